//! Least and greatest value of a quadratic over the box.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::surface::quadratic::{Face, Quadratic, faces, point_on_face};

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
/// there are 3^m faces of the m coordinates in which the function is curved or which interact. In each of
/// the others it is a line, whose extremes lie at its ends. A face without a single stationary point
/// passes the extreme on to a face of lower dimension.
pub(crate) fn span(quadratic: &Quadratic) -> Span {
    let k = quadratic.linear.len();
    let mut span = Span {
        lowest: Vec::new(),
        min: f64::INFINITY,
        highest: Vec::new(),
        max: f64::NEG_INFINITY,
    };
    let curved: Vec<usize> = (0..k)
        .filter(|&j| quadratic.hessian.row(j).iter().any(|h| *h != 0.0))
        .collect();
    let corner = |up: f64| -> Face {
        let toward = |slope: &f64| Some(if up * slope > 0.0 { 1.0 } else { -1.0 });
        quadratic.linear.iter().map(toward).collect()
    };
    let (mut low, mut high) = (corner(-1.0), corner(1.0));
    for face in faces(curved.len()) {
        for (&j, place) in curved.iter().zip(&face) {
            (low[j], high[j]) = (*place, *place);
        }
        let Some(point) = stationary_on_face(quadratic, &low) else {
            continue;
        };
        let value = quadratic.value(&point);
        if value < span.min {
            (span.min, span.lowest) = (value, point.clone());
        }
        let opposite = high.iter().zip(&point).map(|(up, x)| up.unwrap_or(*x));
        let point: Vec<f64> = opposite.collect();
        let value = quadratic.value(&point);
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

#[cfg(test)]
mod tests {
    use super::span;
    use crate::surface::quadratic::Quadratic;
    use nalgebra::{DMatrix, DVector};

    /// `x0^2 - x0 x1 - x1 / 10` and 30 lines: the extremes of the curved part are -0.35 (at 1/2, 1) and 2.1 (at 1, -1),
    /// each line adds its slope at its ends. All 3^32 faces could not be visited.
    #[test]
    fn coordinates_without_curvature_cost_nothing() {
        let n = 32;
        let mut hessian = DMatrix::zeros(n, n);
        hessian[(0, 0)] = 2.0;
        (hessian[(0, 1)], hessian[(1, 0)]) = (-1.0, -1.0);
        let slope = |j: usize| match j {
            0 => 0.0,
            1 => -0.1,
            _ if j.is_multiple_of(2) => 0.5,
            _ => -0.5,
        };
        let quadratic = Quadratic {
            constant: 3.0,
            linear: DVector::from_fn(n, |j, _| slope(j)),
            hessian,
        };
        let span = span(&quadratic);
        assert!((span.min - (3.0 - 0.35 - 15.0)).abs() < 1e-12, "{span:?}");
        assert!((span.max - (3.0 + 2.1 + 15.0)).abs() < 1e-12, "{span:?}");
        assert_eq!(span.lowest[..4], [0.5, 1.0, -1.0, 1.0]);
        assert!((quadratic.value(&span.highest) - span.max).abs() < 1e-12);
    }
}
