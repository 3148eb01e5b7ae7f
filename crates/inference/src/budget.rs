//! How many runs a residual study may need.

use crate::residual_study::amplitude::MOST_AMPLITUDES;
use crate::residual_study::amplitude_search::{
    BLOCKS_OF_FURTHER_SEARCH, BLOCKS_OF_SEARCH, MOST_POINTS,
};
use crate::residual_study::fits::{
    BLOCKS_OF_ENDS, BLOCKS_OF_FIT, BLOCKS_WITH_EFFECTS, MOST_NOISY, MOST_SUSPECTS,
};
use crate::residual_study::rivals::MOST_REFITS;
use crate::residual_study::{MORE_AT_KEPT, certain_lists};
use crate::{ResidualPlan, RunList};

/// The largest number of runs that a study may need, for r replicates, K declared parameters, M effects, U used
/// conditions and C kept for the check.
///
/// # Formula
///
/// `r ((1 + K + M + F + 2 s + m (1 + K) + 2 B + n (A + 4 + I)) U + 3 (1 + n) C)`: the start and the sensitivities, F = 3 fits without an
/// effect, s = min(M, 6) slopes that are noise, at both ends of their ranges; for each of m = min(M, 3) effects that may explain
/// it one sensitivity measured again, and K slopes beside it; B = min(4 m, 6) points of the search for their amplitudes, before and after
/// these slopes; for each of n = min(M, 3) models that are compared A = 4 fits, one point beyond its amplitude, two more of a search
/// and one beyond where that ends (with two effects two beyond and one by the slopes there), and I = 3 at the ends of its interval. The
/// kept conditions get three times as many runs if few of them withdraw an answer.
/// A study that needs no correction of its fits, or adds no effect, needs fewer.
pub fn runs_needed(plan: &ResidualPlan) -> usize {
    let settings = 1 + plan.parameters.len() + plan.effects.len();
    let [blocks, kept] = most_blocks(plan);
    plan.replicates * ((settings + blocks) * plan.count(true) + kept * plan.count(false))
}

/// The lists of runs of a study: those that are certain if nothing fails, and further ones, at most, see [`runs_needed`].
///
/// Certain are the start with a step in each parameter and effect, the first fit, and where that ends the kept conditions.
pub(crate) fn lists_of(plan: &ResidualPlan) -> (Vec<RunList>, Vec<RunList>) {
    let [start, used, kept] = certain_lists(plan);
    let [blocks, checks] = most_blocks(plan);
    let candidates: Vec<_> = plan.requests_at_candidates();
    let further = [
        (blocks - 1, used.clone()),
        (checks - 1, kept.clone()),
        (1, candidates),
    ];
    let further = further.map(|(times, requests)| RunList { times, requests });
    (
        [start, used, kept].map(RunList::once).into(),
        further.into(),
    )
}

/// Most blocks of runs at the used conditions behind the sensitivities, and at the kept ones.
fn most_blocks(plan: &ResidualPlan) -> [usize; 2] {
    let suspects = MOST_SUSPECTS.min(plan.effects.len());
    let noisy = 2 * MOST_NOISY.min(plan.effects.len());
    let most_points = MOST_POINTS * suspects;
    let searches = [BLOCKS_OF_SEARCH.len(), BLOCKS_OF_FURTHER_SEARCH.len()];
    let points: usize = searches.iter().map(|n| most_points.min(*n)).sum();
    let searched = points + suspects * plan.parameters.len();
    let refits = MOST_REFITS.min(plan.effects.len());
    let of_refit = BLOCKS_WITH_EFFECTS.len() + 2 + BLOCKS_OF_ENDS.len() + MOST_AMPLITUDES;
    let of_refits = refits * of_refit;
    let rounds = BLOCKS_OF_FIT.len() + noisy + suspects + searched + of_refits;
    [rounds, MORE_AT_KEPT * (1 + refits)]
}

#[cfg(test)]
mod tests {
    use super::{lists_of, runs_needed};
    use crate::{EffectProbe, Parameter, ResidualPlan, StudyCondition};
    use campaign::RunRequest;
    use std::collections::BTreeMap;

    /// Seven speeds, one parameter, two effects, two replicates.
    fn plan() -> ResidualPlan {
        let speeds = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 45.0];
        let condition = |rpm: &f64| StudyCondition {
            condition: BTreeMap::from([("rpm".to_owned(), *rpm)]),
            used: *rpm != 45.0,
            ..StudyCondition::default()
        };
        let effect = |name: &str| EffectProbe {
            name: name.into(),
            probe: 1.0,
            range: [-2.0, 2.0],
            ..EffectProbe::default()
        };
        ResidualPlan {
            id: "speeds".into(),
            base: RunRequest::new("toy", 1),
            conditions: speeds.iter().map(condition).collect(),
            observables: vec!["angle".into()],
            parameters: vec![Parameter::new("a", [0.0, 1.0])],
            effects: vec![effect("one"), effect("two")],
            replicates: 2,
            seed: 1,
            candidates: Vec::new(),
        }
    }

    /// By hand: 2 (49 x 6 + 3 x 3 x 1) = 606 runs; with three used conditions 2 (49 x 3 + 3 x 3 x 4) = 366.
    #[test]
    fn used_and_kept_conditions_need_the_runs_of_the_formula() {
        let mut plan = plan();
        assert_eq!(runs_needed(&plan), 606);
        for condition in plan.conditions.iter_mut().take(3) {
            condition.used = false;
        }
        assert_eq!(runs_needed(&plan), 366);
    }

    /// By hand, two replicates: four settings and a fit at six conditions, the fit at the one that is kept, 2 (4 + 1) 6 + 2 = 62 runs;
    /// with what may follow as many as are needed at most, 606. An effect that is absent at a condition is not run there: 2 runs less.
    #[test]
    fn certain_and_further_runs_are_all_that_is_needed() {
        let number = |plan: &ResidualPlan| {
            let (certain, further) = lists_of(plan);
            [certain, further]
                .map(|lists| -> usize { lists.iter().map(|l| l.times * l.requests.len()).sum() })
        };
        let mut plan = plan();
        assert_eq!(number(&plan), [62, 606 - 62]);
        plan.conditions[0].model = Some("slow".into());
        plan.effects[1].absent = BTreeMap::from([("slow".to_owned(), "no reason".to_owned())]);
        assert_eq!(number(&plan), [60, 606 - 62]);
    }
}
