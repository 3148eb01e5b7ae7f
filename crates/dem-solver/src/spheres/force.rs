//! Forces between bodies of one sphere each, in worlds that have no other bodies.
//!
//! Three passes over some hundred pairs at a time: which are awake, which of those touch, and the contact
//! law over the touching ones side by side. No pass branches on what it finds: whether the next pair
//! touches cannot be foreseen.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Column, ContactLoad, ROOM, Sink, by_law, read, write};
use crate::bodies::Bodies;
use crate::contact::{Interaction, Memory, Mover, SpherePair};
use crate::lanes::make_room;
use crate::liquid::bridge_volume;
use crate::pair_force::Context;
use crate::spheres::pairs::{Row, SpherePairs, TOUCHES, row, vector};
use crate::template::{OuterSphere, Template};
use crate::workspace::Workspace;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use nalgebra::Vector3;

/// Pairs looked at together: what is known of them stays in the first-level cache between the passes.
const BLOCK: usize = 256;

/// All of a sphere that a contact needs, in two lines of the cache; a copy of what stands in the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(crate) struct Sphere {
    /// Centre and radius, m.
    position: Row,
    /// Velocity, m/s, and mass in a dashpot, kg.
    velocity: Row,
    /// Angular velocity, rad/s.
    spin: Row,
}

impl Sphere {
    /// Where it is and how it moves.
    #[inline(always)]
    pub(crate) fn mover(&self) -> Mover {
        Mover {
            position: vector(&self.position),
            velocity: vector(&self.velocity),
            spin: vector(&self.spin),
        }
    }

    /// Its size and mass.
    #[inline(always)]
    pub(crate) fn shape(&self) -> OuterSphere {
        OuterSphere {
            centre: Vector3::zeros(),
            radius: self.position[3],
            dashpot_mass: self.velocity[3],
        }
    }

    /// Moves it.
    #[inline(always)]
    pub(crate) fn put(
        &mut self,
        position: &Vector3<f64>,
        velocity: &Vector3<f64>,
        spin: &Vector3<f64>,
    ) {
        self.position = row(position, self.position[3]);
        self.velocity = row(velocity, self.velocity[3]);
        self.spin = row(spin, 0.0);
    }

    /// All bodies, into a list.
    pub(crate) fn copy_all(bodies: &Bodies, templates: &[Template], spheres: &mut Vec<Self>) {
        spheres.clear();
        spheres.extend((0..bodies.len()).map(|i| {
            let sphere = &templates[bodies.template[i]].spheres[0];
            Self {
                position: row(&bodies.position[i], sphere.radius),
                velocity: row(&bodies.velocity[i], sphere.dashpot_mass),
                spin: row(&bodies.spin[i], 0.0),
            }
        }));
    }
}

/// Contacts that wait for their forces.
#[derive(Debug, Clone)]
pub(crate) struct SphereBatch {
    /// Number of contacts.
    n: usize,
    /// Interaction of all of them.
    interaction: usize,
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

/// What comes out of the law, one entry a contact; fields as of [`Effect`](crate::contact::Effect).
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

/// Finds the forces between the bodies of a range and those behind them.
pub(crate) fn add_sphere_forces(
    level: Level,
    pairs: &mut SpherePairs,
    travel: &[f32],
    workspace: &mut Workspace,
    context: &Context<'_>,
    sink: &mut impl Sink,
) {
    dispatch!(level, simd => add_sphere_forces_on(simd, pairs, travel, workspace, context, sink));
}

/// [`add_sphere_forces`] on one instruction set.
#[inline(always)]
fn add_sphere_forces_on<S: Simd>(
    simd: S,
    pairs: &mut SpherePairs,
    travel: &[f32],
    workspace: &mut Workspace,
    context: &Context<'_>,
    sink: &mut impl Sink,
) {
    let (awake, apart) = (&mut workspace.awake, &mut workspace.near);
    let batch = &mut workspace.spheres;
    make_room(apart, BLOCK);
    let spheres = context.spheres;
    let is_wet = context.slack.reach > 0.0;
    for first in (0..pairs.len()).step_by(BLOCK) {
        let block = (first, pairs.len().min(first + BLOCK));
        let n_awake = pairs.find_awake(simd, block, travel, awake);
        let mut n_apart = 0;
        for &pair in &awake[..n_awake] {
            let k = pair as usize;
            let ends = pairs.ends[k];
            let interaction = ends.interaction as usize;
            if batch.must_be_applied(interaction) {
                batch.apply(simd, pairs, context, sink);
            }
            let bodies = ends.bodies();
            let [a, b] = [&spheres[bodies[0]], &spheres[bodies[1]]];
            let (volume, reach) = if is_wet {
                wet(pairs, k, bodies, context)
            } else {
                (0.0, 0.0)
            };
            let touches = are_near(a, b, reach);
            batch.put(pair, [a, b], pairs, volume);
            batch.interaction = interaction;
            batch.n += usize::from(touches);
            apart[n_apart] = pair;
            n_apart += usize::from(!touches);
            // What is apart gets its own a moment later.
            pairs.wake[k] = TOUCHES;
        }
        for &pair in &apart[..n_apart] {
            let k = pair as usize;
            let bodies = pairs.ends[k].bodies();
            let [a, b] = [&spheres[bodies[0]], &spheres[bodies[1]]];
            let gap = gap(a, b) - context.slack.safety;
            pairs.wake[k] = travel[bodies[0]] + travel[bodies[1]] + gap;
            pairs.remember(k, &Memory::default());
        }
    }
    batch.apply(simd, pairs, context, sink);
}

/// Volume of the bridge of a pair (m³), and the gap up to which it holds: 0 for a pair that did not touch (m).
#[inline]
fn wet(pairs: &SpherePairs, k: usize, bodies: [usize; 2], context: &Context<'_>) -> (f64, f64) {
    let law = &context.interactions[pairs.ends[k].interaction as usize];
    let volume = bridge_volume(law, context.liquid, bodies);
    let reach = if pairs.touches(k) {
        law.reach(volume)
    } else {
        0.0
    };
    (volume, reach)
}

/// From the centre of a to that of b, m.
#[inline(always)]
fn between(a: &Row, b: &Row) -> Vector3<f64> {
    Vector3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2])
}

/// Whether two spheres have a gap below a reach (m); two in one place have no direction in which to part and
/// count as apart.
#[inline(always)]
#[expect(
    clippy::needless_bitwise_bool,
    reason = "no branch on what cannot be foreseen"
)]
fn are_near(a: &Sphere, b: &Sphere, reach: f64) -> bool {
    let square = between(&a.position, &b.position).norm_squared();
    let sum = a.position[3] + b.position[3] + reach;
    (square < sum * sum) & (square != 0.0)
}

/// Gap of two spheres, m.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the way up to the touch is shortened by a safety distance"
)]
fn gap(a: &Sphere, b: &Sphere) -> f32 {
    let distance = between(&a.position, &b.position).norm();
    (distance - a.position[3] - b.position[3]) as f32
}

impl SphereBatch {
    /// Whether a contact of this interaction has no place before the batch is worked off.
    #[inline(always)]
    fn must_be_applied(&self, interaction: usize) -> bool {
        self.n == ROOM || (self.n > 0 && self.interaction != interaction)
    }

    /// Writes a contact into the next free place, without taking it.
    #[inline(always)]
    fn put(&mut self, pair: u32, [a, b]: [&Sphere; 2], pairs: &SpherePairs, bridge_volume: f64) {
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
    fn apply<S: Simd>(
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
