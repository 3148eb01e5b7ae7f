//! Several steps in one sweep through a large world of spheres.
//!
//! A step reads and writes the whole state of a world. A large one exceeds the caches, and the processor waits
//! for the memory longer than it computes. A sweep advances one part of the bodies after the other by several steps while it is in
//! the cache. The contacts of a part wait until its bodies, and those of the parts before it, have made the step before; its
//! bodies move once the parts behind it that act on them have found their contacts. Each body gets its loads in
//! the order of single steps, so that every bit of the result is the same.
//!
//! The steps of a sweep follow each other through the parts, each at a range of parts of its own. Threads take turns of
//! different steps at the same time: a turn reads and writes the bodies of its range alone.
//!
//! It pays if neighbours are near each other in memory ([`World::sort_bodies`]).

use super::World;
use crate::advance::advance;
use crate::batch::Loads;
use crate::bodies::BodySlices;
use crate::context::Context;
use crate::error::Error;
use crate::integrate::Surroundings;
use crate::interaction::Interaction;
use crate::part::Part;
use crate::phases::Clock;
use crate::wall::Wall;
use crate::window::Window;
use crate::workspace::Workspace;
use fearless_simd::Level;
use nalgebra::Vector3;
use std::mem::take;
use std::ops::Range;

/// Steps of a sweep for each thread: our choice, as eight gain no more with 100 000 spheres on a processor with 32 MiB of cache
/// (`benchmark --against` builds with other numbers). Several threads find turns at the ends of the parts too.
const STEPS_PER_THREAD: usize = 4;

/// Most steps of a sweep: our choice; the lists rarely hold for more.
const MOST_STEPS: usize = 32;

/// Parts for each thread from which on several threads sweep: a step needs three parts, and each thread a step. Measured with two threads:
/// 10 000 spheres are slower so, 20 000 faster.
const PARTS_PER_THREAD: usize = 10;

/// Bodies of a part of a world that is swept: our choice; 512 to 2048 cost the same.
pub(super) const BODIES_OF_PART: usize = 1 << 10;

/// How much faster than the fastest body of now one may become during a sweep: our choice. A light ball that a heavy one
/// hits leaves at most twice as fast as that came, or three times as fast if both came.
const SPEED_UP: f64 = 4.0;

/// Acceleration that even a body at rest may have during a sweep beside that, over gravity or 1 m/s²: our choice.
const MOST_ACCELERATION: f64 = 10.0;

/// Largest share of the motion that lists cover which a sweep may keep in reserve: our choice. They are rebuilt so much
/// earlier, a third more often at worst, and making them takes a hundredth of the time.
const MOST_RESERVE: f64 = 0.25;

/// What one step of a sweep does at a time: it finds the contacts of a part, and moves all parts that then have their loads.
#[derive(Debug)]
struct Turn {
    /// The step, from 0 on.
    step: usize,
    /// Part whose contacts it finds; none if it has found all.
    finds: Option<usize>,
    /// Parts that it moves.
    moves: Range<usize>,
    /// Longest way of a body that it has moved, m.
    longest: f32,
    /// Time of the contacts, s, where it is counted.
    contacts: f64,
    /// Time of the motion, s, where it is counted.
    motion: f64,
}

impl Turn {
    /// The first part that it reads or writes: those before have made the step, and no later contact acts on them.
    fn first_part(&self) -> usize {
        self.moves.start
    }
}

/// How far the steps of a sweep are: for each the number of parts that have found their contacts, and of those that have moved.
#[derive(Debug)]
struct Progress {
    found: Vec<usize>,
    moved: Vec<usize>,
}

impl Progress {
    /// The turns that can be taken now, the last step first: their parts are in rising order and do not overlap.
    fn turns<'a>(&'a self, last_partners: &'a [usize]) -> impl Iterator<Item = Turn> + 'a {
        let n_parts = last_partners.len();
        let turn = move |step: usize| {
            let next = self.found[step];
            // These bodies have made the step before, and so have their partners, which are in earlier parts.
            let is_ready = step == 0 || self.moved[step - 1] > next;
            let finds = (next < n_parts && is_ready).then_some(next);
            let found = finds.map_or(next, |part| part + 1);
            // All parts whose contacts act on these bodies have added their loads.
            let from = self.moved[step];
            let ready = last_partners[from..]
                .iter()
                .take_while(|last| **last < found);
            let moves = from..from + ready.count();
            let has_work = finds.is_some() || !moves.is_empty();
            has_work.then_some(Turn {
                step,
                finds,
                moves,
                longest: 0.0,
                contacts: 0.0,
                motion: 0.0,
            })
        };
        (0..self.found.len()).rev().filter_map(turn)
    }

    /// Notes a turn that was taken.
    fn note(&mut self, turn: &Turn) {
        self.found[turn.step] += usize::from(turn.finds.is_some());
        self.moved[turn.step] += turn.moves.len();
    }
}

/// What all turns of a sweep read.
#[derive(Debug, Clone, Copy)]
struct Fixed<'a> {
    level: Level,
    walls: &'a [Wall],
    context: Context<'a>,
    around: &'a Surroundings,
    /// The last step of the sweep.
    last_step: usize,
    counts_time: bool,
}

/// Parts in a row with their bodies, on which turns work.
#[derive(Debug)]
struct Stretch<'a> {
    first_part: usize,
    parts: &'a mut [Part],
    loads: Loads<'a>,
    /// Without their loads.
    bodies: BodySlices<'a>,
    /// Force (N) and torque (N m) on each wall, where the last step is; empty elsewhere.
    on_walls: (&'a mut [Vector3<f64>], &'a mut [f64]),
}

impl Stretch<'_> {
    /// The parts before `part` and those from there on.
    fn split_at(self, part: usize) -> (Self, Self) {
        let first = self.loads.first;
        let (low, high) = self.parts.split_at_mut(part - self.first_part);
        let body = high[0].range().start;
        let loads = self.loads.split_at(body);
        let bodies = self.bodies.split_at(body - first);
        let low = Self {
            first_part: self.first_part,
            parts: low,
            loads: loads.0,
            bodies: bodies.0,
            on_walls: self.on_walls,
        };
        let high = Self {
            first_part: part,
            parts: high,
            loads: loads.1,
            bodies: bodies.1,
            on_walls: (&mut [], &mut []),
        };
        (low, high)
    }

    /// Takes a turn within it.
    fn take_turn(&mut self, turn: &mut Turn, fixed: &Fixed<'_>, workspace: &mut Workspace) {
        let mut clock = Clock::start(fixed.counts_time);
        let first = self.loads.first;
        if let Some(part) = turn.finds {
            let part = &mut self.parts[part - self.first_part];
            let travel = Window::new(first, self.bodies.travel);
            let context = Context {
                spheres: Window::new(first, self.bodies.spheres),
                ..fixed.context
            };
            let (walls, loads) = (fixed.walls, &mut self.loads);
            part.clear(loads);
            part.find_loads_of_spheres(fixed.level, travel, walls, &context, workspace, loads);
        }
        turn.contacts = clock.lap();
        for part in turn.moves.clone() {
            let part = &self.parts[part - self.first_part];
            part.give_wall_forces(&mut self.loads);
            if turn.step == fixed.last_step {
                let on_walls = (&mut *self.on_walls.0, &mut *self.on_walls.1);
                part.add_to_walls(Window::new(first, self.bodies.position), on_walls);
            }
            let range = part.range().start - first..part.range().end - first;
            let load = &self.loads.all[range.clone()];
            let own = self.bodies.within(range, load);
            let templates = fixed.context.templates;
            let longest = advance(fixed.level, false, own, templates, fixed.around);
            turn.longest = turn.longest.max(longest);
        }
        turn.motion = clock.lap();
    }
}

/// Takes turns, whose parts are in rising order; halves at the same time if there is more than one workspace.
fn take_turns(
    turns: &mut [Turn],
    mut stretch: Stretch<'_>,
    fixed: &Fixed<'_>,
    workspaces: &mut [Workspace],
) {
    if turns.len() < 2 || workspaces.len() < 2 {
        for turn in turns {
            stretch.take_turn(turn, fixed, &mut workspaces[0]);
        }
        return;
    }
    let (low, high) = turns.split_at_mut(turns.len() / 2);
    let stretches = stretch.split_at(high[0].first_part());
    let workspaces = workspaces.split_at_mut(workspaces.len() / 2);
    rayon::join(
        || take_turns(low, stretches.0, fixed, workspaces.0),
        || take_turns(high, stretches.1, fixed, workspaces.1),
    );
}

impl World {
    /// Moves the world by `n` steps: the same bits as `n` calls of [`Self::step`], and faster in a large world of spheres.
    ///
    /// # Errors
    ///
    /// A body that has run away or whose state is no longer finite. The world may have gone on by then.
    pub fn steps(&mut self, n: u64) -> Result<(), Error> {
        let most = MOST_STEPS.min(STEPS_PER_THREAD * self.n_threads());
        let mut left = n;
        while left > 0 {
            let most = usize::try_from(left).map_or(most, |left| left.min(most));
            left -= if self.can_be_swept() {
                self.sweep_or_step(most)?
            } else {
                self.step()?;
                1
            };
        }
        Ok(())
    }

    /// Moves the world by at most so many steps; how many they were.
    fn sweep_or_step(&mut self, most: usize) -> Result<u64, Error> {
        let together = self.steps_of_lists(most)?;
        if together > 1 {
            self.sweep(together)?;
        } else {
            self.step()?;
        }
        Ok(together as u64)
    }

    /// Moves the world by steps until its time is not before `end` (s); [`Self::steps`] says how.
    ///
    /// # Errors
    ///
    /// As of [`Self::steps`].
    pub fn steps_until(&mut self, end: f64) -> Result<(), Error> {
        // Counted as the time is, to the last bit.
        let (mut time, mut n) = (self.time, 0);
        while time < end {
            time += self.settings.time_step;
            n += 1;
        }
        self.steps(n)
    }

    /// Whether all bodies are spheres.
    pub(super) fn is_of_spheres(&self) -> bool {
        self.templates.iter().all(|template| template.is_sphere)
    }

    /// Whether a body depends on the bodies near it alone.
    pub(super) fn is_local(&self) -> bool {
        self.is_of_spheres()
            && self.mesh_walls.moving.is_empty()
            && !self.interactions.iter().any(Interaction::is_wet)
    }

    /// Whether that is so, and there are parts enough for each thread.
    pub(super) fn can_be_swept(&self) -> bool {
        let threads = self.n_threads();
        let fewest = if threads > 1 {
            PARTS_PER_THREAD * threads
        } else {
            2
        };
        self.parts.len() >= fewest && self.is_local()
    }

    /// The number of steps, at most so many, for which the lists hold or are made again; 1 if bodies are too fast for that to pay.
    fn steps_of_lists(&mut self, most: usize) -> Result<usize, Error> {
        let half = 0.5 * self.settings.margin;
        let (mut n, mut way) = (most, self.longest_way(most));
        while n > 1 && (way.is_nan() || way > MOST_RESERVE * half) {
            n /= 2;
            way = self.longest_way(n);
        }
        if n > 1 && f64::from(self.longest) + way > half {
            let mut clock = Clock::start(self.phases.is_some());
            self.search_pairs()?;
            self.longest = 0.0;
            if let Some(phases) = &mut self.phases {
                phases.search += clock.lap();
            }
        }
        Ok(n.max(1))
    }

    /// Longest displacement of a body within `n` steps that is thought possible, in the frame in which travels are measured, m.
    fn longest_way(&self, n: usize) -> f64 {
        let bodies = &self.bodies;
        let square = |v: &Vector3<f64>| v.norm_squared();
        let fastest = bodies.velocity.iter().map(square).fold(0.0, f64::max);
        let farthest = bodies.position.iter().map(|p| p.xy().norm_squared());
        let spins = self.walls.iter().map(|wall| wall.spin.abs());
        let spin = spins.fold(self.reference_spin.abs(), f64::max);
        // A wall drags bodies along.
        let speed = fastest.sqrt() + spin * farthest.fold(0.0, f64::max).sqrt();
        let time = n as f64 * self.settings.time_step;
        let acceleration = MOST_ACCELERATION * self.settings.gravity.norm().max(1.0);
        time * (SPEED_UP * speed + acceleration * time)
    }

    /// Moves the world by `n` steps, for which the lists hold.
    fn sweep(&mut self, n: usize) -> Result<(), Error> {
        // One change of threads for the whole sweep.
        let longest = match self.pool.clone() {
            Some(pool) => pool.install(|| self.sweep_here(n)),
            None => self.sweep_here(n),
        };
        self.n_steps += n as u64;
        for _ in 0..n {
            self.time += self.settings.time_step;
        }
        self.longest = longest[n - 1];
        self.check_ways(longest[n - 2])
    }

    /// Moves the bodies by `n` steps on a thread of the pool, if there is one; after each the longest way of a body since the last
    /// broad phase, m.
    fn sweep_here(&mut self, n: usize) -> Vec<f32> {
        self.wall_load.fill(Vector3::zeros());
        self.wall_torque.fill(0.0);
        let (mut parts, mut workspaces) = (take(&mut self.parts), take(&mut self.workspaces));
        let (mut bodies, mut spheres) = (take(&mut self.bodies), take(&mut self.spheres));
        let mut loads = take(&mut bodies.load);
        let (mut force, mut torque) = (take(&mut self.wall_load), take(&mut self.wall_torque));
        let fixed = Fixed {
            level: self.level,
            walls: &self.walls,
            context: self.context(),
            around: &self.surroundings(),
            last_step: n - 1,
            counts_time: self.phases.is_some(),
        };
        let (found, moved) = (vec![0; n], vec![0; n]);
        let mut progress = Progress { found, moved };
        let mut longest = vec![0.0_f32; n];
        let (mut contacts, mut motion) = (0.0, 0.0);
        // One thread takes the turn of the latest step: its data are in the cache.
        let at_once = if workspaces.len() > 1 { n } else { 1 };
        while progress.moved[n - 1] < parts.len() {
            let turns = progress.turns(&self.last_partners).take(at_once);
            let mut turns: Vec<Turn> = turns.collect();
            let stretch = Stretch {
                first_part: 0,
                parts: &mut parts,
                loads: Loads::of(&mut loads),
                bodies: bodies.slices(&mut spheres),
                on_walls: (&mut force, &mut torque),
            };
            take_turns(&mut turns, stretch, &fixed, &mut workspaces);
            for turn in &turns {
                progress.note(turn);
                longest[turn.step] = longest[turn.step].max(turn.longest);
                contacts += turn.contacts;
                motion += turn.motion;
            }
        }
        bodies.load = loads;
        (self.bodies, self.spheres) = (bodies, spheres);
        (self.parts, self.workspaces) = (parts, workspaces);
        (self.wall_load, self.wall_torque) = (force, torque);
        if let Some(phases) = &mut self.phases {
            phases.add([0.0, contacts, 0.0, 0.0, motion]);
        }
        longest
    }

    /// Refuses a sweep in which the lists did not hold up to the last step: a body has run away. Checked afterwards, because the
    /// bound of the sweep is an estimate and not a proof.
    fn check_ways(&self, longest: f32) -> Result<(), Error> {
        if f64::from(longest) <= 0.5 * self.settings.margin {
            return Ok(());
        }
        self.check_finite()?;
        let shifts = self.bodies.shift.iter().enumerate();
        let farthest = shifts.max_by(|a, b| a.1.total_cmp(b.1));
        Err(Error::Diverged {
            body: farthest.map_or(0, |(body, _)| body),
            time: self.time,
            time_step: self.settings.time_step,
        })
    }
}

/// For each part the last one whose contacts act on its bodies.
pub(super) fn last_partners(parts: &[Part]) -> Vec<usize> {
    let mut last: Vec<usize> = (0..parts.len()).collect();
    for (k, part) in parts.iter().enumerate() {
        if let Some(lowest) = part.lowest_partner() {
            let first = parts.partition_point(|p| p.range().end <= lowest);
            last[first..=k].fill(k);
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use crate::{
        DashpotMass, Interaction, InteractionSettings, Placement, Settings, Shape, Template, Wall,
        World,
    };
    use contact_law::{Material, NormalForceEnd, PairParameters};
    use geometry::clump::Clump;
    use nalgebra::{UnitQuaternion, Vector3};
    use probability::random_stream::Stream;

    /// Balls of 4 mm that fall between six walls, 12 by 16 by 30 of them: six parts.
    fn falling() -> World {
        let clump = Clump::sphere(2e-3, 1000.0).unwrap();
        let templates = vec![Template::new(&clump, 0, DashpotMass::Body)];
        let parameters = PairParameters {
            restitution: 0.4,
            static_friction: 0.4,
            rolling_friction: 0.05,
        };
        let interaction = Interaction::new(&InteractionSettings {
            materials: [Material::new(0.25, 4e6).unwrap(); 2],
            parameters,
            attraction: 0.0,
            end: NormalForceEnd::Clipped,
        });
        let half = Vector3::new(0.026, 0.036, 0.066);
        let plane = |axis: usize, sign: f64| {
            let inward = Vector3::ith(axis, -sign);
            Wall {
                name: format!("wall {axis} {sign}"),
                shape: Shape::Plane {
                    point: -inward * half[axis],
                    normal: inward,
                },
                material: 0,
                spin: 0.0,
            }
        };
        let walls = (0..3).flat_map(|axis| [plane(axis, -1.0), plane(axis, 1.0)]);
        let mut stream = Stream::new(3, "sweep");
        let mut starts = Vec::new();
        for number in 0..12 * 16 * 30 {
            let cell = [number % 12, number / 12 % 16, number / 192].map(f64::from);
            let place = Vector3::from(cell) - Vector3::new(5.5, 7.5, 14.5);
            let moved = Vector3::from_fn(|_, _| stream.between(-5e-5, 5e-5));
            let start = Placement::at_rest(0, place * 4.1e-3 + moved, UnitQuaternion::identity());
            let velocity = Vector3::from_fn(|_, _| stream.between(-0.3, 0.3));
            starts.push(Placement { velocity, ..start });
        }
        let settings = Settings {
            time_step: 2e-5,
            gravity: Vector3::new(0.0, -9.81, 0.0),
            skin: 3e-4,
            margin: 1e-3,
        };
        World::new(
            settings,
            templates,
            vec![interaction.unwrap()],
            walls.collect(),
            &starts,
        )
        .unwrap()
    }

    /// Sweeps and single steps, in turn with other numbers of steps, give the same bits: of bodies, of forces and
    /// of walls, in the order in which the bodies were placed and sorted, on one thread and on three, which take up to eight steps
    /// together. The lists of before a sweep are older, and what touches is found all the same.
    #[test]
    fn sweeps_change_no_bit() {
        for (sorts, threads) in [(false, 1), (true, 1), (false, 3), (true, 3)] {
            let [mut swept, mut single] = [falling(), falling()];
            swept.set_threads(threads).unwrap();
            let mut contacts = 0;
            for steps in [4, 150, 31, 200, 1, 2, 1800] {
                if sorts {
                    swept.sort_bodies().unwrap();
                    single.sort_bodies().unwrap();
                }
                assert_eq!(swept.can_be_swept(), threads == 1, "few parts for threads");
                let mut left = steps;
                while left > 0 {
                    let most = usize::try_from(left)
                        .unwrap()
                        .min(if threads > 1 { 8 } else { 4 });
                    left -= swept.sweep_or_step(most).unwrap();
                }
                (0..steps).for_each(|_| single.step().unwrap());
                assert!(swept.bodies.load == single.bodies.load);
                assert!(swept.bodies.position == single.bodies.position);
                assert!(swept.bodies.orientation == single.bodies.orientation);
                assert!(swept.bodies.spin == single.bodies.spin);
                assert_eq!(swept.wall_load, single.wall_load);
                assert_eq!(swept.wall_torque, single.wall_torque);
                assert_eq!((swept.time, swept.n_steps), (single.time, single.n_steps));
                contacts += swept.census().sphere_contacts;
            }
            assert!(contacts > 5000, "the bodies hardly meet: {contacts}");
            // In the order of the placing, parts wait for the next one alone.
            let n_parts = swept.parts.len();
            let last: Vec<usize> = (0..n_parts).map(|k| (k + 1).min(n_parts - 1)).collect();
            assert_eq!(swept.last_partners, last);
        }
    }

    /// A body that has come farther than the lists hold is named.
    #[test]
    fn a_body_that_outruns_the_lists_is_named() {
        let mut world = falling();
        world.steps(8).unwrap();
        world.bodies.shift[7] = 6e-4;
        let error = world.sweep(4).unwrap_err().to_string();
        assert!(error.contains("body 7 has run away"), "{error}");
    }
}
