//! A whole study of a drum with a closed form, for the tests: three parameters, known truth, records with a series and,
//! in a few of them, a frame.

use crate::test_input::{Example, measured};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use campaign::run_store::{Lookup, Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use dev_support::fixture_files::fixture;
use inference::{CalibrationProblem, LoopSettings, Model, Parameter, Role, calibrate};
use probability::random_stream::Stream;
use scene::FillingLibrary;
use serde_json::json;
use std::collections::BTreeMap;

/// Truth of the parameters.
const TRUTH: [f64; 3] = [0.32, 0.41, 1.6];
/// A name that would run if it were taken for markup.
pub(crate) const HOSTILE: &str = "sliding </script><script>alert(1)</script><!-- & \"friction\"";

/// Angle (deg) and toe height (mm) of the drum.
fn drum([f, e, g]: [f64; 3], rpm: f64) -> [f64; 2] {
    [
        20.0 + 24.0 * f + 11.0 * e - 9.0 * f * f + 6.0 * f * e - 0.8 * g + 0.1 * (rpm - 15.0),
        3.0 + 4.0 * f - 2.0 * e + 1.4 * g + 0.5 * g * e,
    ]
}

/// Drum and sled in closed form, with scatter.
struct Laboratory;

impl Simulator for Laboratory {
    fn version(&self) -> String {
        "closed form".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let f = request.parameter("F")?;
        let mut stream = Stream::new(request.seed, &format!("{request}"));
        let mut seen = |mean: f64, sd: f64, unit: &str| Observation {
            mean: mean + sd * stream.normal(),
            sd: None,
            n: 1,
            unit: unit.into(),
        };
        if request.model == "sled" {
            return Ok(RunOutcome::default()
                .with_observable("shown_static_friction", seen(0.9 * f + 0.02, 0.004, "1")));
        }
        let at = [f, request.parameter("E")?, request.parameter("G")?];
        let rpm = if request.model == "drum-15" {
            15.0
        } else {
            30.0
        };
        let [angle, toe] = drum(at, rpm);
        let angle = seen(angle, 0.25, "deg");
        let outcome = RunOutcome {
            details: details(angle.mean, request.seed.is_multiple_of(4)),
            ..RunOutcome::default()
        };
        Ok(outcome
            .with_observable("angle_deg", angle)
            .with_observable("toe_height_mm", seen(toe, 0.05, "mm")))
    }
}

/// What a run keeps: how the bed rose, and the last frame in some runs.
fn details(angle: f64, with_frame: bool) -> serde_json::Value {
    let times: Vec<f64> = (0..21).map(|k| 0.1 * f64::from(k)).collect();
    let rise = |t: &f64| angle * (1.0 - (-4.0 * t).exp());
    let mut details = json!({
        "start_up_s": 0.9,
        "frames": { "times_s": [1.2, 1.6, 2.0] },
        "series": {
            "time_s": times,
            "centre_of_mass_deg": times.iter().map(rise).collect::<Vec<f64>>(),
        },
    });
    if with_frame {
        details["last_bodies"] = crate::test_scene::bodies();
        details["last_frame_png_base64"] = STANDARD.encode(crate::test_scene::frame()).into();
    }
    details
}

/// The problem to be solved.
fn problem() -> CalibrationProblem {
    let parameter = |symbol: &str, name: &str, unit: &str, range: [f64; 2], start| Parameter {
        symbol: symbol.into(),
        name: name.into(),
        unit: unit.into(),
        sets: vec![format!("contact.{symbol}")],
        range,
        limits: [0.0, 2.0 * range[1]],
        start,
        prior: None,
        is_input: false,
    };
    let model = |name: &str, scene: &str, speed: &str, parameters: &[usize]| Model {
        name: name.into(),
        scene: scene.into(),
        condition: if speed.is_empty() {
            BTreeMap::new()
        } else {
            BTreeMap::from([("apparatus.speed".into(), speed.into())])
        },
        parameters: parameters.to_vec(),
    };
    let [slow, fast] = [drum(TRUTH, 15.0), drum(TRUTH, 30.0)];
    CalibrationProblem {
        id: "closed form".into(),
        parameters: vec![
            parameter("F", HOSTILE, "1", [0.1, 0.6], 0.2),
            parameter("E", "rolling friction", "1", [0.1, 0.6], 0.2),
            parameter("G", "gap", "mm", [1.0, 2.0], 1.2),
        ],
        models: vec![
            model("sled", "sled", "", &[0]),
            model("drum-15", "drum", "15 rpm", &[0, 1, 2]),
            model("drum-30", "drum", "30 rpm", &[0, 1, 2]),
        ],
        measurements: vec![
            measured(
                0,
                "shown_static_friction",
                Role::Fit,
                0.9 * TRUTH[0] + 0.02,
                0.01,
            ),
            measured(1, "angle_deg", Role::Fit, slow[0], 0.5),
            measured(1, "toe_height_mm", Role::Fit, slow[1], 0.1),
            measured(2, "angle_deg", Role::Check, fast[0], 0.5),
        ],
        correlations: Vec::new(),
        effects: Vec::new(),
        candidates: Vec::new(),
        coarse_graining: None,
    }
}

/// The study, calibrated.
pub(crate) fn study() -> Example {
    let problem = problem();
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 1, &Silent);
    let settings = LoopSettings::default();
    let calibration = calibrate(&campaign, &Laboratory, &problem, &settings, &|_| {}).unwrap();
    let comparisons = calibration.fit.iter().chain(&calibration.check);
    let keys = comparisons.flat_map(|c| &c.keys);
    let keys = keys.chain(calibration.surfaces.iter().flat_map(|s| &s.keys));
    let records = keys.filter_map(|key| match store.get(key).unwrap() {
        Lookup::Found(record) => Some((key.clone(), record)),
        _ => None,
    });
    let drum = crate::test_scene::drum(&fixture("stl"));
    Example {
        name: "closed form".into(),
        inputs: BTreeMap::from([("study.toml".into(), "ab12".into())]),
        compare: Vec::new(),
        defaults: Vec::new(),
        scenes: ["drum-15", "drum-30"]
            .map(|name| (name.to_owned(), drum.clone()))
            .into(),
        fillings: FillingLibrary::default(),
        records: records.collect(),
        curves: Vec::new(),
        problem,
        calibration,
    }
}
