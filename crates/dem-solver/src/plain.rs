//! The plain force loop: every sphere of every body against every other, no lists.
//!
//! It is slow and obvious. The tests hold the fast loop to it.

use crate::contact::Memory;
use crate::mesh_force::{Touch, find_contacts};
use crate::pair_force::{PairFrame, mover};
use crate::shared_mass::Shares;
use crate::template::OuterSphere;
use crate::wall_force::sphere_at_wall;
use crate::world::World;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// What the contacts remember, by (body, body or wall, sphere pair).
#[derive(Debug, Clone, Default)]
pub struct History {
    /// Between bodies.
    pairs: BTreeMap<(usize, usize, u32), Memory>,
    /// Between bodies and walls.
    walls: BTreeMap<(usize, usize, u32), Memory>,
    /// Between bodies and walls of triangles, by (body, wall).
    meshes: BTreeMap<(usize, usize), Vec<Touch>>,
}

impl History {
    /// Number of touching pairs of spheres of two bodies.
    pub fn n_contacts(&self) -> usize {
        self.pairs.len()
    }

    /// Number of touching spheres at all walls.
    pub fn n_wall_contacts(&self) -> usize {
        self.walls.len() + self.meshes.values().map(Vec::len).sum::<usize>()
    }
}

/// Force (N) and torque (N m) on one body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// Force, N.
    pub force: Vector3<f64>,
    /// Torque about the centre of mass, N m.
    pub torque: Vector3<f64>,
}

/// Contact loads on all bodies that the next step of a world will use.
///
/// `history` holds what the contacts remember of the step before, and of this step afterwards: starting
/// from an empty one, call this once before each step.
pub fn loads(world: &World, history: &mut History) -> Vec<Load> {
    let context = world.context();
    let bodies = world.bodies();
    let mut loads = vec![Load::default(); bodies.len()];
    let mut next = History::default();
    for i in 0..bodies.len() {
        for j in i + 1..bodies.len() {
            let templates = [i, j].map(|k| &context.templates[bodies.template[k]]);
            let [n, m] = templates.map(|t| t.spheres.len());
            let [a, b] = templates.map(|t| t.material);
            let frame = PairFrame::new(bodies, [i, j]);
            let key = |pair: usize| {
                u32::try_from(pair / m).unwrap_or(0) << 16 | u32::try_from(pair % m).unwrap_or(0)
            };
            let touching =
                (0..n * m).filter_map(|pair| frame.sphere_pair(key(pair), templates, 0.0));
            let radii = touching.map(|pair| pair.contact_radius());
            let shares = Shares::new(templates.map(|t| t.shares_mass), radii);
            for pair in 0..n * m {
                let key = key(pair);
                let law = context.interaction(a, b);
                let known = history.pairs.get(&(i, j, key));
                let reach = if known.is_some() { law.reach() } else { 0.0 };
                let Some(mut pair) = frame.sphere_pair(key, templates, reach) else {
                    continue;
                };
                pair.memory = known.copied().unwrap_or_default();
                pair.share_masses(shares.as_ref());
                let effect = law.between_spheres(&pair, context.time_step);
                next.pairs.insert((i, j, key), effect.memory);
                loads[i].force += effect.force;
                loads[j].force -= effect.force;
                loads[i].torque += effect.torque_i;
                loads[j].torque += effect.torque_j;
            }
        }
        wall_loads(world, i, history, &mut next, &mut loads[i]);
        mesh_loads(world, i, history, &mut next, &mut loads[i]);
    }
    *history = next;
    loads
}

/// Adds the loads of all walls on body `i`.
fn wall_loads(world: &World, i: usize, before: &History, next: &mut History, load: &mut Load) {
    let context = world.context();
    let bodies = world.bodies();
    let template = &context.templates[bodies.template[i]];
    let body = mover(bodies, i);
    for (w, wall) in world.walls().iter().enumerate() {
        let at_wall = |sphere: &OuterSphere| {
            let centre = body.position + bodies.rotation[i] * sphere.centre;
            sphere_at_wall(&body, sphere, &centre, wall, &wall.nearest(&centre))
        };
        let radii = template.spheres.iter().map(|s| at_wall(s).contact_radius());
        let shares = Shares::new([template.shares_mass, false], radii);
        for (k, sphere) in template.spheres.iter().enumerate() {
            let mut contact = at_wall(sphere);
            let key = (i, w, u32::try_from(k).unwrap_or(0));
            let law = context.interaction(template.material, wall.material);
            let known = before.walls.get(&key);
            let reach = if known.is_some() { law.reach() } else { 0.0 };
            if contact.geometry.overlap <= -reach {
                continue;
            }
            let memory = known.copied().unwrap_or_default();
            contact.share_mass(shares.as_ref());
            let effect = law.at_wall(&contact, &body, memory, context.time_step);
            load.force += effect.force;
            load.torque += effect.torque_i;
            next.walls.insert(key, effect.memory);
        }
    }
}

/// Adds the loads of all walls of triangles on body `i`: each of its spheres against each triangle.
fn mesh_loads(world: &World, i: usize, before: &History, next: &mut History, load: &mut Load) {
    let context = world.context();
    let bodies = world.bodies();
    let template = &context.templates[bodies.template[i]];
    for (w, moving) in world.moving_walls().iter().enumerate() {
        let spheres = (0_u16..).zip(&template.spheres);
        let all = spheres.flat_map(|(sphere, _)| {
            let triangles = (0_u32..).zip(&moving.wall.triangles);
            triangles.map(move |(triangle, _)| (sphere, triangle))
        });
        let mut touches = before.meshes.get(&(i, w)).cloned().unwrap_or_default();
        let body = (&mover(bodies, i), template);
        let all: Vec<_> = all.collect();
        let effect = find_contacts(
            &all,
            &mut touches,
            body,
            &bodies.rotation[i],
            moving,
            &context,
        );
        load.force += effect.force;
        load.torque += effect.torque_i;
        next.meshes.insert((i, w), touches);
    }
}
