//! Factors of named levels on the command line.

use anyhow::Context as _;
use response_surface::{Categorical, Fit};

/// The fit with named factors held at levels.
///
/// # Errors
/// A level that does not exist.
pub(crate) fn held(fit: &Fit, chosen: &[(Categorical, String)]) -> anyhow::Result<Fit> {
    let mut held = Vec::new();
    for (category, level) in chosen {
        let (symbol, levels) = (category.symbol(), category.levels().join(", "));
        let values = category.coded(level).with_context(|| {
            format!("'{symbol}' has no level '{level}'; its levels are {levels}")
        })?;
        for (column, value) in category.columns()?.iter().zip(values) {
            let place = fit
                .factors
                .iter()
                .position(|f| f.symbol() == column.symbol())
                .with_context(|| format!("the analysis has no column of '{symbol}'"))?;
            held.push((place, value));
        }
    }
    Ok(fit.held(&held)?)
}
