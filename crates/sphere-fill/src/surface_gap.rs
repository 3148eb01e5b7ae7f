//! How far the spheres' surface lies from the mesh's.

use geometry::clump::Sphere;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Vector3;

/// Signed distances from points of the surface to the union of spheres, m: positive where the
/// spheres fall short, negative where they stand out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gaps<'a> {
    /// The distances, each standing for the same area, m.
    pub(crate) values: &'a [f64],
}

impl Gaps<'_> {
    /// Mean gap, m.
    pub(crate) fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Root of the mean squared gap, m.
    pub(crate) fn rms(&self) -> f64 {
        let squares: f64 = self.values.iter().map(|g| g * g).sum();
        (squares / self.values.len() as f64).sqrt()
    }

    /// Root of the mean squared deviation from the mean gap, m.
    pub(crate) fn roughness_rms(&self) -> f64 {
        let mean = self.mean();
        let squares: f64 = self.values.iter().map(|g| (g - mean).powi(2)).sum();
        (squares / self.values.len() as f64).sqrt()
    }

    /// Largest absolute gap, m.
    pub(crate) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |m, g| g.abs().max(m))
    }
}

/// Gap at each point: min over spheres of (distance to the centre − radius), m.
pub(crate) fn gaps_at<'a>(
    points: impl Iterator<Item = &'a Vector3<f64>>,
    spheres: &[Sphere],
) -> Vec<f64> {
    let centres: Vec<[f64; 3]> = spheres
        .iter()
        .map(|s| [s.centre.x, s.centre.y, s.centre.z])
        .collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&centres) else {
        return Vec::new();
    };
    let largest = spheres.iter().fold(0.0, |m: f64, s| m.max(s.radius));
    let equal = spheres.iter().all(|s| s.radius == largest);
    let gap_at = |point: &Vector3<f64>| {
        let place = [point.x, point.y, point.z];
        let nearest = tree
            .query(&place)
            .nearest_one::<SquaredEuclidean<f64>>()
            .execute();
        if equal {
            return nearest.distance.sqrt() - largest;
        }
        // A larger sphere farther off may have its surface nearer: its centre is then within
        // the gap to the nearest-centred one plus the largest radius (the tree takes squares).
        let gap = |i: usize| (point - spheres[i].centre).norm() - spheres[i].radius;
        let bound = gap(usize::try_from(nearest.item).unwrap_or(0));
        let reach = (bound + largest).max(0.0);
        tree.query(&place)
            .within::<SquaredEuclidean<f64>>(reach * reach)
            .unsorted()
            .execute()
            .iter()
            .map(|found| gap(usize::try_from(found.item).unwrap_or(0)))
            .fold(bound, f64::min)
    };
    points.map(gap_at).collect()
}

#[cfg(test)]
mod tests {
    use super::gaps_at;
    use geometry::clump::Sphere;
    use nalgebra::Vector3;
    use probability::random_stream::Stream;

    /// The tree gives what the comparison with every sphere gives, for radii that differ 30-fold.
    #[test]
    fn gap_is_that_of_the_nearest_surface_not_of_the_nearest_centre() {
        let mut stream = Stream::new(5, "gaps");
        let spheres: Vec<_> = (0..60)
            .map(|_| Sphere {
                centre: Vector3::from_fn(|_, _| stream.between(-1.0, 1.0)),
                radius: stream.between(0.01, 0.3),
            })
            .collect();
        let points: Vec<_> = (0..300)
            .map(|_| Vector3::from_fn(|_, _| stream.between(-1.5, 1.5)))
            .collect();
        let found = gaps_at(points.iter(), &spheres);
        for (point, gap) in points.iter().zip(found) {
            let plain = spheres
                .iter()
                .map(|s| (point - s.centre).norm() - s.radius)
                .fold(f64::INFINITY, f64::min);
            assert!((gap - plain).abs() < 1e-14, "{gap} instead of {plain}");
        }
    }
}
