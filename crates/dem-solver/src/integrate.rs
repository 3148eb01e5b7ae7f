//! Time integration of rigid bodies.
//!
//! Translation: v += (F/m + g) dt, x += v dt (symplectic Euler, that is leapfrog with velocities
//! half a step behind). Rotation: L += T dt, then the orientation turns about the angular
//! velocity of the half step, w = R I^-1 R' L, found with one predictor: second order, and free
//! rotation keeps |L| exactly.

use crate::bodies::{Bodies, single};
use crate::template::Template;
use multiversion::multiversion;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// What a step needs beside the bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    /// Time step, s.
    pub(crate) time_step: f64,
    /// Gravity, m/s².
    pub(crate) gravity: Vector3<f64>,
    /// Spin about z of the frame in which ways are counted, rad/s.
    pub(crate) reference_spin: f64,
}

/// Moves all bodies by one step and returns the longest way of the step's bodies since the last
/// broad phase, m.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn advance(bodies: &mut Bodies, templates: &[Template], step: &Step) -> f32 {
    let dt = step.time_step;
    let mut longest = 0.0_f32;
    for i in 0..bodies.len() {
        let template = &templates[bodies.template[i]];
        let velocity = bodies.velocity[i] + (bodies.force[i] * template.inverse_mass + step.gravity) * dt;
        bodies.velocity[i] = velocity;
        bodies.position[i] += velocity * dt;

        let momentum = bodies.angular_momentum[i] + bodies.torque[i] * dt;
        bodies.angular_momentum[i] = momentum;
        let before = bodies.orientation[i];
        let rotation = &bodies.rotation[i];
        let spin_of = |r: &nalgebra::Matrix3<f64>| {
            r * r.tr_mul(&momentum).component_mul(&template.inverse_inertia)
        };
        let first = spin_of(rotation);
        let half = turned(&before, &(first * (0.5 * dt)));
        let spin = spin_of(&half.to_rotation_matrix().into_inner());
        let after = turned(&before, &(spin * dt));
        let rotation = after.to_rotation_matrix().into_inner();
        bodies.orientation[i] = after;
        bodies.spin[i] = spin;
        bodies.rotation_single[i] = single(&rotation);
        bodies.rotation[i] = rotation;

        let position = bodies.position[i];
        let frame = Vector3::new(-position.y, position.x, 0.0) * step.reference_spin;
        let turning = (spin - Vector3::z() * step.reference_spin).norm();
        let way = ((velocity - frame).norm() + turning * template.bounding_radius) * dt;
        bodies.travel[i] += rounded_up(way);
        longest = longest.max(bodies.travel[i]);
    }
    longest
}

/// A length in single precision, never shorter than the given one.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the loss is made good by the factor")]
fn rounded_up(length: f64) -> f32 {
    (length * (1.0 + 1e-6)) as f32
}

/// The orientation turned by a small rotation vector (world frame, rad).
///
/// The series of the half angle is cut after the second order; the error of the angle is of
/// fifth order in it and the quaternion is normalised.
#[inline]
fn turned(orientation: &UnitQuaternion<f64>, vector: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = vector * 0.5;
    let square = half.norm_squared();
    let turn = Quaternion::from_parts(1.0 - 0.5 * square, half * (1.0 - square / 6.0));
    UnitQuaternion::new_normalize(turn * orientation.into_inner())
}
