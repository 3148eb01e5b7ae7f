//! The whole set of solutions: every combination of parameters that agrees with the measurements.

use crate::diagnosis::Whitener;
use crate::intervals::{best_of, crossing};
use crate::joint_fit::{JointFit, Minimum, Penalty};
use crate::{Error, Estimate, SolutionSet};
use nalgebra::DVector;
use probability::chi_squared_quantile;
use probability::random_stream::Stream;

/// Points drawn between the ends of the set.
const DRAWN: usize = 4096;
/// Points that are kept for pictures.
const KEPT: usize = 500;
/// Most separate points that are reported.
const MOST_SEPARATE: usize = 8;
/// Places between two minima at which a way from one to the other is sought.
const PLACES: usize = 9;
/// How far is looked first for an end of the set, in halves of the box.
const FIRST_LOOK: f64 = 0.05;
/// Weight of the penalty that holds such a place.
const PENALTY: f64 = 1e4;

/// Draws the set inside the box of a fit.
///
/// # Formula
///
/// A point belongs to the set where Q is at most its least value plus the 95 % quantile of chi² for as many degrees of
/// freedom as tuned parameters are searched. Two minima are one solution where a way leads from one to the other inside the
/// set: on planes across the straight line between them, Q is made least. The set ends along a parameter where the least Q over
/// all others leaves it; its points are drawn evenly between these ends. Inputs are where they fit each point best.
///
/// # Errors
///
/// A quantile that does not exist, which no number of parameters leads to.
pub(crate) fn solution_set(
    fit: &JointFit<'_>,
    minima: &[Minimum],
    whitening: &Whitener,
    estimates: &[Estimate],
    seed: u64,
) -> Result<SolutionSet, Error> {
    let best = best_of(minima)?;
    let tuned = fit.n_tuned();
    let free = fit.free[..tuned].iter().filter(|free| **free);
    let n = free.count().max(1);
    let rise = chi_squared_quantile(0.05, n as f64).ok_or(Error::Search {
        what: "the set of solutions",
        reason: format!("chi squared has no quantile for {n} degrees of freedom"),
    })?;
    let limit = best.misfit + rise;
    let separate = separate(fit, minima, whitening, limit);
    let end = |j: usize, side: f64| {
        let ends = separate.iter().map(|minimum| {
            let end = crossing(fit, minimum, whitening, (j, side), FIRST_LOOK, limit);
            side * end.unwrap_or(side)
        });
        side * ends.fold(-1.0, f64::max)
    };
    // Coded ends; what is not searched stays in the middle.
    let ends = |j: usize| {
        if fit.free[j] {
            [-1.0, 1.0].map(|side| end(j, side))
        } else {
            [0.0; 2]
        }
    };
    let ends: Vec<[f64; 2]> = (0..tuned).map(ends).collect();
    // A narrow set would be met by few points of the whole box.
    let mut stream = Stream::new(seed, "solution set");
    let drawn = (0..DRAWN).map(|_| {
        let point = ends.iter().zip(&fit.free);
        let point = point.map(|([low, high], free)| {
            if *free {
                stream.between(*low, *high)
            } else {
                0.0
            }
        });
        let inputs = best.coded[tuned..].iter().copied();
        let point = point.chain(inputs).collect::<Vec<f64>>();
        fit.with_best_inputs(point, whitening)
    });
    let inside = drawn.filter(|drawn| drawn.misfit <= limit);
    let points: Vec<Vec<f64>> = inside.map(|drawn| fit.natural(&drawn.coded)).collect();
    let within = ends.iter().zip(&fit.free).filter(|(_, free)| **free);
    let share_of_ends: f64 = within.map(|([low, high], _)| 0.5 * (high - low)).product();
    let extent = ends.iter().zip(estimates).enumerate();
    let extent = extent.map(|(j, (ends, estimate))| {
        if fit.free[j] {
            ends.map(|end| fit.region.natural(j, end))
        } else {
            [estimate.value; 2]
        }
    });
    Ok(SolutionSet {
        share_of_box: share_of_ends * points.len() as f64 / DRAWN as f64,
        extent: extent.collect(),
        separate: separate.iter().map(|m| fit.natural(&m.coded)).collect(),
        points: points.into_iter().take(KEPT).collect(),
    })
}

/// Minima inside the set to which no way inside it leads from a better one.
fn separate<'m>(
    fit: &JointFit<'_>,
    minima: &'m [Minimum],
    whitening: &Whitener,
    limit: f64,
) -> Vec<&'m Minimum> {
    let mut kept: Vec<&Minimum> = Vec::new();
    for minimum in minima.iter().filter(|m| m.misfit <= limit) {
        let joined = |other: &&Minimum| is_joined(fit, other, minimum, whitening, limit);
        if kept.len() < MOST_SEPARATE && !kept.iter().any(joined) {
            kept.push(minimum);
        }
    }
    kept
}

/// Whether a way inside the set leads from one minimum to another.
fn is_joined(
    fit: &JointFit<'_>,
    from: &Minimum,
    to: &Minimum,
    whitening: &Whitener,
    limit: f64,
) -> bool {
    let (a, b) = (
        DVector::from_column_slice(&from.coded),
        DVector::from_column_slice(&to.coded),
    );
    let length = (&b - &a).norm();
    if length == 0.0 {
        return true;
    }
    let direction = (&b - &a) / length;
    let mut start = from.coded.clone();
    (1..=PLACES).all(|place| {
        let share = place as f64 / (PLACES + 1) as f64;
        let penalty = Penalty {
            distance: direction.dot(&a) + share * length,
            direction: direction.clone(),
            weight: PENALTY,
        };
        let line: Vec<f64> = (&a + &direction * (share * length))
            .iter()
            .copied()
            .collect();
        let low = |start: &[f64]| {
            fit.minimise(start, whitening, &fit.free, std::slice::from_ref(&penalty))
        };
        let (along, onward) = (low(&line), low(&start));
        let better = if along.misfit < onward.misfit {
            along
        } else {
            onward
        };
        start.clone_from(&better.coded);
        fit.misfit(&better.coded, whitening) <= limit
    })
}
