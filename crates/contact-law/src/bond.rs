//! An elastic bond between two spheres, which may break.
//!
//! # Formula
//!
//! A bond is a short cylinder of radius `R_B`, A = pi `R_B`², J = 1/2 pi `R_B`⁴, with stiffnesses per
//! unit area (N/m³) `S_n` along and `S_t` across its axis. The study gives increments:
//!
//! ```text
//! dF_n = -v_n S_n A dt       dM_n = -w_n S_t J dt      (twisting)
//! dF_t = -v_t S_t A dt       dM_t = -w_t S_n J/2 dt    (bending)
//! ```
//!
//! Here the increments are taken as a whole: u and theta are the displacement and the rotation of
//! side i against side j since the bond was made, and
//!
//! ```text
//! F_n = -S_n A u_n    F_t = -S_t A u_t    M_n = -S_t J theta_n    M_t = -S_n (J/2) theta_t
//! ```
//!
//! so that no error of turning adds up over a run. A dashpot of damping ratio z acts on each part,
//! `c = 2 z sqrt(k m)` with the stiffness k of the part and the reduced mass m (moment of inertia for
//! the moments). A breakable bond ends where
//!
//! ```text
//! F_n tension / A + 2 |M_t| R_B / J > sigma_max      or      |F_t| / A + |M_n| R_B / J > tau_max
//! ```
//!
//! # Source
//!
//! `[PotyondyCundall2004]`; `[CottonStudy, eqs. 7 and 8]` with the stiffnesses of
//! twisting and bending in their places (printed swapped), the stresses in Pa, and the inequalities
//! as the condition of breakage. The study states no value for any of them.

use crate::{Error, in_range};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Stresses at which a bond breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondStrength {
    /// Tensile strength `sigma_max`, Pa.
    pub tension: f64,
    /// Shear strength `tau_max`, Pa.
    pub shear: f64,
}

/// Settings of bonds, as a user states them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondSettings {
    /// Normal stiffness per unit area `S_n`, N/m³.
    pub normal_stiffness: f64,
    /// Shear stiffness per unit area `S_t`, N/m³.
    pub shear_stiffness: f64,
    /// Radius of the bond `R_B`, m.
    pub radius: f64,
    /// Damping ratio z of each part.
    pub damping_ratio: f64,
    /// Strength; none for a bond that never breaks.
    pub strength: Option<BondStrength>,
}

/// The law of a bond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bond {
    /// Parameters.
    settings: BondSettings,
    /// Area of the cross-section A, m².
    area: f64,
    /// Polar moment of the cross-section J, m⁴.
    polar_moment: f64,
}

/// Deformation of a bond: side i against side j.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deformation {
    /// Unit vector along the bond, from i to j.
    pub axis: Vector3<f64>,
    /// Displacement since the bond was made, m.
    pub displacement: Vector3<f64>,
    /// Rotation since the bond was made, as a rotation vector, rad.
    pub rotation: Vector3<f64>,
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Angular velocity, rad/s.
    pub spin: Vector3<f64>,
}

/// Inertia that the dashpots of a bond see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedInertia {
    /// Reduced mass, kg.
    pub mass: f64,
    /// Reduced moment of inertia, kg m².
    pub moment: f64,
}

/// Force and moment of a bond on side i; side j feels the opposite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondLoad {
    /// Force, N.
    pub force: Vector3<f64>,
    /// Moment, N m.
    pub moment: Vector3<f64>,
    /// Whether the elastic part is above the strength.
    pub breaks: bool,
}

impl Bond {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// Stiffnesses, a radius or strengths that are not positive, a damping ratio outside 0 to 2.
    pub fn new(settings: &BondSettings) -> Result<Self, Error> {
        let stiffness = "0.001 N/m³ to 1e20 N/m³";
        for (name, value) in [
            (
                "normal stiffness of a bond in N/m³",
                settings.normal_stiffness,
            ),
            (
                "shear stiffness of a bond in N/m³",
                settings.shear_stiffness,
            ),
        ] {
            in_range(name, value, 1e-3, 1e20, stiffness)?;
        }
        in_range(
            "radius of a bond in m",
            settings.radius,
            1e-9,
            1.0,
            "1e-9 m to 1 m",
        )?;
        in_range(
            "damping ratio of a bond",
            settings.damping_ratio,
            0.0,
            2.0,
            "0 to 2",
        )?;
        if let Some(strength) = settings.strength {
            let range = "0.001 Pa to 1e14 Pa";
            in_range(
                "tensile strength in Pa",
                strength.tension,
                1e-3,
                1e14,
                range,
            )?;
            in_range("shear strength in Pa", strength.shear, 1e-3, 1e14, range)?;
        }
        Ok(Self {
            settings: *settings,
            area: PI * settings.radius.powi(2),
            polar_moment: 0.5 * PI * settings.radius.powi(4),
        })
    }

    /// Stiffnesses of stretching and shearing (N/m), twisting and bending (N m/rad).
    pub fn stiffnesses(&self) -> [f64; 4] {
        let s = &self.settings;
        [
            s.normal_stiffness * self.area,
            s.shear_stiffness * self.area,
            s.shear_stiffness * self.polar_moment,
            s.normal_stiffness * 0.5 * self.polar_moment,
        ]
    }

    /// Force and moment at a deformation.
    pub fn load(&self, deformation: &Deformation, inertia: &ReducedInertia) -> BondLoad {
        let d = deformation;
        let [stretch, shear, twist, bend] = self.stiffnesses();
        let split = |v: &Vector3<f64>| {
            let along = d.axis * v.dot(&d.axis);
            (along, v - along)
        };
        let (normal, tangential) = split(&d.displacement);
        let (twisting, bending) = split(&d.rotation);
        let force = [normal * -stretch, tangential * -shear];
        let moment = [twisting * -twist, bending * -bend];
        let breaks = self.is_above_strength(&force, &moment, &d.axis);

        let dashpot = |stiffness: f64, inertia: f64| {
            2.0 * self.settings.damping_ratio * (stiffness * inertia).sqrt()
        };
        let (normal, tangential) = split(&d.velocity);
        let (twisting, bending) = split(&d.spin);
        BondLoad {
            force: force[0] + force[1]
                - normal * dashpot(stretch, inertia.mass)
                - tangential * dashpot(shear, inertia.mass),
            moment: moment[0] + moment[1]
                - twisting * dashpot(twist, inertia.moment)
                - bending * dashpot(bend, inertia.moment),
            breaks,
        }
    }

    /// Whether the elastic force and moment on side i are above the strength.
    fn is_above_strength(
        &self,
        force: &[Vector3<f64>; 2],
        moment: &[Vector3<f64>; 2],
        axis: &Vector3<f64>,
    ) -> bool {
        let Some(strength) = self.settings.strength else {
            return false;
        };
        // A stretched bond pulls i towards j, that is along the axis.
        let tension = force[0].dot(axis) / self.area;
        let lever = self.settings.radius / self.polar_moment;
        let tensile = tension + 2.0 * moment[1].norm() * lever;
        let shear = force[1].norm() / self.area + moment[0].norm() * lever;
        tensile > strength.tension || shear > strength.shear
    }
}

#[cfg(test)]
mod tests {
    use super::{Bond, BondLoad, BondSettings, BondStrength, Deformation, ReducedInertia};
    use nalgebra::Vector3;
    use std::f64::consts::PI;

    const RADIUS: f64 = 1e-3;

    fn settings() -> BondSettings {
        BondSettings {
            normal_stiffness: 1e10,
            shear_stiffness: 4e9,
            radius: RADIUS,
            damping_ratio: 0.0,
            strength: Some(BondStrength {
                tension: 1e5,
                shear: 5e4,
            }),
        }
    }

    fn load(displacement: Vector3<f64>, rotation: Vector3<f64>) -> BondLoad {
        let deformation = Deformation {
            axis: Vector3::x(),
            displacement,
            rotation,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
        };
        let inertia = ReducedInertia {
            mass: 1e-6,
            moment: 1e-12,
        };
        Bond::new(&settings()).unwrap().load(&deformation, &inertia)
    }

    /// Each part by its own stiffness: a cylinder of length 1/S has the axial stiffness S A, shear
    /// S A, torsion S J and bending S I with I = J/2.
    #[test]
    fn each_part_has_the_stiffness_of_a_cylinder() {
        let (area, polar) = (PI * RADIUS.powi(2), 0.5 * PI * RADIUS.powi(4));
        let got = load(Vector3::new(1e-7, 2e-7, 0.0), Vector3::new(1e-5, 0.0, 2e-5));
        let force = Vector3::new(-1e10 * area * 1e-7, -4e9 * area * 2e-7, 0.0);
        let moment = Vector3::new(-4e9 * polar * 1e-5, 0.0, -1e10 * 0.5 * polar * 2e-5);
        assert!((got.force - force).norm() < 1e-12 * force.norm(), "{got:?}");
        assert!(
            (got.moment - moment).norm() < 1e-12 * moment.norm(),
            "{got:?}"
        );
    }

    /// Tension breaks at `S_n u = sigma_max`, u = 1e-5 m; compression does not. Bending alone breaks at
    /// the outer fibre, `S_n theta R_B = sigma_max`, theta = 0.01.
    #[test]
    fn bond_breaks_at_its_strength() {
        let pulled = |u: f64| load(Vector3::x() * -u, Vector3::zeros()).breaks;
        assert!(!pulled(0.99e-5) && pulled(1.01e-5), "tension");
        assert!(!pulled(-5e-5), "compression");
        let bent = |t: f64| load(Vector3::zeros(), Vector3::z() * t).breaks;
        assert!(!bent(0.0099) && bent(0.0101), "bending");
        let sheared = |u: f64| load(Vector3::y() * u, Vector3::zeros()).breaks;
        assert!(!sheared(1.24e-5) && sheared(1.26e-5), "shear");
        let twisted = |t: f64| load(Vector3::zeros(), Vector3::x() * t).breaks;
        assert!(!twisted(0.0124) && twisted(0.0126), "torsion");
    }

    #[test]
    fn impossible_bonds_are_refused() {
        let wrong = BondSettings {
            normal_stiffness: 0.0,
            ..settings()
        };
        assert!(Bond::new(&wrong).is_err(), "no stiffness");
        let wrong = BondSettings {
            radius: f64::NAN,
            ..settings()
        };
        assert!(Bond::new(&wrong).is_err(), "no radius");
    }
}
