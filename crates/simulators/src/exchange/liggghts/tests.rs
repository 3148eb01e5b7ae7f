//! What decks for LIGGGHTS say, and what they refuse.

use super::seeds::primes_from;
use super::{Start, check, deck, setup};
use crate::exchange::drum_deck::first_of;
use contact_law::RollingLever;
use dev_support::fixture_files::fixture;
use input::quantity::FrictionCoefficient;
use nalgebra::Vector3;
use scene::{FillingLibrary, Scene, starting_frame};

fn drum() -> Scene {
    let file = fixture("cotton/drum.toml");
    Scene::read(&file, &[]).unwrap()
}

/// What it stops at when it reads a deck is refused or declared in the deck: soft seeds, and restitutions of 0.05 or less. These
/// spheres have the mass of their body.
#[test]
fn what_it_would_stop_at_is_refused_or_told() {
    let deck_of = |changes: &[(&str, &str)]| {
        let set = changes.iter().map(|(name, value)| scene::Override {
            name: (*name).into(),
            value: (*value).into(),
        });
        let set: Vec<_> = set.collect();
        let scene = Scene::read(&fixture("peers-study/spheres.toml"), &set).unwrap();
        let (start, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        let deck = deck(&scene, &bodies, &start, step, 1).map(|files| files[0].text.clone());
        // This much needs no body, and is checked before one is made.
        assert_eq!(check(&scene).is_ok(), deck.is_ok());
        deck
    };
    let hard = deck_of(&[]).unwrap();
    assert!(!hard.contains("soft_particles"), "{hard}");
    let soft = deck_of(&[("material.bead.shear_modulus", "1 MPa")]).unwrap();
    assert!(
        soft.contains("hard_particles yes\nsoft_particles yes\n"),
        "{soft}"
    );
    for (name, value, word) in [
        ("contact.bead-bead.restitution", "0.02", "restitution 0.02"),
        (
            "material.bead.poisson_ratio",
            "-0.2",
            "Poisson's ratio -0.2",
        ),
    ] {
        let told = deck_of(&[(name, value)]).unwrap_err().to_string();
        assert!(told.contains(word) && told.contains("LIGGGHTS"), "{told}");
    }
}

/// Values by hand for the study's drum: `E = 2 G (1 + nu)` = 9.1428e6 Pa; 10 rpm. Restitution 0.06 has b = 0.66713;
/// with the mass of one of 146 or 127 spheres, a mean of 0.0069723 of a seed, b is 0.05571, which is a
/// restitution of 0.8392. The numbers of the seeds stay.
#[test]
fn deck_carries_the_study_s_drum() {
    let scene = drum();
    let (start, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let files = deck(&scene, &bodies, &start, step, 1).unwrap();
    let names: Vec<_> = files.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(
        names,
        ["in.drum", "cover.stl", "seed1.spheres", "seed2.spheres"]
    );
    let text = &files[0].text;
    let number = |line: &str, word: usize| -> f64 {
        let line = text.lines().find(|l| l.starts_with(line)).unwrap();
        line.split_whitespace().nth(word).unwrap().parse().unwrap()
    };
    let near = |got: f64, expected: f64| {
        assert!((got / expected - 1.0).abs() < 1e-3, "{got} for {expected}");
    };
    near(number("fix young", 6), 9.1428e6);
    near(number("fix friction", 7), 0.10);
    near(number("fix restitution", 7), 0.8392);
    near(number("fix shell", 17), 10.0 * std::f64::consts::TAU / 60.0);
    for count in ["nparticles 1056 ", "nparticles 144 "] {
        assert!(text.contains(count), "{count} is missing");
    }
}

/// A start from a frame puts in each seed once, where it is and as fast. LIGGGHTS takes the place for that of the
/// centre of the spheres at the surface, so the centre of mass is found back from all of them: the spheres of a
/// kind have one size, and those of the packings here overlap by nothing. Places are written to 1e-10 m.
#[test]
fn seeds_of_a_frame_keep_their_places_and_motion() {
    let scene = drum();
    let (mut frame, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    for i in 0..frame.position.len() {
        frame.velocity[i] = Vector3::new(0.1 * i as f64, -0.2, 0.3);
        frame.spin[i] = Vector3::new(1.0, 2.0 * i as f64, -3.0);
    }
    let text = setup(&scene, &bodies, Start::Frame(&frame), step)
        .unwrap()
        .swap_remove(0)
        .text;
    let numbers = |line: &str, behind: &str, n: usize| -> Vec<f64> {
        let (_, rest) = line.split_once(behind).unwrap();
        let words = rest.split_whitespace().take(n);
        words.map(|word| word.parse().unwrap()).collect()
    };
    let starting = |with: &str| {
        let lines: Vec<&str> = text.lines().filter(|l| l.starts_with(with)).collect();
        lines
    };
    let places = starting("region place");
    let puts = starting("fix put");
    assert_eq!([places.len(), puts.len()], [2 * 1200, 1200]);
    for i in [0, 1, 700, 1199] {
        let box_of = numbers(places[i], " block ", 6);
        let at = Vector3::from_fn(|axis, _| 0.5 * (box_of[2 * axis] + box_of[2 * axis + 1]));
        let spheres = bodies[frame.kind[i]].outer.spheres();
        let centres = spheres.iter().map(|s| frame.orientation[i] * s.centre);
        let centroid = centres.sum::<Vector3<f64>>() / spheres.len() as f64;
        let error = (at - centroid - frame.position[i]).norm();
        assert!(error < 1e-9, "seed {i} is {error} m away");
        assert_eq!(
            numbers(puts[i], "vel constant ", 3),
            frame.velocity[i].as_slice()
        );
        assert_eq!(
            numbers(puts[i], "omega constant ", 3),
            frame.spin[i].as_slice()
        );
        let q = frame.orientation[i];
        assert_eq!(
            numbers(puts[i], "orientation constant ", 4),
            [q.w, q.i, q.j, q.k]
        );
        let kind = format!("distributiontemplate kind{} ", frame.kind[i] + 1);
        assert!(puts[i].contains(&kind), "{kind}: {}", puts[i]);
    }
}

/// With the arm of the sphere, which is LIGGGHTS' own, the coefficient goes out as it is; with that of the body it
/// grows by the mean of arm over radius: the mean seed is 4.5 to 9.3 mm across, so that a surface sphere of 0.45 mm has its
/// contact at an arm of 5.0 to 10.3 radii.
#[test]
fn rolling_friction_goes_out_for_the_arm_of_the_sphere() {
    let mut scene = drum();
    for contact in scene.contact.values_mut() {
        contact.rolling_friction = FrictionCoefficient::new(0.1).unwrap();
    }
    let (start, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let greatest = |lever: RollingLever| -> f64 {
        let mut scene = scene.clone();
        scene.model.rolling_lever = lever;
        let files = deck(&scene, &bodies, &start, step, 1).unwrap();
        let line = files[0].text.lines().find(|l| l.contains("fix rolling "));
        let words = line.unwrap().split_whitespace().skip(7);
        words.map(|w| w.parse().unwrap()).fold(0.0, f64::max)
    };
    assert_eq!(greatest(RollingLever::Sphere), 0.1);
    let of_body = greatest(RollingLever::Centre);
    assert!((0.50..1.03).contains(&of_body), "{of_body}");
}

/// Cohesion of the seeds among themselves goes out for their pair, 0 for the walls, and the model is on in all contacts; a scene
/// without it names no cohesion.
#[test]
fn cohesion_by_area_goes_out_as_sjkr() {
    let mut scene = drum();
    let (start, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let deck = |scene: &Scene| {
        deck(scene, &bodies, &start, step, 1).unwrap()[0]
            .text
            .clone()
    };
    assert!(!deck(&scene).contains("cohesion"));
    let own = scene.contact.get_mut("seed-seed").unwrap();
    own.cohesion_energy_density_j_m3 = Some(4e3);
    let text = deck(&scene);
    assert_eq!(
        text.matches("tangential history cohesion sjkr").count(),
        3,
        "{text}"
    );
    let line = text.lines().find(|l| l.contains("fix cohesion ")).unwrap();
    let words = line.split_whitespace().skip(7);
    let numbers: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
    assert_eq!(numbers[0], 4e3);
    assert!(numbers[1..].iter().all(|k| *k == 0.0), "{line}");
}

#[test]
fn what_liggghts_would_run_otherwise_is_refused() {
    let scene = drum();
    let (start, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let mut shared = scene.clone();
    shared.model.dashpot_mass = dem_solver::DashpotMass::Shared;
    let mut mixed = scene;
    mixed.model.whole_seed_damping = 0.25;
    let refused = [
        (shared, "shares the mass"),
        (mixed, "whole-seed damping of 0.25"),
    ];
    for (scene, word) in refused {
        let error = deck(&scene, &bodies, &start, step, 1)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(word) && error.contains("LIGGGHTS"),
            "{error}"
        );
    }
}

/// LIGGGHTS reads signed 32-bit numbers: no seed of a loop exceeds them, and no two of a thousand share their first primes.
#[test]
fn primes_of_any_seed_are_numbers_that_liggghts_reads() {
    let seeds = (0..500).chain(5_000_000..5_000_500).chain([u64::MAX]);
    let mut firsts: Vec<u64> = seeds.map(first_of).collect();
    assert!(firsts.iter().all(|first| *first < 2_147_000_000));
    firsts.sort_unstable();
    assert!(firsts.windows(2).all(|w| w[1] - w[0] > 500), "they overlap");
}

#[test]
fn primes_are_primes() {
    let found: Vec<u64> = primes_from(10_007).take(3).collect();
    assert_eq!(found, [10_007, 10_009, 10_037]);
}
