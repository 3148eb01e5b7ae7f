//! Correlations of observables from the same frames.

use crate::{Error, summarise};

/// Correlations of the means of several series from the same frames, shrunk towards 0.
///
/// Columns are observables, each with one value a frame, in time order; the matrix has their order and a diagonal of 1. It is
/// always positive definite. The means are assumed to have the correlations of the values, which is true if all observables have
/// the same autocorrelation.
///
/// # Formula
///
/// `r* = (1 - l) r` for each pair, with the sample correlations r and `l = sum var(r) / sum r^2` over all pairs, at
/// most 1. `var(r) = 1 / (m - 1)`, that of independent normal values, `m = n / (1 + 2 sum p(k) q(k))` with the
/// correlations p and q of the two columns with themselves over lags k from 1 to n / 4 of n frames; m is at most n,
/// so that l is never less than 1 / (n - 1), and two columns that are the same have a matrix that is positive
/// definite. A column without scatter is correlated with none.
///
/// # Source
///
/// `[SchaeferStrimmer2005, table 1]` for the share, `[Bartlett1935]` for m.
///
/// # Errors
///
/// [`Error::TooFewPoints`] and [`Error::NotFinite`] as [`summarise`]; [`Error::UnequalColumns`].
pub fn shrunk_correlations(columns: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, Error> {
    let p = columns.len();
    let n = columns.first().map_or(0, Vec::len);
    let mut whitened: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        if column.len() != n {
            return Err(Error::UnequalColumns {
                first: n,
                other: column.len(),
            });
        }
        let series = summarise(column)?;
        let root = (series.sd * series.sd * (n as f64 - 1.0)).sqrt();
        let scaled = |v: &f64| {
            if root > 0.0 {
                (v - series.mean) / root
            } else {
                0.0
            }
        };
        whitened.push(column.iter().map(scaled).collect());
    }
    let lags: Vec<Vec<f64>> = whitened.iter().map(|w| own_correlations(w)).collect();
    let mut matrix = vec![vec![0.0; p]; p];
    let (mut variance, mut square) = (0.0, 0.0);
    for i in 0..p {
        matrix[i][i] = 1.0;
        for j in 0..i {
            let r = product(&whitened[i], &whitened[j]).clamp(-1.0, 1.0);
            (matrix[i][j], matrix[j][i]) = (r, r);
            let longer = 1.0 + 2.0 * product(&lags[i], &lags[j]);
            variance += 1.0 / (n as f64 / longer.max(1.0) - 1.0).max(0.0);
            square += r * r;
        }
    }
    let share = if square > 0.0 {
        (variance / square).min(1.0)
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

/// Sum of products.
fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Correlations of a column of squares that add up to 1 with itself, over lags from 1 to a quarter of it.
fn own_correlations(column: &[f64]) -> Vec<f64> {
    let lags = 1..=column.len() / 4;
    lags.map(|lag| product(column, &column[lag..])).collect()
}

#[cfg(test)]
mod tests {
    use super::shrunk_correlations;
    use crate::test_noise::correlated;
    use nalgebra::DMatrix;
    use probability::random_stream::Stream;

    /// Columns of n normal values of which the first two have the correlation r, and the rest none.
    fn columns(seed: u64, n: usize, p: usize, r: f64) -> Vec<Vec<f64>> {
        let mut stream = Stream::new(seed, "columns");
        let mut all: Vec<Vec<f64>> = (0..p)
            .map(|_| (0..n).map(|_| stream.normal()).collect())
            .collect();
        let other = all[0].clone();
        for (value, other) in all[1].iter_mut().zip(other) {
            *value = r * other + (1.0 - r * r).sqrt() * *value;
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

    /// Seven columns of few frames, and two columns that are the same: the least eigenvalue is above 0. Two frames have
    /// correlations of 1 or -1, which say nothing: none is left.
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
                if n == 2 {
                    assert!(found[0][6].abs() < 1e-12, "{matrix}");
                }
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

    /// Two slow series that have nothing to do with each other (0.9 from frame to frame, 40 frames) often look correlated. On
    /// average at least a fifth less is left of it than of the same values in an order that parts neighbours; it was 28 % over
    /// these 300, as lags of a quarter of a short series tell a part of its memory only.
    #[test]
    fn slow_series_tell_less() {
        let (mut left, mut shown) = (0.0, 0.0);
        for seed in 0..300 {
            let mut stream = Stream::new(seed, "slow columns");
            let all = [(); 2].map(|()| correlated(&mut stream, 40, 0.9));
            let found = shrunk_correlations(&all).unwrap()[0][1];
            let swapped: Vec<Vec<f64>> = all.iter().map(|c| shuffled(c)).collect();
            shown += shrunk_correlations(&swapped).unwrap()[0][1].abs();
            left += found.abs();
        }
        assert!(left < 0.8 * shown, "{left} {shown}");
    }

    /// The same values in another order, which parts neighbours: every seventh of forty.
    fn shuffled(column: &[f64]) -> Vec<f64> {
        (0..column.len())
            .map(|k| column[7 * k % column.len()])
            .collect()
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
