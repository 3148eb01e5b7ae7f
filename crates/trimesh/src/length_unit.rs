//! The unit of length in which a mesh file is written.

use serde::{Deserialize, Serialize};

/// Unit of the bare numbers in a mesh file (STL itself carries none).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum LengthUnit {
    /// Metre, `m`.
    #[serde(rename = "m")]
    Metre,
    /// Centimetre, `cm`.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetre, `mm`.
    #[default]
    #[serde(rename = "mm")]
    Millimetre,
    /// Micrometre, `um`.
    #[serde(rename = "um")]
    Micrometre,
}

impl LengthUnit {
    /// All units, from large to small.
    pub const ALL: [Self; 4] = [
        Self::Metre,
        Self::Centimetre,
        Self::Millimetre,
        Self::Micrometre,
    ];

    /// Length of one unit, m.
    pub fn in_metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Micrometre => 1e-6,
        }
    }

    /// Symbol as written in files and flags.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
        }
    }
}

impl std::fmt::Display for LengthUnit {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.symbol())
    }
}

impl std::str::FromStr for LengthUnit {
    type Err = crate::Error;

    /// Reads `mm`, `cm`, `m` or `um`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|unit| unit.symbol() == text)
            .ok_or_else(|| crate::Error::UnknownUnit {
                found: text.to_owned(),
            })
    }
}
