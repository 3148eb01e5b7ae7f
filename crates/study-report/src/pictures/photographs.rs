//! Pictures of filled seeds.

use crate::{Error, ReportInput};
use frame_render::{ObjectView, RenderSphere, render_object};
use image::RgbImage;
use image::codecs::png::PngEncoder;
use scene::SeedBody;
use std::sync::Arc;

/// Colour of the spheres, sRGB.
pub(crate) const SPHERE_COLOUR: [u8; 3] = [214, 160, 96];
/// Width of the picture of a seed, pixels.
const SEED_PIXELS: u32 = 480;

/// A kind of seed as a body, once for each distinct filling.
#[derive(Debug)]
pub(crate) struct FilledSeed {
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

/// A seed under its half transparent mesh if it has one, and its spheres alone, which are shown unless the viewer runs.
pub(crate) fn seed_pictures(seed: &FilledSeed) -> Result<(Option<Vec<u8>>, Vec<u8>), Error> {
    let spheres = seed.body.spheres.iter().map(|s| RenderSphere {
        centre: s.centre.into(),
        radius: s.radius,
        colour: SPHERE_COLOUR,
    });
    let spheres: Vec<RenderSphere> = spheres.collect();
    let view = ObjectView::oblique(SEED_PIXELS);
    let draw = |coat: &[[[f64; 3]; 3]]| {
        let wrong = |e: frame_render::Error| picture_error(&seed.name, &e.to_string());
        png_bytes(
            &seed.name,
            &render_object(&spheres, coat, &view).map_err(wrong)?,
        )
    };
    let shape = seed.body.shape.as_ref();
    let under_mesh = shape.map(|shape| {
        let mesh = &shape.mesh.mesh;
        let all = 0..mesh.triangles().len();
        let triangles: Vec<_> = all.map(|k| mesh.corners(k).map(Into::into)).collect();
        draw(&triangles)
    });
    Ok((under_mesh.transpose()?, draw(&[])?))
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
