//! What the crate asks of an apparatus; a new one answers what differs from the defaults.

use super::{BenchTest, NamedMesh, NamedWall};
use crate::curve::CurveKind;
use crate::phases::{Plan, Seen};
use crate::{Error, ObservableValues, Scene, SeedBody};
use geometry::clump::Sphere;
use input::quantity::AngularSpeed;
use nalgebra::Vector3;
use std::sync::Arc;

/// Two planes normal to the z axis through which seeds pass, as if the apparatus went on beyond them without end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PeriodicSides {
    /// Setting that says how far they are from each other.
    pub(crate) setting: &'static str,
    /// Their z coordinates, m.
    pub(crate) z: [f64; 2],
}

impl PeriodicSides {
    /// At plus and minus half of a width, m.
    pub(crate) fn about_zero(setting: &'static str, width: f64) -> Self {
        Self {
            setting,
            z: [-0.5 * width, 0.5 * width],
        }
    }

    /// Their distance, m.
    pub(crate) fn distance(&self) -> f64 {
        self.z[1] - self.z[0]
    }
}

/// An apparatus. A device that holds a bed states [`Self::walls`] or [`Self::mesh_walls`], [`Self::room`], [`Self::has_room`]
/// and [`Self::radius`], [`Self::width`] and [`Self::bed_volume`].
pub(crate) trait Device {
    /// Names of the wall materials.
    fn materials(&self) -> Vec<&str>;

    /// Refuses invalid settings.
    fn check(&self) -> Result<(), Error>;

    /// Refuses names of walls that neither the apparatus nor the scene has.
    fn check_walls(&self, scene: &Scene) -> Result<(), Error> {
        let _ = scene;
        Ok(())
    }

    /// Names of the observables that a run can give.
    fn observables(&self) -> Vec<&str>;

    /// Analytic walls with the spins of the running drive.
    fn walls(&self) -> Vec<NamedWall> {
        Vec::new()
    }

    /// Walls of triangles with the motions of the running drive.
    fn mesh_walls(&self) -> Vec<NamedMesh> {
        Vec::new()
    }

    /// Periodic sides, normal to the z axis; `None` where walls end the apparatus.
    fn periodic_sides(&self) -> Option<PeriodicSides> {
        None
    }

    /// Region in which seeds may start: lower and upper corner, m.
    fn room(&self) -> [Vector3<f64>; 2] {
        [Vector3::zeros(); 2]
    }

    /// Region that a picture of the inside shows, m.
    fn view(&self) -> [Vector3<f64>; 2] {
        self.room()
    }

    /// Whether a ball (centre and radius, m) is clear of all walls; by default, within the region.
    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let [low, high] = self.room();
        (0..3).all(|k| centre[k] - radius > low[k] && centre[k] + radius < high[k])
    }

    /// Whether no ball of a radius (m) at these coordinates (m) can be inside.
    fn is_out_of_reach(&self, x: f64, y: f64, radius: f64) -> bool {
        let _ = (x, y, radius);
        false
    }

    /// Whether a run goes through phases; seeds may then leave the region in which they start.
    fn has_phases(&self) -> bool {
        false
    }

    /// Inner radius, half the length of a box, m.
    fn radius(&self) -> f64 {
        0.0
    }

    /// Inner width along the z axis, m.
    fn width(&self) -> f64 {
        0.0
    }

    /// Volume of which a fill level is a share, m³.
    fn bed_volume(&self) -> Option<f64> {
        None
    }

    /// Gravity of a size (m/s²), m/s².
    fn gravity(&self, size: f64) -> Vector3<f64> {
        Vector3::new(0.0, -size, 0.0)
    }

    /// Speed of the drive; `None` if nothing turns.
    fn speed(&self) -> Option<AngularSpeed> {
        None
    }

    /// Sets the speed of the drive, if there is one.
    fn set_speed(&mut self, speed: AngularSpeed) {
        let _ = speed;
    }

    /// Time in which the speed rises to its full, s; `None` if it has it at once.
    fn ramp(&self) -> Option<f64> {
        None
    }

    /// Share of the speed at a time after the start of the drive (s); `None` if it is constant.
    fn share_of_speed(&self, time: f64) -> Option<f64> {
        let _ = time;
        None
    }

    /// Side of the lower cover of a tilted drum: 1 at the front, towards the camera, -1 at the back.
    fn lower_cover(&self) -> Option<f64> {
        None
    }

    /// What is done to the bed of a scene, phase by phase; `None` if a drive turns until the bed is steady, and in a bench test.
    fn plan(&self, scene: &Scene) -> Option<Plan> {
        let _ = scene;
        None
    }

    /// Whether the seeds end as a heap on a floor, which is seen from the side.
    fn leaves_a_heap(&self) -> bool {
        false
    }

    /// Whether observables are read from the pictures of its camera.
    fn is_photographed(&self) -> bool {
        self.speed().is_some()
    }

    /// Refuses seeds that the apparatus cannot take, before the first step.
    fn check_seeds(&self, scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<(), Error> {
        let _ = (scene, bodies);
        Ok(())
    }

    /// Whether the seeds must come at a rate, and not all at once.
    fn needs_insertion_rate(&self) -> bool {
        false
    }

    /// Cylinder about the y axis in which seeds appear that must come at a rate: radius, lower and upper end, m.
    fn inlet(&self) -> Option<[f64; 3]> {
        None
    }

    /// Greatest stress of a loaded wall on the bed, Pa.
    fn greatest_stress(&self) -> f64 {
        0.0
    }

    /// Greatest speed of the walls that its phases move, if it counts for the time step, m/s.
    fn fastest_wall(&self) -> f64 {
        0.0
    }

    /// Slope, height and extent of spheres that lie there at the end; the largest seed has a bounding radius in m.
    fn read_pile(&self, spheres: &[Sphere], largest_radius: f64) -> Vec<ObservableValues> {
        let _ = (spheres, largest_radius);
        Vec::new()
    }

    /// Observables of a run in phases.
    fn observe(&self, seen: &Seen<'_>) -> Result<Vec<ObservableValues>, Error> {
        Ok(self.read_pile(&seen.spheres(), seen.largest_radius()))
    }

    /// The curve that a run in phases gives; `None` if it gives none.
    fn curve(&self) -> Option<CurveKind> {
        None
    }

    /// Rows of the curve: along which it goes, and its values.
    fn read_curve(&self, seen: &Seen<'_>) -> Vec<Vec<f64>> {
        let _ = seen;
        Vec::new()
    }

    /// Settings of a bench test; `None` if the apparatus holds a bed of seeds.
    fn bench_test(&self) -> Option<BenchTest<'_>> {
        None
    }
}
