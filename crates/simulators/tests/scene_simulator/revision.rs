//! The revision of the physics, which is part of the key of every record, belongs to these numbers.

use campaign::run_store::Record;
use campaign::{RunRequest, Simulator as _};
use scene::{FillingLibrary, Override, Scene, run};
use simulators::scene_simulator::SceneSimulator;
use std::collections::BTreeMap;
use std::path::Path;

/// The revision for which the numbers below hold. A change of any of them is a change of the physics: old records then lie, and
/// the revision in `simulator.rs` must be raised with the numbers here.
const REVISION: &str = "physics 21";

/// Numbers are reported with nine digits. Processors without the same vector registers round otherwise; over these few contacts that
/// stays below this share, and no law, step or seed of randomness can be changed by so little.
const ROUNDING: f64 = 1e-6;

/// Coordinates and speeds that cancel in a sum are rounded as one of this size, m or m/s.
const LEAST: f64 = 0.01;

/// Beads and a flat grain, both in closed form, on glass and on each other.
const SCENE: &str = r#"
    [apparatus]
    APPARATUS
    [[seed]]
    name = "bead"
    sphere = "4 mm"
    density = "1250 kg/m3"
    count = 6
    material = "seed"
    GRAIN
    [material.seed]
    poisson_ratio = 0.3
    shear_modulus = "2 MPa"
    [material.glass]
    poisson_ratio = 0.25
    shear_modulus = "50 MPa"
    [contact.seed-seed]
    restitution = 0.5
    static_friction = 0.4
    rolling_friction = 0.05
    [contact.seed-glass]
    restitution = 0.6
    static_friction = 0.3
    rolling_friction = 0.02
    [protocol]
    settle_limit = "0.1 s"
    rotation_limit = "0.2 s"
    frame_interval = "0.02 s"
    frames = 2
"#;

/// The flat grain.
const GRAIN: &str = r#"
    [[seed]]
    name = "grain"
    ellipsoid = ["6 mm", "4 mm", "3 mm"]
    mass = "60 mg"
    count = 4
    material = "seed"
"#;

/// The scene in an apparatus, with other seeds beside the beads.
fn scene_with(others: &str, apparatus: &str, set: &[(&str, &str)]) -> Scene {
    let text = SCENE
        .replace("APPARATUS", apparatus)
        .replace("GRAIN", others);
    let set: Vec<Override> = set
        .iter()
        .map(|(name, value)| Override {
            name: (*name).into(),
            value: (*value).into(),
        })
        .collect();
    Scene::from_text(&text, "revision.toml", Path::new("."), &set).expect("a scene")
}

/// The scene in an apparatus.
fn scene(apparatus: &str, set: &[(&str, &str)]) -> Scene {
    scene_with(GRAIN, apparatus, set)
}

/// What a bench test shows, by the simulator that writes the records.
fn shown(apparatus: &str, observable: &str) -> f64 {
    let scenes = BTreeMap::from([("test".to_owned(), scene(apparatus, &[]))]);
    let simulator = SceneSimulator::new(scenes, BTreeMap::new()).expect("a simulator");
    assert!(
        simulator.version().ends_with(REVISION),
        "{}",
        simulator.version()
    );
    let outcome = simulator.run(&RunRequest::new("test", 3)).expect("runs");
    outcome.observables[observable].mean
}

/// Sum of all coordinates (m) and speeds (m/s) at the end of a run, which every force on the way has moved.
fn moved(scene: &Scene) -> f64 {
    let result = run(scene, &FillingLibrary::default(), 3);
    let result = result.expect("runs");
    let last = result.frames.last().expect("a frame");
    let places: f64 = last.position.iter().map(|p| p.x + p.y + p.z).sum();
    let speeds: f64 = last.velocity.iter().map(|p| p.x + p.y + p.z).sum();
    places + speeds
}

/// Fails unless these numbers are the pinned ones.
fn belong_to_the_revision(found: &[(&str, f64)], pinned: &[f64]) {
    assert_eq!(found.len(), pinned.len());
    let others: Vec<String> = found
        .iter()
        .zip(pinned)
        .filter(|((_, found), pinned)| {
            let is_pinned = (found - *pinned).abs() <= ROUNDING * f64::max(pinned.abs(), LEAST);
            !is_pinned
        })
        .map(|((name, found), pinned)| format!("{name}: {found:.9e} and not {pinned:.9e}"))
        .collect();
    assert!(
        others.is_empty(),
        "{others:#?}\nIf the physics was meant to change, raise REVISION in scene-simulator and pin the new numbers here; if \
         not, old records would lie"
    );
}

/// Tiny bench tests give the numbers of their revision.
#[test]
fn the_revision_belongs_to_the_bench_tests() {
    let bench = |kind: &str, further: &str| {
        format!("kind = \"{kind}\"\nplate = \"glass\"\nseed = \"grain\"\nrepeats = 2\n{further}")
    };
    let found = [
        (
            "drop",
            shown(&bench("drop", "height = \"50 mm\""), "shown_restitution"),
        ),
        (
            "slider",
            shown(&bench("slider", ""), "shown_static_friction"),
        ),
        (
            "slider on seeds",
            shown(
                &bench("slider", "").replace("glass", "seed"),
                "shown_static_friction",
            ),
        ),
        ("tilt", shown(&bench("tilt", ""), "shown_rolling_friction")),
    ];
    let pinned = [
        6.085447144e-1,
        3.000000000e-1,
        4.051437609e-1,
        3.055001783e-1,
    ];
    belong_to_the_revision(&found, &pinned);
}

/// Tiny runs that go through the laws of contact, rolling and liquid, walls, meshes, filling, placement and time step give the
/// numbers of their revision.
#[test]
fn the_revision_belongs_to_the_beds() {
    let drum = "kind = \"metering\"\ninner_diameter = \"40 mm\"\nwidth = \"14 mm\"\nspeed = \"30 rpm\"\nplate = \"glass\"\n\
                front = \"glass\"\nboard = \"glass\"\nboard_angle = \"-20 deg\"\nboard_length = \"8 mm\"";
    let heap = "kind = \"heap\"\ninner_diameter = \"20 mm\"\nheight = \"40 mm\"\nlift_speed = \"100 mm/s\"\n\
                floor = \"glass\"\ncylinder = \"glass\"";
    let found = [
        ("turning plate", moved(&scene(drum, &[]))),
        ("heap", moved(&scene(heap, &[]))),
        ("beads alone", moved(&scene_with("", heap, &[]))),
        (
            "rolling spring",
            moved(&scene(heap, &[("model.rolling_law", "spring-dashpot")])),
        ),
        (
            "cohesion",
            moved(&scene(heap, &[("model.bond_number", "2.0")])),
        ),
    ];
    let pinned = [
        -1.420403722e-1,
        7.591251583e-2,
        -1.288765163e-2,
        9.341680822e-2,
        -3.914293413e-3,
    ];
    belong_to_the_revision(&found, &pinned);
}

/// Records of earlier builds of this revision are found again: the key of a run is theirs.
#[test]
fn the_key_of_a_run_is_that_of_earlier_builds() {
    let drop =
        "kind = \"drop\"\nplate = \"glass\"\nseed = \"grain\"\nrepeats = 2\nheight = \"50 mm\"";
    let scenes = BTreeMap::from([("test".to_owned(), scene(drop, &[]))]);
    let simulator = SceneSimulator::new(scenes, BTreeMap::new()).expect("a simulator");
    let run = simulator.prepare(&RunRequest::new("test", 3));
    let inputs = run.and_then(|run| run.inputs()).expect("a sound scene");
    let blank = Record::new(&simulator.version(), inputs, 3).expect("finite numbers");
    assert_eq!(
        blank.key(),
        "8252c815e0e6c81c9433118bf7ac6f56d372cb98208e264521167a3c5aae0072"
    );
}
