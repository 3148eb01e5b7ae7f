//! Model matrix, least squares, analysis of variance, the set of solutions.
//!
//! [`fit()`] fits a polynomial [`Model`] to cell means and returns a [`Fit`] with everything that is
//! known about it: coefficients, analysis of variance, cases, lack of fit, canonical form.
//! [`screen`] analyses a saturated two-level design. [`solutions()`] answers where in the box the
//! surface meets a target: the whole set, its confidence region, and the nearest points.
//!
//! ```
//! use experiment_design::{Factor, box_behnken};
//! use response_surface::{Cell, Model, Observations, fit};
//! let factors = ["B", "E", "F"].map(|s| Factor::coded_only(s).unwrap());
//! let design = box_behnken(&factors, 3)?;
//! let truth = |x: &[f64]| 36.0 + x[0] - 2.0 * x[2] + 0.5 * x[0] * x[0];
//! let cells = design.coded_rows().into_iter().map(|x| Cell::single(x.clone(), truth(&x)));
//! let data = Observations::from_cells(cells.collect())?;
//! let fitted = fit(&factors, &Model::quadratic(&factors)?, &data)?;
//! assert!((fitted.terms.get("B2").unwrap().coef - 0.5).abs() < 1e-12);
//! # Ok::<(), response_surface::Error>(())
//! ```
//!
//! Invariants: what is undefined is `None` (JSON null), never NaN or infinity; terms that the
//! runs cannot separate are an error that names them; p values are upper tails, never 1 - cdf.
//!
//! # Weights
//! A cell mean of n runs has weight n divided by the mean n of all cells, so sums of squares and
//! mean squares are in squared units of the response and hold for a cell of mean size. With equal
//! n this is ordinary least squares on the means.

mod effects;
mod error;
pub mod fit;
mod gaussian_process;
mod goals;
mod groups;
mod model;
mod named;
mod observations;
mod regime;
mod selection;
pub mod solutions;
mod surface;

pub use effects::interaction_search::{InteractionStep, interaction_search};
pub use effects::pareto::{Pareto, pareto};
pub use effects::saturated::{Contrasts, HalfNormalPoint, Lenth, Saturated, contrasts, saturated};
pub use effects::screening::{FactorSignificance, Screening, screen};
pub use error::Error;
pub use fit::polynomials::Polynomials;
pub use fit::{ErrorSource, ErrorVariance, Fit, Weighting, fit, fit_weighted};
pub use gaussian_process::{GaussianProcess, ProcessPrediction, gaussian_process};
pub use goals::confirm::{Confirmation, confirm};
pub use goals::desirability::{Aim, Compromise, Goal, ScatterGoal, compromise_at, compromises};
pub use groups::one_way::{OneWay, one_way, one_way_decimals};
pub use groups::pairs::PairDifference;
pub use groups::random_blocks::{RandomBlockTerm, RandomBlocks, random_blocks};
pub use groups::spread::{Spread, spread};
pub use model::categorical::{Categorical, CategoricalModel, GroupRow, GroupSum};
pub use model::transform::Transform;
pub use model::{Model, Term};
pub use named::NamedValues;
pub use observations::{Cell, Observations};
pub use regime::{Regime, regime};
pub use selection::alias::{alias_matrix, aliases};
pub use selection::box_cox::{BoxCox, box_cox};
pub use selection::evaluate::{Efficiency, Evaluation, Over, evaluate};
pub use selection::orders::{Order, Orders, orders};
pub use selection::reduce::{ReductionRule, ReductionStep, reduce};
pub use solutions::{Measured, SolutionRequest, Solutions, solutions};
pub use surface::canonical::{Canonical, StationaryKind};
pub use surface::data_region::{DataRegion, OpenBound};
pub use surface::extremes::{BoxExtremes, Extreme};
pub use surface::prediction::Prediction;
pub use surface::propagation::Propagation;
pub use surface::ridge::{RidgePoint, ridge_path};
pub use surface::sobol::{FactorShare, Share, Sobol};
pub use surface::tolerance::{Tolerance, tolerance_factor};
