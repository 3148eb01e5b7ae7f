//! The elastic constants of a material, as a scene file states them.

use contact_law::Material;
use input::quantity::{PoissonRatio, Pressure};
use serde::{Deserialize, Serialize};

/// Elastic constants of a material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stated", into = "Stated")]
pub struct MaterialSettings {
    /// Poisson's ratio.
    pub poisson_ratio: PoissonRatio,
    /// Stiffness.
    pub stiffness: Stiffness,
}

/// The modulus that a scene states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// Shear modulus G.
    ShearModulus(Pressure),
    /// Young's modulus E. It stays if Poisson's ratio changes, and the shear modulus follows.
    YoungsModulus(Pressure),
}

impl MaterialSettings {
    /// Shear modulus, Pa.
    ///
    /// # Formula
    ///
    /// `G = E / (2 (1 + nu))` for an isotropic material of Young's modulus E and Poisson's ratio nu.
    pub fn shear_modulus_pa(&self) -> f64 {
        match self.stiffness {
            Stiffness::ShearModulus(shear) => shear.si(),
            Stiffness::YoungsModulus(young) => {
                young.si() / (2.0 * (1.0 + self.poisson_ratio.get()))
            }
        }
    }

    /// Young's modulus, Pa: the stated one, or `E = 2 G (1 + nu)`.
    pub fn youngs_modulus_pa(&self) -> f64 {
        match self.stiffness {
            Stiffness::ShearModulus(shear) => 2.0 * shear.si() * (1.0 + self.poisson_ratio.get()),
            Stiffness::YoungsModulus(young) => young.si(),
        }
    }

    /// The constants as the laws of contacts take them.
    ///
    /// # Errors
    ///
    /// A Poisson's ratio or a modulus that no material has.
    pub fn constants(&self) -> Result<Material, contact_law::Error> {
        Material::new(self.poisson_ratio.get(), self.shear_modulus_pa())
    }

    /// The material with its modulus multiplied by a factor.
    ///
    /// # Errors
    ///
    /// A modulus that is not finite.
    pub fn stiffened(self, factor: f64) -> Result<Self, input::quantity::Error> {
        let times = |modulus: Pressure| Pressure::from_si(modulus.si() * factor);
        let stiffness = match self.stiffness {
            Stiffness::ShearModulus(shear) => Stiffness::ShearModulus(times(shear)?),
            Stiffness::YoungsModulus(young) => Stiffness::YoungsModulus(times(young)?),
        };
        Ok(Self { stiffness, ..self })
    }
}

/// The keys of a material in a file.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stated {
    /// Poisson's ratio.
    poisson_ratio: PoissonRatio,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shear_modulus: Option<Pressure>,
    /// Young's modulus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    youngs_modulus: Option<Pressure>,
}

impl TryFrom<Stated> for MaterialSettings {
    type Error = &'static str;

    fn try_from(stated: Stated) -> Result<Self, Self::Error> {
        let stiffness = match (stated.shear_modulus, stated.youngs_modulus) {
            (Some(shear), None) => Stiffness::ShearModulus(shear),
            (None, Some(young)) => Stiffness::YoungsModulus(young),
            (Some(_), Some(_)) => {
                return Err(
                    "shear_modulus and youngs_modulus are both stated; one follows from the other by \
                     E = 2 G (1 + nu): keep one of them",
                );
            }
            (None, None) => {
                return Err(
                    "neither shear_modulus nor youngs_modulus is stated; state one of them",
                );
            }
        };
        Ok(Self {
            poisson_ratio: stated.poisson_ratio,
            stiffness,
        })
    }
}

impl From<MaterialSettings> for Stated {
    fn from(material: MaterialSettings) -> Self {
        let (shear_modulus, youngs_modulus) = match material.stiffness {
            Stiffness::ShearModulus(shear) => (Some(shear), None),
            Stiffness::YoungsModulus(young) => (None, Some(young)),
        };
        Self {
            poisson_ratio: material.poisson_ratio,
            shear_modulus,
            youngs_modulus,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Error, Override, Scene};
    use std::path::Path;

    /// A sled of a ball on a plate whose seed has these elastic constants.
    fn sled(constants: &str, changes: &[(&str, &str)]) -> Result<Scene, Error> {
        let text = format!(
            r#"
            apparatus = {{ kind = "slider", plate = "steel", repeats = 2 }}
            seed = [{{ name = "ball", sphere = "6 mm", density = "1250 kg/m3", material = "pea" }}]
            material.pea = {{ {constants} }}
            material.steel = {{ poisson_ratio = 0.3, shear_modulus = "10 MPa" }}
            contact.pea-steel = {{ restitution = 0.6, static_friction = 0.3 }}
            "#
        );
        let changes: Vec<_> = changes
            .iter()
            .map(|(name, value)| Override {
                name: (*name).into(),
                value: (*value).into(),
            })
            .collect();
        Scene::from_text(&text, "sled.toml", Path::new(""), &changes)
    }

    /// `E = 13 MPa` at a ratio of 0.3 is `G = 5 MPa`, and at 0.25 it is `G = 5.2 MPa`: E stays. Rounding only.
    #[test]
    fn youngs_modulus_stands_for_the_shear_modulus() {
        let stated = r#"poisson_ratio = 0.3, youngs_modulus = "13 MPa""#;
        let shear = |scene: &Scene| scene.material["pea"].shear_modulus_pa();
        let scene = sled(stated, &[]).unwrap();
        assert!((shear(&scene) / 5e6 - 1.0).abs() < 1e-14);
        assert_eq!(scene.material["pea"].youngs_modulus_pa(), 13e6);
        let other = sled(stated, &[("material.pea.poisson_ratio", "0.25")]).unwrap();
        assert!((shear(&other) / 5.2e6 - 1.0).abs() < 1e-14);
        // What is written says what was stated.
        let json = serde_json::to_value(&scene).unwrap();
        assert_eq!(json["material"]["pea"]["youngs_modulus"], "13000000 Pa");
        assert_eq!(json["material"]["pea"].get("shear_modulus"), None);
    }

    /// A setting that states the other modulus takes the place of the one in the file, in either direction.
    #[test]
    fn one_modulus_takes_the_place_of_the_other() {
        let file = r#"poisson_ratio = 0.3, shear_modulus = "1 MPa""#;
        let by_young = sled(file, &[("youngs_modulus", "13 MPa")]);
        // Both materials can have it.
        assert!(matches!(by_young, Err(Error::AmbiguousSetting { .. })));
        let scene = sled(file, &[("material.pea.youngs_modulus", "13 MPa")]).unwrap();
        assert_eq!(scene.material["pea"].youngs_modulus_pa(), 13e6);
        let back = Override {
            name: "material.pea.shear_modulus".into(),
            value: "2 MPa".into(),
        };
        let back = scene.with(&[back]).unwrap();
        assert_eq!(back.material["pea"].shear_modulus_pa(), 2e6);
    }

    #[test]
    fn exactly_one_modulus_is_stated() {
        let both = sled(
            r#"poisson_ratio = 0.3, youngs_modulus = "13 MPa", shear_modulus = "5 MPa""#,
            &[],
        );
        let told = both.unwrap_err().to_string();
        assert!(
            told.contains("shear_modulus and youngs_modulus are both stated"),
            "{told}"
        );
        assert!(
            told.contains("sled.toml") && told.contains("line 4"),
            "{told}"
        );
        let none = sled("poisson_ratio = 0.3", &[]).unwrap_err().to_string();
        assert!(
            none.contains("neither shear_modulus nor youngs_modulus"),
            "{none}"
        );
    }
}
