//! `seedloop init`: a commented study to start from.

use anyhow::Context as _;
use clap::ValueEnum;
use command_line::{Common, DONE, try_folder, write_new};
use serde::Serialize;
use std::path::PathBuf;
use study::Starter;

/// What the study measures in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// A rotating drum, angles at two speeds
    Drum,
    /// A heap from a cylinder that is lifted
    Heap,
    /// A box whose gate is lifted
    Box,
    /// A hopper that is emptied through its opening
    Hopper,
    /// A box whose seeds fall through a slot on a second floor
    DrawDown,
    /// A heap that is poured
    PouredHeap,
    /// A plate over whose ends a bed is discharged
    Ledge,
    /// A cup that is filled, struck off and tapped
    BulkDensity,
    /// A bed under a piston
    Compression,
    /// A shear box
    DirectShear,
    /// A probe pressed into a bed
    Penetration,
    /// Several benches with the same seeds, with the question what to measure next
    Benches,
}

impl Kind {
    /// The study that it starts from.
    fn starter(self) -> Starter {
        match self {
            Self::Drum => Starter::Drum,
            Self::Heap => Starter::Heap,
            Self::Box => Starter::Box,
            Self::Hopper => Starter::Hopper,
            Self::DrawDown => Starter::DrawDown,
            Self::PouredHeap => Starter::PouredHeap,
            Self::Ledge => Starter::Ledge,
            Self::BulkDensity => Starter::BulkDensity,
            Self::Compression => Starter::Compression,
            Self::DirectShear => Starter::DirectShear,
            Self::Penetration => Starter::Penetration,
            Self::Benches => Starter::Benches,
        }
    }
}

/// Writes a commented study to start from, its scene, and the job script of a cluster
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop init drum --out my-drum")]
pub(crate) struct Arguments {
    /// What the study measures in
    #[arg(value_enum)]
    kind: Kind,

    /// Folder for the files
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,

    #[command(flatten)]
    common: Common,
}

/// What was written, in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version of the program.
    version: &'static str,
    files: Vec<PathBuf>,
}

/// Writes all files, or none if one of them exists.
///
/// # Errors
/// Files that exist, a folder that cannot be made or written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let (folder, common) = (&arguments.out, &arguments.common);
    common.try_outputs([])?;
    try_folder(folder)?;
    let files = arguments.kind.starter().files();
    for file in &files {
        let path = folder.join(&file.name);
        anyhow::ensure!(
            common.force || !path.exists(),
            "{} exists: say --force to overwrite it, or give another --out",
            path.display()
        );
    }
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let mut written = Vec::new();
    for file in &files {
        let path = folder.join(&file.name);
        write_new(&path, file.text.as_bytes(), common.overwrite())?;
        common.print(path.display())?;
        written.push(path);
    }
    let study = folder.join("study.toml");
    common.log(|| {
        format!(
            "next: replace the values marked EXAMPLE, then seedloop calibrate {} --plan",
            study.display()
        )
    });
    common.emit_json(&Report {
        version: env!("CARGO_PKG_VERSION"),
        files: written,
    })?;
    Ok(DONE)
}
