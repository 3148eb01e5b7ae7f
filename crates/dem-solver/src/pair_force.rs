//! Forces between bodies.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Batch, Sink};
use crate::bodies::Bodies;
use crate::contact::{Memory, SpherePair};
use crate::context::{Context, Cutoffs};
use crate::lanes::{NUMBERS, keep, make_room};
use crate::liquid::bridge_volume;
use crate::neighbours::{CHUNK, Chunk, Due, Neighbours};
use crate::periodic::Period;
use crate::shared_mass::{Shares, Turned};
use crate::sphere_contact::SphereContact;
use crate::template::Template;
use crate::workspace::Workspace;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x8, u32x8};
use nalgebra::{Matrix3, Vector3};

/// Bodies whose pairs are looked at together. Known data of a pair that is awake lies anywhere among those that sleep;
/// for some at a time it is fetched side by side, and stays in the first-level cache until it is used.
const BLOCK: usize = 16;

/// Loads stored whole numbers into a register as `f32`.
#[inline(always)]
fn numbers_of<S: Simd>(simd: S, stored: &[i16; CHUNK]) -> f32x8<S> {
    let mut numbers = [0.0; CHUNK];
    for (number, &cell) in numbers.iter_mut().zip(stored) {
        *number = f32::from(cell);
    }
    f32x8::from_slice(simd, &numbers)
}

/// Squares of the distances of the sphere centres of a chunk, m².
///
/// `ri` and `rj` turn the stored cells of both bodies into metres, row by row; `d` is the way
/// from body i to body j, m.
#[inline(always)]
fn distances<S: Simd>(
    simd: S,
    chunk: &Chunk,
    ri: &[f32; 9],
    rj: &[f32; 9],
    d: &[f32; 3],
) -> f32x8<S> {
    // Plain code: what is given to map would not be inlined.
    let [x, y, z] = &chunk.i;
    let i = [
        numbers_of(simd, x),
        numbers_of(simd, y),
        numbers_of(simd, z),
    ];
    let [x, y, z] = &chunk.j;
    let j = [
        numbers_of(simd, x),
        numbers_of(simd, y),
        numbers_of(simd, z),
    ];
    let mut square = f32x8::splat(simd, 0.0);
    let rows = ri.as_chunks::<3>().0.iter().zip(rj.as_chunks::<3>().0);
    for ((ri, rj), &d) in rows.zip(d) {
        let mut own = i[0].mul_sub(ri[0], d);
        own = i[1].mul_add(ri[1], own);
        own = i[2].mul_add(ri[2], own);
        let mut between = j[0].mul_sub(rj[0], own);
        between = j[1].mul_add(rj[1], between);
        between = j[2].mul_add(rj[2], between);
        square = between.mul_add(between, square);
    }
    square
}

/// Writes the keys of all candidates that may touch into `near`; returns their number and, if there are
/// none, how much farther the nearest centres are than the largest distance of a contact (m).
///
/// `square` is that of the largest distance at which two spheres can have a contact (m²), `n` the number of
/// candidates, the other arguments as of [`distances`].
#[inline(always)]
fn find_near<S: Simd>(
    simd: S,
    (chunks, n): (&[Chunk], u32),
    square: f32,
    ri: &[f32; 9],
    rj: &[f32; 9],
    d: &[f32; 3],
    near: &mut Vec<u32>,
) -> (usize, f32) {
    make_room(near, chunks.len() * CHUNK);
    let mut numbers = u32x8::from_slice(simd, &NUMBERS);
    let mut n_near = 0;
    let mut nearest = f32x8::splat(simd, f32::INFINITY);
    for chunk in chunks {
        let squares = distances(simd, chunk, ri, rj, d);
        nearest = nearest.min(squares);
        let touching = squares.simd_lt(square) & numbers.simd_lt(n);
        let keys = u32x8::from_slice(simd, &chunk.key);
        n_near = keep(near, n_near, keys, touching);
        // The places of the next chunk.
        numbers += NUMBERS[CHUNK - 1] + 1;
    }
    let gap = if n_near > 0 {
        f32::NEG_INFINITY
    } else {
        nearest.reduce_min().sqrt() - square.sqrt()
    };
    (n_near, gap)
}

/// Finds the forces between the bodies of a range and those before them.
pub(crate) fn add_pair_forces(
    level: Level,
    neighbours: &mut Neighbours,
    bodies: &Bodies,
    workspace: &mut Workspace,
    context: &Context<'_>,
    sink: &mut impl Sink,
) {
    dispatch!(level, simd => add_pair_forces_on(simd, neighbours, bodies, workspace, context, sink));
}

/// [`add_pair_forces`] on one instruction set.
#[inline(always)]
fn add_pair_forces_on<S: Simd>(
    simd: S,
    neighbours: &mut Neighbours,
    bodies: &Bodies,
    workspace: &mut Workspace,
    context: &Context<'_>,
    sink: &mut impl Sink,
) {
    let Workspace {
        batch,
        awake,
        due,
        stale,
        near,
        touches,
        scratch,
        ..
    } = workspace;
    touches.clear();
    let mut collector = Collector {
        simd,
        bodies,
        batch,
        near,
        touches,
        context,
        sink,
    };
    let range = neighbours.range();
    for first in range.clone().step_by(BLOCK) {
        due.clear();
        for j in first..range.end.min(first + BLOCK) {
            let n_awake = neighbours.find_awake(simd, j, &bodies.travel, awake);
            let pairs = awake[..n_awake].iter();
            due.extend(pairs.map(|&pair| neighbours.due(pair, j)));
        }
        neighbours.find_stale(due, &bodies.travel, stale);
        // The reads of all are started before the first is used: the processor waits for memory once.
        neighbours.fetch_poses(stale);
        for pair in stale.iter() {
            neighbours.refresh(simd, pair, bodies, context, scratch);
        }
        neighbours.fetch_candidates(due);
        for pair in due.iter() {
            collector.collect_listed(neighbours, pair);
        }
    }
    collector.apply();
    // The touches of this step replace those of the last, in the order of the pairs.
    std::mem::swap(&mut neighbours.touches, touches);
}

/// Puts touching spheres into the batch; what it works with beside the lists.
struct Collector<'a, S, K> {
    simd: S,
    bodies: &'a Bodies,
    batch: &'a mut Batch,
    /// Keys of the candidates of one pair that may touch.
    near: &'a mut Vec<u32>,
    /// Touching pairs of spheres of this step.
    touches: &'a mut Vec<SphereContact>,
    context: &'a Context<'a>,
    sink: &'a mut K,
}

impl<S: Simd, K: Sink> Collector<'_, S, K> {
    /// Works off the batch.
    #[inline(always)]
    fn apply(&mut self) {
        let context = self.context;
        self.batch.apply(
            self.simd,
            context.interactions,
            context.time_step,
            self.sink,
            self.touches,
        );
    }

    /// Works off the batch if it has no place for a contact of an interaction. To be called before anything of the
    /// contact is read: known values would have to wait in memory.
    #[inline(always)]
    fn make_place(&mut self, interaction: usize) {
        if self.batch.must_be_applied(interaction) {
            self.apply();
        }
    }

    /// Puts a contact of two bodies into the place that was made in the batch, and what it remembers into the
    /// touches.
    #[inline(always)]
    fn put(&mut self, (interaction, bodies): (usize, [usize; 2]), key: u32, pair: &SpherePair) {
        self.batch
            .push(interaction, bodies, self.touches.len(), pair);
        self.touches.push(SphereContact {
            key,
            memory: pair.memory,
        });
    }

    /// Puts the touching spheres in the list of a pair into the batch.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the overlap test has a safety distance"
    )]
    fn collect_listed(&mut self, neighbours: &mut Neighbours, pair: &Due) {
        let (bodies, context) = (self.bodies, self.context);
        let (k, [i, j]) = (pair.pair(), pair.bodies());
        let lists = &mut neighbours.lists[k];
        if lists.n_candidates == 0 {
            return;
        }
        let templates = [i, j].map(|body| &context.templates[bodies.template[body]]);
        let old = lists.touches();
        let first = self.touches.len();
        let interaction = context.interaction_index(templates[0].material, templates[1].material);
        let law = &context.interactions[interaction];
        let volume = bridge_volume(law, context.liquid, [i, j]);
        let reach = law.reach(volume);
        let between = context
            .period
            .nearest(bodies.position[j] - bodies.position[i]);
        let single = [0, 1, 2].map(|axis| between[axis] as f32);
        let (ri, rj) = (&bodies.cells_to_metres[i], &bodies.cells_to_metres[j]);
        let Cutoffs {
            reach: holds,
            safety,
            ..
        } = context.cutoffs;
        let largest = templates[0].packed.largest + templates[1].packed.largest + holds + safety;
        let chunks = (&neighbours.chunks[lists.chunks()], lists.n_candidates);
        let found = &mut *self.near;
        let square = largest * largest;
        let (n_near, gap) = find_near(self.simd, chunks, square, ri, rj, &single, found);
        if n_near == 0 {
            // The touches move on without a pair that sleeps.
            (lists.touch, lists.n_touches) = (0, 0);
            neighbours.sleep(k, pair.travel(&bodies.travel) + gap);
            return;
        }
        let frame = PairFrame::new(bodies, [i, j], context.period);
        let near = self.near[..n_near].iter();
        let touching = near.filter_map(|&key| frame.sphere_pair(key, templates, 0.0));
        let shares = Shares::new(frame.turned(templates), touching.map(|pair| pair.touch()));
        for candidate in 0..n_near {
            self.make_place(interaction);
            let key = self.near[candidate];
            // A pair has few touches: a search from the front beats any map.
            let known = neighbours.touches[old.clone()]
                .iter()
                .find(|t| t.key == key);
            // A bridge that exists holds up to its rupture; a new one forms at contact only.
            let gap = if known.is_some() { reach } else { 0.0 };
            if let Some(mut pair) = frame.sphere_pair(key, templates, gap) {
                pair.memory = known.map_or_else(Memory::default, |touch| touch.memory);
                pair.bridge_volume = volume;
                pair.share_masses(shares.as_ref());
                self.put((interaction, [i, j]), key, &pair);
            }
        }
        lists.touch = first as u32;
        lists.n_touches = (self.touches.len() - first) as u32;
    }
}

/// Whether spheres whose centres are `between` (m) have a gap above that of a sum of lengths (m);
/// two in one place have no direction in which to part and count as apart.
#[inline(always)]
fn are_apart(between: &Vector3<f64>, sum: f64) -> bool {
    let square = between.norm_squared();
    square >= sum * sum || square == 0.0
}

/// What all pairs of spheres of two bodies have in common.
#[derive(Debug)]
pub(crate) struct PairFrame<'a> {
    /// From the principal frames to the world.
    rotations: [&'a Matrix3<f64>; 2],
    /// From the centre of i to the nearest image of the centre of j, m.
    difference: Vector3<f64>,
    /// Velocity of i minus that of j, m/s.
    velocity: Vector3<f64>,
    /// Angular velocities, rad/s.
    spins: [Vector3<f64>; 2],
}

impl<'a> PairFrame<'a> {
    /// Of two bodies.
    #[inline(always)]
    pub(crate) fn new(bodies: &'a Bodies, [i, j]: [usize; 2], period: Period) -> Self {
        Self {
            rotations: [&bodies.rotation[i], &bodies.rotation[j]],
            difference: period.nearest(bodies.position[j] - bodies.position[i]),
            velocity: bodies.velocity[i] - bodies.velocity[j],
            spins: [bodies.spin[i], bodies.spin[j]],
        }
    }

    /// Both bodies, of these types, with their orientations.
    #[inline(always)]
    pub(crate) fn turned(&self, [a, b]: [&'a Template; 2]) -> [Turned<'a>; 2] {
        [(a, self.rotations[0]), (b, self.rotations[1])]
            .map(|(template, rotation)| Turned { template, rotation })
    }

    /// Geometry and motion of two spheres, without memory and liquid; none if their gap is above `reach` (m):
    /// 0 for spheres that must touch.
    #[inline(always)]
    pub(crate) fn sphere_pair(
        &self,
        key: u32,
        [a, b]: [&Template; 2],
        reach: f64,
    ) -> Option<SpherePair> {
        let u = &a.spheres[(key >> 16) as usize];
        let v = &b.spheres[(key & 0xffff) as usize];
        let offset_i = self.rotations[0] * u.centre;
        let offset_j = self.rotations[1] * v.centre;
        let between = self.difference + (offset_j - offset_i);
        let sum = u.radius + v.radius + reach;
        if are_apart(&between, sum) {
            return None;
        }
        Some(SpherePair {
            between,
            offset_i,
            offset_j,
            velocity: self.velocity,
            spins: self.spins,
            memory: Memory::default(),
            radii: [u.radius, v.radius],
            dashpot_masses: [u.dashpot_mass, v.dashpot_mass],
            bridge_volume: 0.0,
        })
    }
}
