//! What a series of frames says: means with their errors, how they go together, and what they tell of time.

use crate::file::{MeasuredCorrelation, MeasuredEntry, MeasuredValue};
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
/// Name of the speed of the surface.
pub(crate) const SPEED: &str = "surface_speed_m_s";
/// Name of the share of the drum that the bed fills.
pub(crate) const FILL: &str = "fill_level";
/// Observables that are taken over only if the file names them.
///
/// A run gives [`MEMORY`], [`SIZE`], [`WAITING`] and [`SPEED`] only if its bed moves so, or its frames lie close enough; a fit that
/// asks for one of them loses each run without it. [`FILL`] is what the scene is told (number or mass of its seeds): fitted, a
/// small mistake of that input moves the parameters by many standard errors, since pictures show it to a thousandth.
pub(crate) const IF_NAMED: [&str; 5] = [FILL, MEMORY, SIZE, WAITING, SPEED];
/// All observables that photos of drums and heaps give.
pub(crate) const OF_PHOTOS: [&str; 12] = [
    "angle_deg",
    "angle_of_repose_deg",
    "curvature",
    "s_shape",
    "shape_4",
    "shape_5",
    FLUCTUATION,
    FILL,
    MEMORY,
    SIZE,
    WAITING,
    SPEED,
];
/// Scatter, over the mean, of values that are the same but for the rounding of their mean.
const ROUNDING: f64 = 1e-12;
/// Fewest independent frames that tell a standard deviation: it is known to a third then.
const LEAST_FRAMES: f64 = 5.0;

/// An observable that was taken over, and what stands for it in each frame.
type Column = (&'static str, Vec<f64>);

/// What may be taken over, and how the frames follow each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// Observables that the scene gives.
    pub(crate) observables: &'a [&'a str],
    /// Of [`IF_NAMED`], the ones that the file names.
    pub(crate) also: &'a [String],
    /// Observables that the file leaves out.
    pub(crate) leave_out: &'a [String],
    /// Time between frames, s, where it is known.
    pub(crate) interval: Option<f64>,
}

/// The filling that photos show, if it is compared and not fitted: what the scene is told is judged by nobody, and a value that the
/// entry states counts instead.
pub(crate) fn shown_fill(
    series: Option<&PhotoSeries>,
    entry: &MeasuredEntry,
) -> Option<(String, MeasuredValue)> {
    let value = series?.further.get(FILL)?;
    (!entry.values.contains_key(FILL)).then(|| (FILL.to_owned(), *value))
}

/// Takes over what frames, and the speeds of the surface between pictures (m/s), say.
pub(crate) fn take_over(
    frames: &[FrameValues],
    speeds: &[f64],
    wanted: Wanted<'_>,
    series: &mut PhotoSeries,
) {
    let mut columns = means(frames, wanted, series);
    let interval = wanted.interval;
    if let Some(interval) = interval {
        memory(interval, wanted, series);
        if let Some(found) = avalanches(&series.angles_deg, interval) {
            of_avalanches(&found, interval, wanted, series);
        }
    }
    if let Ok(found) = summarise(speeds)
        && found.sd > 0.0
    {
        let value = MeasuredValue {
            mean: found.mean,
            sd: found.sd,
            n: found.n_effective,
        };
        // A speed of every frame, and not of some, goes with the other observables of that frame.
        if tell(SPEED, value, wanted, series) && speeds.len() == frames.len() {
            columns.push((SPEED, speeds.to_vec()));
        }
    }
    if series.values.contains_key(SIZE) {
        series.remarks.push(format!(
            "{FLUCTUATION}: left out, the size of the avalanches gives it"
        ));
    } else {
        columns.extend(fluctuation(wanted, series));
    }
    for name in wanted
        .also
        .iter()
        .filter(|name| !series.values.contains_key(*name))
    {
        series
            .remarks
            .push(format!("{name}: left out, the photos do not show it"));
    }
    for name in wanted.leave_out {
        let remark = format!("{name}: left out, as photo.leave_out says");
        series.remarks.push(remark);
    }
    correlate(&columns, series);
}

impl Wanted<'_> {
    /// Whether the scene gives an observable and the file does not leave it out.
    fn takes(&self, name: &str) -> bool {
        self.observables.contains(&name) && !self.leave_out.iter().any(|out| out == name)
    }

    /// Whether the file names an observable among those that are taken over only then.
    fn names(&self, name: &str) -> bool {
        self.also.iter().any(|also| also == name)
    }
}

/// Takes over an observable that not every run gives where the file names it, and says it otherwise; whether it was taken over.
fn tell(
    name: &'static str,
    value: MeasuredValue,
    wanted: Wanted<'_>,
    series: &mut PhotoSeries,
) -> bool {
    let given = wanted.takes(name);
    let taken = given && wanted.names(name);
    if taken {
        series.values.insert(name.to_owned(), value);
    } else {
        if given {
            series.remarks.push(format!(
                "{name}: not taken over, a run may not give it; name it in photo.also where all runs do"
            ));
        }
        series.further.insert(name.to_owned(), value);
    }
    taken
}

/// Means over the frames; the values of those that have an error.
fn means(frames: &[FrameValues], wanted: Wanted<'_>, series: &mut PhotoSeries) -> Vec<Column> {
    let mut columns = Vec::new();
    let Some(first) = frames.first() else {
        return columns;
    };
    for (k, (name, value)) in first.values.iter().enumerate() {
        if !wanted.takes(name) {
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
            Some(mut taken) if taken.sd > ROUNDING * taken.mean.abs() => {
                if k == 0 && taken.sd < reading_error(frames) {
                    taken.sd = reading_error(frames);
                    series.remarks.push(format!(
                        "{name}: the photos agree by chance better than each is read; its sd is the error of the reading"
                    ));
                }
                if *name == FILL && !wanted.names(name) {
                    series.further.insert((*name).to_owned(), taken);
                    series.remarks.push(format!(
                        "{FILL}: compared and not fitted, since it follows from the number or mass of the seeds; name it in \
                         photo.also to fit it"
                    ));
                    continue;
                }
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

/// Root mean square of the standard errors with which the frames are read, in the unit of their first value. Frames scatter by
/// that, however few of them agree.
fn reading_error(frames: &[FrameValues]) -> f64 {
    let squares = frames.iter().map(|f| f.error * f.error);
    (squares.sum::<f64>() / frames.len().max(1) as f64).sqrt()
}

/// The standard deviation of the angle between frames, deg; none of too few. Its column are the squares about the mean, as the
/// standard deviation changes with each of them.
///
/// # Formula
///
/// The standard error of the standard deviation s of n independent normal values is `s / sqrt(2 (n - 1))`.
fn fluctuation(wanted: Wanted<'_>, series: &mut PhotoSeries) -> Option<Column> {
    let angles = summarise(&series.angles_deg).ok()?;
    let told = angles.sd > 0.0 && angles.n_effective >= LEAST_FRAMES;
    if !told || !wanted.takes(FLUCTUATION) {
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
fn memory(interval: f64, wanted: Wanted<'_>, series: &mut PhotoSeries) {
    if let Some(found) = correlation_time(&series.angles_deg, interval) {
        let value = MeasuredValue {
            mean: found.time,
            sd: found.standard_error,
            n: 1.0,
        };
        tell(MEMORY, value, wanted, series);
    }
}

/// Size and waiting time of avalanches. A waiting time is the difference of two times that are known to an interval: its
/// standard deviation is never less than `interval / sqrt(6)`.
fn of_avalanches(found: &Avalanches, interval: f64, wanted: Wanted<'_>, series: &mut PhotoSeries) {
    let least = interval / 6.0_f64.sqrt();
    let pairs = [
        (SIZE, &found.sizes, 0.0),
        (WAITING, &found.waiting_times, least),
    ];
    let mut columns: Vec<Column> = Vec::new();
    for (name, values, least) in pairs {
        if let Ok(s) = summarise(values)
            && s.sd.max(least) > 0.0
        {
            let value = MeasuredValue {
                mean: s.mean,
                sd: s.sd.max(least),
                n: s.n_effective,
            };
            if tell(name, value, wanted, series) {
                // An avalanche and the time that the next one takes to come.
                columns.push((name, values[..found.waiting_times.len()].to_vec()));
            }
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
