//! Which convention another code reads in another way, by the diagnosis that finds missing effects.
//!
//! The small cases are the observables, the conventions the rival effects. The slopes of [`inference::diagnosis`] decide whether
//! there is anything to explain and which conventions could be seen; runs of the reference integrator with each convention
//! changed, its factor fitted, decide between them. One change is tried first, then two, then three together.

use crate::Error;
use crate::advice::{Difference, difference};
use crate::bench::{Bench, Fitted};
use crate::convention::{CONVENTIONS, concerns};
use crate::expected::Expected;
use crate::model::Model;
use inference::diagnosis::{Diagnosis, Verdict};
use serde::Serialize;

/// Standard deviations within which bed and heap must lie.
const WIDEST: f64 = 3.5;

/// A number beside what was expected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What was expected.
    #[serde(flatten)]
    pub expected: Expected,
    /// What the other code gave.
    pub got: f64,
    /// Difference in bands.
    pub z: f64,
}

/// The answer of a check.
#[derive(Debug, Clone, Serialize)]
pub struct Checked {
    /// Whether all numbers agree.
    pub agrees: bool,
    /// Verdict on the conventions, by the small cases.
    pub verdict: Verdict,
    /// The conventions that differ if one is named; the rivals of a tie; the suspects of an unknown difference.
    pub differences: Vec<Difference>,
    /// Conventions that these cases cannot show with these parameters.
    pub not_shown: Vec<String>,
    /// All numbers.
    pub rows: Vec<Row>,
    /// The diagnosis itself.
    pub diagnosis: Diagnosis,
}

/// Compares the numbers of another code, in the order of the expected rows, with these; `accepted` are conventions that belong to the
/// other code, by name.
///
/// # Errors
///
/// Expected rows that do not belong to the model, a convention that is unknown or no matter of one of two ways, a diagnosis that
/// cannot be computed.
pub fn check(
    model: &Model,
    expected: &[Expected],
    got: &[f64],
    accepted: &[String],
) -> Result<Checked, Error> {
    let bench = Bench::new(model, expected, got, accepted)?;
    let first = bench.diagnose()?;
    let (diagnosis, best) = if first.verdict == Verdict::None {
        (first, Vec::new())
    } else {
        bench.decide(first)
    };
    let moved = bench.moved.iter().copied().chain(std::iter::repeat(0.0));
    let rows: Vec<Row> = expected
        .iter()
        .zip(got)
        .zip(moved)
        .map(|((expected, &got), moved)| Row {
            z: (got - expected.value - moved) / expected.band,
            expected: Expected {
                value: expected.value + moved,
                ..expected.clone()
            },
            got,
        })
        .collect();
    let packed = rows.iter().filter(|row| row.expected.varies);
    let agrees = diagnosis.verdict == Verdict::None
        && packed.map(|row| row.z.abs()).fold(0.0, f64::max) < WIDEST;
    let mut differences: Vec<Difference> = Vec::new();
    for difference in best.iter().flat_map(|fitted| in_words(fitted, model)) {
        if !differences
            .iter()
            .any(|known| known.convention == difference.convention)
        {
            differences.push(difference);
        }
    }
    let mut not_shown = diagnosis.not_testable.clone();
    not_shown.retain(|name| differences.iter().all(|d| d.convention != *name));
    let absent = CONVENTIONS
        .iter()
        .filter(|convention| !concerns(convention, model));
    not_shown.extend(absent.map(|convention| convention.name.to_owned()));
    Ok(Checked {
        agrees,
        verdict: diagnosis.verdict,
        differences,
        not_shown,
        rows,
        diagnosis,
    })
}

/// The conventions of a fit in words.
fn in_words(fitted: &Fitted, model: &Model) -> Vec<Difference> {
    let each = fitted
        .conventions
        .iter()
        .zip(&fitted.logs)
        .zip(&fitted.intervals);
    each.map(|((&k, &log), &interval)| difference(&CONVENTIONS[k], model, log, interval))
        .collect()
}
