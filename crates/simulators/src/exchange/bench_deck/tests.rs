//! What decks of benches say, and what they refuse.

use crate::exchange::bench_deck::stl;
use crate::exchange::vtk::File;
use crate::exchange::{lammps, liggghts};
use dev_support::fixture_files::fixture;
use nalgebra::Vector3;
use scene::{FillingLibrary, Override, Scene, starting_frame};

fn scene(bench: &str, changes: &[(&str, &str)]) -> Scene {
    let set = changes.iter().map(|(name, value)| Override {
        name: (*name).into(),
        value: (*value).into(),
    });
    let set: Vec<_> = set.collect();
    Scene::read(&fixture(&format!("benches/{bench}.toml")), &set).unwrap()
}

/// The decks for LAMMPS and LIGGGHTS, or their refusals.
fn decks(scene: &Scene) -> [Result<Vec<File>, crate::exchange::Error>; 2] {
    let (start, bodies, step) = starting_frame(scene, &FillingLibrary::default(), 1).unwrap();
    [
        lammps::deck(scene, &bodies, &start, step, 1),
        liggghts::deck(scene, &bodies, &start, step, 1),
    ]
}

fn scripts(scene: &Scene) -> [String; 2] {
    decks(scene).map(|deck| deck.unwrap().swap_remove(0).text)
}

/// All presets with phases have a deck but the cup, whose collar is struck off above the bed. What is missing is named before any seed is
/// placed or written.
#[test]
fn presets_have_decks_and_a_cup_is_refused() {
    for bench in [
        "hopper",
        "draw-down",
        "ledge",
        "compression",
        "direct-shear",
        "penetration",
        "poured-heap",
    ] {
        let made = decks(&scene(bench, &[]));
        assert!(made.iter().all(Result::is_ok), "{bench}: {made:?}");
    }
    for refused in decks(&scene("bulk-density", &[])) {
        let message = refused.unwrap_err().to_string();
        assert!(
            message.contains("outlet") && message.contains("simulate this bench here"),
            "{message}"
        );
    }
    let slice = [("seed.0.count", "20")];
    for refused in decks(&scene("../anand-hopper/periodic", &slice)) {
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("periodic sides"), "{message}");
    }
    for refused in decks(&scene("drum", &[("apparatus.cover", "periodic")])) {
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("a drum with periodic ends"), "{message}");
    }
    let [lammps, liggghts] = decks(&scene("machine", &[]));
    assert!(lammps.is_ok());
    let message = liggghts.unwrap_err().to_string();
    assert!(
        message.contains("'paddle'") && message.contains("turns about a point that moves"),
        "{message}"
    );
    let wet = scene("hopper", &[("model.bond_number", "1")]);
    for message in
        [lammps::check_deck(&wet), liggghts::check_deck(&wet)].map(|m| m.unwrap_err().to_string())
    {
        assert!(message.contains("model.bond_number"), "{message}");
    }
}

/// Both codes start from the places of the run here: the rows of a data file are those of the starting frame, to the printed digits.
#[test]
fn spheres_start_where_they_start_here() {
    let scene = scene("hopper", &[]);
    let (start, ..) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    for deck in decks(&scene) {
        let files = deck.unwrap();
        let data = &files
            .iter()
            .find(|file| file.name == "bench.data")
            .unwrap()
            .text;
        let atoms = data.split("Atoms").nth(1).unwrap();
        let row = atoms.lines().find(|line| line.starts_with("7 1 ")).unwrap();
        let numbers: Vec<f64> = row
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        let place = Vector3::from_column_slice(&numbers[4..7]);
        assert!((place - start.position[6]).norm() < 1e-12, "{row}");
        assert!(
            (numbers[2] - 3e-3).abs() < 1e-12 && (numbers[3] - 2500.0).abs() < 1e-6,
            "{row}"
        );
    }
}

/// The gate of the hopper goes at the start of the discharge and not before, and the box ends 15 mm below the opening, where seeds are
/// counted. In LIGGGHTS the other walls stay.
#[test]
fn the_gate_is_taken_away_in_the_last_phase() {
    let scene = scene("hopper", &[]);
    let [lammps, liggghts] = scripts(&scene);
    for (text, gone) in [
        (&lammps, "unfix wall_gate_1\n"),
        (&liggghts, "unfix gate\n"),
    ] {
        let (before, behind) = text.split_once("# Phase 2: discharge.").unwrap();
        assert!(!before.contains(gone) && behind.contains(gone), "{text}");
    }
    assert!(
        liggghts.contains("n_meshes 3 meshes gate bottom side")
            && liggghts.contains("n_meshes 2 meshes bottom side")
    );
    for deck in decks(&scene) {
        let files = deck.unwrap();
        let data = &files
            .iter()
            .find(|file| file.name == "bench.data")
            .unwrap()
            .text;
        let line = data.lines().find(|line| line.ends_with("ylo yhi")).unwrap();
        let low: f64 = line.split_whitespace().next().unwrap().parse().unwrap();
        assert!((low + 0.015).abs() < 1e-12, "{line}");
    }
}

/// The piston carries 2, 5, 10 and again 2 kPa on 40 mm by 40 mm: 3.2, 8, 16 and 3.2 N. LIGGGHTS takes them as targets; in LAMMPS the
/// acceleration is the force that is left over the mass of the piston, half of that of 520 peas: 0.02127 kg.
#[test]
fn a_piston_carries_its_stresses() {
    let [lammps, liggghts] = scripts(&scene("compression", &[]));
    let mut walls = lammps.lines().filter(|l| l.starts_with("region at_"));
    let moves = |line: &str| line.contains(" move v_dx_piston v_dy_piston v_dz_piston");
    let of_piston = walls.find(|line| line.starts_with("region at_piston_"));
    assert!(moves(of_piston.unwrap()), "the piston stays: {of_piston:?}");
    let targets: Vec<f64> = liggghts
        .lines()
        .filter_map(|line| line.strip_prefix("fix_modify piston servo/target_val "))
        .map(|value| value.parse().unwrap())
        .collect();
    for (target, expected) in targets.iter().zip([3.2, 8.0, 16.0, 3.2]) {
        assert!((target - expected).abs() < 1e-9, "{targets:?}");
    }
    assert_eq!(targets.len(), 4);
    let accelerations: Vec<&str> = lammps
        .lines()
        .filter(|l| l.starts_with("variable free_piston equal "))
        .collect();
    assert_eq!(accelerations.len(), 4);
    assert!(
        accelerations[1].contains("equal (8e0+((-1e0)*v_fy_piston)")
            || accelerations[1].contains("equal (8e0+(-1e0)*v_fy_piston)/2.127"),
        "{}",
        accelerations[1]
    );
    assert_eq!(
        lammps.matches("unfix servo_piston\n").count(),
        3,
        "one for each later load"
    );
}

/// LIGGGHTS gets a plane as two triangles across its box that look towards the bed: for the floor of the press upwards.
#[test]
fn planes_are_rectangles_for_liggghts() {
    let [_, liggghts] = decks(&scene("compression", &[]));
    let files = liggghts.unwrap();
    let of = |name: &str| &files.iter().find(|file| file.name == name).unwrap().text;
    assert!(
        of("floor.stl").contains("facet normal 0e0 1e0 0e0")
            || of("floor.stl").contains("facet normal -0e0 1e0"),
        "{}",
        of("floor.stl")
    );
    let right: Vec<f64> = of("right_end.stl")
        .lines()
        .filter_map(|line| line.strip_prefix("vertex "))
        .map(|line| line.split_whitespace().next().unwrap().parse().unwrap())
        .collect();
    assert_eq!(right.len(), 6);
    assert!(right.iter().all(|x| (x - 0.04).abs() < 1e-12), "{right:?}");
}

/// A triangle in the plane z = 0 that turns counter-clockwise as seen from above looks upwards.
#[test]
fn facets_have_their_normals() {
    let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let text = stl("plate", &[[a, b, c]]);
    assert!(
        text.contains("facet normal 0e0 -0e0 1e0") || text.contains("facet normal 0e0 0e0 1e0"),
        "{text}"
    );
    assert_eq!(text.matches("vertex").count(), 3);
}

/// A heap of type C is exported for LIGGGHTS with `epsd2`, one of type A with `cdt`, and one without rolling friction with neither.
#[test]
fn rolling_laws_have_their_models() {
    let model = |changes: &[(&str, &str)]| scripts(&scene("poured-heap", changes))[1].clone();
    let spring = model(&[]);
    assert!(
        spring.contains("rolling_friction epsd2") && !spring.contains("torsionTorque"),
        "{spring}"
    );
    let constant = model(&[("model.rolling_law", "constant-torque")]);
    assert!(constant.contains("rolling_friction cdt") && constant.contains("torsionTorque on"));
    let none = model(&[
        ("contact.pea-pea.rolling_friction", "0"),
        ("contact.pea-felt.rolling_friction", "0"),
    ]);
    assert!(!none.contains("rolling_friction "), "{none}");
}
