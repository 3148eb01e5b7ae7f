//! Reading a picture file: size checked first, cut files refused, orientation honoured.

use crate::Error;
use crate::film::{Film, is_film};
use crate::jpeg_end::reaches_end;
use crate::pixels::to_level;
use image::codecs::gif::GifDecoder;
use image::codecs::png::PngDecoder;
use image::{AnimationDecoder as _, DynamicImage, ImageDecoder as _, ImageFormat, ImageReader};
use std::io::Cursor;
use std::path::Path;

/// Most pixels that are decoded: above any camera of today, below 1 GB of memory.
pub const MOST_PIXELS: u64 = 120_000_000;

/// Reads a PNG, JPEG, BMP, GIF, TIFF or WebP file (the first picture in it), upright as its EXIF orientation says, transparent parts on
/// white.
///
/// # Errors
/// [`Error::Read`], [`Error::Decode`], [`Error::Truncated`] and [`Error::TooLarge`].
pub fn read_photo(path: &Path) -> Result<DynamicImage, Error> {
    decode_photo(path, &read_bytes(path)?)
}

/// The pictures in a file, in order: one of a photo, many of an animation or a film.
#[derive(Debug)]
pub struct Frames {
    /// Where they come from.
    source: Source,
}

/// Where pictures come from.
#[derive(Debug)]
enum Source {
    /// Decoded already.
    Decoded {
        /// Those left.
        left: std::vec::IntoIter<DynamicImage>,
        /// Whether the file is an animation.
        several: bool,
    },
    /// Decoded one behind the other.
    Film(Film),
}

impl Frames {
    /// Whether the file may hold more than one picture.
    pub fn are_several(&self) -> bool {
        match &self.source {
            Source::Decoded { several, .. } => *several,
            Source::Film(_) => true,
        }
    }

    /// Pictures a second that a film states, 1/s; none of all else. A film in slow motion was taken at another rate.
    pub fn rate(&self) -> Option<f64> {
        match &self.source {
            Source::Decoded { .. } => None,
            Source::Film(film) => Some(film.rate),
        }
    }
}

impl Iterator for Frames {
    type Item = Result<DynamicImage, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        match &mut self.source {
            Source::Decoded { left, .. } => left.next().map(Ok),
            Source::Film(film) => film.next(),
        }
    }
}

/// Opens a file with pictures: the frames of an animated PNG or GIF, those of a film (MP4, MOV, AVI and others, by the
/// program `ffmpeg`), or the one picture of any other file.
///
/// Each frame is the whole picture as it is seen at its time.
///
/// # Errors
/// As [`read_photo`]; all frames of an animation together count against [`MOST_PIXELS`]. [`Error::Film`] where `ffmpeg` is
/// missing or fails; each picture of a film may bring it too.
pub fn read_frames(path: &Path) -> Result<Frames, Error> {
    Ok(Frames {
        source: if is_film(path) {
            Source::Film(Film::open(path)?)
        } else {
            let pictures = decoded_frames(path)?;
            Source::Decoded {
                several: pictures.len() > 1,
                left: pictures.into_iter(),
            }
        },
    })
}

/// The frames of an animation, or the one picture of any other file.
fn decoded_frames(path: &Path) -> Result<Vec<DynamicImage>, Error> {
    let bytes = read_bytes(path)?;
    let first = decode_photo(path, &bytes)?;
    let failed = |source: image::ImageError| Error::Decode {
        path: path.to_path_buf(),
        source,
    };
    let frames = match image::guess_format(&bytes).ok() {
        Some(ImageFormat::Gif) => GifDecoder::new(Cursor::new(&bytes))
            .map_err(failed)?
            .into_frames(),
        Some(ImageFormat::Png) => {
            let decoder = PngDecoder::new(Cursor::new(&bytes)).map_err(failed)?;
            if !decoder.is_apng().map_err(failed)? {
                return Ok(vec![first]);
            }
            decoder.apng().map_err(failed)?.into_frames()
        }
        _ => return Ok(vec![first]),
    };
    let each = u64::from(first.width()) * u64::from(first.height());
    let mut pictures = Vec::new();
    for frame in frames {
        // Before the next one is kept: a small file may hold any number of frames.
        let pixels = each * (pictures.len() as u64 + 1);
        if pixels > MOST_PIXELS {
            return Err(Error::TooLarge {
                path: path.to_path_buf(),
                pixels,
                most: MOST_PIXELS,
            });
        }
        let seen = frame.map_err(failed)?.into_buffer();
        let seen = on_white(DynamicImage::ImageRgba8(seen)).into_rgb8();
        // A grey frame is kept in a third of the memory.
        let grey = seen.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]);
        pictures.push(if grey {
            DynamicImage::from(seen).into_luma8().into()
        } else {
            seen.into()
        });
    }
    Ok(if pictures.is_empty() {
        vec![first]
    } else {
        pictures
    })
}

/// The bytes of a file.
fn read_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    input::file::read(path).map_err(|source| Error::Read {
        path: path.to_path_buf(),
        source,
    })
}

/// [`read_photo`] of a file whose bytes are read already; `path` is in messages.
///
/// # Errors
/// [`Error::Decode`], [`Error::Truncated`] and [`Error::TooLarge`].
pub fn decode_photo(path: &Path, bytes: &[u8]) -> Result<DynamicImage, Error> {
    let failed = |source: image::ImageError| Error::Decode {
        path: path.to_path_buf(),
        source,
    };
    let reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|source| Error::Read {
            path: path.to_path_buf(),
            source,
        })?;
    if reader.format() == Some(ImageFormat::Jpeg) && !reaches_end(bytes) {
        return Err(Error::Truncated {
            path: path.to_path_buf(),
            bytes: bytes.len(),
        });
    }
    let mut decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MOST_PIXELS {
        return Err(Error::TooLarge {
            path: path.to_path_buf(),
            pixels,
            most: MOST_PIXELS,
        });
    }
    let orientation = decoder.orientation().map_err(failed)?;
    let mut picture = DynamicImage::from_decoder(decoder).map_err(failed)?;
    picture.apply_orientation(orientation);
    Ok(on_white(picture))
}

/// A transparent picture as it is seen on white paper; what lies under transparent pixels is not
/// meant to be seen.
fn on_white(picture: DynamicImage) -> DynamicImage {
    if !picture.color().has_alpha() {
        return picture;
    }
    let mut seen = picture.into_rgba8();
    for pixel in seen.pixels_mut() {
        let [red, green, blue, alpha] = pixel.0;
        let part = f64::from(alpha) / 255.0;
        let over = |value: u8| to_level(part * f64::from(value) + (1.0 - part) * 255.0);
        pixel.0 = [over(red), over(green), over(blue), 255];
    }
    DynamicImage::ImageRgba8(seen).into_rgb8().into()
}
