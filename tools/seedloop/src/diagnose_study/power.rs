//! What a study can be expected to detect, before any run.

use anyhow::Context as _;
use inference::diagnosis::{Power, Problem, ProblemFile, Truth, trials, usual_truths};
use inference::{PowerTable, power_of_design};
use std::path::Path;
use study::Study;

/// Sizes where sensitivities are known, in standard errors.
const SIZES: [f64; 3] = [3.0, 6.0, 12.0];
/// Drawn campaigns of a size, over all effects together.
const CAMPAIGNS: usize = 100;

/// The power as a table: by the sensitivities of an earlier diagnosis in the result folder if there are any, else by
/// random shapes, with what would raise it. Empty if no effect is to be searched.
///
/// # Errors
///
/// A problem in the folder that cannot be read, campaigns that cannot be drawn.
pub(super) fn text(
    study: &Study,
    folder: &Path,
    seed: u64,
    threads: usize,
) -> anyhow::Result<String> {
    let settings = inference::LoopSettings {
        seed,
        ..study.settings.clone()
    };
    let Some(table) = power_of_design(&study.problem, &settings)? else {
        return Ok(String::new());
    };
    let mut out = format!(
        "what {} values, {} parameters and {} effects show of a hidden effect, % of drawn campaigns",
        table.values, table.parameters, table.effects
    );
    let known = of_folder(folder, &table, seed, threads)?;
    out.push_str(match known {
        Some(_) => " with the sensitivities of the diagnosis in the result folder\n",
        None => {
            " with random shapes, a run scattering as a single measured value (a prior, not a result)\n"
        }
    });
    super::add(
        &mut out,
        format_args!(
            "  {:>20} {:>6} {:>6} {:>6} {:>8} {:>7}\n",
            "size, standard errors", "named", "tied", "wrong", "unknown", "unseen"
        ),
    );
    for row in known.as_ref().unwrap_or(&table.rows) {
        line(&mut out, &format!("{}", row.size), row);
    }
    if known.is_none() {
        out.push_str("with one more, at 6 standard errors\n");
        for (words, row) in &table.with_more {
            line(&mut out, words, row);
        }
        out.push_str(best(&table).as_str());
    }
    Ok(out)
}

/// What raises the share of named effects most, in a line.
fn best(table: &PowerTable) -> String {
    let now = table.rows.iter().find(|row| row.size == 6.0);
    let most = table
        .with_more
        .iter()
        .max_by(|a, b| a.1.named.total_cmp(&b.1.named));
    let Some((now, (words, with))) = now.zip(most) else {
        return String::new();
    };
    // A difference of two shares of 100 campaigns has a standard error of 0.07 at most.
    if with.named < now.named + 0.07 {
        return "no single addition raises the share that is named beyond the chance of the draws; several together, or fewer \
                effects to search, would\n"
            .to_owned();
    }
    format!(
        "{words} more would raise it most: {:.0} % named instead of {:.0} %\n",
        100.0 * with.named,
        100.0 * now.named
    )
}

/// One line of the table.
fn line(out: &mut String, words: &str, row: &Power) {
    let percent = [row.named, row.tied, row.wrong, row.unknown, row.unseen];
    let [named, tied, wrong, unknown, unseen] = percent.map(|share| 100.0 * share);
    super::add(
        out,
        format_args!(
            "  {words:>20} {named:>6.0} {tied:>6.0} {wrong:>6.0} {unknown:>8.0} {unseen:>7.0}\n"
        ),
    );
}

/// The power by the sensitivities that an earlier diagnosis found; none without one of as many parameters and values.
fn of_folder(
    folder: &Path,
    table: &PowerTable,
    seed: u64,
    threads: usize,
) -> anyhow::Result<Option<Vec<Power>>> {
    let path = folder.join("problem.json");
    if !path.is_file() {
        return Ok(None);
    }
    let text =
        input::file::read_text(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let file: ProblemFile = serde_json::from_str(&text)
        .with_context(|| format!("{} is not a problem file", path.display()))?;
    let values = file.residual_obs_minus_sim.iter().flatten().count();
    if values != table.values || file.declared.len() != table.parameters {
        return Ok(None);
    }
    let problem = Problem::try_from(file)?;
    let mut rows = Vec::new();
    for size in SIZES {
        let mut truths = usual_truths(&problem, size)?;
        truths.retain(|truth| matches!(truth, Truth::Effect { .. }));
        if truths.is_empty() {
            return Ok(None);
        }
        let each = CAMPAIGNS.div_ceil(truths.len());
        let drawn = trials(&problem, &truths, each, seed, threads)?;
        rows.push(Power::of(size, &drawn));
    }
    Ok(Some(rows))
}
