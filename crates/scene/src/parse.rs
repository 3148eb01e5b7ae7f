//! Reading a scene file, and changing single settings of it.

use crate::other_names::way_out;
use crate::{Error, Scene, SeedSettings};
use input::file::toml_slip;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// A setting to change: dotted path or unambiguous short name, and the value as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    /// `contact.seed-seed.static_friction`, or `rpm`, `time_s` and other short names.
    pub name: String,
    /// The value as it would stand in the file; quotes may be left out.
    pub value: String,
}

impl Override {
    /// The change of a setting to a value.
    pub fn new(name: &str, value: &str) -> Self {
        Self {
            name: name.to_owned(),
            value: value.to_owned(),
        }
    }

    /// The change of a setting to a number, with the unit if the setting is a quantity. Every bit of it arrives.
    pub fn number(name: &str, value: f64, unit: Option<&str>) -> Self {
        let value = match unit {
            Some(unit) => format!("{value} {unit}"),
            None => value.to_string(),
        };
        Self::new(name, &value)
    }
}

/// Time step of the solver.
const TIME_STEP: &str = "protocol.time_step";

/// Quantities without a default that can be set although the file omits them.
const LEFT_OUT_QUANTITIES: [&str; 8] = [
    TIME_STEP,
    "protocol.start_up",
    "protocol.start_slope",
    "protocol.angle_error",
    "protocol.insertion_rate",
    "camera.distance",
    "camera.pair_interval",
    "camera.max_angle_error",
];

/// Numbers likewise.
const LEFT_OUT_NUMBERS: [&str; 5] = [
    "model.whole_seed_damping",
    "protocol.flow_step_share",
    "protocol.session",
    "surroundings.air_drag",
    "surroundings.charge_nc",
];

/// Numbers of each contact likewise.
const LEFT_OUT_OF_A_CONTACT: [&str; 4] = [
    "attraction_n",
    "cohesion_energy_density_j_m3",
    "viscoelastic_damping",
    "friction_rate",
];

/// Quantities of a drum likewise.
const LEFT_OUT_OF_A_DRUM: [&str; 3] = [
    "apparatus.ramp",
    "apparatus.reverse_every",
    "apparatus.tilt",
];

/// Settings of a seed likewise, each with a value of its kind.
fn left_out_of_a_seed() -> [(&'static str, Value); 8] {
    let quantity = || Value::String(String::new());
    [
        ("mass", quantity()),
        ("density", quantity()),
        ("count", Value::Integer(1)),
        ("total_mass", quantity()),
        ("fill_level", Value::Float(0.0)),
        ("solid_fraction", Value::Float(0.0)),
        ("scale", Value::Float(1.0)),
        ("spheres_unit", quantity()),
    ]
}

/// Settings of a material likewise.
const LEFT_OUT_OF_A_MATERIAL: [&str; 2] = ["shear_modulus", "youngs_modulus"];

/// Keys of a section of which a scene states one: a change of one takes the others out. The fraction belongs to the level.
const ALTERNATIVES: [(&str, &[&str]); 3] = [
    ("material", &LEFT_OUT_OF_A_MATERIAL),
    ("seed", &["mass", "density"]),
    ("seed", &["count", "total_mass", "fill_level"]),
];

/// Switches of an apparatus likewise.
const SWITCHES: [(&str, &str); 3] = [
    ("drum", "apparatus.covers_at_rest"),
    ("hopper", "apparatus.periodic"),
    ("machine", "apparatus.periodic"),
];

/// Settings named in a message about a name that is none.
const LIKE_NAMES: usize = 8;
/// Of them those with the same last word.
const OF_ONE_WORD: usize = 3;
/// How much less like than the best, by Jaro and Winkler, a name may be that is offered beside it.
const NEARLY_AS_LIKE: f64 = 0.15;

/// Short names that stand for a setting with its unit: (name, path, unit).
pub(crate) const SHORT_NAMES: [(&str, &str, &str); 3] = [
    ("rpm", "apparatus.speed", "rpm"),
    ("time_s", "protocol.rotation_limit", "s"),
    ("time_step_s", TIME_STEP, "s"),
];

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, text that is not a scene, invalid settings: the first of
    /// [`Self::read_all`].
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, Error> {
        Self::from_text(&text_of(path)?, &name_of(path), &folder_of(path), overrides)
    }

    /// Reads a scene file, and tells all that is wrong with it.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, text that is not a scene, a mesh that cannot be read, each alone; or all
    /// [`Self::problems`].
    pub fn read_all(path: &Path, overrides: &[Override]) -> Result<Self, Vec<Error>> {
        let alone = |error| vec![error];
        let text = text_of(path).map_err(alone)?;
        let (file, folder) = (name_of(path), folder_of(path));
        let scene = Self::parsed(&text, &file, overrides).map_err(alone)?;
        let scene = scene.completed(&file, &folder, &[]).map_err(alone)?;
        let problems = scene.problems();
        if problems.is_empty() {
            return Ok(scene);
        }
        Err(problems)
    }

    /// Reads the text of a scene; `file` is named in messages, paths refer to `folder`.
    ///
    /// # Errors
    ///
    /// Text that is not a scene, invalid settings.
    pub fn from_text(
        text: &str,
        file: &str,
        folder: &Path,
        overrides: &[Override],
    ) -> Result<Self, Error> {
        let scene = Self::parsed(text, file, overrides)?.completed(file, folder, &[])?;
        scene.check()?;
        Ok(scene)
    }

    /// The scene of a text, with settings changed; neither completed nor checked.
    fn parsed(text: &str, file: &str, overrides: &[Override]) -> Result<Self, Error> {
        let wrong = |e: toml::de::Error| Error::Text {
            file: file.into(),
            message: e.to_string(),
        };
        // The plain text is read first, so that a message can name the line.
        let mut scene: Self = toml::from_str(text).map_err(|e| Error::Text {
            file: file.into(),
            message: with_way_out(text, &e),
        })?;
        if !overrides.is_empty() {
            // Settings that the text leaves out and that have a default can be changed too.
            let mut table = scene.table()?;
            for change in overrides {
                apply(&mut table, change, file)?;
            }
            scene = table.try_into().map_err(wrong)?;
        }
        Ok(scene)
    }

    /// The scene with what its text does not contain; volumes of `known` seeds are not measured again.
    fn completed(
        mut self,
        file: &str,
        folder: &Path,
        known: &[SeedSettings],
    ) -> Result<Self, Error> {
        folder.clone_into(&mut self.folder);
        file.clone_into(&mut self.file);
        self.expand_sizes()?;
        self.complete_seeds(known)?;
        Ok(self)
    }

    /// The scene with settings changed.
    ///
    /// # Errors
    ///
    /// A name that fits no setting or several, an invalid value.
    pub fn with(&self, overrides: &[Override]) -> Result<Self, Error> {
        let mut table = self.table()?;
        for change in overrides {
            apply(&mut table, change, &self.file)?;
        }
        let scene: Self = table
            .try_into()
            .map_err(|error| self.misread(overrides, &error))?;
        let scene = scene.completed(&self.file, &self.folder, &self.seed)?;
        scene.check()?;
        Ok(scene)
    }

    /// The error of settings that the form of a scene refuses, with the name of the first that is refused alone: the error itself
    /// names the kind of quantity and not the setting.
    fn misread(&self, overrides: &[Override], error: &toml::de::Error) -> Error {
        let refused = overrides.iter().find_map(|change| {
            let mut table = self.table().ok()?;
            apply(&mut table, change, &self.file).ok()?;
            let error = table.try_into::<Self>().err()?;
            Some(format!("{}: {}", change.name, error.message()))
        });
        Error::Text {
            file: self.file.clone(),
            message: refused.unwrap_or_else(|| error.to_string()),
        }
    }

    /// The number of a setting by its dotted path; `None` if it is absent or not a plain number.
    pub fn number(&self, path: &str) -> Option<f64> {
        match setting_at(&self.table().ok()?, path)? {
            Value::Integer(number) => Some(*number as f64),
            Value::Float(number) => Some(*number),
            _ => None,
        }
    }

    /// The scene as a table of values.
    pub(crate) fn table(&self) -> Result<Table, Error> {
        Table::try_from(self).map_err(|e| Error::Text {
            file: self.file.clone(),
            message: e.to_string(),
        })
    }
}

/// The message of an error, with the remedy if the line has a usual slip of TOML, or a key is that of another code.
fn with_way_out(text: &str, error: &toml::de::Error) -> String {
    let told = error.to_string();
    if toml::from_str::<Table>(text).is_ok() {
        return match way_out_of_key(&told) {
            Some(way_out) => format!("{}; {way_out}", told.trim_end()),
            None => told,
        };
    }
    let line = error.span().and_then(|span| {
        let before = text.get(..span.start)?;
        text.lines().nth(before.matches('\n').count())
    });
    match line.and_then(toml_slip) {
        Some(slip) => format!("{}; {slip}", told.trim_end()),
        None => told,
    }
}

/// What to write for the key that a message calls unknown: the keys that it expects stand in the message.
fn way_out_of_key(told: &str) -> Option<String> {
    let (_, rest) = told.split_once("unknown field `")?;
    let (name, expected) = rest.split_once('`')?;
    way_out(name, |key| expected.contains(&format!("`{key}`")))
}

/// Hint for a name that is not a setting: the existing names that are similar.
fn meant(all: &[String], name: &str) -> String {
    let (section, last) = name.rsplit_once('.').unwrap_or(("", name));
    let is_there = |key: &str| match section {
        "" => all.iter().any(|path| path.rsplit('.').next() == Some(key)),
        _ => all.contains(&format!("{section}.{key}")),
    };
    way_out(last, is_there)
        .unwrap_or_else(|| format!("settings with a like name: {}", like_names(all, name)))
}

/// Text of a file.
fn text_of(path: &Path) -> Result<String, Error> {
    input::file::read_text(path).map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })
}

/// Name of a file in messages.
fn name_of(path: &Path) -> String {
    path.display().to_string()
}

/// Folder to which paths in a file refer.
fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

/// Settings without a default that can be set although the scene omits them, each with a value of its kind.
pub(crate) fn left_out(table: &Table) -> Vec<(String, Value)> {
    let contacts = table.get("contact").and_then(Value::as_table);
    let pairs = contacts.into_iter().flat_map(Table::keys);
    let of_pairs = pairs.flat_map(|pair| {
        LEFT_OUT_OF_A_CONTACT.map(|key| (format!("contact.{pair}.{key}"), Value::Float(0.0)))
    });
    let quantity = |path: &str| (path.to_owned(), Value::String(String::new()));
    let numbers = LEFT_OUT_NUMBERS.map(|p| (p.to_owned(), Value::Float(1.0)));
    let kind = setting_at(table, "apparatus.kind").and_then(Value::as_str);
    let of_drum = (kind == Some("drum")).then(|| LEFT_OUT_OF_A_DRUM.map(quantity));
    let own = SWITCHES.iter().filter(|(of, _)| kind == Some(*of));
    let switches = own.map(|(_, path)| ((*path).to_owned(), Value::Boolean(false)));
    let names = table.get("material").and_then(Value::as_table);
    let of_materials = names.into_iter().flat_map(Table::keys).flat_map(|name| {
        LEFT_OUT_OF_A_MATERIAL.map(|key| quantity(&format!("material.{name}.{key}")))
    });
    let seeds = table.get("seed").and_then(Value::as_array);
    let of_seeds = (0..seeds.map_or(0, Vec::len))
        .flat_map(|k| left_out_of_a_seed().map(|(key, value)| (format!("seed.{k}.{key}"), value)));
    let all = LEFT_OUT_QUANTITIES.map(quantity).into_iter().chain(numbers);
    all.chain(of_drum.into_iter().flatten())
        .chain(switches)
        .chain(of_pairs)
        .chain(of_materials)
        .chain(of_seeds)
        .collect()
}

/// The keys that cannot stand beside that of a path.
fn alternatives(path: &str) -> Vec<&'static str> {
    let words: Vec<&str> = path.split('.').collect();
    let [section, _, key] = words[..] else {
        return Vec::new();
    };
    let group = ALTERNATIVES
        .iter()
        .find(|(of, keys)| *of == section && keys.contains(&key));
    let others = group.iter().flat_map(|(_, keys)| keys.iter().copied());
    let mut others: Vec<&str> = others.filter(|other| *other != key).collect();
    if others.contains(&"fill_level") {
        others.push("solid_fraction");
    }
    others
}

/// Makes room for a setting without a default that the scene leaves out; one that cannot stand beside it goes.
pub(crate) fn make_room(table: &mut Table, path: &str) {
    let section = path.rsplit_once('.').map_or("", |(section, _)| section);
    if let Some(Value::Table(section)) = value_mut(table, section) {
        for other in alternatives(path) {
            section.remove(other);
        }
    }
    let mut known = left_out(table).into_iter();
    let Some((_, value)) = known.find(|(known, _)| known == path) else {
        return;
    };
    let (sections, key) = path.rsplit_once('.').unwrap_or(("", path));
    let mut section = table;
    let mut keys = sections.split('.');
    while let Some(name) = keys.next() {
        let below = section.entry(name).or_insert(Value::Table(Table::new()));
        // The items of a list are there, or the setting is none.
        let item = match below {
            Value::Array(list) => keys
                .next()
                .and_then(|k| list.get_mut(k.parse::<usize>().ok()?)),
            other => Some(other),
        };
        let Some(Value::Table(below)) = item else {
            return;
        };
        section = below;
    }
    section.entry(key).or_insert(value);
}

/// Changes one setting of a table.
fn apply(table: &mut Table, change: &Override, file: &str) -> Result<(), Error> {
    let short = SHORT_NAMES.iter().find(|s| s.0 == change.name);
    let (path, text) = match short {
        Some((_, path, unit)) => ((*path).to_owned(), format!("{} {unit}", change.value)),
        None => (whole_path(table, &change.name, file)?, change.value.clone()),
    };
    make_room(table, &path);
    let unknown = || Error::UnknownSetting {
        name: change.name.clone(),
        file: file.into(),
        near: meant(&leaves(table), &change.name),
    };
    let Some(old) = setting_at(table, &path) else {
        return Err(unknown());
    };
    let value = like(old, &text).map_err(|requirement| Error::BadValue {
        name: format!("{file}: {path}"),
        value: text,
        requirement: requirement.into(),
    })?;
    if let Some(place) = value_mut(table, &path) {
        *place = value;
    }
    Ok(())
}

/// The path of a setting given by its whole or short name.
pub(crate) fn whole_path(table: &Table, name: &str, file: &str) -> Result<String, Error> {
    let mut all = leaves(table);
    all.extend(left_out(table).into_iter().map(|(path, _)| path));
    all.sort();
    all.dedup();
    if all.iter().any(|path| path == name) {
        return Ok(name.to_owned());
    }
    let ending = format!(".{name}");
    let mut fits: Vec<_> = all
        .iter()
        .filter(|path| path.ends_with(&ending))
        .cloned()
        .collect();
    // Who says `density` means the seed that has one, and not another that states its mass.
    let there = |path: &String| setting_at(table, path).is_some();
    if fits.iter().any(there) {
        fits.retain(|path| there(path) || alternatives(path).is_empty());
    }
    match fits.as_slice() {
        [path] => Ok(path.clone()),
        [] => Err(Error::UnknownSetting {
            name: name.into(),
            file: file.into(),
            near: meant(&all, name),
        }),
        _ => Err(Error::AmbiguousSetting {
            name: name.into(),
            candidates: fits.join(", "),
        }),
    }
}

/// The settings whose last word, or a part of it, is most like the last word of a name, as a list for a message: eight at most, and three
/// with the same last word, the most like path first. Words that are much less like than the best are left out.
pub fn like_names(all: &[String], name: &str) -> String {
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let wanted = last(name);
    let likeness = |path: &String| {
        let word = last(path);
        let holds = f64::from(u8::from(word.contains(&wanted)));
        let parts = word.split('_').chain([word.as_str()]);
        let most = parts.fold(0.0, |most: f64, part| {
            most.max(strsim::jaro_winkler(part, &wanted))
        });
        (holds + most, strsim::jaro_winkler(path, name))
    };
    let mut nearest: Vec<_> = all.iter().map(|path| (likeness(path), path)).collect();
    nearest.sort_by(|(a, _), (b, _)| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    let best = nearest.first().map_or(0.0, |(likeness, _)| likeness.0);
    let mut offered: Vec<&str> = Vec::new();
    for ((likeness, _), path) in nearest {
        let same = offered.iter().filter(|other| last(other) == last(path));
        if likeness >= best - NEARLY_AS_LIKE && same.count() < OF_ONE_WORD {
            offered.push(path);
        }
    }
    offered.truncate(LIKE_NAMES);
    offered.join(", ")
}

/// Text as a value of the kind that is there now, or what it must be.
fn like(old: &Value, text: &str) -> Result<Value, &'static str> {
    match old {
        Value::Integer(_) => text
            .parse()
            .map(Value::Integer)
            .map_err(|_| "a whole number"),
        Value::Float(_) => text
            .parse()
            .map(Value::Float)
            .map_err(|_| "a number without unit"),
        Value::Boolean(_) => text
            .parse()
            .map(Value::Boolean)
            .map_err(|_| "true or false"),
        _ => Ok(Value::String(text.trim_matches('"').into())),
    }
}

/// Dotted paths of all leaves; the items of a list are numbered from 0.
pub(crate) fn leaves(table: &Table) -> Vec<String> {
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

/// The setting at a dotted path of a scene written as a table; items of lists are numbered from 0.
pub fn setting_at<'a>(table: &'a Table, path: &str) -> Option<&'a Value> {
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
fn value_mut<'a>(table: &'a mut Table, path: &str) -> Option<&'a mut Value> {
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
