"""Runs the self-test of a passport in LAMMPS, LIGGGHTS and YADE: before and after conversion, and with one convention broken at a time.

    python3 trials/passport.py OUT SEEDLOOP

Prints a table in Markdown. Programs that are missing are left out; `trials/programs.sh passport` installs them.
"""

import json
import os
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
OUT, SEEDLOOP = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
PACKINGS = "bed", "heap"

# Code: parameters, script, conventions that belong to it, and breaks by the convention that must be named.
CODES = {
    "lammps": ("rolling", ["python3", "run_lammps.py"], ["limit-moves-spring"], [
        ("rolling", "roll_grains=0.24 roll_wall=0.16"),
        ("normal-force-end", "clipped=0"),
        ("friction-wall", "mu_wall=0.3"),
        ("stiffness", "young_grains=4e6 young_wall=YOUNG*0.4"),
        ("history-as-force", "history=mindlin/force"),
    ]),
    "liggghts": ("rolling", ["python3", "run_liggghts.py"], ["limit-of-spring", "rolling-by-spring"], [
        ("rolling-grains", "roll_grains=0.24"),
        ("damping-wall", "e_wall=0.5"),
        ("normal-force-end", "clipped=0"),
        ("no-history", "history=no_history"),
    ]),
    "yade": ("smooth", ["yade", "-n", "-x", "run_yade.py"], ["history-as-force", "limit-of-spring"], [
        ("stiffness-wall", "young_wall=2.6e9 nu_wall=0.3"),
        ("friction-grains", "mu_grains=0.45"),
        ("damping-grains", "e_grains=0.8"),
    ]),
}


def passport(parameters):
    """Writes the passport of a parameter file, once."""
    folder = os.path.join(OUT, parameters)
    if not os.path.exists(os.path.join(folder, "passport.json")):
        subprocess.run([SEEDLOOP, "passport", f"{ROOT}/fixtures/passport/{parameters}.toml", "--scene", f"{ROOT}/fixtures/peers-study/spheres.toml",
                        "--out", folder, "--quiet"], check=True)
    return folder


def run(code, name, arguments, small=False):
    """Runs the cases in a folder of their own; the lines of RESULTS.csv, and the seconds. Finished runs are kept."""
    parameters, command, _, _ = CODES[code]
    source, folder = passport(parameters), os.path.join(OUT, code, name)
    results = os.path.join(folder, "RESULTS.csv")
    if not os.path.exists(results):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(source, folder)
        os.rename(results, os.path.join(folder, "template.csv"))
        with open(os.path.join(folder, "cases.py")) as file:
            text = file.read().replace('here("RESULTS.csv")', 'here("template.csv")')
        with open(os.path.join(folder, "cases.py"), "w") as file:
            file.write(text)
        with open(os.path.join(folder, "runs.csv")) as file:
            cases = [line.split(",")[0] for line in file.read().splitlines()[1:]]
        if small:
            arguments = [*arguments, "--cases=" + ",".join(case for case in cases if case not in PACKINGS)]
        start = time.time()
        subprocess.run([*command, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(folder, "seconds"), "w") as file:
            file.write(str(time.time() - start))
    with open(results) as file, open(os.path.join(folder, "seconds")) as seconds:
        return folder, file.read().splitlines(), float(seconds.read())


def check(folder, lines, accepted):
    """The answer of the check as JSON."""
    file = os.path.join(folder, "all.csv")
    with open(file, "w") as text:
        text.write("\n".join(lines) + "\n")
    flags = [flag for name in accepted for flag in ("--accept", name)]
    done = subprocess.run([SEEDLOOP, "passport", "--check", file, *flags, "--json"], capture_output=True, text=True)
    if done.returncode == 2:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def packings(answer):
    rows = [row for row in answer["rows"] if row["case"] in PACKINGS]
    return ", ".join(f"{row['z']:+.1f}" for row in rows)


def answer_in_words(answer):
    names = [f"{d['convention']}" + (f" {d['factor']:.2f}" if d["factor"] else "") for d in answer["differences"]]
    return f"{answer['verdict']}: {', '.join(names)}" if names else answer["verdict"]


def main():
    print("| code | run | answer | right | bed x, y, heap x, y in bands | s |\n|---|---|---|---|---|--:|")
    for code, (_, command, accepted, breaks) in CODES.items():
        if shutil.which(command[0] if code == "yade" else os.environ.get(code.upper(), {"lammps": "lmp"}.get(code, code))) is None:
            continue
        for name, arguments, accept in (("raw", ["--raw"], []), ("converted", [], []), ("converted, accepted", [], accepted)):
            folder, lines, seconds = run(code, name.split(",")[0], arguments)
            answer = check(folder, lines, accept)
            right = ("yes" if answer["agrees"] else "no") if accept else ""
            print(f"| {code} | {name} | {answer_in_words(answer)} | {right} | {packings(answer)} | {seconds:.0f} |", flush=True)
        packed = [line for line in lines if line.split(",")[0] in PACKINGS]
        young = json.load(open(os.path.join(folder, "passport.json")))["model"]["materials"]
        for wanted, settings in breaks:
            if "YOUNG*" in settings:
                settings = lammps_modulus(young, settings)
            folder, lines, _ = run(code, wanted, settings.split(), small=True)
            answer = check(folder, lines + packed, accepted)
            names = [d["convention"] for d in answer["differences"]]
            right = "yes" if answer["verdict"] == "named" and names == [wanted] else "tie" if answer["verdict"] == "tie" and wanted in names else "no"
            print(f"| {code} | {settings} | {answer_in_words(answer)} | {right} | | |", flush=True)


def lammps_modulus(materials, settings):
    """The modulus of the wall contact, as the script of LAMMPS converts it, times 0.4: the shear modulus as Young's modulus."""
    side = lambda m: ((1 - m["poisson_ratio"]) / 2 / m["shear_modulus"], (2 - m["poisson_ratio"]) / m["shear_modulus"])
    young, shear = (1 / (a + b) for a, b in zip(*map(side, materials)))
    q = 2 * shear / young
    nu = (1 - 2 * q) / (1 - q)
    return settings.replace("YOUNG*0.4", repr(0.4 * 2 * (1 - nu * nu) * young))


if __name__ == "__main__":
    main()
