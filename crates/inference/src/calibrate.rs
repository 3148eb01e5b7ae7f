//! The loop: screening, surfaces, joint estimate, box after box, fresh runs, check, residual.

use crate::coarse_graining::{self, trends};
use crate::comparison::{SurfacesByModel, compare};
use crate::confirmation::{Confirmed, confirm};
use crate::diagnosis_stage::{self, diagnose_at};
use crate::intervals::{Uncertainty, best_of, estimates, inputs, test};
use crate::joint::{joint_estimate, planes, region_about, slope_runs, with_slopes};
use crate::next_for_parameters::next_for_parameters;
use crate::remarks::{
    all_failures, missed_but_shown, moved_inputs, other_solutions, states, unknown_inputs,
};
use crate::samples::{Asked, Runner, Samples, Wanted, first_seed, wanted};
use crate::screening::screen_models;
use crate::search::{Found, Search};
use crate::solution_set::solution_set;
use crate::timer::{Counted, Timer};
use crate::verdict::verdict;
use crate::with_effects::judged_with;
use crate::{
    Calibration, CalibrationProblem, Comparison, DiagnosisStage, Error, Estimate, InputEstimate,
    JointEstimate, LoopSettings, NextForParameters, PlannedStage, Role, planned,
};
use campaign::{Campaign, Simulator};
use std::collections::{BTreeMap, BTreeSet};

/// Stage number of the runs with the parameters in use before.
const STAGE_BEFORE: u64 = 0;
/// Stage number of the runs of models that the fit does not use, at the estimate.
const STAGE_CHECK: u64 = 60;

/// Place of the screening in the plan.
const SCREENING: usize = 1;
const SURFACES: usize = 2;
const CONFIRMATION: usize = 3;
const CHECK: usize = 4;
const DIAGNOSIS: usize = 5;
const NEXT: usize = 6;

/// Calibrates the parameters of a problem and says whether the result holds.
///
/// `announce` receives each stage as it begins.
///
/// # Errors
///
/// An invalid problem, runs too few for any surface, a campaign
/// that was stopped. That the measurements are out of reach or contradict each other is a result and no error.
#[allow(
    clippy::too_many_lines,
    reason = "the stages follow each other, and the result lists what each gave"
)]
pub fn calibrate(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    problem: &CalibrationProblem,
    settings: &LoopSettings,
    announce: &dyn Fn(&str),
) -> Result<Calibration, Error> {
    problem.check()?;
    let counted = Counted::new(simulator);
    let asked = Asked { problem, settings };
    let stages = planned(problem, settings)?;
    let elsewhere = within_budget(&stages, settings)?;
    let runner = Runner {
        campaign: *campaign,
        simulator: &counted,
        asked,
    };
    let mut timer = Timer::new(announce, (&runner, &counted), &stages);
    timer.begin(0);
    let before = before(&runner)?;
    timer.begin(SCREENING);
    let screened = screen_models(&runner)?;
    let mut search = Search::new(runner, screened.active, elsewhere);
    timer.expect(SURFACES, &search.planned(&stages[SURFACES])?);
    timer.begin(SURFACES);
    let found = found(problem, &mut search, announce)?;
    timer.expect(CONFIRMATION, &with_boxes_left(&stages, &search)?);
    timer.begin(CONFIRMATION);
    let confirmed = confirm(&runner, &mut search, found, announce)?;
    let size_trends = trends(problem, &search, &confirmed.found)?;
    let estimate = Estimated::new(asked, &confirmed)?;
    timer.begin(CHECK);
    let checked = check(&runner, &confirmed, &estimate)?;
    timer.begin(DIAGNOSIS);
    let at = &confirmed.found.best;
    let spent = elsewhere + spent(&search, &confirmed, &stages[CONFIRMATION]);
    let diagnosis = diagnosis_left(campaign, &counted, problem, settings, (at, spent))?;
    let surfaces = all_surfaces(&confirmed, &checked.planes);
    let row =
        |role, runs, covariance, at: &[f64]| compare(asked, role, runs, &surfaces, covariance, at);
    let covariance = Some(&estimate.uncertainty.covariance);
    let fit = row(Role::Fit, &confirmed.runs, None, at);
    let checks = row(Role::Check, &checked.at_estimate, covariance, at);
    let runs = [&before, &screened.runs, &checked.at_estimate];
    let show = row(Role::Show, &checked.at_estimate, covariance, at);
    let remarks = [
        search.remarks.clone(),
        confirmed.remarks.clone(),
        coarse_graining::remarks(problem, &size_trends),
        all_failures(problem, runs),
        states(problem, &checked.at_estimate),
        other_solutions(problem, &estimate).into_iter().collect(),
        moved_inputs(&estimate.inputs),
        unknown_inputs(problem, &surfaces),
        missed_but_shown(&show),
    ];
    let judged = verdict(problem, &estimate, &fit, &checks, &confirmed);
    let (with_effects, met, verdict) = judged_with(problem, &diagnosis, judged);
    Ok(Calibration {
        next_for_parameters: next_left(&mut timer, &runner, &confirmed, (&estimate, spent))?,
        id: problem.id.clone(),
        settings: settings.clone(),
        before: of_all_roles(&|role| row(role, &before, None, &problem.start())),
        show,
        surfaces: search.model_surfaces(&confirmed.found)?,
        boxes: search.boxes,
        cost: timer.end(),
        joint: checked.joint,
        size_trends,
        confirmations: confirmed.rounds,
        correlation: estimate.uncertainty.correlation(problem.tuned()),
        open_combinations: estimate
            .uncertainty
            .open_combinations(problem.tuned(), &confirmed.found.free),
        test: estimate.test,
        solutions: estimate.solutions,
        parameters: estimate.parameters,
        inputs: estimate.inputs,
        fit,
        check: checks,
        screening: screened.screenings,
        diagnosis,
        with_effects,
        remarks: remarks.concat(),
        met,
        verdict,
    })
}

/// What the search finds; nothing is made of runs with coarse grains that say too little about real ones.
fn found(
    problem: &CalibrationProblem,
    search: &mut Search<'_>,
    announce: &dyn Fn(&str),
) -> Result<Found, Error> {
    let found = search.run(announce)?;
    trends(problem, search, &found)?;
    Ok(found)
}

/// The measurements of all roles, one role behind the other.
fn of_all_roles(rows: &dyn Fn(Role) -> Vec<Comparison>) -> Vec<Comparison> {
    let roles = [Role::Fit, Role::Check, Role::Show];
    roles.into_iter().flat_map(rows).collect()
}

/// Runs of the boxes and of the rounds of confirmation behind the first.
fn spent(search: &Search<'_>, confirmed: &Confirmed, round: &PlannedStage) -> usize {
    let of_boxes: usize = search.boxes.iter().map(|b| b.n_runs).sum();
    of_boxes + (confirmed.rounds.len() - 1) * round.runs()
}

/// The stage of the confirmation with what else it may ask for: a round may send the search on, as far as there are boxes left.
fn with_boxes_left(stages: &[PlannedStage], search: &Search<'_>) -> Result<PlannedStage, Error> {
    let mut stage = stages[CONFIRMATION].clone();
    stage
        .further
        .extend(search.planned(&stages[SURFACES])?.further);
    Ok(stage)
}

/// The diagnosis at a point, as far as the budget allows after so many runs: what to measure next is asked where it does.
fn diagnosis_left(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    problem: &CalibrationProblem,
    settings: &LoopSettings,
    (at, spent): (&[f64], usize),
) -> Result<DiagnosisStage, Error> {
    match diagnosis_stage::within_budget(problem, settings, spent) {
        Ok(problem) => diagnose_at(campaign, simulator, &problem, settings, at),
        Err(reason) => Ok(DiagnosisStage::LeftOut { reason }),
    }
}

/// What to measure next, in a stage of its own if the problem names candidates and a combination of parameters is open.
fn next_left(
    timer: &mut Timer<'_>,
    runner: &Runner<'_>,
    confirmed: &Confirmed,
    (estimate, spent): (&Estimated, usize),
) -> Result<Option<NextForParameters>, Error> {
    if timer.has(NEXT) {
        timer.begin(NEXT);
    }
    next_for_parameters(runner, confirmed, estimate, spent)
}

/// Runs that the [stages](crate::planned) beside the search and the diagnosis need; those of the search are known only if nothing is screened.
///
/// # Errors
///
/// [`Error::Budget`] where the runs that are certain are more than the settings allow.
pub fn within_budget(stages: &[PlannedStage], settings: &LoopSettings) -> Result<usize, Error> {
    let runs = |i: usize| stages[i].runs();
    let elsewhere = (0..DIAGNOSIS).filter(|i| *i != SURFACES);
    let elsewhere: usize = elsewhere.map(runs).sum();
    let certain = if runs(SCREENING) == 0 {
        elsewhere + runs(SURFACES)
    } else {
        elsewhere
    };
    match settings.most_runs {
        Some(most) if certain > most => Err(Error::Budget {
            needed: certain,
            most,
        }),
        _ => Ok(elsewhere),
    }
}

#[derive(Debug)]
pub(crate) struct Estimated {
    /// Tuned parameters with intervals.
    pub(crate) parameters: Vec<Estimate>,
    pub(crate) inputs: Vec<InputEstimate>,
    /// Covariance and what is open.
    pub(crate) uncertainty: Uncertainty,
    pub(crate) test: crate::FitTest,
    pub(crate) solutions: crate::SolutionSet,
}

impl Estimated {
    /// Of the last surfaces.
    fn new(asked: Asked<'_>, confirmed: &Confirmed) -> Result<Self, Error> {
        let problem = asked.problem;
        let found = &confirmed.found;
        let fit = found.fit(problem);
        let best = best_of(&found.minima)?;
        let uncertainty = Uncertainty::new(&fit, best, &found.whitening);
        let parameters = estimates(&fit, best, &found.whitening, &uncertainty);
        let seed = asked.settings.seed;
        Ok(Self {
            solutions: solution_set(&fit, &found.minima, &found.whitening, &parameters, seed)?,
            test: test(&fit, best),
            inputs: inputs(&fit, best, &uncertainty),
            uncertainty,
            parameters,
        })
    }
}

/// Runs of all models with the parameters in use before; an error if none of them gives a result.
fn before(runner: &Runner<'_>) -> Result<BTreeMap<usize, Samples>, Error> {
    let start = runner.problem.start();
    let n = runner.settings.before_runs;
    let models = 0..runner.problem.models.len();
    let list = models.flat_map(|model| {
        let seed = first_seed(runner.settings, STAGE_BEFORE, model);
        let coarsest = runner.problem.coarsest_of(model);
        wanted(seed, (model, coarsest), &vec![start.clone(); n])
    });
    let runs = runner.run(&list.collect::<Vec<_>>())?;
    let n_failed: usize = runs.values().map(|samples| samples.failed.len()).sum();
    let first = runs.values().find_map(|samples| samples.failed.first());
    match first {
        Some((_, reason)) if runs.values().all(|samples| samples.done.is_empty()) => {
            Err(Error::AllFailed {
                n: n_failed,
                reason: reason.clone(),
            })
        }
        _ => Ok(runs),
    }
}

/// What the models say that the fit did not use.
struct Checked {
    /// Runs of the models of role check or show at the estimate, those of the fit included that have a measurement of
    /// such a role.
    at_estimate: BTreeMap<usize, Samples>,
    /// Planes of the models of the checks about the estimate.
    planes: SurfacesByModel,
    joint: Option<JointEstimate>,
}

/// Runs the models of the checks at the estimate and about it, and those that are only shown.
fn check(
    runner: &Runner<'_>,
    confirmed: &Confirmed,
    estimate: &Estimated,
) -> Result<Checked, Error> {
    let (problem, settings) = (runner.problem, runner.settings);
    let found = &confirmed.found;
    let of_fit = problem.models_of(Role::Fit);
    let others = |role| -> Vec<usize> {
        let models = problem.models_of(role).into_iter();
        models.filter(|k| !of_fit.contains(k)).collect()
    };
    let (checks, mut shown) = (others(Role::Check), others(Role::Show));
    shown.retain(|k| !checks.contains(k));
    let mut list: Vec<Wanted> = Vec::new();
    for &model in checks.iter().chain(&shown) {
        let mut seed = first_seed(settings, STAGE_CHECK, model);
        let n = settings.check_runs.max(2);
        for &factor in problem.factors_of(model) {
            list.extend(wanted(seed, (model, factor), &vec![found.best.clone(); n]));
            seed += n as u64;
        }
    }
    let region = region_about(runner.asked, &found.best, &estimate.parameters);
    let sloped = with_slopes(runner.asked);
    let about = slope_runs(runner.asked, &sloped, (&found.best, &region))?;
    let n_at = list.len();
    list.extend(about);
    // One list, so that no core waits; the two parts are distinguished by their place.
    let all = runner.run_parts(&list, n_at)?;
    let [mut at_estimate, about] = all;
    let of_planes: BTreeSet<usize> = checks.iter().chain(&sloped).copied().collect();
    let of_planes: Vec<usize> = of_planes.into_iter().collect();
    let planes = planes(runner.asked, &of_planes, &region, &about, &at_estimate);
    for (model, samples) in &confirmed.runs {
        at_estimate.insert(*model, samples.clone());
    }
    let joint = if settings.joint && !checks.is_empty() {
        let mut surfaces = found.surfaces.clone();
        surfaces.extend(planes.values().cloned());
        Some(joint_estimate(runner.asked, &found.region, &surfaces)?)
    } else {
        None
    };
    Ok(Checked {
        at_estimate,
        planes,
        joint,
    })
}

/// Surfaces of the fit and planes of the checks by model.
fn all_surfaces(confirmed: &Confirmed, planes: &SurfacesByModel) -> SurfacesByModel {
    let mut all = planes.clone();
    for surface in &confirmed.found.surfaces {
        all.insert(surface.model, surface.clone());
    }
    all
}
