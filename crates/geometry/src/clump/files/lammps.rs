//! LAMMPS molecule file, SI units (`units si`, `atom_style sphere`).

use super::Body;
use super::principal::in_principal_frame;
use super::rows::joined;

/// Sections Coords, Types, Diameters; with a known mass also mass, centre of mass, inertia (for
/// `fix rigid/small ... mol`), and Masses: the mass shared in proportion to sphere volume.
///
/// The body lies in its principal frame: LAMMPS (22 Jul 2025) takes the three products of inertia
/// in the order yz, xz, xy where its manual says xy, xz, yz; here all three are 0. `create_atoms` takes neither mass nor inertia
/// from the file, and the body then has the inertia of its separate spheres; the first line says so.
pub(crate) fn text(body: &Body<'_>) -> String {
    let n = body.spheres.len();
    let how = match body.mass {
        Some(_) => {
            "; insert it by fix deposit or fix pour (create_atoms leaves out mass and inertia)"
        }
        None => "",
    };
    let mut text = format!(
        "# {} of {n} spheres, SI units{how}\n\n{n} atoms\n",
        body.word()
    );
    let (spheres, moments) = in_principal_frame(body);
    if let Some(mass) = body.mass {
        let [xx, yy, zz]: [f64; 3] = (moments * (mass / body.volume)).into();
        let numbers = joined(&[xx, yy, zz, 0.0, 0.0, 0.0], " ");
        text.extend([
            format!("{} mass\n0 0 0 com\n", joined(&[mass], "")),
            format!("{numbers} inertia\n"),
        ]);
    }
    let mut section = |name: &str, line: &dyn Fn(usize) -> String| {
        text.extend([format!("\n{name}\n\n")]);
        for i in 0..n {
            text.extend([format!("{} {}\n", i + 1, line(i))]);
        }
    };
    section("Coords", &|i| {
        let c = spheres[i].centre;
        joined(&[c.x, c.y, c.z], " ")
    });
    section("Types", &|_| "1".to_owned());
    section("Diameters", &|i| joined(&[2.0 * spheres[i].radius], ""));
    if let Some(mass) = body.mass {
        let cubes = |i: usize| spheres[i].radius.powi(3);
        let total: f64 = (0..n).map(cubes).sum();
        section("Masses", &|i| joined(&[mass * cubes(i) / total], ""));
    }
    text
}
