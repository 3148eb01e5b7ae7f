//! A factor: a quantity that the experiment varies between two bounds.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::Error;

/// A quantity varied between a low and a high level.
///
/// # Formula
/// coded x = (u - (low + high)/2) / ((high - low)/2), so low is -1 and high is +1.
/// u is the natural value in the unit of the factor.
///
/// ```
/// use experiment_design::Factor;
/// let friction = Factor::new("B", "static friction seed-steel", "1", 0.30, 0.42)?;
/// assert!((friction.coded(0.33) + 0.5).abs() < 1e-12);
/// assert_eq!(friction.natural(1.0), 0.42);
/// # Ok::<(), experiment_design::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawFactor")]
pub struct Factor {
    /// Short name, used as column name and in model formulas.
    symbol: String,
    /// Name of the factor.
    name: String,
    /// Unit of `low` and `high`; `1` if dimensionless.
    unit: String,
    /// Natural value at coded -1, `unit`.
    low: f64,
    /// Natural value at coded +1, `unit`.
    high: f64,
}

/// A factor before it is checked.
#[derive(Debug, Deserialize)]
struct RawFactor {
    /// Short name.
    symbol: String,
    #[serde(default)]
    name: String,
    /// Unit of the bounds.
    #[serde(default)]
    unit: String,
    /// Natural value at coded -1.
    low: f64,
    /// Natural value at coded +1.
    high: f64,
}

impl TryFrom<RawFactor> for Factor {
    type Error = Error;

    fn try_from(raw: RawFactor) -> Result<Self, Error> {
        Self::new(&raw.symbol, &raw.name, &raw.unit, raw.low, raw.high)
    }
}

impl Factor {
    /// Makes a factor; `low` and `high` are in `unit` (`1` or empty if dimensionless).
    ///
    /// # Errors
    /// [`Error::BadSymbol`], [`Error::BoundNotFinite`], or [`Error::EmptyRange`] unless
    /// low < high and the half-range is a finite, non-zero number.
    pub fn new(symbol: &str, name: &str, unit: &str, low: f64, high: f64) -> Result<Self, Error> {
        check_symbol(symbol)?;
        for (bound, value) in [("low", low), ("high", high)] {
            if !value.is_finite() {
                let symbol = symbol.to_owned();
                return Err(Error::BoundNotFinite {
                    symbol,
                    bound,
                    value,
                });
            }
        }
        let half_range = high / 2.0 - low / 2.0;
        if !(half_range > 0.0 && half_range.is_finite()) {
            let (symbol, unit) = (symbol.to_owned(), unit.to_owned());
            return Err(Error::EmptyRange {
                symbol,
                low,
                high,
                unit,
            });
        }
        let unit = if unit.is_empty() { "1" } else { unit };
        Ok(Self {
            symbol: symbol.to_owned(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            low,
            high,
        })
    }

    /// A factor whose natural and coded values are the same, -1 to +1.
    ///
    /// # Errors
    /// [`Error::BadSymbol`].
    pub fn coded_only(symbol: &str) -> Result<Self, Error> {
        Self::new(symbol, "", "1", -1.0, 1.0)
    }

    /// Short name.
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// Name of the factor.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Unit of the natural values; `1` if dimensionless.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// Natural value at coded -1, unit of the factor.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// Natural value at coded +1, unit of the factor.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Natural value at coded 0, unit of the factor.
    pub fn mid(&self) -> f64 {
        self.low / 2.0 + self.high / 2.0
    }

    /// Natural length of one coded unit, unit of the factor.
    pub fn half_range(&self) -> f64 {
        self.high / 2.0 - self.low / 2.0
    }

    /// Coded value of a natural value.
    pub fn coded(&self, natural: f64) -> f64 {
        (natural - self.mid()) / self.half_range()
    }

    /// Natural value of a coded value, unit of the factor; exact at -1 and +1.
    pub fn natural(&self, coded: f64) -> f64 {
        if coded <= 0.0 {
            self.low + (1.0 + coded) * self.half_range()
        } else {
            self.high - (1.0 - coded) * self.half_range()
        }
    }
}

/// Checks that there are factors and that no symbol is used twice.
///
/// # Errors
/// [`Error::NoFactors`] or [`Error::DuplicateSymbol`].
pub fn check_factors(factors: &[Factor]) -> Result<(), Error> {
    if factors.is_empty() {
        return Err(Error::NoFactors);
    }
    let mut seen = BTreeSet::new();
    match factors.iter().find(|factor| !seen.insert(factor.symbol())) {
        Some(factor) => Err(Error::DuplicateSymbol {
            symbol: factor.symbol.clone(),
        }),
        None => Ok(()),
    }
}

/// Checks that a symbol can be a column name and part of a formula.
fn check_symbol(symbol: &str) -> Result<(), Error> {
    let reserved = ["run", "cell", "replicate", "block"];
    let starts_well = symbol.starts_with(|c: char| c.is_ascii_alphabetic());
    let all_well = symbol
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
    if starts_well && all_well && !reserved.contains(&symbol) && !symbol.ends_with("_natural") {
        return Ok(());
    }
    Err(Error::BadSymbol {
        symbol: symbol.to_owned(),
    })
}

/// Factors x0, x1, ... that are their own coded values, for tests.
#[cfg(test)]
pub(crate) fn coded_factors(k: usize) -> Vec<Factor> {
    let factor = |i| Factor::coded_only(&format!("x{i}")).expect("a symbol");
    (0..k).map(factor).collect()
}

#[cfg(test)]
mod tests {
    use super::{Factor, check_factors};
    use crate::Error;

    /// Coding is affine: the bounds are exact, other points agree to rounding (1e-15 of the range).
    #[test]
    fn coding_maps_bounds_to_plus_and_minus_one_and_back() {
        let f = Factor::new("E", "restitution", "1", 0.01, 0.18).unwrap();
        assert_eq!(f.natural(-1.0), 0.01);
        assert_eq!(f.natural(1.0), 0.18);
        for x in [-1.7, -1.0, -0.3, 0.0, 0.411, 1.0, 2.0] {
            assert!((f.coded(f.natural(x)) - x).abs() < 1e-14, "at {x}");
        }
    }

    #[test]
    fn factors_that_cannot_be_meant_are_refused() {
        assert!(matches!(
            Factor::new("B", "", "1", 0.4, 0.3),
            Err(Error::EmptyRange { .. })
        ));
        assert!(matches!(
            Factor::new("B", "", "1", 0.4, 0.4),
            Err(Error::EmptyRange { .. })
        ));
        assert!(matches!(
            Factor::new("B", "", "1", f64::NAN, 0.3),
            Err(Error::BoundNotFinite { bound: "low", .. })
        ));
        for symbol in ["", "2B", "B:E", "run", "B_natural", "a b"] {
            assert!(
                matches!(
                    Factor::new(symbol, "", "1", 0.0, 1.0),
                    Err(Error::BadSymbol { .. })
                ),
                "'{symbol}' was taken"
            );
        }
        let twice = [
            Factor::coded_only("B").unwrap(),
            Factor::coded_only("B").unwrap(),
        ];
        assert!(matches!(
            check_factors(&twice),
            Err(Error::DuplicateSymbol { .. })
        ));
        assert_eq!(check_factors(&[]), Err(Error::NoFactors));
    }
}
