//! What a study file says, entry by entry.

mod candidate;
mod choices;
mod coarse_graining;
mod input;
mod parts;
mod photo;
mod simulator;

pub use coarse_graining::CoarseGrainingEntry;
pub(crate) use coarse_graining::USUAL_ERROR;
pub(crate) use simulator::usable_name;
pub use simulator::{CommandEntry, EffectEntry, PeerEntry, SimulatorEntry};

use crate::document::{Document, Fields, below};
use crate::keys;
use crate::plausible::wrong_name;
use crate::problem::Problems;
use inference::{Prior, Role};
use serde::Serialize;
use simulators::external_simulator::DrumDescription;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use toml::{Table, Value};

/// A simulated scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneEntry {
    /// Name.
    pub name: String,
    /// Scene file, relative to the study file; none of a scene that a program of the user knows.
    pub file: Option<PathBuf>,
    /// Changes of it, `name = value`, as after `--set`; those of the profile come last.
    pub changes: Vec<String>,
    /// Another apparatus in the place of that of the file.
    pub apparatus: Option<Table>,
    /// Observables that a program of the user tells of it.
    pub observables: Option<Vec<String>>,
    /// Parameters on which its runs depend, where a program of the user does them; all where absent.
    pub parameters: Option<Vec<String>>,
    /// The drum that a program of the user shows.
    #[serde(skip)]
    pub drum: Option<DrumDescription>,
    /// Where it stands.
    #[serde(skip)]
    pub(crate) path: String,
}

/// A parameter that may be tuned.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEntry {
    /// Short name.
    pub symbol: String,
    /// What it is; the first path where absent.
    pub name: Option<String>,
    /// Dotted paths of the settings that it sets.
    pub sets: Vec<String>,
    /// Unit, where the settings are quantities with one.
    pub unit: Option<String>,
    /// Where the search begins.
    pub low: f64,
    /// Where it begins, upper end.
    pub high: f64,
    /// What is physically possible; by the kind of setting where absent.
    pub limits: Option<[f64; 2]>,
    /// Value in use before; what stands in the first scene where absent.
    pub start: Option<f64>,
    /// Knowledge beside the measurements.
    pub prior: Option<Prior>,
    /// Whether it is an `[[input]]`: stated with an error, and not tuned.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_input: bool,
    /// The effect of the library whose amplitude it is, in place of settings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effect: Option<String>,
    /// Scenes on which it acts; all where absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenes: Option<Vec<String>>,
    /// Where it stands; empty for an input that the file leaves out.
    #[serde(skip)]
    pub(crate) path: String,
}

/// A measured mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeasuredValue {
    /// Mean, in the unit of the observable.
    pub mean: f64,
    /// Standard deviation of the single values.
    pub sd: f64,
    /// Number of independent values, above 0.
    pub n: f64,
}

/// How the means of two observables of one measurement go together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredCorrelation {
    /// The one observable.
    pub a: String,
    /// The other.
    pub b: String,
    /// Correlation of their means, between -1 and 1.
    pub value: f64,
}

/// What was measured at one condition of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredEntry {
    /// Name of the scene.
    pub scene: String,
    /// Settings of the scene by path or short name, with the values as text.
    pub condition: BTreeMap<String, String>,
    /// What it serves for.
    pub role: Role,
    /// Means by observable.
    pub values: BTreeMap<String, MeasuredValue>,
    /// Which of the means are correlated, as the file states it; photos tell theirs themselves.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<MeasuredCorrelation>,
    /// Photos or folders of them, relative to the study file.
    pub photos: Vec<PathBuf>,
    /// How they are read.
    pub photo: PhotoOptions,
    /// Where it stands.
    #[serde(skip)]
    pub(crate) path: String,
}

/// A measurement that could be made next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateEntry {
    /// Name of the scene.
    pub scene: String,
    /// Settings of the scene by path or short name, with the values as text.
    pub condition: BTreeMap<String, String>,
    /// What would be measured; what the study measures on the scene where absent.
    pub observables: Option<Vec<String>>,
    /// Standard deviation of the single values, by observable; that of the same one elsewhere where absent.
    pub sd: BTreeMap<String, f64>,
    /// Number of independent values; as elsewhere where absent.
    pub n: Option<f64>,
    /// Work in the laboratory, min; 1 where absent.
    pub minutes: Option<f64>,
    /// Where it stands.
    #[serde(skip)]
    pub(crate) path: String,
}

/// How photos are read.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PhotoOptions {
    /// Angle of the true horizontal in the pictures, counter-clockwise positive, rad.
    pub roll_rad: f64,
    /// Standard error of that angle, rad: that of the mark that shows it; 0 if it is stated.
    pub roll_error_rad: f64,
    /// How far above the foot of a heap the camera stands, rad; as the lower edge of each heap shows it where absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elevation_rad: Option<f64>,
    /// Largest standard error with which the angle may be known from one picture, rad; 3 degrees where absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_angle_error_rad: Option<f64>,
    /// The part of each picture that alone is looked at; all of it where absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<photo_profile::PixelRegion>,
    /// A picture that is black where something else than bed and air shows, beside the file or with its whole path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
    /// One picture of so many is taken: of several files one file, of one film or animation one picture in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every: Option<NonZeroUsize>,
    /// Centre and radius of the drum, px; found where absent.
    pub drum: Option<[f64; 3]>,
    /// Corners of a square in the plane of the drum's end, px.
    pub corners: Option<[[f64; 2]; 4]>,
    /// Tone of the bed against the air.
    pub foreground: photo_profile::Foreground,
    /// Time between two pictures that follow each other, taken or not, s; none where it is not known or not always the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_interval_s: Option<f64>,
    /// Time between the two pictures of a pair, s: the pictures then come in pairs, of which the first is measured and the
    /// second tells how far the surface went. None where each picture stands alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pair_interval_s: Option<f64>,
    /// Observables to be taken over besides the usual ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
    /// Observables that are not to be taken over.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub leave_out: Vec<String>,
}

/// A value that somebody published.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompareEntry {
    /// Name of the result beside which it is printed.
    pub result: String,
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sd: Option<f64>,
    /// Where it was published.
    pub source: String,
    /// Where it stands.
    #[serde(skip)]
    pub(crate) path: String,
}

/// How much may be run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Budget {
    /// Most runs.
    pub runs: Option<usize>,
    /// Most time of one core, h.
    pub core_hours: Option<f64>,
}

/// Tables that a profile may replace key by key.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Choices {
    /// Settings of the loop by key.
    pub design: Table,
    /// How much may be run.
    pub budget: Option<Budget>,
    /// Effects to search; the whole library where absent, none where empty.
    pub effects: Option<Vec<String>>,
    /// Published values.
    pub compare: Option<Vec<CompareEntry>>,
    /// Who does the runs, in a profile: the solver here, LAMMPS or LIGGGHTS; what the file says where absent.
    pub simulator: Option<SimulatorEntry>,
    /// Further changes by scene.
    pub changes: BTreeMap<String, Vec<String>>,
    /// Where the tables stand: empty, or the path of the profile.
    #[serde(skip)]
    pub(crate) path: String,
}

/// A study file as it stands, read and not yet resolved against its scenes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudyFile {
    /// Name; also that of the result folder.
    pub name: String,
    /// Who does the runs.
    pub simulator: SimulatorEntry,
    /// Effects that a program of the user has.
    pub effects: Vec<EffectEntry>,
    /// Scenes.
    pub scenes: Vec<SceneEntry>,
    /// Parameters, and behind them the inputs that have an error.
    pub parameters: Vec<ParameterEntry>,
    /// Scenes whose grains are coarser in the runs than the real ones; none if all have their real size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coarse_graining: Option<CoarseGrainingEntry>,
    /// Measurements.
    pub measured: Vec<MeasuredEntry>,
    /// What could be measured next; suggested by the measurements where absent.
    pub candidates: Option<Vec<CandidateEntry>>,
    /// Optional tables.
    pub choices: Choices,
    /// The same of the profiles.
    pub profiles: BTreeMap<String, Choices>,
}

impl StudyFile {
    /// Reads all entries; what cannot be read is told and left out.
    pub(crate) fn of(document: &Document, problems: &mut Problems) -> Self {
        let root = Fields::root(document);
        root.check_keys(&keys::STUDY, problems);
        let name: Option<String> = root.required("name", "a text", problems);
        let name = name.unwrap_or_default();
        if root.table.contains_key("name")
            && let Some(problem) = folder_name(&name)
        {
            problems.add(root.wrong("name", problem));
        }
        let simulator = simulator::simulator(&root, problems);
        let of_command = matches!(simulator, SimulatorEntry::Command(_));
        let effects = root.list("effect", problems);
        if !of_command && !effects.is_empty() {
            let problem = "are those of a program of the user: set kind = \"command\" in [simulator], or remove them";
            problems.add(document.problem("effect", "[[effect]]", problem));
        }
        let mut effects = parts::each(&effects, problems, simulator::effect);
        parts::refuse_twice(
            document,
            "effect",
            &mut effects,
            |e| (&e.name, &e.path),
            problems,
        );
        let candidates = root.list("candidate", problems);
        let candidates = parts::each(&candidates, problems, candidate::candidate);
        let candidates = root.table.contains_key("candidate").then_some(candidates);
        let mut list = |key: &str| {
            let found = root.list(key, problems);
            if found.is_empty() && !root.table.contains_key(key) {
                let problem = format!("has no [[{key}]]: a study needs at least one");
                problems.add(document.problem("", "the study", problem));
            }
            found
        };
        let (scenes, parameters, measured) = (list("scene"), list("parameter"), list("measured"));
        let (scene, parameter, input): (
            parts::ReadScene,
            parts::ReadParameter,
            parts::ReadParameter,
        ) = if of_command {
            (
                parts::command_scene,
                parts::command_parameter,
                input::command_input,
            )
        } else {
            (parts::scene, parts::parameter, input::input)
        };
        let mut parameters = parts::each(&parameters, problems, parameter);
        let measured = parts::each(&measured, problems, parts::measured);
        let inputs = parts::each(&root.list("input", problems), problems, input);
        parameters.extend(if of_command {
            input::with_error(inputs)
        } else {
            input::complete(document, inputs, &measured, problems)
        });
        let mut scenes: Vec<_> = parts::each(&scenes, problems, scene);
        parts::refuse_twice(
            document,
            "scene",
            &mut scenes,
            |s| (&s.name, &s.path),
            problems,
        );
        Self {
            name,
            scenes,
            simulator,
            effects,
            parameters,
            coarse_graining: coarse_graining::coarse_graining(&root, problems),
            measured,
            candidates,
            choices: choices::choices(&root, of_command, problems),
            profiles: profiles(&root, of_command, problems),
        }
    }
}

impl Choices {
    /// The same with those of a profile on top: keys that the profile does not name stay.
    #[must_use]
    pub(crate) fn under(mut self, profile: &Self) -> Self {
        for (key, value) in &profile.design {
            self.design.insert(key.clone(), value.clone());
        }
        for (scene, changes) in &profile.changes {
            let all = self.changes.entry(scene.clone()).or_default();
            all.extend(changes.iter().cloned());
        }
        Self {
            budget: profile.budget.or(self.budget),
            effects: profile.effects.clone().or(self.effects),
            compare: profile.compare.clone().or(self.compare),
            simulator: profile.simulator.clone().or(self.simulator),
            ..self
        }
    }
}

/// The profiles by name.
fn profiles(
    root: &Fields<'_>,
    of_command: bool,
    problems: &mut Problems,
) -> BTreeMap<String, Choices> {
    let mut found = BTreeMap::new();
    let Some(all) = root.table("profile", problems) else {
        return found;
    };
    for name in all.table.keys() {
        if let Some(problem) = folder_name(name) {
            let what = format!("[profile.{name}]");
            let document = root.document;
            problems.add(document.problem(&below(&all.path, name), what, problem));
        }
        if let Some(fields) = all.table(name, problems) {
            fields.check_keys(&keys::PROFILE, problems);
            let choices = choices::choices(&fields, of_command, problems);
            found.insert(name.clone(), choices);
        }
    }
    found
}

/// What is wrong with a name of which that of a result folder is made, as the rest of a sentence about it.
fn folder_name(name: &str) -> Option<String> {
    let usable = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
    if let Some(problem) = wrong_name(name) {
        return Some(problem);
    }
    (name.starts_with('.') || !name.chars().all(usable)).then(|| {
        "names the result folder: take letters, digits, '-', '_', '.' and blanks".to_owned()
    })
}

/// A value of a condition as text; none for what is no single value.
pub(crate) fn plain(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        // Negative zero, too, is the level 0.
        Value::Float(number) if *number == 0.0 => Some("0.0".to_owned()),
        Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => Some(value.to_string()),
        _ => None,
    }
}

/// Settings of a table by dotted path; tables inside are steps of the path.
pub(crate) fn settings(fields: &Fields<'_>, problems: &mut Problems) -> BTreeMap<String, String> {
    fn walk(table: &Table, path: &str, found: &mut BTreeMap<String, Result<String, String>>) {
        for (key, value) in table {
            let path = if path.is_empty() {
                key.clone()
            } else {
                format!("{path}.{key}")
            };
            match value {
                Value::Table(inner) => walk(inner, &path, found),
                _ => {
                    found.insert(path, level(value));
                }
            }
        }
    }
    /// A level becomes a part of the name of its model; a number is looked at with all others.
    fn level(value: &Value) -> Result<String, String> {
        match value.as_str().and_then(wrong_name) {
            Some(problem) => Err(problem),
            None => plain(value)
                .ok_or_else(|| "must be a number or a text, such as \"15 rpm\"".to_owned()),
        }
    }
    let mut found = BTreeMap::new();
    walk(fields.table, "", &mut found);
    let mut settings = BTreeMap::new();
    for (name, value) in found {
        match value {
            Ok(value) => drop(settings.insert(name, value)),
            Err(problem) => {
                let what = format!("{}: '{name}'", fields.words);
                let path = below(&fields.path, &name);
                problems.add(fields.document.problem(&path, what, problem));
            }
        }
    }
    settings
}
