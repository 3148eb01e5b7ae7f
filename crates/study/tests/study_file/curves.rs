//! A measured curve in a study.

use super::folder::{Folder, problems};
use campaign::run_store::Record;
use campaign::{RunRequest, Simulator};
use dev_support::fixture_files::fixture;
use serde_json::json;

/// A study of the oedometer of the fixtures with a measured curve.
fn study(curve: &str) -> Folder {
    let folder = Folder::new(&format!(
        r#"
name = "curve"
[effects]
search = []
[[scene]]
name = "press"
file = "{}"
[[parameter]]
symbol = "G"
sets = ["material.pea.shear_modulus"]
unit = "MPa"
low = 2
high = 10
[[measured]]
scene = "press"
role = "fit"
curve = {curve}
"#,
        fixture("benches/compression.toml").display()
    ));
    let table = "stress_kpa,strain\n2,0\n4,0.01\n8,0.03\n";
    folder.write("curve.csv", table);
    folder
}

/// The record of a run with the strains at 2, 5 and 10 kPa.
fn record(strains: [f64; 3]) -> Record {
    let details = json!({
        "steady": true, "start_up_s": null, "motion": null, "froude_number": null, "last_frame_png_base64": null,
        "curve": { "name": "compression", "columns": { "stress_kpa": [2.0, 5.0, 10.0], "strain": strains } },
        "frames": {
            "times_s": [], "angles_deg": [], "angles_by_position_deg": [],
            "filling_angles_deg": [], "refused": 0, "effective_number": null,
        },
        "series": { "time_s": [], "centre_of_mass_deg": [] },
        "timing": {
            "time_step_s": 1e-4, "settling_time_step_s": 1e-4, "steps": 1, "bodies": 1, "spheres": 1,
            "threads": 1, "wall_s": 6.5, "cpu_s": 6.0, "filling_s": null, "us_per_step": null,
            "sphere_steps_per_s": null, "continued": false, "only_seen": false,
        },
    });
    Record::new("v", json!({}), 1)
        .expect("no null")
        .with_details(details)
}

/// The curve becomes two measurements with their correlation; the simulator of the study reads the same from the record of a run, here
/// 0.005 of strain for each kPa: 0, 0.01 and 0.03 at 2, 4 and 8 kPa are met by the line to their mean of 0.0133 and 0.0133.
#[test]
fn a_curve_is_measured_and_read() {
    let folder =
        study(r#"{ file = "curve.csv", sd = 0.002, correlation_length = 2.0, scores = 2 }"#);
    let study = folder.read(None).unwrap();
    let names: Vec<_> = study
        .problem
        .measurements
        .iter()
        .map(|m| m.observable.as_str())
        .collect();
    assert_eq!(
        names,
        ["compression_mean_strain", "compression_slope_strain"]
    );
    assert_eq!(study.problem.correlations.len(), 1);
    assert!(study.inputs.contains_key("curve.csv"), "{:?}", study.inputs);
    let simulator = study.simulator(&folder.path("out")).unwrap();
    let request = RunRequest::new("press", 1);
    let read = simulator
        .read_further(&request, &record([0.0, 0.015, 0.04]))
        .unwrap();
    let mean = &study.problem.measurements[0];
    assert!((mean.mean - 0.04 / 3.0).abs() < 1e-12);
    assert!((read[&mean.observable].mean - 0.04 / 3.0).abs() < 1e-12);
    let other = simulator.read_further(&RunRequest::new("drum", 1), &record([0.0; 3]));
    assert!(other.unwrap().is_empty(), "another model has no curve");
}

/// What a curve lacks is reported with its key; an apparatus without a curve names those that have one.
#[test]
fn a_wrong_curve_is_reported() {
    for (curve, key, told) in [
        (r#"{ file = "none.csv" }"#, "curve.file", "none.csv"),
        (
            r#"{ file = "curve.csv", scores = 1 }"#,
            "curve",
            "sd: is missing",
        ),
        (
            r#"{ file = "curve.csv", sd = 1, correlation_length = 1, scores = 9 }"#,
            "curve.scores",
            "it must be 1 to 2",
        ),
        (
            r#"{ file = "curve.csv", sd = 1, correlation_length = 1, scores = 1, error = 1 }"#,
            "curve.error",
            "unknown key",
        ),
    ] {
        let list = problems(&study(curve), None);
        let [problem] = &list[..] else {
            panic!("{list:?}");
        };
        assert!(
            problem.what.contains(key) && format!("{problem}").contains(told),
            "{problem}"
        );
        assert_eq!(problem.line, Some(17), "{problem}");
    }
    let sled = super::folder::with("curve = { file = \"curve.csv\" }");
    let list = problems(&Folder::new(&sled), None);
    assert!(list[0].problem.contains("hopper"), "{list:?}");
}
