//! A record like those of real runs, in its small parts; and workers that share a folder.
use campaign::run_store::{Attempt, CLAIM_LIFE, Lookup, Observation, Record, Store};
use serde_json::json;
use std::path::Path;
use std::time::Duration;

/// Number of runs that workers share.
pub(crate) const RUNS: usize = 48;

/// A record with numbers whose last bits matter.
pub(crate) fn record(seed: u64) -> Record {
    let angle = Observation {
        mean: 38.870000000000005,
        sd: Some(0.1 + 0.2),
        n: 10,
        unit: "deg".into(),
    };
    Record::new(
        "0.1.0",
        json!({"rpm": 14.999999999999998, "model": "drum"}),
        seed,
    )
    .expect("the record is sound")
    .with_observable("angle", angle)
    .expect("the record is sound")
    .with_details(json!({"wall_s": 1.25, "series": [0.1, 2.2250738585072014e-308]}))
}

/// Does the runs that nobody has done or claimed, until each has a record; gives the number that it did. Each worker
/// begins at another run.
pub(crate) fn work_through(folder: &Path, worker: usize) -> usize {
    let store = Store::open(folder).expect("the folder can be opened");
    let mut left: Vec<u64> = (0..RUNS as u64).collect();
    left.rotate_left(worker % RUNS * 7 % RUNS);
    let mut done = 0;
    while !left.is_empty() {
        left.retain(|seed| {
            let run = record(*seed);
            let has_record = || matches!(store.get(run.key()), Ok(Lookup::Found(_)));
            if has_record() {
                return false;
            }
            let attempt = store.claim(run.key(), CLAIM_LIFE);
            let Attempt::Won(claim) = attempt.expect("it can be claimed") else {
                return true;
            };
            if !has_record() {
                std::thread::sleep(Duration::from_millis(1));
                store.put(&run).expect("it can be stored");
                done += 1;
            }
            drop(claim);
            false
        });
        std::thread::sleep(Duration::from_millis(2));
    }
    done
}
