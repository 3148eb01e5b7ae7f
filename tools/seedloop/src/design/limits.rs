//! What runs may be: levels of factors with numbers, and linear constraints on them.

use anyhow::{Context as _, bail, ensure};
use experiment_design::{Constraint, Coordinate, Factor};

use super::Arguments;

/// The factors' coordinates: their ranges, or the levels of `--levels` in coded values, ascending.
pub(super) fn coordinates(
    arguments: &Arguments,
    factors: &[Factor],
) -> anyhow::Result<Vec<Coordinate>> {
    let mut all = vec![Coordinate::Range; factors.len()];
    for text in &arguments.levels {
        let form = || format!("'{text}' is not a list of levels; write it as B=0.30:0.36:0.42");
        let (symbol, levels) = text.split_once('=').with_context(form)?;
        let place = place(factors, symbol.trim())?;
        let factor = &factors[place];
        ensure!(
            all[place] == Coordinate::Range,
            "the levels of '{}' are given twice",
            factor.symbol()
        );
        let number = |text: &str| text.trim().parse::<f64>().ok().with_context(form);
        let mut levels: Vec<f64> = levels.split(':').map(number).collect::<Result<_, _>>()?;
        levels.sort_by(f64::total_cmp);
        for level in &levels {
            ensure!(
                (factor.low()..=factor.high()).contains(level),
                "the level {level} of '{}' lies outside its range {} to {} {}",
                factor.symbol(),
                factor.low(),
                factor.high(),
                factor.unit()
            );
        }
        levels.dedup();
        ensure!(
            levels.len() > 1,
            "'{text}' leaves one level; a factor needs two or more"
        );
        all[place] = Coordinate::Levels(levels.iter().map(|level| factor.coded(*level)).collect());
    }
    Ok(all)
}

/// A constraint such as `2*B + E <= 0.5`, natural values, as one on coded values.
///
/// # Formula
/// u = middle + half-range x for each factor, so that `sum(a u) <= b` is `sum(a half x) <= b - sum(a middle)`.
pub(super) fn constraint(text: &str, factors: &[Factor]) -> anyhow::Result<Constraint> {
    let form = || format!("'{text}' is not a linear constraint; write it as \"2*B + E <= 0.5\"");
    let (left, right, sign) = match (text.split_once("<="), text.split_once(">=")) {
        (Some((left, right)), None) => (left, right, 1.0),
        (None, Some((left, right))) => (left, right, -1.0),
        _ => bail!(form()),
    };
    let mut weights = vec![0.0; factors.len()];
    let mut bound = 0.0;
    for (side, of_side) in [(left, sign), (right, -sign)] {
        for (factor, number) in terms(side).with_context(form)? {
            let number = of_side * number;
            match factor {
                None => bound -= number,
                Some(symbol) => {
                    let place = place(factors, &symbol)?;
                    weights[place] += number * factors[place].half_range();
                    bound -= number * factors[place].mid();
                }
            }
        }
    }
    let size: f64 = weights.iter().map(|w| w.abs()).sum();
    ensure!(
        size > 0.0 && size.is_finite(),
        "{}: no factor is left in it",
        form()
    );
    // With the greatest sum of weights one the rounding of a constraint is that of coded values.
    Ok(Constraint {
        weights: weights.iter().map(|w| w / size).collect(),
        bound: bound / size,
    })
}

/// The terms of a sum such as `2*B - 0.5 E + 1`: symbols, none for a plain number, with their factors.
fn terms(side: &str) -> Option<Vec<(Option<String>, f64)>> {
    let mut all = Vec::new();
    let mut rest = side.trim();
    let mut first = true;
    while !rest.is_empty() {
        let sign = match rest.chars().next()? {
            '+' => 1.0,
            '-' => -1.0,
            _ if first => 0.0,
            _ => return None,
        };
        let body = if sign == 0.0 {
            rest
        } else {
            rest[1..].trim_start()
        };
        let sign = if sign == 0.0 { 1.0 } else { sign };
        first = false;
        // The sign of an exponent (1e-3) ends no term.
        let is_exponent = |i: usize| {
            body[..i].ends_with(['e', 'E'])
                && body[..i - 1].ends_with(|c: char| c.is_ascii_digit() || c == '.')
        };
        let end = body
            .char_indices()
            .find(|(i, c)| matches!(c, '+' | '-') && !is_exponent(*i))
            .map_or(body.len(), |(i, _)| i);
        let (term, after) = (body[..end].trim(), &body[end..]);
        all.push(term_of(term, sign)?);
        rest = after.trim_start();
    }
    (!all.is_empty()).then_some(all)
}

/// One term: `B`, `2*B`, `2 B`, `B*2` or a number.
fn term_of(term: &str, sign: f64) -> Option<(Option<String>, f64)> {
    let words: Vec<&str> = term
        .split(['*', ' '])
        .filter(|word| !word.is_empty())
        .collect();
    let number = |word: &str| word.parse::<f64>().ok().filter(|value| value.is_finite());
    match words[..] {
        [word] => match number(word) {
            Some(value) => Some((None, sign * value)),
            None => Some((Some(word.to_owned()), sign)),
        },
        [one, two] => match (number(one), number(two)) {
            (Some(value), None) => Some((Some(two.to_owned()), sign * value)),
            (None, Some(value)) => Some((Some(one.to_owned()), sign * value)),
            _ => None,
        },
        _ => None,
    }
}

fn place(factors: &[Factor], symbol: &str) -> anyhow::Result<usize> {
    let found = factors.iter().position(|f| f.symbol() == symbol);
    found.with_context(|| {
        let known: Vec<&str> = factors.iter().map(Factor::symbol).collect();
        format!(
            "there is no factor '{symbol}'; the factors are {}",
            known.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::constraint;
    use experiment_design::Factor;

    fn factors() -> [Factor; 2] {
        [
            Factor::new("B", "", "1", 0.2, 0.6).unwrap(),
            Factor::new("E", "", "mm", 0.0, 10.0).unwrap(),
        ]
    }

    /// All ways to write 2 B + E/10 <= 1 are the same half-space: natural points on it have no room, to rounding.
    #[test]
    fn a_constraint_is_the_half_space_that_is_written() {
        let ways = [
            "2*B + 0.1*E <= 1",
            "2 B + 1e-1 E <= 1",
            "1 >= 2*B + E*0.1",
            "0.1*E <= 1 - 2*B",
            "-2*B - 0.1 E >= -1",
            "B + B + 0.1E0 * E - 1 <= 0",
        ];
        let f = factors();
        for text in ways {
            let got = constraint(text, &f).unwrap();
            let room = |b: f64, e: f64| {
                let coded = [f[0].coded(b), f[1].coded(e)];
                let sum: f64 = got.weights.iter().zip(coded).map(|(w, x)| w * x).sum();
                got.bound - sum
            };
            assert!(room(0.2, 6.0).abs() < 1e-12, "{text}: {got:?}");
            assert!(room(0.5, 0.0).abs() < 1e-12, "{text}");
            assert!(room(0.3, 1.0) > 0.1 && room(0.6, 9.0) < -0.1, "{text}");
        }
    }

    #[test]
    fn what_is_no_linear_constraint_is_refused_with_its_form() {
        for (text, part) in [
            ("B + E", "write it as"),
            ("B < 1", "write it as"),
            ("B*E <= 1", "write it as"),
            ("B^2 <= 1", "no factor 'B^2'"),
            ("2*G <= 1", "the factors are B, E"),
            ("B - B <= 1", "no factor is left"),
            (" <= 1", "write it as"),
            ("B ++ E <= 1", "write it as"),
            ("B E E <= 1", "write it as"),
            ("B <= nan", "no factor 'nan'"),
        ] {
            let error = format!("{:#}", constraint(text, &factors()).unwrap_err());
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
