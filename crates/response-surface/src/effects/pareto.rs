//! Pareto chart of the effects with its limits.

use serde::{Deserialize, Serialize};

use crate::{Fit, NamedValues};
use probability::t_two_sided_quantile;

/// Sizes of the t values with the limits to read them against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pareto {
    /// |t| of each term, in the order of the model.
    pub t_abs: NamedValues<f64>,
    /// Sign of each coefficient: -1, 0 or 1.
    pub sign: NamedValues<i32>,
    /// Names by falling |t|.
    pub order: Vec<String>,
    /// Degrees of freedom of the error.
    pub df: usize,
    /// Two-sided 5 % limit of one t.
    pub t_limit: Option<f64>,
    /// The limit that holds for all terms of the model at once (Bonferroni).
    pub bonferroni_terms: Option<f64>,
    /// The limit that holds for all columns of a saturated design (n - 1) at once (Bonferroni).
    pub bonferroni_columns: Option<f64>,
}

/// Pareto chart of a fit with its residuals as error; none without residual degrees of freedom.
///
/// # Source
/// Bonferroni limit: `[Dunn1961]`.
pub fn pareto(fit: &Fit) -> Option<Pareto> {
    let intercept = usize::from(fit.formula.has_intercept());
    let t = |(name, row): (&str, &crate::fit::TermRow)| Some((name.to_owned(), row.t?.abs()));
    let t_abs: NamedValues<f64> = fit.terms.iter().skip(intercept).filter_map(t).collect();
    if t_abs.is_empty() {
        return None;
    }
    let sign = |coef: f64| i32::from(coef > 0.0) - i32::from(coef < 0.0);
    let terms = fit.terms.iter().skip(intercept);
    let mut by_size: Vec<(&str, f64)> = t_abs.iter().map(|(name, t)| (name, *t)).collect();
    by_size.sort_by(|a, b| b.1.total_cmp(&a.1));
    let order = by_size
        .into_iter()
        .map(|(name, _)| name.to_owned())
        .collect();
    let df = fit.df_resid as f64;
    let bonferroni = |k: usize| t_two_sided_quantile(0.05 / k as f64, df);
    Some(Pareto {
        sign: terms
            .map(|(name, row)| (name.to_owned(), sign(row.coef)))
            .collect(),
        order,
        df: fit.df_resid,
        t_limit: fit.t_crit_975,
        bonferroni_terms: bonferroni(t_abs.len()),
        bonferroni_columns: bonferroni(fit.n - 1),
        t_abs,
    })
}
