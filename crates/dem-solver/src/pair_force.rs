//! Forces between bodies.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::Batch;
use crate::bodies::Bodies;
use crate::contact::{Interaction, Mover, SpherePair};
use crate::neighbours::{Chunk, Neighbours, Touch};
use crate::template::Template;
use crate::world::Settings;
use multiversion::multiversion;
use nalgebra::Vector3;
use wide::f32x8;

/// Distances of the sphere lists.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slack {
    /// Gap up to which spheres are listed, at least twice the safety, m.
    pub(crate) skin: f32,
    /// Bound of the rounding of a gap in single precision, m.
    pub(crate) safety: f32,
}

impl Slack {
    /// Distances for bodies of a largest bounding radius (m).
    ///
    /// A gap is the difference of coordinates below twice the radius plus the margin. Each comes
    /// from about ten roundings of 6e-8 of that size, some of them in three components.
    #[expect(clippy::cast_possible_truncation, reason = "the skin may be anything")]
    pub(crate) fn new(largest_radius: f64, settings: &Settings) -> Self {
        let safety = 2e-6 * (2.0 * largest_radius + settings.margin);
        Self {
            skin: (settings.skin + 2.0 * safety) as f32,
            safety: safety as f32,
        }
    }
}

/// What the force loops need beside bodies and lists.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// Body types.
    pub(crate) templates: &'a [Template],
    /// Interaction of material a with material b at `a * n_materials + b`.
    pub(crate) interactions: &'a [Interaction],
    /// Number of materials.
    pub(crate) n_materials: usize,
    /// Distances of the sphere lists.
    pub(crate) slack: Slack,
    /// Time step, s.
    pub(crate) time_step: f64,
}

impl<'a> Context<'a> {
    /// Place of the interaction of two materials in the table.
    #[inline(always)]
    pub(crate) fn interaction_index(&self, a: usize, b: usize) -> usize {
        a * self.n_materials + b
    }

    /// Interaction of two materials.
    #[inline(always)]
    pub(crate) fn interaction(&self, a: usize, b: usize) -> &'a Interaction {
        &self.interactions[self.interaction_index(a, b)]
    }
}

/// Lanes of a chunk whose spheres touch, as bits.
#[inline(always)]
fn touching_lanes(chunk: &Chunk, ri: &[f32; 9], rj: &[f32; 9], d: &[f32; 3]) -> u32 {
    let [ix, iy, iz] = chunk.i.map(f32x8::from);
    let [jx, jy, jz] = chunk.j.map(f32x8::from);
    let mut squares = f32x8::splat(0.0);
    for axis in 0..3 {
        let (a, b) = (&ri[3 * axis..3 * axis + 3], &rj[3 * axis..3 * axis + 3]);
        let p = jx * b[0] + jy * b[1] + jz * b[2];
        let q = ix * a[0] + iy * a[1] + iz * a[2];
        let c = p - q + d[axis];
        squares += c * c;
    }
    squares.simd_lt(f32x8::from(chunk.limit)).to_bitmask()
}

/// Adds the forces between all bodies.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn add_pair_forces(
    neighbours: &mut Neighbours,
    bodies: &mut Bodies,
    batch: &mut Batch,
    context: &Context<'_>,
) {
    neighbours.next_touches.clear();
    for i in 0..bodies.len() {
        let range = neighbours.start[i] as usize..neighbours.start[i + 1] as usize;
        let travel = bodies.travel[i];
        for k in range {
            let head = neighbours.heads[k];
            let j = head.j as usize;
            if travel + bodies.travel[j] > head.limit {
                neighbours.refresh(k, i, bodies, context.templates, context.slack);
            }
            if neighbours.lists[k].n_chunks > 0 {
                collect_pair(neighbours, k, [i, j], bodies, batch, context);
            }
        }
    }
    let touches = &mut neighbours.next_touches;
    batch.apply(context.interactions, context.time_step, bodies, touches);
    std::mem::swap(&mut neighbours.touches, &mut neighbours.next_touches);
}

/// Puts the touching spheres of pair `k` into the batch.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the overlap test has a safety distance"
)]
fn collect_pair(
    neighbours: &mut Neighbours,
    k: usize,
    [i, j]: [usize; 2],
    bodies: &mut Bodies,
    batch: &mut Batch,
    context: &Context<'_>,
) {
    let lists = &mut neighbours.lists[k];
    let old = lists.touch as usize..(lists.touch + lists.n_touches) as usize;
    let first = neighbours.next_touches.len();
    let [a, b] = [i, j].map(|body| context.templates[bodies.template[body]].material);
    let interaction = context.interaction_index(a, b);
    let difference = bodies.position[j] - bodies.position[i];
    let single = [
        difference.x as f32,
        difference.y as f32,
        difference.z as f32,
    ];
    let (ri, rj) = (bodies.rotation_single[i], bodies.rotation_single[j]);
    let chunks = lists.chunk as usize..(lists.chunk + lists.n_chunks) as usize;
    for chunk in &neighbours.chunks[chunks] {
        let mut mask = touching_lanes(chunk, &ri, &rj, &single);
        while mask != 0 {
            let key = chunk.key[mask.trailing_zeros() as usize];
            mask &= mask - 1;
            if let Some(mut pair) = sphere_pair(key, [i, j], bodies, context.templates) {
                let known = neighbours.touches[old.clone()]
                    .iter()
                    .find(|t| t.key == key);
                pair.slip = known.map_or_else(Vector3::zeros, |touch| touch.slip);
                let touches = &mut neighbours.next_touches;
                if batch.must_be_applied(interaction) {
                    batch.apply(context.interactions, context.time_step, bodies, touches);
                }
                batch.push(interaction, [i, j], touches.len(), &pair);
                touches.push(Touch {
                    key,
                    slip: pair.slip,
                });
            }
        }
    }
    lists.touch = first as u32;
    lists.n_touches = (neighbours.next_touches.len() - first) as u32;
}

/// Geometry and motion of two spheres, without a slip; none if they do not touch.
#[inline(always)]
pub(crate) fn sphere_pair(
    key: u32,
    [i, j]: [usize; 2],
    bodies: &Bodies,
    templates: &[Template],
) -> Option<SpherePair> {
    let (u, v) = ((key >> 16) as usize, (key & 0xffff) as usize);
    let (a, b) = (
        &templates[bodies.template[i]],
        &templates[bodies.template[j]],
    );
    let offset_i = bodies.rotation[i] * a.centres[u];
    let offset_j = bodies.rotation[j] * b.centres[v];
    let between = (bodies.position[j] + offset_j) - (bodies.position[i] + offset_i);
    let sum = a.radii[u] + b.radii[v];
    let square = between.norm_squared();
    if square >= sum * sum || square == 0.0 {
        return None;
    }
    let (mass_i, mass_j) = (a.dashpot_masses[u], b.dashpot_masses[v]);
    Some(SpherePair {
        between,
        offset_i,
        offset_j,
        velocity: bodies.velocity[i] - bodies.velocity[j],
        spins: [bodies.spin[i], bodies.spin[j]],
        slip: Vector3::zeros(),
        radii: [a.radii[u], b.radii[v]],
        reduced_mass: mass_i * mass_j / (mass_i + mass_j),
    })
}

/// Motion of a body.
#[inline(always)]
pub(crate) fn mover(bodies: &Bodies, k: usize) -> Mover {
    Mover {
        position: bodies.position[k],
        velocity: bodies.velocity[k],
        spin: bodies.spin[k],
    }
}
