//! Fractions and blocks by the user's own products of factors.

use crate::design::append_centres;
use crate::fractional_factorial::{fraction, spell};
use crate::full_factorial::two_level_rows;
use crate::{Design, Error, Factor, Fraction, check_factors};

/// Largest number of generators: m of them make 2^m - 1 defining words, which are all reported.
const MOST_GENERATORS: usize = 15;

/// The factor that each generator makes, its sign, and the factors of its product.
fn read_generators(
    factors: &[Factor],
    generators: &[String],
) -> Result<Vec<(usize, f64, Vec<usize>)>, Error> {
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
            .ok_or_else(|| refuse("the text before '=' is not a factor"))?;
        let (sign, word) = match word.trim().strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, word.trim()),
        };
        let parts = letters(factors, word)
            .ok_or_else(|| refuse("the text after '=' is not a product of factors"))?;
        if made.iter().any(|(other, _, _)| *other == place) {
            return Err(refuse("this factor has a generator already"));
        }
        made.push((place, sign, parts));
    }
    Ok(made)
}

/// The fraction in which further factors are products of earlier ones, such as `D=ABC` (`D=A:B:C`
/// for longer symbols; a minus sign, `D=-ABC`, takes the other half). The factors without a
/// generator are the basic ones, in their order.
///
/// # Errors
/// [`Error::BadGenerator`]; [`Error::CountOutOfRange`] for more than 15 generators or ten other factors; those of [`crate::fractional_factorial`] for the centre runs.
pub fn fraction_with_generators(
    factors: &[Factor],
    generators: &[String],
    n_centre: usize,
) -> Result<Fraction, Error> {
    check_factors(factors)?;
    let made = read_generators(factors, generators)?;
    let basic: Vec<usize> = (0..factors.len())
        .filter(|j| made.iter().all(|(place, _, _)| place != j))
        .collect();
    if made
        .iter()
        .any(|(_, _, parts)| parts.iter().any(|j| !basic.contains(j)))
    {
        return Err(Error::BadGenerator {
            generator: generators.join(", "),
            reason: "a generator may contain only factors without a generator of their own",
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
    if made.len() > MOST_GENERATORS {
        return Err(Error::CountOutOfRange {
            what: "generators",
            given: made.len(),
            least: 0,
            most: MOST_GENERATORS,
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
/// `ABC`; m generators make 2^m blocks. Centre runs are divided among the blocks.
///
/// Returns the design and the products that are confounded with blocks.
///
/// # Errors
/// [`Error::BadGenerator`] for a word that is not a product of factors, that is constant over the
/// runs, or that the other words give.
pub fn in_blocks(design: &Design, words: &[String]) -> Result<(Design, Vec<String>), Error> {
    let factors = design.factors();
    // 2^m blocks need as many runs; more words could not be listed with their products.
    if words.len() > design.runs().len().ilog2() as usize {
        return Err(Error::BadGenerator {
            generator: words.join(", "),
            reason: "these products make more blocks than there are runs; give fewer",
        });
    }
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
    use super::{fraction_with_generators, in_blocks};
    use crate::{Factor, fractional_factorial};

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
}
