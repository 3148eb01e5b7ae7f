//! Files of spheres for other programs.

use geometry::clump::files::{Body, Format, write};
use sphere_fill::Filling;
use std::path::Path;
use trimesh::LengthUnit;

/// Format that was asked for, or that belongs to the extension of a file.
///
/// # Errors
///
/// An extension that names none.
pub(crate) fn choose_format(asked: Option<Format>, file: &Path) -> anyhow::Result<Format> {
    let extension = file
        .extension()
        .map(|end| end.to_string_lossy().to_lowercase());
    let named = extension.as_deref().and_then(Format::of_extension);
    asked.or(named).ok_or_else(|| {
        anyhow::anyhow!(
            "the name {} does not tell the format: say --format; supported are {}",
            file.display(),
            Format::ALL.map(Format::name).join(", ")
        )
    })
}

/// Reads the name of a format.
pub(crate) fn format_named(name: &str) -> Result<Format, String> {
    let mut all = Format::ALL.into_iter();
    all.find(|format| format.name() == name)
        .ok_or_else(|| format!("supported are {}", Format::ALL.map(Format::name).join(", ")))
}

/// Writes a filling as text of a format.
pub(crate) fn sphere_text(
    format: Format,
    filling: &Filling,
    name: &str,
    unit: LengthUnit,
    mass: Option<f64>,
) -> String {
    let moments = &filling.mesh_moments;
    let body = Body {
        spheres: &filling.spheres,
        name,
        unit: (unit.symbol(), unit.in_metres()),
        volume: moments.volume,
        centroid: moments.centroid,
        inertia: moments.inertia,
        mass,
    };
    write(format, &body)
}
