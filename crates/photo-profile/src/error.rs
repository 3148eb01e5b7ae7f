//! What stops a photo from being read at all.

use crate::PixelRegion;
use std::path::PathBuf;

/// Why there is no reading; a picture that was read but cannot be measured is a
/// [`crate::PhotoReading::Refused`] instead.
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
    #[error("the folder {} holds no picture ({endings}){left_out}", folder.display())]
    NoPicture {
        /// The folder.
        folder: PathBuf,
        /// Endings of the names of pictures.
        endings: String,
        /// What was left out of it, in words that begin with a semicolon; nothing of an empty folder.
        left_out: String,
    },
    /// Nothing but pictures that this crate drew.
    #[error(
        "{} is an overlay, drawn by this program over a photo, or the mask: give the photo itself",
        path.display()
    )]
    OnlyOverlays {
        /// The first of them.
        path: PathBuf,
    },
    /// The file is not a picture of a known format, or is damaged.
    #[error("cannot decode {} (PNG, JPEG, BMP, GIF, TIFF and WebP are read)", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
    /// The file is not a film that can be decoded, or not to its end.
    #[error("cannot decode the film {}: {reason}", path.display())]
    Film {
        /// The file.
        path: PathBuf,
        /// Why, in the words of the program that decodes it.
        reason: String,
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
    /// A part of the picture that lies outside it, or holds no pixel.
    #[error(
        "the region of {} by {} px from ({}, {}) must hold pixels and lie in the picture of {width} by {height} px",
        region.width, region.height, region.left, region.top
    )]
    BadRegion {
        /// The part.
        region: PixelRegion,
        /// Pixels along x of the picture.
        width: u64,
        /// Pixels along y.
        height: u64,
    },
    /// A mask that does not fit the picture, or leaves nothing of it.
    #[error(
        "the mask of {} by {} px must have the size of the picture, {} by {} px, and white places to look at",
        mask[0], mask[1], picture[0], picture[1]
    )]
    BadMask {
        /// Pixels of the mask along x and y.
        mask: [usize; 2],
        /// Pixels of the picture along x and y.
        picture: [usize; 2],
    },
    /// Two places that tell no horizontal.
    #[error(
        "the two places are {length:.0} px apart: a plumb line runs down and a level across within 45 degrees, over at least \
         {least} px"
    )]
    BadMark {
        /// Their distance, px.
        length: f64,
        /// Least distance, px.
        least: f64,
    },
    /// A surface that was given and cannot be one.
    #[error("the surface given cannot be measured: {what}")]
    BadSurface {
        /// Why not.
        what: &'static str,
    },
    /// Corners that span no square seen in perspective.
    #[error(
        "the corners must be finite and span a convex area, in the order upper left, upper \
         right, lower right, lower left"
    )]
    BadCorners,
}
