//! Cohesion as a constant attraction while two surfaces touch.
//!
//! # Formula
//!
//! F_n = F_repulsive - F_c,  F_c = Bo m g
//!
//! Bo is the granular Bond number: attraction of one contact over the weight of one body. It
//! stands for a liquid bridge or a tacky coat whose range is small against the body. The friction
//! limit stays mu F_repulsive: the attraction loads the contact, and the repulsion carries it.
//!
//! # Source
//!
//! [CastellanosSoria2005] for the Bond number as the measure of cohesion of grains.

/// Attraction of one contact, Bo m g, N; mass in kg, gravity in m/s².
pub fn attraction(bond_number: f64, body_mass: f64, gravity: f64) -> f64 {
    bond_number * body_mass * gravity
}

#[cfg(test)]
mod tests {
    use super::attraction;

    /// A seed of 94.5 mg at Bond number 1 can hang from one contact: F = its weight.
    #[test]
    fn bond_number_one_carries_the_weight() {
        assert!((attraction(1.0, 94.5e-6, 9.81) - 9.27045e-4).abs() < 1e-18, "rounding only");
    }
}
