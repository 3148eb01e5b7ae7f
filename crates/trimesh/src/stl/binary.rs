//! Binary STL: an 80-byte header, a count, 50 bytes a triangle.

use crate::Error;
use nalgebra::Vector3;

/// Bytes before the triangle count.
const HEADER: usize = 80;

/// Triangle count that the header declares, if there are enough bytes for one.
pub(super) fn declared_triangles(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

/// Length of a file of n triangles, bytes.
pub(super) fn length_for(n: u32) -> u64 {
    84 + 50 * u64::from(n)
}

/// Reads the triangles of a file whose length has been checked.
///
/// The header is blanked first: `stl_io` takes a file for ASCII when it begins with `solid `.
pub(super) fn triangles(mut bytes: Vec<u8>, file: &str) -> Result<Vec<[Vector3<f64>; 3]>, Error> {
    bytes[..HEADER].fill(b' ');
    let failed = |source| Error::Read {
        path: file.to_owned(),
        source,
    };
    let mut cursor = std::io::Cursor::new(bytes);
    let reader = stl_io::create_stl_reader(&mut cursor).map_err(failed)?;
    let corner = |v: stl_io::Vertex| Vector3::from(v.0.map(f64::from));
    reader
        .map(|triangle| Ok(triangle.map_err(failed)?.vertices.map(corner)))
        .collect()
}
