//! The error of every measurement before and after, in one chart.

use super::NamedPicture;
use crate::measurement_rows::{MeasurementRow, rows};
use crate::{Error, ReportInput};
use inference::Role;
use report::{AxisTitle, ResidualCondition, ResidualPanel, Residuals};

/// Name of the chart.
pub(crate) const ERRORS: &str = "errors";

/// Measured minus simulated in standard errors, before, fitted and with what is added, by the number of the measurement in the first table,
/// with the band in which it is met; nothing where no run was made at the estimate.
pub(super) fn chart(input: &ReportInput<'_>) -> Result<Option<NamedPicture>, Error> {
    let all: Vec<MeasurementRow<'_>> = rows(input);
    if all.iter().all(|row| row.after.is_none()) {
        return Ok(None);
    }
    let mut models = Vec::new();
    let mut residuals = Vec::new();
    if all.iter().any(|row| row.before.is_some()) {
        models.push("before".to_owned());
        residuals.push(all.iter().map(|r| r.before.map(|c| c.z)).collect());
    }
    models.push("fitted".into());
    residuals.push(all.iter().map(|r| r.after.map(|c| c.z)).collect());
    if input.calibration.with_effects.is_some() {
        models.push("with what is added".into());
        residuals.push(all.iter().map(|r| r.with_effects.map(|c| c.z)).collect());
    }
    let condition = |(number, row): (usize, &MeasurementRow<'_>)| ResidualCondition {
        name: (number + 1).to_string(),
        role: match row.measurement.role {
            Role::Fit => report::Role::Fit,
            Role::Check | Role::Show => report::Role::Check,
        },
    };
    let chart = Residuals {
        models,
        noise_name: "limit of |z|".into(),
        conditions: all.iter().enumerate().map(condition).collect(),
        panels: vec![ResidualPanel {
            observable: AxisTitle::new("z", ""),
            residuals,
            noise: all
                .iter()
                .map(|r| r.after.map_or(0.0, |c| c.z_limit))
                .collect(),
        }],
    };
    Ok(Some(NamedPicture::chart(ERRORS, chart.draw()?)))
}
