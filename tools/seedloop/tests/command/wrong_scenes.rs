//! Invalid scenes: each message names the place and the remedy.

use crate::assert_error;
use crate::tiny_scene::TinyScene;
use std::fs;

/// Number of the line in which the scene holds a text, from 1.
fn line_of(scene: &TinyScene, text: &str) -> String {
    let file = fs::read_to_string(scene.path("tiny.toml")).unwrap();
    let line = file.lines().position(|line| line.contains(text)).unwrap() + 1;
    format!("line {line}")
}

#[test]
fn an_unknown_key_is_named_with_its_line() {
    let scene = TinyScene::changed("pixels = 480", "pixels = 480\nzoom = 2");
    let line = line_of(&scene, "zoom");
    assert_error(
        &scene.simulate(&[]),
        &["tiny.toml", &line, "zoom", "pixels"],
    );
}

#[test]
fn a_negative_friction_is_named_with_its_line() {
    let scene = TinyScene::changed("static_friction = 0.33", "static_friction = -0.33");
    let line = line_of(&scene, "-0.33");
    assert_error(&scene.simulate(&[]), &["tiny.toml", &line, "-0.33"]);
}

#[test]
fn a_restitution_above_1_is_named_with_its_line() {
    let scene = TinyScene::changed("restitution = 0.13", "restitution = 1.5");
    let line = line_of(&scene, "1.5");
    assert_error(
        &scene.simulate(&[]),
        &["tiny.toml", &line, "1.5", "restitution"],
    );
}

#[test]
fn a_unit_of_the_wrong_kind_is_named_with_its_line() {
    let scene = TinyScene::changed("mass = \"94.5 mg\"", "mass = \"94.5 mm\"");
    let line = line_of(&scene, "94.5 mm");
    assert_error(
        &scene.simulate(&[]),
        &["tiny.toml", &line, "94.5 mm", "mass"],
    );
}

/// The kind of the apparatus decides its keys, so the section is named instead of the line.
#[test]
fn a_unit_of_the_wrong_kind_in_the_apparatus_is_named_with_its_value() {
    let scene = TinyScene::changed("\"70 mm\"", "\"70 mg\"");
    assert_error(
        &scene.simulate(&[]),
        &["tiny.toml", "[apparatus]", "70 mg", "length"],
    );
}

#[test]
fn a_missing_contact_names_the_file_and_the_section_to_add() {
    let section = "[contact.seed-clear_resin]\nrestitution = 0.12\nstatic_friction = 0.29\n\
                   rolling_friction = 0.0\n";
    let scene = TinyScene::changed(section, "");
    assert_error(
        &scene.simulate(&[]),
        &["tiny.toml", "[contact.seed-clear_resin]"],
    );
}

#[test]
fn an_empty_mesh_is_named() {
    let scene = TinyScene::changed("FIXTURES/cotton_flat.stl", "empty.stl");
    fs::write(scene.path("empty.stl"), "").unwrap();
    assert_error(&scene.simulate(&[]), &["empty.stl", "empty"]);
}

#[test]
fn a_missing_mesh_or_scene_is_named() {
    let scene = TinyScene::changed("FIXTURES/cotton_flat.stl", "nowhere.stl");
    assert_error(&scene.simulate(&[]), &["nowhere.stl"]);
    fs::remove_file(scene.path("tiny.toml")).unwrap();
    assert_error(&scene.simulate(&[]), &["tiny.toml"]);
}

#[test]
fn an_unknown_setting_is_answered_with_settings_of_a_like_name() {
    let scene = TinyScene::new();
    let output = scene.simulate(&["--set", "contact.seed-sand.static_friction=0.2"]);
    assert_error(
        &output,
        &[
            "contact.seed-sand.static_friction",
            "contact.seed-seed.static_friction",
        ],
    );
}

#[test]
fn an_ambiguous_short_name_is_answered_with_its_meanings() {
    let output = TinyScene::new().simulate(&["--set", "restitution=0.2"]);
    assert_error(&output, &["contact.seed-seed.restitution", "whole path"]);
}

#[test]
fn a_setting_without_a_value_is_an_error_of_usage() {
    assert_error(
        &TinyScene::new().simulate(&["--set", "rpm"]),
        &["NAME=VALUE"],
    );
    assert_error(
        &TinyScene::new().simulate(&["--set", "rpm="]),
        &["NAME=VALUE"],
    );
}

#[test]
fn a_setting_that_cannot_be_meant_is_refused_as_in_the_file() {
    let scene = TinyScene::new();
    let friction = "contact.seed-seed.static_friction";
    for value in ["-0.1", "nan", "inf", "much"] {
        assert_error(
            &scene.simulate(&["--set", &format!("{friction}={value}")]),
            &["tiny.toml"],
        );
    }
    assert_error(
        &scene.simulate(&["--set", "seed.0.count=2.5"]),
        &["tiny.toml", "2.5"],
    );
}

/// A step of 0.1 ms samples a swing of 5 kHz twice: what the seeds feel would be another frequency.
#[test]
fn a_vibration_too_fast_for_the_time_step_is_refused() {
    let scene = TinyScene::changed(
        "[model]",
        "[surroundings.vibration]\namplitude = [\"0 mm\", \"0.1 mm\", \"0 mm\"]\nfrequency = \"5 kHz\"\n\n[model]",
    );
    assert_error(
        &scene.simulate(&[]),
        &["vibration.frequency", "20 time steps"],
    );
}

#[test]
fn a_step_share_above_1_is_refused() {
    let scene = TinyScene::changed("[protocol]", "[protocol]\nstep_share = 1.5");
    assert_error(
        &scene.simulate(&[]),
        &["tiny.toml", "step_share", "1.5", "at most 1"],
    );
}

/// Two walls of one name would take each other's motion.
#[test]
fn two_walls_of_one_name_are_refused() {
    let wall = "[[wall]]\nname = \"plate\"\nmesh = \"FIXTURES/cotton_flat.stl\"\nmesh_unit = \"mm\"\nmaterial = \"tough_resin\"\n\n";
    let scene = TinyScene::changed("[model]", &format!("{wall}{wall}[model]"));
    assert_error(&scene.simulate(&[]), &["wall.name", "plate", "its own"]);
}

/// A fixed step of 0.2 ms is twice what a hard contact of these seeds allows, and is not shortened in
/// silence; one of 0.01 ms is taken as it is.
#[test]
fn a_time_step_too_long_for_a_hard_contact_is_refused() {
    let scene = TinyScene::changed("[protocol]", "[protocol]\ntime_step = \"0.2 ms\"");
    assert_error(
        &scene.simulate(&[]),
        &[
            "tiny.toml",
            "protocol.time_step",
            "0.0002",
            "at most",
            "step_share",
        ],
    );
    let scene = TinyScene::changed("[protocol]", "[protocol]\nflow_step_share = -0.1");
    assert_error(
        &scene.simulate(&[]),
        &["flow_step_share", "-0.1", "above 0"],
    );
}
