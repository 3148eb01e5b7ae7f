//! A campaign of a stand-in simulator, as submitting process and as worker: for tests on a real or pretended cluster.
//!
//! ```text
//! stand_in run local|slurm|command FOLDER RUNS SLEEP_S WORKERS [SETTINGS.json]
//! stand_in work NOTES STORE TASK.json
//! ```
//!
//! The first does `RUNS` runs of `SLEEP_S` seconds, keeps their records in `FOLDER/runs`, and prints how long it took.

mod simulator;

use batch_runner::{BatchRunner, BatchSettings, run_task};
use campaign::run_store::Store;
use campaign::{Campaign, Silent};
use simulator::{StandIn, requests};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Version of the simulator, part of the keys.
const VERSION: &str = "stand-in 1";

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["work", notes, store, task] => work(notes, store, Path::new(task)),
        ["run", runner, folder, runs, sleep_s, workers] => run(
            runner,
            folder,
            &requests_of(runs, sleep_s)?,
            workers.parse()?,
            BatchSettings::default(),
        ),
        ["run", runner, folder, runs, sleep_s, workers, settings] => {
            let settings = serde_json::from_slice(&std::fs::read(settings)?)?;
            run(
                runner,
                folder,
                &requests_of(runs, sleep_s)?,
                workers.parse()?,
                settings,
            )
        }
        _ => Err("give: run local|slurm|command FOLDER RUNS SLEEP_S WORKERS [SETTINGS.json], or: work NOTES STORE TASK.json".into()),
    }
}

/// Does the runs of a task.
fn work(notes: &str, store: &str, task: &Path) -> Result<(), Box<dyn Error>> {
    let simulator = StandIn {
        notes: Some(notes.into()),
        records: Some(store.into()),
        version: VERSION.into(),
    };
    run_task(task, &simulator, &Store::open(store)?, 0, &Silent, None)?;
    Ok(())
}

/// The requests of the command line.
fn requests_of(runs: &str, sleep_s: &str) -> Result<Vec<campaign::RunRequest>, Box<dyn Error>> {
    Ok(requests(runs.parse()?, sleep_s.parse()?))
}

/// Does a campaign.
#[expect(clippy::print_stdout, reason = "it is a command")]
#[expect(clippy::print_stderr, reason = "it is a command")]
fn run(
    runner: &str,
    folder: &str,
    requests: &[campaign::RunRequest],
    workers: usize,
    mut settings: BatchSettings,
) -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::path::absolute(folder)?;
    std::fs::create_dir_all(&folder)?;
    let notes = folder.join("notes");
    let runs = folder.join("runs");
    let store = Store::open(&runs)?;
    let simulator = StandIn {
        notes: Some(notes.clone()),
        records: Some(runs.clone()),
        version: VERSION.into(),
    };
    let program = std::env::current_exe()?.display().to_string();
    let shown = |path: &Path| path.display().to_string();
    let worker = vec![program, "work".into(), shown(&notes), shown(&runs)];
    let begin = Instant::now();
    let campaign = Campaign::new(&store, workers, &Silent);
    let batch = folder.join("batch");
    settings.array_limit = settings.array_limit.or(Some(workers));
    let batch = match runner {
        "local" => None,
        "slurm" => Some(BatchRunner::slurm(batch, worker, settings)?),
        "command" => Some(BatchRunner::command(batch, worker, settings)?),
        _ => return Err("the runner is local, slurm or command".into()),
    };
    let tell = move |text: &str| eprintln!("{:7.2} s: {text}", begin.elapsed().as_secs_f64());
    let batch = batch.map(|batch| batch.with_listener(tell));
    let records = match &batch {
        None => campaign.run_all(&simulator, requests)?,
        Some(batch) => campaign
            .with_executor(batch)
            .run_all(&simulator, requests)?,
    };
    println!(
        "{} records in {:.2} s",
        records.len(),
        begin.elapsed().as_secs_f64()
    );
    Ok(())
}
