//! Walls of triangles, which may move as a rigid whole.
//!
//! A wall is a list of triangles with two faces. Its motion is prescribed: a velocity, a spin about
//! a point that moves along, and a vibration. The forces of the bodies change it only along the axis of a load.

use crate::error::Error;
use crate::triangle_tree::TriangleTree;
use geometry::triangle::nearest_on_triangle;
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

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

/// A force on a wall that is free to move along one axis, as on a piston.
///
/// # Formula
///
/// `m dv/dt = F + f - m v / T`, v at most the greatest speed: F is the load, f the force of the bodies, both along the axis.
/// At rest f = -F, whatever m and T are. A wall on n contacts of a stiffness k needs no shorter step than a body of mass m/n
/// on one of them: a mass of n bodies or more keeps the step of the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AxialLoad {
    /// Unit vector of the axis.
    pub axis: Vector3<f64>,
    /// Load along the axis, N.
    pub force: f64,
    /// Mass of the wall, kg; its weight is not added.
    pub mass: f64,
    /// Time T in which the wall loses its speed, s.
    pub damping_time: f64,
    /// Greatest speed, m/s.
    pub greatest_speed: f64,
}

impl AxialLoad {
    /// Speed along the axis after a step (s) from a speed (m/s) under a force of the bodies (N).
    fn speed_after(&self, time_step: f64, speed: f64, of_bodies: &Vector3<f64>) -> f64 {
        let force = self.force + of_bodies.dot(&self.axis);
        // The damping is taken at the end of the step: it is stable for any damping time.
        let free = speed + force / self.mass * time_step;
        let damped = free / (1.0 + time_step / self.damping_time);
        damped.clamp(-self.greatest_speed, self.greatest_speed)
    }

    /// Whether it can move a wall.
    fn is_valid(&self) -> bool {
        let positive = [self.mass, self.damping_time, self.greatest_speed];
        (self.axis.norm() - 1.0).abs() < 1e-9
            && self.force.is_finite()
            && positive.iter().all(|x| *x > 0.0 && x.is_finite())
    }
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
    /// Load that changes the velocity along its axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<AxialLoad>,
}

/// A harmonic displacement `amplitude sin(angular_frequency t)` from where the wall stands, t from the moment
/// at which the vibration is given to it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Vibration {
    /// Amplitude, m.
    pub amplitude: Vector3<f64>,
    /// Angular frequency, rad/s.
    pub angular_frequency: f64,
}

impl Vibration {
    /// Velocity at a time from its start (s), m/s.
    fn velocity(&self, time: f64) -> Vector3<f64> {
        let phase = self.angular_frequency * time;
        self.amplitude * (self.angular_frequency * phase.cos())
    }

    /// Displacement at a time from its start (s), m.
    fn displacement(&self, time: f64) -> Vector3<f64> {
        self.amplitude * (self.angular_frequency * time).sin()
    }
}

/// Where a wall of triangles stands, relative to its start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeshPose {
    /// Centre of rotation at the start, m.
    pub about: Vector3<f64>,
    /// Way of the centre of rotation, m.
    pub displacement: Vector3<f64>,
    /// Turn about the centre of rotation.
    pub turn: UnitQuaternion<f64>,
    /// Whether the wall was taken away.
    pub removed: bool,
}

impl MeshPose {
    /// Where a corner is that was at a place at the start, m.
    pub fn place(&self, start: &Vector3<f64>) -> Vector3<f64> {
        self.turn * (start - self.about) + self.about + self.displacement
    }
}

/// Where a wall is on its way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Path {
    /// The motion of now.
    motion: Motion,
    /// Way of the centre of rotation without the vibration of now, m.
    shift: Vector3<f64>,
    /// Time at which the vibration began, s.
    #[serde(default)]
    since: f64,
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
    /// Whether the wall was taken away.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    removed: bool,
}

/// A wall on its way.
#[derive(Debug, Clone)]
pub(crate) struct Moving {
    /// The wall as it was given, with the motion of now.
    pub(crate) wall: MeshWall,
    /// Which triangles are near a point.
    tree: TriangleTree,
    /// Largest distance of a corner from the centre of rotation, m.
    extent: f64,
    /// Way of the centre of rotation without the vibration of now, m.
    shift: Vector3<f64>,
    /// Time at which the vibration began, s.
    since: f64,
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
    /// Whether the wall was taken away: no body feels it any more.
    removed: bool,
}

impl Moving {
    /// Checks a wall and puts it at its start, at a time (s).
    pub(crate) fn new(wall: MeshWall, time: f64) -> Result<Self, Error> {
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
        if !motion.is_valid() {
            return broken(
                "its motion must be finite; a load has a unit axis, a positive mass, damping time and greatest speed",
            );
        }
        if wall.triangles.iter().any(|[a, b, c]| {
            let longest = (b - a).norm().max((c - a).norm());
            (b - a).cross(&(c - a)).norm() <= 1e-12 * longest * longest
        }) {
            return broken("no triangle may be a line or a point");
        }
        let corners = wall.triangles.iter().flatten();
        let extent = corners.map(|c| (c - motion.about).norm());
        Ok(Self {
            tree: TriangleTree::of(&wall.triangles),
            extent: extent.fold(0.0, f64::max),
            shift: Vector3::zeros(),
            since: time,
            swing: Vector3::zeros(),
            swing_velocity: motion.swing_velocity(0.0),
            turn: UnitQuaternion::identity(),
            travel: 0.0,
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
            removed: false,
            wall,
        })
    }

    /// Where the wall is.
    pub(crate) fn path(&self) -> Path {
        Path {
            motion: self.wall.motion,
            shift: self.shift,
            since: self.since,
            swing: self.swing,
            swing_velocity: self.swing_velocity,
            turn: self.turn,
            force: self.force,
            torque: self.torque,
            removed: self.removed,
        }
    }

    /// Puts the wall where it was.
    pub(crate) fn put(&mut self, path: &Path) {
        self.wall.motion = path.motion;
        (self.shift, self.since) = (path.shift, path.since);
        self.swing = path.swing;
        self.swing_velocity = path.swing_velocity;
        self.turn = path.turn;
        (self.force, self.torque) = (path.force, path.torque);
        self.removed = path.removed;
    }

    /// Takes the wall away.
    pub(crate) fn remove(&mut self) {
        self.removed = true;
    }

    /// Displacement of the centre of rotation since the start, m.
    pub(crate) fn displacement(&self) -> Vector3<f64> {
        self.shift + self.swing
    }

    /// Where it stands now.
    pub(crate) fn pose(&self) -> MeshPose {
        MeshPose {
            about: self.wall.motion.about,
            displacement: self.displacement(),
            turn: self.turn,
            removed: self.removed,
        }
    }

    /// Changes velocity, spin and vibration at a time (s); the centre of rotation stays. Another vibration begins
    /// where the wall stands, and a wall whose vibration ends stays there.
    pub(crate) fn set_motion(&mut self, motion: &Motion, time: f64) {
        let now = &mut self.wall.motion;
        if self.removed {
            return;
        }
        if now.vibration != motion.vibration {
            self.shift += std::mem::take(&mut self.swing);
            self.since = time;
            self.swing_velocity = motion.swing_velocity(0.0);
        }
        *now = Motion {
            about: now.about,
            ..*motion
        };
    }

    /// Centre of rotation now, m.
    pub(crate) fn pivot(&self) -> Vector3<f64> {
        self.wall.motion.about + self.displacement()
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

    /// Triangles within a distance (m) of a point of the frame of the triangles, in ascending order.
    pub(crate) fn near(&self, own: &Vector3<f64>, distance: f64) -> Vec<u32> {
        let mut found = Vec::new();
        if self.removed {
            return found;
        }
        self.tree.visit(own, distance, |index| {
            let corners = &self.wall.triangles[index as usize];
            if (nearest_on_triangle(own, corners) - own).norm() < distance {
                found.push(index);
            }
        });
        found.sort_unstable();
        found
    }

    /// Moves the wall by a step (s) that ends at a time (s).
    pub(crate) fn advance(&mut self, time_step: f64, time: f64) {
        let motion = &mut self.wall.motion;
        if let Some(load) = &motion.load {
            let speed = motion.velocity.dot(&load.axis);
            motion.velocity +=
                load.axis * (load.speed_after(time_step, speed, &self.force) - speed);
        }
        let before = self.swing;
        if let Some(vibration) = &motion.vibration {
            self.swing = vibration.displacement(time - self.since);
        }
        self.swing_velocity = motion.swing_velocity(time - self.since);
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
    /// Velocity of the vibration at a time from its start (s), m/s; zero without one.
    fn swing_velocity(&self, time: f64) -> Vector3<f64> {
        let velocity = |vibration: Vibration| vibration.velocity(time);
        self.vibration.map_or_else(Vector3::zeros, velocity)
    }

    /// Whether all numbers are finite, and those of a load positive.
    pub(crate) fn is_valid(&self) -> bool {
        let vibration = self
            .vibration
            .map_or(0.0, |v| v.amplitude.sum() + v.angular_frequency);
        let loaded = self.load.is_none_or(|load| load.is_valid());
        loaded && (self.velocity.sum() + self.spin.sum() + self.about.sum() + vibration).is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::{MeshWall, Motion, Moving, Vibration};
    use nalgebra::Vector3;

    /// Step, s.
    const STEP: f64 = 1e-4;

    /// A wall that stands, and its motion with a vibration of 1 mm.
    fn standing() -> (Moving, Motion) {
        let wall = MeshWall {
            name: "wall".into(),
            triangles: vec![[Vector3::zeros(), Vector3::x(), Vector3::y()]],
            material: 0,
            motion: Motion::default(),
        };
        let vibrating = Motion {
            vibration: Some(Vibration {
                amplitude: Vector3::z() * 1e-3,
                angular_frequency: 188.0,
            }),
            ..Motion::default()
        };
        (Moving::new(wall, 0.0).expect("possible"), vibrating)
    }

    /// A vibration that is switched on late starts where the wall stands: no step is longer than the highest
    /// speed A w times the step. At 0.3131 s the sine of the time of the world would be 0.73.
    #[test]
    fn vibration_begins_and_ends_where_the_wall_stands() {
        let (mut wall, vibrating) = standing();
        let mut time = 0.3131;
        wall.set_motion(&vibrating, time);
        for k in 1..=100 {
            let before = wall.pivot();
            time += STEP;
            wall.advance(STEP, time);
            let way = (wall.pivot() - before).norm();
            assert!(way <= 1e-3 * 188.0 * STEP, "{way} m in step {k}");
        }
        let expected = 1e-3 * (188.0_f64 * 100.0 * STEP).sin();
        let place = wall.pivot().z;
        // Times of 0.3 s are known to 6e-17 s, so the place to 1e-17 m.
        assert!((place - expected).abs() < 1e-15, "{place}");

        // The same vibration given again continues.
        wall.set_motion(&vibrating, time);
        assert!(wall.pivot().z.to_bits() == place.to_bits());
        time += STEP;
        wall.advance(STEP, time);
        let expected = 1e-3 * (188.0_f64 * 101.0 * STEP).sin();
        assert!((wall.pivot().z - expected).abs() < 1e-15, "{expected}");

        wall.set_motion(&Motion::default(), time);
        let end = wall.pivot();
        assert_eq!(wall.velocity_at(&Vector3::x()), Vector3::zeros());
        wall.advance(STEP, time + STEP);
        assert_eq!(wall.pivot(), end);
        assert_eq!(wall.velocity_at(&Vector3::x()), Vector3::zeros());
    }
}
