//! Wrong input: each message names file, line, key and the way out, and nothing is run.

use super::folder::{DRUM, Folder, STUDY, changed, with, wrong};
use study::Error;

/// The message holds the file, and each of the words.
pub(crate) fn tells(message: &str, words: &[&str]) {
    for word in ["study.toml"].iter().chain(words) {
        assert!(message.contains(word), "'{word}' is missing in: {message}");
    }
}

#[test]
fn several_errors_come_together_with_their_lines() {
    let study = changed("low = 0.1", "low = -0.1")
        .replacen("sd = 0.8", "sd = 0", 1)
        .replacen("role = \"check\"", "role = \"chek\"", 1)
        .replacen("name = \"sled\"", "nam = \"sled\"", 1);
    let error = Folder::new(&study).read(None).unwrap_err();
    let Error::Problems { list } = &error else {
        panic!("{error}");
    };
    let at = |text: &str| 1 + study[..study.find(text).unwrap()].matches('\n').count();
    for (line, word) in [
        (at("nam ="), "is no key here; there are name, file"),
        (at("low = -0.1"), "outside the limits 0 to 2"),
        (at("sd = 0,"), "must be above 0"),
        (at("role = \"chek\""), "\"fit\", \"check\" or \"show\""),
    ] {
        let found = list
            .iter()
            .any(|p| p.line == Some(line) && p.problem.contains(word));
        assert!(found, "line {line}, '{word}': {error}");
    }
    let lines: Vec<_> = list.iter().map(|p| p.line).collect();
    assert!(lines.is_sorted(), "{error}");
}

/// A wrong measurement hides no wrong path: the scenes are known, so that both are told.
#[test]
fn a_path_that_is_nowhere_is_told_beside_a_wrong_measurement() {
    let study =
        changed("static_friction\"]", "statik_friction\"]").replacen("sd = 0.8", "sd = 0", 1);
    let error = Folder::new(&study).read(None).unwrap_err().to_string();
    tells(
        &error,
        &[
            "statik_friction', a setting that no scene has",
            "must be above 0",
        ],
    );
}

#[test]
fn text_that_is_no_toml_is_told_with_its_line() {
    tells(
        &wrong("name = \n[[scene]]\nname ="),
        &["line 1", "line 3", "no TOML"],
    );
}

/// Drum and sled are of one file: what is wrong in it is told once, with the first of them.
#[test]
fn a_mistake_in_a_file_of_two_scenes_is_told_once() {
    let folder = Folder::new(STUDY);
    folder.write("drum.toml", &DRUM.replacen("count = 100", "cuont = 100", 1));
    let error = folder.read(None).unwrap_err();
    let Error::Problems { list } = &error else {
        panic!("{error}");
    };
    assert_eq!(list.len(), 1, "{error}");
    tells(&error.to_string(), &["'drum'", "drum.toml", "cuont"]);
}

/// A slip is told once with what to write; all that a parser makes of the rest of its line is not told.
#[test]
fn a_slip_is_told_once_with_what_to_write() {
    let study = changed("low = 0.1", "low = 0,1").replacen("sd = 0.8", "sd = 0,8", 1);
    let error = Folder::new(&study).read(None).unwrap_err();
    let Error::Problems { list } = &error else {
        panic!("{error}");
    };
    assert_eq!(list.len(), 2, "{error}");
    for problem in list {
        assert!(problem.problem.contains("with a point"), "{error}");
    }
    let study = changed("role = \"check\"", "role = check");
    tells(&wrong(&study), &["no TOML", "in quotes, \"check\""]);
    // Without a usual slip it is the first that the parser found in the line.
    let study = changed("sd = 0.8, n = 10", "sd == 0.8,, n =");
    let error = Folder::new(&study).read(None).unwrap_err();
    let Error::Problems { list } = &error else {
        panic!("{error}");
    };
    assert_eq!(list.len(), 1, "{error}");
}

#[test]
fn a_study_of_nothing_lacks_its_three_lists() {
    tells(
        &wrong("name = \"x\""),
        &["[[scene]]", "[[parameter]]", "[[measured]]"],
    );
}

#[test]
fn unknown_keys_are_told_wherever_they_stand() {
    let more =
        "[design]\nreplicate = 2\n[budget]\nhours = 2\n[effects]\nnone = []\n[profile.x.desing]\n";
    let study = changed("high = 0.6", "hihg = 0.6") + more;
    tells(
        &wrong(&study),
        &[
            "hihg",
            "replicate",
            "hours",
            "none",
            "desing",
            "there are symbol, name, sets",
        ],
    );
}

#[test]
fn a_scene_that_is_not_there_or_cannot_be_meant_is_told_with_its_file() {
    tells(
        &wrong(&changed("file = \"drum.toml\"", "file = \"dum.toml\"")),
        &["line 3", "dum.toml", "cannot read"],
    );
    let folder = Folder::new(STUDY);
    folder.write(
        "drum.toml",
        &DRUM.replace(
            "restitution = 0.5\nstatic_friction = 0.35",
            "static_friction = 0.35",
        ),
    );
    tells(
        &folder.read(None).unwrap_err().to_string(),
        &["drum.toml", "restitution"],
    );
}

/// A drum of 101 000 peas: there is no room for them, and no run is needed to see it.
#[test]
fn a_scene_that_cannot_be_built_is_told() {
    let study = changed(
        "file = \"drum.toml\"",
        "file = \"drum.toml\"\nchanges = [\"seed.0.count = 101000\"]",
    );
    tells(
        &wrong(&study),
        &["[[measured]]", "do not fit into the apparatus"],
    );
}

#[test]
fn wrong_changes_of_a_scene_are_told_all() {
    let changes = "changes = [\"frames 3\", \"protocol.fames = 3\", \"gravity_m_s2 = -1\"]";
    let study = changed(
        "file = \"drum.toml\"",
        &format!("file = \"drum.toml\"\n{changes}"),
    );
    tells(
        &wrong(&study),
        &["frames 3", "no '='", "protocol.fames", "gravity_m_s2"],
    );
}

#[test]
fn a_mesh_that_is_not_there_is_told() {
    let folder = Folder::new(STUDY);
    let mesh = "mesh = \"no.stl\"\nmesh_unit = \"mm\"\nfilling = { method = \"pack\", sphere_radius = \"1 mm\", seed = 1 }";
    folder.write("drum.toml", &DRUM.replace("sphere = \"6 mm\"", mesh));
    tells(&folder.read(None).unwrap_err().to_string(), &["no.stl"]);
}

#[test]
fn two_parameters_cannot_set_one_path() {
    let study = changed(
        "contact.pea-wall.static_friction",
        "contact.pea-pea.static_friction",
    );
    tells(
        &wrong(&study),
        &[
            "[[parameter]] W",
            "contact.pea-pea.static_friction",
            "parameter F sets too",
        ],
    );
}

#[test]
fn a_path_that_no_scene_has_is_told_with_those_like_it() {
    let study = changed(
        "contact.pea-pea.static_friction",
        "contact.pea-pee.static_friction",
    );
    tells(
        &wrong(&study),
        &[
            "pea-pee",
            "no scene has",
            "contact.pea-wall.static_friction",
        ],
    );
}

/// Peas never touch the spare material.
#[test]
fn a_parameter_that_changes_nothing_is_told() {
    let study = changed(
        "contact.pea-wall.static_friction",
        "contact.pea-spare.static_friction",
    );
    tells(
        &wrong(&study),
        &[
            "[[parameter]] W",
            "changes nothing in any scene",
            "remove the parameter",
        ],
    );
}

#[test]
fn more_parameters_than_can_be_calibrated_are_refused() {
    let more: Vec<String> = (0..11)
        .map(|k| {
            format!("[[parameter]]\nsymbol = \"P{k}\"\nsets = [\"contact.pea-pea.restitution\"]\nlow = 0.1\nhigh = 0.2\n")
        })
        .collect();
    tells(
        &wrong(&with(&more.concat())),
        &["[[parameter]] x 13", "12 can be calibrated"],
    );
}

#[test]
fn a_start_outside_the_limits_and_limits_that_fall_are_refused() {
    tells(
        &wrong(&changed("start = 0.25", "start = 1.6")),
        &["start", "1.6", "outside the limits 0 to 1.5"],
    );
    tells(
        &wrong(&changed("limits = [0.0, 1.5]", "limits = [1.5, 0.0]")),
        &["limits", "rise"],
    );
    tells(
        &wrong(&changed("high = 0.6", "high = 0.05")),
        &["low = 0.1 and high = 0.05", "rise"],
    );
    tells(
        &wrong(&changed("sd = 0.05", "sd = 0")),
        &["prior", "sd above 0"],
    );
}

/// Friction is never negative: the scene says so at the end of the limits, not in the middle of a search.
#[test]
fn limits_that_the_scene_refuses_are_told() {
    tells(
        &wrong(&changed("limits = [0.0, 1.5]", "limits = [-1.0, 1.5]")),
        &["limits", "reach -1", "friction", "narrow them"],
    );
    tells(
        &wrong(&changed("limits = [0.0, 1.5]", "limits = [0.0, 50.0]")),
        &["limits", "reach 50", "static friction is 50", "0 to 10"],
    );
}

/// An angle of repose is between level and upright; squares of larger numbers than 1e15 need not be finite.
#[test]
fn numbers_that_no_quantity_has_are_refused() {
    for (from, to, words) in [
        (
            "mean = 33.1",
            "mean = -1.0",
            vec!["angle_deg", "1.6 to 90 deg"],
        ),
        ("mean = 33.1", "mean = 1e308", vec!["1.6 to 90 deg"]),
        ("mean = 33.1", "mean = 0.578", vec!["and not in radians"]),
        (
            "angle_deg = { mean = 33.1",
            "shown_static_friction = { mean = 34.0",
            vec!["shown_static_friction", "0 to 6", "no angle"],
        ),
        (
            "angle_deg = { mean = 33.1",
            "shown_restitution = { mean = 1.2",
            vec!["shown_restitution", "0 to 1"],
        ),
        ("sd = 0.8", "sd = 1e308", vec!["above 0, at most 1e15"]),
        ("n = 10", "n = 1e300", vec!["1 or more, at most 1e15"]),
        ("[0.0, 1.5]", "[0.0, 1e308]", vec!["limits", "1e15"]),
        ("mean = 0.4, sd", "mean = 1e308, sd", vec!["prior", "1e15"]),
    ] {
        tells(&wrong(&changed(from, to)), &words);
    }
    for (key, value, words) in [
        ("replicates", "1000000000", "1 to 1000"),
        ("before_runs", "1000000000", "0 to 1000"),
        ("check_runs", "1001", "2 to 1000"),
        ("confirmation_runs", "1", "2 to 1000"),
        ("most_boxes", "10000000000000", "1 to 1000"),
    ] {
        let study = with(&format!("[design]\n{key} = {value}"));
        tells(&wrong(&study), &[key, value, words]);
    }
}

/// A plan that the budget cannot pay is told before any run, as the loop would tell it.
#[test]
fn a_budget_below_the_runs_that_are_certain_is_refused_by_the_plan() {
    let folder = Folder::new(&with("[budget]\nruns = 3"));
    let study = folder.read(None).unwrap();
    let error = study::plan_study(&study, 1, &folder.path("out")).unwrap_err();
    let told = error.to_string();
    assert!(
        told.contains("runs are needed, and the budget is 3"),
        "{told}"
    );
}

/// What a study states twice, or in two ways of which one would be passed over in silence.
#[test]
fn what_contradicts_itself_is_refused() {
    let speed = "sets = [\"apparatus.speed\"]\nunit = \"rpm\"";
    for (from, to, words) in [
        (
            "mean = 0.4, sd",
            "mean = 5.0, sd",
            vec!["prior", "mean 5, outside the limits 0 to 1.5"],
        ),
        (
            "role = \"fit\"",
            "role = \"fit\"\nphotos = []",
            vec!["photos", "is empty"],
        ),
        (
            "sets = [\"contact.pea-wall.static_friction\"]\nlow = 0.1\nhigh = 0.6\nlimits = [0.0, 1.5]\nstart = 0.25\nprior = { mean = 0.4, sd = 0.05 }",
            &format!("{speed}\nlow = 10.0\nhigh = 40.0"),
            vec![
                "W",
                "'apparatus.speed'",
                "condition 'apparatus.speed'",
                "one value",
            ],
        ),
        (
            "contact.pea-pea.static_friction",
            "seed.0.count",
            vec!["F", "'seed.0.count' is a whole number"],
        ),
    ] {
        tells(&wrong(&changed(from, to)), &words);
    }
    let twice = with("[effects]\nsearch = [\"cohesion\", \"camera-roll\", \"cohesion\"]");
    tells(&wrong(&twice), &["search", "'cohesion' twice"]);
}

/// Peas of 30 mm do not fit into a drum that is 20 mm wide: that is told when the study is read, and not when the
/// design comes to the end of the range.
#[test]
fn a_range_at_whose_end_a_scene_cannot_be_built_is_refused() {
    let diameter = "[[parameter]]\nsymbol = \"D\"\nsets = [\"seed.0.sphere\"]\nunit = \"mm\"\nlow = 5.0\nhigh = 30.0\n";
    let message = wrong(&with(diameter));
    tells(
        &message,
        &[
            "[[parameter]] D: high",
            "cannot be built",
            "do not fit",
            "narrow the range",
        ],
    );
}

#[test]
fn a_unit_that_does_not_fit_the_setting_is_refused() {
    let more = |unit: &str| {
        with(&format!(
            "[[parameter]]\nsymbol = \"D\"\nsets = [\"seed.0.sphere\"]\nlow = 5.0\nhigh = 7.0\n{unit}"
        ))
    };
    tells(
        &wrong(&more("")),
        &["[[parameter]] D", "is a quantity", "unit ="],
    );
    tells(
        &wrong(&more("unit = \"rpm\"")),
        &["[[parameter]] D: unit", "no value in 'rpm'"],
    );
    tells(
        &wrong(&changed("high = 0.6", "high = 0.6\nunit = \"mm\"")),
        &["plain number", "'mm'"],
    );
}

#[test]
fn a_symbol_that_no_formula_can_hold_is_refused() {
    tells(
        &wrong(&changed("symbol = \"W\"", "symbol = \"1 W\"")),
        &["symbol", "1 W"],
    );
    tells(
        &wrong(&changed("symbol = \"W\"", "symbol = \"F\"")),
        &["symbol of another"],
    );
}

#[test]
fn unknown_effects_and_profiles_are_refused() {
    tells(
        &wrong(&with("[effects]\nsearch = [\"rolling-resistence\"]")),
        &["rolling-resistence", "rolling-resistance"],
    );
    let error = Folder::new(&with("[profile.quick.design]\nreplicates = 2"))
        .read(Some("quik"))
        .unwrap_err();
    tells(&error.to_string(), &["profile 'quik'", "there are quick"]);
    let study = with("[profile.quick]\nscene.dram.changes = [\"protocol.frames = 3\"]");
    tells(&wrong(&study), &["scene.dram", "there are drum, sled"]);
}

#[test]
fn settings_of_the_loop_that_cannot_be_meant_are_refused() {
    let study = with(
        "[design]\nsurface = \"box\"\nreplicates = 0\nscreening_alpha = 2\n[budget]\nruns = 3\ncore_hours = 1",
    );
    tells(
        &wrong(&study),
        &[
            "surface",
            "box-behnken",
            "replicates = 0",
            "screening_alpha",
            "keep one of both",
        ],
    );
}

#[test]
fn a_published_value_of_no_result_is_told_with_the_names_there_are() {
    let message = wrong(&with(
        "[[compare]]\nresult = \"angle of drum\"\nvalue = 38.6\nsource = \"x\"",
    ));
    tells(
        &message,
        &[
            "angle of drum",
            "F; W; angle_deg of drum at apparatus.speed = 15 rpm",
            "shown_static_friction of sled",
        ],
    );
    // Measured at two speeds: which one is meant?
    let message = wrong(&with(
        "[[compare]]\nresult = \"angle_deg of drum\"\nvalue = 38.6\nsource = \"x\"",
    ));
    tells(&message, &["angle_deg of drum at rpm = 30"]);
}

/// A parameter on which no fit depends, without a prior: the calibration itself says so.
#[test]
fn a_parameter_that_no_fit_sees_is_refused() {
    let study = changed("prior = { mean = 0.4, sd = 0.05 }", "").replacen(
        "role = \"fit\"",
        "role = \"show\"",
        1,
    );
    tells(&wrong(&study), &["parameter W", "nothing can fix it"]);
}

/// An input that is not what the scenes have, one of no effect of the library, of no scene, of a whole number, of nothing, and a
/// standard deviation below 0: each with its line, before any run.
#[test]
fn inputs_that_cannot_be_meant_are_refused() {
    let stated = "sets = [\"apparatus.inner_diameter\"]\nunit = \"mm\"\n";
    for (input, expected) in [
        (
            format!("{stated}mean = 90.0\nsd = 1.0"),
            "while the scene has 100",
        ),
        ("effect = \"fill\"\nsd = 0.1".to_owned(), "no effect 'fill'"),
        (
            "effect = \"seed-count\"\nsd = 0.1\nscenes = [\"drums\"]".to_owned(),
            "is no [[scene]]; there are drum",
        ),
        (
            "sets = [\"seed.0.count\"]\nmean = 100.0\nsd = 3.0".to_owned(),
            "effect = \"seed-count\"",
        ),
        ("sd = 0.1".to_owned(), "needs one of 'effect'"),
        (
            "effect = \"seed-count\"\nsd = -0.1".to_owned(),
            "must be 0, for an input that is exact",
        ),
        (
            "effect = \"seed-count\"\nsd = 0.1\nmean = 1.0".to_owned(),
            "belongs to an input with 'sets'",
        ),
    ] {
        let text = with(&format!("[[input]]\n{input}\n"));
        let told = Folder::new(&text).read(None).unwrap_err().to_string();
        assert!(told.contains(expected), "{input}: {told}");
        assert!(told.contains("line "), "{told}");
    }
}
