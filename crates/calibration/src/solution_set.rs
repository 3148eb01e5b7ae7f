//! The whole set of solutions: every combination of parameters that agrees with the measurements.

use crate::intervals::{best_of, crossing};
use crate::joint_fit::{JointFit, Leash, Minimum, Whitening};
use crate::{Error, Estimate, SolutionSet};
use nalgebra::DVector;
use probability::chi_squared_quantile;
use random_stream::Stream;

/// Points drawn from the box.
const DRAWN: usize = 4096;
/// Points that are kept for pictures.
const KEPT: usize = 500;
/// Most separate points that are told.
const MOST_SEPARATE: usize = 8;
/// Places between two minima at which a way from one to the other is sought.
const PLACES: usize = 9;
/// How far is looked first for an end of the set, in halves of the box.
const FIRST_LOOK: f64 = 0.05;
/// Weight of the leash that holds such a place.
const LEASH: f64 = 1e4;

/// Draws the set inside the box of a fit.
///
/// # Formula
///
/// A point belongs to the set where Q is at most its least value plus the 95 % quantile of chi² for as many degrees of
/// freedom as parameters are searched. Two minima are one solution where a way leads from one to the other inside the
/// set: on planes across the straight line between them, Q is made least. The set ends along a parameter where the least Q over
/// all others leaves it.
///
/// # Errors
///
/// A quantile that does not exist, which no number of parameters leads to.
pub(crate) fn solution_set(
    fit: &JointFit<'_>,
    minima: &[Minimum],
    whitening: &Whitening,
    estimates: &[Estimate],
    seed: u64,
) -> Result<SolutionSet, Error> {
    let best = best_of(minima)?;
    let n = fit.n_free().max(1);
    let rise = chi_squared_quantile(0.05, n as f64).ok_or(Error::Search {
        what: "the set of solutions",
        reason: format!("chi squared has no quantile for {n} degrees of freedom"),
    })?;
    let limit = best.misfit + rise;
    let mut stream = Stream::new(seed, "solution set");
    let mut points = Vec::new();
    for _ in 0..DRAWN {
        let mut coded: Vec<f64> = (0..fit.free.len())
            .map(|_| stream.between(-1.0, 1.0))
            .collect();
        for (x, _) in coded.iter_mut().zip(&fit.free).filter(|(_, free)| !**free) {
            *x = 0.0;
        }
        if fit.misfit(&coded, whitening) <= limit {
            points.push(fit.natural(&coded));
        }
    }
    let separate = separate(fit, minima, whitening, limit);
    // A narrow set is met by few points: its ends are those of the ways from the minima, or a point where one lies farther.
    let extent = estimates.iter().enumerate().map(|(j, estimate)| {
        if !fit.free[j] {
            return [estimate.value; 2];
        }
        let ends = separate.iter().flat_map(|minimum| {
            [-1.0, 1.0].map(|side| {
                let end = crossing(fit, minimum, whitening, (j, side), FIRST_LOOK, limit);
                fit.region.natural(j, end.unwrap_or(side))
            })
        });
        let values: Vec<f64> = points.iter().map(|p| p[j]).chain(ends).collect();
        let low = values.iter().copied().fold(estimate.value, f64::min);
        [low, values.iter().copied().fold(estimate.value, f64::max)]
    });
    Ok(SolutionSet {
        share_of_box: points.len() as f64 / DRAWN as f64,
        extent: extent.collect(),
        separate: separate.iter().map(|m| fit.natural(&m.coded)).collect(),
        points: points.into_iter().take(KEPT).collect(),
    })
}

/// Minima inside the set to which no way inside it leads from a better one.
fn separate<'m>(
    fit: &JointFit<'_>,
    minima: &'m [Minimum],
    whitening: &Whitening,
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
    whitening: &Whitening,
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
        let leash = Leash {
            distance: direction.dot(&a) + share * length,
            direction: direction.clone(),
            weight: LEASH,
        };
        let line: Vec<f64> = (&a + &direction * (share * length))
            .iter()
            .copied()
            .collect();
        let low =
            |start: &[f64]| fit.minimise(start, whitening, &fit.free, std::slice::from_ref(&leash));
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
