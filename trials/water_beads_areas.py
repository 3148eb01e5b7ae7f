"""The area of the side view of each deposit of fixtures/water-beads, from its height and its two angles, without any simulation.

    python3 trials/water_beads_areas.py

The upper half of the height H falls with the top angle, the lower half with the toe angle: the area is
H^2/8 (3 cot top + cot toe). The same grains at the same bulk density have the same area whatever their angles are."""

import csv
import math
import statistics
from collections import defaultdict

from runs import FIXTURES


def area(row):
    height = 10 * float(row["deposit_height_cm"])
    top, toe = (math.radians(float(row[name])) for name in ("top_angle_deg", "toe_angle_deg"))
    return height**2 / 8 * (3 / math.tan(top) + 1 / math.tan(toe))


def mean_and_error(areas):
    return statistics.fmean(areas), statistics.stdev(areas) / math.sqrt(len(areas))


def main():
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
            cells += [f"{mean / 100:.0f} +- {error / 100:.0f} cm2", f"{ratio:.2f} +- {of_ratio:.2f}"]
        print(f"| {content} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
