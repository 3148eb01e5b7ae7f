//! Which settings of a scene a parameter stands for.

use crate::scene_simulator::Error;
use scene::{NumberChange, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The settings that the symbol of a parameter stands for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Binding {
    /// Dotted paths, such as `contact.seed-seed.static_friction`; all get the same number, in every scene that
    /// has them.
    pub paths: Vec<String>,
    /// Unit of the number where the settings are quantities, such as `rpm`; none where they are plain numbers.
    pub unit: Option<String>,
}

impl Binding {
    /// The plain number at one dotted path, for parameters that are named by their path.
    pub fn of_path(path: &str) -> Self {
        Self {
            paths: vec![path.to_owned()],
            unit: None,
        }
    }

    /// The changes of a scene that the value of the parameter makes: one for each path that the scene has.
    pub(crate) fn changes(&self, present: &[String], value: f64) -> Vec<NumberChange> {
        let paths = self.paths.iter().filter(|path| present.contains(path));
        let change = |path: &String| NumberChange {
            path: path.clone(),
            value,
            unit: self.unit.clone(),
        };
        paths.map(change).collect()
    }
}

/// The paths of all bindings that a scene has.
///
/// # Errors
///
/// A setting that takes no number, or none with that unit; a short name of several settings.
pub(crate) fn present_paths(
    scene: &Scene,
    bindings: &BTreeMap<String, Binding>,
) -> Result<Vec<String>, Error> {
    let mut present = Vec::new();
    for (symbol, binding) in bindings {
        for path in &binding.paths {
            let has = has_setting(scene, path, binding.unit.as_deref());
            if has.map_err(|source| Error::Setting {
                symbol: symbol.clone(),
                source: Box::new(source),
            })? {
                present.push(path.clone());
            }
        }
    }
    Ok(present)
}

/// Whether a scene has a setting that takes a number, with a unit where one is given.
///
/// # Errors
///
/// A setting that takes no number, or none with that unit; a short name of several settings.
pub(crate) fn has_setting(
    scene: &Scene,
    path: &str,
    unit: Option<&str>,
) -> Result<bool, scene::Error> {
    let there = scene.number(path);
    // The number that stands there can always be put there again.
    let probe = NumberChange {
        path: path.to_owned(),
        value: there.unwrap_or(1.0),
        unit: unit.map(str::to_owned),
    };
    match scene.with_numbers(&[probe]) {
        Ok(_) => Ok(true),
        Err(scene::Error::UnknownSetting { .. }) => Ok(false),
        // Whether 1 of the unit is valid is the question of a request.
        Err(_) if there.is_none() && unit.is_some() => Ok(true),
        Err(error) => Err(error),
    }
}
