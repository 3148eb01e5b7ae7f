#!/usr/bin/env bash
# Checks that take minutes to hours, by tests that `just test` leaves out: trials/checks.sh NAME
set -euo pipefail
cd "$(dirname "$0")/.."

# Runs the ignored tests of a package whose names hold a word.
ignored() { cargo test --release --locked -p "$1" "${@:3}" "$2" -- --ignored --nocapture; }

# Calibrates a study of benches; it ends with 1 if it is open, which is an answer.
calibrated() {
    cargo build --release --locked -p seedloop
    "${CARGO_TARGET_DIR:-target}/release/seedloop" calibrate "$1" --out "$2" --resume || [ $? = 1 ]
}

case ${1:-} in
    frictions)
        calibrated fixtures/benches/study.toml out/frictions
        calibrated fixtures/benches/joint.toml out/frictions-joint ;;
    benches) ignored scene benches --test suite && ignored scene machine --test suite && ignored scene periodic --test suite ;;
    camera-faults) ignored scene camera_faults --test suite ;;
    diagnosis-rates) ignored inference table_of_rates --test diagnosis ;;
    divergence) ignored simulators divergence --test scene_simulator ;;
    drawn-studies) ignored inference table_of_drawn --test whole_loop ;;
    fuzz-meshes) ignored trimesh mutated --test suite ;;
    fuzz-photos) ignored photo-profile mutated_files --test suite ;;
    name-campaigns) ignored inference rates_of_ --lib ;;
    next-measurements) ignored inference table_of_next --test diagnosis ;;
    null-campaigns) ignored inference without_a_hidden_effect --lib ;;
    passport) ignored passport convention --lib ;;
    two-rulers) ignored scene two_rulers --test suite ;;
    *) sed -n 's/^    \([a-z-]*\)).*/\1/p' "$0" >&2; exit 2 ;;
esac
