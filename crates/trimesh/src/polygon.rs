//! Polygons of files with shared vertices, cut into triangles.

use crate::Error;
use crate::soup::Soup;
use nalgebra::Vector3;

impl Soup {
    /// Adds a polygon as a fan from its first corner.
    ///
    /// The fan of a polygon that is not convex folds over itself; volume and inertia stay right,
    /// because the folded parts cancel.
    pub(crate) fn push_polygon(&mut self, corners: &[Vector3<f64>]) {
        for pair in corners.windows(2).skip(1) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
    }
}

/// Looks up a vertex by its index from 0.
pub(crate) fn vertex(
    vertices: &[Vector3<f64>],
    index: Option<usize>,
    place: impl FnOnce() -> Error,
) -> Result<Vector3<f64>, Error> {
    index
        .and_then(|index| vertices.get(index))
        .copied()
        .ok_or_else(place)
}
