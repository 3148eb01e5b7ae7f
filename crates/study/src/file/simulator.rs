//! `[simulator]`: who does the runs.

use crate::document::below;
use crate::limits::{LEAST_TIME_S, LONGEST_NAME, MOST_TIME_S};
use crate::plausible::wrong_name;
use crate::problem::Problems;
use input::quantity::Time;
use serde::Deserialize;
use simulators::external_simulator::{Keep, Peer, ResultFiles};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Time limit of a run if none is stated, s.
const WALL_LIMIT_S: f64 = 86_400.0;
/// Expected time of a run if none is stated, s.
const EXPECTED_S: f64 = 60.0;

/// Who does the runs of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SimulatorKind {
    /// The solver here.
    #[default]
    Own,
    Lammps,
    Liggghts,
    /// A program of the user.
    Command,
}

/// The table; each kind has keys of its own.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SimulatorTable {
    pub(crate) kind: SimulatorKind,
    /// The command line, the program first; of a program of the user with places for values.
    command: Option<Vec<String>>,
    /// Number of processes.
    ranks: Option<usize>,
    #[serde(default)]
    pub(crate) environment: BTreeMap<String, String>,
    /// Folder of files for each run, relative to the study file.
    pub(crate) template: Option<PathBuf>,
    /// The user's word for the version of the program.
    pub(crate) version: Option<String>,
    wall_limit: Option<Time>,
    expected: Option<Time>,
    /// Folders of runs that are kept.
    #[serde(default)]
    pub(crate) keep: Keep,
    /// What the program leaves; `None`: observables in `results.json`.
    results: Option<ResultFiles>,
}

impl SimulatorKind {
    /// Keys that the table of this kind may have.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Own => &["kind"],
            Self::Lammps | Self::Liggghts => &[
                "kind",
                "command",
                "ranks",
                "environment",
                "wall_limit",
                "keep",
            ],
            Self::Command => &[
                "kind",
                "command",
                "template",
                "version",
                "wall_limit",
                "expected",
                "keep",
                "results",
            ],
        }
    }
}

impl SimulatorTable {
    /// The other code that runs the scenes.
    pub(crate) fn peer(&self) -> Option<Peer> {
        match self.kind {
            SimulatorKind::Lammps => Some(Peer::Lammps),
            SimulatorKind::Liggghts => Some(Peer::Liggghts),
            SimulatorKind::Own | SimulatorKind::Command => None,
        }
    }

    pub(crate) fn ranks(&self) -> usize {
        self.ranks.unwrap_or(1)
    }

    /// The command line: the usual program if none is stated, behind `mpirun` if it has several processes.
    pub(crate) fn command(&self) -> Vec<String> {
        let usual = self.peer().map(|peer| vec![peer.program().to_owned()]);
        let mut command = self.command.clone().or(usual).unwrap_or_default();
        if self.ranks() > 1 {
            let launcher = [
                "mpirun".to_owned(),
                "-np".to_owned(),
                self.ranks().to_string(),
            ];
            command.splice(0..0, launcher);
        }
        command
    }

    pub(crate) fn wall_limit_s(&self) -> f64 {
        self.wall_limit.map_or(WALL_LIMIT_S, Time::si)
    }

    pub(crate) fn expected_s(&self) -> f64 {
        self.expected.map_or(EXPECTED_S, Time::si)
    }

    pub(crate) fn results(&self) -> ResultFiles {
        self.results.clone().unwrap_or(ResultFiles {
            observables: Some("results.json".into()),
            ..ResultFiles::default()
        })
    }

    /// Refuses keys of another kind, and what no program can be started with.
    pub(super) fn check(&self, path: &str, problems: &mut Problems) {
        let at = |key: &str| below(path, key);
        let stated = problems
            .document
            .value(path)
            .and_then(toml::Value::as_table);
        let stated: Vec<String> = stated
            .into_iter()
            .flat_map(toml::Table::keys)
            .cloned()
            .collect();
        let known = self.kind.keys();
        for key in stated.iter().filter(|key| !known.contains(&key.as_str())) {
            let problem = format!(
                "key of another kind of simulator; this has {}",
                known.join(", ")
            );
            problems.wrong(&at(key), problem);
        }
        problems.require(self.ranks != Some(0), &at("ranks"), "must be 1 or more");
        let program = self
            .command
            .as_ref()
            .map(|line| line.first().map_or("", |p| p.trim()));
        problems.require(
            program != Some(""),
            &at("command"),
            "names no program: add it",
        );
        for (key, time) in [("wall_limit", self.wall_limit), ("expected", self.expected)] {
            let possible = |time: Time| (LEAST_TIME_S..=MOST_TIME_S).contains(&time.si());
            problems.require(
                time.is_none_or(possible),
                &at(key),
                "must be 1 ms to a year",
            );
        }
        if self.kind == SimulatorKind::Command {
            for key in ["command", "version"] {
                let problem = format!("has no '{key}': add it");
                problems.require(stated.iter().any(|s| s == key), path, &problem);
            }
            if let Some(problem) = self.version.as_deref().and_then(wrong_name) {
                problems.wrong(&at("version"), problem);
            }
        }
        let results = self.results.iter();
        for (key, file) in results.flat_map(|r| {
            [
                ("observables", &r.observables),
                ("positions", &r.positions),
                ("pictures", &r.pictures),
            ]
        }) {
            if let Some(problem) = file.as_deref().and_then(not_inside) {
                problems.wrong(&below(&at("results"), key), problem);
            }
        }
    }
}

/// Why a path is not one in the folder of a run.
fn not_inside(path: &Path) -> Option<String> {
    let stays = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    if !path.components().all(stays) {
        return Some("must stay inside the folder of the run".into());
    }
    let is_wrong = path.file_name().is_none() || path.iter().any(|part| part.len() > LONGEST_NAME);
    is_wrong
        .then(|| format!("must name a file, each part of its path of at most {LONGEST_NAME} bytes"))
}
