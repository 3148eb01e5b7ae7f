//! What a study file gives.

use super::folder::{Folder, STUDY, changed, right, with};
use dev_support::fixture_files::fixture;
use inference::{Role, SurfaceDesign};

#[test]
fn a_model_is_a_scene_under_a_condition_and_knows_its_parameters() {
    let study = right(STUDY);
    let models = &study.problem.models;
    let names: Vec<&str> = models.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        names,
        ["drum @ apparatus.speed = 15 rpm", "drum @ rpm = 30", "sled"]
    );
    let parameters: Vec<&[usize]> = models.iter().map(|m| m.parameters.as_slice()).collect();
    // Peas on peas: the wall is not there.
    assert_eq!(parameters, [&[0, 1][..], &[0, 1], &[0]]);
    // The scenes of what could be measured next stand beside those that were.
    assert_eq!(study.models.len(), 3 + study.problem.candidates.len());
    // 30 rpm are pi rad/s; rounding only.
    let speed = study.models["drum @ rpm = 30"].apparatus.speed();
    assert!((speed - std::f64::consts::PI).abs() < 1e-14, "{speed}");
}

#[test]
fn measurements_keep_their_order_role_and_number() {
    let study = right(STUDY);
    let measured = &study.problem.measurements;
    let all: Vec<_> = measured
        .iter()
        .map(|m| (m.model, m.observable.as_str(), m.role, m.n))
        .collect();
    let expected = [
        (0, "angle_deg", Role::Fit, 10.0),
        (0, "curvature", Role::Fit, 7.5),
        (1, "angle_deg", Role::Check, 10.0),
        (2, "shown_static_friction", Role::Fit, 5.0),
    ];
    assert_eq!(all, expected);
}

#[test]
fn what_the_file_leaves_out_is_told() {
    let study = right(STUDY);
    let of = |key: &str| {
        study
            .defaults
            .iter()
            .find(|d| d.key == key)
            .map(|d| d.value.as_str())
    };
    assert_eq!(of("parameter F: limits"), Some("0 to 2"));
    assert_eq!(of("parameter F: start"), Some("0.35"), "as in the drum");
    assert_eq!(of("parameter W: limits"), None, "stated");
    assert_eq!(of("parameter W: start"), None, "stated");
    assert_eq!(of("design.replicates"), Some("1"));
    assert_eq!(of("budget"), Some("none"));
    let [f, w] = &study.problem.parameters[..] else {
        panic!("two parameters")
    };
    assert_eq!(
        (f.start, f.limits, f.unit.as_str()),
        (0.35, [0.0, 2.0], "1")
    );
    assert_eq!((w.start, w.limits), (0.25, [0.0, 1.5]));
    assert_eq!(
        w.name, "contact.pea-wall.static_friction",
        "a name that is left out is the path"
    );
}

#[test]
fn a_profile_replaces_key_by_key_and_adds_changes() {
    let more = r#"
[design]
replicates = 2
centre_points = 5
[effects]
search = []
[budget]
runs = 300
[profile.quick]
budget = { core_hours = 2 }
design = { replicates = 3, surface = "linear" }
effects = { search = ["rolling-resistance"] }
scene.drum.changes = ["protocol.frames = 4"]
"#;
    let folder = Folder::new(&with(more));
    let (plain, quick) = (
        folder.read(None).unwrap(),
        folder.read(Some("quick")).unwrap(),
    );
    assert_eq!(
        (plain.settings.replicates, plain.settings.centre_points),
        (2, 5)
    );
    assert_eq!(
        (quick.settings.replicates, quick.settings.centre_points),
        (3, 5)
    );
    assert_eq!(quick.settings.surface, SurfaceDesign::Linear);
    assert_eq!(
        (plain.settings.most_runs, quick.settings.most_runs),
        (Some(300), None)
    );
    assert_eq!(quick.file.budget.core_hours, Some(2.0));
    assert!(
        plain.problem.effects.is_empty(),
        "an empty search switches the diagnosis off"
    );
    assert_eq!(quick.problem.effects[0].name, "rolling-resistance");
    let frames = |s: &study::Study| s.models["drum @ rpm = 30"].protocol.frames;
    assert_eq!((frames(&plain), frames(&quick)), (10, 4));
    assert_eq!(
        (plain.folder_name(), quick.folder_name()),
        ("peas".into(), "peas-quick".into())
    );
}

#[test]
fn without_a_search_the_whole_library_is_searched_or_its_refusal_told() {
    let study = right(STUDY);
    let all = study.problem.effects.len() + study.not_applicable.len();
    assert_eq!(all, simulators::effects::names().len());
    assert!(!study.problem.effects.is_empty());
}

/// Photographs of others at 15 rpm, one file: no scatter, so that the error of the reading is used instead; its
/// reading in `fixtures/photos/readings.csv` lies between chord and middle.
#[test]
fn one_photo_gives_the_angle_with_the_error_of_its_reading() {
    let photo = fixture("photos/granudrum_mccA_15rpm_avg.bmp");
    let study = right(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        &format!(
            "photos = [{photo:?}]\nphoto = {{ definition = \"line\", roll = \"0 deg\", foreground = \"dark\" }}"
        ),
    ));
    let measured = study
        .problem
        .measurements
        .iter()
        .find(|m| m.role == Role::Check)
        .unwrap();
    assert_eq!(
        (measured.observable.as_str(), measured.n),
        ("angle_deg", 1.0)
    );
    assert!((35.0..41.2).contains(&measured.mean), "{}", measured.mean);
    assert_eq!(measured.sd, study.photos[0].angle_se_deg[0]);
    let values: Vec<&String> = study.photos[0].values.keys().collect();
    assert_eq!(
        values,
        ["angle_deg"],
        "one photo shows no error of the shape"
    );
    assert!(
        study.photos[0]
            .remarks
            .iter()
            .any(|r| r.starts_with("curvature: left out"))
    );
    let hashed = study
        .inputs
        .keys()
        .any(|file| file.ends_with("granudrum_mccA_15rpm_avg.bmp"));
    assert!(hashed, "{:?}", study.inputs);
}

/// Two pictures 9 degrees apart: mean, scatter between them, and what else the ruler knows.
#[test]
fn a_folder_of_photos_gives_mean_scatter_and_shape() {
    let folder = Folder::new(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        "photos = \"photos\"",
    ));
    std::fs::create_dir(folder.path("photos")).unwrap();
    for (k, name) in [
        "granudrum_mccA_15rpm_avg.bmp",
        "granudrum_mccA_45rpm_avg.bmp",
    ]
    .iter()
    .enumerate()
    {
        let to = folder.path(&format!("photos/{k}.bmp"));
        std::fs::copy(fixture(&format!("photos/{name}")), to).unwrap();
    }
    let study = folder.read(None).unwrap();
    let names: Vec<&str> = study.photos[0].values.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        ["angle_deg", "curvature", "s_shape", "shape_4", "shape_5"]
    );
    let [a, b] = study.photos[0].angles_deg[..] else {
        panic!("two angles")
    };
    let angle = study.photos[0].values["angle_deg"];
    // Mean and sample standard deviation of two values, up to rounding.
    assert!((angle.mean - 0.5 * (a + b)).abs() < 1e-12);
    assert!((angle.sd - (a - b).abs() / 2.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(study.problem.measurements.len(), 9);
    // The scene has its fill level as an input: what the photos show of that is not an answer of the model.
    let fill = study.problem.measurements.iter();
    let fill: Vec<_> = fill.filter(|m| m.observable == "fill_level").collect();
    assert_eq!(fill.len(), 1);
    assert_eq!(fill[0].role, inference::Role::Show);
    assert_eq!(fill[0].mean, study.photos[0].further["fill_level"].mean);
}

/// Shapes that the user does not trust take no part, and the remark says so; the rest stays.
#[test]
fn observables_of_photos_are_left_out_by_name() {
    let folder = Folder::new(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        "photos = \"photos\"\nphoto = { leave_out = [\"s_shape\", \"shape_4\", \"shape_5\", \"fill_level\"] }",
    ));
    std::fs::create_dir(folder.path("photos")).unwrap();
    for rpm in [15, 45] {
        let name = format!("photos/granudrum_mccA_{rpm}rpm_avg.bmp");
        let to = folder.path(&format!("photos/{rpm}.bmp"));
        std::fs::copy(fixture(&name), to).unwrap();
    }
    let study = folder.read(None).unwrap();
    let photos = &study.photos[0];
    let names: Vec<&str> = photos.values.keys().map(String::as_str).collect();
    assert_eq!(names, ["angle_deg", "curvature"]);
    assert!(photos.further.is_empty(), "{:?}", photos.further);
    let told = photos.remarks.join("; ");
    assert!(
        told.contains("s_shape: left out, as photo.leave_out says"),
        "{told}"
    );
}

/// Every second of five photos, turned by a mark that leans by atan(10.481 / 200) = 3.000 degrees, a part of each and
/// behind a mask that hides a corner without drum: angles 3 degrees higher than as they are, to the resampling of a photo. The
/// surface falls to the right, so that a horizontal turned counter-clockwise brings it nearer to upright by as much.
#[test]
fn photos_are_read_as_the_file_says() {
    let angle = "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }";
    let as_is = Folder::new(&changed(angle, "photos = \"photos\""));
    let options =
        "level = \"20,240;220,229.519\", every = 2, region = [0, 0, 406, 400], mask = \"mask.png\"";
    let options = format!("photos = \"photos\"\nphoto = {{ {options} }}");
    let turned = Folder::new(&changed(angle, &options));
    for folder in [&as_is, &turned] {
        std::fs::create_dir(folder.path("photos")).unwrap();
        for (k, rpm) in [15, 15, 45, 45, 15].iter().enumerate() {
            let to = folder.path(&format!("photos/{k}.bmp"));
            let from = fixture(&format!("photos/granudrum_mccA_{rpm}rpm_avg.bmp"));
            std::fs::copy(from, to).unwrap();
        }
        let mut mask = image::GrayImage::from_pixel(406, 406, image::Luma([255]));
        mask.put_pixel(0, 0, image::Luma([0]));
        dev_support::drawn_pictures::save(mask, folder.path("mask.png")).unwrap();
    }
    let [as_is, turned] = [as_is, turned].map(|folder| folder.read(None).unwrap());
    let angles = &as_is.photos[0].angles_deg;
    assert_eq!(angles.len(), 5);
    let found = &turned.photos[0].angles_deg;
    assert_eq!(found.len(), 3);
    // 100 spheres of 6 mm are 11.3 cm3, in half of 157 cm3 (100 mm x 20 mm): 0.14 of the volume of the bed.
    let told = as_is.photos[0].remarks.join(" ");
    for part in [
        "3 of 5 photos are copies of others",
        "show 0.5",
        "would take 0.1",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    for (found, angle) in found.iter().zip(angles.iter().step_by(2)) {
        assert!((found - angle - 3.0).abs() < 0.2, "{found} for {angle}");
    }
    let reads = |name: &str| turned.inputs.keys().any(|file| file.ends_with(name));
    assert!(reads("mask.png") && reads("4.bmp") && !reads("3.bmp"));
}

/// A folder of two photos, of which one was turned by a quarter, with an overlay and what a system leaves beside them: two angles, that
/// add up to 90 degrees, and remarks that name the picture and what was left out.
#[test]
fn a_photo_on_its_side_is_named_and_an_overlay_is_no_photo() {
    let folder = Folder::new(&changed(
        "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }",
        "photos = \"photos\"",
    ));
    std::fs::create_dir(folder.path("photos")).unwrap();
    let drawn = dev_support::drawn_pictures::Scene {
        size: 240,
        radius: 112.0,
        inclination: 0.6,
        ..dev_support::drawn_pictures::Scene::default()
    }
    .draw();
    let settings = photo_profile::Settings::default();
    let reading = photo_profile::measure_image(&drawn, &settings).unwrap();
    let overlay = photo_profile::overlay_gray(&drawn, &reading, &settings);
    let turned = image::imageops::rotate90(&drawn);
    dev_support::drawn_pictures::save(overlay, folder.path("photos/c.png")).unwrap();
    dev_support::drawn_pictures::save(drawn, folder.path("photos/a.png")).unwrap();
    dev_support::drawn_pictures::save(turned, folder.path("photos/b.png")).unwrap();
    std::fs::write(folder.path("photos/._a.png"), "no picture").unwrap();
    let study = folder.read(None).unwrap();
    let photos = &study.photos[0];
    assert_eq!(photos.angles_deg.len(), 2, "{:?}", photos.files);
    let told = photos.remarks.join(" ");
    for part in [
        "b.png' may lie on its side",
        "1 overlay of this program (c.png)",
        "1 hidden file (._a.png)",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

/// Five copies of one photo have no scatter, and so no error; the message says why.
#[test]
fn copies_of_one_photo_are_told() {
    let angle = "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }";
    let photo = fixture("photos/granudrum_mccA_15rpm_avg.bmp");
    let five = [&photo; 5];
    let copies = changed(angle, &format!("photos = {five:?}"));
    let problems = Folder::new(&copies).read(None).unwrap_err().to_string();
    for name in ["angle_deg", "curvature"] {
        let told = format!(
            "{name}: left out, all frames show the same value: are they copies of one photo?"
        );
        assert!(problems.contains(&told), "{problems}");
    }
}

/// A photo and itself moved by a pixel agree far better than either is read: the error of their mean is the error of the
/// reading.
#[test]
fn photos_that_agree_are_not_known_better_than_they_are_read() {
    let angle = "angle_deg = { mean = 35.1, sd = 0.8, n = 10 }";
    let folder = Folder::new(&changed(angle, "photos = [\"0.bmp\", \"1.bmp\"]"));
    let photo = image::open(fixture("photos/granudrum_mccA_15rpm_avg.bmp")).unwrap();
    photo.save(folder.path("0.bmp")).unwrap();
    let mut moved = photo.to_luma8();
    image::imageops::overlay(&mut moved, &photo.to_luma8(), 1, 0);
    moved.save(folder.path("1.bmp")).unwrap();
    let study = folder.read(None).unwrap();
    let photos = &study.photos[0];
    let value = &photos.values["angle_deg"];
    let scatter = (photos.angles_deg[0] - photos.angles_deg[1]).abs() / 2.0_f64.sqrt();
    let squares = photos.angle_se_deg.iter().map(|se| se * se / 2.0);
    let read = squares.sum::<f64>().sqrt();
    assert!(scatter > 0.0 && scatter < 0.5 * read, "{scatter} {read}");
    assert!((value.sd - read).abs() < 1e-12, "{} {read}", value.sd);
    let told = photos.remarks.join(" ");
    assert!(told.contains("agree by chance"), "{told}");
}

#[test]
fn every_file_that_is_read_is_hashed() {
    let study = right(STUDY);
    let mut names: Vec<&str> = study
        .inputs
        .keys()
        .filter_map(|file| file.rsplit('/').next())
        .collect();
    names.sort_unstable();
    assert_eq!(names, ["drum.toml", "study.toml"]);
    assert!(study.inputs.values().all(|hash| hash.len() == 64));
}

#[test]
fn a_parameter_can_be_a_quantity_and_set_several_paths() {
    let study = right(&with(
        r#"
[[parameter]]
symbol = "D"
sets = ["seed.0.sphere"]
unit = "mm"
low = 5.0
high = 7.0

[[parameter]]
symbol = "E"
sets = ["contact.pea-pea.restitution", "contact.pea-wall.restitution"]
low = 0.1
high = 0.6
"#,
    ));
    let [_, _, d, e] = &study.problem.parameters[..] else {
        panic!("four parameters")
    };
    assert_eq!(
        (d.start, d.unit.as_str(), d.limits),
        (6.0, "mm", [5.0, 7.0])
    );
    assert_eq!((e.start, e.limits), (0.5, [0.001, 0.999]));
}

#[test]
fn published_values_name_parameters_observables_and_effects() {
    let more: String = [
        "F",
        "angle_deg of drum at rpm = 30",
        "curvature of drum",
        "shown_static_friction of sled",
        "effect of W on angle_deg of drum at apparatus.speed = 15 rpm",
    ]
    .map(|name| {
        format!(
            "[[compare]]\nresult = \"{name}\"\nvalue = 1.0\nsd = 0.1\nsource = \"[X, table 1]\"\n"
        )
    })
    .concat();
    let study = right(&with(&more));
    assert_eq!(study.file.compare.len(), 5);
    assert_eq!(study.file.compare[4].sd, Some(0.1));
}

/// Two inputs of one setting are two quantities if their scenes have none in common, and one too many if they do.
#[test]
fn inputs_of_different_scenes_may_set_the_same() {
    let inputs = |other: &str| {
        with(&format!(
            r#"
[[input]]
sets = ["seed.0.density"]
symbol = "one"
mean = 1300
unit = "kg/m3"
sd = 20
scenes = ["drum"]

[[input]]
sets = ["seed.0.density"]
symbol = "two"
mean = 1300
unit = "kg/m3"
sd = 30
scenes = ["{other}"]
"#
        ))
    };
    let problem = right(&inputs("sled")).problem;
    for (k, name) in ["drum", "sled"].into_iter().enumerate() {
        let of_scene = problem.models.iter().filter(|model| model.scene == name);
        for model in of_scene {
            let own = [0, 1].map(|i| model.parameters.contains(&(problem.n_tuned() + i)));
            assert_eq!(own, [k == 0, k == 1], "{}", model.name);
        }
    }
    let text = inputs("drum");
    let list = super::folder::problems(&super::folder::Folder::new(&text), None);
    assert!(
        list[0].problem.contains("parameter one sets it too"),
        "{list:?}"
    );
}

/// An input comes after the parameters, acts where it says, and has the stated value, with a range of three standard deviations; an
/// exact one is none.
#[test]
fn inputs_with_an_error_stand_behind_the_parameters() {
    let study = right(&with(
        r#"
[[input]]
effect = "seed-count"
sd = 0.02
scenes = ["drum"]

[[input]]
sets = ["apparatus.inner_diameter"]
symbol = "D"
mean = 100.0
unit = "mm"
sd = 0.5

[[input]]
effect = "seed-size"
sd = 0
"#,
    ));
    let problem = &study.problem;
    let inputs = &problem.parameters[problem.n_tuned()..];
    let names: Vec<&str> = inputs.iter().map(|p| p.symbol.as_str()).collect();
    assert_eq!(names, ["seed_count", "D"]);
    assert_eq!(inputs[1].range, [98.5, 101.5]);
    assert_eq!((inputs[1].start, inputs[1].is_input), (100.0, true));
    let acts = |model: &inference::Model| model.parameters.contains(&problem.n_tuned());
    for model in &problem.models {
        assert_eq!(acts(model), model.scene == "drum", "{}", model.name);
    }
}

/// Where photos are fitted the number and the size of the seeds have an error, unless the file says that they are exact.
#[test]
fn inputs_behind_photos_have_an_error_by_default() {
    let photo = fixture("photos/granudrum_mccA_15rpm_avg.bmp");
    let photos = format!("photos = '{}'", photo.display());
    let by_photo =
        |text: &str| text.replace("angle_deg = { mean = 35.1, sd = 0.8, n = 10 }", &photos);
    let study = right(&by_photo(STUDY));
    let problem = &study.problem;
    let sds = problem.parameters.iter().filter(|p| p.is_input);
    let sds = sds.map(|p| (p.symbol.as_str(), p.prior.unwrap().sd));
    assert_eq!(
        sds.collect::<Vec<_>>(),
        [("seed_count", 0.03), ("seed_size", 0.01)]
    );
    let told = |d: &study::DefaultUsed| d.key == "input seed-count: sd";
    assert!(study.defaults.iter().any(told));
    let exact =
        "[[input]]\neffect = \"seed-count\"\nsd = 0\n[[input]]\neffect = \"seed-size\"\nsd = 0.0\n";
    let study = right(&by_photo(&with(exact)));
    assert!(study.problem.parameters.iter().all(|p| !p.is_input));
}
