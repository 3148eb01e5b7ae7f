//! The table of the seeds as bodies.

use super::csv::{CsvTable, Field};
use crate::pictures::photographs::filled_seeds;
use crate::{Error, ReportInput};
use scene::FilledShape;

/// How well the spheres stand for the seeds.
pub(super) fn seeds(input: &ReportInput<'_>) -> Result<CsvTable, Error> {
    let columns = [
        "seed",
        "models",
        "n_spheres",
        "n_outer_spheres",
        "mass_mg",
        "fraction_density_kg_m3",
        "volume_mm3",
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
        let body = &seed.body;
        let of_fit = |value: &dyn Fn(&FilledShape) -> f64| {
            let shape = body.shape.as_ref();
            Field::from(shape.map(value))
        };
        let mm = |value: &dyn Fn(&FilledShape) -> f64| of_fit(&|s| 1e3 * value(s));
        let error = |k: usize| of_fit(&|s| s.report.inertia_error_percent[k]);
        table.row([
            (&seed.name).into(),
            (&seed.models.join(" ")).into(),
            body.spheres.len().into(),
            body.outer.spheres().len().into(),
            (body.clump.mass() * 1e6).into(),
            body.fraction_density.into(),
            (body.volume * 1e9).into(),
            of_fit(&|s| s.report.packing_fraction),
            of_fit(&|s| s.report.union_fraction),
            mm(&|s| s.report.max_protrusion),
            mm(&|s| s.report.max_overlap),
            mm(&|s| s.report.surface_rms),
            mm(&|s| s.report.surface_hausdorff),
            mm(&|s| s.report.roughness_rms),
            mm(&|s| s.report.mean_gap),
            mm(&|s| s.report.centroid_offset),
            error(0),
            error(1),
            error(2),
        ]);
    }
    Ok(table)
}
