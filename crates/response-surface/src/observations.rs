//! What was observed: one row per cell, with the mean, the standard deviation and the number of
//! its replicates.

use std::collections::BTreeMap;

use experiment_design::Design;
use serde::{Deserialize, Serialize};

use crate::Error;

/// One row of data: the mean of n runs at the same settings (n = 1: a single run).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Coded settings, one per column.
    pub coded: Vec<f64>,
    /// Mean response, unit of the response.
    pub mean: f64,
    /// Standard deviation of single runs within the cell, unit of the response; none if n = 1 or
    /// if it is not known.
    pub sd: Option<f64>,
    /// Number of runs behind the mean.
    pub n: usize,
    /// Block, from 1.
    pub block: usize,
}

impl Cell {
    /// A single run.
    pub fn single(coded: Vec<f64>, response: f64) -> Self {
        Self {
            coded,
            mean: response,
            sd: None,
            n: 1,
            block: 1,
        }
    }

    /// The mean of replicates, with their standard deviation if there are two or more.
    ///
    /// # Errors
    /// [`Error::Length`] without replicates.
    pub fn of_replicates(coded: Vec<f64>, responses: &[f64]) -> Result<Self, Error> {
        let n = responses.len();
        if n == 0 {
            return Err(Error::Length {
                what: "replicates of a cell",
                expected: 1,
                given: 0,
            });
        }
        let mean = responses.iter().sum::<f64>() / n as f64;
        let squares: f64 = responses.iter().map(|y| (y - mean) * (y - mean)).sum();
        let sd = (n > 1).then(|| (squares / (n - 1) as f64).sqrt());
        Ok(Self {
            coded,
            mean,
            sd,
            n,
            block: 1,
        })
    }
}

/// Coded settings of a cell and the responses of its runs.
type Group<'a> = (&'a [f64], Vec<f64>);

/// Cells of data, checked: all values finite, all rows equally long.
///
/// ```
/// use response_surface::Observations;
/// // Three runs at two settings: the repeats become one cell.
/// let data = Observations::from_runs(&[vec![-1.0], vec![1.0], vec![1.0]], &[30.1, 34.8, 35.2])?;
/// assert_eq!(data.cells().len(), 2);
/// assert_eq!((data.cells()[1].mean, data.cells()[1].n), (35.0, 2));
/// # Ok::<(), response_surface::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// The cells in their order.
    cells: Vec<Cell>,
    /// Names of the blocks 1, 2, ...; empty where blocks have numbers only.
    block_names: Vec<String>,
}

impl Observations {
    /// Greatest size of a response or its standard deviation, unit of the response. Sums of squares reach the
    /// number of rows times its square, and ratios of them the square of that over rounding; numbers end at 1.8e308.
    pub const LARGEST: f64 = 1e140;
    /// Most runs behind a mean (our choice): the most runs of a design.
    pub const MOST_REPLICATES: usize = 1_000_000;
    /// Least size that the greatest response may have, unit of the response, unless all are zero: squares of smaller
    /// ones lose their digits or are zero.
    pub const SMALLEST: f64 = 1e-140;

    /// Whether a standard deviation can be the scatter of values of a size, both in one unit: zero, or between 1e-20 and 1e9 of
    /// the size, and between [`Observations::SMALLEST`] and [`Observations::LARGEST`]. Values that are equal but for rounding
    /// scatter by 1e-16 of their size, and no quantity scatters by much more than its greatest value; the limits leave room on
    /// both sides (our choice). A size of zero sets no limit of its own.
    pub fn is_plausible_sd(sd: f64, size: f64) -> bool {
        let in_numbers = (Self::SMALLEST..=Self::LARGEST).contains(&sd);
        let beside = sd / size.abs();
        sd == 0.0 || (in_numbers && (size == 0.0 || (1e-20..=1e9).contains(&beside)))
    }

    /// Takes cells as they are.
    ///
    /// # Errors
    /// [`Error::Length`] without cells or with rows of different length;
    /// [`Error::BadObservation`] for values that are not finite, a negative sd, or n = 0, and for responses whose
    /// squares are not numbers: beyond [`Observations::LARGEST`], or all below [`Observations::SMALLEST`]; for an sd that is not a
    /// scatter of such responses ([`Observations::is_plausible_sd`]), or more than a million runs in a cell.
    pub fn from_cells(cells: Vec<Cell>) -> Result<Self, Error> {
        let Some(first) = cells.first() else {
            return Err(Error::Length {
                what: "observations",
                expected: 1,
                given: 0,
            });
        };
        let expected = first.coded.len();
        for (i, cell) in cells.iter().enumerate() {
            if cell.coded.len() != expected {
                return Err(Error::Length {
                    what: "coded values of an observation",
                    expected,
                    given: cell.coded.len(),
                });
            }
            check_cell(i + 1, cell)?;
        }
        let sizes = cells.iter().map(|cell| cell.mean.abs()).enumerate();
        let greatest = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, _)) = greatest.filter(|(_, size)| *size > 0.0 && *size < Self::SMALLEST) {
            return Err(Error::BadObservation {
                row: i + 1,
                what: "the greatest mean",
                value: cells[i].mean,
                way_out: "squares of responses below 1e-140 are zero here; give them in a smaller unit",
            });
        }
        let size = greatest.map_or(0.0, |(_, size)| size);
        let spreads = cells.iter().enumerate();
        let mut spreads = spreads.filter_map(|(i, cell)| Some((i, cell.sd?)));
        if let Some((i, value)) = spreads.find(|(_, sd)| !Self::is_plausible_sd(*sd, size)) {
            return Err(Error::BadObservation {
                row: i + 1,
                what: "the standard deviation",
                value,
                way_out: "responses of this size do not scatter so; correct it, or write 0 for runs that are all alike",
            });
        }
        Ok(Self {
            cells,
            block_names: Vec::new(),
        })
    }

    /// The same observations with names for the blocks 1, 2, ..., which the terms of a fit then bear.
    #[must_use]
    pub fn with_block_names(self, names: Vec<String>) -> Self {
        Self {
            block_names: names,
            ..self
        }
    }

    /// Name of a block: as given, or its number.
    pub(crate) fn block_name(&self, block: usize) -> String {
        let named = block.checked_sub(1).and_then(|i| self.block_names.get(i));
        named.cloned().unwrap_or_else(|| block.to_string())
    }

    /// Groups single runs into cells by equal coded settings and block, in order of first
    /// appearance.
    ///
    /// # Errors
    /// As [`Observations::from_cells`]; [`Error::Length`] if the lists differ in length.
    pub fn from_runs(coded: &[Vec<f64>], responses: &[f64]) -> Result<Self, Error> {
        if coded.len() != responses.len() {
            return Err(Error::Length {
                what: "responses",
                expected: coded.len(),
                given: responses.len(),
            });
        }
        let mut groups: Vec<(&Vec<f64>, Vec<f64>)> = Vec::new();
        let mut places = BTreeMap::new();
        for (row, &response) in coded.iter().zip(responses) {
            // Adding 0 makes -0 and 0 the same settings.
            let settings: Vec<u64> = row.iter().map(|x| (x + 0.0).to_bits()).collect();
            let place = *places.entry(settings).or_insert_with(|| {
                groups.push((row, Vec::new()));
                groups.len() - 1
            });
            groups[place].1.push(response);
        }
        let cells = groups
            .into_iter()
            .map(|(row, group)| Cell::of_replicates(row.clone(), &group))
            .collect::<Result<Vec<_>, _>>()?;
        Self::from_cells(cells)
    }

    /// Groups the responses of a design, one per run in its order, into its cells; a run without
    /// response (failed) is left out, and so is a cell without any.
    ///
    /// Centre cells stay apart, so they give a lack-of-fit test; the coded values of the dummy
    /// columns are kept.
    ///
    /// # Errors
    /// As [`Observations::from_cells`]; [`Error::Length`] unless there is one entry per run.
    pub fn from_design(design: &Design, responses: &[Option<f64>]) -> Result<Self, Error> {
        if design.runs().len() != responses.len() {
            return Err(Error::Length {
                what: "responses, one per run of the design",
                expected: design.runs().len(),
                given: responses.len(),
            });
        }
        let mut groups: BTreeMap<(usize, usize), Group> = BTreeMap::new();
        for (run, response) in design.runs().iter().zip(responses) {
            let group = groups
                .entry((run.cell, run.block))
                .or_insert((&run.coded, Vec::new()));
            group.1.extend(response);
        }
        let mut cells = Vec::with_capacity(groups.len());
        for ((_, block), (coded, group)) in groups {
            if !group.is_empty() {
                let cell = Cell::of_replicates(coded.to_vec(), &group)?;
                cells.push(Cell { block, ..cell });
            }
        }
        Self::from_cells(cells)
    }

    /// The cells in their order.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The same cells with only the first `n` coded columns.
    #[must_use]
    pub(crate) fn first_columns(&self, n: usize) -> Self {
        let mut cells = self.cells.clone();
        for cell in &mut cells {
            cell.coded.truncate(n);
        }
        Self {
            cells,
            block_names: self.block_names.clone(),
        }
    }

    /// Mean number of runs per cell.
    pub fn mean_count(&self) -> f64 {
        let runs: usize = self.cells.iter().map(|cell| cell.n).sum();
        runs as f64 / self.cells.len() as f64
    }
}

/// Refuses a cell with invalid values.
fn check_cell(row: usize, cell: &Cell) -> Result<(), Error> {
    let refuse = |what, value, way_out| {
        Err(Error::BadObservation {
            row,
            what,
            value,
            way_out,
        })
    };
    if let Some(&x) = cell.coded.iter().find(|x| !x.is_finite()) {
        return refuse("a coded value", x, "it must be a finite number");
    }
    if !cell.mean.is_finite() {
        return refuse(
            "the mean",
            cell.mean,
            "it must be a finite number; leave failed runs out",
        );
    }
    if let Some(sd) = cell.sd.filter(|sd| !(sd.is_finite() && *sd >= 0.0)) {
        return refuse("the standard deviation", sd, "it must be zero or positive");
    }
    let beyond = |size: &f64| size.abs() > Observations::LARGEST;
    let spread = cell.sd.map(|sd| ("the standard deviation", sd));
    let sizes = [Some(("the mean", cell.mean)), spread];
    if let Some((what, value)) = sizes.into_iter().flatten().find(|(_, size)| beyond(size)) {
        return refuse(
            what,
            value,
            "squares of numbers beyond 1e140 overflow; give it in a larger unit",
        );
    }
    if !(1..=Observations::MOST_REPLICATES).contains(&cell.n) {
        return refuse(
            "the number of replicates",
            cell.n as f64,
            "it must be at least 1 and at most a million",
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Cell, Observations};
    use crate::Error;

    /// Squares of 1e160 are infinite and those of 1e-170 zero: either would leave NaN in every table. Zero itself is a
    /// response like any other.
    #[test]
    fn responses_whose_squares_are_no_numbers_are_refused_with_their_row() {
        let cells = |responses: &[f64]| {
            let cell = |y: &f64| Cell::single(vec![0.5], *y);
            Observations::from_cells(responses.iter().map(cell).collect())
        };
        let row = |responses: &[f64]| match cells(responses) {
            Err(Error::BadObservation { row, .. }) => Some(row),
            _ => None,
        };
        assert_eq!(row(&[1.0, 2.0, -1e160]), Some(3));
        assert_eq!(row(&[1e-170, -3e-170, 0.0]), Some(2));
        assert!(cells(&[1e-170, 1.0]).is_ok() && cells(&[0.0, 0.0]).is_ok());
        let wide = Cell {
            sd: Some(1e150),
            n: 3,
            ..Cell::single(vec![0.5], 1.0)
        };
        assert!(Observations::from_cells(vec![wide]).is_err());
    }

    /// Scatter that no runs have, and numbers of runs that nobody made, are refused with their row; runs that are all alike, or
    /// but for rounding, are not.
    #[test]
    fn a_scatter_that_cannot_be_one_is_refused_with_its_row() {
        let cells = |sd: f64, n: usize| {
            let cell = |mean: f64, sd: f64, n: usize| Cell {
                sd: Some(sd),
                n,
                ..Cell::single(vec![0.5], mean)
            };
            Observations::from_cells(vec![cell(36.0, 0.5, 5), cell(-2.0, sd, n)])
        };
        for (sd, n) in [
            (1e-320, 5),
            (1e-25, 5),
            (1e12, 5),
            (1e300, 5),
            (0.5, 0),
            (0.5, 10_000_000),
            (0.5, usize::MAX),
        ] {
            let found = cells(sd, n);
            assert!(
                matches!(found, Err(Error::BadObservation { row: 2, .. })),
                "{sd:e}, {n}: {found:?}"
            );
        }
        for sd in [0.0, 4e-16, 0.5, 200.0] {
            assert!(cells(sd, 5).is_ok(), "{sd:e}");
        }
    }
}
