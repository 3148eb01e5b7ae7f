//! Calibrated values handed from one command to the next.

use dev_support::fixture_files::fixture;
use scene::{Override, Scene};
use simulators::scene_simulator::{CalibratedParameter, Error, ParameterFile};
use std::path::PathBuf;

/// The drum of the fixtures.
fn drum() -> Scene {
    let file = fixture("cotton/drum.toml");
    Scene::read(&file, &[]).expect("the fixture is sound")
}

/// Writes a parameter file into a folder.
fn written(folder: &tempfile::TempDir, text: &str) -> PathBuf {
    let path = folder.path().join("parameters.toml");
    std::fs::write(&path, text).expect("the folder takes a file");
    path
}

/// Every key of the file, and one parameter with the required keys alone.
const TEXT: &str = r#"
# What the study gave.
[[parameter]]
symbol = "F"
name = "static friction seed-seed"
sets = ["contact.seed-seed.static_friction", "contact.pea-pea.static_friction"]
value = 0.30000000000000004
unit = "1"
se = 0.02
interval95 = [0.25, 0.35]
fixed_by_data = true
at_limit = false

[[parameter]]
symbol = "N"
name = "speed"
sets = ["apparatus.speed"]
value = 23
unit = "rpm"
"#;

/// The settings that a scene has get the value with its unit, to the last bit; those that it lacks are skipped.
#[test]
fn the_values_of_a_file_are_set_where_the_scene_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = ParameterFile::read(&written(&folder, TEXT)).unwrap();
    let change = |name: &str, value: &str| Override {
        name: name.into(),
        value: value.into(),
    };
    let overrides = file.overrides(&drum()).unwrap();
    assert_eq!(
        overrides,
        [
            change("contact.seed-seed.static_friction", "0.30000000000000004"),
            change("apparatus.speed", "23 rpm"),
        ]
    );
    let set = drum().with(&overrides).unwrap();
    let friction = set.contact["seed-seed"].static_friction.get();
    assert_eq!(friction, 0.1 + 0.2);
}

/// Effects with which the values were calibrated are switched on: damping of the whole seed in a drum, which has no plate of seeds
/// that could give way and says so. One that the library lacks is an error that names the file.
#[test]
fn the_effects_of_a_file_are_switched_on() {
    let folder = tempfile::tempdir().unwrap();
    let effect = |name: &str| format!("[[effect]]\nname = \"{name}\"\namplitude = 0.5\n");
    let text = [TEXT, &effect("whole-seed-damping"), &effect("plate-give")].concat();
    let file = ParameterFile::read(&written(&folder, &text)).unwrap();
    let (scene, told) = file.applied(&drum()).unwrap();
    assert_eq!(scene.model.whole_seed_damping, 0.5);
    assert_eq!(scene.contact["seed-seed"].static_friction.get(), 0.1 + 0.2);
    assert!(
        told.len() == 1 && told[0].contains("plate-give"),
        "{told:?}"
    );
    let again = ParameterFile::read(&written(&folder, &file.to_toml().unwrap())).unwrap();
    assert_eq!(again, file);
    let unknown = [TEXT, &effect("ghost")].concat();
    let file = ParameterFile::read(&written(&folder, &unknown)).unwrap();
    let error = file.applied(&drum()).unwrap_err().to_string();
    assert!(
        error.contains("parameters.toml") && error.contains("ghost"),
        "{error}"
    );
}

#[test]
fn what_is_written_reads_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let read = ParameterFile::read(&written(&folder, TEXT)).unwrap();
    let first = &read.parameter[0];
    assert_eq!(first.interval95, Some([0.25, 0.35]));
    assert_eq!(
        (first.fixed_by_data, first.at_limit),
        (Some(true), Some(false))
    );
    let again = ParameterFile::read(&written(&folder, &read.to_toml().unwrap())).unwrap();
    assert_eq!(again, read);
    let short = CalibratedParameter {
        unit: None,
        se: None,
        interval95: None,
        fixed_by_data: None,
        at_limit: None,
        ..first.clone()
    };
    let short = ParameterFile {
        parameter: vec![short],
        ..ParameterFile::default()
    };
    let text = short.to_toml().unwrap();
    assert!(!text.contains("se =") && !text.contains("unit"), "{text}");
}

/// A fit that was not met says so with every use of its values, by its key, or in a file without it by its first line; so do a value
/// that the data leave open and one that the scene has no place for.
#[test]
fn what_stands_behind_the_values_is_said_with_each_use() {
    let folder = tempfile::tempdir().unwrap();
    let warnings = |text: &str| {
        let file = ParameterFile::read(&written(&folder, text)).unwrap();
        file.warnings(&drum()).unwrap()
    };
    assert_eq!(warnings(TEXT), [""; 0]);
    assert_eq!(
        warnings(&format!("met = true\nverdict = \"all is met\"\n{TEXT}")),
        [""; 0]
    );
    let verdict = "the fit does not meet angle_deg";
    for text in [
        format!("met = false\nverdict = \"{verdict}\"\n{TEXT}"),
        format!("# NOT MET: {verdict}\n\n{TEXT}"),
    ] {
        let told = warnings(&text);
        assert!(
            told.len() == 1 && told[0].ends_with(&format!("NOT MET: {verdict}")),
            "{told:?}"
        );
        let file = ParameterFile::read(&written(&folder, &text)).unwrap();
        let again = written(&folder, &file.to_toml().unwrap());
        assert_eq!(
            ParameterFile::read(&again).unwrap(),
            file,
            "the state stays with the values"
        );
    }
    let text = TEXT
        .replace("fixed_by_data = true", "fixed_by_data = false")
        .replace("seed-seed", "bean-bean");
    let told = warnings(&text).join("\n");
    assert!(
        told.contains("do not fix F") && told.contains("is not carried over: "),
        "{told}"
    );
}

/// A scene with other materials: nothing is silently left as it was.
#[test]
fn a_scene_without_any_of_the_settings_is_an_error_that_names_file_and_paths() {
    let folder = tempfile::tempdir().unwrap();
    let text = TEXT
        .replace("seed-seed", "bean-bean")
        .replace("apparatus.speed", "apparatus.tempo");
    let file = ParameterFile::read(&written(&folder, &text)).unwrap();
    let error = file.overrides(&drum()).unwrap_err();
    assert!(matches!(error, Error::NothingToSet { .. }), "{error}");
    let error = error.to_string();
    for said in [
        "parameters.toml",
        "drum.toml",
        "contact.bean-bean.static_friction",
        "apparatus.tempo",
    ] {
        assert!(error.contains(said), "{said}: {error}");
    }
}

#[test]
fn a_file_that_cannot_be_meant_is_refused_with_place_and_value() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, said) in [
        ("value = 23", "value = nan", "'N' has the value NaN"),
        ("se = 0.02", "se = -0.02", "'F' has se = -0.02"),
        ("[0.25, 0.35]", "[0.35, 0.45]", "interval95 = [0.35, 0.45]"),
        ("[\"apparatus.speed\"]", "[]", "'N' sets nothing"),
        (
            "apparatus.speed",
            "contact.seed-seed.static_friction",
            "parameter 'F' sets as well",
        ),
        ("symbol = \"F\"", "symbl = \"F\"", "symbl"),
    ] {
        assert!(TEXT.contains(from));
        let error = ParameterFile::read(&written(&folder, &TEXT.replace(from, to))).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains(said) && error.contains("parameters.toml"),
            "{said}: {error}"
        );
    }
    let file = ParameterFile::read(&written(&folder, &TEXT.replace("unit = \"rpm\"", ""))).unwrap();
    let error = file.overrides(&drum()).unwrap_err().to_string();
    assert!(
        error.contains("'N'") && error.contains("with its unit"),
        "{error}"
    );
}
