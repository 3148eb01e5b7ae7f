//! Forces between bodies of one sphere each, in worlds that have no other bodies.
//!
//! Two passes over some hundred pairs at a time: which are awake, and the contact law over all of those side by
//! side. Nearly all that are awake touch; what the law says of the others is not used.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::Sink;
use crate::context::Context;
use crate::spheres::pairs::SpherePairs;
use crate::window::Window;
use crate::workspace::Workspace;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

/// Pairs looked at together: the known data of them stays in the cache between the passes.
const BLOCK: usize = 1024;

/// Finds the forces between the bodies of a range and those before them.
pub(crate) fn add_sphere_forces(
    level: Level,
    pairs: &mut SpherePairs,
    travel: Window<'_, f32>,
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
    travel: Window<'_, f32>,
    workspace: &mut Workspace,
    context: &Context<'_>,
    sink: &mut impl Sink,
) {
    let (awake, batch) = (&mut workspace.awake, &mut workspace.spheres);
    for first in (0..pairs.len()).step_by(BLOCK) {
        let block = (first, pairs.len().min(first + BLOCK));
        let n_awake = pairs.find_awake(simd, block, travel, awake);
        let mut rest = &awake[..n_awake];
        while !rest.is_empty() {
            let (now, later) = rest.split_at(pairs.of_one_interaction(rest));
            batch.apply(simd, now, pairs, travel, context, sink);
            rest = later;
        }
    }
}
