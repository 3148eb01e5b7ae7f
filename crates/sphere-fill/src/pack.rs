//! Dense packing of equal spheres without overlap.

use crate::distance_grid::DistanceGrid;
use crate::neighbours::Neighbours;
use crate::pack_search::{FREE, LONGEST, Search};
use crate::relaxation::{DEPTH, Room, Stop, Wall, relax};
use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;
use nalgebra::Vector3;

/// Sum of squared overlaps (radii²) that counts as none in the last relaxation against the exact surface.
const FREE_AT_LAST: f64 = 1e-9;

/// Bodies of which the largest inscribed sphere has less than this many radii are packed against the
/// exact surface: the interpolated distance rounds the ridge in the middle of a thin wall off, by up
/// to a quarter of a radius.
const THIN: f64 = 1.3;

/// Work against the exact surface, where an evaluation takes about ten times as long.
const EXACT_SHARE: f64 = 0.1;

/// Largest overlap of a result, radii: 0.1 %.
const OVERLAP_TOLERANCE: f64 = 1e-3;

/// Largest protrusion of a result, radii: 1 %.
const PROTRUSION_TOLERANCE: f64 = 1e-2;

/// Equal spheres, dense and without overlap, inside the mesh.
///
/// # Method
///
/// Random centres are relaxed ([energy minimisation](crate#packing)); spheres are then dropped
/// into the deepest holes and the whole relaxed again, as long as all overlap can be removed.
/// When it cannot, one of the most squeezed spheres is moved to another deep hole, and the
/// move kept when the energy falls; after 60 moves without gain a new random start is made,
/// until the work is spent. The largest configuration wins; a best-placed lattice is grown the
/// same way when it holds more, as it does for bodies many spheres across. An effort above 1 is
/// spent on a random walk between the minima of the energy with one sphere more. At last the spheres
/// are relaxed against the exact surface and checked.
///
/// With a count N the same search stops at N spheres, and the centres are then spread: their
/// mutual distance is raised as far as N centres can have it while each stays one radius below
/// the surface. Spare room is so shared evenly, and the surface is covered as evenly as N
/// spheres can cover it. A single sphere stands where the body is thickest.
///
/// # Source
///
/// The relocation of squeezed spheres into vacancies is the core of `[Huang2011]` for equal
/// spheres in a sphere; the energy is that of soft-disk packings `[Ohern2003]`.
#[derive(Debug, Clone, Copy)]
pub struct Pack;

impl Place for Pack {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let grid = body.grid(settings);
        let thin = is_thin(body, settings);
        let exact = Wall::Exact {
            grid: &grid,
            distance: &body.distance,
            radius: settings.radius,
            thin,
        };
        let room = Room {
            wall: if thin { exact } else { Wall::Grid(&grid) },
            spacing: 2.0,
        };
        let effort = settings.effort * if thin { EXACT_SHARE } else { 1.0 };
        let search = FillSettings {
            effort,
            ..*settings
        };
        let found = if settings.count == Some(1) {
            Vec::new()
        } else {
            Search::new(body, &search, &grid, room).run()
        };
        let spread = match settings.count {
            Some(count) if found.len() == count => spread(room, found),
            _ => Spread {
                centres: found,
                spacing: 2.0,
            },
        };
        let mut centres = finish(body, settings, &grid, spread);
        if centres.len() <= 1 {
            // The radius was checked: one sphere fits where the body is thickest.
            centres = vec![body.inscribed_centre / settings.radius];
        }
        if let Some(asked) = settings.count.filter(|&count| centres.len() < count) {
            return Err(Error::CountNotReached {
                mesh: body.mesh.source().to_owned(),
                asked,
                reached: centres.len(),
                radius_mm: settings.radius * 1e3,
                method: settings.method,
            });
        }
        Ok(in_metres(&centres, settings.radius))
    }
}

/// Whether the body is thin for spheres of this radius.
fn is_thin(body: &Body<'_>, settings: &FillSettings) -> bool {
    body.inscribed_radius < THIN * settings.radius
}

pub(crate) fn in_metres(centres: &[Vector3<f64>], radius: f64) -> Vec<Sphere> {
    let sphere = |centre: &Vector3<f64>| Sphere {
        centre: centre * radius,
        radius,
    };
    centres.iter().map(sphere).collect()
}

/// Centres and the distance that they keep, radii.
struct Spread {
    centres: Vec<Vector3<f64>>,
    spacing: f64,
}

/// Raises the distance between centres as far as it goes, to about 0.2 %.
fn spread(room: Room<'_>, centres: Vec<Vector3<f64>>) -> Spread {
    let mut best = Spread {
        centres,
        spacing: room.spacing,
    };
    let stop = Stop {
        energy: FREE,
        evaluations: LONGEST,
    };
    let mut growth = 0.08;
    while growth > 2e-3 {
        let spacing = best.spacing * (1.0 + growth);
        let relaxed = relax(&Room { spacing, ..room }, best.centres.clone(), stop);
        if relaxed.energy <= FREE {
            best.centres = relaxed.centres;
            best.spacing = spacing;
        } else {
            growth *= 0.5;
        }
    }
    best
}

/// Relaxes against the exact surface and drops what is still outside the tolerances.
fn finish(
    body: &Body<'_>,
    settings: &FillSettings,
    grid: &DistanceGrid,
    spread: Spread,
) -> Vec<Vector3<f64>> {
    let exact = Wall::Exact {
        grid,
        distance: &body.distance,
        radius: settings.radius,
        thin: is_thin(body, settings),
    };
    // A spread filling has room to spare: keeping a little less of it makes the end easy.
    let room = Room {
        wall: exact,
        spacing: (spread.spacing * 0.998).max(2.0),
    };
    let stop = Stop {
        energy: FREE_AT_LAST,
        evaluations: LONGEST / 4,
    };
    let centres = relax(&room, spread.centres, stop).centres;
    within_tolerance(&exact, &centres)
}

/// Keeps the centres that stand out by at most the tolerance, and of each pair that overlaps by
/// more than the tolerance the first one.
pub(crate) fn within_tolerance(wall: &Wall<'_>, centres: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let protrudes = |centre| wall.at(centre).value + DEPTH > PROTRUSION_TOLERANCE;
    let mut dropped: Vec<bool> = centres.iter().map(protrudes).collect();
    let mut neighbours = Neighbours::default();
    for &(i, j) in neighbours.within(centres, 2.0) {
        let (i, j) = (i as usize, j as usize);
        let overlap = 2.0 - (centres[i] - centres[j]).norm();
        if overlap > OVERLAP_TOLERANCE && !dropped[i] {
            dropped[j] = true;
        }
    }
    let kept = centres.iter().zip(dropped).filter(|(_, dropped)| !dropped);
    kept.map(|(centre, _)| *centre).collect()
}
