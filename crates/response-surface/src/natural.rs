//! The fitted polynomial in natural units.

use std::collections::BTreeMap;

use experiment_design::Factor;

use crate::fit::TermRow;
use crate::{Model, NamedValues, Term};

/// Coefficients in natural units with their tests.
///
/// # Formula
/// Each coded power is multiplied out: `x^e = sum_m binomial(e, m) (u/h)^m (-c/h)^(e-m)`, c
/// the middle and h the half-range of the factor. Variances follow from the linear map of the
/// coefficients.
pub(crate) fn natural_terms(
    factors: &[Factor],
    model: &Model,
    coefficients: &[f64],
    covariance: &[Vec<f64>],
    mse: Option<f64>,
    df_resid: usize,
) -> NamedValues<TermRow> {
    let mut map: BTreeMap<Vec<u8>, Vec<f64>> = BTreeMap::new();
    for (j, term) in model.terms().iter().enumerate() {
        for (powers, amount) in multiply_out(factors, term) {
            map.entry(powers)
                .or_insert_with(|| vec![0.0; coefficients.len()])[j] += amount;
        }
    }
    let row = |parts: &[f64]| {
        let coef = parts.iter().zip(coefficients).map(|(a, c)| a * c).sum();
        let dot = |i: usize| -> f64 { covariance[i].iter().zip(parts).map(|(c, a)| c * a).sum() };
        let c: f64 = parts.iter().enumerate().map(|(i, a)| a * dot(i)).sum();
        crate::fit::tested(coef, c, mse, df_resid)
    };
    // Terms of the model first and in its order, then those that only the natural form has.
    let mut ordered = Vec::with_capacity(map.len());
    for term in model.terms() {
        if let Some(parts) = map.remove(term.powers()) {
            ordered.push((model.name(term), row(&parts)));
        }
    }
    for (powers, parts) in map {
        ordered.push((model.name(&Term::from_powers(powers)), row(&parts)));
    }
    ordered.into_iter().collect()
}

/// A product of coded powers as a sum of products of natural powers.
fn multiply_out(factors: &[Factor], term: &Term) -> Vec<(Vec<u8>, f64)> {
    let mut sum = vec![(vec![0_u8; factors.len()], 1.0)];
    for (j, factor) in factors.iter().enumerate() {
        let power = term.powers()[j];
        let (slope, offset) = (
            1.0 / factor.half_range(),
            -factor.mid() / factor.half_range(),
        );
        let mut next = Vec::with_capacity(sum.len() * usize::from(power + 1));
        for (powers, amount) in &sum {
            for m in 0..=power {
                let mut powers = powers.clone();
                powers[j] = m;
                let part = binomial(power, m)
                    * slope.powi(i32::from(m))
                    * offset.powi(i32::from(power - m));
                next.push((powers, amount * part));
            }
        }
        sum = next;
    }
    sum
}

/// Number of ways to choose m of n.
fn binomial(n: u8, m: u8) -> f64 {
    (0..m).fold(1.0, |product, i| {
        product * f64::from(n - i) / f64::from(i + 1)
    })
}
