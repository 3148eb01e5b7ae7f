//! What a series of frames says: means with their errors, their correlations, and correlation times.

use crate::file::{MeasuredCorrelation, MeasuredEntry, MeasuredValue};
use crate::photos::{FrameValues, PhotoSeries};
use input::quantity::significant;
use photo_profile::SelectionBias;
use surface_profile::{
    Avalanches, SeriesSummary, avalanches, correlation_time, longest_unbroken, shrunk_correlations,
    summarise,
};

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
/// asks for one of them loses each run without it. [`FILL`] is an input of the scene (number or mass of its seeds): if it is fitted, a
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
/// Fewest independent frames that give a standard deviation: it is then known to a third.
const LEAST_FRAMES: f64 = 5.0;

/// An observable that was taken over, and its value in each frame; `None` in a frame that does not show it.
type Column = (&'static str, Vec<Option<f64>>);

/// What may be taken over, and how the frames follow each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// Observables that the scene gives.
    pub(crate) observables: &'a [&'a str],
    /// Of [`IF_NAMED`], the ones that the file names.
    pub(crate) also: &'a [String],
    /// Observables that the file leaves out.
    pub(crate) leave_out: &'a [String],
    /// Time between frames, s, if it is known.
    pub(crate) interval: Option<f64>,
}

/// The filling that photos show, if it is compared and not fitted: an input of the scene is not judged, and a value that the
/// entry states counts instead.
pub(crate) fn shown_fill(
    series: Option<&PhotoSeries>,
    entry: &MeasuredEntry,
) -> Option<(String, MeasuredValue)> {
    let value = series?.further.get(FILL)?;
    (!entry.values.contains_key(FILL)).then(|| (FILL.to_owned(), *value))
}

/// Takes over the observables of frames, and the speeds of the surface between pictures (m/s); `lost` pairs of pictures give none.
///
/// # Errors
///
/// More frames without a value than the mean of the first observable bears, as the rest of a sentence about the photos.
pub(crate) fn take_over(
    frames: &[Option<FrameValues>],
    (speeds, lost): (&[f64], usize),
    wanted: Wanted<'_>,
    series: &mut PhotoSeries,
) -> Result<(), String> {
    let mut columns = means(frames, wanted, series)?;
    let angles: Vec<Option<f64>> = frames.iter().map(|f| value_of(f.as_ref(), 0)).collect();
    if let Some(interval) = wanted.interval {
        let unbroken = longest_unbroken(&angles);
        memory(&unbroken, interval, wanted, series);
        if let Some(found) = avalanches(&unbroken, interval) {
            of_avalanches(&found, interval, wanted, series);
        }
    }
    columns.extend(speed((speeds, lost), frames.len(), wanted, series));
    if series.values.contains_key(SIZE) {
        series.remarks.push(format!(
            "{FLUCTUATION}: left out, the size of the avalanches gives it"
        ));
    } else {
        columns.extend(fluctuation(&angles, wanted, series));
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
    Ok(())
}

/// The value of a frame by its place, if the frame shows it.
fn value_of(frame: Option<&FrameValues>, place: usize) -> Option<f64> {
    let value = frame?.values.get(place)?.1;
    value.is_finite().then_some(value)
}

/// Takes over the speeds of the surface; their column if every frame gives one.
fn speed(
    (speeds, lost): (&[f64], usize),
    frames: usize,
    wanted: Wanted<'_>,
    series: &mut PhotoSeries,
) -> Option<Column> {
    let found = summarise(speeds).ok().filter(|found| found.sd > 0.0)?;
    let bias = SelectionBias::new(&found, lost);
    if bias.is_some_and(|bias| !bias.is_borne()) {
        series.remarks.push(format!(
            "{SPEED}: left out, too many pairs of pictures do not show it"
        ));
        return None;
    }
    let value = MeasuredValue::of_mean(found.mean, found.sd, found.n_effective);
    // A speed of every frame, and not of some, goes with the other observables of that frame.
    let is_taken = tell(SPEED, value, wanted, series) && speeds.len() == frames;
    is_taken.then(|| (SPEED, speeds.iter().copied().map(Some).collect()))
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

/// Takes over an observable that not every run gives if the file names it, and adds a remark otherwise. Returns whether it was taken over.
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
///
/// # Errors
///
/// More frames without the first observable than its mean bears.
fn means(
    frames: &[Option<FrameValues>],
    wanted: Wanted<'_>,
    series: &mut PhotoSeries,
) -> Result<Vec<Column>, String> {
    let mut columns = Vec::new();
    let read: Vec<&FrameValues> = frames.iter().flatten().collect();
    let Some(first) = read.first() else {
        return Ok(columns);
    };
    for (k, (name, _)) in first.values.iter().enumerate() {
        if !wanted.takes(name) {
            continue;
        }
        let column: Vec<Option<f64>> = frames.iter().map(|f| value_of(f.as_ref(), k)).collect();
        let shown: Vec<f64> = column.iter().copied().flatten().collect();
        let Ok(summary) = summarise(&shown) else {
            series
                .remarks
                .push(format!("{name}: left out, no photo shows it"));
            continue;
        };
        if let Some(bias) = SelectionBias::new(&summary, frames.len() - shown.len()) {
            if !bias.is_borne() && k == 0 {
                return Err(too_many(name, &bias));
            }
            if !bias.is_borne() {
                series.remarks.push(format!(
                    "{name}: left out, {} of {} photos do not show it",
                    bias.left_out, bias.of
                ));
                continue;
            }
            series.left_out.push(told(name, &bias));
        }
        if let Some(taken) = value_from((k, name), &summary, &read, series) {
            if *name == FILL && !wanted.names(name) {
                series.further.insert((*name).to_owned(), taken);
                series.remarks.push(format!(
                    "{FILL}: compared and not fitted, since it follows from the number or mass of the seeds; name it in \
                     photo.also to fit it"
                ));
                continue;
            }
            series.values.insert((*name).to_owned(), taken);
            if shown.len() > 1 {
                columns.push((*name, column));
            }
        }
    }
    Ok(columns)
}

/// The k-th observable of the frames that show it; `None` if they give no error of it.
fn value_from(
    (k, name): (usize, &str),
    summary: &SeriesSummary,
    read: &[&FrameValues],
    series: &mut PhotoSeries,
) -> Option<MeasuredValue> {
    let error = reading_error(read);
    let is_one = summary.n == 1;
    if is_one && k > 0 {
        series
            .remarks
            .push(format!("{name}: left out, one photo shows no error of it"));
        return None;
    }
    if is_one {
        series.remarks.push(format!(
            "{name}: one photo; its sd is the standard error of the reading, and what changes from frame \
             to frame is not in it"
        ));
    }
    let mut sd = if is_one { error } else { summary.sd };
    if sd.is_nan() || sd <= ROUNDING * summary.mean.abs() {
        series.remarks.push(format!(
            "{name}: left out, all frames show the same value: are they copies of one photo?"
        ));
        return None;
    }
    if k == 0 && sd < error {
        sd = error;
        series.remarks.push(format!(
            "{name}: the photos agree by chance better than each is read; its sd is the error of the reading"
        ));
    }
    let n = if is_one { 1.0 } else { summary.n_effective };
    Some(MeasuredValue::of_mean(summary.mean, sd, n))
}

/// What frames without a value may change in a mean.
fn told(name: &str, bias: &SelectionBias) -> String {
    format!(
        "{name}: {} of {} photos do not show it; if these were the highest of all, or the lowest, the mean of all would lie {} higher or \
         lower, {} of its standard error",
        bias.left_out,
        bias.of,
        significant(bias.most, 2),
        significant(bias.in_standard_errors, 2)
    )
}

/// Why so many frames without a value are too many.
fn too_many(name: &str, bias: &SelectionBias) -> String {
    let worst = if bias.most.is_finite() {
        format!(
            "if these were the highest of all, or the lowest, the mean of all would lie {} standard errors off, and more than one is too \
             much",
            significant(bias.in_standard_errors, 2)
        )
    } else {
        "what the others show is not enough to judge what they would change".to_owned()
    };
    format!(
        "show {name} too seldom: {} of {} do not, and {worst}; mend them, say how to read them with photo = {{ ... }}, or take them \
         out if what spoiled them has nothing to do with the bed",
        bias.left_out, bias.of
    )
}

/// Root mean square of the standard errors with which the frames are read, in the unit of their first value. Frames scatter by
/// that, however few of them agree.
fn reading_error(frames: &[&FrameValues]) -> f64 {
    let squares = frames.iter().map(|f| f.error * f.error);
    (squares.sum::<f64>() / frames.len().max(1) as f64).sqrt()
}

/// The standard deviation of the angle between frames, deg; `None` of too few. Its column holds the squares about the mean, as the
/// standard deviation changes with each of them.
fn fluctuation(
    angles: &[Option<f64>],
    wanted: Wanted<'_>,
    series: &mut PhotoSeries,
) -> Option<Column> {
    let summary = summarise(&series.angles_deg).ok()?;
    let told = summary.sd > 0.0 && summary.n_effective >= LEAST_FRAMES;
    if !told || !wanted.takes(FLUCTUATION) {
        return None;
    }
    if let Some(bias) = SelectionBias::new(&summary, angles.len() - summary.n) {
        if !bias.scatter_is_borne() {
            series.remarks.push(format!(
                "{FLUCTUATION}: left out, {} of {} photos do not show the angle",
                bias.left_out, bias.of
            ));
            return None;
        }
        series.left_out.push(format!(
            "{FLUCTUATION}: if these were the highest and the lowest of all, it would be up to {} % larger",
            significant(100.0 * bias.most_scatter, 2)
        ));
    }
    let value = MeasuredValue::of_scatter(summary.sd, summary.n_effective);
    series.values.insert(FLUCTUATION.to_owned(), value);
    let squares = angles.iter();
    let squares = squares.map(|a| a.map(|a| (a - summary.mean).powi(2)));
    Some((FLUCTUATION, squares.collect()))
}

/// The time over which the angle is correlated, by a series without a gap.
fn memory(angles: &[f64], interval: f64, wanted: Wanted<'_>, series: &mut PhotoSeries) {
    if let Some(found) = correlation_time(angles, interval) {
        let value = MeasuredValue::of_mean(found.time, found.standard_error, 1.0);
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
            let value = MeasuredValue::of_mean(s.mean, s.sd.max(least), s.n_effective);
            if tell(name, value, wanted, series) {
                // An avalanche and the time that the next one takes to come.
                let values = &values[..found.waiting_times.len()];
                columns.push((name, values.iter().copied().map(Some).collect()));
            }
        }
    }
    correlate(&columns, series);
}

/// How the means of observables go together that were read from the same frames.
fn correlate(columns: &[Column], series: &mut PhotoSeries) {
    let frames = columns.first().map_or(0, |c| c.1.len());
    // A frame shows the correlation of observables if it shows them all.
    let whole = |i: &usize| {
        columns
            .iter()
            .all(|c| c.1.get(*i).is_some_and(Option::is_some))
    };
    let whole: Vec<usize> = (0..frames).filter(whole).collect();
    let values = columns
        .iter()
        .map(|c| whole.iter().filter_map(|&i| c.1[i]).collect());
    let values: Vec<Vec<f64>> = values.collect();
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
