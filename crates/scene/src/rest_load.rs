//! What loads the contacts of a bed at rest: weight and attraction.

use crate::interactions::{interactions, material_of};
use crate::{Error, RollingLaw, Scene, SeedBody, SeedSettings, Stiffness};
use contact_law::RollingLever;
use contact_law::material::effective_moduli;
use dem_solver::Interaction;
use std::sync::Arc;

/// Steps towards the overlap at which the spring carries weight and attraction. The attraction by area grows with the overlap at most,
/// so that each step leaves two thirds of the error.
const ROUNDS: usize = 100;

/// The most loaded contact of a kind of seed in a bed at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RestLoad {
    /// Weight of the seeds above and attraction, N.
    pub(crate) force: f64,
    /// Reduced radius, m.
    pub(crate) radius: f64,
    /// Overlap, m.
    pub(crate) overlap: f64,
    /// Effective shear modulus, Pa.
    pub(crate) shear: f64,
    /// Whether anything that the seed touches hinders its rolling by a torque of type A.
    pub(crate) rolls_with_constant_torque: bool,
    /// Greatest torque of that kind that the attraction of a contact alone gives, N m; 0 without attraction.
    pub(crate) torque_by_attraction: f64,
}

/// What a seed touches.
struct Touched {
    /// Law of the contact.
    law: Interaction,
    /// Rolling friction of type A; 0 where the contact has none.
    rolling: f64,
    /// Share of its radius, and of its lever arm, that counts in the contact: 1/2 between two seeds, 1 at a wall.
    share: f64,
}

impl RestLoad {
    /// That of a kind of seed, with as many seeds above it as lie on each other, `N^(1/3)`.
    ///
    /// # Formula
    ///
    /// `4/3 E* sqrt(R) d^(3/2) = N^(1/3) m g + s D² + F(d)`, with s the greatest stress of a loaded wall, D the diameter of the largest
    /// sphere, and F the greatest attraction of a contact of the seed at the overlap d, of
    /// constant size, by area or of a bridge of liquid. R is half of the largest radius in the spring, and in the attraction
    /// between seeds; at a wall the attraction takes the whole radius.
    ///
    /// # Errors
    ///
    /// Spheres that would be pressed by more than their radius, laws that are refused.
    pub(crate) fn of(
        scene: &Scene,
        bodies: &[Arc<SeedBody>],
        (seed, body): (&SeedSettings, &SeedBody),
    ) -> Result<Self, Error> {
        let counts = scene.seed.iter().map(|seed| scene.count_of(seed) as f64);
        let above = counts.sum::<f64>().cbrt();
        let material = material_of(scene, &seed.material, &seed.name)?;
        let moduli = effective_moduli(&material, &material);
        let radius = 0.5 * largest_radius(body);
        let stressed = scene.apparatus.device().greatest_stress() * (16.0 * radius * radius);
        let weight = above * body.clump.mass() * scene.model.gravity_m_s2 + stressed;
        let touched = touched_by(scene, bodies, seed)?;
        let largest = largest_radius(body);
        let pull = |touched: &Touched, overlap: f64| {
            touched
                .law
                .attraction(overlap, touched.share * largest, 0.0)
        };
        let force = |overlap: f64| {
            let pulls = touched.iter().map(|touched| pull(touched, overlap));
            weight + pulls.fold(0.0, f64::max)
        };
        let pressed = |force: f64| (0.75 * force / (moduli.young * radius.sqrt())).powf(2.0 / 3.0);
        let (mut overlap, deepest) = (pressed(force(0.0)), 2.0 * radius);
        for _ in 0..ROUNDS {
            overlap = pressed(force(overlap.min(deepest)));
        }
        if overlap > deepest {
            let carried = moduli.young * radius.sqrt() * deepest.powf(1.5) / 0.75;
            let factor = force(deepest) / carried;
            let loads = if force(deepest) > weight {
                "the weight of the bed and the attraction"
            } else {
                "the weight of the bed"
            };
            // The modulus that the scene states.
            let (key, modulus) = match scene.material[&seed.material].stiffness {
                Stiffness::ShearModulus(shear) => ("shear_modulus", shear.si()),
                Stiffness::YoungsModulus(young) => ("youngs_modulus", young.si()),
            };
            return Err(Error::BadValue {
                name: format!("material.{}.{key}", seed.material),
                value: format!("{modulus} Pa"),
                requirement: format!(
                    "at least {:.1e} Pa: {loads} would press spheres of seed '{}' by more than their radius",
                    factor * modulus,
                    seed.name
                ),
            });
        }
        let lever = match scene.model.rolling_lever {
            RollingLever::Centre => body.clump.bounding_radius(),
            RollingLever::Sphere => 2.0 * radius,
        };
        let torques = touched
            .iter()
            .map(|touched| touched.rolling * touched.share * pull(touched, overlap) * lever);
        Ok(Self {
            force: force(overlap),
            radius,
            overlap,
            shear: moduli.shear,
            rolls_with_constant_torque: touched.iter().any(|touched| touched.rolling > 0.0),
            torque_by_attraction: torques.fold(0.0, f64::max),
        })
    }
}

/// All that a kind of seed touches.
fn touched_by(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    seed: &SeedSettings,
) -> Result<Vec<Touched>, Error> {
    let own = seed.material.as_str();
    let pairs = scene.touching_pairs();
    let with_it = pairs.iter().filter(|pair| pair.contains(&own));
    let constant = scene.model.rolling_law == RollingLaw::ConstantTorque;
    let mut touched = Vec::new();
    for [a, b] in with_it {
        let other = if *a == own { b } else { a };
        let contact = scene.contact_of(own, other);
        let rolling = contact.map_or(0.0, |contact| contact.rolling_friction.get());
        // The second entry of the first row is the law between the two.
        let table = interactions(scene, bodies, &[own, other])?;
        // A wall may be of the material of the seeds.
        let is_wall = scene.wall_materials().contains(other);
        touched.push(Touched {
            law: table[1],
            rolling: if constant { rolling } else { 0.0 },
            share: if is_wall { 1.0 } else { 0.5 },
        });
    }
    Ok(touched)
}

/// Radius of the largest sphere at the surface of a seed, m.
pub(crate) fn largest_radius(body: &SeedBody) -> f64 {
    let radii = body.outer.spheres().iter().map(|s| s.radius);
    radii.fold(0.0, f64::max)
}
