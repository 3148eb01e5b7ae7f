//! Walls of triangles, which may move as a rigid whole.
//!
//! A wall is a list of triangles with two faces. Its motion is prescribed: a velocity, a spin about
//! a point that moves along, and a vibration. The forces of the bodies do not change it.

use crate::error::Error;
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use trimesh::nearest_on_triangle;

/// A wall made of triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshWall {
    /// Name for messages and reports.
    pub name: String,
    /// Corners of each triangle at the start, m.
    pub triangles: Vec<[Vector3<f64>; 3]>,
    /// Index of the material in the world's table.
    pub material: usize,
    /// How it moves from the start on.
    pub motion: Motion,
}

/// Prescribed motion of a rigid wall.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Motion {
    /// Velocity of the centre of rotation, m/s.
    pub velocity: Vector3<f64>,
    /// Angular velocity, rad/s.
    pub spin: Vector3<f64>,
    /// Centre of rotation at the start, m. It moves along with the velocity.
    pub about: Vector3<f64>,
    /// Vibration on top of the motion.
    pub vibration: Option<Vibration>,
}

/// A harmonic displacement `amplitude sin(angular_frequency t)`, t from the start of the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Vibration {
    /// Amplitude, m.
    pub amplitude: Vector3<f64>,
    /// Angular frequency, rad/s.
    pub angular_frequency: f64,
}

impl Vibration {
    /// Velocity at a time (s), m/s.
    fn velocity(&self, time: f64) -> Vector3<f64> {
        let phase = self.angular_frequency * time;
        self.amplitude * (self.angular_frequency * phase.cos())
    }

    /// Displacement at a time (s), m.
    fn displacement(&self, time: f64) -> Vector3<f64> {
        self.amplitude * (self.angular_frequency * time).sin()
    }
}

/// Ball about a triangle at the start.
#[derive(Debug, Clone, Copy)]
struct Ball {
    /// Centre, m.
    centre: Vector3<f64>,
    /// Radius, m.
    radius: f64,
}

/// Where a wall is on its way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Path {
    /// The motion of now.
    motion: Motion,
    /// Way of the centre of rotation without the vibration, m.
    shift: Vector3<f64>,
    /// Displacement of the vibration, m.
    swing: Vector3<f64>,
    /// Velocity of the vibration, m/s.
    swing_velocity: Vector3<f64>,
    /// Turn since the start.
    turn: UnitQuaternion<f64>,
    /// Force of the last step, N.
    force: Vector3<f64>,
    /// Torque of the last step about the centre of rotation, N m.
    torque: Vector3<f64>,
}

/// A wall on its way.
#[derive(Debug, Clone)]
pub(crate) struct Moving {
    /// The wall as it was given, with the motion of now.
    pub(crate) wall: MeshWall,
    /// Balls about the triangles.
    balls: Vec<Ball>,
    /// Largest distance of a corner from the centre of rotation, m.
    extent: f64,
    /// Way of the centre of rotation without the vibration, m.
    shift: Vector3<f64>,
    /// Displacement of the vibration, m.
    swing: Vector3<f64>,
    /// Velocity of the vibration, m/s.
    swing_velocity: Vector3<f64>,
    /// Turn since the start.
    turn: UnitQuaternion<f64>,
    /// Upper bound of the way of any corner since the last search, m.
    pub(crate) travel: f64,
    /// Force of the last step, N.
    pub(crate) force: Vector3<f64>,
    /// Torque of the last step about the centre of rotation, N m.
    pub(crate) torque: Vector3<f64>,
}

impl Moving {
    /// Checks a wall and puts it at its start.
    pub(crate) fn new(wall: MeshWall) -> Result<Self, Error> {
        let broken = |rule| {
            Err(Error::Shape {
                wall: wall.name.clone(),
                rule,
            })
        };
        let motion = &wall.motion;
        if wall.triangles.is_empty() {
            return broken("it must have at least one triangle");
        }
        let finite = |v: &Vector3<f64>| v.iter().all(|c| c.is_finite());
        if !wall.triangles.iter().flatten().all(finite) {
            return broken("every corner must be finite");
        }
        if !motion.is_finite() {
            return broken("its motion must be finite");
        }
        if wall.triangles.iter().any(|[a, b, c]| {
            let longest = (b - a).norm().max((c - a).norm());
            (b - a).cross(&(c - a)).norm() <= 1e-12 * longest * longest
        }) {
            return broken("no triangle may be a line or a point");
        }
        let balls = wall.triangles.iter().map(|corners| {
            let centre = corners.iter().sum::<Vector3<f64>>() / 3.0;
            let radius = corners.iter().map(|c| (c - centre).norm());
            Ball {
                centre,
                radius: radius.fold(0.0, f64::max),
            }
        });
        let corners = wall.triangles.iter().flatten();
        let extent = corners.map(|c| (c - motion.about).norm());
        Ok(Self {
            balls: balls.collect(),
            extent: extent.fold(0.0, f64::max),
            shift: Vector3::zeros(),
            swing: Vector3::zeros(),
            swing_velocity: motion
                .vibration
                .map_or_else(Vector3::zeros, |v| v.velocity(0.0)),
            turn: UnitQuaternion::identity(),
            travel: 0.0,
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
            wall,
        })
    }

    /// Where the wall is.
    pub(crate) fn path(&self) -> Path {
        Path {
            motion: self.wall.motion,
            shift: self.shift,
            swing: self.swing,
            swing_velocity: self.swing_velocity,
            turn: self.turn,
            force: self.force,
            torque: self.torque,
        }
    }

    /// Puts the wall where it was.
    pub(crate) fn put(&mut self, path: &Path) {
        self.wall.motion = path.motion;
        self.shift = path.shift;
        self.swing = path.swing;
        self.swing_velocity = path.swing_velocity;
        self.turn = path.turn;
        (self.force, self.torque) = (path.force, path.torque);
    }

    /// Centre of rotation now, m.
    pub(crate) fn pivot(&self) -> Vector3<f64> {
        self.wall.motion.about + self.shift + self.swing
    }

    /// A point of the world in the frame in which the triangles were given.
    pub(crate) fn own_point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.turn.inverse_transform_vector(&(point - self.pivot())) + self.wall.motion.about
    }

    /// A direction of the frame of the triangles in the world.
    pub(crate) fn direction(&self, own: &Vector3<f64>) -> Vector3<f64> {
        self.turn.transform_vector(own)
    }

    /// Velocity of the surface at a point of the world (m), m/s.
    pub(crate) fn velocity_at(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let motion = &self.wall.motion;
        motion.velocity + self.swing_velocity + motion.spin.cross(&(point - self.pivot()))
    }

    /// Triangles within a distance (m) of a point of the frame of the triangles.
    pub(crate) fn near<'a>(
        &'a self,
        own: &'a Vector3<f64>,
        distance: f64,
    ) -> impl Iterator<Item = u32> + 'a {
        let triangles = self.balls.iter().zip(&self.wall.triangles);
        let is_near = move |ball: &Ball, corners: &[Vector3<f64>; 3]| {
            (ball.centre - own).norm() < ball.radius + distance
                && (nearest_on_triangle(own, corners) - own).norm() < distance
        };
        (0_u32..)
            .zip(triangles)
            .filter(move |(_, (ball, corners))| is_near(ball, corners))
            .map(|(index, _)| index)
    }

    /// Corners of a triangle now, m.
    pub(crate) fn corners_now(&self, triangle: usize) -> [Vector3<f64>; 3] {
        self.wall.triangles[triangle]
            .map(|c| self.turn.transform_vector(&(c - self.wall.motion.about)) + self.pivot())
    }

    /// Moves the wall by a step (s) that ends at a time (s).
    pub(crate) fn advance(&mut self, time_step: f64, time: f64) {
        let motion = &self.wall.motion;
        let before = self.swing;
        if let Some(vibration) = &motion.vibration {
            self.swing = vibration.displacement(time);
            self.swing_velocity = vibration.velocity(time);
        }
        self.shift += motion.velocity * time_step;
        if motion.spin != Vector3::zeros() {
            let turn = UnitQuaternion::from_scaled_axis(motion.spin * time_step);
            self.turn = turn * self.turn;
            self.turn.renormalize();
        }
        let way = motion.velocity.norm() + motion.spin.norm() * self.extent;
        self.travel += way * time_step + (self.swing - before).norm();
    }
}

impl Motion {
    /// Whether all numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let vibration = self
            .vibration
            .map_or(0.0, |v| v.amplitude.sum() + v.angular_frequency);
        (self.velocity.sum() + self.spin.sum() + self.about.sum() + vibration).is_finite()
    }
}
