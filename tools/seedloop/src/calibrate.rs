//! `seedloop calibrate STUDY.toml`: the whole loop.

mod report;
mod text;

use crate::enter::{enter, require_memory, work_of};
use crate::run_flags::{Retries, Wait, finished};
use crate::stop::Stop;
use crate::{next_measurement, running};
use ::report::Tone;
use anyhow::Context as _;
use campaign::LineProgress;
use command_line::{Common, DONE, NOT_MET, Overwrite, try_folder};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use study::{
    RunSettings, Study, StudyResult, plan_study, run_study, write_hand_over, write_result,
};
use study_report::RunningPage;

pub(crate) use text::plan;

/// The example of the help.
pub(crate) const EXAMPLE: &str = "Example:\n  seedloop calibrate study.toml --plan";

/// Calibrates the parameters of a study on its measurements: screening, surfaces, solutions, check, diagnosis
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// The study
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,

    /// Profile of the study file [default: none]
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,

    /// Check everything, say what would be run and what it costs, and run nothing
    #[arg(long)]
    plan: bool,

    /// First seed of all random numbers; the runs take those that follow: start a second loop 10000000 further
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Folder of the results [default: out/NAME, or out/NAME-PROFILE]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Continue in a folder that exists: finished runs are reused, result files are renewed
    #[arg(long)]
    resume: bool,

    #[command(flatten)]
    retries: Retries,

    #[command(flatten)]
    wait: Wait,
}

/// Runs the loop and writes the result folder.
///
/// # Errors
///
/// Bad input, runs that failed, files that cannot be written.
pub(crate) fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<u8> {
    let study = Study::read(&arguments.study, arguments.profile.as_deref())?;
    common.try_outputs([])?;
    let out = arguments.out.clone();
    let folder = out.unwrap_or_else(|| PathBuf::from("out").join(study.folder_name()));
    try_folder(&folder)?;
    let price = plan_study(&study, arguments.seed, &folder)?;
    let plan = plan(&study, &price, common.threads());
    if arguments.plan {
        common.print(plan.trim_end())?;
        common.emit_json(&price)?;
        let can_be_met = price.cannot_be_met.is_none();
        return Ok(if can_be_met { DONE } else { NOT_MET });
    }
    refuse_used_folder(&folder, arguments.resume, common)?;
    require_memory(study.models.values(), common.threads())?;
    let work = work_of(
        "calibrate",
        &study.inputs,
        &(&study.profile, arguments.seed),
    );
    let _owner = enter(&folder, &work, common)?;
    common.log(|| plan.trim_end().to_owned());
    let retries = arguments.retries.number;
    let stop = Stop::of_runs(&folder)?;
    let simulator = study.simulator(&folder)?.with_retries(retries);
    let simulator = simulator.with_stop(stop.flag());
    let lines = progress_lines(common);
    let title = format!("Calibration {}", study.folder_name());
    let page = RunningPage::begin(
        &folder,
        running::of_study(title, &study, &price.stages),
        &lines,
    );
    let settings = RunSettings {
        seed: arguments.seed,
        threads: common.threads(),
        folder: folder.clone(),
        progress: &page,
        stop: stop.flag(),
        retries,
        wait: arguments.wait.limit(),
    };
    let announce = |stage: &str| {
        page.announce(stage);
        common.log(|| format!("== {stage}"));
    };
    let done = run_study(&study, &simulator, &settings, &announce);
    if let Err(study::Error::Calibration(refused @ inference::Error::CoarseGraining { .. })) = &done
    {
        page.finish(Tone::Bad, "Refused", &refused.to_string());
        common.print(format!("refused: {refused}"))?;
        return Ok(NOT_MET);
    }
    let result = match finished(&stop, done)? {
        Ok(result) => result,
        Err(code) => return Ok(code),
    };
    let write_page =
        |result: &StudyResult| page.replace(|| report::write(&folder, &study, &simulator, result));
    hand_over(result, &study, &folder, write_page, common)
}

/// Writes the result into the folder and prints it; gives the exit code.
fn hand_over(
    mut result: StudyResult,
    study: &Study,
    folder: &Path,
    write_page: impl FnOnce(&StudyResult) -> anyhow::Result<()>,
    common: &Common,
) -> anyhow::Result<u8> {
    let files = write_hand_over(folder, study, &mut result)
        .with_context(|| format!("cannot write the results into {}", folder.display()))?;
    write_result(&folder.join("result.json"), &result, &StudyResult::CLOCK)?;
    write_page(&result)?;
    let next = next_measurement::of_calibration(study, &result, folder);
    let text = text::result(&result, folder, &files) + &next;
    common.print(text.trim_end())?;
    common.emit_json(&result)?;
    let met = result.calibration.met;
    Ok(if met { DONE } else { NOT_MET })
}

/// Refuses a folder with results of an earlier run, unless the user said that it is to continue.
pub(crate) fn refuse_used_folder(
    folder: &Path,
    resume: bool,
    common: &Common,
) -> anyhow::Result<()> {
    let allowed = resume || common.overwrite() == Overwrite::Allow;
    let used = folder
        .read_dir()
        .is_ok_and(|mut entries| entries.next().is_some());
    anyhow::ensure!(
        allowed || !used,
        "{} holds the results of an earlier run: give --resume to continue with it (finished runs \
         are reused), or another --out",
        folder.display()
    );
    Ok(())
}

/// Where the progress of the runs is reported.
pub(crate) fn progress_lines(common: &Common) -> LineProgress {
    let errors = std::io::stderr();
    if common.quiet {
        LineProgress::new(std::io::sink())
    } else if errors.is_terminal() {
        LineProgress::on_terminal(errors)
    } else {
        LineProgress::new(errors)
    }
}
