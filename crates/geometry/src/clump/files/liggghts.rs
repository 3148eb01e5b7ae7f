//! LIGGGHTS multisphere template: `x y z r` a line, in metres, and comments.

use super::Body;
use super::rows::{in_unit, joined};

/// The comments hold the command that reads the file; mass and inertia are arguments of that
/// command, not part of the file. Without them LIGGGHTS integrates the union of the spheres.
pub(crate) fn text(body: &Body<'_>) -> String {
    let n = body.spheres.len();
    let mut text = format!(
        "# x y z radius, m\n\
         # fix {} all particletemplate/multisphere 15485863 atom_type 1 density constant DENSITY \
         nspheres {n} ntry 1000000 spheres file FILE scale 1.0 type 1",
        body.word()
    );
    if let Some(mass) = body.mass {
        let [xx, yy, zz, xy, xz, yz] = body.inertia_components(mass / body.volume);
        let order = joined(&[xx, xy, xz, yy, yz, zz], " ");
        let mass = joined(&[mass], "");
        text.extend([format!(" mass {mass} inertia_tensor {order} use_volume")]);
    }
    text.push('\n');
    for sphere in body.spheres {
        text.extend([joined(&in_unit(sphere, 1.0), " "), "\n".to_owned()]);
    }
    text
}
