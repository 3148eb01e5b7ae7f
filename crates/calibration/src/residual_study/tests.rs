use super::fits::sets_to_add;
use super::linearisation::Linearisation;
use super::runs::{At, Setting, means};
use super::worker::Worker;
use super::{
    DeclaredParameter, EffectProbe, Observed, ResidualPlan, StudyCondition, study_residual,
};
use crate::Laboratory;
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use random_stream::Stream;
use residual_diagnosis::{CovarianceInput, Verdict};
use run_store::{Observation, Store};
use std::collections::BTreeMap;

/// Noise of one run, and of one measurement.
const RUN_SD: f64 = 0.1;
pub(super) const MEASURED_SD: f64 = 0.1;

/// A simulator in closed form: two observables, two parameters, two effects.
pub(super) struct Toy;

pub(super) fn truth(rpm: f64, fill: f64, a: f64, b: f64, effects: [f64; 2]) -> [f64; 2] {
    [
        30.0 + 10.0 * a
            + 0.1 * rpm
            + 2.0 * b * fill
            + effects[0] * 0.004 * rpm * rpm
            + effects[1] * 3.0 * fill,
        1.0 + a * fill + 0.5 * b + effects[0] * fill * fill - effects[1] * 0.05 * rpm,
    ]
}

impl Simulator for Toy {
    fn version(&self) -> String {
        "toy".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let (rpm, fill) = (request.condition("rpm")?, request.condition("fill")?);
        let effects = [request.effect("bend"), request.effect("tilt")];
        if request.effect("no surface") != 0.0 {
            let reason = "no frame shows a surface".to_owned();
            return Err(SimulatorError::Refused { reason });
        }
        let values = truth(
            rpm,
            fill,
            request.parameter("a")?,
            request.parameter("b")?,
            effects,
        );
        Ok(outcome(request, values))
    }
}

/// A run that gives these values with noise. The effect "turn" is that of a camera: it adds to the angle and
/// leaves the noise alone.
fn outcome(request: &RunRequest, [angle, shape]: [f64; 2]) -> RunOutcome {
    let values = [angle + request.effect("turn"), shape];
    let mut motion = request.clone();
    motion.effects.remove("turn");
    let mut stream = Stream::new(motion.seed, &format!("{motion}"));
    let mut outcome = RunOutcome::default();
    for (name, value) in ["angle", "shape"].iter().zip(values) {
        let mean = value + RUN_SD * stream.normal();
        let result = Observation {
            mean,
            sd: None,
            n: 1,
            unit: "1".into(),
        };
        outcome = outcome.with_observable(name, result);
    }
    outcome
}

pub(super) fn plan(seed: u64) -> ResidualPlan {
    let mut conditions = Vec::new();
    for rpm in [5.0, 10.0, 20.0, 30.0] {
        for fill in [0.2, 0.3, 0.4] {
            conditions.push(StudyCondition {
                model: None,
                observables: None,
                condition: BTreeMap::from([("rpm".to_owned(), rpm), ("fill".to_owned(), fill)]),
                used: rpm != 20.0,
            });
        }
    }
    let declared = |name: &str| DeclaredParameter {
        name: name.into(),
        start: 0.5,
        step: 0.3,
        bounds: [0.0, 2.0],
        prior: None,
    };
    let effect = |name: &str| EffectProbe {
        name: name.into(),
        probe: 2.0,
        range: [0.0, 5.0],
        absent: BTreeMap::new(),
    };
    ResidualPlan {
        id: "toy".into(),
        base: RunRequest::new("toy", 100 + seed),
        conditions,
        observables: vec!["angle".into(), "shape".into()],
        declared: vec![declared("a"), declared("b")],
        effects: vec![effect("bend"), effect("tilt")],
        replicates: 4,
        seed,
        candidates: Vec::new(),
    }
}

pub(super) fn observed(plan: &ResidualPlan, effects: [f64; 2], seed: u64) -> Observed {
    measured(plan, seed, |rpm, fill| truth(rpm, fill, 0.7, 0.4, effects))
}

pub(super) fn measured(
    plan: &ResidualPlan,
    seed: u64,
    truth: impl Fn(f64, f64) -> [f64; 2],
) -> Observed {
    let mut stream = Stream::new(seed, "measured");
    let values = plan.conditions.iter().map(|c| {
        let values = truth(c.condition["rpm"], c.condition["fill"]);
        values
            .iter()
            .map(|v| Some(v + MEASURED_SD * stream.normal()))
            .collect()
    });
    let square = MEASURED_SD * MEASURED_SD;
    Observed {
        values: values.collect(),
        covariance: vec![vec![vec![square, 0.0], vec![0.0, square]]; plan.conditions.len()],
    }
}

/// The planted effect is named, its amplitude comes back within four standard errors of the
/// linear estimate, and the error on the kept conditions falls to the noise: a whitened mean
/// square of 6 rows lies below 3 with a chance of 0.995.
#[test]
fn a_planted_effect_is_named_and_the_kept_error_falls() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(1);
    let study = study_residual(&campaign, &Toy, &plan, &observed(&plan, [2.0, 0.0], 1)).unwrap();
    assert_eq!(
        study.diagnosis.verdict,
        Verdict::Named,
        "{}",
        study.diagnosis.summary()
    );
    assert_eq!(study.diagnosis.effects, ["bend"]);
    let after = study.after.unwrap();
    let se = study.diagnosis.candidates["bend"].se.unwrap();
    assert!(
        (after.effects["bend"] - 2.0).abs() < 4.0 * se,
        "{:?} se {se}",
        after.effects
    );
    let kept = after.errors.kept.unwrap().whitened_mse;
    let before = study.errors_before.kept.unwrap().whitened_mse;
    assert!(
        kept < 3.0 && kept < before / 2.0,
        "before {before}, after {kept}"
    );
}

/// Without a planted effect nothing is named; the seed is fixed, and a right rule errs in 5 %.
#[test]
fn nothing_is_named_where_nothing_is_hidden() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(2);
    let study = study_residual(&campaign, &Toy, &plan, &observed(&plan, [0.0, 0.0], 2)).unwrap();
    assert_eq!(
        study.diagnosis.verdict,
        Verdict::None,
        "{}",
        study.diagnosis.summary()
    );
    assert!(study.after.is_none(), "an effect was added");
    for (name, expected) in [("a", 0.7), ("b", 0.4)] {
        assert!(
            (study.fitted[name] - expected).abs() < 0.3,
            "{name} {:?}",
            study.fitted
        );
    }
}

/// Of 2000 campaigns in which nothing is hidden, each fitted, linearised and diagnosed from its own runs, no more than
/// 5 % report that something is missing: 100, and three standard errors of 10 more at most. Also prints the rate.
#[test]
#[ignore = "minutes; `just null-campaigns`"]
fn few_campaigns_without_a_hidden_effect_report_one() {
    let campaigns = 2000;
    let mut reported = 0;
    for seed in 0..campaigns {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let campaign = Campaign::new(&store, 2, &Silent);
        let plan = plan(1000 + seed);
        let observed = observed(&plan, [0.0, 0.0], seed);
        let study = study_residual(&campaign, &Toy, &plan, &observed).unwrap();
        reported += usize::from(study.diagnosis.verdict != Verdict::None);
    }
    println!("{reported} of {campaigns} campaigns report something missing");
    assert!(reported <= 130, "{reported}");
}

#[test]
fn one_replicate_is_refused_because_it_gives_no_noise() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 1, &Silent);
    let plan = ResidualPlan {
        replicates: 1,
        ..plan(3)
    };
    let error = study_residual(&campaign, &Toy, &plan, &observed(&plan, [0.0; 2], 3)).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("replicates: 1 given, two or more needed"),
        "{error}"
    );
}

/// A probe that cannot be run costs its own effect only: the others are diagnosed as without it, bit
/// for bit, and the reason is kept.
#[test]
fn an_effect_that_cannot_be_run_is_left_out_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(1);
    let mut more = plan.clone();
    more.effects.insert(
        0,
        EffectProbe {
            name: "no surface".into(),
            probe: 1.0,
            range: [0.0, 1.0],
            absent: BTreeMap::new(),
        },
    );
    let data = observed(&plan, [2.0, 0.0], 1);
    let with = study_residual(&campaign, &Toy, &more, &data).unwrap();
    let without = study_residual(&campaign, &Toy, &plan, &data).unwrap();
    assert!(with.left_out["no surface"].contains("no frame shows a surface"));
    assert!(without.left_out.is_empty());
    assert_eq!(with.diagnosis, without.diagnosis);
}

/// An effect that leaves the motion alone has an exact sensitivity, and its runs say nothing new of the noise;
/// another has a noise of its own.
#[test]
fn an_effect_of_the_camera_shares_the_noise_of_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(5);
    let mut more = plan.clone();
    more.effects.push(EffectProbe {
        name: "turn".into(),
        probe: 2.0,
        range: [-5.0, 5.0],
        absent: BTreeMap::new(),
    });
    let data = observed(&plan, [2.0, 0.0], 5);
    let without = study_residual(&campaign, &Toy, &plan, &data).unwrap();
    let with = study_residual(&campaign, &Toy, &more, &data).unwrap();
    assert_eq!(
        with.diagnosis.effects,
        ["bend"],
        "{}",
        with.diagnosis.summary()
    );
    assert_eq!(with.noise_dof, without.noise_dof);
    let CovarianceInput::Blocks(turn) = &with.problem.cov_sensitivities_library[2] else {
        panic!("{:?}", with.problem.cov_sensitivities_library);
    };
    let CovarianceInput::Blocks(bend) = &with.problem.cov_sensitivities_library[0] else {
        panic!("{:?}", with.problem.cov_sensitivities_library);
    };
    for (turn, bend) in turn.iter().zip(bend) {
        assert!(turn[0][0] < 1e-12 && bend[0][0] > 1e-6, "{turn:?} {bend:?}");
    }
    // Rounding of the mean of four values about 30.
    let slopes = with.problem.sensitivities_library.iter().step_by(2);
    assert!(slopes.clone().all(|row| (row[2] - 1.0).abs() < 1e-12));
}

/// A laboratory gives the truth with the noise that it states: variance of a mean of four runs plus that of
/// reading. Pooled over 12 conditions that is 36 degrees of freedom, so a variance of runs is right within
/// four times its standard error, sqrt(2/36); a mean within five standard errors.
#[test]
fn a_laboratory_states_its_own_noise() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(6);
    let laboratory = Laboratory {
        parameters: BTreeMap::from([("a".to_owned(), 0.7), ("b".to_owned(), 0.4)]),
        effects: BTreeMap::from([("tilt".to_owned(), 1.5)]),
        runs: 4,
        reading_sd: &[0.2, 0.0],
        first_seed: 5000,
        reading: Stream::new(6, "reading"),
    };
    let data = laboratory.measure(&campaign, &Toy, &plan).unwrap();
    let of_runs = RUN_SD * RUN_SD / 4.0;
    for (k, reading) in [0.04, 0.0].into_iter().enumerate() {
        let stated = data.covariance[0][k][k] - reading;
        assert!(
            (stated / of_runs - 1.0).abs() < 4.0 * (2.0_f64 / 36.0).sqrt(),
            "{stated}"
        );
        for (row, c) in data.values.iter().zip(&plan.conditions) {
            let true_values = truth(
                c.condition["rpm"],
                c.condition["fill"],
                0.7,
                0.4,
                [0.0, 1.5],
            );
            let off = row[k].unwrap() - true_values[k];
            assert!(off.abs() < 5.0 * (of_runs + reading).sqrt(), "{off}");
        }
    }
}

/// Values that were not measured carry nothing: with the second observable missing everywhere the
/// study is that of the first alone.
#[test]
fn a_value_that_was_not_measured_has_no_weight() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let both = plan(1);
    let mut data = observed(&both, [2.0, 0.0], 1);
    let one = ResidualPlan {
        observables: vec!["angle".into()],
        ..both.clone()
    };
    let mut alone = data.clone();
    for (row, block) in alone.values.iter_mut().zip(&mut alone.covariance) {
        row.truncate(1);
        *block = vec![vec![block[0][0]]];
    }
    for row in &mut data.values {
        row[1] = None;
    }
    let missing = study_residual(&campaign, &Toy, &both, &data).unwrap();
    let alone = study_residual(&campaign, &Toy, &one, &alone).unwrap();
    let t0 = |s: &super::ResidualStudy| s.diagnosis.structured_residual.t0.unwrap();
    assert!(
        (t0(&missing) - t0(&alone)).abs() < 1e-9 * t0(&alone),
        "rounding"
    );
    assert_eq!(missing.fitted, alone.fitted);
    assert_eq!(missing.errors_before.used.rmse.len(), 1);
}

/// A simulator by a formula of speed, fill, both parameters and both effects.
struct Formula {
    name: &'static str,
    values: fn(f64, f64, f64, f64, [f64; 2]) -> [f64; 2],
}

impl Simulator for Formula {
    fn version(&self) -> String {
        self.name.into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let (rpm, fill) = (request.condition("rpm")?, request.condition("fill")?);
        let (a, b) = (request.parameter("a")?, request.parameter("b")?);
        let effects = [request.effect("bend"), request.effect("tilt")];
        Ok(outcome(request, (self.values)(rpm, fill, a, b, effects)))
    }
}

/// A simulator in which the angle grows with the amplitude of "bend", but the shape hardly any more beyond 0.5: its
/// pattern over the observables is quite another at 0.5 than at the probe of 2.
fn saturating(rpm: f64, fill: f64, a: f64, b: f64, effects: [f64; 2]) -> [f64; 2] {
    let [bend, tilt] = effects;
    let [angle, shape] = truth(rpm, fill, a, b, [0.0, tilt]);
    let saturated = 20.0 * (1.0 - (-bend / 0.3).exp());
    [
        angle + 0.004 * rpm * rpm * bend,
        shape + saturated * fill * fill,
    ]
}

const SATURATING: Formula = Formula {
    name: "saturating",
    values: saturating,
};

/// "bend" at its own amplitude is all that is missing. By its slope at the probe more than noise remains, and all three
/// answers are "unknown". The amplitude comes back within four standard errors.
#[test]
fn an_effect_that_saturates_is_judged_at_its_own_fit() {
    for seed in 1..=3 {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let campaign = Campaign::new(&store, 2, &Silent);
        let plan = plan(seed);
        let truth = |rpm, fill| saturating(rpm, fill, 0.7, 0.4, [0.5, 0.0]);
        let data = measured(&plan, seed, truth);
        let study = study_residual(&campaign, &SATURATING, &plan, &data).unwrap();
        let diagnosis = &study.diagnosis;
        assert_eq!(
            diagnosis.verdict,
            Verdict::Named,
            "seed {seed}: {}",
            diagnosis.summary()
        );
        assert_eq!(diagnosis.effects, ["bend"]);
        let se = diagnosis.candidates["bend"].se.unwrap();
        let found = study.after.unwrap().effects["bend"];
        assert!((found - 0.5).abs() < 4.0 * se, "{found} se {se}");
    }
}

/// A simulator in which "bend" lifts the angle less and less and the shape more and more: from the probe on one straight line
/// after another ends short of its truth.
fn bent(rpm: f64, fill: f64, a: f64, b: f64, effects: [f64; 2]) -> [f64; 2] {
    let [bend, tilt] = effects;
    let [angle, shape] = truth(rpm, fill, a, b, [0.0, tilt]);
    let (slowing, growing) = (1.0 - (-bend).exp(), (bend / 2.0).powi(3));
    [
        angle + 0.008 * rpm * rpm * slowing,
        shape + growing * fill * fill,
    ]
}

const BENT: Formula = Formula {
    name: "bent",
    values: bent,
};

/// By straight lines the answers are "unknown" or "partial", with amplitudes of 2.6 to 2.8. The search by real runs ends at
/// the truth of 4.5, within four standard errors, and the effect is named.
#[test]
fn a_bent_effect_is_searched_where_the_data_pull_it() {
    for seed in 1..=4 {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let campaign = Campaign::new(&store, 2, &Silent);
        let plan = plan(seed);
        let truth = |rpm, fill| bent(rpm, fill, 0.7, 0.4, [4.5, 0.0]);
        let data = measured(&plan, seed, truth);
        let study = study_residual(&campaign, &BENT, &plan, &data).unwrap();
        let diagnosis = &study.diagnosis;
        let summary = diagnosis.summary();
        assert_eq!(diagnosis.verdict, Verdict::Named, "seed {seed}: {summary}");
        assert_eq!(diagnosis.effects, ["bend"]);
        let bend = &diagnosis.candidates["bend"];
        let (found, se) = (bend.amplitude.unwrap(), bend.se.unwrap());
        assert!(
            (found - 4.5).abs() < 4.0 * se,
            "seed {seed}: {found} se {se}"
        );
    }
}

/// The bent simulator, which breaks beyond 3 of "bend".
struct Brittle;

impl Simulator for Brittle {
    fn version(&self) -> String {
        "brittle".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        if request.effect("bend") > 3.0 {
            let reason = "the bed breaks".to_owned();
            return Err(SimulatorError::Refused { reason });
        }
        BENT.run(request)
    }
}

/// A search that meets an amplitude that cannot be run ends there, and the answer says so.
#[test]
fn a_search_that_cannot_go_on_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(1);
    let data = measured(&plan, 1, |rpm, fill| bent(rpm, fill, 0.7, 0.4, [4.5, 0.0]));
    let study = study_residual(&campaign, &Brittle, &plan, &data).unwrap();
    assert_ne!(study.diagnosis.verdict, Verdict::Named);
    let said = study.diagnosis.warnings.join("; ");
    assert!(
        said.contains("the search for the amplitude of bend ends at")
            && said.contains("the bed breaks"),
        "{said}"
    );
}

/// The toy is linear, so the secant of "bend" is its slope wherever it ends, once what the parameters do on the way
/// is taken off: 0.6 in a moves the angle by 6. Standard deviation by hand: means of four runs 0.05 each, over the
/// amplitude 2; slopes of the parameters 0.24, times 0.6 / 2 and 0.3 / 2: 0.09 together. The bound is five times
/// that, a fifteenth of the error with the wrong sign.
#[test]
fn a_secant_to_another_point_leaves_out_what_the_parameters_do() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(7);
    let (linear, _) = Linearisation::run(&Worker::new(&campaign, &Toy), &plan).unwrap();
    let fit = Setting::declared(&plan, &[0.5, 0.5]);
    let mut on = Setting::declared(&plan, &[1.1, 0.2]);
    on.effects.insert("bend".into(), 2.0);
    let run = |setting: &Setting, block| {
        means(
            &Worker::new(&campaign, &Toy),
            &plan,
            setting,
            block,
            At::Used,
        )
        .unwrap()
    };
    let (at_fit, at_on) = (run(&fit, 1), run(&on, 6));
    let linear = linear.with_secant(&plan, 0, (&fit, &at_fit), (&on, &at_on));
    for (c, slopes) in plan.conditions.iter().zip(&linear.library) {
        let (rpm, fill) = (c.condition["rpm"], c.condition["fill"]);
        for (slopes, expected) in slopes.iter().zip([0.004 * rpm * rpm, fill * fill]) {
            assert!((slopes[0] - expected).abs() < 0.45, "{c:?}: {slopes:?}");
        }
    }
}

/// Two effects that do the same, "bend" and "bow"; the second cannot be run at 25 rpm.
struct Twins;

impl Simulator for Twins {
    fn version(&self) -> String {
        "twins".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        if request.condition("rpm")? == 25.0 && request.effect("bow") != 0.0 {
            let reason = "the bow breaks at 25 rpm".to_owned();
            return Err(SimulatorError::Refused { reason });
        }
        let mut one = request.clone();
        let both = request.effect("bend") + request.effect("bow");
        one.effects.insert("bend".into(), both);
        Toy.run(&one)
    }
}

/// The plan with both twins in the library.
pub(super) fn plan_of_twins() -> ResidualPlan {
    let mut plan = plan(1);
    let bow = EffectProbe {
        name: "bow".into(),
        ..plan.effects[0].clone()
    };
    plan.effects.push(bow);
    plan
}

/// Twins tie, and each is added in turn: with either the amplitude comes back within four standard errors, and the
/// error on the kept conditions falls to the noise, as for a lone effect above.
#[test]
fn tied_effects_are_added_in_turn() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan_of_twins();
    let data = observed(&plan, [2.0, 0.0], 1);
    let study = study_residual(&campaign, &Twins, &plan, &data).unwrap();
    let diagnosis = &study.diagnosis;
    assert_eq!(diagnosis.verdict, Verdict::Tie, "{}", diagnosis.summary());
    assert_eq!(diagnosis.effects, ["bend", "bow"]);
    assert!(study.after.is_none());
    let before = study.errors_before.kept.unwrap().whitened_mse;
    assert_eq!(study.rivals.len(), 2);
    for name in ["bend", "bow"] {
        let model = study.rivals.iter().find(|m| m.effects.contains_key(name));
        let model = model.unwrap();
        assert_eq!(model.effects.len(), 1, "{:?}", model.effects);
        let se = diagnosis.candidates[name].se.unwrap();
        assert!((model.effects[name] - 2.0).abs() < 4.0 * se, "{name}");
        let kept = model.errors.kept.as_ref().unwrap().whitened_mse;
        assert!(kept < 3.0 && kept < before / 2.0, "{before} -> {kept}");
    }
    assert!(
        diagnosis.summary().contains("falls by real runs"),
        "{}",
        diagnosis.summary()
    );
}

/// A tied effect whose model cannot be run at a kept condition costs itself, not the study. (In one campaign of 25 the noise of
/// the slopes tells twins apart; these data are none of those.)
#[test]
fn a_tied_effect_that_cannot_be_run_is_told_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let mut plan = plan_of_twins();
    for condition in plan.conditions.iter_mut().filter(|c| !c.used) {
        condition.condition.insert("rpm".into(), 25.0);
    }
    let data = observed(&plan, [2.0, 0.0], 2);
    let study = study_residual(&campaign, &Twins, &plan, &data).unwrap();
    assert_eq!(study.diagnosis.verdict, Verdict::Tie);
    assert_eq!(study.rivals.len(), 1);
    assert!(study.rivals[0].effects.contains_key("bend"));
    let said = study.diagnosis.warnings.join(" ");
    assert!(
        said.contains("the model with bow could not be run") && said.contains("breaks at 25 rpm"),
        "{said}"
    );
}

/// A simulator in which "bend" does more where the parameter "a" is larger, so that no straight line from the fit
/// without it ends at the right point.
fn interacting(rpm: f64, fill: f64, a: f64, b: f64, effects: [f64; 2]) -> [f64; 2] {
    let [bend, tilt] = effects;
    truth(rpm, fill, a, b, [bend * (2.0 * (a - 0.5)).exp(), tilt])
}

const INTERACTING: Formula = Formula {
    name: "interacting",
    values: interacting,
};

/// Runs that contradict the slopes correct them: six campaigns of six end at the noise on the used conditions, where a
/// right model stays below 2.16 (18 values) in 399 of 400 cases, and on the kept ones, below 3 (6 values) in 199 of 200.
#[test]
fn slopes_that_runs_contradict_are_corrected() {
    for seed in 1..=6 {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let campaign = Campaign::new(&store, 2, &Silent);
        let plan = plan(seed);
        let truth = |rpm, fill| interacting(rpm, fill, 0.7, 0.4, [3.0, 0.0]);
        let data = measured(&plan, seed, truth);
        let study = study_residual(&campaign, &INTERACTING, &plan, &data).unwrap();
        let summary = study.diagnosis.summary();
        assert_eq!(study.diagnosis.effects, ["bend"], "seed {seed}: {summary}");
        let errors = study.after.unwrap().errors;
        let (used, kept) = (errors.used.whitened_mse, errors.kept.unwrap().whitened_mse);
        assert!(used < 2.16 && kept < 3.0, "seed {seed}: {used} {kept}");
    }
}

/// Between two points of a linear simulator only noise speaks against the slopes, in 1 of 40 cases by more than the
/// limit (the seed is fixed); where "bend" depends on "a", the corrected slopes go through both points.
#[test]
fn slopes_are_corrected_only_where_runs_contradict_them() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(8);
    let data = observed(&plan, [0.0; 2], 8);
    let mut from = Setting::declared(&plan, &[0.5, 0.5]);
    from.effects.insert("bend".into(), 0.5);
    let mut to = Setting::declared(&plan, &[0.9, 0.4]);
    to.effects.insert("bend".into(), 2.0);
    let corrected = |simulator: &dyn Simulator| {
        let (linear, _) = Linearisation::run(&Worker::new(&campaign, simulator), &plan).unwrap();
        let run = |setting: &Setting, block| {
            means(
                &Worker::new(&campaign, simulator),
                &plan,
                setting,
                block,
                At::Used,
            )
            .unwrap()
        };
        let (at_from, at_to) = (run(&from, 1), run(&to, 2));
        let effects = ["bend".to_owned()];
        let points = ((&from, &at_from), (&to, &at_to));
        let corrected = linear.contradicted(&plan, &data, &effects, points.0, points.1);
        (corrected.unwrap(), at_from, at_to)
    };
    assert!(corrected(&Toy).0.is_none(), "noise alone");
    let (linear, at_from, at_to) = corrected(&INTERACTING);
    let linear = linear.expect("a contradiction");
    for (c, condition) in plan.conditions.iter().enumerate().filter(|(_, c)| c.used) {
        for k in 0..2 {
            let slopes = &linear.declared[c][k];
            let predicted = slopes[0] * 0.4 - slopes[1] * 0.1 + linear.library[c][k][0] * 1.5;
            let moved = at_to.values[c][k] - at_from.values[c][k];
            assert!((predicted - moved).abs() < 1e-9, "{condition:?} {k}");
        }
    }
}

/// An observable without any scatter of the runs, such as a count, is no reason to stop.
#[test]
fn an_observable_that_does_not_scatter_can_be_fitted() {
    struct Counting;
    impl Simulator for Counting {
        fn version(&self) -> String {
            "counting".into()
        }

        fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
            let mut outcome = Toy.run(request)?;
            if let Some(shape) = outcome.observables.get_mut("shape") {
                shape.mean = 3.0;
            }
            Ok(outcome)
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(9);
    let data = measured(&plan, 9, |rpm, fill| {
        [truth(rpm, fill, 0.7, 0.4, [2.0, 0.0])[0], 3.0]
    });
    study_residual(&campaign, &Counting, &plan, &data).unwrap();
}

/// The first of each group is the effect that was taken: all of them together come first, then the next best of each
/// group in its place, three models at most, and never an effect twice in one.
#[test]
fn models_to_be_run_begin_with_what_was_taken() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let plan = plan(2);
    let data = observed(&plan, [0.0; 2], 2);
    let mut diagnosis = study_residual(&campaign, &Toy, &plan, &data)
        .unwrap()
        .diagnosis;
    assert!(sets_to_add(&diagnosis).is_empty(), "nothing is named");
    let groups = |groups: &[&[&str]]| -> Vec<Vec<String>> {
        let owned = |group: &&[&str]| group.iter().map(|&name| name.to_owned()).collect();
        groups.iter().map(owned).collect()
    };
    diagnosis.tie_groups = groups(&[&["a", "b", "c", "d"]]);
    assert_eq!(sets_to_add(&diagnosis), groups(&[&["a"], &["b"], &["c"]]));
    diagnosis.tie_groups = groups(&[&["a", "b"], &["d", "a"]]);
    let expected = groups(&[&["a", "d"], &["b", "d"]]);
    assert_eq!(sets_to_add(&diagnosis), expected);
}

/// The drum of [`Toy`] by its angle alone, and a sled that no camera sees; both feel the friction "a".
struct DrumAndSled;

impl Simulator for DrumAndSled {
    fn version(&self) -> String {
        "drum and sled".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        if request.model != "sled" {
            return Toy.run(request);
        }
        if request.effect("turn") != 0.0 {
            let reason = "a sled has no camera".to_owned();
            return Err(SimulatorError::Refused { reason });
        }
        let a = request.parameter("a")?;
        Ok(outcome(request, [20.0 + 10.0 * a, 1.0]))
    }
}

/// Evidence across scenes: a turned camera moves the angle of a drum as friction does, and no re-tuning can tell the two
/// apart in the drum alone. A sled that the camera does not see fixes the friction. There the effect is 0 without
/// noise, and nothing is run with it.
#[test]
fn an_effect_is_zero_in_a_scene_that_cannot_carry_it() {
    let diagnosed = |with_sled: bool| {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let campaign = Campaign::new(&store, 2, &Silent);
        let mut plan = plan(1);
        let mut data = measured(&plan, 1, |rpm, fill| {
            truth(rpm, fill, 0.7, 0.4, [0.0, 0.0]).map(|value| value + 3.0)
        });
        for (condition, values) in plan.conditions.iter_mut().zip(&mut data.values) {
            condition.observables = Some(BTreeMap::from([("angle".into(), "angle".into())]));
            values[1] = None;
        }
        plan.observables = vec!["angle".into(), "slope".into()];
        plan.observables.truncate(if with_sled { 2 } else { 1 });
        plan.declared.truncate(1);
        plan.base.parameters.insert("b".into(), 0.4);
        if with_sled {
            plan.conditions.push(StudyCondition {
                model: Some("sled".into()),
                condition: BTreeMap::new(),
                observables: Some(BTreeMap::from([("slope".into(), "angle".into())])),
                used: true,
            });
            data.values.push(vec![None, Some(27.0)]);
            data.covariance.push(data.covariance[0].clone());
        } else {
            data.values.iter_mut().for_each(|row| row.truncate(1));
            let corner = vec![vec![data.covariance[0][0][0]]];
            data.covariance
                .iter_mut()
                .for_each(|block| block.clone_from(&corner));
        }
        plan.effects = vec![EffectProbe {
            name: "turn".into(),
            probe: 2.0,
            range: [-5.0, 5.0],
            absent: BTreeMap::from([("sled".into(), "it has no camera".into())]),
        }];
        study_residual(&campaign, &DrumAndSled, &plan, &data).unwrap()
    };
    let drum_alone = diagnosed(false).diagnosis;
    assert_eq!(drum_alone.not_testable, ["turn"]);
    let both = diagnosed(true);
    assert_eq!(
        both.diagnosis.effects,
        ["turn"],
        "{}",
        both.diagnosis.summary()
    );
    let amplitude = both.after.as_ref().unwrap().effects["turn"];
    assert!((amplitude - 3.0).abs() < 0.6, "{amplitude}");
    let slopes = both.problem.sensitivities_library.last().unwrap();
    assert_eq!(slopes[0], 0.0);
    let CovarianceInput::Blocks(noise) = &both.problem.cov_sensitivities_library[0] else {
        panic!("{:?}", both.problem.cov_sensitivities_library);
    };
    assert_eq!(noise.last().unwrap()[1][1], 0.0);
}

/// An effect whose probe is so small that its slope is noise cannot be judged by it. It is run at its largest amplitude,
/// where it stands out, and is found.
#[test]
fn a_slope_that_is_noise_is_measured_at_the_largest_amplitude() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 2, &Silent);
    let mut plan = plan(1);
    plan.effects[0].probe = 0.02;
    let study = study_residual(&campaign, &Toy, &plan, &observed(&plan, [2.0, 0.0], 1)).unwrap();
    let diagnosis = &study.diagnosis;
    assert_eq!(diagnosis.effects, ["bend"], "{}", diagnosis.summary());
    let amplitude = study.after.as_ref().unwrap().effects["bend"];
    assert!((amplitude - 2.0).abs() < 0.5, "{amplitude}");
}
