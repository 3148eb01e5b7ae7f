//! Surfaces of revolution about the y axis and rectangles, as walls of triangles.

use super::NamedMesh;
use dem_solver::Motion;
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// Corners of a triangle, m.
pub(super) type Corners = [Vector3<f64>; 3];

/// Sides of a prism instead of a cylinder; it lies within 0.3 % of its radius.
const SIDES: usize = 48;

/// Radius within a prism instead of a cylinder of a radius, m.
pub(super) fn within_prism(radius: f64) -> f64 {
    radius * (PI / SIDES as f64).cos()
}

/// Radius of a prism with the cross-section of a circle of a radius, m.
pub(super) fn of_equal_area(radius: f64) -> f64 {
    let angle = TAU / SIDES as f64;
    radius * (angle / angle.sin()).sqrt()
}

/// Region about the y axis: lower and upper corner of a cylinder of a radius that begins at y = 0, m.
pub(super) fn room_of_cylinder(radius: f64, height: f64) -> [Vector3<f64>; 2] {
    [
        Vector3::new(-radius, 0.0, -radius),
        Vector3::new(radius, height, radius),
    ]
}

/// Whether a ball (centre and radius, m) is within a cylinder of an inner radius and a height about the y axis, m.
pub(super) fn is_in_cylinder(
    (centre, radius): (&Vector3<f64>, f64),
    inner: f64,
    height: f64,
) -> bool {
    centre.x.hypot(centre.z) + radius < inner && centre.y > radius && centre.y + radius < height
}

/// The surface between two circles about the y axis, each a radius and a height, m: a tube, a cone, a ring or a disc.
pub(super) fn between_circles([r0, y0]: [f64; 2], [r1, y1]: [f64; 2]) -> Vec<Corners> {
    // Rows twice as long as a side is wide: compact triangles keep the contact search short.
    let slant = (r1 - r0).hypot(y1 - y0);
    let n_rows = (slant * SIDES as f64 / (2.0 * TAU * r0.max(r1))).ceil();
    let rows: Vec<f64> = std::iter::successors(Some(0.0), |r| Some(r + 1.0))
        .take_while(|r| *r < n_rows)
        .collect();
    let at = |k: usize, row: f64| {
        let angle = TAU * (k % SIDES) as f64 / SIDES as f64;
        let radius = r0 + (r1 - r0) * row / n_rows;
        let height = y0 + (y1 - y0) * row / n_rows;
        Vector3::new(radius * angle.cos(), height, radius * angle.sin())
    };
    let side = |k: usize| {
        let panel = move |row: &f64| {
            let [low, high] = [*row, row + 1.0];
            let [a, b] = [at(k, low), at(k + 1, low)];
            let [c, d] = [at(k + 1, high), at(k, high)];
            [[a, b, c], [a, c, d]]
        };
        rows.iter().flat_map(panel).collect::<Vec<_>>()
    };
    // At a point on the axis one of the two triangles is a line.
    let has_area = |[a, b, c]: &Corners| (b - a).norm() > 0.0 && (c - b).norm() > 0.0;
    (0..SIDES).flat_map(side).filter(has_area).collect()
}

/// [`between_circles`] about the x (0), y (1) or z axis (2): each circle a radius and a place along the axis, m.
pub(super) fn between_circles_about(axis: usize, from: [f64; 2], to: [f64; 2]) -> Vec<Corners> {
    let turned = |corner: Vector3<f64>| {
        let mut turned = Vector3::zeros();
        for k in 0..3 {
            turned[(axis + 2 + k) % 3] = corner[k];
        }
        turned
    };
    let triangles = between_circles(from, to).into_iter();
    triangles.map(|corners| corners.map(turned)).collect()
}

/// A level rectangle at a height y over ranges of x and z, m.
pub(super) fn level([x0, x1]: [f64; 2], y: f64, [z0, z1]: [f64; 2]) -> Vec<Corners> {
    let at = |x, z| Vector3::new(x, y, z);
    quadrangle([at(x0, z0), at(x1, z0), at(x1, z1), at(x0, z1)])
}

/// An upright rectangle at a place x over ranges of y and z, m.
pub(super) fn upright(x: f64, [y0, y1]: [f64; 2], [z0, z1]: [f64; 2]) -> Vec<Corners> {
    let at = |y, z| Vector3::new(x, y, z);
    quadrangle([at(y0, z0), at(y1, z0), at(y1, z1), at(y0, z1)])
}

/// Two triangles between four corners of a plane.
pub(super) fn quadrangle([a, b, c, d]: [Vector3<f64>; 4]) -> Vec<Corners> {
    vec![[a, b, c], [a, c, d]]
}

/// A wall of triangles that is at rest until a phase moves it.
pub(super) fn at_rest(name: &str, material: &str, triangles: Vec<Corners>) -> NamedMesh {
    NamedMesh {
        name: name.into(),
        triangles,
        material: material.to_owned(),
        motion: Motion::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Corners, between_circles, of_equal_area};
    use std::f64::consts::PI;

    fn area(triangles: &[Corners]) -> f64 {
        let areas = triangles
            .iter()
            .map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm());
        areas.sum()
    }

    /// A disc of the radius of equal area has the area of the circle, to rounding; a cone of 48 sides lies within 0.5 % of
    /// `pi (r0 + r1) s`.
    #[test]
    fn surfaces_have_their_areas() {
        let disc = between_circles([0.0, 0.0], [of_equal_area(0.02), 0.0]);
        assert!((area(&disc) / (PI * 4e-4) - 1.0).abs() < 1e-12);
        let cone = between_circles([0.01, 0.0], [0.04, 0.04]);
        let expected = PI * 0.05 * 0.05;
        assert!((area(&cone) / expected - 1.0).abs() < 5e-3, "cone");
    }
}
