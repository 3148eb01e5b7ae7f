//! Cohesion as a constant attraction while two surfaces touch.
//!
//! # Formula
//!
//! ```text
//! F_n = F_repulsive - F_c     F_c = Bo m g
//! ```
//!
//! Bo is the granular Bond number: attraction of one contact over the weight of one body. It
//! represents a liquid bridge or a tacky coat whose range is small against the body. The friction
//! limit stays `mu F_repulsive`: the attraction loads the contact, the repulsion carries it.
//!
//! # Source
//!
//! `[Castellanos2005]` for the Bond number as the measure of cohesion of grains.

use crate::{Error, in_range};

/// Attraction of one contact, Bo m g, N; mass in kg, gravity in m/s².
pub fn attraction(bond_number: f64, body_mass: f64, gravity: f64) -> f64 {
    bond_number * body_mass * gravity
}

/// Refuses an attraction (N) that is negative or no number.
///
/// # Errors
///
/// A value outside 0 to 1e9 N.
pub fn check(attraction: f64) -> Result<f64, Error> {
    in_range("attraction in N", attraction, 0.0, 1e9, "0 N to 1e9 N")
}

#[cfg(test)]
mod tests {
    use super::{attraction, check};

    #[test]
    fn repulsion_is_no_attraction() {
        assert!(check(-1e-6).is_err() && check(f64::NAN).is_err(), "refused");
        assert_eq!(check(2e-3), Ok(2e-3));
    }

    /// A seed of 94.5 mg at Bond number 1 can hang from one contact: F = its weight.
    #[test]
    fn bond_number_one_carries_the_weight() {
        assert!(
            (attraction(1.0, 94.5e-6, 9.81) - 9.27045e-4).abs() < 1e-18,
            "rounding only"
        );
    }
}
