//! The study of a residual that two effects explain alike, for the tests.

use campaign::run_store::{Observation, Store};
use campaign::{Campaign, RunOutcome, RunRequest, Silent, Simulator, SimulatorError};
use inference::{EffectProbe, ResidualPlan, ResidualStudy, StudyCondition, study_residual};
use probability::random_stream::Stream;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// An angle that two effects bend over the speed in the same way.
struct Twins;

impl Simulator for Twins {
    fn version(&self) -> String {
        "twins".into()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let bent = request.effect("bend") + request.effect("bow");
        let mut stream = Stream::new(request.seed, &format!("{request}"));
        let angle = Observation::of_one(
            30.0 + bent * request.condition("rpm")? + 0.1 * stream.normal(),
            "deg",
        );
        Ok(RunOutcome::default().with_observable("angle_deg", angle))
    }
}

/// Speeds at which the twins were measured, rpm; the last is kept for the check.
pub(crate) const SPEEDS: [f64; 6] = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0];

/// The study of an angle that is bent by 1 degree per rpm, which two effects explain alike.
pub(crate) fn twins() -> ResidualStudy {
    // The diagnosis draws its distributions, which takes seconds; one is enough for all tests.
    static STUDY: OnceLock<ResidualStudy> = OnceLock::new();
    STUDY.get_or_init(study).clone()
}

/// Makes it.
fn study() -> ResidualStudy {
    let probe = |name: &str| EffectProbe {
        name: name.into(),
        probe: 1.0,
        range: [-5.0, 5.0],
        absent: BTreeMap::new(),
    };
    let condition = |rpm: &f64| StudyCondition {
        model: None,
        observables: None,
        condition: BTreeMap::from([("rpm".to_owned(), *rpm)]),
        parameters: None,
        used: *rpm < 30.0,
        values: vec![Some(30.0 + rpm)],
        covariance: vec![vec![0.01]],
        ..StudyCondition::default()
    };
    let plan = ResidualPlan {
        id: "twins".into(),
        base: RunRequest::new("twins", 1),
        conditions: SPEEDS.iter().map(condition).collect(),
        observables: vec!["angle_deg".into()],
        parameters: Vec::new(),
        effects: vec![probe("bend"), probe("bow")],
        replicates: 4,
        seed: 1,
        candidates: Vec::new(),
    };
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let campaign = Campaign::new(&store, 1, &Silent);
    study_residual(&campaign, &Twins, &plan).unwrap()
}
