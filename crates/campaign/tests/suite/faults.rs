//! Every operation of the disk goes wrong once: no record is lost, none is wrong, and the next call ends with the same results.

use campaign::run_store::{Disk, Fault, Lookup, Observation, Record, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// A simulator in closed form that writes down what it was asked.
#[derive(Debug, Default)]
struct Square {
    /// Seeds of the runs that it did.
    asked: Mutex<Vec<u64>>,
}

impl Simulator for Square {
    fn version(&self) -> String {
        "square 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.asked.lock().expect("no panic").push(request.seed);
        let x = request.parameter("x")?;
        Ok(RunOutcome::default().with_observable(
            "square",
            Observation {
                mean: x * x,
                sd: None,
                n: 1,
                unit: "1".into(),
            },
        ))
    }
}

/// The process of a claim that was not given back lives on here, so that its time must run out: short against the test.
const LIFE: Duration = Duration::from_millis(50);

/// Faults tried at a time.
const THREADS: u8 = 16;

/// Four runs.
fn requests() -> Vec<RunRequest> {
    let runs = (1..=4_u32).map(|k| (f64::from(k) + 0.5, u64::from(k)));
    runs.map(|(x, seed)| RunRequest::new("square", seed).with_parameter("x", x))
        .collect()
}

/// All records that are whole, by a sound store; other files must be reported as damaged.
fn kept(folder: &Path, all: &[Record]) -> Vec<u64> {
    let store = Store::open(folder).expect("opens");
    let mut seeds = Vec::new();
    for record in all {
        match store.get(record.key()).expect("can be read") {
            Lookup::Found(found) => {
                assert_eq!(found, *record, "a wrong record is believed");
                seeds.push(record.seed());
            }
            Lookup::Absent | Lookup::Damaged { .. } => {}
        }
    }
    seeds
}

/// Lets one operation of a campaign go wrong, and the next call put it right. Returns whether the first call met the fault.
fn goes_wrong(fault: Fault, operation: u64, whole: &[Record]) -> bool {
    let place = tempfile::tempdir().expect("a folder");
    let at = format!("{fault:?} at operation {operation}");
    let first = Square::default();
    let result = Store::open_on(place.path(), Disk::with_fault(fault, operation))
        .map_err(|error| error.to_string())
        .and_then(|store| {
            let campaign = Campaign::new(&store, 1, &Silent).with_claim_life(LIFE);
            let done = campaign.run_all(&first, &requests());
            done.map_err(|error| error.to_string())
        });
    let before = kept(place.path(), whole);
    if let Ok(records) = &result {
        assert_eq!(*records, whole, "{at}");
        assert_eq!(before.len(), 4, "{at}: a record is reported and not kept");
    }
    // The next call on a sound disk, as after a restart.
    let again = Square::default();
    let store = Store::open(place.path()).expect("opens");
    let records = Campaign::new(&store, 1, &Silent).with_claim_life(LIFE);
    let records = records.run_all(&again, &requests());
    assert_eq!(records.expect("a sound disk"), whole, "{at}");
    let asked = again.asked.into_inner().expect("no panic");
    let twice = asked.iter().filter(|seed| before.contains(seed)).count();
    assert_eq!(twice, 0, "{at}: a record was lost");
    assert_eq!(asked.len() + before.len(), 4, "{at}");
    assert_eq!(store.keys().expect("only records").len(), 4, "{at}");
    result.is_err()
}

/// The number of operations that a campaign takes is not known before: faults are moved on until none is met any more.
#[test]
fn any_operation_may_go_wrong() {
    let sound = tempfile::tempdir().expect("a folder");
    let store = Store::open(sound.path()).expect("opens");
    let whole = Campaign::new(&store, 1, &Silent).run_all(&Square::default(), &requests());
    let whole = whole.expect("a sound disk");
    let needed = store.operations().expect("it is in a folder");
    assert!(needed > 40, "{needed} operations for four records");
    for fault in [Fault::Fails, Fault::Fills, Fault::Tears] {
        let met = AtomicUsize::new(0);
        // Most of the time is spent waiting for the disk and for claims to run out.
        std::thread::scope(|scope| {
            for first in 0..THREADS {
                let (whole, met) = (&whole, &met);
                scope.spawn(move || {
                    let operations = u64::from(first)..needed + 8;
                    for operation in operations.step_by(THREADS.into()) {
                        let is_met = goes_wrong(fault, operation, whole);
                        met.fetch_add(usize::from(is_met), Ordering::Relaxed);
                    }
                });
            }
        });
        let met = met.into_inner();
        assert!(met > 4, "{fault:?} was met {met} times");
    }
}
