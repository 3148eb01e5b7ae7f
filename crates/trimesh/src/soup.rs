//! Loose triangles as a file gives them, before any check.

use crate::build::build;
use crate::{CheckedMesh, Error, LengthUnit, Repair, Warning};
use nalgebra::Vector3;
use std::path::Path;

/// Triangles of a file and what was odd about the file.
#[derive(Debug, Default)]
pub(crate) struct Soup {
    /// Corners, in the unit of the file.
    pub(crate) triangles: Vec<[Vector3<f64>; 3]>,
    /// Warnings for the user.
    pub(crate) warnings: Vec<Warning>,
}

impl Soup {
    /// The triangles of a file, or the refusal of one that has `points` and no triangles.
    pub(crate) fn or_points(self, points: usize, file: &str) -> Result<Self, Error> {
        if points > 0 && self.triangles.is_empty() {
            return Err(Error::PointCloud {
                file: file.to_owned(),
                points: format!("{points} points"),
            });
        }
        Ok(self)
    }

    /// Makes the mesh.
    pub(crate) fn check(
        self,
        unit: LengthUnit,
        file: &str,
        repair: &Repair,
    ) -> Result<CheckedMesh, Error> {
        build(self.triangles, unit, file, repair, self.warnings)
    }
}

/// Name and bytes of a file; an empty one is refused.
pub(crate) fn bytes_of(path: &Path) -> Result<(String, Vec<u8>), Error> {
    let name = path.display().to_string();
    match input::file::read(path) {
        Ok(bytes) => Ok((name, bytes)),
        Err(source) => Err(Error::Read { path: name, source }),
    }
}
