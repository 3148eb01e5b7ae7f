//! Pairs of bodies of one sphere each, in worlds that have no other bodies.
//!
//! A pair has one possible contact, and how its bodies are turned does not matter. So there are no
//! lists of candidates: all that is known of a pair is in columns beside each other, with what its
//! contact remembers, and a step goes through them from front to back.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::ROOM;
use crate::census::Census;
use crate::contact::Memory;
use crate::context::Context;
use crate::interaction::Interaction;
use crate::kept_contact::KeptContact;
use crate::lanes::stored;
use crate::lanes::{HALF, NUMBERS, keep, make_room};
use crate::transpose::{Row, row, vector};
use crate::travel::{TOUCHES, UNKNOWN, lowered};
use crate::window::Window;
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};
use nalgebra::Vector3;

/// The bodies of a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Ends {
    /// The body before it.
    other: u32,
    /// The body of the range.
    own: u32,
    /// Place of the interaction of both in the table.
    pub(crate) interaction: u32,
}

impl Ends {
    /// Both bodies, in order.
    #[inline(always)]
    pub(crate) fn bodies(&self) -> [usize; 2] {
        [self.other as usize, self.own as usize]
    }
}

/// The pairs of a range of bodies with all bodies before them, in the order of the later body, then of the other.
///
/// All columns that are read in groups continue for one group behind the last pair.
#[derive(Debug, Clone, Default)]
pub(crate) struct SpherePairs {
    /// The first body of the range.
    first: usize,
    /// First pair of each body of the range; one more than there are bodies.
    start: Vec<u32>,
    /// Who the pairs are.
    pub(crate) ends: Vec<Ends>,
    /// Sum of the travels of both bodies above which the pair is awake, m: [`TOUCHES`] for a pair that
    /// touches, else where it could.
    pub(crate) wake: Vec<f32>,
    /// Tangential displacement of the contact, m; 0 if there is none.
    pub(crate) slip: Vec<Row>,
    /// Torque of the rolling spring of the contact, N m; 0 if there is none. Empty in a world without
    /// rolling springs.
    pub(crate) rolling: Vec<Vector3<f64>>,
    /// Whether there are rolling springs.
    remembers_rolling: bool,
    /// Whether not all pairs have the interaction of the first one.
    has_several_interactions: bool,
}

impl SpherePairs {
    /// Whether there are rolling springs.
    pub(super) fn remembers_rolling(&self) -> bool {
        self.remembers_rolling
    }

    /// Number of pairs.
    pub(crate) fn len(&self) -> usize {
        self.slip.len()
    }

    /// The first of all partners; none if there are no pairs.
    pub(crate) fn lowest_partner(&self) -> Option<usize> {
        let pairs = self.ends[..self.len()].iter();
        pairs.map(|ends| ends.other as usize).min()
    }

    /// Begins a new list and moves the old one out of the way; partners of each body follow in order,
    /// from the first one on, through [`Self::add`].
    pub(crate) fn begin(&mut self, first: usize, interactions: &[Interaction], old: &mut Self) {
        std::mem::swap(self, old);
        self.first = first;
        self.remembers_rolling = interactions.iter().any(Interaction::remembers_rolling);
        self.has_several_interactions = false;
        self.start.clear();
        self.start.push(0);
        self.ends.clear();
        self.wake.clear();
        self.slip.clear();
        self.rolling.clear();
    }

    /// Adds the partners of body `j`, in rising order, keeping the known data of old pairs.
    ///
    /// `template` is the body type of each body, `travel` the travel up to now (m); the caller sets it to
    /// 0 afterwards, so what the pairs that stay have used up of it is taken off.
    pub(crate) fn add(
        &mut self,
        j: usize,
        partners: &[u32],
        (template, travel): (&[usize], &[f32]),
        context: &Context<'_>,
        old: &Self,
    ) {
        let place = j - self.first;
        let (mut k, end) = match old.start.get(place..place + 2) {
            Some(range) => (range[0] as usize, range[1] as usize),
            None => (0, 0),
        };
        let material = |body: usize| context.templates[template[body]].material;
        for &i in partners {
            while k < end && old.ends[k].other < i {
                k += 1;
            }
            let other = i as usize;
            let known = (k < end && old.ends[k].other == i).then_some(k);
            let ways = travel[other] + travel[j];
            let wake = known.map_or(UNKNOWN, |k| lowered(old.wake[k], ways));
            let interaction = stored(context.interaction_index(material(other), material(j)));
            let first = self.ends.first().map_or(interaction, |e| e.interaction);
            self.has_several_interactions |= interaction != first;
            self.ends.push(Ends {
                other: i,
                own: stored(j),
                interaction,
            });
            self.wake.push(wake);
            self.slip.push(remembered(&old.slip, known));
            if self.remembers_rolling {
                self.rolling.push(remembered(&old.rolling, known));
            }
        }
        self.start.push(stored(self.slip.len()));
    }

    /// Ends a list that was begun.
    pub(crate) fn end(&mut self) {
        // The group behind the last pair reads its bodies, as those of no other part may be at hand.
        let last = self.ends.last().copied().unwrap_or_default();
        self.ends.extend([last; HALF]);
        self.wake.extend([f32::INFINITY; HALF]);
    }

    /// Writes the pairs from `from` up to `to` that need attention in this step to the front of `awake` and
    /// returns how many there are.
    #[inline(always)]
    pub(crate) fn find_awake<S: Simd>(
        &self,
        simd: S,
        (from, to): (usize, usize),
        travel: Window<'_, f32>,
        awake: &mut Vec<u32>,
    ) -> usize {
        make_room(awake, to - from + HALF);
        let numbers = u32x8::from_slice(simd, &NUMBERS);
        let mut n = 0;
        for first in (from..to).step_by(HALF) {
            let group = first..first + HALF;
            let ends = &self.ends[group.clone()];
            let ways = f32x8::from_fn(simd, |l| travel[ends[l].own as usize])
                + f32x8::from_fn(simd, |l| travel[ends[l].other as usize]);
            let is_awake = ways.simd_gt(f32x8::from_slice(simd, &self.wake[group]));
            let pairs = numbers + stored(first);
            n = keep(awake, n, pairs, is_awake & pairs.simd_lt(stored(to)));
        }
        n
    }

    /// How many of these pairs, from the first one on, have its interaction and fit into a batch.
    #[inline(always)]
    pub(super) fn of_one_interaction(&self, pairs: &[u32]) -> usize {
        if !self.has_several_interactions {
            return pairs.len().min(ROOM);
        }
        let of = |&pair: &u32| self.ends[pair as usize].interaction;
        let batch = &pairs[..pairs.len().min(ROOM)];
        let first = batch.first().map(of);
        let others = batch.iter().position(|pair| Some(of(pair)) != first);
        others.unwrap_or(batch.len())
    }

    /// What the contact of a pair remembers.
    pub(crate) fn memory(&self, k: usize) -> Memory {
        Memory {
            slip: vector(&self.slip[k]),
            rolling: self.rolling.get(k).copied().unwrap_or_default(),
        }
    }

    /// Sets what the contact of a pair remembers: its slip (m) and the torque of its rolling spring (N m).
    #[inline(always)]
    pub(crate) fn remember(&mut self, k: usize, slip: Row, rolling: Vector3<f64>) {
        self.slip[k] = slip;
        if let Some(kept) = self.rolling.get_mut(k) {
            *kept = rolling;
        }
    }

    /// Whether a pair touched in the last step.
    #[inline(always)]
    pub(crate) fn touches(&self, k: usize) -> bool {
        self.wake[k] == TOUCHES
    }

    /// All contacts, as of the last step.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptContact> + '_ {
        let touching = (0..self.len()).filter(|&k| self.touches(k));
        touching.map(|k| KeptContact {
            body: self.ends[k].other as usize,
            other: self.ends[k].own as usize,
            key: 0,
            memory: self.memory(k),
        })
    }

    /// Takes up the contacts of its bodies with those before them; the pairs are listed and have none yet. The number
    /// taken.
    pub(crate) fn recall(&mut self, contacts: &[KeptContact]) -> usize {
        let n_bodies = self.start.len().saturating_sub(1);
        let mut taken = 0;
        for contact in contacts {
            let Some(place) = contact
                .other
                .checked_sub(self.first)
                .filter(|p| *p < n_bodies)
            else {
                continue;
            };
            let (from, to) = (self.start[place] as usize, self.start[place + 1] as usize);
            let pairs = &self.ends[from..to];
            if let Ok(at) = pairs.binary_search_by_key(&contact.body, |e| e.other as usize) {
                self.wake[from + at] = TOUCHES;
                let memory = &contact.memory;
                self.remember(from + at, row(&memory.slip, 0.0), memory.rolling);
                taken += 1;
            }
        }
        taken
    }

    /// Sizes of the lists.
    pub(crate) fn census(&self) -> Census {
        let touching = (0..self.len()).filter(|&k| self.touches(k)).count();
        Census {
            body_pairs: self.len(),
            touching_pairs: touching,
            sphere_contacts: touching,
            bytes: self.len() * (size_of::<Ends>() + size_of::<f32>())
                + touching * size_of::<Row>()
                + self.rolling.len() * size_of::<Vector3<f64>>(),
            ..Census::default()
        }
    }
}

/// What a column holds of an entry that is known; 0 of one that is not.
pub(crate) fn remembered<T: Copy + Default>(column: &[T], known: Option<usize>) -> T {
    known.map_or_else(T::default, |k| column[k])
}
