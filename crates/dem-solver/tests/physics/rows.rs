//! The rows of the verification table, of which `seedloop verify` writes the page.

use verification::{run, suite};

/// One test a check, so that they run side by side and a failure has a name.
macro_rules! checks {
    ($($test:ident: $name:literal),* $(,)?) => {
        $(#[test]
        fn $test() {
            let rows = run(&[$name.to_owned()], |_| {}).expect("the check can be done");
            for row in &rows {
                assert!(row.passes(), "{row:?}");
            }
        })*
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
    bodies_on_inclines_follow_newton: "incline",
    rolling_resistance_takes_the_arm_that_is_stated: "rolling-lever",
    free_rotation_follows_euler: "free-rotation",
    gravity_does_not_count_spheres: "gravity-overlap",
    rebound_does_not_count_spheres: "rebound-sphere-count",
    whole_seeds_rebound_as_rigid_bodies: "whole-seed-damping",
    energy_ledger_closes: "energy-ledger",
    mesh_walls_are_analytic_walls: "mesh-wall",
    moving_walls_carry_bodies: "moving-wall",
    spinning_walls_drag_bodies: "spinning-wall",
    bonded_chain_is_a_beam: "bond-beam",
    small_grains_pass_between_large_ones: "size-ratio",
    laws_have_their_closed_forms: "laws",
    cohesion_holds_to_its_largest_pull: "cohesion-by-area",
    bridges_of_liquid_hold_and_resist: "liquid-bridge",
    same_input_gives_the_same_bits: "determinism",
}

#[test]
fn every_check_has_a_test() {
    let names: Vec<_> = suite().iter().map(|c| c.name).collect();
    assert_eq!(names, NAMES);
}
