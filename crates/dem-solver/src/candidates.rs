//! Which spheres of two bodies may touch before the bodies have moved by the skin.
//!
//! Single precision throughout: the skin is larger than the rounding ([`Cutoffs`]), and whether a
//! candidate touches is decided in double precision.

#![expect(
    clippy::needless_range_loop,
    reason = "one axis runs through several arrays"
)]
#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::context::Cutoffs;
use crate::lanes::{
    HALF, LANES, Lanes, Vectors, along, keep, load, load_vectors, make_room, set_bits, squares,
};
use crate::template::Packed;
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f32x16, mask32x16, u32x16};

/// Pose of body j in the principal frame of body i.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RelativeSingle {
    /// Rotation matrix, row by row.
    pub(crate) rotation: [f32; 9],
    /// Position of the centre of j, m.
    pub(crate) position: [f32; 3],
}

/// The part of body j that decides how long a list holds.
///
/// The farther a sphere is from the patch, the farther it is from body i: by [`SLOPE`] of the way beyond the patch's radius
/// at least. So a turn of up to the slope brings no sphere beyond the patch nearer than one in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patch {
    /// Its middle in the principal frame of j, m.
    pub(crate) centre: [f32; 3],
    /// Its radius, m.
    pub(crate) radius: f32,
}

/// Slope at which a body must fall away from its neighbour beyond the patch; a list is rebuilt after a larger turn.
pub(crate) const SLOPE: f32 = 0.25;

/// A box in the frame of body i.
#[derive(Debug, Clone, Copy)]
struct Region {
    /// Lower corner, m.
    low: [f32; 3],
    /// Upper corner, m.
    high: [f32; 3],
}

/// Spheres of body j that survived the culling, in the frame of body i.
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
    /// How far the spheres of i and of j reach towards the other body, group by group, m.
    reaches: [Vec<Lanes>; 2],
    /// Survivors of body i, as indices in the template.
    i: Vec<u32>,
    /// Survivors of body j.
    j: Kept,
    /// Candidates found: (sphere of i, sphere of j), in rising order.
    pub(crate) found: Vec<(u16, u16)>,
}

impl Kept {
    /// Makes room for all spheres of a template of so many groups.
    fn reset(&mut self, n_groups: usize) {
        // What is added goes to whole groups from the first free place on.
        let room = (n_groups + 1) * LANES;
        self.centre
            .iter_mut()
            .for_each(|axis| make_room(axis, room));
        make_room(&mut self.radius, room);
        make_room(&mut self.index, room);
        self.n = 0;
    }

    /// Adds those spheres of a group that a mask keeps.
    #[inline(always)]
    fn add<S: Simd>(
        &mut self,
        mask: mask32x16<S>,
        centre: &Vectors<S>,
        radius: f32x16<S>,
        index: u32x16<S>,
    ) {
        let place = self.n..self.n + LANES;
        for axis in 0..3 {
            let kept = centre[axis].compress(mask);
            kept.store_slice(&mut self.centre[axis][place.clone()]);
        }
        radius.compress(mask).store_slice(&mut self.radius[place]);
        self.n = keep(&mut self.index, self.n, index, mask);
    }

    /// Keeps the spheres of body j that reach beyond a plane, `least` away from its centre (m), and come
    /// nearer to the box of body i than a skin (m); returns the box of these. `reaches` are those of [`support`].
    #[inline(always)]
    fn cull<S: Simd>(
        &mut self,
        simd: S,
        (packed, reaches): (&Packed, &[Lanes]),
        least: f32,
        pose: &RelativeSingle,
        (other, skin): (&Packed, f32),
    ) -> Region {
        let (r, p) = (&pose.rotation, &pose.position);
        let infinite = f32x16::splat(simd, f32::INFINITY);
        let (mut low, mut high) = ([infinite; 3], [-infinite; 3]);
        self.reset(packed.groups.len());
        for (group, reaches) in packed.groups.iter().zip(reaches) {
            let mut mask = load(simd, reaches).simd_gt(least);
            // Most groups are on the far side as a whole.
            if mask.to_bitmask() == 0 {
                continue;
            }
            let own = load_vectors(simd, &group.centre);
            let centre = [
                along(&own, &[r[0], r[1], r[2]]) + p[0],
                along(&own, &[r[3], r[4], r[5]]) + p[1],
                along(&own, &[r[6], r[7], r[8]]) + p[2],
            ];
            let radius = load(simd, &group.radius);
            let reach = radius + skin;
            for axis in 0..3 {
                mask &= (centre[axis] + reach).simd_gt(other.low[axis]);
                mask &= (centre[axis] - reach).simd_lt(other.high[axis]);
            }
            if mask.to_bitmask() == 0 {
                continue;
            }
            let index = u32x16::from_slice(simd, &group.index);
            self.add(mask, &centre, radius, index);
            for axis in 0..3 {
                low[axis] = low[axis].min(mask.select(centre[axis] - reach, infinite));
                high[axis] = high[axis].max(mask.select(centre[axis] + reach, -infinite));
            }
        }
        self.pad();
        // Plain code: what is given to map would not be inlined.
        Region {
            low: [
                low[0].reduce_min(),
                low[1].reduce_min(),
                low[2].reduce_min(),
            ],
            high: [
                high[0].reduce_max(),
                high[1].reduce_max(),
                high[2].reduce_max(),
            ],
        }
    }

    /// Fills the last group with spheres that touch nothing.
    fn pad(&mut self) {
        self.centre[0][self.n..self.n + LANES].fill(f32::INFINITY);
    }
}

/// Writes how far each sphere of a template reaches along a direction of its own frame, m; returns the
/// farthest.
#[inline(always)]
fn support<S: Simd>(
    simd: S,
    packed: &Packed,
    direction: &[f32; 3],
    reaches: &mut Vec<Lanes>,
) -> f32 {
    make_room(reaches, packed.groups.len());
    let mut best = f32x16::splat(simd, f32::NEG_INFINITY);
    for (group, reach) in packed.groups.iter().zip(reaches) {
        let centre = load_vectors(simd, &group.centre);
        let own = along(&centre, direction) + load(simd, &group.radius);
        own.store_slice(reach);
        best = best.max(own);
    }
    best.reduce_max()
}

/// The patch of body j about a point `middle` (m, in the frame of i): the smallest one such that each sphere beyond it reaches
/// less far than `level` (m) towards body i by the slope. `reaches` are those of [`support`].
#[inline(always)]
fn patch_about<S: Simd>(
    simd: S,
    (packed, reaches): (&Packed, &[Lanes]),
    level: f32,
    middle: [f32; 3],
    pose: &RelativeSingle,
) -> Patch {
    let (r, p) = (&pose.rotation, &pose.position);
    let [x, y, z] = [middle[0] - p[0], middle[1] - p[1], middle[2] - p[2]];
    let centre = [
        r[0] * x + r[3] * y + r[6] * z,
        r[1] * x + r[4] * y + r[7] * z,
        r[2] * x + r[5] * y + r[8] * z,
    ];
    let mut farthest = f32x16::splat(simd, 0.0);
    for (group, reaches) in packed.groups.iter().zip(reaches) {
        let own = load_vectors(simd, &group.centre);
        let way = [own[0] - centre[0], own[1] - centre[1], own[2] - centre[2]];
        let below = (-load(simd, reaches) + level).max(0.0);
        let beyond = squares(&way).sqrt() - below * (1.0 / SLOPE);
        farthest = farthest.max(beyond);
    }
    Patch {
        centre,
        radius: farthest.reduce_max(),
    }
}

/// Lists in `scratch.found` all pairs of spheres whose gap is below the skin.
///
/// Returns a lower bound of the gap of all pairs that are not listed, m: the skin less the
/// safety, or more where a plane between the bodies proves more; and the patch of body j that keeps to it.
#[inline(always)]
pub(crate) fn search<S: Simd>(
    simd: S,
    i: &Packed,
    j: &Packed,
    pose: &RelativeSingle,
    cutoffs: Cutoffs,
    scratch: &mut Scratch,
) -> (f32, Patch) {
    let Cutoffs { skin, safety, .. } = cutoffs;
    let Scratch {
        reaches: [reaches_i, reaches_j],
        i: kept_i,
        j: kept_j,
        found,
    } = scratch;
    found.clear();
    let (r, p) = (&pose.rotation, &pose.position);
    let distance = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt().max(1e-12);
    let normal = [p[0] / distance, p[1] / distance, p[2] / distance];
    let back = [
        -(r[0] * normal[0] + r[3] * normal[1] + r[6] * normal[2]),
        -(r[1] * normal[0] + r[4] * normal[1] + r[7] * normal[2]),
        -(r[2] * normal[0] + r[5] * normal[1] + r[8] * normal[2]),
    ];
    let far_of_i = support(simd, i, &normal, reaches_i);
    let far_of_j = support(simd, j, &back, reaches_j);
    // The plane across the line of centres that separates the bodies, if there is one, proves their gap.
    let gap = distance - far_of_i - far_of_j - safety;
    let ahead = |axis: usize| p[axis] - normal[axis] * far_of_j;
    let mut middle = [ahead(0), ahead(1), ahead(2)];
    if gap > skin {
        let patch = patch_about(simd, (j, reaches_j), far_of_j, middle, pose);
        return (gap, patch);
    }
    let least_of_j = distance - far_of_i - skin;
    // Each body is culled by the box of the other, so that few of some hundred spheres are tested pair by pair.
    let near = kept_j.cull(simd, (j, reaches_j), least_of_j, pose, (i, skin));
    if kept_j.n > 0 {
        let least_of_i = distance - far_of_j - skin;
        let n_i = cull(simd, (i, reaches_i), least_of_i, &near, kept_i);
        pair_up(simd, &kept_i[..n_i], &i.spheres, kept_j, skin, found);
        // The order of groups depends on the width of the registers, the order of the forces must not.
        found.sort_unstable();
        for axis in 0..3 {
            middle[axis] = 0.5 * (near.low[axis] + near.high[axis]);
        }
    }
    let patch = patch_about(simd, (j, reaches_j), least_of_j, middle, pose);
    (skin - safety, patch)
}

/// Writes the spheres of body i into `kept` that reach beyond a plane, `least` away from the centre (m), and come
/// near a box. `reaches` are those of [`support`]. Returns their number.
#[inline(always)]
fn cull<S: Simd>(
    simd: S,
    (packed, reaches): (&Packed, &[Lanes]),
    least: f32,
    near: &Region,
    kept: &mut Vec<u32>,
) -> usize {
    make_room(kept, (packed.groups.len() + 1) * LANES);
    let mut n = 0;
    for (group, reaches) in packed.groups.iter().zip(reaches) {
        let mut mask = load(simd, reaches).simd_gt(least);
        if mask.to_bitmask() == 0 {
            continue;
        }
        let (centre, radius) = (load_vectors(simd, &group.centre), load(simd, &group.radius));
        for axis in 0..3 {
            mask &= (centre[axis] + radius).simd_gt(near.low[axis]);
            mask &= (centre[axis] - radius).simd_lt(near.high[axis]);
        }
        n = keep(kept, n, u32x16::from_slice(simd, &group.index), mask);
    }
    n
}

/// Tests each survivor of i, of which `spheres` holds x, y, z and radius (m), against each of j.
#[inline(always)]
fn pair_up<S: Simd>(
    simd: S,
    i: &[u32],
    spheres: &[[f32; 4]],
    j: &Kept,
    skin: f32,
    found: &mut Vec<(u16, u16)>,
) {
    let number = |index: u32| u16::try_from(index).unwrap_or(u16::MAX);
    let padded = j.n.next_multiple_of(HALF);
    let centre = [&j.centre[0], &j.centre[1], &j.centre[2]].map(|axis| column(axis, padded));
    let others = centre[0]
        .iter()
        .zip(centre[1])
        .zip(centre[2])
        .zip(column(&j.radius, padded));
    let others = others.zip(column(&j.index, padded));
    for &own in i {
        let [x, y, z, radius] = spheres[own as usize];
        let reach = radius + skin;
        for ((((other_x, other_y), other_z), other_radius), index) in others.clone() {
            let x = f32x8::from_slice(simd, other_x) - x;
            let y = f32x8::from_slice(simd, other_y) - y;
            let z = f32x8::from_slice(simd, other_z) - z;
            let square = x.mul_add(x, y.mul_add(y, z * z));
            let limit = f32x8::from_slice(simd, other_radius) + reach;
            let near = square.simd_lt(limit * limit);
            for l in set_bits(near.to_bitmask()) {
                found.push((number(own), number(index[l])));
            }
        }
    }
}

/// The first `n` of some numbers in groups of eight; `n` is a multiple of eight.
#[inline(always)]
fn column<T>(numbers: &[T], n: usize) -> &[[T; HALF]] {
    numbers[..n].as_chunks().0
}
