//! Reading a table of spheres.

use anyhow::{Context as _, ensure};
use clump::Sphere;
use nalgebra::Vector3;
use std::path::Path;
use trimesh::LengthUnit;

/// How the names of the columns begin, where the first line names them.
const COLUMNS: [char; 4] = ['x', 'y', 'z', 'r'];

/// Reads lines `x,y,z,radius` in a unit: commas or blanks between, or semicolons, between which a comma is a decimal one. A
/// first line of names and lines that begin with `#` are passed over.
///
/// # Errors
///
/// A file that cannot be read, columns named in another order, a line without just four finite numbers, a radius that is not
/// positive.
pub(crate) fn read_spheres(file: &Path, unit: LengthUnit) -> anyhow::Result<Vec<Sphere>> {
    let text =
        input_file::read_text(file).with_context(|| format!("cannot read {}", file.display()))?;
    let mut spheres = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields = fields(line);
        let place = format!("{}, line {}", file.display(), index + 1);
        let is_head = index == 0 && line.starts_with(|c: char| c.is_ascii_alphabetic());
        if is_head {
            ensure!(
                is_head_of_columns(&fields),
                "{place}: the columns must be x, y, z and radius in this order, found `{line}`"
            );
            continue;
        }
        let sphere = sphere_of(&fields, unit).with_context(|| {
            format!(
                "{place}: expected x,y,z,radius as four finite numbers, radius above 0, found `{line}`; between \
                 semicolons a comma is a decimal one"
            )
        })?;
        spheres.push(sphere);
    }
    ensure!(!spheres.is_empty(), "{} holds no sphere", file.display());
    Ok(spheres)
}

/// The fields of a line, with decimal points.
fn fields(line: &str) -> Vec<String> {
    let trimmed = |word: &str| word.trim().to_owned();
    if line.contains(';') {
        let words = line.split(';');
        return words.map(|word| trimmed(word).replace(',', ".")).collect();
    }
    if line.contains(',') {
        return line.split(',').map(trimmed).collect();
    }
    line.split_whitespace().map(str::to_owned).collect()
}

/// Whether a line names the columns in their order, as `x`, `X (mm)` or `radius_mm`.
fn is_head_of_columns(fields: &[String]) -> bool {
    let mut columns = fields.iter().zip(COLUMNS);
    fields.len() == COLUMNS.len()
        && columns.all(|(field, letter)| field.to_lowercase().starts_with(letter))
}

/// Reads one line.
fn sphere_of(fields: &[String], unit: LengthUnit) -> Option<Sphere> {
    let numbers = fields.iter().map(|field| {
        let number: f64 = field.parse().ok()?;
        Some(number * unit.in_metres()).filter(|x| x.is_finite())
    });
    let numbers: Option<Vec<f64>> = numbers.collect();
    let [x, y, z, radius] = numbers?.try_into().ok()?;
    let centre = Vector3::new(x, y, z);
    (radius > 0.0).then_some(Sphere { centre, radius })
}
