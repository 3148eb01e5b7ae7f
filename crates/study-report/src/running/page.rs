//! What the page of a running campaign says.

use super::{End, FinishedRun, Seen};
use crate::Error;
use crate::measurement_rows::{place, role_name};
use crate::numbers::{DASH, digits, in_unit, observable, shown_unit, with_error};
use campaign::{ProgressState, RunRequest, range_in_words, time_in_words};
use inference::Measurement;
use report::{
    AxisTitle, Column, Fact, Mark, Plot, PlotPoint, Report, Table, Tone, counted, scatter,
};
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of charts, so that the page is made and opened at once. Our choice.
const MOST_CHARTS: usize = 12;
/// Seconds after which a browser loads the page again.
const RELOAD_S: u32 = 5;

/// The page; without an end it loads itself again.
pub(super) fn page(seen: &Seen, end: Option<End<'_>>) -> Result<String, Error> {
    let mut report = Report::new(&seen.campaign.title);
    report.section("Progress");
    if let Some(end) = &end {
        report.verdict(end.tone, end.headline, end.reason);
    } else {
        report.reload_every(RELOAD_S);
        let stage = match seen.stage.as_str() {
            "" => "Running".to_owned(),
            stage => format!("Running: {stage}"),
        };
        report.verdict(Tone::Note, &stage, &seen.remark);
    }
    report.facts(&facts(seen, end.is_some()));
    stages(&mut report, seen)?;
    for (sentence, lines) in [
        ("Runs without a result:", &seen.failures),
        ("Warnings:", &seen.warnings),
    ] {
        crate::page::list(&mut report, sentence, lines);
    }
    report.section("Results so far");
    let rows = rows(seen);
    if seen.runs.is_empty() {
        report.paragraph("No run has finished yet.");
    }
    results(&mut report, &rows)?;
    let charts = rows
        .iter()
        .flat_map(|row| row.charts(seen))
        .take(MOST_CHARTS);
    for (chart, caption) in charts {
        // The table shows what cannot be drawn.
        if let Ok(svg) = chart.draw() {
            report.figure(&svg, &caption);
        }
    }
    let frames: Vec<(&str, &[u8])> = seen
        .frames
        .values()
        .map(|frame| (frame.run.as_str(), frame.bytes.as_slice()))
        .collect();
    if !frames.is_empty() {
        let runs: Vec<&str> = frames.iter().map(|(run, _)| *run).collect();
        let caption = format!("Last frames of the latest runs: {}.", runs.join("; "));
        report.pictures(&frames, &caption)?;
    }
    Ok(report.html())
}

/// Numbers of runs, and times.
fn facts(seen: &Seen, is_over: bool) -> Vec<Fact> {
    let records = seen.keys.len();
    let mut facts = vec![
        Fact::new("Records", records.to_string()),
        Fact::new("Runs without a result", seen.failed.to_string()),
    ];
    let Some((state, heard)) = &seen.progress else {
        return facts;
    };
    let ProgressState {
        done,
        total,
        running,
        elapsed_s,
        left_s,
        ..
    } = *state;
    let age_s = if is_over {
        0.0
    } else {
        heard.elapsed().as_secs_f64()
    };
    let waiting = total.saturating_sub(done + running);
    facts.extend([
        Fact::new("This list", format!("{done} of {total} runs")),
        Fact::new("Running, waiting", format!("{running}, {waiting}")),
        Fact::new("Time so far", time_in_words(elapsed_s + age_s)),
    ]);
    if !is_over {
        let left = left_s.map(|ends| range_in_words(ends.map(|end| end - age_s)));
        let left = left.unwrap_or_else(|| "known after the first run".to_owned());
        facts.push(Fact::new("Time left, all stages", left));
    }
    facts
}

/// The stages with their runs; nothing for a single list.
fn stages(report: &mut Report, seen: &Seen) -> Result<(), Error> {
    if seen.campaign.stages.is_empty() {
        return Ok(());
    }
    let mut table = Table::new(
        "Stages, with the runs that are certain and the largest number of further ones.",
        vec![
            Column::text("stage"),
            Column::number("finished"),
            Column::number("planned"),
            Column::number("further, at most"),
        ],
    )?;
    for stage in &seen.campaign.stages {
        let done = seen.done_by_stage.get(&stage.name).copied();
        table.row([
            stage.name.clone(),
            done.unwrap_or(0).to_string(),
            stage.runs.to_string(),
            stage.at_most_further.to_string(),
        ])?;
    }
    report.table(&table);
    Ok(())
}

/// An observable of a model with its values so far.
struct Row<'a> {
    /// Where, in words.
    place: String,
    /// Name of the observable.
    quantity: &'a str,
    /// The measured value.
    measured: Option<&'a Measurement>,
    /// The runs that gave it, with its means.
    runs: Vec<(&'a FinishedRun, f64)>,
}

/// A row for each measurement, or for each observable of each model if nothing was measured.
fn rows(seen: &Seen) -> Vec<Row<'_>> {
    let runs = |model: &str, quantity: &str| -> Vec<(&FinishedRun, f64)> {
        let of_model = seen.runs.iter().filter(|run| run.request.model == model);
        let mean = |run| Some((run, finite(run, quantity)?));
        of_model.filter_map(mean).collect()
    };
    if let Some(problem) = &seen.campaign.problem {
        let row = problem.measurements.iter().filter_map(|m| {
            let model = problem.models.get(m.model)?;
            Some(Row {
                place: place(&model.scene, &model.condition),
                quantity: &m.observable,
                measured: Some(m),
                runs: runs(&model.name, &m.observable),
            })
        });
        return row.collect();
    }
    let names: BTreeSet<(&str, &str)> = seen
        .runs
        .iter()
        .flat_map(|run| {
            let model = run.request.model.as_str();
            run.observables
                .keys()
                .map(move |name| (model, name.as_str()))
        })
        .collect();
    let each = names.into_iter().map(|(model, quantity)| Row {
        place: model.to_owned(),
        quantity,
        measured: None,
        runs: runs(model, quantity),
    });
    each.collect()
}

/// The mean of an observable of a run; `None` if it has none or one that is not finite.
fn finite(run: &FinishedRun, quantity: &str) -> Option<f64> {
    let mean = run.observables.get(quantity)?.mean;
    mean.is_finite().then_some(mean)
}

/// The table of the results so far.
fn results(report: &mut Report, rows: &[Row<'_>]) -> Result<(), Error> {
    let mut table = Table::new(
        "Measured values with their standard errors, and the values of all runs so far.",
        vec![
            Column::text("observable"),
            Column::text("role"),
            Column::number("measured"),
            Column::number("runs"),
            Column::number("smallest"),
            Column::number("largest"),
            Column::number("latest"),
        ],
    )?;
    for row in rows {
        let (words, unit) = observable(row.quantity);
        let values = || row.runs.iter().map(|(_, mean)| *mean);
        let shown = |value: Option<f64>| {
            value.map_or_else(|| DASH.to_owned(), |value| in_unit(&digits(value), unit))
        };
        let measured = row.measured.map_or_else(
            || DASH.to_owned(),
            |m| with_error(m.mean, Some(m.variance().sqrt()), unit),
        );
        table.row([
            format!("{}: {words}", row.place),
            row.measured.map_or(DASH, |m| role_name(m.role)).to_owned(),
            measured,
            row.runs.len().to_string(),
            shown(values().reduce(f64::min)),
            shown(values().reduce(f64::max)),
            shown(values().next_back()),
        ])?;
    }
    report.table(&table);
    Ok(())
}

impl Row<'_> {
    /// Its values against each parameter, condition or effect that differs between the runs.
    fn charts(&self, seen: &Seen) -> Vec<(Plot, String)> {
        let each: Vec<(BTreeMap<&str, f64>, f64)> = self
            .runs
            .iter()
            .map(|(run, mean)| (values_of(&run.request).collect(), *mean))
            .collect();
        let names: BTreeSet<&str> = each
            .iter()
            .flat_map(|(values, _)| values.keys().copied())
            .collect();
        // An effect that a request does not name is off.
        let of =
            |values: &BTreeMap<&str, f64>, name: &str| values.get(name).copied().unwrap_or(0.0);
        let varies = |name: &&str| {
            each.iter()
                .any(|(values, _)| of(values, name) != of(&each[0].0, name))
        };
        let chart = |name: &str| {
            let point =
                |(values, y): &(BTreeMap<&str, f64>, f64)| PlotPoint::new(of(values, name), *y);
            let points: Vec<PlotPoint> = each.iter().map(point).collect();
            let latest = points
                .last()
                .cloned()
                .map(|point| point.with_label("latest"));
            let (words, unit) = observable(self.quantity);
            let caption = format!(
                "{}: {words} of {} against {name}.",
                self.place,
                counted(points.len(), "run", "runs")
            );
            let y = AxisTitle::new(words, unit);
            let chart = scatter(
                parameter_title(seen, name),
                y,
                points,
                latest.into_iter().collect(),
            )
            .with_all(self.measured.map(|m| Mark::level("measured", m.mean)));
            (chart, caption)
        };
        names.into_iter().filter(varies).map(chart).collect()
    }
}

/// Title of the axis of a parameter, condition or effect.
fn parameter_title(seen: &Seen, name: &str) -> AxisTitle {
    let mut parameters = seen.campaign.problem.iter().flat_map(|p| &p.parameters);
    match parameters.find(|p| p.symbol == name) {
        Some(p) => AxisTitle::new(format!("{}: {}", p.symbol, p.name), shown_unit(&p.unit)),
        None => AxisTitle::new(name, ""),
    }
}

/// All numbers of a request by name.
fn values_of(request: &RunRequest) -> impl Iterator<Item = (&str, f64)> {
    let all = [&request.condition, &request.parameters, &request.effects];
    all.into_iter()
        .flatten()
        .map(|(name, value)| (name.as_str(), *value))
}

pub(super) fn run_in_words(request: &RunRequest) -> String {
    let mut parts = vec![request.model.clone()];
    parts.extend(values_of(request).map(|(name, value)| format!("{name} = {}", digits(value))));
    parts.push(format!("seed {}", request.seed));
    parts.join(", ")
}
