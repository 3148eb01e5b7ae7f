//! Other apparatus than the plain drum, bench tests, the verification table, and exports.

use crate::tiny_scene::TinyScene;
use crate::{assert_code, assert_error, json, seedloop};
use std::fs;
use std::path::Path;

/// The apparatus of the tiny scene.
const DRUM: &str = "kind = \"drum\"\ninner_diameter = \"70 mm\"\nwidth = \"14 mm\"\nspeed = \"20 rpm\"\n\
                    shell = \"tough_resin\"\ncover = \"clear_resin\"\n";

#[test]
fn a_heap_and_a_box_show_a_slope() {
    let heap = "kind = \"heap\"\ninner_diameter = \"30 mm\"\nheight = \"60 mm\"\n\
                lift_speed = \"200 mm/s\"\nfloor = \"tough_resin\"\ncylinder = \"clear_resin\"\n";
    let body = "kind = \"box-collapse\"\nlength = \"20 mm\"\nheight = \"60 mm\"\nwidth = \"16 mm\"\n\
                lift_speed = \"500 mm/s\"\nfloor = \"tough_resin\"\nwall = \"clear_resin\"\n";
    for apparatus in [heap, body] {
        let scene = TinyScene::changed(DRUM, apparatus);
        let output = scene.simulate(&["--set", "time_s=0.5", "--json", "--quiet"]);
        assert_code(&output, 0);
        let json = json(&output);
        let height = json["observables"]["height_mm"]["mean"].as_f64().unwrap();
        // No lower than the flattest seed, no higher than what the seeds were let go from.
        assert!((3.0..60.0).contains(&height), "{height} mm");
        assert_eq!(json["regime"], "resting");
    }
}

/// What a scene says that its runs can give is what they give: nothing more, and nothing less but the period of
/// avalanches, which a short series need not show, and the top of a slope that 86 seeds leave in a box.
#[test]
fn a_run_gives_the_observables_that_its_scene_names() {
    let turned = "inner_diameter = \"70 mm\"\nwidth = \"14 mm\"\nspeed = \"20 rpm\"\n";
    let metering = format!(
        "kind = \"metering\"\n{turned}plate = \"tough_resin\"\nfront = \"clear_resin\"\n\
         board = \"clear_resin\"\nboard_angle = \"-10 deg\"\nboard_length = \"20 mm\"\n"
    );
    let heap = "kind = \"heap\"\ninner_diameter = \"60 mm\"\nheight = \"100 mm\"\n\
                lift_speed = \"200 mm/s\"\nfloor = \"tough_resin\"\ncylinder = \"clear_resin\"\n";
    let body = "kind = \"box-collapse\"\nlength = \"40 mm\"\nheight = \"100 mm\"\nwidth = \"30 mm\"\n\
                lift_speed = \"500 mm/s\"\nfloor = \"tough_resin\"\nwall = \"clear_resin\"\n";
    let bench = |kind: &str| format!("kind = \"{kind}\"\nplate = \"tough_resin\"\nrepeats = 2\n");
    let drop = bench("drop") + "height = \"20 mm\"\n";
    for apparatus in [
        DRUM,
        &metering,
        heap,
        body,
        &bench("slider"),
        &drop,
        &bench("tilt"),
    ] {
        let folder = TinyScene::changed(DRUM, apparatus);
        let scene = scene::Scene::read(&folder.path("tiny.toml"), &[]).unwrap();
        let mut named: Vec<_> = scene.observables();
        // Enough for a layer that flows and a flank that can be read; half as many for half a cavity.
        let count = if apparatus == metering {
            "seed.0.count=34"
        } else {
            "seed.0.count=80"
        };
        let settings = ["--set", "time_s=1", "--set", count, "--json"];
        let output = folder.simulate(&settings);
        assert_code(&output, 0);
        let json = json(&output);
        let given: Vec<_> = json["observables"].as_object().unwrap().keys().collect();
        let may_lack = [
            "angle_correlation_time_s",
            "avalanche_period_s",
            "avalanche_size_deg",
            "avalanche_waiting_time_s",
            "top_angle_deg",
            "waiting_time_s",
        ];
        named.retain(|name| !may_lack.contains(name) || given.iter().any(|g| g == name));
        named.sort_unstable();
        assert_eq!(given, named, "{apparatus}");
        assert_eq!(json["regime"].is_null(), scene.apparatus.is_bench_test());
        let told = String::from_utf8_lossy(&output.stderr);
        let is_told = told.contains("2 repeats");
        assert_eq!(is_told, scene.apparatus.is_bench_test(), "{told}");
    }
}

#[test]
fn a_tilted_drum_with_lifters_and_a_ramp_runs() {
    let more = format!(
        "{DRUM}tilt = \"2 deg\"\nramp = \"0.1 s\"\nreverse_every = \"0.2 s\"\n\
         lifters = {{ count = 3, height = \"5 mm\", material = \"tough_resin\" }}\n"
    );
    let scene = TinyScene::changed(DRUM, &more);
    // A bed deep enough that its surface can be read between the lifters.
    let settings = ["time_s=0.3", "frames=2", "seed.0.count=60"];
    let output = scene.simulate(&[&settings[..], &["--json", "--quiet"]].concat());
    assert_code(&output, 0);
    let fill = json(&output)["observables"]["fill_level_by_position"]["mean"]
        .as_f64()
        .unwrap();
    assert!((0.02..0.6).contains(&fill), "fill level {fill}");
}

#[test]
fn lifters_that_do_not_fit_are_refused() {
    let more = format!(
        "{DRUM}lifters = {{ count = 3, height = \"40 mm\", material = \"tough_resin\" }}\n"
    );
    let scene = TinyScene::changed(DRUM, &more);
    assert_error(
        &scene.simulate(&[]),
        &["lifters.height", "0.04 m", "inner radius"],
    );
}

/// A wall from a mesh takes its material from the scene like any other.
#[test]
fn a_wall_of_an_unknown_material_or_without_a_mesh_is_named() {
    let wall = |material: &str| {
        format!(
            "[[wall]]\nname = \"baffle\"\nmesh = \"baffle.stl\"\nmesh_unit = \"mm\"\n\
             material = \"{material}\"\n\n[material.seed]"
        )
    };
    let scene = TinyScene::changed("[material.seed]", &wall("glass"));
    assert_error(&scene.simulate(&[]), &["'glass'", "clear_resin"]);
    let scene = TinyScene::changed("[material.seed]", &wall("clear_resin"));
    assert_error(&scene.simulate(&[]), &["baffle.stl"]);
}

/// A bent plate 20 mm wide in the drum, with further lines of its wall.
fn with_baffle(more: &str) -> TinyScene {
    let wall = format!(
        "[[wall]]\nname = \"baffle\"\nmesh = \"baffle.stl\"\nmesh_unit = \"mm\"\n\
         material = \"clear_resin\"\n{more}\n\n[material.seed]"
    );
    let scene = TinyScene::changed("[material.seed]", &wall);
    let facet = |a: &str, b: &str, c: &str| {
        format!(
            "facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n"
        )
    };
    let (a, b, c, d) = ("-10 0 -6", "10 0 -6", "10 3 6", "-10 0 6");
    let text = format!(
        "solid baffle\n{}{}endsolid baffle\n",
        facet(a, b, c),
        facet(a, c, d)
    );
    fs::write(scene.path("baffle.stl"), text).unwrap();
    scene
}

/// A turning bent plate in the bed takes part: the mesh is read, placed and moved.
#[test]
fn a_wall_from_a_mesh_takes_part() {
    let scene = with_baffle("spin = [\"0 rpm\", \"0 rpm\", \"30 rpm\"]");
    let output = scene.simulate(&["time_s=0.2", "frames=2", "--json", "--quiet"]);
    assert_code(&output, 0);
    let inputs = json(&output)["inputs"].as_object().unwrap().len();
    assert_eq!(inputs, 4, "the scene, two seeds and the wall");
}

/// A wall a metre away touches nothing, and one that turns a thousand million times a minute is a slip of the pen.
#[test]
fn a_wall_that_touches_nothing_or_is_too_fast_is_refused() {
    let away = with_baffle("position = [\"1 m\", \"0 m\", \"0 m\"]");
    let words = ["place of wall 'baffle'", "0.99", "position", "mesh_unit"];
    assert_error(&away.simulate(&["--quiet"]), &words);
    let fast = with_baffle("spin = [\"0 rpm\", \"0 rpm\", \"1e9 rpm\"]");
    let words = ["tiny.toml", "spin", "wall 'baffle'", "at most 100 m/s"];
    assert_error(&fast.simulate(&["--quiet"]), &words);
}

/// Beads that slide on a smooth shell: Coulomb friction damps no swing, so that a bed that was started at once swings on until
/// the end and is carried again and again. A warning says so and gives the remedy, which helps.
#[test]
fn a_bed_that_swings_on_from_its_start_is_told_to_start_evenly() {
    let folder = tempfile::tempdir().unwrap();
    let beads = r#"
        apparatus = { kind = "drum", inner_diameter = "50 mm", width = "12 mm", speed = "15 rpm", shell = "acrylic", cover = "acrylic" }
        [[seed]]
        name = "bead"
        sphere = "4 mm"
        density = "1300 kg/m3"
        fill_level = 0.3
        material = "bead"
        [material]
        bead = { poisson_ratio = 0.3, shear_modulus = "0.5 MPa" }
        acrylic = { poisson_ratio = 0.35, shear_modulus = "10 MPa" }
        [contact]
        bead-bead = { restitution = 0.5, static_friction = 0.8 }
        bead-acrylic = { restitution = 0.5, static_friction = 0.1 }
    "#;
    fs::write(folder.path().join("beads.toml"), beads).unwrap();
    let run = |more: &[&str]| {
        let output = seedloop(
            folder.path(),
            &[&["simulate", "beads.toml", "--json"], more].concat(),
        );
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        (json(&output)["motion"].clone(), told)
    };
    let (motion, told) = run(&[]);
    assert_eq!(motion, "surging");
    assert!(told.contains("apparatus.ramp"), "{told}");
    let (motion, told) = run(&["--set", "ramp=2 s", "--set", "rotation_limit=12 s"]);
    assert_eq!(motion, "sliding");
    assert!(!told.contains("ramp"), "{told}");
}

#[test]
fn bench_measurements_become_a_coefficient_with_its_interval() {
    let folder = tempfile::tempdir().unwrap();
    let table = "drop_height_mm,rebound_height_mm\n400,4\n400,16\n400,36\n";
    fs::write(folder.path().join("drop.csv"), table).unwrap();
    let output = seedloop(folder.path(), &["bench-test", "drop", "drop.csv", "--json"]);
    assert_code(&output, 0);
    let json = json(&output);
    // 0.1, 0.2 and 0.3: mean 0.2, sd 0.1.
    assert!((json["mean"].as_f64().unwrap() - 0.2).abs() < 1e-12);
    assert!((json["sd"].as_f64().unwrap() - 0.1).abs() < 1e-12);
    assert_eq!(json["coefficient"], "restitution");
    assert_error(
        &seedloop(folder.path(), &["bench-test", "tilt", "drop.csv"]),
        &["drop.csv", "angle_deg"],
    );
}

/// A plate that the scene does not define is reported with all materials that it does, and a bench test has no frame to show;
/// both before anything runs.
#[test]
fn what_a_bench_test_cannot_have_is_refused_before_it_runs() {
    let sled = "kind = \"slider\"\nplate = \"tough_resin\"\nrepeats = 2\n";
    let scene = TinyScene::changed(DRUM, sled);
    for words in [["--frame", "a.png"], ["--arrays", "a.npz"]] {
        let output = scene.simulate(&words);
        assert_error(&output, &[words[0], words[1], "bench test"]);
        assert!(!String::from_utf8_lossy(&output.stderr).contains("running"));
    }
    let words = ["bench-test", "tilt", "--scene", "tiny.toml"];
    let words = [&words[..], &["--plate", "wood", "--repeats", "2"]].concat();
    let output = seedloop(scene.path("").as_path(), &words);
    assert_error(&output, &["'wood'", "clear_resin, seed, tough_resin"]);
    let of = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        seedloop(scene.path("").as_path(), &words)
    };
    assert_error(&of("bench-test drop"), &["DATA.csv", "--scene SCENE.toml"]);
    let low = "bench-test drop --scene tiny.toml --plate tough_resin --height-mm -5";
    assert_error(&of(low), &["height", "-0.005 m"]);
}

/// A sled on a smooth plate shows the friction of its spheres, whatever their number: Coulomb's law;
/// 1 % is what still swings.
#[test]
fn simulated_sled_shows_the_friction_that_was_put_in() {
    let scene = TinyScene::new();
    let words = [
        "bench-test",
        "slider",
        "--scene",
        "tiny.toml",
        "--plate",
        "tough_resin",
    ];
    let words = [&words[..], &["--repeats", "2", "--json"]].concat();
    let output = seedloop(scene.path("").as_path(), &words);
    assert_code(&output, 0);
    let json = json(&output);
    let (mean, put_in) = (
        json["mean"].as_f64().unwrap(),
        json["put_in"].as_f64().unwrap(),
    );
    assert!(
        (mean / put_in - 1.0).abs() < 0.01,
        "{mean} against {put_in}"
    );
}

#[test]
fn verification_prints_its_rows_and_refuses_unknown_names() {
    let here = Path::new(".");
    let output = seedloop(here, &["verify", "--only", "laws", "--json"]);
    assert_code(&output, 0);
    let json = json(&output);
    assert_eq!(json["failed"], 0);
    assert_eq!(json["rows"][0]["verdict"], "PASS");
    assert_error(
        &seedloop(here, &["verify", "--only", "magic"]),
        &["magic", "slip-to-roll"],
    );
}

#[test]
fn a_scene_is_exported_for_lammps_paraview_and_fluid_solvers() {
    let scene = TinyScene::new();
    let folder = scene.path("");
    let export = |format: &str, more: &[&str]| {
        let words = ["export", format, "tiny.toml", "--out", format];
        seedloop(&folder, &[&words[..], more].concat())
    };
    assert_code(&export("lammps", &[]), 0);
    let bodies = fs::read_to_string(scene.path("lammps/drum.bodies")).unwrap();
    let seeds: usize = bodies.lines().next().unwrap().parse().unwrap();
    assert_eq!(bodies.lines().count(), seeds + 1, "one line a seed");
    assert_error(&export("lammps", &[]), &["exists", "--force"]);

    assert_code(
        &export("vtk", &["--set", "time_s=0.2", "--set", "frames=2"]),
        0,
    );
    let list = fs::read_to_string(scene.path("vtk/frames.pvd")).unwrap();
    let frame = fs::read_to_string(scene.path("vtk/frames_0000.vtp")).unwrap();
    assert!(list.contains("frames_0000.vtp"), "{list}");
    for array in ["radius", "volume", "velocity", "body", "kind", "material"] {
        assert!(
            frame.contains(&format!("Name=\"{array}\"")),
            "no array {array}"
        );
    }

    assert_code(
        &export("csv", &["--set", "time_s=0.2", "--set", "frames=2"]),
        0,
    );
    let table = fs::read_to_string(scene.path("csv/frames_0000.csv")).unwrap();
    let mut rows = table.lines();
    assert_eq!(
        rows.next(),
        Some("time_s,body,kind,material,x_m,y_m,z_m,radius_m,volume_m3,vx_m_s,vy_m_s,vz_m_s")
    );
    let points = format!("NumberOfPoints=\"{}\"", rows.count());
    assert!(frame.contains(&points), "both hold the same spheres");
}

/// What a deck cannot carry is refused, with the setting to remove; nothing is left out silently.
#[test]
fn what_a_deck_cannot_carry_is_refused() {
    for (from, to, named) in [
        ("bond_number = 0.0", "bond_number = 1.0", "bond_number"),
        (
            "restitution = 0.06",
            "restitution = 0.06\nattraction_n = 1e-5",
            "attraction_n",
        ),
        (
            "restitution = 0.06",
            "restitution = 0.06\ncohesion_energy_density_j_m3 = 1e4",
            "cohesion_energy_density_j_m3",
        ),
        (
            "[model]",
            "[surroundings]\nair_drag = 1.0\n\n[model]",
            "surroundings",
        ),
    ] {
        let scene = TinyScene::changed(from, to);
        let words = ["export", "lammps", "tiny.toml", "--out", "deck"];
        let output = seedloop(scene.path("").as_path(), &words);
        assert_error(&output, &["LAMMPS", named]);
        assert!(
            !scene.path("deck").exists(),
            "a deck without {named} was written"
        );
    }
}

/// A bench is written with its walls and starts from a script that says how it is run; an apparatus that decks do not have is refused by its
/// name before anything is written.
#[test]
fn benches_are_written_as_decks_or_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let export = |format: &str, scene: &str, out: &str| {
        let scene = dev_support::fixture_files::fixture(scene);
        let words = ["export", format, scene.to_str().unwrap(), "--out", out];
        seedloop(folder.path(), &words)
    };
    assert_code(&export("lammps", "benches/hopper.toml", "l"), 0);
    assert_code(&export("liggghts", "benches/poured-heap.toml", "g"), 0);
    let at = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    // The deck has not run.
    let scene = dev_support::fixture_files::fixture("benches/hopper.toml");
    let words = ["read-deck", scene.to_str().unwrap(), "l"];
    assert_error(&seedloop(folder.path(), &words), &["l/0-filling.dump"]);
    assert!(
        at("l/in.bench").contains("run it with -in") && at("l/bench.data").contains("900 atoms")
    );
    assert!(
        at("g/in.bench").contains("insert/rate/region")
            && at("g/disc.stl").starts_with("solid disc")
    );
    for (scene, named) in [
        ("cotton/metering.toml", "the apparatus 'metering'"),
        ("benches/bulk-density.toml", "an outlet"),
    ] {
        for (format, tool) in [("lammps", "LAMMPS"), ("liggghts", "LIGGGHTS")] {
            assert_error(&export(format, scene, "none"), &[named, tool]);
        }
    }
    assert!(!folder.path().join("none").exists());
}

/// A heap is drawn from the side, and its results are written beside.
#[test]
fn a_heap_has_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let heap = r#"
        apparatus = { kind = "heap", inner_diameter = "30 mm", height = "30 mm", lift_speed = "0.5 m/s", floor = "wall", cylinder = "wall" }
        seed = [{ name = "pea", sphere = "6 mm", density = "1250 kg/m3", count = 12, material = "pea" }]
        material.pea = { poisson_ratio = 0.3, youngs_modulus = "1 MPa" }
        material.wall = { poisson_ratio = 0.3, youngs_modulus = "10 MPa" }
        contact.pea-pea = { restitution = 0.5, static_friction = 0.4, rolling_friction = 0.1 }
        contact.pea-wall = { restitution = 0.5, static_friction = 0.4, rolling_friction = 0.1 }
        protocol = { rotation_limit = "0.3 s" }
    "#;
    fs::write(folder.path().join("heap.toml"), heap).unwrap();
    let words = [
        "simulate",
        "heap.toml",
        "--frame",
        "t.png",
        "--json",
        "t.json",
    ];
    assert_code(&seedloop(folder.path(), &words), 0);
    assert!(folder.path().join("t.json").exists());
    let picture = fs::read(folder.path().join("t.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG"));
}
