//! Reading STL files.
//!
//! Whether a file is binary is decided by its length, 84 + 50 n bytes for n triangles, never by
//! its first word: many binary files begin with `solid`. Binary files then go through `stl_io`
//! with a blanked header; ASCII files through an own scanner, because real files hold several
//! solids, `nan` normals, upper case and byte-order marks.

mod ascii;
mod binary;

use crate::{CheckedMesh, Error, LengthUnit, TriMesh};
use std::path::Path;

/// Reads and checks a mesh file whose numbers are in `unit`.
///
/// # Errors
///
/// The file cannot be read, is no whole STL, or holds no body; see [`Error`].
pub fn read_stl(path: &Path, unit: LengthUnit) -> Result<CheckedMesh, Error> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|source| Error::Read {
        path: name.clone(),
        source,
    })?;
    parse_stl(bytes, unit, &name)
}

/// Reads and checks the bytes of a mesh file; `file` names it in messages.
///
/// # Errors
///
/// The bytes are no whole STL or hold no body; see [`Error`].
pub fn parse_stl(bytes: Vec<u8>, unit: LengthUnit, file: &str) -> Result<CheckedMesh, Error> {
    if bytes.is_empty() {
        return Err(Error::EmptyFile {
            file: file.to_owned(),
        });
    }
    let declared = binary::declared_triangles(&bytes);
    let length = bytes.len() as u64;
    let soup = match declared {
        Some(n) if binary::length_for(n) == length => binary::triangles(bytes, file)?,
        _ if ascii::looks_like_text(&bytes) => ascii::triangles(&bytes, file)?,
        Some(n) if !ascii::is_plain_text(&bytes) => {
            return Err(Error::LengthMismatch {
                file: file.to_owned(),
                declared: n,
                expected_bytes: binary::length_for(n),
                actual_bytes: length,
            });
        }
        _ => {
            return Err(Error::NotStl {
                file: file.to_owned(),
                bytes: length,
            });
        }
    };
    TriMesh::from_triangles(&soup, unit, file)
}
