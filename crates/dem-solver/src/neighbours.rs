//! Lists of pairs of bodies and, for each pair, of the spheres that may touch.
//!
//! A pair sleeps until its two bodies together have moved by more than the distance that its list covers. Distances are
//! measured in a frame that turns with the drum, where a bed that turns as a whole is at rest. The sum of both travels is an upper
//! bound of the relative motion that costs one addition; when it exceeds the limit, the true relative motion
//! since the list was made decides whether the list must be rebuilt.
//!
//! Worlds of bodies of one sphere each have lists of their own (`spheres`).

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::bodies::{Bodies, scaled_single};
use crate::candidates::{RelativeSingle, Scratch, search};
use crate::census::Census;
use crate::context::Context;
use crate::kept_contact::KeptContact;
use crate::lanes::{HALF, NUMBERS, keep, make_room, stored};
use crate::pose::{Pose, single};
use crate::sphere_contact::SphereContact;
use crate::template::Template;
use crate::travel::lowered;
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};
use std::hint::black_box;
use std::ops::{BitXor, Range};

/// Candidates handled together. A chunk fills two lines of the cache; the lists of the study's drum hold one and
/// a half a pair.
pub(crate) const CHUNK: usize = HALF;

/// Up to eight pairs of spheres in the principal frames of their bodies; what is left over repeats the first.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Chunk {
    /// x, y, z of the spheres of i, in cells of its template.
    pub(crate) i: [[i16; CHUNK]; 3],
    /// x, y, z of the spheres of j, in cells of its template.
    pub(crate) j: [[i16; CHUNK]; 3],
    /// Keys of the lanes, as in [`SphereContact`].
    pub(crate) key: [u32; CHUNK],
}

/// What decides whether pairs need attention in a step, one entry a pair; read every step for every pair. Both
/// arrays continue for one group of eight behind the last pair.
#[derive(Debug, Clone, Default)]
struct PairTable {
    /// The earlier body.
    other: Vec<u32>,
    /// Sum of the travels of both bodies above which the pair is awake, m: minus infinity for a
    /// pair in contact, otherwise the travel after which its nearest spheres could touch.
    wake: Vec<f32>,
}

impl PairTable {
    /// Forgets all pairs.
    fn clear(&mut self) {
        self.other.clear();
        self.wake.clear();
    }

    /// Adds a pair whose list holds so many candidates up to a limit (m).
    fn push(&mut self, other: u32, n_candidates: u32, limit: f32) {
        self.other.push(other);
        self.wake.push(wake(n_candidates, limit));
    }

    /// Adds the group behind the last pair, which never wakes.
    fn pad(&mut self) {
        self.other.extend([0; CHUNK]);
        self.wake.extend([f32::INFINITY; CHUNK]);
    }
}

/// Sum of travels (m) at which a pair wakes whose list holds so many candidates up to a limit (m).
#[inline(always)]
fn wake(n_candidates: u32, limit: f32) -> f32 {
    if n_candidates > 0 {
        f32::NEG_INFINITY
    } else {
        limit
    }
}

/// The list of a pair; read only for pairs that are awake.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lists {
    /// First chunk of the pair.
    pub(crate) chunk: u32,
    pub(crate) n_candidates: u32,
    /// Number of chunks that the place can hold.
    room: u32,
    /// First touching pair of spheres.
    pub(crate) touch: u32,
    /// Number of touching pairs of spheres.
    pub(crate) n_touches: u32,
    /// Sum of the travels of both bodies above which the list must be looked at, m.
    pub(crate) limit: f32,
}

impl Lists {
    /// List of a new pair: empty, due at once.
    const NEW: Self = Self {
        chunk: 0,
        n_candidates: 0,
        room: 0,
        touch: 0,
        n_touches: 0,
        limit: f32::NEG_INFINITY,
    };

    /// Number of chunks in use.
    fn n_chunks(&self) -> u32 {
        stored((self.n_candidates as usize).div_ceil(CHUNK))
    }

    /// The chunks in use.
    #[inline(always)]
    pub(crate) fn chunks(&self) -> Range<usize> {
        self.chunk as usize..(self.chunk + self.n_chunks()) as usize
    }

    /// The touching pairs of spheres.
    #[inline(always)]
    pub(crate) fn touches(&self) -> Range<usize> {
        self.touch as usize..(self.touch + self.n_touches) as usize
    }
}

/// A pair that needs attention in this step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Due {
    pair: u32,
    /// Its bodies, in order.
    bodies: [u32; 2],
}

impl Due {
    #[inline(always)]
    pub(crate) fn pair(&self) -> usize {
        self.pair as usize
    }

    /// Its bodies, in order.
    #[inline(always)]
    pub(crate) fn bodies(&self) -> [usize; 2] {
        self.bodies.map(|body| body as usize)
    }

    /// Sum of the travels of both, m.
    #[inline(always)]
    pub(crate) fn travel(&self, travel: &[f32]) -> f32 {
        let [i, j] = self.bodies();
        travel[i] + travel[j]
    }
}

/// The pairs of a range of bodies with all bodies before them.
///
/// Chunks and touches lie in the order in which the force loop visits the pairs, so that the
/// loop reads memory from front to back. A list that grows out of its place goes to the end;
/// the next broad phase puts it back in order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Neighbours {
    /// The first body of the range.
    first: usize,
    /// Entries, grouped by the later body.
    table: PairTable,
    /// Lists of the same entries.
    pub(crate) lists: Vec<Lists>,
    /// The pairs when their lists were made.
    poses: Vec<Pose>,
    /// First entry of each body of the range in the table; one more than there are bodies.
    start: Vec<u32>,
    /// Candidates.
    pub(crate) chunks: Vec<Chunk>,
    /// Touching pairs of spheres of the step before.
    pub(crate) touches: Vec<SphereContact>,
    /// Lists rebuilt since the start.
    n_rebuilds: u64,
    /// Pairs looked at since the start.
    n_checks: u64,
}

/// Lists before a broad phase.
#[derive(Debug, Clone, Default)]
pub(crate) struct Previous {
    /// Entries.
    table: PairTable,
    lists: Vec<Lists>,
    poses: Vec<Pose>,
    start: Vec<u32>,
    /// Candidates.
    chunks: Vec<Chunk>,
}

impl Neighbours {
    /// The bodies whose pairs are listed.
    pub(crate) fn range(&self) -> Range<usize> {
        self.first..self.first + self.start.len().saturating_sub(1)
    }

    /// All contacts, as of the last step.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptContact> + '_ {
        let bodies = self.start.windows(2).zip(self.first..);
        let pairs = bodies.flat_map(|(w, j)| (w[0] as usize..w[1] as usize).map(move |k| (j, k)));
        pairs.flat_map(|(j, k)| {
            let lists = &self.lists[k];
            let body = self.table.other[k] as usize;
            self.touches[lists.touches()]
                .iter()
                .map(move |t| KeptContact {
                    body,
                    other: j,
                    key: t.key,
                    memory: t.memory,
                })
        })
    }

    /// Takes up the contacts of its bodies with those before them, pair by pair; the pairs are listed and have none yet.
    /// The number taken.
    pub(crate) fn recall(&mut self, contacts: &[KeptContact]) -> usize {
        let range = self.range();
        let mut taken = 0;
        for pair in contacts.chunk_by(|a, b| (a.body, a.other) == (b.body, b.other)) {
            if !range.contains(&pair[0].other) {
                continue;
            }
            let place = pair[0].other - self.first;
            let (from, to) = (self.start[place] as usize, self.start[place + 1] as usize);
            let found =
                self.table.other[from..to].binary_search_by_key(&pair[0].body, |&i| i as usize);
            if let Ok(at) = found {
                let lists = &mut self.lists[from + at];
                lists.touch = stored(self.touches.len());
                lists.n_touches = stored(pair.len());
                self.touches
                    .extend(pair.iter().map(|contact| SphereContact {
                        key: contact.key,
                        memory: contact.memory,
                    }));
                taken += pair.len();
            }
        }
        taken
    }

    /// Sizes of the lists.
    pub(crate) fn census(&self) -> Census {
        let count = |test: &dyn Fn(&Lists) -> bool| self.lists.iter().filter(|l| test(l)).count();
        let body_pairs = self.lists.len();
        let pairs_with_candidates = count(&|l| l.n_candidates > 0);
        let chunks = self.lists.iter().map(|l| l.n_chunks() as usize).sum();
        Census {
            body_pairs,
            pairs_with_candidates,
            chunks,
            touching_pairs: count(&|l| l.n_touches > 0),
            sphere_contacts: self.touches.len(),
            // The other body and the travel of each pair; the rest of those that are awake.
            bytes: body_pairs * (size_of::<u32>() + size_of::<f32>())
                + pairs_with_candidates * size_of::<Lists>()
                + chunks * size_of::<Chunk>()
                + self.touches.len() * size_of::<SphereContact>(),
            rebuilds: self.n_rebuilds,
            checks: self.n_checks,
        }
    }

    /// Begins a new list and moves the old one out of the way; partners of each body follow in order,
    /// from the first one on, through [`Self::add`].
    pub(crate) fn begin(&mut self, first: usize, old: &mut Previous) {
        self.first = first;
        std::mem::swap(&mut self.table, &mut old.table);
        std::mem::swap(&mut self.lists, &mut old.lists);
        std::mem::swap(&mut self.poses, &mut old.poses);
        std::mem::swap(&mut self.start, &mut old.start);
        std::mem::swap(&mut self.chunks, &mut old.chunks);
        self.table.clear();
        self.lists.clear();
        self.poses.clear();
        self.chunks.clear();
        self.start.clear();
        self.start.push(0);
    }

    /// Adds the partners of body `j`, in rising order, keeping the known data of old pairs.
    ///
    /// `travel` is the travel of the bodies up to now; the caller sets it to 0 afterwards, so
    /// the limits of the pairs that stay are lowered by it.
    pub(crate) fn add(&mut self, j: usize, partners: &[u32], travel: &[f32], old: &Previous) {
        let place = j - self.first;
        let (mut k, end) = match old.start.get(place..place + 2) {
            Some(range) => (range[0] as usize, range[1] as usize),
            None => (0, 0),
        };
        self.poses
            .resize(self.lists.len() + partners.len(), Pose::NONE);
        for &i in partners {
            while k < end && old.table.other[k] < i {
                k += 1;
            }
            if k < end && old.table.other[k] == i {
                let lists = old.lists[k];
                let limit = lowered(lists.limit, travel[i as usize] + travel[j]);
                self.table.push(i, lists.n_candidates, limit);
                self.poses[self.lists.len()] = old.poses[k];
                let moved = &old.chunks[lists.chunks()];
                let chunk = stored(self.chunks.len());
                self.chunks.extend_from_slice(moved);
                self.lists.push(Lists {
                    chunk,
                    room: lists.n_chunks(),
                    limit,
                    ..lists
                });
                k += 1;
            } else {
                self.table.push(i, 0, f32::NEG_INFINITY);
                self.lists.push(Lists::NEW);
            }
        }
        self.start.push(stored(self.lists.len()));
    }

    /// Ends a list that was begun.
    pub(crate) fn end(&mut self) {
        self.table.pad();
    }

    /// A pair of body `j`.
    #[inline(always)]
    pub(crate) fn due(&self, pair: u32, j: usize) -> Due {
        Due {
            pair,
            bodies: [self.table.other[pair as usize], stored(j)],
        }
    }

    /// Lists those pairs whose covered motion is used up.
    #[inline(always)]
    pub(crate) fn find_stale(&self, due: &[Due], travel: &[f32], stale: &mut Vec<Due>) {
        stale.clear();
        let is_stale = |pair: &&Due| pair.travel(travel) > self.lists[pair.pair()].limit;
        stale.extend(due.iter().filter(is_stale));
    }

    /// Reads the poses of some pairs, so that they are fetched side by side and not one after the other.
    #[inline(always)]
    pub(crate) fn fetch_poses(&self, pairs: &[Due]) {
        let poses = pairs.iter().map(|pair| &self.poses[pair.pair()]);
        black_box(poses.map(Pose::both_ends).fold(0, BitXor::bitxor));
    }

    /// Reads the candidates and what touched of some pairs, so that they are fetched side by side and not one after the
    /// other.
    #[inline(always)]
    pub(crate) fn fetch_candidates(&self, pairs: &[Due]) {
        let mut read = 0;
        for pair in pairs {
            let lists = &self.lists[pair.pair()];
            for chunk in &self.chunks[lists.chunks()] {
                read ^= chunk.key[0] ^ u32::from(chunk.i[0][0].cast_unsigned());
            }
            for touch in &self.touches[lists.touches()] {
                read ^= touch.key;
            }
        }
        black_box(read);
    }

    /// Looks at a pair whose covered motion is used up; makes its list again where
    /// the true relative motion demands it.
    #[inline(always)]
    pub(crate) fn refresh<S: Simd>(
        &mut self,
        simd: S,
        pair: &Due,
        bodies: &Bodies,
        context: &Context<'_>,
        scratch: &mut Scratch,
    ) {
        let (templates, cutoffs) = (context.templates, context.cutoffs);
        self.n_checks += 1;
        let (k, [i, j]) = (pair.pair(), pair.bodies());
        let travel = pair.travel(&bodies.travel);
        let (a, b) = (
            &templates[bodies.template[i]],
            &templates[bodies.template[j]],
        );
        let position = bodies.rotation[i].tr_mul(
            &context
                .period
                .nearest(bodies.position[j] - bodies.position[i]),
        );
        let rotation = bodies.orientation[i].inverse() * bodies.orientation[j];
        let pose = self.poses[k];
        let left = pose.left(&position, &rotation, cutoffs.safety);
        // With less than a fifth left the pair would come back soon: a new list is cheaper than many looks.
        if left > 0.2 * pose.reach() {
            self.set_limit(k, travel + left);
            return;
        }
        let relative = RelativeSingle {
            rotation: scaled_single(&rotation.to_rotation_matrix().into_inner(), 1.0),
            position: single(&position.data.0[0]),
        };
        // The list is found in the frame of body i, so that it stays valid while both turn together.
        let (reach, patch) = simd.vectorize(
            #[inline(always)]
            || search(simd, &a.packed, &b.packed, &relative, cutoffs, scratch),
        );
        self.poses[k] = Pose::new(&position, &rotation, &patch, reach);
        self.n_rebuilds += 1;
        self.place_chunks(k, a, b, &scratch.found);
        self.set_limit(k, travel + reach);
    }

    /// Sets the limit of pair `k`, whose chunks are in place.
    fn set_limit(&mut self, k: usize, limit: f32) {
        let lists = &mut self.lists[k];
        lists.limit = limit;
        self.table.wake[k] = wake(lists.n_candidates, limit);
    }

    /// Lets pair `k`, none of whose candidates touches, sleep up to a sum of travels (m), but not
    /// beyond the limit of its list.
    #[inline(always)]
    pub(crate) fn sleep(&mut self, k: usize, travel: f32) {
        self.table.wake[k] = travel.min(self.lists[k].limit);
    }

    /// Writes the pairs of body `j` that need attention in this step to the front of `awake` and returns how
    /// many there are. Nine of ten pairs sleep, so that the loop over all of them must not branch.
    #[inline(always)]
    pub(crate) fn find_awake<S: Simd>(
        &self,
        simd: S,
        j: usize,
        travel: &[f32],
        awake: &mut Vec<u32>,
    ) -> usize {
        let place = j - self.first;
        let (from, to) = (self.start[place], self.start[place + 1]);
        make_room(awake, (to - from) as usize + CHUNK);
        let mut n = 0;
        let numbers = u32x8::from_slice(simd, &NUMBERS);
        for first in (from..to).step_by(CHUNK) {
            let group = first as usize..first as usize + CHUNK;
            let others = &self.table.other[group.clone()];
            let ways = f32x8::from_fn(simd, |l| travel[others[l] as usize]) + travel[j];
            let wake = f32x8::from_slice(simd, &self.table.wake[group]);
            let pairs = numbers + first;
            let is_awake = ways.simd_gt(wake) & pairs.simd_lt(to);
            n = keep(awake, n, pairs, is_awake);
        }
        n
    }

    /// Writes the candidates found into the place of pair `k`, or to the end if it is too small.
    fn place_chunks(&mut self, k: usize, a: &Template, b: &Template, found: &[(u16, u16)]) {
        let lists = &mut self.lists[k];
        let groups = found.chunks(CHUNK);
        lists.n_candidates = stored(found.len());
        if lists.n_chunks() > lists.room {
            lists.chunk = stored(self.chunks.len());
            lists.room = lists.n_chunks();
            self.chunks
                .extend(groups.map(|group| chunk_of(group, a, b)));
        } else {
            // In place: the lists stay in the order in which the force loop reads them.
            let place = &mut self.chunks[lists.chunk as usize..];
            for (chunk, group) in place.iter_mut().zip(groups) {
                *chunk = chunk_of(group, a, b);
            }
        }
        if lists.n_candidates == 0 {
            // The force loop skips this pair, and its touches would be those of other pairs after the next step.
            (lists.touch, lists.n_touches) = (0, 0);
        }
    }
}

/// Lays one to eight candidates out in lanes.
fn chunk_of(group: &[(u16, u16)], a: &Template, b: &Template) -> Chunk {
    let mut chunk = Chunk {
        i: [[0; CHUNK]; 3],
        j: [[0; CHUNK]; 3],
        key: [0; CHUNK],
    };
    for l in 0..CHUNK {
        let (si, sj) = *group.get(l).unwrap_or(&group[0]);
        let (u, v) = (usize::from(si), usize::from(sj));
        for axis in 0..3 {
            chunk.i[axis][l] = a.cells[u][axis];
            chunk.j[axis][l] = b.cells[v][axis];
        }
        chunk.key[l] = u32::from(si) << 16 | u32::from(sj);
    }
    chunk
}
