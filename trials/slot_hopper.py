"""Measured and simulated discharge of the slot hopper: writes fixtures/slot-hopper/curves.svg.

    python3 trials/slot_hopper.py FRICTION=RUN.json ...

RUN.json is what `seedloop simulate fixtures/slot-hopper/spheres.toml ... --json=RUN.json` wrote; FRICTION names the curve."""

import csv
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "fixtures/slot-hopper"
WIDTH, HEIGHT, LEFT, BOTTOM, LONGEST = 640, 400, 60, 50, 8.0
COLOURS = ["#b2502c", "#3a6ea5", "#4b8b4b", "#7a5195"]


def place(time, percent):
    x = LEFT + (WIDTH - LEFT - 20) * time / LONGEST
    y = HEIGHT - BOTTOM - (HEIGHT - BOTTOM - 20) * percent / 100
    return f"{x:.1f},{y:.1f}"


def measured():
    rows = csv.DictReader((FOLDER / "measured.csv").open())
    return [(float(r["time_s"]), float(r["discharged_percent"])) for r in rows if r["material"] == "plastic spheres"]


def simulated(path):
    run = json.loads(Path(path).read_text())
    curve = run["curve"]["columns"]
    points = list(zip(curve["time_s"], curve["percent"]))
    return points[:: max(1, len(points) // 200)] + points[-1:]


def middle_rate(points):
    """Per cent a second between 20 and 60 %."""
    ends = [next(t for t, p in points if p >= part) for part in (20, 60)]
    return 40 / (ends[1] - ends[0])


def main():
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">']
    parts.append(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>')
    for time in range(0, 9, 2):
        x, y = place(time, 0).split(",")
        parts.append(f'<text x="{x}" y="{float(y) + 18}" text-anchor="middle">{time}</text>')
    for percent in range(0, 101, 20):
        x, y = place(0, percent).split(",")
        parts.append(f'<text x="{float(x) - 8}" y="{float(y) + 4}" text-anchor="end">{percent}</text>')
        parts.append(f'<path d="M{place(0, percent)} L{place(LONGEST, percent)}" stroke="#ddd"/>')
    parts.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 10}" text-anchor="middle">time, s</text>')
    parts.append(f'<text x="16" y="{HEIGHT / 2}" text-anchor="middle" transform="rotate(-90 16 {HEIGHT / 2})">discharged, %</text>')
    points = measured()
    print(f"measured: {middle_rate(points):.1f} %/s, {points[-1][1]} % in the end")
    parts += [f'<circle cx="{p.split(",")[0]}" cy="{p.split(",")[1]}" r="3.5"/>' for p in (place(*q) for q in points)]
    parts.append('<text x="470" y="250">points: measured</text>')
    for k, argument in enumerate(sys.argv[1:]):
        name, path = argument.split("=", 1)
        curve = simulated(path)
        print(f"{name}: {middle_rate(curve):.1f} %/s, {curve[-1][1]:.1f} % in the end")
        line = " L".join(place(*p) for p in curve)
        parts.append(f'<path d="M{line}" fill="none" stroke="{COLOURS[k % 4]}" stroke-width="2"/>')
        parts.append(f'<text x="470" y="{270 + 20 * k}" fill="{COLOURS[k % 4]}">{name}</text>')
    (FOLDER / "curves.svg").write_text("\n".join(parts + ["</svg>", ""]))


main()
