//! Reading a table of spheres.

use anyhow::Context as _;
use clump::Sphere;
use nalgebra::Vector3;
use std::path::Path;
use trimesh::LengthUnit;

/// Reads lines `x,y,z,radius` (commas or blanks between) in a unit; a first line of words and
/// lines that begin with `#` are passed over.
///
/// # Errors
///
/// A file that cannot be read, a line without four finite numbers, a radius that is not positive.
pub(crate) fn read_spheres(file: &Path, unit: LengthUnit) -> anyhow::Result<Vec<Sphere>> {
    let text =
        input_file::read_text(file).with_context(|| format!("cannot read {}", file.display()))?;
    let mut spheres = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        let is_head = index == 0 && line.starts_with(|c: char| c.is_ascii_alphabetic());
        if line.is_empty() || line.starts_with('#') || is_head {
            continue;
        }
        let sphere = sphere_of(line, unit).with_context(|| {
            format!(
                "{}, line {}: expected x,y,z,radius as finite numbers, radius above 0, found `{line}`",
                file.display(),
                index + 1
            )
        })?;
        spheres.push(sphere);
    }
    anyhow::ensure!(!spheres.is_empty(), "{} holds no sphere", file.display());
    Ok(spheres)
}

/// Reads one line.
fn sphere_of(line: &str, unit: LengthUnit) -> Option<Sphere> {
    let words = line.split(|c: char| c == ',' || c == ';' || c.is_whitespace());
    let mut numbers = words.filter(|word| !word.is_empty()).map(str::parse::<f64>);
    let mut next = || {
        numbers
            .next()?
            .ok()
            .map(|v| v * unit.in_metres())
            .filter(|v| v.is_finite())
    };
    let centre = Vector3::new(next()?, next()?, next()?);
    let radius = next().filter(|radius| *radius > 0.0)?;
    Some(Sphere { centre, radius })
}
