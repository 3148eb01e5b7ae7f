//! Effects that the diagnosis may search.

use crate::scenes::{Models, Scenes};
use calibration::{EffectProbe, Measurement, Role};
use effect_library::{Description, apply, find, names};
use std::collections::BTreeMap;

/// Effects to search, and those that a measured scene cannot carry, with the reason.
#[derive(Debug, Default)]
pub(crate) struct Searched {
    /// Effects that every measured scene can carry.
    pub(crate) probes: Vec<EffectProbe>,
    /// The others.
    pub(crate) not_applicable: BTreeMap<String, String>,
}

/// Finds them; all of the library where the file names none. Names that the library lacks were refused before.
pub(crate) fn search(
    named: Option<&[String]>,
    models: &Models,
    measurements: &[Measurement],
    scenes: &Scenes<'_>,
) -> Searched {
    let all = named.map_or_else(names, <[String]>::to_vec);
    let mut found = Searched::default();
    let judged = |model: usize| {
        let mut all = measurements.iter();
        all.any(|m| m.model == model && m.role != Role::Show)
    };
    for name in all {
        let Ok(effect) = find(&name) else { continue };
        let Description { probe, range, .. } = effect.description();
        let refusal = models.scenes.iter().enumerate().find_map(|(k, scene)| {
            if !judged(k) {
                return None;
            }
            let mut scene = scene.clone();
            let refused = match apply(&mut scene, &name, probe, &scenes.fillings) {
                Err(error) => error.to_string(),
                Ok(()) => scenes.peer?.check(&scene).err()?.to_string(),
            };
            Some(format!("{}: {refused}", models.models[k].name))
        });
        match refusal {
            Some(reason) => {
                found.not_applicable.insert(name, reason);
            }
            None => found.probes.push(EffectProbe { name, probe, range }),
        }
    }
    found
}
