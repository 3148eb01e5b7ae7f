//! What a report is made of.

use campaign::run_store::Record;
use inference::diagnosis::TrialRow;
use inference::{Calibration, CalibrationProblem, ResidualStudy};
use scene::{FillingLibrary, Scene, TimeSpent};
use std::collections::BTreeMap;

/// Everything that the report of a calibration shows.
#[derive(Debug, Clone, Copy)]
pub struct ReportInput<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// Profile that was run.
    pub profile: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// First seed.
    pub seed: u64,
    /// SHA-256 of each input file, by file.
    pub inputs: &'a BTreeMap<String, String>,
    /// The problem that was solved.
    pub problem: &'a CalibrationProblem,
    /// The result.
    pub calibration: &'a Calibration,
    /// Values of others to be printed beside results.
    pub compare: &'a [ComparedValue],
    /// Defaults for entries that the file omits, one sentence each.
    pub defaults: &'a [String],
    /// Scenes by name of the model.
    pub scenes: &'a BTreeMap<String, Scene>,
    /// Bodies of the seeds of these scenes; one that is missing is filled again.
    pub fillings: &'a FillingLibrary,
    /// Records of the runs behind the comparisons and the surfaces, by key; a picture whose record is missing is left out.
    pub records: &'a BTreeMap<String, Record>,
    /// Curves that were measured.
    pub curves: &'a [CurvePoints],
    /// Cost of the runs and of this call.
    pub spent: TimeSpent,
}

/// A measured curve, to be drawn beside those of the runs.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoints {
    /// Name of its model.
    pub model: String,
    /// Name of the curve.
    pub name: String,
    /// Column along which it goes, with its unit at the end.
    pub along: String,
    /// Column of its values, with its unit at the end.
    pub column: String,
    /// Points of each repeat.
    pub repeats: Vec<Vec<[f64; 2]>>,
}

/// A value that somebody else gave, beside what was found here.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedValue {
    /// Name of the result; its ending is its unit.
    pub result: String,
    /// Value found here; `None` if this calibration does not give it.
    pub found: Option<f64>,
    /// Standard error of what was found.
    pub se: Option<f64>,
    /// The other value.
    pub value: f64,
    /// Standard deviation of the other value as its source gives it.
    pub sd: Option<f64>,
    /// Where the other value stands.
    pub source: String,
}

/// Everything that the report of a diagnosis alone shows.
#[derive(Debug, Clone, Copy)]
pub struct DiagnosisInput<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// First seed.
    pub seed: u64,
    /// SHA-256 of each input file, by file.
    pub inputs: &'a BTreeMap<String, String>,
    /// Defaults for entries that the file omits, one sentence each.
    pub defaults: &'a [String],
    /// Effects that the scenes cannot carry, with the reason.
    pub not_applicable: &'a BTreeMap<String, String>,
    /// Largest number of runs of the plan.
    pub planned_runs: usize,
    /// Cost of the runs and of this call.
    pub spent: TimeSpent,
    /// The study of the residual.
    pub study: &'a ResidualStudy,
    /// Result of the rules in drawn campaigns at these conditions, with this library and noise; empty if nothing
    /// was drawn.
    pub trials: &'a [TrialRow],
}
