//! Two frictions that one apparatus ties, and which further one separates them.

use super::toy::{Shown, Toy, measured, model, parameter, problem, run, value};
use inference::{Calibration, CalibrationProblem, Candidate, LoopSettings, Parameter, Role};

/// Truth of sliding and rolling friction.
const TRUTH: [f64; 2] = [0.4, 0.1];

/// What an apparatus shows: both drums only the sum `20 F + 40 R`, hopper and shear box more of the sliding friction.
fn law(name: &str, of: &dyn Fn(&str) -> f64) -> Result<Shown, String> {
    let (f, r) = (of("F"), of("R"));
    let y = match name {
        "drum" => 20.0 * f + 40.0 * r,
        "faster drum" => 2.0 + 20.0 * f + 40.0 * r,
        "hopper" => 60.0 - 30.0 * f,
        "flat hopper" => 60.0 + 60.0 * (f - 0.45).min(0.0).powi(2),
        "shear box" => 30.0 * f + 10.0 * r,
        _ => return Err("the lid ejects the bed".into()),
    };
    Ok(Shown {
        values: vec![("y", y)],
        regime: "",
    })
}

fn candidate(name: &str, minutes: f64) -> Candidate {
    Candidate {
        model: model(name, &[0, 1]),
        standard_errors: [("y".to_owned(), 0.5)].into(),
        repeats: 5.0,
        minutes,
        is_suggested: false,
    }
}

/// The drum alone, known to 0.25, with the other apparatus as candidates.
fn drum_alone(candidates: Vec<Candidate>) -> CalibrationProblem {
    let wide = |symbol: &str, range, limits| Parameter {
        limits,
        ..parameter(symbol, range)
    };
    let y = 20.0 * TRUTH[0] + 40.0 * TRUTH[1];
    CalibrationProblem {
        candidates,
        ..problem(
            vec![
                wide("F", [0.1, 0.6], [0.0, 1.0]),
                wide("R", [0.0, 0.3], [0.0, 0.5]),
            ],
            vec![model("drum", &[0, 1])],
            vec![measured(0, "y", Role::Fit, (y, 0.25 * 10.0_f64.sqrt()))],
        )
    }
}

const TOY: Toy = Toy { law, noise: 0.01 };

/// Names of the candidates in the order of their ranking.
fn order(found: &Calibration) -> Vec<&str> {
    let next = found.next_for_parameters.as_ref().expect("a ranking");
    next.ranked.iter().map(|r| r.name.as_str()).collect()
}

/// By hand: the drum ties F and R, so that F goes from 0.1 to 0.6 while R goes from 0.25 to 0. The hopper then changes by 15, 30 standard errors of
/// 0.5; drawn points reach the ends of the set to some percent. F is known to 0.5 / 30 and R to what the drum leaves; that the hopper tells F and
/// not the place along the tie alone makes up to a fifth of these errors. The shear box changes by 15 - 2.5, 25 standard errors, and takes three
/// times as long; a faster drum, the cheapest, leaves the tie.
#[test]
fn the_apparatus_that_separates_two_frictions_comes_first() {
    let candidates = vec![
        candidate("faster drum", 1.0),
        candidate("shear box", 30.0),
        candidate("hopper", 10.0),
    ];
    let found = run(&TOY, &drum_alone(candidates)).unwrap();
    assert!(!found.met && !found.open_combinations.is_empty());
    assert_eq!(order(&found), ["hopper", "shear box", "faster drum"]);
    let next = found.next_for_parameters.as_ref().unwrap();
    let [hopper, shear, drum] = [0, 1, 2].map(|k| &next.ranked[k]);
    assert!((hopper.separation / 30.0 - 1.0).abs() < 0.06, "{next:?}");
    assert!((shear.separation / 25.0 - 1.0).abs() < 0.06, "{next:?}");
    assert!(next.now < 4.0 && drum.separation < 4.0, "{next:?}");
    let [f, r] = ["F", "R"].map(|symbol| hopper.standard_errors[symbol].expect("closed"));
    assert!((f / (0.5 / 30.0) - 1.0).abs() < 0.2, "{f}");
    let of_r = (0.25_f64.powi(2) + (20.0 * 0.5 / 30.0_f64).powi(2)).sqrt() / 40.0;
    assert!((r / of_r - 1.0).abs() < 0.2, "{r}");
    assert_eq!(drum.standard_errors["F"], None);
    assert_eq!(hopper.runs, hopper.keys.len());
    assert_eq!(found.cost.last().unwrap().runs, 3 * hopper.runs);
}

/// What the slope at the estimate hides: a hopper that is flat above F = 0.45, as a small one was found to be, leaves the tie open there, whatever it
/// tells below.
#[test]
fn an_apparatus_that_is_flat_in_a_part_does_not_separate() {
    let candidates = ["flat hopper", "hopper"].map(|name| candidate(name, 10.0));
    let found = run(&TOY, &drum_alone(candidates.to_vec())).unwrap();
    assert_eq!(order(&found), ["hopper", "flat hopper"]);
    let next = found.next_for_parameters.as_ref().unwrap();
    assert!(next.ranked[1].separation < next.needed, "{next:?}");
}

/// Once the first is measured, both frictions are those of the truth within their intervals, and nothing is asked any more.
#[test]
fn the_first_apparatus_closes_the_study() {
    let mut joint = drum_alone(vec![candidate("shear box", 30.0)]);
    joint.models.push(model("hopper", &[0, 1]));
    let flow = (60.0 - 30.0 * TRUTH[0], 0.5 * 10.0_f64.sqrt());
    joint.measurements.push(measured(1, "y", Role::Fit, flow));
    let found = run(&TOY, &joint).unwrap();
    assert!(found.open_combinations.is_empty(), "{found:?}");
    assert_eq!(found.next_for_parameters, None);
    for (symbol, truth) in ["F", "R"].into_iter().zip(TRUTH) {
        let near = (value(&found, symbol) - truth).abs();
        assert!(near < 0.02, "{symbol}: off by {near}");
    }
}

/// A candidate that fails is named with the reason; one that nobody named is not run, and one beyond the budget neither.
#[test]
fn what_is_not_ranked_is_said() {
    let jammed = candidate("jammed box", 1.0);
    let found = run(&TOY, &drum_alone(vec![jammed, candidate("hopper", 10.0)])).unwrap();
    assert_eq!(order(&found), ["hopper"]);
    let next = found.next_for_parameters.as_ref().unwrap();
    assert!(next.left_out["jammed box"].contains("ejects the bed"));
    let suggested = Candidate {
        is_suggested: true,
        ..candidate("hopper", 10.0)
    };
    let found = run(&TOY, &drum_alone(vec![suggested])).unwrap();
    assert_eq!(found.next_for_parameters, None);
    let settings = LoopSettings {
        most_runs: Some(22),
        ..LoopSettings::default()
    };
    let problem = drum_alone(vec![candidate("hopper", 10.0)]);
    let found = super::toy::run_with(&TOY, &problem, &settings).unwrap();
    let next = found.next_for_parameters.as_ref().unwrap();
    assert!(next.ranked.is_empty() && next.left_out["hopper"].contains("budget of 22 runs"));
}
