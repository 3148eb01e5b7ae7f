//! What a calibration says on standard output.

use campaign::{range_in_words, time_in_words};
use command_line::significant;
use inference::{Calibration, Comparison, DiagnosisStage, Estimate, InputEstimate};
use report::counted;
use std::collections::BTreeMap;
use std::fmt::{Arguments, Write as _};
use std::path::{Path, PathBuf};
use study::{ComparedValue, Price, Study, StudyResult};
use study_report::{answer, open_in_words};

/// Appends to a text.
fn add(text: &mut String, more: Arguments<'_>) {
    text.write_fmt(more).expect("a string takes all text");
}

/// What would be run, stage by stage, and what was filled in.
pub(crate) fn plan(study: &Study, price: &Price, threads: usize) -> String {
    let problem = &study.problem;
    let mut text = format!(
        "{}: {}, {} with an error, {} on {}, {} to search\n",
        problem.id,
        counted(problem.n_tuned(), "parameter", "parameters"),
        counted(
            problem.parameters.len() - problem.n_tuned(),
            "input",
            "inputs"
        ),
        counted(problem.measurements.len(), "measurement", "measurements"),
        counted(problem.models.len(), "model", "models"),
        counted(problem.effects.len(), "effect", "effects")
    );
    let mut add_line = |line: std::fmt::Arguments<'_>| add(&mut text, format_args!("  {line}\n"));
    for model in &problem.models {
        let symbols = model.parameters.iter();
        let symbols: Vec<&str> = symbols
            .map(|&j| problem.parameters[j].symbol.as_str())
            .collect();
        let on = match symbols.as_slice() {
            [] => "no parameter".to_owned(),
            _ => symbols.join(", "),
        };
        add_line(format_args!("{}: depends on {on}", model.name));
    }
    for (name, scene) in &study.scenes {
        add_line(format_args!("scene {name}: {}", scene.seeds_in_words()));
    }
    for series in &study.photos {
        for (name, value) in &series.values {
            let [mean, sd] = [(value.mean, 5), (value.sd, 3)].map(|(x, n)| significant(x, n));
            let (files, n) = (series.files.len(), value.n);
            add_line(format_args!(
                "photos ({files}): {name} {mean} sd {sd} n {n:.1}"
            ));
        }
        for remark in series.left_out.iter().chain(&series.remarks) {
            add_line(format_args!("photos: {remark}"));
        }
    }
    for (effect, reason) in &study.not_applicable {
        add_line(format_args!("effect left out: {effect}: {reason}"));
    }
    for default in &study.defaults {
        let (key, value, why) = (&default.key, &default.value, &default.why);
        add_line(format_args!("not stated: {key} = {value} ({why})"));
    }
    priced(&mut text, price, threads);
    if let Some(why) = &price.cannot_be_met {
        add(&mut text, format_args!("  cannot be met: {why}\n"));
    }
    text
}

/// The stages with their runs and what these take.
fn priced(text: &mut String, price: &Price, threads: usize) {
    let mut line = |name: &str, [runs, further, time, further_time]: [&str; 4]| {
        add(
            text,
            format_args!("  {name:<28} {runs:>7} {further:>16}  {time:>18} {further_time:>18}\n"),
        );
    };
    line(
        "runs",
        [
            "planned",
            "further, at most",
            "time of one core",
            "further, at most",
        ],
    );
    let mut priced = |name: &str, runs: [usize; 2], core_s: [f64; 2]| {
        let [runs, further] = runs.map(|n| n.to_string());
        let [time, more] = core_s.map(time_in_words);
        line(name, [&runs, &further, &time, &more]);
    };
    for stage in &price.stages {
        priced(
            &stage.stage,
            [stage.runs, stage.at_most_further],
            [stage.core_s, stage.further_core_s],
        );
    }
    let core_s = [price.core_s, price.further_core_s];
    priced("all", [price.runs, price.at_most_further], core_s);
    let wall = [price.core_s, price.core_s + price.further_core_s];
    let wall = range_in_words(wall.map(|core_s| core_s / threads.max(1) as f64));
    add(
        text,
        format_args!(
            "  {wall} on {threads} threads, by what is found; reading, statistics, report and decks come on top\n"
        ),
    );
    for size in &price.sizes {
        let [time, real] = [size.core_s, size.real_core_s].map(time_in_words);
        let factor = significant(size.factor, 4);
        add(
            text,
            format_args!(
                "  grains {factor} times as large as real ones: {} runs of {time}, {real} with real ones\n",
                size.runs
            ),
        );
    }
    if !price.measured {
        text.push_str("  (times are a guess until the first runs are done)\n");
    }
    if let Some(most) = price.most_runs {
        add(
            text,
            format_args!("  the budget ends the loop after {most} runs\n"),
        );
    }
}

/// The parameters, the measurements beside what is simulated, and the verdict.
pub(super) fn result(result: &StudyResult, folder: &Path, files: &[PathBuf]) -> String {
    let found = &result.calibration;
    let mut text = parameters(&found.parameters);
    if let Some(with) = &found.with_effects {
        let effects = with.effects.iter();
        let effects: Vec<String> = effects
            .map(|(name, amplitude)| format!("{name} = {}", significant(*amplitude, 3)))
            .collect();
        add(
            &mut text,
            format_args!("\nwith {} added\n", effects.join(" and ")),
        );
        text.push_str(&parameters(&with.parameters));
    }
    text.push_str(&inputs(&found.inputs));
    for open in &found.open_combinations {
        let words = open_in_words(open, &found.parameters);
        add(&mut text, format_args!("  {words}\n"));
    }
    for (role, rows) in [
        ("fit", &found.fit),
        ("check", &found.check),
        ("show", &found.show),
    ] {
        text.push_str(&comparisons(role, rows, found));
    }
    text.push_str(&compared(&result.compare));
    for remark in &found.remarks {
        add(&mut text, format_args!("note: {remark}\n"));
    }
    add(&mut text, format_args!("\n{}\n", found.verdict));
    if let DiagnosisStage::Done(done) = &found.diagnosis {
        let answer = answer(done);
        add(&mut text, format_args!("diagnosis: {}\n", answer.headline));
        for (question, words) in answer.lines {
            add(&mut text, format_args!("  {question}: {words}\n"));
        }
    }
    add(
        &mut text,
        format_args!("results: {}\n", folder.join("result.json").display()),
    );
    for file in files.iter().take(1) {
        add(&mut text, format_args!("parameters: {}\n", file.display()));
    }
    let decks = files.len().saturating_sub(1);
    if decks > 0 {
        let place = folder.join("decks");
        add(
            &mut text,
            format_args!("decks ({decks} files): {}\n", place.display()),
        );
    }
    text
}

/// The table of parameters.
pub(crate) fn parameters(estimates: &[Estimate]) -> String {
    let width = estimates.iter().map(|e| e.name.chars().count());
    let width = width.max().unwrap_or(0).max(4);
    let units = estimates.iter().map(|e| e.unit.chars().count());
    let unit_width = units.max().unwrap_or(0).max(4);
    let mut text = format!(
        "{:<8} {:<width$} {:>11} {:>10}  {:<24} {:<unit_width$}  fixed by\n",
        "symbol", "name", "value", "se", "95 % interval", "unit"
    );
    for e in estimates {
        let se = e.se.map_or_else(|| "-".to_owned(), |se| significant(se, 3));
        let [low, high] = e.interval95.map(|end| significant(end, 4));
        let interval = format!("{low} to {high}");
        let fixed = if e.fixed_by_data {
            "the data"
        } else {
            // It is known by its prior, or not at all.
            match e.se {
                Some(_) => "its prior",
                None => "nothing: open",
            }
        };
        let limit = if e.at_limit { ", at its limit" } else { "" };
        add(
            &mut text,
            format_args!(
                "{:<8} {:<width$} {:>11} {se:>10}  {interval:<24} {:<unit_width$}  {fixed}{limit}\n",
                e.symbol,
                e.name,
                significant(e.value, 5),
                e.unit
            ),
        );
    }
    text
}

/// The table of inputs: how far each moves, and how far the parameters would if it were larger.
fn inputs(inputs: &[InputEstimate]) -> String {
    if inputs.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "\n{:<16} {:>18} {:>18} {:>10}  by one sd more the parameters move by\n",
        "input", "stated", "estimate", "moved (sd)"
    );
    for input in inputs {
        let moves = input.moves.iter();
        let moves = moves.map(|(symbol, move_)| format!("{symbol} {move_:+.2e}"));
        add(
            &mut text,
            format_args!(
                "{:<16} {:>18} {:>18} {:>10.2}  {}\n",
                input.symbol,
                with_error(input.stated, input.sd),
                with_error(input.value, input.se),
                input.moved,
                moves.collect::<Vec<_>>().join(", ")
            ),
        );
    }
    text
}

/// Measured values beside simulated ones, for one role: with the values in use before, at the estimate, and with what is missing added.
fn comparisons(role: &str, rows: &[Comparison], found: &Calibration) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let with = found.with_effects.as_ref().filter(|_| role != "show");
    let mut text = format!("\n{role:<44} {:>18}", "measured");
    let mut add_heading = |heading: &str| {
        add(&mut text, format_args!(" {heading:>18} {:>7}", "z"));
    };
    if !found.before.is_empty() {
        add_heading("before");
    }
    add_heading("fitted");
    if with.is_some() {
        add_heading("with what is added");
    }
    text.push('\n');
    for row in rows {
        let se = row.measured.sd / row.measured.n.sqrt();
        let measured = with_error(row.measured.mean, se);
        let name = format!("{} of {}{}", row.observable, row.scene, at(&row.condition));
        add(&mut text, format_args!("{name:<44} {measured:>18}"));
        let before = same(&found.before, row);
        let added = with.and_then(|with| same(&with.rows, row));
        for one in before.into_iter().chain([row]).chain(added) {
            let simulated = with_error(one.simulated.mean, one.simulated.se);
            add(&mut text, format_args!(" {simulated:>18} {:>7.2}", one.z));
        }
        text.push_str(match (role, added.unwrap_or(row).holds) {
            ("show", _) => "",
            (_, true) => "  holds",
            (_, false) => "  does not hold",
        });
        text.push('\n');
    }
    text
}

/// The row of the same measurement.
fn same<'a>(rows: &'a [Comparison], row: &Comparison) -> Option<&'a Comparison> {
    rows.iter().find(|other| {
        (
            &other.scene,
            &other.condition,
            &other.observable,
            other.role,
        ) == (&row.scene, &row.condition, &row.observable, row.role)
    })
}

/// A value with its error; without where repeats differ by rounding alone.
fn with_error(value: f64, error: f64) -> String {
    if error <= 1e-9 * value.abs() {
        return significant(value, 5);
    }
    format!("{} +- {}", significant(value, 5), significant(error, 3))
}

/// A condition in words.
fn at(condition: &BTreeMap<String, String>) -> String {
    if condition.is_empty() {
        return String::new();
    }
    let one = |(name, value): (&String, &String)| format!("{name} = {value}");
    let all: Vec<String> = condition.iter().map(one).collect();
    format!(" at {}", all.join(", "))
}

/// Published values beside results.
fn compared(rows: &[ComparedValue]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!("\n{:<44} {:>18} {:>18}\n", "published", "published", "here");
    for row in rows {
        let with = |value: f64, error: Option<f64>| match error {
            Some(error) => with_error(value, error),
            None => significant(value, 5),
        };
        let published = with(row.published, row.published_sd);
        let here = row
            .found
            .map_or_else(|| "-".to_owned(), |found| with(found, row.se));
        add(
            &mut text,
            format_args!("{:<44} {published:>18} {here:>18}\n", row.result),
        );
    }
    text
}
