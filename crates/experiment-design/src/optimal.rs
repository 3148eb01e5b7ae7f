//! Designs that are optimal for a given model.

use random_stream::Stream;

use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Random starts of the exchange; the best of ten is rarely beaten by more than 1 %.
const STARTS: usize = 10;
/// Passes over all coordinates per start; the exchange stops by itself long before.
pub(crate) const PASSES: usize = 50;
/// The levels a coordinate may take; enough for quadratic models on a box.
const LEVELS: [f64; 3] = [-1.0, 0.0, 1.0];
/// Added to the diagonal of X'X, relative to the runs, so that a poor start has a finite value.
const RIDGE: f64 = 1e-8;

/// What an optimal design makes small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Determinant of (X'X)^-1: the volume of the confidence region of the coefficients (D).
    Determinant,
    /// Mean over the box of x'(X'X)^-1 x: the variance of the prediction (I).
    MeanVariance,
}

/// A design of `n_runs` runs on the levels -1, 0, +1 that is nearly optimal for a model.
///
/// `row` gives the terms of the model at a coded point. Each coordinate in turn is set to its
/// best level until none changes, from ten random starts; the result depends on the seed.
///
/// # Source
/// Coordinate exchange: `[Meyer1995]`.
///
/// # Errors
/// [`Error::CountOutOfRange`] for fewer runs than terms or more than 500; those of
/// [`check_factors`].
pub fn optimal_design(
    factors: &[Factor],
    criterion: Criterion,
    n_runs: usize,
    seed: u64,
    row: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Design, Error> {
    augmented_design(factors, criterion, &[], n_runs, seed, row)
}

/// Adds `n_runs` runs on the levels -1, 0, +1 to given coded runs so that all of them together are
/// nearly optimal for a model. The given runs come first, in block 1; the added ones are block 2.
/// Without given runs it is [`optimal_design`].
///
/// # Errors
/// As [`optimal_design`], for all runs together; [`Error::BadRun`] for a given run of wrong length.
pub fn augmented_design(
    factors: &[Factor],
    criterion: Criterion,
    given: &[Vec<f64>],
    n_runs: usize,
    seed: u64,
    row: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Design, Error> {
    optimal_within(factors, criterion, given, n_runs, seed, row)
}

/// Given runs as block 1 and added ones as block 2.
pub(crate) fn stacked(
    factors: &[Factor],
    given: &[Vec<f64>],
    added: Vec<Vec<f64>>,
    kind: DesignKind,
) -> Result<Design, Error> {
    let first = given.len();
    let rows: Vec<Vec<f64>> = given.iter().cloned().chain(added).collect();
    let blocks: Vec<usize> = (0..rows.len())
        .map(|i| 1 + usize::from(first > 0 && i >= first))
        .collect();
    Design::new(kind, factors, Vec::new(), rows)?.blocked(&blocks)
}

/// The exchange behind the designs on three levels.
fn optimal_within(
    factors: &[Factor],
    criterion: Criterion,
    given: &[Vec<f64>],
    n_runs: usize,
    seed: u64,
    row: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    if let Some(i) = given.iter().position(|x| x.len() != k) {
        return Err(Error::BadRun {
            run: i + 1,
            columns: k,
        });
    }
    let terms = row(&vec![0.0; k]).len();
    let least = terms.saturating_sub(given.len());
    if !(least..=500).contains(&n_runs) {
        return Err(Error::CountOutOfRange {
            what: "runs of the optimal design (at least one per term)",
            given: n_runs,
            least,
            most: 500,
        });
    }
    let mut stream = Stream::new(seed, "optimal design");
    let moments = box_moments(k, row, seed);
    let fixed = information(given, row, terms);
    let cost = |rows: &[Vec<f64>]| {
        let mut sum = information(rows, row, terms);
        for (entry, more) in sum.iter_mut().flatten().zip(fixed.iter().flatten()) {
            *entry += more;
        }
        match criterion {
            Criterion::Determinant => log_determinant_cost(&sum),
            Criterion::MeanVariance => variance_cost(&sum, &moments),
        }
    };
    let mut best: Option<(f64, Vec<Vec<f64>>)> = None;
    for _ in 0..STARTS {
        let level = |stream: &mut Stream| LEVELS[stream.below(LEVELS.len())];
        let mut rows: Vec<Vec<f64>> = (0..n_runs)
            .map(|_| (0..k).map(|_| level(&mut stream)).collect())
            .collect();
        let reached = exchange(&mut rows, &cost);
        if best.as_ref().is_none_or(|(least, _)| reached < *least) {
            best = Some((reached, rows));
        }
    }
    let (_, mut rows) = best.unwrap_or_default();
    rows.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let kind = match (given.is_empty(), criterion) {
        (false, _) => DesignKind::Augmented,
        (true, Criterion::Determinant) => DesignKind::DOptimal,
        (true, Criterion::MeanVariance) => DesignKind::IOptimal,
    };
    stacked(factors, given, rows, kind)
}

/// Sets each coordinate to its best level until a pass changes nothing; returns the cost.
fn exchange(rows: &mut [Vec<f64>], cost: &dyn Fn(&[Vec<f64>]) -> f64) -> f64 {
    let mut reached = cost(rows);
    for _ in 0..PASSES {
        let before = reached;
        for i in 0..rows.len() {
            for j in 0..rows[i].len() {
                let mut kept = rows[i][j];
                for level in LEVELS {
                    rows[i][j] = level;
                    let value = cost(rows);
                    // Rounding must not make two equal levels alternate for ever.
                    if value < reached - 1e-12 * reached.abs() {
                        (reached, kept) = (value, level);
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

/// X'X with a slight ridge, (terms, terms).
pub(crate) fn information(
    rows: &[Vec<f64>],
    row: &dyn Fn(&[f64]) -> Vec<f64>,
    terms: usize,
) -> Vec<Vec<f64>> {
    let mut sum = vec![vec![0.0; terms]; terms];
    for (i, line) in sum.iter_mut().enumerate() {
        line[i] = RIDGE * rows.len() as f64;
    }
    for x in rows.iter().map(|x| row(x)) {
        for (line, a) in sum.iter_mut().zip(&x) {
            for (entry, b) in line.iter_mut().zip(&x) {
                *entry += a * b;
            }
        }
    }
    sum
}

/// Lower Cholesky factor of a symmetric positive definite matrix.
fn cholesky(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|m| factor[i][m] * factor[j][m]).sum();
            factor[i][j] = if i == j {
                (matrix[i][i] - sum).max(f64::MIN_POSITIVE).sqrt()
            } else {
                (matrix[i][j] - sum) / factor[j][j]
            };
        }
    }
    factor
}

/// ln det (X'X)^-1.
pub(crate) fn log_determinant_cost(information: &[Vec<f64>]) -> f64 {
    let factor = cholesky(information);
    -2.0 * (0..factor.len()).map(|i| factor[i][i].ln()).sum::<f64>()
}

/// Trace of (X'X)^-1 M, M the mean of x x' over the box.
pub(crate) fn variance_cost(information: &[Vec<f64>], moments: &[Vec<f64>]) -> f64 {
    let factor = cholesky(information);
    let n = factor.len();
    // Columns of the inverse factor: (X'X)^-1 = L^-T L^-1.
    let mut inverse = vec![vec![0.0; n]; n];
    for j in 0..n {
        inverse[j][j] = 1.0 / factor[j][j];
        for i in j + 1..n {
            let sum: f64 = (j..i).map(|m| factor[i][m] * inverse[m][j]).sum();
            inverse[i][j] = -sum / factor[i][i];
        }
    }
    let mut trace = 0.0;
    for line in &inverse {
        for (a, moment) in line.iter().zip(moments) {
            trace += a * line.iter().zip(moment).map(|(b, m)| b * m).sum::<f64>();
        }
    }
    trace
}

/// Mean of x x' over the box from a Latin hypercube and its mirror images of signs, exact for
/// odd powers and good to about 1 % for even ones, which is enough to rank designs.
pub(crate) fn box_moments(k: usize, row: &dyn Fn(&[f64]) -> Vec<f64>, seed: u64) -> Vec<Vec<f64>> {
    const POINTS: usize = 512;
    let mut stream = Stream::new(seed, "moments of the box");
    let mut columns: Vec<Vec<f64>> = Vec::with_capacity(k);
    for _ in 0..k {
        let middle = |i: usize| 2.0 * (i as f64 + 0.5) / POINTS as f64 - 1.0;
        let mut column: Vec<f64> = (0..POINTS).map(middle).collect();
        stream.shuffle(&mut column);
        columns.push(column);
    }
    let point = |i: usize, sign: f64| columns.iter().map(|c| sign * c[i]).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = (0..POINTS)
        .flat_map(|i| [point(i, 1.0), point(i, -1.0)])
        .collect();
    let terms = row(&vec![0.0; k]).len();
    let mut moments = information(&rows, row, terms);
    for entry in moments.iter_mut().flatten() {
        *entry /= rows.len() as f64;
    }
    moments
}

#[cfg(test)]
mod tests {
    use super::{Criterion, augmented_design, information, log_determinant_cost, optimal_design};
    use crate::{Error, Factor, full_factorial};

    fn factors(k: usize) -> Vec<Factor> {
        (0..k)
            .map(|i| Factor::coded_only(&format!("x{i}")).unwrap())
            .collect()
    }

    fn linear(x: &[f64]) -> Vec<f64> {
        std::iter::once(1.0).chain(x.iter().copied()).collect()
    }

    /// For a linear model in three factors and eight runs no design beats orthogonal corners
    /// (Hadamard's bound): the exchange must reach their determinant to rounding.
    #[test]
    fn linear_model_gets_an_orthogonal_two_level_design() {
        let design = optimal_design(&factors(3), Criterion::Determinant, 8, 3, &linear).unwrap();
        let full = full_factorial(&factors(3), 0).unwrap();
        let cost = |rows: &[Vec<f64>]| log_determinant_cost(&information(rows, &linear, 4));
        let (got, best) = (cost(&design.coded_rows()), cost(&full.coded_rows()));
        assert!((got - best).abs() < 1e-9, "{got} against {best}");
    }

    /// For a quadratic in one factor the D-optimal design puts a third of the runs on each of
    /// -1, 0, 1 (known result), and the I-optimal one half on the middle [1/4, 1/2, 1/4].
    #[test]
    fn quadratic_in_one_factor_gets_the_known_shares() {
        let row = |x: &[f64]| vec![1.0, x[0], x[0] * x[0]];
        let middle = |criterion| {
            let design = optimal_design(&factors(1), criterion, 12, 5, &row).unwrap();
            design
                .runs()
                .iter()
                .filter(|run| run.coded[0] == 0.0)
                .count()
        };
        assert_eq!(middle(Criterion::Determinant), 4);
        assert_eq!(middle(Criterion::MeanVariance), 6);
    }

    /// Half a factorial in three factors, augmented by four runs for a linear model with
    /// interactions, must become the full factorial: no other eight runs are orthogonal.
    #[test]
    fn augmentation_completes_the_factorial() {
        let half: Vec<Vec<f64>> = full_factorial(&factors(3), 0)
            .unwrap()
            .coded_rows()
            .into_iter()
            .filter(|x| x.iter().product::<f64>() > 0.0)
            .collect();
        let row = |x: &[f64]| vec![1.0, x[0], x[1], x[2], x[0] * x[1], x[0] * x[2], x[1] * x[2]];
        let both =
            augmented_design(&factors(3), Criterion::Determinant, &half, 4, 1, &row).unwrap();
        let mut rows = both.coded_rows();
        assert_eq!(rows[..4], half[..]);
        assert_eq!(both.runs()[4].block, 2);
        rows.sort_by(|a, b| a.partial_cmp(b).unwrap());
        rows.dedup();
        assert_eq!(rows.len(), 8, "{rows:?}");
    }

    #[test]
    fn fewer_runs_than_terms_are_refused() {
        let error = optimal_design(&factors(3), Criterion::Determinant, 3, 1, &linear);
        assert!(matches!(
            error,
            Err(Error::CountOutOfRange { least: 4, .. })
        ));
    }
}
