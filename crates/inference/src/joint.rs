//! The models that the fit did not use, about the estimate; and the estimate from all measurements.

use crate::comparison::SurfacesByModel;
use crate::designs::{input_points, placed, slope_design};
use crate::intervals::{Uncertainty, best_of, estimates, inputs, test};
use crate::joint_fit::JointFit;
use crate::region::Region;
use crate::samples::{Asked, Samples, Wanted, first_seed, observables, wanted};
use crate::surface::{Degree, Surface};
use crate::{Error, Estimate, JointEstimate, JointPrediction, Role};
use std::collections::BTreeMap;

/// Stage number of the points about the estimate.
const STAGE: u64 = 70;
/// Half width of the box about the estimate, in standard errors of the parameter.
const STANDARD_ERRORS: f64 = 2.0;
/// Its least half width, as a share of half the box of the file: a slope over less is noise.
const LEAST_SHARE: f64 = 0.3;

/// A box about the estimate in which a plane represents the models of the checks.
pub(crate) fn region_about(asked: Asked<'_>, at: &[f64], estimates: &[Estimate]) -> Region {
    let parameters = &asked.problem.parameters;
    let half: Vec<f64> = parameters
        .iter()
        .enumerate()
        .map(|(j, p)| {
            let whole = 0.5 * (p.range[1] - p.range[0]);
            // Inputs, behind the estimates, are known by their own error.
            estimates.get(j).map_or(whole, |estimate| {
                let by_error = STANDARD_ERRORS * estimate.se.unwrap_or(0.0);
                by_error.clamp(LEAST_SHARE * whole, whole)
            })
        })
        .collect();
    Region::about(at, &half, parameters)
}

/// The models that the fit does not use and whose slopes are asked for: those of the checks if a joint estimate follows, and those with
/// coarse grains, whose runs no slope would carry to the real size.
pub(crate) fn with_slopes(asked: Asked<'_>) -> Vec<usize> {
    let Asked { problem, settings } = asked;
    let [of_fit, checks] = [Role::Fit, Role::Check].map(|role| problem.models_of(role));
    let others = (0..problem.models.len()).filter(|k| !of_fit.contains(k));
    let asked =
        others.filter(|k| (settings.joint && checks.contains(k)) || problem.coarsest_of(*k) > 1.0);
    asked.collect()
}

/// Runs about the estimate `at`, for the slopes of models that the fit did not use.
///
/// # Errors
///
/// A design for more parameters than there are.
pub(crate) fn slope_runs(
    asked: Asked<'_>,
    models: &[usize],
    (at, region): (&[f64], &Region),
) -> Result<Vec<Wanted>, Error> {
    let problem = asked.problem;
    let mut list = Vec::new();
    for &model in models {
        let active = problem.tuned_of(model);
        let mut points = Vec::new();
        if !active.is_empty() {
            let symbols = problem.symbols(&active);
            let rows = slope_design(&symbols, asked.settings.seed)?;
            points = placed(&rows, &active, region, &problem.parameters);
        }
        points.extend(input_points(asked, model, at));
        let seed = first_seed(asked.settings, STAGE, model);
        let coarsest = problem.coarsest_of(model);
        list.extend(wanted(seed, (model, coarsest), &points));
    }
    Ok(list)
}

/// Planes through runs about the estimate, runs at the estimate included.
pub(crate) fn planes(
    asked: Asked<'_>,
    models: &[usize],
    region: &Region,
    about: &BTreeMap<usize, Samples>,
    at_estimate: &BTreeMap<usize, Samples>,
) -> SurfacesByModel {
    let problem = asked.problem;
    let mut planes = BTreeMap::new();
    for &model in models {
        let of = |runs: &BTreeMap<usize, Samples>| {
            runs.get(&model).map_or_else(Vec::new, |s| s.done.clone())
        };
        let mut samples = of(about);
        samples.extend(of(at_estimate));
        let regime = crate::samples::usual_regime(&of(at_estimate));
        let (inside, _) = crate::samples::of_regime(&samples, &regime);
        let names = observables(problem, model);
        let (active, inputs) = (problem.tuned_of(model), problem.inputs_of(model));
        let axes = (model, &active[..], &inputs[..]);
        let plane = Surface::fit(axes, &names, region, &inside, Degree::Linear);
        if let Some(plane) = plane.filter(|p| active.is_empty() || p.degree == Degree::Linear) {
            planes.insert(model, plane);
        }
    }
    planes
}

/// The estimate from all measurements of the roles fit and check.
///
/// # Errors
///
/// A covariance that is not positive definite.
pub(crate) fn joint_estimate(
    asked: Asked<'_>,
    region: &Region,
    surfaces: &[Surface],
) -> Result<JointEstimate, Error> {
    let problem = asked.problem;
    let roles = [Role::Fit, Role::Check];
    let used = problem.measurements.iter();
    let used = used.filter(|m| roles.contains(&m.role));
    let fit = JointFit::new(problem, region, surfaces, &roles);
    let (minima, whitening) = fit.solve(asked.settings.seed)?;
    let best = best_of(&minima)?;
    let uncertainty = Uncertainty::new(&fit, best, &whitening);
    let at = fit.natural(&best.coded);
    let predicted = used.filter_map(|m| {
        let surface = surfaces.iter().find(|s| s.model == m.model)?;
        let k = surface.place(&m.observable)?;
        let model = &problem.models[m.model];
        Some(JointPrediction {
            scene: model.scene.clone(),
            condition: model.condition.clone(),
            observable: m.observable.clone(),
            measured: m.mean,
            predicted: surface.value(k, &at),
            se: (surface.leverage(&at) * surface.covariance[(k, k)]).sqrt(),
        })
    });
    Ok(JointEstimate {
        parameters: estimates(&fit, best, &whitening, &uncertainty),
        inputs: inputs(&fit, best, &uncertainty),
        correlation: uncertainty.correlation(problem.tuned()),
        test: test(&fit, best),
        predicted: predicted.collect(),
    })
}
