//! The page of a running campaign.

use super::{PAUSE, RunningCampaign, RunningPage, RunningStage};
use crate::test_input::example;
use crate::tests::row;
use campaign::run_store::{Observation, Record, Store};
use campaign::{
    Campaign, Progress, ProgressState, RunOutcome, RunRequest, Silent, Simulator, SimulatorError,
};
use report::Tone;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

/// A text with markup, which the page must show as it is.
const ODD: &str = "beans </title><script>alert(1)</script>";

/// An angle that grows by 40 deg per unit of F from 20 deg; fails if F is negative.
struct Slope;

impl Simulator for Slope {
    fn version(&self) -> String {
        "slope 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let friction = request.parameter("F")?;
        if friction < 0.0 {
            let reason = "below 0".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        let angle = Observation {
            mean: 20.0 + 40.0 * friction,
            sd: None,
            n: 1,
            unit: "deg".into(),
        };
        Ok(RunOutcome::default().with_observable("angle_deg", angle))
    }
}

/// Runs of the model "drum-15" of the example at these frictions.
fn requests(frictions: &[f64]) -> Vec<RunRequest> {
    let request = |f: &f64| RunRequest::new("drum-15", 7).with_parameter("F", *f);
    frictions.iter().map(request).collect()
}

/// A campaign of two stages over the problem of the example.
fn campaign() -> RunningCampaign {
    let stage = |name: &str, runs| RunningStage {
        name: name.into(),
        runs,
        at_most_further: 9,
    };
    RunningCampaign {
        title: ODD.into(),
        stages: vec![stage("before", 1), stage("surfaces", 4)],
        problem: Some(example().problem),
    }
}

fn page(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("report.html")).unwrap()
}

/// From the first moment the page is there and loads itself again; in the end it has the records of each stage, the failure with
/// its place and reason, and the measured angle beside the values of the runs, 20 deg + 40 deg F; and nothing of a name is markup.
#[test]
fn the_page_is_there_from_the_beginning_and_shows_stages_failures_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::in_memory();
    let running = RunningPage::begin(folder.path(), campaign(), &Silent);
    let first = page(folder.path());
    assert!(first.contains("http-equiv=\"refresh\"") && first.contains("No run has finished yet"));
    assert!(!first.contains("<script>alert"), "markup of a name");
    let runs = Campaign::new(&store, 1, &running);
    running.announce("before");
    runs.run_each(&Slope, &requests(&[0.1])).unwrap();
    running.announce("surfaces");
    runs.run_each(&Slope, &requests(&[0.1, 0.3, 0.2, -1.0]))
        .unwrap();
    running.finish(Tone::Note, "Finished", "The results are there.");
    let last = page(folder.path());
    assert!(!last.contains("http-equiv=\"refresh\"") && last.contains("Finished"));
    // The run of the stage before is not counted twice.
    assert_eq!(row(&last, "before")[1..], ["1", "1", "9"]);
    assert_eq!(row(&last, "surfaces")[1..], ["2", "4", "9"]);
    assert!(last.contains("drum-15, F = −1.00, seed 7: "), "{last}");
    let angle = row(&last, "drum, speed 15 rpm: angle");
    assert_eq!(
        angle[1..],
        ["fit", "33.10 ± 0.25°", "3", "24.0°", "32.0°", "28.0°"]
    );
    // A chart against F, with the measured angle as a line.
    assert!(last.contains("angle of 3 runs against F."), "{last}");
}

/// A page that is dropped says that the campaign ended early; so does one whose successor cannot be written, and one that is replaced is left alone.
#[test]
fn a_campaign_that_ends_early_says_so() {
    let folder = tempfile::tempdir().unwrap();
    drop(RunningPage::begin(folder.path(), campaign(), &Silent));
    assert!(page(folder.path()).contains("Ended early"));
    let running = RunningPage::begin(folder.path(), campaign(), &Silent);
    assert!(!page(folder.path()).contains("Ended early"));
    assert_eq!(running.replace(|| Err("full")), Err("full"));
    assert!(page(folder.path()).contains("Ended early"));
    let running = RunningPage::begin(folder.path(), campaign(), &Silent);
    let write = || std::fs::write(folder.path().join("report.html"), "final");
    running.replace(write).unwrap();
    assert_eq!(page(folder.path()), "final");
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

/// A folder in the place of the page: the runs are done all the same, and the reason is reported once.
#[test]
fn a_page_that_cannot_be_written_ends_no_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("report.html")).unwrap();
    let warnings = Warnings::default();
    let running = RunningPage::begin(folder.path(), campaign(), &warnings);
    let store = Store::in_memory();
    let records = Campaign::new(&store, 2, &running)
        .run_all(&Slope, &requests(&[0.1, 0.2]))
        .unwrap();
    assert_eq!(records.len(), 2);
    drop(running);
    let heard = warnings.0.into_inner().unwrap();
    assert_eq!(heard.len(), 1, "{heard:?}");
    assert!(heard[0].contains("report.html"), "{heard:?}");
}

/// Within one pause many short runs write the page at most once, and after it the page shows them.
#[test]
fn the_page_follows_the_runs_without_holding_them_up() {
    let folder = tempfile::tempdir().unwrap();
    let running = RunningPage::begin(folder.path(), campaign(), &Silent);
    let begin = Instant::now();
    let (first, mut seen) = (page(folder.path()), 0);
    let record = Record::new("slope 1", serde_json::json!({}), 7).unwrap();
    while begin.elapsed() < 2 * PAUSE {
        running.ended(&requests(&[0.1])[0], Ok(&record));
        running.announce(&format!("{:?}", begin.elapsed()));
        std::thread::sleep(PAUSE / 200);
        seen += usize::from(page(folder.path()) != first);
        if begin.elapsed() < PAUSE {
            assert_eq!(seen, 0, "{:?}", begin.elapsed());
        }
    }
    assert!(seen > 0, "the page does not follow");
}
