//! Several steps in one sweep through a large world of spheres.
//!
//! A step reads and writes the whole state of a world. A large one exceeds the caches, and the processor waits
//! for the memory longer than it computes. A sweep advances one part of the bodies after the other by several steps while it is in
//! the cache. The contacts of a part wait until its bodies, and those of the parts before it, have made the step before; its
//! bodies move once the parts behind it that act on them have found their contacts. Each body gets its loads in
//! the order of single steps, so that every bit of the result is the same.
//!
//! It pays if neighbours are near each other in memory ([`World::sort_bodies`]).

use super::World;
use crate::advance::advance;
use crate::batch::Loads;
use crate::error::Error;
use crate::interaction::Interaction;
use crate::part::Part;
use crate::phases::Clock;
use nalgebra::Vector3;
use std::mem::take;

/// Steps of a sweep: our choice, as eight gain no more with 100 000 spheres on a processor with 32 MiB of cache
/// (`benchmark --against` builds with other numbers).
const MOST_STEPS: usize = 4;

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

impl World {
    /// Moves the world by `n` steps: the same bits as `n` calls of [`Self::step`], and faster in a large world of
    /// spheres on one thread.
    ///
    /// # Errors
    ///
    /// A body that has run away or whose state is no longer finite. The world may have gone on by then.
    pub fn steps(&mut self, n: u64) -> Result<(), Error> {
        let mut left = n;
        while left > 0 {
            let together = usize::try_from(left).map_or(MOST_STEPS, |n| n.min(MOST_STEPS));
            if together > 1 && self.can_be_swept() && self.lists_hold(together)? {
                self.sweep(together)?;
                left -= together as u64;
            } else {
                self.step()?;
                left -= 1;
            }
        }
        Ok(())
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
    pub(super) fn can_be_swept(&self) -> bool {
        self.parts.len() > 1
            && self.pool.is_none()
            && self.is_of_spheres()
            && self.mesh_walls.moving.is_empty()
            && !self.interactions.iter().any(Interaction::is_wet)
    }

    /// Makes the lists again unless they hold for so many steps; false if bodies are too fast for that to pay.
    fn lists_hold(&mut self, n: usize) -> Result<bool, Error> {
        let half = 0.5 * self.settings.margin;
        let way = self.longest_way(n);
        if way.is_nan() || way > MOST_RESERVE * half {
            return Ok(false);
        }
        if f64::from(self.longest) + way > half {
            let mut clock = Clock::start(self.phases.is_some());
            self.search_pairs()?;
            self.longest = 0.0;
            if let Some(phases) = &mut self.phases {
                phases.search += clock.lap();
            }
        }
        Ok(true)
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
    // One loop over the state of all steps: its parts would share seven variables.
    fn sweep(&mut self, n: usize) -> Result<(), Error> {
        let mut clock = Clock::start(self.phases.is_some());
        let (mut contacts, mut motion) = (0.0, 0.0);
        let mut parts = take(&mut self.parts);
        let mut loads = take(&mut self.bodies.load);
        let mut workspaces = take(&mut self.workspaces);
        // For each step the parts that have found their contacts, and those that have moved.
        let (mut found, mut moved) = ([0; MOST_STEPS], [0; MOST_STEPS]);
        let mut longest = [0.0_f32; MOST_STEPS];
        self.wall_load.fill(Vector3::zeros());
        self.wall_torque.fill(0.0);
        // Each turn does one of two things for one part and one step: it moves the bodies, or finds their contacts.
        while moved[n - 1] < parts.len() {
            // The latest step that can continue: its data are in the cache.
            for step in (0..n).rev() {
                let k = moved[step];
                // All parts whose contacts act on these bodies have added their loads.
                if k < parts.len() && found[step] > self.last_partners[k] {
                    let part = &parts[k];
                    part.give_wall_forces(&mut Loads::of(&mut loads));
                    if step == n - 1 {
                        let on_walls = (
                            self.wall_load.as_mut_slice(),
                            self.wall_torque.as_mut_slice(),
                        );
                        part.add_to_walls(&self.bodies.position, on_walls);
                    }
                    self.bodies.load = loads;
                    longest[step] = longest[step].max(self.move_part(part));
                    loads = take(&mut self.bodies.load);
                    moved[step] += 1;
                    motion += clock.lap();
                    break;
                }
                let k = found[step];
                // These bodies have made the step before, and so have their partners, which are in earlier parts.
                if k < parts.len() && (step == 0 || moved[step - 1] > k) {
                    let (workspace, mut all) = (&mut workspaces[0], Loads::of(&mut loads));
                    let (part, context) = (&mut parts[k], self.context());
                    part.clear(&mut all);
                    part.find_loads(
                        self.level,
                        &self.bodies,
                        &self.walls,
                        &context,
                        workspace,
                        &mut all,
                    );
                    found[step] += 1;
                    contacts += clock.lap();
                    break;
                }
            }
        }
        (self.parts, self.workspaces, self.bodies.load) = (parts, workspaces, loads);
        self.n_steps += n as u64;
        for _ in 0..n {
            self.time += self.settings.time_step;
        }
        self.longest = longest[n - 1];
        if let Some(phases) = &mut self.phases {
            phases.add([0.0, contacts, 0.0, 0.0, motion]);
        }
        self.check_ways(longest[n - 2])
    }

    /// Moves the bodies of a part by a step; longest way of one since the last broad phase, m.
    fn move_part(&mut self, part: &Part) -> f32 {
        let around = self.surroundings();
        let range = part.range();
        let (_, bodies) = self.bodies.slices(&mut self.spheres).split_at(range.start);
        let (own, _) = bodies.split_at(range.len());
        advance(self.level, false, own, &self.templates, &around)
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
    /// of walls, in the order in which the bodies were placed and sorted. The lists of before a sweep are older, and what
    /// touches is found all the same.
    #[test]
    fn sweeps_change_no_bit() {
        for sorts in [false, true] {
            let [mut swept, mut single] = [falling(), falling()];
            let mut contacts = 0;
            for steps in [4, 150, 31, 200, 1, 2, 1800] {
                if sorts {
                    swept.sort_bodies().unwrap();
                    single.sort_bodies().unwrap();
                }
                assert!(swept.can_be_swept());
                swept.steps(steps).unwrap();
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
            let last: Vec<usize> = (0..6).map(|k| (k + 1).min(5)).collect();
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
