//! The parameters and conventions of the self-test: one grain, one wall, two contacts.

use crate::Error;
use contact_law::hard_contact::{self, Impact};
use contact_law::material::{EffectiveModuli, effective_moduli};
use contact_law::{Material, NormalForceEnd, PairParameters, RollingLever, constant_attraction};
use dem_solver::DashpotMass;
use geometry::clump::volume_of_sphere;
use scene::{FillingLibrary, RollingLaw, Scene, SeedSettings};
use serde::{Deserialize, Serialize};

/// Deepest overlap of the impacts over the radius: contacts are resolved, and small against the sphere.
const DEEPEST: f64 = 0.01;

/// A contact between two materials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Coefficient of static friction.
    pub static_friction: f64,
    /// Coefficient of rolling friction.
    pub rolling_friction: f64,
    /// Attraction of a pair of spheres in contact, N.
    pub attraction_n: f64,
    /// Cohesion energy density, J/m³.
    pub cohesion_energy_density_j_m3: f64,
}

impl Contact {
    /// The coefficients as the law takes them.
    pub(crate) fn parameters(&self) -> PairParameters {
        PairParameters {
            restitution: self.restitution,
            static_friction: self.static_friction,
            rolling_friction: self.rolling_friction,
        }
    }
}

/// Parameters and conventions of a calibrated model, for spheres of one size and one wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Name of the material of the grains.
    pub grain: String,
    /// Name of the material of the wall.
    pub wall: String,
    /// Radius of the sphere with the mean volume of the grains, m.
    pub radius_m: f64,
    /// Density of that sphere if it has the mean mass of the grains, kg/m³.
    pub density_kg_m3: f64,
    /// Whether the grains are clumps, whose conventions then count.
    pub clumps: bool,
    /// Elastic constants of grain and wall.
    pub materials: [Material; 2],
    /// Contact of two grains, and of a grain with the wall.
    pub contacts: [Contact; 2],
    /// Mass in the dashpots of clumps.
    pub dashpot_mass: DashpotMass,
    /// End of the normal force.
    pub normal_force_end: NormalForceEnd,
    /// Law of rolling resistance.
    pub rolling_law: RollingLaw,
    /// Lever arm of rolling resistance of clumps.
    pub rolling_lever: RollingLever,
    /// Gravity, m/s².
    pub gravity_m_s2: f64,
}

impl Model {
    /// The model of a scene: its first material of grains, and the named wall, or the first one that has a contact with them.
    ///
    /// # Errors
    ///
    /// Laws that the self-test does not cover, an unknown wall, a grain whose size cannot be computed.
    pub fn of_scene(
        scene: &Scene,
        library: &FillingLibrary,
        wall: Option<&str>,
    ) -> Result<Self, Error> {
        refuse_other_laws(scene)?;
        let grain = scene.seed[0].material.clone();
        let wall = wall_of(scene, &grain, wall)?;
        let (radius_m, density_kg_m3, clumps, mass) = mean_grain(scene, library, &grain)?;
        let model = &scene.model;
        let weight = constant_attraction::attraction(model.bond_number, mass, model.gravity_m_s2);
        let contact = |other: &str| {
            let found = scene.contact_of(&grain, other);
            let found = found.ok_or_else(|| Error::NoContact(format!("{grain}-{other}")))?;
            Ok::<_, Error>(Contact {
                restitution: found.restitution.get(),
                static_friction: found.static_friction.get(),
                rolling_friction: found.rolling_friction.get(),
                attraction_n: weight + found.attraction_n.unwrap_or(0.0),
                cohesion_energy_density_j_m3: found.cohesion_energy_density_j_m3.unwrap_or(0.0),
            })
        };
        Ok(Self {
            radius_m,
            density_kg_m3,
            clumps,
            materials: [
                scene.material[&grain].constants()?,
                scene.material[&wall].constants()?,
            ],
            contacts: [contact(&grain)?, contact(&wall)?],
            dashpot_mass: model.dashpot_mass,
            normal_force_end: model.normal_force_end,
            rolling_law: model.rolling_law,
            rolling_lever: model.rolling_lever,
            gravity_m_s2: model.gravity_m_s2,
            grain,
            wall,
        })
    }

    /// Mass of a sphere, kg.
    pub fn mass(&self) -> f64 {
        self.density_kg_m3 * volume_of_sphere(self.radius_m)
    }

    /// Effective moduli of two grains, and of a grain and the wall.
    pub(crate) fn moduli(&self) -> [EffectiveModuli; 2] {
        let [grain, wall] = &self.materials;
        [
            effective_moduli(grain, grain),
            effective_moduli(grain, wall),
        ]
    }

    /// Whether a contact attracts.
    pub(crate) fn coheres(&self) -> bool {
        self.contacts
            .iter()
            .any(|c| c.attraction_n != 0.0 || c.cohesion_energy_density_j_m3 != 0.0)
    }

    /// Speed of the impacts, m/s: the overlap reaches 1 % of the radius, unless that takes more than ten times the speed
    /// `sqrt(g R)` of a fall by half a radius.
    pub(crate) fn impact_speed(&self) -> f64 {
        let moduli = self.moduli();
        let stiffest = moduli.iter().map(|m| m.young).fold(0.0, f64::max);
        let at_1_m_s = hard_contact::overlap(self.mass(), self.radius_m, &Impact::usual(stiffest));
        // The overlap grows with the power 4/5 of the speed.
        let speed = (DEEPEST * self.radius_m / at_1_m_s).powf(1.25);
        speed.min(10.0 * (self.gravity_m_s2.max(1.0) * self.radius_m).sqrt())
    }

    /// Duration of an elastic impact on the wall at a speed (m/s), s.
    pub(crate) fn contact_time(&self, speed: f64) -> f64 {
        let impact = Impact {
            speed,
            ..Impact::usual(self.moduli()[1].young.max(self.moduli()[0].young))
        };
        hard_contact::duration(self.mass(), self.radius_m, &impact)
    }
}

/// Mean radius (m), density (kg/m³) and mass (kg) of the grains of a material, and whether they are clumps.
fn mean_grain(
    scene: &Scene,
    library: &FillingLibrary,
    material: &str,
) -> Result<(f64, f64, bool, f64), Error> {
    let (mut number, mut mass, mut volume, mut clumps) = (0.0, 0.0, 0.0, false);
    for seed in scene.seed.iter().filter(|seed| seed.material == material) {
        let body = library.body(scene, seed)?;
        let count = scene.count_of(seed).max(1) as f64;
        number += count;
        mass += count * seed.mass_kg();
        volume += count * volume_of_sphere(body.volume_radius());
        clumps |= body.clump.spheres().len() > 1;
    }
    let radius = (volume / number / volume_of_sphere(1.0)).cbrt();
    let heaviest = scene
        .seed
        .iter()
        .map(SeedSettings::mass_kg)
        .fold(0.0, f64::max);
    Ok((radius, mass / volume, clumps, heaviest))
}

/// The wall of the self-test.
fn wall_of(scene: &Scene, grain: &str, wanted: Option<&str>) -> Result<String, Error> {
    let is_grain = |name: &str| scene.seed.iter().any(|seed| seed.material == name);
    let walls: Vec<&String> = scene
        .material
        .keys()
        .filter(|name| !is_grain(name) && scene.contact_of(grain, name).is_some())
        .collect();
    let found = match wanted {
        Some(name) => walls.iter().find(|wall| **wall == name),
        None => walls.first(),
    };
    let names = || {
        walls
            .iter()
            .map(|wall| wall.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    found
        .map(|wall| (*wall).clone())
        .ok_or_else(|| Error::NoWall {
            wanted: wanted.unwrap_or("any").to_owned(),
            walls: names(),
        })
}

/// Refuses laws that the self-test does not cover.
fn refuse_other_laws(scene: &Scene) -> Result<(), Error> {
    let model = &scene.model;
    let depends_on_rate = scene
        .contact
        .values()
        .any(|c| c.viscoelastic_damping.is_some() || c.friction_rate.is_some());
    let laws = [
        (model.liquid.is_some(), "model.liquid"),
        (model.bonds.is_some(), "model.bonds"),
        (model.whole_seed_damping != 0.0, "model.whole_seed_damping"),
        (
            model.dashpot_mass == DashpotMass::Shared,
            "model.dashpot_mass = \"shared\"",
        ),
        (
            depends_on_rate,
            "viscoelastic_damping or friction_rate of a contact",
        ),
    ];
    match laws.into_iter().find(|(uses, _)| *uses) {
        Some((_, law)) => Err(Error::Law {
            law,
            file: scene.file.clone(),
        }),
        None => Ok(()),
    }
}
