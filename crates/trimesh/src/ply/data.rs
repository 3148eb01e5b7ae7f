//! The numbers after the header of a PLY file.

use super::header::{Encoding, Scalar};
use crate::Error;
use crate::words::{Words, number};

/// The body of a file, read number by number.
#[derive(Debug)]
pub(super) struct Data<'a> {
    encoding: Encoding,
    words: Words<'a>,
    bytes: &'a [u8],
    /// Bytes of the body.
    length: usize,
    /// Lines of the header, for messages.
    lines: usize,
    file: &'a str,
}

impl<'a> Data<'a> {
    pub(super) fn new(bytes: &'a [u8], encoding: Encoding, lines: usize, file: &'a str) -> Self {
        Self {
            encoding,
            words: Words::new(bytes, file),
            bytes,
            length: bytes.len(),
            lines,
            file,
        }
    }

    /// Takes a number; an unlike word or the end of the file is an error.
    pub(super) fn number(&mut self, scalar: Scalar) -> Result<f64, Error> {
        if self.encoding == Encoding::Ascii {
            let word = self.words.next_word();
            return match word.and_then(number) {
                Some(value) => Ok(value),
                None => Err(self.fault_at("a finite number", word)),
            };
        }
        match scalar {
            Scalar::I8 => self.take().map(|b| f64::from(i8::from_le_bytes(b))),
            Scalar::U8 => self.take().map(|b| f64::from(u8::from_le_bytes(b))),
            Scalar::I16 => self.take().map(|b| f64::from(i16::from_le_bytes(b))),
            Scalar::U16 => self.take().map(|b| f64::from(u16::from_le_bytes(b))),
            Scalar::I32 => self.take().map(|b| f64::from(i32::from_le_bytes(b))),
            Scalar::U32 => self.take().map(|b| f64::from(u32::from_le_bytes(b))),
            Scalar::F32 => self.take().map(|b| f64::from(f32::from_le_bytes(b))),
            Scalar::F64 => self.take().map(f64::from_le_bytes),
        }
    }

    /// Takes the length of a list.
    pub(super) fn count(&mut self, scalar: Scalar) -> Result<u64, Error> {
        let value = self.number(scalar)?;
        super::whole(value)
            .map(|n| n as u64)
            .ok_or_else(|| self.fault("the length of a list"))
    }

    /// Takes bytes, the lowest first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let Some((head, rest)) = self.bytes.split_first_chunk::<N>() else {
            return Err(self.fault("more numbers"));
        };
        self.bytes = rest;
        let mut head = *head;
        if self.encoding == Encoding::Big {
            head.reverse();
        }
        Ok(head)
    }

    /// Refuses what was read last.
    pub(super) fn fault(&self, expected: &'static str) -> Error {
        self.fault_at(expected, None)
    }

    fn fault_at(&self, expected: &'static str, word: Option<&[u8]>) -> Error {
        let found = match (self.encoding, word) {
            (Encoding::Ascii, Some(word)) => {
                String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned()
            }
            (Encoding::Ascii, None) => "another value or the end of the file".to_owned(),
            _ => {
                let place = self.length - self.bytes.len();
                format!("byte {place} of {} after the header", self.length)
            }
        };
        Error::Syntax {
            file: self.file.to_owned(),
            line: self.lines + self.words.line() - 1,
            expected,
            found,
        }
    }
}
