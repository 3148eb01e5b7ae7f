//! What a reader should know before trusting a fit.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Fit, ratio};
use probability::t_two_sided_quantile;

/// A property of the fit that calls for care.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// A coefficient is blurred by others: variance inflation above 10.
    VarianceInflation {
        /// Name of the term.
        term: String,
        /// Variance inflation factor.
        vif: f64,
    },
    /// The model passes through this observation whatever its value.
    FullLeverage {
        /// Number of the observation, from 1.
        run: usize,
    },
    /// The model misses structure: p of the lack of fit below 0.05.
    LackOfFit {
        /// Upper tail of F.
        p: f64,
        /// Whether it was tested against replicates within cells (or against repeated rows).
        against_replicates: bool,
    },
    /// Predicted and adjusted R2 differ by more than 0.2: the model follows single observations.
    PredictionGap {
        /// Adjusted R2.
        adj_r2: f64,
        /// Predicted R2.
        pred_r2: f64,
    },
    /// Cells differ in variance: p of Bartlett's test below 0.05.
    UnequalVariance {
        /// Upper tail of chi squared.
        p: f64,
    },
    /// Products or powers are in the model without the terms they are made of.
    Hierarchy {
        /// The missing terms.
        missing: Vec<String>,
    },
    /// The residuals are much smaller than replicates allow: the sds may not be over repeats.
    ResidualsBelowReplicates {
        /// Mean square of the residuals over the variance of a cell mean.
        ratio: f64,
    },
    /// There is neither a replicate nor a repeated row: lack of fit cannot be tested.
    NoReplicates,
    /// The scaled columns of the model are nearly dependent: condition number above 1e8.
    IllConditioned {
        /// Greatest over least singular value of the scaled columns.
        condition: f64,
    },
    /// An observation lies outside the Bonferroni limit of all external studentised residuals.
    Outlier {
        /// Number of the observation, from 1.
        run: usize,
        /// External studentised residual.
        t: f64,
    },
    /// There are no residual degrees of freedom: nothing can be tested against residuals.
    Saturated,
}

impl fmt::Display for Warning {
    #[allow(clippy::too_many_lines, reason = "each variant has its sentence here")]
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::VarianceInflation { term, vif } => {
                write!(
                    out,
                    "{term} is blurred by other terms (variance inflation {vif:.1})"
                )
            }
            Self::FullLeverage { run } => {
                write!(
                    out,
                    "observation {run} is fitted exactly whatever its value (leverage 1)"
                )
            }
            Self::LackOfFit {
                p,
                against_replicates,
            } => {
                let against = if *against_replicates {
                    "replicates"
                } else {
                    "repeated rows"
                };
                write!(
                    out,
                    "the model misses structure (lack of fit against {against}, p {p:.2e})"
                )
            }
            Self::PredictionGap { adj_r2, pred_r2 } => write!(
                out,
                "predicted R2 {pred_r2:.3} is far below adjusted R2 {adj_r2:.3}; the model \
                 follows single observations"
            ),
            Self::UnequalVariance { p } => {
                write!(out, "cells differ in variance (Bartlett, p {p:.2e})")
            }
            Self::Hierarchy { missing } => {
                write!(
                    out,
                    "the model has products without their terms {}: what it fits depends on where the ranges of the \
                     factors have their middle",
                    missing.join(", ")
                )
            }
            Self::ResidualsBelowReplicates { ratio } => write!(
                out,
                "residuals are {ratio:.2} of what replicates allow; check what the standard \
                 deviations were taken over"
            ),
            Self::NoReplicates => write!(
                out,
                "no settings are repeated: there is no pure error, so lack of fit is undefined"
            ),
            Self::IllConditioned { condition } => write!(
                out,
                "the terms are nearly dependent over these runs (condition number {condition:.1e})"
            ),
            Self::Outlier { run, t } => write!(
                out,
                "observation {run} lies outside the limit for all observations (external \
                 studentised residual {t:.2})"
            ),
            Self::Saturated => write!(out, "no residual degrees of freedom; nothing is tested"),
        }
    }
}

/// Collects the warnings of a fit.
pub(crate) fn warnings(fit: &Fit) -> Vec<Warning> {
    let mut found = Vec::new();
    if fit.df_resid == 0 {
        found.push(Warning::Saturated);
    }
    let missing = fit.formula.missing_for_hierarchy();
    if !missing.is_empty() {
        found.push(Warning::Hierarchy { missing });
    }
    for (term, &vif) in fit.vif.iter().filter(|(_, vif)| **vif > 10.0) {
        let term = term.to_owned();
        found.push(Warning::VarianceInflation { term, vif });
    }
    if fit.df_resid > 0 {
        let full = fit.cases.iter().filter(|case| case.leverage > 1.0 - 1e-8);
        found.extend(full.map(|case| Warning::FullLeverage { run: case.run }));
    }
    if let Some(condition) = fit.condition.filter(|condition| *condition > 1e8) {
        found.push(Warning::IllConditioned { condition });
    }
    found.extend(outliers(fit));
    if fit.pure_error.is_none() && fit.replicates.is_none() {
        found.push(Warning::NoReplicates);
    }
    if let Some(p) = fit
        .lack_of_fit
        .as_ref()
        .and_then(|l| l.p)
        .filter(|p| *p < 0.05)
    {
        let against_replicates = false;
        found.push(Warning::LackOfFit {
            p,
            against_replicates,
        });
    }
    if let (Some(adj_r2), Some(pred_r2)) = (fit.adj_r2, fit.pred_r2)
        && adj_r2 - pred_r2 > 0.2
    {
        found.push(Warning::PredictionGap { adj_r2, pred_r2 });
    }
    against_replicates(fit, &mut found);
    found
}

/// Observations beyond the two-sided 5 % limit that holds for all of them at once.
fn outliers(fit: &Fit) -> Vec<Warning> {
    let Some(df) = fit.df_resid.checked_sub(1).filter(|df| *df > 0) else {
        return Vec::new();
    };
    let Some(limit) = t_two_sided_quantile(0.05 / fit.n as f64, df as f64) else {
        return Vec::new();
    };
    let beyond = |case: &super::Case| {
        let t = case.studentized_external.filter(|t| t.abs() > limit)?;
        Some(Warning::Outlier { run: case.run, t })
    };
    fit.cases.iter().filter_map(beyond).collect()
}

/// Adds the warnings that replicates allow.
fn against_replicates(fit: &Fit, found: &mut Vec<Warning>) {
    let Some(replicates) = &fit.replicates else {
        return;
    };
    let test = replicates.lack_of_fit_vs_replicates.as_ref();
    if let Some(p) = test.and_then(|t| t.p).filter(|p| *p < 0.05) {
        let against_replicates = true;
        found.push(Warning::LackOfFit {
            p,
            against_replicates,
        });
    }
    if let Some(p) = replicates
        .bartlett
        .as_ref()
        .and_then(|b| b.p)
        .filter(|p| *p < 0.05)
    {
        found.push(Warning::UnequalVariance { p });
    }
    let share = fit
        .mse
        .and_then(|mse| ratio(mse, replicates.var_of_run_mean));
    // The lower 1 % tail of F lies below 0.2 for five residual degrees of freedom or more.
    if let Some(ratio) = share.filter(|q| *q < 0.2 && fit.df_resid >= 5) {
        found.push(Warning::ResidualsBelowReplicates { ratio });
    }
}
