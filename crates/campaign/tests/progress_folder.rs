//! What a campaign tells of itself in its folder.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use campaign::run_store::{Observation, Store};
use campaign::{
    Campaign, CampaignPlan, CampaignState, PlannedList, Progress, ProgressFolder, ProgressState,
    RunOutcome, RunRequest, Silent, Simulator, SimulatorError, StagePlan,
};
use std::fs;
use std::path::Path;
use std::sync::Mutex;

/// Twice its parameter; fails where that is negative.
struct Doubler;

impl Simulator for Doubler {
    fn version(&self) -> String {
        "doubler 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let x = request.parameter("x")?;
        if x < 0.0 {
            let reason = "below 0".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        let y = Observation {
            mean: 2.0 * x,
            sd: None,
            n: 1,
            unit: "1".into(),
        };
        Ok(RunOutcome::default().with_observable("y", y))
    }
}

/// A plan of two stages.
fn plan() -> CampaignPlan {
    let stage = |name: &str| StagePlan {
        name: name.into(),
        runs: 2,
        at_most_further: 0,
    };
    CampaignPlan {
        name: "toy".into(),
        stages: vec![stage("first"), stage("second")],
        ..CampaignPlan::default()
    }
}

/// Requests at these values.
fn requests(values: &[f64]) -> Vec<RunRequest> {
    let each = values.iter();
    each.map(|x| RunRequest::new("toy", 7).with_parameter("x", *x))
        .collect()
}

/// The state in a folder.
fn state(folder: &Path) -> CampaignState {
    CampaignState::read(folder).unwrap().unwrap().0
}

/// Each list is there with its stage and the keys of its records; failures of all lists are counted; the end is told; and no file
/// is left aside.
#[test]
fn the_folder_tells_stages_lists_failures_and_the_end() {
    let place = tempfile::tempdir().unwrap();
    let store = Store::open(place.path().join("runs")).unwrap();
    assert_eq!(CampaignState::read(place.path()), Ok(None));
    let progress = ProgressFolder::new(place.path(), plan(), &Silent);
    let campaign = Campaign::new(&store, 1, &progress);
    progress.announce("first");
    let first = campaign
        .run_each(&Doubler, &requests(&[1.0, -1.0, 1.0]))
        .unwrap();
    let told = state(place.path());
    assert_eq!(
        (told.stage.as_str(), told.lists, told.runs, told.done),
        ("first", 1, 2, 2)
    );
    assert_eq!((told.failed, told.failed_before), (1, 0));
    progress.announce("second");
    progress.announce("a box further");
    campaign.run_each(&Doubler, &requests(&[2.0])).unwrap();
    let told = state(place.path());
    assert_eq!((told.stage.as_str(), told.lists), ("second", 2));
    assert_eq!((told.failed, told.failed_before), (0, 1));
    assert_eq!(told.remark, "a box further");
    assert_eq!(told.plan, plan());
    assert_eq!(told.end, None);
    let list = PlannedList::read(place.path(), 1).unwrap().unwrap();
    assert_eq!(list.stage, "first");
    assert_eq!(list.runs.len(), 2, "one of the three is asked for twice");
    assert_eq!(list.runs[0].key, first[0].as_ref().unwrap().key());
    assert_eq!(list.runs[0].request, requests(&[1.0])[0]);
    assert_eq!(PlannedList::read(place.path(), 3), Ok(None));
    progress.end("done");
    drop(progress);
    assert_eq!(state(place.path()).end.as_deref(), Some("done"));
    let files = fs::read_dir(place.path().join("progress")).unwrap().count();
    assert_eq!(files, 3);
    drop(ProgressFolder::new(place.path(), plan(), &Silent));
    assert_eq!(state(place.path()).end.as_deref(), Some("ended early"));
}

/// Half a file, a folder and a pipe of the name are told, and none is waited for.
#[test]
fn a_damaged_file_is_told() {
    let place = tempfile::tempdir().unwrap();
    let progress = ProgressFolder::new(place.path(), plan(), &Silent);
    let path = CampaignState::path(place.path());
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let told = CampaignState::read(place.path()).unwrap_err();
    assert!(told.contains("EOF"), "{told}");
    fs::remove_file(&path).unwrap();
    let pipe = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(pipe.unwrap().success());
    let told = CampaignState::read(place.path()).unwrap_err();
    assert!(told.contains("no plain file"), "{told}");
    drop(progress);
}

/// Keeps the warnings.
#[derive(Default)]
struct Warnings(Mutex<Vec<String>>);

impl Progress for Warnings {
    fn update(&self, _state: &ProgressState) {}

    fn warning(&self, text: &str) {
        self.0.lock().unwrap().push(text.into());
    }
}

/// A file in the place of the folder: the runs are done all the same, and the reason is told once.
#[test]
fn a_folder_that_takes_no_progress_hinders_no_run() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("progress"), "in the way").unwrap();
    let store = Store::open(place.path().join("runs")).unwrap();
    let warnings = Warnings::default();
    let progress = ProgressFolder::new(place.path(), plan(), &warnings);
    let records = Campaign::new(&store, 2, &progress)
        .run_all(&Doubler, &requests(&[1.0, 2.0]))
        .unwrap();
    assert_eq!(records.len(), 2);
    drop(progress);
    let heard = warnings.0.into_inner().unwrap();
    assert_eq!(heard.len(), 1, "{heard:?}");
    assert!(
        heard[0].contains("progress") && heard[0].contains("the runs go on"),
        "{heard:?}"
    );
}

/// 2000 runs of no time: the numbers are written a few times a second, not for each run, and the last of them always.
#[test]
fn short_runs_are_not_held_up() {
    let place = tempfile::tempdir().unwrap();
    let progress = ProgressFolder::new(place.path(), plan(), &Silent);
    let begin = std::time::Instant::now();
    let mut written = 0;
    let mut seen = 0;
    for done in 1..=2000 {
        progress.update(&ProgressState {
            done,
            failed: 0,
            reused: 0,
            total: 2000,
            running: 1,
            elapsed_s: 0.0,
            left_s: None,
        });
        let now = state(place.path()).done;
        written += usize::from(now != seen);
        seen = now;
    }
    let most = 2.0 + begin.elapsed().as_secs_f64() / 0.25;
    assert!(written as f64 <= most, "{written} times, {most} allowed");
    assert_eq!(seen, 2000);
}
