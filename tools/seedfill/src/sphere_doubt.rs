//! Whether given spheres can be those of a mesh.

use crate::arguments::Arguments;
use command_line::significant;
use geometry::clump::Sphere;
use nalgebra::Vector3;
use trimesh::{BoundingBox, LengthUnit};

/// Why spheres (m) may not be those of a mesh: in another unit they would be about as large, or they lie beside it.
///
/// Another unit is named if it brings the ratio of the sizes ten times as near to 1, on the scale of its logarithm: to a factor of
/// 2 for metres instead of millimetres, of 1.26 for centimetres. Spheres that are few or small for other reasons raise no question.
pub(crate) fn doubt(
    spheres: &[Sphere],
    mesh: &BoundingBox,
    arguments: &Arguments,
) -> Option<String> {
    const NEARER: f64 = 10.0;
    let file = arguments.spheres.as_deref()?.display();
    let ends = spheres.iter().flat_map(|s| {
        let reach = Vector3::repeat(s.radius);
        [s.centre - reach, s.centre + reach]
    });
    let ends: Vec<Vector3<f64>> = ends.collect();
    let bounds = BoundingBox::of(ends.iter());
    let (own, whole) = (bounds.size().norm(), mesh.size().norm());
    let mesh_unit = arguments.unit;
    let read_in = arguments.spheres_unit.unwrap_or(mesh_unit);
    let misfit = |factor: f64| (own * factor / whole).ln().abs();
    let fitting = |from: LengthUnit, sense: i32| {
        let factor = |other: &LengthUnit| (other.in_metres() / from.in_metres()).powi(sense);
        LengthUnit::ALL
            .into_iter()
            .filter(|other| NEARER * misfit(factor(other)) < misfit(1.0))
            .min_by(|a, b| misfit(factor(a)).total_cmp(&misfit(factor(b))))
    };
    let of_spheres = fitting(read_in, 1).map(|unit| {
        format!("the numbers of {file} fit it if they are in {unit} (--spheres-unit {unit})")
    });
    let of_mesh = fitting(mesh_unit, -1).map(|unit| {
        format!(
            "those of the mesh fit if they are in {unit} (--unit {unit} --spheres-unit {read_in})"
        )
    });
    let ways: Vec<String> = of_spheres.into_iter().chain(of_mesh).collect();
    if !ways.is_empty() {
        return Some(format!(
            "the spheres extend over {} mm and the mesh over {} mm: {}",
            significant(1e3 * own, 3),
            significant(1e3 * whole, 3),
            ways.join(", or ")
        ));
    }
    (!bounds.meets(mesh)).then(|| {
        format!("the spheres lie beside the mesh: {file} must be in the frame of the mesh (--out FILE.csv writes it)")
    })
}
