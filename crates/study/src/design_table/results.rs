//! The results of the runs of a design table, as a table.

use super::columns::SEED;
use super::{DesignTable, cells};
use campaign::run_store::Record;
use experiment_design::table::csv_field;
use scene::Scene;
use simulators::scene_simulator::{RunDetails, no_surface_of};
use std::collections::BTreeSet;

/// Standard error of the angle over the time of a run.
const STANDARD_ERROR: &str = "standard_error_deg";

/// Columns that every table of results has, beside the seed and the observables.
const ALWAYS: [&str; 5] = ["repeat", "regime", "steady", "key", "problem"];

/// All names that the results of a scene may use.
pub(super) fn names_of(scene: &Scene) -> Vec<String> {
    let names = ALWAYS.into_iter().chain([STANDARD_ERROR]);
    let names = names.chain(scene.observables());
    names.map(str::to_owned).collect()
}

impl DesignTable {
    /// The results as a table: one row for each run, in the order of the design, with all its columns, then
    /// `repeat`, `seed`, `regime`, `steady`, the mean of each observable, `standard_error_deg` of the angle if a run
    /// has one, the `key` of the record, and the `problem` of a run that has none, or no surface to read an angle from. What a run does not have is empty.
    ///
    /// `outcomes` are those of [`DesignTable::run`], in the order of the runs.
    pub fn results_csv(&self, outcomes: &[Result<Record, String>]) -> String {
        let records = || outcomes.iter().filter_map(|outcome| outcome.as_ref().ok());
        let observables: BTreeSet<&str> = records()
            .flat_map(|record| record.observables().keys().map(String::as_str))
            .collect();
        let has_error = records().any(|record| error_of(record).is_some());
        let error_name = has_error.then_some(STANDARD_ERROR);
        let header = self.table.header();
        // The seed of the run is in its own column.
        let own: Vec<usize> = (0..header.len()).filter(|i| header[*i] != SEED).collect();
        let names = own.iter().map(|i| header[*i].as_str());
        let names = names.chain(["repeat", SEED, "regime", "steady"]);
        let names = names.chain(observables.iter().copied()).chain(error_name);
        let names: Vec<String> = names.chain(["key", "problem"]).map(csv_field).collect();
        let mut text = names.join(",") + "\n";
        for (run, outcome) in self.runs.iter().zip(outcomes) {
            let row = self.table.rows().get(run.row);
            let record = outcome.as_ref().ok();
            let cell = |column: &usize| row.map_or("", |row| row.text(*column)).to_owned();
            let mut fields: Vec<String> = own.iter().map(cell).collect();
            fields.push(run.repeat.to_string());
            fields.push(run.request.seed.to_string());
            let regime = record.and_then(Record::regime);
            fields.push(regime.unwrap_or_default().to_owned());
            fields.push(word(record.and_then(steady)));
            for name in &observables {
                fields.push(word(
                    record.and_then(|r| r.observable(name)).map(|o| o.mean),
                ));
            }
            if has_error {
                fields.push(word(record.and_then(error_of)));
            }
            fields.push(record.map_or("", Record::key).to_owned());
            let problem = match outcome {
                Ok(record) => no_surface_of(record),
                Err(why) => Some(why.clone()),
            };
            let problem = problem.map(|why| cells::one_line(&why));
            fields.push(problem.unwrap_or_default());
            let fields: Vec<String> = fields.iter().map(|field| csv_field(field)).collect();
            text += &(fields.join(",") + "\n");
        }
        text
    }
}

/// A value as text; empty if there is none.
fn word(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// Whether the bed of a run was steady; `None` if there is no such state.
fn steady(record: &Record) -> Option<bool> {
    RunDetails::of(record).ok()?.steady
}

/// Standard error of the angle of a run, deg.
fn error_of(record: &Record) -> Option<f64> {
    RunDetails::of(record).ok()?.frames.standard_error_deg
}
