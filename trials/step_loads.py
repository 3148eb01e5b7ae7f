"""What the time step does where something else than weight loads the contacts: attraction, liquid, dashpots of whole bodies, and
large stones that meet fast. RUNS runs (3) of each scene at the step of the rule, half and a quarter of it. Drums are cut short: they
show the direction of the centre of mass after 0.4 s, not a steady state. Finished runs in FOLDER are found again.
"""

from runs import FIXTURES, folder_and_runs, mean_and_error, of, program, run, table, values

DEFAULT = 0.36  # of protocol.step_share
PARTS = (1.0, 0.5, 0.25)
HEAP = ("angle_of_repose_deg", "base_radius_mm", "height_mm")
DRUM = ("centre_of_mass_deg",)
# A small and thin drum of the cotton study, cut short.
SHORT = ["apparatus.inner_diameter=100 mm", "apparatus.width=12 mm", "seed.0.count=141", "seed.1.count=19",
         "protocol.rotation_limit=0.4 s", "protocol.frames=2", "protocol.frame_interval=0.1 s"]

PEAS = """
[apparatus]
kind = "heap"
inner_diameter = "40 mm"
height = "80 mm"
lift_speed = "50 mm/s"
floor = "wall"
cylinder = "wall"
[[seed]]
name = "pea"
sphere = "4 mm"
density = "1250 kg/m3"
count = 600
material = "pea"
[material]
pea = { poisson_ratio = 0.3, shear_modulus = "2 MPa" }
wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
[contact]
pea-pea = { restitution = 0.3, static_friction = 0.6, rolling_friction = 0.3 }
pea-wall = { restitution = 0.3, static_friction = 0.2, rolling_friction = 0.1 }
[protocol]
rotation_limit = "4 s"
"""

# Overlapping spheres that meet at up to 4 m/s.
STONES = """
[apparatus]
kind = "drum"
inner_diameter = "800 mm"
width = "300 mm"
speed = "10 rpm"
shell = "steel"
cover = "steel"
[[seed]]
name = "stone"
ellipsoid = ["80 mm", "56 mm", "48 mm"]
density = "2600 kg/m3"
count = 250
material = "stone"
filling = { method = "surface", sphere_count = 60, sphere_radius = "1 mm", seed = 1 }
[material]
stone = { poisson_ratio = 0.25, shear_modulus = "10 MPa" }
steel = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
[contact]
stone-stone = { restitution = 0.3, static_friction = 0.6 }
stone-steel = { restitution = 0.3, static_friction = 0.5 }
[protocol]
frames = 2
rotation_limit = "0.4 s"
"""
WET = "[model.liquid]\ncontent = 0.02\nsurface_tension_n_m = 0.07\ncontact_angle = \"0 deg\"\n"

# Name, text of the scene or its file, changes, what is shown; those that cost least first.
SCENES = [
    ("stones", STONES, [], DRUM),
    ("packed seeds, dashpots shared", "drum", [*SHORT, "model.dashpot_mass=shared"], DRUM),
    ("packed seeds, dashpots body", "drum", [*SHORT, "model.dashpot_mass=body"], DRUM),
    ("smooth seeds, dashpots body", "measured", [*SHORT, "model.dashpot_mass=body"], DRUM),
    ("heap, attraction 0", PEAS, [], HEAP),
    ("heap, attraction 1 weight", PEAS, ["contact.pea-pea.attraction_n=0.00041"], HEAP),
    ("heap, attraction 4.9 weights", PEAS, ["contact.pea-pea.attraction_n=0.002"], HEAP),
    ("heap, liquid of 2 %", PEAS + WET, [], HEAP),
]


def main():
    folder, runs = folder_and_runs("out/step-loads", 3)
    seedloop, lines = program("seedloop"), []
    for name, text, changes, shown in SCENES:
        here = folder / name.replace(" ", "-").replace(",", "").replace("%", "percent")
        scene = FIXTURES / f"cotton/{text}.toml"
        if "\n" in text:
            here.mkdir(parents=True, exist_ok=True)
            scene = here / "scene.toml"
            scene.write_text(text)
        shares = [part * DEFAULT for part in PARTS]
        rows = [{"protocol.step_share": share, "protocol.flow_step_share": share, "seed": seed}
                for share in shares for seed in range(1, runs + 1)]
        results = run(seedloop, here, scene, rows, changes)
        parts = [results[k * runs:(k + 1) * runs] for k in range(len(PARTS))]
        for observable in shown:
            cells = [mean_and_error(values(part, observable), 1) + of(len(values(part, observable)), runs) for part in parts]
            lines.append([name, f"`{observable}`", *cells])
    table(["scene", "shown", *map(str, PARTS)], lines)


main()
