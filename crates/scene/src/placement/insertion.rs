//! Random sequential insertion: bodies put at random places, one after another. Where one finds no place, those that are
//! there are shaken, as molecules of a dense gas, and it is tried again.

use super::{Capsule, Placed, Room, clear, is_inside, try_place};
use clump::Clump;
use dem_solver::Placement;
use nalgebra::{UnitQuaternion, Vector3};
use random_stream::Stream;
use std::collections::BTreeMap;

/// Places drawn for a body before the others are shaken: our choice. Equal balls jam at 0.38 of the volume; at 0.3 a place in
/// some tens is free.
const MOST_PLACES: usize = 2000;

/// How often all are shaken for the bodies that found no place: our choice.
const MOST_SHAKES: usize = 300;

/// Share of the volume beyond which nothing is shaken: equal balls crystallise at 0.49 `[HooverRee1968]`.
const DENSE: f64 = 0.45;

/// Longest step of a body that is shaken along each axis, over its radius: our choice, about the gaps of a dense gas.
const STEP: f64 = 0.5;

/// Inserts `kinds[k].1` bodies of each kind, the largest kinds first, as far as there is room.
pub(super) fn insert(
    room: Room<'_>,
    capsules: &[Capsule],
    kinds: &[(&Clump, usize)],
    seed: u64,
) -> Vec<Placement> {
    let mut stream = Stream::new(seed, "insertion");
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    order.sort_by(|a, b| capsules[*b].reach().total_cmp(&capsules[*a].reach()));
    let largest = order.first().map_or(0.0, |kind| capsules[*kind].reach());
    let mut inserted = Inserted {
        room,
        cells: Cells::new(2.0 * largest),
        bodies: Vec::new(),
    };
    let mut shakes = if is_dense(room, capsules, kinds) {
        MOST_SHAKES
    } else {
        0
    };
    let all = order
        .iter()
        .flat_map(|&kind| std::iter::repeat_n(kind, kinds[kind].1));
    for kind in all {
        while !inserted.add(kind, capsules[kind], &mut stream) {
            if shakes == MOST_SHAKES {
                return inserted.placements();
            }
            inserted.shake(&mut stream);
            shakes += 1;
        }
    }
    inserted.placements()
}

/// Whether bodies would take more of the box about the apparatus than a gas does that can still be shaken.
fn is_dense(room: Room<'_>, capsules: &[Capsule], kinds: &[(&Clump, usize)]) -> bool {
    let [low, high] = room.apparatus.room();
    let outlines = capsules.iter().zip(kinds);
    let volumes = outlines.map(|(capsule, kind)| capsule.volume() * kind.1 as f64);
    volumes.sum::<f64>() > DENSE * (high - low).product()
}

/// The bodies that are there.
struct Inserted<'a> {
    /// What leaves room for them.
    room: Room<'a>,
    /// Their numbers by place.
    cells: Cells,
    /// Kind, outline and turn of each.
    bodies: Vec<(usize, Placed, UnitQuaternion<f64>)>,
}

impl Inserted<'_> {
    /// Adds a body of a kind, if one of the places that are drawn is free.
    fn add(&mut self, kind: usize, capsule: Capsule, stream: &mut Stream) -> bool {
        let [low, high] = self.room.apparatus.room();
        let found = (0..MOST_PLACES).find_map(|_| {
            let centre = Vector3::from_fn(|axis, _| stream.between(low[axis], high[axis]));
            let near = self.near(&centre, None);
            // Its core does not turn.
            let core = Placed {
                centre,
                half: Vector3::zeros(),
                radius: capsule.radius,
            };
            if !near.iter().all(|other| clear(&core, other)) {
                return None;
            }
            try_place(self.room, capsule, |_| centre, &near, stream)
        });
        if let Some((body, turn)) = found {
            self.cells.add(self.bodies.len(), &body.centre);
            self.bodies.push((kind, body, turn));
        }
        found.is_some()
    }

    /// Moves each body by a random step, where it is clear of all others there.
    fn shake(&mut self, stream: &mut Stream) {
        for number in 0..self.bodies.len() {
            let (_, before, _) = self.bodies[number];
            let step = Vector3::from_fn(|_, _| stream.between(-STEP, STEP)) * before.radius;
            let after = Placed {
                centre: before.centre + step,
                ..before
            };
            let near = self.near(&after.centre, Some(number));
            if is_inside(self.room, &after) && near.iter().all(|other| clear(&after, other)) {
                self.cells.remove(number, &before.centre);
                self.cells.add(number, &after.centre);
                self.bodies[number].1 = after;
            }
        }
    }

    /// All bodies but one that one at a place may touch.
    fn near(&self, place: &Vector3<f64>, but: Option<usize>) -> Vec<&Placed> {
        let numbers = self.cells.near(place);
        let others = numbers.filter(|number| Some(*number) != but);
        others.map(|number| &self.bodies[number].1).collect()
    }

    /// Where they are.
    fn placements(&self) -> Vec<Placement> {
        let bodies = self.bodies.iter();
        bodies
            .map(|(kind, body, turn)| Placement::at_rest(*kind, body.centre, *turn))
            .collect()
    }
}

/// Bodies by the cell in which they lie.
struct Cells {
    /// Edge of a cell, m: no body reaches beyond the next one.
    edge: f64,
    /// The numbers of the bodies of each cell.
    bodies: BTreeMap<[i64; 3], Vec<usize>>,
}

impl Cells {
    /// No bodies yet; `edge` (m) is twice the reach of the largest one.
    fn new(edge: f64) -> Self {
        Self {
            edge,
            bodies: BTreeMap::new(),
        }
    }

    /// The cell of a place.
    fn cell(&self, place: &Vector3<f64>) -> [i64; 3] {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the apparatus is at most some thousands of bodies across"
        )]
        let cell = [0, 1, 2].map(|axis: usize| (place[axis] / self.edge).floor() as i64);
        cell
    }

    /// The numbers of all bodies that one at a place may touch.
    fn near(&self, place: &Vector3<f64>) -> impl Iterator<Item = usize> {
        let [x, y, z] = self.cell(place);
        let around = -1..=1_i64;
        let cells = around.clone().flat_map(move |i| {
            let around = around.clone();
            around
                .clone()
                .flat_map(move |j| around.clone().map(move |k| [x + i, y + j, z + k]))
        });
        cells
            .filter_map(|cell| self.bodies.get(&cell))
            .flatten()
            .copied()
    }

    /// A body at a place.
    fn add(&mut self, number: usize, place: &Vector3<f64>) {
        self.bodies
            .entry(self.cell(place))
            .or_default()
            .push(number);
    }

    /// A body has left a place.
    fn remove(&mut self, number: usize, place: &Vector3<f64>) {
        if let Some(there) = self.bodies.get_mut(&self.cell(place)) {
            there.retain(|other| *other != number);
        }
    }
}
