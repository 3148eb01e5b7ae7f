//! Box-Behnken designs.

use crate::design::append_centres;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Sets of factors that vary together, the others staying at the centre, for 6 factors
/// `[Box1960]`.
const TRIPLES_6: [[usize; 3]; 6] = [
    [0, 1, 3],
    [1, 2, 4],
    [2, 3, 5],
    [0, 3, 4],
    [1, 4, 5],
    [0, 2, 5],
];
/// The same for 7 factors: a balanced incomplete block design `[Box1960]`.
const TRIPLES_7: [[usize; 3]; 7] = [
    [3, 4, 5],
    [0, 5, 6],
    [1, 4, 6],
    [0, 1, 3],
    [2, 3, 6],
    [0, 2, 4],
    [1, 2, 5],
];

/// Pairs of the first block for 5 factors, twice each factor; the other pairs are the second.
const BLOCK_OF_5: [[usize; 2]; 5] = [[0, 1], [2, 3], [1, 4], [0, 2], [3, 4]];

/// Box-Behnken design for 3 to 7 factors: 12, 24, 40, 48 or 56 runs and `n_centre` centre runs.
///
/// Two (from six factors on: three) factors at a time take all combinations of -1 and +1 while
/// the others stay at 0; the first of them changes fastest, as in the study's Table 5. No run
/// lies at a corner of the box, and all lie within it.
///
/// # Source
/// `[Box1960]`, list of designs.
///
/// # Errors
/// [`Error::FactorCount`] outside 3 to 7 factors; [`Error::CountOutOfRange`] beyond 10 000 centre
/// runs; those of [`check_factors`].
pub fn box_behnken(factors: &[Factor], n_centre: usize) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    let sets: Vec<Vec<usize>> = match k {
        3..=5 => (0..k)
            .flat_map(|i| (i + 1..k).map(move |j| vec![i, j]))
            .collect(),
        6 => TRIPLES_6.iter().map(|set| set.to_vec()).collect(),
        7 => TRIPLES_7.iter().map(|set| set.to_vec()).collect(),
        given => {
            return Err(Error::FactorCount {
                design: "Box-Behnken",
                given,
                least: 3,
                most: 7,
                way_out: "take a central composite design (2 to 8 factors), or screen first and \
                          keep the factors that matter",
            });
        }
    };
    let mut rows: Vec<Vec<f64>> = sets.iter().flat_map(|set| corners(set, k)).collect();
    append_centres(&mut rows, k, n_centre)?;
    Design::new(DesignKind::BoxBehnken, factors, Vec::new(), rows)
}

/// Box-Behnken design in orthogonal blocks, `n_centre` centre runs divided among them: three
/// blocks for 4 factors, two for 5, 6 and 7. Main effects, interactions and squares are free of the
/// differences between blocks.
///
/// # Source
/// `[Box1960]`, list of designs: pairs are divided so that every factor occurs equally often in
/// a block; triples are split by the sign of their product.
///
/// # Errors
/// As [`box_behnken`]; [`Error::FactorCount`] for 3 factors (no orthogonal blocks exist);
/// [`Error::UnequalCentres`] unless each block gets the same number of centre runs.
pub fn box_behnken_in_blocks(factors: &[Factor], n_centre: usize) -> Result<Design, Error> {
    let design = box_behnken(factors, n_centre)?;
    let k = factors.len();
    let n_blocks = match k {
        3 => {
            return Err(Error::FactorCount {
                design: "blocked Box-Behnken",
                given: k,
                least: 4,
                most: 7,
                way_out: "run it in one block, or take a central composite design in blocks",
            });
        }
        4 => 3,
        _ => 2,
    };
    if !n_centre.is_multiple_of(n_blocks) || n_centre == 0 {
        return Err(Error::UnequalCentres {
            given: n_centre,
            blocks: n_blocks,
        });
    }
    let edge = design.runs().len() - n_centre;
    let block = |(i, run): (usize, &crate::Run)| {
        if i >= edge {
            return (i - edge) % n_blocks + 1;
        }
        let moved: Vec<usize> = (0..k).filter(|&j| run.coded[j] != 0.0).collect();
        let sign: f64 = moved.iter().map(|&j| run.coded[j]).product();
        match k {
            // A pair and the pair of the other two factors share a block.
            4 if moved[0] == 0 => moved[1],
            4 => 6 - moved[0] - moved[1],
            5 => {
                if BLOCK_OF_5.contains(&[moved[0], moved[1]]) {
                    1
                } else {
                    2
                }
            }
            _ => {
                if sign > 0.0 {
                    1
                } else {
                    2
                }
            }
        }
    };
    let blocks: Vec<usize> = design.runs().iter().enumerate().map(block).collect();
    design.blocked(&blocks)
}

/// All combinations of -1 and +1 of the factors in `set`, the first fastest; the others at 0.
fn corners(set: &[usize], k: usize) -> Vec<Vec<f64>> {
    let row = |bits: usize| {
        let mut row = vec![0.0; k];
        for (place, &factor) in set.iter().enumerate() {
            row[factor] = if bits >> place & 1 == 1 { 1.0 } else { -1.0 };
        }
        row
    };
    (0..1 << set.len()).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::{box_behnken, box_behnken_in_blocks};
    use crate::Error;
    use crate::factor::coded_factors;

    /// The published run counts, and the moments that make the quadratic estimable with equal
    /// precision: every factor has the same sum of squares, every pair the same sum of products
    /// of squares for 3, 4, 5 and 7 factors (6 is only partially balanced), all odd moments zero.
    #[test]
    fn run_counts_and_moments_are_the_published_ones() {
        for (k, n, square) in [
            (3, 12, 8.0),
            (4, 24, 12.0),
            (5, 40, 16.0),
            (6, 48, 24.0),
            (7, 56, 24.0),
        ] {
            let rows = box_behnken(&coded_factors(k), 3).unwrap().coded_rows();
            assert_eq!(rows.len(), n + 3, "{k} factors");
            let moment = |f: &dyn Fn(&[f64]) -> f64| rows.iter().map(|r| f(r)).sum::<f64>();
            let pair = moment(&|r| r[0] * r[0] * r[1] * r[1]);
            for i in 0..k {
                assert_eq!(moment(&|r| r[i] * r[i]), square, "factor {i} of {k}");
                assert_eq!(moment(&|r| r[i]), 0.0);
                for j in 0..i {
                    assert_eq!(moment(&|r| r[i] * r[j]), 0.0);
                    let both = moment(&|r| r[i] * r[i] * r[j] * r[j]);
                    assert!(both > 0.0, "interaction {i}:{j} of {k} is never varied");
                    assert!(
                        k == 6 || both == pair,
                        "pair {i}:{j} of {k} is out of balance"
                    );
                }
            }
        }
    }

    /// Blocks are orthogonal if within each of them odd moments vanish and the sum of squares of
    /// every factor is the same share of the runs (exact whole numbers).
    #[test]
    fn blocks_are_orthogonal_to_the_quadratic() {
        for (k, n_blocks, centre) in [(4, 3, 3), (5, 2, 6), (6, 2, 6), (7, 2, 6)] {
            let design = box_behnken_in_blocks(&coded_factors(k), centre).unwrap();
            for block in 1..=n_blocks {
                let rows: Vec<&[f64]> = design
                    .runs()
                    .iter()
                    .filter(|run| run.block == block)
                    .map(|run| &run.coded[..])
                    .collect();
                assert_eq!(rows.len() * n_blocks, design.runs().len(), "{k} factors");
                let square: f64 = rows.iter().map(|r| r[0] * r[0]).sum();
                for i in 0..k {
                    assert_eq!(rows.iter().map(|r| r[i]).sum::<f64>(), 0.0);
                    assert_eq!(rows.iter().map(|r| r[i] * r[i]).sum::<f64>(), square);
                    for j in 0..i {
                        assert_eq!(rows.iter().map(|r| r[i] * r[j]).sum::<f64>(), 0.0);
                    }
                }
            }
        }
        assert!(box_behnken_in_blocks(&coded_factors(3), 6).is_err());
        assert!(box_behnken_in_blocks(&coded_factors(5), 5).is_err());
    }

    #[test]
    fn other_numbers_of_factors_are_refused_with_a_way_out() {
        for k in [1, 2, 8] {
            let error = box_behnken(&coded_factors(k), 3).unwrap_err();
            assert!(matches!(error, Error::FactorCount { .. }));
            assert!(error.to_string().contains("central composite"), "{error}");
        }
    }
}
