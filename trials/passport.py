"""Runs the self-test of a passport in LAMMPS, LIGGGHTS and YADE: before and after conversion, and with one convention broken at a time.

    python3 trials/passport.py OUT SEEDLOOP [CODE ...] [--small]

`--small` leaves out bed and heap. Prints a table in Markdown, and stores passports and results in OUT/stored, as in fixtures/passport/stored. Programs that are missing are
left out; `trials/programs.sh passport` installs them.
"""

import json
import os
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
OUT, SEEDLOOP = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
FIXTURES = f"{ROOT}/fixtures/passport"
PACKINGS = "bed", "heap"
# Passports by name: parameters and scene.
PASSPORTS = {
    "rolling": ("rolling.toml", "../peers-study/spheres.toml"),
    "smooth": ("smooth.toml", "../peers-study/spheres.toml"),
    "clumps": ("rolling.toml", "clumps.toml"),
}
COMMANDS = {
    "lammps": ["python3", "run_lammps.py"],
    "liggghts": ["python3", "run_liggghts.py"],
    "yade": ["yade", "-n", "-x", "run_yade.py"],
}
# Runs after conversion, with bed and heap or the small cases alone.
CONVERTED = [
    ("lammps", "rolling", True), ("lammps", "clumps", False),
    ("liggghts", "rolling", True), ("liggghts", "clumps", False),
    ("yade", "smooth", True), ("yade", "rolling", True), ("yade", "clumps", False),
]
# Breaks: the convention that must be named, its factor, and the settings that break it.
BREAKS = {
    ("lammps", "rolling"): [
        ("rolling", 2.0, "roll_grains=0.24 roll_wall=0.16"),
        ("normal-force-end", None, "clipped=0"),
        ("friction-wall", 0.75, "mu_wall=0.3"),
        ("stiffness", 0.4, "young_grains=4e6 young_wall=YOUNG*0.4"),
        ("history-as-force", None, "history=mindlin/force"),
    ],
    ("liggghts", "rolling"): [
        ("rolling-grains", 2.0, "roll_grains=0.24"),
        ("damping-wall", 1.342, "e_wall=0.5"),
        ("normal-force-end", None, "clipped=0"),
        ("no-history", None, "history=no_history"),
    ],
    ("yade", "smooth"): [
        ("stiffness-wall", 0.7071, "young_wall=2.6e9 nu_wall=0.3"),
        ("friction-grains", 1.5, "mu_grains=0.45"),
        ("damping-grains", 0.3288, "e_grains=0.8"),
    ],
}


def passport(name):
    """Writes the passport of a parameter file, once."""
    folder = os.path.join(OUT, name)
    parameters, scene = PASSPORTS[name]
    if not os.path.exists(os.path.join(folder, "passport.json")):
        subprocess.run([SEEDLOOP, "passport", f"{FIXTURES}/{parameters}", "--scene", f"{FIXTURES}/{scene}", "--out", folder, "--quiet"], check=True)
        store(os.path.join(folder, "passport.json"), f"{name}.json")
    return folder


def store(file, name):
    os.makedirs(os.path.join(OUT, "stored"), exist_ok=True)
    shutil.copy(file, os.path.join(OUT, "stored", name))


def run(code, source, name, arguments, cases=None):
    """Runs cases in a folder of their own, all small ones if none are named; the lines of RESULTS.csv without the header, and the seconds.
    Finished runs are kept."""
    folder = os.path.join(OUT, code, f"{source}-{name}")
    results = os.path.join(folder, "RESULTS.csv")
    if not os.path.exists(results):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(passport(source), folder)
        os.rename(results, os.path.join(folder, "template.csv"))
        with open(os.path.join(folder, "cases.py")) as file:
            text = file.read().replace('here("RESULTS.csv")', 'here("template.csv")')
        with open(os.path.join(folder, "cases.py"), "w") as file:
            file.write(text)
        with open(os.path.join(folder, "runs.csv")) as file:
            all_cases = [line.split(",")[0] for line in file.read().splitlines()[1:]]
        cases = cases or [case for case in all_cases if case not in PACKINGS]
        start = time.time()
        subprocess.run([*COMMANDS[code], *arguments, "--cases=" + ",".join(cases)], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(folder, "seconds"), "w") as file:
            file.write(str(time.time() - start))
    with open(results) as file, open(os.path.join(folder, "seconds")) as seconds:
        return folder, file.read().splitlines()[1:], float(seconds.read())


def expected(source):
    """The expected rows by case and quantity."""
    with open(os.path.join(passport(source), "passport.json")) as file:
        return {(row["case"], row["quantity"]): row for row in json.load(file)["expected"]}


def expected_packings(source):
    """The expected numbers of bed and heap as results, where these were not run."""
    rows = expected(source).values()
    return [f"{row['case']},{row['quantity']},{row['unit']},{row['value']!r}" for row in rows if row["varies"]]


def distances(source, lines):
    """Distances of results from the expected numbers, in bands."""
    rows = expected(source)
    cells = [line.split(",") for line in lines]
    return [(float(value) - rows[case, quantity]["value"]) / rows[case, quantity]["band"] for case, quantity, _, value in cells]


def check(folder, lines, code=None):
    """The answer of the check as JSON."""
    file = os.path.join(folder, "all.csv")
    with open(file, "w") as text:
        text.write("\n".join(["case,quantity,unit,value", *lines]) + "\n")
    flags = ["--code", code] if code else []
    done = subprocess.run([SEEDLOOP, "passport", "--check", file, *flags, "--json"], capture_output=True, text=True)
    if done.returncode == 2:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def answer_in_words(answer):
    number = lambda d: f" {d['factor']:.2f} ({d['interval95'][0]:.2f} to {d['interval95'][1]:.2f})" if d["factor"] else ""
    names = [d["convention"] + number(d) for d in answer["differences"]]
    return f"{answer['verdict']}: {', '.join(names)}" if names else answer["verdict"]


def main():
    with_packings = "--small" not in sys.argv
    codes = [word for word in sys.argv[3:] if word in COMMANDS] or COMMANDS
    print("| code | passport | run | answer | right | bed, heap in bands | s |\n|---|---|---|---|---|---|--:|")
    for code, source, packed in CONVERTED:
        program = os.environ.get(code.upper(), {"lammps": "lmp"}.get(code, code))
        if code not in codes or shutil.which(program) is None:
            continue
        last = expected_packings(source)
        for name, arguments in (("raw", ["--raw"]), ("converted", [])):
            folder, lines, seconds = run(code, source, name, arguments)
            words = ""
            if packed and with_packings:
                _, last, more = run(code, source, f"{name}-packings", arguments, PACKINGS)
                words, seconds = ", ".join(f"{z:+.1f}" for z in distances(source, last)), seconds + more
            if name == "raw":
                answer = f"up to {max(abs(z) for z in distances(source, lines)):.0f} bands apart"
                print(f"| {code} | {source} | raw | {answer} | | {words} | {seconds:.0f} |", flush=True)
                continue
            for stated in (None, code):
                answer = check(folder, lines + last, stated)
                right = ("yes" if answer["agrees"] else "no") if stated else ""
                flag = ", --code" if stated else ""
                print(f"| {code} | {source} | converted{flag} | {answer_in_words(answer)} | {right} | {words} | {seconds:.0f} |", flush=True)
        store(os.path.join(folder, "all.csv"), f"{code}-{source}.csv")
        with open(os.path.join(folder, "passport.json")) as file:
            materials = json.load(file)["model"]["materials"]
        for wanted, factor, settings in BREAKS.get((code, source), []):
            if "YOUNG*" in settings:
                settings = lammps_modulus(materials, settings)
            folder, lines, _ = run(code, source, wanted, settings.split())
            answer = check(folder, lines + last, code)
            store(os.path.join(folder, "all.csv"), f"{code}-{source}-{wanted}.csv")
            print(f"| {code} | {source} | {settings} | {answer_in_words(answer)} | {judged(answer, wanted, factor)} | | |", flush=True)


def judged(answer, wanted, factor):
    """Whether the broken convention is named alone and the interval of its factor, widened by 2 %, holds the factor of the break."""
    found = answer["differences"]
    if answer["verdict"] != "named" or [d["convention"] for d in found] != [wanted]:
        return "tie" if answer["verdict"] == "tie" and wanted in [d["convention"] for d in found] else "no"
    low, high = found[0]["interval95"] or (0, 0)
    return "yes" if factor is None or low / 1.02 <= factor <= high * 1.02 else "no"


def lammps_modulus(materials, settings):
    """The modulus of the wall contact, as the script of LAMMPS converts it, times 0.4: the shear modulus as Young's modulus."""
    side = lambda m: ((1 - m["poisson_ratio"]) / 2 / m["shear_modulus"], (2 - m["poisson_ratio"]) / m["shear_modulus"])
    young, shear = (1 / (a + b) for a, b in zip(*map(side, materials)))
    q = 2 * shear / young
    nu = (1 - 2 * q) / (1 - q)
    return settings.replace("YOUNG*0.4", repr(0.4 * 2 * (1 - nu * nu) * young))


if __name__ == "__main__":
    main()
