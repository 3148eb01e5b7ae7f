//! `seedloop diagnose STUDY.toml`: own simulations, verdict, the model with the effect.

mod power;
mod report;

use crate::calibrate::{progress_lines, refuse_used_folder};
use crate::diagnose::{evidence_text, exit_code};
use crate::enter::{enter, require_memory, work_of};
use crate::run_flags::finished;
use crate::stop::Stop;
use crate::{next_measurement, running};
use ::report::Tone;
use anyhow::Context as _;
use campaign::range_in_words;
use command_line::{Common, DONE, NOT_MET, significant, try_folder};
use inference::diagnosis::Diagnosis;
use inference::{CalibrationProblem, DiagnosisStage, ResidualStudy};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use study::{
    DiagnosisPrice, DiagnosisResult, RunSettings, StagePrice, Study, plan_diagnosis, run_diagnosis,
    write_json, write_result,
};
use study_report::{RunningPage, answer};

/// What the command line says.
#[derive(Debug)]
pub(crate) struct Options {
    /// Profile of the study file.
    pub(crate) profile: Option<String>,
    /// File with the parameters from which it starts; the start values of the study if omitted.
    pub(crate) from: Option<PathBuf>,
    /// First seed.
    pub(crate) seed: u64,
    /// Result folder.
    pub(crate) out: Option<PathBuf>,
    /// Whether to continue in a folder that exists.
    pub(crate) resume: bool,
    /// Whether nothing is to be run.
    pub(crate) plan_only: bool,
    /// How often a run that diverges is tried again.
    pub(crate) retries: u32,
    /// Longest wait for runs of other processes.
    pub(crate) wait: Option<Duration>,
}

/// The answer in JSON: the keys of a diagnosis, then the whole result.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// The diagnosis; `None` if it was left out.
    #[serde(flatten)]
    diagnosis: Option<&'a Diagnosis>,
    /// What it was made of, and the model with the effect.
    result: &'a DiagnosisResult,
}

/// What would be run in JSON: the problem of the study, and the price.
#[derive(Debug, Serialize)]
struct Plan<'a> {
    /// What is asked.
    #[serde(flatten)]
    problem: &'a CalibrationProblem,
    /// Runs and times.
    price: &'a DiagnosisPrice,
}

impl<'a> Plan<'a> {
    fn new(study: &'a Study, price: &'a DiagnosisPrice) -> Self {
        Self {
            problem: &study.problem,
            price,
        }
    }
}

/// Plans, runs, writes the result folder, prints.
///
/// # Errors
///
/// An invalid file, runs that failed, files that cannot be written.
pub(crate) fn run(path: &Path, options: &Options, common: &Common) -> anyhow::Result<u8> {
    let study = Study::read(path, options.profile.as_deref())?;
    let at = match &options.from {
        Some(file) => study.values_from(file)?,
        None => study.start_values(),
    };
    let folder = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(format!("{}-diagnosis", study.folder_name())));
    try_folder(&folder)?;
    let price = plan_diagnosis(&study, options.seed, &folder);
    let price = price.with_context(|| path.display().to_string())?;
    let planned = plan_text(&study, &at, &price, common.threads());
    if options.plan_only {
        common.print(planned.trim_end())?;
        common.print(power::text(&study, &folder, options.seed, common.threads())?.trim_end())?;
        common.emit_json(&Plan::new(&study, &price))?;
        return Ok(DONE);
    }
    refuse_used_folder(&folder, options.resume, common)?;
    require_memory(study.models.values(), common.threads())?;
    let work = work_of(
        "diagnose",
        &study.inputs,
        &(&study.profile, options.seed, &at),
    );
    let _owner = enter(&folder, &work, common)?;
    common.log(|| planned.trim_end().to_owned());
    let lines = progress_lines(common);
    let title = format!("Diagnosis {}", study.folder_name());
    let stages = std::slice::from_ref(&price.stage);
    let page = RunningPage::begin(&folder, running::of_study(title, &study, stages), &lines);
    page.announce(&price.stage.stage);
    let stop = Stop::of_runs(&folder)?;
    let settings = RunSettings {
        seed: options.seed,
        threads: common.threads(),
        folder: folder.clone(),
        progress: &page,
        stop: stop.flag(),
        retries: options.retries,
        wait: options.wait,
    };
    let done = run_diagnosis(&study, &at, &settings);
    match finished(&stop, done)? {
        Ok(result) => hand_over(&study, &result, &folder, page, common),
        Err(code) => Ok(code),
    }
}

/// Writes the result into the folder and prints it; gives the exit code.
fn hand_over(
    study: &Study,
    result: &DiagnosisResult,
    folder: &Path,
    page: RunningPage<'_>,
    common: &Common,
) -> anyhow::Result<u8> {
    let file = folder.join("result.json");
    write_result(&file, result, &DiagnosisResult::CLOCK)?;
    let (done, code) = match &result.diagnosis {
        DiagnosisStage::Done(done) => {
            write_json(&folder.join("problem.json"), &done.problem)?;
            page.replace(|| report::write(folder, result, done, common))?;
            common.print(found_text(study, done).trim_end())?;
            let next = next_measurement::of_diagnosis(study, result, folder);
            if !next.is_empty() {
                common.print(next.trim_end())?;
            }
            (Some(&done.diagnosis), exit_code(done.diagnosis.verdict))
        }
        DiagnosisStage::LeftOut { reason } => {
            page.finish(Tone::Caution, "No diagnosis", reason);
            common.print(format!("no diagnosis: {reason}"))?;
            (None, NOT_MET)
        }
    };
    for warning in done.iter().flat_map(|d| &d.warnings) {
        common.log(|| format!("warning: {warning}"));
    }
    common.print(format!("results: {}", file.display()))?;
    common.emit_json(&Report {
        diagnosis: done,
        result,
    })?;
    Ok(code)
}

/// The answer, the parameters with what they stand for, and what the answer rests on.
fn found_text(study: &Study, done: &ResidualStudy) -> String {
    let told = answer(done);
    let mut out = format!("{}: {}\n", done.plan.id, told.headline);
    for (question, text) in &told.lines {
        add(&mut out, format_args!("  {question}: {text}\n"));
    }
    for parameter in &study.problem.parameters {
        let (symbol, name) = (&parameter.symbol, &parameter.name);
        add(
            &mut out,
            format_args!(
                "  {symbol}: {name}, from {}\n",
                significant(parameter.start, 5)
            ),
        );
    }
    out.push('\n');
    out + &evidence_text(&done.diagnosis)
}

/// What will be run.
fn plan_text(study: &Study, at: &[f64], price: &DiagnosisPrice, threads: usize) -> String {
    let problem = &study.problem;
    let StagePrice {
        runs,
        at_most_further,
        core_s,
        further_core_s,
        ..
    } = &price.stage;
    let core = [*core_s, core_s + further_core_s];
    let wall = core.map(|core_s| core_s / threads.max(1) as f64);
    let mut out = format!(
        "{}: {runs} to {} runs, {} behind each simulated mean of {} models, {} effects to search\n  {} of one core, {} on \
         {threads}{}\n",
        problem.id,
        runs + at_most_further,
        study.settings.diagnosis_replicates,
        problem.models.len(),
        problem.effects.len(),
        range_in_words(core),
        range_in_words(wall),
        if price.measured {
            ""
        } else {
            " (a guess until the first runs are done)"
        },
    );
    let mut add_line = |line: std::fmt::Arguments<'_>| add(&mut out, format_args!("  {line}\n"));
    for (parameter, value) in problem.parameters.iter().zip(at) {
        let (symbol, name) = (&parameter.symbol, &parameter.name);
        add_line(format_args!("from {symbol} = {value}: {name}"));
    }
    for measured in &problem.measurements {
        let (model, name) = (&problem.models[measured.model].name, &measured.observable);
        let role = format!("{:?}", measured.role).to_lowercase();
        add_line(format_args!("{role:<6} {name} of {model}"));
    }
    let offered = &problem.candidates;
    if price.at_candidates > 0 {
        add_line(format_args!(
            "of these at most {} at {} candidates for the next measurement, only where the verdict leaves a question",
            price.at_candidates,
            offered.len()
        ));
        for candidate in offered {
            add_line(format_args!("could be measured: {}", candidate.model.name));
        }
    } else if !offered.is_empty() {
        add_line(format_args!(
            "the budget leaves no runs for what to measure next"
        ));
    }
    for (effect, reason) in &study.not_applicable {
        add_line(format_args!("left out: {effect}: {reason}"));
    }
    out
}

/// Appends to a text.
fn add(text: &mut String, more: std::fmt::Arguments<'_>) {
    text.write_fmt(more).expect("a string takes all text");
}
