//! What could be measured next, in words.

use std::fmt::Write as _;
use std::path::Path;
use study::{DiagnosisResult, NextRow, Study, StudyResult};

/// Most lines of the list.
const MOST_LINES: usize = 5;

/// The best candidates with the cost and the gain of each, and what to do with the first; empty if there are none.
pub(crate) fn of_diagnosis(study: &Study, result: &DiagnosisResult, folder: &Path) -> String {
    let next = match &result.diagnosis {
        inference::DiagnosisStage::Done(done) => done.diagnosis.next_measurement.as_ref(),
        inference::DiagnosisStage::LeftOut { .. } => None,
    };
    let Some(next) = next else {
        return String::new();
    };
    let mut out = ranking(&next.effects, next.now, next.needed, &result.next);
    if let Some(first) = result.next.first() {
        out.push_str(&after(("diagnose", study), first, folder));
        for offered in left_out(result) {
            let _ = writeln!(out, "{offered}");
        }
    }
    out
}

/// The same for a calibration that leaves parameters open.
pub(crate) fn of_calibration(study: &Study, result: &StudyResult, folder: &Path) -> String {
    let Some(next) = &result.calibration.next_for_parameters else {
        return String::new();
    };
    let open = result.calibration.parameters.iter();
    let open = open.filter(|p| !p.fixed_by_data).map(|p| p.symbol.clone());
    let open: Vec<String> = open.collect();
    let mut out = ranking(&open, next.now, Some(next.needed), &result.next);
    if let Some(first) = result.next.first() {
        out.push_str(&after(("calibrate", study), first, folder));
    }
    for (name, reason) in &next.left_out {
        let _ = writeln!(out, "not offered: {name}: {reason}");
    }
    out
}

/// The lines of the best candidates; empty if there are none.
fn ranking(open: &[String], now: f64, needed: Option<f64>, rows: &[NextRow]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let needed = needed.map_or_else(String::new, |needed| format!(", {needed:.0} would do"));
    let mut out = format!(
        "\nwhat to measure next for {}; now {now:.1} standard errors{needed}\n  {:>9} {:>8} {:>5} {:>9}\n",
        open.join(", "),
        "se with",
        "minutes",
        "runs",
        "core s"
    );
    for row in rows.iter().take(MOST_LINES) {
        let seconds = row
            .core_s
            .map_or_else(|| "-".to_owned(), |s| format!("{s:.0}"));
        let _ = writeln!(
            out,
            "  {:>9.1} {:>8} {:>5} {seconds:>9}  {}",
            row.criterion, row.minutes, row.runs, row.name
        );
    }
    out
}

/// What to do with the first candidate.
fn after((command, study): (&str, &Study), first: &NextRow, folder: &Path) -> String {
    let profile = study.profile.as_ref();
    let profile = profile.map_or_else(String::new, |name| format!(" --profile {name}"));
    format!(
        "measure the first, add this to {file} with your numbers, and run\n  seedloop {command} {file}{profile} --out {} \
         --resume\n\n{}",
        folder.display(),
        first.block,
        file = study.path.display(),
    )
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
