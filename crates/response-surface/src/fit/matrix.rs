//! The model matrix with its weights.

use crate::fit::wide::Wide;
use crate::{Error, Model, Observations, Weighting};

/// Degrees of freedom that the pooled variance counts for in shrunk weights: chosen by us. With
/// five replicates a cell keeps 4/14 of its own variance.
const PRIOR_DF: f64 = 10.0;

/// Model matrix, response and weights of a fit.
///
/// Columns: intercept, block contrasts (each block against the last, summing to zero), the other
/// terms of the model.
#[derive(Debug)]
pub(crate) struct Matrix {
    /// Names of the columns, (p).
    pub(crate) names: Vec<String>,
    /// Number of block columns.
    pub(crate) n_blocks: usize,
    /// Number of intercept columns, 0 or 1.
    pub(crate) intercept: usize,
    /// The matrix, (n, p).
    pub(crate) rows: Vec<Vec<f64>>,
    /// Mean response of each observation, (n).
    pub(crate) response: Vec<f64>,
    /// Weights with mean 1, (n).
    pub(crate) weights: Vec<f64>,
    /// Whether the factors of the model take the values -1 and +1 only.
    pub(crate) two_level: bool,
}

impl Matrix {
    /// Builds the matrix.
    pub(crate) fn new(
        model: &Model,
        data: &Observations,
        weighting: Weighting,
    ) -> Result<Self, Error> {
        let matrix = Self::unchecked(model, data, weighting)?;
        let (observations, terms) = (matrix.rows.len(), matrix.names.len());
        if observations < terms {
            return Err(Error::TooFewObservations {
                observations,
                terms,
            });
        }
        Ok(matrix)
    }

    /// Builds the matrix, be there fewer rows than columns or not.
    pub(crate) fn unchecked(
        model: &Model,
        data: &Observations,
        weighting: Weighting,
    ) -> Result<Self, Error> {
        let k = model.symbols().len();
        let cells = data.cells();
        let given = cells[0].coded.len();
        if given < k {
            return Err(Error::Length {
                what: "coded values of an observation",
                expected: k,
                given,
            });
        }
        let mut blocks: Vec<usize> = cells.iter().map(|cell| cell.block).collect();
        blocks.sort_unstable();
        blocks.dedup();
        let last = blocks.pop();
        let intercept = usize::from(model.has_intercept());
        if intercept == 0 && !blocks.is_empty() {
            return Err(Error::NoIntercept {
                what: "a model with blocks needs its intercept",
            });
        }
        let block_name = |&block: &usize| format!("block {}", data.block_name(block));
        let block_names = blocks.iter().map(block_name);
        let mut names = model.names();
        names.splice(intercept..intercept, block_names);
        let contrast = |cell: usize, column: usize| match cell {
            cell if cell == column => 1.0,
            cell if Some(cell) == last => -1.0,
            _ => 0.0,
        };
        let contrasts = |cell: &crate::Cell| -> Vec<f64> {
            blocks.iter().map(|&b| contrast(cell.block, b)).collect()
        };
        let row = |cell: &crate::Cell| {
            let mut row = model.row(&cell.coded[..k]);
            row.splice(intercept..intercept, contrasts(cell));
            row
        };
        let rows: Vec<Vec<f64>> = cells.iter().map(row).collect();
        refuse_overflow(&rows)?;
        Ok(Self {
            names,
            n_blocks: blocks.len(),
            intercept,
            rows,
            response: cells.iter().map(|cell| cell.mean).collect(),
            weights: weights(data, weighting)?,
            two_level: cells
                .iter()
                .all(|c| c.coded[..k].iter().all(|x| x.abs() == 1.0)),
        })
    }

    /// Builds the matrix as if all observations were of one block.
    pub(crate) fn without_blocks(
        model: &Model,
        data: &Observations,
        weighting: Weighting,
    ) -> Result<Self, Error> {
        let mut cells = data.cells().to_vec();
        for cell in &mut cells {
            cell.block = 1;
        }
        Self::new(model, &Observations::from_cells(cells)?, weighting)
    }

    /// Place of the first column that is neither intercept nor block.
    pub(crate) fn first(&self) -> usize {
        self.intercept + self.n_blocks
    }

    /// Whether the intercept is part of the model.
    pub(crate) fn intercept_is_in(&self) -> bool {
        self.intercept == 1
    }

    /// Row `i` in long arithmetic.
    pub(crate) fn wide_row(&self, model: &Model, data: &Observations, i: usize) -> Vec<Wide> {
        let k = model.symbols().len();
        let mut row = model.wide_row(&data.cells()[i].coded[..k]);
        let blocks = &self.rows[i][self.intercept..self.intercept + self.n_blocks];
        let place = self.intercept..self.intercept;
        row.splice(place, blocks.iter().map(|&x| Wide::from(x)));
        row
    }

    /// The entries of a vector over the columns that belong to terms of the model.
    pub(crate) fn model_part<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let keep = |i: &usize| *i == 0 || *i > self.n_blocks;
        (0..values.len()).filter(keep).map(|i| values[i]).collect()
    }

    /// The block of a matrix over the columns that belong to terms of the model.
    pub(crate) fn model_block(&self, values: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let keep = |i: &usize| *i == 0 || *i > self.n_blocks;
        (0..values.len())
            .filter(keep)
            .map(|i| self.model_part(&values[i]))
            .collect()
    }
}

/// Weights of the observations, scaled to mean 1.
fn weights(data: &Observations, weighting: Weighting) -> Result<Vec<f64>, Error> {
    let pooled = crate::fit::pooled_variance(data).filter(|variance| *variance > 0.0);
    let mut weights = Vec::with_capacity(data.cells().len());
    for (i, cell) in data.cells().iter().enumerate() {
        weights.push(match weighting {
            Weighting::Counts => cell.n as f64,
            Weighting::Equal => 1.0,
            Weighting::InverseVariance => {
                let sd = cell.sd.unwrap_or(0.0);
                let weight = cell.n as f64 / (sd * sd);
                if !weight.is_finite() {
                    return Err(Error::BadObservation {
                        row: i + 1,
                        what: "the standard deviation",
                        value: sd,
                        way_out: "inverse-variance weights need one above zero in every cell; \
                                  weight by the number of replicates instead",
                    });
                }
                weight
            }
            Weighting::ShrunkVariance => {
                let spread = pooled.ok_or(Error::NoErrorVariance {
                    source_of_error: "replicates",
                    way_out: "shrunk weights need an sd and a number of replicates above 1",
                })?;
                let (known, variance) = match cell.sd.filter(|_| cell.n > 1) {
                    Some(sd) => ((cell.n - 1) as f64, sd * sd),
                    None => (0.0, 0.0),
                };
                let shrunk = (known * variance + PRIOR_DF * spread) / (known + PRIOR_DF);
                cell.n as f64 / shrunk
            }
        });
    }
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    Ok(weights.into_iter().map(|w| w / mean).collect())
}

/// Refuses products of settings whose squares overflow.
fn refuse_overflow(rows: &[Vec<f64>]) -> Result<(), Error> {
    let is_beyond = |x: &&f64| x.is_nan() || x.abs() > Observations::LARGEST;
    let far = rows.iter().enumerate();
    let mut far = far.filter_map(|(i, row)| Some((i, *row.iter().find(is_beyond)?)));
    far.next().map_or(Ok(()), |(i, value)| {
        Err(Error::BadObservation {
            row: i + 1,
            what: "a product of its coded settings",
            value,
            way_out: "squares of numbers beyond 1e140 overflow; give the range of the factor",
        })
    })
}
