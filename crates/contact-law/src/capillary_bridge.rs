//! Attraction by a small bridge of liquid between two surfaces.
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
//! The bridge forms when the surfaces touch and breaks when the gap passes `s_rupture`. The force
//! acts along the normal; viscosity is left out. Lengths in m, volume in m³, tension in N/m, angle
//! in rad.
//!
//! # Source
//!
//! `[Willett2000]`, closed form for small bridges, there with half the gap (2.1 and 10 in place of
//! 1.05 and 2.5); unequal spheres by the mean radius. Rupture: `[Lian1993]`.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::{Error, in_range};
use std::f64::consts::PI;

/// The liquid of all bridges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapillaryBridge {
    /// Surface tension, N/m.
    tension: f64,
    /// Angle of contact, rad.
    contact_angle: f64,
    /// Volume of one bridge, m³.
    volume: f64,
}

impl CapillaryBridge {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// A surface tension outside 0 to 1 N/m, an angle of contact outside 0 to pi/2, a volume that is
    /// not positive.
    pub fn new(tension: f64, contact_angle: f64, volume: f64) -> Result<Self, Error> {
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
            volume: in_range(
                "volume of a bridge in m³",
                volume,
                1e-24,
                1e-3,
                "1e-24 m³ to 0.001 m³",
            )?,
        })
    }

    /// Gap at which a bridge breaks, m.
    pub fn rupture_gap(&self) -> f64 {
        (1.0 + 0.5 * self.contact_angle) * self.volume.cbrt()
    }

    /// Attraction at a gap (m, 0 or less while the surfaces touch), N; 0 where there is no bridge.
    ///
    /// `bridged` tells whether there was a bridge in the step before.
    pub fn attraction(&self, gap: f64, reduced_radius: f64, bridged: bool) -> f64 {
        if gap > 0.0 && (!bridged || gap > self.rupture_gap()) {
            return 0.0;
        }
        self.between(2.0 * reduced_radius).attraction(gap)
    }

    /// The bridge between two surfaces of a mean radius (m).
    pub fn between(&self, radius: f64) -> BridgeForce {
        BridgeForce {
            touching: 2.0 * PI * radius * self.tension * self.contact_angle.cos(),
            inverse_length: (radius / self.volume).sqrt(),
            rupture_gap: self.rupture_gap(),
        }
    }
}

/// The force of a bridge that exists, between two given surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BridgeForce {
    /// Force while the surfaces touch, N.
    touching: f64,
    /// sqrt(R / V), 1/m.
    inverse_length: f64,
    /// Gap at which it breaks, m.
    rupture_gap: f64,
}

impl BridgeForce {
    /// The bridge with a share of its force, from 0 to 1: on rough surfaces little liquid does not
    /// fill the valleys.
    #[must_use]
    pub fn scaled(self, share: f64) -> Self {
        Self {
            touching: share * self.touching,
            ..self
        }
    }

    /// Gap at which the bridge breaks, m.
    pub fn rupture_gap(&self) -> f64 {
        self.rupture_gap
    }

    /// Attraction at a gap (m, 0 or less while the surfaces touch), N.
    #[inline(always)]
    pub fn attraction(&self, gap: f64) -> f64 {
        let s = gap.max(0.0) * self.inverse_length;
        self.touching / (1.0 + 1.05 * s + 2.5 * s * s)
    }
}

#[cfg(test)]
mod tests {
    use super::CapillaryBridge;
    use std::f64::consts::PI;

    /// Water between two spheres of 1 mm that touch: 2 pi R g = 4.52e-4 N, whatever the volume.
    #[test]
    fn force_at_touch_does_not_depend_on_the_volume() {
        for volume in [1e-12, 1e-11] {
            let bridge = CapillaryBridge::new(0.072, 0.0, volume).unwrap();
            let got = bridge.attraction(0.0, 0.5e-3, false);
            let expected = 2.0 * PI * 1e-3 * 0.072;
            assert!((got / expected - 1.0).abs() < 1e-14, "{got}");
        }
    }

    /// A bridge lives on between the touch and its rupture, and no bridge comes from nothing.
    #[test]
    fn bridge_forms_at_touch_and_breaks_at_its_gap() {
        let bridge = CapillaryBridge::new(0.072, 0.2, 1e-12).unwrap();
        let gap = bridge.rupture_gap();
        assert!((gap - 1.1e-4).abs() < 1e-18, "(1 + 0.1) cbrt(1e-12): {gap}");
        assert_eq!(bridge.attraction(0.5 * gap, 1e-3, false), 0.0);
        let near = bridge.attraction(0.5 * gap, 1e-3, true);
        let far = bridge.attraction(0.99 * gap, 1e-3, true);
        assert!(near > far && far > 0.0, "{near} N, then {far} N");
        assert_eq!(bridge.attraction(1.01 * gap, 1e-3, true), 0.0);
    }

    #[test]
    fn impossible_liquids_are_refused() {
        assert!(CapillaryBridge::new(-0.1, 0.0, 1e-12).is_err(), "tension");
        assert!(CapillaryBridge::new(0.07, 2.0, 1e-12).is_err(), "angle");
        assert!(CapillaryBridge::new(0.07, 0.0, 0.0).is_err(), "volume");
    }
}
