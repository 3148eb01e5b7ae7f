//! From the least misfit to estimates with standard errors and intervals.

mod uncertainty;
mod weights;

use crate::diagnosis::Whitener;
use crate::joint_fit::{JointFit, Minimum};
use crate::{Error, Estimate, FitTest, InputEstimate, Prior};
use probability::{f_upper_tail, normal_quantile, t_two_sided_quantile};
use uncertainty::is_open;
pub(crate) use uncertainty::{SHARE, Uncertainty};
use weights::variance_dof;

/// Chance of the two tails outside an interval.
const TAILS: f64 = 0.05;
/// Beyond so many degrees of freedom Student's quantile is the normal one to five digits.
const MANY: f64 = 1e6;
/// Halvings of the bracket of an end of an interval.
const HALVINGS: usize = 40;
/// Distance from a limit, in widths of the limits, at which an estimate lies on it.
const ON_A_LIMIT: f64 = 1e-6;

pub(crate) fn inputs(
    fit: &JointFit<'_>,
    best: &Minimum,
    uncertainty: &Uncertainty,
) -> Vec<InputEstimate> {
    let at = fit.natural(&best.coded);
    let (tuned, inputs) = fit.parameters.split_at(fit.n_tuned());
    let each = inputs.iter().enumerate().filter_map(|(place, input)| {
        let j = tuned.len() + place;
        let Prior { mean, sd } = input.prior?;
        let moves = tuned.iter().enumerate();
        Some(InputEstimate {
            symbol: input.symbol.clone(),
            name: input.name.clone(),
            unit: input.unit.clone(),
            sets: input.sets.clone(),
            stated: mean,
            sd,
            value: at[j],
            se: uncertainty.covariance[(j, j)].sqrt(),
            moved: (at[j] - mean) / sd,
            moves: moves
                .map(|(k, p)| (p.symbol.clone(), uncertainty.by_inputs[(k, place)]))
                .collect(),
        })
    });
    each.collect()
}

/// Estimates of the tuned parameters with their intervals.
///
/// # Formula
///
/// An end of an interval is where the least Q over all other parameters has risen by t² times the growth of the variance
/// by estimated weights and by `1 / (1 - (t² - 1) h)`, t Student's quantile for the effective degrees of freedom (profile) and h what
/// [the error of the slopes adds at one standard error](growth_with_distance) `[Fieller1954]`, once of which is in the variance; for a
/// plane with exact slopes that is `value +- t se`. If slopes were dropped as noise, the surfaces still have them, and the end is that of the plane. Outside the box
/// the surfaces say nothing: there the end is that of the plane too, at least the edge of the box. Ends are cut at the limits.
pub(crate) fn estimates(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    uncertainty: &Uncertainty,
) -> Vec<Estimate> {
    let at = fit.natural(&best.coded);
    let each = fit.parameters[..fit.n_tuned()].iter().enumerate();
    each.map(|(j, parameter)| {
        let [least, most] = parameter.limits;
        let width = most - least;
        let value = at[j];
        let se = uncertainty.standard_error(j, parameter);
        let interval95 = match se {
            Some(_) if fit.free[j] => {
                let ends =
                    [-1.0, 1.0].map(|side| end(fit, best, whitening, uncertainty, (j, side)));
                [ends[0].max(least), ends[1].min(most)]
            }
            _ => [least, most],
        };
        Estimate {
            symbol: parameter.symbol.clone(),
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            sets: parameter.sets.clone(),
            start: parameter.start,
            value,
            se: se.filter(|_| fit.free[j]),
            interval95,
            fixed_by_data: fit.free[j]
                && !is_open(&uncertainty.by_data, j, uncertainty.quantile(j)),
            at_limit: fit.free[j]
                && ((value - least).abs() < ON_A_LIMIT * width
                    || (most - value).abs() < ON_A_LIMIT * width),
            limits: parameter.limits,
        }
    })
    .collect()
}

/// One end of the interval of parameter j, unit of the parameter.
fn end(
    fit: &JointFit<'_>,
    best: &Minimum,
    whitening: &Whitener,
    uncertainty: &Uncertainty,
    (j, side): (usize, f64),
) -> f64 {
    let t = uncertainty.quantile(j);
    let growth = uncertainty.growth[j];
    let half = t * (growth * uncertainty.covariance[(j, j)]).sqrt() / fit.region.half(j);
    if !uncertainty.of_the_surfaces {
        return fit.region.natural(j, best.coded[j] + side * half);
    }
    let limit = best.misfit + t * t * growth * uncertainty.inflation[j];
    if let Some(x) = crossing(fit, best, whitening, (j, side), half, limit) {
        return fit.region.natural(j, x);
    }
    let line = fit.region.natural(j, best.coded[j] + side * half);
    let edge = fit.region.natural(j, side);
    if side > 0.0 {
        line.max(edge)
    } else {
        line.min(edge)
    }
}

/// Value of parameter j, coded, at which the least Q over all other parameters rises above a limit on the way from a minimum; `None`
/// if it does not inside the box. `step` is the first distance.
pub(crate) fn crossing(
    fit: &JointFit<'_>,
    from: &Minimum,
    whitening: &Whitener,
    (j, side): (usize, f64),
    step: f64,
    limit: f64,
) -> Option<f64> {
    let mut free = fit.free.clone();
    free[j] = false;
    let profile = |from: &[f64], x: f64| {
        let mut start = from.to_vec();
        start[j] = x;
        fit.minimise(&start, whitening, &free, &[])
    };
    let (mut inside, mut from) = (from.coded[j], from.coded.clone());
    let begin = inside;
    let mut step = step.max(1e-9);
    let mut outside = loop {
        let x = (begin + side * step).clamp(-1.0, 1.0);
        let there = profile(&from, x);
        if there.misfit > limit {
            break x;
        }
        if x.abs() >= 1.0 {
            return None;
        }
        (inside, from) = (x, there.coded);
        step *= 1.5;
    };
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        let there = profile(&from, middle);
        if there.misfit > limit {
            outside = middle;
        } else {
            (inside, from) = (middle, there.coded);
        }
        if (outside - inside).abs() < 1e-9 {
            break;
        }
    }
    Some(0.5 * (inside + outside))
}

/// Two-sided 95 % quantile of Student's distribution, of the normal one for very many degrees of freedom.
pub(crate) fn student(degrees_of_freedom: f64) -> f64 {
    quantile_of(TAILS, degrees_of_freedom)
}

/// The t that |T| exceeds with a chance of `tails`.
pub(crate) fn quantile_of(tails: f64, degrees_of_freedom: f64) -> f64 {
    let student = t_two_sided_quantile(tails, degrees_of_freedom.min(MANY));
    let normal = || normal_quantile(1.0 - 0.5 * tails);
    student.or_else(normal).unwrap_or(f64::INFINITY)
}

/// Whether the fit leaves more than noise.
///
/// # Formula
///
/// Q over its degrees of freedom f = measurements + priors - parameters is compared with F(f, d), d the harmonic mean
/// of the effective degrees of freedom of the variances in V.
pub(crate) fn test(fit: &JointFit<'_>, best: &Minimum) -> FitTest {
    let rows = fit.targets.len() + fit.n_priors();
    let degrees_of_freedom = rows.saturating_sub(fit.n_free());
    let inverse: f64 = variance_dof(fit, best).iter().map(|dof| 1.0 / dof).sum();
    let denominator = (fit.targets.len() as f64 / inverse).min(MANY);
    let f = degrees_of_freedom as f64;
    FitTest {
        misfit: best.misfit,
        degrees_of_freedom,
        p: f_upper_tail(best.misfit / f, f, denominator),
    }
}

/// The error of a fit without a point; it cannot happen with one start or more.
pub(crate) fn best_of(minima: &[Minimum]) -> Result<&Minimum, Error> {
    minima.first().ok_or(Error::Search {
        what: "the estimate",
        reason: "no point was searched".into(),
    })
}
