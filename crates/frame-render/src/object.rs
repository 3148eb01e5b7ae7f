//! One particle from a free direction.

use image::{Rgb, RgbImage};
use nalgebra::{Matrix3, Vector3};

use crate::coat::{Coat, Faces, check_triangles};
use crate::colour::{channel_from, mixed};
use crate::depth_buffer::{DepthBuffer, Footprint};
use crate::sphere::check_spheres;
use crate::{Error, RenderSphere};

/// Samples per pixel in each direction; averaged for smooth outlines.
const SAMPLES: u32 = 3;
/// Least and largest picture, pixels.
const PIXELS: [u32; 2] = [16, 4096];
/// Background, near white.
const PAPER: [u8; 3] = [250, 250, 248];
const MESH_COLOUR: [u8; 3] = [110, 170, 225];
/// Weight of the mesh colour in front of other surfaces.
const MESH_OPACITY: f64 = 0.3;
/// Part of the picture's half width that the object may take.
const FILL: f64 = 0.92;
/// Ambient light.
const AMBIENT: f64 = 0.28;
/// Key light: right, up, toward the camera (need not be of unit length), and its strength.
const KEY_LIGHT: ([f64; 3], f64) = ([-0.5, 0.65, 0.75], 0.62);
/// Fill light from the other side, and its strength.
const FILL_LIGHT: ([f64; 3], f64) = ([0.8, -0.1, 0.45], 0.26);

/// View of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectView {
    /// From the object to the camera, in the object's frame; any length but 0.
    pub toward_camera: [f64; 3],
    /// Width and height of the picture, pixels.
    pub pixels: u32,
}

impl ObjectView {
    /// A view from the front, the right and above: all three axes can be seen.
    pub fn oblique(pixels: u32) -> Self {
        Self {
            toward_camera: [0.55, -0.8, 0.45],
            pixels,
        }
    }
}

/// Picture of an object made of spheres, with its mesh as a half transparent coat.
///
/// Parallel rays, z upward in the picture (y for a view along z), two lights, light paper. The
/// view is chosen so that everything is seen. `triangles` holds three corners each, m, wound
/// counter-clockwise from outside; triangles that face away are not drawn. Pass an empty slice
/// for spheres alone or for a mesh alone.
///
/// # Errors
/// [`Error`] for a view, a sphere or a triangle with an invalid value, and
/// [`Error::NothingToShow`] without any sphere or triangle.
pub fn render_object(
    spheres: &[RenderSphere],
    triangles: &[[[f64; 3]; 3]],
    view: &ObjectView,
) -> Result<RgbImage, Error> {
    check_spheres(spheres)?;
    check_triangles(triangles)?;
    let camera = CameraView::new(spheres, triangles, view)?;
    let mut buffer = DepthBuffer::new(camera.samples);
    let outlines: Vec<Footprint> = spheres
        .iter()
        .map(|sphere| camera.footprint(sphere))
        .collect();
    for (index, outline) in (0u32..).zip(&outlines) {
        buffer.add(index, outline);
    }
    let placed = triangles
        .iter()
        .map(|t| t.map(|corner| camera.place(corner)));
    let coat = Coat::new(camera.samples, placed, Faces::Front);
    let middle = f64::from(camera.samples - 1) / 2.0;
    let sampled = RgbImage::from_fn(camera.samples, camera.samples, |column, row| {
        let hit = buffer.hit(column, row);
        let below = hit
            .and_then(|hit| Some((hit, spheres.get(hit.index)?, outlines.get(hit.index)?)))
            .map_or(PAPER, |(hit, sphere, outline)| {
                let normal = Vector3::new(
                    f64::from(column) - middle - outline.right,
                    outline.down - (f64::from(row) - middle),
                    hit.near - outline.near,
                );
                lit(sphere.colour, &(normal / outline.radius))
            });
        match coat.layer(column, row) {
            Some(layer) if hit.is_none_or(|hit| layer.near > hit.near) => {
                mixed(below, lit(MESH_COLOUR, &layer.normal), MESH_OPACITY)
            }
            _ => Rgb(below),
        }
    });
    Ok(averaged(&sampled, view.pixels))
}

/// Colour of a surface under both lights; the normal has unit length in camera axes.
fn lit(colour: [u8; 3], normal: &Vector3<f64>) -> [u8; 3] {
    let from = |(direction, strength): ([f64; 3], f64)| {
        strength * normal.dot(&Vector3::from(direction).normalize()).max(0.0)
    };
    let brightness = AMBIENT + from(KEY_LIGHT) + from(FILL_LIGHT);
    colour.map(|channel| channel_from(f64::from(channel) * brightness))
}

/// Camera axes and scale.
#[derive(Debug)]
struct CameraView {
    /// Rows: right, up and toward the camera.
    axes: Matrix3<f64>,
    /// Point in the middle of the picture, in camera axes, m.
    middle: Vector3<f64>,
    /// Scale, samples/m.
    scale: f64,
    /// Width and height, samples.
    samples: u32,
}

impl CameraView {
    /// Chooses axes and scale so that everything is seen.
    fn new(
        spheres: &[RenderSphere],
        triangles: &[[[f64; 3]; 3]],
        view: &ObjectView,
    ) -> Result<Self, Error> {
        let [least, most] = PIXELS;
        if !(least..=most).contains(&view.pixels) {
            return Err(Error::InvalidPixels {
                pixels: view.pixels,
                least,
                most,
            });
        }
        let axes = camera_axes(view.toward_camera)?;
        let mut lower = Vector3::repeat(f64::INFINITY);
        let mut upper = Vector3::repeat(f64::NEG_INFINITY);
        let mut include = |point: [f64; 3], radius: f64| {
            let place = axes * Vector3::from(point);
            lower = lower.inf(&place.add_scalar(-radius));
            upper = upper.sup(&place.add_scalar(radius));
        };
        for sphere in spheres {
            include(sphere.centre, sphere.radius);
        }
        for corner in triangles.as_flattened() {
            include(*corner, 0.0);
        }
        let half = (upper - lower).xy().max() / 2.0;
        if !half.is_finite() || half <= 0.0 {
            return Err(Error::NothingToShow);
        }
        let samples = view.pixels * SAMPLES;
        let scale = FILL * f64::from(samples) / 2.0 / half;
        Ok(Self {
            axes,
            middle: (lower + upper) / 2.0,
            scale,
            samples,
        })
    }

    /// A point in samples to the right, up and toward the camera from the middle.
    fn place(&self, point: [f64; 3]) -> Vector3<f64> {
        (self.axes * Vector3::from(point) - self.middle) * self.scale
    }

    /// Outline of a sphere.
    fn footprint(&self, sphere: &RenderSphere) -> Footprint {
        let place = self.place(sphere.centre);
        Footprint {
            right: place.x,
            down: -place.y,
            near: place.z,
            radius: sphere.radius * self.scale,
        }
    }
}

/// Right, up and toward the camera, for a camera that keeps z (or y) upward.
fn camera_axes(toward_camera: [f64; 3]) -> Result<Matrix3<f64>, Error> {
    let toward = Vector3::from(toward_camera);
    let length = toward.norm();
    if !(length.is_finite() && length > 0.0) {
        return Err(Error::InvalidView {
            field: "toward_camera",
            value: length,
            requirement: "a direction with a finite length above 0",
        });
    }
    let toward = toward / length;
    // Within about 2.6 degrees of z the picture would spin wildly, so y is kept upward there.
    let upward = if toward.xy().norm() > 0.045 {
        Vector3::z()
    } else {
        Vector3::y()
    };
    let right = upward.cross(&toward).normalize();
    let up = toward.cross(&right);
    Ok(Matrix3::from_rows(&[
        right.transpose(),
        up.transpose(),
        toward.transpose(),
    ]))
}

/// Mean of the samples of each pixel.
fn averaged(sampled: &RgbImage, pixels: u32) -> RgbImage {
    let per_pixel = f64::from(SAMPLES * SAMPLES);
    RgbImage::from_fn(pixels, pixels, |column, row| {
        let mut sum = [0u32; 3];
        for place in 0..SAMPLES * SAMPLES {
            let sample = sampled.get_pixel(
                column * SAMPLES + place % SAMPLES,
                row * SAMPLES + place / SAMPLES,
            );
            for (total, channel) in sum.iter_mut().zip(sample.0) {
                *total += u32::from(channel);
            }
        }
        Rgb(sum.map(|total| channel_from(f64::from(total) / per_pixel)))
    })
}
