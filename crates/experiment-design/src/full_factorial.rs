//! Full two-level factorial designs.

use crate::design::append_centres;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Greatest number of factors of a full factorial (1024 runs).
const MOST_FACTORS: usize = 10;

/// All 2^k combinations of the two levels in standard (Yates) order, the first factor changing
/// fastest, followed by `n_centre` centre runs.
///
/// # Source
/// `[Yates1937]`.
///
/// # Errors
/// [`Error::FactorCount`] beyond 10 factors; [`Error::CountOutOfRange`] beyond 10 000 centre
/// runs; those of [`check_factors`].
pub fn full_factorial(factors: &[Factor], n_centre: usize) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    if k > MOST_FACTORS {
        return Err(Error::FactorCount {
            design: "full factorial",
            given: k,
            least: 1,
            most: MOST_FACTORS,
            way_out: "take a fraction (up to 11 factors), a Plackett-Burman design or a Latin \
                      hypercube",
        });
    }
    let mut rows = two_level_rows(k);
    append_centres(&mut rows, k, n_centre)?;
    Design::new(DesignKind::FullFactorial, factors, Vec::new(), rows)
}

/// Most rows of a factorial of given levels.
const MOST_ROWS: usize = 100_000;

/// All combinations of given coded levels, the first factor changing fastest, followed by `n_centre` centre runs.
///
/// # Errors
/// [`Error::CountOutOfRange`] beyond 100 000 combinations; those of [`Design::new`], for levels of another number of factors.
pub fn mixed_factorial(
    factors: &[Factor],
    levels: &[Vec<f64>],
    n_centre: usize,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let count = levels
        .iter()
        .try_fold(1_usize, |n, levels| n.checked_mul(levels.len()));
    let Some(count) = count.filter(|n| (1..=MOST_ROWS).contains(n)) else {
        return Err(Error::CountOutOfRange {
            what: "combinations of the levels",
            given: count.unwrap_or(usize::MAX),
            least: 1,
            most: MOST_ROWS,
        });
    };
    let row = |index: usize| {
        let mut rest = index;
        let each = levels.iter().map(|levels| {
            let level = levels[rest % levels.len()];
            rest /= levels.len();
            level
        });
        each.collect()
    };
    let mut rows: Vec<Vec<f64>> = (0..count).map(row).collect();
    append_centres(&mut rows, factors.len(), n_centre)?;
    Design::new(DesignKind::FullFactorial, factors, Vec::new(), rows)
}

/// The 2^k rows in standard order; k is at most [`MOST_FACTORS`].
pub(crate) fn two_level_rows(k: usize) -> Vec<Vec<f64>> {
    let level = |bits: usize, j: usize| if bits >> j & 1 == 1 { 1.0 } else { -1.0 };
    (0..1 << k)
        .map(|bits| (0..k).map(|j| level(bits, j)).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{full_factorial, mixed_factorial};
    use crate::Factor;

    #[test]
    fn standard_order_changes_the_first_factor_fastest() {
        let factors = [
            Factor::coded_only("A").unwrap(),
            Factor::coded_only("B").unwrap(),
        ];
        let rows = full_factorial(&factors, 1).unwrap().coded_rows();
        let expected = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [-1.0, 1.0],
            [1.0, 1.0],
            [0.0, 0.0],
        ];
        assert_eq!(rows, expected.map(|row| row.to_vec()));
    }

    /// Three by two levels make six runs, each once; two levels everywhere are the full factorial.
    #[test]
    fn levels_are_combined_in_standard_order() {
        let factors = ["A", "B"].map(|s| Factor::coded_only(s).unwrap());
        let ends = vec![-1.0, 1.0];
        let design = mixed_factorial(&factors, &[vec![-1.0, 0.2, 1.0], ends.clone()], 0).unwrap();
        let expected = [
            [-1.0, -1.0],
            [0.2, -1.0],
            [1.0, -1.0],
            [-1.0, 1.0],
            [0.2, 1.0],
            [1.0, 1.0],
        ];
        assert_eq!(design.coded_rows(), expected.map(|row| row.to_vec()));
        let two = mixed_factorial(&factors, &[ends.clone(), ends], 1).unwrap();
        assert_eq!(two, full_factorial(&factors, 1).unwrap());
        let many = vec![(0..400).map(f64::from).collect::<Vec<_>>(); 2];
        assert!(mixed_factorial(&factors, &many, 0).is_err());
    }
}
