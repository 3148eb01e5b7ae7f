//! The studies of the repository, and those to start from.

use dev_support::fixture_files::fixture;
use study::{STARTERS, Study};

#[test]
fn the_studies_to_start_from_read_as_they_are() {
    for starter in STARTERS {
        let folder = tempfile::tempdir().unwrap();
        for file in starter.files() {
            std::fs::write(folder.path().join(file.name), file.text).unwrap();
        }
        let study = Study::read(&folder.path().join("study.toml"), None)
            .unwrap_or_else(|error| panic!("{}: {error}", starter.name));
        let fits = study.problem.measurements_of(inference::Role::Fit).len();
        // The study of benches is open on purpose: it asks what to measure next.
        let enough = fits >= study.problem.parameters.len();
        assert!(enough == (starter.name != "benches"), "{}", starter.name);
    }
}

#[test]
fn the_studies_of_the_repository_read_as_they_are() {
    for name in [
        "cotton/study.toml",
        "cotton/blind.toml",
        "cotton/published.toml",
        "mcc/study.toml",
        "mcc/real-size.toml",
        "water-beads/dry.toml",
        "water-beads/wet-1.toml",
        "water-beads/wet-3.toml",
        "water-beads/wet-3-rolling.toml",
        "water-beads/wet-5.toml",
        "water-beads/wet-1-filling.toml",
        "water-beads/wet-3-filling.toml",
        "water-beads/wet-5-filling.toml",
    ] {
        Study::read(&fixture(name), None).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}
