//! The verification table as a page.

use crate::{Row, Tolerance};
use std::fmt::Write as _;

/// The page with all rows, in Markdown.
pub fn page(rows: &[Row]) -> String {
    let failed = rows.iter().filter(|r| !r.passes()).count();
    let mut text = format!(
        "# Verification of the solver\n\n\
         Written by `just verify` (`seedloop verify --out docs/verification.md --force`); do not edit. \
         {} rows, {failed} of them FAIL.\n\n\
         Analytical: a closed form, a symmetry or a conservation law. Cross-code: an independent \
         integration of the same law. Published: a printed number. Trend: a sign, a count or an order \
         only. `rel` is a share of the expected number, `abs` a difference in the unit of the row.\n",
        rows.len()
    );
    let mut check = "";
    for row in rows {
        if row.check != check {
            check = row.check;
            add(
                &mut text,
                format_args!(
                    "\n## {check}\n\n| what | kind | unit | expected | got | tolerance | reason | \
                     source | |\n|---|---|---|---|---|---|---|---|---|\n"
                ),
            );
        }
        let verdict = if row.passes() { "PASS" } else { "FAIL" };
        add(
            &mut text,
            format_args!(
                "| {} | {} | {} | {} | {} | {} | {} | {} | {verdict} |\n",
                row.name,
                row.kind.word(),
                row.unit,
                number(row.expected),
                number(row.got),
                tolerance(row.tolerance),
                row.reason,
                row.source,
            ),
        );
    }
    text
}

/// Appends formatted text.
fn add(text: &mut String, what: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(what);
}

/// A number with six digits.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let size = value.abs();
    if (1e-3..1e6).contains(&size) {
        #[expect(clippy::cast_possible_truncation, reason = "between -3 and 6")]
        let digits = 5 - size.log10().floor() as i32;
        let places = usize::try_from(digits).unwrap_or(0);
        format!("{value:.places$}")
    } else {
        format!("{value:.5e}")
    }
}

/// A tolerance in words.
fn tolerance(tolerance: Tolerance) -> String {
    match tolerance {
        Tolerance::Relative(share) => format!("{share:.1e} rel"),
        Tolerance::Absolute(0.0) => "none".into(),
        Tolerance::Absolute(width) => format!("{width:.1e} abs"),
        Tolerance::Below => "below".into(),
        Tolerance::Above => "above".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_keep_six_digits() {
        assert_eq!(number(0.285714285), "0.285714");
        assert_eq!(number(-1234.5678), "-1234.57");
        assert_eq!(number(1.5e-7), "1.50000e-7");
    }
}
