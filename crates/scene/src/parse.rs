//! Reading a scene file, and changing single settings of it.

use crate::{Error, Scene};
use std::path::Path;
use toml::{Table, Value};

/// A setting to change: dotted path or unambiguous short name, and the value as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    /// `contact.seed-seed.static_friction`, or `rpm`, `time_s` and other short names.
    pub name: String,
    /// The value as it would stand in the file; quotes may be left out.
    pub value: String,
}

/// The one setting without a default that can be set where the file leaves it out.
const TIME_STEP: &str = "protocol.time_step";

/// Short names that stand for a setting with its unit: (name, path, unit).
const SHORT_NAMES: [(&str, &str, &str); 3] = [
    ("rpm", "apparatus.speed", "rpm"),
    ("time_s", "protocol.rotation_limit", "s"),
    ("time_step_s", TIME_STEP, "s"),
];

/// Largest slope at which a bed may be laid, rad.
const MOST_START_SLOPE: f64 = std::f64::consts::FRAC_PI_4;

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, text that is no scene, settings that cannot be meant.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::from_text(&text, &path.display().to_string(), &folder, overrides)
    }

    /// Reads the text of a scene; `file` is named in messages, paths refer to `folder`.
    ///
    /// # Errors
    ///
    /// Text that is no scene, settings that cannot be meant.
    pub fn from_text(
        text: &str,
        file: &str,
        folder: &Path,
        overrides: &[Override],
    ) -> Result<Self, Error> {
        let wrong = |e: toml::de::Error| Error::Text {
            file: file.into(),
            message: e.to_string(),
        };
        // The plain text is read first, so that a message can name the line.
        let mut scene: Self = toml::from_str(text).map_err(wrong)?;
        if !overrides.is_empty() {
            // Settings that the text leaves out and that have a default can be changed too.
            let mut table = Table::try_from(&scene).map_err(|e| Error::Text {
                file: file.into(),
                message: e.to_string(),
            })?;
            for change in overrides {
                apply(&mut table, change, file)?;
            }
            scene = table.try_into().map_err(wrong)?;
        }
        folder.clone_into(&mut scene.folder);
        file.clone_into(&mut scene.file);
        scene.check().map_err(|error| error.in_file(file))?;
        Ok(scene)
    }

    /// The scene with settings changed.
    ///
    /// # Errors
    ///
    /// A name that fits no setting or several, a value that cannot be meant.
    pub fn with(&self, overrides: &[Override]) -> Result<Self, Error> {
        let wrong = |message: String| Error::Text {
            file: self.file.clone(),
            message,
        };
        let text = toml::to_string(self).map_err(|e| wrong(e.to_string()))?;
        Self::from_text(&text, &self.file, &self.folder, overrides)
    }

    /// Refuses what cannot be meant; for scenes that were changed after reading.
    ///
    /// # Errors
    ///
    /// A setting out of range, a name that refers to nothing, a contact that nobody states.
    pub fn check(&self) -> Result<(), Error> {
        self.check_protocol()?;
        let bond = self.model.bond_number;
        if !(0.0..=100.0).contains(&bond) {
            return bad("model.bond_number", bond.to_string(), "0 to 100");
        }
        if let Some(liquid) = &self.model.liquid {
            let tension = liquid.surface_tension_n_m;
            if !(0.0..=0.2).contains(&liquid.content) {
                let content = liquid.content.to_string();
                return bad("model.liquid.content", content, "0 to 0.2");
            }
            if !(0.0..=1.0).contains(&tension) {
                let name = "model.liquid.surface_tension_n_m";
                return bad(name, tension.to_string(), "0 to 1");
            }
            if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&liquid.contact_angle.si()) {
                let angle = liquid.contact_angle.to_string();
                return bad("model.liquid.contact_angle", angle, "0 to 90 deg");
            }
        }
        let gravity = self.model.gravity_m_s2;
        if !(gravity > 0.0 && gravity <= 1000.0) {
            return bad(
                "model.gravity_m_s2",
                gravity.to_string(),
                "above 0, at most 1000",
            );
        }
        if !(64..=4096).contains(&self.camera.pixels) {
            return bad(
                "camera.pixels",
                self.camera.pixels.to_string(),
                "64 to 4096",
            );
        }
        if self.seed_count() == 0 {
            return bad("number of seeds", "0".into(), "at least 1");
        }
        for seed in &self.seed {
            if seed.mass.si() <= 0.0 || seed.filling.sphere_radius.si() <= 0.0 {
                return bad(
                    &format!("mass or sphere_radius of seed '{}'", seed.name),
                    "0".into(),
                    "above 0",
                );
            }
            if let Some(scale) = seed.scale
                && !(0.01..=100.0).contains(&scale)
            {
                let name = format!("scale of seed '{}'", seed.name);
                return bad(&name, scale.to_string(), "0.01 to 100");
            }
        }
        if let Some(distance) = self.camera.distance
            && distance.si() <= self.apparatus.radius()
        {
            return bad(
                "camera.distance",
                distance.to_string(),
                "above the inner radius of the drum",
            );
        }
        if let Some(bonds) = &self.model.bonds {
            bonds.law().map_err(|source| Error::Text {
                file: self.file.clone(),
                message: format!("[model.bonds]: {source}"),
            })?;
            if self.protocol.insertion_rate.is_some() || !self.surroundings.is_empty() {
                let other = "protocol.insertion_rate or [surroundings] beside it";
                return bad("model.bonds", other.into(), "alone: remove one of them");
            }
        }
        self.surroundings.check(&self.apparatus)?;
        self.apparatus.check()?;
        self.check_names()
    }

    /// Refuses times, steps and counts that cannot be meant.
    fn check_protocol(&self) -> Result<(), Error> {
        let p = &self.protocol;
        for (name, time) in [
            ("protocol.settle_limit", p.settle_limit),
            ("protocol.rotation_limit", p.rotation_limit),
            ("protocol.frame_interval", p.frame_interval),
        ] {
            if time.si() <= 0.0 {
                return bad(name, time.to_string(), "above 0");
            }
        }
        if let Some(rate) = p.insertion_rate
            && rate.si() < 1.0
        {
            return bad("protocol.insertion_rate", rate.to_string(), "1 1/s or more");
        }
        let shares = [
            ("protocol.step_share", Some(p.step_share)),
            ("protocol.flow_step_share", p.flow_step_share),
        ];
        for (name, share) in shares.into_iter().filter_map(|(n, s)| Some((n, s?))) {
            if !(share > 0.0 && share <= 1.0) {
                return bad(name, share.to_string(), "above 0, at most 1");
            }
        }
        if p.time_step.is_some_and(|step| step.si() <= 0.0) {
            return bad("protocol.time_step", "0".into(), "above 0");
        }
        if let Some(session) = p.session
            && !(0.0..=1.0).contains(&session)
        {
            return bad("protocol.session", session.to_string(), "0 to 1");
        }
        if let Some(slope) = p.start_slope {
            let in_a_drum = matches!(self.apparatus, crate::Apparatus::Drum(_));
            if !(in_a_drum && (0.0..=MOST_START_SLOPE).contains(&slope.si())) {
                return bad(
                    "protocol.start_slope",
                    slope.to_string(),
                    "0 to 45 deg, in a drum only",
                );
            }
        }
        if p.frames < 2 {
            return bad("protocol.frames", p.frames.to_string(), "at least 2");
        }
        let shaken = self.wall.iter().filter_map(|wall| wall.vibration.as_ref());
        for vibration in shaken.chain(&self.surroundings.vibration) {
            if vibration.frequency.si() <= 0.0 {
                let frequency = vibration.frequency.to_string();
                return bad("vibration.frequency", frequency, "above 0");
            }
        }
        Ok(())
    }

    /// Refuses names that refer to nothing, and contacts that nobody states.
    fn check_names(&self) -> Result<(), Error> {
        let walls = self.wall_materials();
        let seeds: Vec<&str> = self.seed.iter().map(|s| s.material.as_str()).collect();
        let in_contacts = self.contact.keys().flat_map(|pair| pair.split('-'));
        for name in walls
            .iter()
            .copied()
            .chain(seeds.iter().copied())
            .chain(in_contacts)
        {
            if !self.material.contains_key(name) {
                let known: Vec<_> = self.material.keys().map(String::as_str).collect();
                return Err(Error::Undefined {
                    file: self.file.clone(),
                    what: "material",
                    name: name.into(),
                    known: known.join(", "),
                });
            }
        }
        for seed in &seeds {
            for other in seeds.iter().chain(&walls) {
                if self.contact_of(seed, other).is_none() {
                    let pair = format!("{seed}-{other}");
                    return Err(Error::MissingContact {
                        file: self.file.clone(),
                        pair,
                    });
                }
            }
        }
        let own: Vec<String> = {
            let walls = self.apparatus.mesh_walls().into_iter();
            walls.map(|wall| wall.name).collect()
        };
        for (k, wall) in self.wall.iter().enumerate() {
            let twice = self.wall[..k].iter().any(|other| other.name == wall.name);
            if twice || own.contains(&wall.name) {
                return Err(Error::BadValue {
                    name: "wall.name".into(),
                    value: wall.name.clone(),
                    requirement: "another name: each wall of triangles needs its own".into(),
                });
            }
        }
        Ok(())
    }
}

/// The refusal of a value.
fn bad<T>(name: &str, value: String, requirement: &str) -> Result<T, Error> {
    Err(Error::BadValue {
        name: name.into(),
        value,
        requirement: requirement.into(),
    })
}

/// Changes one setting of a table.
fn apply(table: &mut Table, change: &Override, file: &str) -> Result<(), Error> {
    let short = SHORT_NAMES.iter().find(|s| s.0 == change.name);
    let (path, text) = match short {
        Some((_, path, unit)) => ((*path).to_owned(), format!("{} {unit}", change.value)),
        None => (whole_path(table, &change.name, file)?, change.value.clone()),
    };
    if path == TIME_STEP
        && let Some((section, key)) = path.split_once('.')
        && let Some(Value::Table(section)) = table.get_mut(section)
    {
        section
            .entry(key)
            .or_insert_with(|| Value::String(String::new()));
    }
    let unknown = || Error::UnknownSetting {
        name: change.name.clone(),
        file: file.into(),
        near: leaves(table).join(", "),
    };
    let found = leaf(table, &path).map(|old| like(old, &text));
    let Some(value) = found else {
        return Err(unknown());
    };
    if let Some(place) = leaf_mut(table, &path) {
        *place = value;
    }
    Ok(())
}

/// The path that a whole or short name stands for.
fn whole_path(table: &Table, name: &str, file: &str) -> Result<String, Error> {
    let all = leaves(table);
    if all.iter().any(|path| path == name) {
        return Ok(name.to_owned());
    }
    let ending = format!(".{name}");
    let fits: Vec<_> = all
        .iter()
        .filter(|path| path.ends_with(&ending))
        .cloned()
        .collect();
    match fits.as_slice() {
        [path] => Ok(path.clone()),
        [] => {
            let last = name.rsplit('.').next().unwrap_or(name);
            let near: Vec<_> = all.iter().filter(|p| p.contains(last)).cloned().collect();
            let near = if near.is_empty() {
                all.join(", ")
            } else {
                near.join(", ")
            };
            Err(Error::UnknownSetting {
                name: name.into(),
                file: file.into(),
                near,
            })
        }
        _ => Err(Error::AmbiguousSetting {
            name: name.into(),
            candidates: fits.join(", "),
        }),
    }
}

/// Text as a value of the kind that stands there now.
fn like(old: &Value, text: &str) -> Value {
    match old {
        Value::Integer(_) => text.parse().map_or_else(|_| number(text), Value::Integer),
        Value::Float(_) => number(text),
        Value::Boolean(_) => text
            .parse()
            .map_or_else(|_| Value::String(text.into()), Value::Boolean),
        _ => Value::String(text.trim_matches('"').into()),
    }
}

/// Text as a number where it is one.
fn number(text: &str) -> Value {
    text.parse()
        .map_or_else(|_| Value::String(text.into()), Value::Float)
}

/// Dotted paths of all leaves; the items of a list are numbered from 0.
fn leaves(table: &Table) -> Vec<String> {
    fn walk(value: &Value, path: &str, out: &mut Vec<String>) {
        let mut below = |key: &str, child: &Value| {
            let path = if path.is_empty() {
                key.to_owned()
            } else {
                format!("{path}.{key}")
            };
            walk(child, &path, out);
        };
        match value {
            Value::Table(table) => table.iter().for_each(|(key, child)| below(key, child)),
            Value::Array(list) => {
                list.iter()
                    .enumerate()
                    .for_each(|(k, child)| below(&k.to_string(), child));
            }
            _ => out.push(path.to_owned()),
        }
    }
    let mut out = Vec::new();
    walk(&Value::Table(table.clone()), "", &mut out);
    out
}

/// The leaf at a dotted path.
fn leaf<'a>(table: &'a Table, path: &str) -> Option<&'a Value> {
    let mut keys = path.split('.');
    let mut value = table.get(keys.next()?)?;
    for key in keys {
        value = match value {
            Value::Table(table) => table.get(key)?,
            Value::Array(list) => list.get(key.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    Some(value)
}

/// The same, to be changed.
fn leaf_mut<'a>(table: &'a mut Table, path: &str) -> Option<&'a mut Value> {
    let mut keys = path.split('.');
    let mut value = table.get_mut(keys.next()?)?;
    for key in keys {
        value = match value {
            Value::Table(table) => table.get_mut(key)?,
            Value::Array(list) => list.get_mut(key.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    Some(value)
}
