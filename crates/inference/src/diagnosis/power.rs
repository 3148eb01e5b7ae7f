//! What a design can be expected to detect before any run: drawn campaigns with shapes of chance.

use nalgebra::{DMatrix, DVector};
use probability::random_stream::Stream;
use serde::Serialize;
use std::collections::BTreeSet;

use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::problem::{Candidate, Part, Problem, Row, SlopeNoise};
use crate::diagnosis::problem_file::{Condition, Level, Sign};
use crate::diagnosis::trials::Design;
use crate::diagnosis::{Error, TrialRow, Truth};

/// Draws of the null distribution in each campaign: the level of a gate is then right within 0.007.
const DRAWS: usize = 500;
/// How much of a shape over a coordinate is bent, where its level and its slope are 1. Own choice: at 0 all effects are
/// straight lines and tie more.
const BEND: f64 = 0.5;
/// Scatter of a shape from value to value. Own choice, likewise.
const ROUGHNESS: f64 = 0.3;
/// What a step of a declared parameter moves a value, in standard errors of it. Own choice: half of it doubles the noise of
/// its sensitivities.
const STEP: f64 = 5.0;

/// Rows of a design and what acts on them, all in standard errors of the measured values.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerDesign {
    /// Conditions with their coordinates.
    pub conditions: Vec<Condition>,
    /// Condition and observable of each value; an observable belongs to one scene.
    pub rows: Vec<[usize; 2]>,
    /// Variance of the simulated mean over that of the measured value (rows).
    pub simulated_variance: Vec<f64>,
    /// Whether each declared parameter acts at each condition (parameters, conditions).
    pub declared: Vec<Vec<bool>>,
    /// Whether each effect acts at each condition (effects, conditions).
    pub effects: Vec<Vec<bool>>,
}

/// Frequencies of the outcomes if one effect of a size is hidden; they add up to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Power {
    /// Amplitude of the hidden effect over its standard error after re-tuning.
    pub size: f64,
    /// Drawn campaigns; a share p has the standard error sqrt(p (1 - p) / campaigns).
    pub campaigns: usize,
    /// It alone is named.
    pub named: f64,
    /// It is in a tie set, or among the effects that are said to help.
    pub tied: f64,
    /// Another one is named or tied.
    pub wrong: f64,
    /// Something is seen, and nothing named.
    pub unknown: f64,
    /// Nothing is seen.
    pub unseen: f64,
}

/// Degrees of freedom of a design: values less declared parameters that act, at least 0.
fn degrees_of_freedom(design: &PowerDesign) -> usize {
    let acts = design.declared.iter();
    let acting = acts.filter(|on| design.rows.iter().any(|row| on[row[0]]));
    design.rows.len().saturating_sub(acting.count())
}

/// Draws campaigns of a design without knowing its sensitivities: each parameter and each effect gets a random shape, over
/// the conditions of each observable a level, a slope and a bend in each coordinate, and a rest from value to value. The
/// rules see sensitivities with the noise of runs, an effect run at the size at which it is hidden. Known data of
/// parameters beforehand, their limits, and the signs and limits of amplitudes are left out. (own derivation)
///
/// # Errors
///
/// [`Error::NotPositiveDefinite`] where a variance is not above 0.
pub fn power(
    design: &PowerDesign,
    sizes: &[f64],
    campaigns: usize,
    seed: u64,
) -> Result<Vec<Power>, Error> {
    let of_size = |&size: &f64| {
        let mut stream = Stream::new(seed, &format!("power {size}"));
        let mut rows = Vec::new();
        for k in 0..campaigns as u64 {
            rows.push(campaign(design, size, seed + k, &mut stream)?);
        }
        Ok(Power::of(size, &rows))
    };
    sizes.iter().map(of_size).collect()
}

/// One campaign in which an effect of a size is hidden, as [trials](crate::diagnosis::trials) draw it.
fn campaign(
    design: &PowerDesign,
    size: f64,
    seed: u64,
    stream: &mut Stream,
) -> Result<TrialRow, Error> {
    let mut problem = drawn_problem(design, stream);
    // Lengths of the effects after re-tuning, with the true sensitivities of the parameters.
    let nominal = Fit::new(&problem, &[])?;
    let length = |j: usize| Some(nominal.score(j, &problem.candidates[j])?.length);
    let lengths: Vec<Option<f64>> = (0..design.effects.len()).map(length).collect();
    let seen: Vec<usize> = (0..lengths.len())
        .filter(|&j| lengths[j].is_some())
        .collect();
    if degrees_of_freedom(design) == 0 || seen.is_empty() {
        let mut unseen = TrialRow::new(&Truth::Nothing, 1);
        unseen.none = 1;
        return Ok(unseen);
    }
    let name = problem.candidates[seen[stream.below(seen.len())]]
        .name
        .clone();
    let part = &mut problem.used;
    // What the rules see: a difference of two means for a parameter, one mean for an effect, whose other is in the residual.
    let of_step: Vec<f64> = design.simulated_variance.iter().map(|q| 2.0 * q).collect();
    for (k, acts) in design.declared.iter().enumerate() {
        let noise = diagonal(&masked(design, acts, &of_step));
        let n = design.declared.len();
        part.declared_noise.push(SlopeNoise::of_one(k, n, noise));
    }
    for (j, acts) in design.effects.iter().enumerate() {
        // Each effect is run at the size at which it would be hidden.
        let scaled = part.library.column(j) * lengths[j].map_or(1.0, |length| size / length);
        part.library.set_column(j, &scaled);
        let noise = diagonal(&masked(design, acts, &design.simulated_variance));
        part.library_noise.push(noise);
    }
    let truth = Truth::Effect {
        name,
        strength: size,
    };
    Design::new(&problem)?.row(&truth, 1, seed, DRAWS)
}

/// A problem with random true sensitivities and no residual yet.
fn drawn_problem(design: &PowerDesign, stream: &mut Stream) -> Problem {
    let n = design.rows.len();
    let mut columns = |acts: &[Vec<bool>], scale: f64| {
        let mut matrix = DMatrix::zeros(n, acts.len());
        for (k, acts) in acts.iter().enumerate() {
            matrix.set_column(k, &(shape(design, acts, stream) * scale));
        }
        matrix
    };
    let (declared, library) = (
        columns(&design.declared, STEP),
        columns(&design.effects, 1.0),
    );
    let total: Vec<f64> = design.simulated_variance.iter().map(|q| 1.0 + q).collect();
    let row = |[condition, observable]: &[usize; 2]| Row {
        condition: *condition,
        observable: *observable,
    };
    let observables = design.rows.iter().map(|row| row[1] + 1).max().unwrap_or(0);
    let name = |j: usize| Candidate {
        name: format!("effect {j}"),
        ends: None,
        sign: Sign::Any,
        was_run: true,
    };
    Problem {
        id: "power".into(),
        observables: (0..observables)
            .map(|k| format!("observable {k}"))
            .collect(),
        declared: (0..design.declared.len())
            .map(|k| format!("P{k}"))
            .collect(),
        candidates: (0..design.effects.len()).map(name).collect(),
        used: Part {
            conditions: design.conditions.clone(),
            rows: design.rows.iter().map(row).collect(),
            residual: DVector::zeros(n),
            covariance: diagonal(&total),
            declared,
            library,
            declared_noise: Vec::new(),
            library_noise: Vec::new(),
        },
        unused: None,
        limits: vec![[f64::NEG_INFINITY, f64::INFINITY]; design.declared.len()],
        at_fit: false,
        prior: None,
        covariance_dof: None,
        experiments: Vec::new(),
        warnings: Vec::new(),
    }
}

/// A random shape over the rows, 0 where it does not act.
fn shape(design: &PowerDesign, acts: &[bool], stream: &mut Stream) -> DVector<f64> {
    let mut values = DVector::zeros(design.rows.len());
    let observables: BTreeSet<usize> = design.rows.iter().map(|row| row[1]).collect();
    for observable in observables {
        let own: Vec<usize> = (0..design.rows.len())
            .filter(|&i| design.rows[i][1] == observable)
            .collect();
        let conditions = own.iter().map(|&i| &design.conditions[design.rows[i][0]]);
        let level = stream.normal();
        for &i in &own {
            values[i] = level + ROUGHNESS * stream.normal();
        }
        for coordinate in coordinates(&conditions.collect::<Vec<_>>()) {
            let (slope, bend) = (stream.normal(), BEND * stream.normal());
            for (&i, x) in own.iter().zip(&coordinate) {
                values[i] += slope * x + bend * (x * x - 1.0);
            }
        }
    }
    for (value, row) in values.iter_mut().zip(&design.rows) {
        if !acts[row[0]] {
            *value = 0.0;
        }
    }
    values
}

/// Numbers that vary over some conditions, each with mean 0 and variance 1.
fn coordinates(conditions: &[&Condition]) -> Vec<Vec<f64>> {
    let names: BTreeSet<&String> = conditions.iter().flat_map(|c| c.keys()).collect();
    let numbers = names.into_iter().filter_map(|name| {
        let each = conditions.iter().map(|c| match c.get(name) {
            Some(Level::Number(x)) => Some(*x),
            _ => None,
        });
        let values: Vec<f64> = each.collect::<Option<_>>()?;
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
        let spread = variance.sqrt();
        let varies = spread > 1e-12 * mean.abs();
        varies.then(|| values.iter().map(|x| (x - mean) / spread).collect())
    });
    numbers.collect()
}

/// Variances of the rows on which something acts, 0 elsewhere.
fn masked(design: &PowerDesign, acts: &[bool], variances: &[f64]) -> Vec<f64> {
    let each = design.rows.iter().zip(variances);
    each.map(|(row, v)| if acts[row[0]] { *v } else { 0.0 })
        .collect()
}

/// A covariance without correlations.
fn diagonal(variances: &[f64]) -> Covariance {
    let each = variances.iter().map(|v| DMatrix::from_element(1, 1, *v));
    Covariance::new(each.collect(), vec!["value".to_owned(); variances.len()])
}

impl Power {
    /// The shares of campaigns in which effects of a size were hidden.
    pub fn of(size: f64, rows: &[TrialRow]) -> Self {
        let sum = |count: fn(&TrialRow) -> usize| rows.iter().map(count).sum::<usize>();
        let campaigns = sum(|row| row.trials);
        let share = |count: usize| count as f64 / campaigns.max(1) as f64;
        Self {
            size,
            campaigns,
            named: share(sum(|row| row.named)),
            tied: share(sum(|row| row.tied)),
            wrong: share(sum(|row| row.false_name)),
            unknown: share(sum(|row| row.unknown + row.recheck)),
            unseen: share(sum(|row| row.none)),
        }
    }
}

impl PowerDesign {
    /// The same with the values of one more condition of the scene with most values: those of the last of its conditions,
    /// each of whose coordinates lies as far beyond the largest as its levels lie apart.
    #[must_use]
    pub fn with_condition(&self) -> Self {
        let mut more = self.clone();
        let Some(&[last, _]) = self.largest().last() else {
            return more;
        };
        let mut condition = self.conditions[last].clone();
        for (name, level) in &mut condition {
            let all = self.conditions.iter().filter_map(|c| match c.get(name) {
                Some(Level::Number(x)) => Some(*x),
                _ => None,
            });
            let (low, high, n) = all.fold(
                (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64),
                |(low, high, n), x| (low.min(x), high.max(x), n + 1.0),
            );
            if let Level::Number(x) = level {
                let apart = (high - low) / (n - 1.0).max(1.0);
                *x = high + if apart > 0.0 { apart } else { 0.5 * high };
            }
        }
        more.add_condition(condition, last);
        let observables: Vec<usize> = self
            .rows
            .iter()
            .filter(|row| row[0] == last)
            .map(|row| row[1])
            .collect();
        let at = more.conditions.len() - 1;
        for observable in observables {
            more.add_row([at, observable]);
        }
        more
    }

    /// The same with one more observable at the conditions of the one with most values.
    #[must_use]
    pub fn with_observable(&self) -> Self {
        let mut more = self.clone();
        let new = self.next_observable();
        for [condition, _] in self.largest() {
            more.add_row([condition, new]);
        }
        more
    }

    /// The same with one value of one more scene, in which all parameters and effects act.
    #[must_use]
    pub fn with_scene(&self) -> Self {
        let mut more = self.clone();
        more.conditions.push(Condition::new());
        let all = more.declared.iter_mut().chain(&mut more.effects);
        all.for_each(|acts| acts.push(true));
        more.add_row([more.conditions.len() - 1, self.next_observable()]);
        more
    }

    /// Rows of the observable with most values, the first of several.
    fn largest(&self) -> Vec<[usize; 2]> {
        let of = |k: usize| self.rows.iter().copied().filter(move |row| row[1] == k);
        let most = (0..self.next_observable())
            .rev()
            .max_by_key(|&k| of(k).count());
        most.map_or_else(Vec::new, |k| of(k).collect())
    }

    /// Number of an observable that there is not yet.
    fn next_observable(&self) -> usize {
        self.rows.iter().map(|row| row[1] + 1).max().unwrap_or(0)
    }

    /// Adds a condition on which the same acts as on another one.
    fn add_condition(&mut self, condition: Condition, like: usize) {
        self.conditions.push(condition);
        for acts in self.declared.iter_mut().chain(&mut self.effects) {
            acts.push(acts[like]);
        }
    }

    /// Adds a value with the mean noise of the others.
    fn add_row(&mut self, row: [usize; 2]) {
        let n = self.simulated_variance.len().max(1) as f64;
        let mean = self.simulated_variance.iter().sum::<f64>() / n;
        self.rows.push(row);
        self.simulated_variance.push(mean);
    }
}

#[cfg(test)]
mod tests;
