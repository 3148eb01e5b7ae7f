//! Which spheres of two bodies may touch before the bodies have moved by the skin.
//!
//! Single precision throughout: the skin is larger than the rounding ([`Slack`]), and whether a
//! candidate touches is decided in double precision.

#![expect(
    clippy::needless_range_loop,
    reason = "one axis runs through several arrays"
)]
#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::lanes::{LANES, Vectors, along, load, load_vectors, set_bits, squares};
use crate::pair_force::Slack;
use crate::template::Packed;
use fearless_simd::prelude::*;
use fearless_simd::{f32x16, mask32x16, u32x16};

/// The lanes, numbered.
const NUMBERS: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Pose of body j in the principal frame of body i.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RelativeSingle {
    /// Rotation matrix, row by row.
    pub(crate) rotation: [f32; 9],
    /// Position of the centre of j, m.
    pub(crate) position: [f32; 3],
}

/// Spheres of one body that survived the culling, in the frame of body i.
#[derive(Debug, Clone, Default)]
struct Kept {
    /// x, y, z of the centres, padded to whole groups by spheres at an infinite distance, m.
    centre: [Vec<f32>; 3],
    /// Radii, m.
    radius: Vec<f32>,
    /// Indices in the template.
    index: Vec<u32>,
    /// Number of survivors.
    n: usize,
}

/// Buffers of the search, kept between calls.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    /// Survivors of body i.
    i: Kept,
    /// Survivors of body j.
    j: Kept,
    /// Candidates found: (sphere of i, sphere of j).
    pub(crate) found: Vec<(u16, u16)>,
}

impl Kept {
    /// Makes room for all spheres of a template of so many groups.
    fn reset(&mut self, n_groups: usize) {
        // What is added goes to whole groups from the first free place on.
        let room = (n_groups + 1) * LANES;
        if self.index.len() < room {
            self.centre
                .iter_mut()
                .for_each(|axis| axis.resize(room, 0.0));
            self.radius.resize(room, 0.0);
            self.index.resize(room, 0);
        }
        self.n = 0;
    }

    /// Adds those spheres of a group that a mask keeps; `index` is that of the first of the group.
    #[inline(always)]
    fn add<S: Simd>(
        &mut self,
        keep: mask32x16<S>,
        centre: &Vectors<S>,
        radius: f32x16<S>,
        index: u32x16<S>,
    ) {
        let place = self.n..self.n + LANES;
        for axis in 0..3 {
            let kept = centre[axis].compress(keep);
            kept.store_slice(&mut self.centre[axis][place.clone()]);
        }
        radius
            .compress(keep)
            .store_slice(&mut self.radius[place.clone()]);
        index.compress(keep).store_slice(&mut self.index[place]);
        self.n += keep.to_bitmask().count_ones() as usize;
    }

    /// Fills the last group with spheres that touch nothing.
    fn pad(&mut self) {
        self.centre[0][self.n..self.n + LANES].fill(f32::INFINITY);
    }
}

/// Farthest reach of a template along a direction of its own frame, m.
#[inline(always)]
fn support<S: Simd>(simd: S, packed: &Packed, direction: &[f32; 3]) -> f32 {
    let mut best = f32x16::splat(simd, f32::NEG_INFINITY);
    for group in &packed.groups {
        let centre = load_vectors(simd, &group.centre);
        best = best.max(along(&centre, direction) + load(simd, &group.radius));
    }
    best.reduce_max()
}

/// Lists in `scratch.found` all pairs of spheres whose gap is below the skin.
///
/// Returns a lower bound of the gap of all pairs that are not listed, m: the skin less the
/// safety, or more where a plane between the bodies proves more.
#[inline(always)]
pub(crate) fn search<S: Simd>(
    simd: S,
    i: &Packed,
    j: &Packed,
    pose: &RelativeSingle,
    slack: Slack,
    scratch: &mut Scratch,
) -> f32 {
    let Slack { skin, safety, .. } = slack;
    scratch.found.clear();
    let (r, p) = (&pose.rotation, &pose.position);
    let distance = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt().max(1e-12);
    let normal = [p[0] / distance, p[1] / distance, p[2] / distance];
    let back = [
        -(r[0] * normal[0] + r[3] * normal[1] + r[6] * normal[2]),
        -(r[1] * normal[0] + r[4] * normal[1] + r[7] * normal[2]),
        -(r[2] * normal[0] + r[5] * normal[1] + r[8] * normal[2]),
    ];
    let far_of_i = support(simd, i, &normal);
    let near_of_j = distance - support(simd, j, &back);
    let gap = near_of_j - far_of_i - safety;
    if gap > skin {
        return gap;
    }

    // Spheres of j that come near the box of i and the plane before it, and the box of these.
    let infinite = f32x16::splat(simd, f32::INFINITY);
    let lanes = u32x16::from_slice(simd, &NUMBERS);
    let kept_j = &mut scratch.j;
    kept_j.reset(j.groups.len());
    let (mut low, mut high) = ([infinite; 3], [-infinite; 3]);
    for (first, group) in (0_u32..).step_by(LANES).zip(&j.groups) {
        let own = load_vectors(simd, &group.centre);
        let centre = [
            along(&own, &[r[0], r[1], r[2]]) + p[0],
            along(&own, &[r[3], r[4], r[5]]) + p[1],
            along(&own, &[r[6], r[7], r[8]]) + p[2],
        ];
        let radius = load(simd, &group.radius);
        let reach = radius + skin;
        let mut keep = (along(&centre, &normal) - reach).simd_lt(far_of_i);
        for axis in 0..3 {
            keep &= (centre[axis] + reach).simd_gt(i.low[axis]);
            keep &= (centre[axis] - reach).simd_lt(i.high[axis]);
        }
        if keep.to_bitmask() == 0 {
            continue;
        }
        kept_j.add(keep, &centre, radius, lanes + first);
        for axis in 0..3 {
            low[axis] = low[axis].min(keep.select(centre[axis] - reach, infinite));
            high[axis] = high[axis].max(keep.select(centre[axis] + reach, -infinite));
        }
    }
    if kept_j.n == 0 {
        return skin - safety;
    }
    kept_j.pad();
    // Plain code: what is given to map would not be inlined.
    let low = [
        low[0].reduce_min(),
        low[1].reduce_min(),
        low[2].reduce_min(),
    ];
    let high = [
        high[0].reduce_max(),
        high[1].reduce_max(),
        high[2].reduce_max(),
    ];

    // Spheres of i that come near that box and the plane before j.
    let kept_i = &mut scratch.i;
    kept_i.reset(i.groups.len());
    for (first, group) in (0_u32..).step_by(LANES).zip(&i.groups) {
        let (centre, radius) = (load_vectors(simd, &group.centre), load(simd, &group.radius));
        let mut keep = (along(&centre, &normal) + radius + skin).simd_gt(near_of_j);
        for axis in 0..3 {
            keep &= (centre[axis] + radius).simd_gt(low[axis]);
            keep &= (centre[axis] - radius).simd_lt(high[axis]);
        }
        if keep.to_bitmask() != 0 {
            kept_i.add(keep, &centre, radius, lanes + first);
        }
    }
    pair_up(simd, kept_i, kept_j, skin, &mut scratch.found);
    skin - safety
}

/// Tests each survivor of i against each of j.
#[inline(always)]
fn pair_up<S: Simd>(simd: S, i: &Kept, j: &Kept, skin: f32, found: &mut Vec<(u16, u16)>) {
    let number = |index: u32| u16::try_from(index).unwrap_or(u16::MAX);
    for a in 0..i.n {
        let reach = i.radius[a] + skin;
        for first in (0..j.n).step_by(LANES) {
            let block = first..first + LANES;
            let other = |axis: usize| f32x16::from_slice(simd, &j.centre[axis][block.clone()]);
            let between = [
                other(0) - i.centre[0][a],
                other(1) - i.centre[1][a],
                other(2) - i.centre[2][a],
            ];
            let limit = f32x16::from_slice(simd, &j.radius[block.clone()]) + reach;
            let near = squares(&between).simd_lt(limit * limit);
            for l in set_bits(near.to_bitmask()) {
                found.push((number(i.index[a]), number(j.index[first + l])));
            }
        }
    }
}
