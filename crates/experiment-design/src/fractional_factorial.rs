//! Regular fractions of two-level factorials.

use serde::Serialize;

use crate::design::append_centres;
use crate::full_factorial::two_level_rows;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Generators of least aberration: number of factors, number of basic factors, and for each
/// further factor the basic factors whose product it is `[Fries1980]`,
/// `[Box2005, table of fractions of least aberration]`.
///
/// The list has every number of halvings from one to the most that leaves each main effect its own column, in rising order.
/// Those of more than 128 runs come from a search through all defining relations of their size.
const GENERATORS: [(usize, usize, &[&str]); 33] = [
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
    (9, 8, &["ABCDEFGH"]),
    (9, 7, &["ACDFG", "BCEFG"]),
    (9, 6, &["ABCD", "ACEF", "CDEF"]),
    (9, 5, &["BCDE", "ACDE", "ABDE", "ABCE"]),
    (9, 4, &["ABC", "BCD", "ACD", "ABD", "ABCD"]),
    (10, 9, &["ABCDEFGHI"]),
    (10, 8, &["ABEFGH", "CDEFGH"]),
    (10, 7, &["ABCG", "BCDE", "ACDF"]),
    (10, 6, &["BCDF", "ACDF", "ABDE", "ABCE"]),
    (10, 5, &["ABCD", "ABCE", "ABDE", "ACDE", "BCDE"]),
    (10, 4, &["ABC", "BCD", "ACD", "ABD", "ABCD", "AB"]),
    (11, 10, &["ABCDEFGHIJ"]),
    (11, 9, &["ABFGHI", "CDEFGHI"]),
    (11, 8, &["ACDGH", "AEFGH", "BCDEFGH"]),
    (11, 7, &["ACEG", "BCFG", "DEFG", "ABCDEFG"]),
    (11, 6, &["CDE", "ABCD", "ABF", "BDEF", "ADEF"]),
    (11, 5, &["ABC", "BCD", "CDE", "ACD", "ADE", "BDE"]),
    (11, 4, &["ABC", "BCD", "ACD", "ABD", "ABCD", "AB", "AC"]),
];

/// A fraction with its resolution and defining relation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fraction {
    /// The runs.
    pub design: Design,
    /// Length of the shortest word: 3 aliases main effects with two-factor interactions, 4
    /// two-factor interactions with each other, 5 neither.
    pub resolution: usize,
    /// Products of factors that are constant +1 over the runs (symbols joined by `:`).
    pub defining_words: Vec<String>,
    /// Main effects and two-factor interactions that the runs cannot separate, set by set.
    pub aliases: Vec<Vec<String>>,
}

/// The 2^(k-p) fraction of least aberration for 3 to 11 factors, p = `halvings`, followed by
/// `n_centre` centre runs.
///
/// # Source
/// `[Fries1980]`.
///
/// # Errors
/// [`Error::FactorCount`] outside 3 to 11 factors; [`Error::CountOutOfRange`] if that fraction does
/// not exist or for too many centre runs; those of [`check_factors`].
pub fn fractional_factorial(
    factors: &[Factor],
    halvings: usize,
    n_centre: usize,
) -> Result<Fraction, Error> {
    let fractions = fractions_of(factors)?;
    let k = factors.len();
    let most = fractions.iter().map(|(basic, _)| k - basic).max();
    let Some((basic, masks)) = fractions.iter().find(|(basic, _)| k - basic == halvings) else {
        return Err(Error::CountOutOfRange {
            what: "halvings of the full factorial",
            given: halvings,
            least: 1,
            most: most.unwrap_or(0),
        });
    };
    from_masks(factors, *basic, masks, n_centre)
}

/// The fraction of fewest runs whose resolution is at least `resolution`, for 3 to 11 factors.
///
/// # Source
/// As [`fractional_factorial`].
///
/// # Errors
/// [`Error::NoFraction`] if only the full factorial has that resolution, or for a resolution below 3, which leaves main effects
/// aliased with each other; otherwise those of [`fractional_factorial`].
pub fn fraction_of_resolution(
    factors: &[Factor],
    resolution: usize,
    n_centre: usize,
) -> Result<Fraction, Error> {
    for (basic, masks) in fractions_of(factors)?.iter().rev() {
        let made = from_masks(factors, *basic, masks, n_centre)?;
        if resolution >= 3 && made.resolution >= resolution {
            return Ok(made);
        }
    }
    Err(Error::NoFraction {
        factors: factors.len(),
        resolution,
    })
}

/// The tabulated fractions of this number of factors, each halved once more than the one before it: its number of basic factors and the
/// products that make the others.
fn fractions_of(factors: &[Factor]) -> Result<Vec<(usize, Vec<usize>)>, Error> {
    check_factors(factors)?;
    let k = factors.len();
    if !(3..=11).contains(&k) {
        return Err(Error::FactorCount {
            design: "fractional factorial",
            given: k,
            least: 3,
            most: 11,
            way_out: "take a full factorial for fewer; for more a Plackett-Burman design, or your own generators",
        });
    }
    let rows = GENERATORS.iter().filter(|(n, _, _)| *n == k);
    let masks = |words: &[&str]| words.iter().map(|word| mask(word)).collect();
    Ok(rows
        .map(|(_, basic, words)| (*basic, masks(words)))
        .collect())
}

/// A fraction whose further factors are the products `masks` of the basic ones.
fn from_masks(
    factors: &[Factor],
    basic: usize,
    masks: &[usize],
    n_centre: usize,
) -> Result<Fraction, Error> {
    let k = factors.len();
    let mut rows = two_level_rows(basic);
    for row in &mut rows {
        let product = |m: usize| {
            (0..basic)
                .filter(|j| m >> j & 1 == 1)
                .map(|j| row[j])
                .product()
        };
        let added: Vec<f64> = masks.iter().map(|&m| product(m)).collect();
        row.extend(added);
    }
    append_centres(&mut rows, k, n_centre)?;
    let words: Vec<usize> = masks
        .iter()
        .enumerate()
        .map(|(i, m)| m | 1 << (basic + i))
        .collect();
    fraction(factors, rows, &words, &vec![1.0; words.len()])
}

/// Puts a fraction together with its defining relation.
pub(crate) fn fraction(
    factors: &[Factor],
    rows: Vec<Vec<f64>>,
    generating: &[usize],
    signs: &[f64],
) -> Result<Fraction, Error> {
    let mut words: Vec<(usize, f64)> = (1..1_usize << generating.len())
        .map(|choice| {
            let chosen = (0..generating.len()).filter(|i| choice >> i & 1 == 1);
            chosen.fold((0, 1.0), |(m, s), i| (m ^ generating[i], s * signs[i]))
        })
        .collect();
    words.sort_by_key(|(m, _)| (m.count_ones(), *m));
    let resolution = words
        .first()
        .map_or(factors.len() + 1, |(m, _)| m.count_ones() as usize);
    let aliases = alias_sets(factors, &words);
    let signed = |(m, sign): &(usize, f64)| {
        format!(
            "{}{}",
            if *sign < 0.0 { "-" } else { "" },
            spell(factors, *m)
        )
    };
    Ok(Fraction {
        design: Design::new(DesignKind::FractionalFactorial, factors, Vec::new(), rows)?,
        resolution,
        defining_words: words.iter().map(signed).collect(),
        aliases,
    })
}

/// Main effects and two-factor interactions that share a column, each set once; sets of one are
/// left out.
fn alias_sets(factors: &[Factor], words: &[(usize, f64)]) -> Vec<Vec<String>> {
    let k = factors.len();
    let singles = (0..k).map(|i| 1_usize << i);
    let pairs = (0..k).flat_map(|i| (i + 1..k).map(move |j| 1_usize << i | 1 << j));
    let effects: Vec<usize> = singles.chain(pairs).collect();
    let mut sets = Vec::new();
    for (i, effect) in effects.iter().enumerate() {
        let partners: Vec<(usize, f64)> = words
            .iter()
            .map(|(m, sign)| (m ^ effect, *sign))
            .filter(|(m, _)| matches!(m.count_ones(), 1 | 2))
            .collect();
        if partners.is_empty() || partners.iter().any(|(m, _)| effects[..i].contains(m)) {
            continue;
        }
        let mut set = vec![spell(factors, *effect)];
        set.extend(partners.iter().map(|(m, sign)| {
            format!(
                "{}{}",
                if *sign < 0.0 { "-" } else { "" },
                spell(factors, *m)
            )
        }));
        sets.push(set);
    }
    sets
}

/// The symbols of a set of factors joined by `:`.
pub(crate) fn spell(factors: &[Factor], mask: usize) -> String {
    let letters = factors
        .iter()
        .enumerate()
        .filter(|(j, _)| mask >> j & 1 == 1);
    letters
        .map(|(_, f)| f.symbol())
        .collect::<Vec<_>>()
        .join(":")
}

/// The set of letters of a word, bit 0 for A.
fn mask(word: &str) -> usize {
    word.bytes().fold(0, |m, letter| m | 1 << (letter - b'A'))
}

#[cfg(test)]
mod tests {
    use super::{GENERATORS, fraction_of_resolution, fractional_factorial};
    use crate::{Error, Factor};

    fn some_factors(k: usize) -> Vec<Factor> {
        let factor = |i| Factor::coded_only(&format!("x{i}")).unwrap();
        (0..k).map(factor).collect()
    }

    /// Published resolutions; those of more than 128 runs are the greatest that the lengths of their words allow, as each factor
    /// lies in half of the words. Every defining word is checked to be +1 in every run (exact).
    #[test]
    fn resolutions_are_the_published_ones_and_words_are_constant() {
        let published = [
            3, 4, 5, 3, 6, 4, 3, 7, 4, 4, 3, 8, 5, 4, 4, 9, 6, 4, 4, 3, 10, 6, 5, 4, 4, 3, 11, 7,
            6, 5, 4, 4, 3,
        ];
        assert_eq!(GENERATORS.len(), published.len());
        for ((k, basic, _), resolution) in GENERATORS.iter().zip(published) {
            let factors = some_factors(*k);
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

    /// The most halvings leave the fewest runs that have a column for each of k main effects: `2^(k - p) > k`. The limit that a
    /// refusal names is that one, and every number within it is made.
    #[test]
    fn every_number_of_halvings_is_made_up_to_the_limit_that_is_named() {
        for k in 3..=11 {
            let factors = some_factors(k);
            let most = (1..k).rfind(|p| 1 << (k - p) > k).unwrap();
            for halvings in 0..=k + 1 {
                match fractional_factorial(&factors, halvings, 0) {
                    Ok(fraction) => {
                        assert!((1..=most).contains(&halvings));
                        assert_eq!(fraction.design.runs().len(), 1 << (k - halvings));
                    }
                    Err(error) => {
                        assert!(!(1..=most).contains(&halvings), "{k}, {halvings}: {error}");
                        let limits = |e: &Error| match e {
                            Error::CountOutOfRange { least, most, .. } => (*least, *most),
                            other => panic!("{other}"),
                        };
                        assert_eq!(limits(&error), (1, most));
                    }
                }
            }
        }
        for k in [2, 12] {
            let refused = fractional_factorial(&some_factors(k), 1, 0);
            assert!(matches!(refused, Err(Error::FactorCount { given, .. }) if given == k));
        }
    }

    /// The fewest runs of resolution III, IV and V for 3 to 11 factors; none of resolution V for three and four factors, whose
    /// halves have III and IV.
    ///
    /// Source: `[Box2005, table of fractions of least aberration]`, for 11 factors 128 runs.
    #[test]
    fn the_smallest_fraction_of_a_resolution_has_the_published_number_of_runs() {
        let published = [
            [4, 0, 0],
            [8, 8, 0],
            [8, 16, 16],
            [8, 16, 32],
            [8, 16, 64],
            [16, 16, 64],
            [16, 32, 128],
            [16, 32, 128],
            [16, 32, 128],
        ];
        for (k, runs) in (3..).zip(published) {
            let factors = some_factors(k);
            for (resolution, runs) in (3..).zip(runs) {
                match fraction_of_resolution(&factors, resolution, 0) {
                    Ok(fraction) => {
                        assert_eq!(fraction.design.runs().len(), runs, "{k}, {resolution}");
                        assert!(fraction.resolution >= resolution);
                    }
                    Err(error) => {
                        assert_eq!(runs, 0, "{error}");
                        let expected = Error::NoFraction {
                            factors: k,
                            resolution,
                        };
                        assert_eq!(error, expected);
                    }
                }
            }
            assert!(fraction_of_resolution(&factors, 2, 0).is_err());
        }
    }
}
