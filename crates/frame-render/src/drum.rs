//! The drum through its end cover, and bodies on a floor from the side.

use image::{Rgb, RgbImage};
use nalgebra::Vector3;

use crate::coat::{Coat, Faces, check_triangles};
use crate::colour::{BACKGROUND_COLOUR, OUTSIDE_COLOUR, RIM_COLOUR, WALL_COLOUR, mixed, shaded};
use crate::depth_buffer::{DepthBuffer, Footprint, Hit};
use crate::drum_view::{DrumProjection, DrumView};
use crate::segments::draw_segments;
use crate::sphere::check_spheres;
use crate::{Error, RenderSphere};

/// Brightness of a face seen edge-on, relative to one that faces the camera.
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
    render_drum_with_walls(spheres, &[], view)
}

/// [`render_drum`] with walls of triangles (three corners each, m), in blue with the same light. A face on edge is a line.
///
/// # Errors
/// [`Error`] for a view, a sphere or a triangle with an invalid value.
pub fn render_drum_with_walls(
    spheres: &[RenderSphere],
    walls: &[[[f64; 3]; 3]],
    view: &DrumView,
) -> Result<RgbImage, Error> {
    let projection = view.projection()?;
    draw(spheres, walls, view, empty_drum(view, &projection))
}

/// Bodies on a floor, seen from the side along -z by parallel rays: x to the right, y up, a square picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideView {
    /// Point in the middle of the picture, m.
    pub centre: [f64; 3],
    /// Half of the width that is seen, m.
    pub half_width: f64,
    /// Extent along z over which things get darker, m.
    pub depth: f64,
    /// Width and height of the picture, pixels.
    pub pixels: u32,
}

/// Picture of spheres and walls of triangles from the side, before a light wall, with the light of [`render_drum`].
///
/// # Errors
/// [`Error`] for a view, a sphere or a triangle with an invalid value.
pub fn render_side(
    spheres: &[RenderSphere],
    walls: &[[[f64; 3]; 3]],
    view: &SideView,
) -> Result<RgbImage, Error> {
    let camera = DrumView {
        centre: view.centre,
        margin: 0.0,
        rim: 0.0,
        ..DrumView::new(view.half_width, view.depth, view.pixels)
    };
    camera.projection()?;
    let air = RgbImage::from_pixel(view.pixels, view.pixels, Rgb(BACKGROUND_COLOUR));
    draw(spheres, walls, &camera, air)
}

/// Draws spheres and walls over a background.
fn draw(
    spheres: &[RenderSphere],
    walls: &[[[f64; 3]; 3]],
    view: &DrumView,
    mut picture: RgbImage,
) -> Result<RgbImage, Error> {
    let projection = view.projection()?;
    check_spheres(spheres)?;
    check_triangles(walls)?;
    let mut buffer = DepthBuffer::new(view.pixels);
    let footprint = |sphere: &RenderSphere| footprint_of(sphere, view, &projection);
    for (index, sphere) in (0u32..).zip(spheres) {
        buffer.add(index, &footprint(sphere));
    }
    let place = |[x, y, z]: [f64; 3]| {
        let offset = projection.offset_from_metre([x, y]);
        let near = (z - view.centre[2]) * projection.pixels_per_metre();
        Vector3::new(offset.right, -offset.down, near)
    };
    let coat = Coat::new(view.pixels, walls.iter().map(|t| t.map(place)), Faces::Both);
    for (column, row, pixel) in picture.enumerate_pixels_mut() {
        let hit = buffer.hit(column, row);
        let wall = coat.layer(column, row);
        if let Some(wall) = wall.filter(|wall| hit.is_none_or(|hit| wall.near > hit.near)) {
            let brightness = brightness(wall.normal.z, wall.near, &projection, view);
            *pixel = shaded(WALL_COLOUR, brightness);
        } else if let Some(hit) = hit
            && let Some(sphere) = spheres.get(hit.index)
        {
            *pixel = seed_pixel(sphere, &footprint(sphere), hit, &projection, view);
        }
    }
    draw_segments(&mut picture, view, &on_edge(walls), WALL_COLOUR)?;
    Ok(picture)
}

/// The faces of walls that the camera sees on edge, as lines.
fn on_edge(walls: &[[[f64; 3]; 3]]) -> Vec<[[f64; 2]; 2]> {
    let mut lines = Vec::new();
    for corners in walls {
        let [a, b, c] = corners.map(Vector3::from);
        let normal = (b - a).cross(&(c - a));
        if normal.z.abs() <= 1e-6 * normal.norm() {
            let ends = [[a, b], [b, c], [c, a]];
            lines.extend(ends.map(|pair| pair.map(|end| [end.x, end.y])));
        }
    }
    lines
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
    shaded(
        sphere.colour,
        brightness(normal, hit.near, projection, view),
    )
}

/// Brightness of a face by the component of its normal toward the camera and its distance toward it, pixels.
fn brightness(normal: f64, near: f64, projection: &DrumProjection, view: &DrumView) -> f64 {
    let width = view.width * projection.pixels_per_metre();
    let forward = (near / width + 0.5).clamp(0.0, 1.0);
    let facing = EDGE_BRIGHTNESS + (1.0 - EDGE_BRIGHTNESS) * normal;
    let depth = BACK_BRIGHTNESS + (1.0 - BACK_BRIGHTNESS) * forward;
    facing * depth
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
