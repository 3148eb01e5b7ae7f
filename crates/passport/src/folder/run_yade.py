"""Runs the cases of a passport without clumps in YADE and writes RESULTS.csv: yade -n -x run_yade.py [NAME=VALUE ...]

The law is Law2_ScGeom_MindlinPhys_Mindlin. What is converted is in `converted`; `--raw` leaves it out.
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))
import cases  # noqa: E402
from yade import *  # noqa: E402, F403


def damping_ratio(restitution):
    log = math.log(restitution)
    return -log / math.hypot(log, math.pi)


def converted(values):
    """YADE takes R/2 for the reduced radius at a wall: the wall gets moduli that, mixed with those of the grain, make up for
    sqrt(1/2); that they are negative does no harm. Its lever arm of rolling is the mean radius, between grains twice the reduced one."""
    found = dict(values)
    sides = lambda place: ((1 - values[f"nu_{place}"] ** 2) / values[f"young_{place}"],
                           2 * (1 + values[f"nu_{place}"]) * (2 - values[f"nu_{place}"]) / values[f"young_{place}"])
    grain, wall = sides("grains"), sides("wall")
    x, y = (math.sqrt(0.5) * (g + w) - g for g, w in zip(grain, wall))
    ratio = y / x
    nu = (ratio - 4) / (ratio - 2)
    found["nu_wall"], found["young_wall"] = nu, (1 - nu * nu) / x
    found["roll_grains"] *= 0.5
    return found


def build(case, values):
    """Bodies and engines of a case."""
    O.reset()
    material = lambda place: FrictMat(young=values[f"young_{place}"], poisson=values[f"nu_{place}"],
                                      frictionAngle=math.atan(values[f"mu_{place}"]), density=values["density"])
    grain, wall = O.materials.append(material("grains")), O.materials.append(material("wall"))
    for body, place in zip(case.bodies, case.spheres):
        number = O.bodies.append(utils.sphere([place[f"{a}_m"] for a in "xyz"], values["radius"], material=grain))
        O.bodies[number].state.vel = [body[f"velocity_{a}_m_s"] for a in "xyz"]
        O.bodies[number].state.angVel = [body[f"spin_{a}_rad_s"] for a in "xyz"]
    for plane in case.walls:
        axis = max(range(3), key=lambda k: abs(plane[f"normal_{'xyz'[k]}"]))
        O.bodies.append(utils.wall(plane[f"{'xyz'[axis]}_m"], axis, material=wall))
    pairs = lambda of: MatchMaker(matches=((grain, grain, of("grains")), (grain, wall, of("wall"))))
    angle = lambda place: math.atan(values[f"mu_{place}"])
    dashpots = {}
    if cases.is_raw():
        dashpots["en"] = dashpots["es"] = pairs(lambda place: values[f"e_{place}"])
    else:
        dashpots["betan"] = dashpots["betas"] = pairs(lambda place: math.sqrt(5 / 6) * damping_ratio(values[f"e_{place}"]))
    mass = 4 / 3 * math.pi * values["radius"] ** 3 * values["density"]
    physics = Ip2_FrictMat_FrictMat_MindlinPhys(frictAngle=pairs(angle), eta=values["roll_grains"],
                                                krot=0.01 * mass * (values["radius"] / case.step) ** 2, **dashpots)
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
                 InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], [physics],
                                 [Law2_ScGeom_MindlinPhys_Mindlin(includeMoment=values["roll_grains"] + values["roll_wall"] > 0)]),
                 NewtonIntegrator(gravity=case.gravity, damping=0)]
    if case.walls and not cases.is_raw():
        # The lever arm has one coefficient for all contacts: those of the wall get theirs as they form.
        O.engines += [PyRunner(command="roll_on_walls()", iterPeriod=5)]
    O.dt = case.step


limit_of_walls = 0.0


def roll_on_walls():
    for contact in O.interactions:
        if contact.isReal and (contact.id1 >= n_spheres or contact.id2 >= n_spheres):
            contact.phys.maxBendPl = limit_of_walls


def run(case, values):
    global limit_of_walls, n_spheres
    limit_of_walls, n_spheres = values["roll_wall"] * values["radius"], len(case.spheres)
    build(case, values)
    states = []
    for n in case.steps():
        O.run(n, True)
        state = O.bodies[0].state
        states.append([*state.pos, *state.vel, *state.angVel])
    if case.is_packing:
        return cases.read_packing(case, [list(O.bodies[k].state.pos) for k in range(n_spheres)], values["radius"])
    return [cases.component(case, quantity, states) for quantity, _ in case.wanted]


raw, changes = cases.settings()
values = cases.with_changes(raw if cases.is_raw() else converted(raw), changes)
chosen = [case for case in cases.chosen() if not case.has_clumps]
if any(raw[f"{what}_{place}"] for what in ("attraction", "cohesion") for place in ("grains", "wall")):
    raise SystemExit("this script has no attraction: calibrate without cohesion")
cases.write_results([(case, run(case, values)) for case in chosen])
