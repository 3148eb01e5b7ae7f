#!/usr/bin/env bash
# Builds the wheel into target/wheel/dist, by cargo and maturin in a virtual environment of its own. With the argument
# `portable` it is built against glibc 2.28, so that it installs on Linux distributions of 2018 and later (manylinux).
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
wheel=$root/target/wheel
[ -x "$wheel/venv/bin/python" ] || python3 -m venv "$wheel/venv"
"$wheel/venv/bin/pip" install --quiet 'maturin>=1.9,<2'
export PATH="$wheel/venv/bin:$PATH"
rm -rf "$wheel/seedloop.data" "$wheel/dist"
mkdir -p "$wheel/seedloop.data/scripts"
if [ "${1:-}" = portable ]; then
    pip install --quiet cargo-zigbuild ziglang
    triple=x86_64-unknown-linux-gnu
    cargo zigbuild --release --locked --manifest-path "$root/Cargo.toml" -p seedfill -p angle-from-image \
        --target "$triple.2.28"
    built=$target/$triple/release
    options=(--zig --target "$triple" --compatibility manylinux_2_28)
else
    cargo build --release --locked --manifest-path "$root/Cargo.toml" -p seedfill -p angle-from-image
    built=$target/release
    options=(--compatibility linux)
fi
cp "$built/seedfill" "$built/angle-from-image" "$wheel/seedloop.data/scripts/"
strip "$wheel"/seedloop.data/scripts/*
maturin build --release --strip --out "$wheel/dist" "${options[@]}"
