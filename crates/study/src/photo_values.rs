//! What a series of frames says: means with their errors, how they go together, and what the angle tells of time.

use crate::file::{MeasuredCorrelation, MeasuredValue};
use crate::photos::{FrameValues, PhotoSeries};
use surface_profile::{Avalanches, avalanches, correlation_time, shrunk_correlations, summarise};

/// Name of the standard deviation of the angle from frame to frame.
const FLUCTUATION: &str = "fluctuation_deg";
/// Name of the time over which the angle is correlated.
const MEMORY: &str = "angle_correlation_time_s";
/// Name of the mean fall of the angle in an avalanche.
const SIZE: &str = "avalanche_size_deg";
/// Name of the mean time from one avalanche to the next.
const WAITING: &str = "avalanche_waiting_time_s";
/// Fewest independent frames that tell a standard deviation: it is known to a third then.
const LEAST_FRAMES: f64 = 5.0;

/// An observable that was taken over, and what stands for it in each frame.
type Column = (&'static str, Vec<f64>);

/// Takes over what frames say of the observables that the scene gives; `interval` is the time between frames, s.
pub(crate) fn take_over(
    frames: &[FrameValues],
    observables: &[&str],
    interval: Option<f64>,
    series: &mut PhotoSeries,
) {
    let mut columns = means(frames, observables, series);
    let falls = interval.and_then(|interval| avalanches(&series.angles_deg, interval));
    match (interval, falls) {
        (Some(interval), Some(falls)) => of_avalanches(&falls, interval, observables, series),
        (interval, _) => {
            columns.extend(fluctuation(observables, series));
            if let Some(interval) = interval {
                memory(interval, observables, series);
            }
        }
    }
    correlate(&columns, series);
}

/// Means over the frames; the values of those that have an error.
fn means(frames: &[FrameValues], observables: &[&str], series: &mut PhotoSeries) -> Vec<Column> {
    let mut columns = Vec::new();
    let Some(first) = frames.first() else {
        return columns;
    };
    for (k, (name, value)) in first.values.iter().enumerate() {
        if !observables.contains(name) {
            continue;
        }
        let all = frames.iter().filter_map(|f| Some(f.values.get(k)?.1));
        let all: Vec<f64> = all.collect();
        let taken = match (all.len(), summarise(&all)) {
            (1, Ok(_)) if k == 0 => Some(MeasuredValue {
                mean: *value,
                sd: first.error,
                n: 1.0,
            }),
            (2.., Ok(s)) => Some(MeasuredValue {
                mean: s.mean,
                sd: s.sd,
                n: s.n_effective,
            }),
            (_, Err(_)) => {
                let remark = format!("{name}: left out, not every frame shows it");
                series.remarks.push(remark);
                continue;
            }
            _ => None,
        };
        match taken {
            Some(taken) if taken.sd > 0.0 => {
                series.values.insert((*name).to_owned(), taken);
                if all.len() == 1 {
                    series.remarks.push(format!(
                        "{name}: one photo; its sd is the standard error of the reading, and what changes from frame \
                         to frame is not in it"
                    ));
                } else {
                    columns.push((*name, all));
                }
            }
            Some(_) => series.remarks.push(format!(
                "{name}: left out, all frames show the same value: are they copies of one photo?"
            )),
            None => series
                .remarks
                .push(format!("{name}: left out, one photo tells no error of it")),
        }
    }
    columns
}

/// The standard deviation of the angle between frames, deg; none of too few. Its column are the squares about the mean, as the
/// standard deviation changes with each of them.
///
/// # Formula
///
/// The standard error of the standard deviation s of n independent normal values is `s / sqrt(2 (n - 1))`.
fn fluctuation(observables: &[&str], series: &mut PhotoSeries) -> Option<Column> {
    let angles = summarise(&series.angles_deg).ok()?;
    let told = angles.sd > 0.0 && angles.n_effective >= LEAST_FRAMES;
    if !told || !observables.contains(&FLUCTUATION) {
        return None;
    }
    let value = MeasuredValue {
        mean: angles.sd,
        sd: angles.sd * std::f64::consts::FRAC_1_SQRT_2,
        n: angles.n_effective - 1.0,
    };
    series.values.insert(FLUCTUATION.to_owned(), value);
    let squares = series.angles_deg.iter();
    let squares = squares.map(|a| (a - angles.mean).powi(2)).collect();
    Some((FLUCTUATION, squares))
}

/// The time over which the angle is correlated.
fn memory(interval: f64, observables: &[&str], series: &mut PhotoSeries) {
    let found = correlation_time(&series.angles_deg, interval);
    if let Some(found) = found.filter(|_| observables.contains(&MEMORY)) {
        let value = MeasuredValue {
            mean: found.time,
            sd: found.standard_error,
            n: 1.0,
        };
        series.values.insert(MEMORY.to_owned(), value);
    }
}

/// Size and waiting time of avalanches. The scatter of the angle and the time over which it is correlated follow from them, and
/// a fit would count the same evidence twice. A waiting time is the difference of two times that are known to an interval:
/// its standard deviation is never less than `interval / sqrt(6)`.
fn of_avalanches(
    found: &Avalanches,
    interval: f64,
    observables: &[&str],
    series: &mut PhotoSeries,
) {
    for left_out in [FLUCTUATION, MEMORY] {
        if observables.contains(&left_out) {
            series.remarks.push(format!(
                "{left_out}: left out, the bed moves in avalanches, and their size and waiting time give it"
            ));
        }
    }
    let pairs = [
        (SIZE, &found.sizes, 0.0),
        (WAITING, &found.waiting_times, interval / 6.0_f64.sqrt()),
    ];
    let mut columns: Vec<Column> = Vec::new();
    for (name, values, least) in pairs {
        if let Ok(s) = summarise(values)
            && observables.contains(&name)
            && s.sd.max(least) > 0.0
        {
            let value = MeasuredValue {
                mean: s.mean,
                sd: s.sd.max(least),
                n: s.n_effective,
            };
            series.values.insert(name.to_owned(), value);
            // An avalanche and the time that the next one takes to come.
            columns.push((name, values[..found.waiting_times.len()].to_vec()));
        }
    }
    correlate(&columns, series);
}

/// How the means of observables go together that were read from the same frames.
fn correlate(columns: &[Column], series: &mut PhotoSeries) {
    let values: Vec<Vec<f64>> = columns.iter().map(|c| c.1.clone()).collect();
    let Ok(matrix) = shrunk_correlations(&values) else {
        return;
    };
    for (i, row) in matrix.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(i) {
            if *value != 0.0 {
                series.correlations.push(MeasuredCorrelation {
                    a: columns[j].0.to_owned(),
                    b: columns[i].0.to_owned(),
                    value: *value,
                });
            }
        }
    }
}
