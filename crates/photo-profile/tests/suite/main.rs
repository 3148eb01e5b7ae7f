//! The reader of pictures on drawn and real pictures.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod colours;
mod files;
mod heaps;
mod kinds;
mod mutated_files;
mod other_library;
mod real_photos;
mod refusals;
mod regions;
mod synthetic_pictures;

use photo_profile::{Error, PhotoPixels, PhotoReading, Settings, measure_photo, read_photo};
use std::path::Path;

/// Measures the angle in a picture file.
fn measure_file(path: &Path, settings: &Settings) -> Result<PhotoReading, Error> {
    measure_photo(&PhotoPixels::from_picture(&read_photo(path)?), settings)
}
