//! Charts of single runs.

use super::NamedPicture;
use crate::measurement_rows::{MeasurementRow, rows};
use crate::run_details::RunDetails;
use crate::{Error, ReportInput};
use campaign::run_store::Record;
use inference::{Model, Role};
use report::{AxisTitle, Level, TimeSeries, TimeSpan};

/// The models that are kept for the check, each with the records of its runs at the estimate.
pub(crate) fn check_runs<'a>(input: &ReportInput<'a>) -> Vec<(&'a Model, Vec<&'a Record>)> {
    let mut models: Vec<(&'a Model, Vec<&'a Record>)> = Vec::new();
    let checks = rows(input).into_iter();
    for row in checks.filter(|row| row.measurement.role == Role::Check) {
        if models.iter().all(|(model, _)| model.name != row.model.name) {
            models.push((row.model, records_of(input, &row)));
        }
    }
    models
}

/// Records of the runs behind a row that are there, in the order of the row.
fn records_of<'a>(input: &ReportInput<'a>, row: &MeasurementRow<'a>) -> Vec<&'a Record> {
    let keys = row.after.map_or(&[][..], |c| c.keys.as_slice());
    keys.iter()
        .filter_map(|key| input.records.get(key))
        .collect()
}

/// Name of the series of a model of the check.
pub(crate) fn series_name(number: usize) -> String {
    format!("check-{}-series", number + 1)
}

/// Direction of the centre of mass over time in the first run of each model of the check that kept its series, with the
/// steady part and the sampled moments.
pub(super) fn series(input: &ReportInput<'_>) -> Result<Vec<NamedPicture>, Error> {
    let mut charts = Vec::new();
    for (number, (_, records)) in check_runs(input).into_iter().enumerate() {
        let Some(record) = records.first() else {
            continue;
        };
        if let Some(chart) = series_of(record) {
            charts.push(NamedPicture::chart(series_name(number), chart.draw()?));
        }
    }
    Ok(charts)
}

/// The series of a run; nothing where it kept none.
pub(super) fn series_of(record: &Record) -> Option<TimeSeries> {
    let run = RunDetails::of(record);
    let n = run.times_s.len();
    if n < 2 || run.centre_of_mass_deg.len() != n {
        return None;
    }
    let (first, last) = (run.times_s[0], run.times_s[n - 1]);
    let mean = record.observable("centre_of_mass_deg");
    let moments = run.frame_times_s.iter();
    Some(TimeSeries {
        time_title: AxisTitle::new("time since the drive started", "s"),
        value_title: AxisTitle::new("direction of the centre of mass", "°"),
        steady: run
            .start_up_s
            .filter(|s| *s < last)
            .map(|from| TimeSpan { from, to: last }),
        samples: moments.map(|t| t.clamp(first, last)).collect(),
        levels: mean
            .map(|m| Level::new("mean of the steady part", m.mean))
            .into_iter()
            .collect(),
        times: run.times_s,
        values: run.centre_of_mass_deg,
    })
}
