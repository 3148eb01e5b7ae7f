//! The `[simulator]` table: who does the runs.

use super::parts::NUMBER;
use super::photo::max_angle_error;
use crate::document::Fields;
use crate::keys;
use crate::limits::{LEAST_TIME_S, LONGEST_NAME, MOST_TIME_S};
use crate::plausible::wrong_name;
use crate::problem::Problems;
use input::quantity::Time;
use photo_profile::MAX_ANGLE_ERROR;
use serde::Serialize;
use simulators::external_simulator::{DrumDescription, Keep, Peer, ResultFiles};
use std::collections::BTreeMap;
use std::path::{Component, PathBuf};

/// Who does the runs of a study.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum SimulatorEntry {
    /// The solver here.
    #[default]
    Own,
    /// LAMMPS or LIGGGHTS, by exported decks.
    Peer(PeerEntry),
    /// A program of the user.
    Command(CommandEntry),
}

/// LAMMPS or LIGGGHTS as they are run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeerEntry {
    /// Which of them.
    pub peer: Peer,
    /// The command line.
    pub command: Vec<String>,
    /// Number of processes.
    pub ranks: usize,
    /// Environment variables.
    pub environment: BTreeMap<String, String>,
    /// Time limit of a run, s.
    pub wall_limit_s: f64,
    /// Folders of runs that are kept.
    pub keep: Keep,
}

/// A program of the user as it is run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CommandEntry {
    /// The command line, with places for values.
    pub command: Vec<String>,
    /// Folder of files for each run, relative to the study file.
    pub template: Option<PathBuf>,
    /// The user's word for the version of the program.
    pub version: String,
    /// Time limit of a run, s.
    pub wall_limit_s: f64,
    /// Time that a run is expected to take, s.
    pub expected_s: f64,
    /// Folders of runs that are kept.
    pub keep: Keep,
    /// What the program leaves.
    #[serde(skip)]
    pub results: ResultFiles,
}

/// Time limit of a run where none is stated, s.
const WALL_LIMIT_S: f64 = 86_400.0;
/// Expected time of a run where none is stated, s.
const EXPECTED_S: f64 = 60.0;

/// The table, or the solver here where it is absent.
pub(super) fn simulator(root: &Fields<'_>, problems: &mut Problems) -> SimulatorEntry {
    let Some(fields) = root.table("simulator", problems) else {
        return SimulatorEntry::Own;
    };
    let kind: Option<String> = fields.required("kind", KINDS, problems);
    match kind.as_deref() {
        Some("own") => {
            fields.check_keys(&["kind"], problems);
            SimulatorEntry::Own
        }
        Some("lammps") => peer(Peer::Lammps, &fields, problems),
        Some("liggghts") => peer(Peer::Liggghts, &fields, problems),
        Some("command") => command(&fields, problems),
        Some(_) => {
            problems.add(fields.wrong("kind", format!("must be {KINDS}")));
            SimulatorEntry::Own
        }
        None => SimulatorEntry::Own,
    }
}

/// What the kind must be, for messages.
const KINDS: &str = "\"own\", \"lammps\", \"liggghts\" or \"command\"";
/// What a command line must be, for messages.
const LINE: &str = "a list of texts, the program first";

/// LAMMPS or LIGGGHTS.
fn peer(peer: Peer, fields: &Fields<'_>, problems: &mut Problems) -> SimulatorEntry {
    fields.check_keys(&keys::SIMULATOR_PEER, problems);
    let command: Option<Vec<String>> = fields.optional("command", LINE, problems);
    let mut command = command.unwrap_or_else(|| vec![peer.program().to_owned()]);
    let ranks: Option<usize> = fields.optional("ranks", "a whole number", problems);
    match ranks {
        Some(0) => problems.add(fields.wrong("ranks", "must be 1 or more")),
        Some(ranks) if ranks > 1 => {
            let launcher = ["mpirun".to_owned(), "-np".to_owned(), ranks.to_string()];
            command.splice(0..0, launcher);
        }
        _ => {}
    }
    if command.is_empty() {
        problems.add(fields.wrong("command", "names no program"));
    }
    SimulatorEntry::Peer(PeerEntry {
        peer,
        command,
        ranks: ranks.unwrap_or(1),
        environment: fields
            .optional("environment", "a table of texts", problems)
            .unwrap_or_default(),
        wall_limit_s: time(fields, "wall_limit", WALL_LIMIT_S, problems),
        keep: keep(fields, problems),
    })
}

/// A program of the user.
fn command(fields: &Fields<'_>, problems: &mut Problems) -> SimulatorEntry {
    fields.check_keys(&keys::SIMULATOR_COMMAND, problems);
    let results = match fields.table("results", problems) {
        Some(table) => {
            table.check_keys(&keys::RESULTS, problems);
            let mut path = |key: &str| inside(&table, key, problems);
            ResultFiles {
                observables: path("observables"),
                positions: path("positions"),
                pictures: path("pictures"),
            }
        }
        None => ResultFiles {
            observables: Some("results.json".into()),
            ..ResultFiles::default()
        },
    };
    let command: Vec<String> = fields
        .required("command", LINE, problems)
        .unwrap_or_default();
    if command
        .first()
        .is_some_and(|program| program.trim().is_empty())
    {
        problems.add(fields.wrong("command", "begins with no program"));
    }
    let version: Option<String> = fields.required(
        "version",
        "a text that changes when the program does",
        problems,
    );
    if let Some(problem) = version.as_deref().and_then(wrong_name) {
        problems.add(fields.wrong("version", problem));
    }
    SimulatorEntry::Command(CommandEntry {
        command,
        template: fields.optional("template", "the path of a folder", problems),
        version: version.unwrap_or_default(),
        wall_limit_s: time(fields, "wall_limit", WALL_LIMIT_S, problems),
        expected_s: time(fields, "expected", EXPECTED_S, problems),
        keep: keep(fields, problems),
        results,
    })
}

/// A path in the folder of a run.
fn inside(table: &Fields<'_>, key: &str, problems: &mut Problems) -> Option<PathBuf> {
    let path: Option<PathBuf> = table.optional(key, "a path", problems);
    let path = path?;
    let leads_inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    if !path.components().all(leads_inside) {
        let problem = "leads out of the folder of the run: name what the program leaves there";
        problems.add(table.wrong(key, problem));
    } else if path.file_name().is_none() || path.iter().any(|part| part.len() > LONGEST_NAME) {
        let problem =
            format!("must name a file, each part of its path of at most {LONGEST_NAME} bytes");
        problems.add(table.wrong(key, problem));
    }
    Some(path)
}

/// A time above 0 with its unit, s.
fn time(fields: &Fields<'_>, key: &str, default: f64, problems: &mut Problems) -> f64 {
    let Some(text) = fields.optional::<String>(key, "a time such as \"30 min\"", problems) else {
        return default;
    };
    match Time::parse(&text) {
        Ok(time) if (LEAST_TIME_S..=MOST_TIME_S).contains(&time.si()) => return time.si(),
        Ok(_) => problems.add(fields.wrong(key, "must be 1 ms to a year")),
        Err(error) => problems.add(fields.wrong(key, format!(": {error}"))),
    }
    default
}

/// Which folders are kept.
fn keep(fields: &Fields<'_>, problems: &mut Problems) -> Keep {
    let keep = fields.optional("keep", "\"failed\" or \"all\"", problems);
    keep.unwrap_or_default()
}

/// The drum of a scene of a program.
pub(super) fn drum(fields: &Fields<'_>, problems: &mut Problems) -> Option<DrumDescription> {
    fields.check_keys(&keys::DRUM, problems);
    let length = "a length such as \"60 mm\"";
    let inner_diameter = fields.required("inner_diameter", length, problems);
    let width = fields.required("width", length, problems);
    let speed = fields.required("speed", "a speed such as \"{rpm} rpm\"", problems);
    let centre = fields.optional("centre", "three lengths", problems);
    let mut text = |key: &str| fields.optional(key, "a text", problems);
    let (axis, up) = (text("axis"), text("up"));
    let (interval, time_step, start_up) = (text("interval"), text("time_step"), text("start_up"));
    let gravity: Option<f64> = fields.optional("gravity_m_s2", NUMBER, problems);
    if gravity.is_some_and(|g| !(g.is_finite() && g > 0.0)) {
        problems.add(fields.wrong("gravity_m_s2", "must be above 0"));
    }
    let pixels: Option<u32> = fields.optional("pixels", "a whole number", problems);
    Some(DrumDescription {
        inner_diameter: inner_diameter?,
        width: width?,
        speed: speed?,
        centre: centre.unwrap_or_else(|| ["0 mm", "0 mm", "0 mm"].map(str::to_owned)),
        axis: axis.unwrap_or_else(|| "z".into()),
        up: up.unwrap_or_else(|| "y".into()),
        gravity_m_s2: gravity.unwrap_or(9.81),
        interval,
        time_step,
        start_up,
        pixels: pixels.unwrap_or(480),
        max_angle_error: max_angle_error(fields, problems).unwrap_or(MAX_ANGLE_ERROR),
    })
}

/// An effect that a program of the user can switch on: a value as that of a parameter, 0 where it is off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectEntry {
    /// Name of the value.
    pub name: String,
    /// Amplitude at which its influence is measured.
    pub probe: f64,
    /// Smallest and greatest amplitude that is possible.
    pub range: [f64; 2],
    /// Where it stands.
    #[serde(skip)]
    pub(crate) path: String,
}

/// An `[[effect]]`.
pub(super) fn effect(fields: &Fields<'_>, problems: &mut Problems) -> Option<EffectEntry> {
    fields.check_keys(&keys::EFFECT, problems);
    let name: Option<String> = fields.required("name", "a text", problems);
    let probe: Option<f64> = fields.required("probe", NUMBER, problems);
    let range: Option<[f64; 2]> = fields.required("range", "two numbers", problems);
    if let (Some(probe), Some([low, high])) = (probe, range) {
        let sound = low.is_finite() && high.is_finite() && low <= 0.0 && high >= 0.0 && low < high;
        if !sound {
            let problem = "must be two finite numbers around 0, at which the effect is off";
            problems.add(fields.wrong("range", problem));
        } else if probe == 0.0 || !(low..=high).contains(&probe) {
            problems.add(fields.wrong("probe", "must lie in the range, and not at 0"));
        }
    }
    Some(EffectEntry {
        name: name?,
        probe: probe?,
        range: range?,
        path: fields.path.clone(),
    })
}

/// Names of a value that may be written in a command line and as a variable.
pub(crate) fn usable_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(char::is_alphabetic)
        && letters.all(|c| c.is_alphanumeric() || "_-.".contains(c))
}
