//! Whether a surface misses the runs that it was made of.

use crate::samples::Sample;
use crate::surface::Surface;
use crate::{CalibrationProblem, Role};
use input::quantity::significant;
use probability::f_upper_tail;
use std::collections::BTreeMap;

/// Chance that a surface which is right is said to miss its runs, shared among the measurements.
const ALPHA: f64 = 0.01;
/// How far a surface must miss its runs, in standard errors of what was measured: less moves the estimate by less than a quarter
/// of its own error.
const MATTERS: f64 = 0.25;
/// Scatter of repeats over their mean, below which it is rounding.
const ROUNDING: f64 = 1e-12;

/// A surface that misses its runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Missed {
    pub(crate) model: usize,
    pub(crate) observable: String,
    /// Root mean square of what it misses beyond the scatter of repeats, in standard errors of what was measured.
    pub(crate) in_errors: f64,
    /// Pure error: the variance of a run where it is repeated.
    pub(crate) pure: f64,
}

impl Missed {
    /// The slope of the surface along a parameter at a point over the standard error that pure error gives it.
    pub(crate) fn slope_in_errors(&self, surface: &Surface, j: usize, at: &[f64]) -> f64 {
        let place = surface.parameters.iter().position(|p| *p == j);
        let slope = place
            .zip(surface.place(&self.observable))
            .map(|(place, k)| {
                let variance = surface.slope_covariance(at)[(place, place)] * self.pure;
                surface.slopes(k, at)[place] / variance.sqrt()
            });
        slope.filter(|z| !z.is_nan()).unwrap_or(0.0)
    }

    /// What is missed, in words.
    pub(crate) fn in_words(&self, problem: &CalibrationProblem) -> String {
        let model = &problem.models[self.model].name;
        format!(
            "the surface of {} of {model} misses its own runs by {} standard errors of what was measured",
            self.observable,
            significant(self.in_errors, 2)
        )
    }
}

/// The measurements of the fit of which a surface misses the runs behind it, or fresh runs at a point, by more than these scatter
/// where they repeat each other and by more than matters.
///
/// # Formula
///
/// Pure error is the mean square of the repeats about their means, q its degrees of freedom. The residuals of the surface without
/// their share of it are compared with it by F `[Myers2016, chapter 2]`, and so is `m² / (1/n + h)`, by `F(1, q)`: m the
/// difference of the mean of n fresh runs and the surface, h the leverage there.
pub(crate) fn missed(
    problem: &CalibrationProblem,
    surface: &Surface,
    used: &[&Sample],
    (point, fresh): (&[f64], &[&Sample]),
) -> Vec<Missed> {
    let groups = repeats(surface, used);
    let df_own = groups.iter().map(|group| group.len() - 1).sum::<usize>() as f64;
    let df_pure = df_own + fresh.len().saturating_sub(1) as f64;
    let df = surface.degrees_of_freedom - df_own;
    let of_fit = problem.measurements.iter().filter(|m| m.role == Role::Fit);
    let rows = of_fit.clone().count() as f64;
    let mut found = Vec::new();
    if df_pure == 0.0 {
        return found;
    }
    for measured in of_fit.filter(|m| m.model == surface.model) {
        let name = &measured.observable;
        let Some(k) = surface.place(name) else {
            continue;
        };
        let own: f64 = groups.iter().map(|group| squares(group, name)).sum();
        let pure = (own + squares(fresh, name)) / df_pure;
        let all = surface.covariance[(k, k)] * surface.degrees_of_freedom;
        // A mean square to be compared with pure error, its degrees of freedom, and the square of what is missed.
        let of_runs = (df > 0.0).then(|| {
            let square = (all - own) / df;
            (square, df, (square - pure).max(0.0))
        });
        let at_point = (!fresh.is_empty()).then(|| {
            let mean = fresh.iter().map(|s| s.values[name]).sum::<f64>() / fresh.len() as f64;
            let factor = fresh[0].factor;
            let share = 1.0 / fresh.len() as f64 + surface.leverage_of(point, factor);
            let missed = (mean - surface.value_of(k, point, factor)).powi(2);
            (missed / share, 1.0, missed)
        });
        let variance = measured.variance_at(surface.value(k, point));
        let in_errors = |(square, df, missed): (f64, f64, f64)| {
            let errors = (missed / variance).sqrt();
            let p = f_upper_tail(square / pure, df, df_pure);
            // Runs without any scatter leave no doubt.
            let is_missed = errors > MATTERS && p.is_none_or(|p| p < ALPHA / rows);
            is_missed.then_some(errors)
        };
        let worst = [of_runs, at_point].into_iter().flatten();
        let worst = worst.filter_map(in_errors).fold(0.0, f64::max);
        if worst > 0.0 {
            found.push(Missed {
                model: surface.model,
                observable: name.clone(),
                in_errors: worst,
                pure,
            });
        }
    }
    found
}

/// Runs of the same parameters of a model, two or more each.
fn repeats<'s>(surface: &Surface, used: &[&'s Sample]) -> Vec<Vec<&'s Sample>> {
    let mut groups: BTreeMap<Vec<u64>, Vec<&Sample>> = BTreeMap::new();
    for &sample in used {
        // Adding 0 makes -0 and 0 the same.
        let at = surface.parameters.iter();
        let at = at.map(|&j| (sample.at[j] + 0.0).to_bits());
        let at = at.chain([sample.factor.to_bits()]).collect();
        groups.entry(at).or_default().push(sample);
    }
    groups.into_values().filter(|g| g.len() > 1).collect()
}

/// Sum of squares of an observable about its mean over a group; 0 where that is rounding.
fn squares(group: &[&Sample], observable: &str) -> f64 {
    let values = group.iter().map(|s| s.values[observable]);
    let mean = values.clone().sum::<f64>() / group.len() as f64;
    let sum: f64 = values.map(|y| (y - mean).powi(2)).sum();
    let rounding = group.len() as f64 * (ROUNDING * mean).powi(2);
    if sum > rounding { sum } else { 0.0 }
}
