//! Where the energy of a run goes: a ledger by the plain force loop.
//!
//! # Formula
//!
//! Over each step, with the mean of the velocities before and after it:
//!
//! ```text
//! kinetic + potential + elastic + dissipated - driven = constant
//! ```
//!
//! `elastic` is a function of the overlaps and slips alone (`8/15 E* sqrt(R*) d^(5/2) - F_c d + 1/2 k_t
//! s²`), `driven` the work of the walls, and `dissipated` the work of the dashpots and of sliding and
//! rolling friction, each from its own force. What the terms leave open is the error of the time
//! stepping, and the change of `k_t` under a stored slip is counted as friction.
//!
//! The ledger looks at every pair of spheres in each step: it is for small worlds. It refuses walls of
//! triangles and bridges of liquid, whose energies it does not know.

use crate::contact::{ContactWrench, Memory};
use crate::error::Error;
use crate::interaction::Interaction;
use crate::plain::{find_at_wall, find_pairs};
use crate::world::World;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Energies since the ledger was opened, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyTerms {
    /// Kinetic energy now.
    pub kinetic: f64,
    /// Potential energy in gravity now, about the origin.
    pub potential: f64,
    /// Energy in the springs of the contacts now.
    pub elastic: f64,
    /// Work that the normal dashpots (and the clipping of their pull) took.
    pub damped: f64,
    /// Work that sliding took: tangential springs and dashpots, less what is stored.
    pub rubbed: f64,
    /// Work that rolling resistance took.
    pub rolled: f64,
    /// Work of the walls on the bodies.
    pub driven: f64,
}

impl EnergyTerms {
    /// The sum that must stay constant, J.
    pub fn balance(&self) -> f64 {
        self.kinetic + self.potential + self.elastic + self.damped + self.rubbed + self.rolled
            - self.driven
    }
}

/// A contact: body, body or wall, whether it is a wall, and the spheres.
type Key = (usize, usize, bool, u32);

/// A contact in one step.
#[derive(Debug, Clone, Copy)]
struct Contact {
    /// Which contact.
    key: Key,
    /// From the centres of both bodies to the point of contact, m.
    arms: [Vector3<f64>; 2],
    /// Velocity (m/s) and spin (rad/s) of the wall.
    wall: [Vector3<f64>; 2],
    /// Unit normal.
    normal: Vector3<f64>,
    /// Force on body i, N.
    force: Vector3<f64>,
    /// Torque of rolling resistance on body i, N m.
    rolling: Vector3<f64>,
    /// Force of the normal spring, N, and its energy, J.
    spring: [f64; 2],
    /// What the contact remembers.
    memory: Memory,
    /// Energy of the tangential spring, J.
    stored: f64,
}

/// What one step took and gave, J.
#[derive(Debug, Clone, Copy, Default)]
struct Work {
    damped: f64,
    rubbed: f64,
    rolled: f64,
    driven: f64,
}

/// The ledger of a world.
#[derive(Debug, Clone, Default)]
pub struct EnergyLedger {
    /// Memory of the contacts and energy of their tangential springs after the last step.
    history: BTreeMap<Key, (Memory, f64)>,
    /// Work up to the middle of the last step.
    done: Work,
    /// Terms at the moment of the last force.
    terms: EnergyTerms,
}

impl EnergyLedger {
    /// Moves the world by one step and books the work of it.
    ///
    /// Start with a world that has no contacts, and call this for every step.
    ///
    /// # Errors
    ///
    /// A world with walls of triangles or bridges of liquid, a body that has run away.
    pub fn step(&mut self, world: &mut World) -> Result<(), Error> {
        let unknown = if world.mesh_walls().next().is_some() {
            Some("walls of triangles")
        } else if world.context().cutoffs.reach > 0.0 {
            Some("bridges of liquid")
        } else {
            None
        };
        if let Some(what) = unknown {
            return Err(Error::NotInLedger { what });
        }
        let contacts = self.contacts(world);
        let potential = potential(world);
        let before = world.bodies().clone();
        let kinetic = world.kinetic_energy();
        world.step()?;
        let work = self.work(&contacts, &before, world);
        // Forces belong to the middle of their step: half of the work lies before that moment.
        let half = |done: f64, now: f64| done + 0.5 * now;
        self.terms = EnergyTerms {
            kinetic: 0.5 * (kinetic + world.kinetic_energy()),
            potential,
            elastic: contacts.iter().map(|c| c.spring[1] + c.stored).sum(),
            damped: half(self.done.damped, work.damped),
            rubbed: half(self.done.rubbed, work.rubbed),
            rolled: half(self.done.rolled, work.rolled),
            driven: half(self.done.driven, work.driven),
        };
        self.done.damped += work.damped;
        self.done.rubbed += work.rubbed;
        self.done.rolled += work.rolled;
        self.done.driven += work.driven;
        let kept = contacts.iter().map(|c| (c.key, (c.memory, c.stored)));
        self.history = kept.collect();
        Ok(())
    }

    /// The terms at the moment of the last force.
    pub fn terms(&self) -> EnergyTerms {
        self.terms
    }

    /// Work of a step with the mean of the velocities before and after it.
    fn work(&self, contacts: &[Contact], before: &crate::Bodies, world: &World) -> Work {
        let (after, time_step) = (world.bodies(), world.settings().time_step);
        let mean = |k: usize, arm: &Vector3<f64>| {
            let spin = 0.5 * (before.spin[k] + after.spin[k]);
            let velocity = 0.5 * (before.velocity[k] + after.velocity[k]);
            [velocity + spin.cross(arm), spin]
        };
        let mut work = Work::default();
        let mut stored = 0.0;
        for contact in contacts {
            let (i, j, is_wall, _) = contact.key;
            let [velocity_i, spin_i] = mean(i, &contact.arms[0]);
            let [velocity_j, spin_j] = if is_wall {
                contact.wall
            } else {
                mean(j, &contact.arms[1])
            };
            let relative = velocity_i - velocity_j;
            let along = contact.normal * contact.force.dot(&contact.normal);
            let spring = -contact.normal * contact.spring[0];
            work.damped -= (along - spring).dot(&relative) * time_step;
            work.rubbed -= (contact.force - along).dot(&relative) * time_step;
            work.rolled -= contact.rolling.dot(&(spin_i - spin_j)) * time_step;
            stored += contact.stored;
            if is_wall {
                let power = contact.force.dot(&velocity_j) + contact.rolling.dot(&spin_j);
                work.driven += power * time_step;
            }
        }
        // What the tangential springs hold is not lost yet; what ended contacts held is.
        work.rubbed -= stored - self.history.values().map(|h| h.1).sum::<f64>();
        work
    }

    /// All contacts of the state before a step.
    fn contacts(&self, world: &World) -> Vec<Contact> {
        let bodies = world.bodies();
        let bounding_radius = |k: usize| world.templates()[bodies.template[k]].bounding_radius;
        let mut contacts = Vec::new();
        for i in 0..bodies.len() {
            for j in i + 1..bodies.len() {
                let reach = bounding_radius(i) + bounding_radius(j);
                let between = world
                    .period()
                    .nearest(bodies.position[j] - bodies.position[i]);
                if between.norm() > reach {
                    continue;
                }
                let known = |spheres| self.memory(&(i, j, false, spheres));
                find_pairs(world, [i, j], known, |spheres, pair, law, effect| {
                    let distance = pair.between.norm();
                    let [a, b] = pair.radii;
                    let (overlap, normal) = (a + b - distance, pair.between / distance);
                    let arms = [
                        pair.offset_i + normal * (a - 0.5 * overlap),
                        pair.offset_j - normal * (b - 0.5 * overlap),
                    ];
                    let (key, geometry) = ((i, j, false, spheres), [overlap, a * b / (a + b)]);
                    let wall = [Vector3::zeros(); 2];
                    contacts.push(contact(key, arms, wall, normal, geometry, law, effect));
                });
            }
            for w in 0..world.walls().len() {
                let known = |sphere| self.memory(&(i, w, true, sphere));
                find_at_wall(world, i, w, known, |sphere, at, law, effect| {
                    let key = (i, w, true, sphere);
                    let geometry = [at.geometry.overlap, at.geometry.reduced_radius];
                    let (arms, motion) = ([at.arm; 2], [at.wall_velocity, at.wall_spin]);
                    let own = contact(key, arms, motion, at.normal, geometry, law, effect);
                    contacts.push(own);
                });
            }
        }
        contacts
    }

    /// What a contact remembers of the step before, none if it is new.
    fn memory(&self, key: &Key) -> Option<Memory> {
        self.history.get(key).map(|held| held.0)
    }
}

/// A contact with its energies; geometry is overlap and reduced radius, m.
fn contact(
    key: Key,
    arms: [Vector3<f64>; 2],
    wall: [Vector3<f64>; 2],
    normal: Vector3<f64>,
    [overlap, radius]: [f64; 2],
    interaction: &Interaction,
    effect: &ContactWrench,
) -> Contact {
    let law = interaction.law();
    let pull = interaction.attraction(overlap, radius, 0.0);
    let spring = 2.0 / 3.0 * law.normal_stiffness(overlap, radius) * overlap;
    let stiffness = law.tangential_stiffness(overlap, radius);
    Contact {
        key,
        arms,
        wall,
        normal,
        force: effect.force,
        rolling: effect.torque_i - arms[0].cross(&effect.force),
        spring: [
            spring - pull,
            law.elastic_energy(overlap, radius) + interaction.energy_of_attraction(overlap, radius),
        ],
        memory: effect.memory,
        stored: 0.5 * stiffness * effect.memory.slip.norm_squared(),
    }
}

/// Energy of all bodies in gravity, about the origin, J.
fn potential(world: &World) -> f64 {
    let bodies = world.bodies();
    let gravity = world.settings().gravity;
    let height = |k: usize| -bodies.position[k].dot(&gravity);
    let mass = |k: usize| world.templates()[bodies.template[k]].mass();
    (0..bodies.len()).map(|k| mass(k) * height(k)).sum()
}
