//! Campaigns of several processes in one folder.
//!
//! The other processes are this test program itself, with its task in a file.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use campaign::run_store::{Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Number of runs.
const RUNS: u64 = 64;
/// The same, to compare with lengths.
const RUN_COUNT: usize = 64;
/// Number of threads of each process.
const THREADS: usize = 8;
/// Number of processes.
const PROCESSES: usize = 8;

/// y = 2 seed, in 3 ms; notes each begin in a file of its own.
struct Noting {
    /// Where the notes are.
    notes: PathBuf,
    /// Numbers them.
    number: AtomicUsize,
    /// The run that takes minutes.
    endless: Option<u64>,
}

impl Simulator for Noting {
    fn version(&self) -> String {
        "noting 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let number = self.number.fetch_add(1, Ordering::SeqCst);
        let note = format!("{} {} {number}", request.seed, std::process::id());
        fs::write(self.notes.join(note), "").unwrap();
        let endless = self.endless == Some(request.seed);
        std::thread::sleep(if endless {
            Duration::from_mins(5)
        } else {
            Duration::from_millis(3)
        });
        let y = Observation {
            mean: 2.0 * request.seed as f64,
            sd: None,
            n: 1,
            unit: "1".into(),
        };
        Ok(RunOutcome::default().with_observable("y", y))
    }
}

/// A folder for the tasks and notes of children, beside the folder of runs.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        let desk = tempfile::tempdir().unwrap();
        for folder in ["runs", "notes", "task"] {
            fs::create_dir(desk.path().join(folder)).unwrap();
        }
        Self(desk)
    }

    fn start(&self) -> Child {
        Command::new(std::env::current_exe().unwrap())
            .args(["--ignored", "--exact", "processes::a_child_does_its_runs"])
            .current_dir(self.0.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    }

    /// Seeds of the runs that were begun, sorted.
    fn begun(&self) -> Vec<u64> {
        let entries = fs::read_dir(self.0.path().join("notes")).unwrap();
        let seed = |name: String| name.split(' ').next().unwrap().parse().unwrap();
        let mut seeds: Vec<u64> = entries
            .map(|entry| seed(entry.unwrap().file_name().into_string().unwrap()))
            .collect();
        seeds.sort_unstable();
        seeds
    }
}

/// The campaign of every process, with one endless run or none.
fn run(folder: &Path, endless: Option<u64>) -> Vec<f64> {
    let store = Store::open(folder.join("runs")).unwrap();
    let simulator = Noting {
        notes: folder.join("notes"),
        number: AtomicUsize::new(0),
        endless,
    };
    let list: Vec<_> = (0..RUNS).map(|seed| RunRequest::new("toy", seed)).collect();
    let records = Campaign::new(&store, THREADS, &Silent)
        .run_all(&simulator, &list)
        .unwrap();
    let y = |record: &campaign::run_store::Record| record.observable("y").unwrap().mean;
    records.iter().map(y).collect()
}

/// Task of the children; alone it does nothing.
#[test]
#[ignore = "the process that other tests of this file start: `just test`"]
fn a_child_does_its_runs() {
    let here = Path::new(".");
    if here.join("task").exists() {
        let endless = fs::read_to_string("task/endless").ok();
        run(here, endless.map(|seed| seed.parse().unwrap()));
    }
}

/// 64 workers in 8 processes: 64 runs are begun, each of them once, and all records are whole.
#[test]
fn processes_share_the_runs() {
    let desk = Desk::new();
    let children: Vec<_> = (0..PROCESSES).map(|_| desk.start()).collect();
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    let all: Vec<u64> = (0..RUNS).collect();
    assert_eq!(desk.begun(), all);
    let expected: Vec<f64> = all.iter().map(|seed| 2.0 * *seed as f64).collect();
    assert_eq!(run(desk.0.path(), None), expected);
    assert_eq!(desk.begun(), all, "nothing was left to do");
    let files = fs::read_dir(desk.0.path().join("runs")).unwrap().count();
    assert_eq!(files, all.len(), "records alone");
}

/// A process that is killed in the middle of a run: another one takes this run over, long before a claim dies of age,
/// and repeats no other.
#[test]
fn the_run_of_a_killed_process_is_taken_over() {
    let desk = Desk::new();
    let endless = 17;
    fs::write(desk.0.path().join("task/endless"), endless.to_string()).unwrap();
    let mut child = desk.start();
    let begin = Instant::now();
    let records = || fs::read_dir(desk.0.path().join("runs")).unwrap();
    let whole = |entry: &fs::DirEntry| entry.path().extension().is_some_and(|e| e == "json");
    while records().filter(|e| whole(e.as_ref().unwrap())).count() + 1 < RUN_COUNT {
        assert!(begin.elapsed().as_secs() < 30, "the child is stuck");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(desk.begun().len(), RUN_COUNT);
    let begin = Instant::now();
    let expected: Vec<f64> = (0..RUNS).map(|seed| 2.0 * seed as f64).collect();
    assert_eq!(run(desk.0.path(), None), expected);
    assert!(begin.elapsed().as_secs() < 30, "{:?}", begin.elapsed());
    let mut all: Vec<u64> = (0..RUNS).chain([endless]).collect();
    all.sort_unstable();
    assert_eq!(desk.begun(), all);
    assert_eq!(records().count(), RUN_COUNT, "records alone");
}
