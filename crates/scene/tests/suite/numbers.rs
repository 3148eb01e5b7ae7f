//! Defaults of a short scene, numbers by their path, and all problems at once.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use crate::coarse;
use dev_support::fixture_files::fixture;
use scene::{FillingLibrary, Override, Scene, run};
use std::path::Path;

/// The study's drum as its file has it.
fn drum() -> Scene {
    let file = fixture("cotton/drum.toml");
    Scene::read(&file, &[]).unwrap()
}

/// Without model, protocol and camera a scene has the declared defaults, and states them all when written.
#[test]
fn a_short_scene_states_its_defaults() {
    let text = r#"
        [apparatus]
        kind = "heap"
        inner_diameter = "60 mm"
        height = "100 mm"
        lift_speed = "50 mm/s"
        floor = "pea"
        cylinder = "pea"
        [[seed]]
        name = "pea"
        sphere = "6 mm"
        density = "1250 kg/m3"
        count = 10
        material = "pea"
        [material.pea]
        poisson_ratio = 0.3
        shear_modulus = "5 MPa"
        [contact.pea-pea]
        restitution = 0.5
        static_friction = 0.4
    "#;
    let scene = Scene::from_text(text, "heap.toml", Path::new("."), &[]).unwrap();
    for (path, value) in [
        ("contact.pea-pea.rolling_friction", 0.0),
        ("model.bond_number", 0.0),
        ("model.gravity_m_s2", 9.81),
        ("camera.pixels", 480.0),
        ("protocol.frames", 10.0),
        ("protocol.step_share", scene.protocol.step_share),
    ] {
        assert_eq!(scene.number(path), Some(value), "{path}");
    }
    let written = toml::to_string(&scene).unwrap();
    for stated in [
        "settle_limit = \"0.8 s\"",
        "rotation_limit = \"6 s\"",
        "frame_interval = \"0.2 s\"",
        "roll = \"0 rad\"",
        "dashpot_mass = \"sphere\"",
        "normal_force_end = \"clipped\"",
        "rolling_law = \"constant-torque\"",
        "rolling_lever = \"centre\"",
    ] {
        assert!(written.contains(stated), "{stated} is not in {written}");
    }
}

/// Numbers set by path are those that text sets, with and without unit, to the last bit.
#[test]
fn numbers_go_in_and_out_by_their_path() {
    let scene = drum();
    let path = "contact.seed-seed.static_friction";
    assert_eq!(scene.number(path), Some(0.1));
    assert_eq!(
        scene.number("apparatus.speed"),
        None,
        "a quantity has a unit"
    );
    assert_eq!(scene.number("no.such.thing"), None);
    let change = Override::number;
    let value = 0.1 + 0.2;
    let changed = scene
        .with(&[
            change(path, value, None),
            change("seed.0.count", 50.0, None),
            change("apparatus.speed", 15.0, Some("rpm")),
            change("protocol.start_up", 2.0, Some("s")),
        ])
        .unwrap();
    assert_eq!(changed.number(path), Some(value));
    let text = Override::new;
    let by_text = scene
        .with(&[
            text(path, &value.to_string()),
            text("seed.0.count", "50"),
            text("rpm", "15"),
            text("protocol.start_up", "2 s"),
        ])
        .unwrap();
    assert_eq!(changed, by_text);
    for (change, words) in [
        (change(path, -0.1, None), vec!["friction"]),
        (
            change("seed.0.count", 1.5, None),
            vec!["seed.0.count", "whole"],
        ),
        (
            change("apparatus.speed", 1.5, None),
            vec!["apparatus.speed", "unit"],
        ),
        (change(path, 1.5, Some("rpm")), vec![path, "without unit"]),
        (change("apparatus.speed", 1.5, Some("mm")), vec!["mm"]),
        (change("no.such.thing", 1.5, None), vec!["no.such.thing"]),
    ] {
        let told = scene
            .with(std::slice::from_ref(&change))
            .unwrap_err()
            .to_string();
        for word in words {
            assert!(told.contains(word), "'{word}' is not in '{told}'");
        }
    }
}

/// Four mistakes in four sections are reported together, each with its file.
#[test]
fn all_problems_are_reported_at_once() {
    let mut scene = drum();
    scene.camera.pixels = 1;
    scene.protocol.frames = 0;
    scene.model.gravity_m_s2 = -1.0;
    scene.contact.remove("seed-seed");
    let told: Vec<_> = scene.problems().iter().map(ToString::to_string).collect();
    assert_eq!(told.len(), 4, "{told:?}");
    assert!(told.iter().all(|t| t.contains("drum.toml")), "{told:?}");
    assert!(scene.check().is_err());
    assert!(drum().problems().is_empty());
    // A file is read with the same list.
    let file = fixture("cotton/drum.toml");
    let changes =
        [("camera.pixels", "1"), ("protocol.frames", "0")].map(|(name, value)| Override {
            name: name.into(),
            value: value.into(),
        });
    assert_eq!(Scene::read_all(&file, &changes).unwrap_err().len(), 2);
    assert_eq!(Scene::read_all(&file, &[]).unwrap(), drum());
}

/// A stated start-up of 1 s puts every frame behind it, where the series alone would have taken earlier ones.
#[test]
fn no_frame_counts_before_the_start_up() {
    let changes = [
        ("apparatus.inner_diameter", "70 mm"),
        ("apparatus.speed", "20 rpm"),
        ("seed.0.count", "34"),
        ("seed.1.count", "6"),
        ("protocol.frames", "3"),
        ("protocol.frame_interval", "0.1 s"),
    ];
    let first = |start_up: Option<&str>| {
        let mut scene = coarse::drum(&changes);
        scene.protocol.start_up = start_up.map(|t| t.parse().unwrap());
        run(&scene, &FillingLibrary::default(), 1).unwrap().frames[0].time
    };
    let (plain, late) = (first(None), first(Some("2 s")));
    assert!(plain < 1.9, "the series alone: {plain}");
    assert!(late >= 2.0, "{late}");
}
