//! Contacts of bodies of one sphere, collected side by side for the law.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Column, ContactLoad, ROOM, Sink, by_law, read, write};
use crate::contact::{Memory, SpherePair};
use crate::context::Context;
use crate::interaction::Interaction;
use crate::spheres::pairs::SpherePairs;
use crate::spheres::sphere::{Row, Sphere, vector};
use fearless_simd::prelude::*;
use nalgebra::Vector3;

/// Contacts that wait for their forces.
#[derive(Debug, Clone)]
pub(crate) struct SphereBatch {
    /// Number of contacts.
    pub(super) n: usize,
    /// Interaction of all of them.
    pub(super) interaction: usize,
    /// The pairs.
    pair: [u32; ROOM],
    /// What goes into the law.
    input: Box<Input>,
    /// What comes out.
    output: Box<Output>,
}

/// What goes into the law, one entry a contact; fields as of [`SpherePair`].
#[derive(Debug, Clone)]
struct Input {
    between: Column,
    velocity: Column,
    spins: [Column; 2],
    slip: Column,
    rolling: Column,
    radii: [[f64; ROOM]; 2],
    dashpot_masses: [[f64; ROOM]; 2],
    bridge_volume: [f64; ROOM],
}

/// What comes out of the law, one entry a contact; fields as of [`ContactWrench`](crate::contact::ContactWrench).
#[derive(Debug, Clone)]
struct Output {
    force: Column,
    torque_i: Column,
    torque_j: Column,
    slip: Column,
    rolling: Column,
}

impl Default for SphereBatch {
    fn default() -> Self {
        const EMPTY: Column = [[0.0; ROOM]; 3];
        Self {
            n: 0,
            interaction: 0,
            pair: [0; ROOM],
            input: Box::new(Input {
                between: EMPTY,
                velocity: EMPTY,
                spins: [EMPTY; 2],
                slip: EMPTY,
                rolling: EMPTY,
                radii: [[0.0; ROOM]; 2],
                dashpot_masses: [[0.0; ROOM]; 2],
                bridge_volume: [0.0; ROOM],
            }),
            output: Box::new(Output {
                force: EMPTY,
                torque_i: EMPTY,
                torque_j: EMPTY,
                slip: EMPTY,
                rolling: EMPTY,
            }),
        }
    }
}

impl SphereBatch {
    /// Whether a contact of this interaction has no place before the batch is worked off.
    #[inline(always)]
    pub(super) fn must_be_applied(&self, interaction: usize) -> bool {
        self.n == ROOM || (self.n > 0 && self.interaction != interaction)
    }

    /// Writes a contact into the next free place, without taking it.
    #[inline(always)]
    pub(super) fn put(
        &mut self,
        pair: u32,
        [a, b]: [&Sphere; 2],
        pairs: &SpherePairs,
        bridge_volume: f64,
    ) {
        let (n, input) = (self.n, &mut *self.input);
        self.pair[n] = pair;
        write(&mut input.between, n, &between(&a.position, &b.position));
        write(&mut input.velocity, n, &between(&b.velocity, &a.velocity));
        write(&mut input.spins[0], n, &vector(&a.spin));
        write(&mut input.spins[1], n, &vector(&b.spin));
        write(&mut input.slip, n, &pairs.slip[pair as usize]);
        if let Some(rolling) = pairs.rolling.get(pair as usize) {
            write(&mut input.rolling, n, rolling);
        }
        input.radii[0][n] = a.position[3];
        input.radii[1][n] = b.position[3];
        input.dashpot_masses[0][n] = a.velocity[3];
        input.dashpot_masses[1][n] = b.velocity[3];
        input.bridge_volume[n] = bridge_volume;
    }

    /// Computes all contacts, gives their loads to a sink and empties the batch.
    #[inline(always)]
    pub(super) fn apply<S: Simd>(
        &mut self,
        simd: S,
        pairs: &mut SpherePairs,
        context: &Context<'_>,
        sink: &mut impl Sink,
    ) {
        if self.n == 0 {
            return;
        }
        let (input, output, n) = (&*self.input, &mut *self.output, self.n);
        let time_step = context.time_step;
        by_law(
            simd,
            context.interactions[self.interaction],
            #[inline(always)]
            |law| compute(law, input, output, n, time_step),
        );
        let output = &*self.output;
        for k in 0..n {
            let pair = self.pair[k] as usize;
            sink.take(&ContactLoad {
                bodies: pairs.ends[pair].bodies(),
                force: read(&output.force, k),
                torques: [read(&output.torque_i, k), read(&output.torque_j, k)],
            });
            pairs.slip[pair] = read(&output.slip, k);
            if let Some(rolling) = pairs.rolling.get_mut(pair) {
                *rolling = read(&output.rolling, k);
            }
        }
        self.n = 0;
    }
}

/// Runs the law over the first `n` contacts.
#[inline(always)]
fn compute(law: &Interaction, input: &Input, output: &mut Output, n: usize, time_step: f64) {
    for k in 0..n.min(ROOM) {
        let pair = SpherePair {
            between: read(&input.between, k),
            offset_i: Vector3::zeros(),
            offset_j: Vector3::zeros(),
            velocity: read(&input.velocity, k),
            spins: [read(&input.spins[0], k), read(&input.spins[1], k)],
            memory: Memory {
                slip: read(&input.slip, k),
                rolling: read(&input.rolling, k),
            },
            radii: [input.radii[0][k], input.radii[1][k]],
            dashpot_masses: [input.dashpot_masses[0][k], input.dashpot_masses[1][k]],
            bridge_volume: input.bridge_volume[k],
        };
        let effect = law.between_spheres(&pair, time_step);
        write(&mut output.force, k, &effect.force);
        write(&mut output.torque_i, k, &effect.torque_i);
        write(&mut output.torque_j, k, &effect.torque_j);
        write(&mut output.slip, k, &effect.memory.slip);
        write(&mut output.rolling, k, &effect.memory.rolling);
    }
}

/// From the centre of a to that of b, m.
#[inline(always)]
pub(super) fn between(a: &Row, b: &Row) -> Vector3<f64> {
    Vector3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2])
}
