//! From arguments to results.

use crate::arguments::Arguments;
use crate::inputs::files;
use crate::results::{ImageResult, Origin, Output, Summary};
use anyhow::Context as _;
use command_line::{DONE, Header, NOT_MET, file_sha256, write_new};
use image::{DynamicImage, ImageFormat};
use photo_profile::{
    PhotoPixels, PhotoReading, Settings, measure_photo, overlay, read_frames, rectify,
};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Measures all pictures and says what came out; returns the exit code.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let settings = arguments.settings();
    settings.check()?;
    let files = files(&arguments.photos)?;
    let mut images = Vec::new();
    for file in &files {
        arguments
            .common
            .log(|| format!("reading {}", file.display()));
        let frames = read_frames(file)?;
        let animated = frames.len() > 1;
        let several = animated || files.len() > 1;
        let sha256 = file_sha256(file)?;
        for (number, frame) in frames.into_iter().enumerate() {
            let picture = straightened(frame, arguments)?;
            let reading = measure_photo(&PhotoPixels::from_picture(&picture), &settings)?;
            if let Some(out) = &arguments.overlay {
                let out = if several {
                    numbered(out, images.len() + 1)
                } else {
                    out.clone()
                };
                draw(&out, &picture, &reading, arguments)?;
            }
            let origin = Origin {
                file: file.display().to_string(),
                frame: animated.then_some(number),
                sha256: sha256.clone(),
            };
            let result = ImageResult::new(origin, &reading, &settings, arguments.corners.is_some());
            arguments.common.print(result.text())?;
            images.push(result);
        }
    }
    report(arguments, &files, images)
}

/// The picture, straightened where corners are given.
fn straightened(picture: DynamicImage, arguments: &Arguments) -> anyhow::Result<DynamicImage> {
    Ok(match arguments.corners {
        Some(corners) => DynamicImage::ImageLuma8(rectify(&picture, corners.0)?),
        None => picture,
    })
}

/// Writes the overlay of one picture.
fn draw(
    out: &Path,
    picture: &DynamicImage,
    reading: &PhotoReading,
    arguments: &Arguments,
) -> anyhow::Result<()> {
    let settings: Settings = arguments.settings();
    let mut bytes = Vec::new();
    overlay(picture, reading, &settings)
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .with_context(|| format!("cannot draw {}", out.display()))?;
    write_new(out, &bytes, arguments.common.overwrite())
}

/// The name with a number before its ending: `out.png` becomes `out-003.png`.
fn numbered(out: &Path, number: usize) -> PathBuf {
    let stem = out
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    out.with_file_name(format!("{stem}-{number:03}.png"))
}

/// Writes the summary and the JSON; returns the exit code.
fn report(
    arguments: &Arguments,
    files: &[PathBuf],
    images: Vec<ImageResult>,
) -> anyhow::Result<u8> {
    let summary = Summary::new(&images);
    if images.len() > 1 {
        arguments.common.print(summary.text())?;
    }
    let single = match images.as_slice() {
        [one] => Some(one.clone()),
        _ => None,
    };
    let output = Output {
        header: Header::new(None::<u64>, files)?,
        single,
        images,
        summary,
    };
    arguments.common.emit_json(&output)?;
    Ok(if summary.refused > 0 { NOT_MET } else { DONE })
}
