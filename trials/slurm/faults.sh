#!/usr/bin/env bash
# Calibrates the study of fixtures/command-example by a job array on a real Slurm of four pretended processors. While it goes
# on, tasks are killed and cancelled, the node is drained, set down and resumed, the controller is restarted, and the submitting
# command is killed. At the end no run may be missing, none may have been begun again without a loss, and the result must be
# that of one process alone. Two minutes. Prints a table of faults and what became of them.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
cargo build --release --locked --manifest-path "$root/Cargo.toml" -p seedloop

work=$(mktemp -d)
chmod 755 "$work" # munged wants its socket to be reachable
# A copy, so that a build beside the test does not change the program under it.
cp "${CARGO_TARGET_DIR:-$root/target}/release/seedloop" "$work"
mkdir "$work/mill"
cp "$root/fixtures/command-example/study.toml" "$root/crates/study/src/init/cluster.sh" "$work"
cp "$root/fixtures/command-example/mill/run.py" "$work/mill/model.py"
cp "$here/run.py" "$work/mill"

export SLURM_DEV_CPUS=4 SLURM_DEV_MEM=10000 SLURM_DEV_TIMEOUT=20
export SLURM_DEV_DIR=$work/slurm SLURM_DEV_PORT=${SLURM_DEV_PORT:-17117}
slurm=$here/start-slurm.sh

# Stops what was started and removes what was written; the files of a failed test stay.
finish() {
    local code=$?
    "$slurm" purge 2> /dev/null || true
    if [ "$code" = 0 ]; then rm -rf -- "$work"; else echo "files are kept in $work" >&2; fi
}
trap finish EXIT

"$slurm" install_if_missing
cd "$work"
NOTES=$work/notes-of-one ./seedloop calibrate study.toml --threads 4 --quiet --out one > /dev/null

"$slurm" start
eval "$("$slurm" env)"
export NOTES=$work/notes PATH=$work:$PATH
count() { { cat notes 2> /dev/null || true; } | grep -c "^$1" || true; }
until_ended() {
    for _ in $(seq 1200); do
        [ "$(count ended)" -lt "$1" ] || return 0
        sleep 0.1
    done
    echo "only $(count ended) runs after two minutes" >&2
    exit 1
}
running() { squeue --noheader --array --states=R --format=%F_%K; }
killed=0
lose() { killed=$((killed + $1)); }
row() { rows+="| $1 | $2 |"$'\n'; }
rows=

# More tasks than processors: a task that is lost makes room for the next.
sbatch --wait --array=1-8 cluster.sh > /dev/null &
submitter=$!
until_ended 8
task=$(running | head -n 1)
scancel --signal=KILL --full "$task"
lose 1
row "task killed with all its processes (SIGKILL)" "task $task lost its run"

until_ended 16
kill -9 "$(awk '/^began/ {pid = $3} END {print pid}' notes)" 2> /dev/null || true
lose 1
row "seedloop alone killed (SIGKILL)" "the program that it had started ended with it"

until_ended 24
task=$(running | head -n 1)
scancel "$task"
lose 1
row "task cancelled" "task $task gave its run back"

until_ended 32
kill -9 "$submitter"
wait "$submitter" 2> /dev/null || true
row "\`sbatch --wait\` killed (SIGKILL)" "$(running | wc -l) tasks went on"

until_ended 40
scontrol update NodeName=node1 State=DRAIN Reason=test
sleep 4
scontrol update NodeName=node1 State=RESUME
row "node drained for 4 s, then resumed" "running tasks went on"

until_ended 52
kill "$(cat "$SLURM_DEV_DIR/slurmctld.pid")"
while [ -e "/proc/$(cat "$SLURM_DEV_DIR/slurmctld.pid" 2> /dev/null || echo none)" ]; do sleep 0.1; done
sleep 5
slurmctld -f "$SLURM_CONF"
row "controller stopped, started again after 5 s" "tasks went on"

until_ended 64
lose "$(running | wc -l)"
scontrol update NodeName=node1 State=DOWN Reason=test
sleep 2
# It may have come back by itself.
scontrol update NodeName=node1 State=RESUME 2> /dev/null || true
row "node set down with all its tasks, back after 2 s" "Slurm requeued them"

until_ended 80
lose "$(running | wc -l)"
scancel --me
sleep 2
sbatch --wait --array=1-4 cluster.sh > /dev/null || true
row "all tasks cancelled, the array submitted again" "it found the finished runs"

runs=$(find one/runs -name '*.json' | wc -l)
lost=$((runs - $(find out/runs -name '*.json' | wc -l)))
again=$(awk '/^began/ {n[$2]++} END {for (key in n) {again += n[key] - 1} print again + 0}' notes)
same=$(python3 - << 'COMPARE'
import json
one, out = (json.load(open(f"{folder}/result.json")) for folder in ("one", "out"))
print("yes" if {**one, "cost": 0} == {**out, "cost": 0} else "no")
COMPARE
)
printf '| fault | what became of it |\n|---|---|\n%s\n' "$rows"
printf '| outcome | |\n|---|---:|\n'
printf '| runs of one process alone | %d |\n' "$runs"
printf '| runs without a record | %d |\n' "$lost"
printf '| runs begun again, of at most %d that were broken off | %d |\n' "$killed" "$again"
printf '| runs begun though their record was there | %d |\n' "$(count needless)"
printf '| same result | %s |\n' "$same"
[ "$lost $(count needless) $same" = "0 0 yes" ] && [ "$again" -le "$killed" ]
