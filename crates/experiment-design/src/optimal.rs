//! Designs that are optimal for a given model.

mod criterion;

use probability::random_stream::Stream;

pub use criterion::Criterion;
pub(crate) use criterion::Target;

use crate::{Design, Error, Factor, Region, check_factors};

/// Coded points of a design, (runs, factors).
type CodedRows = Vec<Vec<f64>>;

/// Random starts of the exchange; the best of ten is rarely beaten by more than 1 %.
const STARTS: usize = 10;
/// Passes over all coordinates per start; the exchange stops by itself long before.
pub(crate) const PASSES: usize = 50;
/// The levels from which coordinates of the whole box start; enough for quadratic models.
const LEVELS: [f64; 3] = [-1.0, 0.0, 1.0];

/// A design of `n_runs` runs on the levels -1, 0, +1 that is nearly optimal for a model.
///
/// `row` gives the terms of the model at a coded point. Each coordinate in turn is set to its
/// best level until none changes, from ten random starts; the result depends on the seed.
///
/// # Source
/// Coordinate exchange: `[Meyer1995]`.
///
/// # Errors
/// Those of [`optimal_rows`] and [`check_factors`].
pub fn optimal_design(
    factors: &[Factor],
    criterion: Criterion,
    n_runs: usize,
    seed: u64,
    row: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let region = Region::cube(factors.len());
    let rows = optimal_rows(&region, criterion, &[], n_runs, seed, row)?;
    Design::new(criterion.kind(), factors, Vec::new(), rows)
}

/// Runs, added to given ones, that are nearly optimal for a model within a region; all rows are in the coordinates of the
/// region.
///
/// Coordinates move to the ends and the middle of their range within the constraints, or to their levels; under
/// constraints whole runs move to the corners of the region and the middles between them as well.
///
/// # Errors
/// [`Error::CountOutOfRange`] for fewer runs than terms, the given ones counted, or more than 500;
/// [`Error::BadRun`] for a given run of wrong length.
pub fn optimal_rows(
    region: &Region,
    criterion: Criterion,
    given: &[Vec<f64>],
    n_runs: usize,
    seed: u64,
    row: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Vec<Vec<f64>>, Error> {
    let k = region.len();
    if let Some(i) = given.iter().position(|x| x.len() != k) {
        return Err(Error::BadRun {
            run: i + 1,
            columns: k,
        });
    }
    let target = Target::new(region, criterion, given, seed, row);
    let least = target.terms().saturating_sub(given.len());
    if !(least..=500).contains(&n_runs) {
        return Err(Error::CountOutOfRange {
            what: "runs of the optimal design (at least one per term)",
            given: n_runs,
            least,
            most: 500,
        });
    }
    let mut stream = Stream::new(seed, "optimal design");
    let random = |_| {
        let mut row = || (0..k).map(|_| LEVELS[stream.below(LEVELS.len())]).collect();
        (0..n_runs).map(|_| row()).collect()
    };
    let starts: Vec<CodedRows> = if region.is_cube() {
        (0..STARTS).map(random).collect()
    } else {
        let points = region.sample(STARTS * n_runs, seed);
        points.chunks(n_runs.max(1)).map(<[_]>::to_vec).collect()
    };
    let candidates = region.candidates();
    let mut best: Option<(f64, CodedRows)> = None;
    for mut rows in starts {
        let reached = exchange(&mut rows, region, &candidates, &target);
        if best.as_ref().is_none_or(|(least, _)| reached < *least) {
            best = Some((reached, rows));
        }
    }
    let (_, mut rows) = best.unwrap_or_default();
    rows.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    Ok(rows)
}

/// Sets each run to its best candidate and each coordinate to its best value until a pass changes nothing; returns the cost.
fn exchange(
    rows: &mut [Vec<f64>],
    region: &Region,
    candidates: &[Vec<f64>],
    target: &Target,
) -> f64 {
    let mut reached = target.cost(rows);
    // Rounding must not make two equal values alternate for ever.
    let better = |value: f64, reached: f64| value < reached - 1e-12 * reached.abs();
    for _ in 0..PASSES {
        let before = reached;
        for i in 0..rows.len() {
            for candidate in candidates {
                let kept = std::mem::replace(&mut rows[i], candidate.clone());
                let value = target.cost(rows);
                if better(value, reached) {
                    reached = value;
                } else {
                    rows[i] = kept;
                }
            }
            for j in 0..rows[i].len() {
                let mut kept = rows[i][j];
                for value in region.values(&rows[i], j) {
                    rows[i][j] = value;
                    let cost = target.cost(rows);
                    if better(cost, reached) {
                        (reached, kept) = (cost, value);
                    }
                }
                rows[i][j] = kept;
            }
        }
        if reached >= before {
            break;
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::{Criterion, Target, optimal_design, optimal_rows};
    use crate::factor::coded_factors;
    use crate::{Constraint, Coordinate, Error, Region, full_factorial};

    fn linear(x: &[f64]) -> Vec<f64> {
        std::iter::once(1.0).chain(x.iter().copied()).collect()
    }

    /// For a linear model in three factors and eight runs no design beats orthogonal corners
    /// (Hadamard's bound): the exchange must reach their determinant to rounding.
    #[test]
    fn linear_model_gets_an_orthogonal_two_level_design() {
        let design =
            optimal_design(&coded_factors(3), Criterion::Determinant, 8, 3, &linear).unwrap();
        let full = full_factorial(&coded_factors(3), 0).unwrap();
        let target = Target::new(&Region::cube(3), Criterion::Determinant, &[], 1, &linear);
        let (got, best) = (
            target.cost(&design.coded_rows()),
            target.cost(&full.coded_rows()),
        );
        assert!((got - best).abs() < 1e-9, "{got} against {best}");
    }

    /// For a quadratic in one factor the D-optimal design puts a third of the runs on each of
    /// -1, 0, 1 (known result), and the I-optimal one half on the middle [1/4, 1/2, 1/4].
    #[test]
    fn quadratic_in_one_factor_gets_the_known_shares() {
        let row = |x: &[f64]| vec![1.0, x[0], x[0] * x[0]];
        let middle = |criterion| {
            let design = optimal_design(&coded_factors(1), criterion, 12, 5, &row).unwrap();
            design
                .runs()
                .iter()
                .filter(|run| run.coded[0] == 0.0)
                .count()
        };
        assert_eq!(middle(Criterion::Determinant), 4);
        assert_eq!(middle(Criterion::MeanVariance), 6);
    }

    /// Half a factorial in three factors, with four runs added for a linear model with
    /// interactions, must become the full factorial: no other eight runs are orthogonal.
    #[test]
    fn added_runs_complete_the_factorial() {
        let half: Vec<Vec<f64>> = full_factorial(&coded_factors(3), 0)
            .unwrap()
            .coded_rows()
            .into_iter()
            .filter(|x| x.iter().product::<f64>() > 0.0)
            .collect();
        let row = |x: &[f64]| vec![1.0, x[0], x[1], x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2]];
        let cube = Region::cube(3);
        let added = optimal_rows(&cube, Criterion::Determinant, &half, 4, 1, &row).unwrap();
        let mut rows = [half, added].concat();
        rows.sort_by(|a, b| a.partial_cmp(b).unwrap());
        rows.dedup();
        assert_eq!(rows.len(), 8, "{rows:?}");
    }

    #[test]
    fn fewer_runs_than_terms_are_refused() {
        let error = optimal_design(&coded_factors(3), Criterion::Determinant, 3, 1, &linear);
        assert!(matches!(
            error,
            Err(Error::CountOutOfRange { least: 4, .. })
        ));
    }

    /// A plane over a triangle (x + y <= 0 in the square): a D-optimal design of a linear model puts a third of its runs
    /// on each corner of the triangle.
    #[test]
    fn a_plane_over_a_triangle_is_measured_at_its_corners() {
        let constraint = Constraint {
            weights: vec![1.0, 1.0],
            bound: 0.0,
        };
        let region = Region::new(vec![Coordinate::Range; 2], vec![constraint]).unwrap();
        let rows = optimal_rows(&region, Criterion::Determinant, &[], 9, 1, &linear).unwrap();
        for corner in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0]] {
            let count = rows.iter().filter(|row| **row == corner).count();
            assert_eq!(count, 3, "{rows:?}");
        }
    }

    /// Two slanted constraints meet at (0, 0.5): moves along the axes cannot reach that corner, moves to corners do. With
    /// x + y <= 0.5 and y - x <= 0.5 a plane of 12 runs has no run off the corners of the region.
    #[test]
    fn corners_where_two_constraints_meet_are_reached() {
        let limit = |x: f64| Constraint {
            weights: vec![x, 1.0],
            bound: 0.5,
        };
        let constraints = vec![limit(1.0), limit(-1.0)];
        let region = Region::new(vec![Coordinate::Range; 2], constraints).unwrap();
        let rows = optimal_rows(&region, Criterion::Determinant, &[], 12, 1, &linear).unwrap();
        assert!(rows.contains(&vec![0.0, 0.5]), "{rows:?}");
        let corners = region.corners();
        assert_eq!(corners.len(), 5);
        assert!(rows.iter().all(|row| corners.contains(row)), "{rows:?}");
    }

    /// Four levels in a line: a quadratic in one factor takes its ends and one of the two middle levels, a third each.
    #[test]
    fn a_factor_of_levels_takes_no_other_value() {
        let levels = vec![-1.0, -0.4, 0.1, 1.0];
        let region = Region::new(vec![Coordinate::Levels(levels)], Vec::new()).unwrap();
        let row = |x: &[f64]| vec![1.0, x[0], x[0] * x[0]];
        let rows = optimal_rows(&region, Criterion::Determinant, &[], 9, 1, &row).unwrap();
        let taken: Vec<f64> = rows.iter().map(|x| x[0]).collect();
        assert_eq!(taken, [-1.0, -1.0, -1.0, 0.1, 0.1, 0.1, 1.0, 1.0, 1.0]);
    }
}
