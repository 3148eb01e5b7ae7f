"""Calibrates two drums, of spheres and of seeds, by the solver here and by another code, and prints the estimates beside each other.

Usage: python3 peers.py lammps|liggghts. Finished runs in out/ are found again.
"""

import json
import pathlib
import subprocess
import sys

from runs import FIXTURES, program, table

CODES = ("lammps", "liggghts")


def calibrated(seedloop, drum, profile):
    """The result of a calibration."""
    out = pathlib.Path("out") / "-".join(["peers", drum, *profile])
    words = [seedloop, "calibrate", FIXTURES / f"peers-study/study-{drum}.toml", "--resume", "--out", out]
    words += [word for name in profile for word in ("--profile", name)]
    # Exit code 1 is an answer: the check fails.
    if subprocess.run(words, stdout=subprocess.DEVNULL).returncode > 1:
        sys.exit(f"{out}: no result")
    return json.loads((out / "result.json").read_text())


def main(code):
    seedloop, lines = program("seedloop"), []
    for drum in ("spheres", "seeds"):
        own = None
        for profile in ([], [code]):
            result = calibrated(seedloop, drum, profile)
            (parameter,), (check,), cost = result["parameters"], result["check"], result["cost"]
            value, se, shown = parameter["value"], parameter["se"], check["simulated"]
            own = own or (value, se)
            lines.append([drum, code if profile else "own", f"{value:.3f} +- {se:.3f}",
                          f"{value - own[0]:+.3f} +- {(se**2 + own[1] ** 2) ** 0.5:.3f}" if profile else "",
                          f"{shown['mean']:.2f} +- {shown['se']:.2f}", str(cost["runs"]), f"{cost['wall_s'] / 60:.0f}"])
    table(["drum", "runs by", "friction", "less own", "angle at the check, deg", "runs", "wall, min"], lines)


main(sys.argv[1]) if len(sys.argv) == 2 and sys.argv[1] in CODES else sys.exit(__doc__)
