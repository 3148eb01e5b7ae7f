//! The verification table as a page.

use crate::{Row, Tolerance};
use std::fmt::Write as _;

/// The page with a row for each check, in Markdown; `seedloop verify --json` has every number.
pub fn page(rows: &[Row]) -> String {
    let failed = rows.iter().filter(|r| !r.passes()).count();
    let mut text = format!(
        "# Verification of the solver\n\n\
         Written by `just verify` (`seedloop verify --out docs/verification.md --force`); do not edit. \
         {} rows, {failed} of them FAIL. `seedloop verify` prints each row, `--json` with all digits and the reason of each tolerance.\n\n\
         Analytical: a closed form, a symmetry or a conservation law. Cross-code: an independent \
         integration of the same law. Trend: a sign, a count or an order \
         only. The worst row is the one that uses most of its tolerance.\n\n\
         | check | rows | kinds | worst row | expected | got | tolerance | source |\n\
         |---|--:|---|---|---|---|---|---|\n",
        rows.len()
    );
    for check in rows.chunk_by(|a, b| a.check == b.check) {
        let worst = check
            .iter()
            .max_by(|a, b| used(a).total_cmp(&used(b)))
            .unwrap_or(&check[0]);
        let mut kinds: Vec<&str> = check.iter().map(|r| r.kind.word()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let passes = check.iter().all(Row::passes);
        add(
            &mut text,
            format_args!(
                "| {}{} | {} | {} | {} | {} | {} {} | {} | {} |\n",
                worst.check,
                if passes { "" } else { ": FAIL" },
                check.len(),
                kinds.join(", "),
                worst.name,
                number(worst.expected),
                number(worst.got),
                worst.unit,
                tolerance(worst.tolerance),
                worst.source,
            ),
        );
    }
    text
}

/// Share of its tolerance that a row uses; more than 1 where it fails, 0 for a sign that is right.
fn used(row: &Row) -> f64 {
    let width = match row.tolerance {
        Tolerance::Relative(share) => share * row.expected.abs(),
        Tolerance::Absolute(width) => width,
        Tolerance::Below | Tolerance::Above => 0.0,
    };
    match (row.passes(), width > 0.0) {
        (true, true) => (row.got - row.expected).abs() / width,
        (true, false) => 0.0,
        (false, _) => f64::INFINITY,
    }
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
    use super::{number, page};
    use crate::Tolerance;
    use crate::row::{Basis, Kind};

    /// Of two rows of a check the one with less of its tolerance left is shown, and one that fails is the worst of all.
    #[test]
    fn a_check_shows_its_worst_row_and_fails_with_it() {
        let basis = Basis {
            check: "toy",
            kind: Kind::Analytical,
            tolerance: Tolerance::Absolute(1.0),
            reason: "",
            source: "",
        };
        let near = basis.row("near", "m", 2.0, 2.1);
        let far = basis.row("far", "m", 2.0, 2.9);
        let trend = Basis {
            kind: Kind::Trend,
            ..basis
        };
        let rows = [
            near.clone(),
            far,
            trend.row("sign", "m", 2.0, 2.0),
            near.clone(),
        ];
        let text = page(&rows);
        assert!(
            text.contains("| toy | 4 | Analytical, Trend | far | 2.00000 | 2.90000 m |"),
            "{text}"
        );
        let outside = basis.row("outside", "m", 2.0, 3.5);
        let text = page(&[outside, near]);
        assert!(
            text.contains("| toy: FAIL |") && text.contains("| outside |"),
            "{text}"
        );
    }

    #[test]
    fn numbers_keep_six_digits() {
        assert_eq!(number(0.285714285), "0.285714");
        assert_eq!(number(-1234.5678), "-1234.57");
        assert_eq!(number(1.5e-7), "1.50000e-7");
    }
}
