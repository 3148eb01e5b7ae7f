//! A folder with a small study.

use std::path::PathBuf;
use study::{Error, Problem, Study};

/// A drum with peas; friction and restitution against the wall matter in the drum, and on no plate of peas.
pub(crate) const DRUM: &str = r#"
[apparatus]
kind = "drum"
inner_diameter = "100 mm"
width = "20 mm"
speed = "15 rpm"
shell = "wall"
cover = "wall"

[[seed]]
name = "pea"
sphere = "6 mm"
density = "1300 kg/m3"
count = 100
material = "pea"

[material.pea]
poisson_ratio = 0.3
shear_modulus = "5 MPa"
[material.wall]
poisson_ratio = 0.3
shear_modulus = "1 GPa"
[material.spare]
poisson_ratio = 0.3
shear_modulus = "1 GPa"

[contact.pea-pea]
restitution = 0.5
static_friction = 0.35
[contact.pea-wall]
restitution = 0.5
static_friction = 0.3
[contact.pea-spare]
restitution = 0.5
static_friction = 0.3
"#;

/// A study of it, right in all parts.
pub(crate) const STUDY: &str = r#"name = "peas"

[[scene]]
name = "drum"
file = "drum.toml"

[[scene]]
name = "sled"
file = "drum.toml"
apparatus = { kind = "slider", plate = "pea" }

[[parameter]]
symbol = "F"
name = "static friction pea-pea"
sets = ["contact.pea-pea.static_friction"]
low = 0.1
high = 0.6

[[parameter]]
symbol = "W"
sets = ["contact.pea-wall.static_friction"]
low = 0.1
high = 0.6
limits = [0.0, 1.5]
start = 0.25
prior = { mean = 0.4, sd = 0.05 }

[[measured]]
scene = "drum"
condition = { "apparatus.speed" = "15 rpm" }
role = "fit"
angle_deg = { mean = 33.1, sd = 0.8, n = 10 }
curvature = { mean = 0.1, sd = 0.02, n = 7.5 }

[[measured]]
scene = "drum"
condition = { rpm = 30 }
role = "check"
angle_deg = { mean = 35.1, sd = 0.8, n = 10 }

[[measured]]
scene = "sled"
role = "fit"
shown_static_friction = { mean = 0.6, sd = 0.03, n = 5 }
"#;

/// A folder with the two files; it goes with the value.
pub(crate) struct Folder {
    /// Where they are.
    folder: tempfile::TempDir,
}

impl Folder {
    /// Writes both files.
    pub(crate) fn new(study: &str) -> Self {
        let this = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
        };
        this.write("drum.toml", DRUM);
        this.write("study.toml", study);
        this
    }

    /// A path in it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    /// Reads the study.
    pub(crate) fn read(&self, profile: Option<&str>) -> Result<Study, Error> {
        Study::read(&self.path("study.toml"), profile)
    }
}

/// The study with one text replaced, which must be in it.
pub(crate) fn changed(from: &str, to: &str) -> String {
    assert!(STUDY.contains(from), "'{from}' is not in the study");
    STUDY.replacen(from, to, 1)
}

/// The study with more at its end.
pub(crate) fn with(more: &str) -> String {
    format!("{STUDY}\n{more}")
}

/// Reads a study that is right.
pub(crate) fn right(study: &str) -> Study {
    Folder::new(study)
        .read(None)
        .expect("a study that is right")
}

/// The message about a study.
pub(crate) fn wrong(study: &str) -> Vec<Problem> {
    problems(&Folder::new(study), None)
}

/// The message about the study of a folder; empty if it is read.
pub(crate) fn problems(folder: &Folder, profile: Option<&str>) -> Vec<Problem> {
    match folder.read(profile) {
        Err(Error::Problems { list }) => list,
        _ => Vec::new(),
    }
}

/// Asserts that there is a problem of a table, key and value, which says a word, such as a limit or a name, and stands at the line of
/// the key.
pub(crate) fn reports(study: &str, list: &[Problem], what: &str, word: &str) {
    let mut found = list
        .iter()
        .filter(|p| p.what.contains(what) && p.problem.contains(word));
    let found = found.next();
    assert!(found.is_some(), "'{what}', '{word}' not in {list:#?}");
    let Some(Problem { line, what, .. }) = found else {
        return;
    };
    let key = what.split(" = ").next().unwrap_or_default();
    let key = key
        .trim_end_matches(']')
        .rsplit([':', '.', ' ', '['])
        .find(|key| key.parse::<usize>().is_err())
        .unwrap_or_default();
    let line = line.and_then(|line| study.lines().nth(line - 1));
    let is_there = |line: &str| line.contains(key) || line.starts_with('[');
    assert!(
        line.is_none_or(is_there) && (line.is_some() || key == "study"),
        "{key}: {line:?}"
    );
}

/// Asserts of each change of the study, `from` one text `to` another or, without `from`, of more at its end, that it is refused.
pub(crate) fn refuses(rows: &[(&str, &str, &str, &str)]) {
    for (from, to, what, word) in rows {
        let study = if from.is_empty() {
            with(to)
        } else {
            changed(from, to)
        };
        reports(&study, &wrong(&study), what, word);
    }
}
