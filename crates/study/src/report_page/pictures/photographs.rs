//! Pictures of filled seeds, and the frame of a run with the line that was fitted to it.

use super::{NamedPicture, plain_name};
use crate::Error;
use crate::report_page::material::{FilledSeed, RunDetails};
use frame_render::{ObjectView, RenderSphere, render_object};
use image::{DynamicImage, ImageFormat, RgbImage};
use photo_profile::{Settings, measure_image, overlay_gray};
use run_store::Record;
use std::io::Cursor;

/// Colour of the spheres, sRGB.
pub(crate) const SPHERE_COLOUR: [u8; 3] = [214, 160, 96];
/// Width of the picture of a seed, pixels.
const SEED_PIXELS: u32 = 480;

/// Name of the picture of a seed: the spheres under a half transparent mesh.
pub(crate) fn seed_picture_name(seed: &str) -> String {
    format!("seed-{}", plain_name(seed))
}

/// Each seed twice: its spheres under the half transparent mesh, and the spheres alone, which
/// stand in for the viewer.
pub(super) fn seeds(seeds: &[FilledSeed]) -> Result<Vec<NamedPicture>, Error> {
    let mut pictures = Vec::new();
    for seed in seeds {
        let spheres: Vec<RenderSphere> = seed
            .body
            .spheres
            .iter()
            .map(|s| RenderSphere {
                centre: s.centre.into(),
                radius: s.radius,
                colour: SPHERE_COLOUR,
            })
            .collect();
        let mesh = &seed.body.mesh.mesh;
        let triangles: Vec<[[f64; 3]; 3]> = (0..mesh.triangles().len())
            .map(|k| mesh.corners(k).map(Into::into))
            .collect();
        let name = seed_picture_name(&seed.name);
        let view = ObjectView::oblique(SEED_PIXELS);
        for (name, coat) in [
            (name.clone(), triangles.as_slice()),
            (format!("{name}-spheres"), &[]),
        ] {
            let wrong = |e: frame_render::Error| picture_error(&name, &e.to_string());
            let picture = render_object(&spheres, coat, &view).map_err(wrong)?;
            let bytes = png_bytes(&name, picture)?;
            pictures.push(NamedPicture::png(name, bytes));
        }
    }
    Ok(pictures)
}

/// The last frame of a run with the line that the same code fits to it again; nothing where the
/// run kept no frame.
pub(super) fn drum_frame(record: &Record) -> Result<Option<NamedPicture>, Error> {
    let name = "validation-frame";
    let Some(frame) = RunDetails::of(record).last_frame else {
        return Ok(None);
    };
    let picture = image::load_from_memory_with_format(&frame, ImageFormat::Png)
        .map_err(|e| picture_error(name, &e.to_string()))?
        .into_luma8();
    let settings = Settings::default();
    let reading =
        measure_image(&picture, &settings).map_err(|e| picture_error(name, &e.to_string()))?;
    let bytes = png_bytes(name, overlay_gray(&picture, &reading, &settings))?;
    Ok(Some(NamedPicture::png(name, bytes)))
}

/// A picture as the bytes of a PNG file.
fn png_bytes(name: &str, picture: RgbImage) -> Result<Vec<u8>, Error> {
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(picture)
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|e| picture_error(name, &e.to_string()))?;
    Ok(bytes.into_inner())
}

/// An error about a picture.
fn picture_error(name: &str, reason: &str) -> Error {
    Error::Picture {
        name: name.into(),
        reason: reason.into(),
    }
}
