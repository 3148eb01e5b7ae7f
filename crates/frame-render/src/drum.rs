//! The drum through its end cover.

use image::{Rgb, RgbImage};

use crate::colour::{BACKGROUND_COLOUR, OUTSIDE_COLOUR, RIM_COLOUR, mixed, shaded};
use crate::depth_buffer::{DepthBuffer, Footprint, Hit};
use crate::drum_view::{DrumProjection, DrumView};
use crate::sphere::check_spheres;
use crate::{Error, RenderSphere};

/// Brightness of a face seen edge-on, relative to one that looks into the camera.
const EDGE_BRIGHTNESS: f64 = 0.52;
/// Brightness at the back cover relative to the front cover.
const BACK_BRIGHTNESS: f64 = 0.78;

/// Picture of spheres in a drum, as a camera before the end cover sees it.
///
/// Dark room, thin rim, light back cover, darker spheres. The light comes from the camera.
///
/// # Formula
/// brightness = (0.52 + 0.48 n) (0.78 + 0.22 d), n the component of the surface normal toward
/// the camera, d = 0 at the back cover and 1 at the front cover. A sphere with a luma of 102 or
/// more therefore never falls below 41.
///
/// # Errors
/// [`Error`] for a view or a sphere with an invalid value.
pub fn render_drum(spheres: &[RenderSphere], view: &DrumView) -> Result<RgbImage, Error> {
    let projection = view.projection()?;
    check_spheres(spheres)?;
    let mut buffer = DepthBuffer::new(view.pixels);
    let footprint = |sphere: &RenderSphere| footprint_of(sphere, view, &projection);
    for (index, sphere) in (0u32..).zip(spheres) {
        buffer.add(index, &footprint(sphere));
    }
    let mut picture = empty_drum(view, &projection);
    for (column, row, pixel) in picture.enumerate_pixels_mut() {
        let Some(hit) = buffer.hit(column, row) else {
            continue;
        };
        if let Some(sphere) = spheres.get(hit.index) {
            *pixel = seed_pixel(sphere, &footprint(sphere), hit, &projection, view);
        }
    }
    Ok(picture)
}

/// Outline of a sphere in the picture.
fn footprint_of(sphere: &RenderSphere, view: &DrumView, projection: &DrumProjection) -> Footprint {
    let [x, y, z] = sphere.centre;
    let offset = projection.offset_from_metre([x, y]);
    let scale = projection.pixels_per_metre();
    Footprint {
        right: offset.right,
        down: offset.down,
        near: (z - view.centre[2]) * scale,
        radius: sphere.radius * scale,
    }
}

/// Colour of a pixel on a sphere.
fn seed_pixel(
    sphere: &RenderSphere,
    footprint: &Footprint,
    hit: Hit,
    projection: &DrumProjection,
    view: &DrumView,
) -> Rgb<u8> {
    let normal = ((hit.near - footprint.near) / footprint.radius).clamp(0.0, 1.0);
    let width = view.width * projection.pixels_per_metre();
    let forward = (hit.near / width + 0.5).clamp(0.0, 1.0);
    let facing = EDGE_BRIGHTNESS + (1.0 - EDGE_BRIGHTNESS) * normal;
    let depth = BACK_BRIGHTNESS + (1.0 - BACK_BRIGHTNESS) * forward;
    shaded(sphere.colour, facing * depth)
}

/// The drum without a filling; its circles are smoothed over one pixel.
fn empty_drum(view: &DrumView, projection: &DrumProjection) -> RgbImage {
    let inner = view.inner_radius * projection.pixels_per_metre();
    let outer = inner * (1.0 + view.rim);
    let middle = f64::from(view.pixels - 1) / 2.0;
    RgbImage::from_fn(view.pixels, view.pixels, |column, row| {
        let right = f64::from(column) - middle;
        let down = f64::from(row) - middle;
        let distance = (right * right + down * down).sqrt();
        let inside_outer = (outer - distance + 0.5).clamp(0.0, 1.0);
        let inside_inner = (inner - distance + 0.5).clamp(0.0, 1.0);
        let rim = mixed(OUTSIDE_COLOUR, RIM_COLOUR, inside_outer);
        mixed(rim.0, BACKGROUND_COLOUR, inside_inner)
    })
}
