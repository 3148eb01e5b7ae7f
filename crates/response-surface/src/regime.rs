//! Which regime a point belongs to: no smooth surface may cross from one into another.

use experiment_design::Factor;
use nalgebra::{DMatrix, DVector};
use probability::random_stream::Stream;
use serde::Serialize;

use crate::{Error, Model, NamedValues};

/// Precision of the prior of the slopes: a slope of about 5 per half-range is as far as it reaches.
/// It keeps the boundary finite where the regimes are separated perfectly.
const PRIOR: f64 = 0.04;

/// A boundary between runs of one regime and all others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Regime {
    /// Name of the regime.
    pub name: String,
    /// Number of runs in it.
    pub inside: usize,
    /// Number of runs outside.
    pub outside: usize,
    /// Coefficients of the log odds, coded units.
    pub log_odds: NamedValues<f64>,
    /// Share of runs that the boundary, fitted without them, puts on the right side.
    pub leave_one_out_accuracy: f64,
    /// Share of the box in which the regime is the likelier one (10 000 random points).
    pub box_fraction: f64,
    /// The model of the log odds.
    model: Model,
}

/// Fits the log odds of a regime as a linear function of the coded factors.
///
/// # Formula
/// `ln(p / (1 - p)) = b0 + sum b_j x_j`, greatest likelihood times a normal prior of the slopes of
/// standard deviation 5, by Newton's iteration `[RasmussenWilliams2006, section 3.4]`.
///
/// # Errors
/// [`Error::Length`] for lists of different length or a regime with fewer than 2 runs inside or
/// outside.
pub fn regime(
    factors: &[Factor],
    coded: &[Vec<f64>],
    labels: &[String],
    name: &str,
    seed: u64,
) -> Result<Regime, Error> {
    let model = Model::linear(factors)?;
    let inside: Vec<bool> = labels.iter().map(|label| label == name).collect();
    let count = inside.iter().filter(|x| **x).count();
    let smaller = count.min(inside.len() - count);
    if coded.len() != labels.len() || smaller < 2 {
        return Err(Error::Length {
            what: "runs inside and outside the regime, at least two of each",
            expected: 2,
            given: smaller,
        });
    }
    let rows: Vec<Vec<f64>> = coded
        .iter()
        .map(|x| model.row(&x[..factors.len()]))
        .collect();
    let all: Vec<usize> = (0..rows.len()).collect();
    let coefficients = newton(&rows, &inside, &all);
    let odds = |row: &[f64], b: &[f64]| -> f64 { row.iter().zip(b).map(|(x, c)| x * c).sum() };
    let right = |i: &usize| {
        let others: Vec<usize> = all.iter().copied().filter(|j| j != i).collect();
        (odds(&rows[*i], &newton(&rows, &inside, &others)) > 0.0) == inside[*i]
    };
    let accuracy = all.iter().filter(|i| right(i)).count() as f64 / rows.len() as f64;
    let mut stream = Stream::new(seed, "share of a regime");
    let mut hits = 0.0;
    for _ in 0..10_000 {
        let x: Vec<f64> = factors.iter().map(|_| stream.between(-1.0, 1.0)).collect();
        hits += f64::from(u8::from(odds(&model.row(&x), &coefficients) > 0.0));
    }
    Ok(Regime {
        name: name.to_owned(),
        inside: count,
        outside: inside.len() - count,
        log_odds: model.names().into_iter().zip(coefficients).collect(),
        leave_one_out_accuracy: accuracy,
        box_fraction: hits / 10_000.0,
        model,
    })
}

impl Regime {
    /// Probability of the regime at a coded point.
    pub fn probability(&self, coded: &[f64]) -> f64 {
        let row = self.model.row(coded);
        let odds: f64 = row
            .iter()
            .zip(self.log_odds.values())
            .map(|(x, c)| x * c)
            .sum();
        1.0 / (1.0 + (-odds).exp())
    }
}

/// The most probable coefficients given some of the runs.
fn newton(rows: &[Vec<f64>], inside: &[bool], chosen: &[usize]) -> Vec<f64> {
    let p = rows[0].len();
    let mut b = DVector::zeros(p);
    // The intercept has no prior to speak of.
    let prior = DVector::from_fn(p, |j, _| if j == 0 { 1e-6 } else { PRIOR });
    for _ in 0..50 {
        let mut gradient = -prior.component_mul(&b);
        let mut curvature = DMatrix::from_diagonal(&prior);
        for &i in chosen {
            let row = DVector::from_column_slice(&rows[i]);
            let chance = 1.0 / (1.0 + (-row.dot(&b)).exp());
            gradient += &row * (f64::from(u8::from(inside[i])) - chance);
            curvature += &row * row.transpose() * (chance * (1.0 - chance));
        }
        let Some(step) = curvature.cholesky().map(|c| c.solve(&gradient)) else {
            break;
        };
        // Long steps overshoot where the regimes are separated.
        let length = step.amax();
        b += &step * (2.0 / length.max(2.0));
        if length < 1e-10 {
            break;
        }
    }
    b.as_slice().to_vec()
}

#[cfg(test)]
mod tests {
    use super::regime;
    use experiment_design::{Factor, latin_hypercube};

    /// Rolling where A + B > 0: half of the box. The boundary must be found to a few per cent, and
    /// points far on each side must be distinguished.
    #[test]
    fn a_straight_boundary_is_found() {
        let factors = ["A", "B"].map(|s| Factor::coded_only(s).unwrap());
        let coded = latin_hypercube(&factors, 60, 2).unwrap().coded_rows();
        let label = |x: &Vec<f64>| {
            if x[0] + x[1] > 0.0 {
                "rolling"
            } else {
                "sliding"
            }
        };
        let labels: Vec<String> = coded.iter().map(|x| label(x).to_owned()).collect();
        let found = regime(&factors, &coded, &labels, "rolling", 1).unwrap();
        assert!(found.leave_one_out_accuracy > 0.9, "{found:?}");
        assert!((found.box_fraction - 0.5).abs() < 0.08, "{found:?}");
        assert!(found.probability(&[0.8, 0.8]) > 0.99 && found.probability(&[-0.8, -0.8]) < 0.01);
        assert!(regime(&factors, &coded, &labels, "flying", 1).is_err());
    }
}
