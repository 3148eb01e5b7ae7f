//! Which models real runs must fit again before one of them is named, and what these runs say of each other.

use super::amplitude_search::WORTH_A_SEARCH;
use super::fits::{Fits, Refitted, Remeasured, Visited};
use super::linearisation::Linearisation;
use super::runs::At;
use super::whitened::whitened;
use super::{AddedEffect, ResidualPlan, assemble};
use crate::Error;
use crate::diagnosis::{Diagnosis, RefittedModel, Verdict};

/// Most models with an effect that are fitted again.
pub(crate) const MOST_REFITS: usize = 3;

/// A diagnosis by real runs, with the models behind it.
pub(super) struct Decided {
    pub(super) diagnosis: Diagnosis,
    /// The models in question, the best first, with their runs at the kept conditions.
    pub(super) added: Vec<AddedEffect>,
    /// Whether each of the models in question could be run, at the kept conditions too.
    pub(super) all_could_be_run: bool,
}

/// Effects whose models are to be fitted again, one set a model, the best explanations first: those that are named or tied, the
/// number of which is given, and behind them rivals that a bent response could make as good.
///
/// A rival explains half of what the best one does, or more. By its slope it leaves a residual T, and runs may leave less, as the
/// response of an effect is not a straight line. To leave as little as the best one its response would have to change by
/// `T - T_best`, in squares; half is where that is all that it explains, `T_0 - T`: it would be another response.
pub(super) fn sets_to_refit(
    diagnosis: &Diagnosis,
    plan: &ResidualPlan,
) -> (Vec<Vec<String>>, usize) {
    let groups = &diagnosis.tie_groups;
    let best: Vec<String> = groups.iter().filter_map(|g| g.first().cloned()).collect();
    if best.is_empty() {
        return (Vec::new(), 0);
    }
    let mut sets = vec![best.clone()];
    let longest = groups.iter().map(Vec::len).max().unwrap_or(0);
    // The second of each group, then the third of each, and so on.
    for rank in 1..longest {
        for (place, group) in groups.iter().enumerate() {
            if let Some(name) = group.get(rank).filter(|name| !best.contains(name)) {
                let mut set = best.clone();
                set[place].clone_from(name);
                sets.push(set);
            }
        }
    }
    let tied = sets.len();
    if let [group] = groups.as_slice() {
        let rivals = rivals(diagnosis, plan, &group[0]);
        let others = rivals.into_iter().filter(|name| !group.contains(name));
        sets.extend(others.map(|name| vec![name]));
    }
    (sets, tied)
}

/// Effects that explain half of what one does, or more; the best first.
fn rivals(diagnosis: &Diagnosis, plan: &ResidualPlan, best: &str) -> Vec<String> {
    let whole = diagnosis.structured_residual.t0.unwrap_or(0.0);
    let explained = |name: &str| {
        let candidate = diagnosis.candidates.get(name);
        let candidate = candidate.filter(|c| c.testable && c.amplitude.is_some_and(|a| a != 0.0));
        candidate.map(|c| whole - c.t_after)
    };
    let least = WORTH_A_SEARCH * explained(best).unwrap_or(whole);
    let names = plan.effects.iter().map(|e| e.name.clone());
    let each = names.filter_map(|name| Some((explained(&name)?, name)));
    let mut rivals: Vec<(f64, String)> = each.filter(|(e, _)| *e >= least && *e > 0.0).collect();
    rivals.sort_by(|a, b| b.0.total_cmp(&a.0));
    rivals.into_iter().map(|(_, name)| name).collect()
}

impl Fits<'_> {
    /// Lets real runs decide what a diagnosis by slopes proposes; one that proposes nothing stays as it is.
    pub(super) fn decided(
        &self,
        linear: &Linearisation,
        fit: &Visited,
        diagnosis: Diagnosis,
        remeasured: &mut Remeasured,
    ) -> Result<Decided, Error> {
        let (mut sets, tied) = sets_to_refit(&diagnosis, self.plan);
        if sets.is_empty() {
            return Ok(Decided {
                diagnosis,
                added: Vec::new(),
                all_could_be_run: true,
            });
        }
        let mut open = sets.split_off(sets.len().min(MOST_REFITS));
        open.truncate(tied.saturating_sub(MOST_REFITS));
        let models = self.refitted(linear, &sets, fit, remeasured)?;
        let is_refitted = |set: &Vec<String>| models.iter().any(|m| m.effects == *set);
        let ties = sets.iter().take(tied);
        let failed: Vec<Vec<String>> = ties.filter(|set| !is_refitted(set)).cloned().collect();
        let could_be_run = failed.is_empty();
        open.extend(failed);
        let compared = |model: &Refitted| -> Result<RefittedModel, Error> {
            let end = (&model.end.means.values[..], At::Used);
            let runs = &fit.means.n;
            let (mut residual, noise) = whitened(self.plan, linear, runs, end)?;
            residual.extend(assemble::from_priors(self.plan, &model.end.setting));
            Ok(RefittedModel {
                effects: model.effects.clone(),
                residual,
                noise,
            })
        };
        let compared: Vec<RefittedModel> = models.iter().map(compared).collect::<Result<_, _>>()?;
        let mut diagnosis = diagnosis.decided_by_refits(&compared, &open);
        let stands = |refit: &&crate::diagnosis::Refit| !refit.refuted;
        let standing: Vec<&Refitted> = diagnosis
            .refits
            .iter()
            .filter(stands)
            .filter_map(|refit| models.iter().find(|m| m.effects == refit.effects))
            .collect();
        let added = self.completed(linear, fit, &standing, &mut diagnosis.warnings)?;
        let all_could_be_run = could_be_run && added.len() == standing.len();
        diagnosis.amplitudes.extend(super::amplitudes_of(&added));
        Ok(Decided {
            diagnosis,
            added,
            all_could_be_run,
        })
    }
}

/// The model that is named, or was and is withdrawn, and the others in question.
pub(super) fn after_and_rivals(
    diagnosis: &Diagnosis,
    mut added: Vec<AddedEffect>,
) -> (Option<AddedEffect>, Vec<AddedEffect>) {
    if added.len() == 1 && diagnosis.verdict != Verdict::Tie {
        return (added.pop(), Vec::new());
    }
    let is_named = |model: &AddedEffect| {
        diagnosis.verdict == Verdict::Named
            && model.effects.len() == diagnosis.effects.len()
            && diagnosis
                .effects
                .iter()
                .all(|name| model.effects.contains_key(name))
    };
    let named = added.iter().position(is_named);
    (named.map(|i| added.remove(i)), added)
}
