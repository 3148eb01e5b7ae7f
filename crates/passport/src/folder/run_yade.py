"""Runs the cases of a passport in YADE and writes RESULTS.csv: yade -n -x run_yade.py [NAME=VALUE ...]

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
    spheres = [utils.sphere([place[f"{a}_m"] for a in "xyz"], values["radius"], material=grain) for place in case.spheres]
    numbers = [O.bodies.appendClumped(spheres)[0]] if case.has_clumps else O.bodies.append(spheres)
    for body, number in zip(case.bodies, numbers):
        state = O.bodies[number].state
        state.vel = [body[f"velocity_{a}_m_s"] for a in "xyz"]
        state.angVel = [body[f"spin_{a}_rad_s"] for a in "xyz"]
        if case.has_clumps:
            turned = state.ori.conjugate() * state.angVel
            state.angMom = state.ori * Vector3(*[i * w for i, w in zip(state.inertia, turned)])
    for plane in case.walls:
        axis = max(range(3), key=lambda k: abs(plane[f"normal_{'xyz'[k]}"]))
        O.bodies.append(utils.wall(plane[f"{'xyz'[axis]}_m"], axis, material=wall))
    pairs = lambda of: MatchMaker(matches=((grain, grain, of("grains")), (grain, wall, of("wall"))))
    angle = lambda place: math.atan(values[f"mu_{place}"])
    mass = 4 / 3 * math.pi * values["radius"] ** 3 * values["density"]
    dashpots = {}
    if cases.is_raw():
        dashpots["en"] = dashpots["es"] = pairs(lambda place: values[f"e_{place}"])
    else:
        # The dashpot knows the mass of the sphere, also in a clump.
        share = case.bodies[0]["mass_kg"] / mass if case.has_clumps and not values["sphere_mass"] else 1.0
        dashpots["betan"] = dashpots["betas"] = pairs(lambda place: math.sqrt(5 / 6 * share) * damping_ratio(values[f"e_{place}"]))
    rolls = values["roll_grains"] + values["roll_wall"] > 0
    # A rolling spring that is at its limit soon, and hardly turns a body in the steps in which nothing limits it: the moment
    # of inertia of a clump is larger, and its spin smaller.
    stiff = 1e-3 if any(case.gravity) else 1e-4 if case.has_clumps else 1e-5
    physics = Ip2_FrictMat_FrictMat_MindlinPhys(frictAngle=pairs(angle), eta=values["roll_grains"],
                                                krot=stiff * mass * (values["radius"] / case.step) ** 2, **dashpots)
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
                 InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], [physics],
                                 [Law2_ScGeom_MindlinPhys_Mindlin(includeMoment=rolls)]),
                 NewtonIntegrator(gravity=case.gravity, damping=0, exactAsphericalRot=True)]
    if rolls and not cases.is_raw():
        # A packing has hundreds of contacts and takes bands a thousand times as wide: a twentieth of the steps will do.
        O.engines += [PyRunner(command="roll()", iterPeriod=20 if case.is_packing else 1)]
    O.dt = case.step


limit_of_walls = 0.0
first_wall = 0


def roll():
    """The limit of rolling has one coefficient for all contacts: those of the wall get theirs. Where the normal force is clipped to zero,
    YADE does not limit the rolling spring: it is released."""
    for contact in O.interactions:
        if contact.isReal:
            if max(contact.id1, contact.id2) >= first_wall:
                contact.phys.maxBendPl = limit_of_walls
            if contact.phys.normalForce.squaredNorm() == 0.0:
                contact.phys.momentBend = Vector3.Zero


def run(case, values):
    global first_wall, limit_of_walls
    first_wall, limit_of_walls = len(case.spheres), values["roll_wall"] * values["radius"] * cases.lever_over_radius(case, values)
    build(case, values)
    states = []
    for n in case.steps():
        O.run(n, True)
        state = O.bodies[len(case.spheres) if case.has_clumps else 0].state
        states.append([*state.pos, *state.vel, *state.angVel])
    if case.is_packing:
        return cases.read_packing(case, [list(O.bodies[k].state.pos) for k in range(len(case.spheres))], values["radius"])
    return [cases.component(case, quantity, states) for quantity, _ in case.wanted]


raw, changes = cases.settings()
values = cases.with_changes(raw if cases.is_raw() else converted(raw), changes)
if any(raw[f"{what}_{place}"] for what in ("attraction", "cohesion") for place in ("grains", "wall")):
    raise SystemExit("this script has no attraction: calibrate without cohesion")
cases.write_results([(case, run(case, values)) for case in cases.chosen()])
