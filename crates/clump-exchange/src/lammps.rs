//! LAMMPS molecule file, SI units (`units si`, `atom_style sphere`).

use crate::Body;
use crate::rows::joined;

/// Sections Coords, Types, Diameters; with a known mass also mass, centre of mass, inertia (for
/// `fix rigid/small ... mol`), and Masses: the mass shared in proportion to sphere volume.
pub(crate) fn text(body: &Body<'_>) -> String {
    let n = body.spheres.len();
    let mut text = format!("# {} of {n} spheres, SI units\n\n{n} atoms\n", body.word());
    if let Some(mass) = body.mass {
        let centre: [f64; 3] = body.centroid.into();
        let inertia = body.inertia_components(mass / body.volume);
        text.extend([
            format!("{} mass\n", joined(&[mass], "")),
            format!("{} com\n", joined(&centre, " ")),
            format!("{} inertia\n", joined(&inertia, " ")),
        ]);
    }
    let mut section = |name: &str, line: &dyn Fn(usize) -> String| {
        text.extend([format!("\n{name}\n\n")]);
        for i in 0..n {
            text.extend([format!("{} {}\n", i + 1, line(i))]);
        }
    };
    section("Coords", &|i| {
        let c = body.spheres[i].centre;
        joined(&[c.x, c.y, c.z], " ")
    });
    section("Types", &|_| "1".to_owned());
    section("Diameters", &|i| {
        joined(&[2.0 * body.spheres[i].radius], "")
    });
    if let Some(mass) = body.mass {
        let cubes = |i: usize| body.spheres[i].radius.powi(3);
        let total: f64 = (0..n).map(cubes).sum();
        section("Masses", &|i| joined(&[mass * cubes(i) / total], ""));
    }
    text
}
