//! Frames as tables, for a fluid solver or any other program: one CSV file a frame.
//!
//! Each row is a sphere of a seed, hidden ones included; `volume_m3` is its share of the volume of the seed
//! ([`crate::exchange::fractions`]), so that the volumes of a seed add up to what it takes from a fluid.

use crate::exchange::Error;
use crate::exchange::fractions::fractions;
use crate::exchange::moment::Moment;
use crate::exchange::positions::Rows;
use crate::exchange::vtk::File;
use ::csv::{ReaderBuilder, Trim, Writer};
use scene::{Frame, Scene, SeedBody};
use std::sync::Arc;

/// The columns.
const HEADER: [&str; 12] = [
    "time_s",
    "body",
    "kind",
    "material",
    "x_m",
    "y_m",
    "z_m",
    "radius_m",
    "volume_m3",
    "vx_m_s",
    "vy_m_s",
    "vz_m_s",
];

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

fn rows(scene: &Scene, frame: &Frame, bodies: &[Arc<SeedBody>]) -> String {
    let mut writer = Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    let _ = writer.write_record(HEADER);
    for fraction in fractions(frame, bodies) {
        let seed = &scene.seed[fraction.kind];
        let (c, v) = (fraction.sphere.centre, fraction.velocity);
        let _ = writer.write_record([
            frame.time.to_string(),
            fraction.body.to_string(),
            seed.name.clone(),
            seed.material.clone(),
            format!("{:e}", c.x),
            format!("{:e}", c.y),
            format!("{:e}", c.z),
            format!("{:e}", fraction.sphere.radius),
            format!("{:e}", fraction.volume),
            format!("{:e}", v.x),
            format!("{:e}", v.y),
            format!("{:e}", v.z),
        ]);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

/// Reads a table with the columns `x_m`, `y_m`, `z_m` and `radius_m`, with `vx_m_s`, `vy_m_s`, `vz_m_s`, `body` and `time_s` where it
/// has them; rows of one time are a moment, in the order of the file, and a table without rows is one without spheres.
///
/// # Errors
///
/// A table of other columns, a cell that is not a number.
pub fn read(text: &str, file: &str) -> Result<Vec<Moment>, Error> {
    let mut reader = ReaderBuilder::new()
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let refused = |line: usize, error: &::csv::Error| Error::Positions {
        file: file.to_owned(),
        line,
        what: error.to_string(),
    };
    let header = reader.headers().map_err(|e| refused(1, &e))?.clone();
    let columns: Vec<&str> = header.iter().collect();
    let rows = Rows {
        file,
        columns: &columns,
        header_line: 1,
    };
    let velocity = ["vx_m_s", "vy_m_s", "vz_m_s"];
    let places = rows.places(["x_m", "y_m", "z_m"], "radius_m", velocity, &["body"]);
    let places = places.map_err(|error| Error::OtherKind {
        file: file.to_owned(),
        what: match error {
            Error::Positions { what, .. } => what,
            other => other.to_string(),
        },
    })?;
    let at_time = columns.iter().position(|c| *c == "time_s");
    let mut moments: Vec<Moment> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| refused(line_of(e.position()), &e))?;
        if record.iter().all(str::is_empty) {
            continue;
        }
        let line = line_of(record.position());
        let cells: Vec<&str> = record.iter().collect();
        let time = at_time.map(|place| rows.number(&cells, place, line));
        let time = time.transpose()?;
        if moments.last().is_none_or(|last| last.time != time) {
            moments.push(Moment {
                time,
                ..Moment::default()
            });
        }
        if let Some(moment) = moments.last_mut() {
            let number = moment.spheres.len();
            let sphere = rows.sphere(&places, &cells, line, number)?;
            moment.spheres.push(sphere);
        }
    }
    if moments.is_empty() {
        moments.push(Moment::default());
    }
    Ok(moments)
}

/// The line in which a record begins, from 1.
fn line_of(position: Option<&::csv::Position>) -> usize {
    let line = position.map_or(1, ::csv::Position::line);
    usize::try_from(line).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::{HEADER, ReaderBuilder, read, series};
    use crate::exchange::fractions::fractions;
    use dev_support::fixture_files::fixture;
    use scene::{FillingLibrary, Override, Scene, starting_frame};

    /// What is written is read again to the last bit, in its columns, with a name that holds a comma and quotes: two moments of
    /// the study's drum with six seeds.
    #[test]
    fn frames_are_read_back_as_they_are() {
        let file = fixture("cotton/drum.toml");
        let few = ["seed.0.count", "seed.1.count"].map(|name| Override {
            name: name.into(),
            value: "3".into(),
        });
        let mut scene = Scene::read(&file, &few).unwrap();
        let (first, bodies, _) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        scene.seed[1].name = "flat, \"coated\"".into();
        let mut second = first.clone();
        second.time += 0.25;
        second.spin[4] = nalgebra::Vector3::new(3.0, -1.0, 2.0);
        let frames = [first, second];
        let files = series("bed", &scene, &frames, &bodies);
        let (_, later) = files[1].text.split_once('\n').unwrap();
        let both = read(&[&files[0].text, later].concat(), "both.csv").unwrap();
        let times: Vec<_> = both.iter().map(|moment| moment.time).collect();
        assert_eq!(times, frames.each_ref().map(|frame| Some(frame.time)));
        for (written, frame) in files.iter().zip(&frames) {
            let moments = read(&written.text, &written.name).unwrap();
            let expected = fractions(frame, &bodies);
            assert_eq!((moments.len(), moments[0].time), (1, Some(frame.time)));
            assert_eq!(moments[0].spheres.len(), expected.len());
            let mut reader = ReaderBuilder::new().from_reader(written.text.as_bytes());
            let rows = moments[0].spheres.iter().zip(reader.records());
            for ((sphere, row), wanted) in rows.zip(&expected) {
                assert_eq!(sphere.body, wanted.body);
                assert_eq!(sphere.sphere, wanted.sphere);
                assert_eq!(sphere.velocity, Some(wanted.velocity));
                let row = row.unwrap();
                let seed = &scene.seed[wanted.kind];
                assert_eq!((&row[2], &row[3]), (&*seed.name, &*seed.material));
                assert_eq!(row[8].parse(), Ok(wanted.volume));
            }
        }
    }

    #[test]
    fn what_is_no_table_of_spheres_is_refused_with_its_line() {
        let row = "0.5,3,oval,\"seed, coated\",0.1,0.2,0.3,1e-3,1e-9,1,2,3\n";
        let header = HEADER.join(",") + "\n";
        let refusal = |text: &str| read(text, "bed.csv").unwrap_err().to_string();
        let short = [&header, row, &row.replace(",1e-9,1,2,3", ""), row].concat();
        let told = refusal(&short);
        assert!(
            told.contains("bed.csv: line 3") && told.contains("vx_m_s"),
            "{told}"
        );
        // A quote that stays open takes the rest of the file into its cell.
        let told = refusal("x_m,y_m,z_m,radius_m\n1,2,3,1\n1,2,\"3,1\n1,2,3,1\n");
        assert!(
            told.contains("bed.csv: line 3: the row ends before radius_m"),
            "{told}"
        );
        let told = refusal("x_m,y_m\n");
        assert!(told.contains("'z_m' is missing"), "{told}");
    }
}
