//! The size of an archive once it is unpacked.

use input_file::MOST_BYTES;
use std::io::{Cursor, Read as _, copy, sink};
use zip::ZipArchive;

/// Unpacks every file of an archive once into nothing: all of them together are no larger than a file that is read, and each
/// has its checksum. What an archive says about its sizes is not believed.
pub(crate) fn check(bytes: &[u8]) -> Result<(), String> {
    let damaged = |why: &dyn std::fmt::Display| {
        format!("the workbook is damaged ({why}); take a whole copy, or save it again")
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut left = MOST_BYTES;
    for i in 0..archive.len() {
        let file = archive.by_index(i).map_err(|error| damaged(&error))?;
        let unpacked =
            copy(&mut file.take(left + 1), &mut sink()).map_err(|error| damaged(&error))?;
        left = left.checked_sub(unpacked).ok_or_else(|| {
            format!("unpacked it has more than {MOST_BYTES} bytes; at most so many are read")
        })?;
    }
    Ok(())
}
