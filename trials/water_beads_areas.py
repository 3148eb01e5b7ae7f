"""The area of the side view of each deposit of fixtures/water-beads, from its height and its two angles, without any simulation.

    python3 trials/water_beads_areas.py [simulate]

The upper half of the height H falls with the top angle, the lower half with the toe angle: the area is
H^2/8 (3 cot top + cot toe). The same grains at the same bulk density have the same area whatever their angles are. `simulate` runs boxes with the water
declared and as many more beads than dry as the areas say, eight runs of 8 mm and three of 4 mm at each content (10 minutes of a core)."""

import csv
import math
import statistics
import subprocess
import sys
from collections import defaultdict

from runs import FIXTURES, program


def area(row):
    height = 10 * float(row["deposit_height_cm"])
    top, toe = (math.radians(float(row[name])) for name in ("top_angle_deg", "toe_angle_deg"))
    return height**2 / 8 * (3 / math.tan(top) + 1 / math.tan(toe))


def mean_and_error(areas):
    return statistics.fmean(areas), statistics.stdev(areas) / math.sqrt(len(areas))


# Share of the box of 240 mm that the beads of dry deposits fill, and the runs of each diameter.
DRY_FILL, RUNS = 0.41667, {"4": 3, "8": 8}
SHOWN = ("height_mm", "toe_angle_deg", "top_angle_deg", "length_mm")


def simulate(ratios):
    seedloop = program("seedloop")
    print(f"| water, % | bead, mm | {' | '.join(SHOWN)} |\n|--:|--:|{'--:|' * len(SHOWN)}")
    for (diameter, content), ratio in ratios.items():
        values = defaultdict(list)
        for seed in range(1, RUNS[diameter] + 1):
            sets = ["apparatus.height=240 mm", f"seed.0.sphere={diameter} mm", f"seed.0.fill_level={DRY_FILL * round(ratio, 2):.4f}",
                    f"model.liquid.content={0.025 * float(content)}"]
            words = [seedloop, "simulate", FIXTURES / "water-beads" / "box.toml", *sets, "--seed", str(seed)]
            for line in subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines():
                name, *rest = line.split() or [""]
                if name in SHOWN:
                    values[name].append(float(rest[0]))
        cells = [f"{mean:.1f} +- {error:.1f}" for mean, error in (mean_and_error(values[name]) for name in SHOWN)]
        print(f"| {content} | {diameter} | {' | '.join(cells)} |", flush=True)


def main():
    ratios = {}
    groups = defaultdict(list)
    with open(FIXTURES / "water-beads" / "measured.csv", newline="") as file:
        for row in csv.DictReader(file):
            groups[row["bead_diameter_mm"], row["water_wt_percent"]].append(area(row))
    print("| water, % | 4 mm | over dry | 8 mm | over dry |\n|--:|--:|--:|--:|--:|")
    for content in sorted({content for _, content in groups}, key=float):
        cells = []
        for diameter in ("4", "8"):
            mean, error = mean_and_error(groups[diameter, content])
            dry, of_dry = mean_and_error(groups[diameter, "0"])
            ratio = mean / dry
            of_ratio = ratio * math.hypot(error / mean, of_dry / dry) if content != "0" else 0
            if content in ("1", "3", "5"):
                ratios[diameter, content] = ratio
            cells += [f"{mean / 100:.0f} +- {error / 100:.0f} cm2", f"{ratio:.2f} +- {of_ratio:.2f}"]
        print(f"| {content} | {' | '.join(cells)} |")
    if sys.argv[1:] == ["simulate"]:
        simulate(ratios)


if __name__ == "__main__":
    main()
