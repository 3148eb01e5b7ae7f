//! Forces between bodies of one sphere each and walls, in worlds that have no other bodies.
//!
//! As with pairs of spheres, a sphere has one possible contact with a wall. Entries lie wall by wall, so
//! that the shape of the wall is the same from one to the next; a body still gets its loads in the order of
//! the walls.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::Loads;
use crate::bodies::Bodies;
use crate::contact::{ContactWrench, Memory};
use crate::context::Context;
use crate::interaction::Interaction;
use crate::kept_contact::KeptContact;
use crate::lanes::stored;
use crate::liquid::bridge_volume;
use crate::load::Load;
use crate::spheres::pairs::remembered;
use crate::travel::{TOUCHES, UNKNOWN, lowered};
use crate::wall::Wall;
use crate::wall_batch::WallBatch;
use crate::wall_force::sphere_at_wall;
use crate::window::Window;
use fearless_simd::Level;
use nalgebra::Vector3;
use std::ops::Range;

/// Bodies of a range that are near walls; columns of one length, one entry a body and wall.
#[derive(Debug, Clone, Default)]
pub(crate) struct SphereWalls {
    body: Vec<u32>,
    /// The wall; never falls from one entry to the next.
    wall: Vec<u32>,
    /// Place of the interaction of both in the table.
    interaction: Vec<u32>,
    /// Travel of the body above which the entry is awake, m: [`TOUCHES`] where it touches.
    wake: Vec<f32>,
    /// Tangential displacement of the contact, m; 0 if there is none.
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
                let position = context.period.inside(&bodies.position[body]);
                if shape.distance(&position) >= reach {
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
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the way up to the touch is shortened by a safety distance"
    )]
    pub(crate) fn find_forces(
        &mut self,
        level: Level,
        travel: Window<'_, f32>,
        walls: &[Wall],
        context: &Context<'_>,
        batch: &mut WallBatch<usize>,
    ) {
        self.loads.clear();
        for k in 0..self.body.len() {
            let body = self.body[k] as usize;
            if travel[body] <= self.wake[k] {
                continue;
            }
            let interaction = self.interaction[k] as usize;
            if !batch.has_room(interaction) {
                batch.apply(level, context, |entry, wrench| self.take(entry, wrench));
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
            let mover = context.period.at_walls(sphere.mover());
            let shape = sphere.shape();
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
        batch.apply(level, context, |entry, wrench| self.take(entry, wrench));
    }

    /// Takes what the law says of the contact of an entry.
    #[inline(always)]
    fn take(&mut self, entry: usize, wrench: &ContactWrench) {
        self.loads.push(WallLoad {
            body: self.body[entry] as usize,
            wall: self.wall[entry] as usize,
            force: wrench.force,
            torque: wrench.torque_i,
        });
        self.remember(entry, &wrench.memory);
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
        positions: Window<'_, Vector3<f64>>,
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
