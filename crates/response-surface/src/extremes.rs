//! Least and greatest value of a quadratic over the box.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::quadratic::{Face, Quadratic, faces, point_on_face};

/// The two extremes of the surface over the ranges of the factors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoxExtremes {
    /// Least value.
    pub min: Extreme,
    /// Greatest value.
    pub max: Extreme,
}

/// A point of the box and the value there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// Coded point.
    pub coded: Vec<f64>,
    /// Natural point, units of the factors.
    pub natural: Vec<f64>,
    /// Value of the surface, unit of the response.
    pub value: f64,
}

/// Least and greatest value of a quadratic over -1..+1 in every coordinate.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    /// Point of the least value.
    pub(crate) lowest: Vec<f64>,
    /// Least value.
    pub(crate) min: f64,
    /// Point of the greatest value.
    pub(crate) highest: Vec<f64>,
    /// Greatest value.
    pub(crate) max: f64,
}

/// Finds the extremes exactly: each lies at a stationary point of the function on some face, and
/// there are 3^k faces. A face without a single stationary point passes the extreme on to a face
/// of lower dimension.
pub(crate) fn span(quadratic: &Quadratic) -> Span {
    let k = quadratic.linear.len();
    let mut span = Span {
        lowest: Vec::new(),
        min: f64::INFINITY,
        highest: Vec::new(),
        max: f64::NEG_INFINITY,
    };
    for face in faces(k) {
        let Some(point) = stationary_on_face(quadratic, &face) else {
            continue;
        };
        let value = quadratic.value(&point);
        if value < span.min {
            (span.min, span.lowest) = (value, point.clone());
        }
        if value > span.max {
            (span.max, span.highest) = (value, point);
        }
    }
    span
}

/// The stationary point on a face, if there is one and it lies in the box.
fn stationary_on_face(quadratic: &Quadratic, face: &Face) -> Option<Vec<f64>> {
    let on_face = quadratic.on_face(face);
    if on_face.linear.is_empty() {
        return Some(point_on_face(face, &[]));
    }
    let free = on_face.hessian.lu().solve(&-on_face.linear)?;
    let inside = free.iter().all(|x| x.abs() <= 1.0);
    inside.then(|| point_on_face(face, free.as_slice()))
}

/// The extremes with their natural points.
pub(crate) fn box_extremes(quadratic: &Quadratic, factors: &[Factor]) -> BoxExtremes {
    let span = span(quadratic);
    let extreme = |coded: Vec<f64>, value| Extreme {
        natural: factors
            .iter()
            .zip(&coded)
            .map(|(f, &x)| f.natural(x))
            .collect(),
        coded,
        value,
    };
    BoxExtremes {
        min: extreme(span.lowest, span.min),
        max: extreme(span.highest, span.max),
    }
}
