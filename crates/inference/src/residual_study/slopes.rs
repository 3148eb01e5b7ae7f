//! Slopes with the declared parameters: a regression over all runs at which no effect is on.

use super::ResidualPlan;
use super::runs::{Means, Setting};
use nalgebra::{DMatrix, DVector};

/// Runs without an effect: the start, a step in each declared parameter, and where the fit went.
#[derive(Debug, Clone)]
pub(super) struct Points {
    /// The start, then a step in each declared parameter.
    beside: Vec<Point>,
    /// Further points.
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

/// Slopes with their errors.
#[derive(Debug, Clone)]
pub(super) struct Slopes {
    /// d observable / d parameter, (conditions, observables, parameters); 0 where a parameter moves nothing.
    pub(super) values: Vec<ConditionSlopes>,
    /// Their errors.
    pub(super) errors: Vec<SlopeError>,
}

impl Point {
    /// The means at a setting.
    fn new(plan: &ResidualPlan, setting: &Setting, means: &Means) -> Self {
        Self {
            parameters: setting.declared_values(plan),
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
        let point = |(setting, means)| Point::new(plan, setting, means);
        Self {
            beside: beside.map(point).collect(),
            visited: Vec::new(),
            steps: plan.declared.iter().map(|d| d.step).collect(),
            moves: moves[..plan.declared.len()].to_vec(),
        }
    }

    /// Takes in a point with seeds of its own.
    pub(super) fn visit(&mut self, plan: &ResidualPlan, setting: &Setting, means: &Means) {
        self.visited.push(Point::new(plan, setting, means));
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
            let (points, to_slopes, covariance) = self.normal_equations(start, kind);
            for &c in &same {
                for k in 0..values[c].len() {
                    let seen = points.iter().map(|point| point.values[c][k]);
                    let slopes = &to_slopes * DVector::from_iterator(points.len(), seen);
                    for (&j, slope) in kind.iter().zip(slopes.iter()) {
                        values[c][k][j] = slope / self.steps[j];
                    }
                }
            }
            // Steps are not 0, so that C is positive definite but for rounding.
            let factor = covariance.cholesky().map(|root| root.l());
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

    /// The points that tell of some parameters, what takes their values to slopes, and the block C; slopes over steps.
    fn normal_equations<'a>(
        &'a self,
        start: &'a Point,
        kind: &[usize],
    ) -> (Vec<&'a Point>, DMatrix<f64>, DMatrix<f64>) {
        // A step that moves nothing here is the start once more, with its seeds.
        let steps = kind.iter().filter_map(|&j| self.beside.get(1 + j));
        let points: Vec<&Point> = std::iter::once(start)
            .chain(steps)
            .chain(&self.visited)
            .collect();
        let (n, q) = (points.len(), kind.len());
        let x = DMatrix::from_fn(n, 1 + q, |i, column| match column.checked_sub(1) {
            None => 1.0,
            Some(j) => {
                let j = kind[j];
                (points[i].parameters[j] - start.parameters[j]) / self.steps[j]
            }
        });
        let weights = DMatrix::from_diagonal(&DVector::from_iterator(
            n,
            points.iter().map(|p| p.n as f64),
        ));
        let weighted = x.tr_mul(&weights);
        let inverse = (&weighted * &x)
            .try_inverse()
            .unwrap_or_else(|| DMatrix::zeros(1 + q, 1 + q));
        let to_slopes = (&inverse * weighted).rows(1, q).into_owned();
        (points, to_slopes, inverse.view((1, 1), (q, q)).into_owned())
    }
}
