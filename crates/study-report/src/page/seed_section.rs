//! The seeds as bodies.

use super::Page;
use crate::Error;
use crate::numbers::{fixed, listed};
use crate::pictures::photographs::{FilledSeed, SPHERE_COLOUR, filled_seeds, seed_pictures};
use report::{Column, SphereViewer, Table, ViewerBody, ViewerKind, ViewerSphere, counted};
use scene::FilledShape;

/// Adds the section; nothing without seeds.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let seeds = filled_seeds(page.input)?;
    if seeds.is_empty() {
        return Ok(());
    }
    page.report.section("Seeds as bodies of spheres").paragraph(
        "Each seed is one rigid body of spheres that fill its shape. Its mass is that of the seed, its moments of \
         inertia are those of the shape.",
    );
    table(page, &seeds)?;
    for seed in &seeds {
        pictures(page, seed)?;
    }
    Ok(())
}

/// A seed under its mesh, and its spheres alone.
fn pictures(page: &mut Page<'_>, seed: &FilledSeed) -> Result<(), Error> {
    let spheres = counted(seed.body.spheres.len(), "sphere", "spheres");
    let (under_mesh, picture) = seed_pictures(seed)?;
    if let Some(under_mesh) = under_mesh {
        page.report.picture(
            &under_mesh,
            &format!(
                "Spheres of seed {} under its half transparent mesh",
                seed.name
            ),
            &format!(
                "Seed {}: {spheres} under the mesh (half transparent).",
                seed.name
            ),
        )?;
    }
    let spheres = seed.body.spheres.iter().map(|s| ViewerSphere {
        centre: s.centre.into(),
        radius: s.radius,
    });
    let kind = ViewerKind {
        spheres: spheres.collect(),
        colour: SPHERE_COLOUR,
    };
    let description = format!("Spheres of seed {}", seed.name);
    let viewer = SphereViewer {
        kinds: &[kind],
        bodies: &[ViewerBody::at_origin(0)],
        picture: &picture,
        description: &description,
    };
    let caption = format!(
        "Seed {}: the spheres alone; turn them with the mouse.",
        seed.name
    );
    page.report.viewer(&viewer, &caption)?;
    Ok(())
}

/// How well the spheres stand for the shape.
fn table(page: &mut Page<'_>, seeds: &[FilledSeed]) -> Result<(), Error> {
    let mut table = Table::new(
        "Seeds as bodies. The density is that which the spheres need for the mass of the seed; gaps are those between \
         the mesh and the union of the spheres, for the filling before a scale of the seed; a seed that is a table of spheres has \
         none.",
        vec![
            Column::text("seed"),
            Column::text("in"),
            Column::number("spheres (outer)"),
            Column::number("mass (mg)"),
            Column::number("density (kg/m³)"),
            Column::number("volume (mm³)"),
            Column::number("union / mesh"),
            Column::number("rms gap (mm)"),
            Column::number("roughness (mm)"),
            Column::number("inertia errors (%)"),
        ],
    )?;
    for seed in seeds {
        let body = &seed.body;
        let of_fit = |value: &dyn Fn(&FilledShape) -> String| {
            let shape = body.shape.as_ref();
            shape.map_or_else(|| "-".to_owned(), value)
        };
        let outer = body.outer.spheres().len();
        table.row([
            seed.name.clone(),
            listed(&seed.models),
            format!("{} ({outer})", body.spheres.len()),
            fixed(body.clump.mass() * 1e6, 1),
            fixed(body.fraction_density, 0),
            fixed(body.volume * 1e9, 2),
            of_fit(&|s| fixed(s.report.union_fraction, 3)),
            of_fit(&|s| fixed(s.report.surface_rms * 1e3, 3)),
            of_fit(&|s| fixed(s.report.roughness_rms * 1e3, 3)),
            of_fit(&|s| listed(&s.report.inertia_error_percent.map(|e| fixed(e, 1)))),
        ])?;
    }
    page.table(&table);
    Ok(())
}
