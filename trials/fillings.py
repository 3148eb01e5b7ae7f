"""Table of fillings, method by mesh, beside those of other programs.

Usage: python3 fillings.py [MESH ...], besides the two seeds of fixtures/stl

Other programs are the Python packages `clump-python` (method Euclidean, 102 voxels across, overlap
0.6 as in its own example) and `multisphere`; what is not installed is left out, and said. Their
spheres are measured by `seedfill --spheres`, so every figure has one definition. Times are CPU
seconds of the whole command, reading and measuring included for seedfill, the generating call
alone for the others. Output is a Markdown table.
"""

import contextlib
import csv
import importlib.util
import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

from runs import FIXTURES, program

COUNT = 50
OWN = [
    ("pack", ["--radius", "0.45"]),
    ("lattice", ["--radius", "0.45"]),
    ("smooth", ["--radius", "0.2", "--count", str(COUNT)]),
    ("surface", ["--radius", "0.2", "--count", str(COUNT)]),
    ("favier", ["--radius", "0.2", "--count", str(COUNT)]),
    ("ferellec", ["--radius", "0.2", "--count", str(COUNT)]),
    ("distance-transform", ["--radius", "0.1", "--count", str(COUNT)]),
]


def seedfill(program, mesh, words):
    """Runs seedfill; gives its JSON and CPU seconds, or none where it refuses."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = [program, mesh, *words, "--json", "--quiet"]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return (json.loads(done.stdout) if done.returncode == 0 else None), seconds


def by_clump(mesh):
    """Spheres of CLUMP, about the middle of the bounding box, to which it moves the mesh."""
    from CLUMP import GenerateClump_Euclidean_3D

    _, clump = GenerateClump_Euclidean_3D(str(mesh), COUNT, 0, 102, 0.6)
    return [[*p, float(r)] for p, r in zip(clump.positions, clump.radii.ravel())], True


def by_multisphere(mesh):
    """Spheres of multisphere, in the frame of the mesh by its manual."""
    from multisphere import multisphere_from_mesh
    from multisphere.multisphere_io import load_mesh

    pack = multisphere_from_mesh(load_mesh(str(mesh)), div=100, max_spheres=COUNT)
    return [[*c, float(r)] for c, r in zip(pack.centers, pack.radii)], False


OTHERS = [("CLUMP", "CLUMP", by_clump), ("multisphere", "multisphere", by_multisphere)]


def measured(program, mesh, spheres, about_middle, folder):
    """Measures the spheres of another program."""
    middle = [0.0] * 3
    if about_middle:
        words = [program, mesh, "--radius", "0.4", "--method", "favier", "--json", "--quiet"]
        box = json.loads(subprocess.run(words, capture_output=True, text=True).stdout)
        box = box["mesh"]["bounding_box"]
        middle = [(low + high) / 2 for low, high in zip(box["low"], box["high"])]
    file = folder / "spheres.csv"
    with open(file, "w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["x", "y", "z", "radius"])
        for *centre, radius in spheres:
            table.writerow([*(float(c) + m for c, m in zip(centre, middle)), radius])
    return seedfill(program, mesh, ["--spheres", file])[0]


def row(mesh, name, found, seconds):
    """One line of the table."""
    if found is None:
        return f"| {mesh.stem} | {name} | refused | | | | | | |"
    fit = found["fit"]
    inertia = max(abs(error) for error in fit["inertia_error_percent"])
    return (
        f"| {mesh.stem} | {name} | {found['spheres']} | {seconds:.2f} | "
        f"{fit['packing_fraction']:.3f} | {fit['union_fraction']:.4f} | "
        f"{fit['surface_rms']:.4f} | {fit['roughness_rms']:.4f} | {inertia:.2f} |"
    )


def main():
    """Prints the table."""
    seeds = [FIXTURES / f"stl/cotton_{form}.stl" for form in ("ellipsoidal", "flat")]
    meshes = seeds + [pathlib.Path(word).resolve() for word in sys.argv[1:]]
    own = program("seedfill")
    print("| mesh | method | spheres | CPU s | sphere volumes / mesh | union / mesh | "
          "surface rms, mm | roughness, mm | largest inertia error, % |")
    print("|---|---|---|---|---|---|---|---|---|")
    absent = set()
    with tempfile.TemporaryDirectory() as name:
        for mesh in meshes:
            for method, words in OWN:
                found, seconds = seedfill(own, mesh, ["--method", method, *words])
                print(row(mesh, method, found, seconds), flush=True)
            for label, package, place in OTHERS:
                if importlib.util.find_spec(package) is None:
                    absent.add(label)
                    continue
                start = time.process_time()
                with contextlib.redirect_stdout(sys.stderr):
                    spheres, about_middle = place(mesh)
                seconds = time.process_time() - start
                found = measured(own, mesh, spheres, about_middle, pathlib.Path(name))
                print(row(mesh, label, found, seconds), flush=True)
    for label in sorted(absent):
        print(f"\n{label} is not installed in this Python and was left out.")


main()
