//! A name that conditions kept from the fit give.

use super::toy::{measured, model, parameter, problem};
use campaign::run_store::{Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use inference::diagnosis::Verdict;
use inference::{
    Calibration, CalibrationProblem, Comparison, DiagnosisStage, EffectProbe, LoopSettings,
    Parameter, Prior, ResidualStudy, Role, calibrate,
};
use probability::random_stream::Stream;

/// Seeds that are dropped on three plates: the rebound falls to 0.3 with the restitution put in and not further, unless the whole seed
/// damps. The plate of seeds gives way, the others cannot.
struct Drops;

impl Simulator for Drops {
    fn version(&self) -> String {
        "drops".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let give = request.parameters.get("give").copied();
        let rebound = match (request.model.as_str(), give) {
            ("drop on seeds", give) => {
                0.28 + 0.1 * request.parameter("e")? - 0.5 * give.unwrap_or(0.0)
            }
            (_, None) => 0.30 + 0.2 * request.parameter("e")?,
            (plate, Some(_)) => {
                return Err(SimulatorError::Failed {
                    reason: format!("no plate gives way in {plate}"),
                });
            }
        };
        let mean = rebound * (1.0 - 0.55 * request.effect("damping"));
        let mut stream = Stream::new(request.seed, &format!("noise of {request}"));
        let observation = Observation::of_one(mean + 0.003 * stream.normal(), "1");
        Ok(RunOutcome::default().with_observable("rebound", observation))
    }
}

/// Rebounds on resin and on seeds in the fit, and on glass as the check, which is measured as given; with an input of one scene.
fn drops(on_glass: Option<f64>) -> CalibrationProblem {
    let give = Parameter {
        start: 0.0,
        prior: Some(Prior {
            mean: 0.0,
            sd: 0.002,
        }),
        is_input: true,
        ..parameter("give", [0.0, 0.006])
    };
    let value = |model, role, (mean, se): (f64, f64)| {
        measured(model, "rebound", role, (mean, se * 10.0_f64.sqrt()))
    };
    let mut measurements = vec![
        value(0, Role::Fit, (0.15, 0.015)),
        value(1, Role::Fit, (0.14, 0.015)),
    ];
    measurements.extend(on_glass.map(|mean| value(2, Role::Check, (mean, 0.01))));
    let mut models = vec![
        model("drop on resin", &[0]),
        model("drop on seeds", &[0, 1]),
        model("drop on glass", &[0]),
    ];
    models.truncate(measurements.len());
    let effect = EffectProbe {
        name: "damping".into(),
        probe: 0.5,
        range: [0.0, 1.0],
        ..EffectProbe::default()
    };
    CalibrationProblem {
        effects: vec![effect],
        ..problem(vec![parameter("e", [0.0, 0.5]), give], models, measurements)
    }
}

/// The loop over a problem.
fn calibrated(problem: &CalibrationProblem) -> Calibration {
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 1, &Silent);
    let settings = LoopSettings::default();
    calibrate(&campaign, &Drops, problem, &settings, &|_| {}).expect("all runs give a result")
}

/// What the residual says; `None` if nobody asked.
fn residual(found: &Calibration) -> Option<&ResidualStudy> {
    match &found.diagnosis {
        DiagnosisStage::Done(study) => Some(study),
        DiagnosisStage::LeftOut { .. } => None,
    }
}

/// Two rebounds of half of what any restitution leaves: damping meets both with one amplitude, and an unknown effect does with two. The
/// rebound on a third plate, 0.15 as with damping, though 15 standard errors off without it, tells them apart: damping is
/// named, at (0.3 - 0.15) / 0.3 / 0.55 = 0.91, and with it all three are met, which the loop says and ends well. Without that plate, or
/// if nothing is missing on it, there is no name. In all three both conditions of the fit are used, though the runs on resin
/// would fail if they received the plate of seeds.
#[test]
fn a_kept_condition_that_is_met_gives_the_name() {
    let found = calibrated(&drops(Some(0.15)));
    let named = residual(&found).unwrap();
    let summary = named.diagnosis.summary();
    assert_eq!(named.diagnosis.verdict, Verdict::Named, "{summary}");
    let with = found.with_effects.as_ref().unwrap();
    let amplitude = with.effects["damping"];
    assert!((amplitude - 0.91).abs() < 0.06, "{amplitude}");
    assert!(found.met && with.holds, "{}", found.verdict);
    let misses = |rows: &[Comparison]| rows.iter().filter(|row| !row.holds).count();
    let before: Vec<Comparison> = [&found.fit[..], &found.check[..]].concat();
    assert_eq!((misses(&before), misses(&with.rows)), (3, 0));
    for on_glass in [None, Some(0.30)] {
        let found = calibrated(&drops(on_glass));
        let open = residual(&found).unwrap();
        let summary = open.diagnosis.summary();
        assert_eq!(open.diagnosis.verdict, Verdict::Unknown, "{summary}");
        assert_eq!(open.diagnosis.suspects, ["damping"]);
        let left_out = &open.left_out_conditions;
        assert!(left_out.is_empty(), "{left_out:?}");
        assert!(!found.met && found.with_effects.is_none());
    }
    assert!(named.left_out_conditions.is_empty());
}
