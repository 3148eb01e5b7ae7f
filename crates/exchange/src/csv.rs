//! Frames as tables, for a fluid solver or any other program: one CSV file a frame.
//!
//! Each row is a sphere of a seed, hidden ones included; `volume_m3` is its share of the volume of the seed
//! ([`crate::fractions`]), so that the volumes of a seed add up to what it takes from a fluid.

use crate::fractions::fractions;
use crate::vtk::{File, add};
use scene::{Frame, Scene, SeedBody};
use std::sync::Arc;

/// The columns.
const HEADER: &str =
    "time_s,body,kind,material,x_m,y_m,z_m,radius_m,volume_m3,vx_m_s,vy_m_s,vz_m_s\n";

/// The files of a series: `NAME_0000.csv` and so on.
pub fn series(name: &str, scene: &Scene, frames: &[Frame], bodies: &[Arc<SeedBody>]) -> Vec<File> {
    let numbered = frames.iter().enumerate();
    numbered
        .map(|(k, frame)| File {
            name: format!("{name}_{k:04}.csv"),
            text: rows(scene, frame, bodies),
        })
        .collect()
}

/// One frame.
fn rows(scene: &Scene, frame: &Frame, bodies: &[Arc<SeedBody>]) -> String {
    let mut text = HEADER.to_owned();
    for fraction in fractions(frame, bodies) {
        let seed = &scene.seed[fraction.kind];
        let (c, v) = (fraction.sphere.centre, fraction.velocity);
        add(
            &mut text,
            format_args!(
                "{},{},{},{},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e}\n",
                frame.time,
                fraction.body,
                quoted(&seed.name),
                quoted(&seed.material),
                c.x,
                c.y,
                c.z,
                fraction.sphere.radius,
                fraction.volume,
                v.x,
                v.y,
                v.z
            ),
        );
    }
    text
}

/// A cell that may hold a comma or a quotation mark.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}
