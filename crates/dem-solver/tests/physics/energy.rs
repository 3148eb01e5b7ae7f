//! Energy of bodies that collide.

use crate::scene::{
    box_of_planes, plane, rough, run, scattered, seed_and_block_with, settings, smooth, sticky,
    world,
};
use dem_solver::{DashpotMass, InteractionSettings, Placement, Template, World};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;
use verification::worlds::asymmetric;

fn no_contact(world: &World) -> bool {
    world.census().sphere_contacts + world.n_wall_contacts() == 0
}

/// Change of the kinetic energy, relative, when an unsymmetrical body meets an elastic plane.
fn error_of_an_impact(time_step: f64, stream: &mut Stream) -> f64 {
    let template = Template::new(&asymmetric().expect("a body"), 0, DashpotMass::Body);
    let [w, i, j, k] = stream.rotation();
    let start = Placement {
        template: 0,
        position: Vector3::y() * stream.between(4.0e-3, 4.2e-3),
        orientation: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
        velocity: Vector3::new(0.1, -0.3, 0.05),
        spin: Vector3::from_fn(|_, _| stream.between(-50.0, 50.0)),
    };
    let walls = vec![plane(Vector3::zeros(), Vector3::y())];
    let settings = settings(time_step, Vector3::zeros());
    let mut world = world(settings, &smooth(), vec![template], walls, &[start]);
    let before = world.kinetic_energy();
    while world.time() < 0.02 || !no_contact(&world) {
        run(&mut world, 1);
    }
    assert!(world.bodies().velocity[0].y > 0.0, "no impact");
    world.kinetic_energy() / before - 1.0
}

/// The scheme keeps a smooth force's energy to second order; Hertz's force, which starts with the
/// power 3/2 of the overlap, adds a term of order 5/2 at the two ends of the contact. The mean
/// over 100 starts must fall with at least second order (half the step, a quarter of the error;
/// 0.2 of the order is the scatter of such means).
#[test]
fn energy_error_of_an_elastic_impact_falls_with_the_step() {
    let error = |time_step: f64| {
        let mut stream = Stream::new(6, "impact");
        let square = |_| error_of_an_impact(time_step, &mut stream).powi(2);
        ((0..100).map(square).sum::<f64>() / 100.0).sqrt()
    };
    let errors = [error(2e-5), error(1e-5), error(5e-6)];
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 1.8 && order < 3.0, "order {order} of {errors:?}");
    }
    // The contact lasts about 20 of the longest steps.
    assert!(errors[0] < 1e-3, "{errors:?}");
}

/// Bodies that fly through a box of walls and meet.
fn gas(surface: &InteractionSettings, time_step: f64) -> World {
    let starts = scattered([0.011; 3], 1.0, 0.5, &mut Stream::new(5, "gas"));
    let walls = box_of_planes(0.0125);
    let settings = settings(time_step, Vector3::zeros());
    let templates = seed_and_block_with(1.0, DashpotMass::Shared);
    world(settings, surface, templates, walls, &starts)
}

/// Highest and last kinetic energy of moments without contact, relative to the start, and the
/// highest rise between two such moments.
struct Ledger {
    highest: f64,
    last: f64,
    rise: f64,
}

fn ledger(mut world: World, seconds: f64) -> Ledger {
    let start = world.kinetic_energy();
    let mut ledger = Ledger {
        highest: 0.0,
        last: 1.0,
        rise: 0.0,
    };
    let (mut n_free, mut n_busy) = (0, 0);
    while world.time() < seconds {
        run(&mut world, 1);
        if no_contact(&world) {
            let energy = world.kinetic_energy() / start;
            ledger.rise = ledger.rise.max(energy - ledger.last);
            ledger.highest = ledger.highest.max(energy);
            ledger.last = energy;
            n_free += 1;
        } else {
            n_busy += 1;
        }
    }
    assert!(
        n_free > 1000 && n_busy > 1000,
        "{n_free} steps without contact, {n_busy} with"
    );
    ledger
}

/// Some hundred elastic impacts of the error above, at random signs.
#[test]
fn elastic_gas_keeps_its_energy() {
    let ledger = ledger(gas(&smooth(), 1e-5), 0.2);
    assert!(
        (ledger.last - 1.0).abs() < 2e-3,
        "energy {} of the start",
        ledger.last
    );
    assert!(
        ledger.highest < 1.0 + 2e-3,
        "energy up to {} of the start",
        ledger.highest
    );
}

/// Damping, sliding, rolling resistance and attraction only take energy: between moments without
/// any contact, which store nothing in springs, it never rises by more than the truncation of
/// the free rotation (second order, 1e-8 at this step).
#[test]
fn dissipative_gas_never_gains_energy() {
    let nearly_elastic = rough(0.95, 0.5);
    for surface in [sticky(), rough(0.5, 0.3), rough(0.06, 0.1), nearly_elastic] {
        let ledger = ledger(gas(&surface, 1e-5), 0.1);
        assert!(ledger.rise < 1e-7, "gains {} with {surface:?}", ledger.rise);
        assert!(
            ledger.last < 0.6,
            "loses too little with {surface:?}: {}",
            ledger.last
        );
    }
}
