//! The charts, one a file, and what they share.

pub(crate) mod bars_with_target;
pub(crate) mod contour;
pub(crate) mod cube;
pub(crate) mod design_runs;
pub(crate) mod half_normal;
pub(crate) mod line_series;
pub(crate) mod pareto;
pub(crate) mod predicted_against_measured;
pub(crate) mod residuals;
pub(crate) mod scatter;
pub(crate) mod stacked_bars;
pub(crate) mod surface;
pub(crate) mod timeseries;

use serde::{Deserialize, Serialize};

/// Title of an axis: what is shown and in which unit.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AxisTitle {
    /// What is shown, such as "Repose angle".
    pub quantity: String,
    /// Its unit, such as "°"; empty for a number without unit.
    pub unit: String,
}

impl AxisTitle {
    /// A title; an empty unit for a number without unit.
    pub fn new(quantity: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            quantity: quantity.into(),
            unit: unit.into(),
        }
    }

    /// Whether there is nothing to write.
    pub(crate) fn is_empty(&self) -> bool {
        self.quantity.is_empty() && self.unit.is_empty()
    }

    /// "Quantity (unit)", with a factor such as "×10⁶" before the unit where there is one.
    pub(crate) fn text(&self, factor: &str) -> String {
        let unit = match (factor.is_empty(), self.unit.is_empty()) {
            (true, _) => self.unit.clone(),
            (false, true) => factor.to_owned(),
            (false, false) => format!("{factor} {}", self.unit),
        };
        match (self.quantity.is_empty(), unit.is_empty()) {
            (_, true) => self.quantity.clone(),
            (true, false) => format!("({unit})"),
            (false, false) => format!("{} ({unit})", self.quantity),
        }
    }
}

/// A named line across a chart, such as a limit or a target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// What the line is.
    pub name: String,
    /// Where it lies, in the unit of its axis.
    pub value: f64,
}

impl Level {
    /// A named line at a value in the unit of its axis.
    pub fn new(name: impl Into<String>, value: f64) -> Self {
        Self {
            name: name.into(),
            value,
        }
    }
}
