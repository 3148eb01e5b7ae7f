//! Time integration of rigid bodies.
//!
//! Translation: v += (F/m + g) dt, x += v dt (symplectic Euler, that is leapfrog with velocities
//! half a step behind). Rotation: L += T dt, then the orientation turns about the angular
//! velocity of the half step, w = R I^-1 R' L, found with one predictor: second order, and free
//! rotation keeps |L| exactly.
//!
//! Bodies are moved in blocks that lie side by side, so that the arithmetic runs in vector
//! registers; what is computed for a body does not depend on its place in a block.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::bodies::{BodySlices, scaled_single};
use crate::template::Template;
use crate::travel::rounded_up;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::cell::RefCell;

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

/// Bodies moved together: enough to fill the registers, few enough for the first-level cache.
pub(crate) const ROOM: usize = 32;

/// Some numbers of each of the bodies that are moved together.
pub(crate) type Columns<const N: usize> = [[f64; ROOM]; N];

/// What changes in a step.
#[derive(Debug)]
struct Motion {
    position: Columns<3>,
    velocity: Columns<3>,
    momentum: Columns<3>,
    orientation: Columns<4>,
    /// Row by row.
    rotation: Columns<9>,
    spin: Columns<3>,
    travel: [f64; ROOM],
    shift: [f64; ROOM],
}

/// What drives the step.
#[derive(Debug)]
struct Drive {
    force: Columns<3>,
    torque: Columns<3>,
    inverse_mass: [f64; ROOM],
    inverse_inertia: Columns<3>,
    arm: [f64; ROOM],
}

/// Bodies that are moved together.
#[derive(Debug)]
struct Block {
    motion: Motion,
    drive: Drive,
}

thread_local! {
    /// The block of this thread. It is kept: to fill it with zeros takes a tenth of a step of one body.
    static BLOCK: RefCell<Block> = const {
        RefCell::new(Block {
            motion: Motion {
                position: [[0.0; ROOM]; 3],
                velocity: [[0.0; ROOM]; 3],
                momentum: [[0.0; ROOM]; 3],
                orientation: [[0.0; ROOM]; 4],
                rotation: [[0.0; ROOM]; 9],
                spin: [[0.0; ROOM]; 3],
                travel: [0.0; ROOM],
                shift: [0.0; ROOM],
            },
            drive: Drive {
                force: [[0.0; ROOM]; 3],
                torque: [[0.0; ROOM]; 3],
                inverse_mass: [0.0; ROOM],
                inverse_inertia: [[0.0; ROOM]; 3],
                arm: [0.0; ROOM],
            },
        })
    };
}

/// Writes numbers into column `k`.
#[inline(always)]
pub(crate) fn write<const N: usize>(columns: &mut Columns<N>, k: usize, value: [f64; N]) {
    for (column, number) in columns.iter_mut().zip(value) {
        column[k] = number;
    }
}

/// Reads a vector of column `k`.
#[inline(always)]
pub(crate) fn vector(columns: &Columns<3>, k: usize) -> Vector3<f64> {
    Vector3::new(columns[0][k], columns[1][k], columns[2][k])
}

/// Longest way of a centre of mass and sum of all travels, m.
pub(crate) fn advance_bodies(
    level: Level,
    bodies: &mut BodySlices<'_>,
    templates: &[Template],
    around: &Surroundings,
) -> (f32, f32) {
    BLOCK.with_borrow_mut(|block| advance_in(block, level, bodies, templates, around))
}

/// [`advance_bodies`] in a block.
fn advance_in(
    Block { motion, drive }: &mut Block,
    level: Level,
    bodies: &mut BodySlices<'_>,
    templates: &[Template],
    around: &Surroundings,
) -> (f32, f32) {
    let (mut longest, mut sum) = (0.0_f32, 0.0_f32);
    for first in (0..bodies.len()).step_by(ROOM) {
        let block = first..bodies.len().min(first + ROOM);
        for (k, i) in block.clone().enumerate() {
            gather(bodies, templates, i, k, motion, drive);
        }
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || move_block(motion, drive, around, block.len()),
        ));
        for (k, i) in block.enumerate() {
            scatter(motion, k, bodies, i, templates);
            longest = longest.max(bodies.shift[i]);
            sum += bodies.travel[i];
        }
    }
    (longest, sum)
}

/// Copies body `i` into column `k`.
#[inline(always)]
fn gather(
    bodies: &BodySlices<'_>,
    templates: &[Template],
    i: usize,
    k: usize,
    motion: &mut Motion,
    drive: &mut Drive,
) {
    let template = &templates[bodies.template[i]];
    let orientation = bodies.orientation[i].quaternion();
    write(&mut motion.position, k, bodies.position[i].into());
    write(&mut motion.velocity, k, bodies.velocity[i].into());
    write(&mut motion.momentum, k, bodies.angular_momentum[i].into());
    write(
        &mut motion.orientation,
        k,
        [orientation.i, orientation.j, orientation.k, orientation.w],
    );
    write(&mut motion.rotation, k, rows(&bodies.rotation[i]));
    motion.travel[k] = f64::from(bodies.travel[i]);
    motion.shift[k] = f64::from(bodies.shift[i]);
    write(&mut drive.force, k, bodies.load[i].force().into());
    write(&mut drive.torque, k, bodies.load[i].torque().into());
    drive.inverse_mass[k] = template.inverse_mass;
    write(
        &mut drive.inverse_inertia,
        k,
        template.inverse_inertia.into(),
    );
    drive.arm[k] = template.arm;
}

/// Moves the first `n` bodies of a block.
#[inline(always)]
fn move_block(motion: &mut Motion, drive: &Drive, around: &Surroundings, n: usize) {
    let dt = around.time_step;
    for k in 0..n.min(ROOM) {
        let acceleration = vector(&drive.force, k) * drive.inverse_mass[k] + around.gravity;
        let velocity = vector(&motion.velocity, k) + acceleration * dt;
        let position = vector(&motion.position, k) + velocity * dt;
        write(&mut motion.velocity, k, velocity.into());
        write(&mut motion.position, k, position.into());

        let momentum = vector(&motion.momentum, k) + vector(&drive.torque, k) * dt;
        write(&mut motion.momentum, k, momentum.into());
        let inverse_inertia = vector(&drive.inverse_inertia, k);
        let r = &motion.rotation;
        let rotation = Matrix3::new(
            r[0][k], r[1][k], r[2][k], r[3][k], r[4][k], r[5][k], r[6][k], r[7][k], r[8][k],
        );
        let q = &motion.orientation;
        let before = Quaternion::new(q[3][k], q[0][k], q[1][k], q[2][k]);
        let first = spin_of(&rotation, &momentum, &inverse_inertia);
        let half = turned(&before, &(first * (0.5 * dt)));
        let spin = spin_of(&rotation_matrix(&half), &momentum, &inverse_inertia);
        let after = turned(&before, &(spin * dt));
        write(
            &mut motion.orientation,
            k,
            [after.i, after.j, after.k, after.w],
        );
        write(&mut motion.rotation, k, rows(&rotation_matrix(&after)));
        write(&mut motion.spin, k, spin.into());

        // The velocity of the turning frame is taken half way, where its error is of third order.
        let middle = position - velocity * (0.5 * dt);
        let frame = Vector3::new(-middle.y, middle.x, 0.0) * around.reference_spin;
        let turning = length(&(spin - Vector3::z() * around.reference_spin));
        let shift = length(&(velocity - frame)) * dt;
        motion.shift[k] += shift;
        motion.travel[k] += shift + turning * drive.arm[k] * dt;
    }
}

/// Copies column `k` back to body `i`.
#[inline(always)]
fn scatter(
    motion: &Motion,
    k: usize,
    bodies: &mut BodySlices<'_>,
    i: usize,
    templates: &[Template],
) {
    let (q, r) = (&motion.orientation, &motion.rotation);
    let rotation = Matrix3::new(
        r[0][k], r[1][k], r[2][k], r[3][k], r[4][k], r[5][k], r[6][k], r[7][k], r[8][k],
    );
    bodies.position[i] = vector(&motion.position, k);
    bodies.velocity[i] = vector(&motion.velocity, k);
    bodies.angular_momentum[i] = vector(&motion.momentum, k);
    // The quaternion was normalised when it was turned.
    bodies.orientation[i] =
        UnitQuaternion::new_unchecked(Quaternion::new(q[3][k], q[0][k], q[1][k], q[2][k]));
    bodies.rotation[i] = rotation;
    let cell = templates[bodies.template[i]].cell;
    bodies.cells_to_metres[i] = scaled_single(&rotation, cell);
    bodies.spin[i] = vector(&motion.spin, k);
    bodies.travel[i] = rounded_up(motion.travel[k]);
    bodies.shift[i] = rounded_up(motion.shift[k]);
}

/// A matrix row by row.
#[inline(always)]
fn rows(m: &Matrix3<f64>) -> [f64; 9] {
    [
        m.m11, m.m12, m.m13, m.m21, m.m22, m.m23, m.m31, m.m32, m.m33,
    ]
}

#[inline(always)]
pub(crate) fn length(v: &Vector3<f64>) -> f64 {
    (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}

/// Angular velocity w = R I^-1 R' L, rad/s.
#[inline(always)]
fn spin_of(
    rotation: &Matrix3<f64>,
    momentum: &Vector3<f64>,
    inverse_inertia: &Vector3<f64>,
) -> Vector3<f64> {
    rotation * rotation.tr_mul(momentum).component_mul(inverse_inertia)
}

/// Rotation matrix of a quaternion of length 1.
#[inline(always)]
fn rotation_matrix(q: &Quaternion<f64>) -> Matrix3<f64> {
    UnitQuaternion::new_unchecked(*q)
        .to_rotation_matrix()
        .into_inner()
}

/// The orientation turned by a small rotation vector (world frame, rad).
///
/// The series of the half angle is cut after the second order; the error of the angle is of
/// fifth order in it and the quaternion is normalised.
#[inline(always)]
pub(crate) fn turned(orientation: &Quaternion<f64>, vector: &Vector3<f64>) -> Quaternion<f64> {
    let half = vector * 0.5;
    let square = half.norm_squared();
    let turn = Quaternion::from_parts(1.0 - 0.5 * square, half * (1.0 - square / 6.0));
    let product = turn * orientation;
    product / product.norm()
}
