//! What a study would cost, told before the first run.

use crate::Error;
use crate::file::Budget;
use calibration::PlannedStage;
use campaign::Simulator;
use run_store::{Lookup, Store};
use scene_simulator::RunDetails;
use serde::Serialize;

/// Time of one core for one unit of [`Simulator::expected_cost`], s.
///
/// A guess of ours: the drum of 1200 seeds of 140 spheres takes some 20 s for a cost of 8200. Other machines and
/// seeds of few spheres differ by a factor of several. Nothing but the estimate told and a budget in core hours
/// depends on it.
const SECONDS_PER_COST: f64 = 0.0025;

/// What a stage would cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StagePrice {
    /// Name of the stage.
    pub stage: String,
    /// Number of runs, at most.
    pub runs: usize,
    /// Time of one core, s.
    pub core_s: f64,
}

/// What a study would cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Price {
    /// By stage.
    pub stages: Vec<StagePrice>,
    /// Runs of all stages, at most.
    pub runs: usize,
    /// Time of one core, s.
    pub core_s: f64,
    /// Most runs by the budget; none without one.
    pub most_runs: Option<usize>,
}

/// Prices the stages. A budget in core hours is turned into runs by the mean cost of the planned ones.
pub(crate) fn of(simulator: &dyn Simulator, stages: &[PlannedStage], budget: Budget) -> Price {
    let seconds = |cost: f64| if cost > 0.0 { cost } else { 1.0 } * SECONDS_PER_COST;
    let price = |stage: &PlannedStage| {
        let all = stage.requests.iter().map(|r| simulator.expected_cost(r));
        StagePrice {
            stage: stage.stage.clone(),
            runs: stage.requests.len(),
            core_s: all.map(seconds).sum(),
        }
    };
    let stages: Vec<StagePrice> = stages.iter().map(price).collect();
    let runs = stages.iter().map(|s| s.runs).sum();
    let core_s = stages.iter().map(|s| s.core_s).sum();
    Price {
        most_runs: most_runs(budget, runs, core_s),
        stages,
        runs,
        core_s,
    }
}

/// Most runs by a budget, at least one.
fn most_runs(budget: Budget, runs: usize, core_s: f64) -> Option<usize> {
    let by_time = budget.core_hours.map(|hours| {
        let each = core_s / runs.max(1) as f64;
        let affordable = (hours * 3600.0 / each.max(f64::MIN_POSITIVE)).clamp(1.0, 1e9);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 1 and a thousand million"
        )]
        let whole = affordable as usize;
        whole
    });
    budget.runs.or(by_time)
}

/// Time of one core that the runs in a store took, s.
pub(crate) fn core_seconds(store: &Store) -> Result<f64, Error> {
    let mut sum = 0.0;
    for key in store.keys()? {
        if let Lookup::Found(record) = store.get(&key)? {
            sum += RunDetails::of(&record).map_or(0.0, |details| details.timing.wall_s);
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::most_runs;
    use crate::Budget;

    /// 100 runs of 36 s each: a core hour pays for 100 of them, half an hour for 50.
    #[test]
    fn a_budget_of_core_hours_becomes_runs() {
        let hours = |h: f64| Budget {
            core_hours: Some(h),
            runs: None,
        };
        assert_eq!(most_runs(hours(1.0), 100, 3600.0), Some(100));
        assert_eq!(most_runs(hours(0.5), 100, 3600.0), Some(50));
        assert_eq!(most_runs(Budget::default(), 100, 3600.0), None);
        let runs = Budget {
            runs: Some(7),
            core_hours: None,
        };
        assert_eq!(most_runs(runs, 100, 3600.0), Some(7));
    }
}
