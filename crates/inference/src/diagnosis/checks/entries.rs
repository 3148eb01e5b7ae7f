//! Checks of single lists: matrices, covariances, names, numbers.

use nalgebra::DMatrix;
use std::collections::BTreeSet;

use crate::diagnosis::Error;
use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::problem_file::CovarianceInput;

/// Two mirror entries may differ by this share of the geometric mean of their variances: more
/// than the rounding of printed numbers is a mistake.
const SYMMETRY_TOLERANCE: f64 = 1e-6;
/// Largest size of a number: its square is finite, and the sum of as many as there are in a file.
const MOST: f64 = 1e100;
/// An eigenvalue of the prior precision above minus this share of the largest counts as 0.
const PRIOR_TOLERANCE: f64 = 1e-12;

pub(super) fn covariance(
    input: &CovarianceInput,
    key: &str,
    n_observables: usize,
    labels: &[String],
) -> Result<Covariance, Error> {
    let size = n_observables;
    let n_rows = size * labels.len();
    match input {
        CovarianceInput::Blocks(blocks) => {
            check_length(key, blocks.len(), labels.len(), "one block per condition")?;
            let blocks = blocks
                .iter()
                .enumerate()
                .map(|(c, block)| symmetric(block, &format!("{key}[{c}]"), size))
                .collect::<Result<_, _>>()?;
            Ok(Covariance::new(blocks, labels.to_vec()))
        }
        CovarianceInput::Matrix(rows) if rows.len() == size => {
            let block = symmetric(rows, key, size)?;
            Ok(Covariance::new(vec![block; labels.len()], labels.to_vec()))
        }
        CovarianceInput::Matrix(rows) => {
            check_length(
                key,
                rows.len(),
                n_rows,
                "one row per residual, or per observable for a shared block",
            )?;
            let whole = symmetric(rows, key, n_rows)?;
            Ok(Covariance::new(
                vec![whole],
                vec!["all conditions together".into()],
            ))
        }
    }
}

/// Makes a symmetric matrix with variances that are not negative.
pub(super) fn symmetric(rows: &[Vec<f64>], key: &str, size: usize) -> Result<DMatrix<f64>, Error> {
    let matrix = matrix(rows, key, (size, size), "a square matrix")?;
    for i in 0..size {
        if matrix[(i, i)] < 0.0 {
            return Err(Error::OutOfRange {
                what: format!("{key}[{i}][{i}]"),
                value: matrix[(i, i)],
                range: "a variance, not below 0",
            });
        }
        for j in 0..i {
            let scale = (matrix[(i, i)] * matrix[(j, j)]).sqrt();
            if (matrix[(i, j)] - matrix[(j, i)]).abs() > SYMMETRY_TOLERANCE * scale {
                return Err(Error::NotSymmetric {
                    what: key.to_owned(),
                    row: i,
                    column: j,
                });
            }
        }
    }
    Ok((&matrix + matrix.transpose()) * 0.5)
}

pub(super) fn matrix(
    rows: &[Vec<f64>],
    key: &str,
    shape: (usize, usize),
    reason: &str,
) -> Result<DMatrix<f64>, Error> {
    // Without columns the rows need not be written.
    if shape.1 == 0 && rows.is_empty() {
        return Ok(DMatrix::zeros(shape.0, 0));
    }
    check_length(key, rows.len(), shape.0, reason)?;
    for (i, row) in rows.iter().enumerate() {
        check_length(&format!("{key}[{i}]"), row.len(), shape.1, "its columns")?;
        for (j, &x) in row.iter().enumerate() {
            check_finite(x, || format!("{key}[{i}][{j}]"))?;
        }
    }
    Ok(DMatrix::from_row_iterator(
        shape.0,
        shape.1,
        rows.iter().flatten().copied(),
    ))
}

/// R with R'R = precision, without rows of eigenvalue 0. The parameters are scaled to precision 1
/// first, so that their units do not decide which eigenvalue counts as 0.
pub(super) fn root_of_precision(mut precision: DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let n = precision.nrows();
    if n == 0 {
        return Ok(precision);
    }
    let scale: Vec<f64> = precision
        .diagonal()
        .iter()
        .map(|p| p.max(0.0).sqrt())
        .collect();
    let unscaled = |s: f64| if s > 0.0 { s } else { 1.0 };
    for i in 0..n {
        for j in 0..n {
            precision[(i, j)] /= unscaled(scale[i]) * unscaled(scale[j]);
        }
    }
    let eigen = precision.symmetric_eigen();
    let limit = PRIOR_TOLERANCE * eigen.eigenvalues.amax();
    let mut rows = Vec::new();
    for (i, &value) in eigen.eigenvalues.iter().enumerate() {
        if value < -limit {
            return Err(Error::OutOfRange {
                what: "an eigenvalue of prior_precision (parameters scaled to 1)".into(),
                value,
                range: "not below 0",
            });
        }
        if value > limit {
            let mut row = eigen.eigenvectors.column(i).transpose() * value.sqrt();
            for (entry, s) in row.iter_mut().zip(&scale) {
                *entry *= unscaled(*s);
            }
            rows.push(row);
        }
    }
    if rows.is_empty() {
        return Ok(DMatrix::zeros(0, n));
    }
    Ok(DMatrix::from_rows(&rows))
}

/// Refuses empty names and names that come twice.
pub(super) fn check_names(names: &[String], place: &'static str) -> Result<(), Error> {
    let mut seen = BTreeSet::new();
    for name in names {
        let problem = if name.is_empty() {
            "is empty"
        } else if !seen.insert(name) {
            "comes twice"
        } else {
            continue;
        };
        return Err(Error::BadName {
            name: name.clone(),
            place,
            problem,
        });
    }
    Ok(())
}

/// Refuses a wrong length.
pub(super) fn check_length(
    what: &str,
    found: usize,
    expected: usize,
    reason: &str,
) -> Result<(), Error> {
    if found == expected {
        return Ok(());
    }
    Err(Error::WrongLength {
        what: what.to_owned(),
        found,
        expected,
        reason: reason.to_owned(),
    })
}

pub(super) fn check_finite(value: f64, what: impl Fn() -> String) -> Result<(), Error> {
    if value.abs() <= MOST {
        return Ok(());
    }
    Err(Error::OutOfRange {
        what: what(),
        value,
        range: "a number of a size of 1e100 at most, so that its square is one too",
    })
}

/// Refuses what is not finite and above 0.
pub(super) fn check_positive(value: f64, what: &str) -> Result<(), Error> {
    if value > 0.0 && value <= MOST {
        return Ok(());
    }
    Err(Error::OutOfRange {
        what: what.to_owned(),
        value,
        range: "above 0, and 1e100 at most",
    })
}
