//! `seedloop diagnose PROBLEM.json`: a residual of any simulator.

use anyhow::Context as _;
use inference::diagnosis::{Diagnosis, Options, Problem, ProblemFile, diagnose};

/// Reads a problem file and diagnoses it.
///
/// # Errors
///
/// When the file cannot be read, is not a problem, or holds what is invalid; the message
/// names the file, and the line where it is not valid JSON.
pub(crate) fn run(path: &std::path::Path, seed: u64) -> anyhow::Result<Diagnosis> {
    let text = input::file::read_text(path)
        .with_context(|| format!("cannot read the problem {}", path.display()))?;
    let file: ProblemFile = serde_json::from_str(&text)
        .with_context(|| format!("{} is not a problem file", path.display()))?;
    let problem = Problem::try_from(file)
        .with_context(|| format!("the problem {} cannot be diagnosed", path.display()))?;
    Ok(diagnose(&problem, &Options::new(seed))?)
}
