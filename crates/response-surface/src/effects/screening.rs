//! Screening: which factors of a two-level design matter.

use experiment_design::Design;
use serde::{Deserialize, Serialize};

use crate::fit::FTest;
use crate::fit::{f_test, fit};
use crate::{Error, Fit, Model, NamedValues, Observations, Pareto, Saturated, pareto, saturated};

/// A screening design analysed in all customary ways.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Screening {
    /// Main effects of the factors, the dummy columns as error.
    pub main_effects: Fit,
    /// All columns as effects; none if the design is not saturated and orthogonal (fold-over,
    /// failed runs and unequal weights do not hinder `main_effects`).
    pub saturated: Option<Saturated>,
    /// Pareto chart; none without dummy columns.
    pub pareto: Option<Pareto>,
    /// Test of every column, dummies too, against replicates; none without replicates.
    pub replicate_tests: Option<NamedValues<FTest>>,
    /// The factors by falling sum of squares with both significances.
    pub factors: Vec<FactorSignificance>,
}

/// How much a factor matters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorSignificance {
    /// Symbol.
    pub factor: String,
    /// Rank by sum of squares, 1 the greatest.
    pub rank: usize,
    /// Mean at high minus mean at low level, unit of the response.
    pub effect: f64,
    /// Share of the total sum of squares, %.
    pub contribution_pct: Option<f64>,
    /// Significance against the dummy columns.
    pub p_dummies: Option<f64>,
    /// Significance against the replicates.
    pub p_replicates: Option<f64>,
}

/// Analyses a screening design; `data` holds one observation per cell of the design, with values
/// for the dummy columns as well.
///
/// # Errors
/// Those of [`fit`].
pub fn screen(design: &Design, data: &Observations) -> Result<Screening, Error> {
    let factors = design.factors();
    let main_effects = fit(factors, &Model::linear(factors)?, data)?;
    let equal_counts = data.cells().windows(2).all(|pair| pair[0].n == pair[1].n);
    let saturated = match saturated(&design.columns(), data) {
        Ok(saturated) if equal_counts => Some(saturated),
        Ok(_) | Err(Error::NotSaturated { .. } | Error::Length { .. }) => None,
        Err(error) => return Err(error),
    };
    let replicate_tests = main_effects.replicates.as_ref().map(|replicates| {
        let columns = saturated.iter().flat_map(|s| s.ss.iter());
        let (variance, df) = (replicates.var_of_run_mean, replicates.df);
        let tests: NamedValues<FTest> = columns
            .map(|(name, ss)| (name.to_owned(), f_test(*ss, 1, variance, df)))
            .collect();
        if tests.is_empty() {
            replicates.tests.clone()
        } else {
            tests
        }
    });
    Ok(Screening {
        factors: significances(&main_effects),
        pareto: pareto(&main_effects),
        saturated,
        replicate_tests,
        main_effects,
    })
}

/// The factors by falling sum of squares.
fn significances(main_effects: &Fit) -> Vec<FactorSignificance> {
    let against = |name: &str| main_effects.replicates.as_ref()?.tests.get(name)?.p;
    let symbols = main_effects.formula.symbols();
    let rows = main_effects
        .terms
        .iter()
        .filter(|(name, _)| symbols.iter().any(|s| s == name));
    let mut sorted: Vec<_> = rows.collect();
    sorted.sort_by(|a, b| {
        let size = |row: &crate::fit::TermRow| row.ss_partial.unwrap_or(0.0);
        size(b.1).total_cmp(&size(a.1))
    });
    let significance =
        |(i, (name, row)): (usize, (&str, &crate::fit::TermRow))| FactorSignificance {
            factor: name.to_owned(),
            rank: i + 1,
            effect: 2.0 * row.coef,
            contribution_pct: row.contribution_pct,
            p_dummies: row.p,
            p_replicates: against(name),
        };
    sorted.into_iter().enumerate().map(significance).collect()
}
