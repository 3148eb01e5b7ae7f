"""The restitution that cotton seeds show when they drop on both resins and on seeds, with none to all of the damping of the whole
seed: FOLDER (out/drops), one run of 40 drops each (minutes).
"""

from runs import FIXTURES, folder_and_runs, program, run, table

DAMPING = "model.whole_seed_damping"


def main():
    folder, runs = folder_and_runs("out/drops", 1)
    shares = (0, 0.25, 0.5, 0.75, 1)
    rows = [{"apparatus.plate": plate, DAMPING: share, "seed": seed}
            for plate in ("tough_resin", "clear_resin", "seed") for share in shares for seed in range(1, runs + 1)]
    results = run(program("seedloop"), folder, FIXTURES / "cotton/drop.toml", rows)
    table(["plate", "damping", "seed", "restitution"],
          [[row["apparatus.plate"], row[DAMPING], row["seed"], f"{float(row['shown_restitution']):.3f}"] for row in results])


main()
