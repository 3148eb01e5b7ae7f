//! `seedloop diagnose STUDY.toml`: own simulations, verdict, the model with the effect.

use crate::calibrate::{progress_lines, refuse_used_folder};
use crate::diagnose::{exit_code, text};
use crate::stop;
use anyhow::Context as _;
use command_line::{Common, DONE, Header};
use residual_diagnosis::Diagnosis;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use study::{
    DiagnosisFile, DiagnosisResult, PlannedDiagnosis, RunSettings, run_diagnosis, write_diagnosis,
};

/// What the command line says.
#[derive(Debug)]
pub(crate) struct Options {
    /// First seed.
    pub(crate) seed: u64,
    /// Result folder.
    pub(crate) out: Option<PathBuf>,
    /// Whether to go on in a folder that exists.
    pub(crate) resume: bool,
    /// Whether nothing is to be run.
    pub(crate) plan_only: bool,
}

/// The answer as it stands in JSON: the keys of a diagnosis, then the whole study.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// The diagnosis.
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
    /// What it was made of, and the model with the effect.
    result: &'a DiagnosisResult,
}

/// Plans, runs, writes the result folder, prints.
///
/// # Errors
///
/// A file that cannot be meant, runs that failed, files that cannot be written.
pub(crate) fn run(path: &Path, options: &Options, common: &Common) -> anyhow::Result<u8> {
    let file = DiagnosisFile::read(path)?;
    let planned = file.plan(options.seed)?;
    if options.plan_only {
        common.print(plan_text(&file, &planned).trim_end())?;
        common.emit_json(&planned.plan)?;
        return Ok(DONE);
    }
    let folder = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(format!("{}-diagnosis", file.name)));
    common.refuse_existing_json()?;
    refuse_used_folder(&folder, options.resume, common)?;
    let settings = RunSettings {
        profile: String::new(),
        seed: options.seed,
        threads: common.threads(),
        folder: folder.clone(),
        inputs: Header::new(options.seed, [path.to_owned(), file.scene_path()])?.inputs,
    };
    common.log(|| plan_text(&file, &planned).trim_end().to_owned());
    let stop = stop::flag()?;
    let result = run_diagnosis(
        &planned,
        &file.name,
        &settings,
        &progress_lines(common),
        &stop,
    );
    let result = match stop::result_or_stopped(result, &folder)? {
        Ok(result) => result,
        Err(code) => return Ok(code),
    };
    write_diagnosis(&folder, &result)
        .with_context(|| format!("cannot write the results into {}", folder.display()))?;
    let diagnosis = &result.study.diagnosis;
    for warning in &diagnosis.warnings {
        common.log(|| format!("warning: {warning}"));
    }
    common.print(text(diagnosis).trim_end())?;
    common.print(format!("report: {}", folder.join("report.html").display()))?;
    common.emit_json(&Report {
        diagnosis,
        result: &result,
    })?;
    Ok(exit_code(diagnosis.verdict))
}

/// What will be run.
fn plan_text(file: &DiagnosisFile, planned: &PlannedDiagnosis) -> String {
    let plan = &planned.plan;
    let used = plan.conditions.iter().filter(|c| c.used).count();
    let mut text = format!(
        "{}: at most {} runs of {} in the budget: {} runs each at {used} conditions for the fit \
         (start, {} declared parameters, {} effects), and fits checked at all {} conditions\n",
        file.name,
        planned.runs,
        file.budget_runs,
        plan.replicates,
        plan.declared.len(),
        plan.effects.len(),
        plan.conditions.len(),
    );
    for condition in &plan.conditions {
        let words: Vec<String> = condition
            .condition
            .iter()
            .map(|(name, value)| format!("{name} {value}"))
            .collect();
        let role = if condition.used { "fit  " } else { "check" };
        text.write_fmt(format_args!("  {role} {}\n", words.join(", ")))
            .expect("a string takes all text");
    }
    for (effect, reason) in &planned.not_applicable {
        text.write_fmt(format_args!("  left out: {effect}: {reason}\n"))
            .expect("a string takes all text");
    }
    text
}
