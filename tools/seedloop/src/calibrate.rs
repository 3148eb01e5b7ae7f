//! `seedloop calibrate STUDY.toml`: the whole loop.

use crate::stop;
use anyhow::Context as _;
use campaign::LineProgress;
use command_line::{Common, DONE, Header, NOT_MET, Overwrite};
use std::path::{Path, PathBuf};
use study::{RunSettings, StudyFile, StudyResult, run_study, write_results};

/// Run the whole loop of a study: screening, response surface, solutions, validation, diagnosis
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// The study
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,

    /// Size of the loop, as the study file defines it
    #[arg(long, value_name = "NAME", default_value = "quick")]
    profile: String,

    /// First seed of all random numbers; the runs take those that follow: start a second loop 10000000 further
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Folder of the results [default: out/STUDY-PROFILE]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Go on in a folder that exists: finished runs are reused, result files are renewed
    #[arg(long)]
    resume: bool,
}

/// Runs the loop and writes the result folder.
///
/// # Errors
///
/// Bad input, runs that failed, files that cannot be written.
pub(crate) fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<u8> {
    let study = StudyFile::read(&arguments.study)?;
    study.profile(&arguments.profile)?;
    let folder = arguments.out.clone().unwrap_or_else(|| {
        PathBuf::from("out").join(format!("{}-{}", study.name, arguments.profile))
    });
    common.refuse_existing_json()?;
    refuse_used_folder(&folder, arguments.resume, common)?;
    let base = arguments.study.parent().unwrap_or(Path::new(""));
    let files = [
        arguments.study.clone(),
        base.join(&study.drum),
        base.join(&study.metering),
    ];
    let settings = RunSettings {
        profile: arguments.profile.clone(),
        seed: arguments.seed,
        threads: common.threads(),
        folder: folder.clone(),
        inputs: Header::new(arguments.seed, &files)?.inputs,
    };
    let progress = progress_lines(common);
    let announce = |stage: &str| common.log(|| format!("== {stage}"));
    let stop = stop::flag()?;
    let result = run_study(&study, &settings, &progress, &stop, &announce);
    let result = match stop::result_or_stopped(result, &folder)? {
        Ok(result) => result,
        Err(code) => return Ok(code),
    };
    write_results(&folder, &study, &result)
        .with_context(|| format!("cannot write the results into {}", folder.display()))?;
    common.print(summary(&result))?;
    common.print(format!("report: {}", folder.join("report.html").display()))?;
    common.emit_json(&result)?;
    Ok(if result.target_reached { DONE } else { NOT_MET })
}

/// Refuses a folder with results of an earlier run, unless the user said that it is to go on.
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
        "{} holds the results of an earlier run: give --resume to go on with it (finished runs \
         are reused), or another --out",
        folder.display()
    );
    Ok(())
}

/// Where the progress of the runs is told.
pub(crate) fn progress_lines(common: &Common) -> LineProgress {
    if common.quiet {
        LineProgress::new(std::io::sink())
    } else {
        LineProgress::new(std::io::stderr())
    }
}

/// The result in a few lines.
fn summary(result: &StudyResult) -> String {
    let with_sd = |mean: f64, sd: Option<f64>| match sd {
        Some(sd) => format!("{mean:.2} +- {sd:.2}"),
        None => format!("{mean:.2}"),
    };
    let values = |map: &std::collections::BTreeMap<String, f64>| {
        let one = |(name, value): (&String, &f64)| format!("{name} = {value:.4}");
        map.iter().map(one).collect::<Vec<_>>().join(", ")
    };
    let v = &result.validation;
    let mut lines = vec![
        format!(
            "factors kept by the screening: {}",
            result.kept_factors.join(", ")
        ),
        format!(
            "chosen point{}: {}",
            if result.target_reached {
                ""
            } else {
                " (the target is out of reach)"
            },
            values(&result.chosen)
        ),
        format!(
            "validation: {} deg over {} runs, target {:.2} deg, {:.2} % off",
            with_sd(v.point.mean, v.point.sd),
            v.point.n,
            v.target,
            v.relative_error_percent
        ),
        format!(
            "published optimum: {} deg",
            with_sd(result.published_optimum.mean, result.published_optimum.sd)
        ),
    ];
    for point in &result.sweep {
        lines.push(format!(
            "  {}: {} deg, {}",
            point.result.label,
            with_sd(point.result.mean, point.result.sd),
            point.regime
        ));
    }
    let d = &result.image_against_position;
    lines.push(format!(
        "image minus position: {:.2} deg, sd of runs {:.2} deg, {} frames",
        d.mean_deg, d.sd_of_runs_deg, d.n_frames
    ));
    lines.push(format!(
        "metering device (assumed dimensions): {} deg",
        with_sd(result.metering.result.mean, result.metering.result.sd)
    ));
    for (what, study) in [
        ("bench residual", &result.residual),
        ("hidden effect", &result.hidden.study),
        ("nothing hidden", &result.nothing_hidden.study),
    ] {
        lines.push(format!(
            "{what}: {} {}",
            study.diagnosis.verdict,
            study.diagnosis.summary()
        ));
    }
    lines.join("\n")
}
