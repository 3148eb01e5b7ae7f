//! What a reader of the result should know, one sentence each.

use crate::calibrate::Estimated;
use crate::comparison::SurfacesByModel;
use crate::confirmation::mean;
use crate::samples::{Sample, Samples, observables};
use crate::{CalibrationProblem, Comparison, InputEstimate};
use input::quantity::significant;
use std::collections::BTreeMap;

/// Standard deviations by which an input may move without a remark.
const FAR: f64 = 2.0;
/// Inputs that have to move by more than twice their error, so that the measurements are met.
pub(crate) fn moved_inputs(inputs: &[InputEstimate]) -> Vec<String> {
    let moved = inputs.iter().filter(|input| input.moved.abs() > FAR);
    let remarks = |input: &InputEstimate| {
        format!(
            "the measurements ask for {} = {}, {} standard deviations from the {} that was stated: measure it again",
            input.symbol,
            significant(input.value, 4),
            significant(input.moved.abs(), 2),
            significant(input.stated, 4)
        )
    };
    moved.map(remarks).collect()
}

/// Models of which no run shows how they depend on an input.
pub(crate) fn unknown_inputs(
    problem: &CalibrationProblem,
    surfaces: &SurfacesByModel,
) -> Vec<String> {
    let remarks = surfaces.values().flat_map(|surface| {
        let inputs = problem.inputs_of(surface.model).into_iter();
        let unknown = inputs.filter(|j| !surface.parameters.contains(j));
        unknown.map(|j| {
            format!(
                "the intervals take input {} of {} for exact, since no run with another value gave a result",
                problem.parameters[j].symbol, problem.models[surface.model].name
            )
        })
    });
    remarks.collect()
}

/// Measurements that are only shown and that the simulation misses: inputs may be wrong, or the model.
pub(crate) fn missed_but_shown(show: &[Comparison]) -> Vec<String> {
    let missed = show.iter().filter(|row| !row.holds);
    missed
        .map(|row| {
            format!(
                "{} is shown and not judged, and the simulation misses it",
                crate::verdict::name(row)
            )
        })
        .collect()
}

/// What failed before, in the screening and at the estimate.
pub(crate) fn all_failures(
    problem: &CalibrationProblem,
    runs: [&BTreeMap<usize, Samples>; 3],
) -> Vec<String> {
    let places = [
        "with the parameters in use before",
        "in the screening",
        "at the estimate",
    ];
    let each = places.into_iter().zip(runs);
    each.flat_map(|(place, runs)| failures(problem, place, runs))
        .collect()
}

/// What failed at a point, one sentence for each model.
fn failures(
    problem: &CalibrationProblem,
    place: &str,
    runs: &BTreeMap<usize, Samples>,
) -> Vec<String> {
    let failed = runs.iter().filter_map(|(model, samples)| {
        let (_, reason) = samples.failed.first()?;
        let (n, all) = (
            samples.failed.len(),
            samples.failed.len() + samples.done.len(),
        );
        let name = &problem.models[*model].name;
        Some(format!(
            "{n} of {all} runs of {name} {place} failed: {reason}"
        ))
    });
    failed.collect()
}

/// Models whose runs at the estimate ended up in several regimes, one sentence each: how many in which, and what each shows.
pub(crate) fn states(problem: &CalibrationProblem, runs: &BTreeMap<usize, Samples>) -> Vec<String> {
    let mut remarks = Vec::new();
    for (&model, samples) in runs {
        let mut regimes: BTreeMap<&str, Vec<&Sample>> = BTreeMap::new();
        for sample in &samples.done {
            regimes.entry(&sample.regime).or_default().push(sample);
        }
        if regimes.len() < 2 {
            continue;
        }
        let shown = |group: &Vec<&Sample>| -> String {
            let names = observables(problem, model).into_iter();
            let each = names.map(|name| format!("{name} {}", significant(mean(group, &name), 5)));
            each.collect::<Vec<_>>().join(", ")
        };
        let each: Vec<String> = regimes
            .iter()
            .map(|(regime, group)| format!("{} {regime} ({})", group.len(), shown(group)))
            .collect();
        remarks.push(format!(
            "at the estimate the runs of {} end up in {} states: {}; no mean is taken over both",
            problem.models[model].name,
            regimes.len(),
            each.join(", ")
        ));
    }
    remarks
}

/// That other parameters, apart from the estimate, do nearly as well.
pub(crate) fn other_solutions(
    problem: &CalibrationProblem,
    estimate: &Estimated,
) -> Option<String> {
    let others = estimate.solutions.separate.get(1..)?;
    let point = |at: &Vec<f64>| -> String {
        let each = problem.parameters.iter().zip(at);
        let each = each.map(|(p, x)| format!("{} = {}", p.symbol, significant(*x, 4)));
        each.collect::<Vec<_>>().join(", ")
    };
    let others: Vec<String> = others.iter().map(point).collect();
    (!others.is_empty()).then(|| {
        format!(
            "the fit has separate solutions, of which the estimate is the best; also {} does nearly as well: measure what \
             tells them apart",
            others.join("; also ")
        )
    })
}
