//! Tolerance intervals: where a share of all single runs lies, with a given confidence.

use serde::{Deserialize, Serialize};

use crate::fit::ErrorVariance;
use crate::surface::prediction::check_point;
use crate::{Error, Fit};
use probability::{chi_squared_upper_tail, normal_cdf, normal_density};

/// Steps of the integral over the error of the mean, an even number. Doubling them changes no factor
/// by more than 1e-9.
const STEPS: usize = 240;
/// End of that integral in standard errors: what lies beyond has probability 1e-15.
const REACH: f64 = 8.0;

/// An interval that holds a share of the single runs at a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Share of the runs.
    pub content: f64,
    /// Confidence that the interval holds so many.
    pub confidence: f64,
    /// Half width over the standard deviation of a run.
    pub factor: f64,
    /// Standard deviation of a single run, unit of the response.
    pub run_sd: f64,
    /// The interval, unit of the response.
    pub interval: [f64; 2],
}

impl Fit {
    /// The two-sided tolerance interval of single runs at a natural point; none without an error
    /// variance.
    ///
    /// # Formula
    /// `yhat +- k s`, s^2 the variance of a run: that of a cell mean times the mean number of runs of
    /// a cell.
    ///
    /// # Errors
    /// [`Error::Length`] for a wrong number of values; [`Error::SettingOutOfRange`] for values that
    /// are not finite, and for a content or confidence outside 0 to 1.
    pub fn tolerance(
        &self,
        natural: &[f64],
        error: Option<ErrorVariance>,
        content: f64,
        confidence: f64,
    ) -> Result<Option<Tolerance>, Error> {
        check_point(self, natural)?;
        for (what, value) in [("the content", content), ("the confidence", confidence)] {
            if !(value > 0.0 && value < 1.0) {
                return Err(Error::SettingOutOfRange {
                    what,
                    value,
                    range: "above 0 and below 1",
                });
            }
        }
        let Some(error) = error else {
            return Ok(None);
        };
        let coded = self.coded(natural);
        let runs = self.runs_of_unit_weight();
        let share = self.leverage(&coded) / runs;
        let run_sd = (error.variance * runs).sqrt();
        let mean = self.value(&coded);
        let factor = tolerance_factor(share, error.df as f64, content, confidence);
        Ok(factor.map(|factor| Tolerance {
            content,
            confidence,
            factor,
            run_sd,
            interval: [mean - factor * run_sd, mean + factor * run_sd],
        }))
    }
}

/// The factor k of a two-sided tolerance interval `mean +- k s`: the mean has the variance `share`
/// times that of a run, s^2 has `df` degrees of freedom, `content` and `confidence` lie above 0 and
/// below 1; `None` if undefined.
///
/// # Formula
/// k solves `integral phi(z) P(chi2_df >= df r(z)^2 / k^2) dz = confidence`, where r(z) solves
/// `Phi(z sqrt(share) + r) - Phi(z sqrt(share) - r) = content`. A sample of n has share 1/n.
///
/// # Source
/// `[Witkovsky2014, section 2]`.
pub fn tolerance_factor(share: f64, df: f64, content: f64, confidence: f64) -> Option<f64> {
    let inside = |x: f64| x > 0.0 && x < 1.0;
    let spread = share >= 0.0 && share.is_finite() && df > 0.0 && df.is_finite();
    if !(spread && inside(content) && inside(confidence)) {
        return None;
    }
    let step = REACH / STEPS as f64;
    let nodes: Vec<(f64, f64)> = (0..=STEPS)
        .map(|i| {
            let z = step * i as f64;
            // Simpson's weights; both signs of z.
            let simpson = match i {
                0 | STEPS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let weight = 2.0 * simpson * step / 3.0 * normal_density(z);
            (weight, reach(z * share.sqrt(), content).powi(2))
        })
        .collect();
    let reached = |k: f64| -> f64 {
        let held = |&(weight, square): &(f64, f64)| {
            weight * chi_squared_upper_tail(df * square / (k * k), df).unwrap_or(0.0)
        };
        nodes.iter().map(held).sum()
    };
    let (mut low, mut high) = (0.0, 1.0);
    while reached(high) < confidence {
        low = high;
        high *= 2.0;
        if high > 1e12 {
            return None;
        }
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if reached(middle) < confidence {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// Half width of the interval about `centre` that holds `content` of the standard normal
/// distribution.
fn reach(centre: f64, content: f64) -> f64 {
    let held = |r: f64| normal_cdf(centre + r) - normal_cdf(centre - r);
    let (mut low, mut high) = (0.0, centre.abs() + 1.0);
    while held(high) < content && high < 1e3 {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if held(middle) < content {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
