//! Canonical analysis: the stationary point of a quadratic and its kind.

use experiment_design::Factor;
use nalgebra::SymmetricEigen;
use serde::{Deserialize, Serialize};

use crate::DataRegion;
use crate::surface::quadratic::Quadratic;

/// An eigenvalue smaller than this share of the greatest makes a ridge: along it the stationary
/// point is not determined by the data's digits.
const FLAT: f64 = 1e-10;

/// The stationary point and the curvature around it.
///
/// # Formula
/// `x_s = -B^-1 b / 2`, value `b0 + x_s'b / 2`, with b the linear coefficients and B the symmetric
/// matrix of quadratic ones; eigenvalues and eigenvectors are those of B.
///
/// # Source
/// `[Myers2016, chapter 6]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Canonical {
    /// Stationary point, coded; none on a ridge.
    pub stationary_coded: Option<Vec<f64>>,
    /// Stationary point, units of the factors; none on a ridge.
    pub stationary_natural: Option<Vec<f64>>,
    /// Value there, unit of the response; none on a ridge.
    pub value: Option<f64>,
    /// Eigenvalues of B, ascending, unit of the response.
    pub eigenvalues_ascending: Vec<f64>,
    /// Rows are coordinates, columns the eigenvectors in the order of the eigenvalues; the
    /// largest entry of each is positive.
    pub eigenvectors_columns: Vec<Vec<f64>>,
    /// Kind of the stationary point.
    pub kind: StationaryKind,
    /// Whether it lies within the ranges of the factors; none on a ridge.
    pub inside_box: Option<bool>,
    /// Whether it lies within what the data span; none on a ridge.
    #[serde(default)]
    pub inside_data: Option<bool>,
    /// Largest |coded coordinate|: 1 is the edge of the box; none on a ridge.
    pub reach_coded: Option<f64>,
}

/// Kind of a stationary point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StationaryKind {
    /// The surface falls in all directions.
    Maximum,
    /// The surface rises in all directions.
    Minimum,
    /// It rises in some and falls in others.
    Saddle,
    /// It is flat in at least one direction.
    Ridge,
}

/// Canonical form of a quadratic; none without curvature.
pub(crate) fn canonical(
    quadratic: &Quadratic,
    factors: &[Factor],
    region: Option<&DataRegion>,
) -> Option<Canonical> {
    let half = &quadratic.hessian * 0.5;
    let size = half.amax();
    if size == 0.0 {
        return None;
    }
    let eigen = SymmetricEigen::new(half);
    let k = factors.len();
    let mut order: Vec<usize> = (0..k).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let values: Vec<f64> = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    let sign = |column: usize| {
        let vector = eigen.eigenvectors.column(column);
        vector[vector.icamax()].signum()
    };
    let entry = |row: usize, column: usize| eigen.eigenvectors[(row, column)] * sign(column);
    let vectors = (0..k)
        .map(|row| order.iter().map(|&column| entry(row, column)).collect())
        .collect();
    let kind = kind(&values);
    let stationary = match kind {
        StationaryKind::Ridge => None,
        _ => quadratic.hessian.clone().lu().solve(&-&quadratic.linear),
    };
    let coded = stationary.map(|x| x.as_slice().to_vec());
    let reach = coded
        .as_ref()
        .map(|x| x.iter().fold(0.0_f64, |reach, x| reach.max(x.abs())));
    let natural = |x: &Vec<f64>| factors.iter().zip(x).map(|(f, &x)| f.natural(x)).collect();
    let natural: Option<Vec<f64>> = coded.as_ref().map(natural);
    let inside = region.zip(natural.as_ref());
    Some(Canonical {
        inside_data: inside.map(|(region, point)| region.holds(point)),
        stationary_natural: natural,
        value: coded.as_ref().map(|x| quadratic.value(x)),
        stationary_coded: coded,
        eigenvalues_ascending: values,
        eigenvectors_columns: vectors,
        kind,
        inside_box: reach.map(|reach| reach <= 1.0),
        reach_coded: reach,
    })
}

/// The kind that ascending eigenvalues make.
fn kind(ascending: &[f64]) -> StationaryKind {
    let size = ascending.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
    let flat = ascending.iter().any(|v| v.abs() <= FLAT * size);
    match (flat, ascending.first(), ascending.last()) {
        (false, _, Some(last)) if *last < 0.0 => StationaryKind::Maximum,
        (false, Some(first), _) if *first > 0.0 => StationaryKind::Minimum,
        (false, _, _) => StationaryKind::Saddle,
        (true, _, _) => StationaryKind::Ridge,
    }
}
