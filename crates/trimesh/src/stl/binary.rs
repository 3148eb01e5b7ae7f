//! Binary STL: an 80-byte header, a count, 50 bytes a triangle.

use super::Soup;
use crate::{Error, Warning};
use nalgebra::Vector3;

/// Bytes before the triangle count.
const HEADER: usize = 80;

/// Bytes of one triangle: normal, three corners, two bytes that some programs use for a colour.
const RECORD: usize = 50;

/// Triangle count that the header declares, if there are enough bytes for one.
pub(super) fn declared_triangles(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

/// Length of a file of n triangles, bytes.
pub(super) fn length_for(n: u32) -> u64 {
    84 + 50 * u64::from(n)
}

/// Reads the triangles; what the file's length says wins over a count that is too small.
///
/// More triangles declared than there are is a file cut off, and an error. Fewer declared, and
/// the rest is a whole number of records of finite numbers: all are read. Any other rest is left
/// aside. The last two give a warning.
pub(super) fn triangles(bytes: &[u8], declared: u32, file: &str) -> Result<Soup, Error> {
    let records = bytes.get(HEADER + 4..).unwrap_or_default();
    let whole = records.len() / RECORD;
    let declared_whole = declared as usize;
    if declared_whole > whole || bytes.len() < HEADER + 4 {
        return Err(Error::LengthMismatch {
            file: file.to_owned(),
            declared,
            expected_bytes: length_for(declared),
            actual_bytes: bytes.len() as u64,
        });
    }
    let rest = records.get(declared_whole * RECORD..).unwrap_or_default();
    let more = rest.chunks_exact(RECORD).map(corners);
    let is_whole = rest.len() % RECORD == 0;
    let is_mesh = is_whole && more.flatten().all(|c| c.iter().all(|v| v.is_finite()));
    let (read, warning) = match rest.len() {
        0 => (declared_whole, None),
        _ if is_mesh => {
            let found = whole;
            (whole, Some(Warning::CountCorrected { declared, found }))
        }
        left => (declared_whole, Some(Warning::TrailingBytes(left))),
    };
    let read = records.chunks_exact(RECORD).take(read);
    Ok(Soup {
        triangles: read.map(corners).collect(),
        warnings: warning.into_iter().collect(),
    })
}

/// Corners of a record; its normal follows from them.
fn corners(record: &[u8]) -> [Vector3<f64>; 3] {
    let number = |index: usize| {
        let place = 4 * index;
        let mut bytes = [0; 4];
        bytes.copy_from_slice(&record[place..place + 4]);
        f64::from(f32::from_le_bytes(bytes))
    };
    [3, 6, 9].map(|first| Vector3::new(number(first), number(first + 1), number(first + 2)))
}
