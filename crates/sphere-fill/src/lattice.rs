//! Close-packed lattices placed into a body.

use crate::distance_grid::DistanceGrid;
use crate::pack::{in_metres, within_tolerance};
use crate::placement::{Placement, lattice_count, reach_of};
use crate::relaxation::Wall;
use crate::settling::settled;
use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;
use nalgebra::Vector3;
use probability::random_stream::Stream;

/// Lattice points over all placements that are settled, at effort 1.
const WORK: f64 = 2e7;

/// Equal touching spheres on the best placed close-packed layers.
///
/// # Method
///
/// Cubic (layers ABC) and hexagonal (layers AB) close packing in random rotations and offsets. Each
/// start is settled: turned and shifted as one so that its centres get one radius below the surface,
/// while those that cannot are left out one after another. After a quarter of the work, the best 100
/// are turned and shifted a little, or get another order of the layers (which is as dense), and
/// settled again. The placement with most centres is taken. With a count N, the N spheres nearest
/// to the surface are kept, so that the surface stays covered.
#[derive(Debug, Clone, Copy)]
pub struct Lattice;

impl Place for Lattice {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let grid = body.grid(settings);
        let mut stream = Stream::new(settings.seed, "sphere lattice");
        let found = settled_lattice(&grid, &mut stream, settings.effort);
        let wall = Wall::Exact {
            grid: &grid,
            distance: &body.distance,
            radius: settings.radius,
            thin: false,
        };
        let mut centres = within_tolerance(&wall, &found);
        if let Some(asked) = settings.count {
            if centres.len() < asked {
                return Err(Error::CountNotReached {
                    mesh: body.mesh.source().to_owned(),
                    asked,
                    reached: centres.len(),
                    radius_mm: settings.radius * 1e3,
                    method: settings.method,
                });
            }
            let depth = |centre: &Vector3<f64>| -grid.at(centre).value;
            centres.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
            centres.truncate(asked);
        }
        Ok(in_metres(&centres, settings.radius))
    }
}

/// Placements that are varied after the first quarter of the work.
const ELITE: usize = 100;

/// Share of the variations that change the order of the layers.
const RESTACKED: f64 = 0.3;

/// A settled placement.
struct Settled {
    placement: Placement,
    /// Its centres at least one radius below the surface, radii.
    inside: Vec<Vector3<f64>>,
}

/// Settles random placements, then variations of the best; gives the points of the best.
fn settled_lattice(grid: &DistanceGrid, stream: &mut Stream, effort: f64) -> Vec<Vector3<f64>> {
    let reach = reach_of(grid);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let tries = (effort * WORK / lattice_count(reach)).clamp(4.0, 1e6) as usize;
    let settle = |placement: Placement| {
        let placement = settled(&placement, grid, reach);
        Settled {
            inside: placement.points_below(grid, reach, -1.0),
            placement,
        }
    };
    // Rising count; of equal ones the later is later.
    let mut elite: Vec<Settled> = Vec::new();
    let enter = |elite: &mut Vec<Settled>, found: Settled| {
        let place = elite.partition_point(|other| other.inside.len() <= found.inside.len());
        elite.insert(place, found);
        if elite.len() > ELITE {
            elite.remove(0);
        }
    };
    for _ in 0..tries / 4 {
        enter(&mut elite, settle(Placement::random(stream)));
    }
    for _ in tries / 4..tries {
        let base = &elite[stream.below(elite.len())];
        let size = 0.6 * 30.0_f64.powf(-stream.uniform());
        let mut varied = base.placement.varied(&Placement::random(stream), size);
        if stream.uniform() < RESTACKED {
            varied = varied.restacked(stream);
        }
        enter(&mut elite, settle(varied));
    }
    elite.pop().map(|best| best.inside).unwrap_or_default()
}
