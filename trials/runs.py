"""What the trials beside it share: programs, designs run by `seedloop run`, means with their errors."""

import csv
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FIXTURES = ROOT / "fixtures"
# Makes the drum of fixtures/cotton a small one: 100 mm and 320 seeds.
SMALL_DRUM = ["apparatus.inner_diameter=100 mm", "apparatus.width=24 mm", "seed.0.count=282", "seed.1.count=38",
              "protocol.frame_interval=0.1 s"]


def program(name):
    """Builds a program; gives its path."""
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet", "-p", name], cwd=ROOT, check=True)
    return ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release" / name


def folder_and_runs(folder, runs):
    """Folder of the runs and number of runs of a point from the command line, or these."""
    arguments = sys.argv[1:]
    if len(arguments) > 2 or any(word.startswith("-") for word in arguments):
        sys.exit(f"usage: {sys.argv[0]} [FOLDER [RUNS]]\n\n{sys.modules['__main__'].__doc__}")
    return pathlib.Path(arguments[0] if arguments else folder), int(arguments[1]) if len(arguments) > 1 else runs


def run(seedloop, folder, scene, rows, changes=(), retries=0):
    """Runs each row, a dict of settings and its seed, and gives the rows of results.csv, with `folder`. Finished runs are found
    again. `retries`: how often a run that diverges is tried again with half the step."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "design.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    words = [seedloop, "run", folder / "design.csv", "--scene", scene, "--out", folder / "results", "--resume"]
    words += ["--retries", str(retries)]
    words += [word for change in changes for word in ("--set", change)]
    # 1: a run gave no result, which the tables count.
    if subprocess.run(words, stdout=subprocess.DEVNULL).returncode > 1:
        sys.exit(f"{folder}: no results")
    with open(folder / "results" / "results.csv", newline="") as file:
        return [{**row, "folder": folder / "results"} for row in csv.DictReader(file)]


def details(row):
    """What the record of a run holds beside its observables."""
    with open(row["folder"] / "runs" / f"{row['key']}.json") as file:
        return json.load(file)["details"]


def steady(rows):
    """The runs that gave a result and, if they have such a state, are steady."""
    return [row for row in rows if row["key"] and row["steady"] != "false"]


def values(rows, column):
    """The numbers of a column."""
    return [float(row[column]) for row in rows if row.get(column)]


def mean_and_error(numbers, digits=2):
    """Mean and standard error; the mean alone of one number."""
    if not numbers:
        return "-"
    mean = f"{statistics.fmean(numbers):.{digits}f}"
    if len(numbers) == 1:
        return mean
    return f"{mean} +- {statistics.stdev(numbers) / math.sqrt(len(numbers)):.{digits}f}"


def of(left, asked):
    """How many runs are left if some are missing."""
    return "" if left == asked else f" ({left} of {asked})"


def table(head, rows):
    """Prints a Markdown table."""
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(row)} |", flush=True)
    print()
