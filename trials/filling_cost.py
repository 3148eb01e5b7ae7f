"""What a step of a drum costs with other fillings of its seeds, beside the cost that seedfill counts.

Runs 300 seeds in a quarter of the width, each filling on one thread, with packed spheres before and behind each, since machines
drift; prints a Markdown table. Cost is processor time a seed and step over the mean of the two packings.
"""

import json
import subprocess

from runs import FIXTURES, program

PACKED = ("pack", 0.45, 127)
OTHERS = [
    ("pack", 0.60, 40),
    ("surface", 0.2, 5),
    ("surface", 0.2, 10),
    ("surface", 0.2, 25),
    ("surface", 0.2, 50),
    ("surface", 0.2, 100),
    ("smooth", 0.2, 10),
    ("smooth", 0.2, 20),
    ("smooth", 0.2, 60),
    ("distance-transform", 0.2, 20),
    ("distance-transform", 0.2, 60),
    ("favier", 0.3, 9),
    ("ferellec", 0.3, 40),
]


def output(words):
    """The JSON that a program prints."""
    return json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE).stdout)


def cost(seedloop, filling):
    """Processor time of a seed and step, us."""
    method, radius, count = filling
    changes = ["seed.0.count=264", "seed.1.count=36", "apparatus.width=11.5 mm", "frames=2"]
    changes += ["rotation_limit=0.8 s", "flow_step_share=0.36"]
    for seed in (0, 1):
        changes.append(f"seed.{seed}.filling.method={method}")
        changes.append(f"seed.{seed}.filling.sphere_radius={radius} mm")
        changes.append(f"seed.{seed}.filling.sphere_count={count}")
    sets = [word for change in changes for word in ("--set", change)]
    words = [seedloop, "simulate", FIXTURES / "cotton/drum.toml", "--threads", "1", "--quiet", "--json"]
    timing = output(words + sets)["timing"]
    return timing["cpu_s"] * 1e6 / (timing["steps"] * timing["bodies"])


def counted(seedfill, filling):
    """The near pairs and the relative cost that seedfill counts."""
    method, radius, count = filling
    words = [seedfill, FIXTURES / "stl/cotton_ellipsoidal.stl", "--method", method, "--radius", str(radius)]
    words += ["--count", str(count), "--quiet", "--json"]
    cost = output(words)["cost"]
    return cost["near_pairs_per_contact"], cost["relative_step_cost"]


def main():
    seedloop, seedfill = program("seedloop"), program("seedfill")
    print("| filling | spheres a seed | near pairs a contact | cost of a seed and step, relative | by `seedfill` |")
    print("|---|--:|--:|--:|--:|")
    before = cost(seedloop, PACKED)
    for filling in OTHERS:
        measured = cost(seedloop, filling)
        behind = cost(seedloop, PACKED)
        relative = 2.0 * measured / (before + behind)
        method, radius, count = filling
        near, cost_counted = counted(seedfill, filling)
        print(f"| {method}, {radius} mm | {count} | {near:.1f} | {relative:.2f} | {cost_counted:.2f} |", flush=True)
        before = behind


main()
