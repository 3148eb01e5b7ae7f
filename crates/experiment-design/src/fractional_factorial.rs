//! Regular fractions of two-level factorials.

use serde::Serialize;

use crate::design::append_centres;
use crate::full_factorial::two_level_rows;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Generators of least aberration: number of factors, number of basic factors, and for each
/// further factor the basic factors whose product it is `[Fries1980]`,
/// `[Box2005, table of fractions of least aberration]`.
const GENERATORS: [(usize, usize, &[&str]); 26] = [
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
    (9, 7, &["ACDFG", "BCEFG"]),
    (9, 6, &["ABCD", "ACEF", "CDEF"]),
    (9, 5, &["BCDE", "ACDE", "ABDE", "ABCE"]),
    (9, 4, &["ABC", "BCD", "ACD", "ABD", "ABCD"]),
    (10, 7, &["ABCG", "BCDE", "ACDF"]),
    (10, 6, &["BCDF", "ACDF", "ABDE", "ABCE"]),
    (10, 5, &["ABCD", "ABCE", "ABDE", "ACDE", "BCDE"]),
    (10, 4, &["ABC", "BCD", "ACD", "ABD", "ABCD", "AB"]),
    (11, 6, &["CDE", "ABCD", "ABF", "BDEF", "ADEF"]),
    (11, 5, &["ABC", "BCD", "CDE", "ACD", "ADE", "BDE"]),
    (11, 4, &["ABC", "BCD", "ACD", "ABD", "ABCD", "AB", "AC"]),
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
    /// Main effects and two-factor interactions that cannot be told apart, set by set.
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
    check_factors(factors)?;
    let k = factors.len();
    if !(3..=11).contains(&k) {
        return Err(Error::FactorCount {
            design: "fractional factorial",
            given: k,
            least: 3,
            most: 11,
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
    from_masks(factors, *basic, &masks, n_centre)
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
            .filter(|(m, _)| effects.contains(m))
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
    use super::{GENERATORS, fractional_factorial};
    use crate::Factor;

    /// Published resolutions; every defining word is checked to be +1 in every run (exact).
    #[test]
    fn resolutions_are_the_published_ones_and_words_are_constant() {
        let published = [
            3, 4, 5, 3, 6, 4, 3, 7, 4, 4, 3, 8, 5, 4, 4, 6, 4, 4, 3, 5, 4, 4, 3, 4, 4, 3,
        ];
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
