//! The fit of a model to observations, with its analysis of variance.

mod anova;
mod cases;
mod information;
mod lack_of_fit;
pub(crate) mod least_squares;
mod matrix;
pub(crate) mod polynomials;
pub(crate) mod refine;
mod replicates;
mod terms;
mod typed;
mod warnings;
pub(crate) mod wide;

pub use anova::{AnovaRow, OrderRow, SequentialModel};
pub use cases::Case;
pub use information::Information;
pub use lack_of_fit::{LackOfFit, PureError};
pub(crate) use lack_of_fit::{pure_error as pure_error_of, same_settings};
pub(crate) use matrix::Matrix;
pub use replicates::{Bartlett, FTest, Replicates};
pub(crate) use replicates::{bartlett_of, f_test, pooled_variance};
pub use terms::TermRow;
pub(crate) use terms::{tested, variance_inflation};
pub use typed::{TypedRow, TypedSum};
pub use warnings::Warning;

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

pub(crate) use crate::fit::least_squares::condition;
use crate::fit::least_squares::{LeastSquares, least_squares};
use crate::fit::refine::refine;
use crate::surface::natural::natural_terms;
use crate::{BoxExtremes, Canonical, DataRegion, Error, Model, NamedValues, Observations};
use probability::t_two_sided_quantile;

/// Source of the weights of the observations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weighting {
    /// The number of replicates of each cell: right where all runs have the same variance.
    Counts,
    /// All cells alike.
    Equal,
    /// n / sd^2 of each cell. With few replicates the noise of sd does more harm than good.
    InverseVariance,
    /// n / s^2 with the variance s^2 of each cell drawn towards the pooled one.
    ShrunkVariance,
}

/// Which variance represents the error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorSource {
    /// Mean square of the residuals of the fit.
    Residual,
    /// Scatter of rows with the same settings (centre rows).
    RepeatedRows,
    /// Scatter of replicates within cells, pooled.
    Replicates,
    /// Replicates within cells and rows with the same settings together.
    AllRepeats,
}

/// An error variance with its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorVariance {
    /// Where it comes from.
    pub source: ErrorSource,
    /// Variance of a cell mean of mean size, squared unit of the response.
    pub variance: f64,
    /// Degrees of freedom.
    pub df: usize,
}

/// A fitted model. Sums of squares are in squared units of the response.
///
/// ```
/// use experiment_design::Factor;
/// use response_surface::{Model, Observations, fit};
/// let factors = [Factor::new("B", "friction", "1", 0.2, 0.6)?];
/// let runs = [vec![-1.0], vec![0.0], vec![1.0], vec![1.0]];
/// let data = Observations::from_runs(&runs, &[30.0, 33.0, 36.2, 35.8])?;
/// let line = fit(&factors, &Model::linear(&factors)?, &data)?;
/// // 3 deg per half-range, and the prediction for a friction of 0.5.
/// assert!((line.coefficients()[1] - 3.0).abs() < 1e-12);
/// assert!((line.value(&line.coded(&[0.5])) - 34.5).abs() < 1e-12);
/// # Ok::<(), response_surface::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The factors in column order.
    pub factors: Vec<Factor>,
    /// The terms.
    pub formula: Model,
    /// Source of the weights.
    pub weighting: Weighting,
    /// Mean number of runs behind an observation.
    pub mean_count: f64,
    /// Number of observations (rows).
    pub n: usize,
    /// Number of coefficients with the intercept and blocks.
    pub p: usize,
    /// Degrees of freedom of the residuals.
    pub df_resid: usize,
    /// Sum of squares of the residuals.
    pub sse: f64,
    /// Mean square of the residuals.
    pub mse: Option<f64>,
    /// Its root, unit of the response.
    pub root_mse: Option<f64>,
    /// Weighted mean of the response, unit of the response.
    pub mean: f64,
    /// Sum of squares about the mean.
    pub sst: f64,
    /// Sum of squares of the model.
    pub ssr: f64,
    /// ssr / sst.
    pub r2: Option<f64>,
    /// `1 - (sse / df_resid) / (sst / (n - 1))`.
    pub adj_r2: Option<f64>,
    /// Sum of w (residual / (1 - leverage))^2 `[Allen1974]`.
    pub press: Option<f64>,
    /// 1 - press / sst.
    pub pred_r2: Option<f64>,
    /// `100 root_mse / mean`, %.
    pub cv_pct: Option<f64>,
    /// Range of the fitted values over the root of p mse / n.
    pub adeq_precision: Option<f64>,
    /// Test of all terms together.
    pub model: AnovaRow,
    /// Two-sided 5 % limit of Student's t with `df_resid`.
    pub t_crit_975: Option<f64>,
    /// Coefficients in coded units with their tests, partial (Type III) sums of squares.
    pub terms: NamedValues<TermRow>,
    /// Every observation with its residual and influence.
    pub cases: Vec<Case>,
    /// Test of the model against the pure error of repeated rows.
    pub lack_of_fit: Option<LackOfFit>,
    /// Scatter of rows with the same settings.
    pub pure_error: Option<PureError>,
    /// Test of the misfit against all repeats: repeated rows and replicates within rows.
    pub lack_of_fit_all_repeats: Option<FTest>,
    /// Sums of squares of each term of Type I, II and III with their tests, in the order in which the terms enter.
    pub anova: NamedValues<TypedRow>,
    /// Likelihood with its penalties; none without residuals.
    pub information: Option<Information>,
    /// Greatest over least singular value of the columns scaled to unit length.
    pub condition: Option<f64>,
    /// Sum of squares that each term adds to those that enter before it (Type I), in that order.
    pub ss_sequential: NamedValues<f64>,
    /// The same by degree.
    pub sequential_model_ss: SequentialModel,
    /// The same with tests: blocks, then each order, against the residuals.
    #[serde(default)]
    pub by_order: Vec<OrderRow>,
    /// Inverse of X'WX in coded units, columns in the order of `terms`, (p, p).
    pub xtx_inverse: Vec<Vec<f64>>,
    /// Variance inflation factor of each term.
    pub vif: NamedValues<f64>,
    /// Coefficients of the same polynomial in natural units.
    pub coef_natural_units: NamedValues<f64>,
    /// Coefficients in natural units with their tests; no sums of squares.
    pub terms_natural: NamedValues<TermRow>,
    /// Region that the settings of the data span; `None` in analyses of older versions.
    #[serde(default)]
    pub data_region: Option<DataRegion>,
    /// Stationary point of a quadratic; none for models without curvature or of higher degree.
    pub canonical: Option<Canonical>,
    /// Least and greatest value over the box; none for models of higher degree than two.
    pub box_extremes: Option<BoxExtremes>,
    /// Tests against the scatter of replicates within cells.
    pub replicates: Option<Replicates>,
    /// Warnings to be read before the numbers are trusted.
    pub warnings: Vec<Warning>,
}

/// Fits a model to cell means with the numbers of replicates as weights.
///
/// # Errors
/// As [`fit_weighted`].
pub fn fit(factors: &[Factor], model: &Model, data: &Observations) -> Result<Fit, Error> {
    fit_weighted(factors, model, data, Weighting::Counts)
}

/// Fits a model to cell means. Coded columns beyond the factors (dummies) are left out.
///
/// # Formula
/// `beta = (X'WX)^-1 X'Wy` by Householder reflections; `se = sqrt(mse C_jj)`, `C = (X'WX)^-1`;
/// partial `SS = beta_j^2 / C_jj`; `F = SS / mse`; contribution = `100 SS / sst`.
///
/// # Source
/// `[Myers2016, chapter 2]`.
///
/// # Errors
/// [`Error::FactorMismatch`], [`Error::FactorScale`], [`Error::Length`] (fewer coded values than factors),
/// [`Error::TooFewObservations`], [`Error::AliasedTerms`]; [`Error::BadObservation`] for inverse
/// variance weights without positive sd.
pub fn fit_weighted(
    factors: &[Factor],
    model: &Model,
    data: &Observations,
    weighting: Weighting,
) -> Result<Fit, Error> {
    check_symbols(factors, model)?;
    check_scales(factors, model)?;
    let data = &data.first_columns(factors.len());
    let matrix = Matrix::new(model, data, weighting)?;
    let solved = least_squares(
        &matrix.rows,
        &matrix.names,
        &matrix.response,
        &matrix.weights,
    )?;
    Ok(assemble(factors, model, data, &matrix, solved, weighting))
}

/// Computes everything that follows from the solved least-squares problem.
#[allow(clippy::too_many_lines, reason = "each field of the fit has its line")]
fn assemble(
    factors: &[Factor],
    model: &Model,
    data: &Observations,
    matrix: &Matrix,
    solved: LeastSquares,
    weighting: Weighting,
) -> Fit {
    let (n, p) = (matrix.rows.len(), matrix.names.len());
    let df_resid = n - p;
    let refined = refine(
        &|i| matrix.wide_row(model, data, i),
        &matrix.response,
        &matrix.weights,
        &solved.xtx_inverse,
        &solved.coefficients,
    );
    let sums = anova::sums(matrix, refined.residuals);
    let mse = positive_df(df_resid).map(|df| sums.sse / df);
    let terms = terms::rows(matrix, &refined.coefficients, &solved, &sums, df_resid);
    let entering = anova::entering(matrix, model, &solved);
    let cases = cases::cases(data, matrix, &solved, &sums, df_resid);
    let press = cases::press(&cases, &matrix.weights);
    let pure_error = lack_of_fit::pure_error(data, &matrix.weights);
    let coefficients = matrix.model_part(&refined.coefficients);
    let covariance = matrix.model_block(&solved.xtx_inverse);
    let terms_natural = natural_terms(factors, model, &coefficients, &covariance, mse, df_resid);
    let replicates = replicates::replicates(data, &matrix.weights, &terms, sums.sse, df_resid);
    let explained = |left: Option<f64>| Some(1.0 - ratio(left?, sums.sst)?);
    let mut fit = Fit {
        factors: factors.to_vec(),
        formula: model.clone(),
        weighting,
        mean_count: data.mean_count(),
        n,
        p,
        df_resid,
        sse: sums.sse,
        mse,
        root_mse: mse.map(f64::sqrt),
        mean: sums.mean,
        sst: sums.sst,
        ssr: sums.sst - sums.sse,
        r2: ratio(sums.sst - sums.sse, sums.sst),
        adj_r2: explained(mse.map(|mse| mse * sums.df_total as f64)),
        press,
        pred_r2: explained(press),
        cv_pct: mse.and_then(|mse| ratio(100.0 * mse.sqrt(), sums.mean)),
        adeq_precision: mse.and_then(|mse| cases::adequate_precision(&cases, p, mse)),
        model: anova::model_row(&sums, df_resid),
        t_crit_975: positive_df(df_resid).and_then(|df| t_two_sided_quantile(0.05, df)),
        lack_of_fit: pure_error
            .as_ref()
            .and_then(|pure| lack_of_fit::lack_of_fit(sums.sse, df_resid, pure)),
        ss_sequential: anova::sequential(matrix, &entering),
        sequential_model_ss: anova::sequential_by_degree(matrix, model, &solved, &sums),
        by_order: anova::by_order(matrix, model, &solved, &sums, df_resid),
        vif: terms::variance_inflation(matrix, &solved),
        coef_natural_units: terms_natural
            .iter()
            .map(|(name, row)| (name.to_owned(), row.coef))
            .collect(),
        terms_natural,
        data_region: None,
        canonical: None,
        box_extremes: None,
        lack_of_fit_all_repeats: lack_of_fit::against_all_repeats(
            sums.sse,
            df_resid,
            pure_error.as_ref(),
            replicates.as_ref(),
        ),
        anova: typed::rows(matrix, model, &solved, &entering, &terms, mse, df_resid),
        information: information::information(&sums, &matrix.weights, p),
        condition: condition(&solved),
        pure_error,
        replicates,
        terms,
        cases,
        xtx_inverse: solved.xtx_inverse,
        warnings: Vec::new(),
    };
    fit.add_shape();
    fit.warnings = warnings::warnings(&fit);
    fit
}

impl Fit {
    /// Adds what the data span, and the shape of a surface of degree two at most.
    fn add_shape(&mut self) {
        let cases = self.cases.iter();
        let settings: Vec<Vec<f64>> = cases.map(|case| self.natural(&case.coded)).collect();
        self.data_region = DataRegion::of(&settings);
        if let Ok(quadratic) = self.quadratic() {
            let (factors, region) = (&self.factors, self.data_region.as_ref());
            self.canonical = crate::surface::canonical::canonical(&quadratic, factors, region);
            self.box_extremes = Some(crate::surface::extremes::box_extremes(&quadratic, factors));
        }
    }

    /// Number of runs whose mean has weight 1: the variance of a run over that of such a mean, or the mean number
    /// of runs in a cell if there are no replicates.
    pub fn runs_of_unit_weight(&self) -> f64 {
        let of = |r: &Replicates| r.pooled_within_var / r.var_of_run_mean;
        let seen = self.replicates.as_ref().map(of);
        seen.filter(|runs| runs.is_finite())
            .unwrap_or(self.mean_count)
    }

    /// The chosen error variance of a cell mean of weight 1; `None` if undefined.
    pub fn error_variance(&self, source: ErrorSource) -> Option<ErrorVariance> {
        let within = self.replicates.as_ref().map(|r| (r.var_of_run_mean, r.df));
        let between = self.pure_error.as_ref().map(|pure| (pure.ms, pure.df));
        let (variance, df) = match source {
            ErrorSource::Residual => (self.mse?, self.df_resid),
            ErrorSource::RepeatedRows => between?,
            ErrorSource::Replicates => within?,
            ErrorSource::AllRepeats => match (within, between) {
                (Some((a, m)), Some((b, n))) => {
                    ((a * m as f64 + b * n as f64) / (m + n) as f64, m + n)
                }
                (one, other) => one.or(other)?,
            },
        };
        Some(ErrorVariance {
            source,
            variance,
            df,
        })
    }

    /// The error variance to use if nothing else is asked for: all repeats if there are any,
    /// otherwise the residuals; none if both are undefined.
    pub fn best_error_variance(&self) -> Option<ErrorVariance> {
        self.error_variance(ErrorSource::AllRepeats)
            .or_else(|| self.error_variance(ErrorSource::Residual))
    }

    /// The error variance asked for, or the best one there is.
    ///
    /// # Errors
    /// [`Error::NoErrorVariance`] if the one asked for is undefined.
    pub fn chosen_error(
        &self,
        source: Option<ErrorSource>,
    ) -> Result<Option<ErrorVariance>, Error> {
        let Some(source) = source else {
            return Ok(self.best_error_variance());
        };
        let source_of_error = match source {
            ErrorSource::Residual => "residual",
            ErrorSource::RepeatedRows => "repeated-rows",
            ErrorSource::Replicates => "replicates",
            ErrorSource::AllRepeats => "all-repeats",
        };
        match self.error_variance(source) {
            Some(error) => Ok(Some(error)),
            None => Err(Error::NoErrorVariance {
                source_of_error,
                way_out: "choose another error, or add replicates",
            }),
        }
    }

    /// Coefficients of the model terms (blocks left out), in the order of the model.
    pub fn coefficients(&self) -> Vec<f64> {
        let names = self.formula.names();
        names
            .iter()
            .filter_map(|name| self.terms.get(name))
            .map(|row| row.coef)
            .collect()
    }

    /// Value of the fitted surface at a coded point, unit of the response, at the mean of blocks.
    pub fn value(&self, coded: &[f64]) -> f64 {
        let row = self.formula.row(coded);
        row.iter()
            .zip(self.coefficients())
            .map(|(x, c)| x * c)
            .sum()
    }

    /// x'Cx at a coded point: variance of the fitted value over that of a cell mean.
    pub fn leverage(&self, coded: &[f64]) -> f64 {
        let row = self.formula.row(coded);
        let blocks = self.p - row.len();
        // Columns: intercept, blocks, the other terms; a mean block has zeros.
        let place = |i: usize| if i == 0 { 0 } else { i + blocks };
        let dot = |i: usize| -> f64 {
            let c = &self.xtx_inverse[place(i)];
            row.iter().enumerate().map(|(j, x)| x * c[place(j)]).sum()
        };
        row.iter().enumerate().map(|(i, x)| x * dot(i)).sum()
    }

    /// Change of each coefficient (in the order of `terms`) when case `i` (from 0) is left out, over
    /// its standard error without it; none at leverage 1 or without degrees of freedom, and with
    /// blocks.
    ///
    /// # Source
    /// DFBETAS: `[Belsley1980, section 2.1]`.
    pub fn dfbetas(&self, i: usize) -> Option<Vec<f64>> {
        let case = self.cases.get(i)?;
        let row = self.formula.row(&case.coded);
        let external = case.studentized_external?;
        let free = 1.0 - case.leverage;
        if row.len() != self.p {
            return None;
        }
        let change = |line: &Vec<f64>| -> f64 { line.iter().zip(&row).map(|(c, x)| c * x).sum() };
        let scale = external * (case.weight / free).sqrt();
        let lines = self.xtx_inverse.iter().enumerate();
        Some(
            lines
                .map(|(j, line)| change(line) * scale / line[j].sqrt())
                .collect(),
        )
    }

    /// Natural values of a coded point, units of the factors.
    pub fn natural(&self, coded: &[f64]) -> Vec<f64> {
        self.factors
            .iter()
            .zip(coded)
            .map(|(factor, &x)| factor.natural(x))
            .collect()
    }

    /// Coded values of a natural point, units of the factors.
    pub fn coded(&self, natural: &[f64]) -> Vec<f64> {
        self.factors
            .iter()
            .zip(natural)
            .map(|(factor, &u)| factor.coded(u))
            .collect()
    }
}

/// Refuses a model for other factors.
fn check_symbols(factors: &[Factor], model: &Model) -> Result<(), Error> {
    experiment_design::check_factors(factors)?;
    let given: Vec<&str> = factors.iter().map(Factor::symbol).collect();
    if given == model.symbols() {
        return Ok(());
    }
    Err(Error::FactorMismatch {
        model: model.symbols().join(", "),
        given: given.join(", "),
    })
}

/// Refuses a range in whose unit the coefficients, or their variances, would be no numbers.
fn check_scales(factors: &[Factor], model: &Model) -> Result<(), Error> {
    for (j, factor) in factors.iter().enumerate() {
        let powers = model.terms().iter().map(|term| term.powers()[j]);
        let power = powers.max().unwrap_or(0);
        let half = factor.half_range();
        let ratios = [half, 1.0 / half, factor.mid() / half];
        let largest = |ratio: &f64| ratio.abs().powi(i32::from(power));
        let beyond = |ratio: &f64| ratio.is_nan() || largest(ratio) > Observations::LARGEST;
        if ratios.iter().any(beyond) {
            return Err(Error::FactorScale {
                symbol: factor.symbol().to_owned(),
                low: factor.low(),
                high: factor.high(),
                power,
            });
        }
    }
    Ok(())
}

/// The degrees of freedom as a number; none if there are none.
pub(crate) fn positive_df(df: usize) -> Option<f64> {
    (df > 0).then_some(df as f64)
}

/// a / b; `None` if it is not finite.
pub(crate) fn ratio(a: f64, b: f64) -> Option<f64> {
    Some(a / b).filter(|q| q.is_finite())
}
