//! What the measurements leave open, in words.

use crate::numbers::{digits, signed};
use inference::{Estimate, OpenCombination};

/// Weights below this are not named: such a parameter moves by less than a tenth of the length of the combination.
const NAMED_WEIGHT: f64 = 0.1;
/// Two weights count as equal where their ratio differs from 1 by less than this.
const EQUAL: f64 = 0.05;

/// A combination that the measurements leave open, and what they fix instead, in words.
///
/// # Formula
/// Along the combination parameter j moves by `d_j = w_j` times the width of its limits. Of two parameters i and j the
/// measurements fix the combination that does not change along it: `x_i - (d_i / d_j) x_j`.
pub fn open_in_words(open: &OpenCombination, parameters: &[Estimate]) -> String {
    let moved: Vec<(&Estimate, f64)> = parameters
        .iter()
        .filter_map(|p| Some((p, *open.weights.get(&p.symbol)?)))
        .filter(|(_, weight)| weight.abs() >= NAMED_WEIGHT)
        .collect();
    let width = |p: &Estimate| p.limits[1] - p.limits[0];
    let known = match open.se_in_widths {
        Some(se) if se < 100.0 => format!(
            "the standard error along it is {} of the width of the limits",
            digits(se)
        ),
        _ => "nothing limits it".to_owned(),
    };
    match moved.as_slice() {
        [(p, _)] => format!(
            "These measurements do not fix {} ({}): {known}.",
            p.symbol, p.name
        ),
        [(a, weight_a), (b, weight_b)] => {
            let slope = -(weight_a * width(a)) / (weight_b * width(b));
            let how = if weight_a * weight_b < 0.0 {
                format!("{} may rise while {} falls", a.symbol, b.symbol)
            } else {
                format!("{} and {} may rise together", a.symbol, b.symbol)
            };
            format!(
                "These measurements fix only {}: {how}, and {known}.",
                fixed_part(a, b, slope)
            )
        }
        several => {
            let terms: Vec<String> = several
                .iter()
                .map(|(p, weight)| format!("{} {}", signed(*weight, 2), p.symbol))
                .collect();
            format!(
                "These measurements do not fix the combination {} (weights in widths of the limits): {known}.",
                terms.join(" ")
            )
        }
    }
}

/// What stays fixed of two parameters, a + slope b, in words.
fn fixed_part(a: &Estimate, b: &Estimate, slope: f64) -> String {
    if (slope.abs() - 1.0).abs() < EQUAL {
        let word = if slope > 0.0 { "sum" } else { "difference" };
        return format!("the {word} of {} and {}", a.symbol, b.symbol);
    }
    let sign = if slope < 0.0 { "−" } else { "+" };
    format!(
        "the combination {} {sign} {} {}",
        a.symbol,
        digits(slope.abs()),
        b.symbol
    )
}

#[cfg(test)]
mod tests {
    use super::open_in_words;
    use crate::test_input::estimate;
    use inference::{Estimate, OpenCombination};
    use std::collections::BTreeMap;

    /// Three parameters whose limits are 1.5, 1.5 and 0.5 wide.
    fn parameters() -> Vec<Estimate> {
        let mut narrow = estimate("R", 0.1, None);
        narrow.limits = [0.0, 0.5];
        vec![estimate("F", 0.3, None), estimate("E", 0.4, None), narrow]
    }

    /// A combination in words.
    fn words(weights: &[(&str, f64)], se: Option<f64>) -> String {
        let weights: BTreeMap<String, f64> =
            weights.iter().map(|(s, w)| ((*s).to_owned(), *w)).collect();
        let open = OpenCombination {
            weights,
            se_in_widths: se,
        };
        open_in_words(&open, &parameters())
    }

    /// What moves against each other leaves the sum as it is, what moves together the difference; weights count in
    /// widths of the limits, so that a narrow parameter moves by less: with weights 0.8 and -0.6 in widths of 1.5 and
    /// 0.5 the moves are 1.2 and -0.3, and F + 4 R stays.
    #[test]
    fn an_open_combination_says_what_stays_fixed() {
        let sum = words(&[("F", 0.71), ("E", -0.70), ("R", 0.02)], Some(0.31));
        assert!(sum.contains("fix only the sum of F and E"), "{sum}");
        assert!(sum.contains("0.310 of the width"), "{sum}");
        let difference = words(&[("F", 0.7), ("E", 0.7)], None);
        assert!(
            difference.contains("fix only the difference of F and E"),
            "{difference}"
        );
        assert!(
            difference.contains("may rise together, and nothing limits it"),
            "{difference}"
        );
        let weighted = words(&[("F", 0.8), ("R", -0.6)], None);
        assert!(
            weighted.contains("the combination F + 4.00 R"),
            "{weighted}"
        );
        let one = words(&[("E", -1.0)], None);
        assert!(
            one.contains("do not fix E (name of E): nothing limits it"),
            "{one}"
        );
        let three = words(&[("F", 0.6), ("E", -0.6), ("R", 0.53)], None);
        assert!(three.contains("+0.60 F −0.60 E +0.53 R"), "{three}");
    }
}
