//! Runs of the cells of a design, and their means.

use crate::Error;
use campaign::{Campaign, RunRequest, Simulator};
use experiment_design::Factor;
use response_surface::{Cell, Observations};
use run_store::Record;
use serde::{Deserialize, Serialize};

/// A factor of the calibration: a parameter of the simulator with its levels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibrationFactor {
    /// Symbol, name, unit, low and high level.
    pub factor: Factor,
    /// Name of the parameter in a [`RunRequest`].
    pub parameter: String,
}

/// What is asked of the simulator in all cells.
#[derive(Debug, Clone)]
pub struct Question<'a> {
    /// The run with everything that does not vary.
    pub base: RunRequest,
    /// Name of the observable.
    pub observable: &'a str,
    /// Number of runs in each cell, with seeds of their own.
    pub replicates: usize,
}

/// The runs of one cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellRuns {
    /// Coded settings, one per column of the design (factors, then dummies).
    pub coded: Vec<f64>,
    /// Means over the frames of each run, unit of the observable.
    pub responses: Vec<f64>,
    /// Keys of the records.
    pub keys: Vec<String>,
}

/// Mean of an observable in a record.
pub(crate) fn value(record: &Record, observable: &str) -> Result<f64, Error> {
    record
        .observable(observable)
        .map(|o| o.mean)
        .ok_or_else(|| Error::NoObservable {
            run: record.key().to_owned(),
            name: observable.to_owned(),
            given: record
                .observables()
                .keys()
                .cloned()
                .collect::<Vec<_>>()
                .join(", "),
        })
}

/// Runs all cells of a design; row k, replicate r gets a seed of its own.
///
/// Columns beyond the factors (dummies) set nothing.
///
/// # Errors
///
/// Runs that failed, an observable that is missing.
pub fn run_cells(
    campaign: &Campaign<'_>,
    simulator: &dyn Simulator,
    factors: &[CalibrationFactor],
    rows: &[Vec<f64>],
    question: &Question<'_>,
) -> Result<Vec<CellRuns>, Error> {
    let mut requests = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        for replicate in 0..question.replicates {
            let seed = question.base.seed + (k * question.replicates + replicate) as u64;
            let mut request = question.base.clone().with_seed(seed);
            for (factor, coded) in factors.iter().zip(row) {
                request = request.with_parameter(&factor.parameter, factor.factor.natural(*coded));
            }
            requests.push(request);
        }
    }
    let records = campaign.run_all(simulator, &requests)?;
    rows.iter()
        .zip(records.chunks(question.replicates.max(1)))
        .map(|(row, records)| {
            let responses = records.iter().map(|r| value(r, question.observable));
            Ok(CellRuns {
                coded: row.clone(),
                responses: responses.collect::<Result<_, _>>()?,
                keys: records.iter().map(|r| r.key().to_owned()).collect(),
            })
        })
        .collect()
}

/// Cells as the analysis wants them.
pub(crate) fn observations(cells: &[CellRuns]) -> Result<Observations, Error> {
    let cells = cells
        .iter()
        .map(|c| Cell::of_replicates(c.coded.clone(), &c.responses));
    Ok(Observations::from_cells(cells.collect::<Result<_, _>>()?)?)
}
