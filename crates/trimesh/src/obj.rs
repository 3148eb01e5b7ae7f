//! Wavefront OBJ: `v` and `f` lines; groups, normals, textures and materials are passed over.

use crate::Error;
use crate::polygon::vertex;
use crate::soup::Soup;
use crate::words::Words;
use nalgebra::Vector3;

/// Whether a text has a line that only an OBJ has: a vertex with three numbers.
pub(crate) fn looks_like_obj(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    let mut words = Words::new(start, "");
    loop {
        if words.next_in_line() == Some(b"v") {
            return words
                .next_in_line()
                .and_then(crate::words::number)
                .is_some();
        }
        if !words.next_line() {
            return false;
        }
    }
}

/// Reads the polygons of all groups.
pub(crate) fn obj_soup(bytes: &[u8], file: &str) -> Result<Soup, Error> {
    let mut words = Words::new(bytes, file);
    let mut vertices: Vec<Vector3<f64>> = Vec::new();
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    loop {
        match words.next_in_line() {
            Some(b"v") => vertices.push(position(&mut words)?),
            Some(b"f") => {
                corners.clear();
                while let Some(word) = words.next_in_line() {
                    // A backslash at the end carries a long face over to the next line.
                    if word == b"\\" {
                        words.next_line();
                        continue;
                    }
                    let fault = || words.fault("the index of a vertex", Some(word));
                    corners.push(vertex(&vertices, index(word, vertices.len()), fault)?);
                }
                if corners.len() < 3 {
                    return Err(words.fault("three or more vertices of a face", None));
                }
                soup.push_polygon(&corners);
            }
            _ => {}
        }
        if !words.next_line() {
            return soup.or_points(vertices.len(), file);
        }
    }
}

/// Takes three coordinates from this line.
fn position(words: &mut Words<'_>) -> Result<Vector3<f64>, Error> {
    let mut found = Vector3::zeros();
    for k in 0..3 {
        let word = words.next_in_line();
        found[k] = word
            .and_then(crate::words::number)
            .ok_or_else(|| words.fault("a finite number", word))?;
    }
    Ok(found)
}

/// Index from 0 of a word such as `7`, `7/2`, `7//3` or `-1` (the last vertex so far).
fn index(word: &[u8], vertices: usize) -> Option<usize> {
    let own = word.split(|&byte| byte == b'/').next()?;
    let number: i64 = std::str::from_utf8(own).ok()?.parse().ok()?;
    let back = usize::try_from(number.unsigned_abs()).ok()?;
    match number.signum() {
        1 => back.checked_sub(1),
        -1 => vertices.checked_sub(back),
        _ => None,
    }
}
