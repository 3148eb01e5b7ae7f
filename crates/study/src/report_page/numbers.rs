//! Numbers as people read them: with unit, uncertainty and count, a dash where there is none.

use crate::unit_of_name::split_unit;

/// What stands for a number that is not defined.
pub(crate) const DASH: &str = "–";

/// A number with a fixed count of decimals; a dash for one that is not finite.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return DASH.into();
    }
    let text = format!("{value:.decimals$}");
    let digits_are_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    match text.strip_prefix('-') {
        Some(size) if digits_are_zero => size.into(),
        Some(size) => format!("−{size}"),
        None => text,
    }
}

/// As [`fixed`], with a dash for none.
pub(crate) fn fixed_or_dash(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| DASH.into(), |v| fixed(v, decimals))
}

/// A number with its sign.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if value.is_finite() && value >= 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

/// About three digits that count.
pub(crate) fn digits(value: f64) -> String {
    let size = value.abs();
    match size {
        _ if !value.is_finite() => DASH.into(),
        0.0 => "0".into(),
        s if !(1e-4..1e5).contains(&s) => format!("{value:.2e}").replace('-', "−"),
        s if s >= 100.0 => fixed(value, 0),
        s if s >= 10.0 => fixed(value, 1),
        s if s >= 1.0 => fixed(value, 2),
        s if s >= 0.1 => fixed(value, 3),
        s if s >= 0.01 => fixed(value, 4),
        _ => fixed(value, 5),
    }
}

/// As [`digits`], with a dash for none.
pub(crate) fn digits_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| DASH.into(), digits)
}

/// The upper tail of a test.
pub(crate) fn p_value(p: Option<f64>) -> String {
    match p {
        Some(p) if p.is_finite() && p < 1e-4 => "< 0.0001".into(),
        Some(p) => fixed(p, 4),
        None => DASH.into(),
    }
}

/// p in a sentence: "p = 0.0312", "p < 0.0001", "p undefined".
pub(crate) fn p_in_words(p: Option<f64>) -> String {
    match p {
        Some(p) if p.is_finite() && p < 1e-4 => "p < 0.0001".into(),
        Some(p) if p.is_finite() => format!("p = {}", fixed(p, 4)),
        _ => "p undefined".into(),
    }
}

/// A mean in degrees with the standard deviation of its n values, where there is one.
pub(crate) fn degrees(mean: f64, sd: Option<f64>, n: usize) -> String {
    match sd.filter(|sd| sd.is_finite()) {
        Some(sd) => format!("{}° ± {}° (sd, n = {n})", fixed(mean, 2), fixed(sd, 2)),
        None => format!("{}° (n = {n}, no sd)", fixed(mean, 2)),
    }
}

/// The unit of an observable by the ending of its name, and its name in words.
pub(crate) fn observable(name: &str) -> (String, &'static str) {
    let (stem, unit) = split_unit(name).unwrap_or((name, ""));
    (stem.replace('_', " "), unit)
}

/// Names in a sentence; a dash for none.
pub(crate) fn listed(names: &[String]) -> String {
    if names.is_empty() {
        DASH.into()
    } else {
        names.join(", ")
    }
}

/// One of two words by a count.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::{degrees, digits, fixed, fixed_or_dash, p_value, signed};

    #[test]
    fn what_is_not_a_number_is_a_dash_and_never_a_number() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(fixed(value, 2), "–");
            assert_eq!(digits(value), "–");
            assert_eq!(signed(value, 2), "–");
            assert_eq!(p_value(Some(value)), "–");
        }
        assert_eq!(fixed_or_dash(None, 3), "–");
        assert_eq!(p_value(None), "–");
    }

    #[test]
    fn a_mean_carries_unit_uncertainty_and_count() {
        assert_eq!(
            degrees(38.868, Some(0.592), 10),
            "38.87° ± 0.59° (sd, n = 10)"
        );
        assert_eq!(degrees(38.868, None, 1), "38.87° (n = 1, no sd)");
        assert_eq!(degrees(38.868, Some(f64::NAN), 1), "38.87° (n = 1, no sd)");
    }

    #[test]
    fn signs_are_kept_and_a_rounded_zero_has_none() {
        assert_eq!(fixed(-1.256, 2), "−1.26");
        assert_eq!(fixed(-0.0004, 2), "0.00");
        assert_eq!(signed(0.31, 1), "+0.3");
        assert_eq!(signed(-0.31, 1), "−0.3");
    }

    #[test]
    fn three_digits_count_at_every_size_and_small_tails_are_not_rounded_to_zero() {
        assert_eq!(digits(1234.4), "1234");
        assert_eq!(digits(-0.04567), "−0.0457");
        assert_eq!(digits(3.2e-7), "3.20e−7");
        assert_eq!(p_value(Some(3.2e-7)), "< 0.0001");
        assert_eq!(p_value(Some(0.0467)), "0.0467");
    }
}
