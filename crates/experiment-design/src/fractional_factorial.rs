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

/// The fraction in which further factors are products of earlier ones, such as `D=ABC` (`D=A:B:C`
/// for longer symbols; a minus sign, `D=-ABC`, takes the other half). The factors without a
/// generator are the basic ones, in their order.
///
/// # Errors
/// [`Error::BadGenerator`]; those of [`fractional_factorial`] for the centre runs.
pub fn fraction_with_generators(
    factors: &[Factor],
    generators: &[String],
    n_centre: usize,
) -> Result<Fraction, Error> {
    check_factors(factors)?;
    let mut made: Vec<(usize, f64, Vec<usize>)> = Vec::new();
    for generator in generators {
        let refuse = |reason| Error::BadGenerator {
            generator: generator.clone(),
            reason,
        };
        let (symbol, word) = generator
            .split_once('=')
            .ok_or_else(|| refuse("write it as D=ABC, or as D=A:B:C for longer symbols"))?;
        let place = place_of(factors, symbol.trim())
            .ok_or_else(|| refuse("what stands before '=' is no factor"))?;
        let (sign, word) = match word.trim().strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, word.trim()),
        };
        let parts = letters(factors, word)
            .ok_or_else(|| refuse("what stands behind '=' is no product of factors"))?;
        if made.iter().any(|(other, _, _)| *other == place) {
            return Err(refuse("this factor has a generator already"));
        }
        made.push((place, sign, parts));
    }
    let basic: Vec<usize> = (0..factors.len())
        .filter(|j| made.iter().all(|(place, _, _)| place != j))
        .collect();
    if made
        .iter()
        .any(|(_, _, parts)| parts.iter().any(|j| !basic.contains(j)))
    {
        return Err(Error::BadGenerator {
            generator: generators.join(", "),
            reason: "generators must be products of factors that have no generator themselves",
        });
    }
    if basic.is_empty() || basic.len() > 10 {
        return Err(Error::CountOutOfRange {
            what: "factors without a generator",
            given: basic.len(),
            least: 1,
            most: 10,
        });
    }
    let mut rows = Vec::new();
    for corner in two_level_rows(basic.len()) {
        let mut row = vec![0.0; factors.len()];
        for (&j, x) in basic.iter().zip(&corner) {
            row[j] = *x;
        }
        for (place, sign, parts) in &made {
            row[*place] = sign * parts.iter().map(|&j| row[j]).product::<f64>();
        }
        rows.push(row);
    }
    append_centres(&mut rows, factors.len(), n_centre)?;
    let words: Vec<usize> = made
        .iter()
        .map(|(place, _, parts)| parts.iter().fold(1 << place, |m, j| m ^ (1 << j)))
        .collect();
    let signs: Vec<f64> = made.iter().map(|(_, sign, _)| *sign).collect();
    fraction(factors, rows, &words, &signs)
}

/// Splits the runs of a two-level design into blocks by the signs of products of factors, such as
/// `ABC`; m generators make 2^m blocks. Centre runs are shared out among the blocks.
///
/// Returns the design and the products that are confounded with blocks.
///
/// # Errors
/// [`Error::BadGenerator`] for a word that is no product of factors, that is constant over the
/// runs, or that the other words give.
pub fn in_blocks(design: &Design, words: &[String]) -> Result<(Design, Vec<String>), Error> {
    let factors = design.factors();
    let mut masks = Vec::new();
    for word in words {
        let refuse = |reason| Error::BadGenerator {
            generator: word.clone(),
            reason,
        };
        let parts = letters(factors, word.trim())
            .ok_or_else(|| refuse("a block generator is a product of factors such as ABC"))?;
        masks.push(parts.iter().fold(0_usize, |m, j| m ^ (1 << j)));
    }
    let sign = |mask: usize, coded: &[f64]| -> f64 {
        (0..factors.len())
            .filter(|j| mask >> j & 1 == 1)
            .map(|j| coded[j])
            .product()
    };
    let corner = |coded: &[f64]| coded[..factors.len()].iter().all(|x| x.abs() == 1.0);
    let confounded = products(&masks);
    for mask in &confounded {
        let signs: Vec<f64> = design
            .runs()
            .iter()
            .filter(|r| corner(&r.coded))
            .map(|r| sign(*mask, &r.coded))
            .collect();
        if signs.iter().sum::<f64>() != 0.0 {
            return Err(Error::BadGenerator {
                generator: words.join(", "),
                reason: "it (or a product of the generators) is constant over the runs and makes no blocks",
            });
        }
    }
    let n_blocks = 1_usize << masks.len();
    let mut centres = 0;
    let blocks: Vec<usize> = design
        .runs()
        .iter()
        .map(|run| {
            if !corner(&run.coded) {
                centres += 1;
                return (centres - 1) % n_blocks + 1;
            }
            let bits = masks
                .iter()
                .enumerate()
                .map(|(i, &mask)| usize::from(sign(mask, &run.coded) > 0.0) << i);
            bits.sum::<usize>() + 1
        })
        .collect();
    let spelled = confounded.iter().map(|m| spell(factors, *m)).collect();
    Ok((design.blocked(&blocks)?, spelled))
}

/// Index of the factor with that symbol.
fn place_of(factors: &[Factor], symbol: &str) -> Option<usize> {
    factors.iter().position(|f| f.symbol() == symbol)
}

/// The factors of a product: symbols joined by `:`, or single letters side by side.
fn letters(factors: &[Factor], word: &str) -> Option<Vec<usize>> {
    let parts: Vec<String> = if word.contains(':') || place_of(factors, word).is_some() {
        word.split(':').map(|part| part.trim().to_owned()).collect()
    } else {
        word.chars().map(String::from).collect()
    };
    let places: Option<Vec<usize>> = parts.iter().map(|part| place_of(factors, part)).collect();
    places.filter(|places| !places.is_empty())
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
fn fraction(
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
fn spell(factors: &[Factor], mask: usize) -> String {
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

/// All products of words, sorted by length.
fn products(generators: &[usize]) -> Vec<usize> {
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
    use super::{GENERATORS, fraction_with_generators, fractional_factorial, in_blocks};
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

    fn named(symbols: &str) -> Vec<Factor> {
        symbols
            .chars()
            .map(|c| Factor::coded_only(&c.to_string()).unwrap())
            .collect()
    }

    /// 2^(4-1) with D = ABC, the textbook case: AB = CD, AC = BD, AD = BC; the other half has the
    /// opposite signs. Blocks by AB then confound AB and CD.
    #[test]
    fn own_generators_give_the_textbook_aliases_and_blocks() {
        let factors = named("ABCD");
        let half = fraction_with_generators(&factors, &["D=ABC".to_owned()], 2).unwrap();
        assert_eq!(half.resolution, 4);
        assert_eq!(
            half.aliases,
            [["A:B", "C:D"], ["A:C", "B:D"], ["A:D", "B:C"]]
        );
        let least = fractional_factorial(&factors, 1, 2).unwrap();
        assert_eq!(half.design.coded_rows(), least.design.coded_rows());
        let other = fraction_with_generators(&factors, &["D=-ABC".to_owned()], 0).unwrap();
        assert_eq!(other.aliases[0], ["A:B", "-C:D"]);
        let (blocked, confounded) = in_blocks(&half.design, &["AB".to_owned()]).unwrap();
        assert_eq!(confounded, ["A:B"]);
        for run in blocked.runs() {
            if run.coded[0] != 0.0 {
                assert_eq!(run.coded[0] * run.coded[1] > 0.0, run.block == 2);
            }
        }
        assert_eq!(blocked.runs().iter().filter(|r| r.block == 1).count(), 5);
    }

    #[test]
    fn generators_that_cannot_be_meant_are_refused() {
        let factors = named("ABCD");
        for generator in ["D", "Z=ABC", "D=AZ", "D=ABD", "D="] {
            let error = fraction_with_generators(&factors, &[generator.to_owned()], 0);
            assert!(error.is_err(), "{generator} was taken");
        }
        let half = fraction_with_generators(&factors, &["D=ABC".to_owned()], 0).unwrap();
        assert!(in_blocks(&half.design, &["ABCD".to_owned()]).is_err());
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
