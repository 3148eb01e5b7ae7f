//! The tables of a study file, as serde reads them. What no type can refuse is in `file/check.rs`.

mod check;
mod input;
mod measured;
mod photo;
mod simulator;

pub(crate) use check::usable_name;
pub(crate) use input::InputEntry;
pub(crate) use measured::{CurveEntry, MeasuredEntry};
pub(crate) use photo::PhotoOptions;
pub(crate) use simulator::{SimulatorKind, SimulatorTable};

use crate::plausible::wrong_name;
use crate::problem::Problems;
use inference::Prior;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use simulators::external_simulator::DrumDescription;
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::{Table, Value};

/// A study file, read and not yet resolved against its scenes.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StudyFile {
    /// Name; also that of the result folder.
    pub(crate) name: String,
    pub(crate) simulator: SimulatorTable,
    /// Effects of a program of the user.
    pub(crate) effect: Vec<EffectEntry>,
    pub(crate) scene: Vec<SceneEntry>,
    /// Parameters; once the file is checked, the inputs that have an error follow them.
    pub(crate) parameter: Vec<ParameterEntry>,
    input: Vec<InputEntry>,
    pub(crate) coarse_graining: Option<CoarseGrainingEntry>,
    pub(crate) measured: Vec<MeasuredEntry>,
    /// What could be measured next; `None`: conditions that the measurements suggest.
    pub(crate) candidate: Option<Vec<CandidateEntry>>,
    /// Published values.
    pub compare: Vec<CompareEntry>,
    /// Settings of the loop by key.
    pub(crate) design: Table,
    /// How much may be run.
    pub budget: Budget,
    pub(crate) effects: EffectsTable,
    profile: BTreeMap<String, Profile>,
}

/// A simulated scene: a scene file with changes, or what a program of the user knows by a name.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SceneEntry {
    #[serde(rename = "(path)")]
    pub(crate) path: String,
    pub(crate) name: String,
    /// Scene file, relative to the study file.
    pub(crate) file: Option<PathBuf>,
    /// Changes of it, `name = value`, as after `--set`; those of the profile come last.
    #[serde(default)]
    pub(crate) changes: Vec<String>,
    /// Another apparatus instead of that of the file.
    pub(crate) apparatus: Option<Table>,
    /// Observables that a program of the user reports.
    #[serde(default)]
    pub(crate) observables: Vec<String>,
    /// Parameters on which runs of a program of the user depend; `None`: all.
    pub(crate) parameters: Option<Vec<String>>,
    /// The drum that a program of the user shows.
    pub(crate) drum: Option<DrumDescription>,
}

/// A parameter that may be tuned, or an input.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ParameterEntry {
    /// Empty for an input that the file leaves out.
    #[serde(rename = "(path)")]
    pub(crate) path: String,
    pub(crate) symbol: String,
    /// What it is; `None`: the first path.
    pub(crate) name: Option<String>,
    /// Dotted paths of the settings that it sets; its symbol for a program of the user.
    #[serde(default)]
    pub(crate) sets: Vec<String>,
    /// Unit, if the settings are quantities.
    pub(crate) unit: Option<String>,
    /// Where the search begins.
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// What is physically possible; `None`: by the kind of setting.
    pub(crate) limits: Option<[f64; 2]>,
    /// Value in use before; `None`: that of the first scene.
    pub(crate) start: Option<f64>,
    /// Knowledge beside the measurements.
    pub(crate) prior: Option<Prior>,
    /// Whether it is an `[[input]]`: stated with an error, and not tuned.
    #[serde(skip)]
    pub(crate) is_input: bool,
    /// The effect of the library whose amplitude it is, instead of settings.
    #[serde(skip)]
    pub(crate) effect: Option<String>,
    /// Scenes on which it acts; `None`: all.
    #[serde(skip)]
    pub(crate) scenes: Option<Vec<String>>,
}

/// A measured mean, or a measured standard deviation; the fields are those of [`inference::Measurement`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "StatedValue")]
pub struct MeasuredValue {
    /// Mean, in the unit of the observable.
    pub mean: f64,
    /// Standard deviation of the single values.
    pub sd: f64,
    /// Number of independent values, above 0.
    pub n: f64,
    /// Whether it is the standard deviation of n + 1 values.
    #[serde(skip)]
    pub is_scatter: bool,
}

impl MeasuredValue {
    /// A mean of independent values.
    pub(crate) fn of_mean(mean: f64, sd: f64, n: f64) -> Self {
        Self {
            mean,
            sd,
            n,
            is_scatter: false,
        }
    }

    /// The standard deviation s of so many independent values.
    ///
    /// # Formula
    ///
    /// Standard error of s: `s / sqrt(2 (number - 1))`.
    pub(crate) fn of_scatter(s: f64, number: f64) -> Self {
        Self {
            mean: s,
            sd: s * std::f64::consts::FRAC_1_SQRT_2,
            n: number - 1.0,
            is_scatter: true,
        }
    }
}

/// The same as a study file states it.
#[derive(Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a measurement { mean = ..., sd = ..., n = ... }, or { scatter = ..., n = ... }; keys of [[measured]] are scene, condition, role, photos, photo, curve, correlation"
)]
struct StatedValue {
    mean: Option<f64>,
    sd: Option<f64>,
    n: f64,
    scatter: Option<f64>,
}

impl TryFrom<StatedValue> for MeasuredValue {
    type Error = &'static str;

    fn try_from(stated: StatedValue) -> Result<Self, Self::Error> {
        match (stated.mean, stated.sd, stated.scatter) {
            (Some(mean), Some(sd), None) => Ok(Self::of_mean(mean, sd, stated.n)),
            (None, None, Some(s)) => Ok(Self::of_scatter(s, stated.n)),
            (_, _, Some(_)) => {
                Err("scatter is the standard deviation of n values: leave out mean and sd")
            }
            (None, _, None) => Err("missing field `mean`"),
            (_, None, None) => Err("missing field `sd`"),
        }
    }
}

/// How the means of two observables of one measurement go together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredCorrelation {
    /// One observable.
    pub a: String,
    /// The other.
    pub b: String,
    /// Correlation of their means, between -1 and 1.
    pub value: f64,
}

/// A measurement that could be made next.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CandidateEntry {
    #[serde(rename = "(path)")]
    pub(crate) path: String,
    pub(crate) scene: String,
    #[serde(default, deserialize_with = "condition")]
    pub(crate) condition: BTreeMap<String, String>,
    /// What would be measured; `None`: what the study measures on the scene.
    pub(crate) observables: Option<Vec<String>>,
    /// Standard deviation of the single values, by observable; if it is left out, that of the same one elsewhere.
    #[serde(default)]
    pub(crate) sd: BTreeMap<String, f64>,
    /// Number of independent values; `None`: as elsewhere.
    pub(crate) n: Option<f64>,
    /// Work in the laboratory, min; `None`: 1.
    pub(crate) minutes: Option<f64>,
}

/// A value that somebody published.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompareEntry {
    #[serde(rename = "(path)")]
    pub(crate) path: String,
    /// Name of the result beside which it is printed.
    pub result: String,
    /// In the unit of the result.
    pub value: f64,
    /// Its standard deviation.
    pub sd: Option<f64>,
    /// Where it was published.
    pub source: String,
}

/// The sizes of the grains of the runs, if they are coarser than the real ones.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CoarseGrainingEntry {
    /// Names of the scenes whose grains are coarser in the runs.
    pub(crate) scenes: Vec<String>,
    /// Diameter of the grains over the real one; once the file is checked, the coarsest first.
    pub(crate) factors: Vec<f64>,
    /// Largest standard error of what is carried to the real size, in standard errors of what was measured.
    pub(crate) error: Option<f64>,
}

/// An effect that a program of the user can switch on: a value like that of a parameter, 0 if it is off.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EffectEntry {
    #[serde(rename = "(path)")]
    pub(crate) path: String,
    pub(crate) name: String,
    /// Amplitude at which its influence is measured.
    pub(crate) probe: f64,
    /// Smallest and greatest amplitude that is possible.
    pub(crate) range: [f64; 2],
}

/// How much may be run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Budget {
    /// Most runs.
    pub runs: Option<usize>,
    /// Most time of one core, h.
    pub core_hours: Option<f64>,
}

/// Effects to search.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct EffectsTable {
    /// `None`: the whole library.
    pub(crate) search: Option<Vec<String>>,
}

/// What `--profile` puts on top of the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Profile {
    #[serde(rename = "(path)")]
    path: String,
    #[serde(default)]
    design: Table,
    budget: Option<Budget>,
    #[serde(default)]
    effects: EffectsTable,
    compare: Option<Vec<CompareEntry>>,
    #[serde(default)]
    scene: BTreeMap<String, SceneChanges>,
    simulator: Option<SimulatorTable>,
}

/// Further changes of a scene in a profile.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneChanges {
    changes: Vec<String>,
}

impl StudyFile {
    /// Reads and checks all entries and puts a profile on top; an entry with a fault is reported and left out.
    pub(crate) fn read(profile: Option<&str>, problems: &mut Problems) -> Self {
        let (file, found) = problems.document.read::<Self>("");
        problems.extend(found);
        let Some(mut file) = file else {
            return Self::default();
        };
        file.check(problems);
        if let Some(name) = profile {
            file.apply(name, problems);
        }
        file
    }

    /// Puts a profile on top: keys that it does not name stay, and its changes of a scene come last.
    fn apply(&mut self, name: &str, problems: &mut Problems) {
        let Some(profile) = self.profile.get(name) else {
            let known: Vec<&str> = self.profile.keys().map(String::as_str).collect();
            let known = match known.as_slice() {
                [] => "the file has no profile".to_owned(),
                _ => format!("the profiles are {}", known.join(", ")),
            };
            return problems.wrong("profile", format!("'{name}' is not defined; {known}"));
        };
        self.design.extend(profile.design.clone());
        self.budget = profile.budget.unwrap_or(self.budget);
        self.effects.search = profile
            .effects
            .search
            .clone()
            .or(self.effects.search.take());
        self.compare = profile
            .compare
            .clone()
            .unwrap_or(std::mem::take(&mut self.compare));
        self.simulator = profile
            .simulator
            .clone()
            .unwrap_or(std::mem::take(&mut self.simulator));
        for scene in &mut self.scene {
            let further = profile.scene.get(&scene.name);
            scene
                .changes
                .extend(further.into_iter().flat_map(|s| s.changes.iter().cloned()));
        }
    }

    /// Names of the scenes, as a message lists them.
    pub(crate) fn scene_names(&self) -> String {
        let names: Vec<&str> = self.scene.iter().map(|s| s.name.as_str()).collect();
        names.join(", ")
    }

    /// Whether a program of the user does the runs.
    pub(crate) fn is_of_command(&self) -> bool {
        self.simulator.kind == SimulatorKind::Command
    }
}

/// The settings of a condition by dotted path, with their values as text; tables inside are steps of the path.
fn condition<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<String, String>, D::Error> {
    fn walk(table: &Table, path: &str, found: &mut BTreeMap<String, String>) -> Result<(), String> {
        for (key, value) in table {
            let path = match path {
                "" => key.clone(),
                _ => format!("{path}.{key}"),
            };
            let level = match value {
                Value::Table(inner) => {
                    walk(inner, &path, found)?;
                    continue;
                }
                Value::String(text) => text.clone(),
                // Negative zero, too, is the level 0.
                Value::Float(number) if *number == 0.0 => "0.0".to_owned(),
                Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => value.to_string(),
                _ => {
                    return Err(format!(
                        "'{path}' must be a number or a text, such as \"15 rpm\""
                    ));
                }
            };
            // A level becomes a part of the name of its model.
            if let Some(problem) = wrong_name(&level) {
                return Err(format!("'{path}' {problem}"));
            }
            found.insert(path, level);
        }
        Ok(())
    }
    let mut found = BTreeMap::new();
    walk(&Table::deserialize(from)?, "", &mut found).map_err(D::Error::custom)?;
    Ok(found)
}
