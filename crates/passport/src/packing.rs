//! The two cases with many spheres in a slice: a bed under tilted gravity, and the collapse of a column into a heap.

use crate::Error;
use crate::model::Model;
use crate::reference::steps;
use crate::solver::{interactions, plane, templates};
use dem_solver::{Placement, Settings, Wall, World};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;
use std::f64::consts::PI;

/// Steps of the duration of the hardest impact.
const STEPS_PER_IMPACT: f64 = 25.0;
/// Duration over `sqrt(R / g)`.
const DURATION: f64 = 60.0;
/// Length and width of the slice, radii.
pub(crate) const SLICE: [f64; 2] = [24.0, 4.4];
/// Tilt of gravity over the bed, rad.
const TILT: f64 = 20.0 * PI / 180.0;
/// Distance from the back wall beyond which a sphere counts as being there, radii: spheres that roll away would decide the mean.
pub(crate) const FARTHEST: f64 = 40.0;
/// Highest fall, radii.
const FALL: f64 = 30.0;

/// A case with many spheres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packing {
    /// 200 spheres fall into a slice under tilted gravity.
    Bed,
    /// A column of 300 spheres in a slice collapses from a wall.
    Heap,
}

/// Names of the numbers to report; both are lengths, m.
pub(crate) const QUANTITIES: [&str; 2] = ["mean_x_at_t1", "mean_y_at_t1"];

impl Packing {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Bed, Self::Heap];

    /// Name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bed => "bed",
            Self::Heap => "heap",
        }
    }

    /// Gravity, m/s².
    pub fn gravity(self, model: &Model) -> Vector3<f64> {
        let tilt: f64 = match self {
            Self::Bed => TILT,
            Self::Heap => 0.0,
        };
        Vector3::new(tilt.sin(), -tilt.cos(), 0.0) * model.gravity_m_s2
    }

    /// Planes: a point (m) and the normal towards the spheres.
    pub fn planes(self, model: &Model) -> Vec<[Vector3<f64>; 2]> {
        let [length, width] = SLICE.map(|l| l * model.radius_m);
        let mut planes = vec![
            [Vector3::zeros(), Vector3::y()],
            [Vector3::zeros(), Vector3::x()],
            [Vector3::zeros(), Vector3::z()],
            [Vector3::z() * width, -Vector3::z()],
        ];
        if self == Self::Bed {
            planes.push([Vector3::x() * length, -Vector3::x()]);
        }
        planes
    }

    /// Centres of the spheres at the start (m), for a seed number.
    pub fn starts(self, model: &Model, seed: u64) -> Vec<Vector3<f64>> {
        let [nx, ny, nz] = match self {
            Self::Bed => [10, 10, 2],
            Self::Heap => [10, 15, 2],
        };
        let (spacing, origin) = (2.12, 1.1);
        let mut stream = Stream::new(seed, self.name());
        let mut centres = Vec::new();
        for iy in 0..ny {
            for ix in 0..nx {
                for iz in 0..nz {
                    let cell = [ix, iy, iz].map(f64::from);
                    let place = Vector3::from_fn(|axis, _| {
                        origin + spacing * cell[axis] + stream.between(-0.04, 0.04)
                    });
                    centres.push(place * model.radius_m);
                }
            }
        }
        centres
    }

    /// Time step and duration, s.
    pub fn times(self, model: &Model) -> [f64; 2] {
        let speed = (2.0 * FALL * model.gravity_m_s2 * model.radius_m).sqrt();
        let duration = DURATION * (model.radius_m / model.gravity_m_s2).sqrt();
        [model.contact_time(speed) / STEPS_PER_IMPACT, duration]
    }

    /// The numbers of a packing by the centres of its spheres at the end (m).
    pub fn read(model: &Model, centres: &[Vector3<f64>]) -> [f64; 2] {
        let farthest = FARTHEST * model.radius_m;
        let mean = |of: &dyn Fn(&Vector3<f64>) -> f64| {
            centres.iter().map(of).sum::<f64>() / centres.len() as f64
        };
        [mean(&|c| c.x.min(farthest)), mean(&|c| c.y)]
    }

    /// The numbers of a run with the solver.
    ///
    /// # Errors
    ///
    /// A run that breaks off.
    pub fn run(self, model: &Model, seed: u64) -> Result<[f64; 2], Error> {
        let [(sphere, _), _] = templates(model)?;
        let starts: Vec<Placement> = self
            .starts(model, seed)
            .into_iter()
            .map(|centre| Placement::at_rest(0, centre, UnitQuaternion::identity()))
            .collect();
        let [time_step, duration] = self.times(model);
        let settings = Settings::for_templates(
            time_step,
            self.gravity(model),
            std::slice::from_ref(&sphere),
        );
        let walls: Vec<Wall> = self
            .planes(model)
            .into_iter()
            .map(|[point, normal]| plane(point, normal))
            .collect();
        let mut world = World::new(settings, vec![sphere], interactions(model)?, walls, &starts)?;
        for _ in 0..steps(duration, time_step) {
            world.step()?;
        }
        Ok(Self::read(model, &world.bodies().position))
    }
}
