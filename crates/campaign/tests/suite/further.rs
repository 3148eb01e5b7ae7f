//! What requests read from a record beside its observables.

use campaign::run_store::{Lookup, Observation, Record, Store};
use campaign::{
    Campaign, Cores, Error, PreparedRun, RunOutcome, RunRequest, Silent, Simulator, SimulatorError,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Keeps a list; the model of a request is the place in it that the request reads.
#[derive(Default)]
struct Lister {
    runs: AtomicUsize,
}

impl Simulator for Lister {
    fn version(&self) -> String {
        "lister 1".into()
    }

    fn run(&self, _: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.runs.fetch_add(1, Ordering::SeqCst);
        Ok(RunOutcome {
            details: json!([3.0, 5.0]),
            ..RunOutcome::default().with_observable("sum", Observation::of_one(8.0, "1"))
        })
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        Ok(Box::new(Same(self, request.clone())))
    }

    fn read_further(
        &self,
        request: &RunRequest,
        record: &Record,
    ) -> Result<BTreeMap<String, Observation>, SimulatorError> {
        let place: usize = request.model.parse().expect("a number");
        let value = record.details()[place].as_f64();
        let value = value.ok_or_else(|| SimulatorError::Failed {
            reason: format!("no place {place}"),
        })?;
        let read = Observation::of_one(value, "1");
        Ok(BTreeMap::from([("read".to_owned(), read)]))
    }
}

/// The one run, whatever its model is called.
struct Same<'s>(&'s Lister, RunRequest);

impl PreparedRun for Same<'_> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        Ok(json!({}))
    }

    fn run(&self, _: &Cores) -> Result<RunOutcome, SimulatorError> {
        self.0.run(&self.1)
    }
}

/// Two requests that are one run read different places of its record, also when it is found again; the file holds neither reading. A
/// request that asks for what is not there costs itself alone.
#[test]
fn requests_for_one_run_read_it_in_their_own_ways() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let simulator = Lister::default();
    let campaign = Campaign::new(&store, 1, &Silent);
    let requests = ["0", "1", "7"].map(|model| RunRequest::new(model, 1));
    for _ in 0..2 {
        let records = campaign.run_all(&simulator, &requests[..2]).unwrap();
        let read: Vec<f64> = records
            .iter()
            .map(|r| r.observables()["read"].mean)
            .collect();
        assert_eq!(read, [3.0, 5.0]);
        assert_eq!(records[1].observables()["sum"].mean, 8.0);
    }
    let Lookup::Found(kept) = store.get(&store.keys().unwrap()[0]).unwrap() else {
        panic!("the record is gone");
    };
    assert_eq!(kept.observables().keys().collect::<Vec<_>>(), ["sum"]);
    let each = campaign.run_each(&simulator, &requests).unwrap();
    assert!(each[0].is_ok() && each[1].is_ok());
    assert!(each[2].as_ref().unwrap_err().contains("no place 7"));
    let refused = campaign.run_all(&simulator, &requests).unwrap_err();
    assert!(matches!(refused, Error::Run { n_failed: 1, .. }));
    assert_eq!(simulator.runs.load(Ordering::SeqCst), 1);
}
