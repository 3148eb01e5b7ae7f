//! Campaigns that share a folder share the runs.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use campaign::run_store::{Attempt, Observation, Store};
use campaign::{
    Campaign, Error, Progress, ProgressState, RunOutcome, RunRequest, Silent, Simulator,
    SimulatorError,
};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// y = 2 x, in `x` milliseconds; counts its runs; x = 13 fails.
#[derive(Default)]
struct Toy {
    runs: AtomicUsize,
}

impl Simulator for Toy {
    fn version(&self) -> String {
        "toy 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.runs.fetch_add(1, Ordering::SeqCst);
        let x = request.parameter("x")?;
        std::thread::sleep(Duration::from_secs_f64(x * 1e-3));
        if x == 13.0 {
            let reason = "the drum is empty".into();
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

/// Keeps what it hears.
#[derive(Default)]
struct Listener {
    states: Mutex<Vec<ProgressState>>,
    warnings: Mutex<Vec<String>>,
}

impl Listener {
    fn last(&self) -> ProgressState {
        *self.states.lock().unwrap().last().unwrap()
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.lock().unwrap().clone()
    }
}

impl Progress for Listener {
    fn update(&self, state: &ProgressState) {
        self.states.lock().unwrap().push(*state);
    }
    fn warning(&self, text: &str) {
        self.warnings.lock().unwrap().push(text.into());
    }
}

fn requests(n: u64, x: f64) -> Vec<RunRequest> {
    let request = |seed| RunRequest::new("toy", seed).with_parameter("x", x);
    (0..n).map(request).collect()
}

/// The key of a request.
fn key(request: &RunRequest) -> String {
    campaign::run_store::run_key("toy 1", &request.inputs(), request.seed).unwrap()
}

/// Names of all files other than records.
fn hidden(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.starts_with('.')).collect()
}

/// Leaves a claim that nobody renews, of a process that lives: this one.
fn leave_claim(store: &Store, request: &RunRequest, life: Duration) {
    let Attempt::Won(claim) = store.claim(&key(request), life).unwrap() else {
        unreachable!("nobody else is here");
    };
    std::mem::forget(claim);
}

/// Four campaigns of four workers do 60 runs together: each is done by one of them, and all have the same records.
#[test]
fn campaigns_in_one_folder_share_the_runs() {
    let folder = tempfile::tempdir().unwrap();
    let list = requests(60, 4.0);
    let toys: [Toy; 4] = Default::default();
    let outcomes: Vec<_> = std::thread::scope(|scope| {
        let mut threads = Vec::new();
        for toy in &toys {
            let (folder, list) = (folder.path(), &list);
            threads.push(scope.spawn(move || {
                let store = Store::open(folder).unwrap();
                let listener = Listener::default();
                let campaign = Campaign::new(&store, 4, &listener);
                (campaign.run_all(toy, list).unwrap(), listener.last())
            }));
        }
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    let runs = toys.map(|toy| toy.runs.into_inner());
    assert_eq!(runs.iter().sum::<usize>(), 60, "{runs:?}");
    for ((records, last), runs) in outcomes.iter().zip(runs) {
        assert!(runs > 0 && runs < 60, "they share");
        assert_eq!(records, &outcomes[0].0);
        assert_eq!((last.done, last.total, last.reused), (60, 60, 60 - runs));
        assert_eq!((last.running, last.left_s), (0, Some([0.0; 2])));
    }
    assert!(hidden(folder.path()).is_empty(), "claims are left");
}

/// A run longer than the life of its claim is renewed until it ends; a process that waits for it reports so once.
#[test]
fn a_long_run_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let (toy, listener) = (Toy::default(), Listener::default());
    let list = requests(1, 2200.0);
    let life = Duration::from_millis(800);
    std::thread::scope(|scope| {
        let first = || Campaign::new(&store, 2, &Silent).with_claim_life(life);
        let first = scope.spawn(move || first().run_all(&toy, &requests(1, 2200.0)).unwrap());
        while hidden(folder.path()).is_empty() {
            std::thread::sleep(Duration::from_millis(2));
        }
        let second = Toy::default();
        let campaign = Campaign::new(&store, 2, &listener).with_claim_life(life);
        let records = campaign.run_all(&second, &list).unwrap();
        assert_eq!(records, first.join().unwrap());
        assert_eq!(second.runs.into_inner(), 0);
    });
    let heard = listener.warnings();
    assert_eq!(heard.len(), 1, "{heard:?}");
    assert!(heard[0].contains("waiting for 1 runs"), "{heard:?}");
    assert_eq!((listener.last().done, listener.last().reused), (1, 1));
}

/// Runs that nobody has claimed go first; the one whose owner does not renew its claim is taken over after its life.
#[test]
fn an_abandoned_run_is_taken_over() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(3, 1.0);
    let life = Duration::from_millis(700);
    let begin = Instant::now();
    leave_claim(&store, &list[0], life);
    let toy = Toy::default();
    let records = Campaign::new(&store, 1, &Silent)
        .run_all(&toy, &list)
        .unwrap();
    assert_eq!(records.len(), 3);
    assert_eq!(toy.runs.into_inner(), 3);
    // Two looks at most 0.45 s apart follow the life; the rest is for a busy machine.
    let took = begin.elapsed();
    assert!(took > life && took < life * 6, "{took:?}");
    assert!(hidden(folder.path()).is_empty());
}

/// Who waits for another campaign stops when told so, soon.
#[test]
fn waiting_ends_with_the_stop_flag() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(2, 1.0);
    leave_claim(&store, &list[1], Duration::from_mins(1));
    let (toy, stop) = (Toy::default(), AtomicBool::new(false));
    let campaign = Campaign::new(&store, 2, &Silent).with_stop(&stop);
    let begin = Instant::now();
    let error = std::thread::scope(|scope| {
        let waiting = scope.spawn(|| campaign.run_all(&toy, &list).unwrap_err());
        std::thread::sleep(Duration::from_millis(300));
        stop.store(true, Ordering::SeqCst);
        waiting.join().unwrap()
    });
    assert!(matches!(error, Error::Stopped { n_done: 1, .. }), "{error}");
    assert!(begin.elapsed().as_secs() < 5, "{:?}", begin.elapsed());
}

/// Puts a record into the store at the last moment: after a worker has looked for it in vain, before it claims the run.
struct LastMoment {
    store: Store,
    record: campaign::run_store::Record,
}

impl Progress for LastMoment {
    fn update(&self, state: &ProgressState) {
        if state.done == 0 {
            let name = format!("{}.json", self.record.key());
            std::fs::write(self.store.folder().unwrap().join(name), "cut o").unwrap();
        }
    }
    fn warning(&self, _text: &str) {
        self.store.put(&self.record).unwrap();
    }
}

/// Who has won a claim looks for the record once more: the last owner may have finished just before.
#[test]
fn a_run_that_was_finished_just_before_its_claim_is_not_repeated() {
    let list = requests(1, 1.0);
    let memory = Store::in_memory();
    let expected = Campaign::new(&memory, 1, &Silent)
        .run_all(&Toy::default(), &list)
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let other = LastMoment {
        store: store.clone(),
        record: expected[0].clone(),
    };
    let toy = Toy::default();
    let records = Campaign::new(&store, 1, &other)
        .run_all(&toy, &list)
        .unwrap();
    assert_eq!((records, toy.runs.into_inner()), (expected, 0));
    assert!(hidden(folder.path()).is_empty(), "a claim is left");
}

/// A process that shares the folder does not repeat a run that has failed in another, and reports its reason. Called again, or
/// opened later, a campaign tries it again.
#[test]
fn a_failed_run_is_not_repeated_by_those_who_share_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = [0, 1].map(|_| Store::open(folder.path()).unwrap());
    let toy = Toy::default();
    let attempt = |store: &Store| {
        let campaign = Campaign::new(store, 1, &Silent);
        let error = campaign.run_all(&toy, &requests(1, 13.0)).unwrap_err();
        assert!(
            hidden(folder.path())
                .iter()
                .all(|name| name.ends_with(".failed")),
            "a claim is left"
        );
        (toy.runs.load(Ordering::SeqCst), error)
    };
    assert_eq!([attempt(&first).0, attempt(&first).0], [1, 2]);
    let (runs, error) = attempt(&second);
    assert_eq!(runs, 2, "it was repeated");
    let Error::Run {
        source,
        n_failed: 1,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert!(
        matches!(source, SimulatorError::FailedElsewhere { .. }),
        "{source}"
    );
    assert!(source.to_string().contains("the drum is empty"), "{source}");
    let later = Store::open(folder.path()).unwrap();
    assert_eq!(attempt(&later).0, 3);
    // Its failure, too, is news to the second.
    assert_eq!(attempt(&second).0, 3);
}

/// The note on a failed run goes once the run has a record.
#[test]
fn the_note_on_a_run_that_succeeds_later_goes() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(1, 13.0);
    Campaign::new(&store, 1, &Silent)
        .run_all(&Toy::default(), &list)
        .unwrap_err();
    let note = hidden(folder.path());
    assert_eq!(note.len(), 1, "{note:?}");
    let record = campaign::run_store::Record::new("toy 1", list[0].inputs(), 0).unwrap();
    store.put(&record).unwrap();
    Store::open(folder.path()).unwrap();
    assert!(hidden(folder.path()).is_empty());
}

/// A campaign whose remaining runs others do ends at its limit, 0.3 s, after it has done its own; a worker looks at the latest
/// 0.2 s later, and the rest is for a busy machine.
#[test]
fn a_campaign_waits_for_others_no_longer_than_its_limit() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(3, 1.0);
    leave_claim(&store, &list[1], Duration::from_mins(1));
    let (toy, limit) = (Toy::default(), Duration::from_millis(300));
    let begin = Instant::now();
    let error = Campaign::new(&store, 2, &Silent)
        .with_wait(Some(limit))
        .run_all(&toy, &list)
        .unwrap_err();
    assert!(
        matches!(
            error,
            Error::Waited {
                n_left: 1,
                n_runs: 3
            }
        ),
        "{error}"
    );
    assert_eq!(toy.runs.into_inner(), 2);
    let took = begin.elapsed();
    assert!(took >= limit && took < limit * 10, "{took:?}");
}

/// Where runs cannot be claimed they are done all the same; the listener hears of it once.
#[test]
fn a_claim_that_cannot_be_made_blocks_no_run() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let list = requests(4, 1.0);
    for request in &list {
        let claim = format!(".{}.claim", key(request));
        std::fs::create_dir(folder.path().join(claim)).unwrap();
    }
    let (toy, listener) = (Toy::default(), Listener::default());
    Campaign::new(&store, 2, &listener)
        .run_all(&toy, &list)
        .unwrap();
    assert_eq!(toy.runs.into_inner(), 4);
    let heard = listener.warnings();
    assert_eq!(heard.len(), 1, "{heard:?}");
    assert!(heard[0].contains("cannot be claimed"), "{heard:?}");
}

/// Records in memory are of one process alone, and need no claims.
#[test]
fn a_store_in_memory_is_worked_through_without_claims() {
    let store = Store::in_memory();
    let (toy, listener) = (Toy::default(), Listener::default());
    let list = requests(8, 1.0);
    Campaign::new(&store, 4, &listener)
        .run_all(&toy, &list)
        .unwrap();
    assert_eq!(toy.runs.into_inner(), 8);
    assert!(listener.warnings().is_empty());
}
