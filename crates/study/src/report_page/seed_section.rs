//! The seeds as bodies.

use super::Page;
use super::numbers::{fixed, listed};
use super::pictures::photographs::{SPHERE_COLOUR, seed_picture_name};
use super::pictures::png;
use crate::Error;
use report::{Column, SphereViewer, Table, ViewerSphere};

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    page.report.section("Seeds as bodies of spheres").paragraph(
        "Each mesh is filled with spheres that make one rigid body. Mass is that of the seed; \
         moments of inertia are those of the mesh.",
    );
    table(page)?;
    for seed in &page.material.seeds {
        let name = seed_picture_name(&seed.name);
        let n = seed.body.spheres.len();
        page.png(
            &name,
            &format!(
                "Spheres of seed {} under its half transparent mesh",
                seed.name
            ),
            &format!(
                "Seed {}: {n} spheres under the mesh (half transparent).",
                seed.name
            ),
        )?;
        let spheres: Vec<ViewerSphere> = seed
            .body
            .spheres
            .iter()
            .map(|s| ViewerSphere {
                centre: s.centre.into(),
                radius: s.radius,
            })
            .collect();
        if let Some(picture) = png(page.pictures, &format!("{name}-spheres")) {
            let description = format!("Spheres of seed {}", seed.name);
            let viewer = SphereViewer {
                spheres: &spheres,
                colour: SPHERE_COLOUR,
                picture,
                description: &description,
            };
            let caption = format!(
                "Seed {}: the spheres alone; turn them with the mouse.",
                seed.name
            );
            page.report.viewer(&viewer, &caption)?;
        }
    }
    Ok(())
}

/// How well the spheres stand for the mesh.
fn table(page: &mut Page<'_>) -> Result<(), Error> {
    let mut table = Table::new(
        "Fillings. Density of the spheres by eq. (9) of the study; gaps between the mesh and the \
         union of the spheres.",
        vec![
            Column::text("seed"),
            Column::number("spheres (outer)"),
            Column::number("mass (mg)"),
            Column::number("density (kg/m³)"),
            Column::number("mesh volume (mm³)"),
            Column::number("union / mesh"),
            Column::number("rms gap (mm)"),
            Column::number("roughness (mm)"),
            Column::number("inertia errors (%)"),
        ],
    )?;
    for f in &page.result.fillings {
        let errors = f.fit.inertia_error_percent.map(|e| fixed(e, 1));
        table.row([
            f.name.clone(),
            format!("{} ({})", f.spheres, f.outer_spheres),
            fixed(f.mass_kg * 1e6, 1),
            fixed(f.fraction_density_kg_m3, 0),
            fixed(f.mesh_volume_mm3, 2),
            fixed(f.fit.union_fraction, 3),
            fixed(f.fit.surface_rms * 1e3, 3),
            fixed(f.fit.roughness_rms * 1e3, 3),
            listed(&errors),
        ])?;
    }
    page.report.table(&table);
    Ok(())
}
