//! Model formulas, with the operators of R.

use std::collections::BTreeSet;

use crate::{Error, Term};

/// Greatest power of one factor in a term.
pub(crate) const MOST_POWER: u8 = 12;
/// Deepest brackets of a formula: the reader calls itself for each, and its stack ends.
const MOST_DEPTH: usize = 64;
/// Longest formula, bytes (our choice): 2000 terms of ten factors.
const MOST_BYTES: usize = 100_000;
/// Most terms that a formula may have, of crossings in brackets too.
const MOST_TERMS: usize = 2000;

/// The terms of a formula over k factors, and whether the intercept is taken away.
#[derive(Debug)]
pub(crate) struct Parsed {
    /// The terms as powers of the factors, each once, in the order of the formula; the intercept where it is written.
    pub(crate) terms: Vec<Term>,
    /// Those written in `I(...)`, which count as one factor each, also a product.
    pub(crate) as_they_are: Vec<Term>,
    /// Whether the formula has `0 +` or `- 1`.
    pub(crate) through_zero: bool,
}

/// Reads a formula.
///
/// `a + b` joins terms and `a - b` takes terms away; `a:b` is a product; `a*b` is `a + b + a:b`; `a/b` is `a + a:b`;
/// `(a + b + c)^2` crosses the terms in the brackets up to products of two; `I(...)` holds a product written with
/// `*` and `^`. They bind in the order `^`, `:`, `*` and `/`, `+` and `-`. `0 +`, `+ 0` and `- 1` take the intercept
/// away. A power behind a symbol, `B^2`, is that of its values, as inside `I(...)`; R takes it for `B`.
///
/// # Source
/// Operators: `[WilkinsonRogers1973]`.
pub(crate) fn parse(formula: &str, symbols: &[String]) -> Result<Parsed, Error> {
    if formula.len() > MOST_BYTES {
        return Err(Error::LongFormula {
            bytes: formula.len(),
            most: MOST_BYTES,
        });
    }
    let mut reader = Reader {
        formula,
        rest: formula,
        symbols,
        depth: 0,
        as_they_are: Vec::new(),
    };
    let mut parsed = reader.sum()?;
    if reader.peek().is_some() {
        return Err(reader.bad());
    }
    parsed.as_they_are = reader.as_they_are;
    Ok(parsed)
}

/// A formula that is being read.
struct Reader<'a> {
    /// The whole formula.
    formula: &'a str,
    /// What is still to be read.
    rest: &'a str,
    /// Symbols of the factors.
    symbols: &'a [String],
    /// Brackets that are open.
    depth: usize,
    /// Terms written in `I(...)`.
    as_they_are: Vec<Term>,
}

/// What a part of a formula represents.
struct Part {
    terms: Vec<Term>,
    /// Whether it is one term as written, so that the same one a second time is a slip.
    is_plain: bool,
}

impl Reader<'_> {
    /// The next character that is not a space.
    fn peek(&self) -> Option<char> {
        self.rest.trim_start().chars().next()
    }

    /// Takes a character if it is the next one.
    fn take(&mut self, wanted: char) -> bool {
        let rest = self.rest.trim_start();
        let found = rest.strip_prefix(wanted);
        self.rest = found.unwrap_or(self.rest);
        found.is_some()
    }

    /// The error of what stands next, up to the next joint.
    fn bad(&self) -> Error {
        let rest = self.rest.trim_start();
        let end = rest.find(['+', '-', ')']).filter(|end| *end > 0);
        let part = rest[..end.unwrap_or(rest.len())].trim();
        self.not_a_term(if part.is_empty() {
            self.formula.trim()
        } else {
            part
        })
    }

    fn not_a_term(&self, part: &str) -> Error {
        Error::BadTerm {
            part: part.to_owned(),
            symbols: self.symbols.join(", "),
            most_power: MOST_POWER,
        }
    }

    /// Terms joined by `+` and `-`.
    fn sum(&mut self) -> Result<Parsed, Error> {
        let (mut terms, mut plain): (Vec<Term>, Vec<Term>) = (Vec::new(), Vec::new());
        let mut through_zero = false;
        let mut adds = !self.take('-');
        loop {
            if self.number("0") {
                if !adds {
                    return Err(self.not_a_term("- 0"));
                }
                through_zero = true;
            } else {
                let part = self.crossed()?;
                for term in part.terms {
                    let is_new = !terms.contains(&term);
                    if adds {
                        if part.is_plain && plain.contains(&term) {
                            return Err(Error::DuplicateTerm {
                                term: spelled(&term, self.symbols),
                            });
                        }
                        if part.is_plain {
                            plain.push(term.clone());
                        }
                        if is_new {
                            terms.push(term);
                        }
                    } else if term.degree() == 0 {
                        through_zero = true;
                        terms.retain(|other| *other != term);
                    } else if is_new {
                        // Taking away what is not there is a slip.
                        let name = spelled(&term, self.symbols);
                        return Err(self.not_a_term(&format!("- {name}")));
                    } else {
                        terms.retain(|other| *other != term);
                    }
                }
            }
            self.check_count(terms.len())?;
            adds = match (self.take('+'), self.take('-')) {
                (true, false) => true,
                (false, true) => false,
                (false, false) => break,
                (true, true) => return Err(self.bad()),
            };
        }
        Ok(Parsed {
            terms,
            as_they_are: Vec::new(),
            through_zero,
        })
    }

    /// Terms joined by `*` and `/`.
    fn crossed(&mut self) -> Result<Part, Error> {
        let mut part = self.product()?;
        loop {
            let nested = if self.take('*') {
                false
            } else if self.take('/') {
                true
            } else {
                return Ok(part);
            };
            let other = self.product()?;
            let own = part.terms.iter().cloned();
            let terms = if nested {
                // b within all that a has.
                let all = part
                    .terms
                    .iter()
                    .skip(1)
                    .fold(part.terms[0].clone(), |a, b| joint(&a, b));
                self.once_each(own.chain(other.terms.iter().map(|b| joint(&all, b))))?
            } else {
                let pairs = part.terms.iter();
                let pairs = pairs.flat_map(|a| other.terms.iter().map(move |b| joint(a, b)));
                self.once_each(own.chain(other.terms.iter().cloned()).chain(pairs))?
            };
            part = Part {
                terms,
                is_plain: false,
            };
        }
    }

    /// Terms joined by `:`.
    fn product(&mut self) -> Result<Part, Error> {
        let mut part = self.atom()?;
        while self.take(':') {
            let other = self.atom()?;
            let mut terms = Vec::new();
            for a in &part.terms {
                let products = other.terms.iter().map(|b| self.times(a, b));
                let products = products.collect::<Result<Vec<Term>, Error>>()?;
                terms = self.once_each(terms.into_iter().chain(products))?;
            }
            part = Part {
                terms,
                is_plain: part.is_plain && other.is_plain,
            };
        }
        Ok(part)
    }

    /// A symbol with its power, 1, `I(...)`, or a sum in brackets with its power.
    fn atom(&mut self) -> Result<Part, Error> {
        let plain = |term| Part {
            terms: vec![term],
            is_plain: true,
        };
        let before = self.rest;
        if self.number("1") {
            return Ok(plain(Term::from_powers(vec![0; self.symbols.len()])));
        }
        if self.take('(') {
            if self.depth == MOST_DEPTH {
                return Err(Error::DeepFormula { most: MOST_DEPTH });
            }
            self.depth += 1;
            let sum = self.sum()?;
            self.depth -= 1;
            if !self.take(')') || sum.through_zero || sum.terms.is_empty() {
                self.rest = before;
                return Err(self.bad());
            }
            let order = if self.take('^') { self.power()? } else { 1 };
            let mut terms = sum.terms.clone();
            for _ in 1..order {
                let pairs = terms.iter();
                let next = pairs.flat_map(|a| sum.terms.iter().map(move |b| joint(a, b)));
                terms = self.once_each(terms.iter().cloned().chain(next))?;
            }
            return Ok(Part {
                terms,
                is_plain: false,
            });
        }
        if let Some(inside) = self.rest.trim_start().strip_prefix("I(") {
            self.rest = inside;
            let mut term = self.powered()?;
            while self.take('*') {
                let next = self.powered()?;
                term = self.times(&term, &next)?;
            }
            if !self.take(')') {
                self.rest = before;
                return Err(self.bad());
            }
            self.as_they_are.push(term.clone());
            return Ok(plain(term));
        }
        Ok(plain(self.powered()?))
    }

    /// A symbol with its power.
    fn powered(&mut self) -> Result<Term, Error> {
        let rest = self.rest.trim_start();
        let is_of_symbol = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let end = rest.find(|c| !is_of_symbol(c)).unwrap_or(rest.len());
        let place = self.symbols.iter().position(|s| s == &rest[..end]);
        let place = place.ok_or_else(|| self.bad())?;
        let before = self.rest;
        self.rest = &rest[end..];
        let power = if self.take('^') {
            self.power().map_err(|_| {
                self.rest = before;
                self.bad()
            })?
        } else {
            1
        };
        let mut powers = vec![0; self.symbols.len()];
        powers[place] = power;
        Ok(Term::from_powers(powers))
    }

    /// A whole number from 1 to the greatest power.
    fn power(&mut self) -> Result<u8, Error> {
        let rest = self.rest.trim_start();
        let end = rest
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(rest.len());
        let power = rest[..end].parse().ok();
        let power = power.filter(|power| (1..=MOST_POWER).contains(power));
        let power = power.ok_or_else(|| self.bad())?;
        self.rest = &rest[end..];
        Ok(power)
    }

    /// Takes a number that stands alone.
    fn number(&mut self, digit: &str) -> bool {
        let rest = self.rest.trim_start();
        let after = rest.strip_prefix(digit);
        let alone =
            |rest: &&str| !rest.starts_with(|c: char| c.is_alphanumeric() || ".^_".contains(c));
        let after = after.filter(alone);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    /// The product of two terms, their powers added.
    fn times(&self, a: &Term, b: &Term) -> Result<Term, Error> {
        let powers = a.powers().iter().zip(b.powers());
        let powers: Vec<u8> = powers.map(|(a, b)| a.saturating_add(*b)).collect();
        let term = Term::from_powers(powers);
        if term.powers().iter().any(|power| *power > MOST_POWER) {
            return Err(self.not_a_term(&spelled(&term, self.symbols)));
        }
        Ok(term)
    }

    /// The terms, each at its first place only; an error as soon as there are more than [`MOST_TERMS`], because two long brackets
    /// cross to millions.
    fn once_each(&self, terms: impl Iterator<Item = Term>) -> Result<Vec<Term>, Error> {
        let (mut kept, mut seen) = (Vec::new(), BTreeSet::new());
        for term in terms {
            if seen.insert(term.powers().to_vec()) {
                kept.push(term);
                self.check_count(kept.len())?;
            }
        }
        Ok(kept)
    }

    /// Refuses more terms than [`MOST_TERMS`].
    fn check_count(&self, terms: usize) -> Result<(), Error> {
        if terms <= MOST_TERMS {
            return Ok(());
        }
        Err(Error::TooManyTerms {
            formula: self.formula.trim().to_owned(),
            most: MOST_TERMS,
        })
    }
}

/// The term that two terms cross to: a factor that both have counts once.
fn joint(a: &Term, b: &Term) -> Term {
    let powers = a.powers().iter().zip(b.powers());
    Term::from_powers(powers.map(|(a, b)| *a.max(b)).collect())
}

/// A term as it is written.
fn spelled(term: &Term, symbols: &[String]) -> String {
    let powers = symbols
        .iter()
        .zip(term.powers())
        .filter(|(_, power)| **power > 0);
    let factors: Vec<String> = powers
        .map(|(symbol, power)| match power {
            1 => symbol.clone(),
            power => format!("{symbol}^{power}"),
        })
        .collect();
    if factors.is_empty() {
        "1".to_owned()
    } else {
        factors.join(":")
    }
}

#[cfg(test)]
mod tests {
    use super::{parse, spelled};
    use crate::Error;

    fn read(formula: &str) -> Result<String, Error> {
        let symbols = ["A", "B", "C", "x.1"].map(str::to_owned);
        let parsed = parse(formula, &symbols)?;
        let names = parsed.terms.iter().map(|term| spelled(term, &symbols));
        let zero = parsed.through_zero.then(|| "0".to_owned());
        Ok(zero.into_iter().chain(names).collect::<Vec<_>>().join(" "))
    }

    /// The terms are those of R's `terms(formula)` (named in its order): attr(terms(~ (A + B + C)^2), "term.labels") and
    /// the like.
    #[test]
    fn operators_give_the_terms_that_r_gives() {
        let cases = [
            ("A*B", "A B A:B"),
            ("A*B*C", "A B A:B C A:C B:C A:B:C"),
            ("(A + B + C)^2", "A B C A:B A:C B:C"),
            ("(A+B+C)^3 - A:B:C", "A B C A:B A:C B:C"),
            ("A*B - A:B", "A B"),
            ("A/B", "A A:B"),
            ("A:(B + C)", "A:B A:C"),
            ("(A + B)*C", "A B C A:C B:C"),
            ("A + I(A^2) + I(A*B)", "A A^2 A:B"),
            ("A - 1", "0 A"),
            ("-1 + A", "0 A"),
            ("0 + A + B", "0 A B"),
            ("A + 0", "0 A"),
            ("A*B + A", "A B A:B"),
            ("x.1*A", "x.1 A A:x.1"),
            ("1 + A", "1 A"),
        ];
        for (formula, expected) in cases {
            assert_eq!(read(formula).unwrap(), expected, "{formula}");
        }
    }

    #[test]
    fn what_is_no_formula_is_refused_with_its_part() {
        for (formula, part) in [
            ("A + D", "D"),
            ("A +", "A +"),
            ("(A + B", "(A"),
            ("A B", "B"),
            ("A^", "A^"),
            ("A^13", "A^13"),
            ("(A+B)^0", "0"),
            ("log(A)", "log(A"),
            ("A - B", "- B"),
            ("I(A + B)", "I(A"),
            ("A^7:A^7", "A^14"),
            ("10 + A", "10"),
            ("A - 0", "- 0"),
            ("y ~ A", "y ~ A"),
            ("", ""),
        ] {
            match read(formula) {
                Err(Error::BadTerm { part: told, .. }) => assert_eq!(told, part, "{formula}"),
                other => panic!("{formula}: {other:?}"),
            }
        }
        let nested = |n: usize| read(&format!("{}A{}", "(".repeat(n), ")".repeat(n)));
        assert_eq!(nested(64).unwrap(), "A");
        for depth in [65, 30_000] {
            assert!(matches!(
                nested(depth),
                Err(Error::DeepFormula { most: 64 })
            ));
        }
        let long = "A + ".repeat(30_000);
        assert!(matches!(read(&long), Err(Error::LongFormula { .. })));
        assert!(matches!(
            read("A + B + A"),
            Err(Error::DuplicateTerm { .. })
        ));
    }
}
