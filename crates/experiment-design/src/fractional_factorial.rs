//! Regular fractions of two-level factorials.

use serde::Serialize;

use crate::design::append_centres;
use crate::full_factorial::two_level_rows;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Generators of least aberration: number of factors, number of basic factors, and for each
/// further factor the basic factors whose product it is `[Fries1980]`,
/// `[Box2005, table of fractions of least aberration]`.
const GENERATORS: [(usize, usize, &[&str]); 15] = [
    (3, 2, &["AB"]),
    (4, 3, &["ABC"]),
    (5, 4, &["ABCD"]),
    (5, 3, &["AB", "AC"]),
    (6, 5, &["ABCDE"]),
    (6, 4, &["ABC", "BCD"]),
    (6, 3, &["AB", "AC", "BC"]),
    (7, 6, &["ABCDEF"]),
    (7, 5, &["ABCD", "ABDE"]),
    (7, 4, &["ABC", "BCD", "ACD"]),
    (7, 3, &["AB", "AC", "BC", "ABC"]),
    (8, 7, &["ABCDEFG"]),
    (8, 6, &["ABCD", "ABEF"]),
    (8, 5, &["ABC", "ABD", "BCDE"]),
    (8, 4, &["BCD", "ACD", "ABC", "ABD"]),
];

/// A fraction with what it costs: resolution and defining relation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fraction {
    /// The runs.
    pub design: Design,
    /// Length of the shortest word: 3 aliases main effects with two-factor interactions, 4
    /// two-factor interactions with each other, 5 neither.
    pub resolution: usize,
    /// Products of factors that are constant +1 over the runs (symbols joined by `:`).
    pub defining_words: Vec<String>,
}

/// The 2^(k-p) fraction of least aberration for 3 to 8 factors, p = `halvings`, followed by
/// `n_centre` centre runs.
///
/// # Source
/// `[Fries1980]`.
///
/// # Errors
/// [`Error::FactorCount`] outside 3 to 8 factors; [`Error::CountOutOfRange`] if that fraction does
/// not exist or for too many centre runs; those of [`check_factors`].
pub fn fractional_factorial(
    factors: &[Factor],
    halvings: usize,
    n_centre: usize,
) -> Result<Fraction, Error> {
    check_factors(factors)?;
    let k = factors.len();
    if !(3..=8).contains(&k) {
        return Err(Error::FactorCount {
            design: "fractional factorial",
            given: k,
            least: 3,
            most: 8,
            way_out: "take a full factorial for fewer, a Plackett-Burman design for more",
        });
    }
    let most = GENERATORS
        .iter()
        .filter(|g| g.0 == k)
        .map(|g| k - g.1)
        .max()
        .unwrap_or(0);
    let Some((_, basic, products)) = GENERATORS
        .iter()
        .find(|(n, basic, _)| *n == k && k - basic == halvings)
    else {
        return Err(Error::CountOutOfRange {
            what: "halvings of the full factorial",
            given: halvings,
            least: 1,
            most,
        });
    };
    let masks: Vec<usize> = products.iter().map(|word| mask(word)).collect();
    let mut rows = two_level_rows(*basic);
    for row in &mut rows {
        let product = |m: usize| {
            (0..*basic)
                .filter(|j| m >> j & 1 == 1)
                .map(|j| row[j])
                .product()
        };
        let added: Vec<f64> = masks.iter().map(|&m| product(m)).collect();
        row.extend(added);
    }
    append_centres(&mut rows, k, n_centre)?;
    let words = defining_masks(&masks, *basic);
    let resolution = words
        .iter()
        .map(|m| m.count_ones() as usize)
        .min()
        .unwrap_or(k);
    let spell = |m: &usize| {
        let letters = factors.iter().enumerate().filter(|(j, _)| m >> j & 1 == 1);
        letters
            .map(|(_, f)| f.symbol())
            .collect::<Vec<_>>()
            .join(":")
    };
    Ok(Fraction {
        design: Design::new(DesignKind::FractionalFactorial, factors, Vec::new(), rows)?,
        resolution,
        defining_words: words.iter().map(spell).collect(),
    })
}

/// The set of letters of a word, bit 0 for A.
fn mask(word: &str) -> usize {
    word.bytes().fold(0, |m, letter| m | 1 << (letter - b'A'))
}

/// All products of the generating words, sorted by length.
fn defining_masks(masks: &[usize], basic: usize) -> Vec<usize> {
    let generators: Vec<usize> = masks
        .iter()
        .enumerate()
        .map(|(i, m)| m | 1 << (basic + i))
        .collect();
    let product = |choice: usize| {
        let chosen = generators
            .iter()
            .enumerate()
            .filter(|(i, _)| choice >> i & 1 == 1);
        chosen.fold(0, |m, (_, g)| m ^ g)
    };
    let mut words: Vec<usize> = (1..1_usize << generators.len()).map(product).collect();
    words.sort_by_key(|m| (m.count_ones(), *m));
    words
}

#[cfg(test)]
mod tests {
    use super::{GENERATORS, fractional_factorial};
    use crate::Factor;

    /// Published resolutions; every defining word is checked to be +1 in every run (exact).
    #[test]
    fn resolutions_are_the_published_ones_and_words_are_constant() {
        let published = [3, 4, 5, 3, 6, 4, 3, 7, 4, 4, 3, 8, 5, 4, 4];
        for ((k, basic, _), resolution) in GENERATORS.iter().zip(published) {
            let factors: Vec<Factor> = (0..*k)
                .map(|i| Factor::coded_only(&format!("x{i}")).unwrap())
                .collect();
            let fraction = fractional_factorial(&factors, k - basic, 0).unwrap();
            assert_eq!(fraction.resolution, resolution, "2^({k}-{})", k - basic);
            assert_eq!(fraction.design.runs().len(), 1 << basic);
            for word in &fraction.defining_words {
                let columns: Vec<usize> =
                    word.split(':').map(|s| s[1..].parse().unwrap()).collect();
                for run in fraction.design.runs() {
                    let product: f64 = columns.iter().map(|&j| run.coded[j]).product();
                    assert_eq!(product, 1.0, "{word} in 2^({k}-{})", k - basic);
                }
            }
        }
    }

    #[test]
    fn fractions_that_do_not_exist_are_refused() {
        let factors: Vec<Factor> = ["A", "B", "C"]
            .iter()
            .map(|s| Factor::coded_only(s).unwrap())
            .collect();
        assert!(fractional_factorial(&factors, 0, 0).is_err());
        assert!(fractional_factorial(&factors, 2, 0).is_err());
        assert!(fractional_factorial(&factors[..2], 1, 0).is_err());
    }
}
