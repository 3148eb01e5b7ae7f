//! One line per sphere: the plain table, and functions that other formats share.

use super::Body;
use crate::clump::Sphere;

/// Centre and radius in a unit of some metres.
pub(crate) fn in_unit(sphere: &Sphere, metres: f64) -> [f64; 4] {
    let c = sphere.centre;
    [c.x, c.y, c.z, sphere.radius].map(|length| length / metres)
}

/// Numbers with a sign between them, shortest form that reads back the same.
pub(crate) fn joined(numbers: &[f64], between: &str) -> String {
    let words: Vec<String> = numbers.iter().map(|&number| shortest(number)).collect();
    words.join(between)
}

/// A number as its shortest text; small and large ones with an exponent.
fn shortest(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-5..1e15).contains(&size) {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// Header x,y,z,radius, then the spheres in the unit of the mesh.
pub(crate) fn csv(body: &Body<'_>) -> String {
    let line = |sphere: &Sphere| joined(&in_unit(sphere, body.unit.1), ",") + "\n";
    let lines = body.spheres.iter().map(line);
    "x,y,z,radius\n".to_owned() + &lines.collect::<String>()
}
