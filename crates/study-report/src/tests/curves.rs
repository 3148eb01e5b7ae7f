//! A measured curve beside those of the runs.

use super::page;
use crate::CurvePoints;
use crate::test_input::example;
use campaign::run_store::Record;
use serde_json::json;

/// The check of the example as the mean of a curve, with two repeats, and the record of its run with another curve.
#[test]
fn a_measured_curve_is_drawn_beside_the_simulated_one() {
    let mut example = example();
    let name = "discharge_mean_mass_g";
    let model = example.problem.models[example.problem.measurements[0].model]
        .name
        .clone();
    example.problem.measurements[0].observable = name.into();
    example.calibration.check[0].observable = name.into();
    example.curves = vec![CurvePoints {
        model: model.clone(),
        name: "discharge".into(),
        along: "time_s".into(),
        column: "mass_g".into(),
        repeats: vec![vec![[0.0, 0.0], [1.0, 31.0]], vec![[0.0, 0.0], [1.0, 33.0]]],
    }];
    let caption = format!("{model}, discharge: measured");
    assert!(
        !page(&example).contains(&caption),
        "the record has no curve"
    );
    let (key, record) = example.records.pop_first().unwrap();
    let mut details = record.details().clone();
    let columns = json!({ "time_s": [0.0, 0.5, 1.0], "mass_g": [0.0, 16.0, 32.0] });
    details["curve"] = json!({ "name": "discharge", "columns": columns });
    let with_curve = Record::new("0", record.inputs().clone(), record.seed());
    example
        .records
        .insert(key, with_curve.unwrap().with_details(details));
    let page = page(&example);
    let chart = page
        .split(&caption)
        .next()
        .unwrap()
        .rsplit("<figure")
        .next()
        .unwrap();
    for word in ["measured", "simulated", "mass", "time"] {
        assert!(chart.contains(word), "no {word} in the chart");
    }
    // Two repeats of two points.
    assert_eq!(chart.matches("<circle").count() - 1, 4, "{chart}");
}
