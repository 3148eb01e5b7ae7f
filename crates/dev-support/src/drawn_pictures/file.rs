//! Pictures into files.

use image::{DynamicImage, ImageResult};
use std::path::Path;

/// Writes a picture in the format that the ending of the file's name says.
///
/// The encoders of all formats are compiled here once, and not in each crate that writes a picture.
///
/// # Errors
///
/// An unknown ending, a kind of pixel that the format does not have, a file that cannot be written.
pub fn save(picture: impl Into<DynamicImage>, path: impl AsRef<Path>) -> ImageResult<()> {
    write(&picture.into(), path.as_ref())
}

/// [`save`] of any picture.
fn write(picture: &DynamicImage, path: &Path) -> ImageResult<()> {
    picture.save(path)
}
