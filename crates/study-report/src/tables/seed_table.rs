//! The table of the seeds as bodies.

use super::csv::{CsvTable, Field};
use crate::pictures::photographs::filled_seeds;
use crate::{Error, ReportInput};

/// How well the spheres stand for the seeds.
pub(super) fn seeds(input: &ReportInput<'_>) -> Result<CsvTable, Error> {
    let columns = [
        "seed",
        "models",
        "n_spheres",
        "n_outer_spheres",
        "mass_mg",
        "fraction_density_kg_m3",
        "mesh_volume_mm3",
        "packing_fraction_1",
        "union_fraction_1",
        "max_protrusion_mm",
        "max_overlap_mm",
        "surface_rms_mm",
        "surface_hausdorff_mm",
        "roughness_rms_mm",
        "mean_gap_mm",
        "centroid_offset_mm",
        "inertia_1_error_percent",
        "inertia_2_error_percent",
        "inertia_3_error_percent",
    ];
    let mut table = CsvTable::new("seeds", columns);
    for seed in filled_seeds(input)? {
        let (body, fit) = (&seed.body, &seed.body.report);
        let mm = |length: f64| Field::from(length * 1e3);
        let [first, second, third] = fit.inertia_error_percent.map(Field::from);
        table.row([
            (&seed.name).into(),
            (&seed.models.join(" ")).into(),
            body.spheres.len().into(),
            body.outer.spheres().len().into(),
            (body.clump.mass() * 1e6).into(),
            body.fraction_density.into(),
            (body.mesh.mesh.moments().volume * 1e9).into(),
            fit.packing_fraction.into(),
            fit.union_fraction.into(),
            mm(fit.max_protrusion),
            mm(fit.max_overlap),
            mm(fit.surface_rms),
            mm(fit.surface_hausdorff),
            mm(fit.roughness_rms),
            mm(fit.mean_gap),
            mm(fit.centroid_offset),
            first,
            second,
            third,
        ]);
    }
    Ok(table)
}
