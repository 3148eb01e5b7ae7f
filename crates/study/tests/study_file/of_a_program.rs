//! A study of a program of the user: names and numbers that it could not take are refused before the first run.

use super::folder::{Folder, problems, reports};
use study::Problem;

const COMMAND: &str = r#"name = "mill"
[simulator]
kind = "command"
command = ["sh", "run.sh"]
template = "mill"
version = "1"
wall_limit = "1 min"
[simulator.results]
observables = "results.json"
[[scene]]
name = "drum"
observables = ["angle_deg"]
[[parameter]]
symbol = "mu"
low = 0.1
high = 0.6
limits = [0.0, 2.0]
[[effect]]
name = "cohesion"
probe = 0.4
range = [0.0, 3.0]
[[measured]]
scene = "drum"
condition = { rpm = 15 }
role = "fit"
angle_deg = { mean = 31.0, sd = 0.8, n = 10 }
"#;

/// A folder with a study and the template.
fn folder(study: &str) -> Folder {
    let folder = Folder::new(study);
    std::fs::create_dir(folder.path("mill")).expect("a folder");
    folder
}

/// The message about a changed study.
fn wrong(from: &str, to: &str) -> (String, Vec<Problem>) {
    assert!(COMMAND.contains(from), "{from}");
    let study = COMMAND.replacen(from, to, 1);
    let list = problems(&folder(&study), None);
    (study, list)
}

#[test]
#[rustfmt::skip]
fn a_study_of_a_program_is_read() {
    let long = format!("\"{}\"", "n".repeat(100));
    for (from, to) in [
        ("", ""),
        ("\"run.sh\"]", "\"run.sh\"]\nkeep = \"all\""),
        ("\"mill\"\n[", &format!("{long}\n[")),
        // Zero is a level, whatever its sign.
        ("rpm = 15", "rpm = -0.0"),
    ] {
        folder(&COMMAND.replacen(from, to, 1))
            .read(None)
            .expect("a study that is right");
    }
}

#[test]
#[rustfmt::skip]
fn what_the_program_could_not_be_given_is_refused() {
    for (from, to, what, word) in [
        ("[\"sh\", ", "[\"\", ", "[simulator]: command", "no program"),
        ("command = [\"sh\", \"run.sh\"]\n", "", "[simulator]", "'command'"),
        ("version = \"1\"\n", "", "[simulator]", "'version'"),
        ("version = \"1\"\n", "ranks = 2\nversion = \"1\"\n", "ranks = 2", "template"),
        ("\"results.json\"", "\"\"", "[simulator.results]: observables", "a file"),
        ("\"results.json\"", "\".\"", "[simulator.results]: observables", "a file"),
        ("\"results.json\"", "\"../x.json\"", "[simulator.results]: observables", "inside"),
        ("\"1 min\"", "\"1e-9 s\"", "wall_limit = \"1e-9 s\"", "1 ms to a year"),
        ("template = \"mill\"", "template = \".\"", "template = \".\"", "the study itself"),
        ("template = \"mill\"", "template = \"mill/..\"", "template", "the study itself"),
        ("template = \"mill\"", "template = \"none\"", "template = \"none\"", "none"),
        ("\"cohesion\"", "\"Mu\"", "[[effect]] Mu: name", "SEEDLOOP_MU"),
        ("\"cohesion\"", "\"Seed\"", "[[effect]] Seed: name", "SEEDLOOP_SEED"),
        ("\"cohesion\"", "\"arguments\"", "[[effect]] arguments: name", "'arguments'"),
        ("probe = 0.4", "probe = 0", "probe = 0", "in the range"),
        ("range = [0.0, 3.0]", "range = [1.0, 3.0]", "range = [1.0, 3.0]", "around 0"),
        ("[\"angle_deg\"]", "[\"angle_deg\", \"angle_deg\"]", "observables.1", "twice"),
        ("[\"angle_deg\"]", "[\"slip\"]", "[[measured]] drum: angle_deg", "slip"),
        ("[\"angle_deg\"]", "[\"angle_deg\"]\nparameters = [\"nu\"]", "parameters.0 = \"nu\"", "symbol"),
        ("[\"angle_deg\"]", "[\"angle_deg\"]\nfile = \"a.toml\"", "file = \"a.toml\"", "scene files"),
        ("symbol = \"mu\"", "symbol = \"mu\"\nsets = [\"a.b\"]", "mu: sets", "scene files"),
        ("[[measured]]", "[effects]\nsearch = [\"cohesin\"]\n[[measured]]", "[effects]: search", "cohesion"),
    ] {
        let (study, list) = wrong(from, to);
        reports(&study, &list, what, word);
    }
}

/// What the other tables may hold depends on the kind: where it is wrong, it alone is reported.
#[test]
fn a_wrong_kind_is_reported_alone() {
    for to in ["kind = \"comand\"", "kind = 3", ""] {
        let (study, list) = wrong("kind = \"command\"", to);
        reports(&study, &list, "[simulator]", "");
        assert_eq!(list.len(), 1, "{list:#?}");
    }
}

/// The folder of a study of 300 letters cannot be made; an empty text or one with line ends is not a name.
#[test]
#[rustfmt::skip]
fn texts_that_are_no_names_are_refused() {
    let long = format!("\"{}\"", "n".repeat(300));
    for word in [
        &long,
        "\"\"",
        "\" \"",
        "\" a\"",
        "\"a\\nb\"",
        "\"a\\u0000b\"",
        "\"a\\u0007\"",
    ] {
        for (from, to) in [
        ("name = \"mill\"", format!("name = {word}")),
        ("version = \"1\"", format!("version = {word}")),
        ("symbol = \"mu\"", format!("symbol = {word}")),
        ("name = \"cohesion\"", format!("name = {word}")),
        ("rpm = 15", format!("rpm = {word}")),
        ("[\"angle_deg\"]", format!("[\"angle_deg\", {word}]")),
        ("name = \"drum\"", format!("name = {word}")),
        ("[[measured]]", format!("[profile.{word}.budget]\nruns = 5\n[[measured]]")),
    ] {
            let (study, list) = wrong(from, &to);
            let line = 1 + study[..study.find(&to).expect("there")]
                .matches('\n')
                .count();
            assert!(list.iter().any(|p| p.line == Some(line)), "{to}: {list:#?}");
        }
    }
}

/// Each key asks for its line: counted from the start of the file each time, ten times as many measurements would take a hundred times
/// as long. The length makes ten of it; thirty allow for a machine that does other work. Of thousands of mistakes a hundred are
/// reported, since each takes a reading of the file.
#[test]
fn a_long_study_is_read_in_the_time_of_its_length() {
    let seconds = |number: usize| {
        let one = |rpm: usize| {
            format!(
                "[[measured]]\nscene = \"drum\"\ncondition = {{ rpm = {rpm} }}\nrole = \"show\"\nangle_deg = {{ mean = 31.0, sd = 0.8, n = 10 }}\n"
            )
        };
        let study: String = (100..100 + number).map(one).collect();
        let folder = folder(&format!("{COMMAND}{study}"));
        let begin = std::time::Instant::now();
        folder.read(None).expect("a study that is right");
        folder.write(
            "study.toml",
            &format!("{COMMAND}{}", study.replace("role", "rol")),
        );
        assert!(problems(&folder, None).len() >= 100);
        begin.elapsed().as_secs_f64()
    };
    let (short, long) = (seconds(300), seconds(3000));
    assert!(long < 30.0 * short, "{short} s and {long} s");
}
