//! Wrong measurements: each message names file, line, key and the way out.

use super::folder::{changed, wrong};
use super::refused::tells;
use dev_support::fixture_files::fixture;

#[test]
fn a_measurement_without_scatter_or_number_is_refused() {
    tells(
        &wrong(&changed("sd = 0.8, n = 10", "sd = 0, n = 0")),
        &["angle_deg", "sd = 0", "n = 0", "1 or more"],
    );
    tells(
        &wrong(&changed("sd = 0.8, n = 10", "sd = 0.8")),
        &["angle_deg", "has no 'n'"],
    );
}

#[test]
fn a_condition_without_an_observable_is_refused() {
    let study = changed(
        "condition = { rpm = 30 }\nrole = \"check\"\nangle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        "condition = { rpm = 30 }\nrole = \"check\"",
    );
    tells(
        &wrong(&study),
        &["line 35", "holds no measurement", "or photos"],
    );
}

#[test]
fn an_observable_that_the_scene_does_not_give_is_told_with_those_it_gives() {
    let message = wrong(&changed("shown_static_friction", "angle_deg"));
    tells(
        &message,
        &[
            "'sled'",
            "'angle_deg'",
            "which gives shown_static_friction",
            "scene, condition, role, photos",
        ],
    );
    tells(
        &wrong(&changed("role = \"check\"", "rolle = \"check\"")),
        &["rolle", "has no 'role'"],
    );
}

/// The same condition in two spellings is one condition: 15 rpm stands in the scene, too.
#[test]
fn a_measurement_that_is_both_check_and_fit_is_refused() {
    for condition in [
        "condition = { rpm = 15 }",
        "condition = { \"apparatus.speed\" = \"15.0 rpm\" }",
        "",
    ] {
        let message = wrong(&changed("condition = { rpm = 30 }", condition));
        tells(
            &message,
            &["angle_deg", "another role in line", "one role only"],
        );
    }
}

#[test]
fn a_condition_that_a_scene_cannot_take_is_refused() {
    for (condition, word) in [
        ("{ speeed = 30 }", "speeed"),
        ("{ \"apparatus.speed\" = \"30 mm\" }", "rpm"),
        ("{ \"seed.0.count\" = 0 }", "0"),
        ("{ rpm = [30] }", "number or a text"),
    ] {
        let study = changed(
            "condition = { rpm = 30 }",
            &format!("condition = {condition}"),
        );
        tells(&wrong(&study), &["condition", word]);
    }
    tells(
        &wrong(&changed("scene = \"sled\"", "scene = \"slad\"")),
        &["slad", "there are drum, sled"],
    );
}

/// The photo shows hand-held drums from the side.
#[test]
fn a_photo_without_a_surface_is_named_with_the_reason() {
    let photos = format!(
        "photos = [{:?}, \"none.png\"]",
        fixture("photos/phone_prototype_drums_tilted_camera.jpg")
    );
    let message = wrong(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        &photos,
    ));
    tells(
        &message,
        &[
            "phone_prototype",
            "no surface that can be measured",
            "none.png",
            "cannot be read",
        ],
    );
    tells(
        &wrong(&changed(
            "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
            "photos = \".\"",
        )),
        &["holds no picture"],
    );
}

#[test]
fn reading_options_that_cannot_be_meant_are_refused() {
    let study = changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        "photos = \".\"\nphoto = { definition = \"mid\", roll = 2, corners = \"1,2\", foreground = \"grey\", rol = 1 }",
    );
    tells(
        &wrong(&study),
        &["definition", "roll", "corners", "foreground", "rol"],
    );
    let angle = "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }";
    let unknown = changed(
        angle,
        "photos = \".\"\nphoto = { leave_out = [\"angel_deg\"] }",
    );
    tells(&wrong(&unknown), &["leave_out", "'angel_deg'", "s_shape, "]);
    let steep = changed(angle, "photos = \".\"\nphoto = { elevation = \"40 deg\" }");
    tells(&wrong(&steep), &["elevation", "0 to 30 degrees"]);
    let twice = changed(
        angle,
        "photos = \".\"\nphoto = { roll = \"1 deg\", level = \"0,0;200,0\", plumb_line = \"0,0;200,1\", region = [0, 0, -1, 5], \
         every = 0, mask = \"no.png\", corners = \"0,0;9,0;9,9;0,9\" }",
    );
    tells(
        &wrong(&twice),
        &[
            "level = \"0,0;200,0\" says the turn of the camera a second time",
            "plumb_line = \"0,0;200,1\" tells no horizontal",
            "region",
            "every",
            "mask",
        ],
    );
    // The camera looks along the axis of a drum; the value arrives where the picture is read.
    let photo = fixture("photos/granudrum_mccA_15rpm_avg.bmp");
    let drum = changed(
        angle,
        &format!("photos = [{photo:?}]\nphoto = {{ elevation = \"10 deg\" }}"),
    );
    tells(
        &wrong(&drum),
        &["camera elevation", "a drum is seen along its axis"],
    );
}
