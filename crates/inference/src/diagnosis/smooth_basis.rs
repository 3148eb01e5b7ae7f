//! A generic smooth basis over the conditions: what an unknown effect would look like.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

use crate::diagnosis::problem::{Part, Row};
use crate::diagnosis::problem_file::{Condition, Level};

/// A positive coordinate whose largest value is this many times its smallest acts through its
/// logarithm, as a speed does; twice or half this number changes only mildly bent columns.
const LOG_RATIO: f64 = 3.0;
/// A coordinate with this many levels also gets its square; with fewer the square would follow
/// every level and be no smooth curve.
const LEVELS_FOR_SQUARE: usize = 4;

/// Gives the basis (rows, columns): for every observable a constant and, over its conditions,
/// each numeric coordinate (its logarithm where it spans a wide range), the square of those with
/// many levels, and an indicator for each kind but the most frequent one.
///
/// Numeric columns are centred and scaled to variance 1 over the conditions, and every row is
/// multiplied by the standard deviation of its noise, so that a coefficient counts in noise
/// standard deviations. [statistics of this project, section 4.2, step 2]
pub(crate) fn smooth_basis(part: &Part) -> DMatrix<f64> {
    let conditions: Vec<&Condition> = part.conditions.iter().collect();
    let variances = part.covariance.diagonal();
    let noise: Vec<f64> = variances.iter().map(|v| v.sqrt()).collect();
    basis(&conditions, &part.rows, &noise)
}

/// The basis over some rows, whose conditions have these coordinates and whose noise these standard deviations.
pub(crate) fn basis(conditions: &[&Condition], rows: &[Row], noise: &[f64]) -> DMatrix<f64> {
    let present: BTreeSet<usize> = rows.iter().map(|row| row.condition).collect();
    let conditions: Vec<&Condition> = present
        .iter()
        .filter_map(|&c| conditions.get(c).copied())
        .collect();
    let shapes = shapes(&conditions);
    let place: Vec<usize> = present.iter().copied().collect();
    let observables: BTreeSet<usize> = rows.iter().map(|row| row.observable).collect();
    let mut columns = Vec::new();
    for &observable in &observables {
        for shape in &shapes {
            let entries = rows.iter().zip(noise).map(|(row, sd)| {
                let at = place.binary_search(&row.condition).ok();
                match at.and_then(|i| shape.get(i)) {
                    Some(value) if row.observable == observable => value * sd,
                    _ => 0.0,
                }
            });
            columns.push(DVector::from_iterator(rows.len(), entries));
        }
    }
    if columns.is_empty() {
        return DMatrix::zeros(rows.len(), 0);
    }
    DMatrix::from_columns(&columns)
}

/// Values over the conditions of the functions that the basis is made of.
fn shapes(conditions: &[&Condition]) -> Vec<Vec<f64>> {
    let mut shapes = vec![vec![1.0; conditions.len()]];
    let names: BTreeSet<&String> = conditions.iter().flat_map(|c| c.keys()).collect();
    for name in names {
        let levels: Vec<Option<&Level>> = conditions.iter().map(|c| c.get(name)).collect();
        let numbers: Option<Vec<f64>> = levels
            .iter()
            .map(|level| match level {
                Some(Level::Number(x)) => Some(*x),
                _ => None,
            })
            .collect();
        match numbers {
            Some(values) => shapes.extend(numeric_shapes(&values)),
            None => shapes.extend(kind_shapes(&levels)),
        }
    }
    shapes
}

/// The coordinate, scaled, and its square where it has many levels.
fn numeric_shapes(values: &[f64]) -> Vec<Vec<f64>> {
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let wide = smallest > 0.0 && largest >= LOG_RATIO * smallest;
    let values: Vec<f64> = values
        .iter()
        .map(|x| if wide { x.ln() } else { *x })
        .collect();
    let Some(scaled) = standardised(&values) else {
        return Vec::new();
    };
    let mut distinct = scaled.clone();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    let squares: Vec<f64> = scaled.iter().map(|x| x * x).collect();
    let many = distinct.len() >= LEVELS_FOR_SQUARE;
    let square = standardised(&squares).filter(|_| many);
    std::iter::once(scaled).chain(square).collect()
}

/// An indicator for each kind but the most frequent one; a missing level is a kind too. A kind
/// with a single condition gets none: its column would follow that condition and nothing else.
fn kind_shapes(levels: &[Option<&Level>]) -> Vec<Vec<f64>> {
    let kind = |level: Option<&Level>| match level {
        Some(Level::Kind(kind)) => kind.clone(),
        Some(Level::Number(x)) => x.to_string(),
        None => String::new(),
    };
    let kinds: Vec<String> = levels.iter().copied().map(kind).collect();
    let count = |wanted: &String| kinds.iter().filter(|k| *k == wanted).count();
    let mut shared: Vec<&String> = kinds.iter().filter(|k| count(k) > 1).collect();
    shared.sort_unstable();
    shared.dedup();
    // A stable sort: kinds of equal frequency stay in the order of the alphabet.
    shared.sort_by_key(|k| std::cmp::Reverse(count(k)));
    shared
        .into_iter()
        .skip(1)
        .map(|wanted| {
            let is_it = |k: &String| f64::from(u8::from(k == wanted));
            kinds.iter().map(is_it).collect()
        })
        .collect()
}

/// Mean 0 and variance 1; none when the values do not vary.
fn standardised(values: &[f64]) -> Option<Vec<f64>> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    let spread = variance.sqrt();
    // Less than this is rounding of the mean.
    if spread <= 1e-12 * mean.abs().max(f64::MIN_POSITIVE) {
        return None;
    }
    Some(values.iter().map(|x| (x - mean) / spread).collect())
}

#[cfg(test)]
mod tests {
    use super::shapes;
    use crate::diagnosis::problem_file::{Condition, Level};

    fn drum(rpm: f64, fill: f64, wall: &str) -> Condition {
        Condition::from([
            ("rpm".into(), Level::Number(rpm)),
            ("fill".into(), Level::Number(fill)),
            ("wall".into(), Level::Kind(wall.into())),
        ])
    }

    /// Constant, fill, log rpm, its square, one wall: the basis of section 4.2. Equal steps of the
    /// logarithm give equal steps of the column.
    #[test]
    fn basis_of_drum_conditions_is_constant_fill_log_speed_square_and_wall() {
        let conditions = [
            drum(4.0, 0.2, "a"),
            drum(8.0, 0.3, "b"),
            drum(16.0, 0.2, "a"),
            drum(32.0, 0.3, "b"),
        ];
        let shapes = shapes(&conditions.iter().collect::<Vec<_>>());
        assert_eq!(shapes.len(), 5);
        let speed = &shapes[2];
        assert!((speed[1] - speed[0] - (speed[2] - speed[1])).abs() < 1e-14);
        assert_eq!(shapes[4], vec![0.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn coordinate_that_does_not_vary_gives_no_column() {
        let conditions = [drum(4.0, 0.2, "a"), drum(4.0, 0.2, "a")];
        assert_eq!(shapes(&conditions.iter().collect::<Vec<_>>()).len(), 1);
    }
}
