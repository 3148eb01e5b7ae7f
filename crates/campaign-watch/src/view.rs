//! The parts of the page: each is markup made of what the folder shows, with every text escaped.

use campaign::{range_in_words, time_in_words};
use report::{counted, escaped};
use std::fmt::Write as _;

use crate::charts::{MOST_CHARTS, Shown, plain_unit, shown};
use crate::folder::{AskedRun, Snapshot};
use crate::number::short;

/// Time without a word and without a claim after which a campaign counts as gone, s: twice the life of a claim.
const SILENCE_S: f64 = 120.0;
/// Most problems that are listed.
const MOST_PROBLEMS: usize = 20;
/// Most rows of the table of results.
const MOST_ROWS: usize = 60;

/// The parts of the page in its order: the identifier of the element, and what is in it.
pub(crate) type Parts = Vec<(&'static str, String)>;

/// Title and parts of the page.
pub(crate) fn parts(snapshot: &Snapshot<'_>) -> (String, Parts) {
    let plan = snapshot.state.as_ref().map(|(state, _)| &state.plan);
    let name = plan.map(|plan| plan.name.clone()).unwrap_or_default();
    let name = if name.is_empty() {
        let last = snapshot.path.file_name().unwrap_or_default();
        last.to_string_lossy().into_owned()
    } else {
        name
    };
    let results = shown(snapshot);
    let parts = vec![
        ("name", escaped(&name)),
        ("status", status(snapshot)),
        ("stages", stages(snapshot)),
        ("frames", frames(snapshot)),
        ("results", results_table(&results)),
        ("charts", charts(snapshot, &results)),
        ("problems", problems(snapshot)),
    ];
    let done = snapshot.records;
    (format!("{name}: {}", counted(done, "run", "runs")), parts)
}

/// Appends to a text.
fn add(text: &mut String, more: std::fmt::Arguments<'_>) {
    text.write_fmt(more).expect("a string takes all text");
}

/// What the campaign is at, and the numbers of its runs.
fn status(snapshot: &Snapshot<'_>) -> String {
    let (class, headline, reason) = headline(snapshot);
    let mut out = format!(
        "<div class=\"verdict {class}\"><strong>{}</strong><p>{}</p></div>",
        escaped(&headline),
        escaped(&reason)
    );
    let list = snapshot.list;
    let known = snapshot.state.as_ref();
    if list.all > 0 {
        let over = list.done.saturating_add(list.failed).min(list.all);
        add(
            &mut out,
            format_args!(
                "<progress max=\"{}\" value=\"{over}\">{over} of {}</progress>",
                list.all, list.all
            ),
        );
    }
    out.push_str("<dl class=\"facts\">");
    let mut fact = |name: &str, value: String| {
        add(
            &mut out,
            format_args!(
                "<div><dt>{}</dt><dd>{}</dd></div>",
                escaped(name),
                escaped(&value)
            ),
        );
    };
    if known.is_some() {
        fact(
            "Done of this list",
            format!("{} of {}", list.done, list.all),
        );
        fact("Running", list.running.to_string());
        let begun = list
            .done
            .saturating_add(list.failed)
            .saturating_add(list.running);
        let waiting = list.all.saturating_sub(begun);
        fact("Waiting", waiting.to_string());
        let before = known.map_or(0, |(state, _)| state.failed_before);
        fact("Failed", list.failed.saturating_add(before).to_string());
    }
    fact("Records in the folder", snapshot.records.to_string());
    if let Some((state, age)) = known {
        let is_open = state.end.is_none();
        let age = if is_open && is_alive(snapshot) {
            age.as_secs_f64()
        } else {
            0.0
        };
        fact("Time so far", time_in_words(state.elapsed_s + age));
        if is_open {
            let left = state.left_s.map_or_else(
                || "not known yet".to_owned(),
                |left| range_in_words(left.map(|end| end - age)),
            );
            fact("Time of runs left, whole loop", left);
        }
    }
    out + "</dl>"
}

/// Whether someone works on the campaign.
fn is_alive(snapshot: &Snapshot<'_>) -> bool {
    let silence = snapshot.state.as_ref().map(|(_, age)| age.as_secs_f64());
    snapshot.is_used || silence.is_some_and(|age| age < SILENCE_S)
}

/// The state of the campaign: a class of the style, a headline and its reason.
fn headline(snapshot: &Snapshot<'_>) -> (&'static str, String, String) {
    let folder = snapshot.path.display();
    let Some((state, age)) = &snapshot.state else {
        return if snapshot.is_used {
            let reason = "The folder does not tell stage and plan: only its records are shown.";
            ("note", "Running".to_owned(), reason.to_owned())
        } else {
            let reason = format!("Nobody works in {folder}; its records are shown.");
            ("note", "Not running".to_owned(), reason)
        };
    };
    match state.end.as_deref() {
        Some("finished") => {
            let reason = format!("The results are in {folder}.");
            return ("good", "Finished".to_owned(), reason);
        }
        Some(how) => {
            let reason = format!(
                "The campaign {how}; finished runs are kept, the same command with --resume goes on."
            );
            return ("caution", "Stopped".to_owned(), reason);
        }
        None => {}
    }
    if !is_alive(snapshot) {
        let reason = format!(
            "No sign of life for {}: the same command with --resume goes on.",
            time_in_words(age.as_secs_f64())
        );
        return ("bad", "Not running".to_owned(), reason);
    }
    let stage = if state.stage.is_empty() {
        "Running".to_owned()
    } else {
        format!("Running: {}", state.stage)
    };
    let reason = if state.remark.is_empty() {
        format!("List {} of runs.", state.lists)
    } else {
        format!("List {} of runs; {}.", state.lists, state.remark)
    };
    ("note", stage, reason)
}

/// The stages with their runs.
fn stages(snapshot: &Snapshot<'_>) -> String {
    let Some((state, _)) = &snapshot.state else {
        return String::new();
    };
    let plan = &state.plan.stages;
    if plan.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<h2>Stages</h2><div class=\"table\"><table><thead><tr><th scope=\"col\">stage</th>\
         <th scope=\"col\" class=\"right\">done</th><th scope=\"col\" class=\"right\">planned</th>\
         <th scope=\"col\" class=\"right\">further, at most</th></tr></thead><tbody>",
    );
    for stage in plan {
        let done = snapshot.done_by_stage.get(stage.name.as_str());
        let is_present = stage.name == state.stage && state.end.is_none();
        let (class, mark) = if is_present {
            (" class=\"present\"", "▸ ")
        } else {
            ("", "")
        };
        add(
            &mut out,
            format_args!(
                "<tr{class}><th scope=\"row\">{mark}{}</th><td class=\"right\">{}</td><td class=\"right\">{}</td>\
                 <td class=\"right\">{}</td></tr>",
                escaped(&stage.name),
                done.copied().unwrap_or(0),
                stage.runs,
                stage.at_most_further
            ),
        );
    }
    out + "</tbody></table></div>"
}

/// A row for each observable that is shown.
fn results_table(results: &[Shown<'_>]) -> String {
    let mut out = String::from("<h2>What the runs show so far</h2>");
    if results.iter().all(|shown| shown.points.is_empty()) {
        return out + "<p>No run is finished yet.</p>";
    }
    out.push_str(
        "<div class=\"table\"><table><thead><tr><th scope=\"col\">model</th><th scope=\"col\">observable</th>\
         <th scope=\"col\" class=\"right\">runs</th><th scope=\"col\" class=\"right\">least</th>\
         <th scope=\"col\" class=\"right\">most</th><th scope=\"col\" class=\"right\">latest</th>\
         <th scope=\"col\" class=\"right\">measured</th><th scope=\"col\">role</th></tr></thead><tbody>",
    );
    for shown in results.iter().take(MOST_ROWS) {
        let values = || shown.points.iter().map(|(_, y)| *y);
        let told = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), short);
        let unit = plain_unit(shown.unit);
        let unit = if unit.is_empty() {
            unit
        } else {
            format!(" ({unit})")
        };
        add(
            &mut out,
            format_args!(
                "<tr><td>{}</td><td>{}{}</td><td class=\"right\">{}</td><td class=\"right\">{}</td>\
                 <td class=\"right\">{}</td><td class=\"right\">{}</td><td class=\"right\">{}</td><td>{}</td></tr>",
                escaped(shown.model),
                escaped(&shown.title()),
                escaped(&unit),
                shown.points.len(),
                told(values().reduce(f64::min)),
                told(values().reduce(f64::max)),
                told(values().next_back()),
                told(shown.measured.map(|(mean, _)| mean)),
                escaped(shown.measured.map_or("", |(_, role)| role)),
            ),
        );
    }
    out.push_str("</tbody></table></div>");
    if results.len() > MOST_ROWS {
        add(
            &mut out,
            format_args!("<p>{} more are not shown.</p>", results.len() - MOST_ROWS),
        );
    }
    out
}

/// The charts.
fn charts(snapshot: &Snapshot<'_>, results: &[Shown<'_>]) -> String {
    let plan = snapshot.state.as_ref().map(|(state, _)| &state.plan);
    let (mut out, mut left) = (String::new(), MOST_CHARTS);
    let mut not_drawn = 0;
    for shown in results {
        if left == 0 {
            not_drawn += shown.varied().len();
            continue;
        }
        for chart in shown.charts(plan) {
            if left == 0 {
                not_drawn += 1;
                continue;
            }
            left -= 1;
            add(
                &mut out,
                format_args!(
                    "<figure>{}<figcaption>{}</figcaption></figure>",
                    chart.markup,
                    escaped(&chart.caption)
                ),
            );
        }
    }
    if out.is_empty() {
        if snapshot.runs.is_empty() {
            return out;
        }
        return "<p>Charts begin with the first runs that differ in a parameter.</p>".to_owned();
    }
    let mut out = format!("<div class=\"charts\">{out}</div>");
    if not_drawn > 0 {
        let more = counted(not_drawn, "chart", "charts");
        add(
            &mut out,
            format_args!("<p>{more} more are not drawn; the table has all.</p>"),
        );
    }
    out
}

/// The latest frames.
fn frames(snapshot: &Snapshot<'_>) -> String {
    if snapshot.frames.is_empty() {
        return String::new();
    }
    let mut out = String::from("<h2>Latest frames</h2><div class=\"frames\">");
    for key in &snapshot.frames {
        let Some(run) = snapshot.runs.iter().find(|run| run.key == *key) else {
            continue;
        };
        let words = escaped(&words_of(run));
        add(
            &mut out,
            format_args!(
                "<figure><img src=\"frame/{key}\" alt=\"last frame of {words}\"><figcaption>{words}</figcaption></figure>"
            ),
        );
    }
    out + "</div>"
}

/// A run in words.
fn words_of(run: &AskedRun<'_>) -> String {
    let mut words = String::new();
    if let Some(request) = run.request {
        words.push_str(&request.model);
        let all = [&request.condition, &request.parameters, &request.effects];
        for (name, value) in all.into_iter().flatten() {
            add(&mut words, format_args!(", {name} = {}", short(*value)));
        }
        words.push_str(", ");
    }
    add(&mut words, format_args!("seed {}", run.run.seed));
    if let Some(regime) = &run.run.regime {
        add(&mut words, format_args!(": {regime}"));
    }
    words
}

/// What is damaged or not read yet.
fn problems(snapshot: &Snapshot<'_>) -> String {
    let mut out = String::new();
    if snapshot.unread > 0 {
        add(
            &mut out,
            format_args!("<p>{} records are still to be read.</p>", snapshot.unread),
        );
    }
    if snapshot.problems.is_empty() {
        return out;
    }
    out.push_str("<h2>Not read</h2><ul>");
    for problem in snapshot.problems.iter().take(MOST_PROBLEMS) {
        add(&mut out, format_args!("<li>{}</li>", escaped(problem)));
    }
    out.push_str("</ul>");
    if snapshot.problems.len() > MOST_PROBLEMS {
        let more = snapshot.problems.len() - MOST_PROBLEMS;
        add(&mut out, format_args!("<p>And {more} more.</p>"));
    }
    out
}
