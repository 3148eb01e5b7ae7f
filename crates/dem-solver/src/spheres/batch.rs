//! Pairs of bodies of one sphere, side by side for the law.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Column, Output, ROOM, Sink, by_law, read, write};
use crate::contact::{Memory, SpherePair};
use crate::context::Context;
use crate::interaction::Interaction;
use crate::liquid::bridge_volume;
use crate::periodic::Period;
use crate::spheres::pairs::SpherePairs;
use crate::spheres::sphere::Sphere;
use crate::transpose::{GROUP, Row, four_columns, transposed};
use crate::travel::TOUCHES;
use crate::window::Window;
use fearless_simd::prelude::*;
use fearless_simd::{f64x4, f64x8, mask64x8};
use nalgebra::Vector3;

/// Where the pairs of a batch that may touch stand side by side.
#[derive(Debug, Clone)]
pub(crate) struct SphereBatch {
    /// The pairs, filled up with the last one to whole groups.
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
    /// Gap up to which a contact holds that was made, m; 0 in a dry world.
    reach: [f64; ROOM],
}

impl Default for SphereBatch {
    fn default() -> Self {
        const EMPTY: Column = [[0.0; ROOM]; 3];
        Self {
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
                reach: [0.0; ROOM],
            }),
            output: Box::default(),
        }
    }
}

impl SphereBatch {
    /// Computes the contacts of at most [`ROOM`] pairs of one interaction, gives their loads to a sink and notes what
    /// they remember; of pairs that are apart, when they are to be looked at again.
    #[inline(always)]
    pub(super) fn apply<S: Simd>(
        &mut self,
        simd: S,
        now: &[u32],
        pairs: &mut SpherePairs,
        travel: Window<'_, f32>,
        context: &Context<'_>,
        sink: &mut impl Sink,
    ) {
        let (n, last) = (now.len(), now[now.len() - 1]);
        for (pair, now) in self.pair.iter_mut().zip(now) {
            *pair = *now;
        }
        let full = n.next_multiple_of(GROUP).min(ROOM);
        self.pair[n..full].fill(last);
        let law = context.interactions[pairs.ends[last as usize].interaction as usize];
        if context.cutoffs.reach > 0.0 {
            self.find_bridges(n, &law, pairs, context.liquid);
        }
        let touching = self.collect(simd, full, pairs, context);
        let (input, output) = (&*self.input, &mut *self.output);
        let time_step = context.time_step;
        if law == law.smooth() {
            // The compiler leaves out the arms of rolling friction where it sees that there is none.
            simd.vectorize(
                #[inline(always)]
                || compute(&law.smooth(), input, output, full, time_step),
            );
        } else {
            by_law(
                simd,
                law,
                #[inline(always)]
                |law| compute(law, input, output, full, time_step),
            );
        }
        output.hand_over(
            simd,
            n,
            #[inline(always)]
            |k, loads, slip| {
                let pair = self.pair[k] as usize;
                let bodies = pairs.ends[pair].bodies();
                if touching & (1 << k) == 0 {
                    sleep(pairs, pair, travel, context);
                } else {
                    sink.take(bodies, loads);
                    pairs.wake[pair] = TOUCHES;
                    pairs.remember(pair, slip, output.rolling(k));
                }
            },
        );
    }

    /// Finds the bridges of liquid of the first `n` pairs, and how far they reach: only where a contact was made.
    fn find_bridges(&mut self, n: usize, law: &Interaction, pairs: &SpherePairs, liquid: &[f64]) {
        let input = &mut *self.input;
        for (k, &pair) in self.pair[..n].iter().enumerate() {
            let pair = pair as usize;
            let volume = bridge_volume(law, liquid, pairs.ends[pair].bodies());
            input.bridge_volume[k] = volume;
            input.reach[k] = if pairs.touches(pair) {
                law.reach(volume)
            } else {
                0.0
            };
        }
    }

    /// Puts what the spheres and the memories of the first pairs are into columns. The set bits of what is returned
    /// are those whose gap is below their reach; two spheres in one place have no direction in which to part and
    /// count as apart.
    #[inline(always)]
    fn collect<S: Simd>(
        &mut self,
        simd: S,
        full: usize,
        pairs: &SpherePairs,
        context: &Context<'_>,
    ) -> u64 {
        let spheres = context.spheres;
        let mut touching = 0;
        let input = &mut *self.input;
        let zero = f64x8::splat(simd, 0.0);
        let position = mask64x8::from_bitmask(simd, 0b0000_1111);
        let first_radius = mask64x8::from_bitmask(simd, 0b0000_1000);
        let second_radius = mask64x8::from_bitmask(simd, 0b1000_0000);
        for first in (0..full).step_by(GROUP) {
            let (mut motions, mut spins) = ([zero; 8], [zero; 8]);
            let mut slips = [f64x4::splat(simd, 0.0); 8];
            for l in 0..GROUP {
                let k = self.pair[first + l] as usize;
                let [i, j] = pairs.ends[k].bodies();
                let [a, b] = [&spheres[i], &spheres[j]];
                let of_a = f64x8::simd_from(simd, a.motion);
                let of_b = f64x8::simd_from(simd, b.motion);
                let apart = position.select(of_b - of_a, of_a - of_b);
                let apart = second_radius.select(of_b, apart);
                motions[l] = first_radius.select(of_a, apart);
                let spin: f64x4<S> = a.spin.simd_into(simd);
                spins[l] = spin.combine(b.spin);
                slips[l] = pairs.slip[k].simd_into(simd);
            }
            let [x, y, z, a, u, v, w, b] = transposed(motions);
            let z = context.period.nearest_of_eight(z);
            let square = x * x + y * y + z * z;
            let sum = a + b + f64x8::from_slice(simd, &input.reach[first..first + GROUP]);
            let touches = square.simd_lt(sum * sum) & square.simd_gt(zero);
            touching |= touches.to_bitmask() << first;
            store(&mut input.between, first, [x, y, z]);
            a.store_slice(&mut input.radii[0][first..first + GROUP]);
            store(&mut input.velocity, first, [u, v, w]);
            b.store_slice(&mut input.radii[1][first..first + GROUP]);
            let [x, y, z, a, u, v, w, b] = transposed(spins);
            store(&mut input.spins[0], first, [x, y, z]);
            a.store_slice(&mut input.dashpot_masses[0][first..first + GROUP]);
            store(&mut input.spins[1], first, [u, v, w]);
            b.store_slice(&mut input.dashpot_masses[1][first..first + GROUP]);
            let [x, y, z, _] = four_columns(slips);
            store(&mut input.slip, first, [x, y, z]);
        }
        if pairs.remembers_rolling() {
            for (k, &pair) in self.pair[..full].iter().enumerate() {
                write(&mut input.rolling, k, &pairs.rolling[pair as usize]);
            }
        }
        touching
    }
}

/// Notes when a pair that is apart is to be looked at again.
#[inline(never)]
fn sleep(pairs: &mut SpherePairs, pair: usize, travel: Window<'_, f32>, context: &Context<'_>) {
    let bodies = pairs.ends[pair].bodies();
    let gap = gap(bodies.map(|body| &context.spheres[body]), context.period);
    let ways = travel[bodies[0]] + travel[bodies[1]];
    pairs.wake[pair] = ways + (gap - context.cutoffs.safety);
    pairs.remember(pair, Row::default(), Vector3::zeros());
}

/// Gap of two spheres, m.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the way up to the touch is shortened by a safety distance"
)]
fn gap([a, b]: [&Sphere; 2], period: Period) -> f32 {
    let distance = period.nearest(b.position() - a.position()).norm();
    (distance - a.radius() - b.radius()) as f32
}

/// Writes a vector of each contact of a group into columns.
#[inline(always)]
fn store<S: Simd>(columns: &mut Column, first: usize, values: [f64x8<S>; 3]) {
    for (column, values) in columns.iter_mut().zip(&values) {
        values.store_slice(&mut column[first..first + GROUP]);
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
        output.write(k, &law.between_spheres(&pair, time_step));
    }
}
