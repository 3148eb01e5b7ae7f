//! A particle factory: seeds that appear over time above the bottom of the apparatus and fall from there.
//!
//! # What it does
//!
//! The kinds come in an order shuffled by the seed, so that shapes are mixed. After each interval of
//! the series, the seeds that are due by then appear at rest, at random places and orientations, clear of
//! walls and of all seeds that are there. They appear as low as there is room, because a soft seed that
//! falls far is pressed in deeply. A seed that finds no place waits for the next interval.
//!
//! # Source
//!
//! `[CottonStudy, section 2.4.3]`: 4400 and 600 seeds a second.

use crate::build::Built;
use crate::placement::{Capsule, Placed, Room, TRIES, if_free, try_place};
use crate::{Apparatus, Error, Scene};
use dem_solver::Placement;
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Where seeds appear: above this share of the height of the apparatus.
const FLOOR: f64 = 0.3;

/// Height above which seeds appear in a room between two heights, m.
pub(crate) fn lowest_place(low: f64, high: f64) -> f64 {
    low + FLOOR * (high - low)
}

/// What makes the seeds of a run.
#[derive(Debug, Clone)]
pub(crate) struct Factory {
    /// Kind of each seed, in the order in which they appear.
    order: Vec<usize>,
    /// Seeds a second.
    rate: f64,
    /// The seed of the randomness.
    seed: u64,
}

impl Factory {
    /// Of a scene that states a rate.
    pub(crate) fn of(scene: &Scene, seed: u64) -> Option<Self> {
        let rate = scene.protocol.insertion_rate?.si();
        let kinds = scene.seed.iter().enumerate();
        let mut order: Vec<usize> = kinds
            .flat_map(|(k, kind)| std::iter::repeat_n(k, scene.count_of(kind)))
            .collect();
        Stream::new(seed, "factory").shuffle(&mut order);
        Some(Self { order, rate, seed })
    }

    /// Time that the rate needs for all seeds, s.
    pub(crate) fn duration(&self) -> f64 {
        self.order.len() as f64 / self.rate
    }

    /// Kinds of the seeds of some numbers in rising order, or of the first seeds if no numbers are given; `None` if it makes fewer.
    pub(crate) fn made(&self, numbers: &[usize], count: usize) -> Option<Vec<usize>> {
        if numbers.is_empty() {
            return self.order.get(..count).map(<[usize]>::to_vec);
        }
        let mut numbers = numbers.to_vec();
        numbers.sort_unstable();
        // Seeds behind the last sorting have the numbers of their places.
        numbers.extend(numbers.len()..count);
        let kinds = numbers
            .iter()
            .map(|&number| self.order.get(number).copied());
        kinds.collect()
    }

    /// Refuses an apparatus that is not full of all seeds at the end of the time.
    pub(crate) fn check_all_in(&self, inside: usize) -> Result<(), Error> {
        if inside == self.order.len() {
            return Ok(());
        }
        Err(Error::FullBeforeAllSeeds {
            count: self.order.len(),
            inside,
        })
    }

    /// The seeds that appear now, `interval` (s) after the last ones; `gone` were taken out before.
    pub(crate) fn next(
        &self,
        apparatus: &Apparatus,
        built: &Built,
        (gone, interval): (usize, f64),
    ) -> Vec<Placement> {
        let inside = built.world.bodies().len();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "times and rates are not negative, and the number of seeds bounds it"
        )]
        let due = ((built.world.time() + interval) * self.rate).round() as usize;
        let due = due.min(self.order.len());
        let made_before = inside + gone;
        if made_before >= due {
            return Vec::new();
        }
        let capsules: Vec<Capsule> = built
            .bodies
            .iter()
            .map(|body| Capsule::around(&body.clump))
            .collect();
        let [low, high] = apparatus.device().room();
        let low = Vector3::new(low.x, lowest_place(low.y, high.y), low.z);
        let mut placed = placed_above(low.y, apparatus, built, &capsules);
        let obstacles = built.meshes.iter().flat_map(|m| m.triangles.clone());
        let obstacles: Vec<_> = obstacles.collect();
        let room = Room {
            apparatus,
            obstacles: &obstacles,
        };
        // What was drawn before is not known after a restart: the step is.
        let purpose = format!("factory at step {}", built.world.n_steps());
        let mut stream = Stream::new(self.seed, &purpose);
        let mut made = Vec::new();
        for &kind in &self.order[made_before..due] {
            let near: Vec<&Placed> = placed.iter().collect();
            let mut tries = 0.0;
            let low_first = |stream: &mut Stream| {
                tries += 1.0;
                let top = low.y + (high.y - low.y) * tries / TRIES as f64;
                let high = Vector3::new(high.x, top, high.z);
                Vector3::from_fn(|axis, _| stream.between(low[axis], high[axis]))
            };
            let fits = |body: &Placed, turn: &UnitQuaternion<f64>| if_free(room, body, turn, &near);
            let found = try_place(capsules[kind], low_first, fits, &mut stream);
            let Some((body, turn)) = found else {
                break;
            };
            placed.push(body);
            made.push(Placement::at_rest(kind, body.centre(), turn));
        }
        made
    }
}

/// The seeds that reach above a height (m), as capsules.
fn placed_above(
    low: f64,
    apparatus: &Apparatus,
    built: &Built,
    capsules: &[Capsule],
) -> Vec<Placed> {
    let (bodies, positions) = (built.world.bodies(), built.positions());
    let reach = capsules.iter().map(Capsule::reach).fold(0.0, f64::max);
    let sides = apparatus.device().periodic_sides();
    let period = sides.map(|sides| sides.distance());
    let mut placed = Vec::new();
    for i in (0..bodies.len()).filter(|&i| positions[i].y > low - 2.0 * reach) {
        // A seed that sticks out of a periodic side takes room at the other.
        let beyond = period.into_iter().flat_map(|period| [-period, period]);
        for shift in std::iter::once(0.0).chain(beyond) {
            let centre = positions[i] + Vector3::z() * shift;
            placed.push(capsules[bodies.template[i]].at(centre, &bodies.orientation[i]));
        }
    }
    placed
}
