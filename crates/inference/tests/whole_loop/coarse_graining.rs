//! Runs with grains coarser than the real ones, carried to the real size by their trend.

use super::toy::{
    Law, Toy, measured, model, parameter, problem, run, run_with, settings_of, shown,
};
use inference::{
    Calibration, CalibrationProblem, CoarseGraining, Error, LoopSettings, Role, planned,
};
use probability::random_stream::Stream;
use rayon::prelude::*;

/// True parameters.
const TRUTH: [f64; 2] = [0.4, 0.6];
/// Standard error of each measured mean, and standard deviation of a run.
const MEASURED: f64 = 0.05;
const RUN: f64 = 0.04;

/// What two experiments show of grains of a size; the trend differs between them and with the first parameter.
fn law(name: &str, a: f64, b: f64, factor: f64) -> f64 {
    let beyond = factor - 1.0;
    match name {
        "one" => 2.0 * a + 0.3 * b + beyond * (0.5 + 0.4 * a),
        _ => b - 0.5 * a - 0.3 * beyond,
    }
}

/// A request without a factor is one of real grains.
fn factor(of: &dyn Fn(&str) -> f64) -> f64 {
    of(CoarseGraining::SYMBOL).max(1.0)
}

/// The law with noise.
fn toy() -> Toy {
    Toy {
        law: |name, of| shown("y", law(name, of("a"), of("b"), factor(of))),
        noise: RUN,
    }
}

/// Two experiments, measured with real grains and simulated with grains of some sizes.
fn study(means: [f64; 2], factors: &[f64], error: f64) -> CalibrationProblem {
    let single = MEASURED * 10.0_f64.sqrt();
    let of = |k: usize| measured(k, "y", Role::Fit, (means[k], single));
    CalibrationProblem {
        coarse_graining: Some(CoarseGraining {
            models: vec![0, 1],
            factors: factors.to_vec(),
            error,
        }),
        ..problem(
            vec![parameter("a", [0.0, 1.0]), parameter("b", [0.0, 1.0])],
            vec![model("one", &[0, 1]), model("two", &[0, 1])],
            vec![of(0), of(1)],
        )
    }
}

/// What real grains show at the true parameters.
fn truth() -> [f64; 2] {
    ["one", "two"].map(|name| law(name, TRUTH[0], TRUTH[1], 1.0))
}

/// A drawn study with a seed of its own.
fn drawn(number: u64, factors: &[f64]) -> Calibration {
    let mut stream = Stream::new(number, "drawn study");
    let means = truth().map(|mean| mean + MEASURED * stream.normal());
    let mut problem = study(means, factors, 10.0);
    for measured in &mut problem.measurements {
        (measured.sd, measured.n) = (MEASURED, 1.0);
    }
    run_with(&toy(), &problem, &settings_of(number)).expect("a study that runs")
}

/// Measured with real grains, simulated with grains 3 and 2 times as large, whose trend is known to about the error of a measurement.
/// Of 1000 studies with two intervals each the share that holds the truth has a standard error of 0.5 to 0.7 %: 95 +- 2 % is three
/// of them.
#[test]
fn intervals_at_the_real_size_hold_the_truth_in_95_of_100_studies() {
    let held = |number: u64| {
        let result = drawn(number, &[3.0, 2.0]);
        [0, 1].map(|j| {
            let [low, high] = result.parameters[j].interval95;
            u32::from(low <= TRUTH[j] && TRUTH[j] <= high)
        })
    };
    let studies = (0..1000).into_par_iter().map(held);
    let held = studies.reduce(|| [0; 2], |[a, b], [c, d]| [a + c, b + d]);
    for held in held {
        assert!((930..=970).contains(&held), "{held} of 1000");
    }
}

/// The trend of "one" at the estimate is 0.5 + 0.4 x 0.4 = 0.66 per real diameter, so that grains twice as large stand 0.66 higher; one
/// standard error in 20 studies is left for noise.
#[test]
fn the_trend_at_the_estimate_is_told() {
    let misses = |number: u64| {
        let result = drawn(number, &[3.0, 2.0]);
        let trend = &result.size_trends[0];
        assert_eq!((trend.model.as_str(), trend.finest), ("one", 2.0));
        // The estimate is not the truth, and the slope follows it.
        let at = result.parameters[0].value;
        (trend.shift + 0.5 + 0.4 * at) / trend.shift_se
    };
    let all: Vec<f64> = (0..200).map(misses).collect();
    let square = all.iter().map(|z| z * z).sum::<f64>() / 200.0;
    // A mean square of 200 normal values is 1 +- 0.1; those of Student's t with 12 degrees of freedom and more are 1.2 at most.
    assert!((0.7..=1.5).contains(&square), "{square}");
}

/// Any two values lie on a straight line, so that two sizes cannot show a bend, and three can.
#[test]
fn two_sizes_are_said_to_show_no_bend() {
    let remarked = |factors: &[f64]| {
        let remarks = drawn(1, factors).remarks;
        remarks.iter().any(|remark| remark.contains("a third"))
    };
    assert!(remarked(&[3.0, 2.0]));
    assert!(!remarked(&[3.0, 2.5, 2.0]));
}

/// A trend that is known too little for the error allowed is refused before fresh runs are made, and told with the size that would do:
/// with it the error is what is allowed. 20 runs at a place of the design know the noise to 4 %, each side.
#[test]
fn a_trend_that_is_not_seen_is_refused() {
    let settings = LoopSettings {
        replicates: 20,
        ..LoopSettings::default()
    };
    let refused = run(&toy(), &study(truth(), &[3.0, 2.8], 0.5)).unwrap_err();
    assert!(matches!(refused, Error::CoarseGraining { .. }), "{refused}");
    let told = refused.to_string();
    assert!(
        told.contains("y of one") && told.contains("times as large as real ones or finer"),
        "{told}"
    );
    let error = 0.4;
    let wide = run_with(&toy(), &study(truth(), &[3.0, 2.0], error), &settings).unwrap();
    let allowed = wide.size_trends[0].finest_allowed;
    assert!((2.0..3.0).contains(&allowed), "{allowed}");
    let at_most = run_with(&toy(), &study(truth(), &[3.0, allowed], 10.0), &settings).unwrap();
    let trend = &at_most.size_trends[0];
    let share = trend.shift_se / trend.measured_se / error;
    assert!((share - 1.0).abs() < 0.15, "{share}");
}

/// Three sizes show that a trend in the square of the size is bent, and a straight one passes: 1 % of such studies is refused by
/// chance, so that none of 20 is.
#[test]
fn a_trend_that_is_bent_is_refused() {
    let bent: Law = |name, of| {
        let beyond = factor(of) - 1.0;
        shown(
            "y",
            law(name, of("a"), of("b"), 1.0) + 0.3 * beyond * beyond,
        )
    };
    let bent = Toy {
        law: bent,
        noise: RUN,
    };
    let sizes = [4.0, 3.0, 2.0];
    let refused = run(&bent, &study(truth(), &sizes, 10.0)).unwrap_err();
    let told = refused.to_string();
    assert!(told.contains("bent") && told.contains("y of two"), "{told}");
    for number in 0..20 {
        assert_eq!(drawn(number, &sizes).size_trends.len(), 2);
    }
}

/// A check with coarse grains holds for what real grains show and fails for what coarse ones do; runs are those that were planned. The
/// check bears some 0.2, and grains three times as large stand 2 x 0.66 higher.
#[test]
fn a_check_is_carried_to_the_real_size() {
    let check = |mean: f64| {
        let mut problem = study(truth(), &[3.0, 2.0], 10.0);
        problem.models.push(model("one", &[0, 1]));
        problem.models[2].scene = "check".into();
        problem
            .measurements
            .push(measured(2, "y", Role::Check, (mean, 0.1)));
        if let Some(coarse) = &mut problem.coarse_graining {
            coarse.models.push(2);
        }
        problem
    };
    let of = |factor: f64| law("one", TRUTH[0], TRUTH[1], factor);
    let settings = LoopSettings::default();
    let real = run(&toy(), &check(of(1.0))).unwrap();
    assert!(real.check[0].holds, "{:?}", real.check);
    assert!(
        !run(&toy(), &check(of(3.0))).unwrap().check[0].holds,
        "coarse grains were measured"
    );
    let stages = planned(&check(of(1.0)), &settings).unwrap();
    for (stage, cost) in stages.iter().zip(&real.cost) {
        let further = stage.at_most_further();
        assert!(
            (stage.runs()..=stage.runs() + further).contains(&cost.runs),
            "{}: {} planned, {} and at most {further} done",
            stage.stage,
            stage.runs(),
            cost.runs
        );
    }
    // Real grains were not run before either: the correction is carried over.
    let before = real.before.iter().find(|row| row.scene == "two").unwrap();
    let carried = law("two", 0.5, 0.5, 1.0);
    let error = before.simulated.se;
    assert!(
        (before.simulated.mean - carried).abs() < 4.0 * error && error < 0.1,
        "{before:?}"
    );
}

/// Runs with finer grains that all fail leave no trend: a refusal, and no estimate of coarse grains in the place of real ones.
#[test]
fn sizes_whose_runs_fail_are_refused() {
    let toy = Toy {
        law: |name, of| {
            if factor(of) < 2.5 {
                return Err("too many grains".into());
            }
            shown("y", law(name, of("a"), of("b"), factor(of)))
        },
        noise: RUN,
    };
    let refused = run(&toy, &study(truth(), &[3.0, 2.0], 10.0)).unwrap_err();
    let Error::CoarseGraining { lines } = refused else {
        panic!("{refused}");
    };
    assert!(lines[0].contains("y of one"), "{lines:?}");
    assert!(lines[1].contains("y of two"), "{lines:?}");
}

/// Factors that tell no trend, one by one.
#[test]
fn factors_that_tell_no_trend_are_refused() {
    let cases: [(&[f64], f64, &str); 6] = [
        (&[3.0], 1.0, "two or more"),
        (&[3.0, 3.0], 1.0, "must differ"),
        (&[3.0, 0.5], 1.0, "0.5 must be above 1"),
        (&[3.0, 0.0], 1.0, "0 must be above 1"),
        (&[f64::NAN, 2.0], 1.0, "must be above 1"),
        (&[3.0, 2.0], 0.0, "largest error 0"),
    ];
    for (factors, error, expected) in cases {
        let refused = study(truth(), factors, error).check().unwrap_err();
        assert!(refused.to_string().contains(expected), "{refused}");
    }
    study(truth(), &[3.0, 2.0], 1.0).check().unwrap();
}
