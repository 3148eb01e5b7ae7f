"""Makes broken and odd meshes, feeds them to seedfill, and prints what it answers.

Usage: python3 bad_input.py SEEDFILL

Output is a Markdown table: file, exit code, message (the folder is cut off).
"""

import math
import pathlib
import struct
import subprocess
import sys
import tempfile


def box(low, high):
    """Twelve triangles of a box, counter-clockwise seen from outside."""
    corner = [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [[(a, b, c), (a, c, d)] for a, b, c, d in squares]
    return [[corner[i] for i in face] for pair in faces for face in pair]


def binary(soup, count=None, header=b"", rest=b""):
    """Bytes of a binary STL."""
    text = header.ljust(80) + struct.pack("<I", len(soup) if count is None else count)
    return text + b"".join(struct.pack("<12fH", 0, 0, 0, *sum(t, []), 0) for t in soup) + rest


def strip():
    """A Moebius strip."""
    def point(i, side):
        a = 2 * math.pi * i / 24
        w = side * (-1 if i >= 24 else 1)
        r = 4 + w * math.cos(a / 2)
        return [r * math.cos(a), r * math.sin(a), w * math.sin(a / 2)]

    soup = []
    for i in range(24):
        a, b, c, d = point(i, -1), point(i, 1), point(i + 1, 1), point(i + 1, -1)
        soup += [[a, b, c], [a, c, d]]
    return soup


def pushed():
    """A seed whose tip was pushed in until it came out at the other end: it cuts itself."""
    def point(i, j):
        a, t = 2 * math.pi * i / 30, math.pi * j / 30
        x = 3 * math.cos(t)
        r = 1.5 * math.sin(t)
        return [x - 3.5 * max(0, x - 0.9), r * math.cos(a), r * math.sin(a)]

    soup = []
    for i in range(30):
        for j in range(30):
            a, b, c, d = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            soup += [[a, b, c], [a, c, d]]
    return soup


WHOLE = box((0, 0, 0), (9, 5, 4))
WITH_NAN = [[[math.nan, 0.0, 0.0], *WHOLE[0][1:]], *WHOLE[1:]]
FLAT = [[[x, y, 0.0] for x, y, _ in t] for t in WHOLE]
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"
PLY = b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n" \
    b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n"
CASES = {
    "empty.stl": b"",
    "prose.stl": b"Dear reader, this is no mesh. " * 20,
    "truncated.stl": binary(WHOLE)[:-70],
    "huge_count.stl": binary(WHOLE, count=0xFFFFFFFF),
    "count_too_small.stl": binary(WHOLE, count=5),
    "trailing_bytes.stl": binary(WHOLE, rest=b"written by a scanner"),
    "solid_in_header.stl": binary(WHOLE, header=b"solid seed\nfacet"),
    "no_triangle.stl": binary([]),
    "nan.stl": binary(WITH_NAN),
    "planar.stl": binary(FLAT),
    "open.stl": binary(WHOLE[2:]),
    "inverted.stl": binary([t[::-1] for t in WHOLE]),
    "one_turned.stl": binary([WHOLE[0][::-1], *WHOLE[1:]]),
    "two_bodies.stl": binary(WHOLE + box((20, 0, 0), (22, 2, 2))),
    "cavity.stl": binary(WHOLE + box((2, 2, 1.5), (3, 3, 2.5))),
    "shared_edge.stl": binary(WHOLE + box((9, 5, 0), (12, 8, 4))),
    "moebius.stl": binary(strip()),
    "cuts_itself.stl": binary(pushed()),
    "metres.stl": binary(box((0, 0, 0), (9e-3, 5e-3, 4e-3))),
    "bad_index.obj": OBJ,
    "huge_count.ply": PLY,
}


def main():
    """Prints the table."""
    program = pathlib.Path(sys.argv[1]).resolve()
    print("| file | exit code | message |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for file, data in CASES.items():
            path = pathlib.Path(name) / file
            path.write_bytes(data)
            words = [program, file, "--radius", "0.8", "--effort", "0.1"]
            done = subprocess.run(words, cwd=name, capture_output=True, text=True, timeout=60)
            lines = [line for line in done.stderr.splitlines() if "mesh read in" not in line]
            message = " ".join(lines) or done.stdout.splitlines()[0]
            print(f"| `{file}` | {done.returncode} | {message.replace('|', ' ')} |")


main()
