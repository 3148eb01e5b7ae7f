#!/usr/bin/env bash
# Measures what a run costs beside its own time on each runner, and how a campaign scales from 1 to 16 workers, with
# runs that sleep: on threads, on a real Slurm of 16 pretended processors, and on background processes as a batch
# system of command lines. About ten minutes. Prints two tables.
set -euo pipefail
export SLURM_DEV_CPUS=16
# shellcheck source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# Settings of one campaign: what a task should last, s. All else is as it is by default, but that tasks may be short.
settings() {
    cat > "$work/$1.json" << SETTINGS
{"seconds_per_cost": 1.0, "task_seconds": $2, "least_task_seconds": 1.0,
 "command": {"submit": "sh {script} < /dev/null > /dev/null 2>&1 & echo \$!",
             "status": "for job in {jobs}; do kill -0 \$job 2> /dev/null && echo \$job running || echo \$job ended; done",
             "cancel": "kill {jobs}"}}
SETTINGS
}
settings packed 600
settings single_1 1
settings single_10 10

# Time of a campaign, s.
timed() { # NAME RUNNER RUNS SLEEP_S WORKERS SETTINGS
    "$stand_in" run "$2" "$work/$1" "$3" "$4" "$5" "$work/$6.json" 2> /dev/null |
        awk '{print $4}' > "$work/$1.time"
}
value() { cat "$work/$1.time"; }

# Long runs: all campaigns at a time, since runs that sleep need no processor.
if [ "${1:-}" = long ]; then
    for workers in 1 2 4 8; do
        timed "local_100_$workers" local 8 100 "$workers" packed &
        timed "slurm_100_$workers" slurm 8 100 "$workers" packed &
    done
    wait
    echo "| workers | 8 runs of 100 s: threads, s | Slurm, s |"
    echo "|---:|---:|---:|"
    for workers in 1 2 4 8; do
        printf '| %d | %.1f | %.1f |\n' "$workers" "$(value "local_100_$workers")" "$(value "slurm_100_$workers")"
    done
    exit
fi

# Threads that sleep disturb nobody: all of these go on beside the others.
for workers in 1 2 4 8 16; do
    timed "local_1_$workers" local 64 1 "$workers" packed &
    timed "local_10_$workers" local 16 10 "$workers" packed &
done
for s in 1 10; do
    runs=$((s == 1 ? 32 : 16))
    timed "over_local_$s" local "$runs" "$s" 4 packed
    timed "over_single_$s" slurm "$runs" "$s" 4 "single_$s"
    timed "over_packed_$s" slurm "$runs" "$s" 4 packed
    timed "over_command_$s" command "$runs" "$s" 4 packed
done
for workers in 1 2 4 8 16; do
    timed "slurm_1_$workers" slurm 64 1 "$workers" packed
    timed "slurm_10_$workers" slurm 16 10 "$workers" packed
done
wait

# Overhead of a run: (time - runs x duration / workers) x workers / runs.
over() { awk -v t="$(value "$1")" -v n="$2" -v d="$3" 'BEGIN {printf "%.2f", (t - n * d / 4) * 4 / n}'; }
echo "| runner, 4 workers | beside a run of 1 s (32 runs), s | beside a run of 10 s (16 runs), s |"
echo "|---|---:|---:|"
for row in "local:threads of one process" "single:Slurm, each run a task" \
    "packed:Slurm, runs packed into 4 tasks" "command:command lines, 4 background processes"; do
    name=over_${row%%:*}
    echo "| ${row#*:} | $(over "${name}_1" 32 1) | $(over "${name}_10" 16 10) |"
done
echo
echo "| workers | 64 runs of 1 s: threads, s | Slurm, s | speed-up | 16 runs of 10 s: threads, s | Slurm, s | speed-up |"
echo "|---:|---:|---:|---:|---:|---:|---:|"
for workers in 1 2 4 8 16; do
    cells="| $workers"
    for s in 1 10; do
        local_s=$(value "local_${s}_$workers") slurm_s=$(value "slurm_${s}_$workers")
        up=$(awk -v a="$(value "slurm_${s}_1")" -v b="$slurm_s" 'BEGIN {printf "%.1f", a / b}')
        cells+=" | $(printf '%.1f | %.1f' "$local_s" "$slurm_s") | $up"
    done
    echo "$cells |"
done
