//! Size and shape of a body in numbers.

use crate::smallest_box::smallest_box;
use crate::{Error, TriMesh};
use std::f64::consts::PI;

/// Size and shape of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyShape {
    /// Volume V, m³.
    pub volume: f64,
    /// Surface area A, m²; the walls of cavities count.
    pub area: f64,
    /// Diameter of the sphere of that volume, (6 V / π)^(1/3), m.
    pub equivalent_diameter: f64,
    /// Edges of the box of the least volume that is found in any direction: longest L, intermediate I
    /// and shortest S, m.
    pub lengths: [f64; 3],
    /// I / L, 1 for a body as wide as long `[Zingg1935]`.
    pub elongation: f64,
    /// S / I, 1 for a body as thick as wide `[Zingg1935]`.
    pub flatness: f64,
    /// Area of the sphere of that volume over the area, π^(1/3) (6 V)^(2/3) / A `[Wadell1935]`; 1 for a
    /// sphere, less for all others.
    pub sphericity: f64,
}

impl TriMesh {
    /// Size and shape of the body.
    ///
    /// # Errors
    ///
    /// A mesh that does not bound exactly one body.
    pub fn shape(&self) -> Result<BodyShape, Error> {
        self.require_closed()?;
        let moments = self.moments();
        let (volume, area) = (moments.volume, self.area());
        let found = smallest_box(self.vertices(), &moments.principal_axes().axes);
        let mut lengths: [f64; 3] = found.size.into();
        lengths.sort_by(|a, b| b.total_cmp(a));
        let [longest, intermediate, shortest] = lengths;
        Ok(BodyShape {
            volume,
            area,
            equivalent_diameter: (6.0 * volume / PI).cbrt(),
            lengths,
            elongation: intermediate / longest,
            flatness: shortest / intermediate,
            sphericity: PI.cbrt() * (6.0 * volume).powf(2.0 / 3.0) / area,
        })
    }
}
