//! The cells of a table: settings, mean, standard deviation and number of runs of each row.

use super::Coding;
use anyhow::{Context as _, ensure};
use experiment_design::Factor;
use experiment_design::table::{Row, Table};
use response_surface::{Cell, Observations, Transform};

/// The columns of a row.
pub(super) struct Cells<'a> {
    /// The table.
    pub(super) table: &'a Table,
    /// Column and factor.
    pub(super) factors: Vec<(usize, Factor)>,
    /// What the columns of the factors hold.
    pub(super) coding: Coding,
    /// Columns of the dummies.
    pub(super) dummies: Vec<usize>,
    /// Column of the mean.
    pub(super) response: usize,
    /// The function of the mean that is fitted.
    pub(super) transform: Option<Transform>,
    /// Column of the standard deviation.
    pub(super) sd: Option<usize>,
    /// Column of the number of replicates.
    pub(super) n: Option<usize>,
}

impl Cells<'_> {
    /// Reads all rows, with a warning if standard deviations of replicates are missing.
    pub(super) fn read(&self) -> anyhow::Result<(Vec<Cell>, Option<String>)> {
        ensure!(
            self.sd.is_none() || self.n.is_some(),
            "--sd needs --n, the column of the number of replicates that the sd was taken over"
        );
        let rows = self.table.rows().iter();
        let cells: Vec<Cell> = rows.map(|row| self.cell(row)).collect::<Result<_, _>>()?;
        let without_spread = self.spreads(&cells)?;
        Ok((cells, without_spread))
    }

    /// Checks the standard deviations of the rows, and reports the replicates whose standard deviation is missing.
    fn spreads(&self, cells: &[Cell]) -> anyhow::Result<Option<String>> {
        let Some(column) = self.sd else {
            return Ok(None);
        };
        let rows = || self.table.rows().iter().zip(cells);
        let size = cells.iter().map(|cell| cell.mean.abs()).fold(0.0, f64::max);
        for (row, cell) in rows() {
            let place = self.table.place(row, column);
            let Some(sd) = cell.sd else { continue };
            ensure!(
                Observations::is_plausible_sd(sd, size),
                "{place}: responses up to {size} cannot have the standard deviation {sd:e}; correct it, or write 0 for runs \
                 that are all alike"
            );
            ensure!(
                cell.n > 1 || sd == 0.0,
                "{place}: {sd} is given as the standard deviation of a single run (n = 1), which has none; correct n, or \
                 leave the cell empty"
            );
        }
        let missing = rows().filter(|(_, cell)| cell.n > 1 && cell.sd.is_none());
        let missing: Vec<(&Row, usize)> = missing.map(|(row, cell)| (row, cell.n - 1)).collect();
        if missing.is_empty() {
            return Ok(None);
        }
        let lost: usize = missing.iter().map(|(_, df)| df).sum();
        let all: usize = cells.iter().map(|cell| cell.n - 1).sum();
        let places: Vec<String> = missing
            .iter()
            .map(|(row, _)| self.table.place(row, column))
            .collect();
        Ok(Some(format!(
            "{}: no standard deviation of these replicates: the error of replicates has {} degrees of freedom instead of {all}",
            listed(&places),
            all - lost
        )))
    }

    /// Reads one row.
    fn cell(&self, row: &Row) -> anyhow::Result<Cell> {
        let mut coded = Vec::with_capacity(self.factors.len() + self.dummies.len());
        for (column, factor) in &self.factors {
            let value = self.table.number(row, *column)?;
            coded.push(match self.coding {
                Coding::Coded => value,
                Coding::Natural => plain(factor.coded(value)),
            });
        }
        for &column in &self.dummies {
            coded.push(self.table.number(row, column)?);
        }
        let n = match self.n {
            Some(column) => self.table.count(row, &self.table.header()[column])?,
            None => None,
        };
        if let (Some(n), Some(column)) = (n, self.n) {
            ensure!(
                n <= Observations::MOST_REPLICATES,
                "{}: {n} replicates of one setting; at most {} are believed",
                self.table.place(row, column),
                Observations::MOST_REPLICATES
            );
        }
        let sd = self
            .sd
            .map(|column| self.table.optional_number(row, column))
            .transpose()?;
        let mean = self.table.number(row, self.response)?;
        ensure!(
            mean.abs() <= Observations::LARGEST,
            "{}: {mean:e} is beyond 1e140, and its square overflows; give the response in a larger unit",
            self.table.place(row, self.response)
        );
        let mean = match self.transform {
            None => mean,
            Some(transform) => transform.forward(mean).with_context(|| {
                let place = self.table.place(row, self.response);
                let what = transform.of(&self.table.header()[self.response]);
                let domain = transform.domain();
                format!("{place}: {what} needs values {domain}, this one is {mean}")
            })?,
        };
        Ok(Cell {
            coded,
            mean,
            sd: sd.flatten(),
            n: n.unwrap_or(1),
            block: 1,
        })
    }
}

/// Some places with commas between them, the first few of many.
fn listed(places: &[String]) -> String {
    const MOST: usize = 5;
    let shown = places[..places.len().min(MOST)].join(", ");
    match places.len().checked_sub(MOST) {
        Some(more @ 1..) => format!("{shown} and {more} more"),
        _ => shown,
    }
}

/// Numbers the blocks of the cells by their labels, and gives the names behind the numbers; labels that are whole
/// numbers are taken as they are, and then there are no names.
pub(super) fn number_blocks(cells: &mut [Cell], labels: &[String]) -> Vec<String> {
    let number = |label: &String| label.parse().ok().filter(|n: &usize| *n >= 1);
    if let Some(numbers) = labels.iter().map(number).collect::<Option<Vec<_>>>() {
        for (cell, number) in cells.iter_mut().zip(numbers) {
            cell.block = number;
        }
        return Vec::new();
    }
    let mut names = labels.to_vec();
    names.sort();
    names.dedup();
    for (cell, label) in cells.iter_mut().zip(labels) {
        cell.block = 1 + names.binary_search(label).unwrap_or(0);
    }
    names
}

/// A coded value freed of the rounding of its range: 0.5 rather than 0.5000000000000002.
fn plain(coded: f64) -> f64 {
    let short = (coded * 1e6).round() / 1e6;
    if (short - coded).abs() < 4e-15 {
        short
    } else {
        coded
    }
}
