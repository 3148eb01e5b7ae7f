//! Definitive screening designs: three levels of many factors in few runs.

use crate::conference::conference_matrix;
use crate::design::append_centres;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Largest number of columns: the greatest available conference matrix.
const MOST_COLUMNS: usize = 32;
/// Fewest columns: below, the runs cannot hold the squares.
const LEAST_COLUMNS: usize = 4;

/// Smallest number of factors: with two, this design cannot clear the interaction.
const LEAST_FACTORS: usize = 3;

/// A definitive screening design: 2 c runs in mirrored pairs, each with one factor in its middle, and centre runs.
///
/// c is the least order of a conference matrix that holds the factors and `n_fake` further columns, which are omitted from
/// the runs: they leave degrees of freedom for the error of the main effects. Main effects are orthogonal, and free of
/// squares and two-factor interactions, which are free of each other's full aliasing.
///
/// # Formula
/// Runs `C`, `-C`, `0` with `C'C = (c - 1) I`, zeros on the diagonal and +-1 elsewhere.
///
/// # Source
/// `[JonesNachtsheim2011]`; conference matrices: `[Xiao2012]`; omitted columns: `[JonesNachtsheim2017]`.
///
/// # Errors
/// [`Error::FactorCount`] for fewer than three factors, or more than fit 32 columns with the fake ones;
/// [`Error::CountOutOfRange`] without a centre run, or with more fake factors than leave room for three; those of [`check_factors`].
pub fn definitive_screening(
    factors: &[Factor],
    n_fake: usize,
    n_centre: usize,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    let most_fake = MOST_COLUMNS - LEAST_FACTORS;
    if n_fake > most_fake {
        return Err(Error::CountOutOfRange {
            what: "fake factors",
            given: n_fake,
            least: 0,
            most: most_fake,
        });
    }
    let room = MOST_COLUMNS - n_fake;
    let found = (k + n_fake).max(LEAST_COLUMNS);
    let matrix = (found..=MOST_COLUMNS).find_map(conference_matrix);
    let Some(matrix) = matrix.filter(|_| (LEAST_FACTORS..=room).contains(&k)) else {
        return Err(Error::FactorCount {
            design: "definitive screening",
            given: k,
            least: LEAST_FACTORS,
            most: room,
            way_out: "take a central composite design for two factors, a Plackett-Burman design for many, or fewer fake \
                      factors",
        });
    };
    if n_centre == 0 {
        return Err(Error::CountOutOfRange {
            what: "centre runs of a definitive screening design",
            given: 0,
            least: 1,
            most: 10_000,
        });
    }
    let pair =
        |line: &Vec<f64>| [1.0, -1.0].map(|sign| line[..k].iter().map(|x| sign * x).collect());
    let mut rows: Vec<Vec<f64>> = matrix.iter().flat_map(pair).collect();
    // -0 is no level of its own.
    for value in rows.iter_mut().flatten() {
        *value += 0.0;
    }
    append_centres(&mut rows, k, n_centre)?;
    Design::new(DesignKind::DefinitiveScreening, factors, Vec::new(), rows)
}

#[cfg(test)]
mod tests {
    use super::definitive_screening;
    use crate::Error;
    use crate::factor::coded_factors;

    /// Six factors without fake ones take 13 runs `[JonesNachtsheim2011]`, five as many as six; two fake factors add
    /// four runs.
    #[test]
    fn run_counts_are_those_of_the_source() {
        let runs = |k: usize, fake: usize| {
            let design = definitive_screening(&coded_factors(k), fake, 1).unwrap();
            design.runs().len()
        };
        assert_eq!([runs(4, 0), runs(5, 0), runs(6, 0)], [9, 13, 13]);
        assert_eq!([runs(6, 2), runs(7, 2), runs(12, 0)], [17, 21, 25]);
        // There is no conference matrix of order 22.
        assert_eq!(runs(22, 0), 49);
    }

    /// Every available number of factors: main effects are orthogonal to one another and to all squares and two-factor
    /// interactions (sums of integers: exact), each factor has as many runs in its middle, and no pair of second-order
    /// columns is fully aliased.
    #[test]
    fn main_effects_are_free_of_all_terms_of_second_order() {
        for k in 3..=30 {
            let rows = definitive_screening(&coded_factors(k), 2, 1)
                .unwrap()
                .coded_rows();
            let sum = |f: &dyn Fn(&Vec<f64>) -> f64| rows.iter().map(f).sum::<f64>();
            let middles = rows.iter().filter(|x| x[0] == 0.0).count();
            for a in 0..k {
                assert_eq!(rows.iter().filter(|x| x[a] == 0.0).count(), middles);
                for b in 0..k {
                    let product = sum(&|x| x[a] * x[b]);
                    assert_eq!(product == 0.0, a != b, "{k} factors, {a}, {b}");
                    for c in b..k {
                        assert_eq!(sum(&|x| x[a] * x[b] * x[c]), 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_made_is_refused() {
        for (k, fake) in [(2, 2), (31, 2), (4, 29)] {
            let error = definitive_screening(&coded_factors(k), fake, 1);
            assert!(
                matches!(error, Err(Error::FactorCount { .. })),
                "{k}, {fake}"
            );
        }
        assert!(definitive_screening(&coded_factors(4), 2, 0).is_err());
        let limit = definitive_screening(&coded_factors(3), 40, 1);
        assert!(matches!(
            limit,
            Err(Error::CountOutOfRange { most: 29, .. })
        ));
    }
}
