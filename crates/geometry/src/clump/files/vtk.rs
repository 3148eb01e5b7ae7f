//! Legacy VTK polydata: points, one vertex each, radius as point data.

use super::Body;
use super::rows::{in_unit, joined};

pub(crate) fn text(body: &Body<'_>) -> String {
    let n = body.spheres.len();
    let (unit, metres) = body.unit;
    let mut text = format!(
        "# vtk DataFile Version 3.0\nspheres of a seed, lengths in {unit}\nASCII\n\
         DATASET POLYDATA\nPOINTS {n} double\n"
    );
    let mut cells = format!("VERTICES {n} {}\n", 2 * n);
    let mut radii = format!("POINT_DATA {n}\nSCALARS radius double 1\nLOOKUP_TABLE default\n");
    for (i, sphere) in body.spheres.iter().enumerate() {
        let [x, y, z, r] = in_unit(sphere, metres);
        text.extend([joined(&[x, y, z], " "), "\n".to_owned()]);
        cells.extend([format!("1 {i}\n")]);
        radii.extend([joined(&[r], ""), "\n".to_owned()]);
    }
    text + &cells + &radii
}
