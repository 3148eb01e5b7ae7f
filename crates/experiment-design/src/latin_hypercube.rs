//! Latin hypercube samples.

use probability::random_stream::Stream;

use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Random samples among which the one with the greatest least distance is kept.
const TRIES: usize = 50;

/// Number of consecutive failed exchanges that ends the search.
const EXCHANGES: usize = 200;

/// Latin hypercube of `n_runs` runs: each of the n equal slices of every factor holds one run.
///
/// Of 50 random samples the one whose two closest runs are farthest apart is kept; exchanges of
/// values between runs then move its closest runs apart (maximin, up to 300 runs).
///
/// # Source
/// `[Mckay1979]`; choice by least distance: `[Johnson1990]`; criterion of
/// the exchange: `[MorrisMitchell1995]`.
///
/// # Errors
/// [`Error::CountOutOfRange`] outside 2 to 2000 runs; those of [`check_factors`].
pub fn latin_hypercube(factors: &[Factor], n_runs: usize, seed: u64) -> Result<Design, Error> {
    check_factors(factors)?;
    if !(2..=2000).contains(&n_runs) {
        return Err(Error::CountOutOfRange {
            what: "runs of the Latin hypercube",
            given: n_runs,
            least: 2,
            most: 2000,
        });
    }
    let mut stream = Stream::new(seed, "latin hypercube");
    let mut best = sample(&mut stream, factors.len(), n_runs);
    let mut widest = least_distance_squared(&best);
    // The search costs n^2 per try; large samples fill the box well enough without it.
    let tries = if n_runs <= 300 { TRIES } else { 1 };
    for _ in 1..tries {
        let rows = sample(&mut stream, factors.len(), n_runs);
        let distance = least_distance_squared(&rows);
        if distance > widest {
            (best, widest) = (rows, distance);
        }
    }
    if n_runs <= 300 {
        improve(&mut best, &mut stream);
    }
    Design::new(DesignKind::LatinHypercube, factors, Vec::new(), best)
}

/// Exchanges the values of one factor between a run of the closest pair and another run as long as
/// that moves the closest runs apart; each slice keeps its one run.
fn improve(rows: &mut [Vec<f64>], stream: &mut Stream) {
    let (n, k) = (rows.len(), rows[0].len());
    let mut criterion = crowding(rows);
    let mut failures = 0;
    while failures < EXCHANGES {
        let (i, _) = closest(rows);
        let (other, j) = (stream.below(n), stream.below(k));
        if other == i {
            failures += 1;
            continue;
        }
        let swap = |rows: &mut [Vec<f64>]| {
            let kept = rows[i][j];
            rows[i][j] = rows[other][j];
            rows[other][j] = kept;
        };
        swap(rows);
        let reached = crowding(rows);
        if reached < criterion {
            criterion = reached;
            failures = 0;
        } else {
            swap(rows);
            failures += 1;
        }
    }
}

/// The least distance and, among equals, fewer pairs at it: the sum of d^-30.
fn crowding(rows: &[Vec<f64>]) -> f64 {
    pairs(rows).map(|(_, _, squared)| squared.powi(-15)).sum()
}

/// The closest pair of rows.
fn closest(rows: &[Vec<f64>]) -> (usize, usize) {
    let pair = pairs(rows).min_by(|a, b| a.2.total_cmp(&b.2));
    pair.map_or((0, 0), |(i, j, _)| (i, j))
}

/// All pairs of rows with their squared distance, coded units.
fn pairs(rows: &[Vec<f64>]) -> impl Iterator<Item = (usize, usize, f64)> {
    (0..rows.len()).flat_map(move |i| {
        (0..i).map(move |j| {
            let gaps = rows[i].iter().zip(&rows[j]).map(|(x, y)| (x - y) * (x - y));
            (i, j, gaps.sum())
        })
    })
}

/// One random Latin hypercube in coded variables.
fn sample(stream: &mut Stream, k: usize, n: usize) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; k]; n];
    for j in 0..k {
        let mut slices: Vec<usize> = (0..n).collect();
        stream.shuffle(&mut slices);
        for (row, slice) in rows.iter_mut().zip(slices) {
            row[j] = 2.0 * (slice as f64 + stream.uniform()) / n as f64 - 1.0;
        }
    }
    rows
}

/// Square of the distance of the two closest rows, coded units.
fn least_distance_squared(rows: &[Vec<f64>]) -> f64 {
    pairs(rows).fold(f64::INFINITY, |least, (_, _, squared)| least.min(squared))
}

#[cfg(test)]
mod tests {
    use super::{latin_hypercube, least_distance_squared, sample};
    use crate::Factor;
    use probability::random_stream::Stream;

    fn factors() -> Vec<Factor> {
        ["A", "B", "C"]
            .iter()
            .map(|s| Factor::coded_only(s).unwrap())
            .collect()
    }

    #[test]
    fn every_slice_of_every_factor_holds_exactly_one_run() {
        let n = 17;
        let rows = latin_hypercube(&factors(), n, 4).unwrap().coded_rows();
        for j in 0..3 {
            let slices = rows
                .iter()
                .map(|r| ((r[j] + 1.0) * (n as f64 / 2.0)).floor());
            let mut slices: Vec<f64> = slices.collect();
            slices.sort_by(f64::total_cmp);
            assert_eq!(
                slices,
                (0..n).map(|i| i as f64).collect::<Vec<_>>(),
                "factor {j}"
            );
        }
    }

    #[test]
    fn the_kept_sample_is_wider_than_the_first_and_depends_on_the_seed() {
        let kept = latin_hypercube(&factors(), 20, 9).unwrap();
        let first = sample(&mut Stream::new(9, "latin hypercube"), 3, 20);
        // The exchanges alone widen the best of 50 samples by a fifth or more here.
        let gain = least_distance_squared(&kept.coded_rows()) / least_distance_squared(&first);
        assert!(gain > 1.44, "squared distance grew by {gain}");
        assert_eq!(kept, latin_hypercube(&factors(), 20, 9).unwrap());
        assert_ne!(kept, latin_hypercube(&factors(), 20, 10).unwrap());
        assert!(latin_hypercube(&factors(), 1, 9).is_err());
    }
}
