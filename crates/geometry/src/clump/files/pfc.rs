//! PFC3D: a command file that makes a clump template.

use super::Body;
use super::rows::joined;

/// `clump template create` with the pebbles (radius x y z), and volume and inertia at unit
/// density, as PFC requires. Positions are relative to the centroid; a line ends with `...` if
/// the command continues.
pub(crate) fn text(body: &Body<'_>) -> String {
    let n = body.spheres.len();
    let mut text = format!(
        "; clump template of {n} pebbles, m; volume and inertia at unit density\n\
         clump template create name '{}' ...\n  pebbles {n} ...\n",
        body.word()
    );
    for sphere in body.spheres {
        let c = sphere.centre - body.centroid;
        let numbers = joined(&[sphere.radius, c.x, c.y, c.z], " ");
        text.extend([format!("    {numbers} ...\n")]);
    }
    let inertia = joined(&body.inertia_components(1.0), " ");
    text.extend([
        format!("  volume {} ...\n", joined(&[body.volume], "")),
        "  position 0 0 0 ...\n".to_owned(),
        format!("  inertia {inertia}\n"),
    ]);
    text
}
