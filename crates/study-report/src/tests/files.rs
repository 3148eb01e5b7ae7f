//! The files of a report: whole, repeatable, in full precision.

use super::{headings, rows};
use crate::test_input::{example, spent};
use crate::test_residual::twins;
use crate::test_study::study;
use crate::{DiagnosisInput, Extent, write, write_diagnosis};
use inference::ResidualStudy;
use std::collections::BTreeMap;

/// The lines of a table on disk.
pub(super) fn table(folder: &std::path::Path, name: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("tables").join(name)).unwrap();
    text.lines().map(String::from).collect()
}

#[test]
fn tables_hold_full_precision_and_name_their_units() {
    let example = example();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &example.input(), Extent::WithParts).unwrap();
    let measurements = table(folder.path(), "measurements.csv");
    assert!(measurements[0].starts_with("scene,condition,observable,unit,role,measured_mean,measured_sd,measured_n,measured_se,before_mean"));
    let se = (0.8_f64 * 0.8 / 10.0).sqrt();
    let drum = measurements
        .iter()
        .find(|l| l.starts_with("drum,apparatus.speed = 15 rpm"));
    assert!(drum.unwrap().starts_with(&format!(
        "drum,apparatus.speed = 15 rpm,angle_deg,°,fit,33.1,0.8,10.0,{se:?},30.4,0.12,4,9.6,33.25,0.12,4,-0.5,0.31,2.26,yes,3 rolling 1 slumping,"
    )), "{drum:?}");
    let parameters = table(folder.path(), "parameters.csv");
    assert!(
        parameters[2].starts_with("E,name of E,1,0.4,0.05,"),
        "{}",
        parameters[2]
    );
    assert!(
        parameters[2].contains(",0.4,0.05,yes,no,0.41,0.03,"),
        "{}",
        parameters[2]
    );
    let runs = table(folder.path(), "runs.csv");
    assert_eq!(
        runs[0],
        "stage,model,seed,F_1,E_1,angle_deg,shown_static_friction_1,run_key"
    );
    // 11 of the drum, 10 of the sled, 1 of the check, with every digit of its seed.
    assert_eq!(runs.len(), 1 + 11 + 10 + 1);
    let last = runs.last().unwrap();
    assert!(
        last.starts_with("comparison,drum-30,18446744073709551615,0.33,0.4,36.25,,"),
        "{last}"
    );
    let boxes = table(folder.path(), "boxes.csv");
    assert_eq!(boxes[3], "2,moved,F,1,0.2,0.7,0.33,0.61,21");
    let left_out = table(folder.path(), "runs_left_out.csv");
    assert_eq!(
        left_out[1],
        "drum-15,0.6,0.1,\"it slides, and the others roll\""
    );
    let surfaces = table(folder.path(), "surfaces.csv");
    assert!(
        surfaces
            .iter()
            .any(|line| line.starts_with("drum-15,angle_deg,°,FE,")),
        "{surfaces:?}"
    );
    assert_eq!(table(folder.path(), "correlations.csv")[2], "E,-0.62,1.0");
}

#[test]
fn files_are_whole_and_the_same_input_gives_the_same_bytes() {
    let example = example();
    let written = || {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &example.input(), Extent::WithParts).unwrap();
        write(folder.path(), &example.input(), Extent::WithParts).unwrap();
        let mut files = BTreeMap::new();
        for part in ["", "tables", "pictures"] {
            for entry in std::fs::read_dir(folder.path().join(part)).unwrap() {
                let path = entry.unwrap().path();
                if path.is_file() {
                    let name = path.file_name().unwrap().to_owned();
                    files.insert((part, name), std::fs::read(&path).unwrap());
                }
            }
        }
        files
    };
    let (first, second) = (written(), written());
    assert_eq!(first, second);
    assert!(
        first
            .keys()
            .all(|(_, name)| !name.to_string_lossy().contains("aside"))
    );
    let page = &first[&("", "report.html".into())];
    assert!(page.ends_with(b"</html>\n"));
}

/// A heap of which no angle is read beside the drum: dashes, neither zeros nor a number, under its own name. An observable of
/// which no rows tell alone has no table for it.
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
        parameters: &[],
        defaults: &[],
        not_applicable: &NOTHING,
        planned_runs: 77,
        spent: spent(),
        study,
        trials: &[],
    }
}

/// That page.
fn page_of(study: &ResidualStudy) -> String {
    let folder = tempfile::tempdir().unwrap();
    write_diagnosis(folder.path(), &input_of(study), Extent::Page).unwrap();
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
    write_diagnosis(folder.path(), &input, Extent::WithParts).unwrap();
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
    assert!(folder.path().join("tables/diagnosis_models.csv").is_file());
    assert!(
        folder
            .path()
            .join("pictures/diagnosis-residuals.svg")
            .is_file()
    );
}

/// Without its parts a report is one page, the same as with them.
#[test]
fn a_report_is_one_page_where_nothing_else_is_asked_for() {
    let study = study();
    let [alone, whole] = [Extent::Page, Extent::WithParts].map(|extent| {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &study.input(), extent).unwrap();
        let files = std::fs::read_dir(folder.path()).unwrap().count();
        let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
        (files, page)
    });
    assert_eq!((alone.0, whole.0), (1, 3));
    assert!(alone.1 == whole.1);
}
