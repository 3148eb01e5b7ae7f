//! Times in a series of angles at a known rate: its correlation time, and its avalanches.

use crate::correlation::{correlation, correlation_factor};

/// Largest relative standard error of a reported correlation time.
const MOST_RELATIVE_ERROR: f64 = 0.5;
/// Correlation factor of a correlation time of one interval: below, the intervals are too long to tell it.
const LEAST_FACTOR: f64 = 2.0;
/// Fewest avalanches that make a series one of avalanches.
const LEAST_AVALANCHES: usize = 3;
/// By how many standard errors the skewness of the steps must lie below 0: a series that is as often steep upwards as downwards
/// is taken for one of avalanches in 1 of 700 cases.
const SKEWED: f64 = 3.0;

/// A correlation time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrelationTime {
    /// The time, unit of the interval.
    pub time: f64,
    /// Its standard error, unit of the interval.
    pub standard_error: f64,
}

/// The avalanches in a series of angles, in time order.
#[derive(Debug, Clone, PartialEq)]
pub struct Avalanches {
    /// By how much the angle falls in each, unit of the angles.
    pub sizes: Vec<f64>,
    /// Angle at which each begins: that of maximum stability, unit of the angles.
    pub start_angles: Vec<f64>,
    /// Angle at which each comes to rest: that of repose, unit of the angles.
    pub stop_angles: Vec<f64>,
    /// Times from the start of each but the last to the start of the next, unit of the interval.
    pub waiting_times: Vec<f64>,
}

/// Autocorrelation time of a series at equal intervals; `None` if it is shorter than an interval, or
/// if the series is too short to determine it to a half.
///
/// # Formula
///
/// The integral of the correlation over the lags from 0 on, `interval tau / 2` with the correlation factor tau of
/// [`summarise`](crate::summarise): of a series whose correlation falls as `exp(-t / T)` it is T (8 % more where T is as short
/// as an interval). The relative standard error is `sqrt(2 (2 m + 1) / n)`, m the last lag that counts and n the number of
/// values.
///
/// # Source
///
/// `[Geyer1992, section 3.3]`; the error `[MadrasSokal1988, appendix C]`. The limits are ours.
pub fn correlation_time(values: &[f64], interval: f64) -> Option<CorrelationTime> {
    let n = values.len() as f64;
    let residuals = about_mean(values)?;
    let found = correlation(&residuals, 1.0);
    let relative = (2.0 * (2.0 * found.last_lag as f64 + 1.0) / n).sqrt();
    let time = 0.5 * interval * found.factor;
    let told = found.factor >= LEAST_FACTOR && relative <= MOST_RELATIVE_ERROR;
    (told && time.is_finite() && time > 0.0).then_some(CorrelationTime {
        time,
        standard_error: relative * time,
    })
}

/// The avalanches in a series of angles at equal intervals; `None` if there are fewer than three, or if the angle rises and falls
/// alike, as in a bed with a continuously flowing layer.
///
/// # Formula
///
/// A bed in avalanches is carried up with the drum in many small steps and comes down in few large ones. The skewness of the
/// steps from value to value must lie below `-3 sqrt(6 tau / n)`, n their number and tau their correlation factor: the
/// skewness of a process that looks alike forwards and backwards in time is 0, and `sqrt(6 / n)` is its standard error over
/// independent normal values. Turning points are those between which the angle changes by at least one standard deviation of
/// the series. An avalanche is a fall between two of them; a fall that began before the series or continues after it does not
/// count. The size is too small by about the rise of one interval.
///
/// # Source
///
/// The definition is ours.
pub fn avalanches(angles: &[f64], interval: f64) -> Option<Avalanches> {
    let residuals = about_mean(angles)?;
    let n = residuals.len() as f64;
    let sd = (residuals.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
    let steps: Vec<f64> = angles.windows(2).map(|w| w[1] - w[0]).collect();
    if !(sd > 0.0 && falls_faster(&steps)) {
        return None;
    }
    let falls = falls(angles, sd);
    if falls.len() < LEAST_AVALANCHES {
        return None;
    }
    let starts = falls.windows(2);
    Some(Avalanches {
        sizes: falls
            .iter()
            .map(|f| angles[f.start] - angles[f.end])
            .collect(),
        start_angles: falls.iter().map(|f| angles[f.start]).collect(),
        stop_angles: falls.iter().map(|f| angles[f.end]).collect(),
        waiting_times: starts
            .map(|w| (w[1].start - w[0].start) as f64 * interval)
            .collect(),
    })
}

/// The longest stretch of a series without a missing value, the first of several.
pub fn longest_unbroken(values: &[Option<f64>]) -> Vec<f64> {
    let mut longest: &[Option<f64>] = &[];
    for stretch in values.split(Option::is_none) {
        if stretch.len() > longest.len() {
            longest = stretch;
        }
    }
    longest.iter().copied().flatten().collect()
}

/// Values minus their mean; `None` if one is not finite, or if there are fewer than four.
fn about_mean(values: &[f64]) -> Option<Vec<f64>> {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    (n >= 4 && mean.is_finite()).then(|| values.iter().map(|v| v - mean).collect())
}

/// Whether the steps down are fewer and larger than those up, beyond chance.
fn falls_faster(steps: &[f64]) -> bool {
    let Some(residuals) = about_mean(steps) else {
        return false;
    };
    let n = residuals.len() as f64;
    let moment = |power: i32| residuals.iter().map(|r| r.powi(power)).sum::<f64>() / n;
    let skewness = moment(3) / moment(2).powf(1.5);
    let tau = correlation_factor(&residuals, 1.0);
    skewness < -SKEWED * (6.0 * tau / n).sqrt()
}

/// A fall between two turning points.
struct Fall {
    /// Number of the value at its top.
    start: usize,
    /// Number of the value at its bottom.
    end: usize,
}

/// All whole falls between turning points that are at least so much apart.
fn falls(values: &[f64], least: f64) -> Vec<Fall> {
    let mut found = Vec::new();
    // A top counts behind a bottom that was seen, and a bottom once the series has risen from it.
    let (mut low, mut high) = (0, 0);
    let (mut rising, mut top) = (false, None);
    for (k, value) in values.iter().enumerate() {
        if rising {
            if *value >= values[high] {
                high = k;
            } else if values[high] - value >= least {
                (rising, top, low) = (false, Some(high), k);
            }
        } else if *value <= values[low] {
            low = k;
        } else if value - values[low] >= least {
            if let Some(start) = top.take() {
                found.push(Fall { start, end: low });
            }
            (rising, high) = (true, k);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{avalanches, correlation_time, longest_unbroken};
    use crate::test_noise::correlated;
    use probability::random_stream::Stream;

    /// Angles that rise by `rate` a second and fall by `size` within `fall` seconds, again and again, with noise.
    fn saw_tooth(
        n: u32,
        interval: f64,
        (rate, size, fall): (f64, f64, f64),
        noise: f64,
    ) -> Vec<f64> {
        let mut stream = Stream::new(5, "saw tooth");
        let rise = size / rate;
        (0..n)
            .map(|k| {
                let phase = (f64::from(k) * interval + 0.3).rem_euclid(rise + fall);
                let angle = if phase < rise {
                    30.0 + rate * phase
                } else {
                    30.0 + size * (1.0 - (phase - rise) / fall)
                };
                angle + noise * stream.normal()
            })
            .collect()
    }

    /// A drum at 1 rpm carries the bed up by 6 deg/s for 1.5 s, and 9 deg come down in 0.2 s: sizes of 9 deg less the rise of
    /// an interval, 0.3 deg, and half of it for the noise at both ends; the time from start to start is 1.7 s, known to an
    /// interval over their number. Slow pictures, three in an avalanche of 4 s, and a noise of a tenth of the size change it
    /// by no more than that.
    #[test]
    fn a_saw_tooth_has_its_size_and_waiting_time() {
        for (interval, noise) in [(0.05, 0.0), (0.05, 0.1), (0.2, 0.1), (0.4, 0.0)] {
            let series = saw_tooth(400, interval, (6.0, 9.0, 0.2), noise);
            let found = avalanches(&series, interval).expect("it falls faster than it rises");
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let (size, wait) = (mean(&found.sizes), mean(&found.waiting_times));
            let missed = 6.0 * interval;
            assert!(
                size < 9.0 + 3.0 * noise && size > 9.0 - 1.2 * missed - 3.0 * noise,
                "{size} deg at {interval} s"
            );
            // It begins at 39 and comes to rest at 30, each known to the same.
            let (start, stop) = (mean(&found.start_angles), mean(&found.stop_angles));
            let known = 0.6 * missed + 3.0 * noise;
            assert!(
                (start - 39.0).abs() < known && (stop - 30.0).abs() < known,
                "{start} to {stop} deg"
            );
            let n = found.waiting_times.len() as f64;
            assert!(
                (wait - 1.7).abs() < 2.0 * interval / n,
                "{wait} s at {interval} s"
            );
            // The first fall began before the series or counts, and so does the last: two less than there is time for.
            let all = 400.0 * interval / 1.7;
            assert!(
                found.sizes.len() as f64 > all - 3.0,
                "{} of {all}",
                found.sizes.len()
            );
        }
    }

    /// A bed that flows all the time changes its angle up and down alike: of 300 such series each with 40 and 400 values, and
    /// with memories of none to ten intervals, no more than 1 of 100 may be taken for avalanches (one-sided 3 standard errors
    /// are 1 of 700). Turned upside down a saw tooth falls slowly and is none either.
    #[test]
    fn a_bed_that_flows_all_the_time_has_no_avalanches() {
        for (n, rho) in [
            (40, 0.0),
            (40, 0.7),
            (40, 0.9),
            (400, 0.0),
            (400, 0.7),
            (400, 0.9),
        ] {
            let taken = (0..300).filter(|seed| {
                let series = correlated(&mut Stream::new(*seed, "rolling"), n, rho);
                avalanches(&series, 0.1).is_some()
            });
            let taken = taken.count();
            assert!(taken <= 3, "{taken} of 300 with {n} values and {rho}");
        }
        let slow = saw_tooth(400, 0.05, (6.0, 9.0, 0.2), 0.1);
        let slow: Vec<f64> = slow.iter().map(|v| -v).collect();
        assert_eq!(avalanches(&slow, 0.05), None);
        assert_eq!(avalanches(&[], 0.05), None);
        assert_eq!(avalanches(&[3.0; 50], 0.05), None);
    }

    /// Correlation `exp(-t / T)` with T of 2, 5 and 10 intervals over 4000 values: the estimate lies within three of its own
    /// standard errors, of 40 series all but one at most.
    #[test]
    fn a_series_has_its_correlation_time() {
        for memory in [2.0_f64, 5.0, 10.0] {
            let interval = 0.1;
            let rho = (-1.0 / memory).exp();
            let off = |seed: &u64| {
                let series = correlated(&mut Stream::new(*seed, "memory"), 4000, rho);
                let found = correlation_time(&series, interval).expect("a long series tells it");
                (found.time - memory * interval).abs() > 3.0 * found.standard_error
            };
            let wrong = (0..40).filter(off).count();
            assert!(wrong <= 1, "{wrong} of 40 at {memory} intervals");
        }
    }

    /// Independent values are correlated for less than an interval, and 20 values do not tell a time of ten.
    #[test]
    fn a_time_that_cannot_be_told_is_not_told() {
        let told = (0..100).filter(|seed| {
            let series = correlated(&mut Stream::new(*seed, "white"), 400, 0.0);
            correlation_time(&series, 0.1).is_some()
        });
        assert!(told.count() <= 2, "independent values");
        let short = correlated(&mut Stream::new(1, "short"), 20, 0.9);
        assert_eq!(correlation_time(&short, 0.1), None);
        assert_eq!(correlation_time(&[1.0; 100], 0.1), None);
        assert_eq!(correlation_time(&[], 0.1), None);
    }

    #[test]
    fn a_gap_parts_a_series() {
        let values = [Some(1.0), None, Some(2.0), Some(3.0), None, None, Some(4.0)];
        assert_eq!(longest_unbroken(&values), [2.0, 3.0]);
        assert!(longest_unbroken(&[None]).is_empty());
    }
}
