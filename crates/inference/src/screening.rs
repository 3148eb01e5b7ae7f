//! Which parameters of a model matter for what was measured of it.

use crate::designs::{coded_factors, placed};
use crate::region::Region;
use crate::samples::{Asked, Runner, Samples, Wanted, first_seed, observables, wanted};
use crate::{CalibrationProblem, Error, ModelScreening, Role, ScreeningChoice};
use experiment_design::{Design, plackett_burman};
use response_surface::{Observations, Screening, screen};
use std::collections::BTreeMap;

/// Most parameters that go to a surface without a screening.
const FEW: usize = 5;
/// Stage number: sets the seeds.
const STAGE: u64 = 1;

/// What the screenings say.
#[derive(Debug)]
pub(crate) struct Screened {
    /// Numbers of the parameters that continue, by model of role fit.
    pub(crate) active: BTreeMap<usize, Vec<usize>>,
    pub(crate) screenings: Vec<ModelScreening>,
    /// Runs by model, for what must be said of them.
    pub(crate) runs: BTreeMap<usize, Samples>,
}

/// Which models are screened: those of role fit with more than five parameters, or as the settings say.
pub(crate) fn screened(asked: Asked<'_>) -> Vec<usize> {
    let models = asked.problem.models_of(Role::Fit).into_iter();
    let wanted = |k: &usize| {
        let n = asked.problem.tuned_of(*k).len();
        match asked.settings.screening {
            ScreeningChoice::Auto => n > FEW,
            ScreeningChoice::Always => n >= 2,
            ScreeningChoice::Never => false,
        }
    };
    models.filter(wanted).collect()
}

pub(crate) fn screening_runs(
    asked: Asked<'_>,
    model: usize,
) -> Result<(Design, Vec<Wanted>), Error> {
    let parameters = &asked.problem.parameters;
    let active = &asked.problem.tuned_of(model);
    let symbols = asked.problem.symbols(active);
    let design = plackett_burman(&coded_factors(&symbols)?)?;
    let design = design.replicated(asked.settings.replicates.max(1))?;
    let points = placed(
        &design.coded_rows(),
        active,
        &Region::first(parameters),
        parameters,
    );
    let seed = first_seed(asked.settings, STAGE, model);
    let coarsest = asked.problem.coarsest_of(model);
    Ok((design, wanted(seed, (model, coarsest), &points)))
}

/// Screens all models that need it.
///
/// A parameter continues where its effect on an observable has p below the level of the settings, against replicates if
/// there are any, else against the dummy columns; and the first ones by rank do, as many as the settings ask for.
///
/// # Errors
///
/// No such design, runs of a design that failed so that the others do not fix its effects, a campaign that was stopped.
pub(crate) fn screen_models(runner: &Runner<'_>) -> Result<Screened, Error> {
    let problem = runner.problem;
    let mut active: BTreeMap<usize, Vec<usize>> = problem
        .models_of(Role::Fit)
        .into_iter()
        .map(|k| (k, problem.tuned_of(k)))
        .collect();
    let models = screened(runner.asked);
    let mut designs = BTreeMap::new();
    let mut list = Vec::new();
    for &model in &models {
        let (design, runs) = screening_runs(runner.asked, model)?;
        designs.insert(model, design);
        list.extend(runs);
    }
    let done = runner.run(&list)?;
    let mut screened = Vec::new();
    for (model, design) in designs {
        let samples = done.get(&model).cloned().unwrap_or_default();
        let screenings = screenings(problem, model, &design, &samples)?;
        let kept = kept(runner.asked, model, &screenings);
        let symbol = |j: &usize| problem.parameters[*j].symbol.clone();
        let all = problem.tuned_of(model);
        screened.push(ModelScreening {
            model: problem.models[model].name.clone(),
            n_runs: samples.done.len(),
            kept: kept.iter().map(symbol).collect(),
            dropped: all
                .iter()
                .filter(|j| !kept.contains(j))
                .map(symbol)
                .collect(),
            screenings,
        });
        active.insert(model, kept);
    }
    Ok(Screened {
        active,
        screenings: screened,
        runs: done,
    })
}

/// The screening of each observable of a model, by the runs that gave a result: a replicate less is one value less in the
/// mean of its cell, and a cell less one row less in the regression.
///
/// # Errors
///
/// [`Error::Screening`] where the runs that are left do not fix the effects.
fn screenings(
    problem: &CalibrationProblem,
    model: usize,
    design: &Design,
    samples: &Samples,
) -> Result<BTreeMap<String, Screening>, Error> {
    let mut screenings = BTreeMap::new();
    for name in observables(problem, model) {
        let mut values = vec![None; design.runs().len()];
        for sample in &samples.done {
            if let Some(place) = values.get_mut(sample.place) {
                *place = Some(sample.values[&name]);
            }
        }
        let screened = Observations::from_design(design, &values);
        let screened = screened.and_then(|data| screen(design, &data));
        let screened = screened.map_err(|error| match samples.failed.first() {
            Some((_, reason)) => Error::Screening {
                model: problem.models[model].name.clone(),
                failed: samples.failed.len(),
                reason: reason.clone(),
            },
            None => error.into(),
        })?;
        screenings.insert(name, screened);
    }
    Ok(screenings)
}

/// Numbers of the parameters that continue.
fn kept(asked: Asked<'_>, model: usize, screenings: &BTreeMap<String, Screening>) -> Vec<usize> {
    let Asked { problem, settings } = asked;
    let passes = |symbol: &str| {
        screenings.values().any(|screening| {
            let row = screening.factors.iter().find(|f| f.factor == symbol);
            row.is_some_and(|f| {
                let p = f.p_replicates.or(f.p_dummies);
                f.rank <= settings.screening_least
                    || p.is_some_and(|p| p < settings.screening_alpha)
            })
        })
    };
    let all = problem.tuned_of(model).into_iter();
    all.filter(|&j| passes(&problem.parameters[j].symbol))
        .collect()
}
