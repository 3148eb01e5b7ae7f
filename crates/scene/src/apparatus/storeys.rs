//! A bed on an upper floor with gates, and a lower floor on which it falls: what a draw-down box and a ledge have in common.

use super::hopper::steady_flow;
use super::shapes::{at_rest, level};
use super::{NamedMesh, NamedWall, cover};
use crate::check::bad;
use crate::curve;
use crate::outline::{FLANK, Outline, View};
use crate::phases::{End, Phase, Plan, Seen};
use crate::placement::Capsule;
use crate::{Error, ObservableValues, SeedBody};
use dem_solver::Shape;
use geometry::clump::Sphere;
use input::quantity::Length;
use nalgebra::Vector3;
use std::sync::Arc;

/// Time between samples, s.
const INTERVAL: f64 = 5e-3;
/// Shortest time of a discharge beyond the fall to the lower floor, s: seeds above an open gate have then begun to fall.
const SHORTEST: f64 = 0.1;

/// Upright sides at x = plus and minus `half`, front and back, an upper floor y = 0 and a lower one.
pub(super) struct Storeys<'a> {
    /// Half of the length, m.
    pub(super) half: f64,
    /// Half of the depth along z, m.
    pub(super) half_depth: f64,
    /// Height of the upper floor above the lower one, m.
    pub(super) drop: f64,
    /// Parts of the upper floor, name and range of x, m.
    pub(super) floor: Vec<(&'static str, [f64; 2])>,
    /// Parts that the gate closes, m.
    pub(super) gates: Vec<[f64; 2]>,
    /// Material of all walls.
    pub(super) material: &'a str,
}

impl Storeys<'_> {
    /// Sides, front, back and floors.
    pub(super) fn walls(&self) -> Vec<NamedWall> {
        let side = |sign: f64| Shape::Plane {
            point: Vector3::x() * (sign * self.half),
            normal: Vector3::x() * -sign,
        };
        let slab = |[x0, x1]: [f64; 2], y: f64| Shape::Rectangle {
            centre: Vector3::new(0.5 * (x0 + x1), y, 0.0),
            half_edges: [
                Vector3::x() * (0.5 * (x1 - x0)),
                Vector3::z() * self.half_depth,
            ],
        };
        let mut walls = vec![
            ("left side", side(-1.0)),
            ("right side", side(1.0)),
            ("front side", cover(self.half_depth)),
            ("back side", cover(-self.half_depth)),
            ("lower floor", slab([-self.half, self.half], -self.drop)),
        ];
        let floor = self.floor.iter();
        walls.extend(floor.map(|(name, range)| (*name, slab(*range, 0.0))));
        let named = |(name, shape): (&str, _)| NamedWall {
            name: name.into(),
            shape,
            material: self.material.to_owned(),
            spin: 0.0,
        };
        walls.into_iter().map(named).collect()
    }

    /// The gate that is taken away.
    pub(super) fn gate(&self) -> NamedMesh {
        let across = [-self.half_depth, self.half_depth];
        let parts = self.gates.iter();
        let parts = parts.flat_map(|range| level(*range, 0.0, across));
        at_rest("gate", self.material, parts.collect())
    }

    /// Filling, and the discharge until the seeds rest on both floors, under a gravity (m/s²).
    pub(super) fn plan(&self, gravity: f64) -> Plan {
        let fall = (2.0 * self.drop / gravity).sqrt();
        let mut plan = Plan::new(vec![Phase {
            removed: vec!["gate".into()],
            end: End::AtRest {
                after: SHORTEST + fall,
            },
            ..Phase::named("discharge")
        }]);
        plan.interval = INTERVAL;
        plan
    }

    /// Angles of the flanks of the seeds on a floor, deg: those that fall towards the sides, or towards the middle; of spheres above the
    /// floor at this height and below the upper floor, if that is another.
    pub(super) fn angles(
        &self,
        spheres: &[Sphere],
        (upper, inwards): (bool, bool),
        largest_radius: f64,
    ) -> Vec<f64> {
        let lift = if upper { 0.0 } else { self.drop };
        let on_floor = |x: f64| {
            let mut parts = self.floor.iter();
            parts.any(|(_, [x0, x1])| (*x0..=*x1).contains(&x))
        };
        let is_here = |s: &&Sphere| {
            // Seeds in an opening lie on those below.
            let is_above = s.centre.y > 0.0 && on_floor(s.centre.x);
            is_above == upper
        };
        let of_storey = spheres.iter().filter(is_here);
        let lifted: Vec<Sphere> = of_storey
            .map(|s| Sphere {
                centre: s.centre + Vector3::y() * lift,
                ..*s
            })
            .collect();
        // Flanks that fall towards the middle belong to two deposits, one at each side.
        let parts = if inwards {
            let (left, right) = lifted.into_iter().partition(|s| s.centre.x < 0.0);
            vec![(left, false), (right, true)]
        } else {
            vec![(lifted.clone(), false), (lifted, true)]
        };
        let angle = |(part, mirrored): (Vec<Sphere>, bool)| {
            let outline = Outline::of(&part, View::AlongZ, 0.5 * largest_radius)?;
            let outline = if mirrored {
                outline.mirrored()
            } else {
                outline
            };
            outline.right_flank(FLANK).map(f64::to_degrees)
        };
        parts.into_iter().filter_map(angle).collect()
    }
}

/// Times (s) of the samples of the discharge, and the mass (kg) that fell through the upper floor since the sample before.
fn fallen(seen: &Seen<'_>) -> Vec<[f64; 2]> {
    let samples = seen.samples("discharge");
    let steps = samples.windows(2);
    steps
        .map(|pair| [pair[1].time, pair[1].below - pair[0].below])
        .collect()
}

/// What fell through the upper floor, by time.
pub(super) fn discharge_curve(seen: &Seen<'_>) -> Vec<Vec<f64>> {
    curve::discharge(seen, &fallen(seen))
}

/// Mass flow through the upper floor and the fraction of the mass that fell.
pub(super) fn discharge(seen: &Seen<'_>) -> [ObservableValues; 2] {
    let samples = seen.samples("discharge");
    let flow = steady_flow(&fallen(seen)).map(|flow| 1e3 * flow);
    let share = samples.last().map(|last| last.below / last.mass);
    [
        ObservableValues::new("mass_flow_g_s", "g/s", flow.into_iter().collect()),
        ObservableValues::new("discharged_share", "1", share.into_iter().collect()),
    ]
}

/// Refuses an opening that the widest seed does not pass.
pub(super) fn check_passage(outlet: Length, bodies: &[Arc<SeedBody>]) -> Result<(), Error> {
    let widths = bodies.iter().map(|b| Capsule::around(&b.clump).width());
    let widest = widths.fold(0.0, f64::max);
    if outlet.si() > widest {
        return Ok(());
    }
    let requirement = format!(
        "wider than the widest seed, {:.3} mm: no such seed passes it",
        1e3 * widest
    );
    Err(bad("apparatus.outlet", outlet.to_string(), &requirement))
}
