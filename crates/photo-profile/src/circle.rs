//! Circles through points.

use nalgebra::{Matrix3, Vector3};

/// A circle in the picture; y down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Circle {
    /// Horizontal coordinate of the centre, px.
    pub(crate) x: f64,
    /// Vertical coordinate of the centre, px.
    pub(crate) y: f64,
    /// Radius, px.
    pub(crate) r: f64,
}

/// The circle through three points; `None` where they are on a line.
pub(crate) fn through(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<Circle> {
    let (bx, by) = (b.0 - a.0, b.1 - a.1);
    let (cx, cy) = (c.0 - a.0, c.1 - a.1);
    let twice = 2.0 * (bx * cy - by * cx);
    if twice.abs() < 1e-9 {
        return None;
    }
    let (bb, cc) = (bx * bx + by * by, cx * cx + cy * cy);
    let (x, y) = ((cy * bb - by * cc) / twice, (bx * cc - cx * bb) / twice);
    Some(Circle {
        x: a.0 + x,
        y: a.1 + y,
        r: x.hypot(y),
    })
}

/// Least-squares circle by normal distances, from a start near it.
///
/// # Formula
/// Gauss and Newton steps on `sum (|p - c| - r)^2`; the rows of the normal equations are
/// `(cos phi, sin phi, 1)`. Returns `None` where the points lie on too short an arc to fix it.
pub(crate) fn least_squares(points: &[(f64, f64)], start: Circle) -> Option<Circle> {
    let mut circle = start;
    for _ in 0..10 {
        let mut matrix = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for &(x, y) in points {
            let (dx, dy) = (x - circle.x, y - circle.y);
            let distance = dx.hypot(dy).max(f64::MIN_POSITIVE);
            let row = Vector3::new(dx / distance, dy / distance, 1.0);
            matrix += row * row.transpose();
            right += (distance - circle.r) * row;
        }
        let step = matrix.cholesky()?.solve(&right);
        circle = Circle {
            x: circle.x + step[0],
            y: circle.y + step[1],
            r: circle.r + step[2],
        };
        if !(circle.x.is_finite() && circle.y.is_finite() && circle.r > 0.0) {
            return None;
        }
        if step.norm() < 1e-9 * circle.r {
            break;
        }
    }
    Some(circle)
}
