//! `seedloop init`: a commented study to start from.

use anyhow::Context as _;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use command_line::{Common, DONE, try_folder, write_new};
use serde::Serialize;
use std::path::PathBuf;
use study::{STARTERS, Starter};

/// The starters as values of an argument.
fn starters() -> impl TypedValueParser<Value = &'static Starter> {
    let value = |starter: &Starter| PossibleValue::new(starter.name).help(starter.about);
    PossibleValuesParser::new(STARTERS.iter().map(value)).try_map(|name| {
        STARTERS
            .iter()
            .find(|s| s.name == name)
            .ok_or("no such study")
    })
}

/// Writes a commented study to start from, its scene, and the job script of a cluster
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop init drum --out my-drum")]
pub(crate) struct Arguments {
    /// What the study measures in
    #[arg(value_parser = starters())]
    kind: &'static Starter,

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
    let files = arguments.kind.files();
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
