//! Size of an unpacked archive, and the sizes that its parts announce.

use std::io::{Cursor, Read as _, Result as IoResult, Write, copy};
use zip::ZipArchive;

/// Most bytes of all parts together (256 MiB): our choice, some ten million cells. The archive may be a thousand times smaller.
const MOST_UNPACKED: u64 = 1 << 28;

/// Unpacks every part of an archive once into nothing: all of them together are of a plausible size, and each has its checksum.
/// It does not rely on the sizes in the archive, nor on the number of texts that a part announces, for which
/// the reader would allocate memory before it has read one.
pub(crate) fn check(bytes: &[u8]) -> Result<(), String> {
    let damaged = |why: &dyn std::fmt::Display| {
        format!("the workbook is damaged ({why}); copy it again, or save it again")
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut left = MOST_UNPACKED;
    for i in 0..archive.len() {
        let file = archive.by_index(i).map_err(|error| damaged(&error))?;
        let mut announced = Announced::default();
        let unpacked =
            copy(&mut file.take(left + 1), &mut announced).map_err(|error| damaged(&error))?;
        left = left.checked_sub(unpacked).ok_or_else(|| {
            format!("unpacked it has more than {MOST_UNPACKED} bytes, the most that are read")
        })?;
        if announced.most > unpacked {
            return Err(damaged(&format_args!(
                "a part of {unpacked} bytes announces {} texts",
                announced.most
            )));
        }
    }
    Ok(())
}

/// The attribute with which a part announces the number of its texts.
const ATTRIBUTE: &[u8] = b"uniqueCount";

/// Looks for the greatest number of texts that is announced in the bytes written to it.
#[derive(Debug, Default)]
struct Announced {
    /// The greatest number so far.
    most: u64,
    /// Where in an attribute the bytes so far end.
    at: At,
}

/// A place in `uniqueCount = "12"`.
#[derive(Debug, Clone, Copy)]
enum At {
    /// Behind so many letters of the name.
    Name(usize),
    /// Behind the name.
    Equals,
    /// Behind the sign of equality or the quote.
    Number(u64),
}

impl Default for At {
    fn default() -> Self {
        Self::Name(0)
    }
}

impl Announced {
    /// Takes the next byte.
    fn take(&mut self, byte: u8) {
        self.at = match (self.at, byte) {
            (At::Name(n), byte) if ATTRIBUTE.get(n) == Some(&byte) => match n + 1 {
                n if n == ATTRIBUTE.len() => At::Equals,
                n => At::Name(n),
            },
            (At::Equals, b'=') => At::Number(0),
            (At::Equals | At::Number(0), byte) if byte.is_ascii_whitespace() => self.at,
            (At::Number(0), b'"' | b'\'' | b'+') => self.at,
            (At::Number(n), b'0'..=b'9') => {
                let n = n.saturating_mul(10).saturating_add(u64::from(byte - b'0'));
                self.most = self.most.max(n);
                At::Number(n)
            }
            (_, byte) => At::Name(usize::from(ATTRIBUTE[0] == byte)),
        };
    }
}

impl Write for Announced {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        for byte in bytes {
            self.take(*byte);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> IoResult<()> {
        Ok(())
    }
}
