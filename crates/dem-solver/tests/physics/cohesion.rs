//! Cohesion by the area of contact, in the world.

use crate::scene::{ball, interaction, material, plane, run, settings, smooth, sticky};
use contact_law::LinearCohesion;
use contact_law::material::effective_moduli;
use dem_solver::{
    EnergyLedger, Interaction, InteractionSettings, OptionalLaws, Placement, Wall, World,
};
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::PI;

const RADIUS: f64 = 1e-3;
const STEP: f64 = 2e-6;

/// Cohesion energy density, J/m³: an attraction near the weight of the ball at its overlap.
const DENSITY: f64 = 1e4;

/// Surfaces that hold each other by their area of contact alone.
fn by_area() -> Interaction {
    let without = InteractionSettings {
        attraction: 0.0,
        ..sticky()
    };
    interaction(&without).with(&OptionalLaws {
        linear_cohesion: LinearCohesion::new(DENSITY).ok(),
        ..OptionalLaws::default()
    })
}

/// Balls under gravity.
fn world(walls: Vec<Wall>, gravity: Vector3<f64>, heights: &[f64]) -> World {
    let starts: Vec<_> = heights
        .iter()
        .map(|&y| Placement::at_rest(0, Vector3::y() * y, UnitQuaternion::identity()))
        .collect();
    let template = ball(RADIUS);
    World::new(
        settings(STEP, gravity),
        vec![template],
        vec![by_area(); 4],
        walls,
        &starts,
    )
    .expect("possible")
}

/// Constants of the force of a contact of a reduced radius (m): `h d^(3/2)` repels, `c d` attracts.
fn constants(reduced_radius: f64) -> [f64; 2] {
    let young = effective_moduli(&material(), &material()).young;
    [
        4.0 / 3.0 * young * reduced_radius.sqrt(),
        2.0 * PI * reduced_radius * DENSITY,
    ]
}

/// A ball at rest on a floor, and one on another that is held by the floor: at each contact Hertz's force carries the weight above
/// it and the attraction. After 0.5 s the dashpots have taken all motion: what remains is rounding of a sum over the steps.
#[test]
fn a_contact_at_rest_carries_weight_and_attraction() {
    let gravity = 9.81;
    let floor = vec![plane(Vector3::zeros(), Vector3::y())];
    let mut world = world(floor, Vector3::y() * -gravity, &[RADIUS, 3.0 * RADIUS]);
    run(&mut world, 250_000);
    let weight = ball(RADIUS).mass() * gravity;
    let heights: Vec<f64> = world.bodies().position.iter().map(|p| p.y).collect();
    for (overlap, reduced_radius, load) in [
        (RADIUS - heights[0], RADIUS, 2.0 * weight),
        (
            2.0 * RADIUS - (heights[1] - heights[0]),
            0.5 * RADIUS,
            weight,
        ),
    ] {
        let [h, c] = constants(reduced_radius);
        let carried = h * overlap.powf(1.5) - c * overlap;
        assert!(
            c * overlap > 0.2 * load,
            "hardly an attraction: {overlap} m"
        );
        assert!(
            (carried / load - 1.0).abs() < 1e-6,
            "{carried} N for {load} N"
        );
    }
}

/// The largest pull that a contact carries is `4 c³ / (27 h²)`: a ball hangs from a ceiling against nine tenths of that, and falls
/// from eleven.
#[test]
fn a_contact_parts_at_its_largest_pull() {
    let [h, c] = constants(RADIUS);
    let most = 4.0 * c.powi(3) / (27.0 * h * h);
    let deepest = (2.0 * c / (3.0 * h)).powi(2);
    for (share, hangs) in [(0.9, true), (1.1, false)] {
        let gravity = share * most / ball(RADIUS).mass();
        let ceiling = vec![plane(Vector3::zeros(), -Vector3::y())];
        let mut world = world(ceiling, Vector3::y() * -gravity, &[deepest - RADIUS]);
        run(&mut world, 500_000);
        assert_eq!(
            world.n_wall_contacts() == 1,
            hangs,
            "at {share} of the largest pull"
        );
    }
}

/// The attraction belongs to the energy of a contact: while a ball without damping meets a floor, slowly enough for the attraction
/// to be a good part of the force, motion and contact share one energy. The scheme is of second order with a thousand steps in the
/// contact, hence 1e-5.
#[test]
fn energy_of_an_impact_holds_the_attraction() {
    let elastic = interaction(&smooth()).with(&OptionalLaws {
        linear_cohesion: LinearCohesion::new(DENSITY).ok(),
        ..OptionalLaws::default()
    });
    let start = Placement {
        velocity: Vector3::y() * -0.01,
        ..Placement::at_rest(
            0,
            Vector3::y() * 1.000_01 * RADIUS,
            UnitQuaternion::identity(),
        )
    };
    let floor = vec![plane(Vector3::zeros(), Vector3::y())];
    let settings = settings(5e-7, Vector3::zeros());
    let mut world = World::new(
        settings,
        vec![ball(RADIUS)],
        vec![elastic; 4],
        floor,
        &[start],
    )
    .expect("possible");
    let mut ledger = EnergyLedger::default();
    ledger.step(&mut world).expect("booked");
    let first = ledger.terms().kinetic;
    let (mut most, mut touched) = (0.0_f64, 0);
    for _ in 0..4000 {
        ledger.step(&mut world).expect("booked");
        let terms = ledger.terms();
        most = most.max((terms.kinetic + terms.elastic - first).abs() / first);
        touched += usize::from(world.n_wall_contacts() > 0);
    }
    assert!(touched > 500, "{touched} steps of contact");
    assert!(most < 1e-5, "the energy changes by {most}");
}
