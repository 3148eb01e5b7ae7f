//! What the page of a running study knows before the first run.

use study::{StagePrice, Study};
use study_report::{RunningCampaign, RunningStage};

/// The stages of a study with their runs, its parameters and its measurements.
pub(crate) fn of_study(title: String, study: &Study, stages: &[StagePrice]) -> RunningCampaign {
    let stage = |stage: &StagePrice| RunningStage {
        name: stage.stage.clone(),
        runs: stage.runs,
        at_most_further: stage.at_most_further,
    };
    RunningCampaign {
        title,
        stages: stages.iter().map(stage).collect(),
        problem: Some(study.problem.clone()),
    }
}
