//! Files of sphere positions of any code: dumps of LAMMPS and LIGGGHTS, VTK, CSV.

use crate::exchange::moment::{BedSphere, Moment};
use crate::exchange::{Error, csv, dump, vtk_points};
use geometry::clump::Sphere;
use nalgebra::Vector3;
use std::path::Path;

/// Reads the moments of a file, by its ending: `.csv`, `.vtk` (legacy, ASCII), `.vtp` (XML, ASCII), and everything else
/// as a dump of LAMMPS or LIGGGHTS.
///
/// # Errors
///
/// A file that cannot be read, a missing column, a cell that is not a number; a file of another kind ([`Error::is_other_kind`]).
pub fn read_positions(path: &Path) -> Result<Vec<Moment>, Error> {
    let bytes = input::file::read(path).map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })?;
    let file = path.display().to_string();
    let text = String::from_utf8(bytes).map_err(|_| Error::OtherKind {
        file: file.clone(),
        what: "the file is not text: write it in ASCII form".into(),
    })?;
    let ending = path.extension().and_then(|e| e.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("csv") => csv::read(&text, &file),
        Some("vtk") => vtk_points::read_legacy(&text, &file).map(|moment| vec![moment]),
        Some("vtp") => vtk_points::read_xml(&text, &file).map(|moment| vec![moment]),
        _ => dump::read(&text, &file, 1),
    }
}

/// Where the values of a sphere stand in a row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places {
    centre: [usize; 3],
    radius: usize,
    velocity: Option<[usize; 3]>,
    /// Seed.
    body: Option<usize>,
}

/// Rows of numbers under named columns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows<'a> {
    /// The file, for messages.
    pub(crate) file: &'a str,
    /// Names of the columns.
    pub(crate) columns: &'a [&'a str],
    /// Line with the names, from 1.
    pub(crate) header_line: usize,
}

impl Rows<'_> {
    /// Finds the columns by their names; a velocity has all three components or none.
    pub(crate) fn places(
        &self,
        centre: [&str; 3],
        radius: &str,
        velocity: [&str; 3],
        body: &[&str],
    ) -> Result<Places, Error> {
        let find = |name: &str| self.columns.iter().position(|c| *c == name);
        let needed = |name: &str| {
            find(name).ok_or_else(|| {
                let what = format!(
                    "column '{name}' is missing; the columns are {}",
                    self.columns.join(", ")
                );
                self.wrong(self.header_line, what)
            })
        };
        let [x, y, z] = centre.map(needed);
        let velocity = match velocity.map(find) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        Ok(Places {
            centre: [x?, y?, z?],
            radius: needed(radius)?,
            velocity,
            body: body.iter().find_map(|name| find(name)),
        })
    }

    /// The sphere of a row; `number` is that of its seed if no column gives it.
    pub(crate) fn sphere(
        &self,
        places: &Places,
        cells: &[&str],
        line: usize,
        number: usize,
    ) -> Result<BedSphere, Error> {
        let cell = |place: usize| self.number(cells, place, line);
        let [x, y, z] = places.centre.map(cell);
        let radius = cell(places.radius)?;
        if radius <= 0.0 {
            return Err(self.wrong(line, format!("radius = {radius} must be above 0")));
        }
        let velocity = match places.velocity {
            Some(velocity) => {
                let [x, y, z] = velocity.map(cell);
                Some(Vector3::new(x?, y?, z?))
            }
            None => None,
        };
        let body = places.body.map(cell).transpose()?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of a seed; it chooses a colour and nothing else"
        )]
        let body = body.map_or(number, |b| b.max(0.0) as usize);
        Ok(BedSphere {
            body,
            sphere: Sphere {
                centre: Vector3::new(x?, y?, z?),
                radius,
            },
            velocity,
        })
    }

    /// A finite number of a row.
    pub(crate) fn number(&self, cells: &[&str], place: usize, line: usize) -> Result<f64, Error> {
        let value = cells.get(place).and_then(|c| c.trim().parse().ok());
        value
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| {
                let name = self.columns.get(place).copied().unwrap_or("?");
                let what = match cells.get(place) {
                    Some(cell) => format!("{name} = '{cell}' must be a finite number"),
                    None => format!("the row ends before {name}"),
                };
                self.wrong(line, what)
            })
    }

    /// The fault in a line.
    pub(crate) fn wrong(&self, line: usize, what: String) -> Error {
        Error::Positions {
            file: self.file.to_owned(),
            line,
            what,
        }
    }
}
