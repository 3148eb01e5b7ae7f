//! Elastic constants of one material and of a contact between two.

use crate::{Error, in_range};
use serde::{Deserialize, Serialize};

/// An isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Poisson's ratio, dimensionless.
    pub poisson_ratio: f64,
    /// Shear modulus, Pa.
    pub shear_modulus: f64,
}

/// Moduli of a contact between two materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectiveModuli {
    /// E*, Pa.
    pub young: f64,
    /// G*, Pa.
    pub shear: f64,
}

impl Material {
    /// Checks and builds a material.
    ///
    /// # Errors
    ///
    /// Poisson's ratio outside (-1, 0.5], a shear modulus that is not positive.
    pub fn new(poisson_ratio: f64, shear_modulus: f64) -> Result<Self, Error> {
        in_range(
            "Poisson's ratio",
            poisson_ratio,
            -0.999,
            0.5,
            "-0.999 to 0.5",
        )?;
        in_range(
            "shear modulus in Pa",
            shear_modulus,
            1.0,
            1e13,
            "1 Pa to 1e13 Pa",
        )?;
        Ok(Self {
            poisson_ratio,
            shear_modulus,
        })
    }

    /// Young's modulus E = 2 G (1 + nu), Pa.
    pub fn youngs_modulus(&self) -> f64 {
        2.0 * self.shear_modulus * (1.0 + self.poisson_ratio)
    }
}

/// Effective moduli of a contact.
///
/// # Formula
///
/// ```text
/// 1/E* = (1 - nu_i²)/E_i + (1 - nu_j²)/E_j
/// 1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j
/// ```
///
/// # Source
///
/// `[CottonStudy, eqs. 3 and 5]`; eq. 5 is printed without the reciprocal on the left.
pub fn effective_moduli(i: &Material, j: &Material) -> EffectiveModuli {
    let plane = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus();
    let slip = |m: &Material| (2.0 - m.poisson_ratio) / m.shear_modulus;
    EffectiveModuli {
        young: 1.0 / (plane(i) + plane(j)),
        shear: 1.0 / (slip(i) + slip(j)),
    }
}

#[cfg(test)]
mod tests {
    use super::{Material, effective_moduli};

    /// For two equal materials E* = E / (2 (1 - nu²)) and G* = G / (2 (2 - nu)); rounding only.
    #[test]
    fn equal_materials_give_the_textbook_moduli() {
        let seed = Material::new(0.14, 4.01e6).unwrap();
        let both = effective_moduli(&seed, &seed);
        let young = 9_142_800.0 / (2.0 * (1.0 - 0.14 * 0.14));
        assert!(
            (seed.youngs_modulus() - 9_142_800.0).abs() < 1e-6,
            "{}",
            seed.youngs_modulus()
        );
        assert!((both.young / young - 1.0).abs() < 1e-14, "{}", both.young);
        assert!(
            (both.shear / (4.01e6 / 3.72) - 1.0).abs() < 1e-14,
            "{}",
            both.shear
        );
    }

    #[test]
    fn impossible_constants_are_refused() {
        assert!(Material::new(0.6, 1e6).is_err(), "Poisson's ratio 0.6");
        assert!(Material::new(0.3, -1e6).is_err(), "negative modulus");
        assert!(Material::new(f64::NAN, 1e6).is_err(), "NaN");
    }
}
