//! Forces between bodies of one sphere each and walls, in worlds that have no other bodies.
//!
//! As with pairs of spheres, a sphere has one possible contact with a wall. Entries lie wall by wall, so
//! that the shape of the wall is the same from one to the next; a body still gets its loads in the order of
//! the walls.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Column, Loads, ROOM, by_law, read, write};
use crate::bodies::Bodies;
use crate::contact::{Memory, Mover, SphereWall};
use crate::context::Context;
use crate::interaction::Interaction;
use crate::kept_contact::KeptContact;
use crate::lanes::stored;
use crate::liquid::bridge_volume;
use crate::load::Load;
use crate::spheres::pairs::{TOUCHES, UNKNOWN, remembered};
use crate::travel::lowered;
use crate::wall::Wall;
use crate::wall_force::sphere_at_wall;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use nalgebra::Vector3;
use std::ops::Range;

/// Bodies of a range that are near walls; columns of one length, one entry a body and wall.
#[derive(Debug, Clone, Default)]
pub(crate) struct SphereWalls {
    /// The body.
    body: Vec<u32>,
    /// The wall; never falls from one entry to the next.
    wall: Vec<u32>,
    /// Place of the interaction of both in the table.
    interaction: Vec<u32>,
    /// Travel of the body above which the entry is awake, m: [`TOUCHES`] where it touches.
    wake: Vec<f32>,
    /// Tangential displacement of the contact, m; 0 where there is none.
    slip: Vec<Vector3<f64>>,
    /// Torque of the rolling spring of the contact, N m; empty in a world without rolling springs.
    rolling: Vec<Vector3<f64>>,
    /// Loads of the contacts of the last step.
    loads: Vec<WallLoad>,
}

/// Load of a contact at a wall.
#[derive(Debug, Clone, Copy)]
struct WallLoad {
    body: usize,
    wall: usize,
    /// Force on the body, N.
    force: Vector3<f64>,
    /// Torque on the body, N m.
    torque: Vector3<f64>,
}

/// Contacts at walls that wait for their forces.
#[derive(Debug, Clone)]
pub(crate) struct WallBatch {
    /// Number of contacts.
    n: usize,
    /// Interaction of all of them.
    interaction: usize,
    /// Their entries.
    entry: [usize; ROOM],
    /// What goes into the law.
    input: Box<Input>,
    /// What comes out.
    output: Box<Output>,
}

/// What goes into the law, one entry a contact; fields as of [`SphereWall`], [`Mover`] and [`Memory`].
#[derive(Debug, Clone)]
struct Input {
    normal: Column,
    arm: Column,
    wall_velocity: Column,
    wall_spin: Column,
    velocity: Column,
    spin: Column,
    slip: Column,
    rolling: Column,
    overlap: [f64; ROOM],
    radius: [f64; ROOM],
    mass: [f64; ROOM],
    bridge_volume: [f64; ROOM],
}

/// What comes out of the law, one entry a contact.
#[derive(Debug, Clone)]
struct Output {
    force: Column,
    torque: Column,
    slip: Column,
    rolling: Column,
}

impl Default for WallBatch {
    fn default() -> Self {
        const EMPTY: Column = [[0.0; ROOM]; 3];
        Self {
            n: 0,
            interaction: 0,
            entry: [0; ROOM],
            input: Box::new(Input {
                normal: EMPTY,
                arm: EMPTY,
                wall_velocity: EMPTY,
                wall_spin: EMPTY,
                velocity: EMPTY,
                spin: EMPTY,
                slip: EMPTY,
                rolling: EMPTY,
                overlap: [0.0; ROOM],
                radius: [0.0; ROOM],
                mass: [0.0; ROOM],
                bridge_volume: [0.0; ROOM],
            }),
            output: Box::new(Output {
                force: EMPTY,
                torque: EMPTY,
                slip: EMPTY,
                rolling: EMPTY,
            }),
        }
    }
}

impl SphereWalls {
    /// Lists the bodies of a range whose surface is within the margin (m) of a wall.
    pub(crate) fn rebuild(
        &mut self,
        range: Range<usize>,
        bodies: &Bodies,
        walls: &[Wall],
        margin: f64,
        context: &Context<'_>,
        old: &mut Self,
    ) {
        std::mem::swap(self, old);
        self.clear();
        let remembers_rolling = context
            .interactions
            .iter()
            .any(Interaction::remembers_rolling);
        let mut k = 0;
        for (wall, shape) in walls.iter().enumerate() {
            for body in range.clone() {
                let template = &context.templates[bodies.template[body]];
                let reach = template.bounding_radius + margin;
                if shape.distance(&bodies.position[body]) >= reach {
                    continue;
                }
                let place = (stored(wall), stored(body));
                while k < old.body.len() && (old.wall[k], old.body[k]) < place {
                    k += 1;
                }
                let same = k < old.body.len() && (old.wall[k], old.body[k]) == place;
                let known = same.then_some(k);
                self.wall.push(place.0);
                self.body.push(place.1);
                let interaction = context.interaction_index(template.material, shape.material);
                self.interaction.push(stored(interaction));
                let travel = bodies.travel[body];
                let wake = known.map_or(UNKNOWN, |k| lowered(old.wake[k], travel));
                self.wake.push(wake);
                self.slip.push(remembered(&old.slip, known));
                if remembers_rolling {
                    self.rolling.push(remembered(&old.rolling, known));
                }
            }
        }
    }

    /// Forgets all entries.
    fn clear(&mut self) {
        self.body.clear();
        self.wall.clear();
        self.interaction.clear();
        self.wake.clear();
        self.slip.clear();
        self.rolling.clear();
        self.loads.clear();
    }

    /// Finds the forces of all walls.
    pub(crate) fn find_forces(
        &mut self,
        level: Level,
        travel: &[f32],
        walls: &[Wall],
        context: &Context<'_>,
        batch: &mut WallBatch,
    ) {
        self.loads.clear();
        dispatch!(level, simd => self.find_forces_on(simd, travel, walls, context, batch));
    }

    /// [`Self::find_forces`] on one instruction set.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the way up to the touch is shortened by a safety distance"
    )]
    fn find_forces_on<S: Simd>(
        &mut self,
        simd: S,
        travel: &[f32],
        walls: &[Wall],
        context: &Context<'_>,
        batch: &mut WallBatch,
    ) {
        for k in 0..self.body.len() {
            let body = self.body[k] as usize;
            if travel[body] <= self.wake[k] {
                continue;
            }
            let interaction = self.interaction[k] as usize;
            if batch.must_be_applied(interaction) {
                batch.apply(simd, self, context);
            }
            let sphere = &context.spheres[body];
            let wall = &walls[self.wall[k] as usize];
            let law = &context.interactions[interaction];
            let volume = bridge_volume(law, context.liquid, [body]);
            let reach = if self.touches(k) {
                law.reach(volume)
            } else {
                0.0
            };
            let (mover, shape) = (sphere.mover(), sphere.shape());
            let nearest = wall.nearest(&mover.position);
            let gap = nearest.distance - shape.radius;
            if gap >= reach {
                self.wake[k] = travel[body] + (gap as f32 - context.cutoffs.safety);
                self.remember(k, &Memory::default());
                continue;
            }
            self.wake[k] = TOUCHES;
            let mut contact = sphere_at_wall(&mover, &shape, &mover.position, wall, &nearest);
            contact.bridge_volume = volume;
            batch.put(k, interaction, &contact, &mover, &self.memory(k));
        }
        batch.apply(simd, self, context);
    }

    /// Gives the forces found to the bodies.
    pub(crate) fn give_forces(&self, loads: &mut Loads<'_>) {
        for load in &self.loads {
            loads.add(load.body, &Load::new(&load.force, &load.torque));
        }
    }

    /// Adds the forces found to those on each wall (N) and to its torque about the z axis (N m).
    pub(crate) fn add_to_walls(
        &self,
        positions: &[Vector3<f64>],
        (force, torque): (&mut [Vector3<f64>], &mut [f64]),
    ) {
        for load in &self.loads {
            force[load.wall] -= load.force;
            let about_axis = positions[load.body].cross(&load.force) + load.torque;
            torque[load.wall] -= about_axis.z;
        }
    }

    /// What the contact of an entry remembers.
    #[inline(always)]
    fn memory(&self, k: usize) -> Memory {
        Memory {
            slip: self.slip[k],
            rolling: self.rolling.get(k).copied().unwrap_or_default(),
        }
    }

    /// Sets what the contact of an entry remembers.
    #[inline(always)]
    fn remember(&mut self, k: usize, memory: &Memory) {
        self.slip[k] = memory.slip;
        if let Some(rolling) = self.rolling.get_mut(k) {
            *rolling = memory.rolling;
        }
    }

    /// Whether an entry touched in the last step.
    #[inline(always)]
    fn touches(&self, k: usize) -> bool {
        self.wake[k] == TOUCHES
    }

    /// All contacts.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptContact> + '_ {
        let touching = (0..self.body.len()).filter(|&k| self.touches(k));
        touching.map(|k| KeptContact {
            body: self.body[k] as usize,
            other: self.wall[k] as usize,
            key: 0,
            memory: self.memory(k),
        })
    }

    /// Takes up the contacts of its bodies; the bodies near walls are listed. The number taken.
    pub(crate) fn recall(&mut self, contacts: &[KeptContact]) -> usize {
        let mut taken = 0;
        for contact in contacts {
            let place = (stored(contact.other), stored(contact.body));
            // Wall by wall, and body by body within each.
            let from = self.wall.partition_point(|wall| *wall < place.0);
            let to = self.wall.partition_point(|wall| *wall <= place.0);
            if let Ok(at) = self.body[from..to].binary_search(&place.1) {
                self.wake[from + at] = TOUCHES;
                self.remember(from + at, &contact.memory);
                taken += 1;
            }
        }
        taken
    }

    /// Number of touching spheres of all walls.
    pub(crate) fn n_contacts(&self) -> usize {
        (0..self.body.len()).filter(|&k| self.touches(k)).count()
    }
}

impl WallBatch {
    /// Whether a contact of this interaction has no place before the batch is worked off.
    #[inline(always)]
    fn must_be_applied(&self, interaction: usize) -> bool {
        self.n == ROOM || (self.n > 0 && self.interaction != interaction)
    }

    /// Adds the contact of an entry; the caller has asked [`Self::must_be_applied`] before.
    #[inline(always)]
    fn put(
        &mut self,
        entry: usize,
        interaction: usize,
        contact: &SphereWall,
        body: &Mover,
        memory: &Memory,
    ) {
        let (n, input) = (self.n, &mut *self.input);
        self.interaction = interaction;
        self.entry[n] = entry;
        write(&mut input.normal, n, &contact.normal);
        write(&mut input.arm, n, &contact.arm);
        write(&mut input.wall_velocity, n, &contact.wall_velocity);
        write(&mut input.wall_spin, n, &contact.wall_spin);
        write(&mut input.velocity, n, &body.velocity);
        write(&mut input.spin, n, &body.spin);
        write(&mut input.slip, n, &memory.slip);
        write(&mut input.rolling, n, &memory.rolling);
        input.overlap[n] = contact.geometry.overlap;
        input.radius[n] = contact.geometry.reduced_radius;
        input.mass[n] = contact.geometry.reduced_mass;
        input.bridge_volume[n] = contact.bridge_volume;
        self.n = n + 1;
    }

    /// Computes all contacts, keeps their loads and empties the batch.
    #[inline(always)]
    fn apply<S: Simd>(&mut self, simd: S, walls: &mut SphereWalls, context: &Context<'_>) {
        if self.n == 0 {
            return;
        }
        let (input, output, n) = (&*self.input, &mut *self.output, self.n);
        let time_step = context.time_step;
        by_law(
            simd,
            context.interactions[self.interaction],
            #[inline(always)]
            |law| compute(law, input, output, n, time_step),
        );
        let output = &*self.output;
        for k in 0..n {
            let entry = self.entry[k];
            walls.loads.push(WallLoad {
                body: walls.body[entry] as usize,
                wall: walls.wall[entry] as usize,
                force: read(&output.force, k),
                torque: read(&output.torque, k),
            });
            let memory = Memory {
                slip: read(&output.slip, k),
                rolling: read(&output.rolling, k),
            };
            walls.remember(entry, &memory);
        }
        self.n = 0;
    }
}

/// Runs the law over the first `n` contacts.
#[inline(always)]
fn compute(law: &Interaction, input: &Input, output: &mut Output, n: usize, time_step: f64) {
    for k in 0..n.min(ROOM) {
        let contact = SphereWall {
            normal: read(&input.normal, k),
            arm: read(&input.arm, k),
            wall_velocity: read(&input.wall_velocity, k),
            wall_spin: read(&input.wall_spin, k),
            geometry: contact_law::ContactGeometry {
                overlap: input.overlap[k],
                reduced_radius: input.radius[k],
                reduced_mass: input.mass[k],
            },
            bridge_volume: input.bridge_volume[k],
        };
        let body = Mover {
            // The arm says where the contact is.
            position: Vector3::zeros(),
            velocity: read(&input.velocity, k),
            spin: read(&input.spin, k),
        };
        let memory = Memory {
            slip: read(&input.slip, k),
            rolling: read(&input.rolling, k),
        };
        let effect = law.at_wall(&contact, &body, memory, time_step);
        write(&mut output.force, k, &effect.force);
        write(&mut output.torque, k, &effect.torque_i);
        write(&mut output.slip, k, &effect.memory.slip);
        write(&mut output.rolling, k, &effect.memory.rolling);
    }
}
