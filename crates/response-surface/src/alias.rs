//! Which effects left out of a model blur those in it.

use experiment_design::Design;

use crate::least_squares::least_squares;
use crate::{Error, NamedValues};

/// Alias coefficients of all two-factor interactions on the columns of a design.
///
/// The outer name is the interaction, the inner one a column: the expected coefficient of the
/// column, fitted as a main effect, is its own plus the sum of these times the interactions.
///
/// # Formula
/// A = (X1'X1)^-1 X1'X2, X1 intercept and columns, X2 the interactions
/// `[Myers2016]`.
///
/// # Errors
/// [`Error::AliasedTerms`] if the columns themselves cannot be separated,
/// [`Error::TooFewObservations`].
pub fn alias_matrix(design: &Design) -> Result<NamedValues<NamedValues<f64>>, Error> {
    let columns = design.columns();
    let names: Vec<String> = std::iter::once("1".to_owned())
        .chain(columns.iter().cloned())
        .collect();
    let with_one = |run: Vec<f64>| std::iter::once(1.0).chain(run).collect();
    let rows: Vec<Vec<f64>> = design.coded_rows().into_iter().map(with_one).collect();
    if rows.len() < names.len() {
        return Err(Error::TooFewObservations {
            observations: rows.len(),
            terms: names.len(),
        });
    }
    let weights = vec![1.0; rows.len()];
    let joint = if columns.iter().all(|name| name.len() == 1) {
        ""
    } else {
        ":"
    };
    let k = design.factors().len();
    let mut aliases = Vec::new();
    for i in 0..k {
        for j in i + 1..k {
            let product: Vec<f64> = rows.iter().map(|row| row[i + 1] * row[j + 1]).collect();
            let solved = least_squares(&rows, &names, &product, &weights)?;
            let on_columns = columns
                .iter()
                .cloned()
                .zip(solved.coefficients.into_iter().skip(1));
            aliases.push((
                format!("{}{joint}{}", columns[i], columns[j]),
                on_columns.collect(),
            ));
        }
    }
    Ok(aliases.into_iter().collect())
}
