"""Reads the cases of a passport, and writes RESULTS.csv."""

import csv
import json
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def rows(name):
    """Rows of a table of the passport, numbers as numbers."""
    with open(os.path.join(HERE, name), newline="") as file:
        for row in csv.DictReader(file):
            yield {key: number(value) for key, value in row.items()}


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


class Case:
    """A case: times, gravity, planes, bodies and spheres."""

    def __init__(self, run):
        self.name, self.step = run["case"], run["time_step_s"]
        self.gravity = [run[f"gravity_{axis}_m_s2"] for axis in "xyz"]
        self.times = [t for t in (run["t1_s"], run["t2_s"]) if t != ""]
        here = lambda table: [row for row in rows(table) if row["case"] == self.name]
        self.walls, self.bodies, self.spheres = here("walls.csv"), here("bodies.csv"), here("spheres.csv")
        self.wanted = [(row["quantity"], row["unit"]) for row in here("RESULTS.csv")]
        self.is_packing = self.name in ("bed", "heap")
        self.has_clumps = len(self.spheres) > len(self.bodies)

    def steps(self):
        """Steps from one time to the next."""
        ends = [round(t / self.step) for t in self.times]
        return [end - start for start, end in zip([0] + ends, ends)]


def lever_over_radius(case, values):
    """Arm of rolling friction over the radius of a sphere: of a clump that takes it to its centre, from the point at which it meets the floor."""
    if not case.has_clumps or values["sphere_lever"] or is_raw():
        return 1.0
    body, lowest = case.bodies[0], min(case.spheres, key=lambda sphere: sphere["y_m"])
    down = [0.0, values["radius"], 0.0]
    return math.hypot(*(lowest[f"{a}_m"] - d - body[f"{a}_m"] for a, d in zip("xyz", down))) / values["radius"]


def passport():
    with open(os.path.join(HERE, "passport.json")) as file:
        return json.load(file)


def settings():
    """Values of the model for scripts; arguments NAME=VALUE change them, --raw leaves out all conversions, --cases=A,B chooses."""
    model = passport()["model"]
    values = {}
    for place, contact, material in zip(("grains", "wall"), model["contacts"], model["materials"]):
        values[f"e_{place}"] = contact["restitution"]
        values[f"mu_{place}"] = contact["static_friction"]
        values[f"roll_{place}"] = contact["rolling_friction"]
        values[f"attraction_{place}"] = contact["attraction_n"]
        values[f"cohesion_{place}"] = contact["cohesion_energy_density_j_m3"]
        nu, shear = material["poisson_ratio"], material["shear_modulus"]
        values[f"nu_{place}"], values[f"young_{place}"] = nu, 2.0 * shear * (1.0 + nu)
    values["radius"], values["density"] = model["radius_m"], model["density_kg_m3"]
    values["clipped"] = float(model["normal_force_end"] == "clipped")
    values["sphere_mass"] = float(model["dashpot_mass"] == "sphere")
    values["sphere_lever"] = float(model["rolling_lever"] == "sphere")
    values["spring"] = float(model["rolling_law"] == "spring-dashpot")
    changes = dict(argument.split("=", 1) for argument in sys.argv[1:] if "=" in argument and not argument.startswith("--"))
    unknown = set(changes) - set(values) - {"history"}
    if unknown:
        sys.exit(f"unknown setting {', '.join(sorted(unknown))}; expected one of {', '.join(values)}, history")
    return values, changes


def with_changes(values, changes):
    """Values with what the arguments change, after the conversion."""
    return values | {name: number(value) for name, value in changes.items()}


def chosen():
    only = [argument[8:].split(",") for argument in sys.argv[1:] if argument.startswith("--cases=")]
    runs = [Case(run) for run in rows("runs.csv")]
    return [case for case in runs if not only or case.name in only[0]]


def is_raw():
    return "--raw" in sys.argv


def body_restitution(restitution, share):
    """Restitution that gives, with the mass of the body, the dashpot of a share of that mass."""
    log = math.log(restitution)
    ratio = -log / math.hypot(log, math.pi) * math.sqrt(share)
    return math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio * ratio))


def domain(radius):
    """Ends of the domain along x, y and z, so that no sphere leaves it on the open side of the heap."""
    return [(-20 * radius, 500 * radius), (-20 * radius, 80 * radius), (-20 * radius, 20 * radius)]


def data(case, values, types):
    """Spheres and their motion as a data file of LAMMPS and LIGGGHTS."""
    lines = [case.name, "", f"{len(case.spheres)} atoms", f"{types} atom types", ""]
    lines += [f"{low!r} {high!r} {axis}lo {axis}hi" for axis, (low, high) in zip("xyz", domain(values["radius"]))] + ["", "Atoms", ""]
    for number, s in enumerate(case.spheres, 1):
        place = " ".join(repr(s[f"{axis}_m"]) for axis in "xyz")
        lines.append(f"{number} 1 {2 * values['radius']!r} {values['density']!r} {place}")
    lines += ["", "Velocities", ""]
    keys = [f"velocity_{a}_m_s" for a in "xyz"] + [f"spin_{a}_rad_s" for a in "xyz"]
    return lines + [" ".join([str(n)] + [repr(b[key]) for key in keys]) for n, b in enumerate(case.bodies, 1)]


def component(case, quantity, states):
    """A number such as velocity_x_at_t1; a state is position, velocity and spin of body 1."""
    what, axis, _, time = quantity.split("_")
    axis, state = "xyz".index(axis), states[int(time[1:]) - 1]
    start = case.bodies[0][f"{'xyz'[axis]}_m"]
    return {"velocity": state[3 + axis], "spin": state[6 + axis], "displacement": state[axis] - start}[what]


def read_packing(case, centres, radius):
    """The numbers of bed or heap by the centres at the end."""
    n = len(centres)
    if n != len(case.spheres):
        sys.exit(f"{case.name}: {n} of {len(case.spheres)} spheres are left")
    return [sum(min(c[0], 40.0 * radius) for c in centres) / n, sum(c[1] for c in centres) / n]


def write_results(results):
    """Writes RESULTS.csv in the folder in which the script runs; `results` has a list of values for each case."""
    lines = ["case,quantity,unit,value"]
    for case, values in results:
        for (quantity, unit), value in zip(case.wanted, values):
            lines.append(f"{case.name},{quantity},{unit},{value!r}")
    with open("RESULTS.csv", "w") as file:
        file.write("\n".join(lines) + "\n")
