//! Weighted linear least squares by Householder reflections.

use crate::Error;

/// A column whose part outside the span of the earlier columns is shorter than this share of its
/// length counts as their combination. Rounding leaves about 1e-15 p; a design with a genuine
/// share of 1e-9 would have variance inflation 1e18 and no digits left. At twice the value no
/// published design changes.
const DEPENDENT: f64 = 1e-9;

/// Result of a least-squares fit of p columns to n observations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeastSquares {
    /// Coefficients, (p).
    pub(crate) coefficients: Vec<f64>,
    /// Inverse of X'WX, (p, p).
    pub(crate) xtx_inverse: Vec<Vec<f64>>,
    /// Sum of squares that each column adds to those before it, (p).
    pub(crate) sequential_ss: Vec<f64>,
    /// Diagonal of the hat matrix, (n).
    pub(crate) leverages: Vec<f64>,
    /// Columns of the upper triangle R of the scaled columns, (p, p).
    pub(crate) triangle: Vec<Vec<f64>>,
    /// The response in the coordinates of R, (p).
    pub(crate) rotated: Vec<f64>,
}

/// Minimises sum w (y - X beta)^2.
///
/// Columns are scaled to unit length, then reduced from left to right by Householder reflections
/// of the rows times sqrt(w); X'WX is never formed.
///
/// # Source
/// `[Golub2013, algorithm 5.2.1]`.
///
/// # Errors
/// [`Error::AliasedTerms`] with the relation of every dependent column to those before it.
pub(crate) fn least_squares(
    rows: &[Vec<f64>],
    names: &[String],
    response: &[f64],
    weights: &[f64],
) -> Result<LeastSquares, Error> {
    let p = names.len();
    let roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let column =
        |j: usize| -> Vec<f64> { rows.iter().zip(&roots).map(|(r, w)| r[j] * w).collect() };
    let mut columns: Vec<Vec<f64>> = (0..p).map(column).collect();
    let scales: Vec<f64> = columns.iter().map(|c| norm(c)).collect();
    for (column, &scale) in columns.iter_mut().zip(&scales) {
        if scale > 0.0 {
            for x in column {
                *x /= scale;
            }
        }
    }
    let mut target: Vec<f64> = response.iter().zip(&roots).map(|(y, w)| y * w).collect();
    let reflections = triangularise(&mut columns, &mut target, &scales, names)?;
    let inverse = invert_upper(&columns);
    let scaled = |i: usize, j: usize| -> f64 {
        let dot: f64 = (i.max(j)..p).map(|k| inverse[i][k] * inverse[j][k]).sum();
        dot / (scales[i] * scales[j])
    };
    let solve = |target: &[f64]| -> Vec<f64> {
        let entry = |i: usize| -> f64 { (i..p).map(|k| inverse[i][k] * target[k]).sum() };
        (0..p).map(|i| entry(i) / scales[i]).collect()
    };
    let mut coefficients = solve(&target);
    // One step of refinement on the residuals removes the rounding of the reflections.
    let mut rest: Vec<f64> = (0..rows.len())
        .map(|i| {
            let fitted: f64 = rows[i].iter().zip(&coefficients).map(|(x, c)| x * c).sum();
            (response[i] - fitted) * roots[i]
        })
        .collect();
    for v in &reflections {
        reflect(&mut rest, v);
    }
    coefficients
        .iter_mut()
        .zip(solve(&rest))
        .for_each(|(c, step)| *c += step);
    Ok(LeastSquares {
        coefficients,
        xtx_inverse: (0..p)
            .map(|i| (0..p).map(|j| scaled(i, j)).collect())
            .collect(),
        sequential_ss: target[..p].iter().map(|z| z * z).collect(),
        leverages: leverages(&reflections, rows.len()),
        triangle: columns.iter().map(|c| c[..p].to_vec()).collect(),
        rotated: target[..p].to_vec(),
    })
}

/// Condition number of the scaled columns; `None` if it is not finite.
pub(crate) fn condition(solved: &LeastSquares) -> Option<f64> {
    let p = solved.triangle.len();
    let triangle =
        nalgebra::DMatrix::from_fn(
            p,
            p,
            |i, j| {
                if i <= j { solved.triangle[j][i] } else { 0.0 }
            },
        );
    let values = triangle.singular_values();
    super::ratio(values.max(), values.min())
}

/// Sum of squares that each of some columns adds to those before it; 0 for all if any depends on those before it.
pub(crate) fn each_adds(mut columns: Vec<Vec<f64>>, mut target: Vec<f64>) -> Vec<f64> {
    let m = columns.len();
    let scales = unit_lengths(&mut columns);
    let names = vec![String::new(); m];
    match triangularise(&mut columns, &mut target, &scales, &names) {
        Ok(_) => target[..m].iter().map(|z| z * z).collect(),
        Err(_) => vec![0.0; m],
    }
}

/// Scales columns to unit length and returns the lengths that they had.
fn unit_lengths(columns: &mut [Vec<f64>]) -> Vec<f64> {
    let scales: Vec<f64> = columns.iter().map(|c| norm(c)).collect();
    for (column, scale) in columns.iter_mut().zip(&scales) {
        for x in column {
            *x /= scale.max(f64::MIN_POSITIVE);
        }
    }
    scales
}

/// Sum of squares that the last of some columns adds to the others; 0 if it depends on them.
pub(crate) fn last_adds(columns: Vec<Vec<f64>>, target: Vec<f64>) -> f64 {
    each_adds(columns, target).pop().unwrap_or(0.0)
}

/// An orthonormal basis built column by column, so that the fits of all leading sets of columns
/// can be read off.
#[derive(Debug)]
pub(crate) struct Basis {
    /// Places of the columns that depend on earlier ones, and their relations to them.
    pub(crate) dependent: Vec<(usize, String)>,
    /// The orthonormal columns of the others, with their places.
    pub(crate) columns: Vec<(usize, Vec<f64>)>,
}

/// Builds the basis of the columns of weighted rows.
pub(crate) fn basis(rows: &[Vec<f64>], names: &[String], weights: &[f64]) -> Basis {
    let roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let column =
        |j: usize| -> Vec<f64> { rows.iter().zip(&roots).map(|(r, w)| r[j] * w).collect() };
    let mut columns: Vec<Vec<f64>> = (0..names.len()).map(column).collect();
    let scales: Vec<f64> = columns.iter().map(|c| norm(c)).collect();
    for (column, scale) in columns.iter_mut().zip(&scales) {
        if *scale > 0.0 {
            for x in column {
                *x /= scale;
            }
        }
    }
    let mut found = Reduction::default();
    reduce(
        &mut columns,
        &mut vec![0.0; rows.len()],
        &scales,
        names,
        &mut found,
    );
    let unit = |place: usize| {
        let mut unit = vec![0.0; rows.len()];
        unit[place] = 1.0;
        let before = found.reflections[..=place].iter().rev();
        before.for_each(|v| reflect(&mut unit, v));
        unit
    };
    let places = found.independent.iter().enumerate();
    Basis {
        columns: places.map(|(place, &j)| (j, unit(place))).collect(),
        dependent: found.dependent,
    }
}

/// What a reduction found.
#[derive(Debug, Default)]
struct Reduction {
    /// The reflections, one per independent column.
    reflections: Vec<Vec<f64>>,
    /// Places of the independent columns.
    independent: Vec<usize>,
    /// Places of the dependent columns with their relations.
    dependent: Vec<(usize, String)>,
}

/// Reduces the columns to upper triangular form, applies the same reflections to the target, and
/// returns the reflection vectors (unit length, zero before their own place).
fn triangularise(
    columns: &mut [Vec<f64>],
    target: &mut [f64],
    scales: &[f64],
    names: &[String],
) -> Result<Vec<Vec<f64>>, Error> {
    let mut found = Reduction::default();
    reduce(columns, target, scales, names, &mut found);
    if found.dependent.is_empty() {
        return Ok(found.reflections);
    }
    let (places, relations): (Vec<usize>, Vec<String>) = found.dependent.into_iter().unzip();
    Err(Error::AliasedTerms {
        terms: places.into_iter().map(|j| names[j].clone()).collect(),
        relations,
    })
}

/// Reduces the columns from left to right and passes over those that depend on earlier ones.
fn reduce(
    columns: &mut [Vec<f64>],
    target: &mut [f64],
    scales: &[f64],
    names: &[String],
    found: &mut Reduction,
) {
    for j in 0..columns.len() {
        let place = found.reflections.len();
        let rest = columns[j].get(place..).map_or(0.0, norm);
        if scales[j] == 0.0 || rest < DEPENDENT {
            let relation = relation(columns, &found.independent, j, scales, names);
            found.dependent.push((j, relation));
            continue;
        }
        let mut v = vec![0.0; target.len()];
        v[place..].copy_from_slice(&columns[j][place..]);
        v[place] += rest.copysign(v[place]);
        let length = norm(&v);
        for x in &mut v {
            *x /= length;
        }
        columns[j..]
            .iter_mut()
            .for_each(|column| reflect(column, &v));
        reflect(target, &v);
        found.reflections.push(v);
        found.independent.push(j);
    }
}

/// Spells how column j is made of the independent columns before it.
fn relation(
    columns: &[Vec<f64>],
    independent: &[usize],
    j: usize,
    scales: &[f64],
    names: &[String],
) -> String {
    let m = independent.len();
    let mut parts = vec![0.0; m];
    for i in (0..m).rev() {
        let later: f64 = (i + 1..m)
            .map(|k| columns[independent[k]][i] * parts[k])
            .sum();
        parts[i] = (columns[j][i] - later) / columns[independent[i]][i];
    }
    let mut text = format!("{} =", names[j]);
    let mut nothing = true;
    for (&i, part) in independent.iter().zip(parts) {
        let amount = part * scales[j] / scales[i];
        if part.abs() > 1e-8 {
            let sign = match (nothing, amount < 0.0) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => "+ ",
                (false, true) => "- ",
            };
            let size = format!("{:.4}", amount.abs());
            let size = size.trim_end_matches('0').trim_end_matches('.');
            let product = match (size, names[i].as_str()) {
                ("1", name) => name.to_owned(),
                (size, "1") => size.to_owned(),
                (size, name) => format!("{size} {name}"),
            };
            text += &[" ", sign, &product].concat();
            nothing = false;
        }
    }
    if nothing {
        text.push_str(" 0");
    }
    text
}

/// Inverse of the upper triangle held in the leading rows of the columns, (p, p).
fn invert_upper(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let p = columns.len();
    let mut inverse = vec![vec![0.0; p]; p];
    for k in 0..p {
        inverse[k][k] = 1.0 / columns[k][k];
        for i in (0..k).rev() {
            let sum: f64 = (i + 1..=k).map(|m| columns[m][i] * inverse[m][k]).sum();
            inverse[i][k] = -sum / columns[i][i];
        }
    }
    inverse
}

/// Squared row lengths of the thin orthogonal factor, built backwards from the reflections.
fn leverages(reflections: &[Vec<f64>], n: usize) -> Vec<f64> {
    let mut sums = vec![0.0; n];
    for j in 0..reflections.len() {
        let mut unit = vec![0.0; n];
        unit[j] = 1.0;
        reflections[..=j]
            .iter()
            .rev()
            .for_each(|v| reflect(&mut unit, v));
        sums.iter_mut()
            .zip(&unit)
            .for_each(|(sum, q)| *sum += q * q);
    }
    sums
}

/// Mirrors x at the plane normal to the unit vector v.
fn reflect(x: &mut [f64], v: &[f64]) {
    let twice = 2.0 * x.iter().zip(v).map(|(a, b)| a * b).sum::<f64>();
    x.iter_mut().zip(v).for_each(|(a, b)| *a -= twice * b);
}

/// Euclidean length.
fn norm(x: &[f64]) -> f64 {
    x.iter().map(|a| a * a).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::least_squares;
    use crate::Error;

    fn names(n: usize) -> Vec<String> {
        (0..n).map(|i| format!("x{i}")).collect()
    }

    /// A polynomial of degree 5 over 21 whole numbers has condition 3e7 (normal equations would
    /// lose 14 digits); the response is exact, so the error is rounding times condition, 1e-8.
    #[test]
    fn ill_conditioned_polynomial_is_recovered() {
        let rows: Vec<Vec<f64>> = (0..21)
            .map(|i| (0..6).map(|j| f64::from(i).powi(j)).collect())
            .collect();
        let response: Vec<f64> = rows.iter().map(|r| r.iter().sum()).collect();
        let fit = least_squares(&rows, &names(6), &response, &[1.0; 21]).unwrap();
        for (i, c) in fit.coefficients.iter().enumerate() {
            assert!((c - 1.0).abs() < 1e-8, "coefficient {i} is {c}");
        }
        let sum: f64 = fit.leverages.iter().sum();
        assert!(
            (sum - 6.0).abs() < 1e-12,
            "leverages sum to {sum}, not to the number of columns"
        );
    }

    #[test]
    fn dependent_columns_are_named_with_their_relation() {
        let rows: Vec<Vec<f64>> = (0..5)
            .map(f64::from)
            .map(|x| vec![1.0, x, 3.0 - 2.0 * x, 0.0])
            .collect();
        let error = least_squares(&rows, &names(4), &[1.0; 5], &[1.0; 5]).unwrap_err();
        let Error::AliasedTerms { terms, relations } = error else {
            panic!("wrong error {error}");
        };
        assert_eq!(terms, ["x2", "x3"]);
        assert_eq!(relations, ["x2 = 3 x0 - 2 x1", "x3 = 0"]);
    }

    /// A weight of 3 does what three equal rows do (rounding: 1e-13).
    #[test]
    fn whole_weights_act_as_repeated_rows() {
        let rows = vec![vec![1.0, 0.0], vec![1.0, 1.0], vec![1.0, 3.0]];
        let y = [1.0, 4.0, 5.0];
        let weighted = least_squares(&rows, &names(2), &y, &[1.0, 3.0, 1.0]).unwrap();
        let repeated: Vec<Vec<f64>> = [0, 1, 1, 1, 2].iter().map(|&i| rows[i].clone()).collect();
        let plain =
            least_squares(&repeated, &names(2), &[1.0, 4.0, 4.0, 4.0, 5.0], &[1.0; 5]).unwrap();
        for (a, b) in weighted.coefficients.iter().zip(&plain.coefficients) {
            assert!((a - b).abs() < 1e-13, "{a} against {b}");
        }
    }
}
