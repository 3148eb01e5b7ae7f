//! A range of bodies with its lists: the part of a step that one thread does.
//!
//! A body gets its loads in the order of the bodies of the contacts, whatever thread found
//! them, so that the sums do not depend on the number of parts or threads.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::batch::{Loads, Sink};
use crate::bodies::Bodies;
use crate::broad_phase::BodyGrid;
use crate::census::Census;
use crate::context::Context;
use crate::kept_contact::KeptContact;
use crate::load::Load;
use crate::neighbours::Neighbours;
use crate::pair_force::add_pair_forces;
use crate::spheres::force::add_sphere_forces;
use crate::spheres::pairs::SpherePairs;
use crate::spheres::walls::SphereWalls;
use crate::wall::Wall;
use crate::wall_force::WallNeighbours;
use crate::workspace::Workspace;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use nalgebra::Vector3;
use std::ops::Range;
use std::sync::Arc;

/// The lists of a range of bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct Part {
    /// The bodies.
    range: Range<usize>,
    /// Their pairs with the bodies behind them; empty in a world of spheres.
    neighbours: Neighbours,
    /// The same in a world of spheres; empty in another.
    spheres: SpherePairs,
    /// Those of them that are near walls; empty in a world of spheres.
    walls: WallNeighbours,
    /// The same in a world of spheres; empty in another.
    spheres_at_walls: SphereWalls,
    /// Loads found and not yet given to the bodies.
    outbox: Outbox,
}

/// What one contact does to its two bodies, in half the memory of two [`Load`]s.
#[derive(Debug, Clone, Copy)]
struct ContactLoad {
    /// The two bodies.
    bodies: [usize; 2],
    /// Force on the first, the opposite of that on the second, N.
    force: Vector3<f64>,
    /// Torques on both, N m.
    torques: [Vector3<f64>; 2],
}

impl ContactLoad {
    /// Adds what the contact does to its first body.
    #[inline(always)]
    fn give_first(&self, loads: &mut Loads<'_>) {
        loads.add(self.bodies[0], &Load::new(&self.force, &self.torques[0]));
    }

    /// Adds what the contact does to its second body.
    #[inline(always)]
    fn give_second(&self, loads: &mut Loads<'_>) {
        loads.add(self.bodies[1], &Load::new(&-self.force, &self.torques[1]));
    }
}

/// Loads of the contacts of a part in the order in which they were found.
#[derive(Debug, Clone, Default)]
struct Outbox {
    /// The loads.
    loads: Vec<ContactLoad>,
    /// For each part the loads whose second body is there; empty for the own one.
    abroad: Vec<Vec<u32>>,
    /// End of the own bodies.
    end: usize,
    /// Ends of the bodies of all parts.
    ends: Arc<[usize]>,
}

impl Sink for Outbox {
    #[inline]
    fn take(&mut self, bodies: [usize; 2], loads: &[Load; 2]) {
        let other = bodies[1];
        if other >= self.end {
            let place = self.ends.partition_point(|end| *end <= other);
            let number = u32::try_from(self.loads.len()).unwrap_or(u32::MAX);
            self.abroad[place].push(number);
        }
        self.loads.push(ContactLoad {
            bodies,
            force: loads[0].force(),
            torques: [loads[0].torque(), loads[1].torque()],
        });
    }
}

impl Part {
    /// Cuts so many bodies into parts of nearly the same size.
    pub(crate) fn cut(n_bodies: usize, n_parts: usize) -> Vec<Self> {
        let edge = |k: usize| n_bodies * k / n_parts;
        let ends: Arc<[usize]> = (1..=n_parts).map(edge).collect();
        let part = |k: usize| Self {
            range: edge(k)..edge(k + 1),
            outbox: Outbox {
                abroad: vec![Vec::new(); n_parts],
                end: edge(k + 1),
                ends: Arc::clone(&ends),
                ..Outbox::default()
            },
            ..Self::default()
        };
        (0..n_parts).map(part).collect()
    }

    /// Lists the pairs of bodies, and of bodies and walls, that are near (margin in m).
    pub(crate) fn search(
        &mut self,
        level: Level,
        grid: &BodyGrid,
        bodies: &Bodies,
        radii: &[f64],
        (context, walls, margin): (&Context<'_>, &[Wall], f64),
        workspace: &mut Workspace,
    ) {
        let range = self.range.clone();
        let (positions, travel) = (&bodies.position, &bodies.travel);
        let partners = &mut workspace.partners;
        if context.spheres.is_empty() {
            let (pairs, previous) = (&mut self.neighbours, &mut workspace.previous);
            pairs.begin(range.start, previous);
            let found = |i: usize, with: &[u32]| pairs.add(i, with, travel, previous);
            grid.for_each_body(level, range.clone(), positions, radii, partners, found);
            pairs.end();
            let templates = context.templates;
            self.walls.rebuild(range, bodies, templates, walls, margin);
        } else {
            let (pairs, previous) = (&mut self.spheres, &mut workspace.previous_spheres);
            pairs.begin(range.start, context.interactions, previous);
            let known = (bodies.template.as_slice(), travel.as_slice());
            let found = |i: usize, with: &[u32]| pairs.add(i, with, known, context, previous);
            grid.for_each_body(level, range.clone(), positions, radii, partners, found);
            pairs.end();
            let previous = &mut workspace.previous_at_walls;
            let near = &mut self.spheres_at_walls;
            near.rebuild(range, bodies, walls, margin, context, previous);
        }
    }

    /// Contacts of bodies, as of the last step.
    pub(crate) fn kept_pairs(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.neighbours.kept().chain(self.spheres.kept())
    }

    /// Takes up the contacts of its bodies with others, which come in order; the number taken.
    pub(crate) fn recall_pairs(&mut self, contacts: &[KeptContact]) -> usize {
        self.neighbours.recall(contacts) + self.spheres.recall(contacts)
    }

    /// Contacts of bodies and walls, as of the last step.
    pub(crate) fn kept_walls(&self) -> impl Iterator<Item = KeptContact> + '_ {
        self.walls.kept().chain(self.spheres_at_walls.kept())
    }

    /// Takes up the contacts of its bodies with walls; the number taken.
    pub(crate) fn recall_walls(&mut self, contacts: &[KeptContact]) -> usize {
        self.walls.recall(contacts) + self.spheres_at_walls.recall(contacts)
    }

    /// Number of touching spheres at all walls.
    pub(crate) fn n_wall_contacts(&self) -> usize {
        self.walls.n_contacts() + self.spheres_at_walls.n_contacts()
    }

    /// Gives the forces of walls found to the bodies.
    pub(crate) fn give_wall_forces(&self, loads: &mut Loads<'_>) {
        self.walls.give_forces(loads);
        self.spheres_at_walls.give_forces(loads);
    }

    /// Adds the forces found to those on each wall (N) and to its torque about the z axis (N m).
    pub(crate) fn add_to_walls(
        &self,
        positions: &[Vector3<f64>],
        (force, torque): (&mut [Vector3<f64>], &mut [f64]),
    ) {
        self.walls.add_to_walls(positions, (force, torque));
        let (spheres, loads) = (&self.spheres_at_walls, (force, torque));
        spheres.add_to_walls(positions, loads);
    }

    /// Sizes of the lists.
    pub(crate) fn census(&self) -> Census {
        let mut census = self.neighbours.census();
        census += self.spheres.census();
        census
    }

    /// Finds the loads of all contacts of the part and gives those of pairs to a sink.
    pub(crate) fn find_loads(
        &mut self,
        level: Level,
        bodies: &Bodies,
        walls: &[Wall],
        context: &Context<'_>,
        workspace: &mut Workspace,
        sink: &mut impl Sink,
    ) {
        if context.spheres.is_empty() {
            let pairs = &mut self.neighbours;
            add_pair_forces(level, pairs, bodies, workspace, context, sink);
            self.walls.find_forces(bodies, walls, context);
        } else {
            let (pairs, travel) = (&mut self.spheres, bodies.travel.as_slice());
            add_sphere_forces(level, pairs, travel, workspace, context, sink);
            let batch = &mut workspace.spheres_at_walls;
            let near = &mut self.spheres_at_walls;
            near.find_forces(level, travel, walls, context, batch);
        }
    }

    /// [`Self::find_loads`], with the loads kept for [`give_loads`].
    pub(crate) fn keep_loads(
        &mut self,
        level: Level,
        bodies: &Bodies,
        walls: &[Wall],
        context: &Context<'_>,
        workspace: &mut Workspace,
    ) {
        let mut outbox = std::mem::take(&mut self.outbox);
        outbox.loads.clear();
        outbox.abroad.iter_mut().for_each(Vec::clear);
        self.find_loads(level, bodies, walls, context, workspace, &mut outbox);
        self.outbox = outbox;
    }
}

/// Gives the loads that were kept, of pairs and of walls, to the bodies of some parts; `loads` are those of these
/// bodies. Halves are done at the same time.
pub(crate) fn give_loads(
    level: Level,
    parts: &[Part],
    receivers: Range<usize>,
    mut loads: Loads<'_>,
) {
    if receivers.len() > 1 {
        let middle = receivers.start + receivers.len() / 2;
        let (low, high) = loads.split_at(parts[middle].range.start);
        rayon::join(
            || give_loads(level, parts, receivers.start..middle, low),
            || give_loads(level, parts, middle..receivers.end, high),
        );
        return;
    }
    for receiver in receivers {
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || give_to(parts, receiver, &mut loads),
        ));
        parts[receiver].give_wall_forces(&mut loads);
    }
}

/// Gives the loads of pairs that were kept to the bodies of one part.
#[inline(always)]
fn give_to(parts: &[Part], receiver: usize, loads: &mut Loads<'_>) {
    for part in &parts[..receiver] {
        let outbox = &part.outbox;
        for &number in &outbox.abroad[receiver] {
            outbox.loads[number as usize].give_second(loads);
        }
    }
    let own = &parts[receiver];
    for load in &own.outbox.loads {
        load.give_first(loads);
        if load.bodies[1] < own.range.end {
            load.give_second(loads);
        }
    }
}
