//! Bodies sorted in memory while a large bed mixes, and frames that count them as they began.

use crate::build::Built;
use crate::{Error, Frame};
use dem_solver::{Placement, Snapshot};
use nalgebra::Vector3;

/// Fewest bodies that are sorted. Smaller beds lie in the caches, whatever their order.
pub const SORTED_FROM: usize = 4096;

/// Time after which they are sorted again, s: a bed that rolls has moved by some seeds.
const INTERVAL: f64 = 0.2;

impl Built {
    /// Whether the bodies are sorted when the world has come from one time to another, s. It follows from the world alone,
    /// so that a continued run sorts at the same times.
    pub(crate) fn is_to_be_sorted(&self, [before, now]: [f64; 2]) -> bool {
        // Bonds name the bodies that they hold.
        self.bonds.is_none()
            && self.world.bodies().len() >= SORTED_FROM
            && (before / INTERVAL).floor() < (now / INTERVAL).floor()
    }

    /// Sorts the bodies, and remembers which seed is where.
    pub(crate) fn sort(&mut self) -> Result<(), Error> {
        let order = self.world.sort_bodies()?;
        self.numbers = order.iter().map(|&place| self.number(place)).collect();
        Ok(())
    }

    /// Takes bodies out of the world; the others keep their numbers.
    pub(crate) fn remove(&mut self, places: &[usize]) -> Result<(), Error> {
        if places.is_empty() {
            return Ok(());
        }
        let all = 0..self.world.bodies().len();
        let stay = all.filter(|place| !places.contains(place));
        self.numbers = stay.map(|place| self.number(place)).collect();
        Ok(self.world.remove(places)?)
    }

    /// Adds seeds that a factory makes, behind so many that were taken out.
    pub(crate) fn insert(&mut self, new: &[Placement], gone: usize) -> Result<(), Error> {
        if gone > 0 {
            let made = self.world.bodies().len() + gone;
            self.numbers.extend(made..made + new.len());
        }
        Ok(self.world.insert(new)?)
    }

    /// Places of the seeds, in a world with all of them in order, whose numbers are not among these.
    pub(crate) fn places_without(&self, numbers: &[usize]) -> Vec<usize> {
        let mut is_left = vec![false; self.world.bodies().len()];
        for &number in numbers {
            if let Some(left) = is_left.get_mut(number) {
                *left = true;
            }
        }
        let all = is_left.iter().enumerate();
        all.filter(|(_, left)| !**left).map(|(k, _)| k).collect()
    }

    /// The number of the seed in a place: seeds that a factory makes behind the last sorting are in order.
    fn number(&self, place: usize) -> usize {
        self.numbers.get(place).copied().unwrap_or(place)
    }

    /// Poses of all seeds, in the order of their numbers.
    pub(crate) fn seeds_in_order(&self, time: f64) -> Frame {
        let bodies = self.world.bodies();
        let places = places(&self.numbers, bodies.len());
        Frame {
            time,
            kind: column(&bodies.template, &places),
            position: column(&self.positions(), &places),
            orientation: column(&bodies.orientation, &places),
            velocity: column(&bodies.velocity, &places),
            spin: column(&bodies.spin, &places),
            walls: Vec::new(),
        }
    }

    /// Centres of all bodies, m; between the periodic sides if there are any.
    pub(crate) fn positions(&self) -> Vec<Vector3<f64>> {
        let positions = self.world.bodies().position.iter();
        positions.map(|p| self.world.between_sides(p)).collect()
    }

    /// Puts a world that was just built into the order of one that was left.
    pub(crate) fn put_in_order(&mut self, numbers: &[usize]) -> Result<(), Error> {
        if numbers.is_empty() {
            return Ok(());
        }
        numbers.clone_into(&mut self.numbers);
        // The world has the seeds in the order of their numbers, of which some may be missing.
        let places = places(numbers, self.world.bodies().len());
        let mut order = vec![0; places.len()];
        for (rank, &place) in places.iter().enumerate() {
            order[place] = rank;
        }
        Ok(self.world.reorder(&order)?)
    }
}

/// The seeds of a world that was left, in the order of their numbers.
pub(crate) fn placements_in_order(world: &Snapshot, numbers: &[usize]) -> Vec<Placement> {
    let all: Vec<_> = world.placements().collect();
    let places = places(numbers, all.len());
    column(&all, &places)
}

/// Values of the seeds that stand in some places.
fn column<T: Copy>(values: &[T], places: &[usize]) -> Vec<T> {
    places.iter().map(|&place| values[place]).collect()
}

/// Places of so many seeds in the order of their numbers; the number of a seed that `numbers` does not reach is its place.
fn places(numbers: &[usize], seeds: usize) -> Vec<usize> {
    let mut places: Vec<usize> = (0..seeds).collect();
    places.sort_by_key(|&place| numbers.get(place).copied().unwrap_or(place));
    places
}
