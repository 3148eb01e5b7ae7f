//! How observables that are read from the same frames go together.

use crate::{Error, summarise};

/// Correlations of the means of several series that were read from the same frames, shrunk towards none.
///
/// Columns are observables, each with one value a frame, in time order; the matrix has their order and a diagonal of 1. It is
/// always positive definite. The means are taken to be correlated as the values are, which holds where all observables forget
/// their past alike.
///
/// # Formula
///
/// `r* = (1 - l) r` for each pair, with the sample correlations r and `l = sum var(r) / sum r^2` over all pairs, at least 1 / n
/// and at most 1; `var(r) = (1 - r^2)^2 / (n - 1)`, n the least effective number of frames of the columns. A column without
/// scatter is correlated with none.
///
/// # Source
///
/// `[SchaeferStrimmer2005, table 1]` for the share; the variance of r is that of normal values. The least share is ours:
/// without it two columns that are the same would have a matrix that is not positive definite.
///
/// # Errors
///
/// [`Error::TooFewPoints`] and [`Error::NotFinite`] as [`summarise`]; [`Error::UnequalColumns`].
pub fn shrunk_correlations(columns: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, Error> {
    let p = columns.len();
    let mut matrix = vec![vec![0.0; p]; p];
    let mut n = f64::INFINITY;
    let mut whitened: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        if column.len() != columns[0].len() {
            return Err(Error::UnequalColumns {
                first: columns[0].len(),
                other: column.len(),
            });
        }
        let series = summarise(column)?;
        n = n.min(series.n_effective);
        let root = (series.sd * series.sd * (series.n as f64 - 1.0)).sqrt();
        let scaled = |v: &f64| {
            if root > 0.0 {
                (v - series.mean) / root
            } else {
                0.0
            }
        };
        whitened.push(column.iter().map(scaled).collect());
    }
    let (mut variance, mut square) = (0.0, 0.0);
    for i in 0..p {
        matrix[i][i] = 1.0;
        for j in 0..i {
            let pairs = whitened[i].iter().zip(&whitened[j]);
            let r = pairs.map(|(a, b)| a * b).sum::<f64>().clamp(-1.0, 1.0);
            (matrix[i][j], matrix[j][i]) = (r, r);
            variance += (1.0 - r * r).powi(2) / (n - 1.0);
            square += r * r;
        }
    }
    // Where one value is effectively all there is, nothing is known of how they go together.
    let share = if n > 1.0 && square > 0.0 {
        (variance / square).clamp(1.0 / n, 1.0)
    } else {
        1.0
    };
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, r) in row.iter_mut().enumerate() {
            if i != j {
                *r *= 1.0 - share;
            }
        }
    }
    Ok(matrix)
}

#[cfg(test)]
mod tests {
    use super::shrunk_correlations;
    use nalgebra::DMatrix;
    use random_stream::Stream;

    /// Columns of n normal values of which the first two have the correlation r, and the rest none.
    fn columns(seed: u64, n: usize, p: usize, r: f64) -> Vec<Vec<f64>> {
        let mut stream = Stream::new(seed, "columns");
        let mut all: Vec<Vec<f64>> = (0..p)
            .map(|_| (0..n).map(|_| stream.normal()).collect())
            .collect();
        for k in 0..n {
            all[1][k] = r * all[0][k] + (1.0 - r * r).sqrt() * all[1][k];
        }
        all
    }

    /// Many frames: the correlation of 0.6 comes back, with an error of (1 - r^2) / sqrt(n) = 0.014, times 4; the shrinkage
    /// takes 1 %.
    #[test]
    fn many_frames_tell_the_correlation() {
        let found = shrunk_correlations(&columns(1, 2000, 3, 0.6)).unwrap();
        assert!((found[0][1] - 0.6).abs() < 0.06, "{found:?}");
        assert!(found[0][2].abs() < 0.06, "{found:?}");
        assert_eq!(found[0][1], found[1][0]);
    }

    /// Seven columns of five frames, and two columns that are the same: the least eigenvalue is above 0. With two
    /// frames the correlations are 1 or -1 and say nothing: they are at most half of it.
    #[test]
    fn the_matrix_is_positive_definite_for_any_number_of_frames() {
        for seed in 0..50 {
            for n in [2, 3, 5, 8, 40] {
                let mut all = columns(seed, n, 7, 0.9);
                all[6] = all[0].clone();
                let found = shrunk_correlations(&all).unwrap();
                let matrix = DMatrix::from_fn(7, 7, |i, j| found[i][j]);
                let least = matrix.clone().symmetric_eigenvalues().min();
                assert!(least > 1e-3, "{least} with {n} frames: {matrix}");
                let most = found[0][6].abs();
                assert!(
                    most <= 1.0 - 1.0 / n as f64 + 1e-12,
                    "{most} with {n} frames"
                );
            }
        }
    }

    /// On average over many small samples, the error about the true matrix is less than that without shrinkage.
    #[test]
    fn shrinkage_lowers_the_error_of_few_frames() {
        let (mut shrunk, mut plain) = (0.0, 0.0);
        for seed in 0..300 {
            let all = columns(seed, 8, 5, 0.5);
            let found = shrunk_correlations(&all).unwrap();
            let centred = |c: &Vec<f64>| {
                let mean = c.iter().sum::<f64>() / 8.0;
                let about: Vec<f64> = c.iter().map(|v| v - mean).collect();
                let root = about.iter().map(|v| v * v).sum::<f64>().sqrt();
                about.iter().map(|v| v / root).collect::<Vec<_>>()
            };
            for i in 0..5 {
                for j in 0..i {
                    let truth = if (i, j) == (1, 0) { 0.5 } else { 0.0 };
                    let (a, b) = (centred(&all[i]), centred(&all[j]));
                    let r: f64 = a.iter().zip(&b).map(|(x, y)| x * y).sum();
                    shrunk += (found[i][j] - truth).powi(2);
                    plain += (r - truth).powi(2);
                }
            }
        }
        assert!(shrunk < 0.5 * plain, "{shrunk} against {plain}");
    }

    #[test]
    fn columns_of_other_lengths_or_without_scatter_are_met() {
        assert!(shrunk_correlations(&[vec![1.0, 2.0], vec![1.0]]).is_err());
        assert!(shrunk_correlations(&[vec![1.0, f64::NAN]]).is_err());
        assert!(shrunk_correlations(&[]).unwrap().is_empty());
        let level = shrunk_correlations(&[vec![1.0, 1.0, 1.0], vec![1.0, 2.0, 3.0]]).unwrap();
        assert_eq!(level, [[1.0, 0.0], [0.0, 1.0]]);
    }
}
