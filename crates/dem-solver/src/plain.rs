//! The plain force loop: every sphere of every body against every other, no lists.
//!
//! It is slow and obvious. The tests hold the fast loop to it.

use crate::contact::{ContactWrench, Memory, SpherePair, SphereWall};
use crate::interaction::Interaction;
use crate::liquid::bridge_volume;
use crate::load::Load;
use crate::mesh_force::{TriangleContact, find_contacts};
use crate::pair_force::PairFrame;
use crate::shared_mass::{Shares, Turned};
use crate::template::OuterSphere;
use crate::wall_force::sphere_at_wall;
use crate::world::World;
use std::collections::BTreeMap;

/// State of the contacts, by (body, body or wall, sphere pair).
#[derive(Debug, Clone, Default)]
pub struct History {
    /// Between bodies.
    pairs: BTreeMap<(usize, usize, u32), Memory>,
    /// Between bodies and walls.
    walls: BTreeMap<(usize, usize, u32), Memory>,
    /// Between bodies and walls of triangles, by (body, wall).
    meshes: BTreeMap<(usize, usize), Vec<TriangleContact>>,
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

/// Contact loads on all bodies that the next step of a world will use.
///
/// `history` holds what the contacts remember of the step before, and of this step afterwards: starting
/// from an empty one, call this once before each step.
pub fn loads(world: &World, history: &mut History) -> Vec<Load> {
    let count = world.bodies().len();
    let mut loads = vec![Load::default(); count];
    let mut next = History::default();
    for i in 0..count {
        for j in i + 1..count {
            let known = |key| history.pairs.get(&(i, j, key)).copied();
            find_pairs(world, [i, j], known, |key, _, _, effect| {
                next.pairs.insert((i, j, key), effect.memory);
                loads[i] += Load::new(&effect.force, &effect.torque_i);
                loads[j] += Load::new(&-effect.force, &effect.torque_j);
            });
        }
        for w in 0..world.walls().len() {
            let known = |key| history.walls.get(&(i, w, key)).copied();
            find_at_wall(world, i, w, known, |key, _, _, effect| {
                next.walls.insert((i, w, key), effect.memory);
                loads[i] += Load::new(&effect.force, &effect.torque_i);
            });
        }
        mesh_loads(world, i, history, &mut next, &mut loads[i]);
    }
    *history = next;
    loads
}

/// Tries every sphere of body `i` with every sphere of body `j`.
///
/// `known` reports what a contact remembers, none if it is new; `found` gets the key of each contact, its geometry, its
/// law and what the law says.
pub(crate) fn find_pairs(
    world: &World,
    [i, j]: [usize; 2],
    known: impl Fn(u32) -> Option<Memory>,
    mut found: impl FnMut(u32, &SpherePair, &Interaction, &ContactWrench),
) {
    let context = world.context();
    let bodies = world.bodies();
    let templates = [i, j].map(|k| &context.templates[bodies.template[k]]);
    let [n, m] = templates.map(|t| t.spheres.len());
    let law = context.interaction(templates[0].material, templates[1].material);
    let volume = bridge_volume(law, context.liquid, [i, j]);
    let frame = PairFrame::new(bodies, [i, j], context.period);
    let key = |pair: usize| word(pair / m) << 16 | word(pair % m);
    let touching = (0..n * m).filter_map(|pair| frame.sphere_pair(key(pair), templates, 0.0));
    let shares = Shares::new(frame.turned(templates), touching.map(|pair| pair.touch()));
    for key in (0..n * m).map(key) {
        let known = known(key);
        let reach = known.map_or(0.0, |_| law.reach(volume));
        let Some(mut pair) = frame.sphere_pair(key, templates, reach) else {
            continue;
        };
        pair.memory = known.unwrap_or_default();
        pair.bridge_volume = volume;
        pair.share_masses(shares.as_ref());
        let effect = law.between_spheres(&pair, context.time_step);
        found(key, &pair, law, &effect);
    }
}

/// Tries every sphere of body `i` at wall `w`; the key is the number of the sphere, the rest as in [`find_pairs`].
pub(crate) fn find_at_wall(
    world: &World,
    i: usize,
    w: usize,
    known: impl Fn(u32) -> Option<Memory>,
    mut found: impl FnMut(u32, &SphereWall, &Interaction, &ContactWrench),
) {
    let context = world.context();
    let (bodies, wall) = (world.bodies(), &world.walls()[w]);
    let template = &context.templates[bodies.template[i]];
    let law = context.interaction(template.material, wall.material);
    let volume = bridge_volume(law, context.liquid, [i]);
    let body = context.period.at_walls(bodies.mover(i));
    let at_wall = |sphere: &OuterSphere| {
        let centre = body.position + bodies.rotation[i] * sphere.centre;
        sphere_at_wall(&body, sphere, &centre, wall, &wall.nearest(&centre))
    };
    let turned = Turned {
        template,
        rotation: &bodies.rotation[i],
    };
    let touches = template.spheres.iter().map(|s| at_wall(s).touch());
    let shares = Shares::new([turned], touches);
    for (k, sphere) in template.spheres.iter().enumerate() {
        let mut contact = at_wall(sphere);
        let known = known(word(k));
        let reach = known.map_or(0.0, |_| law.reach(volume));
        if contact.geometry.overlap <= -reach {
            continue;
        }
        contact.bridge_volume = volume;
        contact.share_mass(shares.as_ref());
        let memory = known.unwrap_or_default();
        let effect = law.at_wall(&contact, &body, memory, context.time_step);
        found(word(k), &contact, law, &effect);
    }
}

/// The number of a sphere as it is in a key.
fn word(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
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
        let body = (&context.period.at_walls(bodies.mover(i)), template);
        let all: Vec<_> = all.collect();
        let effect = find_contacts(
            &all,
            &mut touches,
            body,
            (i, &bodies.rotation[i]),
            moving,
            &context,
        );
        *load += Load::new(&effect.force, &effect.torque_i);
        next.meshes.insert((i, w), touches);
    }
}
