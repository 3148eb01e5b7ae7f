//! What a request represents, and what its key is made of.

use campaign::run_store::Store;
use campaign::{Campaign, RunRequest, Silent, Simulator as _, SimulatorError};
use dev_support::fixture_files::fixture;
use scene::{Override, Scene};
use serde_json::Value;
use simulators::scene_simulator::{Binding, Error, NOT_STEADY, RunDetails, SceneSimulator};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A fixture with settings changed.
fn scene(name: &str, changes: &[(&str, &str)]) -> Scene {
    let changes: Vec<Override> = changes
        .iter()
        .map(|(name, value)| Override {
            name: (*name).into(),
            value: (*value).into(),
        })
        .collect();
    Scene::read(&fixture(name), &changes).expect("the fixture is sound")
}

/// What the key of a request is made of.
fn inputs_of(simulator: &SceneSimulator, request: &RunRequest) -> Result<Value, SimulatorError> {
    simulator.prepare(request)?.inputs()
}

/// A drum of 56 coarse seeds that turns too shortly to be steady.
fn small_drum() -> Scene {
    scene(
        "cotton/drum.toml",
        &[
            ("apparatus.inner_diameter", "70 mm"),
            ("apparatus.width", "14 mm"),
            ("seed.0.count", "50"),
            ("seed.1.count", "6"),
            ("seed.0.filling.sphere_radius", "0.8 mm"),
            ("seed.0.filling.sphere_count", "20"),
            ("seed.1.filling.sphere_radius", "0.8 mm"),
            ("seed.1.filling.sphere_count", "16"),
            ("protocol.frames", "3"),
            ("protocol.start_slope", "20 deg"),
            ("time_s", "0.8"),
        ],
    )
}

/// A sled of the same seeds on a plate of the same seeds, two pulls.
fn sled(drum: &Scene) -> Scene {
    let plate = scene::Slider {
        plate: "seed".into(),
        seed: None,
        repeats: 2,
    };
    drum.in_apparatus(scene::Apparatus::Slider(plate))
        .expect("the drum has such seeds")
}

/// Friction of seeds on seeds (F), of seeds on the two walls (W), and the speed of the drum (N).
fn bindings() -> BTreeMap<String, Binding> {
    let walls = ["tough_resin", "clear_resin"].map(|m| format!("contact.seed-{m}.static_friction"));
    [
        ("F", Binding::of_path("contact.seed-seed.static_friction")),
        (
            "W",
            Binding {
                paths: walls.into(),
                unit: None,
            },
        ),
        (
            "N",
            Binding {
                paths: vec!["apparatus.speed".into()],
                unit: Some("rpm".into()),
            },
        ),
    ]
    .map(|(symbol, binding)| (symbol.to_owned(), binding))
    .into()
}

/// The drum and the sled under the symbols of [`bindings`].
fn drum_and_sled() -> SceneSimulator {
    let drum = small_drum();
    let models = BTreeMap::from([("sled".into(), sled(&drum)), ("drum".into(), drum)]);
    SceneSimulator::new(models, bindings()).expect("the drum has all paths")
}

/// A symbol sets all its paths, with its unit, in the scenes that have them; a scene that has none of them is the
/// same run whatever the value. Two models of equal content are the same run.
#[test]
fn a_symbol_sets_all_its_paths_where_they_are() {
    let simulator = drum_and_sled();
    let drum = RunRequest::new("drum", 1);
    let set = drum
        .clone()
        .with_parameter("F", 0.41)
        .with_parameter("W", 0.27)
        .with_parameter("N", 23.0);
    let scene = simulator.scene_of(&set).unwrap();
    let friction = |pair: &str| scene.contact[pair].static_friction.get();
    assert_eq!(friction("seed-seed"), 0.41);
    assert_eq!(friction("seed-tough_resin"), 0.27);
    assert_eq!(friction("seed-clear_resin"), 0.27);
    let rpm = scene.apparatus.speed() * 60.0 / std::f64::consts::TAU;
    // The unit is turned to SI and back: rounding.
    assert!((rpm - 23.0).abs() < 1e-12, "{rpm}");

    let pull = RunRequest::new("sled", 1);
    let inputs = |request: &RunRequest| inputs_of(&simulator, request).unwrap();
    assert_eq!(
        inputs(&pull),
        inputs(&pull.clone().with_parameter("W", 0.27))
    );
    assert_eq!(
        inputs(&pull),
        inputs(&pull.clone().with_parameter("N", 23.0))
    );
    assert_ne!(
        inputs(&pull),
        inputs(&pull.clone().with_parameter("F", 0.41))
    );
    assert_ne!(
        inputs(&drum),
        inputs(&drum.clone().with_parameter("W", 0.27))
    );

    // Without an effect that drifts, the time in the session moves nothing.
    assert_eq!(
        inputs(&drum),
        inputs(&drum.clone().with_condition("session", 0.5))
    );

    let twice = BTreeMap::from([("a".into(), small_drum()), ("b".into(), small_drum())]);
    let twice = SceneSimulator::new(twice, BTreeMap::new()).unwrap();
    let of = |model: &str| inputs_of(&twice, &RunRequest::new(model, 1)).unwrap();
    assert_eq!(of("a"), of("b"));
    assert_eq!(
        of("a"),
        inputs(&drum),
        "other scenes are not part of the inputs"
    );
}

/// The inputs follow the bytes of the scene's own meshes and nothing of other scenes, though both write the same
/// path; the version stays. A mesh that is not there is reported with the file that names it.
#[test]
fn the_inputs_follow_the_own_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let base = small_drum();
    let meshes: Vec<PathBuf> = base.shape_files().into_iter().map(Into::into).collect();
    let write = |of: &str, text: &str| {
        for mesh in &meshes {
            let path = folder.path().join(of).join("scenes").join(mesh);
            std::fs::create_dir_all(folder.path().join(of).join("scenes")).unwrap();
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
    };
    let of = |name: &str| Scene {
        folder: folder.path().join(name).join("scenes"),
        ..base.clone()
    };
    let models = BTreeMap::from([("a".to_owned(), of("a")), ("b".to_owned(), of("b"))]);
    let make = || SceneSimulator::new(models.clone(), BTreeMap::new());
    let refused = make().unwrap_err().to_string();
    let told = "drum.toml: mesh '../stl/cotton_ellipsoidal.stl' cannot be read";
    assert!(refused.contains(told), "{refused}");
    let mut inputs = Vec::new();
    for (a, b) in [("one", "one"), ("two", "one"), ("one", "two")] {
        write("a", a);
        write("b", b);
        let simulator = make().unwrap();
        let of = |model: &str| inputs_of(&simulator, &RunRequest::new(model, 1)).unwrap();
        inputs.push([of("a"), of("b")]);
        assert_eq!(simulator.version(), drum_and_sled().version());
    }
    let [[a1, b1], [a2, b2], [a3, b3]] = &inputs[..] else {
        panic!("three pairs");
    };
    assert_eq!((a1, b1), (b1, a3), "same bytes, other folder");
    assert_ne!(a1, a2);
    assert_eq!(b1, b2);
    assert_ne!(b1, b3);
    // The same file by another path.
    let mut typed = of("a");
    for seed in &mut typed.seed {
        let mesh = seed.mesh.as_mut().expect("a mesh");
        *mesh = Path::new("..").join("scenes").join(&*mesh);
    }
    let models = BTreeMap::from([("a".to_owned(), typed)]);
    let simulator = SceneSimulator::new(models, BTreeMap::new()).unwrap();
    let same = inputs_of(&simulator, &RunRequest::new("a", 1)).unwrap();
    assert_eq!(&same, a3, "same bytes, path typed otherwise");
}

/// A path that no scene has, one that holds no number, and one without its unit are reported before any request; symbols,
/// conditions and invalid values are reported by the request.
#[test]
fn what_cannot_be_meant_is_refused_with_its_name() {
    let make = |path: &str, unit: Option<&str>| {
        let binding = Binding {
            paths: vec![path.to_owned()],
            unit: unit.map(str::to_owned),
        };
        let models = BTreeMap::from([("drum".to_owned(), small_drum())]);
        SceneSimulator::new(models, BTreeMap::from([("F".to_owned(), binding)]))
    };
    let missing = make("contact.seed-sed.static_friction", None).unwrap_err();
    assert!(matches!(missing, Error::NoSetting { .. }), "{missing}");
    // A setting that does not take every number is no less there.
    assert!(make("material.seed.poisson_ratio", None).is_ok());
    for (path, unit, says) in [
        ("apparatus.speed", None, "with its unit"),
        (
            "contact.seed-seed.static_friction",
            Some("mm"),
            "without unit",
        ),
        ("seed.0.filling.method", None, "takes a number"),
    ] {
        let error = make(path, unit).unwrap_err().to_string();
        assert!(error.contains("'F'") && error.contains(says), "{error}");
    }
    let simulator = drum_and_sled();
    let drum = || RunRequest::new("drum", 1);
    for (request, says) in [
        (RunRequest::new("heap", 1), "model 'heap'"),
        (drum().with_parameter("G", 0.1), "parameter 'G'"),
        (drum().with_parameter("F", -0.1), "-0.1"),
        (drum().with_condition("seed_count", 1.5), "seed_count"),
        (drum().with_condition("height", 1.0), "condition 'height'"),
        (drum().with_effect("no-such-effect", 1.0), "no-such-effect"),
    ] {
        let error = inputs_of(&simulator, &request).unwrap_err().in_full();
        assert!(error.contains(says), "{error}");
    }
    let mut twice = bindings();
    twice.insert(
        "contact.seed-seed.static_friction".into(),
        Binding::of_path("contact.seed-seed.static_friction"),
    );
    let models = BTreeMap::from([("drum".to_owned(), small_drum())]);
    let simulator = SceneSimulator::new(models, twice).unwrap();
    let both = drum()
        .with_parameter("F", 0.1)
        .with_parameter("contact.seed-seed.static_friction", 0.2);
    let error = inputs_of(&simulator, &both).unwrap_err().in_full();
    assert!(error.contains("another parameter"), "{error}");
}

/// The expected cost follows what the work follows: seeds, repeats, the inverse of the step, and a plate of seeds costs
/// more than a smooth one. Two pulls of a coarse sled are done before a drum of 56 seeds.
#[test]
fn the_expected_cost_follows_the_work() {
    let pulls = |plate: &str, repeats: usize| {
        let test = scene::Slider {
            plate: plate.into(),
            seed: None,
            repeats,
        };
        small_drum()
            .in_apparatus(scene::Apparatus::Slider(test))
            .unwrap()
    };
    let finer = scene("cotton/drum.toml", &[("protocol.step_share", "0.18")]);
    let models = [
        ("small", small_drum()),
        ("two", pulls("tough_resin", 2)),
        ("six", pulls("tough_resin", 6)),
        ("seeds", pulls("seed", 2)),
        ("drum", scene("cotton/drum.toml", &[])),
        ("finer", finer),
    ];
    let models = models.map(|(name, scene)| (name.to_owned(), scene)).into();
    let simulator = SceneSimulator::new(models, BTreeMap::new()).unwrap();
    let cost = |request: &RunRequest| simulator.prepare(request).unwrap().cost();
    let of = |model: &str| cost(&RunRequest::new(model, 1));
    let ratio = |a: f64, b: f64, expected: f64| assert!((a / b - expected).abs() < 1e-9, "{a} {b}");
    ratio(of("six"), of("two"), 3.0);
    ratio(of("finer"), of("drum"), 2.0);
    let fewer = RunRequest::new("drum", 1).with_condition("seed_count", 600.0);
    ratio(of("drum"), cost(&fewer), 2.0);
    assert!(of("seeds") > 1.5 * of("two"));
    assert!(of("two") < of("small") && of("small") < 0.1 * of("drum"));
}

/// Another camera sees the seeds of the run before: the same observables as a simulator that moves them
/// again, to the last bit, and another angle than the camera before.
#[test]
fn another_camera_sees_the_same_motion() {
    let straight = RunRequest::new("drum", 3);
    let turned = straight.clone().with_effect("camera-roll", 3.0);
    let simulator = drum_and_sled();
    let first = simulator.run(&straight).unwrap();
    let seen = simulator.run(&turned).unwrap();
    let moved = drum_and_sled().run(&turned).unwrap();
    assert_eq!(seen.observables, moved.observables);
    assert_eq!(seen.regime, moved.regime);
    assert_ne!(
        seen.observables["angle_deg"],
        first.observables["angle_deg"]
    );
    let only_seen = |details: &serde_json::Value| details["timing"]["only_seen"].clone();
    assert_eq!(only_seen(&seen.details), true);
    assert_eq!(only_seen(&moved.details), false, "moved again");
    let other_seed = simulator.run(&turned.with_seed(4)).unwrap();
    assert_eq!(only_seen(&other_seed.details), false, "other seeds");
}

/// The record of a drum that was not steady says so in the place of its regime, and why; behind the store it has every
/// detail; that of a bench test has what it
/// shows, and neither regime nor picture nor frames. The details of another simulator are refused by the record's
/// key.
#[test]
fn records_hold_regime_and_typed_details() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let simulator = drum_and_sled();
    let requests = ["drum", "sled"].map(|model| RunRequest::new(model, 1));
    let records = Campaign::new(&store, 2, &Silent)
        .run_all(&simulator, &requests)
        .unwrap();
    let [drum, sled] = &records[..] else {
        panic!("two records");
    };
    assert_eq!(drum.regime(), Some(NOT_STEADY));
    let details = RunDetails::of(drum).unwrap();
    assert_eq!(details.steady, Some(false));
    assert!(details.doubt == Some(scene::Doubt::TooShort));
    assert!(details.frames.times_s.len() >= 2);
    let measured = drum.observable("angle_deg").unwrap().n;
    assert_eq!(details.frames.angles_deg.len(), measured);
    assert_eq!(details.timing.bodies, 56);
    assert!(details.last_frame_png_base64.is_some());
    let bodies = details.last_bodies.unwrap();
    // Eight floats a seed, four bytes each, three bytes in four letters.
    assert_eq!(
        bodies.seeds_base64.len(),
        (56 * 8 * 4_usize).div_ceil(3) * 4
    );
    assert!(
        bodies
            .kinds_base64
            .iter()
            .all(|spheres| !spheres.is_empty())
    );

    let details = RunDetails::of(sled).unwrap();
    let shown = sled.observable("shown_static_friction").unwrap();
    assert!(shown.mean > 0.0 && shown.n == 2, "{shown:?}");
    assert_eq!(sled.observables().len(), 1, "{:?}", sled.observables());
    assert_eq!(sled.regime(), None);
    assert_eq!((details.steady, details.start_up_s), (None, None));
    assert_eq!(details.froude_number, None);
    assert!(details.frames.times_s.is_empty() && details.last_frame_png_base64.is_none());
    assert_eq!(details.last_bodies, None);

    let other = drum.clone().with_details(serde_json::json!({"y": 1.0}));
    let error = RunDetails::of(&other).unwrap_err().to_string();
    assert!(error.contains(drum.key()), "{error}");
}

/// With one step for a hard contact the seeds of the small drum fly apart. Half and a quarter of it bring the run to its
/// end: its record stands under the same key, and tells each attempt and the shorter step. The step of the first attempt over
/// that of the last is a power of two, exactly.
#[test]
fn a_run_that_diverges_is_tried_again_with_half_the_step() {
    let mut drum = small_drum();
    drum.protocol.step_share = 1.0;
    let models = BTreeMap::from([("drum".to_owned(), drum)]);
    let simulator = |retries| {
        let simulator = SceneSimulator::new(models.clone(), BTreeMap::new());
        simulator.expect("a sound scene").with_retries(retries)
    };
    let request = RunRequest::new("drum", 1);
    let error = simulator(0).run(&request).unwrap_err().in_full();
    assert!(error.contains("time step"), "{error}");
    assert!(!error.contains("tried before"), "{error}");
    let patient = simulator(4);
    let (key, again) = (
        inputs_of(&simulator(0), &request),
        inputs_of(&patient, &request),
    );
    assert_eq!(key.unwrap(), again.unwrap());
    let outcome = patient.run(&request).unwrap();
    let timing = &outcome.details["timing"];
    let retried = timing["retried"].as_array().expect("attempts");
    assert_eq!(retried[0], error);
    let step = timing["settling_time_step_s"].as_f64().unwrap();
    let (_, behind) = error
        .split_once("the time step of ")
        .expect("the step of the first");
    let first: f64 = behind.split(' ').next().unwrap().parse().unwrap();
    assert_eq!(first / step, f64::from(1_u32 << retried.len()));
}

/// A drum of 56 seeds, each 1.5 times as large, is one of 17: the bed of the request, and its key.
#[test]
fn coarser_seeds_are_a_parameter_of_a_request() {
    let models = BTreeMap::from([("drum".to_owned(), small_drum())]);
    let simulator = SceneSimulator::new(models, bindings()).unwrap();
    let simulator = simulator.with_coarse_graining("coarser");
    let of = |factor| RunRequest::new("drum", 1).with_parameter("coarser", factor);
    let coarse = simulator.scene_of(&of(1.5)).unwrap();
    // 50 / 1.5³ = 14.8 and 6 / 1.5³ = 1.8.
    assert_eq!(coarse.seed_count(), 17);
    assert_eq!(coarse.seed[0].scale, Some(1.5));
    assert_ne!(
        inputs_of(&simulator, &of(1.5)).unwrap(),
        inputs_of(&simulator, &RunRequest::new("drum", 1)).unwrap()
    );
    for factor in [0.0, f64::NAN] {
        let refused = simulator.scene_of(&of(factor)).unwrap_err().to_string();
        assert!(refused.contains("times as large"), "{refused}");
    }
}
