//! How often the rules err for the user's own design, by simulation.

use nalgebra::{DMatrix, DVector};
use random_stream::Stream;
use serde::Serialize;
use std::collections::BTreeMap;

use crate::decision::decide;
use crate::diagnosis::Verdict;
use crate::fit::Fit;
use crate::gates::testable;
use crate::problem::Problem;
use crate::smooth_basis::smooth_basis;
use crate::{Error, Options};

/// Draws of the null distribution in each trial: the level of a gate is then right within 0.0035.
const DRAWS: usize = 2000;

/// Rates over simulated residuals of the same design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ErrorRates {
    /// Trials of each kind; a rate p has the standard error sqrt(p (1 - p) / trials).
    pub trials: usize,
    /// Detectability |a||u| of the effects that were planted, in standard errors.
    pub strength: f64,
    /// Share of pure noise in which anything is reported (nominal 0.05).
    pub false_alarm: f64,
    /// Share of unknown smooth effects of that strength for which a library effect is named.
    pub outsider_named: f64,
    /// For each testable candidate, what happens when it is the missing effect.
    pub candidates: BTreeMap<String, CandidateRates>,
}

/// Rates for one candidate that is truly missing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CandidateRates {
    /// Share in which anything is reported.
    pub alarm: f64,
    /// Share in which it is named or in the tie set.
    pub in_named_set: f64,
    /// Share in which others are named without it.
    pub dropped: f64,
}

/// Simulates residuals of the design of a problem, and decides about each.
///
/// The residual of the problem is not used; noise is drawn from its covariance. Sensitivities
/// count as exact.
///
/// # Errors
///
/// As [`crate::diagnose`].
pub fn error_rates(
    problem: &Problem,
    strength: f64,
    trials: usize,
    seed: u64,
) -> Result<ErrorRates, Error> {
    let mut exact = problem.clone();
    exact.used.declared_noise.clear();
    exact.used.library_noise.clear();
    let trial = Trials {
        problem: &exact,
        number: trials,
        seed,
    };
    let nominal = Fit::new(&exact, &[])?;
    let nothing = DVector::zeros(exact.used.residual.len());
    let naming = |d: &Outcome| matches!(d.verdict, Verdict::Named | Verdict::Tie);
    let noise_only = trial.decisions("noise", |_| nothing.clone())?;
    let outsiders = trial.decisions("outsider", |stream| {
        outsider(&exact, &nominal, strength, stream)
    })?;
    let mut candidates = BTreeMap::new();
    for j in testable(&exact, &nominal) {
        let Some(score) = nominal.score(j) else {
            continue;
        };
        let sign = if exact.candidates[j].sign.allows(1.0) {
            1.0
        } else {
            -1.0
        };
        let signal = exact.used.library.column(j) * (sign * strength / score.length);
        let name = &exact.candidates[j].name;
        let decisions = trial.decisions(name, |_| signal.clone())?;
        let rates = CandidateRates {
            alarm: share(&decisions, |d| d.verdict.is_alarm()),
            in_named_set: share(&decisions, |d| naming(d) && d.effects.contains(&j)),
            dropped: share(&decisions, |d| naming(d) && !d.effects.contains(&j)),
        };
        candidates.insert(name.clone(), rates);
    }
    Ok(ErrorRates {
        trials,
        strength,
        false_alarm: share(&noise_only, |d| d.verdict.is_alarm()),
        outsider_named: share(&outsiders, naming),
        candidates,
    })
}

/// Simulated residuals of one design.
struct Trials<'a> {
    /// The design.
    problem: &'a Problem,
    /// Their number.
    number: usize,
    /// Seed of all of them.
    seed: u64,
}

impl Trials<'_> {
    /// Decisions about signal plus noise.
    fn decisions(
        &self,
        purpose: &str,
        signal: impl Fn(&mut Stream) -> DVector<f64>,
    ) -> Result<Vec<Outcome>, Error> {
        let whitener = self.problem.used.covariance.whitener()?;
        let mut stream = Stream::new(self.seed, &format!("error rates: {purpose}"));
        let n = self.problem.used.residual.len();
        let decide_one = |trial| {
            let white = DMatrix::from_fn(n, 1, |_, _| stream.normal());
            let noise = whitener.colour(&white).column(0).into_owned();
            let residual = signal(&mut stream) + noise;
            let options = Options {
                draws: DRAWS,
                ..Options::new(self.seed.wrapping_add(trial))
            };
            let decision = decide(&self.problem.with_residual(residual), &options)?;
            Ok(Outcome {
                verdict: decision.verdict,
                effects: decision.effects,
            })
        };
        (0..self.number as u64).map(decide_one).collect()
    }
}

/// What is kept of a decision.
struct Outcome {
    /// The verdict.
    verdict: Verdict,
    /// The effects that are named or tied.
    effects: Vec<usize>,
}

/// Share of the outcomes that are wanted.
fn share(outcomes: &[Outcome], wanted: impl Fn(&Outcome) -> bool) -> f64 {
    let count = outcomes.iter().filter(|outcome| wanted(outcome)).count();
    count as f64 / outcomes.len().max(1) as f64
}

/// A random smooth effect: a direction of the smooth basis that re-tuning cannot absorb, of the
/// given detectability.
fn outsider(problem: &Problem, nominal: &Fit, strength: f64, stream: &mut Stream) -> DVector<f64> {
    let basis = smooth_basis(&problem.used);
    let coefficients = DVector::from_fn(basis.ncols(), |_, _| stream.normal());
    let length = (nominal.smooth_outside() * &coefficients).norm();
    basis * coefficients * (strength / length.max(f64::MIN_POSITIVE))
}

impl Verdict {
    /// Whether anything is reported to be wrong.
    pub(crate) fn is_alarm(self) -> bool {
        !matches!(self, Self::None | Self::NotTestable | Self::Refused)
    }
}
