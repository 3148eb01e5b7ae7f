//! Forces between bodies and walls.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::Loads;
use crate::bodies::Bodies;
use crate::contact::{ContactWrench, Memory, Mover, SphereWall};
use crate::context::{Context, Cutoffs};
use crate::kept_contact::KeptContact;
use crate::liquid::bridge_volume;
use crate::load::Load;
use crate::shared_mass::Shares;
use crate::template::{OuterSphere, Template};
use crate::travel::{TOUCHES, lowered};
use crate::wall::{Nearest, Wall};
use crate::wall_batch::WallBatch;
use contact_law::ContactGeometry;
use fearless_simd::Level;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

/// A sphere that may touch the wall before its body has moved by the skin.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    /// What its contact remembers; 0 where it does not touch.
    memory: Memory,
    /// Travel of the body above which it is awake, m: [`TOUCHES`] where it touches, else where it could.
    wake: f32,
    /// Its number.
    sphere: u16,
}

/// A body near a wall.
#[derive(Debug, Clone)]
struct Near {
    /// The body.
    body: usize,
    /// The wall.
    wall: usize,
    /// Travel of the body at which the list must be made anew, m.
    limit: f32,
    /// Travel of the body up to which none of the candidates is awake, m: [`TOUCHES`] where one of them touches.
    wake: f32,
    /// Spheres within the skin of the wall, by number.
    candidates: Vec<Candidate>,
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
    /// Candidates of the list before of one entry.
    before: Vec<Candidate>,
}

/// Where a contact belongs: its entry and its candidate.
pub(crate) type Place = [usize; 2];

impl WallNeighbours {
    /// Lists the bodies of a range whose bounding sphere is within the margin (m) of a wall.
    pub(crate) fn rebuild(
        &mut self,
        range: Range<usize>,
        bodies: &Bodies,
        templates: &[Template],
        walls: &[Wall],
        margin: f64,
    ) {
        std::mem::swap(&mut self.near, &mut self.old);
        let spare = &mut self.spare;
        let mut old = self.old.drain(..).peekable();
        for (wall, shape) in walls.iter().enumerate() {
            for body in range.clone() {
                let reach = templates[bodies.template[body]].bounding_radius + margin;
                if shape.distance(&bodies.position[body]) >= reach {
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
        batch: &mut WallBatch<Place>,
    ) {
        for at in 0..self.near.len() {
            let near = &mut self.near[at];
            let travel = bodies.travel[near.body];
            let template = &context.templates[bodies.template[near.body]];
            let wall = &walls[near.wall];
            if travel > near.limit {
                near.list_candidates(bodies, template, wall, context.cutoffs, &mut self.before);
            }
            if travel <= near.wake {
                continue;
            }
            let interaction = context.interaction_index(template.material, wall.material);
            let law = &context.interactions[interaction];
            let volume = bridge_volume(law, context.liquid, [near.body]);
            let body = Posed {
                mover: bodies.mover(near.body),
                rotation: &bodies.rotation[near.body],
                template,
            };
            let shares = near.shares(&body, wall, travel);
            (near.force, near.torque) = Default::default();
            near.wake = near.limit;
            for k in 0..self.near[at].candidates.len() {
                let candidate = &mut self.near[at].candidates[k];
                if travel > candidate.wake {
                    let mut contact = body.at_wall(candidate.sphere, wall);
                    let gap = -contact.geometry.overlap;
                    let reach = if candidate.touches() {
                        law.reach(volume)
                    } else {
                        0.0
                    };
                    if gap >= reach {
                        candidate.wake = travel + (gap as f32 - context.cutoffs.safety);
                        candidate.memory = Memory::default();
                    } else {
                        candidate.wake = TOUCHES;
                        let memory = candidate.memory;
                        contact.bridge_volume = volume;
                        contact.share_mass(shares.as_ref());
                        if !batch.has_room(interaction) {
                            batch.apply(level, context, |place, wrench| self.take(place, wrench));
                        }
                        batch.put([at, k], interaction, &contact, &body.mover, &memory);
                    }
                }
                let near = &mut self.near[at];
                near.wake = near.wake.min(near.candidates[k].wake);
            }
        }
        batch.apply(level, context, |place, wrench| self.take(place, wrench));
    }

    /// Takes what the law says of a contact.
    #[inline(always)]
    fn take(&mut self, [at, k]: Place, wrench: &ContactWrench) {
        let near = &mut self.near[at];
        near.force += wrench.force;
        near.torque += wrench.torque_i;
        near.candidates[k].memory = wrench.memory;
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
        positions: &[Vector3<f64>],
        (load, torque): (&mut [Vector3<f64>], &mut [f64]),
    ) {
        for near in self.touching() {
            load[near.wall] -= near.force;
            let about_axis = positions[near.body].cross(&near.force) + near.torque;
            torque[near.wall] -= about_axis.z;
        }
    }

    /// All contacts.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.near.iter().flat_map(|near| {
            near.touches().map(|candidate| KeptContact {
                body: near.body,
                other: near.wall,
                key: u32::from(candidate.sphere) << 16,
                memory: candidate.memory,
            })
        })
    }

    /// Takes up the contacts of its bodies; the bodies near walls are listed. The number taken.
    pub(crate) fn recall(&mut self, contacts: &[KeptContact]) -> usize {
        let mut taken = 0;
        for contact in contacts {
            let place = (contact.other, contact.body);
            if let Ok(at) = self.near.binary_search_by_key(&place, Near::place) {
                self.near[at].candidates.push(Candidate {
                    memory: contact.memory,
                    wake: TOUCHES,
                    sphere: u16::try_from(contact.key >> 16).unwrap_or(u16::MAX),
                });
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

impl Candidate {
    /// Whether it touched in the last step.
    #[inline(always)]
    fn touches(&self) -> bool {
        self.wake == TOUCHES
    }
}

impl Near {
    /// An entry without a list, with the buffer of one not in use.
    fn fresh(body: usize, wall: usize, spare: Option<Self>) -> Self {
        let mut candidates = spare.map_or_else(Vec::new, |near| near.candidates);
        candidates.clear();
        Self {
            body,
            wall,
            limit: f32::NEG_INFINITY,
            wake: TOUCHES,
            candidates,
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
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
        for candidate in &mut self.candidates {
            candidate.wake = lowered(candidate.wake, travel);
        }
    }

    /// The candidates that touched in the last step.
    fn touches(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(|c| c.touches())
    }

    /// Lists the spheres that may touch before the body has moved by the skin.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding is covered by the safety"
    )]
    fn list_candidates(
        &mut self,
        bodies: &Bodies,
        template: &Template,
        wall: &Wall,
        cutoffs: Cutoffs,
        before: &mut Vec<Candidate>,
    ) {
        let (position, rotation) = (bodies.position[self.body], bodies.rotation[self.body]);
        let travel = bodies.travel[self.body];
        before.clear();
        before.append(&mut self.candidates);
        let mut nearest = f64::INFINITY;
        for (sphere, shape) in (0_u16..).zip(&template.spheres) {
            let centre = position + rotation * shape.centre;
            let gap = wall.distance(&centre) - shape.radius;
            nearest = nearest.min(gap);
            if gap < f64::from(cutoffs.skin) {
                let known = before.iter().find(|c| c.sphere == sphere && c.touches());
                self.candidates.push(known.copied().unwrap_or(Candidate {
                    memory: Memory::default(),
                    wake: travel + (gap as f32 - cutoffs.safety),
                    sphere,
                }));
            }
        }
        // Without candidates the body may move until its nearest sphere could touch.
        let reach = (nearest as f32).max(cutoffs.skin) - cutoffs.safety;
        self.limit = travel + reach;
        let wakes = self.candidates.iter().map(|c| c.wake);
        self.wake = wakes.fold(self.limit, f32::min);
    }

    /// How the body shares its mass among its contacts; none where it does not.
    #[inline(always)]
    fn shares(&self, body: &Posed<'_>, wall: &Wall, travel: f32) -> Option<Shares> {
        let awake = self.candidates.iter().filter(|c| travel > c.wake);
        let radii = awake.map(|c| body.at_wall(c.sphere, wall).contact_radius());
        Shares::new([body.template.shares_mass, false], radii)
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
