//! What stops a photo from being read at all.

use std::path::PathBuf;

/// Why there is no reading; a picture that was read but cannot be measured is a
/// [`crate::Verdict::Refused`] instead.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A folder holds no picture.
    #[error("the folder {} holds no picture ({endings})", folder.display())]
    NoPicture {
        /// The folder.
        folder: PathBuf,
        /// Endings of the names of pictures.
        endings: String,
    },
    /// The file is no picture of a known format, or is damaged.
    #[error("cannot decode {} (PNG, JPEG, BMP, GIF, TIFF and WebP are read)", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
    /// The file ends before the picture does.
    #[error("{} is cut off: the JPEG end marker is missing after {bytes} bytes", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Bytes in the file.
        bytes: usize,
    },
    /// The picture is larger than is decoded.
    #[error("{} has {pixels} pixels, at most {most} are read; scale it down", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Pixels it says it has.
        pixels: u64,
        /// Most pixels that are decoded.
        most: u64,
    },
    /// A setting is outside its limits.
    #[error("{name} is {value}, it must be {limit}")]
    BadSetting {
        /// Name of the setting.
        name: &'static str,
        /// Value given, in its own unit.
        value: f64,
        /// What is allowed, in words.
        limit: &'static str,
    },
    /// Corners that span no square seen in perspective.
    #[error(
        "the corners must be finite and span a convex area, in the order upper left, upper \
         right, lower right, lower left"
    )]
    BadCorners,
}
