//! `seedloop optimise --goal`: one setting for one or several responses.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use command_line::{DONE, Header, NOT_MET, significant};
use response_surface::{
    Aim, Compromise, Fit, Goal, OpenBound, Prediction, ScatterGoal, Transform, compromise_at,
    compromises,
};
use serde::Serialize;

use super::Arguments;
use super::read::{Read, read};

/// The answer in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Symbols of the factors, in the order of all points.
    factors: Vec<String>,
    /// Goals of the responses, in the order of the files.
    goals: Vec<Goal>,
    /// Goals of the scatter that the factors hand on.
    scatter_goals: Vec<ScatterGoal>,
    /// Whether any point of the box is worth something.
    exists: bool,
    /// The settings, best first.
    compromises: Vec<Compromise>,
    /// Bounds that each setting lies on although the runs extend beyond them.
    open_bounds: Vec<Vec<OpenBound>>,
    /// What the point asked for is worth; null without `--at`.
    at: Option<Compromise>,
    /// What to bear in mind, such as bounds beyond the data.
    warnings: Vec<String>,
}

/// Answers for one or several responses.
///
/// # Errors
/// Goals and files that cannot be read, responses over different factors.
pub(super) fn run(arguments: &Arguments, first: Read) -> anyhow::Result<u8> {
    let Read {
        fit: first,
        transform,
        mut warnings,
    } = first;
    untransformed(&arguments.analysis, transform)?;
    let text = arguments.goal.as_deref().unwrap_or_default();
    let mut files = vec![arguments.analysis.clone()];
    let mut goals = vec![goal(text, &first)?];
    let mut fits = vec![first];
    let mut scatter = Vec::new();
    for part in &arguments.also {
        let (file, text) = part
            .split_once('=')
            .with_context(|| format!("'{part}' is not a further response; write OTHER.json=max"))?;
        if file == "transmitted" {
            scatter.push(scatter_goal(arguments, text, &fits[0])?);
            continue;
        }
        let other = read(Path::new(file), arguments)?;
        untransformed(Path::new(file), other.transform)?;
        goals.push(goal(text, &other.fit)?);
        fits.push(other.fit);
        warnings.extend(other.warnings);
        files.push(PathBuf::from(file));
    }
    ensure!(
        arguments.factor_sd.is_empty() || !scatter.is_empty(),
        "--factor-sd beside --goal needs --also transmitted=min:0:LIMIT"
    );
    let error = arguments.error();
    let found = compromises(&fits, &goals, &scatter, error)?;
    let at = match super::point_at(&fits[0], &arguments.at)? {
        Some(point) => Some(compromise_at(&fits, &goals, &scatter, &point, error)?),
        None => None,
    };
    let open = found.iter().map(|found| fits[0].open_bounds(&found.coded));
    let symbols: Vec<String> = fits[0]
        .factors
        .iter()
        .map(|f| f.symbol().to_owned())
        .collect();
    let exists = !found.is_empty();
    let report = Report {
        header: Header::new(None, &files)?,
        factors: symbols,
        goals,
        scatter_goals: scatter,
        exists,
        open_bounds: open.collect(),
        compromises: found,
        at,
        warnings,
    };
    let common = &arguments.common;
    common.emit_json(&report)?;
    describe(arguments, &fits, &report)?;
    Ok(if exists { DONE } else { NOT_MET })
}

/// Refuses an analysis of a function of the response: a goal is worth what the response itself is.
fn untransformed(file: &Path, transform: Option<Transform>) -> anyhow::Result<()> {
    match transform {
        None => Ok(()),
        Some(transform) => anyhow::bail!(
            "{} is the analysis of a function of the response ({transform}), and --goal is for the response itself: ask \
             for a --target, or analyse without --transform",
            file.display()
        ),
    }
}

/// Prints the settings, and the errors that their intervals are made with.
fn describe(arguments: &Arguments, fits: &[Fit], report: &Report) -> anyhow::Result<()> {
    let common = &arguments.common;
    if !report.exists {
        common.print(
            "no setting within the bounds is worth anything for all responses; widen the goals",
        )?;
    }
    let settings = report.compromises.iter().zip(&report.open_bounds);
    let settings = settings.map(|(compromise, open)| ("", compromise, &open[..]));
    let asked = report
        .at
        .iter()
        .map(|at| ("point asked for: ", at, &[][..]));
    for (what, compromise, open) in settings.chain(asked) {
        let point = super::words::point(&fits[0], &compromise.natural);
        let value = |p: &Prediction| {
            let interval = p.ci95.map_or_else(String::new, |[low, high]| {
                format!(" ({} to {})", significant(low, 6), significant(high, 6))
            });
            format!("{}{interval}", significant(p.mean, 6))
        };
        let values: Vec<String> = compromise.predictions.iter().map(value).collect();
        let handed = |sd: &f64| format!("; transmitted sd {}", significant(*sd, 4));
        let handed: String = compromise.transmitted_sd.iter().map(handed).collect();
        common.print(format!(
            "{what}desirability {:.4} at {point}: {}{handed}",
            compromise.desirability,
            values.join("; ")
        ))?;
        if compromise.predictions.iter().any(|p| p.extrapolated) {
            common.print(super::words::BEYOND_DATA)?;
        }
        super::words::go_on(common, &fits[0], open)?;
    }
    let is_answered = report.exists || report.at.is_some();
    for (i, fit) in fits.iter().enumerate().filter(|_| is_answered) {
        let which = if fits.len() > 1 {
            format!("response {}: ", i + 1)
        } else {
            String::new()
        };
        let error = super::words::error(fit, fit.chosen_error(arguments.error())?);
        common.print(format!("{which}{error}"))?;
    }
    Ok(())
}

/// Reads the goal of the scatter that the factors hand on to the first response.
fn scatter_goal(arguments: &Arguments, text: &str, first: &Fit) -> anyhow::Result<ScatterGoal> {
    ensure!(
        !arguments.factor_sd.is_empty(),
        "--also transmitted=... needs --factor-sd, the standard deviations of the factors"
    );
    ensure!(
        text.contains(':'),
        "'transmitted={text}' needs its numbers: transmitted=min:LOW:HIGH"
    );
    Ok(ScatterGoal {
        response: 0,
        factor_sd: super::factor_sds(first, &arguments.factor_sd)?,
        goal: goal(text, first)?,
    })
}

/// Reads a goal such as `target:30:37.5:45^2*3`. Without bounds, max and min take the least and the
/// greatest value that the surface reaches.
fn goal(text: &str, fit: &Fit) -> anyhow::Result<Goal> {
    let form = || {
        format!(
            "'{text}' is not a goal; write max, max:LOW:HIGH, min, min:LOW:HIGH, range:LOW:HIGH or \
             target:LOW:VALUE:HIGH, with ^WEIGHT and *IMPORTANCE behind it where wanted"
        )
    };
    let number = |text: &str| text.trim().parse::<f64>().ok().with_context(form);
    let (rest, importance) = match text.split_once('*') {
        Some((rest, importance)) => (rest, number(importance)?),
        None => (text, 1.0),
    };
    let (rest, weight) = match rest.split_once('^') {
        Some((rest, weight)) => (rest, number(weight)?),
        None => (rest, 1.0),
    };
    let mut words = rest.split(':');
    let kind = words.next().unwrap_or_default().trim();
    let numbers = words.map(number).collect::<anyhow::Result<Vec<f64>>>()?;
    let aim = match (kind, &numbers[..]) {
        ("max" | "maximise", &[low, high]) => Aim::Maximise { low, high },
        ("min" | "minimise", &[low, high]) => Aim::Minimise { low, high },
        ("max" | "maximise", []) => {
            let (low, high) = reach(fit)?;
            Aim::Maximise { low, high }
        }
        ("min" | "minimise", []) => {
            let (low, high) = reach(fit)?;
            Aim::Minimise { low, high }
        }
        ("range", &[low, high]) => Aim::Range { low, high },
        ("target", &[low, value, high]) => Aim::Target { low, value, high },
        _ => anyhow::bail!(form()),
    };
    Ok(Goal {
        aim,
        weight,
        importance,
    })
}

/// Least and greatest value of the surface within the bounds.
fn reach(fit: &Fit) -> anyhow::Result<(f64, f64)> {
    let extremes = fit
        .extremes()
        .context("max and min without numbers need a model of degree two at most")?;
    let (low, high) = (extremes.min.value, extremes.max.value);
    ensure!(
        low < high,
        "the surface is flat; nothing can be raised or lowered"
    );
    Ok((low, high))
}
