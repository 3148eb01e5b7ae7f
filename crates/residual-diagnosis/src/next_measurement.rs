//! Which experiment would break a tie, free an absorbed effect, or settle the parameters.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::Error;
use crate::covariance::{Covariance, Whitener};
use crate::decision::Decision;
use crate::diagnosis::Verdict;
use crate::problem::{Experiment, Problem};
use crate::space::Space;

/// Separation at which two effects are told apart nearly always: P(wrong) = Phi(-2).
pub(crate) const SEPARATION_TO_REACH: f64 = 4.0;
/// Longest plan; more of the same seldom helps.
const LONGEST_PLAN: usize = 6;
/// Share of the scale of the parameters that keeps ln det finite before they are all seen.
const RIDGE: f64 = 1e-9;

/// What the experiment is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// Tell the members of the tie set apart (T-optimality).
    BreakTie,
    /// See an effect that re-tuning can imitate (D_s-optimality).
    FreeEffect,
    /// Have more observations than parameters (D-optimality).
    SettleParameters,
}

/// The experiment that helps most, and how far it leads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextMeasurement {
    /// What it is for.
    pub purpose: Purpose,
    /// The effects concerned.
    pub effects: Vec<String>,
    /// The experiments to do, the most helpful first (for its cost, given those before it).
    pub plan: Vec<PlannedExperiment>,
    /// Criterion before any of them: smallest separation of two tied effects, detectability of
    /// the effect, or ln det of the parameters' information.
    pub now: f64,
    /// Value of the criterion that would do; none for the parameters.
    pub needed: Option<f64>,
    /// Whether the plan reaches it.
    pub reached: bool,
    /// What to do, in words.
    pub advice: String,
}

/// An experiment of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedExperiment {
    /// Its name.
    pub experiment: String,
    /// Its cost.
    pub cost: f64,
    /// Criterion once it and those before it are done.
    pub criterion: f64,
}

/// Whitened rows that grow as experiments are added.
#[derive(Clone)]
struct Rows {
    /// S~ (rows, parameters).
    declared: DMatrix<f64>,
    /// l~ (rows, effects).
    library: DMatrix<f64>,
}

/// A criterion on the rows: the larger the better.
type Criterion<'a> = dyn Fn(&Rows) -> f64 + 'a;

/// Plans the next measurement where one helps.
pub(crate) fn next_measurement(
    problem: &Problem,
    decision: &Decision,
) -> Result<Option<NextMeasurement>, Error> {
    let experiments = experiments(problem);
    if experiments.is_empty() {
        return Ok(None);
    }
    match decision.verdict {
        Verdict::Tie => {
            let pairs = tied_pairs(decision);
            let criterion = |rows: &Rows| smallest_separation(rows, &pairs);
            let target = Some(SEPARATION_TO_REACH);
            let effects = &decision.effects;
            plan(
                problem,
                &experiments,
                Purpose::BreakTie,
                effects,
                target,
                &criterion,
            )
            .map(Some)
        }
        Verdict::NotTestable => {
            let effects: Vec<usize> = (0..problem.candidates.len()).collect();
            let criterion = |rows: &Rows| best_detectability(problem, rows, &effects);
            let target = Some(3.0);
            plan(
                problem,
                &experiments,
                Purpose::FreeEffect,
                &effects,
                target,
                &criterion,
            )
            .map(Some)
        }
        Verdict::Refused => {
            let criterion = ln_information;
            plan(
                problem,
                &experiments,
                Purpose::SettleParameters,
                &[],
                None,
                &criterion,
            )
            .map(Some)
        }
        _ => Ok(None),
    }
}

/// The experiments on offer: the problem's own, or its unused conditions at cost 1.
fn experiments(problem: &Problem) -> Vec<Experiment> {
    let Some(part) = problem
        .unused
        .as_ref()
        .filter(|_| problem.experiments.is_empty())
    else {
        return problem.experiments.clone();
    };
    (0..part.conditions.len())
        .map(|c| {
            let own = part.keep(|row| row.condition == c);
            Experiment {
                name: part.label(c),
                covariance: own.covariance,
                declared: own.declared,
                library: own.library,
                cost: 1.0,
            }
        })
        .filter(|e| e.declared.nrows() > 0)
        .collect()
}

/// Adds experiments one by one, each the most helpful for its cost, until the target is reached.
fn plan(
    problem: &Problem,
    experiments: &[Experiment],
    purpose: Purpose,
    effects: &[usize],
    target: Option<f64>,
    criterion: &Criterion<'_>,
) -> Result<NextMeasurement, Error> {
    let mut rows = Rows::of(problem)?;
    let offered = experiments
        .iter()
        .map(|e| Ok((e, e.whitened()?)))
        .collect::<Result<Vec<_>, Error>>()?;
    let now = criterion(&rows);
    let mut value = now;
    let mut plan = Vec::new();
    let longest = if target.is_some() {
        LONGEST_PLAN
    } else {
        longest_for_parameters(problem)
    };
    while plan.len() < longest && target.is_none_or(|t| value < t) {
        let gain = |e: &Experiment, own: &Rows| {
            let new = criterion(&rows.with(own));
            // Separations are compared by their squares, which add up over experiments.
            let gained = if target.is_some() {
                new * new - value * value
            } else {
                new - value
            };
            gained / e.cost
        };
        let best = offered
            .iter()
            .max_by(|a, b| gain(a.0, &a.1).total_cmp(&gain(b.0, &b.1)));
        let Some((experiment, own)) = best else { break };
        rows = rows.with(own);
        value = criterion(&rows);
        plan.push(PlannedExperiment {
            experiment: experiment.name.clone(),
            cost: experiment.cost,
            criterion: value,
        });
    }
    let reached = target.is_none_or(|t| value >= t);
    Ok(NextMeasurement {
        purpose,
        effects: effects
            .iter()
            .map(|&j| problem.candidates[j].name.clone())
            .collect(),
        advice: advice(purpose, plan.first(), reached),
        plan,
        now,
        needed: target,
        reached,
    })
}

/// Experiments until there is one row more than parameters.
fn longest_for_parameters(problem: &Problem) -> usize {
    let rows_each = problem.observables.len().max(1);
    problem.declared.len() / rows_each + 1
}

/// What to do, in words.
fn advice(purpose: Purpose, first: Option<&PlannedExperiment>, reached: bool) -> String {
    let Some(first) = first else {
        return "nothing needs to be measured".to_owned();
    };
    let what = match purpose {
        Purpose::BreakTie => "to tell the tied effects apart",
        Purpose::FreeEffect => "to see the effect that re-tuning can imitate",
        Purpose::SettleParameters => "to have more observations than parameters",
    };
    let rest = if reached {
        ""
    } else {
        "; the experiments on offer do not suffice: measure another observable in which the \
         effects differ, or measure more precisely (more frames and simulator runs)"
    };
    format!("measure at {} {what}{rest}", first.experiment)
}

/// Pairs inside the tie groups, with the mean square of the amplitude of the first.
fn tied_pairs(decision: &Decision) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for group in &decision.tie_groups {
        for &effect in group {
            for &rival in group.iter().filter(|&&k| k != effect) {
                let single = &decision.singles[effect];
                let (a, se) = (single.amplitudes[0], single.standard_errors[0]);
                pairs.push(Pair {
                    effect,
                    rival,
                    mean_square: a * a + se * se,
                });
            }
        }
    }
    pairs
}

/// Two tied effects.
struct Pair {
    /// Taken as true.
    effect: usize,
    /// Fitted in its place.
    rival: usize,
    /// Posterior mean of the squared amplitude of the true one.
    mean_square: f64,
}

/// Smallest d_jk over the pairs: d_jk^2 = a_j^2 |(I - P_[S~, l~_k]) l~_j|^2, the noncentrality
/// left after parameters and rival are refitted (T-optimality `[AtkinsonFedorov1975]`).
fn smallest_separation(rows: &Rows, pairs: &[Pair]) -> f64 {
    pairs
        .iter()
        .map(|pair| {
            let space = Space::of(&rows.with_effect(pair.rival));
            let left = space.outside(&rows.library.column(pair.effect).into_owned());
            pair.mean_square.sqrt() * left.norm()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Largest a_max |u_j| among the effects; 1 stands for a missing a_max.
fn best_detectability(problem: &Problem, rows: &Rows, effects: &[usize]) -> f64 {
    let space = Space::of(&rows.declared);
    effects
        .iter()
        .map(|&j| {
            let left = space.outside(&rows.library.column(j).into_owned()).norm();
            let ends = problem.candidates[j].range().map(f64::abs);
            let largest = ends[0].max(ends[1]);
            left * if largest.is_finite() { largest } else { 1.0 }
        })
        .fold(0.0, f64::max)
}

/// ln det of S~'S~, parameters scaled to the length of their columns, with a small ridge.
fn ln_information(rows: &Rows) -> f64 {
    let information = rows.declared.tr_mul(&rows.declared);
    let scale = information.diagonal().amax().max(f64::MIN_POSITIVE);
    let n = information.nrows();
    if n == 0 {
        return 0.0;
    }
    let ridged = information + DMatrix::identity(n, n) * (RIDGE * scale);
    ridged
        .symmetric_eigenvalues()
        .iter()
        .map(|v| v.max(f64::MIN_POSITIVE).ln())
        .sum()
}

impl Rows {
    /// The rows that there are already, those of the prior included.
    fn of(problem: &Problem) -> Result<Self, Error> {
        let part = &problem.used;
        let whitener = part.covariance.whitener()?;
        let rows = Self {
            declared: whitener.whiten(&part.declared),
            library: whitener.whiten(&part.library),
        };
        Ok(match &problem.prior {
            None => rows,
            Some(prior) => rows.with(&Self {
                declared: prior.root.clone(),
                library: DMatrix::zeros(prior.root.nrows(), problem.candidates.len()),
            }),
        })
    }

    /// These rows, then others.
    fn with(&self, others: &Self) -> Self {
        Self {
            declared: stacked(&self.declared, &others.declared),
            library: stacked(&self.library, &others.library),
        }
    }

    /// [S~, l~_k].
    fn with_effect(&self, effect: usize) -> DMatrix<f64> {
        let mut columns: Vec<DVector<f64>> = self
            .declared
            .column_iter()
            .map(nalgebra::Matrix::into_owned)
            .collect();
        columns.push(self.library.column(effect).into_owned());
        DMatrix::from_columns(&columns)
    }
}

impl Experiment {
    /// Its whitened rows.
    fn whitened(&self) -> Result<Rows, Error> {
        let whitener: Whitener = Covariance::whitener(&self.covariance)?;
        Ok(Rows {
            declared: whitener.whiten(&self.declared),
            library: whitener.whiten(&self.library),
        })
    }
}

/// One matrix on top of another.
fn stacked(top: &DMatrix<f64>, bottom: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = top
        .clone()
        .resize_vertically(top.nrows() + bottom.nrows(), 0.0);
    both.rows_mut(top.nrows(), bottom.nrows()).copy_from(bottom);
    both
}
