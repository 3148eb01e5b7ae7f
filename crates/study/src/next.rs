//! What could be measured next, with what it costs.

use crate::price::mean_core_seconds;
use crate::{Error, Study};
use campaign::run_store::Store;
use inference::{DiagnosisStage, NextForParameters};
use serde::Serialize;
use std::fmt::Write as _;

/// A measurement that could be made next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextRow {
    /// Its name: the scene with the condition.
    pub name: String,
    /// Criterion with it: the smallest separation, or the expected score, in standard errors.
    pub criterion: f64,
    /// Work in the laboratory, min.
    pub minutes: f64,
    /// Runs that a diagnosis with it does there at least, or that a calibration did.
    pub runs: usize,
    /// Time of one core for these, s; `None` if the runs there have no time.
    pub core_s: Option<f64>,
    /// Text to add to the study file once it is measured.
    pub block: String,
}

/// The table of a diagnosis, in the order of its ranking.
pub(crate) fn table(
    study: &Study,
    stage: &DiagnosisStage,
    store: &Store,
) -> Result<Vec<NextRow>, Error> {
    let DiagnosisStage::Done(done) = stage else {
        return Ok(Vec::new());
    };
    let ranked = done.diagnosis.next_measurement.iter();
    let mut rows = Vec::new();
    for ranked in ranked.flat_map(|next| &next.ranked) {
        let offered = done.offered.iter().find(|o| o.name == ranked.experiment);
        let Some(offered) = offered else { continue };
        let each = mean_core_seconds(store, &offered.keys)?;
        rows.push(NextRow {
            name: offered.name.clone(),
            criterion: ranked.criterion,
            minutes: offered.minutes,
            runs: offered.runs,
            core_s: each.map(|s| s * offered.runs as f64),
            block: block(study, &offered.name),
        });
    }
    Ok(rows)
}

/// The table of a calibration that leaves parameters open, in the order of its ranking.
pub(crate) fn table_for_parameters(
    study: &Study,
    next: Option<&NextForParameters>,
    store: &Store,
) -> Result<Vec<NextRow>, Error> {
    let ranked = next.into_iter().flat_map(|next| &next.ranked);
    let row = |ranked: &inference::RankedMeasurement| {
        let each = mean_core_seconds(store, &ranked.keys)?;
        Ok(NextRow {
            name: ranked.name.clone(),
            criterion: ranked.separation,
            minutes: ranked.minutes,
            runs: ranked.runs,
            core_s: each.map(|s| s * ranked.runs as f64),
            block: block(study, &ranked.name),
        })
    };
    ranked.map(row).collect()
}

/// The `[[measured]]` table of a candidate, with dots for what is not known yet.
fn block(study: &Study, name: &str) -> String {
    let all = study.problem.candidates.iter();
    let Some(candidate) = all.into_iter().find(|c| c.model.name == name) else {
        return String::new();
    };
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut text = format!("[[measured]]\nscene = {}\n", quoted(&candidate.model.scene));
    let condition = candidate.model.condition.iter();
    let condition: Vec<String> = condition
        .map(|(key, value)| format!("{} = {}", quoted(key), quoted(value)))
        .collect();
    // Writing to a string cannot fail.
    if !condition.is_empty() {
        let _ = writeln!(text, "condition = {{ {} }}", condition.join(", "));
    }
    text.push_str("role = \"fit\"\n");
    for observable in candidate.standard_errors.keys() {
        let _ = writeln!(text, "{observable} = {{ mean = ..., sd = ..., n = ... }}");
    }
    text
}
