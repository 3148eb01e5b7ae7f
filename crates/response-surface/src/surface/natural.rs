//! The fitted polynomial in natural units.

use std::collections::BTreeMap;

use experiment_design::Factor;

use crate::fit::TermRow;
use crate::fit::wide::Wide;
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
    coefficients: &[Wide],
    covariance: &[Vec<f64>],
    mse: Option<f64>,
    df_resid: usize,
) -> NamedValues<TermRow> {
    let mut map: BTreeMap<Vec<u8>, Vec<Wide>> = BTreeMap::new();
    let lines: Vec<(Wide, Wide)> = factors.iter().map(to_coded).collect();
    for (j, term) in model.terms().iter().enumerate() {
        for (powers, amount) in multiply_out(&lines, term) {
            map.entry(powers)
                .or_insert_with(|| vec![Wide::ZERO; coefficients.len()])[j] += amount;
        }
    }
    // A coefficient that is a sum of zeros is not a term, such as the intercept of a model through the natural zero.
    map.retain(|_, parts| parts.iter().any(|part| *part != Wide::ZERO));
    let wide = |values: &[f64]| -> Vec<Wide> { values.iter().map(|&v| Wide::from(v)).collect() };
    let covariance: Vec<Vec<Wide>> = covariance.iter().map(|line| wide(line)).collect();
    let row = |parts: &[Wide]| {
        let used: Vec<usize> = (0..parts.len())
            .filter(|&i| parts[i] != Wide::ZERO)
            .collect();
        let sum = |f: &dyn Fn(usize) -> Wide| used.iter().fold(Wide::ZERO, |sum, &i| sum + f(i));
        let coef = sum(&|i| parts[i] * coefficients[i]).rounded();
        let c = sum(&|i| parts[i] * sum(&|j| parts[j] * covariance[i][j])).rounded();
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

/// Offset and slope of the coded value as a function of the natural one.
fn to_coded(factor: &Factor) -> (Wide, Wide) {
    let slope = Wide::ONE.divided_by(factor.half_range());
    (-(Wide::from(factor.mid()) * slope), slope)
}

/// A polynomial of x as one of x', x = offset + slope x' in every coordinate: its terms, its
/// coefficients, and their covariances.
pub(crate) fn rebased(
    model: &Model,
    lines: &[(f64, f64)],
    coefficients: &[f64],
    covariance: &[Vec<f64>],
) -> (Model, Vec<f64>, Vec<Vec<f64>>) {
    let wide = |&(a, b): &(f64, f64)| (Wide::from(a), Wide::from(b));
    let lines: Vec<(Wide, Wide)> = lines.iter().map(wide).collect();
    let p = coefficients.len();
    let mut map: BTreeMap<Vec<u8>, Vec<f64>> = BTreeMap::new();
    for (j, term) in model.terms().iter().enumerate() {
        for (powers, amount) in multiply_out(&lines, term) {
            map.entry(powers).or_insert_with(|| vec![0.0; p])[j] += amount.rounded();
        }
    }
    // A coefficient that is a sum of zeros is not a term, except the intercept.
    map.retain(|powers, parts| {
        powers.iter().all(|power| *power == 0) || parts.iter().any(|part| *part != 0.0)
    });
    let terms = map.keys().cloned().map(Term::from_powers).collect();
    let model = Model::from_terms(model.symbols().to_vec(), terms);
    let parts: Vec<Vec<f64>> = model
        .terms()
        .iter()
        .filter_map(|term| map.remove(term.powers()))
        .collect();
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
    let moved: Vec<Vec<f64>> = parts
        .iter()
        .map(|row| covariance.iter().map(|line| dot(line, row)).collect())
        .collect();
    let new_covariance = parts
        .iter()
        .map(|row| moved.iter().map(|column| dot(row, column)).collect())
        .collect();
    let new_coefficients = parts.iter().map(|row| dot(row, coefficients)).collect();
    (model, new_coefficients, new_covariance)
}

/// A product of powers of x as a sum of products of powers of x', x = offset + slope x'.
fn multiply_out(lines: &[(Wide, Wide)], term: &Term) -> Vec<(Vec<u8>, Wide)> {
    let mut sum = vec![(vec![0_u8; lines.len()], Wide::ONE)];
    for (j, &(offset, slope)) in lines.iter().enumerate() {
        let power = term.powers()[j];
        let mut next = Vec::with_capacity(sum.len() * usize::from(power + 1));
        for (powers, amount) in &sum {
            for m in 0..=power {
                let mut powers = powers.clone();
                powers[j] = m;
                let part =
                    Wide::from(binomial(power, m)) * slope.power(m) * offset.power(power - m);
                next.push((powers, *amount * part));
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
