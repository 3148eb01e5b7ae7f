//! Models with effects that real runs have fitted again, against each other: these decide about a name.

use crate::diagnosis::decision::LN_FACTOR_TO_NAME;
use crate::diagnosis::gates::{ALPHA, GATE};
use crate::diagnosis::outcome::{Diagnosis, Verdict};
use crate::diagnosis::summary::summary;
use crate::diagnosis::tails::upper_tail;
use input::quantity::significant;
use probability::t_two_sided_quantile;
use serde::Serialize;

/// Degrees of freedom that stand for a known covariance: the t quantiles are the normal ones to five digits.
pub(crate) const KNOWN: f64 = 1e6;

/// A model with effects, its parameters and amplitudes fitted by real runs.
#[derive(Debug, Clone, PartialEq)]
pub struct RefittedModel {
    /// Its effects.
    pub effects: Vec<String>,
    /// Whitened residual of its runs at the conditions of the fit, the distances from the priors last. The values are in
    /// the same order, and whitened alike, in all models that are compared.
    pub residual: Vec<f64>,
    /// Sum of the variances that its own runs have in the residual.
    pub noise: f64,
}

/// Comparison of a model, by real runs, with the best of those that were fitted again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refit {
    /// Its effects.
    pub effects: Vec<String>,
    /// Sum of squares that it leaves at the conditions of the fit, in standard deviations of measurement and runs, with the
    /// squares of the distances from the priors.
    pub sum_of_squares: f64,
    /// Its upper tail on as many degrees of freedom as there are values and priors.
    pub p: Option<f64>,
    /// ln of the odds of the best model over this one; none for the best.
    pub ln_odds_of_best: Option<f64>,
    /// Whether the best one refutes it.
    pub refuted: bool,
}

impl RefittedModel {
    fn sum_of_squares(&self) -> f64 {
        self.residual.iter().map(|r| r * r).sum()
    }

    /// This model against a better one.
    ///
    /// # Formula
    ///
    /// With the residuals a of this model and b of the better one, d = b - a and N the variance of the runs of either, summed:
    /// where this model is right, `(a'd + N + 1) / |d|` is standard normal, t on the degrees of freedom of the covariance.
    /// N is there because the noise of its runs is in a and, with the other sign, in d; 1 because the other model has fitted an amplitude of
    /// its own to the noise of the data. This model is refuted below the t quantile of `level`.
    ///
    /// The part `2 N / |d|^2` of the distance is noise of the runs of both, which belongs to neither. The ln of the odds, each model
    /// as likely before, is the rest of half the difference of the sums of squares C; with a covariance that is estimated with nu
    /// degrees of freedom from n values, of `(nu + n) / 2 ln((nu + C_a) / (nu + C_b))`. [own; the likelihood ratio of two given
    /// means]
    pub(crate) fn against(&self, better: &Self, level: f64, dof: Option<f64>) -> (bool, f64) {
        let pairs = || self.residual.iter().zip(&better.residual);
        let square: f64 = pairs().map(|(a, b)| (b - a).powi(2)).sum();
        if square <= 0.0 {
            return (false, 0.0);
        }
        let product: f64 = pairs().map(|(a, b)| a * (b - a)).sum();
        let score = (product + self.noise + 1.0) / square.sqrt();
        let quantile = t_two_sided_quantile(2.0 * level, dof.unwrap_or(KNOWN));
        let refuted = quantile.is_some_and(|t| score < -t);
        let (own, other) = (self.sum_of_squares(), better.sum_of_squares());
        let ratio = match dof {
            None => 0.5 * (own - other),
            Some(nu) => {
                let n = self.residual.len() as f64;
                0.5 * (nu + n) * ((nu + own) / (nu + other)).ln()
            }
        };
        let of_models = (1.0 - 2.0 * self.noise / square).max(0.0);
        (refuted, ratio * of_models)
    }
}

/// Odds above which the tails of the noise decide, which nobody knows so well.
const MOST_ODDS: f64 = 1e4;

/// Odds in words, by their ln.
pub fn odds(ln: f64) -> String {
    if ln > MOST_ODDS.ln() {
        format!("more than {MOST_ODDS} to 1")
    } else {
        format!("{} to 1", significant(ln.exp(), 2))
    }
}

impl Diagnosis {
    /// Of the models that real runs have fitted again the best beside the one that is named.
    pub fn best_rival(&self) -> Option<&Refit> {
        let (best, others) = self.refits.split_first()?;
        let is_named = self.verdict == Verdict::Named && best.effects == self.effects;
        let ln = |refit: &Refit| refit.ln_odds_of_best.unwrap_or(f64::INFINITY);
        let rivals = others.iter().filter(|_| is_named);
        rivals.min_by(|a, b| ln(a).total_cmp(&ln(b)))
    }

    /// The diagnosis as if its proposal had done better than an unknown effect; whether it does is still to be told.
    #[must_use]
    pub fn with_proposal_named(mut self) -> Self {
        self.tie_groups = std::mem::take(&mut self.proposal);
        self.effects = members(&self.tie_groups);
        self.verdict = named_or_tied(&self.tie_groups);
        self.suspects.clear();
        self
    }

    /// Takes back a name that by all conditions together, those kept from the fit as well, is not a hundred times as likely as an unknown
    /// effect; the ln of how much more likely its first effect is is given, `None` if no run shows it.
    #[must_use]
    pub fn against_unknown(mut self, ln_factor: Option<f64>) -> Self {
        let first = self
            .effects
            .first()
            .and_then(|name| self.candidates.get_mut(name));
        if let Some(candidate) = first {
            candidate.ln_bf_unknown = ln_factor.or(candidate.ln_bf_unknown);
        }
        if !ln_factor.is_some_and(|ln| ln > LN_FACTOR_TO_NAME) {
            let odds = ln_factor.map_or_else(String::new, |ln| {
                format!(
                    " (odds {:.2}, {:.0} are needed)",
                    ln.exp(),
                    LN_FACTOR_TO_NAME.exp()
                )
            });
            self.take_back(format!(
                "the answer is withdrawn: the kept conditions do not distinguish it from an effect that is not in the library{odds}"
            ));
        }
        self.summary = summary(&self);
        self
    }

    /// Decides between the models that explain a residual by real runs of each; `open` are those that should have been fitted
    /// again and were not, so that nothing has refuted them.
    ///
    /// The model that leaves least is the best. A rival leaves the tie where the best one refutes it: where it is right, that
    /// happens to it by any of its M - 1 rivals with a chance of 5 % at most, M the effects that could be seen. Where even the best one leaves more than noise (below 2.5 %), the
    /// answer is taken back.
    #[must_use]
    pub fn decided_by_refits(mut self, models: &[RefittedModel], open: &[Vec<String>]) -> Self {
        let mut sorted: Vec<&RefittedModel> = models.iter().collect();
        sorted.sort_by(|a, b| a.sum_of_squares().total_cmp(&b.sum_of_squares()));
        let dof = self.structured_residual.covariance_dof;
        let level = self.level();
        let refit = |model: &&RefittedModel| {
            let sum = model.sum_of_squares();
            let against = (*model != sorted[0]).then(|| model.against(sorted[0], level, dof));
            Refit {
                effects: model.effects.clone(),
                sum_of_squares: sum,
                p: upper_tail(sum, model.residual.len(), dof),
                ln_odds_of_best: against.map(|(_, odds)| odds),
                refuted: against.is_some_and(|(refuted, _)| refuted),
            }
        };
        self.refits = sorted.iter().map(refit).collect();
        let stands = self.refits.iter().filter(|refit| !refit.refuted);
        let sets: Vec<Vec<String>> = stands
            .map(|refit| refit.effects.clone())
            .chain(open.iter().cloned())
            .collect();
        self.tie_groups = groups(&sets);
        self.effects = members(&self.tie_groups);
        let taken_back = match self.refits.first() {
            None => Some("the answer is withdrawn: no model with an effect could be run".to_owned()),
            Some(best) => best.p.filter(|p| *p <= GATE).map(|p| {
                format!(
                    "the answer is withdrawn: by real runs the best model leaves more than noise (sum of squares {:.1}, p {p:.1e})",
                    best.sum_of_squares
                )
            }),
        };
        match taken_back {
            Some(reason) => self.take_back(reason),
            None => self.verdict = named_or_tied(&self.tie_groups),
        }
        self.summary = summary(&self);
        self
    }

    /// Chance with which one rival refutes a right model at most.
    pub(crate) fn level(&self) -> f64 {
        let rivals = self.candidates.values().filter(|c| c.testable).count();
        ALPHA / rivals.saturating_sub(1).max(1) as f64
    }

    /// Takes an answer back; its effects are suspects then.
    pub(crate) fn take_back(&mut self, reason: String) {
        self.warnings.push(reason);
        self.verdict = Verdict::Unknown;
        self.suspects = std::mem::take(&mut self.effects);
        self.tie_groups.clear();
    }

    /// Leaves of an answer the effects for which this holds.
    pub(crate) fn keep(&mut self, keeps: impl Fn(&String) -> bool) {
        for group in &mut self.tie_groups {
            group.retain(&keeps);
        }
        self.tie_groups.retain(|group| !group.is_empty());
        self.effects = members(&self.tie_groups);
        self.verdict = named_or_tied(&self.tie_groups);
    }
}

/// Named if there is no tie.
fn named_or_tied(groups: &[Vec<String>]) -> Verdict {
    if groups.iter().all(|group| group.len() == 1) {
        Verdict::Named
    } else {
        Verdict::Tie
    }
}

/// The effects of the first set, each with those that stand in its place in others.
fn groups(sets: &[Vec<String>]) -> Vec<Vec<String>> {
    let Some((best, others)) = sets.split_first() else {
        return Vec::new();
    };
    let mut groups: Vec<Vec<String>> = best.iter().map(|name| vec![name.clone()]).collect();
    for (group, name) in others.iter().flat_map(|set| (0..).zip(set)) {
        if let Some(group) = groups.get_mut(group).filter(|group| !group.contains(name)) {
            group.push(name.clone());
        }
    }
    groups
}

fn members(groups: &[Vec<String>]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for name in groups.iter().flatten() {
        if !all.contains(name) {
            all.push(name.clone());
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::{RefittedModel, groups};
    use probability::random_stream::Stream;

    const VALUES: usize = 18;
    /// Share of the runs in the variance of a residual.
    const SHARE: f64 = 0.4;

    /// Two models whose means differ by so much in the first value, the first right, the noise of the data and of the runs of
    /// each drawn: the second has fitted an amplitude of its own in a direction of no matter.
    fn drawn(separation: f64, stream: &mut Stream) -> [RefittedModel; 2] {
        let data: Vec<f64> = (0..VALUES)
            .map(|_| (1.0 - SHARE).sqrt() * stream.normal())
            .collect();
        let mut model = |far: f64, fits: usize| {
            let own = |i: usize, stream: &mut Stream| {
                let noise = SHARE.sqrt() * stream.normal();
                let fitted = if i == fits { 0.0 } else { data[i] };
                fitted + noise + if i == 0 { far } else { 0.0 }
            };
            RefittedModel {
                effects: vec!["one".into()],
                residual: (0..VALUES).map(|i| own(i, stream)).collect(),
                noise: SHARE * VALUES as f64,
            }
        };
        [model(0.0, 1), model(separation, 2)]
    }

    /// A right model is refuted by another one of the same goodness, or of any, with the chance that is asked for at most: 5 % of
    /// 20 000 draws (three standard errors: 0.5 %). By the difference of the sums of squares alone, with a limit
    /// of the normal quantile, 1.64², a twin would be refuted in a third of them, by the noise of its runs.
    #[test]
    fn a_right_model_is_refuted_with_the_chance_that_is_asked_for() {
        let mut stream = Stream::new(1, "refits");
        for separation in [0.0, 1.0, 2.0, 4.0, 8.0] {
            let draws = 20_000;
            let (mut refuted, mut by_sums) = (0, 0);
            for _ in 0..draws {
                let [right, wrong] = drawn(separation, &mut stream);
                let more = right.sum_of_squares() - wrong.sum_of_squares();
                refuted += u32::from(more > 0.0 && right.against(&wrong, 0.05, None).0);
                by_sums += u32::from(more > 1.64 * 1.64);
            }
            let share = f64::from(refuted) / f64::from(draws);
            assert!(share < 0.055, "{separation}: {share}");
            if separation == 0.0 {
                assert!(f64::from(by_sums) > 0.3 * f64::from(draws), "{by_sums}");
            }
        }
    }

    /// Odds of e^3 are right in 1 - 1 / (1 + e^3), 95 %, of the cases that are equally likely before: of all draws with odds
    /// between e^2 and e^4 the better model is the right one in between 88 and 98 %. By the sums of squares alone such odds come
    /// in the twins as well, where they are right in half of the cases.
    #[test]
    fn odds_are_right_as_often_as_they_say() {
        let mut stream = Stream::new(2, "odds");
        let (mut all, mut right) = (0.0, 0.0);
        for draw in 0..40_000 {
            let separation = [0.5, 2.0, 3.0, 4.0][draw % 4];
            let [truth, other] = drawn(separation, &mut stream);
            let is_better = truth.sum_of_squares() < other.sum_of_squares();
            let (better, worse) = if is_better {
                (&truth, &other)
            } else {
                (&other, &truth)
            };
            let odds = worse.against(better, 0.05, None).1;
            if (2.0..4.0).contains(&odds) {
                all += 1.0;
                right += f64::from(u8::from(is_better));
            }
        }
        let share = right / all;
        assert!(
            all > 1000.0 && (0.88..0.985).contains(&share),
            "{share} of {all}"
        );
    }

    /// The first set leads; an effect in the same place of another set is tied with that of the first.
    #[test]
    fn sets_are_grouped_by_place() {
        let set =
            |names: &[&str]| -> Vec<String> { names.iter().map(|n| (*n).to_owned()).collect() };
        let sets = [set(&["a", "d"]), set(&["b", "d"]), set(&["a", "e"])];
        assert_eq!(groups(&sets), [set(&["a", "b"]), set(&["d", "e"])]);
        assert!(groups(&[]).is_empty());
    }
}
