//! Campaigns over toy simulators.

use campaign::run_store::{Observation, Store};
use campaign::{
    Campaign, Cores, Error, LineProgress, Pace, PreparedRun, Progress, ProgressState, RunOutcome,
    RunRequest, Silent, Simulator, SimulatorError,
};
use serde_json::Value;
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// y = 2 x + effect + noise of the seed; counts its runs, and does as told for special x.
#[derive(Default)]
struct Toy {
    runs: AtomicUsize,
    begun: Mutex<Vec<f64>>,
    stop_at: Option<f64>,
    stop: AtomicBool,
}

impl Simulator for Toy {
    fn version(&self) -> String {
        "toy 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.runs.fetch_add(1, Ordering::SeqCst);
        let x = request.parameter("x")?;
        self.begun.lock().expect("no holder panics").push(x);
        if self.stop_at == Some(x) {
            self.stop.store(true, Ordering::SeqCst);
        }
        if x == 13.0 {
            let reason = "the drum is empty".into();
            return Err(SimulatorError::Failed { reason });
        }
        assert!(x != 14.0, "bug at fourteen");
        // Runs of unlike length, so that threads finish in another order than they begin.
        std::thread::sleep(Duration::from_micros(500 * (request.seed % 4)));
        let noise = (request.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 * 1e-17;
        let y = Observation {
            mean: if x == 15.0 {
                f64::NAN
            } else {
                2.0 * x + request.effect("slip") + noise
            },
            sd: Some(1.0),
            n: 4,
            unit: "1".into(),
        };
        let regime = Some(if x < 5.0 { "rolling" } else { "sliding" }.to_owned());
        Ok(RunOutcome {
            regime,
            ..RunOutcome::default().with_observable("y", y)
        })
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        Ok(Box::new(ToyRun {
            toy: self,
            request: request.clone(),
            inputs: request.inputs(),
        }))
    }
}

/// A run whose cost is x.
struct ToyRun<'s> {
    toy: &'s Toy,
    request: RunRequest,
    inputs: Value,
}

impl PreparedRun for ToyRun<'_> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        Ok(self.inputs.clone())
    }

    fn cost(&self) -> f64 {
        self.request.parameter("x").unwrap_or(1.0)
    }

    fn run(&self, _: &Cores) -> Result<RunOutcome, SimulatorError> {
        self.toy.run(&self.request)
    }
}

fn requests(xs: &[f64]) -> Vec<RunRequest> {
    xs.iter()
        .enumerate()
        .map(|(i, &x)| RunRequest::new("toy", i as u64).with_parameter("x", x))
        .collect()
}

#[test]
fn records_come_in_the_order_of_the_requests_and_do_not_depend_on_threads() {
    let list = requests(&[3.0, 1.0, 2.0, 9.0, 8.0, 7.0, 4.0, 5.0]);
    let run = |threads| {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        Campaign::new(&store, threads, &Silent)
            .run_all(&Toy::default(), &list)
            .unwrap()
    };
    let one = run(1);
    for (record, request) in one.iter().zip(&list) {
        assert_eq!(record.seed(), request.seed);
    }
    assert_eq!(one, run(4));
}

/// A run that ends as soon as it has both of two cores, and others that end at once.
struct Sharing;

impl Simulator for Sharing {
    fn version(&self) -> String {
        "sharing".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        SharingRun(request.clone()).run(&Cores::new(1, 1))
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        Ok(Box::new(SharingRun(request.clone())))
    }
}

struct SharingRun(RunRequest);

impl PreparedRun for SharingRun {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        Ok(self.0.inputs())
    }

    fn run(&self, cores: &Cores) -> Result<RunOutcome, SimulatorError> {
        let begin = Instant::now();
        let first = cores.of_a_run();
        while self.0.parameter("x")? == 2.0 && cores.of_a_run() < 2 {
            if begin.elapsed() > Duration::from_secs(20) {
                let reason = "the other core stayed idle".into();
                return Err(SimulatorError::Failed { reason });
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        let first = Observation::of_one(first as f64, "1");
        Ok(RunOutcome::default().with_observable("first", first))
    }
}

/// While two workers have runs each run has one of two cores; the last one gets both when the others are done, and a run that is alone
/// has them from the start.
#[test]
fn the_last_run_of_a_list_gets_all_cores() {
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let first = |xs: &[f64]| {
        let records = campaign.run_all(&Sharing, &requests(xs)).unwrap();
        records[0].observable("first").unwrap().mean
    };
    assert_eq!(first(&[2.0, 1.0, 1.5]), 1.0);
    assert_eq!(first(&[3.0]), 2.0);
}

#[test]
fn finished_runs_are_reused_and_duplicates_run_once() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let toy = Toy::default();
    let base = RunRequest::new("toy", 1).with_parameter("x", 1.0);
    let list = [
        base.clone(),
        base.clone().with_effect("slip", 0.0),
        base.clone().with_effect("slip", 0.5),
        base,
    ];
    let campaign = Campaign::new(&store, 2, &Silent);
    let first = campaign.run_all(&toy, &list).unwrap();
    assert_eq!(toy.runs.load(Ordering::SeqCst), 2);
    assert_eq!(first[0], first[1]);
    assert_ne!(first[0], first[2]);
    assert_eq!(campaign.run_all(&toy, &list).unwrap(), first);
    assert_eq!(
        toy.runs.load(Ordering::SeqCst),
        2,
        "a finished run was repeated"
    );
}

#[test]
fn another_version_of_the_simulator_reuses_nothing() {
    struct Next(Toy);
    impl Simulator for Next {
        fn version(&self) -> String {
            "toy 2".into()
        }
        fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
            self.0.run(request)
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(&[1.0, 2.0]);
    let campaign = Campaign::new(&store, 1, &Silent);
    campaign.run_all(&Toy::default(), &list).unwrap();
    let next = Next(Toy::default());
    campaign.run_all(&next, &list).unwrap();
    assert_eq!(next.0.runs.load(Ordering::SeqCst), 2);
}

#[test]
fn longest_runs_begin_first() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let toy = Toy::default();
    Campaign::new(&store, 1, &Silent)
        .run_all(&toy, &requests(&[1.0, 3.0, 2.0]))
        .unwrap();
    assert_eq!(*toy.begun.lock().unwrap(), vec![3.0, 2.0, 1.0]);
}

/// One failure of each kind: an error value, a panic, and a result that is not a number.
#[test]
fn failure_of_a_run_is_reported_with_its_request_and_the_others_are_stored() {
    for (bad, says) in [(13.0, "empty"), (14.0, "fourteen"), (15.0, "NaN")] {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let error = Campaign::new(&store, 2, &Silent)
            .run_all(&Toy::default(), &requests(&[1.0, bad, 2.0]))
            .unwrap_err();
        let Error::Run {
            request,
            source,
            n_failed: 1,
            n_runs: 3,
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!(request.parameters["x"], bad);
        assert!(source.to_string().contains(says), "{source}");
        assert_eq!(store.keys().unwrap().len(), 2);
    }
}

/// A failure costs its own record only, also where it is asked for twice; the others are as ever.
#[test]
fn each_run_gives_its_record_or_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let mut list = requests(&[1.0, 13.0, 2.0]);
    list.push(list[1].clone());
    let toy = Toy::default();
    let results = Campaign::new(&store, 2, &Silent)
        .run_each(&toy, &list)
        .unwrap();
    let y = |i: usize| results[i].as_ref().unwrap().observable("y").unwrap().mean;
    assert!((y(0) - 2.0).abs() < 1.0 && (y(2) - 4.0).abs() < 1.0);
    for i in [1, 3] {
        let reason = results[i].as_ref().unwrap_err();
        assert!(reason.contains("the drum is empty"), "{reason}");
    }
    assert_eq!(toy.runs.load(Ordering::SeqCst), 3);
    assert_eq!(store.keys().unwrap().len(), 2);
}

#[test]
fn stop_flag_is_honoured_between_runs_and_the_rest_follows_later() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(&[1.0, 2.0, 3.0, 4.0]);
    let toy = Toy {
        stop_at: Some(3.0),
        ..Toy::default()
    };
    let error = Campaign::new(&store, 1, &Silent)
        .with_stop(&toy.stop)
        .run_all(&toy, &list)
        .unwrap_err();
    assert!(
        matches!(
            error,
            Error::Stopped {
                n_done: 2,
                n_runs: 4
            }
        ),
        "{error}"
    );
    let records = Campaign::new(&store, 1, &Silent)
        .run_all(&toy, &list)
        .unwrap();
    assert_eq!(records.len(), 4);
    assert_eq!(toy.runs.load(Ordering::SeqCst), 4);
}

#[test]
fn request_that_is_not_a_number_is_refused_before_any_run() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let toy = Toy::default();
    let error = Campaign::new(&store, 1, &Silent)
        .run_all(&toy, &requests(&[1.0, f64::NAN]))
        .unwrap_err();
    assert!(matches!(error, Error::Refused { .. }), "{error}");
    assert_eq!(toy.runs.load(Ordering::SeqCst), 0);
}

/// Models that are one run for the simulator: only x and the seed count, and x below 0 is invalid.
#[derive(Default)]
struct OnlyX(Toy);

impl Simulator for OnlyX {
    fn version(&self) -> String {
        self.0.version()
    }
    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.0.run(request)
    }
    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        let x = request.parameter("x")?;
        if x < 0.0 {
            let reason = format!("x = {x}; it must be 0 or more");
            return Err(SimulatorError::Refused { reason });
        }
        Ok(Box::new(ToyRun {
            toy: &self.0,
            request: request.clone(),
            inputs: serde_json::json!({ "x": x }),
        }))
    }
}

/// Requests with the same inputs for the simulator are run once, in one list and over lists, whatever the name of
/// their model and whatever else they set; another seed is another run.
#[test]
fn requests_of_different_models_with_the_same_inputs_are_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let toy = OnlyX::default();
    let run = |model: &str, seed| RunRequest::new(model, seed).with_parameter("x", 1.0);
    let list = [
        run("sled", 1).with_parameter("friction of another pair", 0.3),
        run("drum", 1),
        run("drum", 2),
    ];
    let campaign = Campaign::new(&store, 2, &Silent);
    let records = campaign.run_all(&toy, &list).unwrap();
    assert_eq!(records[0], records[1]);
    assert_ne!(records[0].key(), records[2].key());
    campaign.run_all(&toy, &[run("heap", 2)]).unwrap();
    assert_eq!(toy.0.runs.load(Ordering::SeqCst), 2);
}

/// In `run_each` an invalid request has its reason and the others their records; `run_all` names it
/// and runs nothing.
#[test]
fn a_request_that_is_refused_fails_alone_and_before_any_run() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let toy = OnlyX::default();
    let list = requests(&[1.0, -2.0, f64::NAN, 3.0]);
    let campaign = Campaign::new(&store, 2, &Silent);
    let error = campaign.run_all(&toy, &list).unwrap_err();
    let Error::Refused {
        request,
        source,
        n_refused: 2,
        n_requests: 4,
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!(request.parameters["x"], -2.0);
    assert!(source.to_string().contains("0 or more"), "{source}");
    assert_eq!(toy.0.runs.load(Ordering::SeqCst), 0);
    let each = campaign.run_each(&toy, &list).unwrap();
    let ok: Vec<bool> = each.iter().map(Result::is_ok).collect();
    assert_eq!(ok, [true, false, false, true]);
    let reasons = [each[1].as_ref(), each[2].as_ref()].map(|r| r.unwrap_err().clone());
    assert!(
        reasons[0].contains("x = -2; it must be 0 or more"),
        "{reasons:?}"
    );
    assert!(reasons[1].contains("inputs.x"), "{reasons:?}");
    assert_eq!(toy.0.runs.load(Ordering::SeqCst), 2);
}

/// The class of a run comes back from the simulator and from the store alike.
#[test]
fn the_regime_of_a_run_is_in_its_record() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    for _ in 0..2 {
        let records = campaign
            .run_all(&Toy::default(), &requests(&[1.0, 6.0]))
            .unwrap();
        let regimes: Vec<_> = records
            .iter()
            .map(campaign::run_store::Record::regime)
            .collect();
        assert_eq!(regimes, [Some("rolling"), Some("sliding")]);
    }
}

/// The second list of a loop knows the pace of the first from its first moment, and counts what is ahead. The stage has two lists of
/// the length 2 and 4 at least, and of 7 at most, and a later one 3 to 5: at the end of the first list 4 + 3 to 5 + 5 are left, at the
/// begin of the second its own 4, and 3 to 1 + 5. The sums are those that the pace itself states, to rounding.
#[test]
fn the_time_left_is_that_of_the_whole_loop() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let (pace, listener) = (Pace::new(), Listener::default());
    let campaign = Campaign::new(&store, 2, &listener).with_pace(&pace);
    assert_eq!(pace.seconds_per_cost(), None);
    assert_eq!(campaign.length_of([3.0, 2.0, 2.0].into_iter()), 4.0);
    campaign.expect([6.0, 7.0], [3.0, 5.0]);
    campaign
        .run_all(&Toy::default(), &requests(&[1.0, 2.0]))
        .unwrap();
    let per_cost = pace.seconds_per_cost().unwrap();
    campaign
        .run_all(&Toy::default(), &requests(&[3.0, 4.0]))
        .unwrap();
    campaign.expect([0.0, 1.0], [0.0; 2]);
    campaign
        .run_all(&Toy::default(), &requests(&[5.0]))
        .unwrap();
    let heard = listener.0.into_inner().unwrap();
    assert_eq!(heard[0].left_s, None, "nothing measured yet");
    let close = |found: Option<[f64; 2]>, expected: [f64; 2]| {
        for (found, expected) in found.unwrap().into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    };
    close(heard[2].left_s, [7.0 * per_cost, 10.0 * per_cost]);
    close(heard[3].left_s, [7.0 * per_cost, 10.0 * per_cost]);
    assert_eq!(heard[7].left_s, Some([0.0; 2]), "the end of the loop");
    assert!(heard[3].elapsed_s >= heard[2].elapsed_s, "one clock");
}

/// Keeps what it hears.
#[derive(Default)]
struct Listener(Mutex<Vec<ProgressState>>, Mutex<Vec<String>>);

impl Progress for Listener {
    fn update(&self, state: &ProgressState) {
        self.0.lock().expect("no holder panics").push(*state);
    }
    fn warning(&self, text: &str) {
        self.1.lock().expect("no holder panics").push(text.into());
    }
}

#[test]
fn progress_counts_up_and_knows_the_time_left_after_the_first_run() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(&[1.0, 2.0, 3.0]);
    Campaign::new(&store, 1, &Silent)
        .run_all(&Toy::default(), &list[..1])
        .unwrap();
    let listener = Listener::default();
    Campaign::new(&store, 1, &listener)
        .run_all(&Toy::default(), &list)
        .unwrap();
    let heard = listener.0.into_inner().unwrap();
    let counts: Vec<_> = heard.iter().map(|s| (s.done, s.reused, s.total)).collect();
    assert_eq!(counts, vec![(1, 1, 3), (2, 1, 3), (3, 1, 3)]);
    assert_eq!(heard[0].left_s, None);
    assert!(heard[1].left_s.unwrap()[0] > 0.0, "{:?}", heard[1]);
    assert_eq!(heard[2].left_s, Some([0.0; 2]));
}

#[test]
fn record_under_a_wrong_name_is_warned_of_and_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(&[1.0, 2.0]);
    let records = Campaign::new(&store, 1, &Silent)
        .run_all(&Toy::default(), &list)
        .unwrap();
    let file = |i: usize| folder.path().join(format!("{}.json", records[i].key()));
    std::fs::copy(file(0), file(1)).unwrap();
    let listener = Listener::default();
    let again = Campaign::new(&store, 1, &listener)
        .run_all(&Toy::default(), &list)
        .unwrap();
    assert_eq!(again, records);
    let heard = listener.1.into_inner().unwrap();
    assert_eq!(heard.len(), 1, "{heard:?}");
    for says in [file(1).to_str().unwrap(), "renamed", ".json.damaged"] {
        assert!(heard[0].contains(says), "{says}: {}", heard[0]);
    }
    let away = std::fs::read(file(1).with_extension("json.damaged")).unwrap();
    assert_eq!(away, std::fs::read(file(0)).unwrap(), "nothing is lost");
}

/// Bytes that two owners see.
#[derive(Clone, Default)]
struct Page(Arc<Mutex<Vec<u8>>>);

impl Write for Page {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("no holder panics").write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_list_of_runs_begins_and_ends_with_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let page = Page::default();
    let progress = LineProgress::new(page.clone());
    Campaign::new(&store, 2, &progress)
        .run_all(&Toy::default(), &requests(&[1.0, 2.0, 3.0]))
        .unwrap();
    let text = String::from_utf8(page.0.lock().unwrap().clone()).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let [first, .., last] = lines.as_slice() else {
        panic!("two lines or more: {text}");
    };
    assert!(first.starts_with("0/3 runs"), "{text}");
    assert!(last.starts_with("3/3 runs"), "{text}");
}
