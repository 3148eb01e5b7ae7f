//! Principal moments and axes of a body.

use crate::VolumeMoments;
use nalgebra::Vector3;

/// Moments nearer to each other than this share leave the direction of their axes open: there an error
/// of half a per cent turns them by 25 degrees. Our choice.
const TIED: f64 = 0.01;

/// Principal moments with their axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalAxes {
    /// Moments at unit density in rising order, m⁵.
    pub moments: [f64; 3],
    /// Unit vectors along which they are taken, a right-handed frame; the largest component of the first
    /// two is positive.
    pub axes: [Vector3<f64>; 3],
}

impl VolumeMoments {
    /// Principal moments and axes.
    pub fn principal_axes(&self) -> PrincipalAxes {
        let eigen = self.inertia.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let along = |k: usize| {
            let axis: Vector3<f64> = eigen.eigenvectors.column(order[k]).into();
            axis * axis[axis.iamax()].signum()
        };
        let (first, second) = (along(0), along(1));
        PrincipalAxes {
            moments: order.map(|k| eigen.eigenvalues[k]),
            axes: [first, second, first.cross(&second)],
        }
    }
}

impl PrincipalAxes {
    /// Angles to the axes of another body, rad, 0 to π/2; none if two moments of either body are so
    /// near to each other (1 %) that the axis has no direction of its own.
    pub fn angles_to(&self, other: &Self) -> [Option<f64>; 3] {
        [0, 1, 2].map(|k| {
            let free = self.is_tied(k) || other.is_tied(k);
            let (a, b) = (self.axes[k], other.axes[k]);
            (!free).then(|| a.cross(&b).norm().atan2(a.dot(&b).abs()))
        })
    }

    /// Whether another moment is nearly this one.
    fn is_tied(&self, k: usize) -> bool {
        let near = |other: usize| (self.moments[k] / self.moments[other] - 1.0).abs() < TIED;
        (0..3).any(|other| other != k && near(other))
    }
}
