//! From the gates to a verdict: section 4.2 of the project's statistics, steps 1 to 7.

use crate::diagnosis::bayes_factor::{ln_factor_of_effect, ln_factor_of_unknown};
use crate::diagnosis::detectability::testable;
use crate::diagnosis::fit::{Fit, as_simulated};
use crate::diagnosis::gates::{ALPHA, GATE, Gates};
use crate::diagnosis::outcome::Verdict;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::problem_file::Sign;
use crate::diagnosis::tails::upper_tail;
use crate::diagnosis::{Error, Options};
use probability::normal_upper_quantile;

/// ln of the Bayes factor over an unknown effect from which an effect is named: at 100 one of 70
/// outside effects is still named, at 10 one of 20, at 1000 a third of the true ones is lost.
pub(crate) const LN_FACTOR_TO_NAME: f64 = 4.605_170_185_988_092;

/// Chance of noise below which runs at fitted parameters miss the data. A fit by noisy slopes does not end quite at its
/// best point: this is a tenth of what the gates allow themselves, and more than that is left where an effect hides.
const MISSED: f64 = 0.1 * ALPHA / 2.0;

/// A verdict with what it rests on.
#[derive(Debug, Clone)]
pub(crate) struct Decision {
    pub(crate) verdict: Verdict,
    /// The effects that are named or tied (numbers in the library).
    pub(crate) effects: Vec<usize>,
    /// For each effect that was taken, it and its rivals.
    pub(crate) tie_groups: Vec<Vec<usize>>,
    /// Effects that would help but are not named.
    pub(crate) suspects: Vec<usize>,
    /// What would be named, like `tie_groups`, if it did better than an unknown effect; the conditions of the fit are too few to tell.
    pub(crate) proposal: Vec<Vec<usize>>,
    /// The condition that may carry all of it.
    pub(crate) recheck: Option<usize>,
    /// Nothing on.
    pub(crate) nominal: Fit,
    pub(crate) gates: Gates,
    /// One effect on, for each of the library.
    pub(crate) singles: Vec<Fit>,
    /// The effects that were taken, on; nothing on when none was.
    pub(crate) chosen: Fit,
    /// What runs at fitted parameters leave, where the problem has them.
    pub(crate) at_fit: Option<AtFit>,
    /// Candidates that can be tested.
    pub(crate) testable: Vec<usize>,
    /// Largest distance in deviance inside a tie set.
    pub(crate) tie_limit: f64,
    /// ln of the Bayes factor of an unknown effect against none.
    pub(crate) ln_factor_of_unknown: f64,
}

/// The residual of runs at fitted parameters, without any further step by the slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AtFit {
    /// Its sum of squares.
    pub(crate) t: f64,
    /// Its upper tail on as many degrees of freedom as there are values and priors: the fit took some, so that this is too
    /// large rather than too small.
    pub(crate) p: Option<f64>,
}

impl AtFit {
    /// The residual without any re-tuning, in standard deviations of measurement and simulator alone.
    fn new(problem: &Problem) -> Result<Self, Error> {
        let residual = as_simulated(problem)?;
        let (t, rows) = (residual.norm_squared(), residual.len());
        Ok(Self {
            t,
            p: upper_tail(t, rows, problem.covariance_dof),
        })
    }
}

/// The effects that were taken one after the other.
struct Taken {
    /// All of them on.
    fit: Fit,
    /// What the gates say of what remains.
    gates: Gates,
    /// The score of each when it was taken, and the sign that it may have.
    scores: Vec<(f64, Sign)>,
    /// Whether each after the first beats an unknown effect beside those before it.
    each_beats_unknown: bool,
    /// ln of the Bayes factor of an unknown effect in the place of the first.
    ln_factor_of_unknown: f64,
}

pub(crate) fn decide(problem: &Problem, options: &Options) -> Result<Decision, Error> {
    let nominal = Fit::new(problem, &[])?;
    let testable = testable(problem, &nominal);
    let gates = Gates::new(problem, &nominal, &testable, options);
    let singles = (0..problem.candidates.len())
        .map(|j| Fit::new(problem, &[j]))
        .collect::<Result<Vec<_>, _>>()?;
    let mut decision = Decision {
        verdict: Verdict::None,
        effects: Vec::new(),
        tie_groups: Vec::new(),
        suspects: Vec::new(),
        proposal: Vec::new(),
        recheck: None,
        chosen: nominal.clone(),
        singles,
        tie_limit: tie_limit(testable.len(), problem.used.has_noisy_sensitivities()),
        ln_factor_of_unknown: ln_factor_of_unknown(&nominal),
        at_fit: problem.at_fit.then(|| AtFit::new(problem)).transpose()?,
        testable,
        nominal,
        gates,
    };
    if decision.nominal.df == 0 {
        decision.verdict = Verdict::Refused;
    } else if decision.gates.directed() {
        decision.name(problem, options)?;
    } else if decision.gates.omnibus() {
        decision.recheck = lone_condition(problem, &decision.nominal)?;
        decision.verdict = match decision.recheck {
            Some(_) => Verdict::Recheck,
            None => Verdict::Unknown,
        };
    } else if decision.runs_contradict_slopes() {
        decision.verdict = Verdict::Unknown;
    } else if decision.testable.is_empty() && !problem.candidates.is_empty() {
        decision.verdict = Verdict::NotTestable;
    }
    Ok(decision)
}

impl Taken {
    /// Whether they explain the residual better than an unknown smooth effect, each of them beside those before it.
    fn beat_unknown(&self) -> bool {
        let factor = |&(z, sign): &(f64, Sign)| ln_factor_of_effect(z, sign);
        let together: f64 = self.scores.iter().map(factor).sum();
        self.each_beats_unknown && together - self.ln_factor_of_unknown > LN_FACTOR_TO_NAME
    }
}

impl Decision {
    /// Whether runs at the fitted parameters miss by more than noise, though by the slopes a further step would not.
    /// That step is a promise that no run has kept: the runs are right.
    pub(crate) fn runs_contradict_slopes(&self) -> bool {
        let missed = self.at_fit.and_then(|at| at.p);
        !self.gates.directed() && !self.gates.omnibus() && missed.is_some_and(|p| p < MISSED)
    }

    /// Looks for effects to name once a candidate stands out.
    fn name(&mut self, problem: &Problem, options: &Options) -> Result<(), Error> {
        let taken = self.take_effects(problem, options)?;
        let groups = self.tie_groups(problem, &taken.fit, options)?;
        let mut members: Vec<usize> = groups.iter().flatten().copied().collect();
        members.sort_unstable();
        members.dedup();
        let adequate = taken.gates.adequate();
        if !adequate && self.lone_condition_explains(problem, options)? {
            self.verdict = Verdict::Recheck;
            self.suspects = members;
            return Ok(());
        }
        if adequate && taken.beat_unknown() {
            self.verdict = if members.len() == taken.fit.effects.len() {
                Verdict::Named
            } else {
                Verdict::Tie
            };
            self.effects = members;
            self.tie_groups = groups;
        } else {
            self.verdict = Verdict::Unknown;
            self.suspects = members;
            if adequate && groups.len() == 1 {
                self.proposal = groups;
            }
        }
        self.chosen = taken.fit;
        Ok(())
    }

    /// Takes the best candidate, then, while what remains is not noise, the next, each by the
    /// test of the largest score on what remains.
    fn take_effects(&self, problem: &Problem, options: &Options) -> Result<Taken, Error> {
        let mut taken = Taken {
            fit: self.nominal.clone(),
            gates: self.gates.clone(),
            scores: Vec::new(),
            each_beats_unknown: true,
            ln_factor_of_unknown: self.ln_factor_of_unknown,
        };
        while let Some(j) = taken.gates.best.filter(|_| taken.gates.directed()) {
            let first = taken.fit.effects.is_empty();
            if (!first && taken.gates.adequate()) || taken.fit.effects.len() >= options.max_effects
            {
                break;
            }
            let candidate = &problem.candidates[j];
            let score = taken.gates.scores[j].as_ref();
            let z = score.map_or(0.0, |s| s.gain);
            let mut effects = taken.fit.effects.clone();
            effects.push(j);
            let with = Fit::new(problem, &effects)?;
            let reference = taken.fit.freed_as(problem, &with)?;
            let z = match reference.score(j, candidate) {
                Some(freed) if reference.held != taken.fit.held => freed.gain,
                _ => z,
            };
            let rival = ln_factor_of_unknown(&reference);
            if first {
                taken.ln_factor_of_unknown = rival;
            } else {
                let step = ln_factor_of_effect(z, candidate.sign);
                taken.each_beats_unknown &= step - rival > LN_FACTOR_TO_NAME;
            }
            taken.scores.push((z, candidate.sign));
            taken.fit = with;
            taken.gates = Gates::new(problem, &taken.fit, &self.testable, options);
        }
        Ok(taken)
    }

    /// Each effect that was taken, and behind it the testable candidates that would do nearly as well in its
    /// place, the best first: deviance not more than the limit above. One that could not be run where it would explain the
    /// residual is not passed over for its sensitivity of elsewhere, as long as that leaves no more than noise.
    fn tie_groups(
        &self,
        problem: &Problem,
        taken: &Fit,
        options: &Options,
    ) -> Result<Vec<Vec<usize>>, Error> {
        let mut groups = Vec::new();
        for &held in &taken.effects {
            let others: Vec<usize> = taken
                .effects
                .iter()
                .copied()
                .filter(|&j| j != held)
                .collect();
            let mut rivals = Vec::new();
            for &rival in self.testable.iter().filter(|k| !taken.effects.contains(k)) {
                let mut effects = others.clone();
                effects.push(rival);
                let fit = Fit::new(problem, &effects)?;
                if fit.amplitude(rival) == 0.0 {
                    continue;
                }
                let near = fit.deviance - taken.deviance <= self.tie_limit;
                let unrefuted = || {
                    let gates = Gates::new(problem, &fit, &self.testable, options);
                    !problem.candidates[rival].was_run && gates.adequate()
                };
                if near || unrefuted() {
                    rivals.push((fit.deviance, rival));
                }
            }
            rivals.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut group = vec![held];
            group.extend(rivals.into_iter().map(|(_, rival)| rival));
            groups.push(group);
        }
        Ok(groups)
    }

    /// Whether both gates fall silent once one condition is left out, whose departure is more than
    /// chance; remembers the condition.
    fn lone_condition_explains(
        &mut self,
        problem: &Problem,
        options: &Options,
    ) -> Result<bool, Error> {
        self.recheck = lone_condition(problem, &self.nominal)?;
        let Some(condition) = self.recheck else {
            return Ok(false);
        };
        let rest = problem.without_condition(condition);
        let fit = Fit::new(&rest, &[])?;
        let gates = Gates::new(&rest, &fit, &testable(&rest, &fit), options);
        Ok(!gates.directed() && gates.adequate())
    }
}

/// Largest distance of deviance inside a tie set, so that the set keeps the true effect with chance 1 - alpha, however
/// collinear the M candidates are.
///
/// # Formula
///
/// Exact sensitivities: the square of the normal quantile at alpha / (M - 1). Noisy ones: 2 ln((M - 1) / alpha),
/// because a rival may then win by the noise of its own sensitivity, which no normal quantile bounds; under the
/// true effect the likelihood ratio of a rival of given amplitude has the mean 1, so it exceeds (M - 1) / alpha with a
/// chance of alpha / (M - 1) at most. Amplitudes are fitted, so that this is a guide and no bound: drawn campaigns
/// keep the truth in 97 to 100 % of the namings (docs/trials.md). [statistics of this project, section 4.2, step 7; the
/// second is own]
fn tie_limit(n_candidates: usize, noisy: bool) -> f64 {
    if n_candidates < 2 {
        return 0.0;
    }
    let share = ALPHA / (n_candidates - 1) as f64;
    if noisy {
        -2.0 * share.ln()
    } else {
        normal_upper_quantile(share).powi(2)
    }
}

/// The condition without which the structured residual is no more than noise, if its departure is
/// significant among all conditions.
fn lone_condition(problem: &Problem, nominal: &Fit) -> Result<Option<usize>, Error> {
    let shares = nominal.shares(problem);
    let n = shares.iter().filter(|&&share| share > 0.0).count();
    let mut best: Option<(usize, f64)> = None;
    for condition in 0..shares.len() {
        let rest = problem.without_condition(condition);
        if rest.used.rows.is_empty() || rest.used.rows.len() == problem.used.rows.len() {
            continue;
        }
        let fit = Fit::new(&rest, &[])?;
        let drop = nominal.t - fit.t;
        let dof = problem.covariance_dof;
        let p_drop = upper_tail(drop, nominal.df.saturating_sub(fit.df), dof).unwrap_or(1.0);
        let quiet = fit.p(&rest).is_some_and(|p| p > GATE)
            && fit.smooth_test(&rest).p.is_none_or(|p| p > GATE);
        let larger = best.is_none_or(|(_, d)| drop > d);
        if quiet && larger && p_drop * n as f64 <= GATE / 2.0 {
            best = Some((condition, drop));
        }
    }
    Ok(best.map(|(condition, _)| condition))
}
