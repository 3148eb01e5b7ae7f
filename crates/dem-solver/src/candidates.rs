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

use crate::lanes::{LANES, Lanes, along, load, load_vectors, set_bits, squares};
use crate::pair_force::Slack;
use crate::template::{Group, Packed};
use fearless_simd::f32x16;
use fearless_simd::prelude::*;

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
    /// Centres and radii, padded to whole groups by spheres at an infinite distance.
    groups: Vec<Group>,
    /// Indices in the template.
    index: Vec<u16>,
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
    /// Makes room for all spheres of a template.
    fn reset(&mut self, room: usize) {
        if self.groups.len() < room {
            self.groups.resize(room, Group::default());
            self.index.resize(room * LANES, 0);
        }
        self.n = 0;
    }

    /// Adds sphere number `index`, which is in lane `l` of the centres and radii.
    #[inline(always)]
    fn push(&mut self, centre: &[Lanes; 3], radius: f32, l: usize, index: usize) {
        let place = &mut self.groups[self.n / LANES];
        let lane = self.n % LANES;
        for axis in 0..3 {
            place.centre[axis][lane] = centre[axis][l];
        }
        place.radius[lane] = radius;
        self.index[self.n] = u16::try_from(index).unwrap_or(u16::MAX);
        self.n += 1;
    }

    /// Fills the last group with spheres that touch nothing.
    fn pad(&mut self) {
        for k in self.n..self.n.div_ceil(LANES) * LANES {
            self.groups[k / LANES].centre[0][k % LANES] = f32::INFINITY;
        }
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
    best.as_slice()
        .iter()
        .copied()
        .fold(f32::NEG_INFINITY, f32::max)
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
    let kept_j = &mut scratch.j;
    kept_j.reset(j.groups.len());
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for (k, group) in j.groups.iter().enumerate() {
        let own = load_vectors(simd, &group.centre);
        let centre = [
            along(&own, &[r[0], r[1], r[2]]) + p[0],
            along(&own, &[r[3], r[4], r[5]]) + p[1],
            along(&own, &[r[6], r[7], r[8]]) + p[2],
        ];
        let reach = load(simd, &group.radius) + skin;
        let mut keep = (along(&centre, &normal) - reach).simd_lt(far_of_i);
        for axis in 0..3 {
            keep &= (centre[axis] + reach).simd_gt(i.low[axis]);
            keep &= (centre[axis] - reach).simd_lt(i.high[axis]);
        }
        let keep = keep.to_bitmask();
        if keep == 0 {
            continue;
        }
        let [x, y, z] = centre;
        let centre = [Lanes::from(x), Lanes::from(y), Lanes::from(z)];
        for l in set_bits(keep) {
            kept_j.push(&centre, group.radius[l], l, k * LANES + l);
            let reach = group.radius[l] + skin;
            for axis in 0..3 {
                low[axis] = low[axis].min(centre[axis][l] - reach);
                high[axis] = high[axis].max(centre[axis][l] + reach);
            }
        }
    }
    if kept_j.n == 0 {
        return skin - safety;
    }
    kept_j.pad();

    // Spheres of i that come near that box and the plane before j.
    let kept_i = &mut scratch.i;
    kept_i.reset(i.groups.len());
    for (k, group) in i.groups.iter().enumerate() {
        let (centre, radius) = (load_vectors(simd, &group.centre), load(simd, &group.radius));
        let mut keep = (along(&centre, &normal) + radius + skin).simd_gt(near_of_j);
        for axis in 0..3 {
            keep &= (centre[axis] + radius).simd_gt(low[axis]);
            keep &= (centre[axis] - radius).simd_lt(high[axis]);
        }
        for l in set_bits(keep.to_bitmask()) {
            kept_i.push(&group.centre, group.radius[l], l, k * LANES + l);
        }
    }
    pair_up(simd, kept_i, kept_j, skin, &mut scratch.found);
    skin - safety
}

/// Tests each survivor of i against each of j.
#[inline(always)]
fn pair_up<S: Simd>(simd: S, i: &Kept, j: &Kept, skin: f32, found: &mut Vec<(u16, u16)>) {
    let groups = &j.groups[..j.n.div_ceil(LANES)];
    for a in 0..i.n {
        let (own, l) = (&i.groups[a / LANES], a % LANES);
        let centre = [own.centre[0][l], own.centre[1][l], own.centre[2][l]];
        let reach = own.radius[l] + skin;
        for (b, group) in groups.iter().enumerate() {
            let other = load_vectors(simd, &group.centre);
            let between = [
                other[0] - centre[0],
                other[1] - centre[1],
                other[2] - centre[2],
            ];
            let limit = load(simd, &group.radius) + reach;
            let near = squares(&between).simd_lt(limit * limit);
            for l in set_bits(near.to_bitmask()) {
                found.push((i.index[a], j.index[b * LANES + l]));
            }
        }
    }
}
