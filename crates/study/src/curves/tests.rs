use super::{CurveScores, MeasuredCurve, value_at, weights_at};
use crate::file::CurveEntry;
use campaign::run_store::Record;
use probability::random_stream::Stream;
use scene::CurveKind;
use serde_json::json;
use std::path::Path;

const FLOW: CurveKind = CurveKind {
    name: "discharge",
    along: "time_s",
    values: &["mass_g", "percent"],
    is_kept: true,
};

fn places() -> Vec<f64> {
    (0..40_i32).map(|k| 0.1 * f64::from(k)).collect()
}

fn scores_at(places: Vec<f64>, scores: usize) -> CurveScores {
    CurveScores {
        kind: FLOW,
        column: "mass_g".into(),
        weights: weights_at(&places, scores),
        places,
    }
}

/// Writes a table and reads it as a curve.
fn read(
    table: &str,
    sd: Option<f64>,
    length: Option<f64>,
    scores: usize,
) -> Result<MeasuredCurve, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("curve.csv"), table).unwrap();
    let entry = CurveEntry {
        file: "curve.csv".into(),
        sd,
        correlation_length: length,
        scores,
    };
    MeasuredCurve::read(&entry, folder.path(), FLOW)
        .map_err(|(key, fault)| format!("{key}: {fault}"))
}

/// A straight line a + b x has the scores a + b <x>, b times the standard deviation of x, and 0; the squares of the scores add up to the
/// mean square of the values, and nothing is left. To rounding.
#[test]
fn a_line_has_a_mean_and_a_slope() {
    let x = places();
    let line: Vec<f64> = x.iter().map(|x| 3.0 - 2.0 * x).collect();
    let scores = scores_at(x.clone(), 3);
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let spread = (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    let found = scores.of(&line);
    for (found, expected) in found.iter().zip([3.0 - 2.0 * mean, -2.0 * spread, 0.0]) {
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }
    let square = line.iter().map(|y| y * y).sum::<f64>() / n;
    assert!((found.iter().map(|s| s * s).sum::<f64>() - square).abs() < 1e-12);
    assert!(scores.left_of(&line) < 1e-12);
    // A parabola has a bend, which two scores leave.
    let bent: Vec<f64> = x.iter().map(|x| (x - mean).powi(2)).collect();
    let bend = scores.of(&bent)[2];
    assert!((scores_at(x, 2).left_of(&bent) - bend).abs() < 1e-12 && bend > 0.5);
}

/// Curves drawn with deviations of 0.5 that are correlated over 1.5 (an autoregressive series on the even places) have scores whose
/// variances and covariance are those computed. 4000 draws know a variance to 2.2 %: 9 % is four of that. Independent values would make the
/// variance of the mean 16 times smaller.
#[test]
fn scores_scatter_as_their_covariance_says() {
    let rows: Vec<String> = places().iter().map(|x| format!("{x},1")).collect();
    let text = rows.join("\n");
    let curve = read(&format!("time_s,mass_g\n{text}"), Some(0.5), Some(1.5), 3).unwrap();
    let (mut stream, memory) = (Stream::new(7, "curves"), (-0.1_f64 / 1.5).exp());
    let mut sums = [[0.0; 3]; 3];
    for _ in 0..4000 {
        let mut value = 0.5 * stream.normal();
        let drawn: Vec<f64> = places()
            .iter()
            .map(|_| {
                let now = value;
                value = memory * value + 0.5 * (1.0 - memory * memory).sqrt() * stream.normal();
                now
            })
            .collect();
        let scores = curve.scores.of(&drawn);
        for (a, row) in sums.iter_mut().enumerate() {
            for (b, sum) in row.iter_mut().enumerate() {
                *sum += scores[a] * scores[b] / 4000.0;
            }
        }
    }
    for (k, (name, value)) in curve.values.iter().enumerate() {
        let ratio = sums[k][k] / value.sd.powi(2);
        assert!((ratio - 1.0).abs() < 0.09, "{name}: {ratio}");
    }
    // Mean and bend go together, mean and slope do not: the correlation is known to 0.016.
    let both = |a: usize, b: usize| sums[a][b] / (sums[a][a] * sums[b][b]).sqrt();
    for correlation in &curve.correlations {
        let place = |name: &str| curve.values.iter().position(|v| v.0 == name).unwrap();
        let drawn = both(place(&correlation.a), place(&correlation.b));
        assert!(
            (drawn - correlation.value).abs() < 0.064,
            "{correlation:?}: {drawn}"
        );
    }
    let independent = 0.25 / 40.0;
    assert!(curve.values[0].1.sd.powi(2) > 16.0 * independent);
}

/// Five repeats that differ by a level of 2, 1, 0, -1 and -2: the mean has the standard deviation sqrt(2.5) of n = 5; nothing is stated.
#[test]
fn repeats_show_their_own_scatter() {
    let row = |k: i32| {
        let wiggle = 0.01 * f64::from(k * k % 5);
        let value = |r: i32| f64::from(k + r) + wiggle * f64::from(r * r);
        let values: Vec<String> = (-2..=2).map(|r| value(r).to_string()).collect();
        format!("{k},{}", values.join(","))
    };
    let rows: Vec<String> = (0..9).map(row).collect();
    let rows = rows.join("\n");
    let table = format!("time_s,mass_g,mass_g_2,mass_g_3,mass_g_4,mass_g_5\n{rows}");
    let curve = read(&table, None, None, 3).unwrap();
    let (name, mean) = &curve.values[0];
    assert_eq!((name.as_str(), mean.n), ("discharge_mean_mass_g", 5.0));
    assert!((mean.sd - 2.5_f64.sqrt()).abs() < 0.02, "{}", mean.sd);
    let refused = read(&table, None, None, 4).unwrap_err();
    assert!(refused.starts_with("sd: is missing"), "{refused}");
}

/// A run whose curve lies on the measured one has its scores, with other places of its own and beyond its end, where a discharge keeps its
/// mass; a curve that has ended before is refused by its end.
#[test]
fn a_run_is_read_at_the_measured_places() {
    let details = |name: &str, column: &str| {
        json!({
            "steady": true, "start_up_s": null, "motion": null, "froude_number": null, "last_frame_png_base64": null,
            "curve": { "name": name, "columns": { "time_s": [0.0, 1.0, 2.0], column: [0.0, 10.0, 20.0] } },
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
        })
    };
    let record = |details| {
        Record::new("v", json!({}), 1)
            .unwrap()
            .with_details(details)
    };
    let table = "time_s,mass_g\n0.25,2.5\n0.5,5\n1.5,15\n2.5,20\n";
    let measured = read(table, Some(0.1), Some(0.5), 2).unwrap();
    let found = measured
        .scores
        .read(&record(details("discharge", "mass_g")))
        .unwrap();
    for (name, value) in &measured.values {
        assert!((found[name].mean - value.mean).abs() < 1e-12, "{name}");
        assert_eq!(found[name].unit, "g");
    }
    let ends = CurveScores {
        kind: CurveKind {
            is_kept: false,
            ..FLOW
        },
        ..measured.scores.clone()
    };
    let refused = ends
        .read(&record(details("discharge", "mass_g")))
        .unwrap_err();
    assert!(
        refused.contains("ends at time_s 2") && refused.contains("2.5"),
        "{refused}"
    );
    let refused = ends.read(&record(details("shear", "mass_g"))).unwrap_err();
    assert!(refused.contains("no curve 'discharge'"), "{refused}");
}

/// A fault of a table or of its error is named with its place.
#[test]
fn a_wrong_curve_is_refused() {
    let good = "time_s,mass_g\n0,0\n1,1\n2,2\n";
    for (table, sd, length, scores, told) in [
        (
            "t,mass_g\n0,0\n1,1\n",
            Some(1.0),
            Some(1.0),
            1,
            "the first column must be time_s",
        ),
        (
            "time_s,mass_kg\n0,0\n1,1\n",
            Some(1.0),
            Some(1.0),
            1,
            "mass_g or percent",
        ),
        (
            "time_s,mass_g\n0,0\n2,1\n1,2\n",
            Some(1.0),
            Some(1.0),
            1,
            "1 is not above the one before",
        ),
        (
            "time_s,mass_g\n0,0\n1,x\n",
            Some(1.0),
            Some(1.0),
            1,
            "line 3",
        ),
        (good, Some(1.0), Some(1.0), 3, "it must be 1 to 2"),
        (good, Some(1.0), Some(1.0), 0, "it must be 1 to 2"),
        (
            good,
            Some(0.0),
            Some(1.0),
            2,
            "sd: is 0: it must be above 0",
        ),
        (
            good,
            Some(1.0),
            Some(f64::NAN),
            2,
            "correlation_length: is NaN",
        ),
        (good, Some(1.0), None, 2, "correlation_length: is missing"),
        (good, None, None, 2, "sd: is missing"),
    ] {
        let refused = read(table, sd, length, scores).unwrap_err();
        assert!(refused.contains(told), "{refused} for {told}");
    }
    let entry = CurveEntry {
        file: "none.csv".into(),
        sd: None,
        correlation_length: None,
        scores: 1,
    };
    let (key, fault) = MeasuredCurve::read(&entry, Path::new("."), FLOW).unwrap_err();
    assert!(key == "file" && fault.contains("none.csv"), "{fault}");
}

/// Between two values a curve is a line; beyond its ends it keeps its value.
#[test]
fn a_curve_is_read_between_its_values() {
    let at = |x| value_at(x, &[1.0, 2.0, 4.0], &[10.0, 20.0, 0.0]);
    assert_eq!(
        [at(0.0), at(1.0), at(1.5), at(3.0), at(9.0)],
        [10.0, 10.0, 15.0, 10.0, 0.0]
    );
}
