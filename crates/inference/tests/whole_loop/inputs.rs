//! Inputs of the simulator that were stated with an error.

use super::toy::{Shown, Toy, measured, model, parameter, problem, run, shown};
use inference::{CalibrationProblem, Parameter, Prior, Role};

/// A fill that was stated as 0.35 ± 0.01.
fn fill() -> Parameter {
    Parameter {
        start: 0.35,
        prior: Some(Prior {
            mean: 0.35,
            sd: 0.01,
        }),
        is_input: true,
        ..parameter("fill", [0.32, 0.38])
    }
}

/// A drum whose angle depends on friction and fill, and whose level is the fill.
fn drum(values: &[(&str, f64, f64)]) -> CalibrationProblem {
    let measurements = values.iter();
    let measurements =
        measurements.map(|(name, mean, sd)| measured(0, name, Role::Fit, (*mean, *sd)));
    let friction = Parameter {
        limits: [0.0, 2.0],
        ..parameter("F", [0.1, 0.7])
    };
    problem(
        vec![friction, fill()],
        vec![model("drum", &[0, 1])],
        measurements.collect(),
    )
}

/// What the drum shows: 30 deg for each unit of friction, 60 deg for each of fill.
#[expect(clippy::unnecessary_wraps, reason = "it is what a law returns")]
fn law(_: &str, of: &dyn Fn(&str) -> f64) -> Result<Shown, String> {
    Ok(Shown {
        values: vec![
            ("angle", 20.0 + 30.0 * of("F") + 60.0 * (of("fill") - 0.35)),
            ("level", of("fill")),
        ],
        regime: "",
    })
}

/// One angle, known to 0.25 deg, fixes the friction to sqrt(0.25² + (60 x 0.01)²) / 30 = 0.0217; a fill that is 0.01 larger makes it
/// 60 x 0.01 / 30 = 0.02 smaller. Runs scatter by 0.001, so that 1 % is left for them.
#[test]
fn the_error_of_an_input_is_in_the_standard_error() {
    let toy = Toy { law, noise: 0.001 };
    let angle = ("angle", 32.0, 0.25 * 10.0_f64.sqrt());
    let found = run(&toy, &drum(&[angle])).unwrap();
    let se = found.parameters[0].se.unwrap();
    assert!((se / 0.021_67 - 1.0).abs() < 0.01, "{se}");
    assert_eq!(found.parameters.len(), 1);
    let input = &found.inputs[0];
    assert!((input.moves["F"] + 0.02).abs() < 2e-4, "{input:?}");
    assert!(input.moved.abs() < 0.01, "{input:?}");
    assert!(found.met, "{}", found.verdict);
}

/// Photos show a level of 0.375, which is 2.5 standard deviations of the stated fill away: the fill follows the level, since that is
/// ten times as exact, the friction is that of the fill found, and a remark reports it.
#[test]
fn an_input_that_moves_far_is_told() {
    let toy = Toy { law, noise: 0.0001 };
    let sd = |se: f64| se * 10.0_f64.sqrt();
    let values = [("angle", 33.5, sd(0.25)), ("level", 0.375, sd(0.001))];
    let found = run(&toy, &drum(&values)).unwrap();
    let friction = found.parameters[0].value;
    assert!((friction - 0.4).abs() < 0.003, "{friction}");
    assert!(
        (found.inputs[0].moved - 2.5).abs() < 0.1,
        "{:?}",
        found.inputs
    );
    let told = |remark: &String| remark.contains("fill = 0.37");
    assert!(found.remarks.iter().any(told), "{:?}", found.remarks);
}

/// Runs with another fill fail, as where seeds do not fit any more: the study ends as if the fill were exact, and says so.
#[test]
fn an_input_whose_runs_fail_is_told() {
    let toy = Toy {
        law: |_, of| {
            if (of("fill") - 0.35).abs() > 0.02 {
                return Err("the seeds do not fit".into());
            }
            shown("angle", 20.0 + 30.0 * of("F"))
        },
        noise: 0.01,
    };
    let found = run(&toy, &drum(&[("angle", 32.0, 0.8)])).unwrap();
    assert!((found.parameters[0].value - 0.4).abs() < 0.01);
    let told = |remark: &String| remark.contains("input fill") && remark.contains("drum");
    assert!(found.remarks.iter().any(told), "{:?}", found.remarks);
}
