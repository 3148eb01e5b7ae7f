//! The largest inscribed sphere that touches the surface at a point.

use crate::Body;
use geometry::clump::Sphere;
use trimesh::SurfaceSample;

/// Steps of the shrinking ball; most samples take fewer than 10.
const SHRINKING_STEPS: usize = 40;

/// Largest inscribed sphere that touches the surface at a sample, if its radius is enough.
///
/// # Formula
///
/// From c = p − r n `[Ma2012, section 3]`, the surface point q nearest to c gives the smaller radius
/// r' = |p − q|² / (2 n·(p − q)); repeated until nothing lies nearer than p.
pub(crate) fn touching_sphere(
    body: &Body<'_>,
    sample: &SurfaceSample,
    least: f64,
) -> Option<Sphere> {
    // A facetted surface touches a sphere a little beside p: 0.1 % of the radius is given in.
    const SLACK: f64 = 1e-3;
    let mut radius = body.inscribed_radius * 1.001;
    let mut guess = sample.triangle;
    for _ in 0..SHRINKING_STEPS {
        let centre = sample.point - sample.normal * radius;
        let nearest = body.distance.nearest_from(&centre, guess);
        guess = nearest.triangle;
        if -nearest.distance >= radius * (1.0 - SLACK) {
            return (radius >= least).then_some(Sphere { centre, radius });
        }
        let chord = sample.point - nearest.point;
        let along = sample.normal.dot(&chord);
        let smaller = chord.norm_squared() / (2.0 * along);
        // A neighbouring facet gives no chord to speak of: shrink by a share instead.
        radius = if along > 0.0 && smaller < radius * (1.0 - SLACK) {
            smaller
        } else {
            radius * (1.0 - SLACK)
        };
        if radius < least {
            return None;
        }
    }
    None
}
