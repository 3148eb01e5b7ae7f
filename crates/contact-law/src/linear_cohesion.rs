//! Cohesion in proportion to the area of contact (simplified JKR).
//!
//! # Formula
//!
//! ```text
//! F_c = k A      A = pi ((r_i + r_j)^2 - D^2) (D^2 - (r_i - r_j)^2) / (4 D^2)
//! ```
//!
//! A is the circle in which two spheres at distance D intersect, k the cohesion energy density (J/m³). The force pulls while the spheres overlap and has no
//! memory; a resting contact stands where Hertz's force carries it.
//!
//! # Source
//!
//! The SJKR model of LIGGGHTS, as its documentation states it (`cohesion sjkr`); the area of the
//! circle of intersection of two spheres is elementary geometry.

use crate::{Error, in_range};
use std::f64::consts::PI;

/// Area of the circle in which two spheres intersect, m²; 0 where they do not.
pub fn contact_area([radius_i, radius_j]: [f64; 2], distance: f64) -> f64 {
    let (sum, difference) = (radius_i + radius_j, radius_i - radius_j);
    let product =
        (sum * sum - distance * distance) * (distance * distance - difference * difference);
    if product > 0.0 {
        PI * product / (4.0 * distance * distance)
    } else {
        0.0
    }
}

/// Area of the circle in which a sphere and a plane intersect, m²; the overlap in m.
pub fn contact_area_at_plane(radius: f64, overlap: f64) -> f64 {
    PI * (overlap * (2.0 * radius - overlap)).max(0.0)
}

/// Attraction of a contact, N; density of the cohesion energy in J/m³, area in m².
///
/// # Errors
///
/// A density outside 0 to 1e12 J/m³.
pub fn attraction(energy_density: f64, area: f64) -> Result<f64, Error> {
    let density = in_range(
        "cohesion energy density in J/m³",
        energy_density,
        0.0,
        1e12,
        "0 J/m³ to 1e12 J/m³",
    )?;
    Ok(density * area)
}

#[cfg(test)]
mod tests {
    use super::{attraction, contact_area, contact_area_at_plane};
    use std::f64::consts::PI;

    /// Two equal spheres of radius r at distance D cut in a circle of radius sqrt(r² - D²/4); a
    /// sphere at a much larger one is a sphere at a plane.
    #[test]
    fn area_is_that_of_the_circle_of_intersection() {
        let got = contact_area([1.0, 1.0], 1.8);
        assert!((got - PI * (1.0 - 0.81)).abs() < 1e-14, "{got}");
        let large = contact_area([1.0, 1e7], 1e7 + 0.9);
        let plane = contact_area_at_plane(1.0, 0.1);
        assert!(
            (large / plane - 1.0).abs() < 1e-6,
            "{large} against {plane}"
        );
    }

    #[test]
    fn spheres_apart_do_not_attract() {
        assert_eq!(contact_area([1.0, 1.0], 2.1), 0.0);
        assert_eq!(contact_area_at_plane(1.0, -0.1), 0.0);
        assert!(attraction(-1.0, 1.0).is_err(), "repulsion is no cohesion");
    }
}
