//! Spheres along the longest axis of a body.

use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;
use nalgebra::Vector3;

/// Most spheres, when neither a count nor a limit is given.
const MOST: usize = 400;

/// Points of the axis at which the depth is measured.
const POINTS: usize = 2001;

/// Overlapping spheres with their centres on the axis of least inertia, each touching the surface.
///
/// # Method
///
/// Centres are spaced evenly between the outermost points of the axis that lie at least the
/// smallest radius deep; each sphere is as large as fits. Without a count the spacing is the
/// smallest radius. Meant for axially symmetric bodies: on others it shows what the axis misses.
///
/// # Source
///
/// `[Favier1999]`; the even spacing is a choice made here.
#[derive(Debug, Clone, Copy)]
pub struct Favier;

impl Place for Favier {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let axis = longest_axis(body);
        let centroid = body.moments.centroid;
        let bounds = body.mesh.bounding_box();
        let reach = bounds.size().norm();
        let on_axis = |index: usize| {
            let share = 2.0 * index as f64 / (POINTS - 1) as f64 - 1.0;
            centroid + axis * (share * reach)
        };
        let depth = |point: &Vector3<f64>| -body.distance.distance(point);
        let mut deep = (0..POINTS)
            .map(on_axis)
            .filter(|p| depth(p) >= settings.radius);
        let Some(first) = deep.next() else {
            return Ok(Vec::new());
        };
        let last = deep.next_back().unwrap_or(first);
        let count = settings
            .count
            .unwrap_or_else(|| steps(&first, &last, settings));
        let spheres = (0..count).map(|i| {
            let share = if count == 1 {
                0.5
            } else {
                i as f64 / (count - 1) as f64
            };
            let centre = first.lerp(&last, share);
            let radius = depth(&centre);
            Sphere { centre, radius }
        });
        // A hollow on the axis has no room for a sphere.
        let placed: Vec<Sphere> = spheres
            .filter(|s| s.radius >= 0.999 * settings.radius)
            .collect();
        match settings.count {
            Some(asked) if placed.len() < asked => Err(Error::CountNotReached {
                mesh: body.mesh.source().to_owned(),
                asked,
                reached: placed.len(),
                radius_mm: settings.radius * 1e3,
                method: settings.method,
            }),
            _ => Ok(placed),
        }
    }
}

/// Number of spheres at a spacing of the smallest radius.
fn steps(first: &Vector3<f64>, last: &Vector3<f64>, settings: &FillSettings) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, and a float cast saturates"
    )]
    let steps = ((last - first).norm() / settings.radius).ceil() as usize;
    (steps + 1).min(settings.count_or(MOST))
}

/// Unit vector of the axis of least inertia.
fn longest_axis(body: &Body<'_>) -> Vector3<f64> {
    let eigen = body.moments.inertia.symmetric_eigen();
    eigen
        .eigenvectors
        .column(eigen.eigenvalues.imin())
        .into_owned()
}
