//! Names and numbers that would fail after the first run, or in it, are refused before.

use super::folder::{Folder, STUDY, changed, with};
use super::refused::tells;

/// A study of a program of the user.
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

/// What reading the study says; nothing where it is taken. The message names the line in which `place` stands.
fn told(study: &str, place: &str) -> String {
    let folder = Folder::new(study);
    std::fs::create_dir(folder.path("mill")).expect("a folder");
    let Err(error) = folder.read(None) else {
        return String::new();
    };
    let line = 1 + study[..study.find(place).expect("a place of the study")]
        .matches('\n')
        .count();
    let line = format!("line {line}: ");
    tells(&error.to_string(), &[&line]);
    error.to_string()
}

#[test]
fn numbers_beyond_all_quantities_are_refused_with_line_and_value() {
    assert_eq!(told(STUDY, "name"), "");
    for (from, to) in [
        ("sd = 0.8", "sd = 1e-320"),
        ("sd = 0.8", "sd = 1e-20"),
        ("sd = 0.8", "sd = 1e300"),
        ("sd = 0.8", "sd = -0.0"),
        ("sd = 0.8", "sd = nan"),
        ("mean = 0.1", "mean = 1e-200"),
        ("n = 7.5", "n = inf"),
        ("low = 0.1", "low = 1e-300"),
        ("low = 0.1", "low = 0.5999999999999999"),
        ("start = 0.25", "start = 1e-31"),
        ("sd = 0.05", "sd = 1e-20"),
        ("rpm = 30", "rpm = nan"),
        ("rpm = 30", "rpm = 1e300"),
    ] {
        let text = to.split(" = ").nth(1).unwrap();
        let message = told(&changed(from, to), to);
        let value: f64 = text.parse().unwrap();
        let shown = [text.to_owned(), format!("{value}"), format!("{value:e}")];
        assert!(
            shown.iter().any(|v| message.contains(v.as_str())),
            "{to}: {message}"
        );
    }
    let compare = "[[compare]]\nresult = \"F\"\nvalue = inf\nsource = \"x\"\n";
    assert!(told(&with(compare), "value = inf").contains("value = inf"));
    // Zero is a level, whatever its sign.
    assert_eq!(told(&COMMAND.replace("rpm = 15", "rpm = -0.0"), "name"), "");
}

/// The folder of a study of 300 letters cannot be made; what holds line ends or nothing is no name. One of 100 letters is.
#[test]
fn texts_that_are_no_names_are_refused_with_their_line() {
    assert_eq!(told(COMMAND, "name"), "");
    let (long, longest) = (
        format!("\"{}\"", "n".repeat(300)),
        format!("\"{}\"", "n".repeat(100)),
    );
    assert_eq!(
        told(
            &COMMAND.replace("\"mill\"\n[", &format!("{longest}\n[")),
            "name"
        ),
        ""
    );
    for word in [
        &long,
        "\"\"",
        "\" \"",
        "\" a\"",
        "\"a\\nb\"",
        "\"a\\u0000b\"",
        "\"a\\u0007\"",
    ] {
        for (from, place) in [
            ("name = \"mill\"", "name = "),
            ("version = \"1\"", "version = "),
            ("symbol = \"mu\"", "symbol = "),
            ("name = \"cohesion\"\n", "name = "),
            ("rpm = 15", "rpm = "),
        ] {
            let to = format!("{place}{word}");
            let study = COMMAND.replacen(from.trim_end(), &to, 1);
            assert_ne!(told(&study, &to), "", "{to}");
        }
        for study in [
            COMMAND.replace("[\"angle_deg\"]", &format!("[\"angle_deg\", {word}]")),
            COMMAND.replace("name = \"drum\"", &format!("name = {word}")),
            format!("{COMMAND}[profile.{word}.budget]\nruns = 5\n"),
        ] {
            assert_ne!(told(&study, word), "", "{study}");
        }
    }
}

#[test]
fn what_the_program_could_not_be_given_is_refused() {
    for (from, to, words) in [
        ("\"run.sh\"]", "\"run.sh\"]\nkeep = \"all\"", ""),
        ("[\"sh\", ", "[\"\", ", "begins with no program"),
        ("\"results.json\"", "\"\"", "must name a file"),
        ("\"results.json\"", "\".\"", "must name a file"),
        ("\"1 min\"", "\"1e-9 s\"", "1 ms to a year"),
        (
            "template = \"mill\"",
            "template = \".\"",
            "holds the study itself",
        ),
        (
            "template = \"mill\"",
            "template = \"mill/..\"",
            "holds the study itself",
        ),
        ("\"cohesion\"", "\"Mu\"", "SEEDLOOP_MU"),
        ("\"cohesion\"", "\"Seed\"", "SEEDLOOP_SEED"),
        ("\"cohesion\"", "\"arguments\"", "all values"),
        ("[\"angle_deg\"]", "[\"angle_deg\", \"angle_deg\"]", "twice"),
    ] {
        let message = told(&COMMAND.replacen(from, to, 1), to);
        assert!(
            message.contains(words) && message.is_empty() == words.is_empty(),
            "{to}: {message}"
        );
    }
}

/// Each key asks for its line: counted from the start of the file each time, 3000 measurements would take a minute. 5 s are far above what
/// one count takes.
#[test]
fn a_long_study_is_read_in_the_time_of_its_length() {
    let one = |rpm: usize| {
        format!(
            "[[measured]]\nscene = \"drum\"\ncondition = {{ rpm = {rpm} }}\nrole = \"show\"\nangle_deg = {{ mean = 31.0, sd = 0.8, n = 10 }}\n"
        )
    };
    let study: String = (100..3100).map(one).collect();
    let begin = std::time::Instant::now();
    assert_eq!(told(&format!("{COMMAND}{study}"), "name"), "");
    assert!(begin.elapsed().as_secs() < 5, "{:?}", begin.elapsed());
}
