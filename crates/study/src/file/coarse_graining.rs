//! `[coarse_graining]`: runs with grains coarser than the real ones.

use crate::document::{Fields, below};
use crate::keys;
use crate::problem::Problems;
use serde::Serialize;

/// Standard error of what the trend carries, in standard errors of what was measured, if the file states none. Our choice: an interval
/// is then at most 1.4 times as wide as that of runs with real grains.
pub(crate) const USUAL_ERROR: f64 = 1.0;

/// Largest factor: a scale of the scenes.
const COARSEST: f64 = 100.0;

/// The sizes of the grains of the runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoarseGrainingEntry {
    /// Names of the scenes whose grains are coarser in the runs.
    pub scenes: Vec<String>,
    /// Diameter of the grains over the real one, the coarsest first.
    pub factors: Vec<f64>,
    /// Largest standard error of what is carried to the real size, in standard errors of what was measured.
    pub error: Option<f64>,
    /// Where it stands.
    #[serde(skip)]
    pub(crate) path: String,
}

/// Reads the table; what is invalid is told.
pub(super) fn coarse_graining(
    root: &Fields<'_>,
    problems: &mut Problems,
) -> Option<CoarseGrainingEntry> {
    let fields = root.table("coarse_graining", problems)?;
    fields.check_keys(&keys::COARSE_GRAINING, problems);
    let kind = "a list of numbers without a unit: the diameter of the grains of the runs over that of the grains of the scene";
    let factors: Option<Vec<f64>> = fields.required("factors", kind, problems);
    let scenes: Option<Vec<String>> = fields.required("scenes", "a list of names", problems);
    let error: Option<f64> = fields.optional("error", "a number", problems);
    if error.is_some_and(|error| !(error.is_finite() && error > 0.0)) {
        let problem = "must be above 0: the largest error, in standard errors of what was measured";
        problems.add(fields.wrong("error", problem));
    }
    let names = root.table.get("scene").and_then(toml::Value::as_array);
    let names = names.into_iter().flatten();
    let names: Vec<&str> = names.filter_map(|s| s.get("name")?.as_str()).collect();
    for (k, name) in scenes.iter().flatten().enumerate() {
        if !names.contains(&name.as_str()) {
            let at = below(&below(&fields.path, "scenes"), k);
            let what = format!("[coarse_graining]: scenes: '{name}'");
            let problem = format!("is no [[scene]]; there are {}", names.join(", "));
            problems.add(fields.document.problem(&at, what, problem));
        }
    }
    if scenes.as_ref().is_some_and(Vec::is_empty) {
        problems.add(fields.wrong("scenes", "is empty: name the scenes"));
    }
    let mut factors = factors?;
    if let Some(problem) = wrong_factors(&factors) {
        problems.add(fields.wrong("factors", problem));
        return None;
    }
    factors.sort_by(|a, b| b.total_cmp(a));
    Some(CoarseGrainingEntry {
        scenes: scenes?,
        factors,
        error,
        path: fields.path.clone(),
    })
}

/// What is wrong with factors that tell no trend, as the rest of a sentence about them.
fn wrong_factors(factors: &[f64]) -> Option<String> {
    let is_coarser = |f: &&f64| f.is_finite() && **f > 1.0 && **f <= COARSEST;
    if let Some(factor) = factors.iter().find(|f| !is_coarser(f)) {
        return Some(format!(
            "has {factor}: a factor must be above 1, since the grains of the scene are the real ones, and {COARSEST} at most"
        ));
    }
    let twice = |k: usize| factors[..k].contains(&factors[k]);
    if (0..factors.len()).any(twice) {
        return Some("has one size twice: each must differ from the others".into());
    }
    (factors.len() < 2).then(|| "has one size: a trend with the size needs two or more".into())
}
