//! Everything that a design table refuses before any run.

use super::folder::{FRICTION, Folder, bound};

/// A friction may be 1.5, a restitution may not.
const BOTH: &str = "Q=contact.pea-pea.static_friction,contact.pea-pea.restitution";

/// A table alone.
fn one(table: &str) -> Folder {
    Folder::new(table)
}

/// Asserts of each table that its answer says all of these.
fn tell(cases: Vec<(Folder, &[&str])>) {
    for (folder, parts) in cases {
        let problems = folder.problems();
        for part in parts {
            assert!(problems.contains(part), "'{part}' is not in: {problems}");
        }
    }
}

/// Unknown, ambiguous and repeated names, and units that do not fit: the remedy is reported.
#[test]
fn columns_that_cannot_be_meant_are_told_with_the_way_out() {
    tell(vec![
        (
            one("frction\n0.3\n"),
            &["line 1", "'frction'", "static_friction", "--bind", "--keep"],
        ),
        (
            one("F,F_natural\n0,0.3\n"),
            &["'F_natural'", "--bind F=PATH"],
        ),
        (
            one("static_friction\n0.3\n"),
            &["'static_friction'", "may mean", FRICTION],
        ),
        (
            one("apparatus.speed\n20\n"),
            &["'apparatus.speed'", "[rad/s]"],
        ),
        (
            one("apparatus.speed [mm]\n20\n"),
            &["'apparatus.speed'", "'mm'"],
        ),
        (
            one("camera.pixels [mm]\n480\n"),
            &["'camera.pixels'", "leave out", "'mm'"],
        ),
        (
            one("rpm,apparatus.speed [rpm]\n20,20\n"),
            &["'apparatus.speed'", "'rpm'", "as well"],
        ),
        (one("rpm,rpm\n20,20\n"), &["'rpm'", "twice"]),
        (one("rpm,\n20,1\n"), &["number 2", "no name"]),
        (one("rpm,angle_deg\n20,1\n"), &["'angle_deg'", "results"]),
    ]);
}

/// Each with its line, column and value.
#[test]
fn cells_that_cannot_be_meant_are_told_with_their_place() {
    tell(vec![
        (
            one("rpm\n20\nx\n"),
            &["line 3", "'rpm'", "'x'", "finite number"],
        ),
        (
            one("Q_natural\n1.5\n").bind(BOTH),
            &["'1.5'", "restitution"],
        ),
        (one("rpm\ninf\n"), &["line 2", "'inf'", "finite number"]),
        (
            one("rpm,protocol.frames\n20,\n"),
            &["line 2", "'protocol.frames'", "empty"],
        ),
        (
            one("protocol.frames\n2.5\n"),
            &["line 2", "'2.5'", "whole number"],
        ),
        (
            one("apparatus.speed\n20 rpm\n30\n"),
            &["line 3", "'30'", "no unit"],
        ),
        (
            one("apparatus.speed\n20 mm\n"),
            &["line 2", "'20 mm'", "rpm"],
        ),
        (
            one("model.rolling_law\nnone\n"),
            &["line 2", "'none'", "constant-torque"],
        ),
        (one("rpm,E\n20\n"), &["line 2 has 1 fields"]),
        (
            bound("F,E,W,F_natural\n0,0,0,0.4\n"),
            &["line 2", "'F'", "0.35", "0.4"],
        ),
        (bound("F,E,W\nx,0,0\n"), &["line 2", "'F'", "'x'"]),
    ]);
}

/// No row may be run zero times, a million times, or as a repeat of another with its seed.
#[test]
fn repeats_and_seeds_that_cannot_be_meant_are_told() {
    tell(vec![
        (
            one("rpm,replicates\n20,0\n"),
            &["'replicates'", "'0'", "whole number"],
        ),
        (one("rpm,replicates\n20,1000001\n"), &["line 2", "1000000"]),
        (
            one("rpm,seed\n20,1.5\n"),
            &["'seed'", "'1.5'", "whole number"],
        ),
        (
            one("rpm,seed\n20,18446744073709551615\n").replicates(2),
            &["2^64"],
        ),
        (
            one("rpm,seed\n20,1\n20,1\n"),
            &["line 3", "line 2", "another seed"],
        ),
        (
            one("rpm,seed,replicates\n20,1,2\n20,2,1\n"),
            &["line 3", "line 2", "seed 2"],
        ),
        (
            one("rpm,replicates\n20,1\n").replicates(2),
            &["--replicates", "leave out"],
        ),
        (
            one("rpm\n20\n").replicates(0),
            &["--replicates", "1 or more"],
        ),
    ]);
}

/// Bindings must fit the table.
#[test]
fn flags_that_do_not_fit_the_table_are_told() {
    tell(vec![
        (one("rpm\n20\n").keep("note"), &["'note'", "--keep", "rpm"]),
        (one("rpm\n20\n").bind("Q=rpm"), &["'Q'", "--bind", "rpm"]),
        (one("Q\n20\n").bind("Q=rpn"), &["'Q'", "'rpn'", "rpm"]),
        (
            one("Q\n20\n").bind("Q=rpm,camera.pixels"),
            &["'Q'", "same kind"],
        ),
        (one("Q\n20\n").bind("Q"), &["--bind", "COLUMN=PATH"]),
        (one("rpm\n20\n").set("rpm=3"), &["'rpm'", "--set"]),
        (one("rpm\n20\n").set("frames"), &["--set", "NAME=VALUE"]),
    ]);
}

/// Each value is taken with the other of the scene, and both together lack a contact: the row is reported, not a cell.
#[test]
fn values_that_are_refused_only_together_are_told_as_such() {
    let folder = Folder::new("seed.0.material,apparatus.shell\nbean,spare\npea,wall\nbean,wall\n");
    let text = std::fs::read_to_string(&folder.choices.scene).unwrap();
    let spare = text.replace(" = \"wall\"", " = \"spare\"");
    std::fs::write(&folder.choices.scene, spare).unwrap();
    let problems = folder.problems();
    let expected = "line 4: the row: has values that do not go together";
    assert!(problems.contains(expected), "{problems}");
    assert!(problems.contains("bean-wall"), "{problems}");
    assert_eq!(problems.lines().count(), 1, "{problems}");
}

/// One table with a mistake in each part: all of them are reported, each once.
#[test]
fn all_mistakes_are_told_at_once() {
    let table =
        format!("frction,{FRICTION},rpm,replicates\n1,-0.1,20,1\n1,0.1,x,1\n1,0.1,20,1.5\n");
    let problems = Folder::new(&table).problems();
    let lines: Vec<&str> = problems.lines().collect();
    assert_eq!(lines.len(), 4, "{problems}");
    for (line, place) in lines.iter().zip(["line 1", "line 2", "line 3", "line 4"]) {
        assert!(
            line.contains("design.csv") && line.contains(place),
            "{problems}"
        );
    }
    let kept = Folder::new("frction,rpm\n1,20\n").keep("frction");
    kept.read().unwrap();
}

/// Seeds that have no room are found by building, which costs no run.
#[test]
fn a_row_without_room_is_told_before_any_run() {
    let table = Folder::new("seed.0.count\n100\n100000\n").read().unwrap();
    let simulator = table.simulator().unwrap();
    let error = table
        .check_builds(&simulator, None)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("line 3") && error.contains("do not fit"),
        "{error}"
    );
}
