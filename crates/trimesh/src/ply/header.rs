//! The header of a PLY file.

use crate::Error;
use crate::words::Words;

/// How the numbers of the body are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Words.
    Ascii,
    /// Bytes, the lowest first.
    Little,
    /// Bytes, the highest first.
    Big,
}

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Type of a name of the first or of the later convention.
    fn named(word: &[u8]) -> Option<Self> {
        match word {
            b"char" | b"int8" => Some(Self::I8),
            b"uchar" | b"uint8" => Some(Self::U8),
            b"short" | b"int16" => Some(Self::I16),
            b"ushort" | b"uint16" => Some(Self::U16),
            b"int" | b"int32" => Some(Self::I32),
            b"uint" | b"uint32" => Some(Self::U32),
            b"float" | b"float32" => Some(Self::F32),
            b"double" | b"float64" => Some(Self::F64),
            _ => None,
        }
    }
}

/// One number, or a list with its length before it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A property of an element.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A table of the file.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// Rows that are declared.
    count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Rows to read. A row without properties takes no data, so that only the count would end it.
    pub(super) fn rows(&self) -> u64 {
        if self.properties.is_empty() {
            0
        } else {
            self.count
        }
    }
}

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// Reads the header; gives the bytes after it and the number of the last line.
    pub(super) fn read<'a>(
        bytes: &'a [u8],
        file: &'a str,
    ) -> Result<(Self, &'a [u8], usize), Error> {
        let mut words = Words::new(bytes, file);
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            if !words.next_line() {
                return Err(words.fault("end_header", None));
            }
            match words.next_in_line() {
                Some(b"end_header") => break,
                Some(b"format") => encoding = Some(read_encoding(&mut words)?),
                Some(b"element") => elements.push(read_element(&mut words)?),
                Some(b"property") => {
                    let property = read_property(&mut words)?;
                    match elements.last_mut() {
                        Some(element) => element.properties.push(property),
                        None => return Err(words.fault("element before property", None)),
                    }
                }
                _ => {}
            }
        }
        words.next_line();
        let encoding = encoding.ok_or_else(|| words.fault("a line format", None))?;
        let header = Self { encoding, elements };
        Ok((header, words.rest(), words.line()))
    }
}

fn read_encoding(words: &mut Words<'_>) -> Result<Encoding, Error> {
    match words.next_in_line() {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::Little),
        Some(b"binary_big_endian") => Ok(Encoding::Big),
        other => Err(words.fault("ascii, binary_little_endian or binary_big_endian", other)),
    }
}

fn read_element(words: &mut Words<'_>) -> Result<Element, Error> {
    let name = read_name(words)?;
    let word = words.next_in_line();
    let count = word
        .and_then(|word| std::str::from_utf8(word).ok())
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| words.fault("the number of rows of an element", word))?;
    let properties = Vec::new();
    Ok(Element {
        name,
        count,
        properties,
    })
}

fn read_property(words: &mut Words<'_>) -> Result<Property, Error> {
    let kind = match words.next_in_line() {
        Some(b"list") => Kind::List {
            count: read_scalar(words)?,
            item: read_scalar(words)?,
        },
        other => Kind::One(scalar_of(words, other)?),
    };
    let name = read_name(words)?;
    Ok(Property { name, kind })
}

fn read_name(words: &mut Words<'_>) -> Result<String, Error> {
    match words.next_in_line() {
        Some(word) => Ok(String::from_utf8_lossy(word).into_owned()),
        None => Err(words.fault("a name", None)),
    }
}

fn read_scalar(words: &mut Words<'_>) -> Result<Scalar, Error> {
    let word = words.next_in_line();
    scalar_of(words, word)
}

fn scalar_of(words: &Words<'_>, word: Option<&[u8]>) -> Result<Scalar, Error> {
    word.and_then(Scalar::named)
        .ok_or_else(|| words.fault("a type of number such as float or uchar", word))
}
