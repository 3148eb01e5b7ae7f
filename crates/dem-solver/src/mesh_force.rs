//! Forces between bodies and walls of triangles.
//!
//! A sphere that touches several triangles feels the nearest one, and of the others those whose
//! nearest point does not lie on a triangle that it feels already. So a flat face of many triangles
//! acts as one plane, a convex edge as one edge, and a concave corner as two walls. The tangential
//! displacement belongs to the sphere and the direction of its contact, and thus survives the way
//! from one triangle to the next.

use crate::bodies::Bodies;
use crate::contact::{ContactWrench, Memory, Mover, SphereWall};
use crate::context::Context;
use crate::error::Error;
use crate::liquid::bridge_volume;
use crate::load::Load;
use crate::mesh_wall::{MeshWall, Motion, Moving};
use crate::periodic::Period;
use crate::shared_mass::{Shares, Turned};
use crate::template::{OuterSphere, Template};
use contact_law::ContactGeometry;
use geometry::triangle::nearest_on_triangle;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Two nearest points closer than this share of the reach of a sphere are one.
const SAME_POINT: f64 = 1e-6;

/// Cosine of the angle by which a contact may turn in one step and still be the same.
const SAME_CONTACT: f64 = 0.9;

/// A contact of a body and a wall, as a snapshot keeps it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeshContact {
    pub(crate) body: usize,
    wall: usize,
    touch: TriangleContact,
}

/// A sphere that touches a wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct TriangleContact {
    sphere: u16,
    /// Unit vector from the sphere towards the wall.
    normal: Vector3<f64>,
    /// What the contact remembers.
    memory: Memory,
}

/// A body near a wall.
#[derive(Debug, Clone)]
struct Near {
    body: usize,
    wall: usize,
    /// Sum of the ways of body and wall when the candidates were listed, m.
    listed: f64,
    /// The same at which they must be listed again, m.
    limit: f64,
    /// Triangles within the margin of the body.
    triangles: Vec<u32>,
    /// Spheres and triangles within the skin, by sphere.
    candidates: Vec<Candidate>,
    /// Spheres that touch.
    touches: Vec<TriangleContact>,
}

/// A sphere and a triangle that may touch.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    place: (u16, u32),
    /// Gap when it was listed, m.
    gap: f64,
}

/// A triangle that a sphere touches, in the frame of the triangles.
#[derive(Debug, Clone, Copy)]
struct Hit {
    /// Distance of the sphere's centre, m.
    distance: f64,
    /// Nearest point, m.
    point: Vector3<f64>,
    triangle: usize,
}

/// All walls of triangles, and the bodies near them.
#[derive(Debug, Clone, Default)]
pub(crate) struct MeshWalls {
    /// The walls.
    pub(crate) moving: Vec<Moving>,
    /// Bodies near walls, by body, then wall.
    near: Vec<Near>,
}

impl MeshWalls {
    /// Adds a wall at a time (s).
    pub(crate) fn add(&mut self, wall: MeshWall, time: f64) -> Result<(), Error> {
        self.moving.push(Moving::new(wall, time)?);
        Ok(())
    }

    /// Changes velocity, spin and vibration of all walls of a name at a time (s); the centre of rotation stays.
    pub(crate) fn set_motion(
        &mut self,
        name: &str,
        motion: &Motion,
        time: f64,
    ) -> Result<(), Error> {
        if !motion.is_valid() {
            let what = format!("motion of wall '{name}'");
            return Err(Error::NotFinite { what });
        }
        let mut known = false;
        for moving in self.moving.iter_mut().filter(|m| m.wall.name == name) {
            moving.set_motion(motion, time);
            known = true;
        }
        if known {
            Ok(())
        } else {
            Err(Error::NoWall { name: name.into() })
        }
    }

    /// Takes all walls of a name away, with their contacts.
    pub(crate) fn remove(&mut self, name: &str) -> Result<(), Error> {
        let named: Vec<bool> = self.moving.iter().map(|m| m.wall.name == name).collect();
        if !named.contains(&true) {
            return Err(Error::NoWall { name: name.into() });
        }
        self.near.retain(|near| !named[near.wall]);
        for (moving, _) in self
            .moving
            .iter_mut()
            .zip(&named)
            .filter(|(_, named)| **named)
        {
            moving.set_motion(&Motion::default(), 0.0);
            moving.remove();
        }
        Ok(())
    }

    /// Longest way of a wall since the last search, m.
    pub(crate) fn longest(&self) -> f64 {
        self.moving.iter().map(|m| m.travel).fold(0.0, f64::max)
    }

    /// Lists the bodies whose bounding sphere is within the margin (m) of a triangle, and its triangles there.
    pub(crate) fn rebuild(
        &mut self,
        bodies: &Bodies,
        templates: &[Template],
        margin: f64,
        period: Period,
    ) {
        let mut old = std::mem::take(&mut self.near).into_iter().peekable();
        for body in 0..bodies.len() {
            let reach = templates[bodies.template[body]].bounding_radius + margin;
            let inside = period.inside(&bodies.position[body]);
            for (wall, moving) in self.moving.iter().enumerate() {
                let images = period.images(inside, margin);
                let near = images.flat_map(|image| moving.near(&moving.own_point(&image), reach));
                let mut triangles: Vec<u32> = near.collect();
                triangles.sort_unstable();
                triangles.dedup();
                if triangles.is_empty() {
                    continue;
                }
                while old.next_if(|n| (n.body, n.wall) < (body, wall)).is_some() {}
                let same = old.next_if(|n| (n.body, n.wall) == (body, wall));
                self.near.push(Near {
                    body,
                    wall,
                    listed: 0.0,
                    limit: f64::NEG_INFINITY,
                    triangles,
                    candidates: Vec::new(),
                    touches: same.map_or_else(Vec::new, |n| n.touches),
                });
            }
        }
        for moving in &mut self.moving {
            moving.travel = 0.0;
        }
    }

    /// Forgets which bodies are near, and their contacts.
    pub(crate) fn forget(&mut self) {
        self.near.clear();
    }

    /// Adds the forces of all walls.
    pub(crate) fn add_forces(&mut self, bodies: &mut Bodies, context: &Context<'_>) {
        for moving in &mut self.moving {
            (moving.force, moving.torque) = (Vector3::zeros(), Vector3::zeros());
        }
        let mut within_reach = Vec::new();
        for near in &mut self.near {
            let moving = &mut self.moving[near.wall];
            let template = &context.templates[bodies.template[near.body]];
            let way = f64::from(bodies.travel[near.body]) + moving.travel;
            if way > near.limit {
                near.list_candidates(bodies, template, moving, context);
            }
            near.find_within_reach(way, context, &mut within_reach);
            if within_reach.is_empty() && near.touches.is_empty() {
                continue;
            }
            let body = context.period.at_walls(bodies.mover(near.body));
            let total = find_contacts(
                &within_reach,
                &mut near.touches,
                (&body, template),
                (near.body, &bodies.rotation[near.body]),
                moving,
                context,
            );
            bodies.load[near.body] += Load::new(&total.force, &total.torque_i);
            moving.force -= total.force;
            let arm = body.position - moving.pivot();
            moving.torque -= arm.cross(&total.force) + total.torque_i;
        }
    }

    /// Moves all walls by a step (s) that ends at a time (s).
    pub(crate) fn advance(&mut self, time_step: f64, time: f64) {
        for moving in &mut self.moving {
            moving.advance(time_step, time);
        }
    }

    pub(crate) fn kept(&self) -> Vec<MeshContact> {
        let near = self.near.iter();
        near.flat_map(|n| {
            n.touches.iter().map(|&touch| MeshContact {
                body: n.body,
                wall: n.wall,
                touch,
            })
        })
        .collect()
    }

    /// Body and material of the wall of each contact.
    pub(crate) fn bodies_at_materials(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.near.iter().flat_map(|n| {
            let place = (n.body, self.moving[n.wall].wall.material);
            n.touches.iter().map(move |_| place)
        })
    }

    /// Takes up contacts; the bodies near walls are listed. False if one of them is not.
    pub(crate) fn recall(&mut self, contacts: &[MeshContact]) -> bool {
        contacts.iter().all(|contact| {
            let place = (contact.body, contact.wall);
            let at = self.near.binary_search_by_key(&place, |n| (n.body, n.wall));
            at.map(|at| self.near[at].touches.push(contact.touch))
                .is_ok()
        })
    }

    /// Number of touching spheres at all walls.
    pub(crate) fn n_contacts(&self) -> usize {
        self.near.iter().map(|n| n.touches.len()).sum()
    }
}

impl Near {
    /// Lists the spheres and triangles that may touch before body and wall have moved by the skin.
    fn list_candidates(
        &mut self,
        bodies: &Bodies,
        template: &Template,
        moving: &Moving,
        context: &Context<'_>,
    ) {
        let skin = f64::from(context.cutoffs.skin);
        let inside = context.period.inside(&bodies.position[self.body]);
        let rotation = bodies.rotation[self.body];
        self.candidates.clear();
        let mut nearest = f64::INFINITY;
        for (k, sphere) in (0_u16..).zip(&template.spheres) {
            // The body may pass a side before the next search. A triangle near two images is listed twice, and felt once.
            for image in context.period.images(inside, f64::INFINITY) {
                let own = moving.own_point(&(image + rotation * sphere.centre));
                for &triangle in &self.triangles {
                    let corners = &moving.wall.triangles[triangle as usize];
                    let gap = (nearest_on_triangle(&own, corners) - own).norm() - sphere.radius;
                    nearest = nearest.min(gap);
                    if gap < skin {
                        let place = (k, triangle);
                        self.candidates.push(Candidate { place, gap });
                    }
                }
            }
        }
        // A bridge may pass from a triangle to one that is not listed: that must stay beyond its reach.
        let beyond = f64::from(context.cutoffs.safety + context.cutoffs.reach);
        let reach = nearest.max(skin) - beyond;
        self.listed = f64::from(bodies.travel[self.body]) + moving.travel;
        self.limit = self.listed + reach;
    }

    /// Candidates whose gap may have closed by now, at a sum of the ways of body and wall (m).
    fn find_within_reach(&self, way: f64, context: &Context<'_>, found: &mut Vec<(u16, u32)>) {
        let approach =
            way - self.listed + f64::from(context.cutoffs.safety + context.cutoffs.reach);
        found.clear();
        let may_touch = self.candidates.iter().filter(|c| c.gap <= approach);
        found.extend(may_touch.map(|candidate| candidate.place));
    }
}

/// Forces on a body, of a number, of those of the candidates (sphere and triangle, by sphere) that touch; `touches` holds what
/// touched in the step before, and what does now afterwards.
pub(crate) fn find_contacts(
    candidates: &[(u16, u32)],
    touches: &mut Vec<TriangleContact>,
    (body, template): (&Mover, &Template),
    (number, rotation): (usize, &Matrix3<f64>),
    moving: &Moving,
    context: &Context<'_>,
) -> ContactWrench {
    let interaction = context.interaction(template.material, moving.wall.material);
    let mut total = ContactWrench::default();
    let volume = bridge_volume(interaction, context.liquid, [number]);
    let reach = interaction.reach(volume);
    let mut before = std::mem::take(touches);
    let at_wall = |group: &[(u16, u32)]| {
        let sphere = &template.spheres[usize::from(group[0].0)];
        let centre = body.position + rotation * sphere.centre;
        let own = moving.own_point(&centre);
        let hits = felt(group, &own, sphere.radius + reach, moving).into_iter();
        hits.map(move |hit| geometry(body, sphere, &centre, moving, &hit))
    };
    let groups = || candidates.chunk_by(|a, b| a.0 == b.0);
    let touching = groups().flat_map(at_wall).map(|contact| contact.touch());
    let shares = Shares::new([Turned { template, rotation }], touching);
    for group in groups() {
        let sphere = group[0].0;
        for mut contact in at_wall(group) {
            let known = take_memory(&mut before, sphere, &contact.normal);
            if known.is_none() && contact.geometry.overlap <= 0.0 {
                continue;
            }
            let memory = known.unwrap_or_default();
            contact.bridge_volume = volume;
            contact.share_mass(shares.as_ref());
            let effect = interaction.at_wall(&contact, body, memory, context.time_step);
            touches.push(TriangleContact {
                sphere,
                normal: contact.normal,
                memory: effect.memory,
            });
            total.force += effect.force;
            total.torque_i += effect.torque_i;
        }
    }
    total
}

/// Triangles within reach (m) of the centre of a sphere, a point of their frame, nearest first.
fn felt(group: &[(u16, u32)], own: &Vector3<f64>, reach: f64, moving: &Moving) -> Vec<Hit> {
    let triangles = &moving.wall.triangles;
    let mut hits: Vec<Hit> = Vec::new();
    for &(_, triangle) in group {
        let triangle = triangle as usize;
        let point = nearest_on_triangle(own, &triangles[triangle]);
        let distance = (point - own).norm();
        if distance < reach {
            hits.push(Hit {
                distance,
                point,
                triangle,
            });
        }
    }
    hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    // A point on the edge of a nearer triangle is no nearest point of the surface, even if that triangle is felt through another one.
    let is_on = |point: &Vector3<f64>, other: &Hit| {
        let there = nearest_on_triangle(point, &triangles[other.triangle]);
        (there - point).norm() < SAME_POINT * reach
    };
    let is_felt = |at: &usize| !hits[..*at].iter().any(|o| is_on(&hits[*at].point, o));
    (0..hits.len()).filter(is_felt).map(|at| hits[at]).collect()
}

/// Geometry of a sphere of a body at a triangle, without liquid.
fn geometry(
    body: &Mover,
    sphere: &OuterSphere,
    centre: &Vector3<f64>,
    moving: &Moving,
    hit: &Hit,
) -> SphereWall {
    let towards = if hit.distance > 0.0 {
        moving.direction(&((hit.point - moving.own_point(centre)) / hit.distance))
    } else {
        let [a, b, c] = moving.wall.triangles[hit.triangle];
        moving.direction(&(b - a).cross(&(c - a)).normalize())
    };
    let overlap = sphere.radius - hit.distance;
    let point = centre + towards * (sphere.radius - 0.5 * overlap);
    SphereWall {
        normal: towards,
        arm: point - body.position,
        wall_velocity: moving.velocity_at(&point),
        wall_spin: moving.wall.motion.spin,
        geometry: ContactGeometry {
            overlap,
            reduced_radius: sphere.radius,
            reduced_mass: sphere.dashpot_mass,
        },
        bridge_volume: 0.0,
    }
}

/// Takes the memory of the contact of a sphere that had nearly this normal; none for a new one.
fn take_memory(
    before: &mut Vec<TriangleContact>,
    sphere: u16,
    normal: &Vector3<f64>,
) -> Option<Memory> {
    let same = before
        .iter()
        .enumerate()
        .filter(|(_, t)| t.sphere == sphere && t.normal.dot(normal) > SAME_CONTACT)
        .max_by(|a, b| a.1.normal.dot(normal).total_cmp(&b.1.normal.dot(normal)))
        .map(|(at, _)| at);
    same.map(|at| before.swap_remove(at).memory)
}
