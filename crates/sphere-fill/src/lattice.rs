//! Close-packed lattices placed into a body.

use crate::distance_grid::DistanceGrid;
use crate::pack::{in_metres, within_tolerance};
use crate::relaxation::Wall;
use crate::{Body, Error, FillSettings, Place};
use clump::Sphere;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use random_stream::Stream;

/// Lattice points looked at, at effort 1, over all placements that are tried.
const WORK: f64 = 2e6;

/// Equal touching spheres on the best placed close-packed lattice.
///
/// Cubic (layers ABC) and hexagonal (layers AB) close packing in random rotations and offsets;
/// each start is then varied by ever smaller turns and shifts, and a variation kept when the
/// count is not less, centres up to 0.1 radii too near to the surface counting in part. The
/// placement with most centres at least one radius below the surface is kept. With a count N,
/// the N spheres nearest to the surface are kept, so that the surface stays covered.
#[derive(Debug, Clone, Copy)]
pub struct Lattice;

impl Place for Lattice {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let grid = body.grid(settings);
        let mut stream = Stream::new(settings.seed, "sphere lattice");
        let found = climbed_lattice(&grid, &mut stream, settings.effort);
        let wall = Wall::Exact {
            grid: &grid,
            distance: &body.distance,
            radius: settings.radius,
        };
        let mut centres = within_tolerance(&wall, &found);
        if let Some(asked) = settings.count {
            if centres.len() < asked {
                return Err(Error::CountNotReached {
                    mesh: body.mesh.source().to_owned(),
                    asked,
                    reached: centres.len(),
                    radius_mm: settings.radius * 1e3,
                });
            }
            let depth = |centre: &Vector3<f64>| -grid.at(centre).value;
            centres.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
            centres.truncate(asked);
        }
        Ok(in_metres(&centres, settings.radius))
    }
}

/// Variations of one start.
const CLIMB: usize = 150;

/// Distance to the depth of one radius over which a centre counts in part, radii.
const NEARLY: f64 = 0.1;

/// Part of a sphere that a centre a little too near to the surface is worth, at most.
const PARTLY: f64 = 0.5;

/// Climbs from several random placements; gives the points of the best.
fn climbed_lattice(grid: &DistanceGrid, stream: &mut Stream, effort: f64) -> Vec<Vector3<f64>> {
    let [low, high] = grid.corners();
    let reach = (high - low).norm() / 2.0;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let starts =
        (effort * 16.0 * WORK / lattice_count(reach) / CLIMB as f64).clamp(1.0, 400.0) as usize;
    let mut best: Vec<Vector3<f64>> = Vec::new();
    for _ in 0..starts {
        let mut placement = random_placement(stream);
        let mut worth = 0.0;
        for step in 0..CLIMB {
            let size = 0.6 * (1.0 - step as f64 / CLIMB as f64).powi(2) + 0.01;
            let trial = if step == 0 {
                placement
            } else {
                varied(&placement, &random_placement(stream), size)
            };
            let near = points_below(grid, &trial, reach, NEARLY - 1.0);
            let depth = |point: &Vector3<f64>| grid.at(point).value;
            let part = |point| (1.0 - (depth(point) + 1.0).max(0.0) / NEARLY) * PARTLY;
            let inside: Vec<_> = near.iter().filter(|p| depth(p) <= -1.0).copied().collect();
            let trial_worth =
                inside.len() as f64 * (1.0 - PARTLY) + near.iter().map(part).sum::<f64>();
            if trial_worth >= worth {
                (placement, worth) = (trial, trial_worth);
            }
            if inside.len() > best.len() {
                best = inside;
            }
        }
    }
    best
}

/// Where a lattice lies.
#[derive(Clone, Copy)]
struct Placement {
    /// Turn of the lattice.
    turn: UnitQuaternion<f64>,
    /// Shift from the middle of the body, radii.
    shift: Vector3<f64>,
    /// Layers after which the stacking repeats: 2 hexagonal, 3 cubic.
    period: i32,
}

/// Finds the placement with most points one radius below the surface; gives these points.
pub(crate) fn best_lattice(
    grid: &DistanceGrid,
    stream: &mut Stream,
    effort: f64,
) -> Vec<Vector3<f64>> {
    let [low, high] = grid.corners();
    let reach = (high - low).norm() / 2.0;
    let points = lattice_count(reach);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let tries = (effort * WORK / points).clamp(12.0, 4000.0) as usize;
    let mut best: Option<(Placement, Vec<Vector3<f64>>)> = None;
    for i in 0..tries {
        let fresh = random_placement(stream);
        let placement = match &best {
            Some((found, _)) if 2 * i > tries => {
                let size = 0.5 * (1.0 - i as f64 / tries as f64) + 0.01;
                varied(found, &fresh, size)
            }
            _ => fresh,
        };
        let inside = points_below(grid, &placement, reach, -1.0);
        if best
            .as_ref()
            .is_none_or(|(_, most)| inside.len() > most.len())
        {
            best = Some((placement, inside));
        }
    }
    best.map(|(_, points)| points).unwrap_or_default()
}

/// Number of lattice points in a sphere of a radius in radii: its volume over 4√2.
fn lattice_count(reach: f64) -> f64 {
    clump::volume_of_sphere(reach) / (4.0 * 2.0_f64.sqrt())
}

fn random_placement(stream: &mut Stream) -> Placement {
    let [w, x, y, z] = stream.rotation();
    Placement {
        turn: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
        shift: Vector3::from_fn(|_, _| stream.between(-1.7, 1.7)),
        period: if stream.uniform() < 0.5 { 2 } else { 3 },
    }
}

/// A placement turned and shifted a little toward a random one.
fn varied(base: &Placement, random: &Placement, size: f64) -> Placement {
    Placement {
        turn: base.turn * random.turn.powf(0.2 * size),
        shift: base.shift + random.shift * size,
        period: base.period,
    }
}

/// Lattice points whose signed distance to the surface is at most `level`, radii.
fn points_below(
    grid: &DistanceGrid,
    placement: &Placement,
    reach: f64,
    level: f64,
) -> Vec<Vector3<f64>> {
    let [low, high] = grid.corners();
    let middle = (low + high) * 0.5;
    let (row, layer) = (3.0_f64.sqrt(), (8.0_f64 / 3.0).sqrt());
    #[expect(
        clippy::cast_possible_truncation,
        reason = "reach is bounded by the grid"
    )]
    let steps = |spacing: f64| (reach / spacing).ceil() as i32 + 1;
    let (n_layers, n_rows, n_columns) = (steps(layer), steps(row), steps(2.0));
    let mut inside = Vec::new();
    for k in -n_layers..=n_layers {
        // Layers B and C lie over the hollows of layer A, one or two thirds of a row further.
        let kind = f64::from(k.rem_euclid(placement.period));
        let kind = if placement.period == 2 {
            kind
        } else {
            kind.rem_euclid(3.0)
        };
        for j in -n_rows..=n_rows {
            let y = row * (f64::from(j) + kind / 3.0);
            for i in -n_columns..=n_columns {
                let x = 2.0 * f64::from(i) + f64::from(j.rem_euclid(2)) + kind;
                let point = Vector3::new(x, y, layer * f64::from(k));
                if point.norm_squared() > (reach + 3.0).powi(2) {
                    continue;
                }
                let point = middle + placement.shift + placement.turn * point;
                let within = (0..3).all(|a| point[a] > low[a] && point[a] < high[a]);
                if within && grid.at(&point).value <= level {
                    inside.push(point);
                }
            }
        }
    }
    inside
}
