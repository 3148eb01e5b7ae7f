//! What a design table asks for.

use super::folder::{FRICTION, Folder, bound, design};

/// The natural values of a design arrive at the settings, the same at both contacts, to the last bit.
#[test]
fn a_design_sets_what_its_factors_are_bound_to() {
    let folder = bound(&design());
    let scenes = folder.scenes();
    assert_eq!(scenes.len(), 14);
    // The first run of the design has both frictions at their low levels and the speed in the middle.
    assert_eq!(scenes[0].number(FRICTION), Some(0.2));
    for contact in ["pea-pea", "pea-wall"] {
        let path = format!("contact.{contact}.restitution");
        assert_eq!(scenes[0].number(&path), Some(0.3));
    }
    let speed = folder.scene_with("rpm", "20").apparatus;
    assert_eq!(scenes[0].apparatus, speed);
}

/// Coded values alone give what the natural ones beside them give, to the rounding of a table (1e-14 of the value).
#[test]
fn coded_values_count_where_the_natural_ones_are_missing() {
    let all = design();
    let cut = |line: &str| line.split(',').take(7).collect::<Vec<_>>().join(",") + "\n";
    let coded: String = all.lines().map(cut).collect();
    assert!(coded.starts_with("run,cell,replicate,block,F,E,W\n"));
    let (all, coded) = (bound(&all).read().unwrap(), bound(&coded));
    for (a, b) in all.requests().iter().zip(coded.read().unwrap().requests()) {
        assert_eq!(a.seed, b.seed);
        for (name, value) in &a.parameters {
            let other = b.parameters[name];
            assert!(
                (value / other - 1.0).abs() < 1e-14,
                "{name}: {value} {other}"
            );
        }
    }
    let mut blind = coded;
    blind.choices.factors = None;
    assert!(
        blind
            .problems()
            .contains("may hold coded or natural values")
    );
}

#[test]
fn columns_are_settings_by_path_short_name_and_unit() {
    let table = format!(
        "rpm,{FRICTION},camera.roll [deg],protocol.rotation_limit,protocol.frames\n20,0.4,3,1.5 s,7\n20,0.4,3,0.1 min,7\n"
    );
    let folder = Folder::new(&table);
    let scenes = folder.scenes();
    assert_eq!(
        scenes[0].apparatus,
        folder.scene_with("rpm", "20").apparatus
    );
    assert_eq!(scenes[0].number(FRICTION), Some(0.4));
    assert_eq!(
        scenes[0].camera,
        folder.scene_with("camera.roll", "3 deg").camera
    );
    assert_eq!(scenes[0].protocol.frames, 7);
    let limits: Vec<f64> = scenes
        .iter()
        .map(|s| s.protocol.rotation_limit.si())
        .collect();
    assert_eq!(limits, [1.5, 6.0]);
}

/// Two laws at two walls: four scenes for six rows, and numbers go with each.
#[test]
fn words_become_scenes_of_their_own_one_for_each_combination() {
    let row = |law: &str, wall: &str| format!("{law},{wall},{wall},0.4\n");
    let mut table = format!("model.rolling_law,wall,apparatus.cover,{FRICTION}\n");
    for law in ["constant-torque", "spring-dashpot"] {
        table += &(row(law, "wall") + &row(law, "spare") + &row(law, "wall"));
    }
    let folder = Folder::new(&table).bind("wall=apparatus.shell");
    let read = folder.read().unwrap();
    let requests = read.requests();
    let mut models: Vec<&str> = requests.iter().map(|r| r.model.as_str()).collect();
    models.sort_unstable();
    models.dedup();
    assert_eq!(models.len(), 4, "{models:?}");
    let scenes = folder.scenes();
    let spare = folder.scene_with("apparatus.shell", "spare");
    let scene::Apparatus::Drum(drum) = &scenes[1].apparatus else {
        panic!("a drum");
    };
    assert_eq!(
        (drum.shell.as_str(), drum.cover.as_str()),
        ("spare", "spare")
    );
    assert_ne!(scenes[1].model, scenes[4].model);
    assert_eq!(scenes[4].model.bond_number, spare.model.bond_number);
    assert_eq!(scenes[4].number(FRICTION), Some(0.4));
}

/// No row may fail for what one of its cells does alone: beans touch no wall but the spare one.
#[test]
fn values_that_hold_only_together_are_taken() {
    let table =
        "seed.0.material,apparatus.shell,apparatus.cover\nbean,spare,spare\npea,wall,wall\n";
    assert_eq!(Folder::new(table).scenes().len(), 2);
    let apart = "seed.0.material,apparatus.shell,apparatus.cover\npea,wall,wall\nbean,spare,wall\n";
    let problems = Folder::new(apart).problems();
    assert!(
        problems.contains("line 3") && problems.contains("bean-wall"),
        "{problems}"
    );
}

/// Without a column `seed` all runs differ in theirs, row by row; with one, the repeats of a row take those that follow.
#[test]
fn seeds_and_repeats_follow_the_table() {
    let seeds = |table: &str| -> Vec<(usize, usize, u64)> {
        let read = Folder::new(table).read().unwrap();
        let runs = read.runs().iter();
        runs.map(|run| (run.line, run.repeat, run.request.seed))
            .collect()
    };
    assert_eq!(
        seeds("# two rows\nrpm,replicates\n20,1\n30,2\n"),
        [(3, 1, 11), (4, 1, 12), (4, 2, 13)]
    );
    assert_eq!(
        seeds("rpm,seed,replicates\n20,5,2\n30,5,1\n"),
        [(2, 1, 5), (2, 2, 6), (3, 1, 5)]
    );
    let mut folder = Folder::new("rpm\n20\n30\n");
    folder.choices.replicates = Some(3);
    assert_eq!(folder.read().unwrap().runs().len(), 6);
}
