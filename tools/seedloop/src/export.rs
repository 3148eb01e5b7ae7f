//! `seedloop export`: a scene in the formats of other tools.

use crate::simulate::read_scene;
use anyhow::{Context as _, ensure};
use clap::ValueEnum;
use command_line::{Common, DONE, Header, try_folder, write_new};
use scene::{FillingLibrary, starting_frame};
use serde::Serialize;
use simulators::exchange::vtk::File;
use simulators::exchange::{add_warnings, csv, edem, lammps, liggghts, vtk};
use simulators::scene_simulator::ReadScene;
use std::path::PathBuf;

/// A format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Deck for LAMMPS: of a drum in.drum, drum.data, drum.bodies; of a bench in.bench, bench.data ...
    Lammps,
    /// Deck for LIGGGHTS: of a drum in.drum, cover.stl, seed1.spheres ...; of a bench in.bench, an STL file for each wall ...
    Liggghts,
    /// Table of settings for EDEM: edem.csv, and the spheres of each kind of seed
    Edem,
    /// Every sphere in the frames of a run, for `ParaView`: frames.pvd and one file a frame
    Vtk,
    /// Every sphere in the frames of a run, for a fluid solver: one table a frame
    Csv,
}

/// What is changed in the scene.
#[derive(clap::Args, Debug)]
pub(crate) struct Changes {
    /// Changes a setting of the scene, as in `seedloop simulate`
    #[arg(long, value_name = "NAME=VALUE", value_parser = crate::simulate::setting)]
    pub(crate) set: Vec<scene::Override>,

    /// Sets the calibrated values of a parameter file, as in `seedloop simulate`
    #[arg(long, value_name = "PARAMETERS.toml")]
    pub(crate) set_file: Option<PathBuf>,
}

/// Writes a scene as a deck for LAMMPS or LIGGGHTS, as a table for EDEM, or the frames of a run for `ParaView` or a fluid solver
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop export liggghts drum.toml --out deck")]
pub(crate) struct Arguments {
    /// Format
    #[arg(value_enum)]
    format: Format,

    /// Scene file
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,

    #[command(flatten)]
    changes: Changes,

    /// Seed of the starting places and turns of the seeds
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    #[command(flatten)]
    common: Common,
}

/// What was written, in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Names of the files in the folder.
    files: Vec<String>,
    /// What whoever takes the files over must know; their first one says it too.
    warnings: Vec<String>,
}

/// Reads the scene, runs it where frames are asked for, and writes the files.
///
/// # Errors
/// A scene that cannot be read, run or written in the format, files that exist.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    common.try_outputs([])?;
    try_folder(&arguments.out)?;
    let ReadScene {
        scene, warnings, ..
    } = read_scene(
        &arguments.scene,
        arguments.changes.set_file.as_deref(),
        &arguments.changes.set,
        common,
    )?;
    let library = FillingLibrary::default();
    let mut files = match arguments.format {
        Format::Lammps => {
            // Before places are sought, which takes time.
            lammps::check_deck(&scene)?;
            let (frame, bodies, time_step) = starting_frame(&scene, &library, arguments.seed)?;
            lammps::deck(&scene, &bodies, &frame, time_step, arguments.seed)?
        }
        Format::Liggghts => {
            liggghts::check_deck(&scene)?;
            let (frame, bodies, time_step) = starting_frame(&scene, &library, arguments.seed)?;
            liggghts::deck(&scene, &bodies, &frame, time_step, arguments.seed)?
        }
        Format::Edem => {
            let (_, bodies, time_step) = starting_frame(&scene, &library, arguments.seed)?;
            edem::tables(&scene, &bodies, time_step)?
        }
        Format::Vtk | Format::Csv => {
            let result = scene::run(&scene, &library, arguments.seed)?;
            let (frames, bodies) = (&result.frames, &result.bodies);
            if arguments.format == Format::Vtk {
                vtk::series("frames", &scene, frames, bodies)?
            } else {
                csv::series("frames", &scene, frames, bodies)
            }
        }
    };
    add_warnings(&mut files, &warnings);
    write_all(arguments, &files)?;
    for file in &files {
        common.print(arguments.out.join(&file.name).display())?;
    }
    let mut inputs = vec![arguments.scene.clone()];
    inputs.extend(arguments.changes.set_file.clone());
    inputs.extend(
        scene
            .shape_files()
            .iter()
            .map(|mesh| scene.folder.join(mesh)),
    );
    common.emit_json(&Report {
        header: Header::new(arguments.seed, inputs)?,
        files: files.into_iter().map(|f| f.name).collect(),
        warnings,
    })?;
    Ok(DONE)
}

/// Writes all files, or none if one of them exists.
fn write_all(arguments: &Arguments, files: &[File]) -> anyhow::Result<()> {
    let folder = &arguments.out;
    for file in files {
        let path = folder.join(&file.name);
        ensure!(
            arguments.common.force || !path.exists(),
            "{} exists: say --force to overwrite it, or give another folder",
            path.display()
        );
    }
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    for file in files {
        write_new(
            &folder.join(&file.name),
            file.text.as_bytes(),
            arguments.common.overwrite(),
        )?;
    }
    Ok(())
}
