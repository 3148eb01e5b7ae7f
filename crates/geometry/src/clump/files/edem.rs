//! EDEM: the table of spheres of a multi-sphere particle, to be pasted or imported.

use super::Body;
use super::principal::in_principal_frame;
use super::rows::joined;

/// Columns as in EDEM's table: name, physical radius, contact radius, position x, y, z; in metres.
///
/// EDEM wants the centre of mass at the origin and the principal axes along x, y, z.
pub(crate) fn text(body: &Body<'_>) -> String {
    let mut text =
        "Name,Physical Radius,Contact Radius,Position X,Position Y,Position Z\n".to_owned();
    for (index, sphere) in in_principal_frame(body).0.iter().enumerate() {
        let (c, r) = (sphere.centre, sphere.radius);
        let numbers = joined(&[r, r, c.x, c.y, c.z], ",");
        text.extend([format!("sphere {index},{numbers}\n")]);
    }
    text
}
