//! Running a study: the only place that calls the loop.

use crate::compare::compare;
use crate::next;
use crate::price::{self, Price, StagePrice};
use crate::run_remarks;
use crate::spent::Spending;
use crate::{DiagnosisResult, Error, Study, StudyResult, StudySimulator};
use campaign::run_store::{Lookup, Record, Store};
use campaign::{Campaign, Pace, Progress, Simulator};
use inference::{Calibration, LoopSettings};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How a study is run.
#[derive(Clone)]
pub struct RunSettings<'a> {
    /// First seed.
    pub seed: u64,
    /// Runs at a time.
    pub threads: usize,
    /// Result folder; the records are in its folder `runs`.
    pub folder: PathBuf,
    /// Hears of each run.
    pub progress: &'a dyn Progress,
    /// Once it is true no further run begins, and [`run_diagnosis`] breaks running ones off, see
    /// [`StudySimulator::with_stop`].
    pub stop: &'a Arc<AtomicBool>,
    /// How often [`run_diagnosis`] tries a run again that diverges, see [`StudySimulator::with_retries`].
    pub retries: u32,
    /// Longest wait for runs that other processes do in the folder, see [`Campaign::with_wait`]; `None` is without limit.
    pub wait: Option<Duration>,
}

impl std::fmt::Debug for RunSettings<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunSettings")
            .field("seed", &self.seed)
            .field("threads", &self.threads)
            .field("folder", &self.folder)
            .finish_non_exhaustive()
    }
}

/// Runs of a study at most, stage by stage, with their cost; the pace of runs whose records are in the result
/// folder is taken over.
///
/// # Errors
///
/// A design that cannot be made, a mesh or a record that cannot be read, a budget that is smaller than the runs that are certain.
pub fn plan_study(study: &Study, seed: u64, folder: &Path) -> Result<Price, Error> {
    let simulator = study.simulator(folder)?;
    let within = study.settings_within(&simulator, seed)?;
    let stages = inference::planned(&study.problem, &within)?;
    let store = store_of(folder)?;
    let price = price::of(&simulator, &stages, study.file.budget, store.as_ref())?;
    inference::within_budget(&stages, &within)?;
    Ok(Price {
        most_runs: within.most_runs,
        cannot_be_met: study.problem.cannot_be_met(),
        ..price
    })
}

/// The runs that a folder has; planning makes none.
fn store_of(folder: &Path) -> Result<Option<Store>, Error> {
    let runs = folder.join("runs");
    Ok(runs.is_dir().then(|| Store::open(&runs)).transpose()?)
}

/// Runs of [`run_diagnosis`] and their cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosisPrice {
    /// Most runs at the candidates for the next measurement, if the diagnosis leaves a question, among the further ones; 0 if
    /// the budget does not allow them.
    pub at_candidates: usize,
    /// Runs and times.
    #[serde(flatten)]
    pub stage: StagePrice,
    /// Whether the times follow from planned runs whose records are in the folder, and not from a guess.
    pub measured: bool,
}

/// Runs of [`run_diagnosis`] from given parameters and their cost.
///
/// # Errors
///
/// A budget of the study that is smaller than the diagnosis needs.
pub fn plan_diagnosis(study: &Study, seed: u64, folder: &Path) -> Result<DiagnosisPrice, Error> {
    let simulator = study.simulator(folder)?;
    let within = study.settings_within(&simulator, seed)?;
    let needed = inference::most_runs_of_diagnosis(&study.problem, &within);
    let candidates = inference::most_runs_of_candidates(&study.problem, &within);
    let at_candidates = match within.most_runs {
        Some(most) if most < needed => return Err(Error::Budget { most, needed }),
        Some(most) if most < needed + candidates => 0,
        _ => candidates,
    };
    let stage = inference::planned_diagnosis(&study.problem, &within, 0);
    let store = store_of(folder)?;
    let mut price = price::of(
        &simulator,
        std::slice::from_ref(&stage),
        study.file.budget,
        store.as_ref(),
    )?;
    Ok(DiagnosisPrice {
        at_candidates,
        stage: price.stages.remove(0),
        measured: price.measured,
    })
}

/// Runs all stages of a study.
///
/// `announce` gets each stage as it begins.
///
/// # Errors
///
/// Runs that failed, a store that cannot be used, a stage that cannot be computed.
pub fn run_study(
    study: &Study,
    simulator: &StudySimulator,
    settings: &RunSettings<'_>,
    announce: &dyn Fn(&str),
) -> Result<StudyResult, Error> {
    let store = Store::open(settings.folder.join("runs"))?;
    let spending = Spending::begin(&store)?;
    let pace = Pace::new();
    let campaign = settings.campaign(&store, &pace);
    let within = study.settings_within(simulator, settings.seed)?;
    let mut calibration =
        inference::calibrate(&campaign, simulator, &study.problem, &within, announce)?;
    let records = records_of(&store, &calibration)?;
    let of_photos = study.photos.iter().flat_map(|series| &series.left_out);
    calibration.remarks.extend(of_photos.cloned());
    let of_curves = study
        .curves
        .iter()
        .filter_map(|(_, curve)| curve.remark.clone());
    calibration.remarks.extend(of_curves);
    let of_runs = run_remarks::of_runs(&calibration, &records);
    calibration.remarks.extend(of_runs);
    Ok(StudyResult {
        name: study.problem.id.clone(),
        profile: study.profile.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: settings.seed,
        inputs: study.inputs.clone(),
        compare: compare(&study.file.compare, &study.problem, &calibration),
        defaults: study.defaults.clone(),
        not_applicable: study.not_applicable.clone(),
        records,
        next: next::table_for_parameters(study, calibration.next_for_parameters.as_ref(), &store)?,
        calibration,
        spent: spending.end(settings.threads)?,
    })
}

/// The records behind the measurements of a calibration and behind the surfaces of its last box, by key.
fn records_of(store: &Store, calibration: &Calibration) -> Result<BTreeMap<String, Record>, Error> {
    let rows = calibration.before.iter().chain(&calibration.fit);
    let rows = rows.chain(&calibration.check).chain(&calibration.show);
    let mut records = BTreeMap::new();
    let keys = rows.flat_map(|row| &row.keys);
    for key in keys.chain(calibration.surfaces.iter().flat_map(|s| &s.keys)) {
        if let Lookup::Found(record) = store.get(key)? {
            records.insert(key.clone(), record);
        }
    }
    Ok(records)
}

/// Asks what is missing, starting from given parameters: the last stage alone.
///
/// # Errors
///
/// As [`run_study`].
pub fn run_diagnosis(
    study: &Study,
    at: &[f64],
    settings: &RunSettings<'_>,
) -> Result<DiagnosisResult, Error> {
    let simulator = study.simulator(&settings.folder)?;
    let simulator = simulator
        .with_retries(settings.retries)
        .with_stop(settings.stop);
    let store = Store::open(settings.folder.join("runs"))?;
    let spending = Spending::begin(&store)?;
    let pace = Pace::new();
    let campaign = settings.campaign(&store, &pace);
    let within = study.settings_with(settings.seed);
    let planned = plan_diagnosis(study, settings.seed, &settings.folder)?;
    let problem = match planned.at_candidates {
        0 => study.problem.without_candidates(),
        _ => study.problem.clone(),
    };
    let diagnosis = inference::diagnose_at(&campaign, &simulator, &problem, &within, at)?;
    let next = next::table(study, &diagnosis, &store)?;
    let symbols = study.problem.parameters.iter().map(|p| p.symbol.clone());
    Ok(DiagnosisResult {
        name: study.problem.id.clone(),
        profile: study.profile.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: settings.seed,
        inputs: study.inputs.clone(),
        at: symbols.zip(at.iter().copied()).collect::<BTreeMap<_, _>>(),
        diagnosis,
        next,
        defaults: study.defaults.clone(),
        not_applicable: study.not_applicable.clone(),
        spent: spending.end(settings.threads)?,
    })
}

impl<'a> RunSettings<'a> {
    /// A campaign of these settings.
    fn campaign(&self, store: &'a Store, pace: &'a Pace) -> Campaign<'a> {
        Campaign::new(store, self.threads, self.progress)
            .with_stop(self.stop)
            .with_pace(pace)
            .with_wait(self.wait)
    }
}

impl Study {
    /// The settings of the loop with the seed of a run and the number of runs that the budget allows.
    fn settings_within(&self, simulator: &dyn Simulator, seed: u64) -> Result<LoopSettings, Error> {
        let with_seed = self.settings_with(seed);
        let stages = inference::planned(&self.problem, &with_seed)?;
        let most_runs = price::of(simulator, &stages, self.file.budget, None)?.most_runs;
        Ok(LoopSettings {
            most_runs,
            ..with_seed
        })
    }

    /// The settings of the loop with the seed of a run.
    fn settings_with(&self, seed: u64) -> LoopSettings {
        LoopSettings {
            seed,
            ..self.settings.clone()
        }
    }
}
