//! From arguments to results.

use crate::arguments::Arguments;
use crate::page::{jpeg, page, side};
use crate::results::{ImageResult, Origin, Output, Points};
use crate::summary::Summary;
use crate::table::csv;
use anyhow::Context as _;
use command_line::{DONE, ERROR, Header, NOT_MET, file_sha256, write_new};
use image::{DynamicImage, ImageFormat};
use photo_profile::{
    PhotoPixels, PhotoReading, Settings, marked, measure_photo, overlay, picture_files,
    read_frames, rectify, skipped_files,
};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Measures all pictures and says what came out; returns the exit code.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let settings = arguments.settings();
    settings.check()?;
    let files = picture_files(&arguments.photos)?;
    try_outputs(arguments, &files)?;
    let mut images = Vec::new();
    let mut shown = Vec::new();
    for file in &files {
        arguments
            .common
            .log(|| format!("reading {}", file.display()));
        let read = match read(file) {
            Ok(read) => read,
            // One bad file among others must not cost the others.
            Err(error) if files.len() > 1 => {
                let result = ImageResult::unread(file, format!("{error:#}"), &settings);
                arguments.common.print(result.text())?;
                images.push(result);
                shown.push(None);
                continue;
            }
            Err(error) => return Err(error),
        };
        let animated = read.frames.len() > 1;
        let side = side(files.len().max(read.frames.len()));
        let several = animated || files.len() > 1;
        for (number, frame) in read.frames.into_iter().enumerate() {
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
            if arguments.html.is_some() {
                shown.push(Some(jpeg(&marked(&picture, &reading, &settings, side))?));
            }
            let origin = Origin {
                file: file.display().to_string(),
                frame: animated.then_some(number),
                sha256: read.sha256.clone(),
            };
            let mut result =
                ImageResult::new(origin, &reading, &settings, arguments.corners.is_some());
            result.points = arguments.points.then(|| Points::new(&reading));
            arguments.common.print(result.text())?;
            images.push(result);
        }
    }
    if let Some(rate) = arguments.fps {
        for (place, image) in images.iter_mut().enumerate() {
            image.time_s = Some(place as f64 / rate);
        }
    }
    report(arguments, images, &shown)
}

/// A file as it was read.
struct ReadFile {
    /// Its pictures.
    frames: Vec<DynamicImage>,
    /// SHA-256 of the file.
    sha256: String,
}

/// Reads the pictures in a file.
fn read(file: &Path) -> anyhow::Result<ReadFile> {
    Ok(ReadFile {
        frames: read_frames(file)?,
        sha256: file_sha256(file)?,
    })
}

/// Refuses overlays that are no PNG, results in the place of a picture to be read, and results that cannot be written,
/// before any work is done.
///
/// How many frames an animation has is not known here; a later overlay that exists stops the run.
fn try_outputs(arguments: &Arguments, files: &[PathBuf]) -> anyhow::Result<()> {
    if let Some(out) = &arguments.overlay {
        anyhow::ensure!(
            out.extension()
                .is_some_and(|end| end.eq_ignore_ascii_case("png")),
            "--overlay {}: the picture is written as PNG; give a name that ends in .png",
            out.display()
        );
    }
    let n_files = files.len();
    let overlays = arguments.overlay.iter().flat_map(|out| {
        let several = (1..=n_files).map(|number| numbered(out, number));
        several
            .filter(move |_| n_files > 1)
            .chain((n_files == 1).then(|| out.clone()))
    });
    let outputs: Vec<PathBuf> = overlays
        .chain(arguments.csv.clone())
        .chain(arguments.html.clone())
        .collect();
    let inputs: Vec<PathBuf> = files.iter().filter_map(|f| f.canonicalize().ok()).collect();
    for out in &outputs {
        let onto = out
            .canonicalize()
            .is_ok_and(|place| inputs.contains(&place));
        anyhow::ensure!(
            !onto,
            "{} is a picture to be read and is not replaced by results: give another name",
            out.display()
        );
    }
    arguments.common.try_outputs(&outputs)
}

/// The picture, straightened where corners are given.
fn straightened(picture: DynamicImage, arguments: &Arguments) -> anyhow::Result<DynamicImage> {
    Ok(match arguments.corners {
        Some(corners) => rectify(&picture, corners.0)?,
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

/// Writes the summary and the files that are asked for; returns the exit code. `shown` holds the pictures of the page.
fn report(
    arguments: &Arguments,
    images: Vec<ImageResult>,
    shown: &[Option<Vec<u8>>],
) -> anyhow::Result<u8> {
    let summary = Summary::new(&images, arguments.fps.map(f64::recip));
    if images.len() > 1 {
        arguments.common.print(summary.text())?;
    }
    let skipped = skipped_files(&arguments.photos)?;
    if !skipped.is_empty() {
        let names: Vec<String> = skipped.iter().map(|f| f.display().to_string()).collect();
        let line = format!(
            "skipped, as no pictures by their names: {}",
            names.join(", ")
        );
        arguments.common.print(line)?;
    }
    let single = match images.as_slice() {
        [one] => Some(one.clone()),
        _ => None,
    };
    let read = images.iter().filter(|i| i.sha256.is_some());
    let output = Output {
        header: Header::new(None::<u64>, read.map(|i| &i.file))?,
        single,
        images,
        skipped: skipped.iter().map(|f| f.display().to_string()).collect(),
        summary,
    };
    if let Some(file) = &arguments.csv {
        let text = csv(
            &output.images,
            arguments.settings().mode,
            arguments.fps.is_some(),
        );
        let bytes = table_file::bytes_for(file, &text)?;
        write_new(file, &bytes, arguments.common.overwrite())?;
    }
    if let Some(file) = &arguments.html {
        let text = page(&output, shown, arguments.settings().mode)?;
        write_new(file, text.as_bytes(), arguments.common.overwrite())?;
    }
    arguments.common.emit_json(&output)?;
    let summary = &output.summary;
    Ok(if summary.unread == output.images.len() {
        ERROR
    } else if summary.refused + summary.unread > 0 {
        NOT_MET
    } else {
        DONE
    })
}
