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

mod alias;
mod box_cox;
mod canonical;
mod categorical;
mod confirm;
mod desirability;
mod error;
mod evaluate;
mod extremes;
pub mod fit;
mod formula;
mod gaussian_process;
mod interaction_search;
mod least_squares;
mod model;
mod named;
mod natural;
mod observations;
mod one_way;
mod orders;
mod pairs;
mod pareto;
mod prediction;
mod propagation;
mod quadratic;
mod random_blocks;
mod reduce;
mod refine;
mod regime;
mod ridge;
mod saturated;
mod screening;
mod simplex;
mod sobol;
pub mod solutions;
mod spread;
mod tolerance;
mod transform;
mod wide;
mod within;

pub use alias::{alias_matrix, aliases};
pub use box_cox::{BoxCox, box_cox};
pub use canonical::{Canonical, StationaryKind};
pub use categorical::{Categorical, CategoricalModel, GroupRow, GroupSum};
pub use confirm::{Confirmation, confirm};
pub use desirability::{Aim, Compromise, Goal, ScatterGoal, compromises};
pub use error::Error;
pub use evaluate::{Efficiency, Evaluation, Over, evaluate};
pub use extremes::{BoxExtremes, Extreme};
pub use fit::{ErrorSource, ErrorVariance, Fit, Weighting, fit, fit_weighted};
pub use gaussian_process::{GaussianProcess, ProcessPrediction, gaussian_process};
pub use interaction_search::{InteractionStep, interaction_search};
pub use model::{Model, Term};
pub use named::NamedValues;
pub use observations::{Cell, Observations};
pub use one_way::{OneWay, one_way, one_way_decimals};
pub use orders::{Order, Orders, orders};
pub use pairs::PairDifference;
pub use pareto::{Pareto, pareto};
pub use prediction::Prediction;
pub use propagation::Propagation;
pub use random_blocks::{RandomBlockTerm, RandomBlocks, random_blocks};
pub use reduce::{ReductionRule, ReductionStep, reduce};
pub use regime::{Regime, regime};
pub use ridge::{RidgePoint, ridge_path};
pub use saturated::{Contrasts, HalfNormalPoint, Lenth, Saturated, contrasts, saturated};
pub use screening::{FactorSignificance, Screening, screen};
pub use sobol::{FactorShare, Share, Sobol};
pub use solutions::{Measured, SolutionRequest, Solutions, solutions};
pub use spread::{Spread, spread};
pub use tolerance::{Tolerance, tolerance_factor};
pub use transform::Transform;
