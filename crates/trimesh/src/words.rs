//! A text file word by word, with the line for messages.

use crate::Error;

/// The file without a byte-order mark.
pub(crate) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Words of a file with the line they stand on.
///
/// A line ends at a line feed, at a carriage return, or at both.
#[derive(Debug)]
pub(crate) struct Words<'a> {
    /// What is not yet read.
    rest: &'a [u8],
    /// Number of the line, from 1.
    line: usize,
    /// File, for messages.
    file: &'a str,
}

impl<'a> Words<'a> {
    /// Starts at the beginning of a text, after a byte-order mark.
    pub(crate) fn new(bytes: &'a [u8], file: &'a str) -> Self {
        Self {
            rest: without_mark(bytes),
            line: 1,
            file,
        }
    }

    /// Number of the line, from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// What is not yet read.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Goes to the next word, past the ends of lines; none at the end of the file.
    pub(crate) fn next_word(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.next_in_line() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    /// Next word of this line.
    pub(crate) fn next_in_line(&mut self) -> Option<&'a [u8]> {
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() && !is_end(*byte);
        let start = self.rest.iter().position(|byte| !is_blank(byte))?;
        self.rest = &self.rest[start..];
        let end = self.rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Drops the remainder of the line; false at the end of the file.
    pub(crate) fn next_line(&mut self) -> bool {
        let Some(end) = self.rest.iter().position(|&byte| is_end(byte)) else {
            self.rest = &[];
            return false;
        };
        let pair = self.rest[end..].starts_with(b"\r\n");
        self.rest = &self.rest[end + 1 + usize::from(pair)..];
        self.line += 1;
        true
    }

    /// Refuses a word, or the end of the file.
    pub(crate) fn fault(&self, expected: &'static str, found: Option<&[u8]>) -> Error {
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

    /// Takes a word that must be the one given, in any case.
    pub(crate) fn take(&mut self, expected: &'static str) -> Result<(), Error> {
        match self.next_word() {
            Some(word) if word.eq_ignore_ascii_case(expected.as_bytes()) => Ok(()),
            other => Err(self.fault(expected, other)),
        }
    }

    /// Takes a finite number.
    pub(crate) fn take_number(&mut self) -> Result<f64, Error> {
        let word = self.next_word();
        word.and_then(number)
            .ok_or_else(|| self.fault("a finite number", word))
    }
}

/// A word as a finite number.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse::<f64>().ok().filter(|number| number.is_finite())
}

fn is_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}
