"""Benches of some hundred peas by seedloop and by the decks that it exports for LAMMPS and LIGGGHTS: a table of means with standard
errors. RUNS (4) starts of each; finished runs in FOLDER are found again. LAMMPS and LIGGGHTS name the programs."""

import json
import math
import os
import statistics
import subprocess
from concurrent.futures import ThreadPoolExecutor

from runs import folder_and_runs, mean_and_error, program, table

SEEDS = """
[[seed]]
name = "pea"
sphere = "4 mm"
density = "1250 kg/m3"
count = {count}
material = "pea"

[material]
pea = {{ poisson_ratio = 0.3, shear_modulus = "1 MPa" }}
acrylic = {{ poisson_ratio = 0.35, shear_modulus = "20 MPa" }}

[contact]
pea-pea = {{ restitution = 0.4, static_friction = 0.5, rolling_friction = {rolling} }}
pea-acrylic = {{ restitution = 0.4, static_friction = 0.5, rolling_friction = {rolling} }}

[model]
rolling_law = "{law}"

[protocol]
settle_limit = "0.4 s"
rotation_limit = "2 s"
{protocol}
"""
SPRING = {"rolling": 0.1, "law": "spring-dashpot"}
PLAIN = {"rolling": 0, "law": "constant-torque"}
# Apparatus, seeds, and the observables that are compared.
BENCHES = {
    "hopper": (
        'inner_diameter = "36 mm"\noutlet = "22 mm"\nheight = "60 mm"\nwall = "acrylic"',
        {"count": 250, **PLAIN},
        ["mass_flow_g_s", "left_behind_g"],
    ),
    "poured-heap": (
        'inlet = "16 mm"\nfall_height = "30 mm"\ndisc = "50 mm"\nfloor = "acrylic"',
        {"count": 250, **SPRING, "protocol": 'insertion_rate = "500 1/s"'},
        ["angle_by_position_deg", "height_mm", "heap_mass_g"],
    ),
    "heap": (
        'inner_diameter = "30 mm"\nheight = "60 mm"\nlift_speed = "150 mm/s"\nfloor = "acrylic"\ncylinder = "acrylic"',
        {"count": 250, **SPRING},
        ["angle_of_repose_deg", "height_mm", "base_radius_mm"],
    ),
    "box-collapse": (
        'length = "30 mm"\nheight = "60 mm"\nwidth = "16 mm"\nlift_speed = "500 mm/s"\nfloor = "acrylic"\nwall = "acrylic"',
        {"count": 250, **SPRING},
        ["angle_of_repose_deg", "toe_angle_deg", "top_angle_deg", "length_mm"],
    ),
    "compression": (
        'length = "28 mm"\nwidth = "28 mm"\nheight = "40 mm"\nstresses = ["1 kPa", "2 kPa", "4 kPa"]\nwall = "acrylic"\npiston = "acrylic"',
        {"count": 250, **PLAIN},
        ["strain", "loading_modulus_kpa", "unloading_modulus_kpa", "wall_stress_ratio", "bottom_load_share"],
    ),
}
CODES = {"seedloop": None, "LAMMPS": os.environ.get("LAMMPS", "lmp"), "LIGGGHTS": os.environ.get("LIGGGHTS", "liggghts")}


def scene(name, folder):
    """Writes the scene of a bench."""
    apparatus, seeds, _ = BENCHES[name]
    path = folder / f"{name}.toml"
    text = f'[apparatus]\nkind = "{name}"\n{apparatus}\n' + SEEDS.format(**{"protocol": "", **seeds})
    path.write_text(text)
    return path


def own(seedloop, path, seed, result):
    """The means of a run here."""
    words = [seedloop, "simulate", path, "--seed", str(seed), "--quiet", "--json", result]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    read = json.loads(result.read_text())["observables"]
    return {name: value["mean"] for name, value in read.items() if value["mean"] is not None}


def by_deck(seedloop, code, path, seed, folder):
    """The means of a run of an exported deck; none of a deck that ends with an error."""
    words = [seedloop, "export", code.lower(), path, "--seed", str(seed), "--force", "--quiet", "--out", folder]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    with open(folder / "out.txt", "w") as out:
        done = subprocess.run([CODES[code], "-in", "in.bench"], cwd=folder, stdout=out, stderr=subprocess.STDOUT, env=environment)
    if done.returncode != 0:
        print(f"{folder}: the deck ends with {done.returncode}", flush=True)
        return {}
    command = [seedloop, "read-deck", path, folder, "--seed", str(seed), "--json", "--quiet"]
    read = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["observables"]
    for dump in folder.glob("*.dump"):
        dump.unlink()
    return {name: found["mean"] for name, found in read.items()}


def separation(here, there):
    """Difference of two means over its standard error."""
    if min(len(here), len(there)) < 2:
        return "-"
    error = math.hypot(*(statistics.stdev(values) / math.sqrt(len(values)) for values in (here, there)))
    return f"{(statistics.fmean(there) - statistics.fmean(here)) / error:+.1f}" if error > 0 else "-"


def main():
    folder, runs = folder_and_runs("out/bench-decks", 4)
    folder = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    seedloop = program("seedloop")

    def result(task):
        bench, code, seed = task
        kept = folder / f"{bench}-{code}-{seed}.json"
        if not kept.exists():
            path = scene(bench, folder)
            deck = folder / f"{bench}-{code}-{seed}"
            if code == "seedloop":
                values = own(seedloop, path, seed, folder / f"{bench}-{seed}-run.json")
            else:
                values = by_deck(seedloop, code, path, seed, deck)
            kept.write_text(json.dumps(values))
        return json.loads(kept.read_text())

    tasks = [(bench, code, seed) for seed in range(1, runs + 1) for bench in BENCHES for code in CODES]
    with ThreadPoolExecutor(int(os.environ.get("WORKERS", os.cpu_count() or 1))) as pool:
        results = dict(zip(tasks, pool.map(result, tasks)))
    rows = []
    for bench, (_, _, observables) in BENCHES.items():
        for name in observables:
            of_code = {code: [results[bench, code, seed][name] for seed in range(1, runs + 1) if name in results[bench, code, seed]]
                       for code in CODES}
            digits = 3 if name in ("strain", "wall_stress_ratio", "bottom_load_share") else 2
            cells = [mean_and_error(values, digits) for values in of_code.values()]
            apart = [separation(of_code["seedloop"], of_code[code]) for code in ("LAMMPS", "LIGGGHTS")]
            rows.append([bench, f"`{name}`", *cells, *apart])
    table(["bench", "observable", *CODES, "LAMMPS, errors apart", "LIGGGHTS, errors apart"], rows)


main()
