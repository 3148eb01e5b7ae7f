//! Resistance of the liquid in a bridge: against being squeezed out or drawn in, and against shear.
//!
//! # Formula
//!
//! With the gap D, not less than the height of the roughness, bridge volume V, viscosity h, reduced radius R*,
//! mean radius R = 2 R*:
//!
//! ```text
//! F_n = 6 pi h R*² X² / D  v_n                         X = 1 - 1 / sqrt(1 + 2 V / (pi R D²))
//! F_t = 6 pi h R* (8/15 ln(R* / D) + 0.9588)  v_t      0 where the bracket is below 0
//! ```
//!
//! Both act against the relative velocity of the surfaces at the contact, as long as the bridge lives: while the
//! solids are pressed together D is the roughness, for liquid stays in the valleys. X is 1 in a sea of liquid and falls
//! where the bridge is narrow against its height. A body that rolls without sliding feels no `F_t`: what the
//! liquid in front of a rolling body takes is left out. Lengths in m, volume in m³, viscosity in Pa s.
//!
//! # Source
//!
//! `F_n` in a sea of liquid: `[AdamsPerchard1985]`, as `[ShiMcCarthy2008, eq. 40]` write it; X for a finite volume:
//! `[Pitois2000]`, there `3/2 pi h R² X² / D` for equal spheres. `F_t`: a sphere beside a wall
//! `[GoldmanCoxBrenner1967]`, taken over to two spheres by the reduced radius `[Nase2001]`,
//! `[ShiMcCarthy2008, eq. 41]`. That `F_t` knows no volume is theirs.

#![expect(
    clippy::inline_always,
    reason = "the loop over contacts is vectorised only when inlined"
)]

use crate::{Error, in_range};
use std::f64::consts::PI;

/// Viscosity of the liquid and roughness of the surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscousBridge {
    /// Viscosity, Pa s.
    viscosity: f64,
    /// Least gap, m.
    roughness: f64,
}

impl ViscousBridge {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// A viscosity outside 0 to 1000 Pa s, a roughness outside 1 nm to 1 mm.
    pub fn new(viscosity: f64, roughness: f64) -> Result<Self, Error> {
        Ok(Self {
            viscosity: in_range(
                "viscosity in Pa s",
                viscosity,
                0.0,
                1000.0,
                "0 Pa s to 1000 Pa s",
            )?,
            roughness: in_range("roughness in m", roughness, 1e-9, 1e-3, "1e-9 m to 0.001 m")?,
        })
    }

    /// The resistance between two surfaces of a mean radius (m); none without viscosity.
    pub fn between(&self, radius: f64) -> Option<ViscousForce> {
        let reduced_radius = 0.5 * radius;
        (self.viscosity > 0.0).then_some(ViscousForce {
            stokes: 6.0 * PI * self.viscosity * reduced_radius,
            reduced_radius,
            roughness: self.roughness,
        })
    }
}

/// The resistance between two given surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscousForce {
    /// 6 pi h R*, kg/s.
    stokes: f64,
    /// Reduced radius, m.
    reduced_radius: f64,
    /// Least gap, m.
    roughness: f64,
}

impl ViscousForce {
    /// Force against the speed along the normal and along the surface, over that speed, kg/s; of a bridge of a volume
    /// (m³) at a gap (m, 0 or less while the surfaces touch).
    #[inline(always)]
    pub fn resistance(&self, gap: f64, volume: f64) -> [f64; 2] {
        let gap = gap.max(self.roughness);
        let height = self.reduced_radius / gap;
        let wide = 1.0 + volume / (PI * self.reduced_radius * gap * gap);
        let filled = 1.0 - 1.0 / wide.sqrt();
        let sheared = (8.0 / 15.0 * height.ln() + 0.9588).max(0.0);
        [
            self.stokes * height * filled * filled,
            self.stokes * sheared,
        ]
    }

    /// The greatest that [`Self::resistance`] can be, whatever the volume and the gap, kg/s.
    pub fn most(&self) -> [f64; 2] {
        self.resistance(self.roughness, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::ViscousBridge;
    use std::f64::consts::PI;

    /// Two spheres of 1 mm in a sea of water, 10 um apart: 6 pi h R*²/D = 4.71e-4 kg/s, and 6 pi h R* times the
    /// bracket with ln 50. A bridge of finite volume has less, and a dry one nothing. Rounding only.
    #[test]
    fn resistance_has_its_closed_forms() {
        let force = ViscousBridge::new(1e-3, 1e-6)
            .unwrap()
            .between(1e-3)
            .unwrap();
        let [normal, along] = force.resistance(1e-5, f64::INFINITY);
        let expected = 6.0 * PI * 1e-3 * 0.25e-6 / 1e-5;
        assert!((normal / expected - 1.0).abs() < 1e-14, "{normal} kg/s");
        let expected = 6.0 * PI * 1e-3 * 0.5e-3 * (8.0 / 15.0 * 50_f64.ln() + 0.9588);
        assert!((along / expected - 1.0).abs() < 1e-14, "{along} kg/s");
        // 2 V / (pi R D²) = 3 makes X = 1/2.
        let volume = 1.5 * PI * 1e-3 * 1e-10;
        let [half, _] = force.resistance(1e-5, volume);
        assert!((half / normal - 0.25).abs() < 1e-14, "{half} kg/s");
        assert_eq!(force.resistance(1e-5, 0.0)[0], 0.0, "no liquid");
    }

    /// Surfaces never come nearer than their roughness, and one that is pressed in resists as much as at it. Far away
    /// the bracket would fall below 0: nothing drives a body.
    #[test]
    fn resistance_ends_at_the_roughness_and_never_drives() {
        let force = ViscousBridge::new(1e-3, 1e-5)
            .unwrap()
            .between(1e-3)
            .unwrap();
        let most = force.most();
        assert_eq!(force.resistance(1e-7, f64::INFINITY), most);
        assert_eq!(force.resistance(-1e-4, f64::INFINITY), most);
        assert_eq!(force.resistance(1e-2, f64::INFINITY)[1], 0.0);
    }

    #[test]
    fn impossible_liquids_are_refused() {
        assert!(ViscousBridge::new(-1.0, 1e-6).is_err(), "viscosity");
        assert!(ViscousBridge::new(1e-3, 0.0).is_err(), "roughness");
        let without = ViscousBridge::new(0.0, 1e-6).unwrap();
        assert_eq!(without.between(1e-3), None);
    }
}
