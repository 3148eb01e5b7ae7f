#!/usr/bin/env bash
# Starts, checks or stops a one-machine Slurm (munged + slurmctld + slurmd) that
# needs neither systemd nor cgroups and leaves the system-wide configuration alone.
#
#   start-slurm.sh start     start (does nothing where it already answers)
#   start-slurm.sh status    sinfo + squeue; exit 0 only where it answers
#   start-slurm.sh env       print the export line: eval "$(start-slurm.sh env)"
#   start-slurm.sh stop      cancel jobs, stop the daemons, keep logs and state
#   start-slurm.sh purge     stop, and remove the state directory
#   start-slurm.sh install   apt-get the packages (Debian/Ubuntu, as root)
#   start-slurm.sh install_if_missing
#
# Settings (environment): SLURM_DEV_DIR state directory (all its parents must be
# enterable by everyone, or munged refuses; short, as it holds a socket); SLURM_DEV_NODES pretended
# nodes (1); SLURM_DEV_CPUS CPUs of each (all); SLURM_DEV_MEM MB of each (90 %);
# SLURM_DEV_PORT first TCP port (16817); SLURM_DEV_TIMEOUT seconds until a silent
# node is given up and its jobs are requeued (300).
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
state=${SLURM_DEV_DIR:-${TMPDIR:-/tmp}/slurm-dev-$(id -u)}
nodes=${SLURM_DEV_NODES:-1}
cpus=${SLURM_DEV_CPUS:-$(nproc)}
port=${SLURM_DEV_PORT:-16817}
dtimeout=${SLURM_DEV_TIMEOUT:-300}
total_mb=$(awk '/^MemTotal/ {print int($2 / 1024)}' /proc/meminfo)
mem=${SLURM_DEV_MEM:-$((total_mb * 9 / 10 / nodes))}
conf=$state/slurm.conf
export SLURM_CONF=$conf
export PATH=$PATH:/usr/sbin:/sbin

say() { printf '%s\n' "$*" >&2; }
die() { say "start-slurm: $*"; exit 1; }
answers() { timeout 10 scontrol ping 2>/dev/null | grep -q 'is UP'; }

need() {
    local tool missing=()
    for tool in munged slurmctld slurmd sbatch scontrol; do
        command -v "$tool" >/dev/null || missing+=("$tool")
    done
    [ ${#missing[@]} -eq 0 ] || die "not found: ${missing[*]} (try: $0 install)"
}

# Running, and still the program it was: not gone, not a zombie, not another one.
alive() { # PID PROGRAM
    awk -v want="$2" '/^Name:/ {n = $2} /^State:/ {s = $2}
        END {exit !(s != "" && s != "Z" && index(n, want) == 1)}' "/proc/$1/status" 2>/dev/null
}

# Stops the process a pid file names, but only where it still is that program.
stop_pidfile() { # FILE PROGRAM
    local pid
    [ -s "$1" ] || return 0
    pid=$(cat "$1")
    if alive "$pid" "$2"; then
        kill "$pid" 2>/dev/null || true
        for _ in $(seq 100); do alive "$pid" "$2" || break; sleep 0.1; done
        if alive "$pid" "$2"; then kill -9 "$pid" 2>/dev/null || true; fi
    fi
    rm -f "$1"
}

write_conf() {
    local i line='' name
    for i in $(seq "$nodes"); do
        name=node$i
        line+="NodeName=$name NodeHostname=$(hostname -s) NodeAddr=127.0.0.1"
        line+=" Port=$((port + 1 + i)) CPUs=$cpus RealMemory=$mem State=UNKNOWN"$'\n'
    done
    awk -v HOST="$(hostname -s)" -v CTLD_PORT="$port" -v D_PORT=$((port + 1)) \
        -v USER="$(id -un)" -v STATE="$state" -v MEM_PER_CPU=$((mem / cpus)) \
        -v D_TIMEOUT="$dtimeout" -v NODES="$line" '
        { gsub(/@HOST@/, HOST); gsub(/@CTLD_PORT@/, CTLD_PORT); gsub(/@D_PORT@/, D_PORT)
          gsub(/@USER@/, USER); gsub(/@STATE@/, STATE); gsub(/@D_TIMEOUT@/, D_TIMEOUT)
          gsub(/@MEM_PER_CPU@/, MEM_PER_CPU); gsub(/@NODES@/, NODES); print }
    ' "$here/slurm.conf.in" >"$conf"
}

start() {
    need
    if [ -f "$conf" ] && answers; then say "already running"; return 0; fi
    mkdir -p "$state"/{munge,ctld}
    chmod 755 "$state"
    # munged wants its key and seed private, its socket reachable by job users.
    chmod 711 "$state/munge"
    if [ ! -s "$state/munge/key" ]; then
        (umask 077 && head -c 256 /dev/urandom >"$state/munge/key")
    fi
    write_conf
    stop_pidfile "$state/munge/pid" munged
    munged --key-file="$state/munge/key" --socket="$state/munge/munge.socket" \
        --pid-file="$state/munge/pid" --log-file="$state/munge/log" \
        --seed-file="$state/munge/seed" || die "munged did not start: $state/munge/log"
    munge -n --socket="$state/munge/munge.socket" |
        unmunge --socket="$state/munge/munge.socket" >/dev/null || die "munge does not answer"
    slurmctld -f "$conf" || die "slurmctld did not start: $state/slurmctld.log"
    local i
    for i in $(seq "$nodes"); do
        mkdir -p "$state/spool.node$i"
        slurmd -f "$conf" -N "node$i" || die "slurmd did not start: $state/slurmd.node$i.log"
    done
    for _ in $(seq 60); do
        if answers && [ "$(sinfo -h -N -t idle,alloc,mix -o %N 2>/dev/null | sort -u | wc -l)" -eq "$nodes" ]; then
            say "Slurm is up: $nodes node(s) of $cpus CPU(s). Now: eval \"\$($0 env)\""
            return 0
        fi
        sleep 0.5
    done
    tail -n 20 "$state"/slurmctld.log "$state"/slurmd.*.log >&2 || true
    die "the nodes did not come up in 30 s"
}

stop() {
    local i
    if [ -f "$conf" ] && answers; then
        scancel --quiet --user="$(id -un)" 2>/dev/null || true
        for _ in $(seq 80); do
            [ -z "$(squeue -h -t R,CG -o %i 2>/dev/null)" ] && break
            sleep 0.25
        done
    fi
    stop_pidfile "$state/slurmctld.pid" slurmctld
    for i in "$state"/slurmd.*.pid; do
        if [ -e "$i" ]; then stop_pidfile "$i" slurmd; fi
    done
    stop_pidfile "$state/munge/pid" munged
    rm -f "$state/munge/munge.socket" "$state/munge/munge.socket.lock"
    say "stopped"
}

case ${1:-start} in
    start) start ;;
    stop) stop ;;
    purge) stop; rm -rf -- "$state" ;;
    restart) stop; start ;;
    env) printf 'export SLURM_CONF=%q\n' "$conf" ;;
    status) need; answers || die "not running"; sinfo; squeue ;;
    install)
        apt-get update -q
        DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
            munge slurmctld slurmd slurm-client
        ;;
    install_if_missing)
        (need) 2>/dev/null || "$0" install
        ;;
    *) die "unknown command: $1 (start, stop, restart, status, env, purge, install)" ;;
esac
