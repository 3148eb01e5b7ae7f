//! Effects that the diagnosis may search.

use crate::file::EffectEntry;
use crate::measured::Resolved;
use crate::scenes::{Models, Scenes};
use inference::{EffectProbe, Role};
use scene::Scene;
use simulators::effects::{Effect, apply, find, names};
use std::collections::BTreeMap;

/// Halvings of a range until its end is known well enough.
const BISECTIONS: usize = 20;

/// Effects to search, and those that no measured scene can carry, with the reason.
#[derive(Debug, Default)]
pub(crate) struct Searched {
    /// Effects that a measured scene can carry, with the models that cannot.
    pub(crate) probes: Vec<EffectProbe>,
    /// The others.
    pub(crate) not_applicable: BTreeMap<String, String>,
}

/// Why a scene cannot carry an effect of an amplitude; `None` if it can.
fn refusal(scenes: &Scenes<'_>, scene: &Scene, effect: &str, amplitude: f64) -> Option<String> {
    let mut scene = scene.clone();
    match apply(&mut scene, effect, amplitude, &scenes.fillings) {
        Err(error) => Some(error.to_string()),
        Ok(()) => Some(scenes.peer()?.check(&scene).err()?.to_string()),
    }
}

/// Finds the effects to search, and which models, candidates for the next measurement included, cannot carry each. If the file names
/// none, it is the whole library, or all effects of a program of the user. Unknown names were refused before.
pub(crate) fn search(resolved: &Resolved, scenes: &Scenes<'_>, candidates: &Models) -> Searched {
    let (models, measurements) = (&resolved.models, &resolved.measurements);
    let named = scenes.file.effects.search.as_ref();
    let mut found = Searched::default();
    if scenes.file.is_of_command() {
        let wanted = |name| named.is_none_or(|names| names.contains(name));
        let own = scenes.file.effect.iter().filter(|e| wanted(&e.name));
        let probe = |e: &EffectEntry| EffectProbe {
            name: e.name.clone(),
            probe: e.probe,
            range: e.range,
            absent: BTreeMap::new(),
        };
        found.probes = own.map(probe).collect();
        return found;
    }
    let all = named.cloned().unwrap_or_else(names);
    let is_judged = |k: &usize| {
        let mut all = measurements.iter();
        all.any(|m| m.model == *k && m.role != Role::Show)
    };
    let judged: Vec<usize> = (0..models.setups.len()).filter(is_judged).collect();
    for name in all {
        let Ok(effect) = find(&name) else { continue };
        let Effect { probe, range, .. } = *effect;
        let refusal_at = |scene: &Scene, amplitude| refusal(scenes, scene, &name, amplitude);
        let absent_of = |models: &Models, numbers: &[usize]| -> BTreeMap<String, String> {
            let with_reason = |&k: &usize| {
                let reason = refusal_at(models.setups[k].scene()?, probe)?;
                Some((models.models[k].name.clone(), reason))
            };
            numbers.iter().filter_map(with_reason).collect()
        };
        let mut absent = absent_of(models, &judged);
        if absent.len() < judged.len() {
            let offered: Vec<usize> = (0..candidates.setups.len()).collect();
            let carries = |&&k: &&usize| !absent.contains_key(&models.models[k].name);
            let carrying: Vec<usize> = judged.iter().filter(carries).copied().collect();
            let bears = |amplitude: f64| {
                let mut scenes = carrying.iter().filter_map(|&k| models.setups[k].scene());
                scenes.all(|scene| refusal_at(scene, amplitude).is_none())
            };
            let range = range.map(|end| furthest(probe, end, bears));
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

/// The amplitude nearest to an end of a range that is borne, by bisection from one that is.
///
/// A scene that has something of the effect already, as declared water, has less room for it than the library gives.
fn furthest(borne: f64, end: f64, bears: impl Fn(f64) -> bool) -> f64 {
    if bears(end) {
        return end;
    }
    let (mut borne, mut beyond) = (borne, end);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (borne + beyond);
        if bears(middle) {
            borne = middle;
        } else {
            beyond = middle;
        }
    }
    borne
}

#[cfg(test)]
mod tests {
    use super::furthest;

    /// A limit of 7.5 inside a range of 0 to 15 is found to 15 / 2^20, and from the side that is borne.
    #[test]
    fn a_range_ends_where_a_scene_does() {
        let found = furthest(0.05, 15.0, |x| x <= 7.5);
        assert!((7.5 - 15.0 / 1_048_576.0..=7.5).contains(&found), "{found}");
        assert_eq!(furthest(0.05, 0.0, |x| x <= 7.5), 0.0);
    }
}
