//! Turning and shifting a lattice as one until its centres lie deep enough.

use crate::distance_grid::DistanceGrid;
use crate::placement::Placement;
use crate::relaxation::DEPTH;
use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};

/// Centres that miss the depth by no more than this are taken along at first, radii.
const NEARLY: f64 = 0.2;

/// Steps after which the centre that misses the depth most is left out.
const STEPS: usize = 3;

/// A miss that counts as none, radii: the grid itself is right to 3e-3.
const FREE: f64 = 1e-6;

/// Aim a little deeper, so that rounding leaves no centre out, radii.
const DEEPER: f64 = 1e-5;

/// Turns and shifts a placement so that many of its centres lie one radius below the surface.
///
/// # Formula
///
/// E(t, ω) = Σ max(0, φ(xᵢ) + 1)² over the centres taken along, φ the signed distance in radii, is
/// lowered by Gauss-Newton steps in the shift t and the turn ω; as long as E does not vanish, the
/// centre of the largest miss is left out.
pub(crate) fn settled(start: &Placement, grid: &DistanceGrid, reach: f64) -> Placement {
    let mut placement = *start;
    let mut origin = placement.origin(grid);
    let points = placement.points_below(grid, reach, NEARLY - DEPTH);
    let mut arms: Vec<Vector3<f64>> = points.iter().map(|point| point - origin).collect();
    let mut steps = 0;
    while !arms.is_empty() {
        let misses = Misses::new(grid, &origin, &arms);
        if misses.largest < FREE {
            break;
        }
        if steps == STEPS {
            arms.swap_remove(misses.worst);
            steps = 0;
            continue;
        }
        steps += 1;
        let Some((shift, turn)) = misses.step() else {
            break;
        };
        placement = placement.moved(&turn, &shift);
        origin += shift;
        for arm in &mut arms {
            *arm = turn * *arm;
        }
    }
    placement
}

/// How far centres are from being deep enough.
struct Misses {
    /// Largest miss, radii.
    largest: f64,
    /// Index of the centre of the largest miss.
    worst: usize,
    /// Jᵀ J and Jᵀ m over the centres that miss, J the slopes of the misses m.
    normal: Matrix6<f64>,
    slope: Vector6<f64>,
}

impl Misses {
    fn new(grid: &DistanceGrid, origin: &Vector3<f64>, arms: &[Vector3<f64>]) -> Self {
        let mut found = Self {
            largest: 0.0,
            worst: 0,
            normal: Matrix6::zeros(),
            slope: Vector6::zeros(),
        };
        for (index, arm) in arms.iter().enumerate() {
            let distance = grid.at(&(origin + arm));
            let miss = distance.value + DEPTH + DEEPER;
            if miss <= 0.0 {
                continue;
            }
            if miss > found.largest {
                (found.largest, found.worst) = (miss, index);
            }
            let push = distance.gradient;
            let twist = arm.cross(&push);
            let row = Vector6::new(push.x, push.y, push.z, twist.x, twist.y, twist.z);
            found.normal += row * row.transpose();
            found.slope += row * miss;
        }
        found
    }

    /// Shift and turn that lower the misses, a little damped.
    fn step(&self) -> Option<(Vector3<f64>, UnitQuaternion<f64>)> {
        let damping = 1e-3 * self.normal.trace();
        let damped = self.normal + Matrix6::identity() * damping;
        let step = -damped.cholesky()?.solve(&self.slope);
        let shift = Vector3::new(step[0], step[1], step[2]);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(step[3], step[4], step[5]));
        Some((shift, turn))
    }
}
