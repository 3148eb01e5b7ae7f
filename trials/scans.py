"""Damages bodies of known volume as scans are damaged, gives them to seedfill, and prints what becomes of them.

Usage: python3 scans.py [OTHER_SEEDFILL ...]

Three bodies (a stone, a bean, a lens of a tenth of its width), each damage at two random places. A refused
mesh is given again with the flag that the message proposes, up to four times. Output is a Markdown table:
how many were filled at once, how many with the proposed flags, how many never; of those filled the largest
error of the volume, and how many exceed what the damage can explain (`wrong`). Several programs get the same
files, one line each. The bodies and damages are the same each
time. The variable KIND picks the damages with that word in their name.
"""

import json
import math
import os
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile

import runs

SUBDIVISIONS = 5
PLACES = (1, 2)
ROUNDS = 4
FLAG = re.compile(r"--(?:close-holes|join|rebuild|crumbs) [0-9.e-]+[a-z]*|--unit [a-z]+|--largest-body")


# Geometry: a mesh is a list of points and a list of triples of their numbers.

def add(a, b, scale=1.0):
    """a + scale b."""
    return [x + scale * y for x, y in zip(a, b)]


def cross(a, b):
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    """Scalar product."""
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    """A vector of length 1, or of none where it has none."""
    length = math.sqrt(dot(a, a)) or 1.0
    return [x / length for x in a]


def volume(mesh):
    """Enclosed volume: sum of the signed tetrahedra to the origin."""
    points, faces = mesh
    return sum(dot(points[a], cross(points[b], points[c])) for a, b, c in faces) / 6


def sphere(subdivisions):
    """Icosahedron, its triangles cut in four again and again."""
    g = (1 + math.sqrt(5)) / 2
    points = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g],
              [0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    points = [unit(p) for p in points]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(unit(add(points[a], points[b])))
            return middles[key]

        smaller = []
        for a, b, c in faces:
            d, e, f = middle(a, b), middle(b, c), middle(c, a)
            smaller += [(a, d, f), (d, b, e), (f, e, c), (d, e, f)]
        faces = smaller
    return points, faces


def stone(points):
    """An uneven ellipsoid of 9 x 6 x 5 mm."""
    waves = [([3.1, 1.2, -2.0], 0.06), ([-1.7, 4.3, 1.1], 0.05), ([2.2, -2.9, 5.3], 0.03)]
    out = []
    for p in points:
        r = 1 + sum(a * math.sin(dot(k, p) + 7 * a) for k, a in waves)
        out.append([4.5 * r * p[0], 3.0 * r * p[1], 2.5 * r * p[2]])
    return out


def bean(points):
    """An ellipsoid bent along a parabola, 10 mm long."""
    return [[5 * x, 2 * y + 1.6 * x * x, 1.9 * z] for x, y, z in points]


def lens(points):
    """A flat ellipsoid, 9 x 7 x 0.9 mm."""
    return [[4.5 * x, 3.5 * y, 0.45 * z] for x, y, z in points]


BODIES = {"stone": stone, "bean": bean, "lens": lens}


# Damages: each takes a mesh and a stream of random numbers.

def normals(mesh):
    """Unit normal of each point, from the areas round it."""
    points, faces = mesh
    sums = [[0.0] * 3 for _ in points]
    for face in faces:
        a, b, c = (points[i] for i in face)
        n = cross(add(b, a, -1), add(c, a, -1))
        for i in face:
            sums[i] = add(sums[i], n)
    return [unit(n) for n in sums]


def noise(width):
    """Each point moved by a normal deviate along each axis, mm."""
    def damage(mesh, rng):
        points, faces = mesh
        return [[x + rng.gauss(0, width) for x in p] for p in points], faces
    return damage


def near(mesh, place, radius):
    """Whether each point lies within a radius of the point with that number."""
    centre = mesh[0][place]
    return [math.dist(p, centre) < radius for p in mesh[0]]


def holes(number, radius):
    """Round holes at random places."""
    def damage(mesh, rng):
        points, faces = mesh
        for _ in range(number):
            gone = near(mesh, rng.randrange(len(points)), radius)
            faces = [f for f in faces if not any(gone[i] for i in f)]
        return points, faces
    return damage


def open_bottom(mesh, _rng):
    """The lowest fifth of the height was on the table."""
    points, faces = mesh
    low, high = min(p[2] for p in points), max(p[2] for p in points)
    return points, [f for f in faces if all(points[i][2] > low + 0.2 * (high - low) for i in f)]


def split(gap):
    """Two halves with a gap between them along x, mm: a crack all round."""
    def damage(mesh, _rng):
        points, faces = mesh
        points = [*points]
        new = {}
        out = []
        for f in faces:
            if sum(points[i][0] for i in f) > 0:
                for i in f:
                    if i not in new:
                        new[i] = len(points)
                        points.append(add(points[i], [gap, 0, 0]))
                out.append(tuple(new[i] for i in f))
            else:
                out.append(f)
        return points, out
    return damage


def slit(width):
    """A row of triangles is missing along a plane: a zigzag slit over half of the girth."""
    def damage(mesh, _rng):
        points, faces = mesh
        gone = lambda f: abs(sum(points[i][0] for i in f)) < 1.5 * width and sum(points[i][1] for i in f) > 0
        return points, [f for f in faces if not gone(f)]
    return damage


def turned(share):
    """A share of the triangles is turned round."""
    def damage(mesh, rng):
        points, faces = mesh
        return points, [f[::-1] if rng.random() < share else f for f in faces]
    return damage


def with_triangles(number, triangle):
    """Triangles more, each by a function of the mesh, its normals and the random numbers: points of its own, and three corners,
    of which those behind the points of the mesh are its own."""
    def damage(mesh, rng):
        points, faces = list(mesh[0]), list(mesh[1])
        outward = normals(mesh)
        for _ in range(number):
            own, corners = triangle(mesh, outward, rng)
            shift = len(points) - len(mesh[0])
            points += own
            faces.append(tuple(i + shift if i >= len(mesh[0]) else i for i in corners))
        return points, faces
    return damage


def loose(number):
    """Small triangles that hang free above the surface."""
    def triangle(mesh, outward, rng):
        i, n = rng.randrange(len(mesh[0])), len(mesh[0])
        centre = add(mesh[0][i], outward[i], 0.3)
        return [add(centre, [rng.gauss(0, 0.05) for _ in range(3)]) for _ in range(3)], (n, n + 1, n + 2)
    return with_triangles(number, triangle)


def flaps(number):
    """Triangles that stand on an edge of two others."""
    def triangle(mesh, outward, rng):
        a, b, _c = mesh[1][rng.randrange(len(mesh[1]))]
        return [add(mesh[0][a], outward[a], 0.2)], (a, b, len(mesh[0]))
    return with_triangles(number, triangle)


def doubled(shift):
    """The scan is there twice, shifted: two surfaces that cross."""
    def damage(mesh, rng):
        points, faces = mesh
        way = unit([rng.gauss(0, 1) for _ in range(3)])
        count = len(points)
        return points + [add(p, way, shift) for p in points], faces + [tuple(i + count for i in f) for f in faces]
    return damage


def neighbour(gap):
    """A second body of half the size beside it, mm apart; negative: they cross."""
    def damage(mesh, _rng):
        points, faces = mesh
        right = max(p[0] for p in points)
        small = [[0.5 * x for x in p] for p in points]
        shift = right + gap - min(p[0] for p in small)
        count = len(points)
        return points + [add(p, [shift, 0, 0]) for p in small], faces + [tuple(i + count for i in f) for f in faces]
    return damage


def fold(mesh, rng):
    """A patch is pushed sideways over its neighbours: the surface crosses itself."""
    points, faces = mesh
    inside = near(mesh, rng.randrange(len(points)), 0.8)
    return [add(p, [0.6, 0.6, 0]) if gone else p for p, gone in zip(points, inside)], faces


def spikes(number, height):
    """Single points thrown out along their normals, mm."""
    def damage(mesh, rng):
        points, faces = list(mesh[0]), mesh[1]
        outward = normals(mesh)
        for _ in range(number):
            i = rng.randrange(len(points))
            points[i] = add(points[i], outward[i], height)
        return points, faces
    return damage


def slivers(share):
    """A share of the points falls on a neighbour: triangles without area."""
    def damage(mesh, rng):
        points, faces = list(mesh[0]), mesh[1]
        for a, b, _c in faces:
            if rng.random() < share:
                points[a] = points[b]
        return points, faces
    return damage


def moved(distance):
    """Far from the origin, mm; single precision of the file rounds the points."""
    def damage(mesh, _rng):
        return [add(p, [distance, -distance, distance]) for p in mesh[0]], mesh[1]
    return damage


def scaled(factor):
    """In another unit."""
    def damage(mesh, _rng):
        return [[factor * x for x in p] for p in mesh[0]], mesh[1]
    return damage


def both(*damages):
    """One after another."""
    def damage(mesh, rng):
        for each in damages:
            mesh = each(mesh, rng)
        return mesh
    return damage


# Name, damage, and the largest error of the volume, %, that the damage explains. A lid over a hole of
# radius r on a ball of radius R cuts off a cap of r^4 / R^3 of its volume or less; on the edge of the lens up to 3 %.
DAMAGES = [
    ("none", both(), 0.1),
    ("noise of 0.005 mm", noise(0.005), 2),
    ("noise of 0.05 mm", noise(0.05), 5),
    ("noise of 0.15 mm", noise(0.15), 15),
    ("three holes of 0.3 mm", holes(3, 0.12), 1),
    ("three holes of 1.6 mm", holes(3, 0.8), 10),
    ("open bottom", open_bottom, 15),
    ("crack of 0.001 mm", split(0.001), 0.5),
    ("crack of 0.02 mm", split(0.02), 1),
    ("gap of 0.2 mm", split(0.2), 5),
    ("zigzag slit", slit(0.15), 5),
    ("a tenth of the triangles turned", turned(0.1), 0.1),
    ("half of the triangles turned", turned(0.5), 0.1),
    ("20 loose triangles", loose(20), 0.1),
    ("20 flaps on shared edges", flaps(20), 0.5),
    ("scanned twice, 0.02 mm apart", doubled(0.02), 5),
    ("scanned twice, 0.2 mm apart", doubled(0.2), 20),
    ("a second body beside it", neighbour(0.5), 13),
    ("a second body that crosses it", neighbour(-0.5), 13),
    ("a patch folded over", fold, 5),
    ("five spikes of 2 mm", spikes(5, 2.0), 2),
    ("one in fifty points fallen on a neighbour", slivers(0.02), 2),
    ("10 m from the origin", moved(10_000.0), 2),
    ("written in metres", scaled(0.001), 0.1),
    ("noise, holes and loose triangles", both(noise(0.02), holes(3, 0.5), loose(20)), 5),
]


def binary(mesh):
    """Bytes of a binary STL."""
    points, faces = mesh
    rows = [struct.pack("<12fH", 0, 0, 0, *points[a], *points[b], *points[c], 0) for a, b, c in faces]
    return bytes(80) + struct.pack("<I", len(faces)) + b"".join(rows)


def answer(program, file):
    """Flags that were needed and the volume in mm3, or the last message where it stays refused."""
    flags = []
    for _ in range(ROUNDS + 1):
        words = [program, file, "--radius", "0.3mm" if "lens" in file.name else "0.8mm", "--effort", "0.05", "--json"]
        words += flags
        try:
            done = subprocess.run(words, capture_output=True, text=True, timeout=300)
        except subprocess.TimeoutExpired:
            return flags, None, "no answer in five minutes"
        if done.returncode == 0:
            return flags, json.loads(done.stdout)["mesh"]["volume_mm3"], ""
        message = " ".join(done.stderr.split())
        found = [flag.split() for flag in FLAG.findall(message)]
        proposed = next((flag for flag in found if " ".join(flag) not in " ".join(flags)), None)
        if proposed is None:
            return flags, None, message
        if proposed[0] in flags:
            at = flags.index(proposed[0])
            del flags[at:at + len(proposed)]
        flags += proposed
    return flags, None, message


def trial(program, name, damage, allowed, folder):
    """One row of the table; messages and flags go to standard error."""
    at_once = flagged = refused = wrong = 0
    worst = 0.0
    for body, shape in BODIES.items():
        points, faces = sphere(SUBDIVISIONS)
        whole = (shape(points), faces)
        for place in PLACES:
            file = folder / f"{body}-{place}.stl"
            file.write_bytes(binary(damage(whole, random.Random(f"{name} {body} {place}"))))
            flags, found, message = answer(program, file)
            if found is None:
                refused += 1
                print(f"{name}: {body} {place}: refused after {flags}: {message}", file=sys.stderr)
                continue
            at_once += not flags
            flagged += bool(flags)
            error = 100 * (found / volume(whole) - 1)
            print(f"{name}: {body} {place}: {flags} {error:+.2f} %", file=sys.stderr)
            wrong += abs(error) > allowed
            worst = max(worst, error, key=abs)
    filled = f"{worst:+.2f}" if at_once + flagged else ""
    print(f"| {name} | {at_once} | {flagged} | {refused} | {filled} | {wrong} |", flush=True)


def main():
    """Prints the table."""
    programs = [runs.program("seedfill"), *(pathlib.Path(word).resolve() for word in sys.argv[1:])]
    print("| damage | filled | with the flags proposed | refused | volume error, % | wrong |\n|---|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for name, damage, allowed in DAMAGES:
            if os.environ.get("KIND", "") not in name:
                continue
            for program in programs:
                trial(program, name, damage, allowed, pathlib.Path(folder))


main()
