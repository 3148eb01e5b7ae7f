//! What a campaign tells of itself in its folder, for `seedloop watch`.

use campaign::{CampaignPlan, MeasuredMean, ParameterName, StagePlan};
use study::{Price, StagePrice, Study};

/// What the page says of a campaign that came to its end.
pub(crate) const FINISHED: &str = "finished";

/// The plan of a calibration.
pub(crate) fn of_calibration(study: &Study, price: &Price) -> CampaignPlan {
    CampaignPlan {
        stages: price.stages.iter().map(of_stage).collect(),
        ..of_study(study)
    }
}

/// The plan of a stage.
fn of_stage(stage: &StagePrice) -> StagePlan {
    StagePlan {
        name: stage.stage.clone(),
        runs: stage.runs,
        at_most_further: stage.at_most_further,
    }
}

/// The plan of a diagnosis.
pub(crate) fn of_diagnosis(study: &Study, stage: &StagePrice) -> CampaignPlan {
    CampaignPlan {
        stages: vec![of_stage(stage)],
        ..of_study(study)
    }
}

/// What is known of every study.
fn of_study(study: &Study) -> CampaignPlan {
    let problem = &study.problem;
    let parameters = problem.parameters.iter().map(|parameter| {
        let name = ParameterName {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
        };
        (parameter.symbol.clone(), name)
    });
    let measured = problem.measurements.iter().map(|measured| MeasuredMean {
        model: problem.models[measured.model].name.clone(),
        observable: measured.observable.clone(),
        mean: measured.mean,
        role: format!("{:?}", measured.role).to_lowercase(),
    });
    CampaignPlan {
        name: study.folder_name(),
        stages: Vec::new(),
        parameters: parameters.collect(),
        measured: measured.collect(),
    }
}

/// The plan of a design table.
pub(crate) fn of_design(name: &str) -> CampaignPlan {
    CampaignPlan {
        name: name.to_owned(),
        ..CampaignPlan::default()
    }
}
