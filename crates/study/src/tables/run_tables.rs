//! Tables of points and of fillings.

use super::csv::{CsvTable, Field};
use crate::{StudyFile, StudyResult, SweepPoint};
use calibration::PointResult;

/// How well the spheres stand for the seeds.
pub(super) fn fillings(result: &StudyResult) -> CsvTable {
    let mut table = CsvTable::new(
        "fillings",
        [
            "seed",
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
        ],
    );
    for f in &result.fillings {
        let mm = |length: f64| Field::from(length * 1e3);
        let [first, second, third] = f.fit.inertia_error_percent.map(Field::from);
        table.row([
            (&f.name).into(),
            f.spheres.into(),
            f.outer_spheres.into(),
            (f.mass_kg * 1e6).into(),
            f.fraction_density_kg_m3.into(),
            f.mesh_volume_mm3.into(),
            f.fit.packing_fraction.into(),
            f.fit.union_fraction.into(),
            mm(f.fit.max_protrusion),
            mm(f.fit.max_overlap),
            mm(f.fit.surface_rms),
            mm(f.fit.surface_hausdorff),
            mm(f.fit.roughness_rms),
            mm(f.fit.mean_gap),
            mm(f.fit.centroid_offset),
            first,
            second,
            third,
        ]);
    }
    table
}

/// Mean, sd, n, sd over frames, and keys of a point.
fn of_point(point: &PointResult) -> [Field; 5] {
    [
        point.mean.into(),
        point.sd.into(),
        point.n.into(),
        point.frame_sd.into(),
        (&point.keys.join(" ")).into(),
    ]
}

/// Single points: validation, published optimum, metering device.
pub(super) fn points(result: &StudyResult) -> CsvTable {
    let mut table = CsvTable::new(
        "points",
        [
            "point",
            "observable",
            "mean_deg",
            "sd_of_runs_deg",
            "n_runs",
            "sd_of_frames_deg",
            "run_keys",
            "compared_with_deg",
            "difference_percent",
        ],
    );
    let (validation, metering) = (&result.validation, &result.metering);
    let target = result.solutions.target;
    let optimum = &result.published_optimum;
    let rows = [
        (
            &validation.point,
            "repose angle",
            validation.target,
            validation.relative_error_percent,
        ),
        (
            optimum,
            "repose angle",
            target,
            100.0 * (optimum.mean - target).abs() / target.abs(),
        ),
        (
            &metering.result,
            "filling angle",
            metering.published_measured_deg[0],
            metering.difference_percent,
        ),
    ];
    for (point, observable, with, difference) in rows {
        let head = [Field::from(&point.label), observable.into()];
        table.row(
            head.into_iter()
                .chain(of_point(point))
                .chain([with.into(), difference.into()]),
        );
    }
    table
}

/// A sweep over a quantity.
fn over(name: &str, quantity: &str, points: &[SweepPoint]) -> CsvTable {
    let rest = [
        "angle_mean_deg",
        "angle_sd_of_runs_deg",
        "n_runs",
        "angle_sd_of_frames_deg",
        "run_keys",
        "regime",
        "shell_slip_1",
    ];
    let mut table = CsvTable::new(
        name,
        std::iter::once(quantity.to_owned()).chain(rest.map(String::from)),
    );
    for p in points {
        let tail = [Field::from(&p.regime), p.shell_slip.into()];
        table.row(
            std::iter::once(p.value.into())
                .chain(of_point(&p.result))
                .chain(tail),
        );
    }
    table
}

/// Angle against the swept parameter.
pub(super) fn sweep(study: &StudyFile, result: &StudyResult) -> CsvTable {
    over("sweep", &format!("{}_1", study.sweep.symbol), &result.sweep)
}

/// Angle at the bench measurements against the smoothness of the filling.
pub(super) fn smoothness(result: &StudyResult) -> CsvTable {
    over("smoothness", "smoothness_1", &result.smoothness)
}
