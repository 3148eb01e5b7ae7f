# What both tests need: a Slurm of this test alone, and the stand-in simulator. Read by bash, not run.

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../../.." && pwd)
stand_in=${CARGO_TARGET_DIR:-$root/target}/release/examples/stand_in
[ -x "$stand_in" ] || { echo "build it first: cargo build --release -p batch-runner --examples" >&2; exit 2; }

work=$(mktemp -d)
chmod 755 "$work" # munged wants its socket to be reachable
# A copy, so that a build beside the test does not change the workers under it.
cp "$stand_in" "$work/stand_in"
stand_in=$work/stand_in
export SLURM_DEV_DIR=$work/slurm SLURM_DEV_PORT=${SLURM_DEV_PORT:-17117} SLURM_DEV_TIMEOUT=20
# Tasks need next to nothing, and the pretended processors must not run out of memory.
export SLURM_DEV_MEM=${SLURM_DEV_MEM:-4096}
slurm=$here/start-slurm.sh

# Stops what was started and removes what was written; the notes of a failed test stay.
finish() {
    local code=$?
    "$slurm" purge 2> /dev/null || true
    if [ "$code" = 0 ]; then rm -rf -- "$work"; else echo "files are kept in $work" >&2; fi
}
trap finish EXIT

"$slurm" install_if_missing
"$slurm" start
eval "$("$slurm" env)"
