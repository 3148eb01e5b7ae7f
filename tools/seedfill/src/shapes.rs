//! The shapes of several meshes as one table.

use crate::arguments::Arguments;
use crate::moments::Shape;
use crate::{inputs, read_body, settings_of};
use command_line::{DONE, ERROR, Header, NOT_MET, significant, write_new};
use experiment_design::table::csv_field;
use serde::Serialize;
use sphere_fill::{FillSettings, fill};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use trimesh::LengthUnit;

/// All shapes as JSON; lengths, areas and volumes are in `unit`.
#[derive(Debug, Serialize)]
struct Shapes {
    #[serde(flatten)]
    header: Header,
    unit: LengthUnit,
    meshes: Vec<Row>,
}

/// Known data of one mesh.
#[derive(Debug, Default, Serialize)]
struct Row {
    mesh: String,
    /// None for a mesh that cannot be read or bounds no body.
    shape: Option<Shape>,
    /// Spheres of its filling, where one is asked for and succeeds.
    spheres: Option<usize>,
    /// Volume of their union over that of the mesh.
    volume_share: Option<f64>,
    warnings: Vec<String>,
    /// Why something is missing.
    problem: Option<String>,
}

/// Reads the meshes one after another, and writes one table; a bad mesh has a row with its reason.
///
/// # Errors
///
/// Invalid flags, a table that cannot be written.
pub(crate) fn run(arguments: &Arguments, file: &PathBuf) -> anyhow::Result<u8> {
    let (common, unit) = (&arguments.common, arguments.unit);
    let radius = arguments.radius.as_deref();
    let settings = radius
        .map(|radius| settings_of(arguments, radius))
        .transpose()?;
    let of_filling = [
        ("count", arguments.count.is_some()),
        ("max-spheres", arguments.max_spheres.is_some()),
        ("target", arguments.target.is_some()),
        ("roughness", arguments.roughness.is_some()),
    ];
    if let Some((flag, _)) = of_filling
        .iter()
        .find(|(_, given)| *given && settings.is_none())
    {
        anyhow::bail!("--{flag} is for fillings: give --radius as well");
    }
    arguments.repair()?;
    // A name of a workbook that cannot be written is refused before the work.
    command_line::table_file::bytes_for(file, "mesh\nmesh\n")?;
    common.try_outputs_beside(&arguments.mesh, [file])?;
    let mut meshes = Vec::new();
    for mesh in &arguments.mesh {
        let row = row_of(arguments, mesh, settings.as_ref());
        for warning in &row.warnings {
            common.log(|| format!("warning: {}: {warning}", row.mesh));
        }
        if let Some(problem) = &row.problem {
            common.log(|| format!("refused: {}: {problem}", row.mesh));
        }
        meshes.push(row);
    }
    let csv = table(&meshes, unit);
    write_new(
        file,
        &command_line::table_file::bytes_for(file, &csv)?,
        common.overwrite(),
    )?;
    common.print(text(&meshes, unit))?;
    let bodies = arguments.mesh.iter();
    let files = bodies.flat_map(|body| inputs(arguments, body).unwrap_or_default());
    let readable = files.filter(|file| file.is_file());
    let (unread, bad) = (
        meshes.iter().filter(|row| row.shape.is_none()).count(),
        meshes.iter().filter(|row| row.problem.is_some()).count(),
    );
    let code = match (unread, bad) {
        (unread, _) if unread == meshes.len() => ERROR,
        (_, 0) => DONE,
        _ => NOT_MET,
    };
    common.emit_json(&Shapes {
        header: Header::new(arguments.seed, readable)?,
        unit,
        meshes,
    })?;
    Ok(code)
}

/// Reads a mesh, measures and fills it.
fn row_of(arguments: &Arguments, mesh: &Path, settings: Option<&FillSettings>) -> Row {
    let mut row = Row {
        mesh: mesh.display().to_string(),
        ..Row::default()
    };
    if let Err(error) = measure(arguments, mesh, settings, &mut row) {
        row.problem = Some(error.to_string());
    }
    row
}

/// Fills in a row as far as it goes.
fn measure(
    arguments: &Arguments,
    mesh: &Path,
    settings: Option<&FillSettings>,
    row: &mut Row,
) -> anyhow::Result<()> {
    let read = read_body(arguments, mesh)?;
    row.warnings = read
        .report
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect();
    row.shape = Some(Shape::new(&read.mesh.shape()?, arguments.unit));
    if let Some(settings) = settings {
        let filling = fill(&read.mesh, settings)?;
        row.spheres = Some(filling.spheres.len());
        row.volume_share = Some(filling.report.union_fraction);
    }
    Ok(())
}

/// The table as CSV, a row for each mesh.
fn table(rows: &[Row], unit: LengthUnit) -> String {
    let mut text = format!(
        "mesh,volume_{unit}3,area_{unit}2,equivalent_diameter_{unit},longest_{unit},intermediate_{unit},\
         shortest_{unit},elongation,flatness,sphericity,spheres,volume_share,problem\n"
    );
    for row in rows {
        let numbers = row.shape.as_ref().map_or_else(
            || ",".repeat(8),
            |shape| shape.numbers().map(|number| number.to_string()).join(","),
        );
        let spheres = row.spheres.map(|n| n.to_string()).unwrap_or_default();
        let share = row
            .volume_share
            .map(|share| share.to_string())
            .unwrap_or_default();
        let problem = csv_field(row.problem.as_deref().unwrap_or_default());
        let mesh = csv_field(&row.mesh);
        writeln!(text, "{mesh},{numbers},{spheres},{share},{problem}")
            .expect("a string takes all text");
    }
    text
}

/// The table for people.
fn text(rows: &[Row], unit: LengthUnit) -> String {
    let width = rows
        .iter()
        .map(|row| row.mesh.chars().count())
        .max()
        .unwrap_or(0)
        .max(4);
    let heads = [
        "volume",
        "L",
        "I",
        "S",
        "I/L",
        "S/I",
        "sphericity",
        "spheres",
        "share",
    ];
    let line = |name: &str, cells: &[String]| {
        let cells = cells.iter().map(|cell| format!(" {cell:>10}"));
        format!("{name:<width$}") + &cells.collect::<String>()
    };
    let mut lines =
        vec![line("mesh", &heads.map(str::to_owned)) + &format!("   ({unit}, {unit}3)")];
    for row in rows {
        let Some(shape) = &row.shape else {
            lines.push(line(&row.mesh, &[]) + " no body: see the reason");
            continue;
        };
        let [volume, _, _, l, i, s, elongation, flatness, sphericity] = shape.numbers();
        let mut cells: Vec<String> = [volume, l, i, s]
            .map(|value| significant(value, 4))
            .to_vec();
        cells.extend([elongation, flatness, sphericity].map(|value| format!("{value:.3}")));
        cells.push(row.spheres.map_or("-".to_owned(), |n| n.to_string()));
        cells.push(
            row.volume_share
                .map_or("-".to_owned(), |share| format!("{share:.4}")),
        );
        lines.push(line(&row.mesh, &cells));
    }
    lines.join("\n")
}
