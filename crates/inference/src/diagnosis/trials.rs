//! What the rules say when the truth is known: drawn campaigns of the user's own design.

use nalgebra::{DMatrix, DVector};
use probability::random_stream::Stream;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use serde::Serialize;

use crate::diagnosis::before_after::Stages;
use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::detectability::testable;
use crate::diagnosis::diagnose::decide_and_check;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::max_test::{chi_squared, root};
use crate::diagnosis::next_measurement::SEPARATION_TO_REACH;
use crate::diagnosis::outcome::Verdict;
use crate::diagnosis::problem::{Part, Prior, Problem};
use crate::diagnosis::smooth_basis::smooth_basis;
use crate::diagnosis::{Error, Options};

/// Draws of the null distribution in each trial: the level of a gate is then right within 0.0035.
const DRAWS: usize = 2000;

/// Truth of a drawn campaign. Strengths are detectabilities |a||u|: amplitude over its
/// standard error after re-tuning.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "truth")]
pub enum Truth {
    /// Noise and mis-tuned parameters only.
    Nothing,
    /// One effect of the library.
    Effect {
        /// Its name.
        name: String,
        /// Its strength.
        strength: f64,
    },
    /// Two effects of the library, redrawn in each campaign.
    TwoEffects {
        /// Strength of each alone.
        strength: f64,
    },
    /// An effect that the library lacks: a member that was taken out.
    TakenOut {
        /// Its name.
        name: String,
        /// Its strength.
        strength: f64,
    },
    /// A smooth effect over the conditions that no library holds, redrawn in each campaign.
    Outsider {
        /// Its strength.
        strength: f64,
    },
    /// One value that was read or written wrongly, redrawn in each campaign.
    BadValue {
        /// Its error, in standard deviations of that value.
        strength: f64,
    },
}

/// Result of the campaigns of one truth; the counts add up to `trials`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialRow {
    /// The hidden truth.
    #[serde(flatten)]
    pub truth: Truth,
    /// Number of campaigns; a share p has the standard error sqrt(p (1 - p) / trials).
    pub trials: usize,
    /// Nothing reported.
    pub none: usize,
    /// All hidden effects named, and no other.
    pub named: usize,
    /// A hidden effect in the tie set.
    pub tied: usize,
    /// Effects named or tied, none of them hidden.
    pub false_name: usize,
    /// Reported as something that is not in the library.
    pub unknown: usize,
    /// One condition to be measured again.
    pub recheck: usize,
    /// For an effect that was taken out, what the library still holds that looks most like it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestEffect>,
    /// Change of the error on the unused conditions by a naming; `None` without namings, for a design without such
    /// conditions, and for an outsider, which is drawn over the used ones only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unused: Option<UnusedErrors>,
}

/// The error on the unused conditions before and after the effects that the used ones name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct UnusedErrors {
    /// Number of campaigns in which effects were named or tied, those with a withdrawn naming included.
    pub namings: usize,
    /// Namings that these conditions took back, because the error did not fall; they count as unknown.
    pub withdrawn: usize,
    /// Whitened mean square without an effect, mean over the namings; 1 is noise alone.
    pub before: f64,
    /// Whitened mean square with the effects, or the first of those that tie, mean over the namings.
    pub after: f64,
}

/// The effect of a library that imitates another one best.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NearestEffect {
    /// Its name.
    pub name: String,
    /// Remainder of the other effect, in standard deviations: the square root of the structured residual
    /// T of data without noise, fitted with it and the declared parameters; for an effect of either sign,
    /// the smaller of the two.
    pub left: f64,
    /// Whether that is too little to tell the two apart: less than 4, the separation that a next measurement
    /// is planned for.
    pub twin: bool,
}

impl TrialRow {
    /// A row of so many campaigns, none of which is counted yet.
    pub(crate) fn new(truth: &Truth, trials: usize) -> Self {
        Self {
            truth: truth.clone(),
            trials,
            none: 0,
            named: 0,
            tied: 0,
            false_name: 0,
            unknown: 0,
            recheck: 0,
            nearest: None,
            unused: None,
        }
    }

    /// Share of campaigns in which anything is reported.
    pub fn alarm(&self) -> f64 {
        1.0 - self.none as f64 / self.trials.max(1) as f64
    }

    /// Share of the namings and ties that hold a hidden effect; none without namings.
    pub fn truth_in_named_set(&self) -> Option<f64> {
        let right = self.named + self.tied;
        let all = right + self.false_name;
        (all > 0).then(|| right as f64 / all as f64)
    }
}

/// Draws campaigns of the design of a problem with known truth, and decides about each, on so many threads: 0 for all cores.
///
/// Each campaign draws the noise of the values from the covariance V; its estimate, V times chi2/dof, where V
/// is estimated; the noise of the sensitivities, so that the rules work with others than made the
/// data; the mis-tuning of the declared parameters, normal with the covariance of their fit; the
/// bench means of the priors about the true values. The residual of the problem is not used. Conditions that
/// the problem keeps unused get data of the same truth, and a naming stands only if it lowers the error
/// there, as in [`crate::diagnosis::diagnose`]. Effects act linearly with the sensitivities of the problem: what a real
/// simulator adds to this by its curvature is not seen here.
///
/// # Errors
///
/// As [`crate::diagnosis::diagnose`]; [`Error::Missing`] for an effect that the library does not have.
pub fn trials(
    problem: &Problem,
    truths: &[Truth],
    number: usize,
    seed: u64,
    threads: usize,
) -> Result<Vec<TrialRow>, Error> {
    let design = Design::new(problem)?;
    // Each truth has numbers of its own: threads change no bit.
    let rows = || {
        let rows = truths.par_iter();
        rows.map(|truth| design.row(truth, number, seed, DRAWS))
            .collect()
    };
    match ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(rows),
        // Without threads of their own they are drawn on those that there are.
        Err(_) => rows(),
    }
}

/// The usual truths of a library at one strength: nothing, each testable effect, two effects, each
/// taken out, an outsider, one bad value.
///
/// # Errors
///
/// As [`crate::diagnosis::diagnose`].
pub fn usual_truths(problem: &Problem, strength: f64) -> Result<Vec<Truth>, Error> {
    let names = Design::new(problem)?.testable_names();
    let mut truths = vec![Truth::Nothing];
    let effect = |name: &String| Truth::Effect {
        name: name.clone(),
        strength,
    };
    truths.extend(names.iter().map(effect));
    if names.len() > 1 {
        truths.push(Truth::TwoEffects { strength });
        truths.extend(names.iter().map(|name| Truth::TakenOut {
            name: name.clone(),
            strength,
        }));
    }
    truths.push(Truth::Outsider { strength });
    truths.push(Truth::BadValue { strength });
    Ok(truths)
}

/// A design with its exact sensitivities.
pub(crate) struct Design<'a> {
    problem: &'a Problem,
    /// Nothing on.
    nominal: Fit,
    /// A root of the covariance of the declared parameters.
    parameter_root: DMatrix<f64>,
    /// Candidates that could be seen.
    testable: Vec<usize>,
}

impl<'a> Design<'a> {
    /// Takes a problem for its design.
    pub(crate) fn new(problem: &'a Problem) -> Result<Self, Error> {
        let nominal = Fit::new(problem, &[])?;
        Ok(Self {
            parameter_root: scaled_root(&nominal.parameter_covariance()),
            testable: testable(problem, &nominal),
            nominal,
            problem,
        })
    }

    /// Names of the candidates that could be seen.
    fn testable_names(&self) -> Vec<String> {
        let name = |&j: &usize| self.problem.candidates[j].name.clone();
        self.testable.iter().map(name).collect()
    }

    /// All campaigns of one truth.
    pub(crate) fn row(
        &self,
        truth: &Truth,
        number: usize,
        seed: u64,
        draws: usize,
    ) -> Result<TrialRow, Error> {
        let mut streams = Streams {
            used: Stream::new(seed, &format!("trials: {truth:?}")),
            unused: Stream::new(seed, &format!("trials, unused conditions: {truth:?}")),
        };
        let mut row = TrialRow::new(truth, number);
        row.nearest = self.nearest(truth)?;
        let mut unused = Vec::new();
        for trial in 0..number as u64 {
            let (problem, hidden) = self.campaign(truth, &mut streams)?;
            let options = Options {
                draws,
                ..Options::new(seed.wrapping_add(trial))
            };
            let checked = decide_and_check(&problem, &options)?;
            let decision = &checked.decision;
            let name = |&j: &usize| problem.candidates[j].name.clone();
            let found: Vec<String> = decision.effects.iter().map(name).collect();
            if !found.is_empty() || checked.withdrawn.is_some() {
                let errors = checked.before_after.and_then(|e| e.unused);
                unused.extend(errors.map(|e| (e.whitened_mse, checked.withdrawn.is_some())));
            }
            *match decision.verdict {
                Verdict::None | Verdict::NotTestable | Verdict::Refused => &mut row.none,
                Verdict::Unknown => &mut row.unknown,
                Verdict::Recheck => &mut row.recheck,
                Verdict::Named if !hidden.is_empty() && same(&found, &hidden) => &mut row.named,
                _ if found.iter().any(|name| hidden.contains(name)) => &mut row.tied,
                _ => &mut row.false_name,
            } += 1;
        }
        let mean = |of: fn(&Stages) -> f64| {
            unused.iter().map(|(e, _)| of(e)).sum::<f64>() / unused.len() as f64
        };
        row.unused = (!unused.is_empty()).then(|| UnusedErrors {
            namings: unused.len(),
            withdrawn: unused.iter().filter(|(_, withdrawn)| *withdrawn).count(),
            before: mean(|e| e.before),
            after: mean(|e| e.after),
        });
        Ok(row)
    }

    /// One campaign: the problem as the rules see it, and the names of the hidden effects that its
    /// library holds.
    fn campaign(
        &self,
        truth: &Truth,
        streams: &mut Streams,
    ) -> Result<(Problem, Vec<String>), Error> {
        let part = &self.problem.used;
        let stream = &mut streams.used;
        let mut amplitudes = DVector::zeros(self.problem.candidates.len());
        let mut other = DVector::zeros(part.residual.len());
        match truth {
            Truth::Nothing => {}
            Truth::Effect { name, strength } | Truth::TakenOut { name, strength } => {
                let j = self.number(name)?;
                amplitudes[j] = self.amplitude(j, *strength, stream);
            }
            Truth::TwoEffects { strength } => {
                let mut order = self.testable.clone();
                stream.shuffle(&mut order);
                for &j in order.iter().take(2) {
                    amplitudes[j] = self.amplitude(j, *strength, stream);
                }
            }
            Truth::Outsider { strength } => other = self.outsider(*strength, stream),
            Truth::BadValue { strength } => {
                let row = stream.below(other.len());
                let sign = if stream.below(2) == 0 { 1.0 } else { -1.0 };
                other[row] = sign * strength * part.covariance.diagonal()[row].sqrt();
            }
        }
        let normal = DVector::from_fn(self.parameter_root.ncols(), |_, _| stream.normal());
        let shift = &self.parameter_root * normal;
        let mut problem = self.problem.clone();
        problem.used.residual =
            other + &part.library * &amplitudes + drawn_residual(part, &shift, stream);
        if let Some(prior) = &self.problem.prior {
            problem.prior = Some(drawn_prior(prior, &shift, stream));
        }
        let mut scale = 1.0;
        if let Some(dof) = self.problem.covariance_dof {
            scale = chi_squared(dof, stream) / dof;
        }
        blur(&mut problem.used, scale, stream);
        if matches!(truth, Truth::Outsider { .. }) {
            problem.unused = None;
        }
        if let Some(unused) = &mut problem.unused {
            let stream = &mut streams.unused;
            unused.residual =
                &unused.library * &amplitudes + drawn_residual(unused, &shift, stream);
            blur(unused, scale, stream);
        }
        if let Truth::TakenOut { name, .. } = truth {
            return Ok((problem.without_candidate(self.number(name)?), Vec::new()));
        }
        let hidden = self.problem.candidates.iter().zip(&amplitudes);
        let hidden = hidden.filter(|(_, a)| **a != 0.0);
        let names = hidden.map(|(candidate, _)| candidate.name.clone());
        Ok((problem, names.collect()))
    }

    /// Amplitude of an effect of the library at a strength, with a sign that it can have.
    fn amplitude(&self, j: usize, strength: f64, stream: &mut Stream) -> f64 {
        let sign = self.problem.candidates[j].sign;
        let either = sign.allows(1.0) && sign.allows(-1.0);
        let positive = if either {
            stream.below(2) == 0
        } else {
            sign.allows(1.0)
        };
        self.signed_amplitude(j, strength, positive)
    }

    /// Amplitude of an effect of the library at a strength.
    fn signed_amplitude(&self, j: usize, strength: f64, positive: bool) -> f64 {
        let length = self
            .nominal
            .score(j, &self.problem.candidates[j])
            .map_or(f64::INFINITY, |s| s.length);
        strength / length * if positive { 1.0 } else { -1.0 }
    }

    /// What imitates an effect that was taken out; `None` for other truths, and if no effect is left to imitate it.
    fn nearest(&self, truth: &Truth) -> Result<Option<NearestEffect>, Error> {
        let Truth::TakenOut { name, strength } = truth else {
            return Ok(None);
        };
        let j = self.number(name)?;
        let mut nearest: Option<NearestEffect> = None;
        for positive in [true, false] {
            if !self.problem.candidates[j]
                .sign
                .allows(if positive { 1.0 } else { -1.0 })
            {
                continue;
            }
            let mut problem = self.problem.clone();
            let amplitude = self.signed_amplitude(j, *strength, positive);
            problem.used.residual = problem.used.library.column(j) * amplitude;
            if let Some(prior) = &mut problem.prior {
                prior.offset.fill(0.0);
            }
            for &k in self.testable.iter().filter(|&&k| k != j) {
                let left = Fit::new(&problem, &[k])?.t.sqrt();
                if nearest.as_ref().is_none_or(|n| left < n.left) {
                    nearest = Some(NearestEffect {
                        name: self.problem.candidates[k].name.clone(),
                        left,
                        twin: left < SEPARATION_TO_REACH,
                    });
                }
            }
        }
        Ok(nearest)
    }

    /// A random smooth effect: a direction of the smooth basis that re-tuning cannot absorb.
    fn outsider(&self, strength: f64, stream: &mut Stream) -> DVector<f64> {
        let basis = smooth_basis(&self.problem.used);
        let coefficients = DVector::from_fn(basis.ncols(), |_, _| stream.normal());
        let length = (self.nominal.smooth_outside() * &coefficients).norm();
        basis * coefficients * (strength / length.max(f64::MIN_POSITIVE))
    }

    /// Number of an effect.
    fn number(&self, name: &str) -> Result<usize, Error> {
        let at = self.problem.candidates.iter().position(|c| c.name == name);
        at.ok_or_else(|| Error::Missing {
            what: format!("library effect '{name}'"),
            way_out: "name an effect of the library".into(),
        })
    }
}

/// Random numbers of a campaign.
struct Streams {
    /// For all that the rules are given.
    used: Stream,
    /// For the conditions kept for the check, so that these change nothing else.
    unused: Stream,
}

/// A root of a covariance of numbers with units of their own; 0 for those that are known.
fn scaled_root(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let errors = covariance.diagonal().map(f64::sqrt);
    let each = errors.map(|se| if se > 0.0 { 1.0 / se } else { 0.0 });
    let scale = DMatrix::from_diagonal(&each);
    DMatrix::from_diagonal(&errors) * root(&scale * covariance * &scale)
}

/// What mis-tuned parameters and noise make of the residual.
fn drawn_residual(part: &Part, shift: &DVector<f64>, stream: &mut Stream) -> DVector<f64> {
    &part.declared * shift + noise(&part.covariance, stream)
}

/// What the rules know of a part: its covariance times an error of its estimate, and noisy sensitivities.
fn blur(part: &mut Part, scale: f64, stream: &mut Stream) {
    part.covariance = part.covariance.plus_scaled(scale - 1.0, &part.covariance);
    for own in &part.declared_noise {
        part.declared += noise(&own.covariance, stream) * own.along.transpose();
    }
    for (j, own) in part.library_noise.iter().enumerate() {
        let noisy = part.library.column(j) + noise(own, stream);
        part.library.set_column(j, &noisy);
    }
}

/// Whether two lists hold the same names.
fn same(a: &[String], b: &[String]) -> bool {
    a.len() == b.len() && a.iter().all(|name| b.contains(name))
}

pub(crate) fn noise(covariance: &Covariance, stream: &mut Stream) -> DVector<f64> {
    let white = DVector::from_fn(covariance.rows(), |_, _| stream.normal());
    covariance.noise_from(&white)
}

/// Bench means about the true values: R (shift) + white noise.
fn drawn_prior(prior: &Prior, shift: &DVector<f64>, stream: &mut Stream) -> Prior {
    let noise = DVector::from_fn(prior.offset.len(), |_, _| stream.normal());
    Prior {
        root: prior.root.clone(),
        offset: &prior.root * shift + noise,
    }
}
