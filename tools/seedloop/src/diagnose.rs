//! `seedloop diagnose`: what a residual says of missing effects.

use crate::run_flags::{Retries, Wait};
use crate::{diagnose_problem, diagnose_study};
use anyhow::ensure;
use command_line::{Common, DONE, Header, NOT_MET, significant};
use inference::diagnosis::{CandidateResult, Diagnosis, Unseen, Verdict};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// States which effect, if any, explains a residual that no parameters remove
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop diagnose study.toml --resume")]
pub(crate) struct Arguments {
    /// A study (.toml), as for calibrate: seedloop runs its own simulations.
    /// Or a problem (.json): residual, covariances and sensitivities from any simulator
    #[arg(value_name = "STUDY.toml|PROBLEM.json")]
    file: PathBuf,

    /// Profile of a study [default: none]
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,

    /// Parameters from which the diagnosis of a study starts: result.json or parameters.toml of a calibration
    /// [default: the start values of the study]
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,

    /// First seed of the runs and of the simulated distributions; start a second diagnosis 10000000 further
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Folder of the results of a study [default: out/NAME-diagnosis, or out/NAME-PROFILE-diagnosis]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Continue in a folder that exists: finished runs are reused, result files are renewed
    #[arg(long)]
    resume: bool,

    #[command(flatten)]
    retries: Retries,

    #[command(flatten)]
    wait: Wait,

    /// Say what would be run, and run nothing
    #[arg(long)]
    plan: bool,

    #[command(flatten)]
    common: Common,
}

/// The answer in JSON; the seed is the diagnosis' own.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// Version of the program.
    version: String,
    /// SHA-256 of the input file.
    inputs: BTreeMap<String, String>,
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
}

/// Reads, diagnoses, prints.
///
/// # Errors
/// A file that cannot be read, or holds neither a problem nor a study; runs that failed.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let (path, common) = (&arguments.file, &arguments.common);
    common.try_outputs([])?;
    let is_study = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("toml"));
    if is_study {
        let options = diagnose_study::Options {
            profile: arguments.profile.clone(),
            from: arguments.from.clone(),
            seed: arguments.seed,
            out: arguments.out.clone(),
            resume: arguments.resume,
            plan_only: arguments.plan,
            retries: arguments.retries.number,
            wait: arguments.wait.limit(),
        };
        return diagnose_study::run(path, &options, common);
    }
    let of_study = arguments.out.is_some()
        || arguments.from.is_some()
        || arguments.profile.is_some()
        || arguments.resume
        || arguments.wait.limit().is_some()
        || arguments.plan;
    ensure!(
        !of_study,
        "--out, --resume, --plan, --profile, --from and --wait are for studies (.toml): {} is a problem, which needs no runs",
        path.display()
    );
    let diagnosis = diagnose_problem::run(path, arguments.seed)?;
    for warning in &diagnosis.warnings {
        common.log(|| format!("warning: {warning}"));
    }
    common.print(text(&diagnosis).trim_end())?;
    let Header {
        version, inputs, ..
    } = Header::new(arguments.seed, [path])?;
    common.emit_json(&Report {
        version,
        inputs,
        diagnosis: &diagnosis,
    })?;
    Ok(exit_code(diagnosis.verdict))
}

/// An answer that says nothing about any effect is not a success.
pub(crate) fn exit_code(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Refused | Verdict::NotTestable => NOT_MET,
        _ => DONE,
    }
}

/// The verdict, its reasons in words, and the candidates.
pub(crate) fn text(diagnosis: &Diagnosis) -> String {
    let mut text = format!("{}: {}", diagnosis.id, diagnosis.verdict);
    if !diagnosis.effects.is_empty() {
        add(&mut text, format_args!(" {}", diagnosis.effects.join(", ")));
    }
    add(&mut text, format_args!("\n{}\n", diagnosis.summary()));
    text + &evidence_text(diagnosis)
}

/// The structured residual and the candidates.
pub(crate) fn evidence_text(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    let residual = &diagnosis.structured_residual;
    if let (Some(t0), Some(p)) = (residual.t0, residual.p) {
        let df = residual.df;
        add(
            &mut text,
            format_args!("structured residual {t0:.3} on {df} degrees of freedom, p {p:.3e}\n"),
        );
    }
    if diagnosis.candidates.is_empty() {
        return text;
    }
    let heads = [
        "candidate",
        "z",
        "amplitude",
        "se",
        "absorbed",
        "p adequate",
        "p max",
    ];
    let [name, numbers @ ..] = heads;
    add(&mut text, format_args!("\n{name:<20}"));
    for head in numbers {
        add(&mut text, format_args!(" {head:>11}"));
    }
    text.push('\n');
    for (name, candidate) in &diagnosis.candidates {
        add(&mut text, format_args!("{name:<20}"));
        for number in numbers_of(candidate) {
            let number = number.map_or_else(|| "-".to_owned(), short);
            add(&mut text, format_args!(" {number:>11}"));
        }
        text.push_str(match candidate.unseen {
            None => "",
            Some(Unseen::RetuningHidesIt) => "  hidden by re-tuning",
            Some(Unseen::RangeTooSmall) => "  less than the noise at its largest",
            Some(Unseen::SlopeIsNoise) => "  slope not known well enough",
        });
        text.push('\n');
    }
    text
}

/// The numbers of a candidate in the order of the heads.
fn numbers_of(c: &CandidateResult) -> [Option<f64>; 6] {
    [
        c.z,
        c.amplitude,
        c.se,
        c.absorbed_fraction,
        c.p_adequacy,
        c.p_max_test,
    ]
}

/// A number with four digits that matter.
fn short(x: f64) -> String {
    significant(x, 4)
}

/// Appends to a text.
fn add(text: &mut String, more: std::fmt::Arguments<'_>) {
    text.write_fmt(more).expect("a string takes all text");
}
