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
use crate::sphere_contact::SphereContact;
use crate::template::{OuterSphere, Template};
use crate::travel::lowered;
use crate::wall::{Nearest, Wall};
use contact_law::ContactGeometry;
use nalgebra::Vector3;
use std::ops::Range;

/// A body near a wall.
#[derive(Debug, Clone)]
struct Near {
    /// The body.
    body: usize,
    /// The wall.
    wall: usize,
    /// Travel of the body at which the list must be made anew, m.
    limit: f32,
    /// Travel of the body up to which none of the candidates can touch, m.
    wake: f32,
    /// Spheres within the skin of the wall.
    candidates: Vec<u16>,
    /// Spheres that touch.
    touches: Vec<SphereContact>,
    /// Force and torque on the body in this step; none if nothing touches.
    total: Option<ContactWrench>,
}

/// All bodies near walls.
#[derive(Debug, Clone, Default)]
pub(crate) struct WallNeighbours {
    /// Entries by body, then wall.
    near: Vec<Near>,
    /// Entries of the list before; empty between two calls.
    old: Vec<Near>,
    /// Entries not in use, kept for their buffers.
    spare: Vec<Near>,
}

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
        for body in range {
            let reach = templates[bodies.template[body]].bounding_radius + margin;
            for (wall, shape) in walls.iter().enumerate() {
                if shape.distance(&bodies.position[body]) >= reach {
                    continue;
                }
                while let Some(entry) = old.next_if(|n| (n.body, n.wall) < (body, wall)) {
                    spare.push(entry);
                }
                let same = old.next_if(|n| (n.body, n.wall) == (body, wall));
                let mut entry = same.unwrap_or_else(|| Near::fresh(body, wall, spare.pop()));
                entry.limit = lowered(entry.limit, bodies.travel[body]);
                entry.wake = lowered(entry.wake, bodies.travel[body]);
                self.near.push(entry);
            }
        }
        spare.extend(old);
    }

    /// Finds the forces of all walls.
    pub(crate) fn find_forces(&mut self, bodies: &Bodies, walls: &[Wall], context: &Context<'_>) {
        for near in &mut self.near {
            let template = &context.templates[bodies.template[near.body]];
            let wall = &walls[near.wall];
            let travel = bodies.travel[near.body];
            if travel > near.limit {
                near.list_candidates(bodies, template, wall, context.cutoffs);
            }
            near.total = (travel > near.wake)
                .then(|| near.add_contacts(&bodies.mover(near.body), bodies, wall, context));
        }
    }

    /// Gives the forces found to the bodies.
    pub(crate) fn give_forces(&self, loads: &mut Loads<'_>) {
        for near in &self.near {
            if let Some(total) = &near.total {
                loads.add(near.body, &Load::new(&total.force, &total.torque_i));
            }
        }
    }

    /// Adds the forces found to those on each wall (N) and to its torque about the z axis (N m).
    pub(crate) fn add_to_walls(
        &self,
        positions: &[Vector3<f64>],
        (load, torque): (&mut [Vector3<f64>], &mut [f64]),
    ) {
        for near in &self.near {
            if let Some(total) = &near.total {
                load[near.wall] -= total.force;
                let about_axis = positions[near.body].cross(&total.force) + total.torque_i;
                torque[near.wall] -= about_axis.z;
            }
        }
    }

    /// All contacts.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.near.iter().flat_map(|n| {
            n.touches.iter().map(|touch| KeptContact {
                body: n.body,
                other: n.wall,
                key: touch.key,
                memory: touch.memory,
            })
        })
    }

    /// Takes up the contacts of its bodies; the bodies near walls are listed. The number taken.
    pub(crate) fn recall(&mut self, contacts: &[KeptContact]) -> usize {
        let mut taken = 0;
        for contact in contacts {
            let place = (contact.body, contact.other);
            let at = self.near.binary_search_by_key(&place, |n| (n.body, n.wall));
            if let Ok(at) = at {
                self.near[at].touches.push(SphereContact {
                    key: contact.key,
                    memory: contact.memory,
                });
                taken += 1;
            }
        }
        taken
    }

    /// Number of touching spheres of all walls.
    pub(crate) fn n_contacts(&self) -> usize {
        self.near.iter().map(|n| n.touches.len()).sum()
    }
}

impl Near {
    /// An entry without a list, with the buffers of one not in use.
    fn fresh(body: usize, wall: usize, spare: Option<Self>) -> Self {
        let (mut candidates, mut touches) =
            spare.map_or_else(Default::default, |near| (near.candidates, near.touches));
        candidates.clear();
        touches.clear();
        Self {
            body,
            wall,
            limit: f32::NEG_INFINITY,
            wake: f32::NEG_INFINITY,
            candidates,
            touches,
            total: None,
        }
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
    ) {
        let (position, rotation) = (bodies.position[self.body], bodies.rotation[self.body]);
        self.candidates.clear();
        let mut nearest = f64::INFINITY;
        for (k, sphere) in template.spheres.iter().enumerate() {
            let centre = position + rotation * sphere.centre;
            let gap = wall.distance(&centre) - sphere.radius;
            nearest = nearest.min(gap);
            if gap < f64::from(cutoffs.skin) {
                self.candidates.push(u16::try_from(k).unwrap_or(u16::MAX));
            }
        }
        // Without candidates the body may move until its nearest sphere could touch.
        let reach = (nearest as f32).max(cutoffs.skin) - cutoffs.safety;
        self.limit = bodies.travel[self.body] + reach;
        self.wake = if self.candidates.is_empty() {
            self.limit
        } else {
            f32::NEG_INFINITY
        };
        let listed = &self.candidates;
        self.touches
            .retain(|t| listed.iter().any(|&k| u32::from(k) << 16 == t.key));
    }

    /// Forces of the spheres that touch; puts the entry to sleep if none does.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding is covered by the safety"
    )]
    fn add_contacts(
        &mut self,
        body: &Mover,
        bodies: &Bodies,
        wall: &Wall,
        context: &Context<'_>,
    ) -> ContactWrench {
        let template = &context.templates[bodies.template[self.body]];
        let interaction = context.interaction(template.material, wall.material);
        let volume = bridge_volume(interaction, context.liquid, [self.body]);
        let reach = interaction.reach(volume);
        let rotation = &bodies.rotation[self.body];
        let mut total = ContactWrench::default();
        let mut nearest_gap = f64::INFINITY;
        let placed = |k: u16| {
            let sphere = &template.spheres[usize::from(k)];
            (sphere, body.position + rotation * sphere.centre)
        };
        let at_wall = |sphere: &OuterSphere, centre: &Vector3<f64>| {
            sphere_at_wall(body, sphere, centre, wall, &wall.nearest(centre))
        };
        let radii = self.candidates.iter().map(|&k| {
            let (sphere, centre) = placed(k);
            at_wall(sphere, &centre).contact_radius()
        });
        let shares = Shares::new([template.shares_mass, false], radii);
        for &k in &self.candidates {
            let key = u32::from(k) << 16;
            // Most candidates do not touch: how far they are away is enough.
            let (sphere, centre) = placed(k);
            let overlap = sphere.radius - wall.distance(&centre);
            nearest_gap = nearest_gap.min(-overlap);
            let known = self.touches.iter().position(|t| t.key == key);
            let ends = if known.is_some() { -reach } else { 0.0 };
            if overlap <= ends {
                if let Some(at) = known {
                    self.touches.swap_remove(at);
                }
                continue;
            }
            let mut contact = at_wall(sphere, &centre);
            contact.bridge_volume = volume;
            contact.share_mass(shares.as_ref());
            let at = known.unwrap_or_else(|| {
                self.touches.push(SphereContact {
                    key,
                    memory: Memory::default(),
                });
                self.touches.len() - 1
            });
            let memory = self.touches[at].memory;
            let effect = interaction.at_wall(&contact, body, memory, context.time_step);
            self.touches[at].memory = effect.memory;
            total.force += effect.force;
            total.torque_i += effect.torque_i;
        }
        let free = (nearest_gap - reach) as f32 - context.cutoffs.safety;
        self.wake = if free > 0.0 {
            bodies.travel[self.body] + free
        } else {
            f32::NEG_INFINITY
        };
        total
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
