//! Orders, reduction, transformation, ridge paths, compromises and confirmation on cases with known
//! answers.

#![expect(
    clippy::unwrap_used,
    reason = "the helpers of tests may fail like tests"
)]

use experiment_design::table::Table;
use experiment_design::{AxialDistance, Factor, box_behnken, central_composite};
use probability::random_stream::Stream;
use response_surface::{
    Aim, Cell, ErrorSource, Fit, Goal, Model, Observations, ReductionRule, Weighting, box_cox,
    compromises, confirm, fit, fit_weighted, orders, reduce, ridge_path,
};
use serde_json::Value;

fn factors(symbols: &str) -> Vec<Factor> {
    let symbols = symbols.chars();
    symbols
        .map(|c| Factor::coded_only(&c.to_string()).unwrap())
        .collect()
}

/// The published Box-Behnken table.
fn published() -> Observations {
    let table = Table::parse(include_str!("../../../../fixtures/paper/bbd_table5.csv")).unwrap();
    let number = |row, name: &str| table.number(row, table.column(name).unwrap()).unwrap();
    let cell = |row| Cell {
        sd: Some(number(row, "theta_sd_deg")),
        n: 5,
        ..Cell::single(
            ["B", "E", "F"].map(|c| number(row, c)).to_vec(),
            number(row, "theta_deg"),
        )
    };
    Observations::from_cells(table.rows().iter().map(cell).collect()).unwrap()
}

/// A surface over a rotatable design with noise of a given size.
fn simulated(truth: &dyn Fn(&[f64]) -> f64, sd: f64) -> (Vec<Factor>, Observations) {
    let f = factors("AB");
    let design = central_composite(&f, AxialDistance::Face, 5)
        .unwrap()
        .replicated(4)
        .unwrap();
    let mut stream = Stream::new(4, "test");
    let cell = |x: Vec<f64>| {
        let y = truth(&x) + sd * stream.normal();
        Cell::single(x, y)
    };
    let cells = design.coded_rows().into_iter().map(cell).collect();
    (f, Observations::from_cells(cells).unwrap())
}

/// Sums of squares and residuals of every order are those of the recomputation; of a cubic a
/// Box-Behnken design in three factors leaves seven terms aliased. 1e-9: as for the tables.
#[test]
fn orders_of_the_published_table_are_the_recomputed_ones() {
    let text = include_str!("../../../../fixtures/paper/recomputed.json");
    let expected: Value = serde_json::from_str(text).unwrap();
    let expected = &expected["bbd_quadratic"];
    let got = orders(&factors("BEF"), &published(), Weighting::Counts).unwrap();
    let close = |a: f64, b: &Value| {
        let b = b.as_f64().unwrap();
        assert!((a / b - 1.0).abs() < 1e-9, "{a} against {b}");
    };
    let sums = &expected["sequential_model_ss"];
    for (i, key) in [(1, "linear"), (2, "two_fi"), (3, "quadratic")] {
        close(got.orders[i].added_ss, &sums[key]);
    }
    let quadratic = &got.orders[3];
    close(quadratic.press.unwrap(), &expected["press"]);
    close(quadratic.pred_r2.unwrap(), &expected["pred_r2"]);
    close(quadratic.root_mse.unwrap(), &expected["root_mse"]);
    close(
        quadratic.lack_of_fit.as_ref().unwrap().p.unwrap(),
        &expected["lack_of_fit"]["p"],
    );
    assert_eq!(got.orders[4].aliased.len(), 7);
    assert_eq!(got.suggested, "linear");
    let fitted = fit(
        &factors("BEF"),
        &Model::quadratic(&factors("BEF")).unwrap(),
        &published(),
    );
    let aicc = fitted.unwrap().information.unwrap().aicc.unwrap();
    assert!((aicc - quadratic.aicc.unwrap()).abs() < 1e-9);
}

/// The reduction by p keeps what Table 6 of the study calls significant, and E, which BE and E2 no
/// longer need, for its own sake. Under hierarchy B stays as long as B2 does.
#[test]
fn reduction_keeps_hierarchy_and_the_significant_terms() {
    let f = factors("BEF");
    let full = Model::quadratic(&f).unwrap();
    let by = |rule| reduce(&f, &full, &published(), Weighting::Counts, rule).unwrap();
    let (kept, steps) = by(ReductionRule::PValue(0.1));
    assert_eq!(kept.formula.to_string(), "1 + B + E + F + B:F + B^2");
    assert_eq!(steps[0].dropped, "EF");
    let (kept, _) = by(ReductionRule::Aicc);
    assert!(kept.formula.missing_for_hierarchy().is_empty());
    // A term with a strong square but no slope of its own must stay.
    let (f, data) = simulated(&|x| 5.0 * x[0] * x[0] + x[1], 0.1);
    let rule = ReductionRule::PValue(0.05);
    let model = Model::quadratic(&f).unwrap();
    let (kept, _) = reduce(&f, &model, &data, Weighting::Equal, rule).unwrap();
    assert!(kept.terms.get("A").is_some() && kept.terms.get("A2").is_some());
}

/// exp(linear) is linear after the logarithm, (linear)^2 after the square root.
#[test]
fn the_power_of_the_response_is_found() {
    let model = |f: &[Factor]| Model::linear(f).unwrap();
    for (power, truth) in [
        (0.0, (|x| (3.0 + 0.8 * x).exp()) as fn(f64) -> f64),
        (0.5, |x| (3.0 + x).powi(2)),
        (1.0, |x| 30.0 + 5.0 * x),
    ] {
        let (f, data) = simulated(&|x| truth(x[0] + 0.5 * x[1]), 0.02);
        let got = box_cox(&f, &model(&f), &data, Weighting::Equal)
            .unwrap()
            .unwrap();
        assert!((got.best - power).abs() < 0.1, "{} for {power}", got.best);
        assert!(got.interval95[0] <= got.best && got.best <= got.interval95[1]);
    }
    let (f, data) = simulated(&|x| x[0], 0.1);
    assert_eq!(
        box_cox(&f, &model(&f), &data, Weighting::Equal).unwrap(),
        None
    );
}

/// On each circle the ridge point is the highest of 100 000 points of the circle (step 6e-5 rad, so
/// 1e-6 of the value), also where the gradient vanishes along the main axis.
#[test]
fn ridge_points_are_the_highest_of_their_circle() {
    for truth in [
        (|x: &[f64]| 3.0 + x[0] - x[1] + 2.0 * x[0] * x[0] - x[0] * x[1]) as fn(&[f64]) -> f64,
        |x| 1.0 + 2.0 * x[0] * x[0] - x[1] * x[1] + 0.3 * x[1],
        |x| 2.0 * x[0] + x[1],
    ] {
        let (f, data) = simulated(&truth, 0.0);
        let fitted = fit(&f, &Model::quadratic(&f).unwrap(), &data).unwrap();
        let path = ridge_path(&fitted, &[0.0, 0.5, 1.0, 2.0], true).unwrap();
        for point in &path[1..] {
            let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / 1e5;
            let on_circle =
                |i: u32| [angle(i).cos(), angle(i).sin()].map(|x| x * point.radius_coded);
            let best = (0..100_000)
                .map(|i| truth(&on_circle(i)))
                .fold(f64::MIN, f64::max);
            let length = point.coded.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((length - point.radius_coded).abs() < 1e-6, "{length}");
            assert!(
                (point.value - best).abs() < 1e-5,
                "{} against {best}",
                point.value
            );
        }
    }
}

fn exact(truth: &dyn Fn(&[f64]) -> f64) -> Fit {
    let f = factors("ABC");
    let cells = box_behnken(&f, 3).unwrap().coded_rows();
    let cells = cells
        .into_iter()
        .map(|x| Cell::single(x.clone(), truth(&x)))
        .collect();
    let model = Model::quadratic(&f).unwrap();
    fit(&f, &model, &Observations::from_cells(cells).unwrap()).unwrap()
}

/// Two responses that pull A apart with equal weight meet in the middle, d = 1/2 each; importance
/// moves the best point to a = (r1 - r2) / (r1 + r2), where r1 ln(1 + a) + r2 ln(1 - a) is greatest.
#[test]
fn compromises_lie_where_the_weighted_product_is_greatest() {
    let fits = [exact(&|x| x[0]), exact(&|x| -x[0])];
    let goal = |importance| Goal {
        aim: Aim::Maximise {
            low: -1.0,
            high: 1.0,
        },
        weight: 1.0,
        importance,
    };
    let best = |r1, r2| compromises(&fits, &[goal(r1), goal(r2)], &[], None).unwrap()[0].clone();
    let middle = best(1.0, 1.0);
    assert!((middle.desirability - 0.5).abs() < 1e-9 && middle.coded[0].abs() < 1e-4);
    assert!((best(3.0, 1.0).coded[0] - 0.5).abs() < 1e-4);
    let target = Goal {
        aim: Aim::Target {
            low: 0.0,
            value: 0.7,
            high: 2.0,
        },
        weight: 2.0,
        importance: 1.0,
    };
    let at = compromises(&fits[..1], &[target], &[], None).unwrap()[0].clone();
    assert!((at.coded[0] - 0.7).abs() < 1e-6 && at.desirability > 1.0 - 1e-6);
    // Weight 2 squares the share of the way: (0.35 / 0.7)^2.
    assert!((target.desirability(0.35) - 0.25).abs() < 1e-12);
    let range = Goal {
        aim: Aim::Range {
            low: 5.0,
            high: 6.0,
        },
        ..target
    };
    assert!(
        compromises(&fits[..1], &[range], &[], None)
            .unwrap()
            .is_empty()
    );
    let wrong = Goal {
        aim: Aim::Range {
            low: 6.0,
            high: 5.0,
        },
        ..target
    };
    assert!(compromises(&fits[..1], &[wrong], &[], None).is_err());
}

/// A mean of n new runs lies in its interval in 95 % of cases: of 600 experiments with 3 runs each
/// 570 are expected, standard deviation 5.3; four of them are allowed on each side.
#[test]
fn confirmation_runs_are_confirmed_at_the_nominal_rate() {
    let f = factors("ABC");
    let model = Model::quadratic(&f).unwrap();
    let rows = box_behnken(&f, 5).unwrap().coded_rows();
    let mut confirmed = 0;
    for seed in 0..600 {
        let mut stream = Stream::new(seed, "confirmation");
        let mut cells = Vec::new();
        for x in &rows {
            let runs: Vec<f64> = (0..4).map(|_| 10.0 + x[0] + stream.normal()).collect();
            cells.push(Cell::of_replicates(x.clone(), &runs).unwrap());
        }
        let fitted = fit(&f, &model, &Observations::from_cells(cells).unwrap()).unwrap();
        let runs: Vec<f64> = (0..3).map(|_| 10.5 + stream.normal()).collect();
        let error = fitted.error_variance(ErrorSource::AllRepeats);
        let got = confirm(&fitted, &[0.5, 0.2, -0.3], &runs, error).unwrap();
        confirmed += i32::from(got.confirmed.unwrap());
    }
    assert!((549..=591).contains(&confirmed), "{confirmed} of 600");
}

/// Shrunk weights lie between equal ones and inverse variances: a cell whose variance is 16 times
/// that of the others weighs less, but not 16 times less.
#[test]
fn shrunk_weights_lie_between_the_extremes() {
    let f = factors("A");
    let cells = (0..6).map(|i| Cell {
        sd: Some(if i == 0 { 4.0 } else { 1.0 }),
        n: 5,
        ..Cell::single(vec![f64::from(i) / 2.5 - 1.0], f64::from(i * i))
    });
    let data = Observations::from_cells(cells.collect()).unwrap();
    let model = Model::linear(&f).unwrap();
    let ratio = |weighting| {
        let cases = fit_weighted(&f, &model, &data, weighting).unwrap().cases;
        cases[1].weight / cases[0].weight
    };
    let shrunk = ratio(Weighting::ShrunkVariance);
    // Pooled variance 3.5: (4 * 16 + 10 * 3.5) / (4 + 10 * 3.5).
    assert!((shrunk - 99.0 / 39.0).abs() < 1e-12, "{shrunk}");
    assert!((ratio(Weighting::InverseVariance) - 16.0).abs() < 1e-12);
    assert!((ratio(Weighting::Counts) - 1.0).abs() < 1e-12);
}

/// Lack of fit against all repeats pools centre rows and replicates within rows: the sums of
/// squares of both parts, 4 + 68 degrees of freedom in the published table.
#[test]
fn lack_of_fit_is_tested_against_all_repeats() {
    let f = factors("BEF");
    let fitted = fit(&f, &Model::quadratic(&f).unwrap(), &published()).unwrap();
    let test = fitted.lack_of_fit_all_repeats.as_ref().unwrap();
    assert_eq!((test.df1, test.df2), (3, 72));
    let (pure, within) = (
        fitted.pure_error.as_ref().unwrap(),
        fitted.replicates.as_ref().unwrap(),
    );
    let error = (pure.ss + within.var_of_run_mean * 68.0) / 72.0;
    let expected = fitted.lack_of_fit.as_ref().unwrap().ms / error;
    assert!((test.f.unwrap() / expected - 1.0).abs() < 1e-12);
}
