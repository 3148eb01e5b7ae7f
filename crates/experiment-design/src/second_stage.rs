//! Runs added near a contour: the second stage of an experiment.

use probability::random_stream::Stream;

use crate::optimal::{PASSES, Target};
use crate::{Criterion, Design, DesignKind, Error, Factor, Region, check_factors};

/// Adds runs to given ones as [`crate::optimal_rows`] does, as block 2, taken from the points that `allowed` accepts in a
/// grid of levels -1, -1/2, 0, 1/2, +1: the second stage of an experiment near a contour.
///
/// # Errors
/// As [`crate::optimal_rows`]; [`Error::NoneNear`] if no point of the grid is allowed.
pub fn augmented_near(
    factors: &[Factor],
    criterion: Criterion,
    given: &[Vec<f64>],
    n_runs: usize,
    seed: u64,
    row: &dyn Fn(&[f64]) -> Vec<f64>,
    allowed: &dyn Fn(&[f64]) -> bool,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    let levels = if k <= 4 { 5_usize } else { 3 };
    if k > 8 {
        return Err(Error::CountOutOfRange {
            what: "factors of an experiment near a contour",
            given: k,
            least: 1,
            most: 8,
        });
    }
    let point = |index: usize| -> Vec<f64> {
        let mut rest = index;
        (0..k)
            .map(|_| {
                let level = rest % levels;
                rest /= levels;
                2.0 * level as f64 / (levels - 1) as f64 - 1.0
            })
            .collect()
    };
    let count = (0..k).fold(1, |count, _| count * levels);
    let candidates: Vec<Vec<f64>> = (0..count).map(point).filter(|x| allowed(x)).collect();
    let target = Target::new(&Region::cube(k), criterion, given, seed, row);
    let terms = target.terms();
    if candidates.is_empty() {
        return Err(Error::NoneNear { levels });
    }
    let least = terms.saturating_sub(given.len());
    if !(least..=500).contains(&n_runs) {
        return Err(Error::CountOutOfRange {
            what: "runs to add (both stages together need one per term)",
            given: n_runs,
            least,
            most: 500,
        });
    }
    let mut stream = Stream::new(seed, "second stage");
    let mut rows: Vec<Vec<f64>> = (0..n_runs)
        .map(|_| candidates[stream.below(candidates.len())].clone())
        .collect();
    let mut reached = target.cost(&rows);
    for _ in 0..PASSES {
        let before = reached;
        for i in 0..rows.len() {
            for candidate in &candidates {
                let kept = std::mem::replace(&mut rows[i], candidate.clone());
                let value = target.cost(&rows);
                if value < reached - 1e-12 * reached.abs() {
                    reached = value;
                } else {
                    rows[i] = kept;
                }
            }
        }
        if reached >= before {
            break;
        }
    }
    Design::in_stages(DesignKind::Augmented, factors, given, rows)
}

#[cfg(test)]
mod tests {
    use super::augmented_near;
    use crate::factor::coded_factors;
    use crate::{Criterion, full_factorial};

    /// Points of the second stage stay where they are allowed.
    #[test]
    fn the_second_stage_keeps_to_its_band() {
        let given = full_factorial(&coded_factors(2), 1).unwrap().coded_rows();
        let row = |x: &[f64]| vec![1.0, x[0], x[1], x[0] * x[1]];
        let near = |x: &[f64]| (x[0] - x[1]).abs() < 0.1;
        let both = augmented_near(
            &coded_factors(2),
            Criterion::Determinant,
            &given,
            4,
            1,
            &row,
            &near,
        );
        let rows = both.unwrap().coded_rows();
        assert_eq!(rows.len(), 9);
        assert!(rows[5..].iter().all(|x| near(x)));
    }
}
