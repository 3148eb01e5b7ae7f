//! How the estimate was found: boxes, rounds of confirmation, runs that were left out.

use super::Page;
use crate::Error;
use crate::numbers::{digits, observable, signed, with_error};
use inference::{ConfirmationRound, Estimate};
use report::{Column, Table, counted};

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    let left_out: usize = found.surfaces.iter().map(|s| s.left_out.len()).sum();
    if found.boxes.is_empty() && found.confirmations.is_empty() && left_out == 0 {
        return Ok(());
    }
    page.report.section("How it was found");
    boxes(page)?;
    confirmations(page)?;
    if left_out > 0 {
        runs_left_out(page)?;
    }
    Ok(())
}

/// Values of all parameters in one text.
fn point(parameters: &[Estimate], values: &[f64]) -> String {
    let pairs = parameters.iter().zip(values);
    let texts: Vec<String> = pairs
        .map(|(p, x)| format!("{} = {}", p.symbol, digits(*x)))
        .collect();
    texts.join(", ")
}

/// The boxes in the order of the search.
fn boxes(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    if found.boxes.is_empty() {
        return Ok(());
    }
    let mut table = Table::new(
        "Boxes in the order of the search. The misfit is the sum of squares of the whitened residual at the best point.",
        vec![
            Column::number("box"),
            Column::text("why"),
            Column::text("from low to high"),
            Column::text("best point"),
            Column::number("misfit"),
            Column::number("new runs"),
        ],
    )?;
    for (k, b) in found.boxes.iter().enumerate() {
        let ends = b.low.iter().zip(&b.high);
        let sides: Vec<String> = found
            .parameters
            .iter()
            .zip(ends)
            .map(|(p, (low, high))| format!("{} {} to {}", p.symbol, digits(*low), digits(*high)))
            .collect();
        table.row([
            (k + 1).to_string(),
            b.why.clone(),
            sides.join(", "),
            point(&found.parameters, &b.best),
            digits(b.misfit),
            b.n_runs.to_string(),
        ])?;
    }
    page.table(&table);
    Ok(())
}

/// Rounds of fresh runs at the estimate.
fn confirmations(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    if found.confirmations.is_empty() {
        return Ok(());
    }
    let mut table = Table::new(
        "Rounds of confirmation: what the surfaces predict and what fresh runs show, ± standard errors; z is their \
         difference in standard errors of both. The surface is then shifted to meet the runs of all rounds.",
        vec![
            Column::number("round"),
            Column::text("observable"),
            Column::number("predicted"),
            Column::number("simulated"),
            Column::number("runs"),
            Column::number("z"),
        ],
    )?;
    let rounds = found.confirmations.iter().enumerate();
    for (k, row) in rounds.flat_map(|(k, round)| round.rows.iter().map(move |row| (k, row))) {
        let (words, unit) = observable(&row.observable);
        table.row([
            (k + 1).to_string(),
            format!("{}: {words}", row.model),
            with_error(row.predicted, Some(row.predicted_se), unit),
            with_error(row.simulated.mean, Some(row.simulated.se), unit),
            row.simulated.n_runs.to_string(),
            signed(row.z, 1),
        ])?;
    }
    page.table(&table);
    let line = |(k, round): (usize, &ConfirmationRound)| {
        let agree = if round.confirmed {
            "the runs agree with the surfaces"
        } else {
            "the runs contradict the surfaces"
        };
        format!(
            "Round {} at {}: {agree}.",
            k + 1,
            point(&found.parameters, &round.at)
        )
    };
    let lines: Vec<String> = found.confirmations.iter().enumerate().map(line).collect();
    super::list(&mut page.report, "Where they were made:", &lines);
    Ok(())
}

/// Runs that entered no surface, with the reason.
fn runs_left_out(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    let n: usize = found.surfaces.iter().map(|s| s.left_out.len()).sum();
    page.report.paragraph(&format!(
        "{} entered no surface: a smooth surface must not join two regimes.",
        counted(n, "run", "runs")
    ));
    let mut table = Table::new(
        "Runs that entered no surface.",
        vec![
            Column::text("model"),
            Column::text("at"),
            Column::text("why"),
        ],
    )?;
    for s in &found.surfaces {
        for run in &s.left_out {
            let values = s.symbols.iter().zip(&run.point);
            let at: Vec<String> = values
                .map(|(s, x)| format!("{s} = {}", digits(*x)))
                .collect();
            table.row([s.model.clone(), at.join(", "), run.reason.clone()])?;
        }
    }
    page.table(&table);
    Ok(())
}
