//! Triangles of a wall as rectangles and surfaces of revolution, for a code without meshes.

use nalgebra::Vector3;

/// Fewest triangles of a surface of revolution: the walls here have 48 sides.
const LEAST_SIDES: usize = 48;
/// Largest deviation over the size of a wall.
const EXACT: f64 = 1e-9;

/// Corners of a triangle, m.
type Corners = [Vector3<f64>; 3];

/// A part of a wall.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Part {
    /// A rectangle: a corner and two edges, m.
    Rectangle {
        corner: Vector3<f64>,
        edges: [Vector3<f64>; 2],
    },
    /// The surface between two circles about an axis (0, 1, 2 for x, y, z) through a point, m: a tube, a cone, a ring or a disc. Each circle is
    /// a radius and a place along the axis; the radius is that of a circle with the cross-section of the sides.
    Revolved {
        axis: usize,
        centre: Vector3<f64>,
        circles: [[f64; 2]; 2],
    },
}

/// The parts of a surface; `None` if some triangles are of neither kind.
pub(crate) fn parts(triangles: &[Corners]) -> Option<Vec<Part>> {
    let found = [1, 0, 2]
        .into_iter()
        .find_map(|axis| revolved(triangles, axis));
    found.or_else(|| rectangles(triangles))
}

/// Consecutive pairs of triangles as rectangles.
fn rectangles(triangles: &[Corners]) -> Option<Vec<Part>> {
    if !triangles.len().is_multiple_of(2) {
        return None;
    }
    triangles.chunks(2).map(rectangle).collect()
}

/// Two triangles `[a, b, c]` and `[a, c, d]` as a rectangle.
fn rectangle(pair: &[Corners]) -> Option<Part> {
    let [[a, b, c], [a2, c2, d]] = pair else {
        return None;
    };
    let (first, second) = (b - a, d - a);
    let size = (c - a).norm();
    let is_one = a == a2
        && c == c2
        && (a + first + second - c).norm() <= EXACT * size
        && first.dot(&second).abs() <= EXACT * size * size
        && first.norm() > 0.0
        && second.norm() > 0.0;
    is_one.then_some(Part::Rectangle {
        corner: *a,
        edges: [first, second],
    })
}

/// All triangles as surfaces of revolution about an axis through the middle of their box.
fn revolved(triangles: &[Corners], axis: usize) -> Option<Vec<Part>> {
    let corners = || triangles.iter().flatten();
    let low = corners().copied().reduce(|a, b| a.inf(&b))?;
    let high = corners().copied().reduce(|a, b| a.sup(&b))?;
    let mut centre = 0.5 * (low + high);
    centre[axis] = 0.0;
    let size = (high - low).max();
    let meridian = |p: &Vector3<f64>| {
        let mut aside = p - centre;
        aside[axis] = 0.0;
        [aside.norm(), p[axis]]
    };
    let mut lines: Vec<(usize, [[f64; 2]; 2])> = Vec::new();
    for triangle in triangles {
        let places = triangle.map(|p| meridian(&p));
        if let Some((count, line)) = lines.last_mut()
            && extend(line, &places, size)
        {
            *count += 1;
        } else {
            lines.push((1, spread(&places, size)?));
        }
    }
    let whole = lines.iter().all(|(count, _)| *count >= LEAST_SIDES);
    whole.then(|| {
        let circles = lines.into_iter().map(|(_, line)| line);
        circles
            .map(|line| Part::Revolved {
                axis,
                centre,
                circles: line.map(|[radius, place]| [radius * of_equal_area(), place]),
            })
            .collect()
    })
}

/// Radius of a circle with the cross-section of a polygon of 48 sides over the radius of its corners.
fn of_equal_area() -> f64 {
    let angle = std::f64::consts::TAU / LEAST_SIDES as f64;
    (angle.sin() / angle).sqrt()
}

/// The two places farthest from each other; `None` if all are one.
fn spread(places: &[[f64; 2]; 3], size: f64) -> Option<[[f64; 2]; 2]> {
    let pairs = [(0, 1), (1, 2), (0, 2)].map(|(i, j)| [places[i], places[j]]);
    let farthest = pairs
        .into_iter()
        .max_by(|a, b| length(a).total_cmp(&length(b)))?;
    (length(&farthest) > EXACT * size).then_some(farthest)
}

fn length([a, b]: &[[f64; 2]; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Extends a line by places that are on it; whether all are.
fn extend(line: &mut [[f64; 2]; 2], places: &[[f64; 2]; 3], size: f64) -> bool {
    let [a, b] = *line;
    let along = [b[0] - a[0], b[1] - a[1]];
    let whole = length(line);
    let is_on = |p: &[f64; 2]| {
        let aside = along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0]);
        aside.abs() <= EXACT * size * whole
    };
    if !places.iter().all(is_on) {
        return false;
    }
    for place in places {
        let share = ((place[0] - line[0][0]) * along[0] + (place[1] - line[0][1]) * along[1])
            / (whole * whole);
        if share < 0.0 {
            line[0] = *place;
        } else if share * whole > length(line) {
            line[1] = *place;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::{Part, parts};
    use nalgebra::Vector3;
    use std::f64::consts::TAU;

    /// Triangles of 48 sides between circles about the y axis.
    fn sides(lines: &[[[f64; 2]; 2]]) -> Vec<[Vector3<f64>; 3]> {
        let mut all = Vec::new();
        for [[r0, y0], [r1, y1]] in lines {
            let at = |k: i32, r: f64, y: f64| {
                let angle = TAU * f64::from(k) / 48.0;
                Vector3::new(r * angle.cos(), y, r * angle.sin())
            };
            for k in 0..48 {
                let [a, b] = [at(k, *r0, *y0), at(k + 1, *r0, *y0)];
                let [c, d] = [at(k + 1, *r1, *y1), at(k, *r1, *y1)];
                all.extend(
                    [[a, b, c], [a, c, d]]
                        .into_iter()
                        .filter(|[p, q, r]| p != q && q != r),
                );
            }
        }
        all
    }

    /// A cone and the tube above it are two parts with the circles that they were made of, to rounding; their radii shrink to that of the
    /// circle with the area of 48 sides, 0.99857.
    #[test]
    fn a_cone_and_a_tube_are_found() {
        let lines = [[[0.01, 0.0], [0.03, 0.02]], [[0.03, 0.02], [0.03, 0.07]]];
        let found = parts(&sides(&lines)).unwrap();
        let shrink = (TAU / 48.0_f64).sin().mul_add(48.0 / TAU, 0.0).sqrt();
        assert!((shrink - 0.99857).abs() < 1e-5);
        for (part, line) in found.iter().zip(lines) {
            let Part::Revolved {
                axis: 1, circles, ..
            } = part
            else {
                panic!("{part:?}");
            };
            for (circle, [radius, place]) in circles.iter().zip(line) {
                assert!((circle[0] - shrink * radius).abs() < 1e-12, "{part:?}");
                assert!((circle[1] - place).abs() < 1e-12, "{part:?}");
            }
        }
        assert_eq!(found.len(), 2);
    }

    /// A disc begins at its axis, where one of two triangles is missing.
    #[test]
    fn a_disc_is_found() {
        let found = parts(&sides(&[[[0.0, 0.01], [0.02, 0.01]]])).unwrap();
        assert!(
            matches!(&found[..], [Part::Revolved { axis: 1, .. }]),
            "{found:?}"
        );
    }

    /// Four sides of a square box have one distance from its axis and are rectangles all the same; a single triangle is neither.
    #[test]
    fn a_box_is_four_rectangles() {
        let at = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let ring = [
            (1.0, 1.0),
            (-1.0, 1.0),
            (-1.0, -1.0),
            (1.0, -1.0),
            (1.0, 1.0),
        ];
        let mut triangles = Vec::new();
        for pair in ring.windows(2) {
            let [(x0, z0), (x1, z1)] = [pair[0], pair[1]];
            let [a, b, c, d] = [
                at(x0, 0.0, z0),
                at(x1, 0.0, z1),
                at(x1, 2.0, z1),
                at(x0, 2.0, z0),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        let found = parts(&triangles).unwrap();
        assert_eq!(found.len(), 4);
        assert!(
            found
                .iter()
                .all(|part| matches!(part, Part::Rectangle { .. }))
        );
        assert_eq!(parts(&triangles[..1]), None);
    }
}
