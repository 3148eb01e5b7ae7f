//! Forces between bodies of one sphere each, in worlds that have no other bodies.
//!
//! Three passes over some hundred pairs at a time: which are awake, which of those touch, and the contact
//! law over the touching ones side by side. No pass branches on what it finds: whether the next pair
//! touches cannot be foreseen.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::Sink;
use crate::contact::Memory;
use crate::context::Context;
use crate::lanes::make_room;
use crate::liquid::bridge_volume;
use crate::spheres::batch::between;
use crate::spheres::pairs::{SpherePairs, TOUCHES};
use crate::spheres::sphere::Sphere;
use crate::workspace::Workspace;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

/// Pairs looked at together: what is known of them stays in the first-level cache between the passes.
const BLOCK: usize = 256;

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
    let is_wet = context.cutoffs.reach > 0.0;
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
            let gap = gap(a, b) - context.cutoffs.safety;
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
