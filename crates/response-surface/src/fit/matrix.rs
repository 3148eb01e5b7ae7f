//! The model matrix with its weights.

use crate::{Error, Model, Observations, Weighting};

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
        let terms = model.names();
        let block_names = blocks.iter().map(|block| format!("block {block}"));
        let names: Vec<String> = terms[..1]
            .iter()
            .cloned()
            .chain(block_names)
            .chain(terms[1..].iter().cloned())
            .collect();
        if cells.len() < names.len() {
            return Err(Error::TooFewObservations {
                observations: cells.len(),
                terms: names.len(),
            });
        }
        let contrast = |cell: usize, column: usize| match cell {
            cell if cell == column => 1.0,
            cell if Some(cell) == last => -1.0,
            _ => 0.0,
        };
        let row = |cell: &crate::Cell| {
            let mut row = model.row(&cell.coded[..k]);
            let contrasts: Vec<f64> = blocks.iter().map(|&b| contrast(cell.block, b)).collect();
            row.splice(1..1, contrasts);
            row
        };
        Ok(Self {
            names,
            n_blocks: blocks.len(),
            rows: cells.iter().map(row).collect(),
            response: cells.iter().map(|cell| cell.mean).collect(),
            weights: weights(data, weighting)?,
            two_level: cells
                .iter()
                .all(|c| c.coded[..k].iter().all(|x| x.abs() == 1.0)),
        })
    }

    /// The entries of a vector over the columns that belong to terms of the model.
    pub(crate) fn model_part(&self, values: &[f64]) -> Vec<f64> {
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
        });
    }
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    Ok(weights.into_iter().map(|w| w / mean).collect())
}
