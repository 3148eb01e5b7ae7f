//! A range of bodies with its lists: the part of a step that one thread does.
//!
//! The loads of a part are given to the bodies in the order of the bodies, whatever thread found
//! them, so that the sums do not depend on the number of parts or threads.

use crate::batch::{Batch, ContactLoad, Loads, Sink};
use crate::bodies::Bodies;
use crate::broad_phase::Grid;
use crate::neighbours::Neighbours;
use crate::pair_force::{Context, add_pair_forces};
use crate::template::Template;
use crate::wall::Wall;
use crate::wall_force::WallNeighbours;
use fearless_simd::Level;
use std::ops::Range;

/// The lists of a range of bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct Part {
    /// The bodies.
    range: Range<usize>,
    /// Their pairs with the bodies behind them.
    pub(crate) neighbours: Neighbours,
    /// Those of them that are near walls.
    pub(crate) walls: WallNeighbours,
    /// Contacts that wait for their forces.
    batch: Batch,
    /// Loads found and not yet given to the bodies.
    loads: Vec<ContactLoad>,
    /// Buffer of the broad phase.
    partners: Vec<u32>,
}

impl Part {
    /// Cuts so many bodies into parts of nearly the same size.
    pub(crate) fn cut(n_bodies: usize, n_parts: usize) -> Vec<Self> {
        let edge = |k: usize| n_bodies * k / n_parts;
        let part = |k: usize| Self {
            range: edge(k)..edge(k + 1),
            ..Self::default()
        };
        (0..n_parts).map(part).collect()
    }

    /// Lists the pairs of bodies, and of bodies and walls, that are near (margin in m).
    pub(crate) fn search(
        &mut self,
        level: Level,
        grid: &Grid,
        bodies: &Bodies,
        radii: &[f64],
        (templates, walls, margin): (&[Template], &[Wall], f64),
    ) {
        let (neighbours, range) = (&mut self.neighbours, self.range.clone());
        neighbours.begin(range.start);
        grid.for_each_body(
            level,
            range.clone(),
            &bodies.position,
            radii,
            &mut self.partners,
            |i, partners| neighbours.add(i, partners, &bodies.travel),
        );
        self.walls.rebuild(range, bodies, templates, walls, margin);
    }

    /// Finds the loads of all contacts of the part and gives those of pairs to a sink.
    pub(crate) fn find_loads(
        &mut self,
        level: Level,
        bodies: &Bodies,
        walls: &[Wall],
        context: &Context<'_>,
        sink: &mut impl Sink,
    ) {
        let (neighbours, batch) = (&mut self.neighbours, &mut self.batch);
        add_pair_forces(level, neighbours, bodies, batch, context, sink);
        self.walls.find_forces(bodies, walls, context);
    }

    /// [`Self::find_loads`], with the loads kept for [`Self::give_loads`].
    pub(crate) fn keep_loads(
        &mut self,
        level: Level,
        bodies: &Bodies,
        walls: &[Wall],
        context: &Context<'_>,
    ) {
        let mut loads = std::mem::take(&mut self.loads);
        self.find_loads(level, bodies, walls, context, &mut loads);
        self.loads = loads;
    }

    /// Gives the loads kept to the bodies.
    pub(crate) fn give_loads(&mut self, loads: &mut Loads<'_>) {
        for load in self.loads.drain(..) {
            loads.take(&load);
        }
    }
}
