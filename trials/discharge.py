"""Measured and simulated discharge of a hopper as a picture, and their rates:

    python3 trials/discharge.py PICTURE.svg TABLE.csv[:MATERIAL] NAME=RUN.json ...

TABLE.csv has the columns time_s and discharged_percent, and material if MATERIAL is given. RUN.json is what `seedloop simulate ...
--json=RUN.json` wrote; NAME is written beside its curve."""

import csv
import json
import sys
from pathlib import Path

WIDTH, HEIGHT, LEFT, BOTTOM = 640, 400, 60, 50
COLOURS = ["#b2502c", "#3a6ea5", "#4b8b4b", "#7a5195"]


def tabled(argument):
    path, _, material = argument.partition(":")
    rows = [r for r in csv.DictReader(open(path)) if r.get("material", "") == material]
    return [(float(r["time_s"]), float(r["discharged_percent"])) for r in rows]


def simulated(path):
    curve = json.loads(Path(path).read_text())["curve"]["columns"]
    points = list(zip(curve["time_s"], curve["percent"]))
    return points[:: max(1, len(points) // 200)] + points[-1:]


def rate(points):
    """Per cent a second between 20 and 60 %, by lines between the points."""

    def time_of(part):
        (t0, p0), (t1, p1) = next(pair for pair in zip(points, points[1:]) if pair[1][1] >= part)
        return t0 + (t1 - t0) * (part - p0) / (p1 - p0)

    return 40 / (time_of(60) - time_of(20))


def main():
    picture, table, *runs = sys.argv[1:]
    points = tabled(table)
    named = [argument.rsplit("=", 1) for argument in runs]
    curves = [(name, simulated(path)) for name, path in named]
    for name, curve in [("table", points), *curves]:
        print(f"{name}: {rate(curve):.1f} %/s, {curve[-1][1]:.1f} % in the end")
    longest = 1.05 * points[-1][0]

    def place(time, percent):
        x = LEFT + (WIDTH - LEFT - 20) * min(time, longest) / longest
        y = HEIGHT - BOTTOM - (HEIGHT - BOTTOM - 20) * percent / 100
        return f"{x:.1f}", f"{y:.1f}"

    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">']
    parts.append(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>')
    ticks = [t * 0.5 for t in range(17)] if longest < 4 else range(0, 9, 2)
    for time in (t for t in ticks if t <= longest):
        x, y = place(time, 0)
        parts.append(f'<text x="{x}" y="{float(y) + 18}" text-anchor="middle">{time:g}</text>')
    for percent in range(0, 101, 20):
        x, y = place(0, percent)
        parts.append(f'<text x="{float(x) - 8}" y="{float(y) + 4}" text-anchor="end">{percent}</text>')
        end, _ = place(longest, percent)
        parts.append(f'<path d="M{x},{y} L{end},{y}" stroke="#ddd"/>')
    parts.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 10}" text-anchor="middle">time, s</text>')
    parts.append(f'<text x="16" y="{HEIGHT / 2}" text-anchor="middle" transform="rotate(-90 16 {HEIGHT / 2})">discharged, %</text>')
    for x, y in (place(*point) for point in points):
        parts.append(f'<circle cx="{x}" cy="{y}" r="3.5"/>')
    parts.append(f'<text x="420" y="250">points: {Path(table.partition(":")[0]).name}</text>')
    for k, (name, curve) in enumerate(curves):
        line = " L".join(",".join(place(*point)) for point in curve)
        parts.append(f'<path d="M{line}" fill="none" stroke="{COLOURS[k % 4]}" stroke-width="2"/>')
        parts.append(f'<text x="420" y="{270 + 20 * k}" fill="{COLOURS[k % 4]}">{name}</text>')
    Path(picture).write_text("\n".join(parts + ["</svg>", ""]))


main()
