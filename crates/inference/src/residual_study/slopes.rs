//! Slopes with the declared parameters: a regression over all runs at which no effect is on.

use super::ResidualPlan;
use super::runs::{Means, Setting};
use crate::Parameter;
use nalgebra::DMatrix;
use response_surface::{Model, Polynomials};

/// Runs without an effect: the start, a step in each declared parameter, and where the fit went.
#[derive(Debug, Clone)]
pub(super) struct Points {
    /// The start, then a step in each declared parameter.
    beside: Vec<Point>,
    visited: Vec<Point>,
    /// Step of each declared parameter.
    steps: Vec<f64>,
    /// Whether each parameter moves the runs of a condition, (parameters, conditions).
    moves: Vec<Vec<bool>>,
}

/// A point that was run.
#[derive(Debug, Clone)]
struct Point {
    /// Declared parameters in the order of the plan.
    parameters: Vec<f64>,
    /// Means, (conditions, observables).
    values: Vec<Vec<f64>>,
    /// Number of runs in each mean, the least of all conditions.
    n: usize,
}

/// An error of the slopes, independent of the others: at each condition one of the covariance of a run.
#[derive(Debug, Clone)]
pub(super) struct SlopeError {
    /// How many times the error each slope has, 1 / (unit of the parameter).
    pub(super) along: Vec<f64>,
    /// Whether it is there at a condition.
    pub(super) at: Vec<bool>,
}

/// Slopes at a condition, (observables, parameters or effects).
pub(super) type ConditionSlopes = Vec<Vec<f64>>;

#[derive(Debug, Clone)]
pub(super) struct Slopes {
    /// d observable / d parameter, (conditions, observables, parameters); 0 where a parameter moves nothing.
    pub(super) values: Vec<ConditionSlopes>,
    pub(super) errors: Vec<SlopeError>,
}

impl Point {
    fn new(setting: &Setting, means: &Means) -> Self {
        Self {
            parameters: setting.parameters.clone(),
            values: means.values.clone(),
            n: means.least_n(),
        }
    }
}

impl Points {
    /// The start and a step in each declared parameter.
    pub(super) fn new<'a>(
        plan: &ResidualPlan,
        beside: impl Iterator<Item = (&'a Setting, &'a Means)>,
        moves: &[Vec<bool>],
    ) -> Self {
        let point = |(setting, means)| Point::new(setting, means);
        Self {
            beside: beside.map(point).collect(),
            visited: Vec::new(),
            steps: plan.parameters.iter().map(Parameter::step).collect(),
            moves: moves[..plan.parameters.len()].to_vec(),
        }
    }

    /// Takes in a point with seeds of its own.
    pub(super) fn visit(&mut self, setting: &Setting, means: &Means) {
        self.visited.push(Point::new(setting, means));
    }

    /// The slopes by all points.
    ///
    /// # Formula
    ///
    /// Ordinary least squares with an intercept at each condition over the parameters that move it, each point with the
    /// weight of its runs; with the start and the steps alone these are difference quotients. The covariance of the
    /// slopes is that of a run times the block C of the inverse of the normal matrix; its Cholesky factor gives errors
    /// that are independent of each other.
    ///
    /// Where a fit goes far from a start, a step beside the start says little of what lies between: its noise, times the
    /// way, would let the slopes promise anything. The runs at both ends know.
    pub(super) fn slopes(&self) -> Slopes {
        let Some(start) = self.beside.first() else {
            return Slopes {
                values: Vec::new(),
                errors: Vec::new(),
            };
        };
        let p = self.steps.len();
        let zero = |row: &Vec<f64>| vec![vec![0.0; p]; row.len()];
        let mut values: Vec<_> = start.values.iter().map(zero).collect();
        let mut errors = Vec::new();
        let conditions: Vec<usize> = (0..values.len()).collect();
        let moving = |c: usize| (0..p).filter(|&j| self.moves[j][c]).collect::<Vec<_>>();
        let mut kinds: Vec<Vec<usize>> = conditions.iter().map(|&c| moving(c)).collect();
        kinds.sort();
        kinds.dedup();
        for kind in kinds.iter().filter(|kind| !kind.is_empty()) {
            let same: Vec<usize> = conditions
                .iter()
                .copied()
                .filter(|&c| moving(c) == *kind)
                .collect();
            // A step that moves nothing here is the start once more, with its seeds.
            let steps = kind.iter().filter_map(|&j| self.beside.get(1 + j));
            let points = std::iter::once(start).chain(steps).chain(&self.visited);
            let points: Vec<&Point> = points.collect();
            let Some(plane) = self.plane(&points, (start, kind), &same) else {
                continue;
            };
            let mut column = 0;
            for &c in &same {
                for of_observable in &mut values[c] {
                    for (line, &j) in kind.iter().enumerate() {
                        of_observable[j] = plane.coefficients[(1 + line, column)] / self.steps[j];
                    }
                    column += 1;
                }
            }
            // Steps are not 0, so that C is positive definite but for rounding.
            let block = plane.inverse.view((1, 1), (kind.len(), kind.len()));
            let factor = block.into_owned().cholesky().map(|root| root.l());
            for column in factor.iter().flat_map(|factor| factor.column_iter()) {
                let mut along = vec![0.0; p];
                for (&j, x) in kind.iter().zip(column.iter()) {
                    along[j] = x / self.steps[j];
                }
                let at = conditions.iter().map(|c| same.contains(c)).collect();
                errors.push(SlopeError { along, at });
            }
        }
        Slopes { values, errors }
    }

    /// The plane over some parameters, each over its step, through the observables of some conditions one behind the other.
    fn plane(
        &self,
        points: &[&Point],
        (start, kind): (&Point, &[usize]),
        conditions: &[usize],
    ) -> Option<Polynomials> {
        let way = |at: &Point, j: usize| (at.parameters[j] - start.parameters[j]) / self.steps[j];
        let coded: Vec<Vec<f64>> = points
            .iter()
            .map(|at| kind.iter().map(|&j| way(at, j)).collect())
            .collect();
        let weights: Vec<f64> = points.iter().map(|at| at.n as f64).collect();
        let seen = |at: &&Point| {
            conditions
                .iter()
                .flat_map(|&c| at.values[c].clone())
                .collect()
        };
        let rows: Vec<Vec<f64>> = points.iter().map(seen).collect();
        let responses = DMatrix::from_fn(rows.len(), rows[0].len(), |i, k| rows[i][k]);
        let symbols = kind.iter().map(|j| format!("x{j}")).collect();
        let mut powers = vec![vec![0; kind.len()]; 1 + kind.len()];
        (0..kind.len()).for_each(|j| powers[1 + j][j] = 1);
        let model = Model::of_powers(symbols, powers);
        Polynomials::fit(&model, &coded, &responses, &weights).ok()
    }
}
