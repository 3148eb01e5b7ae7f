//! ASCII STL, read word by word.
//!
//! Words may stand in any case and on any line; normals are skipped unread, since they follow
//! from the corners and are often `nan`. Every solid of the file is read.

use crate::Error;
use nalgebra::Vector3;

/// Bytes at the start that decide whether a file is text.
const SNIFFED: usize = 4096;

/// The file without a byte-order mark.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Whether the file begins as an ASCII STL: the word `solid`, and a facet or an end soon after.
pub(super) fn looks_like_text(bytes: &[u8]) -> bool {
    let start = without_mark(bytes);
    let start = start[..start.len().min(SNIFFED)].to_ascii_lowercase();
    let has = |word: &[u8]| start.windows(word.len()).any(|part| part == word);
    start.trim_ascii_start().starts_with(b"solid") && (has(b"facet") || has(b"endsolid"))
}

/// Whether the file begins with printable characters only.
pub(super) fn is_plain_text(bytes: &[u8]) -> bool {
    without_mark(bytes)
        .iter()
        .take(SNIFFED)
        .all(|&byte| byte >= b' ' || byte.is_ascii_whitespace())
}

/// The lines of a file with their index.
type Lines<'a> = std::iter::Enumerate<std::slice::Split<'a, u8, fn(&u8) -> bool>>;

/// Words of a file with the line they stand on.
struct Words<'a> {
    /// The lines not yet begun.
    lines: Lines<'a>,
    /// The rest of the line begun.
    rest: &'a [u8],
    /// Number of that line, from 1.
    line: usize,
    /// File, for messages.
    file: &'a str,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8], file: &'a str) -> Self {
        let is_end: fn(&u8) -> bool = |&byte| byte == b'\n';
        Self {
            lines: without_mark(bytes).split(is_end).enumerate(),
            rest: &[],
            line: 0,
            file,
        }
    }

    /// Next word, or none at the end of the file.
    fn next_word(&mut self) -> Option<&'a [u8]> {
        loop {
            self.rest = self.rest.trim_ascii_start();
            if self.rest.is_empty() {
                let (index, line) = self.lines.next()?;
                (self.line, self.rest) = (index + 1, line);
                continue;
            }
            let end = self.rest.iter().position(u8::is_ascii_whitespace);
            let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
            self.rest = rest;
            return Some(word);
        }
    }

    /// Drops what is left of the line (the name of a solid).
    fn skip_line(&mut self) {
        self.rest = &[];
    }

    /// Refuses a word.
    fn fault(&self, expected: &'static str, found: Option<&[u8]>) -> Error {
        let shown = found.map_or("end of file".into(), |word| {
            String::from_utf8_lossy(&word[..word.len().min(40)])
        });
        Error::Syntax {
            file: self.file.to_owned(),
            line: self.line,
            expected,
            found: shown.into_owned(),
        }
    }

    /// Takes a word that must be the one given.
    fn take(&mut self, expected: &'static str) -> Result<(), Error> {
        match self.next_word() {
            Some(word) if word.eq_ignore_ascii_case(expected.as_bytes()) => Ok(()),
            other => Err(self.fault(expected, other)),
        }
    }

    /// Takes a finite number.
    fn take_number(&mut self) -> Result<f64, Error> {
        let word = self.next_word();
        word.and_then(|word| std::str::from_utf8(word).ok())
            .and_then(|text| text.parse::<f64>().ok())
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.fault("a finite number", word))
    }

    /// Takes the rest of a facet after its first word.
    fn take_facet(&mut self) -> Result<[Vector3<f64>; 3], Error> {
        self.take("normal")?;
        for _ in 0..3 {
            self.next_word();
        }
        self.take("outer")?;
        self.take("loop")?;
        let mut corners = [Vector3::zeros(); 3];
        for corner in &mut corners {
            self.take("vertex")?;
            for k in 0..3 {
                corner[k] = self.take_number()?;
            }
        }
        self.take("endloop")?;
        self.take("endfacet")?;
        Ok(corners)
    }
}

/// Reads the triangles of all solids.
pub(super) fn triangles(bytes: &[u8], file: &str) -> Result<Vec<[Vector3<f64>; 3]>, Error> {
    let mut words = Words::new(bytes, file);
    let mut found = Vec::new();
    let mut inside = false;
    while let Some(word) = words.next_word() {
        if word.eq_ignore_ascii_case(b"facet") && inside {
            found.push(words.take_facet()?);
        } else if word.eq_ignore_ascii_case(b"solid") && !inside {
            inside = true;
            words.skip_line();
        } else if word.eq_ignore_ascii_case(b"endsolid") && inside {
            inside = false;
            words.skip_line();
        } else {
            let expected = if inside { "facet or endsolid" } else { "solid" };
            return Err(words.fault(expected, Some(word)));
        }
    }
    if inside {
        return Err(words.fault("endsolid", None));
    }
    Ok(found)
}
