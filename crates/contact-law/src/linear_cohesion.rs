//! Cohesion in proportion to the area of contact (linear cohesion, simplified JKR).
//!
//! # Formula
//!
//! ```text
//! F_c = k A      A = 2 pi R* d
//! ```
//!
//! A is the circle in which two spheres of the reduced radius R* with a small overlap d intersect, to first order in d / R*; k the
//! cohesion energy density (J/m³). The force pulls while the spheres overlap and has no memory; Hertz's force carries a contact at
//! rest, and the friction limit stays `mu F_repulsive`. With Hertz's force `h d^(3/2)` and `F_c = c d` the largest pull is
//! `4 c^3 / (27 h^2)`, at `d = (2 c / (3 h))^2`: a contact that nothing presses holds next to nothing.
//!
//! # Source
//!
//! `[Kloss2012]`: the SJKR model of LIGGGHTS, as its documentation states it (`cohesion sjkr`). The area of the circle of
//! intersection of two spheres is elementary geometry.

use crate::{Error, in_range};
use std::f64::consts::TAU;

/// The law of one pair of surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearCohesion {
    /// k, J/m³.
    energy_density: f64,
}

impl LinearCohesion {
    /// Checks the cohesion energy density, J/m³.
    ///
    /// # Errors
    ///
    /// A density outside 0 to 1e12 J/m³.
    pub fn new(energy_density: f64) -> Result<Self, Error> {
        let energy_density = in_range(
            "cohesion energy density in J/m³",
            energy_density,
            0.0,
            1e12,
            "0 J/m³ to 1e12 J/m³",
        )?;
        Ok(Self { energy_density })
    }

    /// Attraction of a contact of a reduced radius and an overlap (m), N; 0 across a gap.
    pub fn attraction(&self, reduced_radius: f64, overlap: f64) -> f64 {
        self.energy_density * contact_area(reduced_radius, overlap)
    }

    /// Energy that parting the surfaces of a contact takes, J.
    pub fn energy(&self, reduced_radius: f64, overlap: f64) -> f64 {
        0.5 * self.attraction(reduced_radius, overlap) * overlap
    }
}

/// Area of the circle in which two spheres of a reduced radius and an overlap (m) intersect, m²; 0 across a gap.
pub fn contact_area(reduced_radius: f64, overlap: f64) -> f64 {
    TAU * reduced_radius * overlap.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::{LinearCohesion, contact_area};
    use std::f64::consts::PI;

    /// Spheres of radii r and s at distance D cut in a circle whose radius Heron's formula gives; the area to first order is off by
    /// half of the overlap over the smaller radius at most, and by that squared.
    #[test]
    fn area_is_that_of_the_circle_of_intersection() {
        for (r, s) in [(1e-3_f64, 1e-3_f64), (1e-3, 3e-3), (1e-3, 1e4)] {
            let overlap = 1e-5;
            let (sum, distance) = (r + s, r + s - overlap);
            let exact = PI * overlap * (sum + distance) * (distance - r + s) * (distance + r - s)
                / (4.0 * distance * distance);
            let area = contact_area(r * s / sum, overlap);
            let off = 0.5 * overlap / r;
            assert!(
                (area / exact - 1.0).abs() < off + 2.0 * off * off,
                "{r} m and {s} m: {area} for {exact} m2"
            );
        }
    }

    #[test]
    fn spheres_apart_do_not_attract() {
        let law = LinearCohesion::new(1e4).unwrap();
        assert_eq!(law.attraction(1e-3, -1e-6), 0.0);
        assert!(
            LinearCohesion::new(-1.0).is_err(),
            "repulsion is not a cohesion"
        );
    }

    /// The energy is the work of the attraction along the overlap: a sum of 1000 midpoints of a straight line, which is exact.
    #[test]
    fn energy_is_the_work_of_the_attraction() {
        let law = LinearCohesion::new(1e4).unwrap();
        let step = 1e-8;
        let work: f64 = (0..1000)
            .map(|k| law.attraction(1e-3, (f64::from(k) + 0.5) * step) * step)
            .sum();
        assert!(
            (work / law.energy(1e-3, 1e-5) - 1.0).abs() < 1e-12,
            "{work} J"
        );
    }
}
