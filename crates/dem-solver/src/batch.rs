//! Contacts collected side by side, so that the contact law runs over them in vector registers.
//!
//! The batch changes where a contact is computed, not what: each lane goes through
//! [`Interaction::between_spheres`], and the results are added to the bodies in the order in
//! which the contacts came.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::contact::{ContactWrench, Memory, SpherePair};
use crate::interaction::Interaction;
use crate::load::Load;
use crate::sphere_contact::SphereContact;
use crate::transpose::{Row, four_by_four, vector};
use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use nalgebra::Vector3;

/// Contacts of one batch: enough to fill the registers, few enough for the first-level cache.
pub(crate) const ROOM: usize = 32;

/// Three coordinates of each contact of a batch.
pub(crate) type Column = [[f64; ROOM]; 3];

/// Fields of [`SpherePair`], one entry a contact.
#[derive(Debug, Clone)]
struct Input {
    between: Column,
    offset_i: Column,
    offset_j: Column,
    velocity: Column,
    spins: [Column; 2],
    slip: Column,
    rolling: Column,
    radii: [[f64; ROOM]; 2],
    dashpot_masses: [[f64; ROOM]; 2],
    bridge_volume: [f64; ROOM],
}

/// Contacts that are handed over together: where registers hold four numbers, what they are given fits into these.
const TOGETHER: usize = 4;

/// What comes out of the law, one entry a contact: fields of [`ContactWrench`].
#[derive(Debug, Clone)]
pub(crate) struct Output {
    force: Column,
    torque_i: Column,
    torque_j: Column,
    slip: Column,
    rolling: Column,
}

impl Default for Output {
    fn default() -> Self {
        const EMPTY: Column = [[0.0; ROOM]; 3];
        Self {
            force: EMPTY,
            torque_i: EMPTY,
            torque_j: EMPTY,
            slip: EMPTY,
            rolling: EMPTY,
        }
    }
}

impl Output {
    /// Notes what the law says of contact `k`.
    #[inline(always)]
    pub(crate) fn write(&mut self, k: usize, wrench: &ContactWrench) {
        write(&mut self.force, k, &wrench.force);
        write(&mut self.torque_i, k, &wrench.torque_i);
        write(&mut self.torque_j, k, &wrench.torque_j);
        write(&mut self.slip, k, &wrench.memory.slip);
        write(&mut self.rolling, k, &wrench.memory.rolling);
    }

    /// Hands over the first `n` contacts in order: the number of each, the loads on both bodies and the slip to
    /// remember. They are made in registers and go straight to where they stay.
    #[inline(always)]
    pub(crate) fn hand_over<S: Simd>(
        &self,
        simd: S,
        n: usize,
        mut to: impl FnMut(usize, &[Load; 2], Row),
    ) {
        for first in (0..n.min(ROOM)).step_by(TOGETHER) {
            let forces = rows(simd, &self.force, first);
            let on_i = rows(simd, &self.torque_i, first);
            let on_j = rows(simd, &self.torque_j, first);
            let slips = rows(simd, &self.slip, first);
            let of = |l: usize| [forces[l], on_i[l], on_j[l], slips[l]];
            // Written out: a loop would put all of it into memory first.
            hand_over_one(first, n, of(0), &mut to);
            hand_over_one(first + 1, n, of(1), &mut to);
            hand_over_one(first + 2, n, of(2), &mut to);
            hand_over_one(first + 3, n, of(3), &mut to);
        }
    }

    /// Torque of the rolling spring of contact `k` to remember, N m.
    #[inline(always)]
    pub(crate) fn rolling(&self, k: usize) -> Vector3<f64> {
        read(&self.rolling, k)
    }
}

/// Hands over contact `k` of `n`: its force, the torques on both bodies and its slip.
#[inline(always)]
fn hand_over_one<S: Simd>(
    k: usize,
    n: usize,
    [force, on_i, on_j, slip]: [f64x4<S>; 4],
    to: &mut impl FnMut(usize, &[Load; 2], Row),
) {
    if k < n {
        let loads = [Load::of_rows(force, on_i), Load::of_rows(-force, on_j)];
        to(k, &loads, slip.into());
    }
}

/// The vectors of four contacts from `first` on, a zero behind each.
#[inline(always)]
fn rows<S: Simd>(simd: S, columns: &Column, first: usize) -> [f64x4<S>; TOGETHER] {
    let of = |c: usize| f64x4::from_slice(simd, &columns[c][first..first + TOGETHER]);
    four_by_four([of(0), of(1), of(2), f64x4::splat(simd, 0.0)])
}

/// Contacts that wait for their forces.
#[derive(Debug, Clone)]
pub(crate) struct Batch {
    /// Number of contacts.
    n: usize,
    /// Interaction of all of them, as an index of the world's table.
    interaction: usize,
    /// The two bodies of each contact.
    bodies: [[usize; 2]; ROOM],
    /// Place of each contact in the list of touches.
    touch: [usize; ROOM],
    /// What goes into the law.
    input: Box<Input>,
    /// What comes out.
    output: Box<Output>,
}

impl Default for Batch {
    fn default() -> Self {
        const EMPTY: Column = [[0.0; ROOM]; 3];
        Self {
            n: 0,
            interaction: 0,
            bodies: [[0; 2]; ROOM],
            touch: [0; ROOM],
            input: Box::new(Input {
                between: EMPTY,
                offset_i: EMPTY,
                offset_j: EMPTY,
                velocity: EMPTY,
                spins: [EMPTY; 2],
                slip: EMPTY,
                rolling: EMPTY,
                radii: [[0.0; ROOM]; 2],
                dashpot_masses: [[0.0; ROOM]; 2],
                bridge_volume: [0.0; ROOM],
            }),
            output: Box::default(),
        }
    }
}

/// Writes a vector into a column.
#[inline(always)]
pub(crate) fn write(column: &mut Column, k: usize, value: &Vector3<f64>) {
    column[0][k] = value.x;
    column[1][k] = value.y;
    column[2][k] = value.z;
}

#[inline(always)]
pub(crate) fn read(column: &Column, k: usize) -> Vector3<f64> {
    Vector3::new(column[0][k], column[1][k], column[2][k])
}

/// Where the loads of contacts go: to the bodies, or to a list that is given to them later.
pub(crate) trait Sink {
    /// Takes the loads that a contact puts on two bodies; their forces are opposite.
    fn take(&mut self, bodies: [usize; 2], loads: &[Load; 2]);
}

/// Loads of a range of bodies.
#[derive(Debug)]
pub(crate) struct Loads<'a> {
    /// The first body.
    pub(crate) first: usize,
    /// All of them.
    pub(crate) all: &'a mut [Load],
}

impl<'a> Loads<'a> {
    /// The loads of all bodies.
    pub(crate) fn of(all: &'a mut [Load]) -> Self {
        Self { first: 0, all }
    }

    /// Adds to the load of a body of the range.
    #[inline(always)]
    pub(crate) fn add(&mut self, body: usize, load: &Load) {
        self.all[body - self.first] += *load;
    }

    /// The loads of the bodies before `middle` and of those from there on.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Loads<'a>) {
        let (earlier, later) = self.all.split_at_mut(middle - self.first);
        let earlier = Self {
            first: self.first,
            all: earlier,
        };
        let later = Loads {
            first: middle,
            all: later,
        };
        (earlier, later)
    }
}

impl Sink for Loads<'_> {
    #[inline(always)]
    fn take(&mut self, bodies: [usize; 2], loads: &[Load; 2]) {
        self.add(bodies[0], &loads[0]);
        self.add(bodies[1], &loads[1]);
    }
}

impl Batch {
    /// Whether a contact of this interaction has no place before the batch is worked off.
    #[inline(always)]
    pub(crate) fn must_be_applied(&self, interaction: usize) -> bool {
        self.n == ROOM || (self.n > 0 && self.interaction != interaction)
    }

    /// Adds a contact; the caller has asked [`Self::must_be_applied`] before.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        interaction: usize,
        bodies: [usize; 2],
        touch: usize,
        pair: &SpherePair,
    ) {
        let (k, input) = (self.n, &mut *self.input);
        self.interaction = interaction;
        self.bodies[k] = bodies;
        self.touch[k] = touch;
        write(&mut input.between, k, &pair.between);
        write(&mut input.offset_i, k, &pair.offset_i);
        write(&mut input.offset_j, k, &pair.offset_j);
        write(&mut input.velocity, k, &pair.velocity);
        write(&mut input.spins[0], k, &pair.spins[0]);
        write(&mut input.spins[1], k, &pair.spins[1]);
        write(&mut input.slip, k, &pair.memory.slip);
        write(&mut input.rolling, k, &pair.memory.rolling);
        input.radii[0][k] = pair.radii[0];
        input.radii[1][k] = pair.radii[1];
        input.dashpot_masses[0][k] = pair.dashpot_masses[0];
        input.dashpot_masses[1][k] = pair.dashpot_masses[1];
        input.bridge_volume[k] = pair.bridge_volume;
        self.n = k + 1;
    }

    /// Computes all contacts, gives their loads to a sink and empties the batch.
    #[inline(always)]
    pub(crate) fn apply<S: Simd>(
        &mut self,
        simd: S,
        interactions: &[Interaction],
        time_step: f64,
        sink: &mut impl Sink,
        touches: &mut [SphereContact],
    ) {
        if self.n == 0 {
            return;
        }
        let (input, output, n) = (&*self.input, &mut *self.output, self.n);
        by_law(
            simd,
            interactions[self.interaction],
            #[inline(always)]
            |law| compute(law, input, output, n, time_step),
        );
        output.hand_over(
            simd,
            n,
            #[inline(always)]
            |k, loads, slip| {
                sink.take(self.bodies[k], loads);
                touches[self.touch[k]].memory = Memory {
                    slip: vector(&slip),
                    rolling: output.rolling(k),
                };
            },
        );
        self.n = 0;
    }
}

/// Gives an interaction to a loop over contacts, in vector registers. The loop is compiled twice: without further laws it
/// is half as long. The copy of the interaction lets the compiler see that nothing else changes it.
#[inline(always)]
pub(crate) fn by_law<S: Simd>(simd: S, law: Interaction, mut run: impl FnMut(&Interaction)) {
    if law == law.plain() {
        simd.vectorize(
            #[inline(always)]
            || run(&law.plain()),
        );
    } else {
        simd.vectorize(
            #[inline(always)]
            || run(&law),
        );
    }
}

/// Runs the law over the first `n` contacts.
#[inline(always)]
fn compute(law: &Interaction, input: &Input, output: &mut Output, n: usize, time_step: f64) {
    for k in 0..n.min(ROOM) {
        let pair = SpherePair {
            between: read(&input.between, k),
            offset_i: read(&input.offset_i, k),
            offset_j: read(&input.offset_j, k),
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
        output.write(k, &law.between_spheres(&pair, time_step));
    }
}
