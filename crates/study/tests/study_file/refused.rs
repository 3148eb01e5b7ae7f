//! Wrong input: each problem names file, line, table, key, value and the remedy, and nothing is run.

use super::folder::{DRUM, Folder, STUDY, changed, problems, refuses, reports, with, wrong};
use dev_support::fixture_files::fixture;

/// The photos of a measurement in the place of its mean.
const ANGLE: &str = "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }";
const CURVATURE: &str = "curvature = { mean = 0.1, sd = 0.02, n = 7.5 }";
const CONDITION: &str = "condition = { rpm = 30 }";
const FILE: &str = "file = \"drum.toml\"";

#[test]
#[rustfmt::skip]
fn several_mistakes_come_together_in_the_order_of_their_lines() {
    let study = changed("low = 0.1", "low = -0.1")
        .replacen("sd = 0.8", "sd = 0", 1)
        .replacen("role = \"check\"", "role = \"chek\"", 1)
        .replacen("name = \"sled\"", "nam = \"sled\"", 1);
    let list = wrong(&study);
    for (what, word) in [
        ("[[scene]] 2: nam = \"sled\"", "name, file"),
        ("[[scene]] 2", "'name'"),
        ("[[parameter]] F: low = -0.1", "0 to 2"),
        ("[[measured]] drum: angle_deg.sd = 0", "above 0"),
        ("[[measured]] drum: role = \"chek\"", "\"fit\", \"check\", \"show\""),
        ("[[measured]] sled: scene = \"sled\"", "scenes are drum"),
    ] {
        reports(&study, &list, what, word);
    }
    assert_eq!(list.len(), 6, "{list:#?}");
    assert!(list.is_sorted_by_key(|p| p.line), "{list:#?}");
    assert!(list.iter().all(|p| p.file.ends_with("study.toml")));
    // A wrong measurement hides no wrong path: the scenes are known.
    let study =
        changed("static_friction\"]", "statik_friction\"]").replacen("sd = 0.8", "sd = 0", 1);
    let list = wrong(&study);
    reports(
        &study,
        &list,
        "pea-pea.statik_friction",
        "contact.pea-wall.static_friction",
    );
    reports(&study, &list, "angle_deg.sd = 0", "");
}

/// A slip is reported once with what to write, without all that a parser makes of the rest of its line.
#[test]
#[rustfmt::skip]
fn text_that_is_not_toml_is_reported_once_a_line() {
    for (study, lines, word) in [
        ("name = \n[[scene]]\nname =".to_owned(), 2, ""),
        (changed("low = 0.1", "low = 0,1").replacen("sd = 0.8", "sd = 0,8", 1), 2, "0.25"),
        (changed("role = \"check\"", "role = check"), 1, "\"check\""),
        (changed("sd = 0.8, n = 10", "sd == 0.8,, n ="), 1, ""),
    ] {
        let list = wrong(&study);
        assert_eq!(list.len(), lines, "{list:#?}");
        for problem in &list {
            assert!(
                problem.line.is_some() && problem.problem.contains("TOML"),
                "{list:#?}"
            );
            assert!(problem.problem.contains(word), "{list:#?}");
        }
    }
}

/// Drum and sled are of one file: the fault in it is reported once, with the first of them.
#[test]
#[rustfmt::skip]
fn a_mistake_in_a_scene_file_is_reported_once() {
    for (from, to, word) in [
        ("count = 100", "cuont = 100", "cuont"),
        ("restitution = 0.5\nstatic_friction = 0.35", "static_friction = 0.35", "restitution"),
        ("sphere = \"6 mm\"", "mesh = \"no.stl\"\nmesh_unit = \"mm\"\nfilling = { method = \"pack\", sphere_radius = \"1 mm\", seed = 1 }", "no.stl"),
    ] {
        let folder = Folder::new(STUDY);
        folder.write("drum.toml", &DRUM.replacen(from, to, 1));
        let list = problems(&folder, None);
        reports(STUDY, &list, "[[scene]] drum", word);
        assert_eq!(list.len(), 1, "{list:#?}");
    }
}

#[test]
fn what_a_study_needs_is_missed_all_at_once() {
    let list = wrong("[budget]\nruns = 5");
    for key in ["'name'", "[[scene]]", "[[parameter]]", "[[measured]]"] {
        reports("", &list, "the study", key);
    }
}

/// The row gives what is changed in the study, the place that is named, and a word of the remedy.
#[test]
#[rustfmt::skip]
fn keys_and_scenes_that_are_not_there_are_refused() {
    refuses(&[
        ("high = 0.6", "hihg = 0.6", "[[parameter]] F: hihg = 0.6", "high"),
        ("high = 0.6", "hihg = 0.6", "[[parameter]] F", "'high'"),
        ("", "[design]\nreplicate = 2", "[design]: replicate = 2", "did you mean replicates"),
        ("", "[design]\nseed = 2", "[design]: seed = 2", "--seed"),
        ("", "[budget]\nhours = 2", "[budget]: hours = 2", "core_hours"),
        ("", "[effects]\nnone = []", "[effects]: none", "search"),
        ("", "[profile.x.desing]", "[profile.x.desing]", "design"),
        ("role = \"check\"", "rolle = \"check\"", "drum: rolle = \"check\"", "scene, condition, role"),
        ("role = \"check\"", "rolle = \"check\"", "[[measured]] drum", "'role'"),
        (FILE, "file = \"dum.toml\"", "[[scene]] drum", "dum.toml"),
        (FILE, "observables = []", "[[scene]] drum: observables", "\"command\""),
        (FILE, "drum = 3", "[[scene]] drum", "'file'"),
        (FILE, "file = 3", "[[scene]] drum: file = 3", "a path"),
        ("scene = \"sled\"", "scene = \"slad\"", "[[measured]] slad: scene = \"slad\"", "drum, sled"),
        ("name = \"sled\"", "name = \"drum\"", "[[scene]] drum: name", "duplicate"),
        ("name = \"sled\"", "name = \"a/b\"", "[[scene]] a/b: name", "'/'"),
        ("", "[[effect]]\nname = \"x\"\nprobe = 1\nrange = [0, 2]", "effect", "\"command\""),
        ("", "[effects]\nsearch = [\"rolling-resistence\"]", "[effects]: search", "rolling-resistance"),
        ("", "[effects]\nsearch = [\"cohesion\", \"cohesion\"]", "[effects]: search", "'cohesion'"),
        ("", "[profile.quick]\nscene.dram.changes = [\"protocol.frames = 3\"]", "dram", "drum, sled"),
    ]);
    // A drum of 101 000 peas has no room for them, and no run is needed to see it.
    let change = |text: &str| format!("{FILE}\nchanges = [{text}]");
    refuses(&[
        (FILE, &change("\"seed.0.count = 101000\""), "[[measured]] drum", "do not fit"),
        (FILE, &change("\"frames 3\""), "changes.0 = \"frames 3\"", "name = value"),
        (FILE, &change("\"protocol.fames = 3\", \"gravity_m_s2 = -1\""), "drum", "protocol.fames"),
        (FILE, &change("\"protocol.fames = 3\", \"gravity_m_s2 = -1\""), "drum", "gravity_m_s2"),
    ]);
    let study = with("[profile.quick.design]\nreplicates = 2");
    reports(
        &study,
        &problems(&Folder::new(&study), Some("quik")),
        "[profile]",
        "'quik'",
    );
}

#[test]
#[rustfmt::skip]
fn parameters_that_cannot_be_meant_are_refused() {
    let speed = "sets = [\"apparatus.speed\"]\nunit = \"rpm\"\nlow = 10.0\nhigh = 40.0";
    let wall = "sets = [\"contact.pea-wall.static_friction\"]\nlow = 0.1\nhigh = 0.6\nlimits = [0.0, 1.5]\nstart = 0.25\nprior = { mean = 0.4, sd = 0.05 }";
    refuses(&[
        ("contact.pea-wall.static", "contact.pea-pea.static", "[[parameter]] W: sets.0", "parameter F"),
        ("contact.pea-pea.static", "contact.pea-pee.static", "pea-pee", "contact.pea-wall.static_friction"),
        // Peas never touch the spare material.
        ("contact.pea-wall.static", "contact.pea-spare.static", "[[parameter]] W: sets", "changes nothing"),
        ("contact.pea-pea.static_friction", "seed.0.count", "[[parameter]] F: sets", "whole number (100)"),
        (wall, speed, "[[parameter]] W: sets", "apparatus.speed = 15 rpm"),
        ("start = 0.25", "start = 1.6", "[[parameter]] W: start = 1.6", "0 to 1.5"),
        ("limits = [0.0, 1.5]", "limits = [1.5, 0.0]", "W: limits = [1.5, 0.0]", "rise"),
        ("high = 0.6", "high = 0.05", "F: low = 0.1", "high = 0.05"),
        ("low = 0.1", "low = 0.5999999999999999", "low = 0.5999999999999999", "nine digits"),
        ("sd = 0.05", "sd = 0", "W: prior", "above 0"),
        ("mean = 0.4, sd", "mean = 5.0, sd", "W: prior", "mean 5, outside the limits 0 to 1.5"),
        // Friction is never negative: the scene says so at the end of the limits, not in the middle of a search.
        ("limits = [0.0, 1.5]", "limits = [-1.0, 1.5]", "W: limits", "reach -1"),
        ("limits = [0.0, 1.5]", "limits = [0.0, 50.0]", "W: limits", "0 to 10"),
        ("high = 0.6", "high = 0.6\nunit = \"mm\"", "F: unit = \"mm\"", "plain number"),
        ("symbol = \"W\"", "symbol = \"1 W\"", "symbol = \"1 W\"", "1 W"),
        ("symbol = \"W\"", "symbol = \"F\"", "[[parameter]] F: symbol", "another"),
    ]);
    // Without a prior no measurement fixes it: the calibration says so.
    let unseen =
        changed("prior = { mean = 0.4, sd = 0.05 }", "").replacen("\"fit\"", "\"show\"", 1);
    reports("", &wrong(&unseen), "the study", "parameter W");
    let diameter = |more: &str| {
        format!("[[parameter]]\nsymbol = \"D\"\nsets = [\"seed.0.sphere\"]\nlow = 5.0\n{more}")
    };
    // Peas of 30 mm do not fit into a drum that is 20 mm wide: no design comes to the end of the range.
    refuses(&[
        ("", &diameter("high = 30.0\nunit = \"mm\""), "[[parameter]] D: high = 30.0", "do not fit"),
        ("", &diameter("high = 7.0"), "[[parameter]] D", "unit ="),
        ("", &diameter("high = 7.0\nunit = \"rpm\""), "[[parameter]] D: unit = \"rpm\"", "'rpm'"),
    ]);
    let one = |k: usize| {
        format!(
            "[[parameter]]\nsymbol = \"P{k}\"\nsets = [\"contact.pea-pea.restitution\"]\nlow = 0.1\nhigh = 0.2\n"
        )
    };
    let many: String = (0..11).map(one).collect();
    reports(
        "",
        &wrong(&with(&many)),
        "the study",
        "13 [[parameter]]: 12",
    );
}

/// An input that is not what the scenes have, one of no effect of the library, of no scene, of a whole number, of nothing, and a
/// standard deviation below 0.
#[test]
#[rustfmt::skip]
fn inputs_that_cannot_be_meant_are_refused() {
    let of = |text: &str| format!("[[input]]\n{text}\n");
    let diameter = "sets = [\"apparatus.inner_diameter\"]\nunit = \"mm\"\nmean = 90.0\nsd = 1.0";
    refuses(&[
        ("", &of(diameter), "mean = 90.0", "100"),
        ("", &of("effect = \"fill\"\nsd = 0.1"), "[[input]] fill: effect", "'fill'"),
        ("", &of("effect = \"seed-count\"\nsd = 0.1\nscenes = [\"drums\"]"), "scenes.0 = \"drums\"", "drum, sled"),
        ("", &of("sets = [\"seed.0.count\"]\nmean = 100.0\nsd = 3.0"), "sets", "\"seed-count\""),
        ("", &of("sd = 0.1"), "[[input]] 1", "'effect'"),
        ("", &of("effect = \"seed-count\"\nsd = -0.1"), "sd = -0.1", "0 or more"),
        ("", &of("effect = \"seed-count\"\nsd = 0.1\nmean = 1.0"), "mean = 1.0", "'sets'"),
    ]);
}

/// An angle of repose is between level and upright; squares of larger numbers than 1e15 need not be finite, and of numbers below 1e-30 the
/// reciprocals.
#[test]
#[rustfmt::skip]
fn numbers_beyond_all_quantities_are_refused() {
    let friction = "shown_static_friction = { mean = 34.0";
    let mean = "angle_deg = { mean = 33.1";
    refuses(&[
        ("mean = 33.1", "mean = -1.0", "angle_deg.mean = -1.0", "1.6 to 90 deg"),
        ("mean = 33.1", "mean = 1e308", "angle_deg.mean = 1e308", "1.6 to 90 deg"),
        ("mean = 33.1", "mean = 0.578", "angle_deg.mean = 0.578", "radians"),
        (mean, friction, "shown_static_friction.mean = 34.0", "0 to 6"),
        (mean, "shown_restitution = { mean = 1.2", "shown_restitution.mean = 1.2", "0 to 1"),
        ("sd = 0.8", "sd = 1e308", "angle_deg.sd = 1e308", "1e15"),
        ("sd = 0.8", "sd = 1e-320", "sd = 1e-320", "1e-9"),
        ("sd = 0.8", "sd = 1e-20", "sd = 1e-20", "1e-9"),
        ("sd = 0.8", "sd = 1e300", "sd = 1e300", "1e15"),
        ("sd = 0.8", "sd = -0.0", "sd = -0.0", "above 0"),
        ("sd = 0.8", "sd = nan", "sd = NaN", "above 0"),
        ("sd = 0.8, n = 10", "sd = 0, n = 0", "angle_deg.sd = 0", "above 0"),
        ("sd = 0.8, n = 10", "sd = 0, n = 0", "angle_deg.n = 0", "1 or more"),
        ("sd = 0.8, n = 10", "sd = 0.8", "angle_deg", "'n'"),
        ("sd = 0.8, n = 10", "sd = \"a\", n = 10", "angle_deg.sd = \"a\"", "a number"),
        ("mean = 0.1,", "mean = 1e-200,", "mean = 1e-200", "1e-30"),
        ("n = 7.5", "n = inf", "n = inf", "1e15"),
        ("n = 10", "n = 1e300", "n = 1e300", "1e15"),
        ("low = 0.1", "low = 1e-300", "low = 1e-300", "1e-30"),
        ("start = 0.25", "start = 1e-31", "start = 1e-31", "1e-30"),
        ("[0.0, 1.5]", "[0.0, 1e308]", "limits", "1e15"),
        ("mean = 0.4, sd", "mean = 1e308, sd", "prior", "1e15"),
        ("sd = 0.05", "sd = 1e-20", "prior", "1e-20"),
        ("rpm = 30", "rpm = nan", "condition", "nan"),
        ("rpm = 30", "rpm = 1e300", "condition", ""),
        ("", "[[compare]]\nresult = \"F\"\nvalue = inf\nsource = \"x\"", "F: value = inf", "1e15"),
        ("", "[design]\nreplicates = 1000000000", "replicates = 1000000000", "1 to 1000"),
        ("", "[design]\nbefore_runs = 1000000000", "before_runs = 1000000000", "0 to 1000"),
        ("", "[design]\ncheck_runs = 1001", "check_runs = 1001", "2 to 1000"),
        ("", "[design]\nconfirmation_runs = 1", "confirmation_runs = 1", "2 to 1000"),
        ("", "[design]\nmost_boxes = 10000000000000", "most_boxes = 10000000000000", "1 to 1000"),
        ("", "[design]\nreplicates = 0", "[design]: replicates = 0", "1 to 1000"),
        ("", "[design]\nscreening_alpha = 2", "[design]: screening_alpha = 2", "0 and 1"),
        ("", "[design]\nsurface = \"box\"", "[design]: surface = \"box\"", "\"box-behnken\""),
        ("", "[budget]\nruns = 3\ncore_hours = 1", "[budget]: core_hours = 1", "runs or core_hours"),
        ("", "[budget]\nruns = 0", "[budget]: runs = 0", "1 or more"),
        ("", "[budget]\nruns = -1", "[budget]: runs = -1", "a whole number"),
    ]);
}

/// A plan that the budget cannot pay is refused before any run, as the loop would refuse it.
#[test]
fn a_budget_below_the_runs_that_are_certain_is_refused_by_the_plan() {
    let folder = Folder::new(&with("[budget]\nruns = 3"));
    let study = folder.read(None).unwrap();
    let told = study::plan_study(&study, 1, &folder.path("out"))
        .unwrap_err()
        .to_string();
    assert!(
        told.contains("runs are needed, and the budget is 3"),
        "{told}"
    );
}

#[test]
#[rustfmt::skip]
fn measurements_that_cannot_be_meant_are_refused() {
    refuses(&[
        (ANGLE, "", "[[measured]] drum", "photos"),
        ("role = \"fit\"", "role = \"fit\"\nphotos = []", "photos = []", "empty"),
        (ANGLE, "photos = 3", "photos = 3", "a folder, or a list of files"),
        (ANGLE, "photo = { }", "photo", "'photos'"),
        ("shown_static_friction", "angle_deg", "[[measured]] sled: angle_deg", "shown_static_friction"),
        // The same condition in two spellings is one condition: 15 rpm is in the scene, too.
        (CONDITION, "condition = { rpm = 15 }", "drum: angle_deg", "in line 32"),
        (CONDITION, "condition = { \"apparatus.speed\" = \"15.0 rpm\" }", "drum: angle_deg", "in line 32"),
        (CONDITION, "", "drum: angle_deg", "in line 32"),
        (CONDITION, "condition = { speeed = 30 }", "[[measured]] drum: condition", "speeed"),
        (CONDITION, "condition = { \"apparatus.speed\" = \"30 mm\" }", "condition", "rpm"),
        (CONDITION, "condition = { \"seed.0.count\" = 0 }", "condition", "0"),
        (CONDITION, "condition = { rpm = [30] }", "condition", "'rpm'"),
        ("", "[[compare]]\nresult = \"angle of drum\"\nvalue = 38.6\nsource = \"x\"", "result", "angle_deg of drum at apparatus.speed = 15 rpm"),
        // Measured at two speeds: which one is meant?
        ("", "[[compare]]\nresult = \"angle_deg of drum\"\nvalue = 38.6\nsource = \"x\"", "result", "angle_deg of drum at rpm = 30"),
    ]);
}

/// Three observables of which each goes with the next as 0.9 and the last with the first as -0.9: no three variables do so, the
/// determinant of the matrix being 1 + 2 * 0.9 * 0.9 * -0.9 - 3 * 0.81 < 0. Nor does one correlation have two values.
#[test]
#[rustfmt::skip]
fn correlations_that_cannot_be_are_refused() {
    let of = |correlations: &str| {
        format!(
            "{CURVATURE}\ns_shape = {{ mean = 0.0, sd = 0.02, n = 7.5 }}\ncorrelation = {correlations}"
        )
    };
    refuses(&[
        (CURVATURE, &of("[[\"angle_deg\", \"shape_4\", 0.4]]"), "correlation", "'shape_4'"),
        (CURVATURE, &of("[[\"angle_deg\", \"curvature\", 1.0]]"), "correlation.0", "-1 and 1"),
        (CURVATURE, &of("[[\"angle_deg\", \"curvature\"]]"), "correlation.0", "OBSERVABLE"),
        (CURVATURE, &of("{ angle_deg = 0.4 }"), "correlation", "a list"),
    ]);
    for (correlations, word) in [
        (
            r#"[["angle_deg", "curvature", 0.9], ["curvature", "s_shape", 0.9], ["angle_deg", "s_shape", -0.9]]"#,
            "s_shape",
        ),
        (
            r#"[["angle_deg", "curvature", 0.5], ["curvature", "angle_deg", 0.4]]"#,
            "curvature",
        ),
        (r#"[["angle_deg", "angle_deg", 0.5]]"#, "angle_deg"),
    ] {
        reports(
            "",
            &wrong(&changed(CURVATURE, &of(correlations))),
            "the study",
            word,
        );
    }
}

#[test]
#[rustfmt::skip]
fn coarse_grains_that_show_no_trend_are_refused() {
    let of = |scenes: &str, factors: &str| {
        format!("[effects]\nsearch = []\n[coarse_graining]\n{scenes}factors = {factors}")
    };
    let drum = "scenes = [\"drum\"]\n";
    refuses(&[
        ("", &of(drum, "[3.0]"), "factors = [3.0]", "two or more"),
        ("", &of(drum, "[3.0, 0.5]"), "factors = [3.0, 0.5]", "0.5"),
        ("", &of(drum, "[2.0, 0]"), "factors = [2.0, 0]", "0"),
        ("", &of(drum, "[2.0, 2.0]"), "factors = [2.0, 2.0]", "twice"),
        ("", &of(drum, "[\"4 mm\", \"3 mm\"]"), "factors.0 = \"4 mm\"", "a number"),
        ("", &of(drum, "[20.0, 2.0]"), "factors = [20.0, 2.0]", "at 20"),
        ("", &of("scenes = [\"drun\"]\n", "[3.0, 2.0]"), "scenes.0 = \"drun\"", "drum, sled"),
        ("", &of("scenes = [\"sled\"]\n", "[3.0, 2.0]"), "scenes = [\"sled\"]", "single seeds"),
        ("", &of("scenes = []\n", "[3.0, 2.0]"), "scenes = []", "empty"),
        ("", &of("", "[3.0, 2.0]"), "[coarse_graining]", "'scenes'"),
        ("", &of(drum, "[3.0, 2.0]\nerror = 0.0"), "error = 0.0", "above 0"),
        ("", &of(drum, "[3.0, 2.0]\nsizes = [3.0, 2.0]"), "sizes", "scenes, factors, error"),
    ]);
    let effects = with(&format!("[coarse_graining]\n{drum}factors = [1.6, 1.33]\n"));
    reports(
        "",
        &wrong(&effects),
        "the study",
        "search = [] in [effects]",
    );
}

/// The photo shows hand-held drums from the side; a camera looks along the axis of a drum.
#[test]
#[rustfmt::skip]
fn photos_that_cannot_be_read_as_the_file_says_are_refused() {
    let side = fixture("photos/phone_prototype_drums_tilted_camera.jpg");
    let bad = format!("photos = [{side:?}, \"none.png\"]");
    let drum = fixture("photos/granudrum_mccA_15rpm_avg.bmp");
    let above = format!("photos = [{drum:?}]\nphoto = {{ elevation = \"10 deg\" }}");
    let read = |options: &str| format!("photos = \".\"\nphoto = {{ {options} }}");
    refuses(&[
        (ANGLE, &bad, "[[measured]] drum: photos", "phone_prototype"),
        (ANGLE, &bad, "[[measured]] drum: photos", "none.png"),
        (ANGLE, &above, "photos", "elevation"),
        (ANGLE, "photos = \".\"", "photos = \".\"", "no picture"),
        (ANGLE, &read("definition = \"mid\""), "photo.definition = \"mid\"", "\"line\""),
        (ANGLE, &read("roll = 2"), "photo.roll = 2", "no unit"),
        (ANGLE, &read("corners = \"1,2\""), "photo.corners = \"1,2\"", "4 places"),
        (ANGLE, &read("foreground = \"grey\""), "foreground = \"grey\"", "\"auto\""),
        (ANGLE, &read("rol = 1"), "photo.rol = 1", "roll"),
        (ANGLE, &read("leave_out = [\"angel_deg\"]"), "photo.leave_out", "'angel_deg'"),
        (ANGLE, &read("also = [\"curvature\"]"), "photo.also", "fill_level"),
        (ANGLE, &read("elevation = \"40 deg\""), "elevation = \"40 deg\"", "0 to 30 degrees"),
        (ANGLE, &read("roll = \"1 deg\", level = \"0,0;200,0\""), "level = \"0,0;200,0\"", "one of roll"),
        (ANGLE, &read("plumb_line = \"0,0;200,1\""), "plumb_line = \"0,0;200,1\"", "no horizontal"),
        (ANGLE, &read("region = [0, 0, -1, 5]"), "region.2 = -1", "a whole number"),
        (ANGLE, &read("every = 0"), "every = 0", "1 or more"),
        (ANGLE, &read("mask = \"no.png\", corners = \"0,0;9,0;9,9;0,9\""), "mask = \"no.png\"", "corners"),
        (ANGLE, &read("frame_interval = \"0 s\""), "frame_interval = \"0 s\"", "above 0"),
        (ANGLE, &read("every = 2, pair_interval = \"2 ms\""), "every = 2", "pair_interval"),
    ]);
}
