//! The set of solutions on the published study's surface, and on random quadratics.

#![expect(
    clippy::unwrap_used,
    reason = "the helpers of tests may fail like tests"
)]

use experiment_design::table::{Table, factors_from_csv};
use experiment_design::{AxialDistance, Factor, central_composite};
use probability::random_stream::Stream;
use response_surface::solutions::roots_along;
use response_surface::{
    Cell, Error, ErrorSource, Fit, Measured, Model, Observations, SolutionRequest, Solutions, fit,
    solutions,
};
use serde_json::Value;

/// Error of the model, standard deviation of the target, and what the reference calls both.
const CASES: [(ErrorSource, Option<f64>, &str); 4] = [
    (ErrorSource::Residual, None, "model_mse"),
    (
        ErrorSource::Residual,
        Some(0.59),
        "model_mse_plus_target_sem",
    ),
    (ErrorSource::Replicates, None, "replicate_var"),
    (
        ErrorSource::Replicates,
        Some(0.59),
        "replicate_var_plus_target_sem",
    ),
];

fn expected() -> Value {
    let text = include_str!("../../../../fixtures/paper/recomputed.json");
    serde_json::from_str::<Value>(text).unwrap()["contour_38_87"].clone()
}

/// The quadratic of Table 5.
fn study() -> Fit {
    let all = factors_from_csv(include_str!(
        "../../../../fixtures/paper/factors_table2.csv"
    ))
    .unwrap();
    let symbols = ["B", "E", "F"];
    let factors: Vec<Factor> = all
        .into_iter()
        .filter(|f| symbols.contains(&f.symbol()))
        .collect();
    let table = Table::parse(include_str!("../../../../fixtures/paper/bbd_table5.csv")).unwrap();
    let number = |row, name| table.number(row, table.column(name).unwrap()).unwrap();
    let cell = |row| Cell {
        coded: symbols.iter().map(|s| number(row, s)).collect(),
        mean: number(row, "theta_deg"),
        sd: Some(number(row, "theta_sd_deg")),
        n: 5,
        block: 1,
    };
    let data = Observations::from_cells(table.rows().iter().map(cell).collect()).unwrap();
    fit(&factors, &Model::quadratic(&factors).unwrap(), &data).unwrap()
}

fn measured(value: f64, sd: f64, n: usize) -> Measured {
    Measured {
        value,
        sd: Some(sd),
        n: Some(n),
    }
}

/// The study's target and measured means (Table 2).
fn study_request(error: ErrorSource) -> SolutionRequest {
    SolutionRequest {
        target: 38.87,
        target_sd: Some(0.59),
        target_n: Some(10),
        near: vec![
            Some(measured(0.32, 0.05, 5)),
            Some(measured(0.06, 0.05, 40)),
            Some(measured(0.56, 0.03, 5)),
        ],
        error: Some(error),
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The expected solutions are good to 1e-9 of the range; relative 1e-6 coded is asked for.
#[test]
fn nearest_solutions_under_each_metric_are_the_recomputed_ones() {
    let fit = study();
    let got = solutions(&fit, &study_request(ErrorSource::Residual)).unwrap();
    for (name, key) in [("sd", "sd"), ("standard_error", "sem"), ("coded", "coded")] {
        let nearest = got.nearest.get(name).unwrap();
        let expected = &expected()["nearest_to_measured"][key];
        for (j, factor) in fit.factors.iter().enumerate() {
            let coded = factor.coded(number(&expected["solution"][j]));
            assert!(
                (nearest.coded[j] - coded).abs() < 1e-6,
                "{name} {j}: {nearest:?}"
            );
        }
        let distance = number(&expected["distance"]);
        assert!(
            (nearest.distance / distance - 1.0).abs() < 1e-9,
            "{name}: {}",
            nearest.distance
        );
        assert_eq!(nearest.at_bound, ["F"], "{name}");
        assert_eq!(nearest.solution[2], 0.10, "{name}");
        assert!(
            (nearest.value - 38.87).abs() < 1e-9,
            "{name}: {}",
            nearest.value
        );
    }
}

#[test]
fn ranges_of_the_factors_on_the_contour_are_the_recomputed_ones() {
    let got = solutions(&study(), &study_request(ErrorSource::Residual)).unwrap();
    let ranges = got.factor_ranges.unwrap();
    let f = ranges.get("F").unwrap();
    let expected_low = number(&expected()["F_range_on_contour"][0]);
    assert!((f.natural.low / expected_low - 1.0).abs() < 1e-9, "{f:?}");
    assert_eq!(f.natural.high, 0.10);
    // Any E has a solution; B starts at about 0.304 (three digits are known).
    let e = ranges.get("E").unwrap();
    assert_eq!((e.natural.low, e.natural.high), (0.01, 0.18));
    let b = ranges.get("B").unwrap();
    assert!(
        (b.natural.low - 0.304).abs() < 5e-4 && b.natural.high == 0.42,
        "{b:?}"
    );
}

#[test]
fn solutions_along_one_factor_are_the_recomputed_ones() {
    let (fit, expected) = (study(), expected());
    let cases = [
        (0, [0.36, 0.06, 0.10], "B_at_E006_F010"),
        (2, [0.33, 0.06, 0.05], "F_at_B033_E006"),
        (2, [0.32, 0.06, 0.05], "F_at_B032_E006_outside_box"),
    ];
    for (i, point, key) in cases {
        let expected = number(&expected[key]);
        let roots = roots_along(&fit, 38.87, &point, i).unwrap();
        assert!(
            roots.iter().any(|u| (u / expected - 1.0).abs() < 1e-9),
            "{key}: {roots:?}"
        );
    }
    // Every listed point of the contour has the target as its value (rounding, 1e-9 deg).
    for point in expected["points"].as_array().unwrap() {
        let natural: Vec<f64> = serde_json::from_value(point.clone()).unwrap();
        let value = fit.value(&fit.coded(&natural));
        assert!((value - 38.87).abs() < 1e-9, "{natural:?}: {value}");
    }
}

/// The reference walks B in steps of 1.2e-5 (a ten-thousandth of its range) and keeps the last
/// node inside, so the true ends lie beyond it by less than a step. The solution that is near in
/// E and F above all lies at E = 0.06, F = 0.10.
#[test]
fn intervals_given_the_others_agree_to_a_step_of_the_reference() {
    let fit = study();
    let expected = &expected()["B_interval95_at_E006_F010_clipped_to_box"];
    let exact = |value| {
        Some(Measured {
            value,
            sd: Some(1e-7),
            n: Some(1),
        })
    };
    let loose = Some(Measured {
        value: 0.32,
        sd: Some(1.0),
        n: Some(1),
    });
    for (error, target_sd, key) in CASES {
        let request = SolutionRequest {
            target_sd,
            target_n: target_sd.map(|_| 10),
            near: vec![loose, exact(0.06), exact(0.10)],
            ..study_request(error)
        };
        let got = solutions(&fit, &request).unwrap();
        let nearest = got.nearest.get("sd").unwrap();
        let b = nearest.given_others.as_ref().unwrap().get("B").unwrap();
        let low = number(&expected[key][0]) - b.natural.low;
        let high = b.natural.high - number(&expected[key][1]);
        for beyond in [low, high] {
            assert!((-1e-9..1.2e-5).contains(&beyond), "{key}: {:?}", b.natural);
        }
        assert_eq!(b.open_below, number(&expected[key][0]) == 0.30, "{key}");
    }
}

/// The reference counts the nodes of a grid of 161^3 that stand on the bounds too; such a count
/// differs from the volume by up to about half a layer of nodes on each bounded side, here less
/// than 0.002. `region_fraction_is_that_of_a_plain_count` has the sharper bound.
#[test]
fn box_fractions_agree_with_the_reference_grid() {
    let (fit, expected) = (study(), expected());
    for (error, target_sd, key) in CASES {
        let request = SolutionRequest {
            target_sd,
            target_n: target_sd.map(|_| 10),
            ..study_request(error)
        };
        let got = solutions(&fit, &request)
            .unwrap()
            .region
            .unwrap()
            .box_fraction;
        let expected = number(&expected["box_fraction_in_95pct_region"][key]);
        assert!(
            (got - expected).abs() < 0.002,
            "{key}: got {got}, expected {expected}"
        );
    }
}

/// A plain count over the midpoints of 40^3 cells: its error is about the share of cells that the
/// two surfaces of the region cut (2 * 40^2 / 40^3 = 0.05) over the root of their number (57),
/// 0.0005 (one standard error); four of them are allowed.
#[test]
fn region_fraction_is_that_of_a_plain_count() {
    let fit = study();
    let got = solutions(&fit, &study_request(ErrorSource::Residual)).unwrap();
    let (t, error) = (got.region.as_ref().unwrap().t_limit, got.error.unwrap());
    let middle = |i: i32| (f64::from(i) + 0.5) / 20.0 - 1.0;
    let mut inside = 0;
    for index in 0..64_000 {
        let x = [
            middle(index % 40),
            middle(index / 40 % 40),
            middle(index / 1600),
        ];
        let variance = error.variance * fit.leverage(&x) + 0.59 * 0.59 / 10.0;
        inside += i32::from((fit.value(&x) - 38.87).abs() <= t * variance.sqrt());
    }
    let (count, share) = (
        f64::from(inside) / 64_000.0,
        got.region.unwrap().box_fraction,
    );
    assert!(
        (share - count).abs() < 0.002,
        "{share} against a count of {count}"
    );
}

/// A quadratic surface in k factors with random coefficients, fitted to exact values.
fn random_surface(stream: &mut Stream, k: usize) -> Fit {
    let factors: Vec<Factor> = (0..k)
        .map(|i| Factor::new(&format!("x{i}"), "", "1", 0.0, 2.0 + i as f64).unwrap())
        .collect();
    let model = Model::quadratic(&factors).unwrap();
    let coefficients: Vec<f64> = model
        .terms()
        .iter()
        .map(|_| stream.between(-1.0, 1.0))
        .collect();
    let design = central_composite(&factors, AxialDistance::Face, 3).unwrap();
    let value = |x: &Vec<f64>| {
        model
            .row(x)
            .iter()
            .zip(&coefficients)
            .map(|(r, c)| r * c)
            .sum()
    };
    let cells = design
        .coded_rows()
        .into_iter()
        .map(|x| Cell::single(x.clone(), value(&x)));
    let data = Observations::from_cells(cells.collect()).unwrap();
    fit(&factors, &model, &data).unwrap()
}

/// Least squared coded distance of a zero found by solving for the last coordinate on a fine grid
/// of the others: an upper bound that the true least distance undercuts by the grid at most.
fn distance_by_brute_force(fit: &Fit, target: f64, centre: &[f64]) -> Option<f64> {
    let k = centre.len();
    let steps: usize = if k == 2 { 1001 } else { 101 };
    let at = |i: usize| -1.0 + 2.0 * i as f64 / (steps - 1) as f64;
    let mut best: Option<f64> = None;
    for index in 0..steps.pow(u32::try_from(k - 1).unwrap()) {
        let mut x: Vec<f64> = (0..k - 1)
            .map(|j| at(index / steps.pow(u32::try_from(j).unwrap()) % steps))
            .collect();
        x.push(0.0);
        let [low, mid, high] = [-1.0, 0.0, 1.0].map(|last| {
            x[k - 1] = last;
            fit.value(&x) - target
        });
        let (a, b, c) = (0.5 * (low + high) - mid, 0.5 * (high - low), mid);
        let root = (b * b - 4.0 * a * c).sqrt();
        for last in [(-b + root) / (2.0 * a), (-b - root) / (2.0 * a)] {
            if last.abs() <= 1.0 {
                x[k - 1] = last;
                let squared: f64 = x.iter().zip(centre).map(|(x, c)| (x - c) * (x - c)).sum();
                best = Some(best.map_or(squared, |least: f64| least.min(squared)));
            }
        }
    }
    best.map(f64::sqrt)
}

/// The nearest solution is never farther than what brute force finds (rounding: 1e-9), and not
/// nearer by more than the step of its grid (the distance changes by no more than the grid's
/// half-step times the steepness of the surface; a tenth is a generous bound for the coarse one).
#[test]
fn nearest_solution_of_random_quadratics_is_that_of_brute_force() {
    let mut stream = Stream::new(11, "random quadratics");
    let mut compared = 0;
    for trial in 0..60 {
        let k = if trial % 6 == 0 { 3 } else { 2 };
        let fit = random_surface(&mut stream, k);
        let centre: Vec<f64> = (0..k).map(|_| stream.between(-1.6, 1.6)).collect();
        let target = stream.between(-1.5, 1.5);
        let near = fit.natural(&centre);
        let near = near.iter().map(|&value| {
            Some(Measured {
                value,
                sd: None,
                n: None,
            })
        });
        let request = SolutionRequest {
            near: near.collect(),
            ..SolutionRequest::for_target(target)
        };
        let got = solutions(&fit, &request).unwrap();
        let Some(brute) = distance_by_brute_force(&fit, target, &centre) else {
            continue;
        };
        let nearest = got
            .nearest
            .get("coded")
            .unwrap_or_else(|| panic!("trial {trial}: none"));
        assert!(
            (nearest.value - target).abs() < 1e-9,
            "trial {trial}: {}",
            nearest.value
        );
        assert!(
            nearest.coded.iter().all(|x| x.abs() <= 1.0),
            "trial {trial}: {nearest:?}"
        );
        let distance = nearest.distance;
        let grid = if k == 2 { 1e-2 } else { 0.2 };
        assert!(
            distance <= brute + 1e-9,
            "trial {trial}: {distance} against {brute}"
        );
        assert!(
            distance >= brute - grid,
            "trial {trial}: {distance} against {brute}"
        );
        compared += 1;
    }
    assert!(compared > 30, "only {compared} surfaces reach their target");
}

/// Centre of symmetry: y = x0^2 + 2 x1^2 seen from (0, 0). The gradient there is zero, so the
/// multiplier sits on a pole; the nearest point with y = 0.5 is (0, +-0.5), at distance 0.5.
#[test]
fn nearest_solution_seen_from_the_centre_of_an_ellipse_is_on_its_short_axis() {
    let factors = [
        Factor::coded_only("U").unwrap(),
        Factor::coded_only("V").unwrap(),
    ];
    let design = central_composite(&factors, AxialDistance::Face, 1).unwrap();
    let value = |x: &[f64]| x[0] * x[0] + 2.0 * x[1] * x[1];
    let cells = design
        .coded_rows()
        .into_iter()
        .map(|x| Cell::single(x.clone(), value(&x)));
    let data = Observations::from_cells(cells.collect()).unwrap();
    let fit = fit(&factors, &Model::quadratic(&factors).unwrap(), &data).unwrap();
    let got = solutions(&fit, &SolutionRequest::for_target(0.5)).unwrap();
    let nearest = got.nearest.get("coded").unwrap();
    assert!((nearest.distance - 0.5).abs() < 1e-9, "{nearest:?}");
    assert!(nearest.coded[0].abs() < 1e-6, "{nearest:?}");
    let range = got.factor_ranges.unwrap();
    let u = range.get("U").unwrap();
    assert!((u.coded.high - 0.5_f64.sqrt()).abs() < 1e-9, "{u:?}");
}

#[test]
fn a_target_out_of_reach_is_a_value_with_the_reachable_range() {
    let got: Solutions = solutions(&study(), &SolutionRequest::for_target(45.0)).unwrap();
    assert!(!got.exists);
    assert!(got.nearest.is_empty() && got.factor_ranges.is_none());
    assert!((got.reachable.max.value - 41.40925).abs() < 1e-9);
    assert!((got.reachable.min.value - 30.75425).abs() < 1e-9);
    assert!(got.region.unwrap().box_fraction == 0.0);
}

#[test]
fn requests_that_cannot_be_meant_are_refused() {
    let fit = study();
    let good = study_request(ErrorSource::Residual);
    let bad = [
        SolutionRequest {
            target: f64::NAN,
            ..good.clone()
        },
        SolutionRequest {
            target_n: None,
            ..good.clone()
        },
        SolutionRequest {
            target_sd: Some(-1.0),
            ..good.clone()
        },
        SolutionRequest {
            target_n: Some(0),
            ..good.clone()
        },
        SolutionRequest {
            near: vec![Some(measured(0.3, 0.0, 5)), None, None],
            ..good.clone()
        },
        SolutionRequest {
            near: vec![None],
            ..good
        },
    ];
    for request in bad {
        let answer = solutions(&fit, &request);
        let refused = matches!(
            answer,
            Err(Error::SettingOutOfRange { .. } | Error::Length { .. })
        );
        assert!(refused, "{request:?} gives {answer:?}");
    }
}
