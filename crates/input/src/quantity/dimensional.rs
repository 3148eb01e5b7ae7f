//! Quantities that carry a dimension: read as text with a unit, held in SI.

use std::fmt;
use std::str::FromStr;

use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::quantity::error::Error;
use crate::quantity::unit::{Kind, find};

/// Whether a kind of quantity can be negative.
#[derive(Clone, Copy)]
enum Sign {
    /// Any finite value: coordinates, turning directions, suction.
    Any,
    /// Zero and more: durations and rates.
    NotNegative,
    /// More than zero: masses and densities.
    Positive,
}

/// Splits text into its leading decimal number and the rest, which is trimmed.
///
/// The words for infinity and not-a-number, which Rust would read, are refused.
fn split_number(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let digits_from = |start: usize| {
        start
            + bytes[start..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count()
    };
    let sign_from =
        |start: usize| start + usize::from(matches!(bytes.get(start), Some(b'+' | b'-')));
    let mut end = digits_from(sign_from(0));
    if bytes.get(end) == Some(&b'.') {
        end = digits_from(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let exponent = sign_from(end + 1);
        if digits_from(exponent) > exponent {
            end = digits_from(exponent);
        }
    }
    (&text[..end], text[end..].trim())
}

/// Reads text such as `0.45 mm` as a quantity of the expected kind, in SI.
fn parse_si(text: &str, expected: Kind) -> Result<f64, Error> {
    let text = text.trim();
    let (number_text, unit_text) = split_number(text);
    let no_number = || Error::NoNumber {
        text: text.to_owned(),
        expected,
    };
    let number: f64 = number_text.parse().map_err(|_| no_number())?;
    if unit_text.starts_with([',', '.']) {
        return Err(no_number());
    }
    if unit_text.is_empty() {
        return Err(Error::NoUnit {
            text: text.to_owned(),
            expected,
        });
    }
    let unit = find(unit_text).ok_or_else(|| Error::UnknownUnit {
        text: text.to_owned(),
        unit: unit_text.to_owned(),
        expected,
    })?;
    if unit.kind != expected {
        return Err(Error::WrongKind {
            text: text.to_owned(),
            found: unit.kind,
            expected,
        });
    }
    Ok(unit.to_si(number))
}

/// Checks that an SI value is finite and has a possible sign.
fn check(value: f64, kind: Kind, what: &'static str, sign: Sign) -> Result<f64, Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite { what, value });
    }
    let limit = match sign {
        Sign::NotNegative if value < 0.0 => "0 or more",
        Sign::Positive if value <= 0.0 => "more than 0",
        Sign::Any | Sign::NotNegative | Sign::Positive => return Ok(value),
    };
    Err(Error::OutOfRange {
        what,
        value: format!("{value} {}", kind.si_unit()),
        limit,
        way_out: "check the sign and the unit",
    })
}

/// Reads a quantity as text with a unit, and refuses bare numbers with the accepted units.
struct TextWithUnit(Kind);

impl TextWithUnit {
    /// Makes the error for a number without unit.
    fn bare<E: de::Error>(&self, number: impl fmt::Display) -> E {
        E::custom(Error::NoUnit {
            text: number.to_string(),
            expected: self.0,
        })
    }
}

impl Visitor<'_> for TextWithUnit {
    type Value = f64;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} such as \"{}\"", self.0, self.0.example())
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<f64, E> {
        parse_si(text, self.0).map_err(E::custom)
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<f64, E> {
        Err(self.bare(number))
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<f64, E> {
        Err(self.bare(number))
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<f64, E> {
        Err(self.bare(number))
    }
}

/// Defines one quantity: a finite number of SI units of its kind.
macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $what:literal, $sign:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// The kind of this quantity.
            pub const KIND: Kind = Kind::$name;

            /// Makes the quantity from a number of SI units (radians for angles).
            ///
            /// # Errors
            /// A value that is not finite or has an impossible sign.
            pub fn from_si(value: f64) -> Result<Self, Error> {
                check(value, Self::KIND, $what, $sign).map(Self)
            }

            /// Reads text made of a decimal number and a unit.
            ///
            /// # Errors
            /// No number, no unit, an unknown unit, a unit of another kind, a value that is
            /// not finite or has an impossible sign.
            pub fn parse(text: &str) -> Result<Self, Error> {
                Self::from_si(parse_si(text, Self::KIND)?)
            }

            /// Returns the value in SI units (radians for angles).
            pub const fn si(self) -> f64 {
                self.0
            }

            /// Returns the value itself if it is more than zero.
            ///
            /// # Errors
            /// A value of zero or less; the message calls it `what`.
            pub fn require_positive(self, what: &'static str) -> Result<Self, Error> {
                check(self.0, Self::KIND, what, Sign::Positive).map(Self)
            }
        }

        impl fmt::Display for $name {
            /// Writes the value in its SI unit, with as many digits as it takes to read the
            /// same value back.
            fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(formatter, "{} {}", self.0, Self::KIND.si_unit())
            }
        }

        impl FromStr for $name {
            type Err = Error;

            fn from_str(text: &str) -> Result<Self, Error> {
                Self::parse(text)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let value = deserializer.deserialize_any(TextWithUnit(Self::KIND))?;
                Self::from_si(value).map_err(de::Error::custom)
            }
        }
    };
}

quantity!(
    /// A length or a coordinate, m.
    Length, "a length", Sign::Any
);
quantity!(
    /// A plane angle, rad; positive counter-clockwise.
    Angle, "an angle", Sign::Any
);
quantity!(
    /// An angular speed, rad/s; positive counter-clockwise.
    AngularSpeed, "an angular speed", Sign::Any
);
quantity!(
    /// A duration, s; never negative.
    Time, "a time", Sign::NotNegative
);
quantity!(
    /// A mass, kg; more than zero.
    Mass, "a mass", Sign::Positive
);
quantity!(
    /// A mass per volume, kg/m3; more than zero.
    Density, "a density", Sign::Positive
);
quantity!(
    /// A pressure, a stress or an elastic modulus, Pa.
    Pressure, "a pressure", Sign::Any
);
quantity!(
    /// A linear speed, m/s.
    Speed, "a speed", Sign::Any
);
quantity!(
    /// A rate of events, Hz; never negative.
    Frequency, "a frequency", Sign::NotNegative
);
