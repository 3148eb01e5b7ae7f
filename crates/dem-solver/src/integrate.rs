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
pub(crate) struct Surroundings {
    /// Time step, s.
    pub(crate) time_step: f64,
    /// Gravity, m/s².
    pub(crate) gravity: Vector3<f64>,
    /// Spin about z of the frame in which ways are counted, rad/s.
    pub(crate) reference_spin: f64,
}

/// Moves all bodies by one step and returns the longest travel since the last broad phase, m;
/// infinite if a travel is no finite number.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn advance(bodies: &mut Bodies, templates: &[Template], around: &Surroundings) -> f32 {
    let dt = around.time_step;
    // The largest of some numbers leaves out what is no number; their sum does not.
    let (mut longest, mut sum) = (0.0_f32, 0.0_f32);
    for i in 0..bodies.len() {
        let template = &templates[bodies.template[i]];
        let velocity =
            bodies.velocity[i] + (bodies.force[i] * template.inverse_mass + around.gravity) * dt;
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

        // The velocity of the turning frame is taken half way, where its error is of third order.
        let position = bodies.position[i] - velocity * (0.5 * dt);
        let frame = Vector3::new(-position.y, position.x, 0.0) * around.reference_spin;
        let turning = (spin - Vector3::z() * around.reference_spin).norm();
        let way = ((velocity - frame).norm() + turning * template.bounding_radius) * dt;
        let travel = rounded_up(f64::from(bodies.travel[i]) + way);
        bodies.travel[i] = travel;
        longest = longest.max(travel);
        sum += travel;
    }
    if sum.is_finite() {
        longest
    } else {
        f32::INFINITY
    }
}

/// A length in single precision, never shorter than the given one, so that a sum of many ways
/// that are short against it is not too short either.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the loss is made good by the factor"
)]
fn rounded_up(length: f64) -> f32 {
    (length * (1.0 + 2.4e-7)) as f32
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
