"""Each preset of fixtures/benches with its spheres and with spheres of 0.7 of their size, as much of them: a table of means with
standard errors. RUNS (2) starts of each; finished runs in FOLDER are found again."""

import re

from runs import FIXTURES, folder_and_runs, mean_and_error, program, run, steady, table, values

SMALLER = 0.7
# Observables that a size of the spheres may change, or must not.
PRESETS = {
    "hopper": ["mass_flow_g_s", "bottom_load_share"],
    "draw-down": ["shear_angle_deg", "angle_of_repose_deg", "mass_flow_g_s", "discharged_share"],
    "ledge": ["angle_of_repose_deg", "discharged_share"],
    "bulk-density": ["bulk_density_kg_m3", "hausner_ratio"],
    "poured-heap": ["angle_by_position_deg", "height_mm", "heap_mass_g"],
    "compression": ["strain", "loading_modulus_kpa", "wall_stress_ratio"],
    "direct-shear": ["peak_shear_stress_kpa", "steady_stress_ratio"],
    "penetration": ["penetration_force_n", "penetration_energy_mj"],
}


def sized(preset, size):
    """Settings of a preset with spheres of a size over its own, and the same mass of them."""
    text = (FIXTURES / "benches" / f"{preset}.toml").read_text()
    diameter = float(re.search(r'^sphere = "([\d.]+) mm"', text, re.M)[1])
    count = int(re.search(r"^count = (\d+)", text, re.M)[1])
    settings = [f"seed.0.sphere={diameter * size} mm", f"seed.0.count={round(count / size**3)}"]
    rate = re.search(r'^insertion_rate = "(\d+) 1/s"', text, re.M)
    return settings + ([f"protocol.insertion_rate={float(rate[1]) / size**3} 1/s"] if rate else [])


def main():
    folder, runs = folder_and_runs("out/bench-sizes", 2)
    seedloop = program("seedloop")
    rows = []
    for preset, observables in PRESETS.items():
        scene = FIXTURES / "benches" / f"{preset}.toml"
        seeds = [{"seed": seed} for seed in range(1, runs + 1)]
        own, smaller = (steady(run(seedloop, folder / f"{preset}-{size}", scene, seeds, sized(preset, size))) for size in (1, SMALLER))
        for name in observables:
            rows.append([preset, f"`{name}`", mean_and_error(values(own, name)), mean_and_error(values(smaller, name))])
    table(["bench", "observable", "its spheres", f"{SMALLER} of their size"], rows)


main()
