//! Time integration of bodies of one sphere each, in worlds that have no other bodies.
//!
//! The scheme of `integrate`, with what is the same about every axis: w = L / I needs no rotation matrix,
//! and a turn moves no surface, so that the way of the centre is the whole way. Rotation matrices are not
//! kept up to date: nothing asks how a sphere is turned but the user, who has the orientation.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::bodies::BodySlices;
use crate::integrate::{Columns, ROOM, Surroundings, length, turned, vector, write};
use crate::template::Template;
use crate::travel::rounded_up;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// What changes in a step, and what drives it.
#[derive(Debug)]
struct Motion {
    position: Columns<3>,
    velocity: Columns<3>,
    momentum: Columns<3>,
    orientation: Columns<4>,
    spin: Columns<3>,
    way: [f64; ROOM],
    force: Columns<3>,
    torque: Columns<3>,
    inverse_mass: [f64; ROOM],
    inverse_inertia: [f64; ROOM],
}

/// Longest way of a centre and sum of all travels, m.
pub(crate) fn advance_spheres(
    level: Level,
    bodies: &mut BodySlices<'_>,
    templates: &[Template],
    around: &Surroundings,
) -> (f32, f32) {
    let mut motion = Motion {
        position: [[0.0; ROOM]; 3],
        velocity: [[0.0; ROOM]; 3],
        momentum: [[0.0; ROOM]; 3],
        orientation: [[0.0; ROOM]; 4],
        spin: [[0.0; ROOM]; 3],
        way: [0.0; ROOM],
        force: [[0.0; ROOM]; 3],
        torque: [[0.0; ROOM]; 3],
        inverse_mass: [0.0; ROOM],
        inverse_inertia: [0.0; ROOM],
    };
    dispatch!(level, simd => simd.vectorize(
        #[inline(always)]
        || {
            let (mut longest, mut sum) = (0.0_f32, 0.0_f32);
            for first in (0..bodies.len()).step_by(ROOM) {
                let n = (bodies.len() - first).min(ROOM);
                gather(bodies, first, n, templates, &mut motion);
                move_block(&mut motion, around, n);
                let (farthest, ways) = scatter(&motion, bodies, first, n);
                longest = longest.max(farthest);
                sum += ways;
            }
            (longest, sum)
        },
    ))
}

/// Copies vectors into columns.
#[inline(always)]
fn read_all(columns: &mut Columns<3>, vectors: &[Vector3<f64>]) {
    for (k, v) in vectors.iter().enumerate().take(ROOM) {
        write(columns, k, [v.x, v.y, v.z]);
    }
}

/// Copies columns into vectors.
#[inline(always)]
fn write_all(vectors: &mut [Vector3<f64>], columns: &Columns<3>) {
    for (k, v) in vectors.iter_mut().enumerate().take(ROOM) {
        *v = vector(columns, k);
    }
}

/// Copies `n` bodies from `first` on into the columns.
#[inline(always)]
fn gather(
    bodies: &BodySlices<'_>,
    first: usize,
    n: usize,
    templates: &[Template],
    motion: &mut Motion,
) {
    let block = first..first + n;
    read_all(&mut motion.position, &bodies.position[block.clone()]);
    read_all(&mut motion.velocity, &bodies.velocity[block.clone()]);
    read_all(
        &mut motion.momentum,
        &bodies.angular_momentum[block.clone()],
    );
    for (k, load) in bodies.load[block.clone()].iter().enumerate().take(ROOM) {
        write(&mut motion.force, k, load.force().into());
        write(&mut motion.torque, k, load.torque().into());
    }
    let orientations = bodies.orientation[block.clone()].iter();
    for (k, orientation) in orientations.enumerate().take(ROOM) {
        let q = orientation.quaternion();
        write(&mut motion.orientation, k, [q.i, q.j, q.k, q.w]);
    }
    for (k, &of) in bodies.template[block].iter().enumerate().take(ROOM) {
        let template = &templates[of];
        motion.inverse_mass[k] = template.inverse_mass;
        motion.inverse_inertia[k] = template.inverse_inertia.x;
    }
}

/// Moves the first `n` bodies of a block.
#[inline(always)]
fn move_block(motion: &mut Motion, around: &Surroundings, n: usize) {
    let dt = around.time_step;
    for k in 0..n.min(ROOM) {
        let acceleration = vector(&motion.force, k) * motion.inverse_mass[k] + around.gravity;
        let velocity = vector(&motion.velocity, k) + acceleration * dt;
        let position = vector(&motion.position, k) + velocity * dt;
        write(&mut motion.velocity, k, velocity.into());
        write(&mut motion.position, k, position.into());

        let momentum = vector(&motion.momentum, k) + vector(&motion.torque, k) * dt;
        let spin = momentum * motion.inverse_inertia[k];
        write(&mut motion.momentum, k, momentum.into());
        write(&mut motion.spin, k, spin.into());
        let q = &motion.orientation;
        let before = Quaternion::new(q[3][k], q[0][k], q[1][k], q[2][k]);
        let after = turned(&before, &(spin * dt));
        write(
            &mut motion.orientation,
            k,
            [after.i, after.j, after.k, after.w],
        );

        // The velocity of the turning frame is taken half way, where its error is of third order.
        let middle = position - velocity * (0.5 * dt);
        let frame = Vector3::new(-middle.y, middle.x, 0.0) * around.reference_spin;
        motion.way[k] = length(&(velocity - frame)) * dt;
    }
}

/// Copies the columns back to `n` bodies from `first` on; longest way of a centre and sum of their travels, m.
#[inline(always)]
fn scatter(motion: &Motion, bodies: &mut BodySlices<'_>, first: usize, n: usize) -> (f32, f32) {
    let block = first..first + n;
    write_all(&mut bodies.position[block.clone()], &motion.position);
    write_all(&mut bodies.velocity[block.clone()], &motion.velocity);
    write_all(
        &mut bodies.angular_momentum[block.clone()],
        &motion.momentum,
    );
    write_all(&mut bodies.spin[block.clone()], &motion.spin);
    let q = &motion.orientation;
    let orientations = bodies.orientation[block.clone()].iter_mut();
    for (k, orientation) in orientations.enumerate().take(ROOM) {
        // The quaternion was normalised when it was turned.
        let turned = Quaternion::new(q[3][k], q[0][k], q[1][k], q[2][k]);
        *orientation = UnitQuaternion::new_unchecked(turned);
    }
    let spheres = bodies.spheres[block.clone()].iter_mut();
    for (k, sphere) in spheres.enumerate().take(ROOM) {
        sphere.put(
            &vector(&motion.position, k),
            &vector(&motion.velocity, k),
            &vector(&motion.spin, k),
        );
    }
    let (mut longest, mut sum) = (0.0_f32, 0.0_f32);
    let shifts = bodies.shift[block.clone()].iter_mut();
    let ways = shifts.zip(&mut bodies.travel[block]).zip(&motion.way);
    for ((shift, travel), way) in ways {
        *shift = rounded_up(f64::from(*shift) + way);
        *travel = rounded_up(f64::from(*travel) + way);
        longest = longest.max(*shift);
        sum += *travel;
    }
    (longest, sum)
}
