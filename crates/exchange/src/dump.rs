//! Dumps of LAMMPS, and the angle of the bed in them.

use crate::Error;
use surface_profile::{DensitySettings, Disc, DrumCircle, measure, profile_from_discs};

/// One moment of a dump: spheres as discs across the axis of the drum.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Number of the step.
    pub step: u64,
    /// Spheres, m.
    pub discs: Vec<Disc>,
}

/// Reads a dump of style `custom` that has the columns x, y and radius; `file` is named in messages.
///
/// # Errors
///
/// Text that is no dump, a missing column, a cell that is no number.
pub fn read(text: &str, file: &str) -> Result<Vec<Moment>, Error> {
    let wrong = |line: usize, what: &str| Error::Dump {
        file: file.to_owned(),
        line: line + 1,
        what: what.to_owned(),
    };
    let lines: Vec<&str> = text.lines().collect();
    let mut moments = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let item = |offset: usize| lines.get(at + offset).copied().unwrap_or("");
        if !item(0).starts_with("ITEM: TIMESTEP") || !item(8).starts_with("ITEM: ATOMS") {
            return Err(wrong(at, "a moment of a dump must begin here"));
        }
        let number = |line: &str, offset: usize| {
            line.trim()
                .parse::<u64>()
                .map_err(|_| wrong(at + offset, "a whole number must stand here"))
        };
        let (step, count) = (number(item(1), 1)?, number(item(3), 3)?);
        let columns: Vec<&str> = item(8).split_whitespace().skip(2).collect();
        let place = |name: &str| {
            let found = columns.iter().position(|c| *c == name);
            found.ok_or_else(|| wrong(at + 8, &format!("column '{name}' is missing")))
        };
        let (x, y, radius) = (place("x")?, place("y")?, place("radius")?);
        let mut discs = Vec::new();
        for k in 0..usize::try_from(count).unwrap_or(usize::MAX) {
            let row = at + 9 + k;
            let cells: Vec<&str> = lines
                .get(row)
                .map_or_else(Vec::new, |l| l.split_whitespace().collect());
            let cell = |place: usize| -> Result<f64, Error> {
                let value = cells.get(place).and_then(|c| c.parse().ok());
                let value = value.filter(|number: &f64| number.is_finite());
                value.ok_or_else(|| wrong(row, "a row of numbers must stand here"))
            };
            discs.push(Disc {
                x: cell(x)?,
                y: cell(y)?,
                radius: cell(radius)?,
            });
        }
        at += 9 + discs.len();
        moments.push(Moment { step, discs });
    }
    Ok(moments)
}

/// Angle of the bed in a drum of a radius (m) about the origin, rad: the definition `line`, from the
/// positions of the spheres. None where no surface can be measured.
pub fn angle(moment: &Moment, radius: f64) -> Option<f64> {
    let drum = DrumCircle {
        x: 0.0,
        y: 0.0,
        radius,
    };
    let points =
        profile_from_discs(&moment.discs, &drum, &DensitySettings::for_drum(&drum)).ok()?;
    measure(&points, &drum).ok().map(|a| a.line)
}

#[cfg(test)]
mod tests {
    use super::read;

    const DUMP: &str = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n\
        0 1\n0 1\n0 1\nITEM: ATOMS id x y z radius\n1 0.1 0.2 0 0.5\n2 0.3 -0.4 0 0.25\n";

    #[test]
    fn moments_are_read_by_the_names_of_their_columns() {
        let moments = read(&DUMP.repeat(2), "bed.dump").unwrap();
        assert_eq!(moments.len(), 2);
        let disc = moments[1].discs[1];
        assert_eq!(
            (moments[1].step, disc.x, disc.y, disc.radius),
            (100, 0.3, -0.4, 0.25)
        );
    }

    #[test]
    fn broken_dumps_are_refused_with_their_line() {
        let short = DUMP.replace("2 0.3 -0.4 0 0.25\n", "");
        let message = read(&short, "bed.dump").unwrap_err().to_string();
        assert!(message.contains("bed.dump: line 11"), "{message}");
        let message = read(&DUMP.replace("-0.4", "NaN"), "bed.dump").unwrap_err();
        assert!(message.to_string().contains("line 11"), "{message}");
        let message = read(&DUMP.replace("radius", "mass"), "b")
            .unwrap_err()
            .to_string();
        assert!(message.contains("'radius'"), "{message}");
    }
}
