//! A frame: where the seeds are at one moment, what the camera sees, and what it reads.

use crate::{Error, Scene, SeedBody};
use frame_render::{DrumView, RenderSphere, render_drum, seed_colour};
use image::{DynamicImage, RgbImage};
use nalgebra::{UnitQuaternion, Vector3};
use photo_profile::{PhotoReading, measure_image};
use std::sync::Arc;
use surface_profile::{
    DensitySettings, Disc, DrumCircle, SurfaceAngle, measure, profile_from_discs,
};

/// Poses of all seeds at one moment.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Time since the drive started, s.
    pub time: f64,
    /// Kind of each seed.
    pub kind: Vec<usize>,
    /// Centres of mass, m.
    pub position: Vec<Vector3<f64>>,
    /// Rotations from the principal frames.
    pub orientation: Vec<UnitQuaternion<f64>>,
    /// Velocities of the centres of mass, m/s.
    pub velocity: Vec<Vector3<f64>>,
    /// Angular velocities, rad/s.
    pub spin: Vec<Vector3<f64>>,
}

/// What a frame says, read in two ways.
#[derive(Debug, Clone)]
pub struct FrameReading {
    /// Reading of the picture.
    pub photo: PhotoReading,
    /// Reading of the positions of the spheres, the cross-check; none where it was refused.
    pub position: Option<SurfaceAngle>,
}

impl Frame {
    /// All spheres that can be seen, with the number of their seed.
    pub(crate) fn spheres<'a>(
        &'a self,
        bodies: &'a [Arc<SeedBody>],
    ) -> impl Iterator<Item = (usize, clump::Sphere)> + 'a {
        (0..self.position.len()).flat_map(move |i| {
            let (position, turn) = (self.position[i], self.orientation[i]);
            bodies[self.kind[i]].outer.spheres().iter().map(move |s| {
                let centre = position + turn * s.centre;
                (
                    i,
                    clump::Sphere {
                        centre,
                        radius: s.radius,
                    },
                )
            })
        })
    }
}

/// What the camera of a scene sees.
///
/// # Errors
///
/// A view that cannot be drawn.
pub fn drum_picture(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frame: &Frame,
) -> Result<RgbImage, Error> {
    let view = DrumView {
        roll: scene.camera.roll.si(),
        ..DrumView::new(
            scene.apparatus.radius(),
            scene.apparatus.width(),
            scene.camera.pixels,
        )
    };
    let spheres: Vec<RenderSphere> = frame
        .spheres(bodies)
        .map(|(seed, s)| RenderSphere {
            centre: s.centre.into(),
            radius: s.radius,
            colour: seed_colour(seed),
        })
        .collect();
    Ok(render_drum(&spheres, &view)?)
}

/// Reads the angle of a frame from its picture, and from the positions as a cross-check.
///
/// The picture goes through the code that measures photos, and that code finds the drum in it.
///
/// # Errors
///
/// A picture that cannot be drawn or measured at all; a refusal is part of the reading.
pub fn read_frame(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frame: &Frame,
) -> Result<FrameReading, Error> {
    let picture = DynamicImage::from(drum_picture(scene, bodies, frame)?).into_luma8();
    let photo = measure_image(&picture, &photo_profile::Settings::default())?;
    let drum = DrumCircle {
        x: 0.0,
        y: 0.0,
        radius: scene.apparatus.radius(),
    };
    let discs: Vec<Disc> = frame
        .spheres(bodies)
        .map(|(_, s)| Disc {
            x: s.centre.x,
            y: s.centre.y,
            radius: s.radius,
        })
        .collect();
    let position = profile_from_discs(&discs, &drum, &DensitySettings::for_drum(&drum))
        .and_then(|points| measure(&points, &drum))
        .ok();
    Ok(FrameReading { photo, position })
}
