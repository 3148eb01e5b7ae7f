//! Random sequential insertion: bodies put at random places, one after another. Where one finds no place, those that are
//! there are shaken, as molecules of a dense gas, and it is tried again.

use super::{Capsule, Placed, Room, clear, is_inside, try_place};
use crate::extent::extent;
use dem_solver::Placement;
use geometry::clump::{Clump, Sphere};
use nalgebra::{UnitQuaternion, Vector3};
use probability::random_stream::Stream;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_6;

/// Places drawn for a body before the others are shaken: our choice. Equal balls jam at 0.38 of the volume; at 0.3 a place in
/// some tens is free.
const MOST_PLACES: usize = 2000;

/// How often all are shaken for the bodies that found no place: our choice.
const MOST_SHAKES: usize = 300;

/// The same where spheres stand for the bodies, which takes ten times as long: our choice.
const MOST_SHAKES_OF_SPHERES: usize = 60;

/// Share of the volume beyond which nothing is shaken: equal balls crystallise at 0.49 `[HooverRee1968]`.
const DENSE: f64 = 0.45;

/// Longest step of a body that is shaken along each axis, over its radius: our choice, about the gaps of a dense gas.
const STEP: f64 = 0.5;

/// Shape by which a body is inserted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outline {
    /// Its capsule.
    Capsules,
    /// Its spheres: slower, and leaves the most room.
    Spheres,
}

/// Share of its capsule that a body must fill for the capsule to be tried: that of a flat seed is a ball, and moves about in
/// vain. Our choice, between seeds as flat as 6 by 6 by 2.4 mm (0.4) and ellipsoids as long as 9 by 5 by 4.5 mm (0.7).
const LEAST_FILLED: f64 = 0.5;

/// The outlines that are worth a try, in turn.
pub(super) fn outlines(kinds: &[(&Clump, usize)]) -> Vec<Outline> {
    let volumes = [Outline::Capsules, Outline::Spheres].map(|outline| {
        let volume =
            |(clump, count): &(&Clump, usize)| Shape::of(clump, outline).volume * *count as f64;
        kinds.iter().map(volume).sum::<f64>()
    });
    let [of_capsules, of_bodies] = volumes;
    // The capsule of a single sphere is that sphere.
    let are_balls = kinds.iter().all(|(clump, _)| clump.spheres().len() == 1);
    match of_bodies / of_capsules {
        _ if are_balls => vec![Outline::Capsules],
        filled if filled < LEAST_FILLED => vec![Outline::Spheres],
        _ => vec![Outline::Capsules, Outline::Spheres],
    }
}

/// Inserts `kinds[k].1` bodies of each kind, the largest kinds first, as far as there is room.
pub(super) fn insert(
    room: Room<'_>,
    outline: Outline,
    kinds: &[(&Clump, usize)],
    seed: u64,
) -> Vec<Placement> {
    let shapes = kinds.iter().map(|(clump, _)| Shape::of(clump, outline));
    let shapes: Vec<Shape<'_>> = shapes.collect();
    let reach = |kind: usize| shapes[kind].capsule.reach();
    let mut stream = Stream::new(seed, "insertion");
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    order.sort_by(|a, b| reach(*b).total_cmp(&reach(*a)));
    let largest = order.first().map_or(0.0, |kind| reach(*kind));
    let mut shakes_left = match outline {
        _ if is_dense(room, &shapes, kinds) => 0,
        Outline::Capsules => MOST_SHAKES,
        Outline::Spheres => MOST_SHAKES_OF_SPHERES,
    };
    let mut inserted = Inserted {
        room,
        shapes,
        cells: Cells::new(2.0 * largest),
        bodies: Vec::new(),
    };
    let all = order
        .iter()
        .flat_map(|&kind| std::iter::repeat_n(kind, kinds[kind].1));
    for kind in all {
        while !inserted.add(kind, &mut stream) {
            if shakes_left == 0 {
                return inserted.placements();
            }
            inserted.shake(&mut stream);
            shakes_left -= 1;
        }
    }
    inserted.placements()
}

/// Whether bodies would take more of the box about the apparatus than a gas does that can still be shaken.
fn is_dense(room: Room<'_>, shapes: &[Shape<'_>], kinds: &[(&Clump, usize)]) -> bool {
    let [low, high] = room.apparatus.device().room();
    let volumes = shapes.iter().zip(kinds);
    let volumes = volumes.map(|(shape, kind)| shape.volume * kind.1 as f64);
    volumes.sum::<f64>() > DENSE * (high - low).product()
}

/// A kind of bodies.
struct Shape<'a> {
    /// The capsule about one.
    capsule: Capsule,
    /// Its spheres; `None` if it is inserted by its capsule.
    spheres: Option<&'a [Sphere]>,
    /// Radius of a ball about its middle that it fills, whichever way it is turned, m.
    core: f64,
    /// Volume, m³; rough where spheres stand for it.
    volume: f64,
}

impl<'a> Shape<'a> {
    /// That of a body.
    fn of(clump: &'a Clump, outline: Outline) -> Self {
        let capsule = Capsule::around(clump);
        if outline == Outline::Capsules {
            return Self {
                capsule,
                spheres: None,
                core: capsule.radius,
                volume: capsule.volume(),
            };
        }
        let spheres = clump.spheres();
        let inner = spheres.iter().map(|s| s.radius - s.centre.norm());
        // An ellipsoid of the same extents.
        let extents = [0, 1, 2].map(|axis| {
            let [low, high] = extent(spheres, axis);
            high - low
        });
        Self {
            capsule,
            spheres: Some(spheres),
            core: inner.fold(0.0, f64::max),
            volume: FRAC_PI_6 * extents.iter().product::<f64>(),
        }
    }
}

/// A body at a place.
struct Body {
    kind: usize,
    capsule: Placed,
    /// How it is turned.
    turn: UnitQuaternion<f64>,
    /// Its spheres; empty if it is inserted by its capsule.
    balls: Vec<Placed>,
}

/// The bodies that are inserted so far.
struct Inserted<'a> {
    /// What leaves room for them.
    room: Room<'a>,
    /// Their shapes, by kind.
    shapes: Vec<Shape<'a>>,
    /// Their numbers by place.
    cells: Cells,
    /// Each of them.
    bodies: Vec<Body>,
}

impl Inserted<'_> {
    /// Adds a body of a kind, if one of the places that are drawn is free.
    fn add(&mut self, kind: usize, stream: &mut Stream) -> bool {
        let [low, high] = self.room.apparatus.device().room();
        let shape = &self.shapes[kind];
        let found = (0..MOST_PLACES).find_map(|_| {
            let centre = Vector3::from_fn(|axis, _| stream.between(low[axis], high[axis]));
            let near = self.near(&centre, None);
            // Its core does not turn.
            let core = ball(centre, shape.core);
            let is_clear_of_core = |other: &&Body| {
                if shape.spheres.is_none() {
                    return clear(&core, &other.capsule);
                }
                let gap = (centre - other.capsule.centre).norm();
                gap > shape.core + self.shapes[other.kind].core
            };
            if !near.iter().all(is_clear_of_core) {
                return None;
            }
            let fits = |capsule: &Placed, turn: &UnitQuaternion<f64>| {
                self.free_body(kind, *capsule, *turn, &near)
            };
            try_place(shape.capsule, |_| centre, fits, stream)
        });
        let Some(body) = found else {
            return false;
        };
        self.cells.add(self.bodies.len(), &body.capsule.centre);
        self.bodies.push(body);
        true
    }

    /// Moves each body by a random step, where it is clear of all others there.
    fn shake(&mut self, stream: &mut Stream) {
        for number in 0..self.bodies.len() {
            let before = &self.bodies[number];
            let from = before.capsule.centre;
            let step = Vector3::from_fn(|_, _| stream.between(-STEP, STEP)) * before.capsule.radius;
            let capsule = Placed {
                centre: from + step,
                ..before.capsule
            };
            let near = self.near(&capsule.centre, Some(number));
            if let Some(after) = self.free_body(before.kind, capsule, before.turn, &near) {
                self.cells.remove(number, &from);
                self.cells.add(number, &capsule.centre);
                self.bodies[number] = after;
            }
        }
    }

    /// A body of a kind, if it is clear of all walls and of the bodies near it.
    fn free_body(
        &self,
        kind: usize,
        capsule: Placed,
        turn: UnitQuaternion<f64>,
        near: &[&Body],
    ) -> Option<Body> {
        let mut body = Body {
            kind,
            capsule,
            turn,
            balls: Vec::new(),
        };
        let is_inside_whole = is_inside(self.room, &capsule);
        let is_apart =
            |part: &Placed, others: &[&Body]| others.iter().all(|other| are_apart(part, other));
        let Some(spheres) = self.shapes[kind].spheres else {
            let is_free = is_inside_whole && is_apart(&capsule, near);
            return is_free.then_some(body);
        };
        // What its capsule does not touch, none of its spheres does.
        let touched = near.iter().filter(|other| !clear(&capsule, &other.capsule));
        let touched: Vec<&Body> = touched.copied().collect();
        // One after the other: a body that does not fit is mostly refused by one of the first.
        for s in spheres {
            let ball = ball(capsule.centre + turn * s.centre, s.radius);
            let is_inside = is_inside_whole || is_inside(self.room, &ball);
            if !(is_inside && is_apart(&ball, &touched)) {
                return None;
            }
            body.balls.push(ball);
        }
        Some(body)
    }

    /// All bodies but one that one at a place may touch.
    fn near(&self, place: &Vector3<f64>, but: Option<usize>) -> Vec<&Body> {
        let numbers = self.cells.near(place);
        let others = numbers.filter(|number| Some(*number) != but);
        others.map(|number| &self.bodies[number]).collect()
    }

    /// Where they are.
    fn placements(&self) -> Vec<Placement> {
        let bodies = self.bodies.iter();
        bodies
            .map(|body| Placement::at_rest(body.kind, body.capsule.centre, body.turn))
            .collect()
    }
}

/// A ball: a capsule without length.
fn ball(centre: Vector3<f64>, radius: f64) -> Placed {
    Placed {
        centre,
        half: Vector3::zeros(),
        radius,
    }
}

/// Whether a ball, or a capsule where capsules stand for bodies, does not touch a body.
fn are_apart(part: &Placed, body: &Body) -> bool {
    if clear(part, &body.capsule) {
        return true;
    }
    let parts_from = |ball: &Placed| {
        let reach = part.radius + ball.radius;
        (part.centre - ball.centre).norm_squared() > reach * reach
    };
    !body.balls.is_empty() && body.balls.iter().all(parts_from)
}

/// Bodies by the cell in which they lie.
struct Cells {
    /// Edge of a cell, m: no body reaches beyond the next one.
    edge: f64,
    /// The numbers of the bodies of each cell.
    bodies: HashMap<[i64; 3], Vec<usize>>,
}

impl Cells {
    /// No bodies yet; `edge` (m) is twice the reach of the largest one.
    fn new(edge: f64) -> Self {
        Self {
            edge,
            bodies: HashMap::new(),
        }
    }

    fn cell(&self, place: &Vector3<f64>) -> [i64; 3] {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the apparatus is at most some thousands of bodies across"
        )]
        let cell = [0, 1, 2].map(|axis: usize| (place[axis] / self.edge).floor() as i64);
        cell
    }

    /// The numbers of all bodies that one at a place may touch.
    fn near(&self, place: &Vector3<f64>) -> impl Iterator<Item = usize> {
        let [x, y, z] = self.cell(place);
        let around = -1..=1_i64;
        let cells = around.clone().flat_map(move |i| {
            let around = around.clone();
            around
                .clone()
                .flat_map(move |j| around.clone().map(move |k| [x + i, y + j, z + k]))
        });
        cells
            .filter_map(|cell| self.bodies.get(&cell))
            .flatten()
            .copied()
    }

    /// A body at a place.
    fn add(&mut self, number: usize, place: &Vector3<f64>) {
        self.bodies
            .entry(self.cell(place))
            .or_default()
            .push(number);
    }

    /// A body has left a place.
    fn remove(&mut self, number: usize, place: &Vector3<f64>) {
        if let Some(there) = self.bodies.get_mut(&self.cell(place)) {
            there.retain(|other| *other != number);
        }
    }
}
