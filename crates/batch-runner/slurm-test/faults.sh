#!/usr/bin/env bash
# A campaign of 200 runs of 0.2 s on a real Slurm of four pretended processors. While it goes on, workers are killed, a
# node is drained and resumed, the daemon of the node dies, the controller is restarted, and the submitting process is
# killed and started again. At the end no run may be missing, none may have been repeated after it was finished, and
# the records must be those of a local campaign. About a minute. Prints a table of faults and what became of them.
set -euo pipefail
export SLURM_DEV_CPUS=4
# shellcheck source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

runs=200
out=$work/out
cat > "$work/settings.json" << 'SETTINGS'
{"seconds_per_cost": 1.0, "task_seconds": 1.5, "least_task_seconds": 0.5, "retries": 3,
 "poll_s": 0.2, "poll_most_s": 0.5, "state_interval_s": 1, "file_latency_s": 2, "heartbeat_s": 1,
 "command_limit_s": 30, "patience_s": 120}
SETTINGS
ended() { { cat "$out/notes" 2> /dev/null || true; } | grep -c '^ended' || true; }
submissions() { ls "$out"/batch/tasks/*.sh 2> /dev/null | wc -l; }
start() {
    "$stand_in" run slurm "$out" "$runs" 0.2 4 "$work/settings.json" >> "$work/result" 2>> "$work/log" &
    submitter=$!
}
until_ended() {
    for _ in $(seq 1200); do
        [ "$(ended)" -lt "$1" ] || return 0
        sleep 0.1
    done
    echo "only $(ended) runs after two minutes" >&2
    exit 1
}
running() { squeue --noheader --array --states=R --format=%F_%K "$@"; }
row() { rows+="| $1 | $2 |"$'\n'; }
rows=

start
until_ended 10
# Killed with its children, so that the script leaves no code either.
killed=$(running | head -n 1)
scancel --signal=KILL --full "$killed"
row "script and worker of a task killed (SIGKILL)" "task $killed"

until_ended 30
pid=$(awk '/^began/ {pid = $3} END {print pid}' "$out/notes")
kill -9 "$pid"
row "worker alone killed (SIGKILL)" "process of the run begun last"

until_ended 45
cancelled=$(running | head -n 1)
scancel "$cancelled"
row "task cancelled by hand" "task $cancelled"

until_ended 60
before=$(submissions)
kill -9 "$submitter"
wait "$submitter" 2> /dev/null || true
sleep 1
start
row "submitting process killed (SIGKILL), started again after 1 s" "attached; arrays submitted by it for living tasks: $(($(submissions) - before))"

until_ended 75
scontrol update NodeName=node1 State=DRAIN Reason=test
sleep 4
scontrol update NodeName=node1 State=RESUME
row "node drained for 4 s, then resumed" "running tasks went on"

until_ended 100
kill "$(cat "$SLURM_DEV_DIR/slurmctld.pid")"
while [ -e "/proc/$(cat "$SLURM_DEV_DIR/slurmctld.pid" 2> /dev/null || echo none)" ]; do sleep 0.1; done
sleep 5
slurmctld -f "$SLURM_CONF"
row "controller stopped, started again after 5 s" "tasks went on"

until_ended 130
scontrol update NodeName=node1 State=DOWN Reason=test
sleep 2
# It may have come back by itself.
scontrol update NodeName=node1 State=RESUME 2> /dev/null || true
row "node set down with all its tasks, back after 2 s" "its tasks were lost and submitted again"

until_ended 150
kill -9 "$submitter"
wait "$submitter" 2> /dev/null || true
scancel --me
sleep 2
start
row "submitting process killed, all its jobs cancelled, started again" "what was left was submitted again"

wait "$submitter"

# The outcome.
"$stand_in" run local "$work/local" "$runs" 0 4 > /dev/null
awk '/^began/ {began[$2]++} /^ended/ {ended[$2]++} /^needless/ {needless++} END {
    for (key in began) {if (began[key] > 1) {repeated++}}
    for (key in ended) {done++}
    print done + 0, repeated + 0, needless + 0
}' "$out/notes" > "$work/counts"
read -r done repeated needless < "$work/counts"
kept=$(ls "$out/runs" | wc -l)
lost=$((runs - kept))
# The local campaign sleeps for another time, which is a condition of its runs: only the results are compared.
values() { grep -h '"mean"\|"x"' "$1"/runs/*.json | paste - - | tr -d ' ,' | sort; }
same=no
[ "$(values "$out")" != "$(values "$work/local")" ] || same=yes

printf '| fault | what it met |\n|---|---|\n%s\n' "$rows"
printf '| outcome | |\n|---|---:|\n'
printf '| runs asked for | %d |\n' "$runs"
printf '| runs without a record | %d |\n' "$lost"
printf '| runs begun again after a loss | %d |\n' "$repeated"
printf '| runs begun though their record was there | %d |\n' "$needless"
printf '| same results as a local campaign | %s |\n' "$same"
printf '| arrays submitted | %d |\n\n' "$(submissions)"
cat "$work/log" >&2
[ "$lost $needless $same $done" = "0 0 yes $runs" ]
