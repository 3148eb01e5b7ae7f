//! The report of a diagnosis: what the runs say, and how often these rules are right.

use anyhow::Context as _;
use command_line::Common;
use inference::diagnosis::{Problem, TrialRow, trials, usual_truths};
use inference::{ResidualStudy, runs_needed};
use std::path::Path;
use study::DiagnosisResult;
use study_report::DiagnosisInput;

/// Most drawn campaigns of each truth: the standard error of a rate of 0.05 is 0.015.
const MOST_TRIALS: usize = 200;
/// Drawn campaigns of all truths together, of a library of twenty effects a minute of two cores.
const CAMPAIGNS: usize = 4000;
/// Detectability of the effects planted in them, in standard errors: the size from which a naming can be expected.
const STRENGTH: f64 = 6.0;

/// Writes the report into the result folder.
///
/// # Errors
/// Campaigns that cannot be drawn, a file that cannot be written.
pub(super) fn write(
    folder: &Path,
    result: &DiagnosisResult,
    done: &ResidualStudy,
    common: &Common,
) -> anyhow::Result<()> {
    let defaults = result.defaults.iter();
    let defaults: Vec<String> = defaults
        .map(|d| format!("{} = {}: {}", d.key, d.value, d.why))
        .collect();
    let input = DiagnosisInput {
        name: &result.name,
        version: &result.version,
        seed: result.seed,
        inputs: &result.inputs,
        defaults: &defaults,
        not_applicable: &result.not_applicable,
        planned_runs: runs_needed(&done.plan),
        spent: result.spent,
        study: done,
        trials: &known_truth(done, result.seed, common)?,
    };
    study_report::write_diagnosis(folder, &input)
        .with_context(|| format!("cannot write the report into {}", folder.display()))
}

/// Drawn campaigns with known truth for this very design; `None` if nothing can be tested.
fn known_truth(done: &ResidualStudy, seed: u64, common: &Common) -> anyhow::Result<Vec<TrialRow>> {
    if done.diagnosis.structured_residual.t0.is_none() {
        return Ok(Vec::new());
    }
    let problem = Problem::try_from(done.problem.clone())?;
    let truths = usual_truths(&problem, STRENGTH)?;
    let each = CAMPAIGNS.div_ceil(truths.len()).min(MOST_TRIALS);
    common.log(|| {
        format!(
            "drawing {} campaigns with known truth for the report",
            each * truths.len()
        )
    });
    Ok(trials(&problem, &truths, each, seed, common.threads())?)
}
