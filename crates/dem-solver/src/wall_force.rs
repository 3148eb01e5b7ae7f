//! Forces between bodies and walls.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::Loads;
use crate::bodies::Bodies;
use crate::contact::{Memory, Mover, SphereWall};
use crate::context::Context;
use crate::kept_contact::KeptContact;
use crate::lanes::stored;
use crate::liquid::bridge_volume;
use crate::load::Load;
use crate::shared_mass::{Shares, Turned};
use crate::sphere_contact::SphereContact;
use crate::template::{OuterSphere, Template};
use crate::travel::{TOUCHES, UNKNOWN, lowered};
use crate::wall::{Nearest, Wall};
use crate::wall_batch::WallBatch;
use crate::window::Window;
use crate::workspace::Workspace;
use contact_law::ContactGeometry;
use fearless_simd::Level;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

/// A body near a wall.
#[derive(Debug, Clone, Default)]
struct Near {
    body: usize,
    wall: usize,
    /// Travel of the body at which the list must be rebuilt, m.
    limit: f32,
    /// Travel of the body up to which none of the candidates is awake, m: [`TOUCHES`] where one of them touches.
    wake: f32,
    /// Numbers of the spheres that may touch before the body has moved by the skin, in order.
    candidates: Vec<u16>,
    /// Travel of the body above which each of them is awake, m: [`TOUCHES`] where it touches, else where it could.
    wakes: Vec<f32>,
    /// What the contact of each of them remembers; 0 where it does not touch.
    memories: Vec<Memory>,
    /// Force (N) and torque (N m) on the body in this step.
    force: Vector3<f64>,
    torque: Vector3<f64>,
}

/// All bodies near walls. Entries lie wall by wall, so that many contacts of one interaction follow each other; a body still
/// gets its loads in the order of the walls.
#[derive(Debug, Clone, Default)]
pub(crate) struct WallNeighbours {
    /// Entries by wall, then body.
    near: Vec<Near>,
    /// Entries of the list before; empty between two calls.
    old: Vec<Near>,
    /// Entries not in use, kept for their buffers.
    spare: Vec<Near>,
}

/// Candidates that are looked at together.
const GROUP: usize = 8;

/// Where a contact belongs: its entry and its candidate.
pub(crate) type Place = [usize; 2];

impl WallNeighbours {
    /// Lists the bodies of a range whose bounding sphere is within the margin (m) of a wall.
    pub(crate) fn rebuild(
        &mut self,
        range: Range<usize>,
        bodies: &Bodies,
        walls: &[Wall],
        margin: f64,
        context: &Context<'_>,
    ) {
        std::mem::swap(&mut self.near, &mut self.old);
        let spare = &mut self.spare;
        let mut old = self.old.drain(..).peekable();
        for (wall, shape) in walls.iter().enumerate() {
            for body in range.clone() {
                let template = &context.templates[bodies.template[body]];
                let reach = template.bounding_radius + margin;
                let position = context.period.inside(&bodies.position[body]);
                if shape.distance(&position) >= reach {
                    continue;
                }
                while let Some(entry) = old.next_if(|n| n.place() < (wall, body)) {
                    spare.push(entry);
                }
                let same = old.next_if(|n| n.place() == (wall, body));
                let mut entry = same.unwrap_or_else(|| Near::fresh(body, wall, spare.pop()));
                entry.lower(bodies.travel[body]);
                self.near.push(entry);
            }
        }
        spare.extend(old);
    }

    /// Finds the forces of all walls.
    // One pass over the entries, whose steps share the entry; it is a few lines longer than a screen.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the way up to the touch is shortened by a safety distance"
    )]
    pub(crate) fn find_forces(
        &mut self,
        level: Level,
        bodies: &Bodies,
        walls: &[Wall],
        context: &Context<'_>,
        workspace: &mut Workspace,
    ) {
        let Workspace {
            at_walls: batch,
            awake,
            touches,
            ..
        } = workspace;
        for at in 0..self.near.len() {
            let near = &mut self.near[at];
            let travel = bodies.travel[near.body];
            let template = &context.templates[bodies.template[near.body]];
            let wall = &walls[near.wall];
            if travel > near.limit {
                near.list_candidates(bodies, wall, context, touches);
            }
            if travel <= near.wake {
                continue;
            }
            let interaction = context.interaction_index(template.material, wall.material);
            let law = &context.interactions[interaction];
            let volume = bridge_volume(law, context.liquid, [near.body]);
            let body = Posed {
                mover: context.period.at_walls(bodies.mover(near.body)),
                rotation: &bodies.rotation[near.body],
                template,
            };
            // Most candidates at a wall touch for many steps or are far: those asleep cost one comparison.
            near.wake = near.find_awake(travel, awake);
            let shares = near.shares(&body, wall, awake);
            (near.force, near.torque) = Default::default();
            for k in awake.iter().map(|&k| k as usize) {
                let near = &mut self.near[at];
                let mut contact = body.at_wall(near.candidates[k], wall);
                let gap = -contact.geometry.overlap;
                // A bridge that exists holds up to its rupture; a new one forms at contact only.
                let reach = if near.wakes[k] == TOUCHES {
                    law.reach(volume)
                } else {
                    0.0
                };
                if gap >= reach {
                    near.wakes[k] = travel + (gap as f32 - context.cutoffs.safety);
                    near.wake = near.wake.min(near.wakes[k]);
                    near.memories[k] = Memory::default();
                    continue;
                }
                (near.wakes[k], near.wake) = (TOUCHES, TOUCHES);
                let memory = near.memories[k];
                contact.bridge_volume = volume;
                contact.share_mass(shares.as_ref());
                // A full batch is worked off before another contact is put in, so that the order of sums stays.
                if !batch.has_room(interaction) {
                    apply(&mut self.near, level, context, batch);
                }
                batch.put([at, k], interaction, &contact, &body.mover, &memory);
            }
        }
        apply(&mut self.near, level, context, batch);
    }

    /// The entries at which something touches.
    fn touching(&self) -> impl Iterator<Item = &Near> {
        self.near.iter().filter(|near| near.wake == TOUCHES)
    }

    /// Gives the forces found to the bodies.
    pub(crate) fn give_forces(&self, loads: &mut Loads<'_>) {
        for near in self.touching() {
            loads.add(near.body, &Load::new(&near.force, &near.torque));
        }
    }

    /// Adds the forces found to those on each wall (N) and to its torque about the z axis (N m).
    pub(crate) fn add_to_walls(
        &self,
        positions: Window<'_, Vector3<f64>>,
        (load, torque): (&mut [Vector3<f64>], &mut [f64]),
    ) {
        for near in self.touching() {
            load[near.wall] -= near.force;
            let about_axis = positions[near.body].cross(&near.force) + near.torque;
            torque[near.wall] -= about_axis.z;
        }
    }

    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.near.iter().flat_map(|near| {
            near.touches().map(|touch| KeptContact {
                body: near.body,
                other: near.wall,
                key: touch.key,
                memory: touch.memory,
            })
        })
    }

    /// Takes up the contacts of its bodies; the bodies near walls are listed. The number taken.
    pub(crate) fn recall(&mut self, contacts: &[KeptContact]) -> usize {
        let mut taken = 0;
        for contact in contacts {
            let place = (contact.other, contact.body);
            if let Ok(at) = self.near.binary_search_by_key(&place, Near::place) {
                let sphere = u16::try_from(contact.key >> 16).unwrap_or(u16::MAX);
                self.near[at].list(sphere, TOUCHES, contact.memory);
                taken += 1;
            }
        }
        taken
    }

    /// Number of touching spheres of all walls.
    pub(crate) fn n_contacts(&self) -> usize {
        self.near.iter().map(|near| near.touches().count()).sum()
    }
}

impl Near {
    /// An entry without a list, with the buffers of one not in use.
    fn fresh(body: usize, wall: usize, spare: Option<Self>) -> Self {
        let mut near = spare.unwrap_or_default();
        near.clear();
        Self {
            body,
            wall,
            limit: UNKNOWN,
            wake: UNKNOWN,
            ..near
        }
    }

    /// Where it stands among the others.
    fn place(&self) -> (usize, usize) {
        (self.wall, self.body)
    }

    /// Lowers what is known by a travel (m) that is used up.
    fn lower(&mut self, travel: f32) {
        self.limit = lowered(self.limit, travel);
        self.wake = lowered(self.wake, travel);
        for wake in &mut self.wakes {
            *wake = lowered(*wake, travel);
        }
    }

    /// Forgets the list.
    fn clear(&mut self) {
        self.candidates.clear();
        self.wakes.clear();
        self.memories.clear();
    }

    /// Adds a candidate to the list.
    fn list(&mut self, sphere: u16, wake: f32, memory: Memory) {
        self.candidates.push(sphere);
        self.wakes.push(wake);
        self.memories.push(memory);
    }

    /// The contacts of the last step.
    fn touches(&self) -> impl Iterator<Item = SphereContact> {
        let touching = (0..self.wakes.len()).filter(|&k| self.wakes[k] == TOUCHES);
        touching.map(|k| SphereContact {
            key: key(self.candidates[k]),
            memory: self.memories[k],
        })
    }

    /// Lists the spheres that may touch before the body has moved by the skin.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding is covered by the safety"
    )]
    fn list_candidates(
        &mut self,
        bodies: &Bodies,
        wall: &Wall,
        context: &Context<'_>,
        before: &mut Vec<SphereContact>,
    ) {
        let cutoffs = context.cutoffs;
        let template = &context.templates[bodies.template[self.body]];
        let position = context.period.inside(&bodies.position[self.body]);
        let rotation = bodies.rotation[self.body];
        let travel = bodies.travel[self.body];
        before.clear();
        before.extend(self.touches());
        self.clear();
        let mut nearest = f64::INFINITY;
        for (sphere, shape) in (0_u16..).zip(&template.spheres) {
            let centre = position + rotation * shape.centre;
            let gap = wall.distance(&centre) - shape.radius;
            nearest = nearest.min(gap);
            if gap < f64::from(cutoffs.skin) {
                let known = before.iter().find(|touch| touch.key == key(sphere));
                let gap = gap as f32 - cutoffs.safety;
                let wake = known.map_or(travel + gap, |_| TOUCHES);
                let memory = known.map_or_else(Memory::default, |touch| touch.memory);
                self.list(sphere, wake, memory);
            }
        }
        // Without candidates the body may move until its nearest sphere could touch.
        let reach = (nearest as f32).max(cutoffs.skin) - cutoffs.safety;
        self.limit = travel + reach;
        self.wake = self.wakes.iter().copied().fold(self.limit, f32::min);
    }

    /// Lists the candidates that are awake at a travel (m), and returns the travel at which the next of the others wakes.
    #[inline(always)]
    fn find_awake(&self, travel: f32, awake: &mut Vec<u32>) -> f32 {
        awake.clear();
        let mut next = [self.limit; GROUP];
        let (groups, rest) = self.wakes.as_chunks::<GROUP>();
        for (g, group) in groups.iter().enumerate() {
            let mut any = false;
            for (next, wake) in next.iter_mut().zip(group) {
                let is_awake = travel > *wake;
                any |= is_awake;
                let wake = if is_awake { f32::INFINITY } else { *wake };
                *next = if wake < *next { wake } else { *next };
            }
            if any {
                let lanes = (0..GROUP).filter(|&l| travel > group[l]);
                awake.extend(lanes.map(|l| stored(g * GROUP + l)));
            }
        }
        for (k, wake) in (groups.len() * GROUP..).zip(rest) {
            if travel > *wake {
                awake.push(stored(k));
            } else {
                next[0] = next[0].min(*wake);
            }
        }
        next.into_iter().fold(f32::INFINITY, f32::min)
    }

    /// How the body shares its mass among its contacts, which are among those that are awake; none if it does not.
    #[inline(always)]
    fn shares<'a>(&self, body: &Posed<'a>, wall: &Wall, awake: &[u32]) -> Option<Shares<'a, 1>> {
        let near = awake.iter().map(|&k| self.candidates[k as usize]);
        let turned = Turned {
            template: body.template,
            rotation: body.rotation,
        };
        Shares::new([turned], near.map(|k| body.at_wall(k, wall).touch()))
    }
}

/// A body with the places of its spheres.
struct Posed<'a> {
    /// How it moves.
    mover: Mover,
    /// How it is turned.
    rotation: &'a Matrix3<f64>,
    /// Its spheres.
    template: &'a Template,
}

impl Posed<'_> {
    /// Geometry of a sphere of a number at a wall, as in [`sphere_at_wall`].
    #[inline(always)]
    fn at_wall(&self, sphere: u16, wall: &Wall) -> SphereWall {
        let sphere = &self.template.spheres[usize::from(sphere)];
        let centre = self.mover.position + self.rotation * sphere.centre;
        sphere_at_wall(&self.mover, sphere, &centre, wall, &wall.nearest(&centre))
    }
}

/// Runs the law over the contacts of a batch and gives their entries what it says.
fn apply(near: &mut [Near], level: Level, context: &Context<'_>, batch: &mut WallBatch<Place>) {
    batch.apply(level, context, |[at, k], wrench| {
        let near = &mut near[at];
        near.force += wrench.force;
        near.torque += wrench.torque_i;
        near.memories[k] = wrench.memory;
    });
}

/// The key of the contact of a sphere.
fn key(sphere: u16) -> u32 {
    u32::from(sphere) << 16
}

/// Geometry of a sphere of a body at a wall, without liquid; the overlap is negative where they do not touch.
#[inline(always)]
pub(crate) fn sphere_at_wall(
    body: &Mover,
    sphere: &OuterSphere,
    centre: &Vector3<f64>,
    wall: &Wall,
    nearest: &Nearest,
) -> SphereWall {
    let overlap = sphere.radius - nearest.distance;
    let point = centre + nearest.towards * (sphere.radius - 0.5 * overlap);
    SphereWall {
        normal: nearest.towards,
        arm: point - body.position,
        wall_velocity: wall.velocity_at(&point),
        wall_spin: Vector3::z() * wall.spin,
        geometry: ContactGeometry {
            overlap,
            reduced_radius: sphere.radius,
            reduced_mass: sphere.dashpot_mass,
        },
        bridge_volume: 0.0,
    }
}
