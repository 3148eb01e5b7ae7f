//! The body to fill, with what every method asks of it.

use crate::distance_grid::DistanceGrid;
use crate::{Error, FillSettings};
use geometry::clump::Sphere;
use nalgebra::Vector3;
use trimesh::{SignedDistance, TriMesh, VolumeMoments};

/// Most spheres of a filling: beyond, a file or a simulation is not what was meant.
pub(crate) const MOST_SPHERES: usize = 200_000;

/// A closed body with its distance field.
#[derive(Debug)]
pub struct Body<'a> {
    /// Its surface.
    pub mesh: &'a TriMesh,
    /// Exact signed distance to the surface.
    pub distance: SignedDistance,
    /// Volume, centroid, inertia.
    pub moments: VolumeMoments,
    /// Radius of (nearly) the largest inscribed sphere, m.
    pub inscribed_radius: f64,
    /// Its centre, m.
    pub inscribed_centre: Vector3<f64>,
}

impl<'a> Body<'a> {
    /// Prepares a mesh for filling.
    ///
    /// # Errors
    ///
    /// A mesh that does not bound exactly one body.
    pub fn new(mesh: &'a TriMesh) -> Result<Self, Error> {
        let distance = SignedDistance::new(mesh)?;
        let largest = largest_inscribed(mesh, &distance);
        Ok(Self {
            mesh,
            distance,
            moments: mesh.moments(),
            inscribed_radius: largest.radius,
            inscribed_centre: largest.centre,
        })
    }

    /// Refuses radii of which none fits.
    pub(crate) fn check_radius(&self, radius: f64) -> Result<(), Error> {
        // The largest sphere is searched for to 0.1 % and its tolerance is 1 %.
        if radius > self.inscribed_radius * 1.001 {
            return Err(Error::RadiusTooLarge {
                mesh: self.mesh.source().to_owned(),
                radius_mm: radius * 1e3,
                largest_mm: self.inscribed_radius * 1e3,
            });
        }
        Ok(())
    }

    /// Refuses radii of which far too many fit without overlap.
    pub(crate) fn check_number(&self, radius: f64) -> Result<(), Error> {
        let estimate = self.expected_count(radius) * 1.3;
        if estimate > MOST_SPHERES as f64 {
            return Err(Error::TooManySpheres {
                mesh: self.mesh.source().to_owned(),
                radius_mm: radius * 1e3,
                estimate,
                limit: MOST_SPHERES,
            });
        }
        Ok(())
    }

    /// Number of spheres at a packing fraction of 0.55, usual for bodies of some radii across.
    pub(crate) fn expected_count(&self, radius: f64) -> f64 {
        0.55 * self.moments.volume / geometry::clump::volume_of_sphere(radius)
    }

    /// Distance grid in units of the sphere radius.
    pub(crate) fn grid(&self, settings: &FillSettings) -> DistanceGrid {
        let radius = settings.radius;
        DistanceGrid::new(&self.distance, &self.mesh.bounding_box(), radius)
    }
}

/// Finds the largest inscribed sphere: best node of a grid, then a shrinking search.
fn largest_inscribed(mesh: &TriMesh, distance: &SignedDistance) -> Sphere {
    const CELLS: usize = 14;
    let bounds = mesh.bounding_box();
    let depth = |point: &Vector3<f64>, guess: usize| {
        let found = distance.nearest_from(point, guess);
        (-found.distance, found.triangle)
    };
    let mut best = (bounds.centre(), depth(&bounds.centre(), 0));
    let mut guess = 0;
    for index in 0..CELLS.pow(3) {
        let cell = [
            index / (CELLS * CELLS),
            index / CELLS % CELLS,
            index % CELLS,
        ];
        let share = Vector3::from_fn(|k, _| (cell[k] as f64 + 0.5) / CELLS as f64);
        let point = bounds.low + bounds.size().component_mul(&share);
        let found = depth(&point, guess);
        guess = found.1;
        if found.0 > best.1.0 {
            best = (point, found);
        }
    }
    let mut step = bounds.size().amax() / CELLS as f64;
    while step > 1e-4 * best.1.0.abs().max(1e-4 * bounds.size().amax()) {
        let around = (0..26).map(|i| {
            let i = i + i32::from(i >= 13);
            let part = |k: i32| f64::from(i / 3_i32.pow(k.unsigned_abs()) % 3 - 1);
            best.0 + Vector3::new(part(0), part(1), part(2)) * step
        });
        let better = around
            .map(|point| (point, depth(&point, best.1.1)))
            .max_by(|a, b| a.1.0.total_cmp(&b.1.0));
        match better {
            Some(found) if found.1.0 > best.1.0 => best = found,
            _ => step *= 0.5,
        }
    }
    Sphere {
        centre: best.0,
        radius: best.1.0,
    }
}
