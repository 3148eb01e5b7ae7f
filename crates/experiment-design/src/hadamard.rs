//! Orthogonal two-level columns.

/// Columns of a saturated orthogonal two-level design of `n_runs` runs, row by row, (n, n - 1); the
/// last row is all minus. `None` for other numbers of runs than the multiples of
/// four from 12 to 48.
///
/// # Source
/// 12, 20, 24, 44, 48: cyclic by quadratic residues `[Plackett1946]`; 28: the same over the field
/// of 27 elements `[Paley1933]`; 36: cyclic by the residues of 5 and 7 `[Plackett1946]`; 16, 32,
/// 40: doubling `[Plackett1946]`.
pub(crate) fn saturated_rows(n_runs: usize) -> Option<Vec<Vec<f64>>> {
    match n_runs {
        8 => Some(doubled(&[
            vec![1.0, 1.0, 1.0],
            vec![-1.0, 1.0, -1.0],
            vec![1.0, -1.0, -1.0],
            vec![-1.0, -1.0, 1.0],
        ])),
        12 | 20 | 24 | 44 | 48 => Some(cyclic(&residue_row(n_runs - 1))),
        28 => Some(from_field_of_27()),
        36 => Some(cyclic(&twin_prime_row())),
        16 | 32 | 40 => saturated_rows(n_runs / 2).map(|half| doubled(&half)),
        _ => None,
    }
}

/// A first row and its shifts to the right, then a row of minus.
fn cyclic(first: &[f64]) -> Vec<Vec<f64>> {
    let m = first.len();
    let shifted = |shift: usize| (0..m).map(|j| first[(j + m - shift) % m]).collect();
    (0..m).map(shifted).chain([vec![-1.0; m]]).collect()
}

/// Plus at 0 and at the squares modulo a prime.
fn residue_row(prime: usize) -> Vec<f64> {
    let mut row = vec![-1.0; prime];
    for i in 0..prime {
        row[i * i % prime] = 1.0;
    }
    row
}

/// Plus where the residue characters of 5 and 7 differ, and at multiples of 5 that are not 0.
fn twin_prime_row() -> Vec<f64> {
    let square = |i: usize, prime: usize| (1..prime).any(|j| j * j % prime == i % prime);
    let plus = |i: usize| match (i % 5, i % 7) {
        (_, 0) => false,
        (0, _) => true,
        _ => square(i, 5) != square(i, 7),
    };
    (0..35).map(|i| if plus(i) { 1.0 } else { -1.0 }).collect()
}

/// The elements of the field of 27 elements: polynomials a + b t + c t^2 over 0, 1, 2 with
/// t^3 = t + 2.
type Element = [usize; 3];

/// Product of two elements.
fn product(x: Element, y: Element) -> Element {
    let mut sums = [0; 5];
    for (i, a) in x.into_iter().enumerate() {
        for (j, b) in y.into_iter().enumerate() {
            sums[i + j] += a * b;
        }
    }
    // t^4 = t^2 + 2 t, t^3 = t + 2.
    let [a, b, c, d, e] = sums;
    [(a + 2 * d) % 3, (b + d + 2 * e) % 3, (c + e) % 3]
}

/// Plus where the difference of two elements is zero or a square, then a row of minus.
fn from_field_of_27() -> Vec<Vec<f64>> {
    let element = |i: usize| [i % 3, i / 3 % 3, i / 9];
    let squares: Vec<Element> = (0..27).map(|i| product(element(i), element(i))).collect();
    let entry = |i: usize, j: usize| {
        let (x, y) = (element(i), element(j));
        let difference = [0, 1, 2].map(|d| (y[d] + 3 - x[d]) % 3);
        if squares.contains(&difference) {
            1.0
        } else {
            -1.0
        }
    };
    let row = |i: usize| (0..27).map(|j| entry(i, j)).collect();
    (0..27).map(row).chain([vec![-1.0; 27]]).collect()
}

/// Twice the runs: the columns repeated, their products with a column that is +1 in one half and -1 in the
/// other, and that column.
fn doubled(half: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let side = |sign: f64| {
        half.iter().map(move |row| {
            let mirrored = row.iter().map(|x| sign * x);
            row.iter().copied().chain(mirrored).chain([sign]).collect()
        })
    };
    side(1.0).chain(side(-1.0)).collect()
}
