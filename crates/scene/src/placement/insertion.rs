//! Random sequential insertion: bodies put at random places, one after another.

use super::{Capsule, Placed, Room, try_place};
use clump::Clump;
use dem_solver::Placement;
use nalgebra::Vector3;
use random_stream::Stream;
use std::collections::BTreeMap;

/// Places drawn for a body before it is given up: our choice. Equal balls jam at 0.38 of the volume; at 0.3 a place in some
/// tens is free.
const MOST_PLACES: usize = 2000;

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
    let mut cells = Cells::new(2.0 * largest);
    let [low, high] = room.apparatus.room();
    let mut result = Vec::new();
    for kind in order {
        let capsule = capsules[kind];
        for _ in 0..kinds[kind].1 {
            let found = (0..MOST_PLACES).find_map(|_| {
                let centre = Vector3::from_fn(|axis, _| stream.between(low[axis], high[axis]));
                let near = cells.near(&centre);
                try_place(room, capsule, |_| centre, &near, &mut stream)
            });
            let Some((body, turn)) = found else {
                return result;
            };
            cells.add(body);
            result.push(Placement::at_rest(kind, body.centre, turn));
        }
    }
    result
}

/// Bodies by the cell in which they lie.
struct Cells {
    /// Edge of a cell, m: no body reaches beyond the next one.
    edge: f64,
    /// The bodies of each cell.
    bodies: BTreeMap<[i64; 3], Vec<Placed>>,
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

    /// All bodies that one at a place may touch.
    fn near(&self, place: &Vector3<f64>) -> Vec<&Placed> {
        let [x, y, z] = self.cell(place);
        let around = -1..=1_i64;
        let cells = around.clone().flat_map(|i| {
            let around = around.clone();
            around
                .clone()
                .flat_map(move |j| around.clone().map(move |k| [x + i, y + j, z + k]))
        });
        cells
            .filter_map(|cell| self.bodies.get(&cell))
            .flatten()
            .collect()
    }

    /// One more body.
    fn add(&mut self, body: Placed) {
        let cell = self.cell(&body.centre);
        self.bodies.entry(cell).or_default().push(body);
    }
}
