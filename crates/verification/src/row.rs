//! One line of the verification table.

use serde::Serialize;

/// Basis of the expected number, strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Kind {
    /// A closed form, a symmetry or a conservation law.
    Analytical,
    /// An independent integration of the same law, or another code.
    #[serde(rename = "Cross-code")]
    CrossCode,
    /// A sign or an order only.
    Trend,
}

impl Kind {
    /// The word in the table.
    pub fn word(self) -> &'static str {
        match self {
            Self::Analytical => "Analytical",
            Self::CrossCode => "Cross-code",
            Self::Trend => "Trend",
        }
    }
}

/// How far a number may be off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tolerance {
    /// Largest difference over the size of the expected number.
    Relative(f64),
    /// Largest difference, in the unit of the row.
    Absolute(f64),
    /// The number must be below the expected one.
    Below,
    /// The number must be above the expected one.
    Above,
}

/// A comparison of one number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name of the check to which it belongs.
    pub check: &'static str,
    /// Compared quantity, with the conditions.
    pub name: String,
    /// Basis of the expected number.
    pub kind: Kind,
    /// Unit of the numbers.
    pub unit: &'static str,
    /// The number that does not come from the solver.
    pub expected: f64,
    /// The number that the solver gives.
    pub got: f64,
    /// How far it may be off.
    pub tolerance: Tolerance,
    /// Why so far.
    pub reason: &'static str,
    /// Where the expected number comes from.
    pub source: &'static str,
}

impl Row {
    /// Whether the number is within the tolerance; a number that is not finite is not.
    pub fn passes(&self) -> bool {
        let difference = (self.got - self.expected).abs();
        self.got.is_finite()
            && match self.tolerance {
                Tolerance::Relative(share) => difference <= share * self.expected.abs(),
                Tolerance::Absolute(width) => difference <= width,
                Tolerance::Below => self.got < self.expected,
                Tolerance::Above => self.got > self.expected,
            }
    }
}

/// What the rows of one comparison share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Basis {
    /// Name of the check.
    pub(crate) check: &'static str,
    pub(crate) kind: Kind,
    pub(crate) tolerance: Tolerance,
    /// Why so far.
    pub(crate) reason: &'static str,
    pub(crate) source: &'static str,
}

impl Basis {
    /// A row: name, unit, expected, got.
    pub(crate) fn row(
        &self,
        name: impl Into<String>,
        unit: &'static str,
        expected: f64,
        got: f64,
    ) -> Row {
        Row {
            check: self.check,
            name: name.into(),
            kind: self.kind,
            unit,
            expected,
            got,
            tolerance: self.tolerance,
            reason: self.reason,
            source: self.source,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Basis, Kind, Tolerance};

    fn passes(expected: f64, got: f64, tolerance: Tolerance) -> bool {
        let basis = Basis {
            check: "test",
            kind: Kind::Analytical,
            tolerance,
            reason: "",
            source: "",
        };
        basis.row("a number", "1", expected, got).passes()
    }

    #[test]
    fn rows_pass_within_their_tolerance_only() {
        assert!(passes(-2.0, -2.1, Tolerance::Relative(0.06)));
        assert!(!passes(-2.0, -2.1, Tolerance::Relative(0.04)));
        assert!(passes(0.0, 1e-3, Tolerance::Absolute(1e-3)));
        assert!(!passes(0.0, 2e-3, Tolerance::Absolute(1e-3)));
        assert!(passes(1.0, 0.9, Tolerance::Below) && !passes(1.0, 1.0, Tolerance::Below));
        assert!(passes(1.0, 1.1, Tolerance::Above) && !passes(1.0, 1.0, Tolerance::Above));
        let wrong = [f64::NAN, f64::INFINITY];
        assert!(
            wrong.iter().all(|&v| !passes(1.0, v, Tolerance::Above)),
            "not finite"
        );
    }
}
