//! What a study gives.

use crate::compare::ComparedValue;
use crate::defaults::DefaultUsed;
use crate::next::NextRow;
use campaign::run_store::Record;
use inference::{Calibration, DiagnosisStage};
use scene::TimeSpent;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Everything that a study found.
///
/// Its JSON has the keys of the calibration at the top (`parameters`, `correlation`, `fit`, `check`, `boxes`,
/// `diagnosis` ...) beside its own; `cost` is the whole cost with the stages inside.
#[derive(Debug, Clone)]
pub struct StudyResult {
    /// Name of the study.
    pub name: String,
    /// Name of the profile.
    pub profile: Option<String>,
    /// Version of the program.
    pub version: String,
    /// First seed.
    pub seed: u64,
    /// SHA-256 of every file that was read.
    pub inputs: BTreeMap<String, String>,
    /// Result of the calibration.
    pub calibration: Calibration,
    /// The records of the runs behind its measurements and its surfaces, by key; no part of the JSON.
    pub records: BTreeMap<String, Record>,
    /// What to measure next if parameters are open, the most helpful for its minutes first; no part of the JSON, which has it in the
    /// calibration.
    pub next: Vec<NextRow>,
    /// Published values beside it.
    pub compare: Vec<ComparedValue>,
    /// Entries that the file omits, with the default used.
    pub defaults: Vec<DefaultUsed>,
    /// Effects that a measured scene cannot carry, with the reason.
    pub not_applicable: BTreeMap<String, String>,
    /// Cost of its runs and of this call.
    pub spent: TimeSpent,
}

impl StudyResult {
    /// What depends in its JSON on the clock and on which runs were there before, by pointers.
    pub const CLOCK: [&str; 1] = ["/cost"];
}

/// What a study cost.
#[derive(Debug, Serialize)]
struct Cost<'a> {
    /// Different runs of all stages; one that two stages ask for counts in both.
    runs: usize,
    #[serde(flatten)]
    spent: TimeSpent,
    stages: &'a [inference::StageCost],
}

/// The keys beside those of the calibration.
#[derive(Debug, Serialize)]
struct Written<'a> {
    /// Name of the study.
    name: &'a str,
    /// Name of the profile.
    profile: Option<&'a str>,
    /// Version of the program.
    version: &'a str,
    /// First seed.
    seed: u64,
    /// SHA-256 of every file that was read.
    inputs: &'a BTreeMap<String, String>,
    /// The calibration, without its cost.
    #[serde(flatten)]
    calibration: serde_json::Map<String, serde_json::Value>,
    /// Published values.
    compare: &'a [ComparedValue],
    /// What was filled in.
    defaults: &'a [DefaultUsed],
    /// Effects left out.
    not_applicable: &'a BTreeMap<String, String>,
    cost: Cost<'a>,
}

impl Serialize for StudyResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = serde_json::to_value(&self.calibration).map_err(serde::ser::Error::custom)?;
        let serde_json::Value::Object(mut calibration) = value else {
            return Err(serde::ser::Error::custom("a calibration is not an object"));
        };
        calibration.remove("cost");
        let stages = &self.calibration.cost;
        let written = Written {
            name: &self.name,
            profile: self.profile.as_deref(),
            version: &self.version,
            seed: self.seed,
            inputs: &self.inputs,
            calibration,
            compare: &self.compare,
            defaults: &self.defaults,
            not_applicable: &self.not_applicable,
            cost: Cost {
                runs: stages.iter().map(|s| s.runs).sum(),
                spent: self.spent,
                stages,
            },
        };
        written.serialize(serializer)
    }
}

/// Result of a diagnosis alone.
#[derive(Debug, Clone, Serialize)]
pub struct DiagnosisResult {
    /// Name of the study.
    pub name: String,
    /// Name of the profile.
    pub profile: Option<String>,
    /// Version of the program.
    pub version: String,
    /// First seed.
    pub seed: u64,
    /// SHA-256 of every file that was read.
    pub inputs: BTreeMap<String, String>,
    /// The parameters from which it started, by symbol.
    pub at: BTreeMap<String, f64>,
    /// The diagnosis.
    pub diagnosis: DiagnosisStage,
    /// Candidates for the next measurement, the most helpful for its minutes first; empty if nothing is in question.
    pub next: Vec<NextRow>,
    /// Entries that the file omits, with the default used.
    pub defaults: Vec<DefaultUsed>,
    /// Effects that a measured scene cannot carry, with the reason.
    pub not_applicable: BTreeMap<String, String>,
    /// Cost of its runs and of this call.
    #[serde(flatten)]
    pub spent: TimeSpent,
}

impl DiagnosisResult {
    /// What depends in its JSON on the clock, by pointers.
    pub const CLOCK: [&str; 4] = ["/core_s", "/phases", "/wall_s", "/waiting_s"];
}
