//! Reading STL files.
//!
//! Whether a file is binary is decided by its length, at least 84 + 50 n bytes for n triangles,
//! never by its first word alone: many binary files begin with `solid`. Real ASCII files hold
//! several solids, `nan` normals, upper case and byte-order marks, so both have an own scanner.

mod ascii;
mod binary;

use crate::Error;
use crate::soup::Soup;

/// Loose triangles of the bytes of an STL file.
pub(crate) fn stl_soup(bytes: &[u8], file: &str) -> Result<Soup, Error> {
    if bytes.is_empty() {
        return Err(Error::EmptyFile {
            file: file.to_owned(),
        });
    }
    let length = bytes.len() as u64;
    match binary::declared_triangles(bytes) {
        // Four characters of a text read as a count take gigabytes: what fits is not text.
        Some(n) if binary::length_for(n) <= length => binary::triangles(bytes, n, file),
        _ if ascii::looks_like_text(bytes) => ascii::triangles(bytes, file),
        // Fewer than 84 bytes declare nothing.
        declared if !ascii::is_plain_text(bytes) => {
            binary::triangles(bytes, declared.unwrap_or(0), file)
        }
        _ => Err(other_text(bytes, file)),
    }
}

/// Whether a line is the place of a point: three numbers or more and nothing else.
fn is_point(line: &str) -> bool {
    let mut words = line.split([' ', '\t', ',', ';']).filter(|w| !w.is_empty());
    words.clone().count() >= 3 && words.all(|word| word.parse::<f64>().is_ok())
}

/// The refusal of a text, with its beginning.
fn other_text(bytes: &[u8], file: &str) -> Error {
    const SHOWN: usize = 40;
    let file = file.to_owned();
    if ascii::is_utf16(bytes) {
        return Error::Utf16 { file };
    }
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(8 * SHOWN)]).into_owned();
    let line = start.lines().map(str::trim).find(|line| !line.is_empty());
    if line.is_some_and(is_point) {
        let points = "lines of numbers".to_owned();
        return Error::PointCloud { file, points };
    }
    Error::NotMesh {
        file,
        start: line
            .unwrap_or_default()
            .chars()
            .filter(|c| !c.is_control())
            .take(SHOWN)
            .collect(),
    }
}
