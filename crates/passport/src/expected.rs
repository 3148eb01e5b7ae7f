//! The expected numbers and their bands.

use crate::Error;
use crate::case::{Case, Component};
use crate::model::Model;
use crate::packing::{Packing, QUANTITIES};
use crate::small_cases::cases;
use crate::variant::Variant;
use crate::{reference, solver};
use serde::{Deserialize, Serialize};

/// Numerical band of a velocity over the speed of its case: arms of `R` and of `R - d/2` differ by half of the overlap, up to 0.5 % of the
/// radius here, and codes take either.
const ARM: f64 = 0.003;

/// Runs of each packing with other starts.
const SEEDS: u64 = 6;

/// An expected number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    /// Name of the case.
    pub case: String,
    /// Name of the quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Expected value.
    pub value: f64,
    /// Standard deviation that counts as agreement: numerical for the small cases, over seeds for bed and heap.
    pub band: f64,
    /// Value in closed form, if there is one.
    pub closed_form: Option<f64>,
    /// Whether the number varies with the start, so that it judges and does not name.
    pub varies: bool,
}

/// Expected numbers of all cases: the small ones first.
///
/// # Errors
///
/// A run that breaks off.
pub fn expected(model: &Model) -> Result<Vec<Expected>, Error> {
    let mut rows = of_small_cases(model)?;
    for packing in Packing::ALL {
        rows.extend(of_packing(model, packing)?);
    }
    Ok(rows)
}

/// Expected numbers of the small cases.
///
/// # Errors
///
/// A run that breaks off.
pub fn of_small_cases(model: &Model) -> Result<Vec<Expected>, Error> {
    let mut rows = Vec::new();
    for case in cases(model) {
        let values = solver::run(&case, model, 1.0)?;
        let finer = solver::run(&case, model, 0.5)?;
        for ((quantity, value), finer) in case.quantities.iter().zip(&values).zip(&finer) {
            rows.push(Expected {
                case: case.name.into(),
                quantity: quantity.name(),
                unit: quantity.unit().into(),
                value: *finer,
                band: band(&case, quantity.component, model).hypot(value - finer),
                closed_form: quantity.closed_form,
                varies: false,
            });
        }
    }
    Ok(rows)
}

/// The part of the band that does not depend on the step.
fn band(case: &Case, component: Component, model: &Model) -> f64 {
    match component {
        Component::Velocity(_) => ARM * case.speed,
        Component::Spin(_) => ARM * case.speed / model.radius_m,
        // A displacement is a speed times the time; its error is that of the deceleration, twice.
        Component::Displacement(_) => {
            let time = case.times.first().copied().unwrap_or_default();
            ARM * case.speed * time
        }
    }
}

/// Mean and standard deviation of a packing over its starts; the mean of so many runs adds its error to that of one run.
fn of_packing(model: &Model, packing: Packing) -> Result<Vec<Expected>, Error> {
    let runs: Vec<[f64; 2]> = (1..=SEEDS)
        .map(|seed| packing.run(model, seed))
        .collect::<Result<_, _>>()?;
    let n = SEEDS as f64;
    let rows = QUANTITIES.into_iter().enumerate().map(|(k, name)| {
        let mean = runs.iter().map(|run| run[k]).sum::<f64>() / n;
        let square: f64 = runs.iter().map(|run| (run[k] - mean).powi(2)).sum();
        Expected {
            case: packing.name().into(),
            quantity: name.into(),
            unit: "m".into(),
            value: mean,
            band: (square / (n - 1.0) * (1.0 + 1.0 / n)).sqrt(),
            closed_form: None,
            varies: true,
        }
    });
    Ok(rows.collect())
}

/// By how much the numbers of a small case change if the parameters are read in another way, by the reference integrator; `nominal` are
/// its numbers with this solver's reading.
pub(crate) fn shift(case: &Case, nominal: &[f64], variant: &Variant) -> Vec<f64> {
    let values = reference::run(case, variant);
    values
        .iter()
        .zip(nominal)
        .map(|(value, nominal)| value - nominal)
        .collect()
}
