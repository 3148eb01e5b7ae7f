//! Numbers in readable form.

/// A number with this many significant digits, whatever its size; a dash if it is not finite.
///
/// From 0.001 up to 999 999 it is a decimal, otherwise a power of ten: `36.500`, `1.0000e-7`. Zero is `0`.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = digits.saturating_sub(1);
    // The power of ten of the rounded number: 9.9999 with two digits is 10.
    let rounded = format!("{value:.decimals$e}");
    let exponent: i32 = rounded
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0);
    if !(-3..6).contains(&exponent) {
        return rounded;
    }
    let decimals = i32::try_from(decimals).unwrap_or(0) - exponent;
    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::significant;

    /// The significant digits are kept at every size: fixed decimals would show 1e-7 as 0.00000.
    #[test]
    fn numbers_of_every_size_keep_their_digits() {
        let cases = [
            (36.5, 5, "36.500"),
            (-0.001_234_56, 4, "-0.001235"),
            (1e-7, 5, "1.0000e-7"),
            (123_456.7, 4, "123457"),
            (1_234_567.0, 4, "1.235e6"),
            (9.9999, 2, "10"),
            (0.000_999_999, 3, "0.00100"),
            (999_999.6, 6, "1.00000e6"),
            (0.0, 4, "0"),
            (-0.0, 4, "0"),
            (5.0, 1, "5"),
            (f64::NAN, 4, "-"),
            (f64::INFINITY, 4, "-"),
        ];
        for (value, digits, expected) in cases {
            assert_eq!(significant(value, digits), expected, "{value}");
        }
    }
}
