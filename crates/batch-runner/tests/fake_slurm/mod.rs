//! A pretended Slurm of four shell scripts, which run tasks in the background; faults are made by files.

use batch_runner::{BatchRunner, BatchSettings, SlurmPrograms};
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What all commands begin with: they do not answer where there is a file `down`, and note that they were called.
const HEAD: &str = r#"#!/bin/sh
here=$(dirname "$0")
echo "$(basename "$0") $*" >> "$here/calls"
[ ! -e "$here/down" ] || { echo "error: Unable to contact slurm controller (connect failure)" >&2; exit 1; }
"#;

/// Takes an array. The first task of an array whose number stands in `fault-NUMBER` is not run and has that state. No
/// task begins as long as there is a file `hold`.
const SBATCH: &str = r#"
for word; do
    case $word in
        --array=*) last=${word#--array=0-}; last=${last%%%*} ;;
        --job-name=*) name=${word#--job-name=} ;;
        --output=*) output=${word#--output=} ;;
    esac
    script=$word
done
[ ! -e "$here/refuse" ] || { echo "sbatch: error: Invalid partition name specified" >&2; exit 1; }
job=1
while ! mkdir "$here/jobs/$job" 2> /dev/null; do job=$((job + 1)); done
echo "$name" > "$here/jobs/$job/name"
index=0
while [ "$index" -le "$last" ]; do
    file=$here/jobs/$job/$index
    if [ "$index" = 0 ] && [ -e "$here/fault-$job" ]; then
        cat "$here/fault-$job" > "$file"
    else
        echo PENDING > "$file"
        (
            while [ -e "$here/hold" ]; do sleep 0.05; done
            [ "$(cat "$file")" = PENDING ] || exit 0
            echo RUNNING > "$file"
            log=$(printf %s "$output" | sed "s/%a/$index/")
            SLURM_ARRAY_TASK_ID=$index sh "$script" > "$log" 2>&1 &
            echo $! > "$file.pid"
            if wait $!; then state=COMPLETED; else state=FAILED; fi
            [ "$(cat "$file")" != RUNNING ] || echo "$state" > "$file"
        ) > /dev/null 2>&1 &
    fi
    index=$((index + 1))
done
[ ! -e "$here/forget-id" ] || { rm "$here/forget-id"; exec sleep 60; }
echo "$job"
"#;

/// Lists all tasks in the one of two formats that is asked for.
const SQUEUE: &str = r#"
for folder in "$here"/jobs/*; do
    [ -d "$folder" ] || continue
    job=$(basename "$folder")
    case $* in
        *%j*) echo "$job|$(cat "$folder/name")" ;;
        *) for file in "$folder"/*; do
            index=$(basename "$file")
            case $index in name | *.pid) ;; *) echo "${job}_$index|$(cat "$file")" ;; esac
        done ;;
    esac
done
"#;

/// Has no accounting, as the smallest of clusters.
const SACCT: &str = r#"
echo "Slurm accounting storage is disabled" >&2
exit 1
"#;

/// Ends all tasks of the jobs.
const SCANCEL: &str = r#"
for job; do
    [ -d "$here/jobs/$job" ] || continue
    for file in "$here/jobs/$job"/*; do
        case $file in */name | *.pid) continue ;; esac
        case $(cat "$file") in
            PENDING | RUNNING)
                echo "CANCELLED by 0" > "$file"
                [ ! -e "$file.pid" ] || kill "$(cat "$file.pid")" ;;
        esac
    done
done
"#;

/// The pretended Slurm, with a folder for the campaign.
pub(crate) struct FakeSlurm {
    /// Holds all.
    folder: tempfile::TempDir,
}

impl FakeSlurm {
    /// Writes the scripts.
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("jobs")).unwrap();
        for (name, text) in [
            ("sbatch", SBATCH),
            ("squeue", SQUEUE),
            ("sacct", SACCT),
            ("scancel", SCANCEL),
        ] {
            let path = folder.path().join(name);
            fs::write(&path, format!("{HEAD}{text}")).unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        }
        Self { folder }
    }

    /// A file or folder of it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Makes a fault.
    pub(crate) fn set(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// Ends a fault.
    pub(crate) fn unset(&self, name: &str) {
        fs::remove_file(self.path(name)).unwrap();
    }

    /// Number of calls of a command so far.
    pub(crate) fn calls(&self, command: &str) -> usize {
        let calls = fs::read_to_string(self.path("calls")).unwrap_or_default();
        let is_call = |line: &&str| line.split(' ').next() == Some(command);
        calls.lines().filter(is_call).count()
    }

    /// Settings under which everything happens within fractions of a second.
    pub(crate) fn settings(&self) -> BatchSettings {
        let program = |name| self.path(name).display().to_string();
        BatchSettings {
            seconds_per_cost: Some(1.0),
            task_seconds: 0.3,
            least_task_seconds: 0.0,
            poll_s: 0.02,
            poll_most_s: 0.1,
            state_interval_s: 0.1,
            file_latency_s: 0.2,
            heartbeat_s: 0.2,
            patience_s: 20.0,
            command_limit_s: 10.0,
            programs: SlurmPrograms {
                sbatch: program("sbatch"),
                squeue: program("squeue"),
                sacct: program("sacct"),
                scancel: program("scancel"),
            },
            ..BatchSettings::default()
        }
    }

    /// The command of a worker.
    pub(crate) fn worker(&self) -> Vec<String> {
        let shown = |path: PathBuf| path.display().to_string();
        let notes = shown(self.path("notes"));
        vec![
            shown(stand_in()),
            "work".into(),
            notes,
            shown(self.path("runs")),
        ]
    }

    /// A runner that works with it.
    pub(crate) fn runner(&self, settings: BatchSettings) -> BatchRunner {
        BatchRunner::slurm(self.path("batch"), self.worker(), settings).unwrap()
    }

    /// Words that the simulator noted, such as `began`, and how often.
    pub(crate) fn noted(&self, word: &str) -> usize {
        let notes = fs::read_to_string(self.path("notes")).unwrap_or_default();
        notes.lines().filter(|line| line.starts_with(word)).count()
    }
}

/// The example that is worker and submitting process.
pub(crate) fn stand_in() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().and_then(Path::parent).unwrap();
    let path = folder.join("examples").join("stand_in");
    assert!(
        path.exists(),
        "{} is missing: cargo build --release -p batch-runner --examples",
        path.display()
    );
    path
}

/// Waits until something is so; 30 s are far beyond what any of it takes.
pub(crate) fn until(what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed().as_secs() < 30, "waited in vain: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
