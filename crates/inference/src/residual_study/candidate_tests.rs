//! Which candidate tells tied effects apart, and the study with it.

use super::tests::{By, MEASURED_SD, observed, plan_of_twins, studied, toy, truth};
use super::{CandidateMeasurement, ResidualPlan, ResidualStudy, StudyCondition, study_residual};
use crate::diagnosis::{Purpose, Verdict};
use campaign::run_store::Store;
use campaign::{Campaign, RunOutcome, RunRequest, Silent, SimulatorError};
use std::collections::BTreeMap;
/// "bend" and "bow" do the same up to 30 rpm, and the opposite beyond; the second cannot be run at 25 rpm.
fn twins(request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
    let (rpm, bow) = (request.condition("rpm")?, request.effect("bow"));
    if rpm == 25.0 && bow != 0.0 {
        let reason = "the bow breaks at 25 rpm".to_owned();
        return Err(SimulatorError::Refused { reason });
    }
    let mut one = request.clone();
    let sign = if rpm > 30.0 { -1.0 } else { 1.0 };
    one.effects
        .insert("bend".into(), request.effect("bend") + sign * bow);
    toy(&one)
}

fn candidate(rpm: f64, minutes: f64) -> CandidateMeasurement {
    CandidateMeasurement {
        name: format!("{rpm} rpm"),
        condition: StudyCondition {
            condition: BTreeMap::from([("rpm".to_owned(), rpm), ("fill".to_owned(), 0.3)]),
            ..StudyCondition::default()
        },
        standard_errors: ["angle", "shape"]
            .map(|name| (name.to_owned(), MEASURED_SD))
            .into(),
        minutes,
    }
}

/// The plan with three candidates, the telling one the dearest.
fn plan() -> ResidualPlan {
    let mut plan = plan_of_twins();
    plan.candidates = vec![
        candidate(15.0, 1.0),
        candidate(25.0, 1.0),
        candidate(40.0, 5.0),
    ];
    plan
}

/// The study of a plan with "bend" hidden, and the number of its runs.
fn study(plan: &ResidualPlan) -> (ResidualStudy, usize) {
    let store = Store::in_memory();
    let campaign = Campaign::new(&store, 2, &Silent);
    let data = observed(plan, [2.0, 0.0], 1);
    let study = study_residual(&campaign, &By(twins), &data).unwrap();
    (study, store.keys().unwrap().len())
}

/// Of a tie: the candidate at which the twins part comes first though it costs five times as much, one at which they do
/// the same has a separation of noise (after its mean was taken off, below 4 with room: both are means of four runs), and
/// one that cannot be run is left out with the reason. Only what is on offer adds runs: 4 replicates at the fitted
/// point, two parameters and two effects for two candidates, and at most as many for the third.
#[test]
fn the_candidate_at_which_twins_part_comes_first() {
    let plan = plan();
    let (study, runs) = study(&plan);
    let diagnosis = &study.diagnosis;
    assert_eq!(diagnosis.verdict, Verdict::Tie, "{}", diagnosis.summary());
    let next = diagnosis.next_measurement.as_ref().expect("a proposal");
    assert_eq!(next.purpose, Purpose::BreakTie);
    let ranked: Vec<&str> = next.ranked.iter().map(|r| r.experiment.as_str()).collect();
    assert_eq!(ranked, ["40 rpm", "15 rpm"]);
    assert!(next.ranked[0].criterion > 10.0, "{next:?}");
    assert!(next.ranked[1].criterion < 2.0, "{next:?}");
    assert!(diagnosis.summary().contains("measure at 40 rpm"));
    let left_out = study.offered[1].left_out.as_ref().expect("a reason");
    assert!(left_out.contains("breaks at 25 rpm"), "{left_out}");
    let (without, runs_without) = self::study(&ResidualPlan {
        candidates: Vec::new(),
        ..plan.clone()
    });
    assert_eq!(without.diagnosis.next_measurement, None);
    let further = runs - runs_without;
    assert!(
        (40..=plan.requests_at_candidates().len()).contains(&further),
        "{further}"
    );
    assert_eq!(study.offered[2].keys.len(), 20);
}

/// Once it is measured, with the truth and its noise of reading (here none), the tie is resolved rightly.
#[test]
fn the_first_candidate_resolves_the_tie() {
    let mut plan = observed(&plan(), [2.0, 0.0], 1);
    let fast = plan.candidates.pop().unwrap();
    plan.conditions.push(StudyCondition {
        used: true,
        values: truth(40.0, 0.3, 0.7, 0.4, [2.0, 0.0]).map(Some).to_vec(),
        covariance: plan.conditions[0].covariance.clone(),
        ..fast.condition
    });
    let study = studied(&By(twins), &plan);
    assert_eq!(
        study.diagnosis.effects,
        ["bend"],
        "{}",
        study.diagnosis.summary()
    );
}

/// If nothing is in question nothing is run at the candidates.
#[test]
fn a_named_effect_asks_for_no_candidate() {
    let mut plan = plan();
    plan.effects.pop();
    let (study, _) = study(&plan);
    assert_eq!(study.diagnosis.verdict, Verdict::Named);
    assert!(study.offered.is_empty() && study.problem.candidate_experiments.is_empty());
}
