//! Numbers as people read them: with unit, uncertainty and count, a dash if there is none.

use crate::unit_of_name::split_unit;

/// Text of a number that is not defined.
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

/// Standard error below which a number counts as exact: rounding, not noise.
const EXACT: f64 = 1e-9;

/// Decimals that show two digits of a standard error, 0 to 9; none for one that is not a size.
pub(crate) fn decimals_of(se: f64) -> Option<usize> {
    if !(se.is_finite() && se > EXACT) {
        return None;
    }
    let mut scaled = se;
    let enough = |_: &usize| {
        // 9.95 is 10 to two digits.
        let enough = scaled >= 9.95;
        scaled *= 10.0;
        enough
    };
    Some((0..9).find(enough).unwrap_or(9))
}

/// A number with as many decimals as its standard error supports; about three digits where it has none.
pub(crate) fn with_decimals_of(value: f64, se: Option<f64>) -> String {
    match se.and_then(decimals_of) {
        Some(decimals) => fixed(value, decimals),
        None => digits(value),
    }
}

/// A number and its standard error with the unit, such as "36.25 ± 0.19°"; an empty unit for a number without unit.
pub(crate) fn with_error(value: f64, se: Option<f64>, unit: &str) -> String {
    let number = with_decimals_of(value, se);
    // A single run has no scatter, and what rounding leaves of one is none.
    let text = match se.filter(|se| se.is_finite() && *se > EXACT) {
        Some(error) => format!("{number} ± {}", with_decimals_of(error, se)),
        None => number,
    };
    in_unit(&text, unit)
}

/// A text followed by a unit; nothing for `1` or an empty unit.
pub(crate) fn in_unit(text: &str, unit: &str) -> String {
    match unit {
        "" | "1" => text.to_owned(),
        "°" | "deg" => format!("{text}°"),
        other => format!("{text} {other}"),
    }
}

/// A unit as a chart or a heading takes it: empty for a plain number.
pub(crate) fn shown_unit(unit: &str) -> &str {
    match unit {
        "1" => "",
        "deg" => "°",
        other => other,
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

#[cfg(test)]
mod tests {
    use super::{digits, fixed, fixed_or_dash, p_value, signed, with_error};

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
    fn a_number_has_as_many_digits_as_its_standard_error_supports() {
        assert_eq!(with_error(36.2468, Some(0.1872), "°"), "36.25 ± 0.19°");
        assert_eq!(with_error(1234.4, Some(31.0), "mm"), "1234 ± 31 mm");
        assert_eq!(with_error(0.33, None, "1"), "0.330");
        assert_eq!(with_error(0.33, Some(f64::INFINITY), ""), "0.330");
        // One run has no scatter, and a smooth plate none beyond rounding.
        assert_eq!(with_error(2.0, Some(0.0), ""), "2.00");
        assert_eq!(with_error(0.32, Some(1.1e-12), ""), "0.320");
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
