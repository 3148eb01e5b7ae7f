//! The five problems of `fixtures/diagnosis` against numbers of an independent implementation.

use dev_support::fixture_files::fixture;
use inference::diagnosis::{
    Diagnosis, Options, Problem, ProblemFile, TrialRow, Truth, Verdict, diagnose, trials,
};
use serde_json::Value;

/// Reads one file of a fixture.
fn read(name: &str, file: &str) -> String {
    let path = fixture("diagnosis").join(name).join(file);
    std::fs::read_to_string(path).expect("the fixture is there")
}

/// The problem of a fixture.
fn problem(fixture: &str) -> Problem {
    let file: ProblemFile =
        serde_json::from_str(&read(fixture, "problem.json")).expect("the fixture has the form");
    Problem::try_from(file).expect("the fixture is sound")
}

/// The diagnosis of a fixture and what is expected.
fn diagnosed(fixture: &str) -> (Diagnosis, Value) {
    let diagnosis = diagnose(&problem(fixture), &Options::new(1)).expect("it can be diagnosed");
    let expected = serde_json::from_str(&read(fixture, "expected.json")).expect("valid JSON");
    (diagnosis, expected)
}

/// Both come from the same double-precision inputs by different algorithms: rounding, amplified
/// by cancellation in `T_after`, stays below 1e-9 relative.
fn assert_close(what: &str, got: Option<f64>, expected: &Value) {
    let (got, expected) = (
        got.expect("a number was computed"),
        expected.as_f64().expect("a number is expected"),
    );
    assert!(
        (got - expected).abs() <= 1e-9 * expected.abs(),
        "{what}: got {got}, expected {expected}"
    );
}

/// The numbers of a fixture that can be tested.
fn check_numbers(fixture: &str) {
    let (d, expected) = diagnosed(fixture);
    let chi2 = &expected["chi2"];
    assert_close("T0", d.structured_residual.t0, &chi2["T0"]);
    assert_close("p", d.structured_residual.p, &chi2["p"]);
    assert_eq!(Some(d.structured_residual.df as u64), chi2["df"].as_u64());
    assert_close("c", Some(d.tie_set_c), &expected["tie_set_c"]);
    let share = d.largest_condition_share.as_ref().expect("a share");
    let expected_share = &expected["largest_condition_share"];
    assert_close("share", Some(share.share), &expected_share["share_of_T0"]);
    assert_eq!(
        Some(share.condition_index as u64),
        expected_share["condition_index"].as_u64()
    );
    for (name, e) in expected["candidates"].as_object().expect("a map") {
        let c = &d.candidates[name];
        assert_close(&format!("{name} z"), c.z, &e["z"]);
        assert_close(&format!("{name} amplitude"), c.amplitude, &e["amplitude"]);
        assert_close(&format!("{name} se"), c.se, &e["se"]);
        assert_close(&format!("{name} T"), Some(c.t_after), &e["T_after"]);
        assert_close(&format!("{name} p"), c.p_adequacy, &e["p_adequacy"]);
        let absorbed = &e["absorbed_fraction"];
        assert_close(&format!("{name} absorbed"), c.absorbed_fraction, absorbed);
        // Two Monte Carlo estimates, of 200 000 draws here and at least as many there: five
        // standard errors of their difference, plus the 1 that is added here.
        let p = e["p_max_test_mc"].as_f64().expect("a number");
        let error = (2.0 * p * (1.0 - p) / 2e5).sqrt();
        let got = c.p_max_test.expect("all are testable");
        assert!((got - p).abs() <= 5.0 * error + 1e-5, "{name}: {got} {p}");
    }
    let unused = &expected["unused_conditions"];
    let errors = d.before_after.expect("candidates");
    assert_eq!(errors.effects, [expected["best"].as_str().expect("a name")]);
    let got = errors.unused.expect("unused conditions");
    let angle = got.rmse["angle_deg"];
    assert_close("before", Some(angle.before), &unused["angle_rmse_before"]);
    assert_close("after", Some(angle.after), &unused["angle_rmse_after_best"]);
    let floor = got.noise_floor["angle_deg"];
    assert_close("floor", Some(floor), &unused["noise_floor_angle"]);
    let mse = got.whitened_mse;
    assert_close(
        "mse before",
        Some(mse.before),
        &unused["whitened_mse_before"],
    );
    assert_close("mse after", Some(mse.after), &unused["whitened_mse_after"]);
}

#[test]
fn numbers_of_the_null_problem_agree() {
    check_numbers("null");
}

#[test]
fn numbers_of_the_single_problem_agree() {
    check_numbers("single");
}

#[test]
fn numbers_of_the_tie_problem_agree() {
    check_numbers("tie");
}

#[test]
fn numbers_of_the_outside_problem_agree() {
    check_numbers("outside");
}

#[test]
fn nothing_is_named_where_nothing_is_missing() {
    let (d, _) = diagnosed("null");
    assert_eq!(d.verdict, Verdict::None, "{d:#?}");
    assert!(d.effects.is_empty(), "{:?}", d.effects);
}

#[test]
fn planted_effect_is_named() {
    let (d, _) = diagnosed("single");
    assert_eq!(d.verdict, Verdict::Named, "{}", d.summary);
    assert_eq!(d.effects, ["E3"]);
}

#[test]
fn twins_are_a_tie_and_a_measurement_is_proposed() {
    let (d, _) = diagnosed("tie");
    assert_eq!(d.verdict, Verdict::Tie, "{}", d.summary);
    assert_eq!(d.effects, ["E4", "E7"]);
    let next = d.next_measurement.expect("a proposal");
    assert!(next.plan[0].criterion > next.now, "{next:?}");
}

#[test]
fn effect_outside_the_library_is_not_named() {
    let (d, _) = diagnosed("outside");
    assert_eq!(d.verdict, Verdict::Unknown, "{}", d.summary);
}

#[test]
fn fewer_observations_than_parameters_are_refused() {
    let (d, _) = diagnosed("refuse");
    assert_eq!(d.verdict, Verdict::Refused, "{}", d.summary);
    assert_eq!(d.structured_residual.df, 0);
    assert!(d.candidates.is_empty(), "nothing can be said of any");
}

#[test]
fn same_problem_and_seed_give_the_same_diagnosis() {
    assert_eq!(diagnosed("tie").0, diagnosed("tie").0);
}

/// What the rules say of an effect that was taken out, and its name and strength.
fn taken_out(fixture: &str, name: &str, strength: f64, number: usize) -> TrialRow {
    let name = name.to_owned();
    let truth = Truth::TakenOut { name, strength };
    let mut rows = trials(&problem(fixture), &[truth], number, 1, 0).expect("it can be simulated");
    rows.pop().expect("one row for one truth")
}

/// E6 made the data and the library lacks it. E7 resembles it in part, and it is not smooth over the conditions, so
/// that the rival of smooth unknown effects does not see it. Where what remains is not noise, a member has to stand
/// out of all of it to be named: 4 of 100 campaigns name one falsely, 16 when it has to stand out of the noise alone.
/// The bound of 10 lies three standard errors (2 each) above what is expected.
#[test]
fn outside_effect_that_a_member_resembles_in_part_is_not_named_by_it() {
    let row = taken_out("single", "E6", 9.0, 100);
    assert!(row.false_name < 10, "{row:?}");
    assert!(row.unknown > 90, "{row:?}");
}

/// An effect of strength s leaves s sqrt(1 - rho^2) when another one of the correlation rho explains what it can;
/// the correlations are those of the independent implementation. Twins are distinguished from the others.
#[test]
fn nearest_effect_leaves_what_its_correlation_says() {
    for (fixture, effect, twin) in [("single", 6, false), ("tie", 4, true)] {
        let (_, expected) = diagnosed(fixture);
        let row = expected["projected_correlation"][effect - 1]
            .as_array()
            .expect("a row");
        let of_others = row.iter().enumerate().filter(|(k, _)| k + 1 != effect);
        let (other, rho) = of_others
            .map(|(k, rho)| (k + 1, rho.as_f64().expect("a number")))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .expect("the library holds others");
        let row = taken_out(fixture, &format!("E{effect}"), 9.0, 1);
        let nearest = row.nearest.expect("the library holds others");
        assert_eq!((nearest.name, nearest.twin), (format!("E{other}"), twin));
        let left = 9.0 * (1.0 - rho * rho).sqrt();
        assert_close("left", Some(nearest.left), &left.into());
    }
}

/// The sensitivities of this problem were measured by runs that scatter. That of the smoother filling is 0.9 / 0.14 =
/// 6.4 standard errors long at its largest amplitude, above the 3 that are asked for, but most of it is the noise of
/// the runs: it is not a candidate, and not named by chance.
#[test]
fn effect_whose_sensitivity_is_mostly_noise_is_not_testable() {
    let problem = problem("drum");
    let d = diagnose(&problem, &Options::new(1)).expect("it can be diagnosed");
    assert_eq!(d.not_testable, ["filling-smoothness"]);
    let se = d.candidates["filling-smoothness"].se.expect("a number");
    assert!(0.9 / se > 3.0, "{se}");
}

/// Of the campaigns in which something is named or tied, 95 % must hold the truth, however alike the effects are and
/// however noisy their sensitivities: each of these five has near twins in this library. 0.975 of the namings are
/// expected to hold it (standard error 0.012); with the limit for exact sensitivities, the normal quantile, 0.92 of these.
#[test]
fn named_set_holds_the_truth_although_sensitivities_are_noisy() {
    let problem = problem("library");
    let names = [
        "rolling-spring",
        "dry-adhesion",
        "cohesion",
        "wall-charge",
        "seed-count",
    ];
    let truths = names.map(|name| Truth::Effect {
        name: name.into(),
        strength: 9.0,
    });
    let rows = trials(&problem, &truths, 40, 1, 0).expect("it can be simulated");
    let right: usize = rows.iter().map(|r| r.named + r.tied).sum();
    let wrong: usize = rows.iter().map(|r| r.false_name).sum();
    assert!(right > 150, "too few namings: {rows:?}");
    let share = right as f64 / (right + wrong) as f64;
    assert!(share >= 0.95, "{share}: {rows:?}");
}
