//! `seedloop read-deck`: the observables of a bench that ran in LAMMPS or LIGGGHTS.

use crate::export::Changes;
use crate::simulate::{read_scene, table_of};
use campaign::run_store::Observation;
use command_line::{Common, DONE, Header};
use scene::{FillingLibrary, starting_frame};
use serde::Serialize;
use simulators::exchange::bench_results;
use simulators::scene_simulator::{ReadScene, over_frames};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Reads what the exported deck of a bench left in its folder, and prints the observables by the rules of `seedloop simulate`
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop read-deck hopper.toml deck")]
pub(crate) struct Arguments {
    /// Scene file of which the deck was made
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,

    /// Folder in which the deck ran
    #[arg(value_name = "DECK")]
    deck: PathBuf,

    #[command(flatten)]
    changes: Changes,

    /// Seed with which the deck was exported
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    common: Common,
}

/// What was read, in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Results by name.
    observables: BTreeMap<String, Observation>,
}

/// Reads the scene and the files of the deck, and prints the observables.
///
/// # Errors
/// A scene that cannot be read or has no phases, files of the deck that are missing or are not what it leaves.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    common.try_outputs([])?;
    let set_file = arguments.changes.set_file.as_deref();
    let ReadScene { scene, .. } =
        read_scene(&arguments.scene, set_file, &arguments.changes.set, common)?;
    let (_, bodies, time_step) =
        starting_frame(&scene, &FillingLibrary::default(), arguments.seed)?;
    let read = bench_results::read(&scene, &bodies, time_step, &arguments.deck)?;
    let observed = read.iter().filter_map(|found| {
        let value = over_frames(&found.values, found.unit)?;
        Some((found.name.to_string(), value))
    });
    let observables: BTreeMap<_, _> = observed.collect();
    common.print(table_of(&observables).trim_end())?;
    let mut inputs = vec![arguments.scene.clone()];
    inputs.extend(arguments.changes.set_file.clone());
    common.emit_json(&Report {
        header: Header::new(arguments.seed, inputs)?,
        observables,
    })?;
    Ok(DONE)
}
