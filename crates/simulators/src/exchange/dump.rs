//! Moments of a bed from dumps of LAMMPS and LIGGGHTS.

use crate::exchange::Error;
use crate::exchange::moment::{BedSphere, Moment};
use crate::exchange::positions::Rows;

/// Names of the column that says to which seed a sphere belongs.
const BODY: [&str; 3] = ["mol", "id_multisphere", "body"];

/// Reads a dump of style `custom` that has the columns x, y, z and radius, with vx, vy and vz where velocities are wanted and mol
/// or `id_multisphere` where seeds are of several spheres; `file` is named in messages, and lines count from `first_line`.
///
/// # Errors
///
/// Text that is not a dump, a missing column, a cell that is not a number.
pub fn read(text: &str, file: &str, first_line: usize) -> Result<Vec<Moment>, Error> {
    read_by(&BODY, text, file, first_line)
}

/// The same, with the number of the seed in the first of some columns that the dump has.
pub(crate) fn read_by(
    body: &[&str],
    text: &str,
    file: &str,
    first_line: usize,
) -> Result<Vec<Moment>, Error> {
    let lines: Vec<&str> = text.lines().collect();
    if lines.is_empty() && first_line == 1 {
        return Err(Error::Positions {
            file: file.to_owned(),
            line: first_line,
            what: "the file is empty: the program ended while it wrote".to_owned(),
        });
    }
    let mut moments = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let wrong = |offset: usize, what: &str| Error::Positions {
            file: file.to_owned(),
            line: first_line + at + offset,
            what: what.to_owned(),
        };
        let item = |offset: usize| lines.get(at + offset).copied().unwrap_or("");
        let other = |what: &str| Error::OtherKind {
            file: file.to_owned(),
            what: what.to_owned(),
        };
        if at == 0 && !item(0).starts_with("ITEM: TIMESTEP") {
            return Err(other("it is not a dump, which begins with ITEM: TIMESTEP"));
        }
        if item(8).starts_with("ITEM: ENTRIES") {
            return Err(other(
                "it is a dump of contacts or other entries, not of spheres",
            ));
        }
        if !item(0).starts_with("ITEM: TIMESTEP") || !item(8).starts_with("ITEM: ATOMS") {
            return Err(wrong(0, "a moment of a dump must begin here"));
        }
        let whole = |offset: usize| {
            let number = item(offset).trim().parse::<u64>();
            number.map_err(|_| wrong(offset, "a whole number must stand here"))
        };
        let (step, count) = (whole(1)?, whole(3)?);
        let columns: Vec<&str> = item(8).split_whitespace().skip(2).collect();
        let rows = Rows {
            file,
            columns: &columns,
            header_line: first_line + at + 8,
        };
        let places = rows.places(["x", "y", "z"], "radius", ["vx", "vy", "vz"], body)?;
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        let mut spheres: Vec<BedSphere> = Vec::new();
        for k in 0..count {
            let cells: Vec<&str> = item(9 + k).split_whitespace().collect();
            spheres.push(rows.sphere(&places, &cells, first_line + at + 9 + k, k)?);
        }
        at += 9 + count;
        moments.push(Moment {
            step: Some(step),
            time: None,
            spheres,
        });
    }
    Ok(moments)
}

#[cfg(test)]
mod tests {
    use super::read;
    use nalgebra::Vector3;

    const DUMP: &str = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n\
        0 1\n0 1\n0 1\nITEM: ATOMS id mol x y z vx vy vz radius\n1 7 0.1 0.2 0 1 0 0 0.5\n2 9 0.3 -0.4 0 0 2 -1 0.25\n";

    #[test]
    fn moments_are_read_by_the_names_of_their_columns() {
        let moments = read(&DUMP.repeat(2), "bed.dump", 1).unwrap();
        assert_eq!(moments.len(), 2);
        let s = moments[1].spheres[1];
        let c = s.sphere.centre;
        assert_eq!(
            (moments[1].step, c.x, c.y, s.sphere.radius, s.body),
            (Some(100), 0.3, -0.4, 0.25, 9)
        );
        assert_eq!(s.velocity, Some(Vector3::new(0.0, 2.0, -1.0)));
        assert!((moments[1].height() + 0.1).abs() < 1e-15, "mean height");
    }

    /// Without the columns of velocity and seed a bed can be read all the same; each sphere is then its own seed.
    #[test]
    fn velocity_and_seed_may_be_missing() {
        let bare = DUMP.replace("mol x", "q x").replace("vx vy vz", "a b c");
        let moments = read(&bare, "bed.dump", 1).unwrap();
        let s = moments[0].spheres[1];
        assert_eq!((s.body, s.velocity), (1, None));
    }

    #[test]
    fn broken_dumps_are_refused_with_their_line() {
        let short = DUMP.replace("2 9 0.3 -0.4 0 0 2 -1 0.25\n", "");
        let message = read(&short, "bed.dump", 1).unwrap_err().to_string();
        assert!(message.contains("bed.dump: line 11"), "{message}");
        let message = read(&DUMP.replace("-0.4", "NaN"), "bed.dump", 100).unwrap_err();
        assert!(message.to_string().contains("line 110"), "{message}");
        let message = read(&DUMP.replace("radius", "mass"), "b", 1)
            .unwrap_err()
            .to_string();
        assert!(message.contains("'radius'"), "{message}");
    }
}
