//! A small bridge of liquid between two surfaces: it pulls, and it resists being stretched and sheared.
//!
//! # Formula
//!
//! With the gap s (0 while the surfaces touch), bridge volume V, surface tension g, angle of contact
//! t, mean radius R = 2 R*:
//!
//! ```text
//! F = 2 pi R g cos(t) / (1 + 1.05 s' + 2.5 s'^2)     s' = s sqrt(R / V)
//! s_rupture = (1 + t/2) V^(1/3)
//! ```
//!
//! The bridge forms when the solid surfaces touch, not when their films of liquid do, and breaks when the gap
//! passes `s_rupture`: between the two a pair that comes near feels nothing and one that parts is held. The
//! volume belongs to the contact at its moment; whoever holds the bodies deals it out. The force acts along the
//! normal, and with it what [`viscous_bridge`](crate::viscous_bridge) says. Lengths in m, volume in m³, tension in
//! N/m, angle in rad.
//!
//! The closed form is one for little liquid, V up to about a tenth of R³; beyond it and where bridges
//! of neighbours merge it is an extrapolation.
//!
//! # Source
//!
//! `[Willett2000]`, closed form for small bridges, there with half the gap (2.1 and 10 instead of
//! 1.05 and 2.5); unequal spheres by the mean radius. Rupture: `[Lian1993]`.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::viscous_bridge::ViscousForce;
use crate::{Error, in_range};
use std::f64::consts::PI;

/// Least volume with which the shape of a bridge is computed, m³: far below a molecule, above what a division
/// bears.
const LEAST_VOLUME: f64 = 1e-30;

/// Properties of liquid and surfaces that all their bridges share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapillaryBridge {
    /// Surface tension, N/m.
    tension: f64,
    /// Angle of contact, rad.
    contact_angle: f64,
}

impl CapillaryBridge {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// A surface tension outside 0 to 1 N/m, an angle of contact outside 0 to pi/2.
    pub fn new(tension: f64, contact_angle: f64) -> Result<Self, Error> {
        Ok(Self {
            tension: in_range(
                "surface tension in N/m",
                tension,
                0.0,
                1.0,
                "0 N/m to 1 N/m",
            )?,
            contact_angle: in_range(
                "angle of contact in rad",
                contact_angle,
                0.0,
                0.5 * PI,
                "0 rad to pi/2 rad",
            )?,
        })
    }

    /// The bridge between two surfaces of a mean radius (m).
    pub fn between(&self, radius: f64) -> BridgeForce {
        BridgeForce {
            touching: 2.0 * PI * radius * self.tension * self.contact_angle.cos(),
            radius,
            rupture: 1.0 + 0.5 * self.contact_angle,
            viscous: None,
        }
    }
}

/// The force of a bridge that exists, between two given surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BridgeForce {
    /// Force while the surfaces touch, N.
    touching: f64,
    /// Mean radius R, m.
    radius: f64,
    /// Gap at which it breaks over the cube root of its volume.
    rupture: f64,
    /// How it resists motion; none for a liquid without viscosity.
    viscous: Option<ViscousForce>,
}

impl BridgeForce {
    /// The bridge with a share of its attraction, from 0 to 1: on rough surfaces little liquid does not
    /// fill the valleys.
    #[must_use]
    pub fn scaled(self, share: f64) -> Self {
        Self {
            touching: share * self.touching,
            ..self
        }
    }

    /// The bridge of a liquid with viscosity.
    #[must_use]
    pub fn with_viscosity(self, viscous: Option<ViscousForce>) -> Self {
        Self { viscous, ..self }
    }

    /// Gap at which a bridge of a volume (m³) breaks, m.
    #[inline(always)]
    pub fn rupture_gap(&self, volume: f64) -> f64 {
        self.rupture * volume.cbrt()
    }

    /// Attraction of a bridge of a volume (m³) at a gap (m, 0 or less while the surfaces touch), N. Whether there is a
    /// bridge at that gap is for the caller to know.
    #[inline(always)]
    pub fn attraction(&self, gap: f64, volume: f64) -> f64 {
        let s = gap.max(0.0) * (self.radius / volume.max(LEAST_VOLUME)).sqrt();
        self.touching / (1.0 + 1.05 * s + 2.5 * s * s)
    }

    /// How it resists motion; none for a liquid without viscosity.
    #[inline(always)]
    pub fn viscous(&self) -> Option<&ViscousForce> {
        self.viscous.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::CapillaryBridge;
    use std::f64::consts::PI;

    /// Water between two spheres of 1 mm that touch: 2 pi R g = 4.52e-4 N, whatever the volume, and half of it
    /// where the liquid wets at 60 degrees. Rounding only.
    #[test]
    fn force_at_touch_does_not_depend_on_the_volume() {
        for (angle, share) in [(0.0, 1.0), (PI / 3.0, 0.5)] {
            let bridge = CapillaryBridge::new(0.072, angle).unwrap().between(1e-3);
            for volume in [0.0, 1e-12, 1e-11] {
                let got = bridge.attraction(0.0, volume);
                let expected = share * 2.0 * PI * 1e-3 * 0.072;
                assert!((got / expected - 1.0).abs() < 1e-14, "{got}");
            }
        }
    }

    /// The gap of rupture is (1 + t/2) cbrt(V); up to there the force falls, and the more liquid, the slower.
    #[test]
    fn bridge_weakens_up_to_its_rupture() {
        let bridge = CapillaryBridge::new(0.072, 0.2).unwrap().between(1e-3);
        let gap = bridge.rupture_gap(1e-12);
        assert!((gap - 1.1e-4).abs() < 1e-18, "(1 + 0.1) cbrt(1e-12): {gap}");
        let near = bridge.attraction(0.5 * gap, 1e-12);
        let far = bridge.attraction(0.99 * gap, 1e-12);
        assert!(near > far && far > 0.0, "{near} N, then {far} N");
        assert!(bridge.attraction(0.99 * gap, 4e-12) > far, "more liquid");
    }

    #[test]
    fn impossible_liquids_are_refused() {
        assert!(CapillaryBridge::new(-0.1, 0.0).is_err(), "tension");
        assert!(CapillaryBridge::new(0.07, 2.0).is_err(), "angle");
    }
}
