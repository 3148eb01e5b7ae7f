//! What a calibration will run, before it runs anything.

use crate::diagnosis_stage::{most_runs_of_candidates, most_runs_of_diagnosis};
use crate::joint::slope_runs;
use crate::region::Region;
use crate::samples::{Asked, Wanted, request, wanted};
use crate::screening::{screened, screening_runs};
use crate::search::design_points;
use crate::{CalibrationProblem, Error, LoopSettings, Role};
use campaign::RunRequest;

/// A stage of the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedStage {
    /// What it is.
    pub stage: String,
    /// Its runs, without those that only its result asks for.
    pub requests: Vec<RunRequest>,
    /// Runs that it may ask for beyond these, at most: further boxes, rounds and effects.
    pub at_most_further: usize,
}

/// The stages of a calibration with their runs.
///
/// Where a run depends on the result of another, the middle of the box stands for the estimate.
///
/// # Errors
///
/// An invalid problem, a design that does not exist.
pub fn planned(
    problem: &CalibrationProblem,
    settings: &LoopSettings,
) -> Result<Vec<PlannedStage>, Error> {
    problem.check()?;
    let asked = Asked { problem, settings };
    let of_fit = problem.models_of(Role::Fit);
    let other: Vec<usize> = (0..problem.models.len())
        .filter(|k| !of_fit.contains(k))
        .collect();
    let checks: Vec<usize> = problem
        .models_of(Role::Check)
        .into_iter()
        .filter(|k| !of_fit.contains(k))
        .collect();
    let region = Region::first(&problem.parameters);
    let middle = region.middle();
    let start = problem.start();
    let everyone: Vec<usize> = (0..problem.models.len()).collect();
    let mut stages = vec![repeats(
        asked,
        "the parameters in use before",
        &everyone,
        &start,
        settings.before_runs,
    )];
    let mut screening = Vec::new();
    let mut design = Vec::new();
    for model in screened(asked) {
        screening.extend(screening_runs(asked, model)?.1);
    }
    for &model in &of_fit {
        let active = problem.tuned_of(model);
        let points = design_points(asked, (model, &active), &region)?;
        design.extend(wanted(0, model, &points));
    }
    let further = settings.most_boxes.saturating_sub(1) * design.len();
    stages.push(stage(asked, "screening", &screening, 0));
    stages.push(stage(asked, "surfaces and estimate", &design, further));
    let rounds = settings.most_confirmations.saturating_sub(1);
    let n = settings.confirmation_runs.max(2);
    let mut confirmation = repeats(asked, "confirmation by fresh runs", &of_fit, &middle, n);
    confirmation.at_most_further = rounds * confirmation.requests.len();
    stages.push(confirmation);
    let mut check = repeats(asked, "check", &other, &middle, settings.check_runs.max(2));
    if settings.joint {
        let about = slope_runs(asked, &checks, (&middle, &region))?;
        check
            .requests
            .extend(about.iter().map(|w| request(problem, w)));
    }
    stages.push(check);
    let diagnosis =
        most_runs_of_diagnosis(problem, settings) + most_runs_of_candidates(problem, settings);
    let name = "diagnosis of the residual";
    stages.push(stage(asked, name, &[], diagnosis));
    Ok(stages)
}

/// A stage of given runs.
fn stage(asked: Asked<'_>, name: &str, list: &[Wanted], at_most_further: usize) -> PlannedStage {
    PlannedStage {
        stage: name.to_owned(),
        requests: list.iter().map(|w| request(asked.problem, w)).collect(),
        at_most_further,
    }
}

/// A stage of `n` runs of some models at a point.
fn repeats(asked: Asked<'_>, name: &str, models: &[usize], at: &[f64], n: usize) -> PlannedStage {
    let each = models.iter();
    let list: Vec<Wanted> = each
        .flat_map(|&model| wanted(0, model, &vec![at.to_vec(); n]))
        .collect();
    stage(asked, name, &list, 0)
}
