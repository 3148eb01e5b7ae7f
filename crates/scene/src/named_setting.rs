//! Settings of a scene found by their names, for tables whose columns name them.

use crate::parse::{SHORT_NAMES, leaves, left_out, make_room, setting_at, whole_path};
use crate::{Error, Scene};
use toml::Value;

/// Kind of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SettingKind {
    /// A plain number.
    Number,
    /// A number with its unit.
    Quantity,
    /// A word, such as the name of a material or of a law.
    Text,
    /// `true` or `false`.
    Switch,
}

/// A setting of a scene, found by its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedSetting {
    /// Its dotted path.
    pub path: String,
    /// Unit that the name brings along, as `rpm` does; none with all others.
    pub unit: Option<&'static str>,
    /// Its kind.
    pub kind: SettingKind,
    /// Its value; an empty text for a quantity that the scene omits.
    pub value: Value,
}

impl Scene {
    /// Finds a setting by its dotted path or an unambiguous short name.
    ///
    /// # Errors
    ///
    /// A name that fits no setting, or several.
    pub fn named_setting(&self, name: &str) -> Result<NamedSetting, Error> {
        let mut table = self.table()?;
        let short = SHORT_NAMES.iter().find(|(short, _, _)| *short == name);
        let (path, unit) = match short {
            Some((_, path, unit)) => ((*path).to_owned(), Some(*unit)),
            None => (whole_path(&table, name, &self.file)?, None),
        };
        make_room(&mut table, &path);
        let Some(value) = setting_at(&table, &path).cloned() else {
            return Err(Error::UnknownSetting {
                name: name.to_owned(),
                file: self.file.clone(),
                near: path,
            });
        };
        let kind = match &value {
            Value::Integer(_) | Value::Float(_) => SettingKind::Number,
            Value::Boolean(_) => SettingKind::Switch,
            Value::String(text) if is_quantity(text) => SettingKind::Quantity,
            _ => SettingKind::Text,
        };
        Ok(NamedSetting {
            path,
            unit,
            kind,
            value,
        })
    }

    /// Dotted paths of all settings, those that the file leaves out and that can be set included, and short names.
    pub fn setting_names(&self) -> Vec<String> {
        let Ok(table) = self.table() else {
            return Vec::new();
        };
        let there = |path: &str| {
            let mut table = table.clone();
            make_room(&mut table, path);
            setting_at(&table, path).is_some()
        };
        let mut names = leaves(&table);
        for (path, _) in left_out(&table) {
            if there(&path) && !names.contains(&path) {
                names.push(path);
            }
        }
        let short = SHORT_NAMES.iter().filter(|(_, path, _)| there(path));
        names.extend(short.map(|(short, _, _)| (*short).to_owned()));
        names
    }
}

/// Whether a text is a number and its unit, or the empty place of a quantity.
fn is_quantity(text: &str) -> bool {
    text.is_empty()
        || text
            .split_once(' ')
            .is_some_and(|(number, unit)| number.parse::<f64>().is_ok() && !unit.is_empty())
}

#[cfg(test)]
mod tests {
    use super::SettingKind;
    use crate::parse::like_names;
    use crate::{Error, Override, Scene};
    use std::path::Path;

    /// A sled of a ball on a plate: no drum, so that nothing turns.
    const SLED: &str = r#"
        apparatus = { kind = "slider", plate = "steel", repeats = 2 }
        seed = [{ name = "ball", sphere = "6 mm", density = "1250 kg/m3", material = "pea" }]
        material.pea = { poisson_ratio = 0.3, shear_modulus = "0.5 MPa" }
        material.steel = { poisson_ratio = 0.3, shear_modulus = "10 MPa" }
        contact.pea-steel = { restitution = 0.6, static_friction = 0.3 }
    "#;

    #[test]
    fn a_name_finds_its_setting_and_what_that_takes() {
        let scene = Scene::from_text(SLED, "sled.toml", Path::new(""), &[]).unwrap();
        let found = |name: &str| {
            let found = scene.named_setting(name).unwrap();
            (found.path, found.unit, found.kind)
        };
        let friction = "contact.pea-steel.static_friction".to_owned();
        assert_eq!(
            found("static_friction"),
            (friction.clone(), None, SettingKind::Number)
        );
        assert_eq!(found(&friction).0, friction);
        let step = || "protocol.time_step".to_owned();
        assert_eq!(
            found("time_step_s"),
            (step(), Some("s"), SettingKind::Quantity)
        );
        assert_eq!(found(&step()), (step(), None, SettingKind::Quantity));
        assert_eq!(found("sphere").2, SettingKind::Quantity);
        assert_eq!(found("rolling_lever").2, SettingKind::Text);
        assert_eq!(found("protocol.flow_step_share").2, SettingKind::Number);
        assert!(matches!(
            scene.named_setting("rpm"),
            Err(Error::UnknownSetting { .. })
        ));
        assert!(matches!(
            scene.named_setting("poisson_ratio"),
            Err(Error::AmbiguousSetting { .. })
        ));
        // Of settings with one last word that with the most like path comes first.
        let paths = [
            "contact.pea-clear.static_friction",
            "contact.pea-pea.static_friction",
        ];
        let like = like_names(&paths.map(str::to_owned), "contact.pea-pea.static_frction");
        assert!(like.starts_with(paths[1]), "{like}");
        // A setting that the file leaves out has a short name too, and a misspelt one is told with those like it, not with all.
        assert_eq!(found("flow_step_share").0, "protocol.flow_step_share");
        let told = scene.named_setting("static_frction").unwrap_err();
        let told = told.to_string();
        let first = told.split("like name: ").nth(1).unwrap();
        assert!(first.starts_with("contact."), "{told}");
        let offered: Vec<&str> = first.split(", ").collect();
        assert!((1..=8).contains(&offered.len()), "{told}");
        assert!(
            offered.iter().all(|path| path.contains("friction")),
            "{told}"
        );
        let names = scene.setting_names();
        assert!(names.contains(&friction) && names.contains(&"time_step_s".to_owned()));
        assert!(!names.contains(&"rpm".to_owned()), "{names:?}");
    }

    #[test]
    fn what_a_scene_leaves_out_can_be_set_by_name() {
        let settings = [
            ("cohesion_energy_density_j_m3", "4000"),
            ("friction_rate", "-0.5"),
            ("max_angle_error", "2 deg"),
        ];
        let set = |name: &str, value: &str| Override {
            name: name.into(),
            value: value.into(),
        };
        let changes = settings.map(|(name, value)| set(name, value));
        let scene = Scene::from_text(SLED, "sled.toml", Path::new(""), &changes).unwrap();
        let contact = &scene.contact["pea-steel"];
        assert_eq!(contact.cohesion_energy_density_j_m3, Some(4000.0));
        assert_eq!(contact.friction_rate, Some(-0.5));
        assert_eq!(contact.attraction_n, None, "what nobody sets stays out");
        assert!(scene.camera.max_angle_error.is_some());
        let names = scene.setting_names();
        let adhesion = "contact.pea-steel.attraction_n";
        assert!(names.iter().any(|name| name == adhesion), "{names:?}");
        // A section that is left out as well comes with its setting, and is checked: nothing blows at a bench test.
        let told = scene.with(&[set("air_drag", "1")]).unwrap_err().to_string();
        assert!(
            told.starts_with("sled.toml: [surroundings] is stated"),
            "{told}"
        );
        // A pair of materials that has no contact is a mistake, and none is made up.
        let brass = set("contact.pea-brass.friction_rate", "0.1");
        let refused = scene.with(&[brass]).unwrap_err();
        assert!(matches!(refused, Error::UnknownSetting { .. }), "{refused}");
        // A value out of range is told with file, contact and range when the scene is read.
        for (name, value, range) in [
            ("attraction_n", "-1e-6", "0 N to 1e9 N"),
            ("cohesion_energy_density_j_m3", "-5", "0 J/m³ to 1e12 J/m³"),
            ("viscoelastic_damping", "1.5", "0 to 1"),
            ("friction_rate", "-1.5", "-0.95 to 10"),
        ] {
            let told = scene.with(&[set(name, value)]).unwrap_err().to_string();
            assert!(
                told.starts_with("sled.toml: contact 'pea-steel': "),
                "{told}"
            );
            assert!(told.contains(range), "{told}");
        }
    }
}
