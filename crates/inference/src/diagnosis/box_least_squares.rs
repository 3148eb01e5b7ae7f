//! Least squares inside a box.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::space::Space;

/// A slope of the sum of squares, over the lengths of its column and of the residual, below which it counts as 0.
const FLAT: f64 = 1e-10;

/// Where a sum of squares is least inside a box.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub(crate) coefficients: DVector<f64>,
    /// Whether each is free; the others are held at a bound.
    pub(crate) free: Vec<bool>,
    /// The space of the free columns.
    pub(crate) space: Space,
    pub(crate) remaining: DVector<f64>,
}

/// The x in a box for which `|target - matrix x|²` is least; 0 lies inside the box. Where several are, the one to which the
/// shortest way leads. Bounds may be infinite.
///
/// # Panics
/// Where the numbers of rows or of bounds do not fit the matrix.
pub fn least_squares_step(
    matrix: &DMatrix<f64>,
    target: &DVector<f64>,
    low: &[f64],
    high: &[f64],
) -> DVector<f64> {
    least_squares_in_box(matrix, target, low, high).coefficients
}

/// Makes `|target - matrix x|²` least with `low <= x <= high`; 0 lies inside the box. Bounds may be infinite.
///
/// # Formula
///
/// The active set method of `[StarkParker1995]`: from x = 0, go towards the least squares solution of the free
/// coefficients until the first meets a bound, hold it there, and continue; then free the held one whose slope points most
/// into the box, until none does. Without a bound in the way the first step is the plain solution.
pub(crate) fn least_squares_in_box(
    matrix: &DMatrix<f64>,
    target: &DVector<f64>,
    low: &[f64],
    high: &[f64],
) -> Solution {
    let n = matrix.ncols();
    let mut x = DVector::zeros(n);
    // A coefficient whose bound is 0 begins there: the slope frees it where that helps.
    let mut free: Vec<bool> = (0..n).map(|j| low[j] < 0.0 && high[j] > 0.0).collect();
    // Each round lowers the sum of squares or ends; the number is a guard against rounding alone.
    for _ in 0..=(20 * n) {
        let space = descend(matrix, target, (low, high), &mut x, &mut free);
        let remaining = target - matrix * &x;
        let size = remaining.norm();
        let into_box = |j: usize| {
            let column = matrix.column(j);
            let slope = column.dot(&remaining) / (column.norm() * size).max(f64::MIN_POSITIVE);
            let may_rise = x[j] < high[j] && slope > FLAT;
            let may_fall = x[j] > low[j] && slope < -FLAT;
            (may_rise || may_fall).then_some((j, slope.abs()))
        };
        let held = (0..n).filter(|&j| !free[j]);
        match held.filter_map(into_box).max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((j, _)) => free[j] = true,
            None => return finished(x, free, space, &remaining),
        }
    }
    let space = Space::of(&columns(matrix, &free));
    let remaining = target - matrix * &x;
    finished(x, free, space, &remaining)
}

/// Goes to the least squares solution of the free coefficients, which are held where they meet a bound on the way.
fn descend(
    matrix: &DMatrix<f64>,
    target: &DVector<f64>,
    (low, high): (&[f64], &[f64]),
    x: &mut DVector<f64>,
    free: &mut [bool],
) -> Space {
    loop {
        let space = Space::of(&columns(matrix, free));
        let mut held = x.clone();
        for j in (0..free.len()).filter(|&j| free[j]) {
            held[j] = 0.0;
        }
        let own = space.coefficients(&(target - matrix * held));
        let indices: Vec<usize> = (0..free.len()).filter(|&j| free[j]).collect();
        // The share of the way after which the first free coefficient leaves the box.
        let first = indices
            .iter()
            .zip(own.iter())
            .filter_map(|(&j, &to)| {
                let bound = to.clamp(low[j], high[j]);
                (bound != to).then(|| (j, bound, (bound - x[j]) / (to - x[j])))
            })
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let share = first.map_or(1.0, |(_, _, share)| share.max(0.0));
        for (&j, &to) in indices.iter().zip(own.iter()) {
            x[j] = if share < 1.0 {
                (x[j] + share * (to - x[j])).clamp(low[j], high[j])
            } else {
                to
            };
        }
        let Some((j, bound, _)) = first else {
            return space;
        };
        x[j] = bound;
        free[j] = false;
    }
}

fn columns(matrix: &DMatrix<f64>, free: &[bool]) -> DMatrix<f64> {
    let kept: Vec<usize> = (0..free.len()).filter(|&j| free[j]).collect();
    matrix.select_columns(&kept)
}

/// Puts a solution together; what remains is projected off the free columns once more, against rounding.
fn finished(x: DVector<f64>, free: Vec<bool>, space: Space, remaining: &DVector<f64>) -> Solution {
    Solution {
        remaining: space.outside(remaining),
        coefficients: x,
        free,
        space,
    }
}

#[cfg(test)]
mod tests {
    use super::least_squares_in_box;
    use nalgebra::{DMatrix, DVector, dmatrix, dvector};
    use probability::random_stream::Stream;

    /// With x2 <= 0.2 the best x1 of these rows solves 2 x1 = 0.3 + 0.6, so x1 = 0.45.
    #[test]
    fn a_coefficient_is_held_at_its_bound() {
        let matrix = dmatrix![1.0, 0.0; 0.0, 2.0; 1.0, 1.0];
        let target = dvector![0.3, 1.0, 0.8];
        let inside = f64::INFINITY;
        let solution = least_squares_in_box(&matrix, &target, &[-inside; 2], &[inside, 0.2]);
        assert!((solution.coefficients[0] - 0.45).abs() < 1e-14);
        assert_eq!(solution.coefficients[1], 0.2);
        assert_eq!(solution.free, [true, false]);
    }

    /// The conditions of Karush, Kuhn and Tucker hold in 2000 random boxes, bounds at 0 and two equal columns included:
    /// what remains is normal to free columns and points out of the box along held ones. Rounding only.
    #[test]
    fn no_way_inside_the_box_lowers_the_sum_of_squares() {
        let mut stream = Stream::new(1, "boxes");
        for _ in 0..2000 {
            let n = 1 + stream.below(6);
            let mut matrix = DMatrix::from_fn(9, n, |_, _| stream.normal());
            if n > 2 && stream.below(4) == 0 {
                let copy = matrix.column(0).into_owned();
                matrix.set_column(1, &copy);
            }
            let target = DVector::from_fn(9, |_, _| 3.0 * stream.normal());
            let mut bound = |scale: f64| match stream.below(3) {
                0 => 0.0,
                1 => scale * stream.uniform(),
                _ => scale * f64::INFINITY,
            };
            let low: Vec<f64> = (0..n).map(|_| bound(-1.0)).collect();
            let high: Vec<f64> = (0..n).map(|_| bound(1.0)).collect();
            let solution = least_squares_in_box(&matrix, &target, &low, &high);
            let rest = &target - &matrix * &solution.coefficients;
            for j in 0..n {
                let (x, slope) = (solution.coefficients[j], matrix.column(j).dot(&rest));
                assert!((low[j]..=high[j]).contains(&x));
                let out = (x < high[j] && slope > 1e-8) || (x > low[j] && slope < -1e-8);
                assert!(!out, "{x} in {}..{}, slope {slope}", low[j], high[j]);
            }
        }
    }
}
