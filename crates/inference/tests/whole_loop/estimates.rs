//! Estimates, intervals and what the data leave open.

use super::toy::{Law, Shown, Toy, measured, model, of_y, parameter, problem, run, shown, value};
use inference::{Correlation, LoopSettings, Measurement, Prior, Role};

/// y = 2 a without noise, measured 1.2 +- 0.1 (ten values): a = 0.6, se = 0.1 / sqrt(10) / 2, and the interval is
/// t(9) = 2.262 standard errors wide on each side, because the standard deviation comes from ten values.
#[test]
fn a_line_through_one_measurement_has_the_estimate_and_the_interval_of_the_hand() {
    let toy = Toy {
        law: |_, p| shown("y", 2.0 * p("a")),
        noise: 0.0,
    };
    let problem = of_y("a", &[("m", Role::Fit, (1.2, 0.1))]);
    let result = run(&toy, &problem).unwrap();
    let a = &result.parameters[0];
    let se = 0.1 / 10_f64.sqrt() / 2.0;
    assert!((a.value - 0.6).abs() < 1e-6, "{a:?}");
    assert!((a.se.unwrap() - se).abs() < 1e-6, "{a:?}");
    let t = 2.262_157;
    assert!((a.interval95[0] - (0.6 - t * se)).abs() < 1e-5, "{a:?}");
    assert!((a.interval95[1] - (0.6 + t * se)).abs() < 1e-5, "{a:?}");
    assert!(a.fixed_by_data && !a.at_limit, "{a:?}");
    assert!(result.met, "{}", result.verdict);
    assert_eq!(
        result.test.degrees_of_freedom, 0,
        "one measurement, one parameter: nothing is tested"
    );
    assert!(result.test.p.is_none());
    assert!(
        result.verdict.contains("as many parameters"),
        "{}",
        result.verdict
    );
}

/// y = z = a, measured 0.5 +- 0.1 and 0.6 +- 0.2 by single values of known error. The best weights of two correlated means are
/// `(s_z² - r s_y s_z)` and `(s_y² - r s_y s_z)` over their sum; at r = -0.5 that is 5/7 and 2/7, and the variance is
/// `s_y² s_z² (1 - r²) / (s_y² + s_z² - 2 r s_y s_z) = 0.03 / 7`.
#[test]
fn correlated_means_have_the_weights_of_the_hand() {
    let toy = Toy {
        law: |_, p| {
            let values = vec![("y", p("a")), ("z", p("a"))];
            Ok(Shown { values, regime: "" })
        },
        noise: 0.0,
    };
    let single = |name: &str, mean| Measurement {
        n: 1.0,
        ..measured(0, name, Role::Fit, mean)
    };
    let mut problem = problem(
        vec![parameter("a", [0.0, 1.0])],
        vec![model("m", &[0])],
        vec![single("y", (0.5, 0.1)), single("z", (0.6, 0.2))],
    );
    problem.correlations.push(Correlation {
        a: 1,
        b: 0,
        value: -0.5,
    });
    let result = run(&toy, &problem).unwrap();
    let a = &result.parameters[0];
    assert!(
        (a.value - (5.0 * 0.5 + 2.0 * 0.6) / 7.0).abs() < 1e-6,
        "{a:?}"
    );
    assert!(
        (a.se.unwrap() - (0.03_f64 / 7.0).sqrt()).abs() < 1e-6,
        "{a:?}"
    );
}

/// Two observables of one model and one of another; a and b appear in all of them. The measured values are those of
/// a = 0.3, b = 0.7; one measurement more than parameters tests the fit.
#[test]
fn a_curved_simulator_gives_its_parameters_back() {
    let toy = Toy {
        law: |model, p| {
            let (a, b) = (p("a"), p("b"));
            if model == "first" {
                let values = vec![("y", (1.0 + a).ln() + 0.5 * b), ("z", a * b)];
                return Ok(Shown { values, regime: "" });
            }
            shown("w", a.exp() - b)
        },
        noise: 0.0,
    };
    let (a, b) = (0.3_f64, 0.7_f64);
    let sd = 0.01;
    let problem = problem(
        vec![parameter("a", [0.0, 1.0]), parameter("b", [0.0, 1.0])],
        vec![model("first", &[0, 1]), model("second", &[0, 1])],
        vec![
            measured(0, "y", Role::Fit, ((1.0 + a).ln() + 0.5 * b, sd)),
            measured(0, "z", Role::Fit, (a * b, sd)),
            measured(1, "w", Role::Fit, (a.exp() - b, sd)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    // The quadratic misses the logarithm by up to 0.003; rounds of fresh runs correct it to a part of the error.
    assert!(
        (value(&result, "a") - a).abs() < 0.004,
        "{:?}",
        result.parameters
    );
    assert!(
        (value(&result, "b") - b).abs() < 0.004,
        "{:?}",
        result.parameters
    );
    assert_eq!(result.test.degrees_of_freedom, 1);
    assert!(result.met, "{}", result.verdict);
}

/// y = 2 a was measured twice, 1.0 +- 0.3: the standard error of a is 0.106, and Student's t of 12.7 makes its interval wider than
/// all that is possible. By ten values of the same scatter it is fixed.
#[test]
fn two_values_fix_nothing_that_student_does_not() {
    let toy = Toy {
        law: |_, p| shown("y", 2.0 * p("a")),
        noise: 0.001,
    };
    let fixed = |n: f64| {
        let measured = Measurement {
            n,
            ..measured(0, "y", Role::Fit, (1.0, 0.3))
        };
        let parameters = vec![parameter("a", [0.0, 1.0])];
        let problem = problem(parameters, vec![model("m", &[0])], vec![measured]);
        let result = run(&toy, &problem).unwrap();
        let a = &result.parameters[0];
        (a.fixed_by_data, a.se.is_some(), a.interval95 == [0.0, 1.0])
    };
    assert_eq!(fixed(2.0), (false, false, true));
    assert_eq!(fixed(10.0), (true, true, false));
}

/// b acts on nothing: the data cannot fix it, its interval is all that is possible, and a is not disturbed.
#[test]
fn a_dead_parameter_is_told_as_open() {
    let toy = Toy {
        law: |_, p| shown("y", 5.0 * p("a")),
        noise: 0.05,
    };
    let problem = problem(
        vec![parameter("a", [0.0, 1.0]), parameter("b", [0.0, 2.0])],
        vec![model("m", &[0, 1])],
        vec![measured(0, "y", Role::Fit, (2.0, 0.1))],
    );
    let result = run(&toy, &problem).unwrap();
    let [a, b] = &result.parameters[..] else {
        panic!("two parameters");
    };
    assert!((a.value - 0.4).abs() < 4.0 * a.se.unwrap(), "{a:?}");
    assert!(a.fixed_by_data, "{a:?}");
    assert!(!b.fixed_by_data, "{b:?}");
    assert_eq!(b.interval95, [0.0, 2.0], "{b:?}");
    let open = &result.open_combinations;
    assert_eq!(open.len(), 1, "{open:?}");
    assert!(open[0].weights["b"].abs() > 0.9, "{open:?}");
}

/// Only a + b is measured: the sum is fixed, the difference is open, and both say so.
#[test]
fn a_sum_alone_leaves_the_difference_open() {
    let toy = Toy {
        law: |_, p| shown("y", p("a") + p("b")),
        noise: 0.0,
    };
    let problem = of_y("ab", &[("m", Role::Fit, (1.0, 0.05))]);
    let result = run(&toy, &problem).unwrap();
    assert!((value(&result, "a") + value(&result, "b") - 1.0).abs() < 1e-6);
    let open = &result.open_combinations;
    assert_eq!(open.len(), 1, "{open:?}");
    let (a, b) = (open[0].weights["a"], open[0].weights["b"]);
    assert!(
        (a + b).abs() < 1e-6 && (a.abs() - 0.5_f64.sqrt()).abs() < 1e-6,
        "{open:?}"
    );
    assert_eq!(
        result.solutions.separate.len(),
        1,
        "a line of solutions is one set: {:?}",
        result.solutions.separate
    );
}

/// A prior of a, 0.2, and a measurement of y = a, 0.8, each known to 0.02: the estimate between them lies 15 standard errors of the
/// measurement off, and the answer says that the priors have a part in it. A prior that is known to 0.5 leaves the measurement alone.
#[test]
fn a_prior_that_contradicts_the_data_is_told() {
    let toy = Toy {
        law: |_, p| shown("y", p("a")),
        noise: 0.0,
    };
    let with = |sd: f64| {
        let mut a = parameter("a", [0.0, 1.0]);
        a.prior = Some(Prior { mean: 0.2, sd });
        let problem = problem(
            vec![a],
            vec![model("m", &[0])],
            vec![measured(0, "y", Role::Fit, (0.8, 0.02 * 10_f64.sqrt()))],
        );
        run(&toy, &problem).unwrap()
    };
    let contradicts = with(0.02);
    let value = contradicts.parameters[0].value;
    assert!((value - 0.5).abs() < 0.05 && !contradicts.met, "{value}");
    let told = &contradicts.verdict;
    assert!(
        told.contains("does not meet y of m") && told.contains("their priors"),
        "{told}"
    );
    let agrees = with(0.5);
    assert!(agrees.met, "{}", agrees.verdict);
    assert!((agrees.parameters[0].value - 0.8).abs() < 0.01);
}

/// A prior is a further measurement: with y = a + b = 1.0 +- 0.05 and a prior of a, 0.3 +- 0.02, both are known; a is fixed
/// by the prior and not by the data.
#[test]
fn a_prior_fixes_what_the_data_leave_open() {
    let toy = Toy {
        law: |_, p| shown("y", p("a") + p("b")),
        noise: 0.0,
    };
    let mut a = parameter("a", [0.0, 1.0]);
    a.prior = Some(Prior {
        mean: 0.3,
        sd: 0.02,
    });
    let problem = problem(
        vec![a, parameter("b", [0.0, 1.0])],
        vec![model("m", &[0, 1])],
        vec![measured(0, "y", Role::Fit, (1.0, 0.05))],
    );
    let result = run(&toy, &problem).unwrap();
    let [a, b] = &result.parameters[..] else {
        panic!("two parameters");
    };
    assert!(
        (a.value - 0.3).abs() < 1e-6 && (b.value - 0.7).abs() < 1e-6,
        "{a:?} {b:?}"
    );
    assert!((a.se.unwrap() - 0.02).abs() < 1e-6, "{a:?}");
    let se_of_b = (0.02_f64.powi(2) + 0.05_f64.powi(2) / 10.0).sqrt();
    assert!((b.se.unwrap() - se_of_b).abs() < 1e-6, "{b:?}");
    assert!(!a.fixed_by_data && !b.fixed_by_data, "{a:?} {b:?}");
    // The set is an ellipse: it ends where one parameter alone is off by sqrt(chi2(2)) = sqrt(5.991) standard errors, and has the area
    // pi 5.991 sqrt(det C), det C the product of both variances that were measured. Drawn points tell that area to 1.6 %: four
    // standard errors are allowed. There are as many for the picture as it takes.
    let extent = &result.solutions.extent;
    for ([low, high], (value, se)) in extent.iter().zip([(0.3, 0.02), (0.7, se_of_b)]) {
        let half = 5.991_465_f64.sqrt() * se;
        assert!((low - (value - half)).abs() < 1e-5, "{extent:?}");
        assert!((high - (value + half)).abs() < 1e-5, "{extent:?}");
    }
    let area = std::f64::consts::PI * 5.991_465 * 0.02 * 0.05 / 10_f64.sqrt();
    let share = result.solutions.share_of_box;
    assert!((share / area - 1.0).abs() < 0.064, "{share} for {area}");
    assert_eq!(result.solutions.points.len(), 500);
}

/// y = (a - 0.5)² = 0.09 holds at a = 0.2 and at a = 0.8, and nowhere between.
#[test]
fn two_separate_solutions_are_both_told() {
    let toy = Toy {
        law: |_, p| shown("y", (p("a") - 0.5).powi(2)),
        noise: 0.0,
    };
    let problem = of_y("a", &[("m", Role::Fit, (0.09, 0.01))]);
    let result = run(&toy, &problem).unwrap();
    let mut separate: Vec<f64> = result.solutions.separate.iter().map(|s| s[0]).collect();
    separate.sort_by(f64::total_cmp);
    assert_eq!(separate.len(), 2, "{separate:?}");
    assert!(
        (separate[0] - 0.2).abs() < 1e-6 && (separate[1] - 0.8).abs() < 1e-6,
        "{separate:?}"
    );
    // The set ends where y is off by sqrt(chi2(1)) = 1.96 standard errors, beyond either solution.
    let far = (0.09 + 1.959_964 * 0.01 / 10_f64.sqrt()).sqrt();
    let [low, high] = result.solutions.extent[0];
    assert!(
        (low - (0.5 - far)).abs() < 1e-5 && (high - (0.5 + far)).abs() < 1e-5,
        "{low} {high}"
    );
    let other = if result.parameters[0].value > 0.5 {
        "also a = 0.2"
    } else {
        "also a = 0.8"
    };
    let told = result.remarks.join(" ");
    assert!(
        told.contains("separate solutions") && told.contains(other),
        "{told}"
    );
}

/// The check is measured of another model, y2 = 3 a at a = 0.6: predicted 1.8. What was measured, 1.8, holds; 2.4, which is
/// far outside all errors, does not, and the estimate does not move: it never sees the check.
#[test]
fn a_check_is_judged_and_moves_nothing() {
    let toy = Toy {
        law: |model, p| {
            if model == "fit" {
                shown("y", 2.0 * p("a"))
            } else {
                shown("y", 3.0 * p("a"))
            }
        },
        noise: 0.01,
    };
    let result = |checked: f64| {
        let problem = problem(
            vec![parameter("a", [0.0, 1.0])],
            vec![model("fit", &[0]), model("kept", &[0])],
            vec![
                measured(0, "y", Role::Fit, (1.2, 0.05)),
                measured(1, "y", Role::Check, (checked, 0.05)),
            ],
        );
        run(&toy, &problem).unwrap()
    };
    let (holds, fails) = (result(1.8), result(2.4));
    assert!(holds.met && holds.check[0].holds, "{}", holds.verdict);
    assert!(!fails.met && !fails.check[0].holds, "{}", fails.verdict);
    assert!(
        fails.verdict.contains("check on y of kept"),
        "{}",
        fails.verdict
    );
    assert_eq!(value(&holds, "a").to_bits(), value(&fails, "a").to_bits());
    // The joint estimate uses both: with 1.8 it stays, and it is known better.
    let joint = holds.joint.expect("there is a check");
    assert!((joint.parameters[0].value - 0.6).abs() < 0.02, "{joint:?}");
    assert!(joint.parameters[0].se < holds.parameters[0].se, "{joint:?}");
}

/// Measured with the parameters in use before, y = 2 a is 0.2 (a = 0.1); after, 1.2. Both stand in the result.
#[test]
fn errors_before_and_after_stand_side_by_side() {
    let toy = Toy {
        law: |_, p| shown("y", 2.0 * p("a")),
        noise: 0.0,
    };
    let mut a = parameter("a", [0.0, 1.0]);
    a.start = 0.1;
    let problem = problem(
        vec![a],
        vec![model("m", &[0])],
        vec![measured(0, "y", Role::Fit, (1.2, 0.1))],
    );
    let result = run(&toy, &problem).unwrap();
    assert!((result.before[0].simulated.mean - 0.2).abs() < 1e-12);
    assert!(!result.before[0].holds);
    assert!((result.fit[0].simulated.mean - 1.2).abs() < 1e-6);
    assert!(result.fit[0].holds);
}

/// y = a + b is measured, the check shows a - b, which is open: it cannot fail, and the verdict says that it tests nothing.
#[test]
fn a_check_that_open_parameters_make_vague_is_told_as_such() {
    let toy = Toy {
        law: |model, p| {
            let (a, b) = (p("a"), p("b"));
            shown("y", if model == "fit" { a + b } else { a - b })
        },
        noise: 0.01,
    };
    let problem = of_y(
        "ab",
        &[
            ("fit", Role::Fit, (1.0, 0.05)),
            ("kept", Role::Check, (0.4, 0.05)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(
        result.check[0].parameter_se.unwrap() > 0.1,
        "{:?}",
        result.check
    );
    assert!(
        result.verdict.contains("tests next to nothing"),
        "{}",
        result.verdict
    );
}

/// A check whose runs scatter ten times as much as its measurement bears differences of many of its standard errors. It could have
/// failed all the same if other parameters in the box change what it shows by far more, 40, and could not if they change it by 0.4.
#[test]
fn a_noisy_check_is_judged_by_what_parameters_change() {
    let steep: Law = |model, p| shown("y", if model == "fit" { 100.0 } else { 40.0 } * p("a"));
    let flat: Law = |model, p| match model {
        "fit" => shown("y", 100.0 * p("a")),
        _ => shown("y", 19.8 + 0.4 * p("a")),
    };
    for (law, met) in [(steep, true), (flat, false)] {
        let toy = Toy { law, noise: 1.0 };
        let sd = 10.0_f64.sqrt();
        let problem = problem(
            vec![parameter("a", [0.0, 1.0])],
            vec![model("fit", &[0]), model("kept", &[0])],
            vec![
                measured(0, "y", Role::Fit, (50.0, sd)),
                measured(1, "y", Role::Check, (20.0, 0.1 * sd)),
            ],
        );
        let result = run(&toy, &problem).unwrap();
        assert!(result.check[0].holds, "{:?}", result.check);
        assert_eq!(result.met, met, "{}", result.verdict);
    }
}

/// Two runs of the check, 0.4 apart, have one degree of freedom: Student's t is 12.7, and 1.5 measured beside 2.0 shown, thirty
/// of its own standard errors, cannot be turned down. The verdict says what the check would bear, and what it needs.
#[test]
fn a_check_of_two_runs_that_scatter_is_told_as_such() {
    let toy = Toy {
        law: |model, p| {
            let scatter = 0.4 * (p("seed") % 2.0);
            shown(
                "y",
                if model == "fit" {
                    2.0 * p("a")
                } else {
                    3.0 * p("a") + scatter
                },
            )
        },
        noise: 0.001,
    };
    let problem = of_y(
        "a",
        &[
            ("fit", Role::Fit, (1.2, 0.005)),
            ("kept", Role::Check, (1.5, 0.05)),
        ],
    );
    let settings = LoopSettings {
        check_runs: 2,
        joint: false,
        ..LoopSettings::default()
    };
    let result = super::toy::run_with(&toy, &problem, &settings).unwrap();
    assert!(result.check[0].holds, "{:?}", result.check);
    for part in ["would bear a difference of 2.4", "more check_runs"] {
        assert!(result.verdict.contains(part), "{}", result.verdict);
    }
}

/// A check measured twice has one degree of freedom: Student's t of 12.7 is what it would bear, whatever the runs. It is the
/// measurement that needs more values.
#[test]
fn a_check_that_was_measured_twice_is_told_as_such() {
    let toy = Toy {
        law: |model, p| shown("y", if model == "fit" { 2.0 } else { 3.0 } * p("a")),
        noise: 0.001,
    };
    let problem = problem(
        vec![parameter("a", [0.0, 1.0])],
        vec![model("fit", &[0]), model("kept", &[0])],
        vec![
            measured(0, "y", Role::Fit, (1.2, 0.005)),
            Measurement {
                n: 2.0,
                ..measured(1, "y", Role::Check, (2.5, 0.3))
            },
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(result.check[0].holds, "{:?}", result.check);
    for part in [
        "the measurement was repeated so little",
        "measure it more often",
    ] {
        assert!(result.verdict.contains(part), "{}", result.verdict);
    }
    assert!(!result.verdict.contains("check_runs"), "{}", result.verdict);
}

/// The check is another observable of the same runs, z = 3 a, measured far from what a = 0.6 shows: the surfaces know it, and
/// neither estimate nor interval moves. The standard error is that of y alone, 0.05 / sqrt(10) / 2, but for the noise of the
/// runs (a tenth at most); with z it would be 0.0044.
#[test]
fn a_check_on_the_runs_of_the_fit_moves_nothing_either() {
    let toy = Toy {
        law: |_, p| {
            let values = vec![("y", 2.0 * p("a")), ("z", 3.0 * p("a"))];
            Ok(Shown { values, regime: "" })
        },
        noise: 0.01,
    };
    let result = |checked: f64| {
        let problem = problem(
            vec![parameter("a", [0.0, 1.0])],
            vec![model("m", &[0])],
            vec![
                measured(0, "y", Role::Fit, (1.2, 0.05)),
                measured(0, "z", Role::Check, (checked, 0.05)),
            ],
        );
        run(&toy, &problem).unwrap()
    };
    let (holds, fails) = (result(1.8), result(2.4));
    assert!(
        holds.met && !fails.met,
        "{} {}",
        holds.verdict,
        fails.verdict
    );
    assert_eq!(holds.parameters, fails.parameters);
    let se = holds.parameters[0].se.unwrap();
    assert!((0.0079..0.0087).contains(&se), "{se}");
}
