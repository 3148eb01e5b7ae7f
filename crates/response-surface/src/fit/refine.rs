//! Refinement of a least-squares solution with numbers of twice the usual length.

use crate::fit::wide::Wide;

/// Steps of refinement. Each gains the digits that X'WX leaves in usual arithmetic, eight or more
/// for models in coded units; three exhaust what the data hold.
const STEPS: usize = 3;

/// A solution with its residuals.
#[derive(Debug)]
pub(crate) struct Refined {
    /// Coefficients, (p).
    pub(crate) coefficients: Vec<Wide>,
    /// Observed minus fitted, (n).
    pub(crate) residuals: Vec<f64>,
}

/// Improves the coefficients of a weighted least-squares fit.
///
/// # Formula
/// `beta := beta + C X'W (y - X beta)`, C the inverse of X'WX; residuals and products in long
/// arithmetic, so the result is that of the given numbers, not of their rounded products.
///
/// # Source
/// `[Golub2013, section 5.3.8]`.
pub(crate) fn refine(
    row: &dyn Fn(usize) -> Vec<Wide>,
    response: &[f64],
    weights: &[f64],
    inverse: &[Vec<f64>],
    start: &[f64],
) -> Refined {
    let mut coefficients: Vec<Wide> = start.iter().map(|&c| Wide::from(c)).collect();
    let mut residuals = vec![Wide::ZERO; response.len()];
    for step in 0..=STEPS {
        let mut gradient = vec![Wide::ZERO; start.len()];
        for (i, residual) in residuals.iter_mut().enumerate() {
            let row = row(i);
            let mut left = Wide::from(response[i]);
            for (x, c) in row.iter().zip(&coefficients) {
                left = left - *x * *c;
            }
            *residual = left;
            let weighted = left * Wide::from(weights[i]);
            for (sum, x) in gradient.iter_mut().zip(row) {
                *sum += x * weighted;
            }
        }
        if step == STEPS {
            break;
        }
        for (c, line) in coefficients.iter_mut().zip(inverse) {
            let change: f64 = line
                .iter()
                .zip(&gradient)
                .map(|(a, g)| a * g.rounded())
                .sum();
            *c += Wide::from(change);
        }
    }
    Refined {
        coefficients,
        residuals: residuals.into_iter().map(Wide::rounded).collect(),
    }
}
