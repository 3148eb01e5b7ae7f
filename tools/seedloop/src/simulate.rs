//! `seedloop simulate`: one run of a scene.

mod report;
mod run_line;
mod single_run;
mod state_file;

use crate::enter::{keep_run, require_memory};
use crate::run_flags::Retries;
use crate::stop::Stop;
use anyhow::{Context as _, anyhow, ensure};
use base64::Engine as _;
use campaign::run_store::{Lookup, Record, Store};
use command_line::{Common, DONE, Header, NOT_MET, try_folder, write_new};
use input::file::has_ending;
use report::Report;
pub(crate) use report::table_of;
use scene::{Override, Progress, RunResult, Scene};
use simulators::exchange::npz;
use simulators::scene_simulator::{ReadScene, RunDetails};
use single_run::SingleRun;
use state_file::{StateFile, state_files};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Runs one scene and prints what it shows
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop simulate drum.toml --set rpm=20 --frame drum.png")]
pub(crate) struct Arguments {
    /// Scene file
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,

    /// Further settings, as after --set
    #[arg(value_name = "NAME=VALUE", value_parser = setting)]
    further: Vec<Override>,

    /// Changes a setting of the scene by its dotted path (contact.seed-seed.static_friction=0.2),
    /// or by its short name where only one setting has it (rpm=20, frames=6)
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    set: Vec<Override>,

    /// Sets the calibrated values of a parameter file, such as the parameters.toml of `seedloop calibrate`; values of
    /// settings that the scene does not have are reported, and --set comes after it
    #[arg(long, value_name = "PARAMETERS.toml")]
    set_file: Option<PathBuf>,

    /// Seed of the starting places and turns of the seeds
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Keeps the record of the run in DIR/runs
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Takes the record of the same run from DIR/runs, if there is one, or continues from the state in DIR
    /// where the run was stopped
    #[arg(long, requires = "out")]
    resume: bool,

    /// Keeps the state of the running run in DIR once in so many seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, requires = "out", value_parser = seconds)]
    keep_every: f64,

    #[command(flatten)]
    retries: Retries,

    /// Writes the last frame: a drum as its camera sees it, with its walls of triangles, a heap or a box from the side
    #[arg(long, value_name = "FILE.png")]
    frame: Option<PathBuf>,

    /// Writes all frames as arrays for `NumPy`: places, rotations and velocities of the seeds, their spheres, and what the
    /// camera saw
    #[arg(long, value_name = "FILE.npz")]
    arrays: Option<PathBuf>,

    #[command(flatten)]
    common: Common,
}

/// Reads `name=value`.
pub(crate) fn setting(text: &str) -> Result<Override, String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok(Override {
                name: name.trim().to_owned(),
                value: value.trim().to_owned(),
            })
        }
        _ => Err("a setting is NAME=VALUE, such as rpm=20".to_owned()),
    }
}

/// Reads a scene with the values of a parameter file and further settings, and logs what must be known of the values.
///
/// # Errors
/// As [`simulators::scene_simulator::read_scene`].
pub(crate) fn read_scene(
    file: &Path,
    set_file: Option<&Path>,
    set: &[Override],
    common: &Common,
) -> anyhow::Result<ReadScene> {
    let read = simulators::scene_simulator::read_scene(file, set_file, set)?;
    log_warnings(&read.warnings, common);
    Ok(read)
}

/// Logs warnings, a line each.
pub(crate) fn log_warnings(warnings: &[String], common: &Common) {
    for warning in warnings {
        common.log(|| format!("warning: {warning}"));
    }
}

/// Reads a time of 0 s or more.
fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text
        .parse()
        .ok()
        .filter(|s: &f64| s.is_finite() && *s >= 0.0);
    seconds.ok_or_else(|| "it must be a number of seconds, 0 or more".to_owned())
}

/// A finished run.
struct Outcome {
    record: Record,
    /// The run itself; `None` if the record was there before.
    result: Option<RunResult>,
    /// Why the record could not be kept; `None` if it is, or was not to be.
    not_kept: Option<anyhow::Error>,
}

/// Reads the scene, runs it or finds its record, prints.
///
/// # Errors
/// A scene that cannot be read or run, files that exist or cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    try_outputs(arguments)?;
    let set = [arguments.set.as_slice(), &arguments.further].concat();
    let set_file = arguments.set_file.as_deref();
    let ReadScene {
        scene,
        changes,
        warnings,
    } = read_scene(&arguments.scene, set_file, &set, common)?;
    let mut inputs = vec![arguments.scene.clone()];
    inputs.extend(arguments.set_file.clone());
    let shapes = scene.shape_files();
    inputs.extend(shapes.iter().map(|mesh| scene.folder.join(mesh)));
    let header = Header::new(arguments.seed, inputs)?;
    require_memory([&scene], 1)?;
    let of_frames = [
        ("--frame", &arguments.frame),
        ("--arrays", &arguments.arrays),
    ];
    for (flag, file) in of_frames {
        let Some(file) = file else { continue };
        ensure!(
            !scene.apparatus.is_bench_test(),
            "{flag} {}: a bench test has no frames; leave it out",
            file.display()
        );
    }
    let single = SingleRun::new(scene, arguments.seed)?;
    let folder = arguments.out.as_ref();
    let files = folder.map(|folder| state_files(folder, single.blank_record().key()));
    let stop = Stop::new(move || kept(files.as_ref()))?;
    let outcome = match stop.result(find_or_run(arguments, &single, &stop)) {
        Ok(Ok(outcome)) => outcome,
        Ok(Err(code)) => return Ok(code),
        Err(error) => return Err(error),
    };
    let mut report = Report::new(header, &outcome, single.scene(), &changes)?;
    log_warnings(&report.warnings, common);
    report.warnings.splice(0..0, warnings);
    if let Some(reason) = report.refusal() {
        // The reason of a refusal is reported even when the log is quiet.
        writeln!(std::io::stderr(), "refused: {reason}")?;
    }
    // The run is done: what cannot be written takes nothing else with it.
    all_written([
        common.print(report.text().trim_end()),
        common.emit_json(&report),
        outcome.not_kept.map_or(Ok(()), Err),
        write_frame(arguments, &outcome.record),
        write_arrays(arguments, single.scene(), outcome.result.as_ref()),
    ])?;
    Ok(if report.refusal().is_some() {
        NOT_MET
    } else {
        DONE
    })
}

/// All that went wrong while results were written, as one error.
pub(crate) fn all_written<const N: usize>(written: [anyhow::Result<()>; N]) -> anyhow::Result<()> {
    let mut wrong = written.into_iter().filter_map(Result::err);
    let Some(first) = wrong.next() else {
        return Ok(());
    };
    Err(wrong.fold(first, |all, error| anyhow!("{all:#}; {error:#}")))
}

/// What is kept of a run that is stopped, whose states these files hold, and how to continue.
fn kept(states: Option<&[PathBuf; 2]>) -> String {
    let Some(states) = states else {
        return "nothing is kept; with --out DIR a run can continue later".to_owned();
    };
    match states.iter().find(|file| file.exists()) {
        Some(file) => format!(
            "the state of the run is kept in {}; the same command with --resume continues",
            file.parent().unwrap_or(file).display()
        ),
        // While a run is set up, and while the frames of one that has come to its end are read, there is no state.
        None => "no state of the run is kept; the same command begins it again".to_owned(),
    }
}

/// Tries whether the results can be written, before the work is done.
fn try_outputs(arguments: &Arguments) -> anyhow::Result<()> {
    let endings = [
        (
            &arguments.frame,
            "--frame",
            "png",
            "the picture is written as PNG",
        ),
        (
            &arguments.arrays,
            "--arrays",
            "npz",
            "the frames are written as arrays for NumPy",
        ),
    ];
    for (file, flag, ending, what) in endings {
        if let Some(file) = file {
            ensure!(
                has_ending(file, &[ending]),
                "{flag} {}: {what}; give a name that ends in .{ending}",
                file.display()
            );
        }
    }
    if let Some(folder) = &arguments.out {
        try_folder(folder)?;
    }
    arguments
        .common
        .try_outputs([&arguments.frame, &arguments.arrays].into_iter().flatten())
}

/// Finds the record of the run, or runs and keeps it.
fn find_or_run(arguments: &Arguments, single: &SingleRun, stop: &Stop) -> anyhow::Result<Outcome> {
    let common = &arguments.common;
    let store = arguments
        .out
        .as_ref()
        .map(|folder| Store::open(folder.join("runs")));
    let store = store.transpose()?;
    let blank = single.blank_record();
    let _keeper = match &store {
        Some(store) => Some(keep_run(store, blank.key())?),
        None => None,
    };
    if let Some(store) = &store {
        match store.get(blank.key())? {
            Lookup::Found(record) if arguments.resume => {
                ensure!(
                    arguments.arrays.is_none(),
                    "{} has the record of this run, which contains only its last frame: give --force instead of --resume \
                     to run again for --arrays",
                    place(store)
                );
                return Ok(Outcome {
                    record,
                    result: None,
                    not_kept: None,
                });
            }
            Lookup::Found(_) => ensure!(
                common.force,
                "{} has the record of this run: say --resume to take it, or --force to run again",
                place(store)
            ),
            Lookup::Damaged { path, reason } => {
                let away = store.set_aside(&path)?;
                common.log(|| {
                    let name = away.as_deref().and_then(Path::file_name);
                    format!(
                        "warning: {} is not the record of its run: {reason}; it is set aside as {}, and the run \
                         is done again",
                        path.display(),
                        name.unwrap_or_default().display()
                    )
                });
            }
            Lookup::Absent => {}
        }
    }
    run_and_keep(arguments, single, store.as_ref(), stop)
}

/// Runs the scene, from where it was left, and keeps what was asked for.
fn run_and_keep(
    arguments: &Arguments,
    single: &SingleRun,
    store: Option<&Store>,
    stop: &Stop,
) -> anyhow::Result<Outcome> {
    let common = &arguments.common;
    let (scene, seed) = (single.scene(), arguments.seed);
    common.log(|| match scene.apparatus.repeats() {
        Some(repeats) => format!("running {repeats} repeats of the bench test, seed {seed}"),
        None => format!("running {} seeds, seed {seed}", scene.seed_count()),
    });
    let folder = arguments.out.as_deref();
    let mut state = StateFile::new(
        folder,
        single.blank_record().key(),
        arguments.keep_every,
        stop.flag(),
        common,
    );
    let left = left_before(arguments, &mut state)?;
    if let Some(left) = &left {
        common.log(|| format!("continues from {:.2} s of the run", left.time()));
    }
    let continued = left.is_some();
    let limits = (common.threads(), arguments.retries.number);
    let run = single.run(limits, left, &mut state);
    let way_out = || {
        let from = state.name();
        format!("the run continued from {from}; remove it to start again")
    };
    let (record, result) = if continued {
        run.with_context(way_out)
    } else {
        run
    }?;
    let kept = store.map_or(Ok(()), |store| {
        store.put(&record)?;
        state.remove()?;
        common.log(|| format!("record {} in {}", record.key(), place(store)));
        anyhow::Ok(())
    });
    Ok(Outcome {
        record,
        result: Some(result),
        not_kept: kept.err(),
    })
}

/// The state from which a run continues; `None` if it begins again.
///
/// # Errors
/// A state that the user did not speak of, or that cannot be read.
fn left_before(
    arguments: &Arguments,
    state: &mut StateFile<'_>,
) -> anyhow::Result<Option<Progress>> {
    let common = &arguments.common;
    if arguments.resume {
        let left = state.left()?;
        for warning in left.warnings {
            common.log(|| format!("warning: {warning}"));
        }
        return Ok(left.progress);
    }
    ensure!(
        common.force || !state.exists(),
        "{} has the state of this run, which was stopped: give --resume to continue from it, or --force \
         to run again",
        state.name()
    );
    Ok(None)
}

/// Writes the last frame, which the record holds as text.
fn write_frame(arguments: &Arguments, record: &Record) -> anyhow::Result<()> {
    let Some(file) = &arguments.frame else {
        return Ok(());
    };
    let text = RunDetails::of(record)?.last_frame_png_base64;
    let text = text.with_context(|| {
        format!(
            "{}: the record of the run has no picture; run it again with --force",
            file.display()
        )
    })?;
    let picture = base64::engine::general_purpose::STANDARD
        .decode(text)
        .context("the picture in the record is damaged; run again with --force")?;
    write_new(file, &picture, arguments.common.overwrite())
}

/// Writes all frames as arrays.
fn write_arrays(
    arguments: &Arguments,
    scene: &Scene,
    result: Option<&RunResult>,
) -> anyhow::Result<()> {
    let (Some(file), Some(result)) = (&arguments.arrays, result) else {
        return Ok(());
    };
    let frames = npz::archive(scene, &result.frames, &result.bodies)?;
    write_new(file, &frames, arguments.common.overwrite())
}

/// The folder of a store, for messages.
fn place(store: &Store) -> String {
    let folder = store.folder();
    folder.map_or_else(String::new, |folder| folder.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::{all_written, kept, state_files};

    /// A state is promised where one is, and only there.
    #[test]
    fn what_is_told_to_be_kept_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let files = state_files(folder.path(), "key");
        assert!(kept(Some(&files)).contains("begins it again"));
        std::fs::write(&files[1], "state").unwrap();
        assert!(kept(Some(&files)).contains("--resume continues"));
        assert!(kept(None).contains("with --out DIR"));
    }

    /// Everything that could not be written is reported, and nothing else is lost for it.
    #[test]
    fn what_cannot_be_written_is_told_at_the_end() {
        let refused = |what: &str| Err(anyhow::anyhow!("{what} is full"));
        assert!(all_written([Ok(()), Ok(())]).is_ok());
        let told = all_written([refused("a.png"), Ok(()), refused("b.npz")]);
        assert_eq!(
            told.unwrap_err().to_string(),
            "a.png is full; b.npz is full"
        );
    }
}
