//! A residual study that keeps to a number of runs.

use crate::residual_study::fits::{BLOCKS_OF_FIT, BLOCKS_WITH_EFFECTS, LOOKS, MOST_SUSPECTS};
use crate::{Error, ResidualPlan};
use nalgebra::DMatrix;
use std::collections::{BTreeMap, BTreeSet};

/// Keeps ln det finite while fewer conditions are chosen than the model has terms.
const RIDGE: f64 = 1e-6;
/// Passes of the exchange; it stops by itself long before.
const PASSES: usize = 20;

/// The largest number of runs that a study may need, for r replicates, K declared parameters, M effects, U used
/// conditions and C kept for the check.
///
/// # Formula
///
/// `r ((1 + K + M + F + m (L + A)) U + (1 + m) C)`: the start and the sensitivities, F = 3 fits without an effect;
/// for each of m = min(M, 3) effects that may explain it L = 2 sensitivities anew and A = 3 fits of the model with it.
/// A study that needs no correction of its fits, or adds no effect, needs fewer.
pub fn runs_needed(plan: &ResidualPlan) -> usize {
    let used = plan.conditions.iter().filter(|c| c.used).count();
    runs(plan, used)
}

/// The same for another number of used conditions.
fn runs(plan: &ResidualPlan, used: usize) -> usize {
    let settings = 1 + plan.declared.len() + plan.effects.len();
    let suspects = MOST_SUSPECTS.min(plan.effects.len());
    let rounds = BLOCKS_OF_FIT.len() + suspects * (LOOKS + BLOCKS_WITH_EFFECTS.len());
    let kept = plan.conditions.len() - used;
    plan.replicates * ((settings + rounds) * used + (1 + suspects) * kept)
}

/// The smallest budget of runs with which [`within_budget`] leaves a study that can test anything; none where even
/// all used conditions have too few values for that.
pub fn least_budget(plan: &ResidualPlan) -> Option<usize> {
    let least = least_used(plan);
    (least <= plan.count(true)).then(|| runs(plan, least))
}

/// Fewest used conditions with more values than declared parameters, where each gives all observables.
fn least_used(plan: &ResidualPlan) -> usize {
    plan.declared.len() / plan.observables.len().max(1) + 1
}

/// Takes used conditions out of the fit until the study needs no more than `budget` runs; they join
/// those kept for the check.
///
/// # Formula
///
/// What stays is D-optimal: it makes det(X'X) large for the model 1, x, x^2 in the coordinates of the
/// conditions, each scaled to -1 ... 1 (x^2 only where a coordinate has three levels or more). Chosen
/// one by one, then exchanged until no exchange helps `[Fedorov1972]`. The sensitivities are not known
/// before the runs, so the coordinates stand for them.
///
/// # Errors
///
/// [`Error::Count`] for a budget that does not reach for more values than declared parameters.
pub fn within_budget(plan: &ResidualPlan, budget: usize) -> Result<ResidualPlan, Error> {
    let used: Vec<usize> = (0..plan.conditions.len())
        .filter(|&c| plan.conditions[c].used)
        .collect();
    let affordable = (1..=used.len()).rev().find(|&n| runs(plan, n) <= budget);
    let least = least_used(plan);
    let count = affordable.filter(|&n| n >= least).ok_or(Error::Count {
        what: "budget of runs",
        got: budget,
        expected: "enough for more values than declared parameters: raise the budget, or name \
                   fewer effects",
    })?;
    if count == used.len() {
        return Ok(plan.clone());
    }
    let chosen = most_informative(&terms(plan, &used), count);
    let mut smaller = plan.clone();
    for (i, &c) in used.iter().enumerate() {
        smaller.conditions[c].used = chosen.contains(&i);
    }
    Ok(smaller)
}

/// Rows 1, x, x^2 of the used conditions.
fn terms(plan: &ResidualPlan, used: &[usize]) -> Vec<Vec<f64>> {
    let mut levels: BTreeMap<&str, BTreeSet<u64>> = BTreeMap::new();
    let mut range: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    for &c in used {
        for (name, &value) in &plan.conditions[c].condition {
            levels.entry(name).or_default().insert(value.to_bits());
            let [low, high] = range.entry(name).or_insert([value, value]);
            *low = low.min(value);
            *high = high.max(value);
        }
    }
    let row = |c: &usize| {
        let mut row = vec![1.0];
        for (name, &[low, high]) in &range {
            let value = plan.conditions[*c].condition.get(*name).copied();
            if high > low {
                let x = value.map_or(0.0, |v| (2.0 * v - low - high) / (high - low));
                row.push(x);
                if levels[name].len() > 2 {
                    row.push(x * x);
                }
            }
        }
        row
    };
    used.iter().map(row).collect()
}

/// Numbers of the `count` rows with nearly the largest determinant.
fn most_informative(rows: &[Vec<f64>], count: usize) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < count {
        let with = |i: usize| {
            let mut more = chosen.clone();
            more.push(i);
            ln_determinant(rows, &more)
        };
        let free = (0..rows.len()).filter(|i| !chosen.contains(i));
        let Some(best) = free.max_by(|&a, &b| with(a).total_cmp(&with(b))) else {
            break;
        };
        chosen.push(best);
    }
    for _ in 0..PASSES {
        let mut value = ln_determinant(rows, &chosen);
        let mut improved = false;
        for slot in 0..chosen.len() {
            for i in 0..rows.len() {
                if chosen.contains(&i) {
                    continue;
                }
                let old = std::mem::replace(&mut chosen[slot], i);
                let new = ln_determinant(rows, &chosen);
                if new > value + 1e-12 {
                    value = new;
                    improved = true;
                } else {
                    chosen[slot] = old;
                }
            }
        }
        if !improved {
            break;
        }
    }
    chosen
}

/// ln det(X'X + ridge) over the chosen rows.
fn ln_determinant(rows: &[Vec<f64>], chosen: &[usize]) -> f64 {
    let n = rows.first().map_or(0, Vec::len);
    let x = DMatrix::from_fn(chosen.len(), n, |i, j| rows[chosen[i]][j]);
    let information = x.tr_mul(&x) + DMatrix::identity(n, n) * RIDGE;
    let eigenvalues = information.symmetric_eigenvalues();
    eigenvalues
        .iter()
        .map(|v| v.max(f64::MIN_POSITIVE).ln())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::{least_budget, runs_needed, within_budget};
    use crate::{DeclaredParameter, EffectProbe, ResidualPlan, StudyCondition};
    use campaign::RunRequest;
    use std::collections::BTreeMap;

    /// Seven speeds, one parameter, two effects, two replicates.
    fn plan() -> ResidualPlan {
        let speeds = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 45.0];
        let condition = |rpm: &f64| StudyCondition {
            model: None,
            observables: None,
            condition: BTreeMap::from([("rpm".to_owned(), *rpm)]),
            used: *rpm != 45.0,
        };
        let effect = |name: &str| EffectProbe {
            name: name.into(),
            probe: 1.0,
            range: [-2.0, 2.0],
        };
        ResidualPlan {
            id: "speeds".into(),
            base: RunRequest::new("toy", 1),
            conditions: speeds.iter().map(condition).collect(),
            observables: vec!["angle".into()],
            declared: vec![DeclaredParameter {
                name: "a".into(),
                start: 0.5,
                step: 0.1,
                bounds: [0.0, 1.0],
                prior: None,
            }],
            effects: vec![effect("one"), effect("two")],
            replicates: 2,
            seed: 1,
        }
    }

    /// By hand: 2 (17 x 6 + 3 x 1) = 210 runs; with three used conditions 2 (17 x 3 + 3 x 4) = 126. The
    /// D-optimal three points of a parabola on 5 ... 30 are the ends and the point nearest to the
    /// middle, 17.5: 15 and 20 do equally well.
    #[test]
    fn a_smaller_budget_keeps_the_ends_and_the_middle() {
        let plan = plan();
        assert_eq!(runs_needed(&plan), 210);
        assert_eq!(within_budget(&plan, 210).unwrap(), plan, "it is enough");
        let smaller = within_budget(&plan, 130).unwrap();
        assert_eq!(runs_needed(&smaller), 126);
        let used = smaller.conditions.iter().filter(|c| c.used);
        let speeds: Vec<f64> = used.map(|c| c.condition["rpm"]).collect();
        assert!(
            speeds == [5.0, 15.0, 30.0] || speeds == [5.0, 20.0, 30.0],
            "{speeds:?}"
        );
    }

    /// One parameter needs two values of the one observable: 2 (17 x 2 + 3 x 5) = 98 runs.
    #[test]
    fn a_budget_that_can_test_nothing_is_refused() {
        let error = within_budget(&plan(), 97).unwrap_err().to_string();
        assert!(error.contains("budget of runs: 97 given"), "{error}");
        within_budget(&plan(), 98).unwrap();
        assert_eq!(least_budget(&plan()), Some(98));
    }

    /// More parameters than all conditions have values: no budget helps.
    #[test]
    fn too_few_values_are_refused_with_any_budget() {
        let mut plan = plan();
        let one = plan.declared[0].clone();
        plan.declared = vec![one; 9];
        assert_eq!(least_budget(&plan), None);
        within_budget(&plan, runs_needed(&plan)).unwrap_err();
    }
}
