"""Runs the cases of a passport in LAMMPS and writes RESULTS.csv: python3 run_lammps.py [NAME=VALUE ...]

The program is `lmp`, or that of the variable LAMMPS. What is converted is in `converted`; `--raw` leaves it out.
"""

import math
import os
import subprocess

import cases


def converted(values):
    """The model in the words of `pair_style granular`: one material that, mixed with itself, has the moduli of the pair."""
    found = dict(values)
    elastic = lambda place: ((1 - values[f"nu_{place}"] ** 2) / values[f"young_{place}"],
                             2 * (1 + values[f"nu_{place}"]) * (2 - values[f"nu_{place}"]) / values[f"young_{place}"])
    grain = elastic("grains")
    for place in ("grains", "wall"):
        young, shear = (1 / (a + b) for a, b in zip(grain, elastic(place)))
        q = 2 * shear / young
        nu = (1 - 2 * q) / (1 - q)
        found[f"nu_{place}"], found[f"young_{place}"] = nu, 2 * (1 - nu * nu) * young
        found[f"tangential_{place}"] = 2 * math.sqrt(shear / young)
    return found


def contact(values, place, case):
    """A contact in the words of LAMMPS. The dashpot knows the mass of the body, the lever arm is that of the sphere."""
    e, roll = values[f"e_{place}"], values[f"roll_{place}"] * cases.lever_over_radius(case, values)
    if case.has_clumps and not cases.is_raw():
        share = 0.5 if values["sphere_mass"] else 1.0
        e = cases.body_restitution(e, share)
    words = (f"hertz/material {values[f'young_{place}']!r} {e!r} {values[f'nu_{place}']!r} "
             f"tangential {values.get('history', 'mindlin')} NULL {values.get(f'tangential_{place}', 1.0)!r} {values[f'mu_{place}']!r} "
             "damping coeff_restitution")
    if roll > 0.0:
        # So stiff a spring that it is at its limit at once, and stable at this time step.
        mass = 4 / 3 * math.pi * values["radius"] ** 3 * values["density"]
        words += f" rolling sds {0.04 * mass / case.step ** 2!r} 0.0 {roll!r}"
    return words + (" limit_damping" if values["clipped"] else "")


def deck(case, values):
    """Input script and data of a case."""
    radius = values["radius"]
    clumps = case.has_clumps
    data = cases.data(case, values, types=1)
    if clumps:
        # Body and shape of each sphere; the bodies are in a file of their own.
        atoms = [f"{n} 1 {s['x_m']!r} {s['y_m']!r} {s['z_m']!r} {2 * radius!r} {values['density']!r} {s['body']:.0f}" for n, s in enumerate(case.spheres, 1)]
        data = data[:data.index("Atoms")] + ["Atoms # hybrid", ""] + atoms
    g = math.hypot(*case.gravity)
    direction = [c / g for c in case.gravity] if g else [0, -1, 0]
    script = ["units si", f"atom_style {'hybrid sphere molecular' if clumps else 'sphere'}", "atom_modify map array",
              "boundary f f f", "newton off", f"comm_modify vel yes cutoff {8 * radius!r}", f"read_data {case.name}.data",
              f"neighbor {0.5 * radius!r} bin", "neigh_modify delay 0 every 1 check yes" + (" exclude molecule/intra all" if clumps else ""),
              f"timestep {case.step!r}", "pair_style granular", f"pair_coeff * * {contact(values, 'grains', case)}",
              f"fix weight all gravity {g!r} vector {' '.join(map(repr, direction))}" + (" disable" if clumps else ""),
              f"fix motion all rigid/small molecule infile {case.name}.bodies gravity weight" if clumps else "fix motion all nve/sphere"]
    for number, wall in enumerate(case.walls):
        axis = max(range(3), key=lambda k: abs(wall[f"normal_{'xyz'[k]}"]))
        place = repr(wall[f"{'xyz'[axis]}_m"])
        sides = f"{place} NULL" if wall[f"normal_{'xyz'[axis]}"] > 0 else f"NULL {place}"
        script.append(f"fix wall{number} all wall/gran granular {contact(values, 'wall', case)} {'xyz'[axis]}plane {sides}")
    names = ["x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz"]
    if case.is_packing:
        dump = [f"dump end all custom {case.steps()[0]} {case.name}.dump x y z", "dump_modify end format float %.12g first no"]
        script += dump + [f"run {case.steps()[0]}"]
    else:
        if clumps:
            script.append("compute body all rigid/local motion " + " ".join(names))
            script += [f"compute {name} all reduce sum c_body[{k}] inputs local" for k, name in enumerate(names, 1)]
        else:
            script += ["group first id 1", "compute motion first property/atom " + " ".join(names)]
            script += [f"compute {name} first reduce sum c_motion[{k}]" for k, name in enumerate(names, 1)]
        script += ["thermo_style custom step " + " ".join(f"c_{name}" for name in names), "thermo_modify format float %.14g"]
        for n in case.steps():
            script += [f"thermo {n}", f"run {n}"]
            script.append("print 'STATE " + " ".join(f"$(c_{name}:%.14g)" for name in names) + "'")
    bodies = [str(len(case.bodies))]
    for b in case.bodies:
        i = [b[f"inertia_{k}_kg_m2"] for k in ("xx", "yy", "zz", "xy", "xz", "yz")]
        w = [b[f"spin_{a}_rad_s"] for a in "xyz"]
        l = [i[0] * w[0] + i[3] * w[1] + i[4] * w[2], i[3] * w[0] + i[1] * w[1] + i[5] * w[2], i[4] * w[0] + i[5] * w[1] + i[2] * w[2]]
        rest = [b["mass_kg"]] + [b[f"{a}_m"] for a in "xyz"] + i + [b[f"velocity_{a}_m_s"] for a in "xyz"] + l
        bodies.append(" ".join([f"{b['body']:.0f}"] + [repr(x) for x in rest] + ["0 0 0"]))
    files = {f"in.{case.name}": script, f"{case.name}.data": data}
    return files | ({f"{case.name}.bodies": bodies} if clumps else {})


def run(case, values):
    for name, lines in deck(case, values).items():
        with open(name, "w") as file:
            file.write("\n".join(lines) + "\n")
    program = os.environ.get("LAMMPS", "lmp")
    done = subprocess.run([program, "-in", f"in.{case.name}", "-log", "none"], capture_output=True, text=True)
    if done.returncode or "ERROR" in done.stdout:
        raise SystemExit(f"LAMMPS stopped in {case.name}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    if case.is_packing:
        with open(f"{case.name}.dump") as file:
            frame = file.read().rsplit("ITEM: ATOMS x y z", 1)[1]
        centres = [[float(x) for x in line.split()] for line in frame.strip().splitlines()]
        return cases.read_packing(case, centres, values["radius"])
    states = [[float(x) for x in line.split()[1:]] for line in done.stdout.splitlines() if line.startswith("STATE ")]
    return [cases.component(case, quantity, states) for quantity, _ in case.wanted]


if __name__ == "__main__":
    raw, changes = cases.settings()
    if any(raw[f"{what}_{place}"] for what in ("attraction", "cohesion") for place in ("grains", "wall")):
        raise SystemExit("LAMMPS has neither a constant attraction nor one by the area of contact: calibrate without cohesion")
    values = cases.with_changes(raw if cases.is_raw() else converted(raw), changes)
    cases.write_results([(case, run(case, values)) for case in cases.chosen()])
