//! EDEM: the table of spheres of a multi-sphere particle, to be pasted or imported.

use crate::Body;
use crate::rows::joined;
use clump::{Clump, MassProperties};
use nalgebra::Vector3;

/// Columns as in EDEM's table: name, physical radius, contact radius, position x, y, z; in
/// metres.
///
/// EDEM wants the centre of mass at the origin and the principal axes along x, y, z. The spheres
/// are moved there; where the body has no inertia to turn by, they are moved only.
pub(crate) fn text(body: &Body<'_>) -> String {
    let properties = MassProperties {
        mass: body.volume,
        centre: body.centroid,
        inertia: body.inertia,
    };
    let turned = Clump::new(body.spheres, &properties);
    let mut text =
        "Name,Physical Radius,Contact Radius,Position X,Position Y,Position Z\n".to_owned();
    let mut row = |index: usize, centre: Vector3<f64>, radius: f64| {
        let numbers = joined(&[radius, radius, centre.x, centre.y, centre.z], ",");
        text.extend([format!("sphere {index},{numbers}\n")]);
    };
    let spheres = turned.as_ref().map_or(body.spheres, Clump::spheres);
    let shift = if turned.is_ok() {
        Vector3::zeros()
    } else {
        body.centroid
    };
    for (index, sphere) in spheres.iter().enumerate() {
        row(index, sphere.centre - shift, sphere.radius);
    }
    text
}
