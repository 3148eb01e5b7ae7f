use super::runs::{At, Setting, means};
use super::tests::{By, observed, plan, studied, toy};
use super::worker::Worker;
use super::{ResidualPlan, ResidualStudy, StudyCondition, study_residual};
use crate::Error;
use crate::diagnosis::Verdict;
use campaign::run_store::{Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The toy, whose runs diverge where a rule says so; it counts how often each of those was asked for.
struct Diverging<F> {
    /// Whether a run diverges.
    rule: F,
    /// How often each of them was begun.
    begun: Mutex<BTreeMap<String, usize>>,
}

impl<F: Fn(&RunRequest) -> bool + Sync> Simulator for Diverging<F> {
    fn version(&self) -> String {
        "diverging".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        if (self.rule)(request) {
            let mut begun = self.begun.lock().unwrap();
            *begun.entry(request.to_string()).or_insert(0) += 1;
            let reason = "body 3 has run away".to_owned();
            return Err(SimulatorError::Failed { reason });
        }
        toy(request)
    }
}

/// A study of the toy with "bend" hidden, in which runs diverge by a rule.
fn study(
    plan: &ResidualPlan,
    rule: impl Fn(&RunRequest) -> bool + Sync,
) -> (Result<ResidualStudy, Error>, BTreeMap<String, usize>) {
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let begun = Mutex::default();
    let simulator = Diverging { rule, begun };
    let data = observed(plan, [2.0, 0.0], 1);
    let study = study_residual(&campaign, &simulator, &data);
    (study, simulator.begun.into_inner().unwrap())
}

/// A mean of three is known less well than one of four: of four runs of each condition the second diverges where the drum
/// turns at 5 rpm, and the mean there is exactly that of the other three.
#[test]
fn a_run_that_fails_is_left_out_of_its_mean() {
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let mut plan = plan(1);
    plan.conditions.truncate(4);
    let setting = Setting::declared(&plan, &[0.5, 0.5]);
    let whole = means(
        &Worker::new(&campaign, &By(toy)),
        &plan,
        &setting,
        0,
        At::Used,
    )
    .unwrap();
    assert_eq!(whole.n, [4; 4]);
    let second = plan.base.seed + 1;
    let simulator = Diverging {
        rule: |r: &RunRequest| r.seed == second && r.condition["rpm"] == 5.0,
        begun: Mutex::default(),
    };
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let worker = Worker::new(&campaign, &simulator);
    let borne = means(&worker, &plan, &setting, 0, At::Used).unwrap();
    assert_eq!(borne.n, [3, 3, 3, 4]);
    assert_eq!(borne.values[3], whole.values[3]);
    for c in 0..3 {
        let three = [0, 2, 3].map(|k| {
            let mut request = plan.base.clone().with_seed(plan.base.seed + k);
            request.condition = plan.conditions[c].condition.clone();
            request.parameters = setting.by_name(&plan);
            toy(&request).unwrap().observables["angle"].mean
        });
        let mean = three.iter().sum::<f64>() / 3.0;
        // The same sum in the same order.
        assert_eq!(borne.values[c][0], mean);
    }
    let told = worker.left_out();
    assert_eq!(told.len(), 3, "{told:?}");
    assert!(told[0].contains("body 3 has run away"), "{told:?}");
}

/// One run in nine diverges, anywhere: the planted effect is found as in the study whose runs all end, its amplitude
/// within four of its standard errors; each failing run is begun once and reported once.
#[test]
fn a_study_goes_on_without_the_runs_that_fail() {
    let mut plan = plan(1);
    plan.replicates = 5;
    // The seed of a run is that of its block and its replicate.
    let rule = |r: &RunRequest| {
        let place =
            3 * u64::from(r.condition["fill"] > 0.25) + 5 * u64::from(r.condition["rpm"] > 8.0);
        (r.seed * 31 + place).is_multiple_of(9)
    };
    let (study, begun) = study(&plan, rule);
    let study = study.unwrap();
    let said = study.diagnosis.summary();
    assert_eq!(study.diagnosis.verdict, Verdict::Named, "{said}");
    assert_eq!(study.diagnosis.effects, ["bend"]);
    let se = study.diagnosis.candidates["bend"].se.unwrap();
    let after = study.after.unwrap();
    assert!((after.effects["bend"] - 2.0).abs() < 4.0 * se, "{se}");
    assert!(begun.len() > 10, "{begun:?}");
    assert!(begun.values().all(|times| *times == 1), "{begun:?}");
    let left_out = study.diagnosis.warnings.iter();
    let told = left_out.filter(|w| w.contains("left out of its mean"));
    assert_eq!(told.count(), begun.len());
    assert!(study.left_out_conditions.is_empty());
}

/// "bend" diverges beyond half of what was planted. Its sensitivity of below still explains the data, and the problem says
/// that it was not run there; an effect that was run is not in that list. No run has shown that it explains the data, so that it
/// is a suspect and no more.
#[test]
fn an_effect_that_diverges_where_it_would_explain_the_data_is_marked() {
    let mut plan = plan(1);
    plan.effects[0].probe = 0.5;
    let (found, _) = study(&plan, |r| r.effect("bend") > 1.0);
    let found = found.unwrap();
    assert_eq!(found.problem.not_run, ["bend"]);
    let summary = found.diagnosis.summary();
    assert_eq!(found.diagnosis.verdict, Verdict::Unknown, "{summary}");
    assert_eq!(found.diagnosis.suspects, ["bend"], "{summary}");
    let (whole, _) = study(&plan, |_| false);
    assert!(whole.unwrap().problem.not_run.is_empty());
}
/// The toy, of which runs with the effect "tilt", and some others, show no shape.
fn shapeless(request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
    let mut outcome = toy(request)?;
    if request.effect("tilt") != 0.0 || request.seed.is_multiple_of(11) {
        outcome.observables.remove("shape");
    }
    Ok(outcome)
}

/// A run that lacks an observable counts as failed: it leaves its mean, an effect whose runs all lack it is left out with the
/// reason, and the study names the planted effect.
#[test]
fn a_run_without_an_observable_costs_itself() {
    let plan = plan(1);
    let data = observed(&plan, [2.0, 0.0], 1);
    let study = studied(&By(shapeless), &data);
    assert_eq!(study.diagnosis.effects, ["bend"]);
    assert!(
        study.left_out["tilt"].contains("'shape'"),
        "{:?}",
        study.left_out
    );
    let warnings = study.diagnosis.warnings.join("; ");
    assert!(
        warnings.contains("gave no observable 'shape'"),
        "{warnings}"
    );
}

/// Where all runs of a used and of a kept condition diverge, the study is that of the others, with the reason.
#[test]
fn a_condition_that_cannot_be_run_is_left_out_of_the_study() {
    let plan = plan(1);
    let gone = |rpm: f64, fill: f64| fill == 0.2 && (rpm == 5.0 || rpm == 20.0);
    // One replicate of another condition fails as well: it is not begun again when the study begins again.
    let one = plan.base.seed + 2;
    let (study, begun) = study(&plan, |r| {
        let (rpm, fill) = (r.condition["rpm"], r.condition["fill"]);
        gone(rpm, fill) || (rpm == 30.0 && fill == 0.3 && r.seed == one)
    });
    let study = study.unwrap();
    assert_eq!(study.diagnosis.effects, ["bend"]);
    assert_eq!(study.plan.conditions.len(), plan.conditions.len() - 2);
    let names: Vec<&String> = study.left_out_conditions.keys().collect();
    assert_eq!(names, ["toy fill=0.2 rpm=20", "toy fill=0.2 rpm=5"]);
    let warnings = study.diagnosis.warnings.join("; ");
    assert!(
        warnings.contains("0 of 4 runs of toy fill=0.2 rpm=5 gave a result"),
        "{warnings}"
    );
    assert!(begun.values().all(|times| *times == 1), "{begun:?}");
}

/// What cannot be borne is an error that names the condition and the reason, not a study of nothing.
#[test]
fn a_study_without_any_condition_is_an_error() {
    let (study, _) = study(&plan(1), |_| true);
    let error = study.unwrap_err().to_string();
    assert!(
        error.contains("a mean needs two") && error.contains("body 3 has run away"),
        "{error}"
    );
}

/// The study of the toy with "bend" hidden and a further observable, "bench", that is measured at one condition alone, in a scene of
/// its own.
fn with_bench() -> ResidualPlan {
    let mut plan = observed(&plan(1), [2.0, 0.0], 1);
    plan.observables.push("bench".into());
    let own = BTreeMap::from(["angle", "shape"].map(|name| (name.to_owned(), name.to_owned())));
    let zeros = vec![vec![0.0; 3]; 3];
    for c in &mut plan.conditions {
        c.observables = Some(own.clone());
        c.values.push(None);
        c.covariance.iter_mut().for_each(|row| row.push(0.0));
        c.covariance.push(zeros[0].clone());
    }
    let mut covariance = zeros;
    covariance[2][2] = 0.01;
    plan.conditions.push(StudyCondition {
        model: Some("bench".into()),
        condition: BTreeMap::from([("rpm".to_owned(), 10.0), ("fill".to_owned(), 0.3)]),
        observables: Some(BTreeMap::from([("bench".to_owned(), "angle".to_owned())])),
        parameters: None,
        used: true,
        values: vec![None, None, Some(1.0)],
        covariance,
        ..StudyCondition::default()
    });
    plan
}

/// All runs of "bench" fail: it is left out with its observable, and the planted effect is found by the others. Left behind without a
/// run, the observable would have no degrees of freedom.
#[test]
fn a_condition_that_always_fails_takes_its_own_observable_with_it() {
    let plan = with_bench();
    let simulator = Diverging {
        rule: |r: &RunRequest| r.model == "bench",
        begun: Mutex::default(),
    };
    let study = studied(&simulator, &plan);
    assert_eq!(
        study.diagnosis.verdict,
        Verdict::Named,
        "{}",
        study.diagnosis.summary()
    );
    assert_eq!(study.diagnosis.effects, ["bend"]);
    assert_eq!(study.plan.observables, ["angle", "shape"]);
    assert!(study.noise_dof > 0.0);
    assert!(
        study.left_out_conditions.contains_key("bench"),
        "{:?}",
        study.left_out_conditions
    );
}

/// Runs of "bench" differ by rounding, and no effect moves it, so that few pairs of them tell their scatter, with 6 degrees of freedom.
/// Since the measurement makes all of the variance of its residual, these limit no test, and
/// the planted effect is found.
#[test]
fn a_bench_test_that_repeats_itself_limits_no_test() {
    fn rounding(request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        if request.model != "bench" {
            return toy(request);
        }
        let angle = Observation::of_one(1.0 + f64::EPSILON * (request.seed % 2) as f64, "1");
        Ok(RunOutcome::default().with_observable("angle", angle))
    }
    let mut plan = with_bench();
    plan.replicates = 2;
    for effect in &mut plan.effects {
        effect.absent.insert("bench".into(), "it has none".into());
    }
    let study = studied(&By(rounding), &plan);
    let told = study.diagnosis.summary();
    assert_eq!(study.diagnosis.verdict, Verdict::Named, "{told}");
    assert_eq!(study.diagnosis.effects, ["bend"]);
    assert!(
        study.left_out_conditions.is_empty(),
        "{:?}",
        study.left_out_conditions
    );
    let dof = study.problem.covariance_dof.unwrap();
    assert!(dof > 10.0, "{dof}");
}
