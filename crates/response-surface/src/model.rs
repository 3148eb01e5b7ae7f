//! Polynomial models and their formulas.

pub(crate) mod categorical;
pub(crate) mod formula;
pub(crate) mod transform;

use std::fmt;

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::fit::wide::Wide;

/// A product of powers of the coded factors; all powers zero is the intercept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Term {
    /// Power of each factor, (factors).
    powers: Vec<u8>,
}

impl Term {
    /// A term of given powers.
    pub(crate) fn from_powers(powers: Vec<u8>) -> Self {
        Self { powers }
    }

    /// Power of each factor, (factors).
    pub fn powers(&self) -> &[u8] {
        &self.powers
    }

    /// Sum of the powers.
    pub fn degree(&self) -> usize {
        self.powers.iter().map(|&power| usize::from(power)).sum()
    }

    /// Number of factors in the product.
    fn n_factors(&self) -> usize {
        self.powers.iter().filter(|&&power| power > 0).count()
    }

    /// Whether the term is one factor to the power one.
    pub fn is_main_effect(&self) -> bool {
        self.degree() == 1
    }

    /// Whether another term is a factor of this one.
    pub fn contains(&self, other: &Self) -> bool {
        self.powers.iter().zip(&other.powers).all(|(a, b)| a >= b)
    }

    /// Value of the product at a coded point.
    pub fn value(&self, coded: &[f64]) -> f64 {
        let pairs = self.powers.iter().zip(coded);
        pairs.map(|(&power, &x)| x.powi(i32::from(power))).product()
    }

    /// Its derivative along one factor, by its place.
    fn slope(&self, coded: &[f64], place: usize) -> f64 {
        let pairs = self.powers.iter().zip(coded).enumerate();
        let factor = |(j, (&power, &x)): (usize, (&u8, &f64))| match (j == place, power) {
            (false, _) => x.powi(i32::from(power)),
            (true, 0) => 0.0,
            (true, _) => f64::from(power) * x.powi(i32::from(power) - 1),
        };
        pairs.map(factor).product()
    }
}

/// Terms in hierarchical order: intercept, main effects, two-factor interactions, squares, then by
/// degree.
///
/// ```
/// use experiment_design::Factor;
/// use response_surface::Model;
/// let factors = [Factor::coded_only("A")?, Factor::coded_only("B")?];
/// let model = Model::parse("A*B + A^2", &factors)?;
/// assert_eq!(model.to_string(), "1 + A + B + A:B + A^2");
/// assert_eq!(model.row(&[2.0, 3.0]), [1.0, 2.0, 3.0, 6.0, 4.0]);
/// # Ok::<(), response_surface::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "ModelText", try_from = "ModelText")]
pub struct Model {
    /// Symbols of the factors.
    symbols: Vec<String>,
    /// The terms; the first is the intercept, if there is one.
    terms: Vec<Term>,
    /// Places of the terms in the order in which a formula lets them enter the Type I sums of squares.
    entry: Vec<usize>,
}

/// A model as it is in a file.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct ModelText {
    /// Symbols of the factors.
    symbols: Vec<String>,
    /// The terms joined by ` + `.
    formula: String,
    /// Places of the terms in the order in which they enter; missing if it is the order of the formula.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    entry: Option<Vec<usize>>,
}

impl From<Model> for ModelText {
    fn from(model: Model) -> Self {
        Self {
            formula: model.to_string(),
            entry: (!model.entry.is_sorted()).then_some(model.entry),
            symbols: model.symbols,
        }
    }
}

impl TryFrom<ModelText> for Model {
    type Error = Error;

    fn try_from(text: ModelText) -> Result<Self, Error> {
        let model = Self::parse_symbols(&text.formula, text.symbols)?;
        let places = (0..model.terms.len()).collect();
        let entry = text.entry.unwrap_or_else(|| Vec::clone(&places));
        let mut sorted = entry.clone();
        sorted.sort_unstable();
        if sorted != places {
            return Err(Error::Length {
                what: "places of the terms in their order of entry, each once",
                expected: places.len(),
                given: entry.len(),
            });
        }
        Ok(Self { entry, ..model })
    }
}

impl Model {
    /// Reads `mean`, `linear`, `2fi`, `quadratic`, `cubic`, or a formula such as `1 + B + E + B:E + B^2`, with the
    /// operators of R: `B*E` is `B + E + B:E`, `(B + E + F)^2` all main effects and products of two, `B/E` is
    /// `B + B:E`, `I(B^2)` is `B^2`, and `- B:E` takes a term away.
    ///
    /// The intercept is part of the model unless the formula has `0 +` or `- 1`; the response is then 0 where all
    /// **coded** values are. The order of the terms is that of [`Model`], whatever the order in the formula;
    /// [`Model::entry`] keeps that of the formula.
    ///
    /// # Errors
    /// [`Error::BadTerm`], [`Error::DuplicateTerm`], [`Error::TooManyTerms`], or [`Error::Design`] for repeated symbols.
    pub fn parse(formula: &str, factors: &[Factor]) -> Result<Self, Error> {
        experiment_design::check_factors(factors)?;
        let symbols = factors.iter().map(|f| f.symbol().to_owned()).collect();
        Self::parse_symbols(formula, symbols)
    }

    /// All main effects.
    ///
    /// # Errors
    /// [`Error::Design`] for repeated symbols.
    pub fn linear(factors: &[Factor]) -> Result<Self, Error> {
        Self::parse("linear", factors)
    }

    /// All main effects, two-factor interactions and squares.
    ///
    /// # Errors
    /// [`Error::Design`] for repeated symbols.
    pub fn quadratic(factors: &[Factor]) -> Result<Self, Error> {
        Self::parse("quadratic", factors)
    }

    /// A model of products of powers of the factors; `powers` has those of each term, (terms, factors).
    pub fn of_powers(symbols: Vec<String>, powers: Vec<Vec<u8>>) -> Self {
        let terms = powers.into_iter().map(Term::from_powers).collect();
        Self::from_terms(symbols, terms)
    }

    /// Reads a formula over given symbols.
    fn parse_symbols(formula: &str, symbols: Vec<String>) -> Result<Self, Error> {
        let up_to = |degree: usize, keep: &dyn Fn(&Term) -> bool| {
            let all = terms_up_to(degree, symbols.len());
            all.into_iter().filter(|term| keep(term)).collect()
        };
        let mut through_zero = false;
        let mut written = None;
        let mut terms: Vec<Term> = match formula.trim() {
            "mean" => Vec::new(),
            "linear" => up_to(1, &|_| true),
            "2fi" => up_to(2, &|term| term.degree() < 2 || term.n_factors() == 2),
            "quadratic" => up_to(2, &|_| true),
            "cubic" => up_to(3, &|_| true),
            formula => {
                let parsed = formula::parse(formula, &symbols)?;
                through_zero = parsed.through_zero;
                written = Some(parsed.as_they_are);
                parsed.terms
            }
        };
        let intercept = Term {
            powers: vec![0; symbols.len()],
        };
        if through_zero && (terms.is_empty() || terms.contains(&intercept)) {
            return Err(Error::NoIntercept {
                what: "a formula with 0 needs other terms than the intercept",
            });
        }
        if !through_zero && !terms.contains(&intercept) {
            terms.push(intercept);
        }
        let mut entering = terms.clone();
        let model = Self::from_terms(symbols, terms);
        let Some(as_they_are) = written else {
            return Ok(model);
        };
        // R's terms(): products of more factors later, otherwise as written. A power is one factor, and so is I(...).
        entering.sort_by_key(|term| {
            if as_they_are.contains(term) {
                1
            } else {
                term.n_factors()
            }
        });
        Ok(model.entering(&entering))
    }

    /// The same model with its terms entering in the order given, which has each of them once.
    pub(crate) fn entering(mut self, order: &[Term]) -> Self {
        let place = |term: &Term| order.iter().position(|other| other == term);
        self.entry.sort_by_key(|&i| place(&self.terms[i]));
        self
    }

    /// A model of terms in any order.
    pub(crate) fn from_terms(symbols: Vec<String>, mut terms: Vec<Term>) -> Self {
        terms.sort_by_key(|term| {
            // Within a class, earlier factors first: larger leading powers come first.
            let lead = term
                .powers
                .iter()
                .map(|&power| u8::MAX - power)
                .collect::<Vec<_>>();
            (term.degree(), usize::MAX - term.n_factors(), lead)
        });
        Self {
            symbols,
            entry: (0..terms.len()).collect(),
            terms,
        }
    }

    /// All terms up to a degree.
    pub(crate) fn of_degree(degree: usize, symbols: &[String]) -> Self {
        Self::from_terms(symbols.to_vec(), terms_up_to(degree, symbols.len()))
    }

    /// A model of some of the terms of this one, those at `keep` with true.
    pub(crate) fn subset(&self, keep: &[bool]) -> Self {
        let kept = self.terms.iter().zip(keep).filter(|(_, keep)| **keep);
        let entry = self.entry.iter().filter(|&&i| keep[i]);
        Self {
            symbols: self.symbols.clone(),
            terms: kept.map(|(term, _)| term.clone()).collect(),
            entry: entry
                .map(|&i| keep[..i].iter().filter(|keep| **keep).count())
                .collect(),
        }
    }

    /// The same model without the symbols at some places, which occur in no term.
    pub(crate) fn without(&self, places: &[usize]) -> Self {
        fn left<T: Clone>(list: &[T], places: &[usize]) -> Vec<T> {
            let kept = list.iter().enumerate().filter(|(j, _)| !places.contains(j));
            kept.map(|(_, item)| item.clone()).collect()
        }
        let term = |term: &Term| Term {
            powers: left(&term.powers, places),
        };
        Self {
            symbols: left(&self.symbols, places),
            terms: self.terms.iter().map(term).collect(),
            entry: self.entry.clone(),
        }
    }

    /// Whether the intercept is part of the model.
    pub fn has_intercept(&self) -> bool {
        self.terms.first().is_some_and(|term| term.degree() == 0)
    }

    /// Symbols of the factors.
    pub fn symbols(&self) -> &[String] {
        &self.symbols
    }

    /// The terms; the first is the intercept, if there is one.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Places of the terms in the order in which they enter the Type I sums of squares: of a written formula that of R's
    /// `terms()`, products of more factors later and otherwise as written; of a named model that of its terms.
    pub fn entry(&self) -> &[usize] {
        &self.entry
    }

    /// Greatest sum of powers of a term.
    pub fn degree(&self) -> usize {
        self.terms.iter().map(Term::degree).max().unwrap_or(0)
    }

    /// Short name of a term: `1`, `B`, `BE`, `B2` where all symbols are single letters, `mu:e`
    /// and `mu^2` otherwise.
    pub fn name(&self, term: &Term) -> String {
        if self.symbols.iter().all(|symbol| symbol.len() == 1) {
            self.spell(term, "", "")
        } else {
            self.spell(term, ":", "^")
        }
    }

    /// A term as it is printed, by its name: `F²`, `FE`, `mu² e`; the name itself where it is that of no term.
    pub fn printed(&self, name: &str) -> String {
        let Some(term) = self.terms.iter().find(|term| self.name(term) == name) else {
            return name.to_owned();
        };
        let powers = self.symbols.iter().zip(&term.powers);
        let factors: Vec<String> = powers
            .filter(|(_, power)| **power > 0)
            .map(|(symbol, power)| format!("{symbol}{}", raised(*power)))
            .collect();
        let letters = self.symbols.iter().all(|symbol| symbol.len() == 1);
        match factors.as_slice() {
            [] => "1".to_owned(),
            factors => factors.join(if letters { "" } else { " " }),
        }
    }

    /// Names of all terms.
    pub fn names(&self) -> Vec<String> {
        self.terms.iter().map(|term| self.name(term)).collect()
    }

    /// Values of all terms at a coded point: one row of the model matrix.
    pub fn row(&self, coded: &[f64]) -> Vec<f64> {
        self.terms.iter().map(|term| term.value(coded)).collect()
    }

    /// Derivatives of all terms along one factor, by its place, at a coded point.
    pub fn row_slopes(&self, coded: &[f64], place: usize) -> Vec<f64> {
        let slope = |term: &Term| term.slope(coded, place);
        self.terms.iter().map(slope).collect()
    }

    /// The same row in long arithmetic.
    pub(crate) fn wide_row(&self, coded: &[f64]) -> Vec<Wide> {
        let value = |term: &Term| {
            let powers = term
                .powers
                .iter()
                .zip(coded)
                .filter(|(power, _)| **power > 0);
            powers.fold(Wide::ONE, |product, (&power, &x)| {
                product * Wide::from(x).power(power)
            })
        };
        self.terms.iter().map(value).collect()
    }

    /// The terms that hierarchy asks for and the model lacks: the factors of every product.
    pub fn missing_for_hierarchy(&self) -> Vec<String> {
        let mut missing = Vec::new();
        for term in &self.terms {
            for j in (0..self.symbols.len()).filter(|&j| term.powers[j] > 0) {
                let mut below = term.clone();
                below.powers[j] -= 1;
                let name = self.name(&below);
                let wanted = below.degree() > 0 && !self.terms.contains(&below);
                if wanted && !missing.contains(&name) {
                    missing.push(name);
                }
            }
        }
        missing
    }

    /// A term as text with the given joints.
    fn spell(&self, term: &Term, between: &str, before_power: &str) -> String {
        let powers = self
            .symbols
            .iter()
            .zip(&term.powers)
            .filter(|(_, power)| **power > 0);
        let factors: Vec<String> = powers
            .map(|(symbol, &power)| match power {
                1 => symbol.clone(),
                power => format!("{symbol}{before_power}{power}"),
            })
            .collect();
        if factors.is_empty() {
            "1".to_owned()
        } else {
            factors.join(between)
        }
    }
}

impl fmt::Display for Model {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let terms: Vec<String> = self.terms.iter().map(|t| self.spell(t, ":", "^")).collect();
        let zero = if self.has_intercept() { "" } else { "0 + " };
        write!(formatter, "{zero}{}", terms.join(" + "))
    }
}

/// A power as the raised text behind its symbol; empty for the first.
fn raised(power: u8) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if power == 1 {
        return String::new();
    }
    let digits = power.to_string();
    let digits = digits.chars().filter_map(|d| d.to_digit(10));
    digits.filter_map(|d| DIGITS.get(d as usize)).collect()
}

/// All terms of k factors up to a degree.
fn terms_up_to(degree: usize, k: usize) -> Vec<Term> {
    let mut terms = vec![Term { powers: vec![0; k] }];
    let mut first = 0;
    for _ in 0..degree {
        let last = terms.len();
        for i in first..last {
            // Raising only the last factor of a term or later ones makes each product once.
            let from = terms[i].powers.iter().rposition(|&p| p > 0).unwrap_or(0);
            for j in from..k {
                let mut raised = terms[i].clone();
                raised.powers[j] += 1;
                terms.push(raised);
            }
        }
        first = last;
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::Model;
    use crate::Error;
    use experiment_design::Factor;

    fn factors(symbols: &[&str]) -> Vec<Factor> {
        symbols
            .iter()
            .map(|s| Factor::coded_only(s).unwrap())
            .collect()
    }

    #[test]
    fn named_models_have_the_terms_in_hierarchical_order() {
        let f = factors(&["B", "E", "F"]);
        let names = |formula| Model::parse(formula, &f).unwrap().names().join(" ");
        assert_eq!(names("linear"), "1 B E F");
        assert_eq!(names("2fi"), "1 B E F BE BF EF");
        assert_eq!(names("quadratic"), "1 B E F BE BF EF B2 E2 F2");
        assert_eq!(names("B^2 + F:B + B + F + E"), "1 B E F BF B2");
    }

    #[test]
    fn long_symbols_keep_their_joints_and_the_formula_is_read_back() {
        let f = factors(&["mu", "e2"]);
        let model = Model::parse("mu + e2 + mu:e2 + mu^2", &f).unwrap();
        assert_eq!(model.names(), ["1", "mu", "e2", "mu:e2", "mu^2"]);
        let text = serde_json::to_string(&model).unwrap();
        assert_eq!(serde_json::from_str::<Model>(&text).unwrap(), model);
    }

    #[test]
    fn formulas_that_cannot_be_meant_are_refused() {
        let f = factors(&["B", "E"]);
        for formula in ["B + G", "B^0", "B^13", "", "B + ", "2 + B", "B^-1", "B:"] {
            let error = Model::parse(formula, &f).unwrap_err();
            assert!(matches!(error, Error::BadTerm { .. }), "{formula}: {error}");
        }
        let twice = Model::parse("B + E + B", &f);
        assert!(matches!(twice, Err(Error::DuplicateTerm { .. })));
    }

    #[test]
    fn a_zero_takes_the_intercept_away_and_is_read_back() {
        let f = factors(&["x"]);
        let model = Model::parse("0 + x + x^2", &f).unwrap();
        assert_eq!(model.names(), ["x", "x2"]);
        let text = serde_json::to_string(&model).unwrap();
        assert_eq!(serde_json::from_str::<Model>(&text).unwrap(), model);
        assert!(Model::parse("0", &f).is_err());
        assert!(Model::parse("0 + 1 + x", &f).is_err());
    }

    #[test]
    fn a_cubic_of_three_factors_has_twenty_terms() {
        let model = Model::parse("cubic", &factors(&["A", "B", "C"])).unwrap();
        assert_eq!(model.terms().len(), 20);
        assert_eq!(model.names()[10..12], ["ABC", "A2B"]);
    }

    #[test]
    fn squares_are_printed_as_squares() {
        let model = Model::parse("quadratic", &factors(&["B", "E"])).unwrap();
        let printed = |model: &Model| -> Vec<String> {
            let names = model.names();
            names.iter().map(|name| model.printed(name)).collect()
        };
        assert_eq!(printed(&model), ["1", "B", "E", "BE", "B²", "E²"]);
        let long = Model::parse("mu + e2 + mu^2:e2 + mu^12", &factors(&["mu", "e2"])).unwrap();
        assert_eq!(printed(&long), ["1", "mu", "e2", "mu² e2", "mu¹²"]);
        assert_eq!(model.printed("block 2"), "block 2");
    }

    #[test]
    fn hierarchy_names_the_missing_parents() {
        let model = Model::parse("B:E + E", &factors(&["B", "E"])).unwrap();
        assert_eq!(model.missing_for_hierarchy(), ["B"]);
    }
}
