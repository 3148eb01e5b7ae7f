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
    /// Zero.
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
}
