//! A scene that cannot be run is refused at the place of its fault, with limit and remedy, before anything is run.

use input::quantity::Time;
use scene::{Error, FillingLibrary, Override, Scene, run};
use std::f64::consts::PI;
use std::path::Path;

/// Forty glass beads in a small drum.
const BEADS: &str = r#"
    [apparatus]
    kind = "drum"
    inner_diameter = "40 mm"
    width = "12 mm"
    speed = "20 rpm"
    shell = "glass"
    cover = "glass"
    [[seed]]
    name = "bead"
    sphere = "4 mm"
    density = "1250 kg/m3"
    count = 40
    material = "glass"
    [material.glass]
    poisson_ratio = 0.3
    shear_modulus = "1 MPa"
    [contact.glass-glass]
    restitution = 0.5
    static_friction = 0.4
    [protocol]
    settle_limit = "0.2 s"
    rotation_limit = "1.2 s"
    frames = 3
"#;

pub(crate) fn beads(name: &str, value: &str) -> Result<Scene, Error> {
    let set = Override {
        name: name.into(),
        value: value.into(),
    };
    Scene::from_text(BEADS, "beads.toml", Path::new("."), &[set])
}

/// Every pair of kinds is worked out before the first step, even if there is no seed of them. A hundred kinds and materials are taken.
#[test]
fn more_kinds_than_can_be_worked_out_are_refused() {
    let read = |seeds: usize, materials: usize| {
        let kind = |k: usize| {
            format!(
                "[[seed]]\nname = \"k{k}\"\nsphere = \"4 mm\"\ndensity = \"1250 kg/m3\"\ncount = 0\nmaterial = \"glass\"\n"
            )
        };
        let material =
            |k: usize| format!("[material.m{k}]\npoisson_ratio = 0.3\nshear_modulus = \"1 MPa\"\n");
        let all: String = (1..seeds)
            .map(kind)
            .chain((1..materials).map(material))
            .collect();
        Scene::from_text(&format!("{BEADS}{all}"), "beads.toml", Path::new("."), &[])
    };
    assert!(read(100, 100).is_ok());
    for (seeds, materials, words) in [
        (101, 1, ["[[seed]]", "101", "at most 100 kinds"]),
        (1, 101, ["[material]", "101", "at most 100 materials"]),
    ] {
        let told = read(seeds, materials).unwrap_err().to_string();
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
    }
}

/// Each of these ran without end, took all memory, or was taken as something else.
#[test]
fn settings_that_no_run_can_have_are_refused_with_their_limit() {
    for (name, value, words) in [
        ("protocol.time_step", "1e-300 s", vec!["at least 1.4e-10 s"]),
        ("protocol.time_step", "1e-11 s", vec!["1e10 steps"]),
        ("protocol.time_step", "21 ms", vec!["at most 20 ms"]),
        ("protocol.settle_limit", "1e300 s", vec!["at most 100000 s"]),
        ("protocol.rotation_limit", "1e9 s", vec!["at most 100000 s"]),
        // 1.2 s hold six frames of 0.2 s.
        ("protocol.frames", "7", vec!["at most 6", "rotation_limit"]),
        ("protocol.frames", "1000000000", vec!["at most 6"]),
        ("protocol.frame_interval", "1e-9 s", vec!["20 ms"]),
        ("protocol.frame_interval", "50 ms", vec!["a multiple"]),
        ("seed.0.count", "1000000000", vec!["count of seed 'bead'"]),
        ("seed.0.count", "1000001", vec!["at most 1000000"]),
        // 20 mm at 1000 m/s2 are 224 rad/s.
        ("rpm", "1e9", vec!["apparatus.speed", "at most 2135 rpm"]),
        ("rpm", "-2136", vec!["at most 2135 rpm"]),
        ("model.gravity_m_s2", "1e-300", vec!["0.001 to 1000"]),
        ("ramp", "1.2 s", vec!["below protocol.rotation_limit"]),
    ] {
        let told = beads(name, value).unwrap_err().to_string();
        let path = name.rsplit('.').next().unwrap_or(name);
        assert!(told.contains("beads.toml"), "{name} = {value}: {told}");
        assert!(path == "rpm" || told.contains(path), "{told}");
        assert!(told.len() < 300, "a number of 300 digits: {told}");
        for word in words {
            assert!(told.contains(word), "{name} = {value}: {told}");
        }
    }
    for (name, value) in [
        ("protocol.time_step", "10 us"),
        ("protocol.frames", "6"),
        ("protocol.frame_interval", "60 ms"),
        ("rpm", "2135"),
    ] {
        let scene = beads(name, value);
        assert!(scene.is_ok(), "{name} = {value}: {scene:?}");
    }
}

/// Tables and names of files contain the names of a scene; one that would break a line is refused.
#[test]
fn names_that_break_a_table_are_refused() {
    for name in ["", " ", "a\\nb", "a, b", "a\\u0000", "a\\\"b"] {
        let text = BEADS.replace("name = \"bead\"", &format!("name = \"{name}\""));
        let told = Scene::from_text(&text, "beads.toml", Path::new("."), &[]).unwrap_err();
        let told = told.to_string();
        assert!(told.contains("beads.toml: seed.name is"), "{name}: {told}");
        assert!(!told.contains('\n'), "{told}");
    }
    let dashed = BEADS.replace("glass", "crown-glass");
    let told = Scene::from_text(&dashed, "beads.toml", Path::new("."), &[]).unwrap_err();
    let told = told.to_string();
    assert!(
        told.contains("material is \"crown-glass\"") && told.contains("without '-'"),
        "{told}"
    );
    let text = BEADS.replace("name = \"bead\"", "name = \"soy bean (dry) 7.2 mm\"");
    assert!(Scene::from_text(&text, "beads.toml", Path::new("."), &[]).is_ok());
}

/// The numbers of several kinds are added without overflow, and a number that follows from a mass is as one that is stated.
#[test]
fn many_seeds_are_refused_however_they_are_stated() {
    let told = beads("seed.0.count", &u64::MAX.to_string()).unwrap_err();
    assert!(told.to_string().contains("count"), "{told}");
    let text = BEADS.replace("count = 40", "total_mass = \"1e6 kg\"");
    let read = |text: &str| Scene::from_text(text, "beads.toml", Path::new("."), &[]);
    let told = read(&text).unwrap_err().to_string();
    assert!(told.contains("total_mass of seed 'bead'"), "{told}");
    let kind = BEADS.split_once("[[seed]]").unwrap().1;
    let kind = kind.split_once("[material").unwrap().0;
    let many = kind.replace("count = 40", "count = 600000");
    let other = many.replace("\"bead\"", "\"other\"");
    let text = BEADS.replace(kind, &format!("{many}[[seed]]{other}"));
    let told = read(&text).unwrap_err().to_string();
    assert!(told.contains("sum of the seeds is 1200000"), "{told}");
    let mut scene = beads("rpm", "20").unwrap();
    scene.set_seed_count(usize::MAX);
    assert_eq!(scene.seed_count(), usize::MAX, "40 of 40 shares of it");
}

/// What follows from the materials: beads of 1 Pa would sink into each other under the weight of their bed, a share of next to
/// nothing of a hard contact never ends, and the step of soft boulders is longer than the time after which the bed is looked at.
#[test]
fn what_no_run_can_have_is_refused_before_it() {
    let refused = |scene: &Scene, words: [&str; 3]| {
        let told = run(scene, &FillingLibrary::default(), 1).unwrap_err();
        let told = told.to_string();
        for word in words {
            assert!(told.contains(word), "{word}: {told}");
        }
    };
    let soft = beads("material.glass.shear_modulus", "1 Pa").unwrap();
    refused(&soft, ["beads.toml", "shear_modulus", "at least 2.6e2 Pa"]);
    let endless = beads("protocol.step_share", "1e-300").unwrap();
    refused(&endless, ["beads.toml", "shear_modulus", "1e10 steps"]);
    let text = BEADS
        .replace("\"4 mm\"", "\"40 cm\"")
        .replace("\"40 mm\"", "\"4 m\"")
        .replace("\"12 mm\"", "\"1.2 m\"")
        .replace("\"1 MPa\"", "\"0.03 MPa\"");
    let boulders = Scene::from_text(&text, "beads.toml", Path::new("."), &[]).unwrap();
    refused(&boulders, ["beads.toml", "shear_modulus", "at most 20 ms"]);
}

/// Beads of 20 kPa: the step is that of a sphere of 2/7 of its mass at twelve contacts under the weight of 40^(1/3) beads, by its
/// swing time over pi, and 0.7 of it with rolling friction of type A. The moduli are those of two equal bodies,
/// E* = G / (1 - nu) and G* = G / (4 - 2 nu). Stiff beads of 1e8 Pa take 0.36 of a hard contact, which is shorter.
#[test]
fn soft_beads_take_the_step_of_a_bed_at_rest() {
    let (mass, radius) = (1250.0 * 4.0 / 3.0 * PI * 8e-9, 1e-3_f64);
    let at_rest = |shear: f64| {
        let weight = 40_f64.cbrt() * mass * 9.81;
        let overlap = (0.75 * weight / (shear / 0.7 * radius.sqrt())).powf(2.0 / 3.0);
        let stiffness = 8.0 * shear / 3.4 * (radius * overlap).sqrt();
        (4.0 * 2.0 / 7.0 * mass / (12.0 * stiffness)).sqrt()
    };
    let step = |shear: &str, rolling: &str| {
        let text = BEADS.replace("1 MPa", shear).replace(
            "static_friction = 0.4",
            &format!("static_friction = 0.3\nrolling_friction = {rolling}"),
        );
        let scene = Scene::from_text(&text, "beads.toml", Path::new("."), &[]).unwrap();
        let result = run(&scene, &FillingLibrary::default(), 1);
        result.unwrap().time_step
    };
    let [free, hindered] = ["0", "0.1"].map(|rolling| step("20 kPa", rolling) / at_rest(2e4));
    assert!((free - 1.0).abs() < 2e-3, "{free}");
    assert!((hindered - 0.7).abs() < 2e-3, "{hindered}");
    let stiff = step("100 MPa", "0") / at_rest(1e8);
    assert!(stiff < 0.9, "{stiff}");
}

/// Grains of 1 um in a drum of 40 mm would have 1e9 places in one layer of the grid on which they are laid.
#[test]
fn seeds_too_small_for_the_apparatus_are_refused() {
    let scene = beads("seed.0.sphere", "1 um").unwrap();
    let told = run(&scene, &FillingLibrary::default(), 1).unwrap_err();
    assert!(told.to_string().contains("at most 3000"), "{told}");
}

/// The drum of the study with 16 times its seeds takes 106 MiB (docs/benchmarks.md); the estimate is of that order, and grows
/// with the frames that are kept.
#[test]
fn memory_is_estimated_to_its_order() {
    let mut scene = beads("rpm", "20").unwrap();
    scene.set_seed_count(19_200);
    let few = scene.estimated_memory();
    let measured = 113.0 * 1024.0 * 1024.0;
    assert!((0.5..2.0).contains(&(few / measured)), "{few}");
    scene.protocol.rotation_limit = Time::from_si(1000.0).unwrap();
    scene.protocol.frames = 5000;
    assert!(scene.estimated_memory() > 10.0 * few);
}

/// A usual slip of TOML is reported with its line and what to write instead; any other fault with the words of the parser alone.
#[test]
fn a_usual_slip_is_reported_with_its_remedy() {
    for (instead, words) in [
        ("0,04", "; write decimals with a point"),
        ("40 mm", "; write it in quotes, \"40 mm\""),
        ("\"40 mm\" \"50 mm\"", "expected newline"),
    ] {
        let text = BEADS.replacen("\"40 mm\"", instead, 1);
        let line = 1 + text[..text.find(instead).unwrap()].matches('\n').count();
        let read = Scene::from_text(&text, "beads.toml", Path::new("."), &[]);
        let message = read.expect_err(instead).to_string();
        for word in ["beads.toml", &format!("line {line},"), words] {
            assert!(message.contains(word), "{instead}: {message}");
        }
        assert_eq!(
            message.contains("; write"),
            words.starts_with(';'),
            "{message}"
        );
    }
}

/// A wrong setting of the apparatus is reported with its key and the kind, not only with the line of its table; so is one
/// that is set from outside.
#[test]
fn a_wrong_setting_of_the_apparatus_is_reported_with_its_key() {
    let read = |text: &str| Scene::from_text(text, "beads.toml", Path::new("."), &[]);
    let kind = "kind = \"drum\"\n";
    for (line, instead, words) in [
        (
            "\"40 mm\"",
            "40",
            ["inner_diameter of the drum", "40 has no unit"],
        ),
        ("\"20 rpm\"", "\"20 rpn\"", ["speed of the drum", "\"rpn\""]),
        ("shell =", "shel =", ["unknown field `shel`", "`shell`"]),
        ("width = \"12 mm\"\n", "", ["drum", "missing field `width`"]),
        ("\"drum\"", "\"drm\"", ["`drm`", "`drum`"]),
        ("\"drum\"", "3", ["kind = 3", "drum"]),
        (kind, "", ["kind is missing", "box-collapse"]),
    ] {
        let text = BEADS.replacen(line, instead, 1);
        assert_ne!(text, BEADS, "{line}");
        let message = read(&text).expect_err(line).to_string();
        for word in ["beads.toml", "[apparatus]"].iter().chain(&words) {
            assert!(message.contains(word), "{line}: {message}");
        }
    }
    let message = beads("apparatus.width", "12").expect_err("no unit");
    assert!(
        message.to_string().contains("width of the drum"),
        "{message}"
    );
}
