//! The file of a report: whole and repeatable.

use super::{headings, rows};
use crate::test_input::{example, spent};
use crate::test_residual::twins;
use crate::{DiagnosisInput, write, write_diagnosis};
use inference::ResidualStudy;
use std::collections::BTreeMap;

/// One whole file, the same for the same input, and nothing else in the folder.
#[test]
fn the_page_is_whole_and_the_same_input_gives_the_same_bytes() {
    let example = example();
    let written = || {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &example.input()).unwrap();
        write(folder.path(), &example.input()).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        std::fs::read(folder.path().join("report.html")).unwrap()
    };
    let first = written();
    assert!(first == written());
    assert!(first.ends_with(b"</html>\n"));
}

/// A heap of which no angle is read beside the drum: dashes, neither zeros nor a number, under its own name. An observable of
/// that no rows show alone has no table for it.
#[test]
fn what_a_condition_does_not_show_is_a_dash() {
    let mut study = twins();
    let heap = &mut study.plan.conditions[0];
    heap.model = Some("heap".into());
    heap.condition.clear();
    heap.observables = Some(BTreeMap::new());
    study.plan.conditions[0].values[0] = None;
    for row in &mut study.diagnosis.observable_support {
        row.z = None;
    }
    let page = page_of(&study);
    let told = rows(&page, "heap");
    let dashes = vec!["–"; 4];
    assert!(
        told.iter()
            .any(|row| row[1] == "used" && row[2..] == dashes),
        "{told:?}"
    );
    assert!(!page.contains("Which observable carries the verdict"));
    assert!(page_of(&twins()).contains("Which observable carries the verdict"));
}

/// What the page of a diagnosis alone is made of.
fn input_of(study: &ResidualStudy) -> DiagnosisInput<'_> {
    static NOTHING: BTreeMap<String, String> = BTreeMap::new();
    DiagnosisInput {
        name: "twins",
        version: "9.8.7",
        seed: 3,
        inputs: &NOTHING,
        defaults: &[],
        not_applicable: &NOTHING,
        planned_runs: 77,
        spent: spent(),
        study,
        trials: &[],
    }
}

fn page_of(study: &ResidualStudy) -> String {
    let folder = tempfile::tempdir().unwrap();
    write_diagnosis(folder.path(), &input_of(study)).unwrap();
    std::fs::read_to_string(folder.path().join("report.html")).unwrap()
}

#[test]
fn a_diagnosis_alone_has_a_page_with_the_same_section() {
    let study = twins();
    let reasons = BTreeMap::from([("wind".into(), "no air".into())]);
    let defaults = vec!["effects: all".to_owned()];
    let input = DiagnosisInput {
        defaults: &defaults,
        not_applicable: &reasons,
        ..input_of(&study)
    };
    let folder = tempfile::tempdir().unwrap();
    write_diagnosis(folder.path(), &input).unwrap();
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let expected = [
        "The answer",
        "What it rests on",
        "What was left out, and what it cost",
    ];
    assert_eq!(headings(&page), expected);
    assert!(page.contains("wind: no air") && page.contains("effects: all"));
    assert!(page.contains(
        "At most 77 runs were planned. All runs took 98 s of one core, and this call 54 s."
    ));
    assert!(page.contains("the band is twice the standard error"));
}
