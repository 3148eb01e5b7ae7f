//! Which effects left out of a model blur those in it.

use experiment_design::Design;

use crate::fit::Matrix;
use crate::fit::least_squares::least_squares;
use crate::{Error, Fit, Model, NamedValues, Observations};

/// Greatest number of factors for which products of three are looked at.
const MOST_FACTORS: usize = 10;

/// Bias by terms left out of a fit in those that are in it, over the rows of these data.
///
/// The outer name is the term left out, the inner one a term of the fit: the expected coefficient of a term is its own
/// plus the sum of these times the coefficients of the terms left out. Main effects, two-factor interactions, squares,
/// and (for up to ten factors) products of three are looked at; one that blurs nothing has no entry.
///
/// # Formula
/// A = (X1'WX1)^-1 X1'WX2, X1 the terms of the fit, X2 those left out, coded, W the weights `[Myers2016]`.
///
/// # Errors
/// Those of [`crate::fit_weighted`] for data that do not belong to the fit.
pub fn aliases(fit: &Fit, data: &Observations) -> Result<NamedValues<NamedValues<f64>>, Error> {
    let data = data.first_columns(fit.factors.len());
    let matrix = Matrix::new(&fit.formula, &data, fit.weighting)?;
    Ok(of_matrix(&fit.formula, &matrix, &data, &fit.xtx_inverse))
}

/// As [`aliases`], of a model matrix with the inverse of its X'WX.
pub(crate) fn of_matrix(
    model: &Model,
    matrix: &Matrix,
    data: &Observations,
    inverse: &[Vec<f64>],
) -> NamedValues<NamedValues<f64>> {
    let k = model.symbols().len();
    let wider = Model::of_degree(if k > MOST_FACTORS { 2 } else { 3 }, model.symbols());
    let left_out = wider.terms().iter().filter(|term| {
        let crossed = term.degree() == 2 || term.powers().iter().all(|power| *power <= 1);
        crossed && !model.terms().contains(term)
    });
    let blurs = |term: &crate::Term| {
        let mut products = vec![0.0; matrix.names.len()];
        for ((cell, row), weight) in data.cells().iter().zip(&matrix.rows).zip(&matrix.weights) {
            let value = weight * term.value(&cell.coded[..k]);
            products
                .iter_mut()
                .zip(row)
                .for_each(|(p, x)| *p += x * value);
        }
        let amount =
            |line: &Vec<f64>| -> f64 { line.iter().zip(&products).map(|(c, p)| c * p).sum() };
        let parts = matrix.names.iter().cloned().zip(inverse.iter().map(amount));
        let parts: NamedValues<f64> = parts.filter(|(_, amount)| amount.abs() > 1e-9).collect();
        (!parts.is_empty()).then(|| (model.name(term), parts))
    };
    left_out.filter_map(blurs).collect()
}

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
