//! What is invalid, and what goes wrong on the way.

use super::toy::{
    Law, Toy, measured, model, of_y, parameter, problem, run, run_with, settings_of, shown, value,
};
use inference::{LoopSettings, Role, planned};

/// A run fails beyond a = 0.85: its point is left out with the reason, and the loop continues.
#[test]
fn a_run_that_fails_costs_its_own_point() {
    let toy = Toy {
        law: |_, p| {
            if p("a") > 0.85 {
                return Err("no frame shows a surface".into());
            }
            shown("y", 2.0 * p("a"))
        },
        noise: 0.01,
    };
    let problem = of_y("a", &[("m", Role::Fit, (1.0, 0.05))]);
    let result = run(&toy, &problem).unwrap();
    assert!(result.met, "{}", result.verdict);
    assert!((value(&result, "a") - 0.5).abs() < 0.03);
    let left_out = &result.surfaces[0].left_out;
    assert_eq!(left_out.len(), 1, "{left_out:?}");
    assert!(
        left_out[0].reason.contains("no frame shows a surface"),
        "{left_out:?}"
    );
}

/// A screening of two parameters in 12 runs of which two fail: the regression continues with ten, finds the effect of a
/// (0.8 over its range, noise 0.01) and leaves b out, and the remark gives the reason.
#[test]
fn a_screening_goes_on_without_the_runs_that_fail() {
    let toy = Toy {
        law: |_, p| {
            if p("a") > 0.85 && p("b") > 0.85 && p("c") > 0.85 {
                return Err("body 3 has run away".into());
            }
            shown("y", 0.8 * p("a"))
        },
        noise: 0.01,
    };
    let unit = |symbol| parameter(symbol, [0.0, 1.0]);
    let problem = problem(
        vec![unit("a"), unit("b"), unit("c")],
        vec![model("m", &[0, 1, 2])],
        vec![measured(0, "y", Role::Fit, (0.4, 0.05))],
    );
    let settings = LoopSettings {
        screening: inference::ScreeningChoice::Always,
        screening_least: 1,
        ..LoopSettings::default()
    };
    let result = run_with(&toy, &problem, &settings).unwrap();
    let screening = &result.screening[0];
    assert_eq!(screening.kept, ["a"], "{screening:?}");
    let told = "of m in the screening failed: ";
    let remark = result.remarks.iter().find(|r| r.contains(told));
    let remark = remark.unwrap_or_else(|| panic!("{:?}", result.remarks));
    assert!(remark.contains("body 3 has run away"), "{remark}");
    assert!(screening.n_runs < 12, "{}", screening.n_runs);
}

/// A simulator that never works is found out by the first list, two runs, and nothing else is run. Where that list is left
/// out there is no surface: an error with the model and the reason, not a result.
#[test]
fn a_model_that_never_runs_is_an_error_with_its_reason() {
    let toy = Toy {
        law: |_, _| Err("the drum is empty".into()),
        noise: 0.0,
    };
    let problem = of_y("a", &[("m", Role::Fit, (1.0, 0.05))]);
    let error = run(&toy, &problem).unwrap_err().to_string();
    assert!(
        error.contains("all 2 runs") && error.contains("the drum is empty"),
        "{error}"
    );
    let settings = LoopSettings {
        before_runs: 0,
        ..LoopSettings::default()
    };
    let error = run_with(&toy, &problem, &settings).unwrap_err().to_string();
    assert!(
        error.contains("0 runs of m") && error.contains("the drum is empty"),
        "{error}"
    );
}

/// A check that cannot be simulated is not a check that holds: the result is not met, and says what failed and why.
#[test]
fn a_check_whose_runs_fail_is_not_met_and_says_why() {
    let toy = Toy {
        law: |model, p| {
            if model == "kept" {
                return Err("the bed shows no surface".into());
            }
            shown("y", 2.0 * p("a"))
        },
        noise: 0.01,
    };
    let problem = of_y(
        "a",
        &[
            ("fit", Role::Fit, (1.2, 0.05)),
            ("kept", Role::Check, (1.2, 0.05)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(!result.met, "{}", result.verdict);
    let told = "4 of 4 runs of kept at the estimate failed";
    let remark = result.remarks.iter().find(|r| r.contains(told));
    let remark = remark.unwrap_or_else(|| panic!("{:?}", result.remarks));
    assert!(remark.contains("the bed shows no surface"), "{remark}");
}

/// One of three fitted experiments never runs: the parameters are fitted by the others, 2 a = 1.2, and the result is not met and says
/// which experiment failed and why.
#[test]
fn an_experiment_that_never_runs_costs_itself_and_not_the_study() {
    let toy = Toy {
        law: |model, p| match model {
            "drop" => Err("the seed neither rebounds nor rests".into()),
            "other" => shown("y", 3.0 * p("a")),
            _ => shown("y", 2.0 * p("a")),
        },
        noise: 0.01,
    };
    let problem = of_y(
        "a",
        &[
            ("fit", Role::Fit, (1.2, 0.05)),
            ("other", Role::Fit, (1.8, 0.05)),
            ("drop", Role::Fit, (0.1, 0.05)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(!result.met, "{}", result.verdict);
    assert!(result.parameters[0].fixed_by_data);
    // The standard error of a is some 0.006; 0.03 is five of them.
    assert!(
        (value(&result, "a") - 0.6).abs() < 0.03,
        "{:?}",
        result.parameters
    );
    let told = |r: &&String| {
        r.contains("the fit is made without drop") && r.contains("neither rebounds nor rests")
    };
    assert!(
        result.remarks.iter().any(|r| told(&r)),
        "{:?}",
        result.remarks
    );
}

/// A program that reads none of its parameters meets every measurement by chance: that fixes nothing, and is not a success.
#[test]
fn a_simulator_that_does_not_respond_is_not_met() {
    let toy = Toy {
        law: |model, _| shown("y", if model == "one" { 0.3 } else { 0.5 }),
        noise: 0.02,
    };
    let problem = of_y(
        "ab",
        &[
            ("one", Role::Fit, (0.3, 0.1)),
            ("two", Role::Fit, (0.5, 0.1)),
            ("three", Role::Fit, (0.5, 0.1)),
            ("kept", Role::Check, (0.5, 0.1)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(!result.met, "{}", result.verdict);
    let told = "do not fix a and b: no fitted observable responds to them";
    assert!(result.verdict.contains(told), "{}", result.verdict);
}

/// One measured value and two parameters: every point of a line meets it.
#[test]
fn fewer_values_than_parameters_are_not_met() {
    let toy = Toy {
        law: |_, p| shown("y", p("a") + p("b")),
        noise: 0.01,
    };
    let problem = of_y(
        "ab",
        &[
            ("m", Role::Fit, (1.0, 0.1)),
            ("kept", Role::Check, (1.0, 0.1)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(!result.met, "{}", result.verdict);
    let told = "1 fitted value depends on a and b, fewer than these 2 parameters";
    assert!(result.verdict.contains(told), "{}", result.verdict);
}

/// A run that lacks a measured observable names it and what it gave.
#[test]
fn a_missing_observable_is_named_with_those_that_are_there() {
    let toy = Toy {
        law: |_, p| shown("y", p("a")),
        noise: 0.0,
    };
    let problem = problem(
        vec![parameter("a", [0.0, 1.0])],
        vec![model("m", &[0])],
        vec![measured(0, "x", Role::Fit, (1.0, 0.05))],
    );
    let error = run(&toy, &problem).unwrap_err().to_string();
    assert!(
        error.contains("'x'") && error.contains("it gave y"),
        "{error}"
    );
}

/// y = a is measured as 0.3 and, in another experiment that shows the same, as 0.7, twenty standard errors apart: no value
/// meets both, and the verdict says which are not met.
#[test]
fn measurements_that_contradict_each_other_are_not_met() {
    let toy = Toy {
        law: |_, p| shown("y", p("a")),
        noise: 0.001,
    };
    let problem = of_y(
        "a",
        &[
            ("one", Role::Fit, (0.3, 0.03)),
            ("other", Role::Fit, (0.7, 0.03)),
        ],
    );
    let result = run(&toy, &problem).unwrap();
    assert!(!result.met);
    assert!(
        (value(&result, "a") - 0.5).abs() < 0.02,
        "{:?}",
        result.parameters
    );
    assert!(result.test.p.unwrap() < 1e-3, "{:?}", result.test);
    assert!(
        result.verdict.contains("y of one") && result.verdict.contains("y of other"),
        "{}",
        result.verdict
    );
}

/// All faults of a problem are reported at once, before any run.
#[test]
fn all_that_cannot_be_meant_is_told_at_once() {
    let mut outside = parameter("a", [0.0, 1.0]);
    outside.start = 2.0;
    let problem = problem(
        vec![
            outside,
            parameter("a", [1.0, 0.5]),
            parameter("c", [0.0, 1.0]),
        ],
        vec![model("m", &[0, 1])],
        vec![
            measured(0, "y", Role::Fit, (1.0, 0.0)),
            measured(0, "y", Role::Check, (1.0, 0.1)),
        ],
    );
    let toy = Toy {
        law: |_, _| Err("it must not run".into()),
        noise: 0.0,
    };
    let error = run(&toy, &problem).unwrap_err().to_string();
    for part in [
        "start 2 lies outside its limits 0 to 1",
        "duplicate symbol",
        "low 1 and high 0.5",
        "parameter c: no measurement of role fit depends on it",
        "sd 0",
        "in two roles",
    ] {
        assert!(error.contains(part), "'{part}' is not in:\n{error}");
    }
}

/// Six parameters of one model are screened: those that act are kept, the others are dropped and reported.
#[test]
fn more_than_five_parameters_are_screened_first() {
    let toy = Toy {
        law: |_, p| shown("y", 4.0 * p("a") - 3.0 * p("b")),
        noise: 0.05,
    };
    let names = ["a", "b", "c", "d", "e", "f"];
    let problem = problem(
        names.iter().map(|s| parameter(s, [0.0, 1.0])).collect(),
        vec![model("m", &[0, 1, 2, 3, 4, 5])],
        vec![measured(0, "y", Role::Fit, (1.0, 0.1))],
    );
    let result = run(&toy, &problem).unwrap();
    let screening = &result.screening[0];
    assert_eq!(screening.n_runs, 12);
    assert!(screening.kept.contains(&"a".to_owned()), "{screening:?}");
    assert!(screening.kept.contains(&"b".to_owned()), "{screening:?}");
    assert!(screening.dropped.len() >= 3, "{:?}", screening.dropped);
    for dropped in &screening.dropped {
        let p = result
            .parameters
            .iter()
            .find(|p| p.symbol == *dropped)
            .unwrap();
        assert!(!p.fixed_by_data && p.value == p.start, "{p:?}");
    }
}

/// The plan has the runs that the loop then makes: with a target inside the first box and surfaces that are confirmed, no
/// stage needs more.
#[test]
fn the_plan_has_the_runs_of_the_loop() {
    let toy = Toy {
        law: |_, p| shown("y", 2.0 * p("a")),
        // A fiftieth of the error of a measurement: what a surface misses does not matter.
        noise: 3e-4,
    };
    let problem = of_y(
        "a",
        &[
            ("fit", Role::Fit, (1.2, 0.05)),
            ("kept", Role::Check, (1.2, 0.05)),
        ],
    );
    let plan = planned(&problem, &LoopSettings::default()).unwrap();
    let result = run(&toy, &problem).unwrap();
    let planned: Vec<_> = plan.iter().map(|s| (s.stage.as_str(), s.runs())).collect();
    let made: Vec<_> = result
        .cost
        .iter()
        .map(|s| (s.stage.as_str(), s.runs))
        .collect();
    assert_eq!(planned, made);
}

/// How 100 studies of one measurement, 0.7 +- 0.02, end: how many do not meet it, and how many of these say that by the surfaces
/// nothing does although their surface does, by two standard errors. A run scatters by 0.08.
fn ends(law: Law) -> (usize, usize) {
    let toy = Toy { law, noise: 0.08 };
    let problem = of_y("a", &[("m", Role::Fit, (0.7, 0.06))]);
    let error = 0.06 / 10_f64.sqrt();
    let (mut not_met, mut wrong) = (0, 0);
    for seed in 0..100 {
        let settings = settings_of(seed);
        let result = run_with(&toy, &problem, &settings).expect("a study that runs");
        let row = &result.confirmations.last().expect("a round").rows[0];
        let meets = (row.predicted - 0.7).abs() < 2.0 * error.hypot(row.predicted_se);
        let told = result.verdict.contains("by the surfaces no parameters");
        not_met += usize::from(!result.met);
        wrong += usize::from(meets && told);
    }
    (not_met, wrong)
}

/// Runs that miss what their surface meets do not prove that nothing meets it: the surface is corrected and the estimate made again.
/// Of a straight line, which can meet the measurement, 5 studies of 100 may say that it does not, and 11 are three standard errors
/// more; taken as they are, the first three runs say so in 16. A step up between the points of the design, which the scatter of
/// runs hides, may go unmet, but none of these studies says what its surface contradicts.
#[test]
fn runs_that_miss_what_their_surface_meets_are_no_proof() {
    let (not_met, wrong) = ends(|_, p| shown("y", p("a")));
    assert!(not_met <= 11 && wrong == 0, "{not_met}, {wrong}");
    let (_, wrong) = ends(|_, p| {
        let step = f64::from(u8::from((p("a") - 0.7).abs() < 0.08));
        shown("y", p("a") + 0.16 * step)
    });
    assert_eq!(wrong, 0);
}
