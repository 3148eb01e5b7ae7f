//! A camera that looks along the axis of a drum: what it sees of spheres, and what is read from that.

use crate::{Error, FrameReading, Scene};
use frame_render::{DrumView, RenderSphere, render_drum_with_walls, seed_colour};
use geometry::clump::Sphere;
use image::{DynamicImage, RgbImage};
use photo_profile::{PhotoPixels, measure_photo, surface_shift};
use surface_profile::{DensitySettings, Disc, DrumCircle, measure, profile_from_discs};

/// A drum and the camera in front of it. The drum is where CONVENTIONS.md has it: axis z, y up, middle at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrumCamera {
    /// Inner radius of the drum, m.
    pub radius: f64,
    /// Width between the covers, m.
    pub width: f64,
    /// Edge of the square picture, px.
    pub pixels: u32,
    /// Angle by which the camera is rolled, counter-clockwise positive, rad.
    pub roll: f64,
    /// Distance from the front cover, m; parallel rays if omitted.
    pub distance: Option<f64>,
    /// Largest standard error of the angle from one picture, rad.
    pub max_angle_error: f64,
}

impl DrumCamera {
    /// The camera of a scene and its drum.
    pub fn of(scene: &Scene) -> Self {
        Self {
            radius: scene.apparatus.radius(),
            width: scene.apparatus.width(),
            pixels: scene.camera.pixels,
            roll: scene.camera.roll.si(),
            distance: scene.camera.distance.map(input::quantity::Length::si),
            max_angle_error: scene
                .camera
                .max_angle_error
                .map_or(photo_profile::MAX_ANGLE_ERROR, input::quantity::Angle::si),
        }
    }

    /// The drum as a circle about the origin, m.
    pub fn circle(&self) -> DrumCircle {
        DrumCircle {
            x: 0.0,
            y: 0.0,
            radius: self.radius,
        }
    }

    /// Picture of spheres (m), each with the number of its body, which gives its colour.
    ///
    /// # Errors
    ///
    /// A view that cannot be drawn.
    pub fn picture(
        &self,
        spheres: impl IntoIterator<Item = (usize, Sphere)>,
    ) -> Result<RgbImage, Error> {
        self.picture_with_walls(spheres, &[])
    }

    /// The same with walls of triangles (three corners each, m).
    ///
    /// # Errors
    ///
    /// A view that cannot be drawn.
    pub(crate) fn picture_with_walls(
        &self,
        spheres: impl IntoIterator<Item = (usize, Sphere)>,
        walls: &[[[f64; 3]; 3]],
    ) -> Result<RgbImage, Error> {
        let view = DrumView {
            roll: self.roll,
            ..DrumView::new(self.radius, self.width, self.pixels)
        };
        let seen = spheres.into_iter().map(|(body, s)| {
            let size = self.apparent_size(s.centre.z);
            RenderSphere {
                centre: [size * s.centre.x, size * s.centre.y, s.centre.z],
                radius: size * s.radius,
                colour: seed_colour(body),
            }
        });
        let corner = |[x, y, z]: [f64; 3]| {
            let size = self.apparent_size(z);
            [size * x, size * y, z]
        };
        let walls: Vec<_> = walls.iter().map(|t| t.map(corner)).collect();
        let spheres: Vec<_> = seen.collect();
        Ok(render_drum_with_walls(&spheres, &walls, &view)?)
    }

    /// Reads the surface of spheres from their picture, and from their positions as a cross-check.
    ///
    /// The picture goes through the code that measures photos, and that code finds the drum in it.
    ///
    /// # Errors
    ///
    /// A picture that cannot be drawn or measured at all; a refusal is part of the reading.
    pub fn read(&self, spheres: &[(usize, Sphere)]) -> Result<FrameReading, Error> {
        self.read_seen(&self.seen(spheres)?, spheres)
    }

    /// Reads spheres as [`Self::read`] does, and the speed of their surface from a second picture of where they are later (s).
    ///
    /// # Errors
    ///
    /// As [`Self::read`].
    pub fn read_pair(
        &self,
        spheres: &[(usize, Sphere)],
        later: &[(usize, Sphere)],
        interval: f64,
    ) -> Result<FrameReading, Error> {
        let (first, second) = (self.seen(spheres)?, self.seen(later)?);
        let reading = self.read_seen(&first, spheres)?;
        let shift = surface_shift(&first, &second, &reading.photo);
        let speed = shift.map(|found| found.shift * self.radius / interval);
        Ok(FrameReading {
            surface_speed: Some(speed),
            ..reading
        })
    }

    /// The grey levels that the camera sees of spheres.
    fn seen(&self, spheres: &[(usize, Sphere)]) -> Result<PhotoPixels, Error> {
        let drawn = self.picture(spheres.iter().copied())?;
        Ok(PhotoPixels::from_picture(&DynamicImage::from(drawn)))
    }

    /// Reads a picture of spheres, and their positions.
    fn read_seen(
        &self,
        picture: &PhotoPixels,
        spheres: &[(usize, Sphere)],
    ) -> Result<FrameReading, Error> {
        let settings = photo_profile::Settings {
            max_angle_error: self.max_angle_error,
            ..photo_profile::Settings::default()
        };
        let photo = measure_photo(picture, &settings)?;
        let drum = self.circle();
        let discs: Vec<Disc> = spheres
            .iter()
            .map(|(_, s)| Disc {
                x: s.centre.x,
                y: s.centre.y,
                radius: s.radius,
            })
            .collect();
        let position = profile_from_discs(&discs, &drum, &DensitySettings::for_drum(&drum))
            .and_then(|points| measure(&points, &drum))
            .ok();
        Ok(FrameReading {
            photo,
            position,
            surface_speed: None,
        })
    }

    /// Size at which something at a depth z (m) is seen, over its size at the front cover.
    ///
    /// # Formula
    ///
    /// `D / (D + w/2 - z)`, with D the distance of the camera from the front cover and w the width of the
    /// drum; 1 for parallel rays. The camera looks along the axis. A sphere stays a disc: its true outline
    /// is an ellipse that is longer by about half the square of the angle from the axis.
    ///
    /// # Source
    ///
    /// Central projection `[HartleyZisserman2004, section 6.1]`.
    fn apparent_size(&self, z: f64) -> f64 {
        self.distance
            .map_or(1.0, |distance| distance / (distance + 0.5 * self.width - z))
    }
}

#[cfg(test)]
mod tests {
    use super::DrumCamera;

    /// At the back cover everything is seen at 92/(92 + 46) = 2/3, at the front cover at 1, and without
    /// a distance at 1 everywhere.
    #[test]
    fn the_back_is_seen_smaller() {
        let mut camera = DrumCamera {
            radius: 0.07,
            width: 0.046,
            pixels: 480,
            roll: 0.0,
            distance: Some(0.092),
            max_angle_error: photo_profile::MAX_ANGLE_ERROR,
        };
        assert!((camera.apparent_size(0.023) - 1.0).abs() < 1e-15);
        assert!((camera.apparent_size(-0.023) - 2.0 / 3.0).abs() < 1e-15);
        camera.distance = None;
        assert_eq!(camera.apparent_size(-0.023), 1.0);
    }
}
