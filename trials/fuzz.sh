#!/usr/bin/env bash
# Gives a reader of files inputs that a coverage-guided fuzzer makes: trials/fuzz.sh READER [SECONDS]
# READER: mesh, obj, spheres, picture, scene, study, table, workbook, problem, positions, passport, record, state or quantity.
# Finds go to out/fuzz/READER.
set -euo pipefail
cd "$(dirname "$0")/.."
reader=${1:?READER is missing}
cover=-Cllvm-args=-sanitizer-coverage
RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module $cover-level=4 $cover-inline-8bit-counters $cover-pc-table $cover-trace-compares" \
    cargo build --release --locked --manifest-path tools/fuzz/Cargo.toml --target x86_64-unknown-linux-gnu --target-dir target/fuzz
mkdir -p "out/fuzz/$reader/inputs"
READER=$reader TMPDIR=/dev/shm target/fuzz/x86_64-unknown-linux-gnu/release/fuzz -max_total_time="${2:-60}" -timeout=10 \
    -rss_limit_mb=4096 -artifact_prefix="out/fuzz/$reader/" "out/fuzz/$reader/inputs" "tools/fuzz/seeds/$reader"
