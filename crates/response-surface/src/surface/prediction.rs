//! Prediction of the response at a point.

use serde::{Deserialize, Serialize};

use crate::fit::ErrorVariance;
use crate::{Error, Fit};
use probability::t_two_sided_quantile;

/// Prediction of the fit at one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// Natural point, units of the factors.
    pub natural: Vec<f64>,
    /// Coded point.
    pub coded: Vec<f64>,
    /// Fitted value, unit of the response.
    pub mean: f64,
    /// Variance of the fitted value over that of a cell mean.
    pub leverage: f64,
    /// Standard error of the fitted value, unit of the response.
    pub se_mean: Option<f64>,
    /// 95 % confidence interval of the mean response.
    pub ci95: Option<[f64; 2]>,
    /// Standard error of a new cell mean of mean size about the fitted value.
    pub se_pred: Option<f64>,
    /// 95 % prediction interval of such a mean.
    pub pi95: Option<[f64; 2]>,
    /// Whether the point lies outside what the data span ([`Fit::is_beyond_data`]): the model was not made there.
    pub extrapolated: bool,
}

impl Fit {
    /// The part of the inverse of X'WX that belongs to the terms of the model, blocks left out, (terms, terms): the
    /// covariance of their coefficients over the variance of a cell mean.
    pub fn inverse_of_terms(&self) -> Vec<Vec<f64>> {
        let terms = self.formula.terms().len();
        let blocks = self.p - terms;
        // Columns: intercept, blocks, the other terms.
        let place = |i: usize| if i == 0 { 0 } else { i + blocks };
        let entry = |i: usize, j: usize| self.xtx_inverse[place(i)][place(j)];
        let line = |i| (0..terms).map(|j| entry(i, j)).collect();
        (0..terms).map(line).collect()
    }

    /// Predicts at a natural point with the residuals as error.
    ///
    /// # Formula
    /// `se_mean = s sqrt(x'Cx)`, `se_pred = s sqrt(1 + x'Cx)`, intervals with Student's t.
    ///
    /// # Errors
    /// [`Error::Length`] for a wrong number of values, [`Error::SettingOutOfRange`] for values
    /// that are not finite.
    pub fn predict(&self, natural: &[f64]) -> Result<Prediction, Error> {
        self.predict_with(natural, self.error_variance(crate::ErrorSource::Residual))
    }

    /// Predicts at a natural point with a chosen error variance.
    ///
    /// # Errors
    /// As [`Fit::predict`].
    pub fn predict_with(
        &self,
        natural: &[f64],
        error: Option<ErrorVariance>,
    ) -> Result<Prediction, Error> {
        check_point(self, natural)?;
        let coded = self.coded(natural);
        let (mean, leverage) = (self.value(&coded), self.leverage(&coded));
        let limit = error.and_then(|e| t_two_sided_quantile(0.05, e.df as f64));
        let se = |share: f64| error.map(|e| (e.variance * share).sqrt());
        let interval = |se: Option<f64>| {
            se.zip(limit)
                .map(|(se, limit)| [mean - limit * se, mean + limit * se])
        };
        let (se_mean, se_pred) = (se(leverage), se(1.0 + leverage));
        Ok(Prediction {
            natural: natural.to_vec(),
            extrapolated: self.is_beyond_data(natural),
            coded,
            mean,
            leverage,
            se_mean,
            ci95: interval(se_mean),
            se_pred,
            pi95: interval(se_pred),
        })
    }
}

/// Refuses a point with a wrong number of values or values that are not finite.
pub(crate) fn check_point(fit: &Fit, natural: &[f64]) -> Result<(), Error> {
    if natural.len() != fit.factors.len() {
        return Err(Error::Length {
            what: "values of a point, one per factor",
            expected: fit.factors.len(),
            given: natural.len(),
        });
    }
    match natural.iter().find(|u| !u.is_finite()) {
        Some(&value) => Err(Error::SettingOutOfRange {
            what: "a coordinate of the point",
            value,
            range: "a finite number",
        }),
        None => Ok(()),
    }
}
