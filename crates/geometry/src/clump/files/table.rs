//! Reading a table of spheres.

use crate::clump::Sphere;
use nalgebra::Vector3;

/// Beginnings of the column names, if the first line has them.
const COLUMNS: [char; 4] = ['x', 'y', 'z', 'r'];

/// Errors in a table of spheres.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The first line names other columns, or in another order.
    #[error(
        "{file}, line {line}: the columns must be x, y, z and radius in this order, found `{text}`"
    )]
    Columns {
        /// The file.
        file: String,
        /// Number of the line, from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// A line is not a sphere.
    #[error(
        "{file}, line {line}: expected x,y,z,radius as four finite numbers, radius above 0, found `{text}`; between \
         semicolons a comma is a decimal one"
    )]
    Row {
        /// The file.
        file: String,
        /// Number of the line, from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// There is no sphere.
    #[error("{file} holds no sphere")]
    Empty {
        /// The file.
        file: String,
    },
}

/// Reads lines `x,y,z,radius` in a unit given in metres, separated by commas, blanks or semicolons; with semicolons a comma is
/// a decimal one. Column names before the first sphere and lines that begin with `#` are skipped; messages name `file`.
///
/// # Errors
///
/// Columns in another order, a line without exactly four finite numbers, a radius that is not positive, no sphere.
pub fn read_spheres(text: &str, file: &str, metres: f64) -> Result<Vec<Sphere>, TableError> {
    let (mut spheres, mut named) = (Vec::new(), false);
    // Spreadsheets mark the encoding at the start.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (index, row) in text.lines().enumerate() {
        let row = row.trim();
        if row.is_empty() || row.starts_with('#') {
            continue;
        }
        let fields = fields(row);
        let (file, line, text) = (file.to_owned(), index + 1, row.to_owned());
        if !named && spheres.is_empty() && row.starts_with(|c: char| c.is_ascii_alphabetic()) {
            if !names_columns(&fields) {
                return Err(TableError::Columns { file, line, text });
            }
            named = true;
            continue;
        }
        let Some(sphere) = sphere_of(&fields, metres) else {
            return Err(TableError::Row { file, line, text });
        };
        spheres.push(sphere);
    }
    if spheres.is_empty() {
        let file = file.to_owned();
        return Err(TableError::Empty { file });
    }
    Ok(spheres)
}

/// The fields of a line, with decimal points.
fn fields(line: &str) -> Vec<String> {
    let trimmed = |word: &str| word.trim().to_owned();
    if line.contains(';') {
        let words = line.split(';');
        return words.map(|word| trimmed(word).replace(',', ".")).collect();
    }
    if line.contains(',') {
        return line.split(',').map(trimmed).collect();
    }
    line.split_whitespace().map(str::to_owned).collect()
}

/// Whether a line names the columns in their order, as `x`, `X (mm)` or `radius_mm`.
fn names_columns(fields: &[String]) -> bool {
    let mut columns = fields.iter().zip(COLUMNS);
    fields.len() == COLUMNS.len()
        && columns.all(|(field, letter)| field.to_lowercase().starts_with(letter))
}

/// Reads one line.
fn sphere_of(fields: &[String], metres: f64) -> Option<Sphere> {
    let numbers = fields.iter().map(|field| {
        let number: f64 = field.parse().ok()?;
        Some(number * metres).filter(|x| x.is_finite())
    });
    let numbers: Option<Vec<f64>> = numbers.collect();
    let [x, y, z, radius] = numbers?.try_into().ok()?;
    let centre = Vector3::new(x, y, z);
    (radius > 0.0).then_some(Sphere { centre, radius })
}

#[cfg(test)]
mod tests {
    use super::{TableError, read_spheres};

    /// The same two spheres as other programs and spreadsheets write them.
    #[test]
    fn tables_are_read_as_people_write_them() {
        for text in [
            "x,y,z,radius\n0,0,0.5,2.25\n0,0,-1.5,1\n",
            "\u{feff}x,y,z,r\r\n0,0,0.5,2.25\r\n0,0,-1.5,1\r\n",
            "X (mm);Y (mm);Z (mm);R (mm)\n0;0;0,5;2,25\n0;0;-1,5;1\n",
            "# x y z r\n0 0 0.5 2.25\n\n0 0 -1.5 1",
            "# from a scan\n\nx,y,z,r\n0,0,0.5,2.25\n0,0,-1.5,1\n",
        ] {
            let spheres = read_spheres(text, "seed.csv", 1e-3).unwrap();
            assert_eq!(spheres.len(), 2, "{text}");
            // A number times the unit, rounded once.
            assert_eq!(spheres[0].radius, 2.25 * 1e-3, "{text}");
            assert_eq!(spheres[1].centre.z, -1.5 * 1e-3, "{text}");
        }
    }

    #[test]
    fn what_is_no_sphere_is_reported_with_file_line_and_text() {
        let told = |text: &str| read_spheres(text, "seed.csv", 1.0).unwrap_err();
        let row = |line: usize, text: &str| TableError::Row {
            file: "seed.csv".into(),
            line,
            text: text.into(),
        };
        assert_eq!(told("x,y,z,r\n0,0,0,1\n0,0,1,-1\n"), row(3, "0,0,1,-1"));
        assert_eq!(told("0,0,0,1\n0,0,nan,1\n"), row(2, "0,0,nan,1"));
        assert_eq!(told("0,0,0\n"), row(1, "0,0,0"));
        assert!(matches!(
            told("r,x,y,z\n1,0,0,0\n"),
            TableError::Columns { line: 1, .. }
        ));
        assert!(matches!(told("x,y,z,r\n"), TableError::Empty { .. }));
    }
}
