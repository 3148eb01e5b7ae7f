//! What the columns of a design table stand for.

use super::DesignChoices;
use super::bind::{Bind, binds, name_and_unit};
use super::cells::carries_unit;
use super::results;
use crate::problem::{Problem, Problems};
use crate::setting::number;
use experiment_design::Factor;
use experiment_design::table::Table;
use scene::{NamedSetting, Scene, SettingKind, like_names};
use std::collections::BTreeMap;
use toml::Value;

/// Columns that a design has beside its factors.
const OF_A_DESIGN: [&str; 4] = ["run", "cell", "replicate", "block"];

/// The column of the number of runs of a row.
pub(super) const REPLICATES: &str = "replicates";

/// The column of the seed of a row.
pub(super) const SEED: &str = "seed";

/// The role of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Role {
    /// Nothing that a run depends on.
    Kept,
    /// Coded values beside the natural ones of another column, which are the ones that count.
    Coded {
        /// The factor, where its range is known.
        factor: Option<Factor>,
        /// The column of the natural values.
        natural: usize,
    },
    /// The number of runs of the row.
    Replicates,
    /// The seed of the row.
    Seed,
    /// Settings of the scene.
    Sets(Setter),
}

/// A column that sets settings of the scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setter {
    /// Name of the parameter in requests.
    pub(super) symbol: String,
    /// Dotted paths of the settings.
    pub(super) paths: Vec<String>,
    /// What all of them take.
    pub(super) kind: SettingKind,
    /// Unit of plain numbers in the column; `None` if the settings are not quantities, or each cell has its unit.
    pub(super) unit: Option<String>,
    /// The factor whose coded values the column holds; `None` if it holds natural ones.
    pub(super) coded: Option<Factor>,
}

#[derive(Debug)]
pub(super) struct Columns {
    /// Their roles, in the order of the header; `None` if a column is wrong.
    pub(super) roles: Vec<Option<Role>>,
}

impl Columns {
    /// Finds the role of each column.
    pub(super) fn read(
        choices: &DesignChoices,
        table: &Table,
        scene: &Scene,
        factors: &BTreeMap<String, Factor>,
        problems: &mut Problems,
    ) -> Self {
        let reader = Reader {
            file: choices.design.display().to_string(),
            keep: &choices.keep,
            binds: binds(&choices.bind, problems),
            known: scene.setting_names(),
            of_results: results::names_of(scene),
            table,
            scene,
            factors,
        };
        reader.check_names(problems);
        let places = 0..table.header().len();
        let roles: Vec<_> = places.map(|i| reader.role(i, problems)).collect();
        reader.check_paths(&choices.set, &roles, problems);
        Self { roles }
    }

    /// The column of a role.
    pub(super) fn place(&self, role: &Role) -> Option<usize> {
        self.roles.iter().position(|r| r.as_ref() == Some(role))
    }
}

/// Everything that the meaning of a column follows from.
struct Reader<'a> {
    /// Name of the table.
    file: String,
    /// Columns that set nothing.
    keep: &'a [String],
    /// Bindings of columns to settings.
    binds: BTreeMap<String, Bind>,
    /// Names of all settings.
    known: Vec<String>,
    /// Names that the results need.
    of_results: Vec<String>,
    table: &'a Table,
    scene: &'a Scene,
    /// Factors by symbol.
    factors: &'a BTreeMap<String, Factor>,
}

impl Reader<'_> {
    fn wrong(&self, column: usize, problem: String) -> Problem {
        let name = &self.table.header()[column];
        Problem {
            file: self.file.clone(),
            line: Some(self.table.header_line()),
            what: format!("column '{name}'"),
            problem,
        }
    }

    /// Place of a column by its exact name.
    fn place(&self, name: &str) -> Option<usize> {
        self.table.header().iter().position(|column| column == name)
    }

    /// Refuses names that are there twice, that the results use, or that no column has.
    fn check_names(&self, problems: &mut Problems) {
        let header = self.table.header();
        for (i, name) in header.iter().enumerate() {
            if name.is_empty() {
                let problem = format!("(number {}) has no name: give it one", i + 1);
                problems.add(self.wrong(i, problem));
            } else if header[..i].contains(name) {
                let problem = "is there twice: give each column its own name".to_owned();
                problems.add(self.wrong(i, problem));
            }
            if self.of_results.contains(name) {
                let problem = "has a name that the results need: rename it, or leave it out";
                problems.add(self.wrong(i, problem.to_owned()));
            }
        }
        let bases: Vec<&str> = header.iter().map(|name| name_and_unit(name).0).collect();
        let said = self.binds.keys().map(|name| ("--bind", name));
        for (flag, name) in said.chain(self.keep.iter().map(|name| ("--keep", name))) {
            let there = bases.contains(&name.as_str())
                || header.contains(name)
                || (flag == "--bind" && self.place(&natural_name(name)).is_some());
            if !there {
                problems.add(Problem {
                    file: self.file.clone(),
                    line: Some(self.table.header_line()),
                    what: format!("{flag} '{name}'"),
                    problem: format!("the table has no such column; it has {}", header.join(", ")),
                });
            }
        }
    }

    /// The role of a column; `None` if it is wrong.
    fn role(&self, column: usize, problems: &mut Problems) -> Option<Role> {
        let name = &self.table.header()[column];
        let factor = name.strip_suffix("_natural").unwrap_or(name);
        if self.keep.iter().any(|kept| kept == name || kept == factor) {
            return Some(Role::Kept);
        }
        match name.as_str() {
            "" => return None,
            REPLICATES => return Some(Role::Replicates),
            SEED => return Some(Role::Seed),
            word if OF_A_DESIGN.contains(&word) => return Some(Role::Kept),
            _ if self.of_results.contains(name) => return None,
            _ => {}
        }
        if let Some(natural) = self.place(&natural_name(name)) {
            let factor = self.factors.get(name).cloned();
            return Some(Role::Coded { factor, natural });
        }
        let setter = if factor == name {
            self.lone(column, problems)
        } else {
            let unit = self.factor_unit(factor);
            self.setter(column, factor, unit, problems)
        };
        setter.map(Role::Sets)
    }

    /// The unit of a factor, if it is known and has one.
    fn factor_unit(&self, symbol: &str) -> Option<String> {
        let unit = self.factors.get(symbol).map(Factor::unit);
        unit.filter(|unit| *unit != "1").map(str::to_owned)
    }

    /// What a column sets that has no column of natural values beside it.
    fn lone(&self, column: usize, problems: &mut Problems) -> Option<Setter> {
        let (base, unit) = name_and_unit(&self.table.header()[column]);
        let has_unit = unit.is_some();
        let factor = self.factors.get(base).filter(|_| !has_unit);
        let unit = unit.or_else(|| self.factor_unit(base));
        let mut setter = self.setter(column, base, unit, problems)?;
        let is_numeric = matches!(setter.kind, SettingKind::Number | SettingKind::Quantity);
        match factor {
            Some(_) if !is_numeric => {
                let problem = format!(
                    "is a factor with a range, and '{}' takes no number: leave it out of --factors",
                    setter.paths.join(", ")
                );
                problems.add(self.wrong(column, problem));
                return None;
            }
            Some(factor) => setter.coded = Some(factor.clone()),
            None if is_numeric
                && !has_unit
                && self.binds.contains_key(base)
                && !self.all_cells_carry_units(column) =>
            {
                let problem = format!(
                    "may hold coded or natural values: give its range with --factors if they are coded; call the \
                     column {} if they are natural",
                    natural_name(base)
                );
                problems.add(self.wrong(column, problem));
                return None;
            }
            None => {}
        }
        Some(setter)
    }

    /// Whether each cell of a column has a unit, and so is not a coded value.
    fn all_cells_carry_units(&self, column: usize) -> bool {
        let mut rows = self.table.rows().iter();
        rows.all(|row| carries_unit(row.text(column)))
    }

    /// The settings that a column sets: those that it is bound to, or the one of its name.
    fn setter(
        &self,
        column: usize,
        symbol: &str,
        unit: Option<String>,
        problems: &mut Problems,
    ) -> Option<Setter> {
        let bind = self.binds.get(symbol);
        let own = [symbol.to_owned()];
        let names = bind.map_or(&own[..], |bind| &bind.names);
        let mut found: Vec<NamedSetting> = Vec::new();
        for name in names {
            match self.scene.named_setting(name) {
                Ok(setting) => found.push(setting),
                Err(error) => {
                    let problem = self.not_found(symbol, name, &error);
                    problems.add(self.wrong(column, problem));
                }
            }
        }
        let first = found.first().filter(|_| found.len() == names.len())?;
        let kind = first.kind;
        if let Some(other) = found.iter().find(|setting| setting.kind != kind) {
            let problem = format!(
                "sets '{}' and '{}', which do not take the same kind of value: give each a column of its own",
                first.path, other.path
            );
            problems.add(self.wrong(column, problem));
            return None;
        }
        let stated = bind.and_then(|bind| bind.unit.clone()).or(unit);
        let unit = stated.or_else(|| first.unit.map(str::to_owned));
        for setting in &found {
            if let Err(problem) = self.check_unit(column, setting, unit.as_deref()) {
                problems.add(self.wrong(column, problem));
                return None;
            }
        }
        Some(Setter {
            symbol: symbol.to_owned(),
            paths: found.into_iter().map(|setting| setting.path).collect(),
            kind,
            unit,
            coded: None,
        })
    }

    /// Why a column sets nothing, and the remedy.
    fn not_found(&self, symbol: &str, name: &str, error: &scene::Error) -> String {
        let file = &self.scene.file;
        let like = like_names(&self.known, name);
        if let scene::Error::AmbiguousSetting { candidates, .. } = error {
            return format!("may mean {candidates}: write the whole path");
        }
        if self.binds.contains_key(symbol) {
            return format!(
                "is bound to '{name}', which {file} does not have; near names are {like}"
            );
        }
        let is_factor = self.factors.contains_key(symbol)
            || self.table.header().contains(&natural_name(symbol));
        if is_factor {
            return format!(
                "holds a factor that sets nothing in {file}: give its setting with --bind \
                 {symbol}=PATH, such as --bind {symbol}=contact.seed-seed.static_friction, or keep it unused with \
                 --keep {symbol}"
            );
        }
        format!(
            "is not a setting of {file}; near names are {like}: correct it, say what it sets with --bind {symbol}=PATH, \
             or keep it unused with --keep {symbol}"
        )
    }

    /// Refuses a unit that a setting cannot have, and a quantity whose unit nobody states.
    fn check_unit(
        &self,
        column: usize,
        setting: &NamedSetting,
        unit: Option<&str>,
    ) -> Result<(), String> {
        let path = &setting.path;
        match (setting.kind, unit) {
            (SettingKind::Number, Some(unit)) => Err(format!(
                "sets '{path}', which is a plain number: leave out its unit '{unit}'"
            )),
            (SettingKind::Quantity, Some(unit)) => {
                let is_left_out = setting.value == Value::String(String::new());
                let there = number(&setting.value, Some(unit));
                there.map(|_| ()).or_else(|problem| {
                    is_left_out
                        .then_some(())
                        .ok_or(format!("sets '{path}', which {problem}"))
                })
            }
            (SettingKind::Quantity, None) if !self.any_cell_carries_a_unit(column) => {
                let name = &self.table.header()[column];
                let symbol = name.strip_suffix("_natural").unwrap_or(name);
                let there = setting.value.as_str().unwrap_or_default();
                let unit = there.split_whitespace().nth(1).unwrap_or("UNIT");
                let way_out = if symbol == name && !self.binds.contains_key(name) {
                    format!("call the column '{name} [{unit}]', or write it behind each number")
                } else {
                    format!("say --bind '{symbol}={path} [{unit}]', or state it in --factors")
                };
                Err(format!(
                    "sets '{path}', a quantity ({there}), with numbers without a unit: {way_out}"
                ))
            }
            _ => Ok(()),
        }
    }

    /// Whether a cell of a column has a unit.
    fn any_cell_carries_a_unit(&self, column: usize) -> bool {
        let mut rows = self.table.rows().iter();
        rows.any(|row| carries_unit(row.text(column)))
    }

    /// Refuses settings that two columns set, or a column and a change of all runs.
    fn check_paths(&self, set: &[String], roles: &[Option<Role>], problems: &mut Problems) {
        let mut by_path: BTreeMap<String, String> = BTreeMap::new();
        for text in set {
            let name = text.split_once('=').map_or("", |(name, _)| name.trim());
            if let Ok(setting) = self.scene.named_setting(name) {
                by_path.insert(setting.path, "--set".to_owned());
            }
        }
        for (i, role) in roles.iter().enumerate() {
            let Some(Role::Sets(setter)) = role else {
                continue;
            };
            for path in &setter.paths {
                let column = format!("column '{}'", self.table.header()[i]);
                if let Some(other) = by_path.insert(path.clone(), column) {
                    let problem =
                        format!("sets '{path}', which {other} sets as well: leave one of them");
                    problems.add(self.wrong(i, problem));
                }
            }
        }
    }
}

/// Name of the column of natural values of a factor.
fn natural_name(symbol: &str) -> String {
    format!("{symbol}_natural")
}
