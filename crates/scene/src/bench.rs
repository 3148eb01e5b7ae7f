//! What a bench test of one kind of seed takes from a scene.

use crate::interactions::interactions;
use crate::time_step::TimeSteps;
use crate::{Error, FillingLibrary, Scene, SeedBody};
use dem_solver::Interaction;
use std::sync::Arc;

/// How much finer than in a drum a bench test is stepped. A drum's step puts about three steps into a
/// hard contact, which is enough for a bed but not for the rebound of a single seed: with it some drops
/// came back higher than they fell (restitution up to 1.06 of 40 drops).
const FINER: f64 = 20.0;

/// A seed, and how it meets its like and a plate.
#[derive(Debug, Clone)]
pub struct BenchParts {
    /// The seed.
    pub body: Arc<SeedBody>,
    /// Interactions of the materials seed (0) and plate (1), row by row.
    pub interactions: Vec<Interaction>,
    /// Which mass enters the dashpots.
    pub dashpot_mass: dem_solver::DashpotMass,
    /// Time step that resolves the contacts, s.
    pub time_step: f64,
    /// Gravity, m/s².
    pub gravity: f64,
}

impl BenchParts {
    /// Takes a kind of seed and a plate by the name of its material; the seeds' own material stands
    /// for a plate of seeds.
    ///
    /// # Errors
    ///
    /// A seed or material that the scene does not define, contacts that are missing.
    pub fn new(
        scene: &Scene,
        library: &FillingLibrary,
        seed: &str,
        plate: &str,
    ) -> Result<Self, Error> {
        let undefined = |what, name: &str, known: Vec<&str>| Error::Undefined {
            file: scene.file.clone(),
            what,
            name: name.to_owned(),
            known: known.join(", "),
        };
        let names = || scene.seed.iter().map(|s| s.name.as_str()).collect();
        let kind = scene
            .seed
            .iter()
            .find(|s| s.name == seed)
            .ok_or_else(|| undefined("seed", seed, names()))?;
        if !scene.material.contains_key(plate) {
            let known = scene.material.keys().map(String::as_str).collect();
            return Err(undefined("material", plate, known));
        }
        if scene.contact_of(&kind.material, plate).is_none() {
            return Err(Error::MissingContact {
                file: scene.file.clone(),
                pair: format!("{}-{plate}", kind.material),
            });
        }
        let body = library.body(scene, kind)?;
        let single = Scene {
            seed: vec![kind.clone()],
            ..scene.clone()
        };
        let steps = TimeSteps::of(&single, std::slice::from_ref(&body))?;
        let bodies = std::slice::from_ref(&body);
        Ok(Self {
            interactions: interactions(&single, bodies, &[&kind.material, plate])?,
            body,
            dashpot_mass: scene.model.dashpot_mass,
            time_step: steps.settling / FINER,
            gravity: scene.model.gravity_m_s2,
        })
    }
}
