//! The runs of a design table, and the table of their results.

use super::folder::{FRICTION, Folder};
use campaign::run_store::{Observation, Record, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use experiment_design::table::Table;
use std::sync::atomic::AtomicBool;
use study::Error;

/// Gives the friction as an angle, and nothing for 0.3.
struct Toy;

impl Simulator for Toy {
    fn version(&self) -> String {
        "toy".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let mean = request.parameter(FRICTION)?;
        if mean == 0.3 {
            let reason = "no \"surface\",\nnone at all".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        let unit = "deg".to_owned();
        let angle = Observation {
            mean,
            sd: None,
            n: 1,
            unit,
        };
        Ok(RunOutcome::default().with_observable("angle_deg", angle))
    }
}

/// The table of results has all columns and runs of the design in its order; a run that fails leaves its cells empty
/// and says why.
#[test]
fn a_run_that_fails_costs_its_own_row() {
    let table = format!("run,{FRICTION},note,replicates\n1,0.4,\"a, b\",1\n2,0.3,c,1\n3,0.1,d,2\n");
    let table = Folder::new(&table).keep("note").read().unwrap();
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = table.plan(&Toy, Some(&store)).unwrap();
    assert_eq!((plan.rows, plan.runs, plan.kept), (3, 4, 0));
    let outcomes = table.run(&campaign, &Toy).unwrap();
    let results = Table::parse(&table.results_csv(&outcomes)).unwrap();
    let column = |name: &str| -> Vec<&str> {
        let column = results.column(name).unwrap();
        results.rows().iter().map(|row| row.text(column)).collect()
    };
    assert_eq!(column("run"), ["1", "2", "3", "3"]);
    assert_eq!(column("note"), ["a, b", "c", "d", "d"]);
    assert_eq!(column("repeat"), ["1", "1", "1", "2"]);
    assert_eq!(column("seed"), ["11", "12", "13", "14"]);
    assert_eq!(column("angle_deg"), ["0.4", "", "0.1", "0.1"]);
    let problem = "the run failed: no \"surface\", none at all";
    assert_eq!(column("problem"), ["", problem, "", ""]);
    let keys = column("key");
    assert_eq!(keys[1], "");
    assert_eq!(Ok(keys[0]), outcomes[0].as_ref().map(Record::key));
    assert!(
        results.column("standard_error_deg").is_err(),
        "nobody has one"
    );
    assert_eq!(table.plan(&Toy, Some(&store)).unwrap().kept, 3);
}

/// A raised flag ends the runs with an error that says how far they came.
#[test]
fn a_stop_is_told_as_such() {
    let table = Folder::new(&format!("{FRICTION}\n0.4\n")).read().unwrap();
    let (store, stop) = (Store::in_memory(), AtomicBool::new(true));
    let campaign = Campaign::new(&store, 1, &Silent).with_stop(&stop);
    let error = table.run(&campaign, &Toy).unwrap_err();
    assert!(matches!(
        error,
        Error::Campaign(campaign::Error::Stopped {
            n_done: 0,
            n_runs: 1
        })
    ));
}

/// A column `seed` of the design stands once in the results, with the seed of each run.
#[test]
fn the_seed_of_a_row_gives_way_to_that_of_its_runs() {
    let table = format!("seed,{FRICTION},replicates\n5,0.4,2\n");
    let table = Folder::new(&table).read().unwrap();
    let store = Store::in_memory();
    let outcomes = table.run(&Campaign::new(&store, 1, &Silent), &Toy);
    let results = table.results_csv(&outcomes.unwrap());
    let header = format!("{FRICTION},replicates,repeat,seed,regime,steady,angle_deg,key,problem");
    let lines: Vec<&str> = results.lines().collect();
    assert_eq!(lines[0], header);
    assert!(lines[1].starts_with("0.4,2,1,5,,,0.4,"), "{results}");
    assert!(lines[2].starts_with("0.4,2,2,6,,,0.4,"), "{results}");
}
