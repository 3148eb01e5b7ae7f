//! A frame: where the seeds are at one moment, what the camera sees, and what it reads.

use crate::{DrumCamera, Error, Scene, SeedBody};
use dem_solver::MeshPose;
use image::RgbImage;
use nalgebra::{UnitQuaternion, Vector3};
use photo_profile::{NoShift, PhotoReading};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use surface_profile::SurfaceAngle;

/// Poses of all seeds at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Where each wall of triangles stands, in the order of [`crate::walls_in_frame`]; empty if it is not known, as in a frame
    /// of another code.
    #[serde(default)]
    pub walls: Vec<MeshPose>,
}

/// Readings of a frame, by its picture and by the positions of its spheres.
#[derive(Debug, Clone)]
pub struct FrameReading {
    /// Reading of the picture.
    pub photo: PhotoReading,
    /// Reading of the positions of the spheres, the cross-check; `None` if it was refused.
    pub position: Option<SurfaceAngle>,
    /// Speed of the surface by this picture and one taken a little later, downhill positive, m/s, or why it cannot be read;
    /// `None` without a second picture.
    pub surface_speed: Option<Result<f64, NoShift>>,
}

impl Frame {
    /// Whether the frame is whole and of seeds of these kinds.
    pub(crate) fn is_of(&self, kinds: &[usize]) -> bool {
        let n = kinds.len();
        self.kind == kinds
            && [self.position.len(), self.velocity.len(), self.spin.len()] == [n; 3]
            && self.orientation.len() == n
    }

    /// The frame a little later (s), each seed going on with the velocity and the spin that it has. In 5 ms gravity alone would
    /// add 0.12 mm to the way of a seed.
    #[must_use]
    pub fn after(&self, time: f64) -> Self {
        let moved = |(p, v): (&Vector3<f64>, &Vector3<f64>)| p + time * v;
        let turned = |(q, w): (&UnitQuaternion<f64>, &Vector3<f64>)| {
            UnitQuaternion::from_scaled_axis(time * w) * q
        };
        Self {
            time: self.time + time,
            position: self
                .position
                .iter()
                .zip(&self.velocity)
                .map(moved)
                .collect(),
            orientation: self
                .orientation
                .iter()
                .zip(&self.spin)
                .map(turned)
                .collect(),
            ..self.clone()
        }
    }

    /// All spheres that can be seen, with the number of their seed.
    pub(crate) fn spheres<'a>(
        &'a self,
        bodies: &'a [Arc<SeedBody>],
    ) -> impl Iterator<Item = (usize, geometry::clump::Sphere)> + 'a {
        (0..self.position.len()).flat_map(move |i| {
            let (position, turn) = (self.position[i], self.orientation[i]);
            bodies[self.kind[i]].outer.spheres().iter().map(move |s| {
                let centre = position + turn * s.centre;
                (
                    i,
                    geometry::clump::Sphere {
                        centre,
                        radius: s.radius,
                    },
                )
            })
        })
    }
}

/// Picture by the camera of a scene.
///
/// # Errors
///
/// A view that cannot be drawn.
pub fn drum_picture(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frame: &Frame,
) -> Result<RgbImage, Error> {
    DrumCamera::of(scene).picture(frame.spheres(bodies))
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
    let camera = DrumCamera::of(scene);
    let spheres: Vec<_> = frame.spheres(bodies).collect();
    let Some(interval) = scene.camera.pair_interval.map(input::quantity::Time::si) else {
        return camera.read(&spheres);
    };
    let later = frame.after(interval);
    let later: Vec<_> = later.spheres(bodies).collect();
    camera.read_pair(&spheres, &later, interval)
}

#[cfg(test)]
mod tests {
    use super::{Frame, drum_picture, read_frame};
    use crate::{FillingLibrary, Override, Scene, SeedBody};
    use dev_support::fixture_files::fixture;
    use image::DynamicImage;
    use nalgebra::{UnitQuaternion, Vector3};
    use photo_profile::{PhotoPixels, measure_photo};

    use std::sync::Arc;

    /// The study's drum with a camera at 92 mm, twice its width, and seeds of few spheres.
    fn scene() -> Scene {
        let file = fixture("cotton/drum.toml");
        let set = |name: &str, value: &str| Override {
            name: name.into(),
            value: value.into(),
        };
        let changes = [
            set("seed.0.filling.sphere_count", "20"),
            set("seed.0.filling.sphere_radius", "0.8 mm"),
            set("camera.pixels", "1400"),
        ];
        let mut scene = Scene::read(&file, &changes).unwrap();
        scene.camera.distance = Some(input::quantity::Length::parse("92 mm").unwrap());
        scene
    }

    /// A bed below a line at 31 degrees in a picture of 480 px, seen from far away.
    fn tilted_bed() -> (Scene, Arc<SeedBody>, Frame) {
        let mut scene = scene();
        scene.camera.distance = None;
        scene.camera.pixels = 480;
        let body = FillingLibrary::default()
            .body(&scene, &scene.seed[0])
            .unwrap();
        let mut places = Vec::new();
        for i in -16..=16 {
            for j in -16..=16 {
                let (x, y) = (0.004 * f64::from(i), 0.004 * f64::from(j));
                if y < 0.6 * x - 0.02 && x.hypot(y) < 0.0665 {
                    places.push(Vector3::new(x, y, 0.02));
                }
            }
        }
        let n = places.len();
        let frame = Frame {
            time: 0.0,
            kind: vec![0; n],
            position: places,
            orientation: vec![UnitQuaternion::identity(); n],
            velocity: vec![Vector3::zeros(); n],
            spin: vec![Vector3::zeros(); n],
            walls: Vec::new(),
        };
        (scene, body, frame)
    }

    /// The circle that the reader finds in a picture of a tilted bed is the drum's: 222.2 px about 239.5 in a picture of 480 px
    /// with 8 % beside the drum, to 0.2 px. The rim has the tone of the seeds, so that its inner edge shows along the air
    /// only; a circle that followed the outer one along the bed would be 1 % too large and 2 px off.
    #[test]
    fn the_drum_is_found_where_it_was_drawn() {
        let (scene, body, frame) = tilted_bed();
        let found = read_frame(&scene, &[body], &frame)
            .unwrap()
            .photo
            .drum()
            .unwrap();
        let radius = 240.0 / 1.08;
        for (got, expected) in [(found.cx, 239.5), (found.cy, 239.5), (found.r, radius)] {
            assert!((got - expected).abs() < 0.2, "{found:?}");
        }
    }

    /// A frame that is read as a photo, in colour, gives what the frame gave, but for the rounding of grey levels: so does
    /// the scatter of a series of them.
    #[test]
    fn a_frame_and_a_photo_of_it_read_alike() {
        let (scene, body, frame) = tilted_bed();
        let bodies = [body];
        let own = read_frame(&scene, &bodies, &frame).unwrap().photo;
        let picture = DynamicImage::from(drum_picture(&scene, &bodies, &frame).unwrap());
        let pixels = PhotoPixels::from_picture(&picture);
        let photo = measure_photo(&pixels, &photo_profile::Settings::default()).unwrap();
        let (own, photo) = (own.bed().unwrap(), photo.bed().unwrap());
        let (a, b) = (own.angle, photo.angle);
        let (c, d) = (own.bed_ends().unwrap(), photo.bed_ends().unwrap());
        for (one, other) in [(a.line, b.line), (c.toe, d.toe), (c.top, d.top)] {
            let off = (one - other).to_degrees();
            assert!(off.abs() < 0.02, "{off} deg");
        }
        let off = own.fill_level.unwrap() - photo.fill_level.unwrap();
        assert!(off.abs() < 0.001, "{off} of the drum");
        assert!((a.curvature - b.curvature).abs() < 0.002, "curvature");
        for (one, other) in a.shape.unwrap().iter().zip(b.shape.unwrap()) {
            assert!((one - other).abs() < 0.001, "shapes: {one} {other}");
        }
    }

    /// A bed whose upper 18 mm flow downhill at 0.3 m/s, in pictures 5 ms apart: the seeds go 1.5 mm, 4.8 px of a drum of 222 px. A
    /// tenth of a pixel is 2 %; seeds that come from below the edge of the layer and go behind others add as much. A bed that
    /// moves 15 mm between the pictures is not found again, and says so.
    #[test]
    fn the_speed_of_the_surface_is_that_of_its_seeds() {
        let (mut scene, body, mut frame) = tilted_bed();
        // Seeds of a lattice that lie alike look alike: 1 mm to any side, and turned.
        let mut stream = probability::random_stream::Stream::new(2, "a bed without order");
        for (place, turn) in frame.position.iter_mut().zip(&mut frame.orientation) {
            let mut random = || stream.between(-1.0, 1.0);
            *place += 0.001 * Vector3::new(random(), random(), 0.0);
            *turn =
                UnitQuaternion::from_scaled_axis(3.0 * Vector3::new(random(), random(), random()));
        }
        let downhill = -Vector3::new(1.0, 0.6, 0.0).normalize();
        let normal = Vector3::new(-0.6, 1.0, 0.0).normalize();
        let speed = |frame: &mut Frame, speed: f64| {
            for (place, velocity) in frame.position.iter().zip(&mut frame.velocity) {
                let depth = -normal.dot(&(place - Vector3::new(0.0, -0.02, 0.0)));
                let share = if depth < 0.018 { 1.0 } else { 0.0 };
                *velocity = share * speed * downhill;
            }
        };
        let bodies = [body];
        let told =
            |scene: &Scene, frame: &Frame| read_frame(scene, &bodies, frame).unwrap().surface_speed;
        speed(&mut frame, 0.3);
        assert!(told(&scene, &frame).is_none(), "no pair, no speed");
        scene.camera.pair_interval = Some(input::quantity::Time::parse("5 ms").unwrap());
        let found = told(&scene, &frame).unwrap().unwrap();
        assert!((found / 0.3 - 1.0).abs() < 0.05, "{found} m/s");
        speed(&mut frame, 3.0);
        let lost = told(&scene, &frame).unwrap().unwrap_err();
        assert!(lost.to_string().contains("closer together"), "{lost}");
    }

    /// The lowest row of a seed at 5 cm below the axis: moved from the front cover to the back cover it
    /// is seen at two thirds of its distance from the middle. One pixel is 0.4 % of that distance.
    #[test]
    fn a_seed_at_the_back_is_drawn_towards_the_axis() {
        let scene = scene();
        let body = FillingLibrary::default()
            .body(&scene, &scene.seed[0])
            .unwrap();
        let lowest = |z: f64| {
            let frame = Frame {
                time: 0.0,
                kind: vec![0],
                position: vec![Vector3::new(0.0, -0.05, z)],
                orientation: vec![UnitQuaternion::identity()],
                velocity: vec![Vector3::zeros()],
                spin: vec![Vector3::zeros()],
                walls: Vec::new(),
            };
            let picture = drum_picture(&scene, std::slice::from_ref(&body), &frame).unwrap();
            let column = picture.width() / 2;
            let dark = (0..1300).filter(|row| picture.get_pixel(column, *row).0[1] < 150);
            f64::from(dark.max().unwrap()) - 699.5
        };
        let ratio = lowest(-0.023) / lowest(0.023);
        assert!((ratio - 2.0 / 3.0).abs() < 0.008, "{ratio}");
    }
}
