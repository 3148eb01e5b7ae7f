//! A response on another scale, and the way back.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A monotonic function of the response, fitted in its place.
///
/// # Source
/// The family of powers: `[BoxCox1964]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transform {
    /// Natural logarithm; the response must be above zero.
    Ln,
    /// Decimal logarithm; the response must be above zero.
    Log10,
    /// Square root; the response must not be below zero.
    Sqrt,
    /// 1 / y; the response must be above zero.
    Inverse,
    /// A power that is not zero; the response must be above zero.
    Power(f64),
}

impl Transform {
    /// The value on the scale of the fit; `None` outside its domain or if it is not finite.
    pub fn forward(self, y: f64) -> Option<f64> {
        let inside = match self {
            Self::Sqrt => y >= 0.0,
            _ => y > 0.0,
        };
        let value = match self {
            Self::Ln => y.ln(),
            Self::Log10 => y.log10(),
            Self::Sqrt => y.sqrt(),
            Self::Inverse => 1.0 / y,
            Self::Power(power) => y.powf(power),
        };
        Some(value).filter(|value| inside && value.is_finite())
    }

    /// The response at a value of the fit; `None` if no response has that value, such as a square root below zero.
    pub fn back(self, z: f64) -> Option<f64> {
        let value = match self {
            Self::Ln => z.exp(),
            Self::Log10 => 10.0_f64.powf(z),
            Self::Sqrt if z >= 0.0 => z * z,
            Self::Inverse if z > 0.0 => 1.0 / z,
            Self::Power(power) if z > 0.0 => z.powf(1.0 / power),
            _ => return None,
        };
        Some(value).filter(|value| value.is_finite())
    }

    /// The interval of the response behind an interval of the fit, lower end first. An end outside the domain is none: the
    /// interval is open there. Quantiles go over as they are, so an interval of the mean becomes one of the median.
    pub fn back_interval(self, [low, high]: [f64; 2]) -> [Option<f64>; 2] {
        let ends = [self.back(low), self.back(high)];
        if self.falls() {
            [ends[1], ends[0]]
        } else {
            ends
        }
    }

    /// Whether the function falls where the response rises.
    pub fn falls(self) -> bool {
        match self {
            Self::Inverse => true,
            Self::Power(power) => power < 0.0,
            _ => false,
        }
    }

    /// Slope of the function at a response, unit of the fit per unit of the response; none outside its domain.
    pub fn slope(self, y: f64) -> Option<f64> {
        self.forward(y)?;
        let slope = match self {
            Self::Ln => 1.0 / y,
            Self::Log10 => 1.0 / (y * std::f64::consts::LN_10),
            Self::Sqrt => 0.5 / y.sqrt(),
            Self::Inverse => -1.0 / (y * y),
            Self::Power(power) => power * y.powf(power - 1.0),
        };
        Some(slope).filter(|slope| slope.is_finite())
    }

    /// Requirement on a response.
    pub fn domain(self) -> &'static str {
        match self {
            Self::Sqrt => "zero or above",
            _ => "above zero",
        }
    }

    /// A response on the scale of the fit, in words: `ln(y)`.
    pub fn of(self, response: &str) -> String {
        match self {
            Self::Ln => format!("ln({response})"),
            Self::Log10 => format!("log10({response})"),
            Self::Sqrt => format!("sqrt({response})"),
            Self::Inverse => format!("1/{response}"),
            Self::Power(power) => format!("{response}^{power}"),
        }
    }
}

impl fmt::Display for Transform {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Ln => formatter.write_str("ln"),
            Self::Log10 => formatter.write_str("log10"),
            Self::Sqrt => formatter.write_str("sqrt"),
            Self::Inverse => formatter.write_str("inverse"),
            Self::Power(power) => write!(formatter, "power:{power}"),
        }
    }
}

impl FromStr for Transform {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let power = |power: &str| {
            power
                .parse()
                .ok()
                .filter(|p: &f64| p.is_finite() && *p != 0.0)
        };
        match (text, text.strip_prefix("power:").and_then(power)) {
            ("ln" | "log", _) => Ok(Self::Ln),
            ("log10", _) => Ok(Self::Log10),
            ("sqrt", _) => Ok(Self::Sqrt),
            ("inverse", _) => Ok(Self::Inverse),
            (_, Some(power)) => Ok(Self::Power(power)),
            _ => Err(format!(
                "'{text}' is not a transformation; write ln, log10, sqrt, inverse or power:P with P other than 0"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Transform;

    const ALL: [Transform; 6] = [
        Transform::Ln,
        Transform::Log10,
        Transform::Sqrt,
        Transform::Inverse,
        Transform::Power(0.3),
        Transform::Power(-2.0),
    ];

    /// Back is the inverse of forward, ends stay in order, and the slope is that of differences (order h^2: 1e-9).
    #[test]
    fn every_transformation_has_its_way_back() {
        for transform in ALL {
            for y in [0.2, 1.0, 37.5] {
                let z = transform.forward(y).unwrap();
                assert!(
                    (transform.back(z).unwrap() / y - 1.0).abs() < 1e-14,
                    "{transform} {y}"
                );
                let h = 1e-5 * y;
                let [above, below] = [y + h, y - h].map(|y| transform.forward(y).unwrap());
                let slope = transform.slope(y).unwrap();
                assert!(
                    ((above - below) / (2.0 * h * slope) - 1.0).abs() < 1e-8,
                    "{transform} {y}"
                );
                let ends = [above.min(below), above.max(below)];
                let [low, high] = transform.back_interval(ends).map(Option::unwrap);
                assert!(low < y && y < high, "{transform} {y}: {low} to {high}");
            }
            assert_eq!(transform.forward(-1.0), None);
            assert_eq!(transform.to_string().parse(), Ok(transform));
        }
        assert_eq!(Transform::Ln.forward(0.0), None);
        assert_eq!(
            Transform::Sqrt.back_interval([-0.1, 2.0]),
            [None, Some(4.0)]
        );
        assert_eq!(
            Transform::Inverse.back_interval([-0.1, 2.0]),
            [Some(0.5), None]
        );
        assert!("power:0".parse::<Transform>().is_err() && "cube".parse::<Transform>().is_err());
    }
}
