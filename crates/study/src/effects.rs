//! Effects that the diagnosis may search.

use crate::scenes::{Models, Scenes};
use calibration::{EffectProbe, Measurement, Role};
use effect_library::{Description, apply, find, names};
use scene::Scene;
use std::collections::BTreeMap;

/// Effects to search, and those that no measured scene can carry, with the reason.
#[derive(Debug, Default)]
pub(crate) struct Searched {
    /// Effects that a measured scene can carry, with the models that cannot.
    pub(crate) probes: Vec<EffectProbe>,
    /// The others.
    pub(crate) not_applicable: BTreeMap<String, String>,
}

/// Finds them, and which models, candidates for the next measurement included, cannot carry each; all of the library where the file names none. Names that the library lacks were refused before.
pub(crate) fn search(
    named: Option<&[String]>,
    models: &Models,
    measurements: &[Measurement],
    scenes: &Scenes<'_>,
    candidates: &Models,
) -> Searched {
    let all = named.map_or_else(names, <[String]>::to_vec);
    let mut found = Searched::default();
    let judged: Vec<usize> = (0..models.scenes.len())
        .filter(|&k| {
            let mut all = measurements.iter();
            all.any(|m| m.model == k && m.role != Role::Show)
        })
        .collect();
    for name in all {
        let Ok(effect) = find(&name) else { continue };
        let Description { probe, range, .. } = effect.description();
        let refusal = |scene: &Scene| {
            let mut scene = scene.clone();
            match apply(&mut scene, &name, probe, &scenes.fillings) {
                Err(error) => Some(error.to_string()),
                Ok(()) => Some(scenes.peer?.check(&scene).err()?.to_string()),
            }
        };
        let absent_of = |models: &Models, numbers: &[usize]| -> BTreeMap<String, String> {
            let refused = numbers
                .iter()
                .filter_map(|&k| Some((k, refusal(&models.scenes[k])?)));
            refused
                .map(|(k, reason)| (models.models[k].name.clone(), reason))
                .collect()
        };
        let mut absent = absent_of(models, &judged);
        if absent.len() < judged.len() {
            let offered: Vec<usize> = (0..candidates.scenes.len()).collect();
            absent.extend(absent_of(candidates, &offered));
            found.probes.push(EffectProbe {
                name,
                probe,
                range,
                absent,
            });
        } else if let Some((model, reason)) = absent.first_key_value() {
            found
                .not_applicable
                .insert(name, format!("{model}: {reason}"));
        }
    }
    found
}
