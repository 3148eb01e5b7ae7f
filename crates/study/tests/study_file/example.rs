//! The commented example of every key.

use dev_support::fixture_files::fixture;
use std::collections::BTreeSet;
use study::{Error, Study};
use toml::{Table, Value};

/// A wrong key, and where it is put into an example: the refusal names the keys of the table.
const WRONG_KEYS: [(&str, &str, &str); 21] = [
    ("study", "study-example", "name = "),
    ("scene", "study-example", "changes = "),
    ("parameter", "study-example", "low = "),
    ("prior", "study-example", "{ mean = 0.4"),
    ("input", "study-example", "effect = "),
    ("measured", "study-example", "role = "),
    ("photo", "study-example", "photo.roll = "),
    ("value", "study-example", "{ mean = 33.1"),
    ("curve", "study-example", "{ file = "),
    ("candidate", "study-example", "minutes = "),
    ("compare", "study-example", "source = "),
    ("design", "study-example", "joint = "),
    ("budget", "study-example", "runs = 300"),
    ("effects", "study-example", "search = [\"rolling"),
    ("profile", "study-example", "compare = []"),
    ("profile scene", "study-example", "scene.drum.changes = "),
    ("simulator", "command-example", "keep = "),
    ("results", "command-example", "observables = \"results"),
    ("drum", "command-example", "observables = [\"angle"),
    ("effect", "command-example", "probe = "),
    ("coarse graining", "mcc", "factors = "),
];

/// Keys of each kind of table, as the message about an unknown key lists them.
fn expected() -> Vec<(&'static str, Vec<String>)> {
    let keys = |(kind, folder, place): (&'static str, &str, &str)| {
        let name = if folder == "mcc" {
            "real-size"
        } else {
            "study"
        };
        let text =
            std::fs::read_to_string(fixture(&format!("{folder}/{name}.toml"))).expect("an example");
        let wrong = match (kind, place) {
            ("photo", _) => format!("photo.zzz = 1\n{place}"),
            ("profile scene", _) => format!("scene.drum.zzz = 1\n{place}"),
            ("drum", _) => format!("drum.zzz = 1\n{place}"),
            (_, inline) if inline.starts_with("{ ") => inline.replacen("{ ", "{ zzz = 1, ", 1),
            _ => format!("zzz = 1\n{place}"),
        };
        assert!(text.contains(place), "{kind}: {place}");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("study.toml");
        std::fs::write(&path, text.replacen(place, &wrong, 1)).expect("written");
        let list = match Study::read(&path, None) {
            Err(Error::Problems { list }) => list,
            _ => Vec::new(),
        };
        let problem = list.iter().find(|p| p.what.contains("zzz"));
        let problem = problem.expect("a wrong key is refused");
        let (_, keys) = problem.problem.split_once(" are ").expect("the keys");
        // The command line and the budget give these two.
        let elsewhere = |key: &&str| kind == "design" && ["seed", "most_runs"].contains(key);
        let keys = keys.split(", ").filter(|key| !elsewhere(key));
        (kind, keys.map(str::to_owned).collect())
    };
    WRONG_KEYS.map(keys).into()
}

/// Adds the keys of a table, and of each table below it, under the name of its kind.
fn collect(kind: &str, table: &Table, found: &mut BTreeSet<(String, String)>) {
    for (key, value) in table {
        found.insert((kind.to_owned(), key.clone()));
        let below = match (kind, key.as_str()) {
            ("study" | "profile", _) => key.as_str(),
            ("parameter", "prior") => "prior",
            ("measured", "photo") => "photo",
            ("measured", "curve") => "curve",
            ("measured", "condition") | ("scene", "apparatus") => continue,
            ("measured", _) => "value",
            _ => continue,
        };
        let tables: Vec<&Table> = match value {
            Value::Table(table)
                if below == "profile" || (kind == "profile" && below == "scene") =>
            {
                table.values().filter_map(Value::as_table).collect()
            }
            Value::Table(table) => vec![table],
            Value::Array(list) => list.iter().filter_map(Value::as_table).collect(),
            _ => Vec::new(),
        };
        let below = if kind == "profile" && below == "scene" {
            "profile scene"
        } else {
            below
        };
        for table in tables {
            collect(below, table, found);
        }
    }
}

#[test]
fn the_example_reads_and_shows_every_key() {
    let path = fixture("study-example/study.toml");
    Study::read(&path, None).unwrap();
    Study::read(&path, Some("quick")).unwrap();
    let table: Table = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let mut found = BTreeSet::new();
    collect("study", &table, &mut found);
    for (kind, keys) in expected() {
        for key in keys {
            if of_other_codes(kind, &key) {
                continue;
            }
            let entry = (kind.to_owned(), key);
            assert!(
                found.contains(&entry),
                "{entry:?} is missing in {}",
                path.display()
            );
        }
    }
}

/// Whether a key says how other codes or batch systems do the runs, or that seeds are coarser than the real ones: the example has the
/// solver here, and effects, which coarse grains leave out.
fn of_other_codes(kind: &str, key: &str) -> bool {
    let tables = ["drum", "simulator", "results", "effect", "coarse graining"];
    let of_a_program = ["observables", "parameters", "drum"];
    tables.contains(&kind)
        || ["simulator", "effect", "coarse_graining"].contains(&key)
        || (kind == "scene" && of_a_program.contains(&key))
}

/// Keys that no example shows together stand in the reference.
#[test]
fn every_key_of_other_codes_is_documented() {
    let text = std::fs::read_to_string(fixture("../docs/study-file.md")).unwrap();
    for (kind, keys) in expected() {
        for key in keys.iter().filter(|key| of_other_codes(kind, key)) {
            let shown = match kind {
                "drum" | "results" => format!("`{kind}.{key}`"),
                _ if kind == "study" => format!("[{key}]"),
                _ => format!("`{key}`"),
            };
            assert!(
                text.contains(&shown)
                    || [format!("`{key}`"), format!("`{key}.")]
                        .iter()
                        .any(|k| text.contains(k)),
                "{kind}: {key} is missing in docs/study-file.md"
            );
        }
    }
}

/// The example of a program of the user, and the drums that other codes run, read as they are.
#[test]
fn the_examples_of_other_codes_read() {
    Study::read(&fixture("command-example/study.toml"), None).unwrap();
    for drum in ["spheres", "seeds"] {
        let path = fixture(&format!("peers-study/study-{drum}.toml"));
        for profile in [None, Some("lammps"), Some("liggghts")] {
            Study::read(&path, profile).unwrap();
        }
    }
}

#[test]
fn every_key_of_the_example_has_a_comment() {
    let text = std::fs::read_to_string(fixture("study-example/study.toml")).unwrap();
    let is_key = |line: &&str| line.contains(" = ") && !line.trim_start().starts_with('#');
    for line in text.lines().filter(is_key) {
        assert!(line.contains('#'), "no comment: {line}");
    }
}

/// What a code does not have is reported before any run, with the scene and the remedy; effects that need it are left out.
#[test]
fn what_another_code_does_not_have_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["spheres.toml", "study-spheres.toml"] {
        let from = fixture("peers-study").join(file);
        std::fs::copy(from, folder.path().join(file)).unwrap();
    }
    let path = folder.path().join("study-spheres.toml");
    let right = std::fs::read_to_string(&path).unwrap();
    let with_effects = right.replace(
        "search = []",
        "search = [\"cohesion\", \"rolling-resistance\"]",
    );
    std::fs::write(&path, with_effects).unwrap();
    let study = Study::read(&path, Some("liggghts")).unwrap();
    let left_out = study.not_applicable["cohesion"].clone();
    assert!(
        left_out.contains("attraction") && left_out.contains("LIGGGHTS"),
        "{left_out}"
    );
    assert_eq!(study.problem.effects.len(), 1);

    let scene = folder.path().join("spheres.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let text = text.replace("[model]", "[model]\nrolling_law = \"spring-dashpot\"");
    std::fs::write(&scene, &text).unwrap();
    // Both have rolling friction of type C.
    Study::read(&path, Some("lammps")).unwrap();
    Study::read(&path, Some("liggghts")).unwrap();
    std::fs::write(&scene, text.replace("speed = ", "ramp = \"1 s\"\nspeed = ")).unwrap();
    let error = Study::read(&path, Some("liggghts"));
    let error = error.expect_err("a drum at a changing speed").to_string();
    assert!(error.contains("ramp") && error.contains("line"), "{error}");

    std::fs::write(&path, right.replace("angle_deg = {", "drive_power_mw = {")).unwrap();
    let error = Study::read(&path, Some("lammps")).unwrap_err().to_string();
    assert!(
        error.contains("drive_power_mw") && error.contains("angle_deg"),
        "{error}"
    );

    for (from, to, word) in [
        ("kind = \"lammps\"", "kind = \"lamps\"", "\"lammps\""),
        (
            "wall_limit = \"60 min\"",
            "wall_limit = \"60 mm\"",
            "wall_limit",
        ),
        ("command = [\"lmp\"] ", "ranks = 0 ", "ranks"),
    ] {
        std::fs::write(&path, right.replacen(from, to, 1)).unwrap();
        let error = Study::read(&path, Some("lammps")).unwrap_err().to_string();
        assert!(error.contains(word), "{word}: {error}");
    }
}

/// LIGGGHTS stops at restitutions of 0.05 and less: a range or limits that reach them are refused before any run, by key, and
/// what the solver here or LAMMPS takes is not. A bench test is reported as unsupported, and not as one without observables.
#[test]
fn ends_at_which_another_code_would_stop_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = fixture("peers-study/spheres.toml");
    std::fs::copy(scene, folder.path().join("spheres.toml")).unwrap();
    let path = folder.path().join("study.toml");
    let right = std::fs::read_to_string(fixture("peers-study/study-spheres.toml")).unwrap();
    let restitution = right.replacen("static_friction", "restitution", 1);
    let range = |text: &str| restitution.replacen("low = 0.1", text, 1);
    let read = |text: &str, profile| {
        std::fs::write(&path, text).unwrap();
        Study::read(&path, Some(profile)).map(|_| ())
    };
    let low = range("low = 0.02\nlimits = [0.02, 0.9]");
    for profile in ["lammps", "liggghts"] {
        let told = read(&low, profile).err().map(|e| e.to_string());
        let told = told.unwrap_or_default();
        for word in ["low = 0.02", "LIGGGHTS", "above 0.05", "narrow the range"] {
            assert_eq!(told.contains(word), profile == "liggghts", "{told}");
        }
    }
    let told = read(&range("low = 0.1"), "liggghts")
        .unwrap_err()
        .to_string();
    assert!(told.contains("limits: at 0.001"), "{told}");
    read(&range("low = 0.1\nlimits = [0.06, 0.999]"), "liggghts").unwrap();

    let sled = "[[scene]]\nname = \"sled\"\nfile = \"spheres.toml\"\napparatus = { kind = \"slider\", plate = \"bead\" }\n\n";
    let measured = "[[measured]]\nscene = \"sled\"\nrole = \"fit\"\nshown_static_friction = { mean = 0.3, sd = 0.02, n = 5 }\n\n";
    let with_sled = right
        .replacen("[[parameter]]", &format!("{sled}[[parameter]]"), 1)
        .replacen("[effects]", &format!("{measured}[effects]"), 1);
    let told = read(&with_sled, "liggghts").unwrap_err().to_string();
    assert!(
        told.contains("sled") && told.contains("LIGGGHTS") && !told.contains("which gives"),
        "{told}"
    );
}
