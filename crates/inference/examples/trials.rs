//! Campaigns with known truth: how often the rules of the diagnosis are right, for the designs of some
//! problem files.
//!
//! `cargo run --release -p residual-diagnosis --example trials -- NUMBER PROBLEM.json...` prints a page in
//! Markdown with a table for each file. `just trials` writes it to out/trials.md, and what
//! the tables come to stands in docs/trials.md.

#![expect(clippy::print_stdout, reason = "the table is the result")]

use inference::diagnosis::{Problem, ProblemFile, TrialRow, Truth, trials, usual_truths};
use std::error::Error;

/// Strengths of the hidden effects, in standard errors of their amplitude.
const STRENGTHS: [f64; 3] = [4.0, 6.0, 9.0];
/// Seed of all draws.
const SEED: u64 = 1;

/// What the tables show.
const HEAD: &str = "# How often the diagnosis is right

Campaigns with known truth, drawn from the design of a problem: its conditions, sensitivities and noise. Drawn are
the noise of the values, its estimate, the noise of the sensitivities (the rules see others than made the
data), declared parameters mis-tuned with the covariance of their fit, and bench means about the true values.
Effects act linearly here; what the curvature of a real simulator adds shows only in campaigns by the
simulator itself (`just effect-trials`).

Strength is the amplitude of the hidden effect over its standard error after re-tuning; for a bad value, its
error over its standard deviation. Columns are shares of the campaigns in percent. `in the tie set`: one of
several that cannot be told apart, or one that helps while something remains. `false name`: effects named
or tied, none of them hidden. `taken out`: the effect made the data and the library did not hold it. `left by the
nearest`: what the effect of the library that imitates it best leaves of it without noise, in standard deviations; a
twin leaves less than 4, too little to tell the two apart. Only another observable or condition could, and the twin
may be named in place of the effect. `unused before, after`: whitened mean square on the conditions that the problem
keeps for the check (1 is noise alone), without and with the effects that the others name, mean over the namings; a
naming that does not lower it is withdrawn and counts as unknown.";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let number: usize = arguments
        .next()
        .ok_or("give the number of campaigns of each truth, then problem files")?
        .parse()?;
    println!("{HEAD}\n\n{number} campaigns of each truth, seed {SEED}.");
    for path in arguments {
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
        let file: ProblemFile = serde_json::from_str(&text).map_err(|e| format!("{path}: {e}"))?;
        let problem = Problem::try_from(file)?;
        println!("\n## `{path}`\n");
        let mut rows = Vec::new();
        for (i, strength) in STRENGTHS.into_iter().enumerate() {
            let mut truths = usual_truths(&problem, strength)?;
            // Nothing hidden has no strength: once is enough.
            truths.retain(|t| i == 0 || *t != Truth::Nothing);
            rows.extend(trials(&problem, &truths, number, SEED, 0)?);
        }
        print_rows(&rows);
        print_summary(&rows);
    }
    Ok(())
}

/// One line for each truth.
fn print_rows(rows: &[TrialRow]) {
    println!(
        "| hidden | strength | nothing | named rightly | in the tie set | false name | unknown | \
         measure again | unused before, after | withdrawn | left by the nearest |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|");
    for row in rows {
        let (hidden, strength) = words(&row.truth);
        let strength = strength.map_or_else(String::new, |s| s.to_string());
        let percent = |count: usize| format!("{:.1}", 100.0 * count as f64 / row.trials as f64);
        let counts = [
            row.none,
            row.named,
            row.tied,
            row.false_name,
            row.unknown,
            row.recheck,
        ];
        let nearest = row.nearest.as_ref().map_or_else(String::new, |n| {
            let twin = if n.twin { ", a twin" } else { "" };
            format!("{:.1}, {}{twin}", n.left, n.name)
        });
        let unused = row.unused.as_ref().map_or_else(
            || " | ".to_owned(),
            |u| {
                let withdrawn = percent(u.withdrawn);
                format!("{:.2}, {:.2} | {withdrawn}", u.before, u.after)
            },
        );
        println!(
            "| {hidden} | {strength} | {} | {unused} | {nearest} |",
            counts.map(percent).join(" | ")
        );
    }
}

/// The numbers that are promised.
fn print_summary(rows: &[TrialRow]) {
    println!();
    for row in rows.iter().filter(|r| r.truth == Truth::Nothing) {
        println!(
            "- False alarms: {:.1} % (nominal 5 %).",
            100.0 * row.alarm()
        );
    }
    for strength in STRENGTHS {
        let of = |wanted: fn(&Truth) -> bool| {
            let chosen = rows
                .iter()
                .filter(move |r| wanted(&r.truth) && words(&r.truth).1 == Some(strength));
            chosen.collect::<Vec<_>>()
        };
        let sum = |rows: &[&TrialRow], count: fn(&TrialRow) -> usize| {
            rows.iter().map(|r| count(r)).sum::<usize>() as f64
        };
        let members = of(|t| matches!(t, Truth::Effect { .. }));
        let right = sum(&members, |r| r.named + r.tied);
        let namings = right + sum(&members, |r| r.false_name);
        let outside = of(|t| matches!(t, Truth::TakenOut { .. } | Truth::Outsider { .. }));
        let false_names = |rows: &[&TrialRow]| {
            let share = sum(rows, |r| r.false_name) / sum(rows, |r| r.trials);
            format!("{:.1} %", 100.0 * share)
        };
        let (twins, others): (Vec<_>, Vec<_>) = outside
            .iter()
            .partition(|r| r.nearest.as_ref().is_some_and(|n| n.twin));
        let twins = match twins.len() {
            0 => "none of them has a twin in the library".to_owned(),
            n => format!(
                "{} for the {n} with a twin in the library, {} for the {} without",
                false_names(&twins),
                false_names(&others),
                others.len()
            ),
        };
        println!(
            "- Strength {strength}: a hidden effect of the library is in the named set in {:.1} % of \
             the campaigns and in {:.1} % of the namings; an effect outside the library gets a false \
             name in {} ({twins}).",
            100.0 * right / sum(&members, |r| r.trials),
            100.0 * right / namings,
            false_names(&outside),
        );
    }
}

/// A truth in words, and its strength.
fn words(truth: &Truth) -> (String, Option<f64>) {
    match truth {
        Truth::Nothing => ("nothing".to_owned(), None),
        Truth::Effect { name, strength } => (name.clone(), Some(*strength)),
        Truth::TwoEffects { strength } => ("two effects".to_owned(), Some(*strength)),
        Truth::TakenOut { name, strength } => (format!("{name}, taken out"), Some(*strength)),
        Truth::Outsider { strength } => ("unknown smooth effect".to_owned(), Some(*strength)),
        Truth::BadValue { strength } => ("one bad value".to_owned(), Some(*strength)),
    }
}
