//! The report of a diagnosis: the answer first, then what it rests on.

use super::closing_section::{defaults, inputs, spent};
use super::residual_parts::answer_colour;
use super::residual_section;
use crate::numbers::{digits, fixed, listed};
use crate::pictures::residual_charts;
use crate::{DiagnosisInput, Error};
use inference::ResidualStudy;
use inference::diagnosis::{NearestEffect, TrialRow, Truth};
use report::{Column, Fact, Report, Table, counted};

/// Makes the page as HTML.
pub(crate) fn page(input: &DiagnosisInput<'_>) -> Result<String, Error> {
    let mut report = Report::new(format!("Diagnosis {}", input.name));
    answer(&mut report, input)?;
    report.section("What it rests on");
    residual_section::add(&mut report, input.study)?;
    next_measurement(&mut report, input.study)?;
    known_truth(&mut report, input.trials)?;
    closing(&mut report, input);
    Ok(report.html())
}

/// The answer on one screen.
fn answer(report: &mut Report, input: &DiagnosisInput<'_>) -> Result<(), Error> {
    let (study, d) = (input.study, &input.study.diagnosis);
    let told = crate::answer(study);
    report.section("The answer");
    report.verdict(
        answer_colour(d.verdict),
        &told.headline,
        &format!("Verdict: {}.", d.verdict),
    );
    let mut facts: Vec<Fact> = told
        .lines
        .into_iter()
        .map(|(question, answer)| Fact::new(question, answer))
        .collect();
    facts.push(Fact::new(
        "Measured",
        format!(
            "{} for the fit, {} for the check",
            counted(study.plan.count(true), "condition", "conditions"),
            study.plan.count(false)
        ),
    ));
    report.facts(&facts);
    if let Some(evidence) = residual_charts::evidence(study) {
        report.figure(
            &evidence.draw()?,
            "Support for each effect: how much of the sum of squares of the residual it takes off, by observable and \
             scene, the parameters fitted again inside their limits. A part to the left of 0 contradicts the effect.",
        );
    }
    for k in 0..study.plan.observables.len() {
        let svg = residual_charts::residuals(study, k).draw()?;
        report.figure(&svg, residual_section::RESIDUALS);
    }
    Ok(())
}

/// What could be measured next; nothing if no question is left.
fn next_measurement(report: &mut Report, study: &ResidualStudy) -> Result<(), Error> {
    let Some(next) = &study.diagnosis.next_measurement else {
        return Ok(());
    };
    let needed = next.needed.map_or_else(String::new, |needed| {
        format!(", where {} would do", digits(needed))
    });
    report.paragraph(&format!(
        "What could be measured next, for {}. By the values that there are, their smallest separation or expected score is \
         {} standard errors{needed}. The noise of the runs at the candidates is taken off.",
        listed(&next.effects),
        fixed(next.now, 1)
    ));
    let mut table = Table::new(
        "Candidates for the next measurement, the most helpful for its minutes first.",
        vec![
            Column::text("measurement"),
            Column::number("standard errors with it"),
            Column::number("minutes"),
            Column::number("further runs, at least"),
        ],
    )?;
    for ranked in &next.ranked {
        let offered = study.offered.iter().find(|o| o.name == ranked.experiment);
        table.row([
            ranked.experiment.clone(),
            fixed(ranked.criterion, 1),
            digits(ranked.cost),
            offered.map_or_else(String::new, |o| o.runs.to_string()),
        ])?;
    }
    report.table(&table);
    Ok(())
}

/// What the rules say of drawn campaigns whose truth is known.
fn known_truth(report: &mut Report, rows: &[TrialRow]) -> Result<(), Error> {
    let Some(first) = rows.first() else {
        return Ok(());
    };
    report.paragraph(&format!(
        "How far these rules can be trusted for these very conditions, sensitivities and noise: {} \
         drawn campaigns of each truth. Strengths in standard errors.",
        first.trials
    ));
    let mut table = Table::new(
        "What came out, % of the campaigns.",
        vec![
            Column::text("hidden"),
            Column::number("nothing"),
            Column::number("named rightly"),
            Column::number("in the tie set"),
            Column::number("false name"),
            Column::number("unknown"),
            Column::number("measure again"),
            Column::text("left by the nearest other effect, standard deviations"),
        ],
    )?;
    for row in rows {
        let percent = |count: usize| fixed(100.0 * count as f64 / row.trials as f64, 1);
        table.row([
            hidden(&row.truth),
            percent(row.none),
            percent(row.named),
            percent(row.tied),
            percent(row.false_name),
            percent(row.unknown),
            percent(row.recheck),
            row.nearest.as_ref().map_or_else(String::new, nearest),
        ])?;
    }
    report.table(&table);
    report.paragraph(
        "An effect that the library does not hold may be named by one that it holds, where that one leaves \
         less of it than 4: these data cannot distinguish such twins.",
    );
    Ok(())
}

/// What imitates an effect that was taken out, in words.
fn nearest(nearest: &NearestEffect) -> String {
    let twin = if nearest.twin { ", a twin" } else { "" };
    format!("{} by {}{twin}", fixed(nearest.left, 1), nearest.name)
}

/// A truth in words.
fn hidden(truth: &Truth) -> String {
    match truth {
        Truth::Nothing => "nothing".to_owned(),
        Truth::Effect { name, strength } => format!("{name}, {}", digits(*strength)),
        Truth::TwoEffects { strength } => format!("two effects, {} each", digits(*strength)),
        Truth::TakenOut { name, strength } => {
            format!("{name}, {}, not in the library", digits(*strength))
        }
        Truth::Outsider { strength } => format!("an unknown smooth effect, {}", digits(*strength)),
        Truth::BadValue { strength } => format!("one bad value, {}", digits(*strength)),
    }
}

/// What was left out, cost, and provenance.
fn closing(report: &mut Report, input: &DiagnosisInput<'_>) {
    report.section("What was left out, and what it cost");
    let reasons = input.not_applicable.iter().chain(&input.study.left_out);
    let lines: Vec<String> = reasons
        .map(|(name, why)| format!("{name}: {why}"))
        .collect();
    if lines.is_empty() {
        report.paragraph("Every effect that was asked for could be run.");
    } else {
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        report
            .paragraph("Effects that could not be run in this scene:")
            .list(&lines);
    }
    report.paragraph(&format!(
        "At most {} runs were planned. {}",
        input.planned_runs,
        spent(&input.spent),
    ));
    defaults(report, input.defaults);
    report.provenance(&format!(
        "seedloop {}, study {}, first seed {}.",
        input.version, input.name, input.seed
    ));
    inputs(report, input.inputs);
}
