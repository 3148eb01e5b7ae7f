//! Numbers of twice the usual length, for the sums in which digits cancel.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A number held as an unevaluated sum of two, about 32 decimal digits.
///
/// # Source
/// Error-free sum and product: `[Dekker1971]`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Wide {
    /// The number rounded.
    high: f64,
    /// What the rounding left.
    low: f64,
}

impl Wide {
    pub(crate) const ZERO: Self = Self {
        high: 0.0,
        low: 0.0,
    };
    /// One.
    pub(crate) const ONE: Self = Self {
        high: 1.0,
        low: 0.0,
    };

    /// The number rounded to the usual length.
    pub(crate) fn rounded(self) -> f64 {
        self.high + self.low
    }

    /// The number over another: one step of Newton's iteration on the rounded quotient.
    pub(crate) fn divided_by(self, divisor: f64) -> Self {
        let quotient = Self::from(self.rounded() / divisor);
        let rest = self - quotient * Self::from(divisor);
        quotient + Self::from(rest.rounded() / divisor)
    }

    /// The number that a decimal text such as `1000000000000.4` or `-2.5e-3` names, to about 31 digits;
    /// `None` if the text is not a finite number.
    ///
    /// A number of the usual length holds 16 digits, so 12 of the digits of 1000000000000.4 stand
    /// before the point and the 4 behind it is off by up to 6e-5.
    pub(crate) fn from_decimal(text: &str) -> Option<Self> {
        let text = text.trim();
        text.parse::<f64>().ok().filter(|x| x.is_finite())?;
        let (digits, exponent) = match text.split_once(['e', 'E']) {
            Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (negative, digits) = match digits.strip_prefix('-') {
            Some(digits) => (true, digits),
            None => (false, digits.strip_prefix('+').unwrap_or(digits)),
        };
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let mut number = Self::ZERO;
        for digit in whole.chars().chain(fraction.chars()) {
            number = number * Self::from(10.0) + Self::from(f64::from(digit.to_digit(10)?));
        }
        let mut shift = exponent - i32::try_from(fraction.len()).ok()?;
        while shift > 0 {
            number = number * Self::from(10.0);
            shift -= 1;
        }
        while shift < 0 {
            // Powers of ten are exact up to the 22nd.
            let step = (-shift).min(22);
            number = number.divided_by(10.0_f64.powi(step));
            shift += step;
        }
        let number = if negative { -number } else { number };
        number.rounded().is_finite().then_some(number)
    }

    /// The number to a whole power.
    pub(crate) fn power(self, exponent: u8) -> Self {
        (0..exponent).fold(Self::ONE, |product, _| product * self)
    }
}

impl From<f64> for Wide {
    fn from(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }
}

/// a + b and its rounding error.
fn sum(a: f64, b: f64) -> (f64, f64) {
    let total = a + b;
    let of_b = total - a;
    (total, (a - (total - of_b)) + (b - of_b))
}

/// The upper and lower half of the digits of a number.
fn halves(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a;
    let upper = shifted - (shifted - a);
    (upper, a - upper)
}

/// a b and its rounding error.
fn product(a: f64, b: f64) -> (f64, f64) {
    let total = a * b;
    let ((au, al), (bu, bl)) = (halves(a), halves(b));
    (total, ((au * bu - total) + au * bl + al * bu) + al * bl)
}

impl Add for Wide {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, error) = sum(self.high, other.high);
        let (low, rest) = sum(self.low, other.low);
        let (high, error) = sum(high, error + low);
        let (high, low) = sum(high, error + rest);
        Self { high, low }
    }
}

impl Neg for Wide {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Wide {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (high, error) = product(self.high, other.high);
        let (high, low) = sum(
            high,
            error + (self.high * other.low + self.low * other.high),
        );
        Self { high, low }
    }
}

impl AddAssign for Wide {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::Wide;

    /// (1 + 2^-60)^2 - 1 = 2^-59 + 2^-120; plain numbers give 0. The digits beyond 2^-106 are cut.
    #[test]
    fn digits_beyond_the_usual_length_are_kept() {
        let small = 2.0_f64.powi(-60);
        let x = Wide::ONE + Wide::from(small);
        let left = (x * x - Wide::ONE).rounded();
        assert!((left / (2.0 * small) - 1.0).abs() < 1e-13, "{left}");
        let third = Wide::from(0.1) * Wide::from(0.1) - Wide::from(0.1 * 0.1);
        assert!(third.rounded() != 0.0);
    }

    /// 1e12 + 0.4 keeps the 0.4 to 1e-19 (31 digits); read as a usual number it is off by 2e-5.
    #[test]
    fn decimals_are_read_beyond_the_usual_length() {
        let of = |text: &str| Wide::from_decimal(text).unwrap();
        let tenths = (of("1000000000000.4") - Wide::from(1e12)).rounded();
        assert!((tenths - 0.4).abs() < 1e-16, "{tenths}");
        assert!((1_000_000_000_000.4_f64 - 1e12 - 0.4).abs() > 1e-6);
        for text in ["-2.5e-3", "+7", ".5", "3.", "1e30", "1.25E2", "0"] {
            let usual: f64 = text.parse().unwrap();
            assert!(
                (of(text).rounded() - usual).abs() <= 1e-16 * usual.abs(),
                "{text}"
            );
        }
        for text in ["", "x", "1,5", "nan", "inf", "1e999", "0x1"] {
            assert_eq!(Wide::from_decimal(text), None, "{text}");
        }
    }
}
