//! Charts of single runs.

use crate::measurement_rows::{MeasurementRow, rows};
use crate::numbers::observable;
use crate::run_details::{RunDetails, curve_column};
use crate::{CurvePoints, ReportInput};
use campaign::run_store::Record;
use inference::{Model, Role};
use report::{Axis, AxisTitle, Format, Mark, Plot, PlotPoint, Shape, colour};

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

/// Direction of the centre of mass over time, with the steady part and the moments of the frames; `None` if the run kept no series.
pub(crate) fn series_of(record: &Record) -> Option<Plot> {
    let run = RunDetails::of(record);
    let (times, values) = (&run.times_s, &run.centre_of_mass_deg);
    let n = times.len();
    if n < 2 || values.len() != n {
        return None;
    }
    let (first, last) = (times[0], times[n - 1]);
    let mean = record
        .observable("centre_of_mass_deg")
        .map(|mean| mean.mean);
    let shown = || values.iter().copied().chain(mean);
    let [low, high] = [
        shown().fold(f64::INFINITY, f64::min),
        shown().fold(f64::NEG_INFINITY, f64::max),
    ];
    let room = 0.06 * (high - low);
    let [low, high] = [low - room, high + room];
    let axis = |quantity, unit, ends| Axis::Numbers {
        title: AxisTitle::new(quantity, unit),
        ends: Some(ends),
    };
    let steady = run.start_up_s.filter(|start| *start < last);
    let band = steady.map(|start| {
        let outline = vec![[start, low], [last, low], [last, high], [start, high]];
        Mark::area("steady part", colour::BAND, 0.8, vec![outline])
    });
    let line = thinned(times, values)
        .into_iter()
        .map(|i| [times[i], values[i]]);
    let frames = run.frame_times_s.iter().map(|t| {
        let t = t.clamp(first, last);
        PlotPoint::new(t, value_at(times, values, t))
    });
    let frames = Mark::points(
        "sampled moments",
        Shape::Circle,
        colour::VERMILION,
        frames.collect(),
    );
    let mut plot = Plot::new(
        axis("time since the drive started", "s", [first, last]),
        axis("direction of the centre of mass", "°", [low, high]),
    )
    .with_all(band)
    .with(Mark::line(
        "direction of the centre of mass",
        colour::BLUE,
        line.collect(),
    ))
    .with(frames)
    .with_all(mean.map(|mean| Mark::level("mean of the steady part", mean)));
    plot.format = Format::Height(280.0);
    Some(plot)
}

/// A measured curve beside those of the runs at the estimate; `None` if no record of them is there.
pub(crate) fn curve_chart(input: &ReportInput<'_>, curve: &CurvePoints) -> Option<Plot> {
    let is_score = |name: &str| {
        let score = name.strip_prefix(&curve.name);
        score.is_some_and(|score| score.ends_with(&curve.column))
    };
    let rows = rows(input).into_iter();
    let mut of_curve =
        rows.filter(|row| row.model.name == curve.model && is_score(&row.measurement.observable));
    let records = records_of(input, &of_curve.next()?);
    let simulated: Vec<Vec<[f64; 2]>> = records
        .iter()
        .map(|record| {
            let along = curve_column(record, &curve.along);
            let values = curve_column(record, &curve.column);
            let kept = thinned(&along, &values).into_iter();
            kept.map(|i| [along[i], values[i]]).collect()
        })
        .filter(|points: &Vec<_>| points.len() > 1)
        .collect();
    if simulated.is_empty() {
        return None;
    }
    // Lines alone do not widen an axis.
    let axis = |column: &str, k: usize| {
        let all = || {
            simulated
                .iter()
                .chain(&curve.repeats)
                .flatten()
                .map(|p| p[k])
        };
        let low = all().fold(f64::INFINITY, f64::min);
        let high = all().fold(f64::NEG_INFINITY, f64::max);
        let (words, unit) = observable(column);
        Axis::Numbers {
            title: AxisTitle::new(words, unit),
            ends: (high > low).then_some([low, high + 0.04 * (high - low)]),
        }
    };
    let measured = curve.repeats.iter().flatten();
    let measured = measured.map(|[x, y]| PlotPoint::new(*x, *y)).collect();
    let mut plot = Plot::new(axis(&curve.along, 0), axis(&curve.column, 1))
        .with(Mark::Line {
            name: "simulated".into(),
            colour: colour::BLUE.into(),
            width: 1.5,
            dashed: false,
            label: String::new(),
            pieces: simulated,
        })
        .with(Mark::points(
            "measured",
            Shape::Circle,
            colour::VERMILION,
            measured,
        ));
    plot.format = Format::Height(320.0);
    Some(plot)
}

/// Value at a time within the series, by linear interpolation.
fn value_at(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times
        .partition_point(|&before| before < time)
        .clamp(1, times.len() - 1);
    let [t0, t1] = [times[after - 1], times[after]];
    let [v0, v1] = [values[after - 1], values[after]];
    v0 + (v1 - v0) * (time - t0) / (t1 - t0)
}

/// Columns into which a long series is thinned out; each keeps its extremes.
const COLUMNS: usize = 600;

/// Which entries are drawn: all of a short series, the first, last, least and greatest of every
/// column of a long one, so that no spike is lost.
fn thinned(times: &[f64], values: &[f64]) -> Vec<usize> {
    if times.len() <= 4 * COLUMNS {
        return (0..times.len()).collect();
    }
    let mut kept = Vec::with_capacity(4 * COLUMNS);
    for column in 0..COLUMNS {
        let from = column * times.len() / COLUMNS;
        let to = (column + 1) * times.len() / COLUMNS;
        let mut chosen = vec![from, to - 1];
        chosen.extend((from..to).min_by(|&a, &b| values[a].total_cmp(&values[b])));
        chosen.extend((from..to).max_by(|&a, &b| values[a].total_cmp(&values[b])));
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::{COLUMNS, thinned};

    #[test]
    fn long_series_is_thinned_without_losing_a_spike() {
        let times: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut values: Vec<f64> = times.iter().map(|t| (t * 1e-3).sin()).collect();
        values[54_321] = 7.0;
        let kept = thinned(&times, &values);
        assert!(kept.len() <= 4 * COLUMNS, "{}", kept.len());
        assert!(kept.contains(&54_321) && kept.contains(&0) && kept.contains(&99_999));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
