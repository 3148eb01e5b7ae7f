//! What other programs take over: the parameters as a file of settings, and drums and benches as decks.

use crate::{Error, Study, StudyResult};
use command_line::{Overwrite, write_new};
use inference::{Calibration, Estimate};
use scene::{Apparatus, FillingLibrary, Scene, starting_frame};
use serde::Serialize;
use simulators::exchange::vtk::File;
use simulators::exchange::{add_warnings, lammps, liggghts};
use simulators::scene_simulator::{CalibratedEffect, CalibratedParameter, ParameterFile};
use std::path::{Path, PathBuf};

/// The parameters as a file that `--set-file` reads; it does not say yet whether they meet the measurements.
pub fn parameter_file(estimates: &[Estimate]) -> ParameterFile {
    let row = |e: &Estimate| CalibratedParameter {
        symbol: e.symbol.clone(),
        name: e.name.clone(),
        sets: e.sets.clone(),
        value: e.value,
        unit: (e.unit != "1").then(|| e.unit.clone()),
        se: e.se,
        interval95: Some(e.interval95),
        fixed_by_data: Some(e.fixed_by_data),
        at_limit: Some(e.at_limit),
    };
    ParameterFile {
        parameter: estimates.iter().map(row).collect(),
        file: "parameters.toml".into(),
        ..ParameterFile::default()
    }
}

/// The parameters of a result as a file, with its verdict: those that were fitted with the effects that the model lacks where only these
/// meet the measurements.
fn of_result(calibration: &Calibration) -> ParameterFile {
    let with = calibration.with_effects.as_ref().filter(|with| with.holds);
    let estimates = with.map_or(&calibration.parameters, |with| &with.parameters);
    let effects = with.iter().flat_map(|with| &with.effects);
    let effect = |(name, amplitude): (&String, &f64)| CalibratedEffect {
        name: name.clone(),
        amplitude: *amplitude,
    };
    ParameterFile {
        met: Some(calibration.met),
        verdict: Some(calibration.verdict.clone()),
        effect: effects.map(effect).collect(),
        ..parameter_file(estimates)
    }
}

/// Writes `parameters.toml`, and in `decks/SCENE/lammps` and `decks/SCENE/liggghts` every drum and bench in phases with the estimates.
///
/// A deck that the other program cannot run is left out; the reason joins the remarks of the result. Gives the files, in
/// the order in which they were written; each is written whole or not at all.
///
/// # Errors
///
/// A file that cannot be written, an estimate that a scene refuses.
pub fn write_hand_over(
    folder: &Path,
    study: &Study,
    result: &mut StudyResult,
) -> Result<Vec<PathBuf>, Error> {
    let path = folder.join("parameters.toml");
    // The file is passed on alone.
    let parameters = of_result(&result.calibration);
    write(&path, parameters.to_toml()?.as_bytes())?;
    let doubts = parameters.doubts();
    let mut written = vec![path];
    let fillings = &study.fillings;
    for (name, scene) in &study.scenes {
        let is_drum = matches!(scene.apparatus, Apparatus::Drum(_));
        if !is_drum && !scene.apparatus.has_phases() {
            continue;
        }
        let (scene, _) = parameters.applied(scene)?;
        for (tool, deck) in [
            ("lammps", lammps_deck(&scene, fillings, result.seed)),
            ("liggghts", liggghts_deck(&scene, fillings, result.seed)),
        ] {
            let deck_folder = folder.join("decks").join(name).join(tool);
            match deck {
                Ok(mut files) => {
                    add_warnings(&mut files, &doubts);
                    for file in files {
                        let path = deck_folder.join(&file.name);
                        write(&path, file.text.as_bytes())?;
                        written.push(path);
                    }
                }
                Err(reason) => {
                    let remark = format!("no deck of scene '{name}' for {tool}: {reason}");
                    result.calibration.remarks.push(remark);
                }
            }
        }
    }
    Ok(written)
}

fn lammps_deck(
    scene: &Scene,
    fillings: &FillingLibrary,
    seed: u64,
) -> Result<Vec<File>, simulators::exchange::Error> {
    let (frame, bodies, time_step) = starting_frame(scene, fillings, seed)?;
    lammps::deck(scene, &bodies, &frame, time_step, seed)
}

fn liggghts_deck(
    scene: &Scene,
    fillings: &FillingLibrary,
    seed: u64,
) -> Result<Vec<File>, simulators::exchange::Error> {
    let (frame, bodies, time_step) = starting_frame(scene, fillings, seed)?;
    liggghts::deck(scene, &bodies, &frame, time_step, seed)
}

/// Writes a result as JSON, whole or not at all; numbers that are not finite become null.
///
/// # Errors
///
/// A result without a form in JSON, a file that cannot be written.
pub fn write_json(path: &Path, result: &impl Serialize) -> Result<(), Error> {
    let mut bytes = serde_json::to_vec_pretty(result).map_err(|source| Error::Write {
        path: path.to_owned(),
        reason: source.to_string(),
    })?;
    bytes.push(b'\n');
    write(path, &bytes)
}

/// Writes a result with its digest, so that [`Study::values_from`] finds what was altered; over one of an earlier run. `clock` names
/// what depends on the clock and not on the study, by JSON pointers: the digest does not count it, so that a campaign that was ended
/// and resumed has the digest of one that was not.
///
/// # Errors
///
/// A result that has no form in JSON, a file that cannot be written.
pub fn write_result(path: &Path, result: &impl Serialize, clock: &[&str]) -> Result<(), Error> {
    let bytes =
        campaign::run_store::seal_without(result, clock).map_err(|source| Error::Write {
            path: path.to_owned(),
            reason: source.to_string(),
        })?;
    write(path, &bytes)
}

/// Writes a file whole or not at all, over one of an earlier run; makes its folder if it is missing.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let refused = |reason: String| Error::Write {
        path: path.to_owned(),
        reason,
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| refused(e.to_string()))?;
    }
    write_new(path, bytes, Overwrite::Allow).map_err(|e| refused(format!("{e:#}")))
}
