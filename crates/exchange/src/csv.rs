//! Frames as tables, for a fluid solver or any other program: one CSV file a frame.
//!
//! Each row is a sphere of a seed, hidden ones included; `volume_m3` is its share of the volume of the seed
//! ([`crate::fractions`]), so that the volumes of a seed add up to what it takes from a fluid.

use crate::Error;
use crate::fractions::fractions;
use crate::moment::Moment;
use crate::positions::Rows;
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

/// Reads a table with the columns `x_m`, `y_m`, `z_m` and `radius_m`, with `vx_m_s`, `vy_m_s`, `vz_m_s`, `body` and `time_s` where it
/// has them; rows of one time are a moment, in the order of the file. Cells in quotation marks may hold commas.
///
/// # Errors
///
/// A missing column, a cell that is no number, no row.
pub fn read(text: &str, file: &str) -> Result<Vec<Moment>, Error> {
    let mut lines = text.lines().enumerate();
    let header = lines.next().map_or("", |(_, line)| line);
    let columns: Vec<&str> = header.split(',').map(str::trim).collect();
    let rows = Rows {
        file,
        columns: &columns,
        header_line: 1,
    };
    let velocity = ["vx_m_s", "vy_m_s", "vz_m_s"];
    let places = rows.places(["x_m", "y_m", "z_m"], "radius_m", velocity, &["body"])?;
    let at_time = columns.iter().position(|c| *c == "time_s");
    let mut moments: Vec<Moment> = Vec::new();
    for (k, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let cells = cells_of(line);
        let time = at_time.map(|place| rows.number(&cells, place, k + 1));
        let time = time.transpose()?;
        if moments.last().is_none_or(|last| last.time != time) {
            moments.push(Moment {
                time,
                ..Moment::default()
            });
        }
        if let Some(moment) = moments.last_mut() {
            let number = moment.spheres.len();
            let sphere = rows.sphere(&places, &cells, k + 1, number)?;
            moment.spheres.push(sphere);
        }
    }
    if moments.is_empty() {
        return Err(rows.wrong(2, "the table has no rows".into()));
    }
    Ok(moments)
}

/// The cells of a line; commas inside quotation marks part nothing.
fn cells_of(line: &str) -> Vec<&str> {
    let mut quoted = false;
    line.split(|c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::{HEADER, read};

    /// Two moments, a material with a comma in its name, and a row that is too short.
    #[test]
    fn a_table_of_frames_is_read_back() {
        let row = |time: f64, body: usize| {
            format!("{time},{body},oval,\"seed, coated\",0.1,0.2,0.3,1e-3,1e-9,1,2,3\n")
        };
        let text = [HEADER.to_owned(), row(0.5, 3), row(0.5, 4), row(0.6, 3)].concat();
        let moments = read(&text, "bed.csv").unwrap();
        let sizes: Vec<_> = moments.iter().map(|m| (m.time, m.spheres.len())).collect();
        assert_eq!(sizes, [(Some(0.5), 2), (Some(0.6), 1)]);
        let s = moments[0].spheres[1];
        assert_eq!((s.body, s.sphere.radius), (4, 1e-3));
        assert_eq!(s.velocity.unwrap().z, 3.0);
        let error = read(&text.replace(",1e-9,1,2,3\n0.6", "\n0.6"), "bed.csv").unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("bed.csv: line 3") && message.contains("vx_m_s"),
            "{message}"
        );
        let error = read("x_m,y_m\n", "bed.csv").unwrap_err().to_string();
        assert!(error.contains("'z_m' is missing"), "{error}");
    }
}
