//! Close-packed layers of equal spheres, placed into a body.

use crate::distance_grid::DistanceGrid;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Distance of rows in a layer, radii.
const ROW: f64 = 1.732_050_807_568_877_2;

/// Cubic close packing: every layer is shifted in the same sense (ABCABC).
const CUBIC: u64 = 0;

/// Hexagonal close packing: the layers are shifted to and fro (ABAB).
const HEXAGONAL: u64 = 0xAAAA_AAAA_AAAA_AAAA;

/// Where close-packed layers lie.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement {
    /// Turn of the layers.
    turn: UnitQuaternion<f64>,
    /// Shift from the middle of the body, radii.
    shift: Vector3<f64>,
    /// Bit k shows whether layer k + 1 lies over the one or the other kind of hollows of layer k
    /// (counted modulo 64). Every order of layers is equally dense.
    stacking: u64,
}

impl Placement {
    /// Cubic or hexagonal packing, turned and shifted at random.
    pub(crate) fn random(stream: &mut Stream) -> Self {
        let [w, x, y, z] = stream.rotation();
        Self {
            turn: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
            shift: Vector3::from_fn(|_, _| stream.between(-1.7, 1.7)),
            stacking: if stream.uniform() < 0.5 {
                HEXAGONAL
            } else {
                CUBIC
            },
        }
    }

    /// Turned and shifted a little toward a random placement.
    pub(crate) fn varied(&self, random: &Self, size: f64) -> Self {
        Self {
            turn: self.turn * random.turn.powf(0.2 * size),
            shift: self.shift + random.shift * size,
            stacking: self.stacking,
        }
    }

    /// Turned about its own origin, then shifted (radii).
    pub(crate) fn moved(&self, turn: &UnitQuaternion<f64>, shift: &Vector3<f64>) -> Self {
        Self {
            turn: turn * self.turn,
            shift: self.shift + shift,
            stacking: self.stacking,
        }
    }

    /// The place about which it is turned, radii.
    pub(crate) fn origin(&self, grid: &DistanceGrid) -> Vector3<f64> {
        let [low, high] = grid.corners();
        (low + high) * 0.5 + self.shift
    }

    /// With the layers from one of the middle ones upward shifted in the other sense.
    pub(crate) fn restacked(&self, stream: &mut Stream) -> Self {
        let layer = (stream.below(16) + 56) % 64;
        Self {
            stacking: self.stacking ^ (1 << layer),
            ..*self
        }
    }

    /// Sphere centres whose signed distance to the surface is at most `level`, radii.
    pub(crate) fn points_below(
        &self,
        grid: &DistanceGrid,
        reach: f64,
        level: f64,
    ) -> Vec<Vector3<f64>> {
        let [low, high] = grid.corners();
        let origin = self.origin(grid);
        let layer = (8.0_f64 / 3.0).sqrt();
        let (n_layers, n_rows) = (steps(reach, layer), steps(reach, ROW));
        let n_columns = steps(reach, 2.0);
        let along = self.turn * Vector3::new(2.0, 0.0, 0.0);
        let mut inside = Vec::new();
        for k in -n_layers..=n_layers {
            // Layers B and C lie over the hollows of layer A, one or two thirds of a row further.
            let kind = f64::from(self.kind(k));
            for j in -n_rows..=n_rows {
                let y = ROW * (f64::from(j) + kind / 3.0);
                let x = f64::from(j.rem_euclid(2)) + kind;
                let start = origin + self.turn * Vector3::new(x, y, layer * f64::from(k));
                let (first, last) = columns_within(&start, &along, &low, &high, n_columns);
                for i in first..=last {
                    let x = 2.0 * f64::from(i) + x;
                    let point = Vector3::new(x, y, layer * f64::from(k));
                    if point.norm_squared() > (reach + 3.0).powi(2) {
                        continue;
                    }
                    let point = origin + self.turn * point;
                    let within = (0..3).all(|a| point[a] > low[a] && point[a] < high[a]);
                    if within && grid.at(&point).value <= level {
                        inside.push(point);
                    }
                }
            }
        }
        inside
    }

    /// 0, 1 or 2: the place A, B or C of layer k; layer 0 is at A.
    fn kind(&self, k: i32) -> i32 {
        let step = |layer: i32| 1 - 2 * i32::from(self.stacking >> layer.rem_euclid(64) & 1 == 1);
        let sum: i32 = if k >= 0 {
            (0..k).map(step).sum()
        } else {
            -(k..0).map(step).sum::<i32>()
        };
        sum.rem_euclid(3)
    }
}

/// Number of lattice points in a sphere of a radius in radii: its volume over 4√2.
pub(crate) fn lattice_count(reach: f64) -> f64 {
    geometry::clump::volume_of_sphere(reach) / (4.0 * 2.0_f64.sqrt())
}

/// Steps of a spacing that cover a reach.
fn steps(reach: f64, spacing: f64) -> i32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "reach is bounded by the grid"
    )]
    let steps = (reach / spacing).ceil() as i32;
    steps + 1
}

/// First and last column of a row that can lie in a box, a little more at both ends.
fn columns_within(
    start: &Vector3<f64>,
    along: &Vector3<f64>,
    low: &Vector3<f64>,
    high: &Vector3<f64>,
    most: i32,
) -> (i32, i32) {
    let (mut first, mut last) = (-f64::from(most), f64::from(most));
    for k in 0..3 {
        let ends = [low[k], high[k]].map(|side| (side - start[k]) / along[k]);
        if ends.iter().all(|end| end.is_finite()) {
            first = first.max(ends[0].min(ends[1]) - 1e-6);
            last = last.min(ends[0].max(ends[1]) + 1e-6);
        }
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "between minus and plus the most"
    )]
    (first.ceil() as i32, last.floor() as i32)
}

/// Finds the placement with most points one radius below the surface; gives these points.
pub(crate) fn best_lattice(
    grid: &DistanceGrid,
    stream: &mut Stream,
    effort: f64,
) -> Vec<Vector3<f64>> {
    /// Lattice points looked at, at effort 1, over all placements that are tried.
    const WORK: f64 = 2e6;
    let reach = reach_of(grid);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let tries = (effort * WORK / lattice_count(reach)).clamp(12.0, 4000.0) as usize;
    let mut best: Option<(Placement, Vec<Vector3<f64>>)> = None;
    for i in 0..tries {
        let fresh = Placement::random(stream);
        let placement = match &best {
            Some((found, _)) if 2 * i > tries => {
                let size = 0.5 * (1.0 - i as f64 / tries as f64) + 0.01;
                found.varied(&fresh, size)
            }
            _ => fresh,
        };
        let inside = placement.points_below(grid, reach, -1.0);
        if best
            .as_ref()
            .is_none_or(|(_, most)| inside.len() > most.len())
        {
            best = Some((placement, inside));
        }
    }
    best.map(|(_, points)| points).unwrap_or_default()
}

/// Half the diagonal of the box that a grid covers, radii.
pub(crate) fn reach_of(grid: &DistanceGrid) -> f64 {
    let [low, high] = grid.corners();
    (high - low).norm() / 2.0
}

#[cfg(test)]
mod tests {
    use super::{CUBIC, HEXAGONAL, Placement};
    use crate::distance_grid::DistanceGrid;
    use nalgebra::{UnitQuaternion, Vector3};
    use trimesh::{SignedDistance, shapes};

    /// In a wide box, inner centres have exactly twelve touching neighbours and none nearer,
    /// whatever the order of the layers, the turn and the shift: so the rows are clipped rightly.
    #[test]
    fn every_inner_centre_has_twelve_neighbours_at_two_radii() {
        let side = 14.0;
        let mesh = shapes::ellipsoid([side, side, side], 12).unwrap();
        let distance = SignedDistance::new(&mesh).unwrap();
        let grid = DistanceGrid::new(&distance, &mesh.bounding_box(), 1.0);
        for (stacking, turn) in [
            (CUBIC, 0.0),
            (HEXAGONAL, 0.7),
            (0x9249_4F31_0555_D213, -2.0),
        ] {
            let placement = Placement {
                turn: UnitQuaternion::from_euler_angles(turn, 0.5 * turn, -turn),
                shift: Vector3::new(0.3, -0.9, 0.1) * turn,
                stacking,
            };
            let points = placement.points_below(&grid, 20.0, -1.0);
            let depth = |p: &Vector3<f64>| p.norm();
            for point in points.iter().filter(|p| depth(p) < 8.0) {
                let near = |distance: f64| {
                    let other = |p: &&Vector3<f64>| (*p - point).norm() < distance;
                    points.iter().filter(other).count() - 1
                };
                assert_eq!(
                    (near(2.0 - 1e-9), near(2.0 + 1e-9)),
                    (0, 12),
                    "{stacking:x}"
                );
            }
        }
    }
}
