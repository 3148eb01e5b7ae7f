//! A range of bodies with its lists: the part of a step that one thread does.
//!
//! A body gets its loads in the order of the bodies of the contacts, whatever thread found
//! them, so that the sums do not depend on the number of parts or threads: a pair is listed at its later body, so a part
//! adds first what its own pairs do to its bodies, and then what the pairs of the parts behind it do to them.

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
use crate::window::Window;
use crate::workspace::Workspace;
use fearless_simd::Level;
use nalgebra::Vector3;
use std::mem::take;
use std::ops::Range;
use std::sync::Arc;

/// The lists of a range of bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct Part {
    /// The bodies.
    range: Range<usize>,
    /// Their pairs with the bodies before them; empty in a world of spheres.
    neighbours: Neighbours,
    /// The same in a world of spheres; empty in another.
    spheres: SpherePairs,
    /// Those of them that are near walls; empty in a world of spheres.
    walls: WallNeighbours,
    /// The same in a world of spheres; empty in another.
    spheres_at_walls: SphereWalls,
    /// Loads on bodies of the parts before it, not yet given to them.
    outbox: Outbox,
}
/// A load on a body of another part.
#[derive(Debug, Clone, Copy)]
struct LoadAbroad {
    body: usize,
    /// What one contact does to it.
    load: Load,
}

/// Loads that a part has found on the bodies of the parts before it.
#[derive(Debug, Clone, Default)]
struct Outbox {
    /// For each of these parts its loads, in the order in which they were found.
    loads: Vec<Vec<LoadAbroad>>,
    /// Ends of the bodies of these parts.
    ends: Arc<[usize]>,
}

/// Where the contacts of a part put their loads: on its own bodies at once, all others into its outbox.
struct OwnLoads<'a> {
    /// Loads of the own bodies.
    own: Loads<'a>,
    /// The others.
    outbox: &'a mut Outbox,
}

impl Sink for OwnLoads<'_> {
    #[inline(always)]
    fn take(&mut self, [other, own]: [usize; 2], [on_other, on_own]: &[Load; 2]) {
        if other < self.own.first {
            self.outbox.put(other, on_other);
        } else {
            self.own.add(other, on_other);
        }
        self.own.add(own, on_own);
    }
}

impl Outbox {
    /// Keeps a load on a body of a part before this one.
    fn put(&mut self, body: usize, load: &Load) {
        let part = self.ends.partition_point(|end| *end <= body);
        self.loads[part].push(LoadAbroad { body, load: *load });
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
                loads: Vec::new(),
                ends: Arc::clone(&ends),
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
        let travel = &bodies.travel;
        let partners = &mut workspace.partners;
        if context.spheres.is_empty() {
            let (pairs, previous) = (&mut self.neighbours, &mut workspace.previous);
            pairs.begin(range.start, previous);
            let found = |i: usize, with: &[u32]| pairs.add(i, with, travel, previous);
            grid.for_each_body(level, range.clone(), radii, partners, found);
            pairs.end();
            self.walls.rebuild(range, bodies, walls, margin, context);
        } else {
            let (pairs, previous) = (&mut self.spheres, &mut workspace.previous_spheres);
            pairs.begin(range.start, context.interactions, previous);
            let known = (bodies.template.as_slice(), travel.as_slice());
            let found = |i: usize, with: &[u32]| pairs.add(i, with, known, context, previous);
            grid.for_each_body(level, range.clone(), radii, partners, found);
            pairs.end();
            let previous = &mut workspace.previous_at_walls;
            let near = &mut self.spheres_at_walls;
            near.rebuild(range, bodies, walls, margin, context, previous);
        }
    }

    /// The bodies.
    pub(crate) fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// The first of all bodies that are listed as partners, in a world of spheres; none if there is none.
    pub(crate) fn lowest_partner(&self) -> Option<usize> {
        self.spheres.lowest_partner()
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
        positions: Window<'_, Vector3<f64>>,
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

    /// Sets the loads of its bodies to zero. No contact of an earlier part acts on them.
    pub(crate) fn clear(&self, loads: &mut Loads<'_>) {
        let first = loads.first;
        let own = self.range.start - first..self.range.end - first;
        loads.all[own].fill(Load::default());
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
            let near = &mut self.walls;
            near.find_forces(level, bodies, walls, context, workspace);
        } else {
            let travel = Window::whole(&bodies.travel);
            self.find_loads_of_spheres(level, travel, walls, context, workspace, sink);
        }
    }

    /// [`Self::find_loads`] in a world of spheres, by the travels of its bodies and their partners (m).
    pub(crate) fn find_loads_of_spheres(
        &mut self,
        level: Level,
        travel: Window<'_, f32>,
        walls: &[Wall],
        context: &Context<'_>,
        workspace: &mut Workspace,
        sink: &mut impl Sink,
    ) {
        let pairs = &mut self.spheres;
        add_sphere_forces(level, pairs, travel, workspace, context, sink);
        let batch = &mut workspace.spheres_at_walls;
        let near = &mut self.spheres_at_walls;
        near.find_forces(level, travel, walls, context, batch);
    }

    /// [`Self::clear`] and [`Self::find_loads`] with the loads of the own bodies alone; those on bodies of other parts are
    /// kept for [`give_loads`].
    fn find_own_loads(
        &mut self,
        level: Level,
        bodies: &Bodies,
        walls: &[Wall],
        context: &Context<'_>,
        workspace: &mut Workspace,
        mut own: Loads<'_>,
    ) {
        self.clear(&mut own);
        let mut outbox = take(&mut self.outbox);
        let before = outbox.ends.partition_point(|end| *end <= self.range.start);
        outbox.loads.resize_with(before, Vec::new);
        outbox.loads.iter_mut().for_each(Vec::clear);
        let mut sink = OwnLoads {
            own,
            outbox: &mut outbox,
        };
        self.find_loads(level, bodies, walls, context, workspace, &mut sink);
        self.outbox = outbox;
    }
}

/// [`Part::find_loads`] of all parts, as many in a row for each workspace; `loads` are those of their bodies. Halves are
/// done at the same time. What the parts keep for each other is given by [`give_loads`].
pub(crate) fn find_loads(
    level: Level,
    parts: &mut [Part],
    bodies: &Bodies,
    walls: &[Wall],
    context: &Context<'_>,
    workspaces: &mut [Workspace],
    mut loads: Loads<'_>,
) {
    if workspaces.len() > 1 {
        let middle = workspaces.len() / 2;
        let (low, high) = parts.split_at_mut(parts.len() / workspaces.len() * middle);
        let of_parts = loads.split_at(high[0].range.start);
        let of_workspaces = workspaces.split_at_mut(middle);
        let find = |parts: &mut [Part], workspaces: &mut [Workspace], loads: Loads<'_>| {
            find_loads(level, parts, bodies, walls, context, workspaces, loads);
        };
        rayon::join(
            || find(low, of_workspaces.0, of_parts.0),
            || find(high, of_workspaces.1, of_parts.1),
        );
        return;
    }
    for part in parts {
        let (own, later) = loads.split_at(part.range.end);
        part.find_own_loads(level, bodies, walls, context, &mut workspaces[0], own);
        loads = later;
    }
}

/// Gives the loads that were kept, and those of walls, to the bodies of some parts; `loads` are those of these bodies.
/// Halves are done at the same time.
pub(crate) fn give_loads(parts: &[Part], receivers: Range<usize>, mut loads: Loads<'_>) {
    if receivers.len() > 1 {
        let middle = receivers.start + receivers.len() / 2;
        let (low, high) = loads.split_at(parts[middle].range.start);
        rayon::join(
            || give_loads(parts, receivers.start..middle, low),
            || give_loads(parts, middle..receivers.end, high),
        );
        return;
    }
    for receiver in receivers {
        for part in &parts[receiver + 1..] {
            for abroad in &part.outbox.loads[receiver] {
                loads.add(abroad.body, &abroad.load);
            }
        }
        parts[receiver].give_wall_forces(&mut loads);
    }
}
