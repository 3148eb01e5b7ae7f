//! A small case with one to three bodies: start, duration, and the numbers to report.

use nalgebra::{UnitQuaternion, Vector3};

/// Shape of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// The sphere of the model.
    Sphere,
    /// Two of these spheres in contact, rigidly joined, along the x axis of the body.
    Clump,
}

impl Shape {
    /// Centres of the spheres in the frame of the body (m), for a radius (m).
    pub fn centres(self, radius: f64) -> Vec<Vector3<f64>> {
        match self {
            Self::Sphere => vec![Vector3::zeros()],
            Self::Clump => vec![-Vector3::x() * radius, Vector3::x() * radius],
        }
    }
}

/// Start of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// Shape.
    pub shape: Shape,
    /// Position of the centre of mass, m.
    pub position: Vector3<f64>,
    /// Rotation from the frame of the body to the world.
    pub orientation: UnitQuaternion<f64>,
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Angular velocity, rad/s.
    pub spin: Vector3<f64>,
}

impl Start {
    pub(crate) fn sphere(position: Vector3<f64>, velocity: Vector3<f64>) -> Self {
        Self {
            shape: Shape::Sphere,
            position,
            orientation: UnitQuaternion::identity(),
            velocity,
            spin: Vector3::zeros(),
        }
    }
}

/// A component of the motion of the first body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// Velocity along x, y, z, m/s.
    Velocity(usize),
    /// Angular velocity about x, y, z, rad/s.
    Spin(usize),
    /// Displacement since the start along x, y, z, m.
    Displacement(usize),
}

/// A number to report.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Component of the motion of the first body.
    pub component: Component,
    /// Index of the time at which it is read.
    pub at: usize,
    /// Value in closed form, if there is one.
    pub closed_form: Option<f64>,
}

impl Quantity {
    /// Name in the tables, such as `velocity_x_at_t1`.
    pub fn name(&self) -> String {
        let (what, axis) = match self.component {
            Component::Velocity(axis) => ("velocity", axis),
            Component::Spin(axis) => ("spin", axis),
            Component::Displacement(axis) => ("displacement", axis),
        };
        format!("{what}_{}_at_t{}", ["x", "y", "z"][axis], self.at + 1)
    }

    /// Unit.
    pub fn unit(&self) -> &'static str {
        match self.component {
            Component::Velocity(_) => "m/s",
            Component::Spin(_) => "rad/s",
            Component::Displacement(_) => "m",
        }
    }
}

/// A small case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name.
    pub name: &'static str,
    /// What it shows, in a sentence.
    pub shows: &'static str,
    /// Starts of the bodies; the first one is measured.
    pub bodies: Vec<Start>,
    /// Whether the plane y = 0 is there.
    pub wall: bool,
    /// Gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Time step, s.
    pub time_step: f64,
    /// Times at which the numbers are read, s.
    pub times: Vec<f64>,
    /// Numbers to report.
    pub quantities: Vec<Quantity>,
    /// Speed of the case, m/s: the scale of its numerical error.
    pub speed: f64,
}
