"""Asks what the published calibration of the cotton seeds and this solver do not share: runs the study's factors F and B
with one thing of the model changed at a time, and prints what each changes, as a Markdown table.

Usage: python3 published_models.py [OUT [RUNS]]
       python3 published_models.py --table RUNS.csv, such as published_models.csv

RUNS (default 2) runs of each point, three times as many in the slice; dear ones have one, since a run with bonded seeds takes seven
minutes. Finished runs in OUT are found again. All runs are written to OUT/runs.csv, from which `--table` makes the table again without a run.

Errors are standard errors by the scatter of the runs at a point, pooled over the points of a model and of others of its group: a
model that costs much has one run of a point. Only runs that are steady count; the slice is cut short before it can
be, and shows the direction of its centre of mass over what it kept.
"""

import csv
import dataclasses
import math
import statistics
import sys

from runs import FIXTURES, folder_and_runs, program, run

# The study's drum made smaller by 1.4: the same shape, filling and Froude number.
SIMILAR = ["apparatus.inner_diameter=100 mm", "apparatus.width=32.9 mm", "apparatus.speed=11.83 rpm",
           "seed.0.count=385", "seed.1.count=53"]
# A slice of half the diameter, at the same filling and Froude number, cut short.
SLICE = ["apparatus.inner_diameter=70 mm", "apparatus.width=15.4 mm", "apparatus.speed=14.142 rpm",
         "seed.0.count=88", "seed.1.count=12", "protocol.settle_limit=0.14 s", "protocol.rotation_limit=0.7 s",
         "protocol.frames=7"]
# What measured.toml states otherwise than the study's optimum.
OPTIMUM = ["contact.seed-seed.restitution=0.06", "contact.seed-tough_resin.restitution=0.13",
           "contact.seed-clear_resin.restitution=0.12", "contact.seed-clear_resin.static_friction=0.29",
           "contact.seed-seed.rolling_friction=0", "contact.seed-tough_resin.rolling_friction=0",
           "contact.seed-clear_resin.rolling_friction=0"]
OTHER = ["seed.0.filling.seed=2", "seed.1.filling.seed=2"]
FEWER = ["seed.0.filling.sphere_count=117", "seed.1.filling.sphere_count=102"]
SOFT = ["model.bonds.normal_stiffness_n_m3=2.5e7", "model.bonds.shear_stiffness_n_m3=1e7"]
WHOLE = ["model.dashpot_mass=shared", "model.normal_force_end=attractive"]

# Paths of F and B.
PATHS = ["contact.seed-seed.static_friction", "contact.seed-tough_resin.static_friction"]
# F and B: the optimum, F at its low level, and B at both levels of the study's Table 2 where F is at its middle.
POINTS = [(0.10, 0.33), (0.0, 0.33), (0.05, 0.30), (0.05, 0.42)]


@dataclasses.dataclass
class Model:
    """A scene, what is changed in it, and how much of it is run."""

    name: str
    scene: str
    changes: list
    observable: str = "angle_deg"
    group: str = ""  # models whose scatter is pooled; its own where empty
    times: int = 1  # runs of a point over RUNS
    most: int = 1000  # runs of a point
    points: int = len(POINTS)


# The slices whose difference is taken over all points.
RIGID, BONDED = "slice, rigid seeds", "slice, bonds a quarter as stiff"

MODELS = [
    Model("as in drum.toml", "drum", SIMILAR, group="rolling"),
    Model("covers at rest", "drum", [*SIMILAR, "apparatus.covers_at_rest=true"]),
    Model("dashpots with the mass of the body that may pull", "drum", [*SIMILAR, *WHOLE], group="rolling", most=1),
    Model("smooth filling", "measured", [*SIMILAR, *OPTIMUM], group="rolling", most=1),
    Model("another packing", "drum", [*SIMILAR, *OTHER], group="rolling", most=1, points=1),
    Model("packed with a fifth fewer spheres", "drum", [*SIMILAR, *FEWER], group="rolling", most=1, points=1),
    Model(RIGID, "drum", SLICE, "centre_of_mass_deg", "slice", times=3),
    Model(BONDED, "bonded", [*SLICE, *SOFT], "centre_of_mass_deg", "slice", most=1),
    Model("slice, bonded seeds", "bonded", SLICE, "centre_of_mass_deg", "slice", most=1, points=1),
]


@dataclasses.dataclass
class Run:
    """What a run shows: the angle (deg) and the slip at the shell at F and B; no angle where it does not count."""

    model: str
    point: tuple
    angle: float
    slip: float


def rows_of(model, runs):
    """Points with a seed of the random stream each: every point once before any twice."""
    seeds = range(1, min(model.times * runs, model.most) + 1)
    return [(f, b, 1000 * k + seed) for seed in seeds for k, (f, b) in enumerate(POINTS[: model.points])]


def results_of(model, seedloop, out, runs):
    """Runs the points of a model; returns the rows of its results, with its name before each."""
    rows = [dict(zip([*PATHS, "seed"], row)) for row in rows_of(model, runs)]
    results = run(seedloop, out, FIXTURES / f"cotton/{model.scene}.toml", rows, model.changes, retries=1)
    columns = [*PATHS, "seed", "steady", model.observable, "shell_slip", "regime"]
    return [[model.name, *(row[column] for column in columns)] for row in results]


def read(row):
    """A run from a row of runs.csv."""
    model = next(model for model in MODELS if model.name == row[0])
    counts = row[5] and (row[4] == "true" or model.group == "slice")
    angle, slip = (float(text) if counts else math.nan for text in row[5:7])
    return Run(row[0], (float(row[1]), float(row[2])), angle, slip)


def at(runs, name, point, value):
    """Values of the runs of a model at a point that count."""
    values = [value(run) for run in runs if run.model == name and run.point == point]
    return [v for v in values if not math.isnan(v)]


def pooled(runs, names, value):
    """Variance of a single run about the mean of its point, over all points of some models."""
    each = [at(runs, name, point, value) for name in names for point in POINTS]
    square = sum(statistics.variance(values) * (len(values) - 1) for values in each if len(values) > 1)
    freedom = sum(len(values) - 1 for values in each if values)
    return square / freedom if freedom else math.nan


def cell(value, variance):
    """A value and its standard error as text."""
    return "-" if math.isnan(value) or math.isnan(variance) else f"{value:.2f} +- {math.sqrt(variance):.2f}"


def table(runs):
    """The Markdown table."""
    print("| model | F from 0 to 0.10, deg | B from 0.30 to 0.42, deg | at the optimum, deg | slip there | runs that count |")
    print("|---|--:|--:|--:|--:|--:|")
    for model in MODELS:
        names = [other.name for other in MODELS if model.group and other.group == model.group] or [model.name]

        def mean(point, value=lambda run: run.angle):
            values = at(runs, model.name, point, value)
            if not values:
                return math.nan, math.nan
            return statistics.fmean(values), pooled(runs, names, value) / len(values)

        def effect(low, high):
            (a, variance_a), (b, variance_b) = mean(low), mean(high)
            return cell(b - a, variance_a + variance_b)

        optimum, low, wall_low, wall_high = POINTS
        mine = [run for run in runs if run.model == model.name]
        if not mine:
            continue
        print(f"| {model.name} | {effect(low, optimum)} | {effect(wall_low, wall_high)} | {cell(*mean(optimum))} | "
              f"{mean(optimum, lambda run: run.slip)[0]:.2f} | "
              f"{sum(not math.isnan(run.angle) for run in mine)} of {len(mine)} |")
    variance = pooled(runs, [RIGID, BONDED], lambda run: run.angle)
    both = [[at(runs, name, point, lambda run: run.angle) for name in (RIGID, BONDED)] for point in POINTS]
    both = [pair for pair in both if all(pair)]
    if both:
        less = statistics.fmean(statistics.fmean(b) - statistics.fmean(a) for a, b in both)
        error = math.sqrt(sum(variance / len(values) for pair in both for values in pair)) / len(both)
        print(f"\n{BONDED}, over {RIGID}, at {len(both)} points: {less:.2f} +- {error:.2f} deg")


def main():
    """Runs all models, or makes the table of a file of runs."""
    if len(sys.argv) == 3 and sys.argv[1] == "--table":
        with open(sys.argv[2], newline="") as file:
            rows = list(csv.reader(file))[1:]
    else:
        out, runs = folder_and_runs("out/published-models", 2)
        seedloop = program("seedloop")
        rows = [row for model in MODELS for row in results_of(model, seedloop, out / model.name.replace(" ", "-"), runs)]
        with open(out / "runs.csv", "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["model", *PATHS, "seed", "steady", "angle_deg", "shell_slip", "regime"])
            writer.writerows(rows)
    table([read(row) for row in rows])


main()
