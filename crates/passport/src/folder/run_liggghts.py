"""Runs the cases of a passport in LIGGGHTS 3.8 and writes RESULTS.csv: python3 run_liggghts.py [NAME=VALUE ...]

The program is `liggghts`, or that of the variable LIGGGHTS. What is converted: the restitution of clumps whose dashpots know the mass of a
sphere, the rolling coefficient of clumps with the lever arm of the body, and the end of the normal force. `--raw` leaves it out.
"""

import math
import os
import subprocess

import cases


def laws(values, case):
    """Properties of the materials, the model, and its settings behind the shape of a wall."""
    factor = cases.lever_over_radius(case, values)
    share = 0.5 if case.has_clumps and values["sphere_mass"] and not cases.is_raw() else 1.0
    restitution = lambda place: cases.body_restitution(values[f"e_{place}"], share)
    pairs = lambda of: " ".join(repr(of(place)) for place in ("grains", "wall", "wall", "wall"))
    both = lambda name: f"{values[f'{name}_grains']!r} {values[f'{name}_wall']!r}"
    model, settings = "hertz tangential " + values.get("history", "history"), ""
    lines = [f"fix young all property/global youngsModulus peratomtype {both('young')}",
             f"fix poisson all property/global poissonsRatio peratomtype {both('nu')}",
             f"fix restitution all property/global coefficientRestitution peratomtypepair 2 {pairs(restitution)}",
             f"fix friction all property/global coefficientFriction peratomtypepair 2 {pairs(lambda p: values[f'mu_{p}'])}",
             f"fix rolling all property/global coefficientRollingFriction peratomtypepair 2 {pairs(lambda p: factor * values[f'roll_{p}'])}"]
    if values["cohesion_grains"] or values["cohesion_wall"]:
        model += " cohesion sjkr"
        lines.append(f"fix cohesion all property/global cohesionEnergyDensity peratomtypepair 2 {pairs(lambda p: values[f'cohesion_{p}'])}")
    if values["roll_grains"] or values["roll_wall"]:
        model, settings = model + " rolling_friction cdt", " torsionTorque on"
    if values["clipped"] and not cases.is_raw():
        settings += " limitForce on"
    return lines, model, settings


def deck(case, values, shift=(0.0, 0.0, 0.0)):
    """Input script and files of a case, whose clump is put where it is meant less a shift."""
    radius = values["radius"]
    lines, model, settings = laws(values, case)
    g = math.hypot(*case.gravity)
    direction = [c / g for c in case.gravity] if g else [0, -1, 0]
    files = {}
    if case.has_clumps:
        body = case.bodies[0]
        centre = [body[f"{a}_m"] for a in "xyz"]
        place = [c - s for c, s in zip(centre, shift)]
        files["clump.spheres"] = [" ".join(repr(s[f"{a}_m"] - c) for a, c in zip("xyz", centre)) + f" {radius!r}" for s in case.spheres]
        edges = " ".join(f"{c - 1e-10:.12f} {c + 1e-10:.12f}" for c in place)
        motion = [" ".join(repr(body[f"{what}_{a}_{unit}"]) for a in "xyz") for what, unit in (("velocity", "m_s"), ("spin", "rad_s"))]
        inertia = " ".join(repr(body[f"inertia_{k}_kg_m2"]) for k in ("xx", "xy", "xz", "yy", "yz", "zz"))
        start = [f"fix clump all particletemplate/multisphere 10007 atom_type 1 density constant {values['density']!r} nspheres {len(case.spheres)} "
                 f"ntry 1000000 spheres file clump.spheres scale 1.0 type 1 mass {body['mass_kg']!r} inertia_tensor {inertia} use_volume",
                 "fix kind all particledistribution/discrete 10009 1 clump 1.0",
                 f"region place block {edges} units box volume_limit 1e-30",
                 f"fix put all insert/pack seed 10037 distributiontemplate kind insert_every once overlapcheck no all_in no vel constant {motion[0]} "
                 f"omega constant {motion[1]} orientation constant 1 0 0 0 particles_in_region 1 region place ntry_mc 1000",
                 "fix motion all multisphere allow_group_and_set yes", "run 1", *written("start"), "unfix put", "region place delete"]
        box = ["region box block " + " ".join(f"{low!r} {high!r}" for low, high in cases.domain(radius)) + " units box", "create_box 2 box"]
    else:
        files[f"{case.name}.data"] = cases.data(case, values, types=2)
        start, box = ["fix motion all nve/sphere"], [f"read_data {case.name}.data"]
    script = ["units si", "atom_style granular", "atom_modify map array", "boundary f f f", "newton off", "communicate single vel yes",
              "hard_particles yes", "soft_particles yes", *box, f"neighbor {0.5 * radius!r} bin", "neigh_modify delay 0", *lines,
              f"pair_style gran model {model}{settings}", "pair_coeff * *", f"timestep {case.step!r}",
              f"fix weight all gravity {g!r} vector {' '.join(map(repr, direction))}"]
    for number, wall in enumerate(case.walls):
        axis = max(range(3), key=lambda k: abs(wall[f"normal_{'xyz'[k]}"]))
        script.append(f"fix wall{number} all wall/gran model {model} primitive type 2 {'xyz'[axis]}plane {wall[f'''{'xyz'[axis]}_m''']!r}{settings}")
    script += start + ["thermo 1000000000"]
    for number, n in enumerate(case.steps(), 1):
        script += [f"run {n}", *written(f"{case.name}.t{number}")]
    files[f"in.{case.name}"] = script
    return files


def written(file):
    """Commands that write down all spheres."""
    return [f"dump state all custom 1 {file} id x y z vx vy vz omegax omegay omegaz", 'dump_modify state sort id format "%d' + " %.12g" * 9 + '"',
            "run 0", "undump state"]


def spheres_in(file):
    """Numbers of the spheres in a file."""
    with open(file) as text:
        frame = text.read().rsplit("ITEM: ATOMS", 1)[1].strip().splitlines()[1:]
    return [[float(x) for x in line.split()[1:]] for line in frame]


def shift_of_clump(case):
    """LIGGGHTS finds the centre of a clump by drawn points and puts that where it is told, a thousandth of its size beside the true one."""
    spheres = spheres_in("start")
    return [sum(sphere[k] for sphere in spheres) / len(spheres) - case.bodies[0][f"{a}_m"] for k, a in enumerate("xyz")]


def execute(case, files):
    for name, lines in files.items():
        with open(name, "w") as file:
            file.write("\n".join(lines) + "\n")
    done = subprocess.run([os.environ.get("LIGGGHTS", "liggghts"), "-in", f"in.{case.name}"], capture_output=True, text=True)
    if done.returncode or "ERROR" in done.stdout:
        raise SystemExit(f"LIGGGHTS stopped in {case.name}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def run(case, values):
    execute(case, deck(case, values))
    if case.has_clumps:
        execute(case, deck(case, values, shift_of_clump(case)))
    states = [spheres_in(f"{case.name}.t{number}") for number in range(1, len(case.times) + 1)]
    if case.is_packing:
        return cases.read_packing(case, [atom[:3] for atom in states[-1]], values["radius"])
    # The spheres of a clump are equal, so that its motion is their mean.
    n = len(case.spheres) if case.has_clumps else 1
    means = [[sum(atom[k] for atom in state[:n]) / n for k in range(9)] for state in states]
    return [cases.component(case, quantity, means) for quantity, _ in case.wanted]


if __name__ == "__main__":
    raw, changes = cases.settings()
    values = cases.with_changes(raw, changes)
    if values["spring"] or values["attraction_grains"] or values["attraction_wall"]:
        raise SystemExit("LIGGGHTS has neither this rolling resistance of type C nor a constant attraction: calibrate with constant-torque and cohesion_energy_density_j_m3")
    cases.write_results([(case, run(case, values)) for case in cases.chosen()])
