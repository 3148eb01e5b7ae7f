//! Targets and answers where a function of the response was fitted.

use anyhow::Context as _;
use response_surface::{Prediction, Solutions, Tolerance, Transform};
use serde::Serialize;

use crate::levels::Original;

/// The scale of a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale(pub(super) Option<Transform>);

impl Scale {
    /// A response on the scale of the fit.
    pub(super) fn of(self, what: &str, y: f64) -> anyhow::Result<f64> {
        let Some(transform) = self.0 else {
            return Ok(y);
        };
        let value = transform.forward(y);
        value.with_context(|| {
            let domain = transform.domain();
            format!("{what} is {y}; the analysis is of {transform}, so that it must be {domain}")
        })
    }

    /// The standard deviation of a measured response there: to first order, times the slope of the function.
    pub(super) fn sd(self, y: f64, sd: Option<f64>) -> anyhow::Result<Option<f64>> {
        let (Some(transform), Some(sd)) = (self.0, sd) else {
            return Ok(sd);
        };
        let slope = transform
            .slope(y)
            .context("the target has no slope there; leave --target-sd out")?;
        Ok(Some(sd * slope.abs()))
    }
}

/// The answer in the unit of the response. Quantiles go over as they are: means become medians.
#[derive(Debug, Serialize)]
pub(super) struct InUnit {
    /// The function of the response that was fitted.
    pub(super) transform: Transform,
    /// The target as given.
    pub(super) target: f64,
    /// Least and greatest value within the ranges; null at an end that the function does not reach.
    pub(super) reachable: [Option<f64>; 2],
    /// At the point asked for.
    pub(super) at: Option<AtPoint>,
}

/// A prediction in the unit of the response.
#[derive(Debug, Serialize)]
pub(super) struct AtPoint {
    /// The median with its 95 % confidence interval.
    #[serde(flatten)]
    pub(super) median: Original,
    /// 95 % prediction interval of a run.
    pub(super) pi95: [Option<f64>; 2],
    /// Tolerance interval.
    pub(super) tolerance: [Option<f64>; 2],
}

impl InUnit {
    /// Takes the answer back.
    pub(super) fn new(
        transform: Transform,
        target: f64,
        solutions: &Solutions,
        at: Option<&Prediction>,
        tolerance: Option<&Tolerance>,
    ) -> Self {
        let back =
            |ends: Option<[f64; 2]>| ends.map_or([None; 2], |ends| transform.back_interval(ends));
        let (min, max) = (&solutions.reachable.min, &solutions.reachable.max);
        Self {
            transform,
            target,
            reachable: transform.back_interval([min.value, max.value]),
            at: at.map(|at| AtPoint {
                median: Original::new(transform, at.mean, at.ci95),
                pi95: back(at.pi95),
                tolerance: back(tolerance.map(|t| t.interval)),
            }),
        }
    }
}
