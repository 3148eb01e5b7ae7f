//! `seedloop simulate` on a scene that can be run.

use crate::tiny_scene::TinyScene;
use crate::{assert_code, assert_error, json, text};
use serde_json::Value;
use std::fs;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// A heap whose rolling friction shakes it is not said to rest, and not advised to continue: the message names the cause and the remedy, in
/// JSON and beside the result.
#[test]
fn a_heap_that_its_own_rolling_torque_drives_is_no_heap_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("heap.toml");
    let heap = r#"
        [apparatus]
        kind = "heap"
        inner_diameter = "20 mm"
        height = "40 mm"
        lift_speed = "200 mm/s"
        floor = "wall"
        cylinder = "wall"
        [[seed]]
        name = "pea"
        sphere = "4 mm"
        density = "1250 kg/m3"
        count = 30
        material = "pea"
        [material]
        pea = { poisson_ratio = 0.3, shear_modulus = "2 MPa" }
        wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
        [contact]
        pea-pea = { restitution = 0.3, static_friction = 0.6, rolling_friction = 10.0 }
        pea-wall = { restitution = 0.3, static_friction = 0.2, rolling_friction = 10.0 }
        [protocol]
        rotation_limit = "0.4 s"
    "#;
    fs::write(&file, heap).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .arg("simulate")
        .arg(&file)
        .arg("--json")
        .output()
        .unwrap();
    assert_code(&output, 0);
    let (json, told) = (json(&output), text(&output.stderr));
    assert_eq!(json["regime"], "not steady");
    assert_eq!(json["steady"], false);
    let doubt = json["doubt"].as_str().unwrap();
    assert!(doubt.contains("its own rolling torque"), "{doubt}");
    assert!(doubt.contains("spring-dashpot"), "{doubt}");
    assert!(told.contains(doubt), "{told}");
    assert!(!told.contains("Raise protocol.rotation_limit"), "{told}");
}

/// Scripts rely on these keys.
#[test]
fn a_run_gives_its_observables_parameters_timing_and_origin() {
    let scene = TinyScene::new();
    let output = scene.simulate(&[
        "protocol.start_slope=0 deg",
        "--json",
        "--quiet",
        "--seed",
        "7",
    ]);
    assert_code(&output, 0);
    assert!(output.stderr.is_empty(), "quiet says nothing");
    let json = json(&output);
    let angle = &json["observables"]["angle_deg"];
    let mean = angle["mean"].as_f64().unwrap();
    // A bed that rises on the right: between flat and vertical.
    assert!((0.0..90.0).contains(&mean), "{mean}");
    assert!(angle["sd"].is_f64(), "several frames have a spread");
    assert!(angle["n"].as_u64().unwrap() >= 2, "{}", angle["n"]);
    assert_eq!(angle["unit"], "deg");
    let timing = &json["timing"];
    assert_eq!(
        (timing["bodies"].as_u64(), timing["spheres"].as_u64()),
        (Some(40), Some(776))
    );
    let number = |name: &str| timing[name].as_f64().unwrap();
    // Each quotient of two timings, to rounding.
    let per_step = number("wall_s") * 1e6 / number("steps");
    assert!((number("us_per_step") / per_step - 1.0).abs() < 1e-9);
    let rate = number("spheres") * number("steps") / number("wall_s");
    assert!((number("sphere_steps_per_s") / rate - 1.0).abs() < 1e-9);
    assert!(
        timing.get("cpu_s").is_some(),
        "null where it is not measured, never absent"
    );
    // 0.8 s of rotation are less than the start-up and four swings of such a bed.
    assert_eq!(json["regime"], "not steady");
    assert_eq!(json["steady"], false);
    assert!(json["doubt"].as_str().unwrap().contains("four swings"));
    assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(json["seed"], 7);
    let inputs = json["inputs"].as_object().unwrap();
    assert_eq!(inputs.len(), 3, "the scene and its two meshes");
    assert!(
        inputs
            .values()
            .all(|digest| digest.as_str().unwrap().len() == 64)
    );
    let parameters = json["parameters"].as_object().unwrap();
    assert_eq!(parameters["contact.seed-seed.static_friction"], 0.10);
    assert_eq!(parameters["seed.0.count"], 34);
}

/// At 0.8 of a hard contact a step throws seeds out of this bed (seeds 1, 2 and 3 of the randomness), at 0.4 it does not: the run
/// begins again with half the step, says so while it runs, in its warnings and in its result. Without a retry it ends.
#[test]
fn a_run_that_diverges_begins_anew_with_half_the_step() {
    let scene = TinyScene::new();
    let words = ["step_share=0.8", "time_s=0.2", "frames=2", "--json"];
    let output = scene.simulate(&words);
    assert_code(&output, 0);
    let log = text(&output.stderr);
    assert!(log.contains("half the time step"), "{log}");
    let json = json(&output);
    let retried = json["timing"]["retried"].as_array().unwrap();
    assert_eq!(retried.len(), 1);
    let step = json["timing"]["time_step_s"].as_f64().unwrap();
    let first = (2.0 * step).to_string();
    assert!(retried[0].as_str().unwrap().contains(&first), "{retried:?}");
    // The time by the clock is that of both attempts, the steps are those of one.
    assert!(json["timing"]["us_per_step"].is_null());
    let output = scene.simulate(&[&words[..], &["--retries", "0"]].concat());
    assert_error(&output, &["body", "time step"]);
}

#[test]
fn settings_are_reached_by_short_name_and_by_dotted_path() {
    let scene = TinyScene::new();
    let output = scene.simulate(&[
        "--set",
        "rpm=30",
        "--set",
        "time_s=0.2",
        "--set",
        "contact.seed-seed.static_friction=0.35",
        "protocol.frames=2",
        "--json",
    ]);
    assert_code(&output, 0);
    let json = json(&output);
    // 30 rpm is pi rad/s: the Froude number is 0.035 pi^2 / 9.81, to rounding.
    let froude = 0.035 * std::f64::consts::PI.powi(2) / 9.81;
    assert!((json["froude_number"].as_f64().unwrap() / froude - 1.0).abs() < 1e-9);
    let parameters = &json["parameters"];
    assert_eq!(parameters["contact.seed-seed.static_friction"], 0.35);
    assert_eq!(parameters["protocol.frames"], 2);
    assert_eq!(json["changed"]["rpm"], "30");
    // 0.3 s of settling at most and 0.2 s of rotation, with one more interval of the series each.
    let steps = json["timing"]["steps"].as_u64().unwrap();
    assert!((2000..=5400).contains(&steps), "{steps}");
}

#[test]
fn a_record_is_kept_and_taken_again_on_resume_only() {
    let scene = TinyScene::new();
    let run = [
        "protocol.start_slope=0 deg",
        "--out",
        "results",
        "--set",
        "time_s=0.2",
        "frames=2",
    ];
    let first = scene.simulate(&[&run[..], &["--json", "first.json"]].concat());
    assert_code(&first, 0);
    let table = text(&first.stdout);
    assert!(
        table.contains("angle_deg") && table.contains("776 spheres"),
        "{table}"
    );
    let read = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(scene.path(name)).unwrap()).unwrap()
    };
    let first = read("first.json");
    let key = first["record"].as_str().unwrap();
    assert!(
        scene.path(&format!("results/runs/{key}.json")).exists(),
        "the record lies by its key"
    );

    assert_error(&scene.simulate(&run), &["--resume", "--force"]);

    let again = [
        &run[..],
        &["--resume", "--json", "again.json", "--frame", "last.png"],
    ]
    .concat();
    assert_code(&scene.simulate(&again), 0);
    let second = read("again.json");
    assert_eq!(
        (&first["reused"], &second["reused"]),
        (&false.into(), &true.into())
    );
    assert_eq!(first["observables"], second["observables"]);
    assert_eq!(
        first["timing"], second["timing"],
        "the time of the run that was done"
    );
    let picture = fs::read(scene.path("last.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG"), "the frame is a PNG");
    // A record has no arrays; the run has.
    let arrays = |more| [&run[..], &[more, "--arrays", "all.npz"]].concat();
    assert_error(&scene.simulate(&arrays("--resume")), &["--force"]);
    assert_code(&scene.simulate(&arrays("--force")), 0);
    let archive = fs::read(scene.path("all.npz")).unwrap();
    assert!(archive.starts_with(b"PK"), "NumPy reads a ZIP archive");

    let other = [&run[..], &["--resume", "--seed", "2", "--json"]].concat();
    let other = json(&scene.simulate(&other));
    assert_eq!(other["reused"], false, "another seed is another run");
}

#[test]
fn the_same_seed_gives_the_same_numbers() {
    let scene = TinyScene::new();
    let run = |seed: &str| {
        let words = [
            "time_s=0.2",
            "frames=2",
            "--seed",
            seed,
            "--json",
            "--quiet",
        ];
        json(&scene.simulate(&words))["observables"].clone()
    };
    let first = run("1");
    assert!(first["angle_deg"]["mean"].is_f64());
    assert_eq!(first, run("1"));
    assert_ne!(first, run("2"));
}

#[test]
fn files_that_exist_are_refused_before_the_run() {
    let scene = TinyScene::new();
    fs::write(scene.path("old.png"), "kept").unwrap();
    assert_error(
        &scene.simulate(&["--frame", "old.png"]),
        &["old.png", "--force"],
    );
    fs::write(scene.path("old.json"), "kept").unwrap();
    assert_error(
        &scene.simulate(&["--json", "old.json"]),
        &["old.json", "--force"],
    );
    assert_error(&scene.simulate(&["--frame", "frame.jpg"]), &[".png"]);
    assert_error(&scene.simulate(&["--arrays", "all.csv"]), &[".npz"]);
    assert_eq!(fs::read_to_string(scene.path("old.png")).unwrap(), "kept");
}

/// Two seeds in a drum show no surface: no line can be laid through their surface. What their places tell is given all the same.
#[test]
fn a_surface_that_cannot_be_measured_is_a_refusal() {
    let scene = TinyScene::new();
    let output = scene.simulate(&[
        "--set",
        "seed.0.count=1",
        "--set",
        "seed.1.count=1",
        "--set",
        "time_s=0.2",
        "--set",
        "frames=2",
        "--json",
    ]);
    assert_code(&output, 1);
    let json = json(&output);
    assert_eq!(json["verdict"], "refused");
    assert!(
        json["reason"].as_str().unwrap().contains("surface"),
        "{}",
        json["reason"]
    );
    let observables = json["observables"].as_object().unwrap();
    assert!(!observables.contains_key("angle_deg"));
    for name in ["centre_of_mass_deg", "shell_slip", "drive_power_mw"] {
        assert!(observables[name]["mean"].is_f64(), "{name}");
    }
    assert!(
        text(&output.stderr).contains("refused"),
        "told on standard error as well"
    );
}

/// A run that is killed continues from the state it kept, and gives what it gives in one go. The state is gone
/// when the record is there.
#[test]
fn a_killed_run_goes_on_from_its_state() {
    let scene = TinyScene::new();
    let words = ["--out", "out", "--keep-every", "0"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_seedloop"))
        .args(["simulate", "tiny.toml"])
        .args(words)
        .current_dir(scene.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let states = || {
        let entries = fs::read_dir(scene.path("out")).into_iter().flatten();
        let names = entries.map(|e| e.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.ends_with(".state.json")).count()
    };
    while states() == 0 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(states(), 1, "the run ended before it kept a state");
    // A third state of the run, damaged: the other is believed, and the damaged one is kept under another name.
    let entries = fs::read_dir(scene.path("out")).unwrap();
    let mut files = entries.map(|e| e.unwrap().path());
    let whole = files.find(|path| path.to_string_lossy().ends_with(".state.json"));
    let whole = whole.unwrap();
    let second = whole.with_extension("").with_extension("state-2.json");
    let mut bytes = fs::read(&whole).unwrap();
    let digit = bytes.iter().rposition(u8::is_ascii_digit).unwrap();
    bytes[digit] = b'0' + (bytes[digit] - b'0' + 1) % 10;
    fs::write(&second, &bytes).unwrap();
    let resumed = scene.simulate(&[&words[..], &["--resume", "--json=-"]].concat());
    assert!(resumed.status.success(), "{resumed:?}");
    let log = text(&resumed.stderr);
    assert!(log.contains("continues from"), "{log}");
    assert!(
        log.contains("state-2.json") && log.contains("altered"),
        "{log}"
    );
    let away = second.with_extension("json.damaged");
    assert_eq!(fs::read(away).unwrap(), bytes);
    let whole = scene.simulate(&["--json=-"]);
    let observables = |output: &Output| json(output)["observables"].clone();
    assert_eq!(observables(&resumed), observables(&whole));
    assert_eq!(states(), 0, "the state is left behind");
}

/// The values of a parameter file are set where the scene has their paths, --set comes after it, and deck and run have
/// the same ones. A file for other materials is refused.
#[test]
fn calibrated_values_are_taken_from_a_file() {
    let scene = TinyScene::new();
    let parameter = |symbol: &str, path: &str, value: &str| {
        format!(
            "[[parameter]]\nsymbol = \"{symbol}\"\nname = \"{symbol}\"\nsets = [\"{path}\"]\nvalue = {value}\n"
        )
    };
    let [friction, walls] =
        ["seed-seed", "seed-tough_resin"].map(|pair| format!("contact.{pair}.static_friction"));
    let file = [
        parameter("F", &friction, "0.47"),
        parameter("W", &walls, "0.21"),
        parameter("P", "contact.pea-pea.static_friction", "0.3"),
    ];
    fs::write(scene.path("parameters.toml"), file.concat()).unwrap();
    let set = format!("{walls}=0.22");
    let words = ["--set-file", "parameters.toml", "--set", &set, "--json=-"];
    let output = scene.simulate(&words);
    assert_code(&output, 0);
    let json = json(&output);
    assert_eq!(json["parameters"][&friction], 0.47);
    assert_eq!(json["parameters"][&walls], 0.22);
    assert_eq!(json["changed"][&friction], "0.47");
    assert_eq!(json["inputs"].as_object().unwrap().len(), 4, "{json}");
    let log = text(&output.stderr);
    let left = "P (P) = 0.3 is not carried over: tiny.toml has no contact.pea-pea.static_friction";
    assert!(log.contains(left), "{log}");
    assert!(!log.contains("F (F)"), "{log}");

    let words = ["export", "lammps", "tiny.toml", "--out", "deck"];
    let words = [&words[..], &["--set-file", "parameters.toml"]].concat();
    let export = crate::seedloop(&scene.path(""), &words);
    assert_code(&export, 0);
    assert!(text(&export.stderr).contains(left), "{export:?}");
    let deck = fs::read_to_string(scene.path("deck/in.drum")).unwrap();
    assert!(deck.contains("0.47") && deck.contains("0.21"), "{deck}");

    fs::write(scene.path("peas.toml"), &file[2]).unwrap();
    let output = scene.simulate(&["--set-file", "peas.toml"]);
    crate::assert_error(&output, &["peas.toml", "tiny.toml", "pea-pea"]);

    let verdict = "NOT MET: the fit does not meet angle_deg";
    let state = "met = false\nverdict = \"the fit does not meet angle_deg\"\n";
    fs::write(
        scene.path("parameters.toml"),
        format!("{state}{}", file.concat()),
    )
    .unwrap();
    a_fit_that_is_not_met_says_so(&scene, verdict);
}

/// Values that miss the measurements are used with a warning in the log, the JSON and the files, by every command that takes them.
fn a_fit_that_is_not_met_says_so(scene: &TinyScene, verdict: &str) {
    fs::write(scene.path("one.csv"), "rpm\n20\n").unwrap();
    let short = ["--set", "time_s=0.2", "--set", "frames=2"];
    let table = ["run", "one.csv", "--scene", "tiny.toml", "--plan"];
    for (words, file) in [
        (&["simulate", "tiny.toml"][..], None),
        (
            &["export", "lammps", "tiny.toml", "--out", "l"],
            Some("l/in.drum"),
        ),
        (
            &["export", "liggghts", "tiny.toml", "--out", "g"],
            Some("g/in.drum"),
        ),
        (
            &["export", "edem", "tiny.toml", "--out", "e"],
            Some("e/edem.csv"),
        ),
        (
            &["export", "vtk", "tiny.toml", "--out", "v"],
            Some("v/frames.pvd"),
        ),
        (
            &["export", "csv", "tiny.toml", "--out", "c"],
            Some("c/WARNING.txt"),
        ),
        (&table, None),
    ] {
        let words = [words, &["--set-file", "parameters.toml", "--json"], &short].concat();
        let output = crate::seedloop(&scene.path(""), &words);
        assert_code(&output, 0);
        let log = text(&output.stderr);
        assert!(
            log.contains(verdict) && log.contains("parameters.toml"),
            "{words:?}: {log}"
        );
        let told = json(&output)["warnings"].to_string();
        assert!(told.contains(verdict), "{words:?}: {told}");
        if let Some(file) = file {
            let written = fs::read_to_string(scene.path(file)).unwrap();
            assert!(written.contains(verdict), "{file}: {written}");
        }
    }
}

/// However a path is typed, the run is the same one: by its key where the scene says the same, and by its numbers where the scene
/// names a mesh in another way.
#[test]
fn how_a_path_is_typed_changes_no_result() {
    let scene = TinyScene::new();
    fs::create_dir(scene.path("below")).unwrap();
    let whole = scene.path("tiny.toml");
    let run = |file: &str| {
        let words = ["simulate", file, "time_s=0.2", "frames=2", "--json"];
        let output = crate::seedloop(&scene.path(""), &words);
        assert_code(&output, 0);
        json(&output)
    };
    let first = run("tiny.toml");
    for other in ["./tiny.toml", "below/../tiny.toml", whole.to_str().unwrap()] {
        assert_eq!(run(other)["record"], first["record"], "{other}");
    }
    let text = fs::read_to_string(&whole).unwrap();
    fs::write(
        &whole,
        text.replace("/cotton_flat.stl", "/./cotton_flat.stl"),
    )
    .unwrap();
    let same = run("tiny.toml");
    assert_eq!(same["observables"], first["observables"]);
    assert_eq!(same["timing"]["steps"], first["timing"]["steps"]);
}
