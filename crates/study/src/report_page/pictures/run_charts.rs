//! Charts of single runs and of points: series, sweeps, bars.

use super::NamedPicture;
use crate::report_page::material::RunDetails;
use crate::report_page::published_surface::PublishedSurface;
use crate::{Error, StudyFile, StudyResult, SweepPoint};
use report::{
    AxisTitle, Bar, BarsWithTarget, Level, LineSeries, Series, SeriesPoint, Target, TimeSeries,
    TimeSpan,
};
use run_store::Record;

/// Points of the published regression along a sweep.
const CURVE_POINTS: usize = 11;

/// Direction of the centre of mass over time, with the steady part and the sampled moments;
/// nothing where the run kept no series.
pub(super) fn series(record: &Record) -> Result<Option<NamedPicture>, Error> {
    let run = RunDetails::of(record);
    let n = run.times_s.len();
    if n < 2 || run.centre_of_mass_deg.len() != n {
        return Ok(None);
    }
    let (first, last) = (run.times_s[0], run.times_s[n - 1]);
    let mean = record.observable("centre_of_mass_deg");
    let chart = TimeSeries {
        time_title: AxisTitle::new("time since the drive started", "s"),
        value_title: AxisTitle::new("direction of the centre of mass", "°"),
        steady: run
            .start_up_s
            .filter(|s| *s < last)
            .map(|from| TimeSpan { from, to: last }),
        samples: run
            .frame_times_s
            .iter()
            .map(|t| t.clamp(first, last))
            .collect(),
        levels: mean
            .map(|m| Level::new("mean of the steady part", m.mean))
            .into_iter()
            .collect(),
        times: run.times_s,
        values: run.centre_of_mass_deg,
    };
    Ok(Some(NamedPicture::chart(
        "validation-series",
        chart.draw()?,
    )))
}

/// Points of a sweep with the standard deviations of their runs.
fn line(points: &[SweepPoint]) -> Vec<SeriesPoint> {
    let point =
        |p: &SweepPoint| SeriesPoint::new(p.value, p.result.mean, p.result.sd.unwrap_or(0.0));
    points.iter().map(point).collect()
}

/// Angle against the swept parameter, beside what the study says.
pub(super) fn sweep(
    study: &StudyFile,
    result: &StudyResult,
) -> Result<Option<NamedPicture>, Error> {
    if result.sweep.is_empty() {
        return Ok(None);
    }
    let symbol = study.sweep.symbol.as_str();
    let factor = study.factor(symbol)?;
    let mut series = vec![Series {
        name: "this work".into(),
        points: line(&result.sweep),
    }];
    if let Some(published) = PublishedSurface::of(study) {
        let curve: Vec<SeriesPoint> = (0..CURVE_POINTS)
            .filter_map(|k| {
                let share = k as f64 / (CURVE_POINTS - 1) as f64;
                let at = factor.low + (factor.high - factor.low) * share;
                let value = |name: &str| {
                    if name == symbol {
                        Some(at)
                    } else {
                        study.published_optimum.get(name).copied()
                    }
                };
                Some(SeriesPoint::new(at, published.angle_deg(&value)?, 0.0))
            })
            .collect();
        if !curve.is_empty() {
            series.push(Series {
                name: "study, eq. (10)".into(),
                points: curve,
            });
        }
        let at_bench = study.published.sliding_angle_at_measured_deg;
        series.push(Series {
            name: "study at the bench means (sliding)".into(),
            points: vec![SeriesPoint::new(factor.measured.mean, at_bench, 0.0)],
        });
    }
    let chart = LineSeries {
        x: AxisTitle::new(format!("{symbol}: {}", factor.name), ""),
        y: AxisTitle::new("repose angle", "°"),
        series,
        levels: vec![Level::new("measured", study.target.value)],
    };
    Ok(Some(NamedPicture::chart("sweep", chart.draw()?)))
}

/// Angle at the bench measurements against the smoothness of the filling.
pub(super) fn smoothness(result: &StudyResult) -> Result<Option<NamedPicture>, Error> {
    if result.smoothness.is_empty() {
        return Ok(None);
    }
    let points = line(&result.smoothness);
    let chart = LineSeries {
        x: AxisTitle::new("smoothness of the filling", ""),
        y: AxisTitle::new("repose angle", "°"),
        series: vec![Series {
            name: "simulated at the bench means".into(),
            points,
        }],
        levels: vec![Level::new("measured", result.solutions.target)],
    };
    Ok(Some(NamedPicture::chart("smoothness", chart.draw()?)))
}

/// Filling angle: measured, published simulation, and ours.
pub(super) fn filling_angle(result: &StudyResult) -> Result<Option<NamedPicture>, Error> {
    let metering = &result.metering;
    let bar = |name: &str, [value, error]: [f64; 2]| Bar {
        name: name.into(),
        value,
        error,
    };
    let ours = [metering.result.mean, metering.result.sd.unwrap_or(0.0)];
    let [value, half_width] = metering.published_measured_deg;
    let chart = BarsWithTarget {
        value_title: AxisTitle::new("filling angle", "°"),
        bars: vec![
            bar("measured (study)", metering.published_measured_deg),
            bar("simulated (study)", metering.published_simulated_deg),
            bar("this work, assumed dimensions", ours),
        ],
        target: Target {
            name: "measured (study), sd".into(),
            value,
            half_width,
        },
    };
    Ok(Some(NamedPicture::chart("filling-angle", chart.draw()?)))
}
