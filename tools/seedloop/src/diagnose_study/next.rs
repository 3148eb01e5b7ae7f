//! What could be measured next, in words.

use std::fmt::Write as _;
use std::path::Path;
use study::{DiagnosisResult, Study};

/// Most lines of the list.
const MOST_LINES: usize = 5;

/// The best candidates with the cost and the gain of each, and what to do with the first; empty if there are none.
pub(super) fn text(study: &Study, result: &DiagnosisResult, folder: &Path) -> String {
    let mut out = String::new();
    let next = match &result.diagnosis {
        inference::DiagnosisStage::Done(done) => done.diagnosis.next_measurement.as_ref(),
        inference::DiagnosisStage::LeftOut { .. } => None,
    };
    let Some((next, first)) = next.zip(result.next.first()) else {
        return out;
    };
    let needed = next
        .needed
        .map_or_else(String::new, |needed| format!(", {needed:.0} would do"));
    super::add(
        &mut out,
        format_args!(
            "\nwhat to measure next for {}; now {:.1} standard errors{needed}\n  {:>9} {:>8} {:>5} {:>9}\n",
            next.effects.join(", "),
            next.now,
            "se with",
            "minutes",
            "runs",
            "core s"
        ),
    );
    for row in result.next.iter().take(MOST_LINES) {
        let seconds = row
            .core_s
            .map_or_else(|| "-".to_owned(), |s| format!("{s:.0}"));
        super::add(
            &mut out,
            format_args!(
                "  {:>9.1} {:>8} {:>5} {seconds:>9}  {}\n",
                row.criterion, row.minutes, row.runs, row.name
            ),
        );
    }
    let profile = study.profile.as_ref();
    let profile = profile.map_or_else(String::new, |name| format!(" --profile {name}"));
    super::add(
        &mut out,
        format_args!(
            "measure the first, add this to {file} with your numbers, and run\n  seedloop diagnose {file}{profile} --out {} \
             --resume\n\n{}",
            folder.display(),
            first.block,
            file = study.path.display(),
        ),
    );
    for offered in left_out(result) {
        let _ = writeln!(out, "{offered}");
    }
    out
}

/// Candidates that could not be run.
fn left_out(result: &DiagnosisResult) -> Vec<String> {
    let inference::DiagnosisStage::Done(done) = &result.diagnosis else {
        return Vec::new();
    };
    let reasons = done.offered.iter().filter_map(|o| {
        let reason = o.left_out.as_ref()?;
        Some(format!("not offered: {}: {reason}", o.name))
    });
    reasons.collect()
}
