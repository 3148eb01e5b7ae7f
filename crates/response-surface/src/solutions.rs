//! Where in the box the surface meets a target.
//!
//! One response and several factors leave a set of solutions, not a point. [`solutions`] reports
//! the whole set: the range of every factor on it, the share of the box that the data cannot tell
//! from it, and the points of it nearest to given values under named metrics.

mod along;
mod bootstrap;
mod branches;
mod nearest;
mod range;
mod region;
mod robust;

pub use along::roots_along;
pub use bootstrap::{Bootstrap, BootstrapFactor, bootstrap};
pub use branches::Branch;
pub use nearest::Nearest;
pub(crate) use range::golden_minimum;
pub use range::{FactorRange, Interval};
pub use region::{GivenOthers, Region};
pub use robust::{Robust, most_robust};

use serde::{Deserialize, Serialize};

use crate::fit::{ErrorSource, ErrorVariance};
use crate::{BoxExtremes, Error, Fit, NamedValues, Observations};
use probability::t_two_sided_quantile;

/// A measured value of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Value, unit of the factor.
    pub value: f64,
    /// Standard deviation of single measurements, unit of the factor.
    pub sd: Option<f64>,
    /// Number of measurements.
    pub n: Option<usize>,
}

/// The question to the surface.
///
/// ```
/// use experiment_design::Factor;
/// use response_surface::solutions::{SolutionRequest, solutions};
/// use response_surface::{Model, Observations, fit};
/// let factors = [Factor::new("B", "friction", "1", 0.2, 0.6)?];
/// let data = Observations::from_runs(&[vec![-1.0], vec![0.0], vec![1.0]], &[30.0, 33.0, 36.0])?;
/// let surface = fit(&factors, &Model::linear(&factors)?, &data)?;
/// let found = solutions(&surface, &SolutionRequest::for_target(34.5))?;
/// let nearest = found.nearest.get("coded").unwrap();
/// assert!((nearest.solution[0] - 0.5).abs() < 1e-9);
/// # Ok::<(), response_surface::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolutionRequest {
    /// Value that the response should have, unit of the response.
    pub target: f64,
    /// Standard deviation of single measurements of the target, unit of the response.
    pub target_sd: Option<f64>,
    /// Number of measurements behind the target.
    pub target_n: Option<usize>,
    /// Measured values of the factors, in their order; the solution should lie near them.
    pub near: Vec<Option<Measured>>,
    /// Which error variance to use; none: all repeats, or the residuals if there are none.
    pub error: Option<ErrorSource>,
}

impl SolutionRequest {
    /// A target without uncertainty and without measured factors.
    pub fn for_target(target: f64) -> Self {
        Self {
            target,
            target_sd: None,
            target_n: None,
            near: Vec::new(),
            error: None,
        }
    }
}

/// All that the fit says about a target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solutions {
    /// Value that the response should have, unit of the response.
    pub target: f64,
    /// Standard error of the target, sd / sqrt(n), unit of the response; none if not given.
    pub target_se: Option<f64>,
    /// Whether the surface meets the target within the ranges of the factors.
    pub exists: bool,
    /// Whether the target is the least or the greatest value there, to rounding: the set is then a point or an edge of
    /// the surface, and any larger or smaller target has no solution.
    #[serde(default)]
    pub tangent: bool,
    /// Extremes of the surface within the ranges of the factors.
    pub reachable: BoxExtremes,
    /// The part of each range on which there are solutions; none if there is no solution.
    pub factor_ranges: Option<NamedValues<FactorRange>>,
    /// The connected parts of the set, largest first: two of them are two kinds of answer. Empty if there
    /// is not a solution or if all lie within a cell of the grid; `None` for more than seven factors.
    #[serde(default)]
    pub branches: Option<Vec<Branch>>,
    /// The solutions nearest to the given values by metric: `sd` and `standard_error` (differences
    /// over those of the measurements) and `coded` (over the half-ranges). Empty if there is no
    /// solution; `coded` refers to the middle of the ranges if no values are given.
    pub nearest: NamedValues<Nearest>,
    /// The error variance that the region is made with; none if it is undefined.
    pub error: Option<ErrorVariance>,
    /// Points that the data cannot tell from a solution; none without an error variance.
    pub region: Option<Region>,
}

/// Finds the solutions of a fitted surface of degree two at most.
///
/// # Formula
/// set: x in the box with `yhat(x) = T`; region: x with `|yhat(x) - T| <= t sqrt(s^2 x'Cx +
/// s_T^2)`, the
/// inversion of the test that the mean response at x is T (after `[Fieller1954]`; the target's own
/// degrees of freedom are taken as those of s^2).
///
/// # Errors
/// [`Error::DegreeTooHigh`]; [`Error::SettingOutOfRange`] for invalid numbers, such
/// as a target sd without its n; [`Error::Length`] for a wrong number of measured values;
/// [`Error::NoErrorVariance`] if the error asked for is undefined. No solution is a value.
pub fn solutions(fit: &Fit, request: &SolutionRequest) -> Result<Solutions, Error> {
    let quadratic = fit.quadratic()?;
    let target_se = check(fit, request)?;
    let error = fit.chosen_error(request.error)?;
    let reachable = crate::surface::extremes::box_extremes(&quadratic, &fit.factors);
    let rounding = quadratic.rounding();
    let touches = |end: &f64| (request.target - end).abs() <= rounding;
    let ends = [reachable.min.value, reachable.max.value];
    let touched = ends.into_iter().find(touches);
    let target = touched.unwrap_or(request.target);
    let exists = reachable.min.value <= target && target <= reachable.max.value;
    let membership = error.and_then(|error| {
        let t_limit = t_two_sided_quantile(0.05, error.df as f64)?;
        Some(region::Membership {
            fit,
            quadratic: &quadratic,
            target,
            t_limit,
            error,
            target_variance: target_se.unwrap_or(0.0).powi(2),
        })
    });
    let nearest = if exists {
        nearest::all_metrics(fit, &quadratic, target, request, membership.as_ref())
    } else {
        NamedValues::default()
    };
    Ok(Solutions {
        target: request.target,
        target_se,
        exists,
        tangent: touched.is_some(),
        factor_ranges: exists.then(|| range::factor_ranges(fit, &quadratic, target)),
        branches: if exists {
            branches::branches(fit, &quadratic, target)
        } else {
            Some(Vec::new())
        },
        nearest,
        error,
        region: membership.map(|membership| region::region(&membership)),
        reachable,
    })
}

/// Checks the numbers of a request and returns the standard error of the target.
fn check(fit: &Fit, request: &SolutionRequest) -> Result<Option<f64>, Error> {
    let refuse = |what, value, range| Err(Error::SettingOutOfRange { what, value, range });
    if !request.target.is_finite() {
        return refuse("the target", request.target, "a finite number");
    }
    if !request.near.is_empty() && request.near.len() != fit.factors.len() {
        return Err(Error::Length {
            what: "measured values of the factors",
            expected: fit.factors.len(),
            given: request.near.len(),
        });
    }
    for (near, factor) in request.near.iter().zip(&fit.factors) {
        let Some(near) = near else { continue };
        if !near.value.is_finite() {
            return refuse("a measured value", near.value, "a finite number");
        }
        let size = factor.half_range().max(near.value.abs());
        let is_sd = |sd: f64| sd > 0.0 && Observations::is_plausible_sd(sd, size);
        if let Some(sd) = near.sd.filter(|sd| !is_sd(*sd)) {
            let range = "above zero, and a plausible scatter of that factor";
            return refuse("the sd of a measured value", sd, range);
        }
        if near.n == Some(0) {
            return refuse("the number of measurements", 0.0, "at least 1");
        }
    }
    match (request.target_sd, request.target_n) {
        (None, None) => Ok(None),
        (Some(sd), _)
            if !Observations::is_plausible_sd(sd, request.target.abs().max(fit.mean.abs())) =>
        {
            let range = "zero, or a plausible scatter of the response";
            refuse("the sd of the target", sd, range)
        }
        (Some(sd), Some(n)) if n > 0 => Ok(Some(sd / (n as f64).sqrt())),
        (_, None) => refuse(
            "the number of measurements of the target",
            0.0,
            "given with its sd",
        ),
        (None, Some(n)) => refuse("the n of the target", n as f64, "given with its sd"),
        (_, Some(_)) => refuse(
            "the number of measurements of the target",
            0.0,
            "at least 1",
        ),
    }
}
