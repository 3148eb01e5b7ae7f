//! What the crate asks of an apparatus; a new one answers what differs from the defaults.

use super::{BenchTest, NamedMesh, NamedWall};
use crate::Error;
use input::quantity::AngularSpeed;
use nalgebra::Vector3;

/// An apparatus. A device that holds a bed states [`Self::walls`] or [`Self::mesh_walls`], [`Self::room`], [`Self::has_room`]
/// and [`Self::radius`], [`Self::width`] and [`Self::bed_volume`].
pub(crate) trait Device {
    /// Names of the wall materials.
    fn materials(&self) -> Vec<&str>;

    /// Refuses invalid settings.
    fn check(&self) -> Result<(), Error>;

    /// Names of the observables that a run can give.
    fn observables(&self) -> &'static [&'static str];

    /// Analytic walls with the spins of the running drive.
    fn walls(&self) -> Vec<NamedWall> {
        Vec::new()
    }

    /// Walls of triangles with the motions of the running drive.
    fn mesh_walls(&self) -> Vec<NamedMesh> {
        Vec::new()
    }

    /// Region in which seeds may start: lower and upper corner, m.
    fn room(&self) -> [Vector3<f64>; 2] {
        [Vector3::zeros(); 2]
    }

    /// Whether a ball (centre and radius, m) in this region is clear of all walls.
    fn has_room(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let _ = (centre, radius);
        false
    }

    /// Whether no ball of a radius (m) at these coordinates (m) can be inside.
    fn is_out_of_reach(&self, x: f64, y: f64, radius: f64) -> bool {
        let _ = (x, y, radius);
        false
    }

    /// Whether seeds may leave the region in which they start.
    fn is_open(&self) -> bool {
        self.releases_after().is_some()
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

    /// Time in which the wall that holds the seeds is lifted out of their way, s; `None` if no wall is lifted.
    fn releases_after(&self) -> Option<f64> {
        None
    }

    /// Settings of a bench test; `None` if the apparatus holds a bed of seeds.
    fn bench_test(&self) -> Option<BenchTest<'_>> {
        None
    }
}
