# Each recipe is a few plain commands, so that everything works without `just` as well. What takes hours, needs other programs, or
# makes a table of the documentation is in trials/.

# Arguments of a recipe reach its command as they were written, with their blanks.
set positional-arguments

# Tools that were installed for this checkout only.
export PATH := justfile_directory() / ".tools/bin" + ":" + env("PATH")

# Where cargo puts programs. The loop is started from there: it ends with 1 for an answer, which `cargo run` would call an error.
programs := env("CARGO_TARGET_DIR", "target") / "release"

[private]
default:
    @just --list

# Check format, lints, and licences of the dependencies.
check:
    cargo fmt --all --check
    cargo clippy --release --workspace --all-targets --locked -- -D warnings
    cargo deny check licenses bans sources

# Run all tests.
test:
    cargo test --release --workspace --locked

# Build the documentation of the crates; a broken link is an error.
docs:
    RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked

# Run all that must pass before a change is merged.
ci:
    bash .ci/run

# Calibrate the cotton seeds on their bench tests, with the drum as the check. Called again after a stop it goes on.
[no-exit-message]
calibrate *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" calibrate fixtures/cotton/study.toml --resume "$@"

# Repeat the published calibration of the cotton seeds at its own levels.
[no-exit-message]
reproduce *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" calibrate fixtures/cotton/published.toml --resume "$@"

# Look for an effect that was hidden in simulated data of the cotton seeds.
[no-exit-message]
blind *ARGS:
    cargo build --release --locked -p seedloop
    @"{{programs}}/seedloop" diagnose fixtures/cotton/blind.toml --resume "$@"

# Ask the loop what measured data sets lack, all of them or those named, and write docs/exam.md (hours). `just exam page`: the page alone.
exam *SETS:
    python3 trials/exam.py "$@"

# Fill a closed mesh with spheres.
fill *ARGS:
    cargo run --release --locked -p seedfill -- "$@"

# Read the angle of repose from photos or frames.
angle *ARGS:
    cargo run --release --locked -p angle-from-image -- "$@"

# Check the solver against mechanics and write docs/verification.md.
verify *ARGS:
    cargo run --release --locked -p seedloop -- verify --out docs/verification.md --force "$@"

# Measure what a step of the solver costs, on the default set of scenes.
bench *ARGS:
    cargo run --release --locked -p benchmark -- "$@"

# Build the Python wheel, for this machine or (`just wheel portable`) for Linux with glibc 2.28 or later, and try it in a fresh environment.
wheel KIND="local":
    bash tools/python/build.sh {{KIND}}
    rm -rf target/wheel/fresh && python3 -m venv target/wheel/fresh
    target/wheel/fresh/bin/pip install --quiet target/wheel/dist/*.whl
    cd target/wheel && fresh/bin/python ../../tools/python/tests/test_seedloop.py

# Build the documentation site into out/site: front page, search, tutorial, how-to, reference, explanation. `python3 -m http.server -d out/site` shows it.
site:
    [ -d .tools/site ] || { python3 -m venv .tools/site && .tools/site/bin/pip install --quiet mkdocs-material; }
    .tools/site/bin/python docs/site/build.py
