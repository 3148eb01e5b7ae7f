//! Which settings of a scene a parameter represents.

use crate::scene_simulator::Error;
use scene::{Override, Scene, SettingKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The settings that the symbol of a parameter represents.
///
/// ```
/// use simulators::scene_simulator::Binding;
/// let binding = Binding::of_path("contact.seed-seed.static_friction");
/// let changes = binding.changes(|_| true, 0.4);
/// assert_eq!((changes[0].name.as_str(), changes[0].value.as_str()), ("contact.seed-seed.static_friction", "0.4"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Binding {
    /// Dotted paths, such as `contact.seed-seed.static_friction`; all get the same number, in every scene that
    /// has them.
    pub paths: Vec<String>,
    /// Unit of the number where the settings are quantities, such as `rpm`; `None` if they are plain numbers.
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

    /// The changes of a scene that a value of the parameter makes: one for each path that the scene has.
    pub fn changes(&self, has: impl Fn(&str) -> bool, value: f64) -> Vec<Override> {
        let paths = self.paths.iter().filter(|path| has(path));
        let change = |path: &String| Override::number(path, value, self.unit.as_deref());
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
    let setting = match scene.named_setting(path) {
        // A short name that brings its own unit takes no other.
        Ok(setting) if setting.unit.is_none() => setting,
        Ok(_) | Err(scene::Error::UnknownSetting { .. }) => return Ok(false),
        Err(error) => return Err(error),
    };
    let requirement = match (setting.kind, unit) {
        (SettingKind::Number, None) | (SettingKind::Quantity, Some(_)) => return Ok(true),
        (SettingKind::Number, Some(_)) => "a number without unit",
        (SettingKind::Quantity, None) => "a number with its unit",
        (SettingKind::Text | SettingKind::Switch, _) => "a setting that takes a number",
    };
    Err(scene::Error::BadValue {
        name: format!("{}: {}", scene.file, setting.path),
        value: unit.map_or("a number".into(), |unit| format!("a number in {unit}")),
        requirement: format!("{requirement}: it is {}", setting.value),
    })
}
