//! Contacts at walls collected side by side, so that the contact law runs over them in vector registers.
//!
//! As [`Batch`](crate::batch::Batch) for pairs, it changes where a contact is computed, not what: each lane goes through
//! [`Interaction::at_wall`], and the results come in the order in which the contacts were put in.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Column, ROOM, by_law, read, write};
use crate::contact::{ContactWrench, Memory, Mover, SphereWall};
use crate::context::Context;
use crate::interaction::Interaction;
use contact_law::ContactGeometry;
use fearless_simd::{Level, dispatch};
use nalgebra::Vector3;

/// Contacts at walls that wait for their forces, each with what tells its owner where it belongs.
#[derive(Debug, Clone)]
pub(crate) struct WallBatch<T> {
    /// Number of contacts.
    n: usize,
    /// Interaction of all of them.
    interaction: usize,
    /// Where they belong.
    place: [T; ROOM],
    /// What goes into the law.
    input: Box<Input>,
    /// What comes out.
    output: Box<Output>,
}

/// What goes into the law, one entry a contact; fields as of [`SphereWall`], [`Mover`] and [`Memory`].
#[derive(Debug, Clone)]
struct Input {
    normal: Column,
    arm: Column,
    wall_velocity: Column,
    wall_spin: Column,
    velocity: Column,
    spin: Column,
    slip: Column,
    rolling: Column,
    overlap: [f64; ROOM],
    radius: [f64; ROOM],
    mass: [f64; ROOM],
    bridge_volume: [f64; ROOM],
}

/// What comes out of the law, one entry a contact; fields as of [`ContactWrench`].
#[derive(Debug, Clone)]
struct Output {
    force: Column,
    torque: Column,
    slip: Column,
    rolling: Column,
}

impl<T: Copy + Default> Default for WallBatch<T> {
    fn default() -> Self {
        const EMPTY: Column = [[0.0; ROOM]; 3];
        Self {
            n: 0,
            interaction: 0,
            place: [T::default(); ROOM],
            input: Box::new(Input {
                normal: EMPTY,
                arm: EMPTY,
                wall_velocity: EMPTY,
                wall_spin: EMPTY,
                velocity: EMPTY,
                spin: EMPTY,
                slip: EMPTY,
                rolling: EMPTY,
                overlap: [0.0; ROOM],
                radius: [0.0; ROOM],
                mass: [0.0; ROOM],
                bridge_volume: [0.0; ROOM],
            }),
            output: Box::new(Output {
                force: EMPTY,
                torque: EMPTY,
                slip: EMPTY,
                rolling: EMPTY,
            }),
        }
    }
}

impl<T: Copy> WallBatch<T> {
    /// Whether a contact of this interaction has a place, or only when the batch has been worked off.
    #[inline(always)]
    pub(crate) fn has_room(&self, interaction: usize) -> bool {
        self.n < ROOM && (self.n == 0 || self.interaction == interaction)
    }

    /// Adds a contact; the caller has asked [`Self::has_room`] before.
    #[inline(always)]
    pub(crate) fn put(
        &mut self,
        place: T,
        interaction: usize,
        contact: &SphereWall,
        body: &Mover,
        memory: &Memory,
    ) {
        let (n, input) = (self.n, &mut *self.input);
        self.interaction = interaction;
        self.place[n] = place;
        write(&mut input.normal, n, &contact.normal);
        write(&mut input.arm, n, &contact.arm);
        write(&mut input.wall_velocity, n, &contact.wall_velocity);
        write(&mut input.wall_spin, n, &contact.wall_spin);
        write(&mut input.velocity, n, &body.velocity);
        write(&mut input.spin, n, &body.spin);
        write(&mut input.slip, n, &memory.slip);
        write(&mut input.rolling, n, &memory.rolling);
        input.overlap[n] = contact.geometry.overlap;
        input.radius[n] = contact.geometry.reduced_radius;
        input.mass[n] = contact.geometry.reduced_mass;
        input.bridge_volume[n] = contact.bridge_volume;
        self.n = n + 1;
    }

    /// Computes all contacts, hands each with its place to a receiver, and empties the batch.
    #[inline(always)]
    pub(crate) fn apply(
        &mut self,
        level: Level,
        context: &Context<'_>,
        mut to: impl FnMut(T, &ContactWrench),
    ) {
        if self.n == 0 {
            return;
        }
        let (input, output) = (&*self.input, &mut *self.output);
        let law = &context.interactions[self.interaction];
        compute(level, law, input, output, self.n, context.time_step);
        for (k, place) in self.place[..self.n].iter().enumerate() {
            let wrench = ContactWrench {
                force: read(&output.force, k),
                torque_i: read(&output.torque, k),
                torque_j: Vector3::zeros(),
                memory: Memory {
                    slip: read(&output.slip, k),
                    rolling: read(&output.rolling, k),
                },
            };
            to(*place, &wrench);
        }
        self.n = 0;
    }
}

/// Runs a law over the first `n` contacts. One function for all callers: it is long on each instruction set.
#[inline(never)]
fn compute(
    level: Level,
    law: &Interaction,
    input: &Input,
    output: &mut Output,
    n: usize,
    time_step: f64,
) {
    dispatch!(level, simd => by_law(
        simd,
        *law,
        #[inline(always)]
        |law| compute_with(law, input, output, n, time_step),
    ));
}

/// [`compute`] on the instruction set of the caller.
#[inline(always)]
fn compute_with(law: &Interaction, input: &Input, output: &mut Output, n: usize, time_step: f64) {
    for k in 0..n.min(ROOM) {
        let contact = SphereWall {
            normal: read(&input.normal, k),
            arm: read(&input.arm, k),
            wall_velocity: read(&input.wall_velocity, k),
            wall_spin: read(&input.wall_spin, k),
            geometry: ContactGeometry {
                overlap: input.overlap[k],
                reduced_radius: input.radius[k],
                reduced_mass: input.mass[k],
            },
            bridge_volume: input.bridge_volume[k],
        };
        let body = Mover {
            // The arm says where the contact is.
            position: Vector3::zeros(),
            velocity: read(&input.velocity, k),
            spin: read(&input.spin, k),
        };
        let memory = Memory {
            slip: read(&input.slip, k),
            rolling: read(&input.rolling, k),
        };
        let effect = law.at_wall(&contact, &body, memory, time_step);
        write(&mut output.force, k, &effect.force);
        write(&mut output.torque, k, &effect.torque_i);
        write(&mut output.slip, k, &effect.memory.slip);
        write(&mut output.rolling, k, &effect.memory.rolling);
    }
}
