//! The files of a filling.

use crate::arguments::Arguments;
use crate::connections::bond_table;
use crate::sphere_file::{choose_format, sphere_text};
use crate::summary::{Measured, Summary};
use crate::{page, preview};
use clump::files::Format;
use command_line::write_new;
use std::path::Path;
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

/// Writes what is asked for: files, text, JSON.
///
/// # Errors
///
/// A body that cannot be drawn, a file that cannot be written.
pub(crate) fn write(
    arguments: &Arguments,
    mesh: &TriMesh,
    measured: &Measured<'_>,
    summary: &Summary,
) -> anyhow::Result<()> {
    let (common, filling) = (&arguments.common, measured.filling);
    let file = Path::new(mesh.source());
    let name = file
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mass = arguments.mass_of(filling.mesh_moments.volume);
    let text = |format: Format| sphere_text(format, filling, &name, arguments.unit, mass);
    match (&arguments.out, format_of(arguments)?) {
        (Some(file), Some(format)) => {
            write_new(file, text(format).as_bytes(), common.overwrite())?;
            common.print(summary.text())?;
        }
        (None, Some(format)) => common.print(text(format).trim_end())?,
        _ => common.print(summary.text())?,
    }
    if let Some(file) = &arguments.bonds {
        let table = bond_table(filling, measured.connectivity, arguments.unit);
        write_new(file, table.as_bytes(), common.overwrite())?;
    }
    if let (Some(file), Some(surface)) = (&arguments.union, summary.union_file()) {
        write_new(file, &surface.bytes, common.overwrite())?;
    }
    if let Some(file) = &arguments.preview {
        let picture = preview::picture(filling, mesh)?;
        write_new(file, &picture, common.overwrite())?;
    }
    if let Some(file) = &arguments.html {
        let page = page::page(summary, measured, mesh)?;
        write_new(file, page.as_bytes(), common.overwrite())?;
    }
    common.emit_json(summary)
}
