//! The files of a filling.

use crate::arguments::Arguments;
use crate::connections::bond_table;
use crate::sphere_file::{choose_format, sphere_text};
use crate::summary::{Measured, Summary};
use crate::{page, preview};
use command_line::write_new;
use geometry::clump::files::Format;
use std::path::{Path, PathBuf};
use trimesh::TriMesh;

/// Tries whether all files that are asked for can be written.
///
/// # Errors
///
/// A name that tells no format, a file that cannot be written.
pub(crate) fn try_all(arguments: &Arguments) -> anyhow::Result<()> {
    format_of(arguments)?;
    let files = [
        &arguments.out,
        &arguments.bonds,
        &arguments.union,
        &arguments.preview,
        &arguments.html,
    ];
    let inputs = arguments.mesh.iter().chain(&arguments.spheres);
    let files = files.into_iter().flatten();
    arguments.common.try_outputs_beside(inputs, files)?;
    if let Some(file) = &arguments.preview {
        anyhow::ensure!(
            file.extension()
                .is_some_and(|end| end.eq_ignore_ascii_case("png")),
            "--preview {}: the picture is written as PNG; give a name that ends in .png",
            file.display()
        );
    }
    Ok(())
}

/// Format of the spheres, where they are asked for.
fn format_of(arguments: &Arguments) -> anyhow::Result<Option<Format>> {
    Ok(match (&arguments.out, arguments.format) {
        (Some(file), asked) => Some(choose_format(asked, file)?),
        (None, Some(asked)) => Some(choose_format(Some(asked), "".as_ref())?),
        (None, None) => None,
    })
}

/// Outputs that failed, each with its reason: none of them keeps the others from being written.
#[derive(Debug, Default)]
pub(crate) struct Failures(Vec<String>);

impl Failures {
    /// The outcome of the work for a file; a failure is noted under its name.
    pub(crate) fn of<T>(
        &mut self,
        file: Option<&PathBuf>,
        work: impl FnOnce() -> anyhow::Result<T>,
    ) -> Option<T> {
        let name = file.as_ref().map_or("standard output".to_owned(), |file| {
            file.display().to_string()
        });
        work()
            .inspect_err(|error| self.0.push(format!("{name} is not written: {error:#}")))
            .ok()
    }
}

/// Writes what is asked for: files, text, JSON, as many of them as can be written.
///
/// # Errors
///
/// A body that cannot be drawn, a file that cannot be written; all others are written.
pub(crate) fn write(
    arguments: &Arguments,
    mesh: &TriMesh,
    measured: &Measured<'_>,
    mut summary: Summary,
    mut failures: Failures,
) -> anyhow::Result<()> {
    let (common, filling) = (&arguments.common, measured.filling);
    let write_to = |file: &Path, bytes: &[u8]| write_new(file, bytes, common.overwrite());
    let file = Path::new(mesh.source());
    let name = file
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mass = arguments.mass_of(filling.mesh_moments.volume);
    let text = |format: Format| sphere_text(format, filling, &name, arguments.unit, mass);
    let format = format_of(arguments)?;
    if let (Some(file), Some(format)) = (&arguments.out, format) {
        failures.of(arguments.out.as_ref(), || {
            write_to(file, text(format).as_bytes())
        });
    }
    failures.of(None, || match (&arguments.out, format) {
        (None, Some(format)) => common.print(text(format).trim_end()),
        _ => common.print(summary.text()),
    });
    if let Some(file) = &arguments.bonds {
        let table = bond_table(filling, measured.connectivity, arguments.unit);
        failures.of(arguments.bonds.as_ref(), || {
            write_to(file, table.as_bytes())
        });
    }
    if let (Some(file), Some(surface)) = (&arguments.union, summary.union_file()) {
        failures.of(arguments.union.as_ref(), || write_to(file, &surface.bytes));
    }
    if let Some(file) = &arguments.preview {
        failures.of(arguments.preview.as_ref(), || {
            write_to(file, &preview::picture(filling, mesh)?)
        });
    }
    if let Some(file) = &arguments.html {
        failures.of(arguments.html.as_ref(), || {
            write_to(file, page::page(&summary, measured, mesh)?.as_bytes())
        });
    }
    for failure in &failures.0 {
        summary.warn(failure.clone());
    }
    let json = common.emit_json(&summary);
    let all = failures
        .0
        .into_iter()
        .chain(json.err().map(|error| format!("{error:#}")));
    let all: Vec<String> = all.collect();
    anyhow::ensure!(all.is_empty(), "{}; all else is written", all.join("; "));
    Ok(())
}
