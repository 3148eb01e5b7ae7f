"""What the time step does to the angle of a drum, by friction and filling, to that of soft beads, and to bench tests: RUNS runs (4)
of each drum and step, twice as many of beads and bench tests. Too long a step throws seeds out, which ends a run: the table tells how
many were left. Finished runs in FOLDER are found again.
"""

from runs import FIXTURES, SMALL_DRUM, details, folder_and_runs, mean_and_error, of, program, run, steady, table, values

FRICTION = "contact.seed-seed.static_friction"
STEP, FLOW_STEP = "protocol.step_share", "protocol.flow_step_share"
SHARES = (0.09, 0.30, 0.36, 0.42, 0.50)
DEFAULT = 0.36
SPHERES = "seed.{}.filling.sphere_count={}"
# Name, scene, spheres of a seed if not those of the scene, shares.
FILLINGS = [
    ("packed", "drum", None, SHARES),
    ("50 spheres", "drum", 50, SHARES[1:]),
    ("100 spheres", "drum", 100, SHARES[1:]),
    ("smooth", "measured", None, SHARES),
]
# Apparatus, what it shows.
TESTS = [
    ('kind = "slider"\nrepeats = 5', "shown_static_friction"),
    ('kind = "tilt"\nrepeats = 15', "shown_rolling_friction"),
    ('kind = "drop"\nrepeats = 40\nheight = "200 mm"', "shown_restitution"),
]


def rows_of(points, runs):
    """Each point with seeds from 1 on."""
    return [{**point, "seed": seed} for point in points for seed in range(1, runs + 1)]


def at(results, column, value):
    """The results whose column has a value."""
    return [row for row in results if float(row[column]) == value]


def angle(results, runs):
    """Mean angle of the steady runs."""
    return mean_and_error(values(steady(results), "angle_deg")) + of(sum(bool(row["key"]) for row in results), runs)


def tests(seedloop, folder, runs):
    """Bench tests by step, with a rolling friction that a tilted seed has to overcome."""
    shares, lines = (0.09, DEFAULT, 1.0), []
    seeds = (FIXTURES / "cotton/drop.toml").read_text().split("[[seed]]", 1)[1].replace("../stl", str(FIXTURES / "stl"))
    for apparatus, shown in TESTS:
        for plate in ("tough_resin", "seed"):
            here = folder / f"{shown}-{plate}"
            here.mkdir(parents=True, exist_ok=True)
            (here / "scene.toml").write_text(f'[apparatus]\n{apparatus}\nplate = "{plate}"\n\n[[seed]]{seeds}')
            rolling = [f"contact.seed-{other}.rolling_friction=0.1" for other in ("tough_resin", "seed")]
            results = run(seedloop, here, here / "scene.toml", rows_of([{STEP: share} for share in shares], runs), rolling)
            lines.append([f"{shown} on {plate}"]
                         + [mean_and_error(values(at(results, STEP, share), shown), 4) for share in shares])
    table(["bench test", *map(str, shares)], lines)


def beads(seedloop, folder, runs):
    """Soft beads, whose step follows from their bed at rest."""
    shares, lines = (0.12, DEFAULT, 0.72), []
    for modulus in ("0.25 MPa", "0.02 MPa"):
        for rolling in ("0.1", "0"):
            changes = ["model.rolling_law=constant-torque", f"material.bead.shear_modulus={modulus}",
                       f"material.wall.shear_modulus={modulus}", f"contact.bead-bead.rolling_friction={rolling}",
                       f"contact.bead-wall.rolling_friction={rolling}"]
            here = folder / f"beads-{modulus.split()[0]}-{rolling}"
            rows = rows_of([{STEP: share} for share in shares], runs)
            results = run(seedloop, here, FIXTURES / "other-code/drum.toml", rows, changes)
            lines.append([f"{modulus}, {rolling}"] + [angle(at(results, STEP, share), runs) for share in shares])
    table(["shear modulus, rolling friction", *map(str, shares)], lines)


def seeds(seedloop, folder, runs):
    """Seeds by filling and friction."""
    lines = []
    for name, scene, spheres, shares in FILLINGS:
        changes = SMALL_DRUM + ([SPHERES.format(k, spheres) for k in (0, 1)] if spheres else [])
        points = [{FRICTION: friction, STEP: share, FLOW_STEP: share} for friction in (0.1, 0.33, 0.56) for share in shares]
        results = run(seedloop, folder / name.replace(" ", "-"), FIXTURES / f"cotton/{scene}.toml", rows_of(points, runs), changes)
        for friction in (0.1, 0.33, 0.56):
            by_share = {share: at(at(results, FRICTION, friction), STEP, share) for share in SHARES}
            default = steady(by_share[DEFAULT])
            step = f"{1e3 * details(default[0])['timing']['time_step_s']:.3f}" if default else "-"
            lines.append([name, str(friction), step] + [angle(rows, runs) if rows else "not run" for rows in by_share.values()]
                         + [mean_and_error(values(default, "shell_slip"))])
    table(["filling", "friction", f"step at {DEFAULT}, ms", *map(str, SHARES), f"shell slip at {DEFAULT}"], lines)


def main():
    folder, runs = folder_and_runs("out/time-step", 4)
    seedloop = program("seedloop")
    tests(seedloop, folder, 2 * runs)
    beads(seedloop, folder, 2 * runs)
    seeds(seedloop, folder, runs)


main()
