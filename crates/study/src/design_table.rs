//! A design table as the runs of one scene.
//!
//! [`DesignTable::read`] turns a table, a scene and a few choices into a simulator and its requests. It reports all mistakes of the
//! table at once, before any run.

mod bind;
mod cells;
mod columns;
mod plan;
mod results;
mod rows;

use crate::Error;
use crate::problem::{Problem, Problems};
use campaign::run_store::{Record, Store};
use campaign::{Campaign, RunRequest, Simulator};
use columns::Columns;
use experiment_design::Factor;
use experiment_design::table::{Table, factors_from_table};
use rows::Asked;
use scene::{Override, Scene};
use simulators::scene_simulator::{Binding, SceneSimulator, read_scene};
use std::collections::BTreeMap;
use std::path::PathBuf;

pub use plan::DesignPlan;

/// Most runs of a table: a slip of the keyboard should not fill the memory.
const MOST_RUNS: usize = 1_000_000;

/// Everything that the runs of a design table follow from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DesignChoices {
    /// The table: one row for each run or cell of repeated runs.
    pub design: PathBuf,
    /// The scene that is run.
    pub scene: PathBuf,
    /// Table of the factors, if a column holds coded values alone or a factor has a unit.
    pub factors: Option<PathBuf>,
    /// Which settings a column sets: `COLUMN=PATH[,PATH]`, with the unit of plain numbers behind: `W=rpm`,
    /// `W=apparatus.speed [rpm]`.
    pub bind: Vec<String>,
    /// Parameters of a calibration, set in all runs before `set`.
    pub set_file: Option<PathBuf>,
    /// Changes of the scene, the same in all runs: `NAME=VALUE`.
    pub set: Vec<String>,
    /// Columns that set nothing.
    pub keep: Vec<String>,
    /// Runs of each row if the table has no column `replicates`; `None`: 1.
    pub replicates: Option<usize>,
    /// Seed of the first run if the table has no column `seed`; the others take those that follow.
    pub seed: u64,
}

/// A run of a design table.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRun {
    /// Line of its row in the table, from 1.
    pub line: usize,
    /// Number of its row among the rows, from 0.
    pub row: usize,
    /// Which run of its row it is, from 1.
    pub repeat: usize,
    /// Request for the run.
    pub request: RunRequest,
}

/// A design table, read and checked against its scene.
#[derive(Debug)]
pub struct DesignTable {
    /// What it was read from.
    choices: DesignChoices,
    /// The table as it was read.
    table: Table,
    /// Scenes by the name of the model: one for each combination of settings that are not numbers.
    models: BTreeMap<String, Scene>,
    /// The settings of each parameter of the requests.
    bindings: BTreeMap<String, Binding>,
    /// The runs, row by row.
    runs: Vec<DesignRun>,
    /// Warnings about the values of the parameter file.
    pub warnings: Vec<String>,
}

impl DesignTable {
    /// Reads a table and its scene.
    ///
    /// # Errors
    ///
    /// Files that cannot be read; [`Error::Problems`] with everything that is wrong with the table.
    pub fn read(choices: &DesignChoices) -> Result<Self, Error> {
        let mut problems = Problems::default();
        let (scene, warnings) = scene_of(choices, &mut problems)?;
        let factors = factors_of(choices)?;
        let table = command_line::table_file::read(&choices.design)?;
        let columns = Columns::read(choices, &table, &scene, &factors, &mut problems);
        let Asked {
            models,
            bindings,
            runs,
        } = Asked::read(choices, &table, &scene, &columns, &mut problems);
        problems.into_result()?;
        Ok(Self {
            choices: choices.clone(),
            table,
            models,
            bindings,
            runs,
            warnings,
        })
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.table.rows().len()
    }

    /// The runs, row by row.
    pub fn runs(&self) -> &[DesignRun] {
        &self.runs
    }

    /// The scenes that are run.
    pub fn scenes(&self) -> impl Iterator<Item = &Scene> {
        self.models.values()
    }

    /// Requests for the simulator, in the order of the runs.
    pub fn requests(&self) -> Vec<RunRequest> {
        self.runs.iter().map(|run| run.request.clone()).collect()
    }

    /// The simulator that the requests are for.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be read.
    pub fn simulator(&self) -> Result<SceneSimulator, Error> {
        let (models, bindings) = (self.models.clone(), self.bindings.clone());
        Ok(SceneSimulator::new(models, bindings)?)
    }

    /// Builds the scene of every row once and runs nothing: there is room for its seeds, its walls can be read. Rows
    /// whose first record a store has are left out.
    ///
    /// # Errors
    ///
    /// [`Error::Problems`] with every row that cannot be built; a record that cannot be read.
    pub fn check_builds(
        &self,
        simulator: &SceneSimulator,
        store: Option<&Store>,
    ) -> Result<(), Error> {
        let mut problems = Problems::default();
        for run in self.runs.iter().filter(|run| run.repeat == 1) {
            if plan::is_kept(simulator, &run.request, store)? {
                continue;
            }
            let built = simulator.scene_of(&run.request).and_then(|scene| {
                let built = scene.build_check(simulator.fillings());
                built.map_err(campaign::SimulatorError::other)
            });
            if let Err(error) = built {
                problems.add(Problem {
                    file: self.choices.design.display().to_string(),
                    line: Some(run.line),
                    what: "the row".to_owned(),
                    problem: format!("cannot be run: {}", cells::one_line(&error.in_full())),
                });
            }
        }
        problems.into_result()
    }

    /// Does all runs, or finds their records: for each run its record, or why there is none.
    ///
    /// # Errors
    ///
    /// A store that cannot be used; a campaign that was stopped, whose finished runs are in the store.
    pub fn run(
        &self,
        campaign: &Campaign<'_>,
        simulator: &dyn Simulator,
    ) -> Result<Vec<Result<Record, String>>, Error> {
        Ok(campaign.run_each(simulator, &self.requests())?)
    }

    /// The files that the runs follow from: table, scene, meshes, factors, parameters.
    pub fn input_files(&self) -> Vec<PathBuf> {
        let choices = &self.choices;
        let mut files = vec![
            command_line::table_file::file_of(&choices.design),
            choices.scene.clone(),
        ];
        files.extend(
            choices
                .factors
                .as_deref()
                .map(command_line::table_file::file_of),
        );
        files.extend(choices.set_file.clone());
        for scene in self.models.values() {
            for mesh in scene.shape_files() {
                let file = scene.folder.join(mesh);
                if !files.contains(&file) {
                    files.push(file);
                }
            }
        }
        files
    }
}

/// The scene with the changes of all runs, and what must be known of the values of a parameter file.
fn scene_of(
    choices: &DesignChoices,
    problems: &mut Problems,
) -> Result<(Scene, Vec<String>), Error> {
    let mut set = Vec::new();
    for text in &choices.set {
        match text.split_once('=') {
            Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
                set.push(Override {
                    name: name.trim().to_owned(),
                    value: value.trim().to_owned(),
                });
            }
            _ => problems.add(Problem {
                file: "--set".to_owned(),
                line: None,
                what: format!("'{text}'"),
                problem: "is not a setting with its value: write NAME=VALUE, such as rpm=20"
                    .to_owned(),
            }),
        }
    }
    let read = read_scene(&choices.scene, choices.set_file.as_deref(), &set)?;
    Ok((read.scene, read.warnings))
}

/// The factors of the table, by symbol.
fn factors_of(choices: &DesignChoices) -> Result<BTreeMap<String, Factor>, Error> {
    let Some(path) = &choices.factors else {
        return Ok(BTreeMap::new());
    };
    let factors = factors_from_table(&command_line::table_file::read(path)?).map_err(|error| {
        Error::Problems {
            list: vec![Problem {
                file: path.display().to_string(),
                line: None,
                what: "as a table of factors:".to_owned(),
                problem: error.to_string(),
            }],
        }
    })?;
    let by_symbol = factors.into_iter().map(|f| (f.symbol().to_owned(), f));
    Ok(by_symbol.collect())
}
