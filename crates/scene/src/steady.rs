//! Where the start-up of a turning bed ends, whether what is kept is a steady state, and how well it fixes a mean.

use probability::{f_quantile, t_two_sided_quantile};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// One swing of a bed in a drum over the period of the same mass as a free pendulum about the axis: the shell holds the
/// bed back. Our choice, from the peaks of the direction of the centre of mass in drums of 100 and 140 mm at 10 to 40 rpm
/// (1.3 to 1.5).
const OVER_PENDULUM: f64 = 1.4;
/// Least distance of the centre of mass from the axis over the radius that counts: a bed that turns with the shell has none.
const LEAST_ARM: f64 = 0.05;
/// Least start-up in swings: a bed that was laid within 5 deg of its slope has then lost what the start gave it.
pub(crate) const LEAST_START_UP: f64 = 1.5;
/// Least number of swings that is kept.
pub(crate) const LEAST_KEPT: usize = 4;
/// Chance of a trend, and of halves that scatter unequally, in a bed that is steady: such a bed runs a little longer.
const ALPHA: f64 = 0.05;
/// What may be left of a drift over all that is kept, and of the scatter of a half, deg, or the standard error that is asked for
/// where that is less: a bed that slides creeps to its place without scatter, and any remainder would be significant. The
/// angle of one picture is not read better.
const NEGLIGIBLE: f64 = 0.1;
/// Degrees of freedom that one swing gives the scatter of a half: measured 3.3 to 4.0 in 12 kinds of bed.
const FREEDOM_OF_SWING: f64 = 3.5;
/// Standard deviation of the means of swings over that within a swing: measured 0.31 to 0.59 in 12 kinds of bed. Four
/// means alone say next to nothing of their own scatter.
const MEANS_OVER_VALUES: f64 = 0.4;
/// Degrees of freedom that this ratio is worth.
const FREEDOM_OF_RATIO: f64 = 6.0;

/// Time of one swing of a bed, s.
///
/// # Formula
///
/// `1.4 * 2 pi sqrt(k² / (g d))`, k² the mean square distance of the seeds from the axis (m²), d the distance of their
/// centre of mass from it (m), g gravity (m/s²): the physical pendulum, and how much slower a bed swings that rubs on
/// its shell. `radius` is that of the apparatus, m.
pub fn swing_time(square: f64, arm: f64, radius: f64, gravity: f64) -> f64 {
    let arm = arm.max(LEAST_ARM * radius);
    OVER_PENDULUM * TAU * (square / (gravity * arm)).sqrt()
}

/// [`swing_time`] of a drum that is half full: k² = R²/2, d = 4 R / (3 pi).
pub(crate) fn expected_swing(radius: f64, gravity: f64) -> f64 {
    let arm = 4.0 * radius / (3.0 * std::f64::consts::PI);
    swing_time(0.5 * radius * radius, arm, radius, gravity)
}

/// Why a bed does not count as steady, or as one at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// Fewer than four swings lie behind the start-up.
    TooShort,
    /// The bed rises or falls from swing to swing by more than its swings scatter.
    Drifts,
    /// The two halves of what is kept scatter unequally: the bed still rings, or began to hold or to slip.
    ScattersUnequally,
    /// The bed rolls in one half of what is kept and slides in the other.
    ChangesRegime,
    /// The mean is not known as well as was asked for.
    NotSharp,
    /// Seeds that were let go still move.
    NotAtRest,
    /// A wall under a load still moves, or finds no seeds that carry it.
    LoadNotCarried,
    /// A probe did not come to its depth.
    DepthNotReached,
    /// The seeds did not push a wall with the force at which a phase ends.
    ForceNotReached,
    /// Less of the bed was taken out than ends a phase.
    NotDischarged,
    /// Rolling friction of type A turns the seeds to and fro within a step, however long it lasts.
    DrivenByRolling,
}

impl Doubt {
    /// The reason as a part of a sentence: "the bed ...".
    pub fn words(self) -> &'static str {
        match self {
            Self::TooShort => "turned for less than the start-up and four swings",
            Self::Drifts => "still rises or falls from swing to swing",
            Self::ScattersUnequally => "swings more in one half of the time than in the other",
            Self::ChangesRegime => "rolls in one half of the time and slides in the other",
            Self::NotSharp => "swings too much for the standard error asked for",
            Self::NotAtRest => "had not come to rest",
            Self::LoadNotCarried => "did not carry the load of a wall",
            Self::DepthNotReached => "was not pressed to the stated depth",
            Self::ForceNotReached => "did not push the wall with the stated force",
            Self::NotDischarged => "did not flow out as far as was stated",
            Self::DrivenByRolling => {
                "is driven by its own rolling torque, which turns the seeds to and fro within a time step: lower \
                 protocol.step_share to a quarter, or take model.rolling_law = \"spring-dashpot\""
            }
        }
    }
}

/// Part of a rotation that is kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SteadyState {
    /// Number of values of the series before it.
    pub cut: usize,
    /// Values of the series in one swing of the bed.
    pub swing: usize,
    /// Standard error of the mean of the series after the cut, deg; `None` if it is shorter than two swings.
    pub standard_error: Option<f64>,
    /// Why it does not count as steady; `None` if it does.
    pub doubt: Option<Doubt>,
}

/// What a rotation is asked to show, in values of its series, which is in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyRule {
    /// Values in one swing.
    pub swing: usize,
    /// Least number of values before what is kept.
    pub start_up: usize,
    /// Largest standard error of the mean of the series, deg; any if omitted.
    pub error: Option<f64>,
}

impl SteadyRule {
    /// The rule for a bed that swings in a time (s), with a value of its series every `interval` s: the start-up is 1.5
    /// swings, or `start_up` s where that is longer. No time counts for longer than `most` s, the limit of the run: a bed
    /// without weight swings for ever.
    pub fn for_bed(
        swing: f64,
        start_up: Option<f64>,
        most: f64,
        interval: f64,
        error: Option<f64>,
    ) -> Self {
        let least = LEAST_START_UP * swing;
        let values = |time: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "positive, at most the limit of the run"
            )]
            let n = (time.min(most) / interval).round() as usize;
            n.max(2)
        };
        Self {
            swing: values(swing),
            start_up: values(start_up.map_or(least, |time| time.max(least))),
            error,
        }
    }

    /// Whether a series of this length is to be judged: after whole swings behind the start-up alone, since what is asked
    /// often enough is answered yes by chance.
    pub fn asks_at(&self, length: usize) -> bool {
        length > self.start_up && (length - self.start_up).is_multiple_of(self.swing)
    }

    /// The part of a series that is kept: the values after the least start-up, after the first third or after the first half,
    /// whichever of the three is steady first. If none is steady, those after the least start-up, with the reason.
    ///
    /// # Statistics
    ///
    /// The means of whole swings are taken for independent: what a swing takes up comes down within it. Over four or more
    /// of them the line of least squares must have a slope within Student's t, and the variances of the two halves, with
    /// 3.5 degrees of freedom a swing, a ratio within F, each at 5 %; a rise of less than 0.1 deg over all of them, and halves
    /// that both scatter by less, do not count. The scatter of the means about the line is pooled
    /// with 0.4 times that within swings, which counts for 6 degrees of freedom. Three places to cut, and not all: one
    /// that is picked from many passes by chance. `rolls` says of each value whether the bed rolled.
    pub fn judge(&self, series: &[f64], rolls: &[bool]) -> SteadyState {
        let n = series.len();
        let cuts = [self.start_up, n / 3, n / 2];
        let long_enough = |cut: &usize| {
            *cut >= self.start_up && n.saturating_sub(*cut) >= LEAST_KEPT * self.swing
        };
        let mut first = None;
        for cut in cuts.into_iter().filter(long_enough) {
            let doubt = self.doubt(&series[cut..], &rolls[cut..]);
            let state = self.state(series, cut, doubt);
            if doubt.is_none() {
                return state;
            }
            first = first.or(Some(state));
        }
        first.unwrap_or_else(|| self.state(series, self.start_up, Some(Doubt::TooShort)))
    }

    /// What is kept behind a cut.
    fn state(&self, series: &[f64], cut: usize, doubt: Option<Doubt>) -> SteadyState {
        // Of a series that ends before its start-up, the end is shown.
        let cut = cut.min(series.len().saturating_sub(self.swing));
        SteadyState {
            cut,
            swing: self.swing,
            standard_error: error_of_mean(&series[cut..], self.swing),
            doubt,
        }
    }

    /// Why a part of a series is not steady.
    fn doubt(&self, kept: &[f64], rolls: &[bool]) -> Option<Doubt> {
        let share = |half: &[bool]| {
            let n = half.iter().filter(|rolls| **rolls).count();
            2 * n > half.len()
        };
        let (early, late) = rolls.split_at(rolls.len() / 2);
        if share(early) != share(late) {
            return Some(Doubt::ChangesRegime);
        }
        if self.drifts(kept) {
            return Some(Doubt::Drifts);
        }
        let (early, late) = kept.split_at(kept.len() / 2);
        let (a, b) = (variance(early), variance(late));
        let freedom = FREEDOM_OF_SWING * 0.5 * kept.len() as f64 / self.swing as f64;
        let counts = a.max(b) > self.negligible().powi(2);
        if counts && a.max(b) > quantile_of_f(freedom) * a.min(b) {
            return Some(Doubt::ScattersUnequally);
        }
        let error = error_of_mean(kept, self.swing);
        let sharp = self
            .error
            .is_none_or(|most| error.is_some_and(|e| e <= most));
        (!sharp).then_some(Doubt::NotSharp)
    }
}

impl SteadyRule {
    /// What does not count, deg.
    fn negligible(&self) -> f64 {
        self.error.map_or(NEGLIGIBLE, |error| error.min(NEGLIGIBLE))
    }

    /// Whether the means of swings rise or fall by more than they scatter, and by more than counts.
    fn drifts(&self, kept: &[f64]) -> bool {
        let means = batch_means(kept, self.swing);
        let n = means.len() as f64;
        let middle = 0.5 * (n - 1.0);
        let mean = means.iter().sum::<f64>() / n;
        let at = |i: usize| i as f64 - middle;
        let squares: f64 = (0..means.len()).map(|i| at(i).powi(2)).sum();
        let products = means.iter().enumerate().map(|(i, m)| at(i) * (m - mean));
        let slope = products.sum::<f64>() / squares;
        let about = means.iter().enumerate();
        let about: f64 = about.map(|(i, m)| (m - mean - slope * at(i)).powi(2)).sum();
        let whole = &kept[kept.len() - means.len() * self.swing..];
        let within: f64 = whole.chunks_exact(self.swing).map(variance).sum::<f64>() / n;
        let freedom = FREEDOM_OF_RATIO + n - 2.0;
        let pooled = FREEDOM_OF_RATIO * MEANS_OVER_VALUES.powi(2) * within + about;
        let is_significant =
            slope.abs() > quantile_of_t(freedom) * (pooled / freedom / squares).sqrt();
        is_significant && slope.abs() * (n - 1.0) > self.negligible()
    }
}

/// Standard error of the mean of equally spaced values of a bed that swings, of which `batch` fill one swing.
///
/// # Formula
///
/// `sqrt(variance of the means of whole swings / their number)`; none with fewer than two swings.
///
/// # Source
///
/// Batch means `[Schmeiser1982]`; that a batch is one swing is our choice: shorter ones count the swing as noise, longer
/// ones are few.
pub fn error_of_mean(values: &[f64], batch: usize) -> Option<f64> {
    let means = batch_means(values, batch.max(1));
    (means.len() >= 2).then(|| (variance(&means) / means.len() as f64).sqrt())
}

/// Means of whole batches; what is left over stays out at the start.
fn batch_means(values: &[f64], batch: usize) -> Vec<f64> {
    let whole = values.chunks_exact(batch).len() * batch;
    let batches = values[values.len() - whole..].chunks_exact(batch);
    batches
        .map(|b| b.iter().sum::<f64>() / batch as f64)
        .collect()
}

/// Variance with n - 1.
fn variance(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)
}

/// Two-sided quantile of Student's t for the trend.
fn quantile_of_t(freedom: f64) -> f64 {
    t_two_sided_quantile(ALPHA, freedom).unwrap_or(f64::INFINITY)
}

/// Quantile of F, of equal degrees of freedom above and below, for the larger variance over the smaller.
fn quantile_of_f(freedom: f64) -> f64 {
    f_quantile(0.5 * ALPHA, freedom, freedom).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests;
