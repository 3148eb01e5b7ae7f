//! Runs that are done elsewhere than on the threads of the campaign.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use campaign::run_store::{Observation, Store};
use campaign::{
    Campaign, Error, Executor, ExecutorError, PendingRun, RunEvent, RunOutcome, RunRequest, Silent,
    Simulator, SimulatorError,
};
use std::sync::Mutex;

/// y = 2 x; x = 13 fails.
struct Doubler;

impl Simulator for Doubler {
    fn version(&self) -> String {
        "doubler 1".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let x = request.parameter("x")?;
        let y = Observation {
            mean: 2.0 * x,
            sd: None,
            n: 1,
            unit: "1".into(),
        };
        Ok(RunOutcome::default().with_observable("y", y))
    }

    fn expected_cost(&self, request: &RunRequest) -> f64 {
        request.parameter("x").unwrap_or(1.0)
    }
}

/// Another campaign in the place of a cluster: it sees the requests alone, and leaves records in the store.
#[derive(Default)]
struct Elsewhere {
    /// Keys in the order in which they were asked for.
    asked: Mutex<Vec<String>>,
    /// Whether it lies: tells a run as done without a record.
    lies: bool,
    /// Whether it alters the record behind the back of the store.
    spoils: bool,
    /// Whether it breaks down after the first run.
    breaks: bool,
}

impl Executor for Elsewhere {
    fn execute(
        &self,
        runs: &[PendingRun<'_>],
        store: &Store,
        stopped: &dyn Fn() -> bool,
        tell: &mut dyn FnMut(RunEvent),
    ) -> Result<(), ExecutorError> {
        for (k, run) in runs.iter().enumerate() {
            if stopped() {
                return Ok(());
            }
            self.asked.lock().unwrap().push(run.key.to_owned());
            tell(RunEvent::Began(k));
            if run.request.parameter("x").unwrap() == 13.0 {
                let reason = "node lost".into();
                tell(RunEvent::Failed(k, SimulatorError::Failed { reason }));
                continue;
            }
            if !self.lies {
                Campaign::new(store, 1, &Silent)
                    .run_all(&Doubler, std::slice::from_ref(run.request))
                    .unwrap();
            }
            if self.spoils {
                let file = store.folder().unwrap().join(format!("{}.json", run.key));
                let text = std::fs::read_to_string(&file).unwrap();
                std::fs::write(file, text.replace("4.0", "4.1")).unwrap();
            }
            tell(RunEvent::Done(k));
            if self.breaks {
                return Err(ExecutorError {
                    reason: "the queue does not answer".into(),
                });
            }
        }
        Ok(())
    }
}

fn requests(xs: &[f64]) -> Vec<RunRequest> {
    let request = |x: &f64| RunRequest::new("toy", 1).with_parameter("x", *x);
    xs.iter().map(request).collect()
}

/// The same records as by the threads of the campaign; longest runs are asked for first, and each once.
#[test]
fn runs_done_elsewhere_give_the_same_records() {
    let list = requests(&[1.0, 3.0, 2.0, 3.0]);
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let [here, there] = folders.each_ref().map(|f| Store::open(f.path()).unwrap());
    let local = Campaign::new(&here, 2, &Silent).run_all(&Doubler, &list);
    let elsewhere = Elsewhere::default();
    let campaign = Campaign::new(&there, 2, &Silent).with_executor(&elsewhere);
    let remote = campaign.run_all(&Doubler, &list).unwrap();
    assert_eq!(remote, local.unwrap());
    let expected: Vec<&str> = [1, 2, 0].map(|k| remote[k].key()).to_vec();
    assert_eq!(*elsewhere.asked.lock().unwrap(), expected);
    campaign.run_all(&Doubler, &list).unwrap();
    assert_eq!(
        elsewhere.asked.lock().unwrap().len(),
        3,
        "nothing is asked for again"
    );
}

/// A run that fails elsewhere is told with its reason, and the others are kept.
#[test]
fn a_run_that_fails_elsewhere_costs_its_own_record() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let elsewhere = Elsewhere::default();
    let campaign = Campaign::new(&store, 1, &Silent).with_executor(&elsewhere);
    let each = campaign
        .run_each(&Doubler, &requests(&[13.0, 2.0]))
        .unwrap();
    assert!(each[0].as_ref().unwrap_err().contains("node lost"));
    assert_eq!(each[1].as_ref().unwrap().observable("y").unwrap().mean, 4.0);
}

/// A run that is told as done and has no record is a failure, not a success; an executor that breaks down ends the
/// campaign with what it kept.
#[test]
fn an_executor_is_not_believed_without_a_record() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let liar = Elsewhere {
        lies: true,
        ..Elsewhere::default()
    };
    let campaign = Campaign::new(&store, 1, &Silent).with_executor(&liar);
    let error = campaign.run_all(&Doubler, &requests(&[2.0])).unwrap_err();
    assert!(matches!(error, Error::Run { n_failed: 1, .. }), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let vandal = Elsewhere {
        spoils: true,
        ..Elsewhere::default()
    };
    let campaign = Campaign::new(&store, 1, &Silent).with_executor(&vandal);
    let each = campaign.run_each(&Doubler, &requests(&[2.0])).unwrap();
    let reason = each[0].as_ref().unwrap_err();
    assert!(reason.contains("altered"), "{reason}");
    let broken = Elsewhere {
        breaks: true,
        ..Elsewhere::default()
    };
    let campaign = Campaign::new(&store, 1, &Silent).with_executor(&broken);
    let error = campaign
        .run_all(&Doubler, &requests(&[2.0, 3.0]))
        .unwrap_err();
    assert!(matches!(error, Error::Executor(_)), "{error}");
    let set_aside_and_done_again = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(
        (store.keys().unwrap().len(), set_aside_and_done_again),
        (1, 2)
    );
}
