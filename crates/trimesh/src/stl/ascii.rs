//! ASCII STL, read word by word.
//!
//! Words may stand in any case and on any line; normals are skipped unread, since they follow
//! from the corners and are often `nan`. Every solid of the file is read.

use super::Soup;
use crate::words::{Words, without_mark};
use crate::{Error, Warning};
use nalgebra::Vector3;

/// Bytes at the start that decide whether a file is text.
const SNIFFED: usize = 4096;

/// Whether the file begins as an ASCII STL: the word `solid`, and a facet or an end soon after.
pub(super) fn looks_like_text(bytes: &[u8]) -> bool {
    let start = without_mark(bytes);
    let start = start[..start.len().min(SNIFFED)].to_ascii_lowercase();
    let has = |word: &[u8]| start.windows(word.len()).any(|part| part == word);
    start.trim_ascii_start().starts_with(b"solid") && (has(b"facet") || has(b"endsolid"))
}

/// Whether the file begins as a text: at most one control character in a hundred, and none of
/// value 0 but in UTF-16, which begins with its byte-order mark.
///
/// A tenth or more of the bytes of a binary mesh are control characters.
pub(super) fn is_plain_text(bytes: &[u8]) -> bool {
    let start = &without_mark(bytes)[..without_mark(bytes).len().min(SNIFFED)];
    let odd = |byte: &&u8| **byte < b' ' && !byte.is_ascii_whitespace();
    is_utf16(bytes) || !start.contains(&0) && 100 * start.iter().filter(odd).count() <= start.len()
}

/// Whether the file begins with the byte-order mark of UTF-16.
pub(super) fn is_utf16(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF")
}

/// Reads the triangles of all solids.
pub(super) fn triangles(bytes: &[u8], file: &str) -> Result<Soup, Error> {
    let mut words = Words::new(bytes, file);
    let mut found = Soup::default();
    let mut inside = false;
    while let Some(word) = words.next_word() {
        if word.eq_ignore_ascii_case(b"facet") && inside {
            found.triangles.push(facet(&mut words)?);
        } else if word.eq_ignore_ascii_case(b"solid") && !inside {
            inside = true;
            words.next_line();
        } else if word.eq_ignore_ascii_case(b"endsolid") && inside {
            inside = false;
            words.next_line();
        } else {
            let expected = if inside { "facet or endsolid" } else { "solid" };
            return Err(words.fault(expected, Some(word)));
        }
    }
    if inside {
        found.warnings.push(Warning::NoEnd);
    }
    Ok(found)
}

/// Takes the rest of a facet after its first word.
fn facet(words: &mut Words<'_>) -> Result<[Vector3<f64>; 3], Error> {
    words.take("normal")?;
    for _ in 0..3 {
        words.next_word();
    }
    words.take("outer")?;
    words.take("loop")?;
    let mut corners = [Vector3::zeros(); 3];
    for corner in &mut corners {
        words.take("vertex")?;
        for k in 0..3 {
            corner[k] = words.take_number()?;
        }
    }
    words.take("endloop")?;
    words.take("endfacet")?;
    Ok(corners)
}
