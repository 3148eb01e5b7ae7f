//! The error of every measurement before and after, in one chart.

use super::residuals::{ResidualCondition, residual_chart};
use crate::ReportInput;
use crate::measurement_rows::{MeasurementRow, rows};
use inference::Role;
use report::{Axis, Plot};

/// Measured minus simulated in standard errors - before, fitted and with what is added - by the number of the measurement in the first
/// table, with the band in which it is met; `None` if no run was made at the estimate.
pub(crate) fn errors(input: &ReportInput<'_>) -> Option<Plot> {
    let all: Vec<MeasurementRow<'_>> = rows(input);
    if all.iter().all(|row| row.after.is_none()) {
        return None;
    }
    let z = |of: fn(&MeasurementRow<'_>) -> Option<f64>| all.iter().map(of).collect();
    let mut models = Vec::new();
    if all.iter().any(|row| row.before.is_some()) {
        models.push(("before".to_owned(), z(|row| row.before.map(|c| c.z))));
    }
    models.push(("fitted".into(), z(|row| row.after.map(|c| c.z))));
    if input.calibration.with_effects.is_some() {
        let with = z(|row| row.with_effects.map(|c| c.z));
        models.push(("with what is added".into(), with));
    }
    let condition = |(number, row): (usize, &MeasurementRow<'_>)| ResidualCondition {
        name: (number + 1).to_string(),
        is_used: row.measurement.role == Role::Fit,
        noise: row.after.map_or(0.0, |c| c.z_limit),
    };
    let conditions: Vec<ResidualCondition> = all.iter().enumerate().map(condition).collect();
    Some(residual_chart(
        Axis::numbers("z", ""),
        "limit of |z|",
        &conditions,
        &models,
    ))
}
