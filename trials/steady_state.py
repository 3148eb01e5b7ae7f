"""Whether the standard error that a run states is the scatter of many runs: 320 seeds of the cotton study in a drum of 100 mm,
RUNS runs (20) at each of four frictions and three speeds. Finished runs in FOLDER are found again.
"""

import math
import statistics

from runs import FIXTURES, SMALL_DRUM, folder_and_runs, mean_and_error, program, run, steady, table, values

FRICTION = "contact.seed-seed.static_friction"
# The longer step of the drum does not hold at 40 rpm.
FLOW_STEP = "protocol.flow_step_share=0.36"


def main():
    folder, runs = folder_and_runs("out/steady-state", 20)
    cells = [(friction, rpm) for friction in (0.0, 0.1, 0.33, 0.56) for rpm in (10, 20, 40)]
    rows = [{FRICTION: friction, "rpm": rpm, "seed": seed} for friction, rpm in cells for seed in range(1, runs + 1)]
    results = run(program("seedloop"), folder, FIXTURES / "cotton/drum.toml", rows, [*SMALL_DRUM, FLOW_STEP])
    lines, scatters, squares = [], [], []
    for friction, rpm in cells:
        here = steady(row for row in results if (float(row[FRICTION]), float(row["rpm"])) == (friction, rpm))
        angles = values(here, "angle_deg")
        scatter = statistics.variance(angles)
        square = statistics.fmean(error**2 for error in values(here, "standard_error_deg"))
        scatters.append(scatter)
        squares.append(square)
        lines.append([str(friction), str(rpm), f"{len(here)} of {runs}", mean_and_error(angles), f"{math.sqrt(scatter):.3f}",
                      f"{math.sqrt(square):.3f}", f"{math.sqrt(square / scatter):.2f}"])
    table(["friction", "rpm", "steady", "angle, deg", "scatter of runs, deg", "error stated, deg", "ratio"], lines)
    print(f"Stated over scatter, all together: {math.sqrt(sum(squares) / sum(scatters)):.2f}.")


main()
