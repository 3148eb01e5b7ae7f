//! Do runs at a predicted point confirm the prediction?

use serde::{Deserialize, Serialize};

use crate::fit::ErrorVariance;
use crate::surface::prediction::check_point;
use crate::{Error, Fit};
use probability::t_two_sided_quantile;

/// Confirmation runs against the prediction interval of their mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Confirmation {
    /// Natural point, units of the factors.
    pub natural: Vec<f64>,
    /// Fitted value, unit of the response.
    pub predicted: f64,
    /// Number of runs.
    pub n: usize,
    /// Their mean, unit of the response.
    pub mean: f64,
    /// Their standard deviation, unit of the response; none for a single run.
    pub sd: Option<f64>,
    /// 95 % prediction interval of the mean of n runs.
    pub pi95_mean: Option<[f64; 2]>,
    /// Whether the mean lies in it; none without an interval.
    pub confirmed: Option<bool>,
}

/// Judges confirmation runs.
///
/// # Formula
/// `se = s sqrt(x'Cx + m / n)`, s^2 the variance of a mean of m runs (the mean count of the
/// data), interval with Student's t.
///
/// # Errors
/// Those of [`Fit::predict`]; [`Error::Length`] without runs; [`Error::BadObservation`] for a
/// response that is not finite.
pub fn confirm(
    fit: &Fit,
    natural: &[f64],
    responses: &[f64],
    error: Option<ErrorVariance>,
) -> Result<Confirmation, Error> {
    check_point(fit, natural)?;
    if let Some(i) = responses.iter().position(|y| !y.is_finite()) {
        return Err(Error::BadObservation {
            row: i + 1,
            what: "the response of a confirmation run",
            value: responses[i],
            way_out: "it must be a finite number",
        });
    }
    let n = responses.len();
    let cell = crate::Cell::of_replicates(Vec::new(), responses)?;
    let coded = fit.coded(natural);
    let predicted = fit.value(&coded);
    let reach = error.and_then(|error| {
        let limit = t_two_sided_quantile(0.05, error.df as f64)?;
        let share = fit.leverage(&coded) + fit.runs_of_unit_weight() / n as f64;
        Some(limit * (error.variance * share).sqrt())
    });
    let interval = reach.map(|reach| [predicted - reach, predicted + reach]);
    Ok(Confirmation {
        natural: natural.to_vec(),
        predicted,
        n,
        mean: cell.mean,
        sd: cell.sd,
        confirmed: interval.map(|[low, high]| (low..=high).contains(&cell.mean)),
        pi95_mean: interval,
    })
}
