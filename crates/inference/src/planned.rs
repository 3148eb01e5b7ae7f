//! What a calibration will run, before it runs anything.

use crate::designs::design_runs;
use crate::diagnosis_stage::{lists_of_diagnosis, within_budget};
use crate::joint::{slope_runs, with_slopes};
use crate::next_for_parameters::planned_next;
use crate::region::Region;
use crate::samples::{Asked, Wanted, request, wanted};
use crate::screening::{screened, screening_runs};
use crate::{CalibrationProblem, Error, LoopSettings, Role};
use campaign::RunRequest;

/// Runs that are asked for together, so many times behind each other.
#[derive(Debug, Clone, PartialEq)]
pub struct RunList {
    /// How often.
    pub times: usize,
    /// The runs of one list.
    pub requests: Vec<RunRequest>,
}

impl RunList {
    /// Runs that are asked for once.
    pub fn once(requests: Vec<RunRequest>) -> Self {
        Self { times: 1, requests }
    }
}

/// A stage of the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedStage {
    /// Name for the reader.
    pub stage: String,
    /// Its runs, without those that only its result asks for.
    pub certain: Vec<RunList>,
    /// Runs that it may ask for beyond these, at most: further boxes, rounds and effects.
    pub further: Vec<RunList>,
}

impl PlannedStage {
    /// Number of runs that are certain.
    pub fn runs(&self) -> usize {
        number(&self.certain)
    }

    /// Number of runs beyond these, at most.
    pub fn at_most_further(&self) -> usize {
        number(&self.further)
    }
}

fn number(lists: &[RunList]) -> usize {
    lists.iter().map(|l| l.times * l.requests.len()).sum()
}

/// The stages of a calibration with their runs.
///
/// Where a run depends on the result of another, the middle of the box represents the estimate. A diagnosis for which the budget of
/// the settings leaves no runs has none.
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
    let region = Region::first(&problem.parameters);
    let middle = region.middle();
    let start = problem.start();
    let coarsest = |model| (model, problem.coarsest_of(model));
    let everyone: Vec<_> = (0..problem.models.len()).map(coarsest).collect();
    let mut stages = vec![repeats(
        asked,
        "the parameters in use before",
        &everyone,
        &start,
        (settings.before_runs, 0),
    )];
    let mut screening = Vec::new();
    let mut design = Vec::new();
    for model in screened(asked) {
        screening.extend(screening_runs(asked, model)?.1);
    }
    for &model in &of_fit {
        let active = problem.tuned_of(model);
        design.extend(design_runs(asked, 0, (model, &active), &region)?);
    }
    let further = settings.most_boxes.saturating_sub(1);
    stages.push(stage(asked, "screening", &screening, 0));
    stages.push(stage(asked, "surfaces and estimate", &design, further));
    let rounds = settings.most_confirmations.saturating_sub(1);
    let n = (settings.confirmation_runs.max(2), rounds);
    let name = "confirmation by fresh runs";
    let finest: Vec<_> = of_fit
        .iter()
        .map(|&model| (model, problem.finest_of(model)))
        .collect();
    stages.push(repeats(asked, name, &finest, &middle, n));
    let n = (settings.check_runs.max(2), 0);
    let all_sizes = |&model: &usize| {
        let factors = problem.factors_of(model).iter();
        factors.map(move |factor| (model, *factor))
    };
    let others: Vec<_> = other.iter().flat_map(all_sizes).collect();
    let mut check = repeats(asked, "check", &others, &middle, n);
    let about = slope_runs(asked, &with_slopes(asked), (&middle, &region))?;
    let about = about.iter().map(|w| request(problem, w));
    check.certain[0].requests.extend(about);
    stages.push(check);
    let spent = stages.iter().map(PlannedStage::runs).sum();
    stages.push(planned_diagnosis(problem, settings, spent));
    stages.extend(planned_next(asked));
    Ok(stages)
}

/// The runs of the diagnosis of a problem, as far as the budget of the settings allows them after so many.
pub fn planned_diagnosis(
    problem: &CalibrationProblem,
    settings: &LoopSettings,
    spent: usize,
) -> PlannedStage {
    let (certain, further) = match within_budget(problem, settings, spent) {
        Ok(problem) => lists_of_diagnosis(&problem, settings),
        Err(_) => (Vec::new(), Vec::new()),
    };
    PlannedStage {
        stage: "diagnosis of the residual".to_owned(),
        certain,
        further,
    }
}

/// A stage of given runs, in one list that may be asked for again with other values.
fn stage(asked: Asked<'_>, name: &str, list: &[Wanted], again: usize) -> PlannedStage {
    let requests: Vec<RunRequest> = list.iter().map(|w| request(asked.problem, w)).collect();
    PlannedStage {
        stage: name.to_owned(),
        certain: vec![RunList::once(requests.clone())],
        further: vec![RunList {
            times: again,
            requests,
        }],
    }
}

/// A stage of `n` runs of some models, each with the size of its grains, at a point, and the same again at others.
fn repeats(
    asked: Asked<'_>,
    name: &str,
    models: &[(usize, f64)],
    at: &[f64],
    (n, again): (usize, usize),
) -> PlannedStage {
    let each = models.iter();
    let list: Vec<Wanted> = each
        .flat_map(|&model| wanted(0, model, &vec![at.to_vec(); n]))
        .collect();
    stage(asked, name, &list, again)
}
