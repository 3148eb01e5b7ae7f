//! From the rows of a design table to requests.

use super::cells::{Change, one_line};
use super::columns::{Columns, REPLICATES, Role, SEED, Setter};
use super::{DesignChoices, DesignRun, MOST_RUNS};
use crate::problem::{Problem, Problems};
use campaign::RunRequest;
use experiment_design::Factor;
use experiment_design::table::{Row, Table};
use scene::{Override, Scene};
use simulators::scene_simulator::Binding;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Share of the half-range by which coded and natural values may differ: they are written in full precision, and a
/// spreadsheet keeps 15 digits.
const AGREES: f64 = 1e-9;

/// The runs of a table with the models and parameters that they name.
#[derive(Debug, Default)]
pub(super) struct Asked {
    /// Scenes by the name of the model.
    pub(super) models: BTreeMap<String, Scene>,
    /// The settings of each parameter.
    pub(super) bindings: BTreeMap<String, Binding>,
    /// The runs, row by row.
    pub(super) runs: Vec<DesignRun>,
}

/// What the rows are read with.
struct Reader<'a> {
    /// What was chosen.
    choices: &'a DesignChoices,
    table: &'a Table,
    scene: &'a Scene,
    /// The roles of the columns.
    columns: &'a Columns,
    /// Whether all columns are right, so that a whole row can be judged and not its cells alone.
    sound: bool,
}

/// A cell that changes settings.
struct Cell<'a> {
    /// Number of its column.
    column: usize,
    /// What its column sets.
    setter: &'a Setter,
    change: Change,
}

impl Asked {
    /// Reads all rows.
    pub(super) fn read(
        choices: &DesignChoices,
        table: &Table,
        scene: &Scene,
        columns: &Columns,
        problems: &mut Problems,
    ) -> Self {
        let reader = Reader {
            choices,
            table,
            scene,
            columns,
            sound: problems.count() == 0,
        };
        let mut read = Self::default();
        reader.check_replicates(problems);
        for (i, row) in table.rows().iter().enumerate() {
            let repeats = reader.repeats(row, problems);
            let seed = reader.own_seed(row, problems);
            let cells = reader.cells(row, problems);
            let request = read.request(&reader, row, &cells, problems);
            let (Some(repeats), Some(seed), Some(request)) = (repeats, seed, request) else {
                continue;
            };
            let first = seed.or_else(|| choices.seed.checked_add(read.runs.len() as u64));
            if read.runs.len().saturating_add(repeats) > MOST_RUNS {
                let problem = format!("brings the table to more than {MOST_RUNS} runs: part it");
                problems.add(reader.of_row(row, problem));
                break;
            }
            for repeat in 1..=repeats {
                let seed = first.and_then(|first| first.checked_add(repeat as u64 - 1));
                let Some(seed) = seed else {
                    let problem = "seed exceeds 2^64 - 1: use a smaller one".to_owned();
                    problems.add(reader.of_row(row, problem));
                    break;
                };
                read.runs.push(DesignRun {
                    line: row.line(),
                    row: i,
                    repeat,
                    request: request.clone().with_seed(seed),
                });
            }
        }
        if columns.place(&Role::Seed).is_some() {
            reader.refuse_same_runs(&read.runs, problems);
        }
        read
    }

    /// The request of a row, whose model and parameters are noted; `None` of a row that is wrong, which is reported.
    fn request(
        &mut self,
        reader: &Reader<'_>,
        row: &Row,
        cells: &[Cell<'_>],
        problems: &mut Problems,
    ) -> Option<RunRequest> {
        let words: Vec<Override> = cells
            .iter()
            .flat_map(|c| c.change.words(c.setter))
            .collect();
        let name = reader.model_name(&words);
        let known = self.models.get(&name).cloned();
        let model = known.map_or_else(|| reader.scene.with(&words), Ok);
        let numbers: Vec<Override> = cells
            .iter()
            .flat_map(|c| c.change.numbers(c.setter))
            .collect();
        let whole = model.and_then(|model| model.with(&numbers).map(|_| model));
        let model = match whole {
            Ok(model) => model,
            Err(error) => {
                reader.blame(row, cells, &error, problems);
                return None;
            }
        };
        if !reader.is_whole(cells) {
            return None;
        }
        self.models.entry(name.clone()).or_insert(model);
        let mut request = RunRequest::new(&name, 0);
        for cell in cells {
            if let Change::Number {
                symbol,
                value,
                unit,
            } = &cell.change
            {
                request = request.with_parameter(symbol, *value);
                let binding = || Binding {
                    paths: cell.setter.paths.clone(),
                    unit: unit.clone(),
                };
                self.bindings.entry(symbol.clone()).or_insert_with(binding);
            }
        }
        Some(request)
    }
}

impl<'a> Reader<'a> {
    fn of_cell(&self, row: &Row, column: usize, problem: String) -> Problem {
        Problem {
            file: self.choices.design.display().to_string(),
            line: Some(row.line()),
            what: format!(
                "{}: '{}'",
                self.table.place_in_row(row, column),
                row.text(column)
            ),
            problem,
        }
    }

    /// A problem of a whole row.
    fn of_row(&self, row: &Row, problem: String) -> Problem {
        Problem {
            file: self.choices.design.display().to_string(),
            line: Some(row.line()),
            what: "the row".to_owned(),
            problem,
        }
    }

    /// Refuses two numbers of repeats, and none at all.
    fn check_replicates(&self, problems: &mut Problems) {
        let problem = match (
            self.choices.replicates,
            self.columns.place(&Role::Replicates),
        ) {
            (Some(0), _) => "is 0: give the number of runs of each row, 1 or more".to_owned(),
            (Some(n), Some(_)) => {
                format!("is {n}, and the table has a column '{REPLICATES}': leave out one of them")
            }
            _ => return,
        };
        problems.add(Problem {
            file: self.choices.design.display().to_string(),
            line: None,
            what: "--replicates".to_owned(),
            problem,
        });
    }

    /// Number of runs of a row.
    fn repeats(&self, row: &Row, problems: &mut Problems) -> Option<usize> {
        let Some(column) = self.columns.place(&Role::Replicates) else {
            return Some(self.choices.replicates.unwrap_or(1));
        };
        let read = row.text(column).parse().ok().filter(|n| *n >= 1);
        if read.is_none() {
            let problem = "is not a number of runs: write a whole number, 1 or more".to_owned();
            problems.add(self.of_cell(row, column, problem));
        }
        read
    }

    /// The seed that a row states, `Some(None)` if the table has none.
    #[expect(
        clippy::option_option,
        reason = "wrong, absent and there are three cases"
    )]
    fn own_seed(&self, row: &Row, problems: &mut Problems) -> Option<Option<u64>> {
        let Some(column) = self.columns.place(&Role::Seed) else {
            return Some(None);
        };
        let read = row.text(column).parse().ok();
        if read.is_none() {
            let problem = format!(
                "is not a seed: write a whole number, 0 or more, or leave out the column '{SEED}'"
            );
            problems.add(self.of_cell(row, column, problem));
        }
        read.map(Some)
    }

    /// The cells of a row that change settings, without those that cannot be read.
    fn cells(&self, row: &Row, problems: &mut Problems) -> Vec<Cell<'a>> {
        let mut cells = Vec::new();
        for (column, role) in self.columns.roles.iter().enumerate() {
            match role {
                Some(Role::Sets(setter)) => match Change::read(row.text(column), setter) {
                    Ok(change) => cells.push(Cell {
                        column,
                        setter,
                        change,
                    }),
                    Err(problem) => problems.add(self.of_cell(row, column, problem)),
                },
                Some(Role::Coded {
                    factor: Some(factor),
                    natural,
                }) => {
                    if let Err(problem) = agrees(row.text(column), row.text(*natural), factor) {
                        problems.add(self.of_cell(row, column, problem));
                    }
                }
                _ => {}
            }
        }
        cells
    }

    /// Name of the scene with words changed.
    fn model_name(&self, words: &[Override]) -> String {
        let stem = self.choices.scene.file_stem().unwrap_or_default();
        let mut name = stem.to_string_lossy().into_owned();
        for word in words {
            write!(name, " {}={}", word.name, word.value).expect("a string takes all text");
        }
        name
    }

    /// Whether these are all cells of a row, without a wrong one.
    fn is_whole(&self, cells: &[Cell<'_>]) -> bool {
        let roles = self.columns.roles.iter().flatten();
        let setters = roles.filter(|role| matches!(role, Role::Sets(_)));
        self.sound && cells.len() == setters.count()
    }

    /// States which cells of a row the scene refuses each for itself, or else that it refuses them together.
    fn blame(
        &self,
        row: &Row,
        cells: &[Cell<'_>],
        together: &scene::Error,
        problems: &mut Problems,
    ) {
        let before = problems.count();
        for cell in cells {
            let words = self.scene.with(&cell.change.words(cell.setter));
            let alone = words.and_then(|scene| scene.with(&cell.change.numbers(cell.setter)));
            if let Err(error) = alone {
                let problem = format!("is refused: {}", one_line(&error.to_string()));
                problems.add(self.of_cell(row, cell.column, problem));
            }
        }
        // A cell or column that is wrong may be what the others lack.
        if self.is_whole(cells) && problems.count() == before {
            let problem = format!(
                "has values that do not go together: {}",
                one_line(&together.to_string())
            );
            problems.add(self.of_row(row, problem));
        }
    }

    /// Refuses rows with the same settings and seed: they are one run, and no repeats of each other.
    fn refuse_same_runs(&self, runs: &[DesignRun], problems: &mut Problems) {
        let mut by_run = BTreeMap::new();
        for run in runs {
            let request = &run.request;
            let values = request.parameters.iter();
            let values: Vec<(&str, u64)> = values
                .map(|(name, x)| (name.as_str(), x.to_bits()))
                .collect();
            let line = by_run.insert((&request.model, values, request.seed), run.line);
            if let (Some(line), Some(row)) = (line, self.table.rows().get(run.row)) {
                problems.add(self.of_row(
                    row,
                    format!(
                        "asks for the same run as line {line}: settings and seed {} are the same; give one of them \
                         another seed",
                        request.seed
                    ),
                ));
            }
        }
    }
}

/// Refuses a coded value that does not belong to the natural one beside it.
fn agrees(coded: &str, natural: &str, factor: &Factor) -> Result<(), String> {
    let number = |text: &str| text.parse().ok().filter(|x: &f64| x.is_finite());
    let Some(coded) = number(coded) else {
        return Err("is not a finite number: correct it, or leave the row out".to_owned());
    };
    let expected = factor.natural(coded);
    match number(natural) {
        Some(natural) if (natural - expected).abs() > AGREES * factor.half_range() => Err(format!(
            "is {expected} by the range {} to {} of the factor, and {natural} is beside it: correct one of them",
            factor.low(),
            factor.high()
        )),
        // A cell that is not a number is reported with its own column.
        _ => Ok(()),
    }
}
