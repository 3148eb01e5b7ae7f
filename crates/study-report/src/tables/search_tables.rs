//! Tables of the search: boxes, rounds of confirmation, cost.

use super::csv::{CsvTable, Field};
use super::unit_of;
use crate::ReportInput;

/// The boxes, a row for each parameter of each box.
pub(super) fn boxes(input: &ReportInput<'_>) -> CsvTable {
    let columns = [
        "box", "why", "symbol", "unit", "low", "high", "best", "misfit_1", "new_runs",
    ];
    let mut table = CsvTable::new("boxes", columns);
    for (k, b) in input.calibration.boxes.iter().enumerate() {
        for (j, p) in input.calibration.parameters.iter().enumerate() {
            table.row([
                (k + 1).into(),
                (&b.why).into(),
                (&p.symbol).into(),
                (&p.unit).into(),
                b.low.get(j).copied().into(),
                b.high.get(j).copied().into(),
                b.best.get(j).copied().into(),
                b.misfit.into(),
                b.n_runs.into(),
            ]);
        }
    }
    table
}

/// The rounds of confirmation.
pub(super) fn confirmations(input: &ReportInput<'_>) -> CsvTable {
    let columns = [
        "round",
        "model",
        "observable",
        "unit",
        "predicted",
        "predicted_se",
        "simulated",
        "simulated_se",
        "runs",
        "z_1",
        "confirmed",
    ];
    let mut table = CsvTable::new("confirmations", columns);
    for (k, round) in input.calibration.confirmations.iter().enumerate() {
        for row in &round.rows {
            table.row([
                Field::from(k + 1),
                (&row.model).into(),
                (&row.observable).into(),
                unit_of(&row.observable).into(),
                row.predicted.into(),
                row.predicted_se.into(),
                row.simulated.mean.into(),
                row.simulated.se.into(),
                row.simulated.n_runs.into(),
                row.z.into(),
                round.confirmed.into(),
            ]);
        }
    }
    table
}

/// Runs and time by stage.
pub(super) fn cost(input: &ReportInput<'_>) -> CsvTable {
    let mut table = CsvTable::new("cost", ["stage", "runs", "wall_s"]);
    for stage in &input.calibration.cost {
        table.row([
            (&stage.stage).into(),
            stage.runs.into(),
            stage.wall_s.into(),
        ]);
    }
    table
}
