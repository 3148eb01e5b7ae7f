//! Reading STL files.
//!
//! Whether a file is binary is decided by its length, at least 84 + 50 n bytes for n triangles,
//! never by its first word alone: many binary files begin with `solid`. Real ASCII files hold
//! several solids, `nan` normals, upper case and byte-order marks, so both have an own scanner.

mod ascii;
mod binary;

use crate::soup::Soup;
use crate::{CheckedMesh, Error, LengthUnit};
use std::path::Path;

/// Reads and checks an STL file whose numbers are in `unit`.
///
/// # Errors
///
/// The file cannot be read, is no whole STL, or holds no body; see [`Error`].
pub fn read_stl(path: &Path, unit: LengthUnit) -> Result<CheckedMesh, Error> {
    let (name, bytes) = crate::soup::bytes_of(path)?;
    parse_stl(bytes, unit, &name)
}

/// Reads and checks the bytes of an STL file; `file` names it in messages.
///
/// # Errors
///
/// The bytes are no whole STL or hold no body; see [`Error`].
pub fn parse_stl(bytes: Vec<u8>, unit: LengthUnit, file: &str) -> Result<CheckedMesh, Error> {
    let soup = stl_soup(&bytes, file)?;
    drop(bytes);
    soup.check(unit, file)
}

/// Loose triangles of the bytes of an STL file.
pub(crate) fn stl_soup(bytes: &[u8], file: &str) -> Result<Soup, Error> {
    if bytes.is_empty() {
        return Err(Error::EmptyFile {
            file: file.to_owned(),
        });
    }
    let length = bytes.len() as u64;
    match binary::declared_triangles(bytes) {
        // Four characters of a text read as a count take gigabytes: what fits is no text.
        Some(n) if binary::length_for(n) <= length => binary::triangles(bytes, n, file),
        _ if ascii::looks_like_text(bytes) => ascii::triangles(bytes, file),
        Some(n) if !ascii::is_plain_text(bytes) => binary::triangles(bytes, n, file),
        _ => Err(Error::NotStl {
            file: file.to_owned(),
            bytes: length,
        }),
    }
}
