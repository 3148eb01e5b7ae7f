//! The smallest box round a body, in any direction.

use nalgebra::{Matrix3, UnitQuaternion, Vector2, Vector3};

/// Directions from which the search starts, besides the ones given.
const STARTS: usize = 24;

/// Vertices of which the starts are made; the best is finished on all.
const LOOKED_AT: usize = 20_000;

/// Turns of one search, at most; most end within 10.
const TURNS: usize = 100;

/// A box in any direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TurnedBox {
    /// Its axes as rows.
    axes: Matrix3<f64>,
    /// Edge lengths along them, m.
    pub(crate) size: Vector3<f64>,
}

impl TurnedBox {
    fn of(points: &[Vector3<f64>], axes: Matrix3<f64>) -> Self {
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for point in points {
            let place = axes * point;
            low = low.inf(&place);
            high = high.sup(&place);
        }
        let size = high - low;
        Self { axes, size }
    }

    fn volume(&self) -> f64 {
        self.size.product()
    }
}

/// Box of the least volume that is found round points; `axes` are tried first.
///
/// # Method
///
/// Seen along one axis of a box, the other two are turned to the rectangle of the least area, exactly; so
/// on along each axis until nothing is gained `[Barequet2001, section 5]`. Of 25 starts the best is taken.
pub(crate) fn smallest_box(points: &[Vector3<f64>], axes: &[Vector3<f64>; 3]) -> TurnedBox {
    let first = Matrix3::from_rows(&axes.map(|axis| axis.transpose()));
    let some: Vec<Vector3<f64>> = points
        .iter()
        .step_by(points.len().div_ceil(LOOKED_AT).max(1))
        .copied()
        .collect();
    // Turns spread over all rotations by an additive sequence of low discrepancy: steps 1/p, 1/p² and
    // 1/p³ with p = 1.22074, the real root of p⁴ = p + 1.
    let turns = (0..STARTS).map(|k| {
        const STEPS: [f64; 3] = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_902];
        let [a, b, c] = STEPS.map(|step| std::f64::consts::TAU * (step * k as f64).fract());
        UnitQuaternion::from_euler_angles(a, b, c).to_rotation_matrix() * first
    });
    let best = std::iter::once(first)
        .chain(turns)
        .map(|axes| turned_down(&some, TurnedBox::of(&some, axes)))
        .min_by(|a, b| a.volume().total_cmp(&b.volume()));
    let axes = best.map_or(first, |found| found.axes);
    turned_down(points, TurnedBox::of(points, axes))
}

/// Turns a box about one axis after the other as long as it gets smaller.
fn turned_down(points: &[Vector3<f64>], mut best: TurnedBox) -> TurnedBox {
    let mut idle = 0;
    for _ in 0..TURNS {
        let [first, second, third] = [0, 1, 2].map(|k| best.axes.row(k).transpose());
        let seen = |point: &Vector3<f64>| Vector2::new(second.dot(point), third.dot(point));
        let flat: Vec<Vector2<f64>> = points.iter().map(seen).collect();
        let along = least_rectangle(&flat);
        let second = (second * along.x + third * along.y).normalize();
        let third = first.cross(&second);
        // The axis that was looked along comes last, so that the next turn is about another.
        let rows = [second, third, first].map(|row| row.transpose());
        let found = TurnedBox::of(points, Matrix3::from_rows(&rows));
        idle = if found.volume() < best.volume() * (1.0 - 1e-12) {
            0
        } else {
            idle + 1
        };
        best = found;
        if idle == 3 {
            break;
        }
    }
    best
}

/// Direction of a side of the rectangle of the least area round points of a plane: one side lies on an
/// edge of their convex hull.
fn least_rectangle(points: &[Vector2<f64>]) -> Vector2<f64> {
    let hull = convex_hull(points);
    let extent = |along: &Vector2<f64>| {
        let ends = hull.iter().map(|point| point.dot(along));
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), end| {
            (low.min(end), high.max(end))
        });
        high - low
    };
    let sides =
        (0..hull.len()).filter_map(|k| (hull[(k + 1) % hull.len()] - hull[k]).try_normalize(0.0));
    let area = |along: &Vector2<f64>| extent(along) * extent(&Vector2::new(-along.y, along.x));
    let measured = sides.map(|along| (area(&along), along));
    let least = measured.min_by(|a, b| a.0.total_cmp(&b.0));
    least.map_or(Vector2::x(), |(_, along)| along)
}

/// Corners of the convex hull of points of a plane, counter-clockwise (monotone chain).
fn convex_hull(points: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp(&(point - a)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut sorted.iter());
    let upper = chain(&mut sorted.iter().rev());
    [lower, upper].concat()
}
