"""One irregular stone at twelve sizes from 10 um to 10 m, filled by every method of seedfill.

usage: sizes.py SEEDFILL

Prints a Markdown table: spheres, share of the volume, and processor time in s. A search that ends when its work is spent, as of
pack without a count, may end with a sphere more or less when the last digit of a coordinate changes.
"""

import json
import math
import os
import random
import subprocess
import sys
import tempfile

METHODS = ["pack", "lattice", "smooth", "surface", "favier", "ferellec", "distance-transform"]
SIZES = 12


def stone():
    """Vertices and triangles of a ball with bumps, about 1 long."""
    rings, around = 24, 36
    draw = random.Random(1)
    bumps = []
    for _ in range(12):
        way = [draw.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*way)
        bumps.append(([part / length for part in way], draw.gauss(0, 0.12)))

    def vertex(polar, azimuth):
        unit = [math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)]
        radius = 0.5
        for way, height in bumps:
            radius += 0.5 * height * max(0.0, sum(a * b for a, b in zip(unit, way))) ** 3
        return [radius * stretch * part for stretch, part in zip((1.0, 0.8, 0.6), unit)]

    vertices = [vertex(0.0, 0.0)]
    for ring in range(1, rings):
        vertices += [vertex(math.pi * ring / rings, 2 * math.pi * k / around) for k in range(around)]
    vertices.append(vertex(math.pi, 0.0))
    at = lambda ring, k: 1 + (ring - 1) * around + k % around
    faces = []
    for k in range(around):
        faces.append((0, at(1, k), at(1, k + 1)))
        faces.append((len(vertices) - 1, at(rings - 1, k + 1), at(rings - 1, k)))
        for ring in range(1, rings - 1):
            faces.append((at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)))
            faces.append((at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)))
    return vertices, faces


def filled(seedfill, mesh, size, method):
    """Spheres, share of the volume, processor time."""
    words = [seedfill, mesh, "--radius", repr(0.06 * size), "--method", method, "--quiet", "--json"]
    child = subprocess.Popen(words, stdout=subprocess.PIPE)
    result = json.loads(child.stdout.read())
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{method} at {size} mm ends with {child.returncode}")
    return result["spheres"], result["fit"]["union_fraction"], used.ru_utime + used.ru_stime


def main(seedfill):
    vertices, faces = stone()
    print("| size, mm | " + " | ".join(METHODS) + " |")
    print("|--:|" + "--:|" * len(METHODS))
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "stone.obj")
        for k in range(SIZES):
            size = 0.01 * 1e6 ** (k / (SIZES - 1))
            with open(mesh, "w", encoding="ascii") as file:
                for vertex in vertices:
                    file.write("v " + " ".join(repr(size * part) for part in vertex) + "\n")
                for face in faces:
                    file.write("f " + " ".join(str(index + 1) for index in face) + "\n")
            cells = [filled(seedfill, mesh, size, method) for method in METHODS]
            text = " | ".join(f"{n}, {share:.4f}, {used:.1f} s" for n, share, used in cells)
            print(f"| {size:.4g} | {text} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
