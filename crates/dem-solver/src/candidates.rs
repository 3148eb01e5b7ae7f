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

use crate::pair_force::Slack;
use crate::template::{LANES, Packed};
use multiversion::multiversion;

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
    /// Coordinates and radii, padded to whole lanes by a sphere far away.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    radius: Vec<f32>,
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
        let room = room + LANES;
        if self.x.len() < room {
            for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
                column.resize(room, 0.0);
            }
            self.index.resize(room, 0);
        }
        self.n = 0;
    }

    /// Writes a sphere at the end; it stays only if `keep` says so.
    #[inline(always)]
    fn offer(&mut self, centre: [f32; 3], radius: f32, index: usize, keep: bool) {
        let n = self.n;
        self.x[n] = centre[0];
        self.y[n] = centre[1];
        self.z[n] = centre[2];
        self.radius[n] = radius;
        self.index[n] = u16::try_from(index).unwrap_or(u16::MAX);
        self.n += usize::from(keep);
    }

    /// Fills the last lanes with a sphere that touches nothing.
    fn pad(&mut self) {
        for k in self.n..self.n.div_ceil(LANES) * LANES {
            self.x[k] = 1e6;
            self.radius[k] = 0.0;
        }
    }
}

/// Farthest reach of a template along a direction of its own frame, m.
#[inline(always)]
fn support(packed: &Packed, direction: [f32; 3]) -> f32 {
    let mut best = [f32::NEG_INFINITY; LANES];
    let columns = packed
        .x
        .chunks_exact(LANES)
        .zip(packed.y.chunks_exact(LANES));
    let rest = packed
        .z
        .chunks_exact(LANES)
        .zip(packed.radius.chunks_exact(LANES));
    for ((x, y), (z, radius)) in columns.zip(rest) {
        for l in 0..LANES {
            let reach = x[l] * direction[0] + y[l] * direction[1] + z[l] * direction[2] + radius[l];
            best[l] = if reach > best[l] { reach } else { best[l] };
        }
    }
    best.into_iter().fold(f32::NEG_INFINITY, f32::max)
}

/// Lists in `scratch.found` all pairs of spheres whose gap is below the skin.
///
/// Returns a lower bound of the gap of all pairs that are not listed, m: the skin less the
/// safety, or more where a plane between the bodies proves more.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn search(
    i: &Packed,
    j: &Packed,
    pose: &RelativeSingle,
    slack: Slack,
    scratch: &mut Scratch,
) -> f32 {
    let Slack { skin, safety } = slack;
    scratch.found.clear();
    let (r, p) = (&pose.rotation, &pose.position);
    let distance = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt().max(1e-12);
    let normal = [p[0] / distance, p[1] / distance, p[2] / distance];
    let back = [
        -(r[0] * normal[0] + r[3] * normal[1] + r[6] * normal[2]),
        -(r[1] * normal[0] + r[4] * normal[1] + r[7] * normal[2]),
        -(r[2] * normal[0] + r[5] * normal[1] + r[8] * normal[2]),
    ];
    let far_of_i = support(i, normal);
    let near_of_j = distance - support(j, back);
    let gap = near_of_j - far_of_i - safety;
    if gap > skin {
        return gap;
    }

    let kept_j = &mut scratch.j;
    kept_j.reset(j.x.len());
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for k in 0..j.n {
        let (x, y, z) = (j.x[k], j.y[k], j.z[k]);
        let centre = [
            r[0] * x + r[1] * y + r[2] * z + p[0],
            r[3] * x + r[4] * y + r[5] * z + p[1],
            r[6] * x + r[7] * y + r[8] * z + p[2],
        ];
        let reach = j.radius[k] + skin;
        let height = centre[0] * normal[0] + centre[1] * normal[1] + centre[2] * normal[2];
        let mut keep = height - reach < far_of_i;
        for axis in 0..3 {
            keep &= centre[axis] > i.low[axis] - reach;
            keep &= centre[axis] < i.high[axis] + reach;
        }
        kept_j.offer(centre, j.radius[k], k, keep);
        if keep {
            for axis in 0..3 {
                low[axis] = low[axis].min(centre[axis] - reach);
                high[axis] = high[axis].max(centre[axis] + reach);
            }
        }
    }
    if kept_j.n == 0 {
        return skin - safety;
    }
    kept_j.pad();

    let kept_i = &mut scratch.i;
    kept_i.reset(i.x.len());
    for k in 0..i.n {
        let centre = [i.x[k], i.y[k], i.z[k]];
        let radius = i.radius[k];
        let height = centre[0] * normal[0] + centre[1] * normal[1] + centre[2] * normal[2];
        let mut keep = height + radius + skin > near_of_j;
        for axis in 0..3 {
            keep &= centre[axis] > low[axis] - radius;
            keep &= centre[axis] < high[axis] + radius;
        }
        kept_i.offer(centre, radius, k, keep);
    }
    pair_up(kept_i, kept_j, skin, &mut scratch.found);
    skin - safety
}

/// Tests each survivor of i against each of j.
#[inline(always)]
fn pair_up(i: &Kept, j: &Kept, skin: f32, found: &mut Vec<(u16, u16)>) {
    let end = j.n.div_ceil(LANES) * LANES;
    for a in 0..i.n {
        let (x, y, z, reach) = (i.x[a], i.y[a], i.z[a], i.radius[a] + skin);
        for b in (0..end).step_by(LANES) {
            let mut mask = 0_u32;
            for l in 0..LANES {
                let (dx, dy, dz) = (j.x[b + l] - x, j.y[b + l] - y, j.z[b + l] - z);
                let limit = reach + j.radius[b + l];
                let inside = dx * dx + dy * dy + dz * dz < limit * limit;
                mask |= u32::from(inside) << l;
            }
            while mask != 0 {
                let l = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                found.push((i.index[a], j.index[b + l]));
            }
        }
    }
}
