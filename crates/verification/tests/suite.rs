//! Every row of the verification table passes; `seedloop verify` writes the same rows.

use verification::{Kind, page, run, suite};

fn all_pass(names: &[&str]) {
    let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
    let rows = run(&names, |_| {}).expect("the checks can be done");
    assert!(!rows.is_empty(), "no rows");
    for row in &rows {
        assert!(row.passes(), "{row:?}");
    }
}

/// One test a check, so that they run side by side and a failure has a name.
macro_rules! checks {
    ($($test:ident: $name:literal),* $(,)?) => {
        $(#[test] fn $test() { all_pass(&[$name]); })*
        const NAMES: &[&str] = &[$($name),*];
    };
}

checks! {
    elastic_impacts_follow_hertz: "chung-ooi-1-2",
    restitution_comes_back: "chung-ooi-3",
    oblique_impacts_follow_the_impulse: "chung-ooi-4-5",
    spinning_impacts_follow_the_impulse: "chung-ooi-6-8",
    oblique_impacts_follow_the_curve_of_maw: "maw",
    restitution_does_not_depend_on_speed: "restitution-speed",
    restitution_trap_is_what_the_law_says: "restitution-trap",
    thrown_ball_ends_at_five_sevenths: "slip-to-roll",
    balls_on_inclines_follow_newton: "incline",
    rolling_resistance_takes_the_arm_that_is_stated: "rolling-lever",
    free_rotation_follows_euler: "free-rotation",
    gravity_does_not_count_spheres: "gravity-overlap",
    rebound_does_not_count_spheres: "rebound-sphere-count",
    whole_seeds_rebound_as_rigid_bodies: "whole-seed-damping",
    energy_ledger_closes: "energy-ledger",
    mesh_walls_are_analytic_walls: "mesh-wall",
    moving_walls_carry_bodies: "moving-wall",
    bonded_chain_is_a_beam: "bond-beam",
    small_grains_pass_between_large_ones: "size-ratio",
    laws_have_their_closed_forms: "laws",
    bridges_of_liquid_hold_and_resist: "liquid-bridge",
    same_input_gives_the_same_bits: "determinism",
}

#[test]
fn every_check_has_a_test() {
    let names: Vec<_> = suite().iter().map(|c| c.name).collect();
    assert_eq!(names, NAMES);
}

#[test]
fn unknown_check_is_answered_with_the_names() {
    let error = run(&["rolling".to_owned()], |_| {}).expect_err("no such check");
    let text = error.to_string();
    assert!(
        text.contains("'rolling'") && text.contains("slip-to-roll"),
        "{text}"
    );
}

#[test]
fn page_has_one_line_a_check_with_its_rows_kind_and_verdict() {
    let rows = run(&["laws".to_owned()], |_| {}).expect("the check can be done");
    let text = page(&rows);
    let line = format!("| laws | {} | {} |", rows.len(), Kind::Analytical.word());
    assert!(text.contains(&line), "{text}");
    assert_eq!(text.matches("PASS |").count(), 1, "{text}");
}
