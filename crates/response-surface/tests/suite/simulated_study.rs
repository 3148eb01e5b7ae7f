//! The way the calibration uses this crate: simulated runs, screening, surface, solutions.

#![expect(
    clippy::unwrap_used,
    reason = "the helpers of tests may fail like tests"
)]

use experiment_design::{Design, Factor, box_behnken, plackett_burman};
use probability::random_stream::Stream;
use response_surface::{
    Cell, Error, ErrorSource, Fit, Model, Observations, SolutionRequest, fit, screen, solutions,
};

/// Standard deviation of a simulated run, deg.
const RUN_SD: f64 = 1.0;

fn factors(symbols: &[&str]) -> Vec<Factor> {
    symbols
        .iter()
        .map(|s| Factor::coded_only(s).unwrap())
        .collect()
}

/// The study's surface in B, E, F, deg.
fn truth(b: f64, e: f64, f: f64) -> f64 {
    36.4 + 1.25 * b - 0.56 * e + 3.5 * f - 0.5 * b * b
}

/// One noisy response per run; the columns of B, E and F are given.
fn simulate(design: &Design, places: [usize; 3], seed: u64) -> Vec<Option<f64>> {
    let mut stream = Stream::new(seed, "simulated study");
    let [b, e, f] = places;
    let response = |x: &[f64], noise: f64| Some(truth(x[b], x[e], x[f]) + RUN_SD * noise);
    design
        .runs()
        .iter()
        .map(|run| response(&run.coded, stream.normal()))
        .collect()
}

fn surface(design: &Design, seed: u64) -> Fit {
    let data = Observations::from_design(design, &simulate(design, [0, 1, 2], seed)).unwrap();
    let factors = design.factors();
    fit(factors, &Model::quadratic(factors).unwrap(), &data).unwrap()
}

#[test]
fn screening_finds_the_strong_factors_against_dummies_and_replicates() {
    let six = factors(&["A", "B", "C", "D", "E", "F"]);
    let design = plackett_burman(&six)
        .unwrap()
        .replicated(3)
        .unwrap()
        .randomised(4);
    let data = Observations::from_design(&design, &simulate(&design, [1, 4, 5], 1)).unwrap();
    assert_eq!(data.cells().len(), 12);
    let cells_of_design = plackett_burman(&six).unwrap();
    let screening = screen(&cells_of_design, &data).unwrap();
    assert_eq!(screening.factors[0].factor, "F");
    assert!(screening.factors[0].p_dummies.unwrap() < 1e-3);
    assert!(screening.factors[0].p_replicates.unwrap() < 1e-6);
    assert_eq!(screening.main_effects.replicates.as_ref().unwrap().df, 24);
    assert_eq!(screening.replicate_tests.unwrap().len(), 11);
}

/// Single runs and five centre runs: the only repeats are the centre rows.
#[test]
fn with_one_replicate_the_pure_error_comes_from_the_centre_alone() {
    let fit = surface(&box_behnken(&factors(&["B", "E", "F"]), 5).unwrap(), 2);
    assert!(fit.replicates.is_none());
    assert_eq!(fit.pure_error.as_ref().unwrap().df, 4);
    assert_eq!(fit.lack_of_fit.as_ref().unwrap().df, 3);
    assert_eq!(fit.best_error_variance().unwrap().df, 4);
    assert_eq!(fit.error_variance(ErrorSource::Replicates), None);
}

/// Thirteen runs, one centre: nothing is repeated, so pure error is undefined, not zero.
#[test]
fn without_any_repeat_pure_error_is_none_and_the_residuals_stand_in() {
    let fit = surface(&box_behnken(&factors(&["B", "E", "F"]), 1).unwrap(), 2);
    assert!(fit.pure_error.is_none() && fit.lack_of_fit.is_none());
    let error = fit.best_error_variance().unwrap();
    assert_eq!((error.source, error.df), (ErrorSource::Residual, 3));
    let text = serde_json::to_string(&fit).unwrap();
    assert!(
        text.contains("\"pure_error\":null"),
        "undefined must be null"
    );
}

/// Cell means weighted by n give the coefficients of the raw runs, and the pure error of all
/// replicates is that of the raw runs (identities; rounding 1e-10).
#[test]
fn weighted_cell_means_agree_with_the_fit_to_single_runs() {
    let design = box_behnken(&factors(&["B", "E", "F"]), 3)
        .unwrap()
        .replicated(3)
        .unwrap();
    let mut responses = simulate(&design, [0, 1, 2], 3);
    // Two failed runs make the counts unequal.
    (responses[4], responses[17]) = (None, None);
    let means = Observations::from_design(&design, &responses).unwrap();
    let runs = design.runs().iter().zip(&responses);
    let single = runs.filter_map(|(run, y)| Some(Cell::single(run.coded.clone(), (*y)?)));
    let raw = Observations::from_cells(single.collect()).unwrap();
    let model = Model::quadratic(design.factors()).unwrap();
    let by_means = fit(design.factors(), &model, &means).unwrap();
    let by_runs = fit(design.factors(), &model, &raw).unwrap();
    for (a, b) in by_means.coefficients().iter().zip(by_runs.coefficients()) {
        assert!((a - b).abs() < 1e-10, "{a} against {b}");
    }
    let all = by_means.error_variance(ErrorSource::AllRepeats).unwrap();
    let pure = by_runs.pure_error.clone().unwrap();
    assert_eq!(all.df, pure.df);
    let per_run = all.variance * by_means.mean_count;
    assert!(
        (per_run / pure.ms - 1.0).abs() < 1e-10,
        "{per_run} against {}",
        pure.ms
    );
    // Standard errors of the prediction agree too, so regions do not depend on the grouping.
    let x = [0.3, -0.2, 0.9];
    let (a, b) = (
        by_means.leverage(&x) * all.variance,
        by_runs.leverage(&x) * pure.ms,
    );
    assert!((a / b - 1.0).abs() < 1e-10, "{a} against {b}");
}

/// The 95 % region must cover a true solution in 95 % of repeated experiments: of 400, 380 are
/// expected with a standard deviation of 4.4; four of them are allowed on each side.
#[test]
fn region_covers_a_true_solution_in_ninety_five_percent_of_experiments() {
    let design = box_behnken(&factors(&["B", "E", "F"]), 5)
        .unwrap()
        .replicated(2)
        .unwrap();
    let point = [-0.4, 0.3, 0.8];
    let target = truth(point[0], point[1], point[2]);
    let mut covered = 0;
    for seed in 0..400 {
        let fit = surface(&design, 1000 + seed);
        let error = fit.best_error_variance().unwrap();
        let prediction = fit.predict_with(&point, Some(error)).unwrap();
        let [low, high] = prediction.ci95.unwrap();
        covered += i32::from(low <= target && target <= high);
    }
    assert!((362..=398).contains(&covered), "{covered} of 400");
}

#[test]
fn a_model_that_the_runs_cannot_separate_is_refused_by_name() {
    let six = factors(&["A", "B", "C"]);
    let design = plackett_burman(&six).unwrap();
    let responses = vec![Some(1.0); 12];
    let data = Observations::from_design(&design, &responses).unwrap();
    let error = fit(&six, &Model::quadratic(&six).unwrap(), &data).unwrap_err();
    let Error::AliasedTerms { terms, .. } = &error else {
        panic!("wrong error: {error}");
    };
    assert_eq!(terms, &["A2", "B2", "C2"]);
    assert!(error.to_string().contains("A2 = 1"), "{error}");
}

/// A constant response has no variance: every ratio is undefined, nothing is NaN.
#[test]
fn constant_responses_give_nulls_and_no_nan() {
    let three = factors(&["B", "E", "F"]);
    let design = box_behnken(&three, 3).unwrap();
    let data = Observations::from_design(&design, &vec![Some(2.1); 15]).unwrap();
    let fit = fit(&three, &Model::linear(&three).unwrap(), &data).unwrap();
    assert_eq!((fit.r2, fit.model.f), (None, None));
    let answer = solutions(&fit, &SolutionRequest::for_target(5.0)).unwrap();
    assert!(!answer.exists);
}

/// The effect of a block is taken out: a shift of 3 deg between two halves of a design that is
/// balanced in each leaves the coefficients as they are (rounding 1e-10).
#[test]
fn a_shift_between_blocks_does_not_reach_the_coefficients() {
    let six = factors(&["A", "B", "C", "D", "E", "F"]);
    let design = plackett_burman(&six).unwrap().folded_over();
    let responses = simulate(&design, [1, 4, 5], 8);
    let shift =
        |(run, y): (&experiment_design::Run, &Option<f64>)| y.map(|y| y + 3.0 * run.block as f64);
    let shifted: Vec<Option<f64>> = design.runs().iter().zip(&responses).map(shift).collect();
    let model = Model::linear(&six).unwrap();
    let fitted = |responses: &[Option<f64>]| {
        fit(
            &six,
            &model,
            &Observations::from_design(&design, responses).unwrap(),
        )
        .unwrap()
    };
    let (a, b) = (fitted(&responses), fitted(&shifted));
    for (x, y) in a.coefficients().iter().zip(b.coefficients()).skip(1) {
        assert!((x - y).abs() < 1e-10, "{x} against {y}");
    }
    assert!(
        (a.sse - b.sse).abs() < 1e-9 * a.sse,
        "{} against {}",
        a.sse,
        b.sse
    );
    let point = [0.2; 6];
    assert!((b.value(&point) - a.value(&point) - 4.5).abs() < 1e-9);
}
