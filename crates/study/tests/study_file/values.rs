//! Parameters that are handed over, and taken up again.

use super::folder::{Folder, STUDY, changed, reports, right, wrong};
use inference::Estimate;
use study::{parameter_file, write_result};

/// Estimates of both parameters of the study.
fn estimates() -> Vec<Estimate> {
    let study = right(STUDY);
    let values = [0.33, 0.1 + 0.2];
    let all = study.problem.parameters.iter().zip(values);
    all.map(|(p, value)| Estimate {
        symbol: p.symbol.clone(),
        name: p.name.clone(),
        unit: p.unit.clone(),
        sets: p.sets.clone(),
        start: p.start,
        value,
        se: Some(0.02),
        interval95: [value - 0.04, value + 0.04],
        fixed_by_data: true,
        at_limit: false,
        limits: p.limits,
    })
    .collect()
}

/// 0.1 + 0.2 is not 0.3: every bit comes back.
#[test]
fn a_parameter_file_and_a_result_bring_back_every_bit() {
    let folder = Folder::new(STUDY);
    let study = folder.read(None).unwrap();
    let estimates = estimates();
    folder.write(
        "parameters.toml",
        &parameter_file(&estimates).to_toml().unwrap(),
    );
    let result = serde_json::json!({ "parameters": estimates });
    write_result(&folder.path("result.json"), &result, &[]).unwrap();
    for name in ["parameters.toml", "result.json"] {
        let values = study.values_from(&folder.path(name)).unwrap();
        assert_eq!(values, [0.33, 0.1 + 0.2], "{name}");
    }
    assert_eq!(study.start_values(), [0.35, 0.25]);
}

#[test]
fn a_start_that_lacks_a_parameter_or_leaves_the_limits_is_refused() {
    let folder = Folder::new(STUDY);
    let study = folder.read(None).unwrap();
    let mut estimates = estimates();
    (estimates[1].value, estimates[1].interval95) = (1.6, [1.5, 1.7]);
    folder.write(
        "parameters.toml",
        &parameter_file(&estimates).to_toml().unwrap(),
    );
    let result = serde_json::json!({ "parameters": estimates[..1] });
    write_result(&folder.path("result.json"), &result, &[]).unwrap();
    for (name, words) in [
        ("parameters.toml", ["W = 1.6", "limits 0 to 1.5"]),
        ("result.json", ["W is missing", "has F"]),
    ] {
        let message = study
            .values_from(&folder.path(name))
            .unwrap_err()
            .to_string();
        for word in words.iter().chain(&[name]) {
            assert!(message.contains(word), "{message}");
        }
    }
}

/// One digit of an estimate altered: the file is refused in words, and so is one whose digest is gone.
#[test]
fn an_altered_result_is_refused() {
    let folder = Folder::new(STUDY);
    let study = folder.read(None).unwrap();
    let file = folder.path("result.json");
    let result = serde_json::json!({ "parameters": estimates() });
    write_result(&file, &result, &[]).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    let without = text.lines().filter(|line| !line.contains("\"digest\""));
    let without = without.collect::<String>();
    for (altered, why) in [
        (text.replace("0.33", "0.34"), "it was altered"),
        (without, "it has no digest"),
    ] {
        std::fs::write(&file, altered).unwrap();
        let message = study.values_from(&file).unwrap_err().to_string();
        for word in [why, "result.json", "parameters.toml"] {
            assert!(message.contains(word), "{message}");
        }
    }
}

#[test]
fn the_scene_of_the_decks_has_the_estimates() {
    let study = right(STUDY);
    let (scene, _) = parameter_file(&estimates())
        .applied(&study.scenes["drum"])
        .unwrap();
    let friction = |a: &str, b: &str| scene.contact_of(a, b).unwrap().static_friction.get();
    assert_eq!(
        (friction("pea", "pea"), friction("pea", "wall")),
        (0.33, 0.1 + 0.2)
    );
}

/// A standard deviation s of ten values has the standard error s / sqrt(18), and is marked as one.
#[test]
fn a_scatter_of_values_is_a_measurement_with_its_error() {
    let mean = "curvature = { mean = 0.1, sd = 0.02, n = 7.5 }";
    let study = right(&changed(
        mean,
        "fluctuation_deg = { scatter = 0.6, n = 10 }",
    ));
    let mut measured = study.problem.measurements.iter();
    let measured = measured
        .find(|m| m.observable == "fluctuation_deg")
        .unwrap();
    assert!(measured.is_scatter && measured.mean == 0.6);
    let error = measured.variance().sqrt();
    assert!((error - 0.6 / 18.0_f64.sqrt()).abs() < 1e-15, "{error}");

    for (value, key, word) in [
        ("{ scatter = 0.6, n = 1 }", "n = 1", "2 or more"),
        ("{ scatter = 0, n = 10 }", "scatter = 0", "above 0"),
        (
            "{ scatter = 0.6, sd = 0.1, n = 10 }",
            "fluctuation_deg",
            "leave out",
        ),
        ("{ mean = 0.6, n = 10 }", "fluctuation_deg", "'sd'"),
    ] {
        let study = changed(mean, &format!("fluctuation_deg = {value}"));
        reports(&study, &wrong(&study), key, word);
    }
}
