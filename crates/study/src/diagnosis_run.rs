//! Running a diagnosis.

use crate::{Error, PlannedDiagnosis, RunSettings};
use calibration::{ResidualStudy, study_residual};
use campaign::{Campaign, Progress};
use residual_diagnosis::{Problem, ProblemFile, TrialRow, trials, usual_truths};
use run_store::Store;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Drawn campaigns of each truth: the standard error of a rate of 0.05 is 0.015.
const TRIALS: usize = 200;
/// Detectability of the effects planted in them, in standard errors: the size from which a naming
/// can be expected.
const STRENGTH: f64 = 6.0;

/// Everything that a diagnosis found.
#[derive(Debug, Clone, Serialize)]
pub struct DiagnosisResult {
    /// Name of the study.
    pub name: String,
    /// Version of the program.
    pub version: String,
    /// First seed.
    pub seed: u64,
    /// SHA-256 of each input file.
    pub inputs: BTreeMap<String, String>,
    /// Effects that the scene cannot carry, with the reason.
    pub not_applicable: BTreeMap<String, String>,
    /// Number of conditions that the budget took out of the fit.
    pub taken_out: usize,
    /// Largest number of runs of the plan.
    pub planned_runs: usize,
    /// Wall time of the whole diagnosis, s; small where records were found again.
    pub wall_s: f64,
    /// Share of it that went into simulations and their bookkeeping.
    pub simulation_share: f64,
    /// The study of the residual.
    pub study: ResidualStudy,
    /// What the rules say of drawn campaigns at these conditions, with this library and noise.
    pub trials: Vec<TrialRow>,
}

/// Runs a planned diagnosis: sensitivities, fit, verdict, the model with the effect, errors before
/// and after.
///
/// # Errors
///
/// Runs that failed, a store that cannot be used, a covariance that cannot be factorised.
pub fn run_diagnosis(
    planned: &PlannedDiagnosis,
    name: &str,
    settings: &RunSettings,
    progress: &dyn Progress,
    stop: &AtomicBool,
) -> Result<DiagnosisResult, Error> {
    let begin = Instant::now();
    let store = Store::open(settings.folder.join("runs"))?;
    let campaign = Campaign::new(&store, settings.threads, progress).with_stop(stop);
    let study = study_residual(
        &campaign,
        &planned.simulator,
        &planned.plan,
        &planned.observed,
    )?;
    let after_runs = begin.elapsed().as_secs_f64();
    let refused = study.diagnosis.structured_residual.t0.is_none();
    let rows = if refused {
        Vec::new()
    } else {
        known_truth(study.problem.clone(), settings.seed).map_err(calibration::Error::from)?
    };
    let wall_s = begin.elapsed().as_secs_f64();
    Ok(DiagnosisResult {
        name: name.to_owned(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: settings.seed,
        inputs: settings.inputs.clone(),
        not_applicable: planned.not_applicable.clone(),
        taken_out: planned.taken_out,
        planned_runs: planned.runs,
        wall_s,
        simulation_share: after_runs / wall_s.max(f64::MIN_POSITIVE),
        study,
        trials: rows,
    })
}

/// Drawn campaigns with known truth for this very design.
fn known_truth(file: ProblemFile, seed: u64) -> Result<Vec<TrialRow>, residual_diagnosis::Error> {
    let problem = Problem::try_from(file)?;
    trials(&problem, &usual_truths(&problem, STRENGTH)?, TRIALS, seed)
}
