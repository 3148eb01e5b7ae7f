//! Conference matrices, from which definitive screening designs are made.

/// A conference matrix of order `n`: zeros on the diagonal, +-1 elsewhere, `C'C = (n - 1) I`. `None` for other
/// orders than 4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 26, 28, 30 and 32 (order 22 does not exist).
///
/// # Source
/// Orders q + 1 for a field of q elements: `[Paley1933]`; 16: doubling of the skew matrix of order 8, `[Xiao2012]`.
pub(crate) fn conference_matrix(n: usize) -> Option<Vec<Vec<f64>>> {
    let (prime, degree) = match n {
        4 | 6 | 8 | 12 | 14 | 18 | 20 | 24 | 30 | 32 => (n - 1, 1),
        10 => (3, 2),
        26 => (5, 2),
        28 => (3, 3),
        16 => return conference_matrix(8).map(|half| doubled(&half)),
        _ => return None,
    };
    Some(bordered(&Field { prime, degree }))
}

/// A finite field of `prime^degree` elements, which are numbered by their digits in base `prime`: polynomials in t.
struct Field {
    /// Its characteristic.
    prime: usize,
    /// Degree over the field of `prime` elements, 1 to 3.
    degree: usize,
}

impl Field {
    /// Number of elements.
    fn size(&self) -> usize {
        (0..self.degree).fold(1, |size, _| size * self.prime)
    }

    /// The coefficients of an element.
    fn digits(&self, element: usize) -> Vec<usize> {
        let mut rest = element;
        let mut digit = || {
            let digit = rest % self.prime;
            rest /= self.prime;
            digit
        };
        (0..self.degree).map(|_| digit()).collect()
    }

    /// The element of given coefficients.
    fn element(&self, digits: &[usize]) -> usize {
        let digits = digits.iter().rev();
        digits.fold(0, |sum, digit| sum * self.prime + digit % self.prime)
    }

    /// t^degree in lower powers: t^2 = 2 over 3 and 5 elements, which have no root of 2; t^3 = t + 1 over 3,
    /// as t^3 - t is 0 at each of them.
    fn reduction(&self) -> &'static [usize] {
        match self.degree {
            2 => &[2, 0],
            _ => &[1, 1, 0],
        }
    }

    /// Product of two elements.
    fn product(&self, a: usize, b: usize) -> usize {
        let (a, b) = (self.digits(a), self.digits(b));
        let mut sums = vec![0; 2 * self.degree - 1];
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                sums[i + j] += x * y;
            }
        }
        for power in (self.degree..sums.len()).rev() {
            let high = sums[power] % self.prime;
            for (lower, by) in self.reduction().iter().enumerate() {
                sums[power - self.degree + lower] += by * high;
            }
        }
        self.element(&sums[..self.degree])
    }

    /// Difference of two elements.
    fn difference(&self, a: usize, b: usize) -> usize {
        let pairs = self.digits(a).into_iter().zip(self.digits(b));
        let digits: Vec<usize> = pairs.map(|(a, b)| a + self.prime - b).collect();
        self.element(&digits)
    }
}

/// The quadratic characters of the differences of the elements, with a border of ones; the border's sign makes the columns
/// orthogonal, whether -1 is a square (symmetric) or not (skew).
fn bordered(field: &Field) -> Vec<Vec<f64>> {
    let q = field.size();
    let squares: Vec<usize> = (1..q).map(|x| field.product(x, x)).collect();
    let character = |x: usize| match x {
        0 => 0.0,
        x if squares.contains(&x) => 1.0,
        _ => -1.0,
    };
    let minus = character(field.difference(0, 1));
    let first: Vec<f64> = std::iter::once(0.0)
        .chain(std::iter::repeat_n(1.0, q))
        .collect();
    let line = |i: usize| -> Vec<f64> {
        let characters = (0..q).map(|j| character(field.difference(i, j)));
        std::iter::once(minus).chain(characters).collect()
    };
    std::iter::once(first).chain((0..q).map(line)).collect()
}

/// Twice the order: `[[C, C + I], [C - I, -C]]` of a skew C, which is skew again.
fn doubled(half: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = half.len();
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let upper = |i: usize| {
        let right = (0..n).map(move |j| half[i][j] + unit(i, j));
        half[i].iter().copied().chain(right).collect()
    };
    let lower = |i: usize| {
        let left = (0..n).map(|j| half[i][j] - unit(i, j));
        left.chain(half[i].iter().map(|x| -x)).collect()
    };
    (0..n).map(upper).chain((0..n).map(lower)).collect()
}

#[cfg(test)]
mod tests {
    use super::conference_matrix;

    /// Checks the definition; whole numbers make it exact.
    #[test]
    fn columns_are_orthogonal_with_zeros_on_the_diagonal_alone() {
        let offered: Vec<usize> = (1..=40)
            .filter(|n| conference_matrix(*n).is_some())
            .collect();
        assert_eq!(
            offered,
            [4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 26, 28, 30, 32]
        );
        for n in offered {
            let rows = conference_matrix(n).unwrap();
            for a in 0..n {
                for b in 0..n {
                    assert_eq!(rows[a][b] == 0.0, a == b, "order {n}");
                    let product: f64 = rows.iter().map(|row| row[a] * row[b]).sum();
                    let expected = if a == b { n as f64 - 1.0 } else { 0.0 };
                    assert_eq!(product, expected, "order {n}, columns {a} and {b}");
                }
            }
        }
    }
}
