//! Two spheres that meet off the centre, beside LIGGGHTS: in a thick liquid, and with cohesion by the area of contact.
//!
//! What LIGGGHTS 3.8 gave for the decks of `fixtures/liggghts-pairs` is kept here, and every test run holds the solver to it.
//! `trials/programs.sh liggghts-pairs` runs LIGGGHTS itself.

use contact_law::{CapillaryBridge, LinearCohesion, NormalForceEnd, ViscousBridge};
use dem_solver::{Interaction, InteractionSettings, OptionalLaws, World};
use dev_support::fixture_files::fixture;
use nalgebra::Vector3;
use std::process::Command;
use verification::worlds::{DENSITY, RADIUS, ball, elastic, settings, surface, thrown};

/// Velocity (m/s) and spin about z (rad/s) of a sphere.
type State = [f64; 3];

/// The first sphere of `in.liquid` after 2, 4 and 6 ms.
const LIQUID: [State; 3] = [
    [-0.0732533081726, 0.0791489826714, -5.98134074984],
    [-0.0651339172266, 0.0740935611238, -8.77557241984],
    [-0.0610890379387, 0.0711954749084, -10.3593180518],
];

/// That of `in.cohesion` after 0.5 ms, in the contact, and after 1 ms, behind it.
const COHESION: [State; 2] = [
    [-0.014794639418, 0.0385072915952, -36.9444973152],
    [-0.189378473482, 0.104633142128, -13.182107158],
];

/// The first of two spheres with these laws after each of so many spans of so many steps of 0.1 us.
fn states<const N: usize>(
    (static_friction, end): (f64, NormalForceEnd),
    further: &OptionalLaws,
    steps: usize,
) -> [State; N] {
    let material = elastic(1e7, 0.25).expect("elastic constants");
    let sides = InteractionSettings {
        end,
        ..surface([material; 2], [0.9, static_friction, 0.0])
    };
    let surface = Interaction::new(&sides).expect("a surface").with(further);
    // So much that the bridge is a sea, as LIGGGHTS takes it.
    let ball = ball(RADIUS, DENSITY).expect("a sphere").with_liquid(1e-2);
    let start = |x: f64, y: f64| {
        let velocity = Vector3::x() * (-0.25 * x.signum());
        thrown(0, Vector3::new(x, y, 0.0), velocity)
    };
    let settings = settings(1e-7, Vector3::zeros(), RADIUS);
    let starts = [start(-0.00201, 0.001), start(0.00201, 0.0)];
    let mut world =
        World::new(settings, vec![ball], vec![surface], vec![], &starts).expect("a world");
    [(); N].map(|()| {
        for _ in 0..steps {
            world.step().expect("steps");
        }
        let bodies = world.bodies();
        let velocity = bodies.velocity[0];
        [velocity.x, velocity.y, bodies.spin[0].z]
    })
}

/// The viscous forces along the normal and the surface, their torque and the contact within are those of LIGGGHTS. It takes
/// the radius as the arm if there is a gap, here it reaches to the middle of the gap, up to 0.45 mm farther:
/// that is what the tolerances are for, 1 % of the first velocity and 8 % of the last spin. Without liquid the
/// velocities are off by more than ten times as much.
#[test]
fn a_viscous_bridge_moves_two_spheres_as_in_liggghts() {
    let states = |viscosity: f64| -> [State; 3] {
        let viscous = ViscousBridge::new(viscosity, 1e-5).expect("a liquid");
        let bridge = CapillaryBridge::new(0.0, 0.0).expect("no tension");
        let bridge = bridge
            .between(RADIUS)
            .with_viscosity(viscous.between(RADIUS));
        let further = OptionalLaws {
            bridge: Some(bridge),
            ..OptionalLaws::default()
        };
        states((0.0, NormalForceEnd::Attractive), &further, 20_000)
    };
    let found = states(0.02);
    for (found, kept) in found.iter().zip(LIQUID) {
        for k in 0..2 {
            let error = (found[k] - kept[k]).abs();
            assert!(error < 0.0025, "{found:?} m/s, LIGGGHTS {kept:?}");
        }
        let error = (found[2] - kept[2]).abs();
        assert!(error < 0.08 * 10.4, "{found:?} rad/s, LIGGGHTS {kept:?}");
    }
    let dry = states(0.0)[0];
    assert!((dry[0] - LIQUID[0][0]).abs() > 0.025, "{dry:?}");
}

/// The attraction by the area of contact, and the friction beside it, are those of SJKR in LIGGGHTS, which takes the exact area of
/// the circle of intersection: the one here is 0.7 % larger at the deepest point. Hence 1 % of the velocity of approach and of the
/// largest spin; without cohesion the spin behind the contact is half of what it is with it.
#[test]
fn cohesion_by_area_moves_two_spheres_as_in_liggghts() {
    let states = |density: f64| -> [State; 2] {
        let further = OptionalLaws {
            linear_cohesion: LinearCohesion::new(density).ok(),
            ..OptionalLaws::default()
        };
        states((0.4, NormalForceEnd::Clipped), &further, 5000)
    };
    for (found, kept) in states(1e5).iter().zip(COHESION) {
        for (k, tolerance) in [0.005, 0.005, 0.37].into_iter().enumerate() {
            let error = (found[k] - kept[k]).abs();
            assert!(error < tolerance, "{found:?}, LIGGGHTS {kept:?}");
        }
    }
    let without = states(0.0)[1];
    assert!((without[2] - COHESION[1][2]).abs() > 5.0, "{without:?}");
}

/// LIGGGHTS still gives what is kept, to the printed digits of single steps of 1e-7 s.
#[test]
#[ignore = "runs LIGGGHTS; `trials/programs.sh liggghts-pairs`"]
fn liggghts_gives_what_is_kept() {
    for (deck, kept) in [("in.liquid", &LIQUID[..]), ("in.cohesion", &COHESION[..])] {
        let deck = fixture(&format!("liggghts-pairs/{deck}"));
        let folder = tempfile::tempdir().expect("a folder");
        let run = Command::new("liggghts")
            .arg("-in")
            .arg(deck.canonicalize().expect("the deck"))
            .current_dir(folder.path())
            .output()
            .expect("LIGGGHTS starts");
        assert!(
            run.status.success(),
            "{}",
            String::from_utf8_lossy(&run.stderr)
        );
        let dump = std::fs::read_to_string(folder.path().join("liggghts.dump")).expect("a dump");
        let first = dump
            .lines()
            .filter(|line| line.starts_with("1 ") && line.split(' ').count() > 9);
        let states: Vec<State> = first
            .map(|line| {
                let numbers: Vec<f64> = line
                    .split_whitespace()
                    .map(|n| n.parse().unwrap())
                    .collect();
                [numbers[4], numbers[5], numbers[9]]
            })
            .collect();
        assert_eq!(states.len(), 4, "{dump}");
        for (state, kept) in states[1..].iter().zip(kept) {
            let error = (0..3).map(|k| (state[k] / kept[k] - 1.0).abs());
            assert!(error.fold(0.0, f64::max) < 1e-6, "{state:?}, kept {kept:?}");
        }
    }
}
