//! Pictures of filled seeds, and the last frames of the runs of the check.

use super::NamedPicture;
use super::run_charts::check_runs;
use crate::run_details::RunDetails;
use crate::{Error, ReportInput};
use frame_render::{ObjectView, RenderSphere, render_object};
use image::codecs::png::{PngDecoder, PngEncoder};
use image::{DynamicImage, RgbImage};
use photo_profile::{Settings, measure_image, overlay_gray};
use scene::{Apparatus, SeedBody};
use std::io::Cursor;
use std::sync::Arc;

/// Colour of the spheres, sRGB.
pub(crate) const SPHERE_COLOUR: [u8; 3] = [214, 160, 96];
/// Width of the picture of a seed, pixels.
const SEED_PIXELS: u32 = 480;

/// A kind of seed as a body, once for each distinct filling.
#[derive(Debug)]
pub(crate) struct FilledSeed {
    /// Name.
    pub(crate) name: String,
    /// Names of the models whose scenes hold it.
    pub(crate) models: Vec<String>,
    /// Spheres and mesh.
    pub(crate) body: Arc<SeedBody>,
}

/// The seeds of all scenes. Seeds of one name with one body are one, whatever scene they stand in.
pub(crate) fn filled_seeds(input: &ReportInput<'_>) -> Result<Vec<FilledSeed>, Error> {
    let mut seeds: Vec<FilledSeed> = Vec::new();
    for (model, scene) in input.scenes {
        for seed in &scene.seed {
            let body = input.fillings.body(scene, seed)?;
            let known = seeds
                .iter_mut()
                .find(|s| s.name == seed.name && Arc::ptr_eq(&s.body, &body));
            match known {
                Some(known) if known.models.contains(model) => {}
                Some(known) => known.models.push(model.clone()),
                None => seeds.push(FilledSeed {
                    name: seed.name.clone(),
                    models: vec![model.clone()],
                    body,
                }),
            }
        }
    }
    Ok(seeds)
}

/// Name of the picture of a seed: the spheres under a half transparent mesh.
pub(crate) fn seed_picture_name(number: usize) -> String {
    format!("seed-{}", number + 1)
}

/// Name of the picture of its spheres alone.
pub(crate) fn spheres_picture_name(number: usize) -> String {
    format!("{}-spheres", seed_picture_name(number))
}

/// Each seed twice: its spheres under the half transparent mesh, if it has one, and the spheres alone, which stand in for the viewer.
pub(crate) fn seeds(input: &ReportInput<'_>) -> Result<Vec<NamedPicture>, Error> {
    let mut pictures = Vec::new();
    for (number, seed) in filled_seeds(input)?.iter().enumerate() {
        let spheres = seed.body.spheres.iter().map(|s| RenderSphere {
            centre: s.centre.into(),
            radius: s.radius,
            colour: SPHERE_COLOUR,
        });
        let spheres: Vec<RenderSphere> = spheres.collect();
        let mut coats: Vec<(String, Vec<[[f64; 3]; 3]>)> = Vec::new();
        // Spheres that are the seed themselves stand under no mesh.
        if let Some(shape) = &seed.body.shape {
            let mesh = &shape.mesh.mesh;
            let all = 0..mesh.triangles().len();
            let triangles = all.map(|k| mesh.corners(k).map(Into::into)).collect();
            coats.push((seed_picture_name(number), triangles));
        }
        coats.push((spheres_picture_name(number), Vec::new()));
        let view = ObjectView::oblique(SEED_PIXELS);
        for (name, coat) in coats {
            let wrong = |e: frame_render::Error| picture_error(&name, &e.to_string());
            let picture = render_object(&spheres, &coat, &view).map_err(wrong)?;
            let bytes = png_bytes(&name, &picture)?;
            pictures.push(NamedPicture::png(name, bytes));
        }
    }
    Ok(pictures)
}

/// Name of the last frame of a model of the check.
pub(crate) fn frame_name(number: usize) -> String {
    format!("check-{}-frame", number + 1)
}

/// The last frame of the first run of each model of the check that kept one.
pub(crate) fn frames(input: &ReportInput<'_>) -> Result<Vec<NamedPicture>, Error> {
    let mut pictures = Vec::new();
    for (number, (model, records)) in check_runs(input).into_iter().enumerate() {
        let mut frames = records.iter().filter_map(|r| RunDetails::of(r).last_frame);
        if let Some(frame) = frames.next() {
            let name = frame_name(number);
            let bytes = if shows_drum(input, &model.name) {
                with_reading(&name, &frame)?
            } else {
                frame
            };
            pictures.push(NamedPicture::png(name, bytes));
        }
    }
    Ok(pictures)
}

/// Whether the camera of a model looks into a drum, so that the reader of drum photos reads its frames.
pub(crate) fn shows_drum(input: &ReportInput<'_>, model: &str) -> bool {
    let scene = input.scenes.get(model);
    scene.is_some_and(|scene| matches!(scene.apparatus, Apparatus::Drum(_)))
}

/// A frame with the line that the reader of photos fits to it; the frame as it is where he refuses it.
pub(super) fn with_reading(name: &str, frame: &[u8]) -> Result<Vec<u8>, Error> {
    let picture = PngDecoder::new(Cursor::new(frame))
        .and_then(DynamicImage::from_decoder)
        .map_err(|e| picture_error(name, &e.to_string()))?
        .into_luma8();
    let settings = Settings::default();
    match measure_image(&picture, &settings) {
        Ok(reading) => png_bytes(name, &overlay_gray(&picture, &reading, &settings)),
        Err(_) => Ok(frame.to_vec()),
    }
}

/// A picture as the bytes of a PNG file.
pub(super) fn png_bytes(name: &str, picture: &RgbImage) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    picture
        .write_with_encoder(PngEncoder::new(&mut bytes))
        .map_err(|e| picture_error(name, &e.to_string()))?;
    Ok(bytes)
}

/// An error about a picture.
pub(super) fn picture_error(name: &str, reason: &str) -> Error {
    Error::Picture {
        name: name.into(),
        reason: reason.into(),
    }
}
