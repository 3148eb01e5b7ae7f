//! Damping of the whole body: what the restitution put in is at a contact of a body of many spheres.
//!
//! # Formula
//!
//! A body hits a plane without friction with one sphere at an arm r. Its normal impulse J moves the mass M:
//!
//! ```text
//! 1/M = 1/m + (r x n) I⁻¹ (r x n)     J = (1 + e) M v     v' = J/m - v     w' = I⁻¹ (r x n) J
//! ```
//!
//! With the overlap to the power 5/4 in its own time the contact is a linear oscillator, `y'' + 2 z y' + y = 0`
//! `[AntypovElliott2011]`; its force vanishes at `t = (pi - atan2(2 z q, 1 - 2 z²))/q`, `q = sqrt(1 - z²)` `[SchwagerPoschel2007]`. If a
//! share p of the pull is kept, the oscillator continues from there with `y'' + p (2 z y' + y) = 0` until y = 0. With an amplitude
//! a of the damping of the whole body `z = b ((1 - a) sqrt(m_sphere) + a sqrt(M)) / sqrt(M)` and p = a: at a = 1 the restitution put in
//! comes out.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{clipped, cluster, collide, floor, settings, surface, thrown};
use contact_law::hertz_mindlin::damping_ratio;
use contact_law::material::effective_moduli;
use contact_law::{Material, hard_contact};
use dem_solver::{
    DashpotMass, Interaction, InteractionSettings, OptionalLaws, Placement, Template, World,
};
use geometry::clump::Clump;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Speed of a fall, m/s.
const SPEED: f64 = 0.2;

/// Steps of the solver in an elastic contact of the whole mass.
const STEPS: f64 = 4000.0;

/// Ways in which the irregular body falls.
const FALLS: usize = 24;

/// A body of four spheres of different sizes, three of them in a bent row.
fn irregular() -> Result<Clump, CheckError> {
    cluster(&[
        ([0.0, 0.0, 0.0], 1.0e-3),
        ([1.6e-3, 0.3e-3, 0.0], 0.8e-3),
        ([-1.1e-3, 0.9e-3, 0.4e-3], 0.7e-3),
        ([0.2e-3, -0.4e-3, 1.3e-3], 0.6e-3),
    ])
}

/// Two stiff sides without friction, so that a body hardly turns in a contact; without the amplitude the end is clipped.
fn stiff(restitution: f64) -> Result<InteractionSettings, CheckError> {
    let sides = [Material::new(0.25, 4e9)?; 2];
    Ok(clipped(surface(sides, [restitution, 0.0, 0.0])))
}

/// The restitution of a contact with a damping ratio below 1, of whose pull a share is kept.
fn returned(ratio: f64, pull: f64) -> f64 {
    let swing = (1.0 - ratio * ratio).sqrt();
    let turned = PI - (2.0 * ratio * swing).atan2(1.0 - 2.0 * ratio * ratio);
    let left = (-ratio * turned / swing).exp();
    // Where the force vanishes.
    let overlap = left * turned.sin() / swing;
    let speed = left * (turned.cos() - ratio * turned.sin() / swing);
    if pull == 0.0 {
        return -speed;
    }
    let decay = ratio * pull;
    let swing = (pull - decay * decay).sqrt();
    let across = (speed + decay * overlap) / swing;
    let turned = overlap.atan2(-across);
    let left = (-decay * turned / swing).exp();
    left * swing * (overlap * turned.sin() - across * turned.cos())
}

/// A fall of a body.
#[derive(Debug, Clone, Copy)]
struct Fall {
    /// Restitution put in.
    restitution: f64,
    /// Amplitude of the damping of the whole body.
    amplitude: f64,
}

/// Velocity of the centre (m/s) and spin times the bounding radius (m/s) after an impact.
#[derive(Debug, Clone, Copy)]
struct After {
    velocity: Vector3<f64>,
    turn: Vector3<f64>,
}

impl After {
    /// The larger difference of velocity and turn, m/s.
    fn difference(&self, other: &Self) -> f64 {
        let velocity = (self.velocity - other.velocity).norm();
        velocity.max((self.turn - other.turn).norm())
    }
}

/// The lowest sphere of a body that is turned, and the next.
fn lowest_two(body: &Clump, turn: &UnitQuaternion<f64>) -> [usize; 2] {
    let low = |k: &usize| bottom(body, turn, *k);
    let mut order: Vec<usize> = (0..body.spheres().len()).collect();
    order.sort_by(|a, b| low(a).total_cmp(&low(b)));
    [order[0], order[order.len().min(2) - 1]]
}

/// Height of the lowest point of a sphere of a body that is turned over the centre of the body, m.
fn bottom(body: &Clump, turn: &UnitQuaternion<f64>, sphere: usize) -> f64 {
    let sphere = &body.spheres()[sphere];
    (turn * sphere.centre).y - sphere.radius
}

impl Fall {
    /// What the solver gives for a body that is turned, and what the impulse says.
    fn outcome(&self, body: &Clump, turn: UnitQuaternion<f64>) -> Result<[After; 2], CheckError> {
        let [sphere, _] = lowest_two(body, &turn);
        let radius = body.spheres()[sphere].radius;
        let arm = turn * body.spheres()[sphere].centre - Vector3::y() * radius;
        let inertia = body.inertia();
        let spin_of = |impulse: f64| {
            let torque = turn.inverse() * arm.cross(&(Vector3::y() * impulse));
            turn * torque.component_div(&inertia)
        };
        let moved = 1.0 / (1.0 / body.mass() + spin_of(1.0).cross(&arm).y);
        let root =
            (1.0 - self.amplitude) * (body.fraction_mass(sphere) / moved).sqrt() + self.amplitude;
        let e = returned(damping_ratio(self.restitution) * root, self.amplitude);
        let impulse = (1.0 + e) * moved * SPEED;
        let reach = body.bounding_radius();
        let expected = After {
            velocity: Vector3::y() * (impulse / body.mass() - SPEED),
            turn: spin_of(impulse) * reach,
        };
        let start = Placement {
            orientation: turn,
            ..thrown(0, Vector3::y() * (1e-7 - arm.y), Vector3::y() * -SPEED)
        };
        let surface = stiff(self.restitution)?;
        let [own, other] = &surface.materials;
        let impact = hard_contact::Impact {
            speed: SPEED,
            ..hard_contact::Impact::usual(effective_moduli(own, other).young)
        };
        let step = hard_contact::duration(body.mass(), radius, &impact) / STEPS;
        let template = Template::new(body, 0, DashpotMass::Sphere);
        let further = OptionalLaws {
            pull: self.amplitude,
            ..OptionalLaws::default()
        };
        let mut world = World::new(
            settings(step, Vector3::zeros(), radius),
            vec![template.with_whole_damping(self.amplitude)],
            vec![Interaction::new(&surface)?.with(&further)],
            vec![floor()],
            &[start],
        )?;
        collide(&mut world, 40_000)?;
        let bodies = world.bodies();
        let got = After {
            velocity: bodies.velocity[0],
            turn: bodies.spin[0] * reach,
        };
        Ok([got, expected])
    }
}

/// Rows of falls: central ones of a row of spheres and one sphere, and of an irregular body in many ways.
pub(crate) fn falls() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "whole-seed-damping",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(1e-3),
        reason: "first order of 4000 steps in an elastic contact",
        source: "[AntypovElliott2011], [SchwagerPoschel2007]",
    };
    let mut rows = Vec::new();
    let upright = UnitQuaternion::identity();
    let ball = cluster(&[([0.0; 3], 1e-3)])?;
    let row = cluster(&[0.0, 1.5e-3, 3.0e-3].map(|y| ([0.0, y, 0.0], 1e-3)))?;
    for (name, body) in [("one sphere", &ball), ("three spheres on end", &row)] {
        // The principal axes of a row of spheres put it along one of them.
        let along = body.spheres()[0].centre;
        let turn = UnitQuaternion::rotation_between(&along, &-Vector3::y()).unwrap_or(upright);
        for restitution in [0.06, 0.13, 0.5] {
            for amplitude in [0.0, 0.5, 1.0] {
                let fall = Fall {
                    restitution,
                    amplitude,
                };
                let [got, expected] = fall.outcome(body, turn)?;
                let name = format!("{name}, restitution {restitution}, amplitude {amplitude}");
                rows.push(basis.row(
                    name,
                    "1",
                    expected.velocity.y / SPEED,
                    got.velocity.y / SPEED,
                ));
            }
        }
    }
    let of_impulse = Basis {
        reason: "first order of 4000 steps; the body turns while it touches",
        source: "impulse of a rigid body [Stronge2000]; [AntypovElliott2011], [SchwagerPoschel2007]",
        ..basis
    };
    let body = irregular()?;
    for restitution in [0.06, 0.5] {
        for amplitude in [0.0, 0.5, 1.0] {
            let fall = Fall {
                restitution,
                amplitude,
            };
            let mut worst = 0.0_f64;
            for turn in single_touches(&body) {
                let [got, expected] = fall.outcome(&body, turn)?;
                worst = worst.max(got.difference(&expected));
            }
            let name = format!(
                "{FALLS} ways to fall, restitution {restitution}, amplitude {amplitude}: worst of velocity and spin"
            );
            rows.push(of_impulse.row(name, "m/s", 0.0, worst));
        }
    }
    Ok(rows)
}

/// Orientations, spread over all, in which the second sphere stands so far back that it does not touch in the contact of the first.
fn single_touches(body: &Clump) -> impl Iterator<Item = UnitQuaternion<f64>> {
    let turned = |number: u32| {
        let part = |step: f64| 2.0 * PI * (f64::from(number) * step).fract();
        UnitQuaternion::from_euler_angles(part(0.7549), part(0.5698), part(0.4302))
    };
    let stands_back = |turn: &UnitQuaternion<f64>| {
        let [first, second] = lowest_two(body, turn).map(|k| bottom(body, turn, k));
        second - first > 3e-5
    };
    let all = (0..).map(turned).filter(stands_back);
    all.take(FALLS)
}
