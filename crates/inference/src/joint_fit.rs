//! The joint estimate: generalised least squares over the surfaces of all measurements.
//!
//! # Formula
//!
//! Q(theta) = r' V^-1 r + sum over priors of ((theta - mean) / sd)², with r = measured - surface(theta), V the covariance
//! of the measured means plus that of the surfaces there, `x'(X'X)^-1 x` times that of a run. V is taken at
//! the last estimate and renewed until it stands. The least Q is searched inside the box by Levenberg's and
//! Marquardt's steps from many starts `[Marquardt1963]`.

use crate::correlated::correlation_of;
use crate::diagnosis::{Covariance, Whitener};
use crate::region::Region;
use crate::surface::Surface;
use crate::{CalibrationProblem, Error, Parameter, Role};
use nalgebra::{Cholesky, DMatrix, DVector};
use probability::random_stream::Stream;

/// Steps of one search; it ends by itself long before.
const MOST_STEPS: usize = 200;
/// Random starts beside the middle and the middles of the faces.
const RANDOM_STARTS: usize = 24;
/// Renewals of V at the estimate.
const RENEWALS: usize = 4;
/// Relative fall of Q below which a search has ended.
const FLAT: f64 = 1e-13;

/// A measured mean that the estimate uses.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Target {
    /// Number of the measurement in the problem.
    pub(crate) measurement: usize,
    /// Number of the surfaces in the list of the fit.
    pub(crate) surface: usize,
    /// Place of the observable there.
    pub(crate) observable: usize,
    pub(crate) mean: f64,
    pub(crate) degrees_of_freedom: f64,
}

/// Surfaces, measurements and priors in a box.
#[derive(Debug)]
pub(crate) struct JointFit<'a> {
    /// What was measured, and how its means go together.
    problem: &'a CalibrationProblem,
    pub(crate) parameters: &'a [Parameter],
    /// Where the search is made; its coordinates are -1 to 1 there.
    pub(crate) region: &'a Region,
    pub(crate) surfaces: &'a [Surface],
    /// What was measured, those of one surface behind each other.
    pub(crate) targets: Vec<Target>,
    /// Whether a parameter is searched; the others stay at their start.
    pub(crate) free: Vec<bool>,
}

/// A least value that a search found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Minimum {
    /// Coordinates in the box.
    pub(crate) coded: Vec<f64>,
    /// Q there.
    pub(crate) misfit: f64,
}

/// A further row of the sum of squares: the distance along a direction from a point, times a weight.
#[derive(Debug, Clone)]
pub(crate) struct Penalty {
    /// Direction of unit length, coded.
    pub(crate) direction: DVector<f64>,
    /// The distance along it that is asked for.
    pub(crate) distance: f64,
    pub(crate) weight: f64,
}

impl<'a> JointFit<'a> {
    /// Joins the measurements of some roles to surfaces; a parameter on which no surface and no prior depends stays at its
    /// start.
    pub(crate) fn new(
        problem: &'a CalibrationProblem,
        region: &'a Region,
        surfaces: &'a [Surface],
        roles: &[Role],
    ) -> Self {
        let parameters = &problem.parameters;
        let mut targets = Vec::new();
        for (s, surface) in surfaces.iter().enumerate() {
            let all = problem.measurements.iter().enumerate();
            let of_model = all.filter(|(_, m)| m.model == surface.model && roles.contains(&m.role));
            targets.extend(of_model.filter_map(|(measurement, m)| {
                Some(Target {
                    measurement,
                    surface: s,
                    observable: surface.place(&m.observable)?,
                    mean: m.mean,
                    degrees_of_freedom: m.degrees_of_freedom(),
                })
            }));
        }
        let acts = |j: usize| surfaces.iter().any(|s| s.parameters.contains(&j));
        let each = parameters.iter().enumerate();
        let free = each.map(|(j, p)| acts(j) || p.prior.is_some());
        Self {
            problem,
            parameters,
            region,
            surfaces,
            targets,
            free: free.collect(),
        }
    }

    /// Number of the parameters that are tuned; those behind them are inputs.
    pub(crate) fn n_tuned(&self) -> usize {
        self.problem.n_tuned()
    }

    /// Number of parameters that are searched.
    pub(crate) fn n_free(&self) -> usize {
        self.free.iter().filter(|f| **f).count()
    }

    /// Whether the fit uses a surface; otherwise it is that of a check, in a joint estimate.
    pub(crate) fn is_fitted(&self, surface: usize) -> bool {
        let model = self.surfaces[surface].model;
        let mut measurements = self.problem.measurements.iter();
        measurements.any(|m| m.model == model && m.role == Role::Fit)
    }

    pub(crate) fn n_priors(&self) -> usize {
        self.parameters.iter().filter(|p| p.prior.is_some()).count()
    }

    /// A point of the box as values of the parameters; those that are not searched at their start.
    pub(crate) fn natural(&self, coded: &[f64]) -> Vec<f64> {
        let value = |(j, x): (usize, &f64)| {
            if self.free[j] {
                self.region.natural(j, *x)
            } else {
                self.parameters[j].start
            }
        };
        coded.iter().enumerate().map(value).collect()
    }

    pub(crate) fn surface_covariance(&self, block: &[Target], at: &[f64]) -> DMatrix<f64> {
        let surface = &self.surfaces[block[0].surface];
        let leverage = surface.leverage(at);
        DMatrix::from_fn(block.len(), block.len(), |a, b| {
            leverage * surface.covariance[(block[a].observable, block[b].observable)]
        })
    }

    /// Correlation of the measured means of two targets.
    pub(crate) fn correlation(&self, a: &Target, b: &Target) -> f64 {
        correlation_of(self.problem, a.measurement, b.measurement)
    }

    /// Variance of the measured value of a target, at a point of all parameters.
    pub(crate) fn measured_variance(&self, target: &Target, at: &[f64]) -> f64 {
        let simulated = self.surfaces[target.surface].value(target.observable, at);
        self.problem.measurements[target.measurement].variance_at(simulated)
    }

    pub(crate) fn measured_covariance(&self, block: &[Target], at: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(block.len(), block.len(), |a, b| {
            let (a, b) = (&block[a], &block[b]);
            let [of_a, of_b] = [a, b].map(|target| self.measured_variance(target, at));
            self.correlation(a, b) * (of_a * of_b).sqrt()
        })
    }

    /// Targets of each surface, with the number of the first.
    pub(crate) fn blocks(&self) -> Vec<(usize, &[Target])> {
        let mut first = 0;
        let groups = self.targets.chunk_by(|a, b| a.surface == b.surface);
        groups
            .map(|group| {
                let at = first;
                first += group.len();
                (at, group)
            })
            .collect()
    }

    /// Roots of V at a point, one block for each surface.
    ///
    /// # Errors
    ///
    /// A covariance that is not positive definite.
    pub(crate) fn whitening(&self, at: &[f64]) -> Result<Whitener, Error> {
        let (mut blocks, mut models) = (Vec::new(), Vec::new());
        for (_, block) in self.blocks() {
            blocks.push(self.surface_covariance(block, at) + self.measured_covariance(block, at));
            let model = self.surfaces[block[0].surface].model;
            models.push(self.problem.models[model].name.clone());
        }
        Ok(Covariance::new(blocks, models).whitener()?)
    }

    /// Measured means minus the surfaces at a point of all parameters.
    fn differences(&self, at: &[f64]) -> DVector<f64> {
        let difference = |t: &Target| t.mean - self.surfaces[t.surface].value(t.observable, at);
        DVector::from_iterator(self.targets.len(), self.targets.iter().map(difference))
    }

    /// Whitened residuals of targets, priors and penalties, and their derivatives along the coordinates.
    pub(crate) fn residuals(
        &self,
        coded: &[f64],
        whitening: &Whitener,
        penalties: &[Penalty],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let (n, k) = (self.targets.len(), self.parameters.len());
        let rows = n + self.n_priors() + penalties.len();
        let at = self.natural(coded);
        let mut slopes = DMatrix::zeros(n, k);
        for (row, target) in self.targets.iter().enumerate() {
            let surface = &self.surfaces[target.surface];
            let each = surface.slopes(target.observable, &at);
            for (&j, slope) in surface.parameters.iter().zip(each) {
                slopes[(row, j)] = -slope * self.region.half(j);
            }
        }
        let mut r = whitening
            .whiten_vector(&self.differences(&at))
            .resize_vertically(rows, 0.0);
        let mut jacobian = whitening.whiten(&slopes).resize_vertically(rows, 0.0);
        let mut row = n;
        for (j, parameter) in self.parameters.iter().enumerate() {
            if let Some(prior) = parameter.prior {
                r[row] = (prior.mean - at[j]) / prior.sd;
                jacobian[(row, j)] = -self.region.half(j) / prior.sd;
                row += 1;
            }
        }
        let x = DVector::from_column_slice(coded);
        for penalty in penalties {
            r[row] = penalty.weight * (penalty.direction.dot(&x) - penalty.distance);
            let derivative = penalty.direction.transpose() * penalty.weight;
            jacobian.row_mut(row).copy_from(&derivative);
            row += 1;
        }
        (r, jacobian)
    }

    /// Q at a point.
    pub(crate) fn misfit(&self, coded: &[f64], whitening: &Whitener) -> f64 {
        let at = self.natural(coded);
        let distance = |(p, x): (&Parameter, &f64)| {
            p.prior
                .map_or(0.0, |prior| ((prior.mean - x) / prior.sd).powi(2))
        };
        let priors: f64 = self.parameters.iter().zip(&at).map(distance).sum();
        whitening
            .whiten_vector(&self.differences(&at))
            .norm_squared()
            + priors
    }

    /// A point with its inputs where Q is least: surfaces are straight along inputs.
    pub(crate) fn with_best_inputs(&self, mut coded: Vec<f64>, whitening: &Whitener) -> Minimum {
        let tuned = self.n_tuned();
        if tuned < coded.len() {
            let (r, jacobian) = self.residuals(&coded, whitening, &[]);
            let slopes = jacobian.columns_range(tuned..);
            // Each input has a prior, so that it has a root.
            if let Some(root) = Cholesky::new(slopes.tr_mul(&slopes)) {
                let step = root.solve(&slopes.tr_mul(&r));
                for (x, step) in coded[tuned..].iter_mut().zip(step.iter()) {
                    *x = (*x - step).clamp(-1.0, 1.0);
                }
            }
        }
        let misfit = self.misfit(&coded, whitening);
        Minimum { coded, misfit }
    }

    /// Walks down from a start inside the box, along the free coordinates of `free`.
    pub(crate) fn minimise(
        &self,
        start: &[f64],
        whitening: &Whitener,
        free: &[bool],
        penalties: &[Penalty],
    ) -> Minimum {
        let mut coded: Vec<f64> = start.iter().map(|x| x.clamp(-1.0, 1.0)).collect();
        let (mut r, mut jacobian) = self.residuals(&coded, whitening, penalties);
        let mut misfit = r.norm_squared();
        let mut damping = 1e-4;
        for _ in 0..MOST_STEPS {
            let gradient = jacobian.tr_mul(&r);
            let blocked = |j: usize| coded[j] * gradient[j].signum() <= -1.0 && gradient[j] != 0.0;
            let moving: Vec<usize> = (0..coded.len())
                .filter(|&j| free[j] && !blocked(j))
                .collect();
            if moving.is_empty() {
                break;
            }
            let step = damped_step(&jacobian, &gradient, &moving, damping);
            let mut trial = coded.clone();
            for (&j, step) in moving.iter().zip(step.iter()) {
                trial[j] = (trial[j] + step).clamp(-1.0, 1.0);
            }
            let (new_r, new_jacobian) = self.residuals(&trial, whitening, penalties);
            let new = new_r.norm_squared();
            if new < misfit {
                let fall = misfit - new;
                (coded, r, jacobian, misfit) = (trial, new_r, new_jacobian, new);
                damping = (damping * 0.2).max(1e-12);
                if fall <= FLAT * (1.0 + misfit) {
                    break;
                }
            } else {
                damping *= 5.0;
                if damping > 1e10 {
                    break;
                }
            }
        }
        Minimum { coded, misfit }
    }

    /// The least Q in the box, with V at the estimate, and all local minima that were met on the way, best first.
    ///
    /// # Errors
    ///
    /// A covariance that is not positive definite.
    pub(crate) fn solve(&self, seed: u64) -> Result<(Vec<Minimum>, Whitener), Error> {
        let middle = vec![0.0; self.parameters.len()];
        let mut whitening = self.whitening(&self.natural(&middle))?;
        let mut minima: Vec<Minimum> = self
            .starts(seed)
            .iter()
            .map(|start| self.minimise(start, &whitening, &self.free, &[]))
            .collect();
        for _ in 0..RENEWALS {
            minima.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
            minima = distinct(minima);
            let Some(best) = minima.first() else { break };
            whitening = self.whitening(&self.natural(&best.coded))?;
            let again = minima.iter();
            let again = again.map(|m| self.minimise(&m.coded, &whitening, &self.free, &[]));
            minima = again.collect();
        }
        minima.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        Ok((distinct(minima), whitening))
    }

    /// Where the searches start: the middle, the middles of the faces, and random points.
    fn starts(&self, seed: u64) -> Vec<Vec<f64>> {
        let k = self.parameters.len();
        let mut starts = vec![vec![0.0; k]];
        for j in (0..k).filter(|&j| self.free[j]) {
            for side in [-0.7, 0.7] {
                let mut start = vec![0.0; k];
                start[j] = side;
                starts.push(start);
            }
        }
        let mut stream = Stream::new(seed, "starts of the joint fit");
        for _ in 0..RANDOM_STARTS {
            starts.push((0..k).map(|_| stream.between(-1.0, 1.0)).collect());
        }
        starts
    }
}

/// The step of Levenberg and Marquardt along some coordinates.
fn damped_step(
    jacobian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    moving: &[usize],
    damping: f64,
) -> DVector<f64> {
    let columns = jacobian.select_columns(moving);
    let mut normal = columns.tr_mul(&columns);
    let largest = normal.diagonal().max().max(f64::MIN_POSITIVE);
    for d in 0..moving.len() {
        normal[(d, d)] += damping * normal[(d, d)].max(1e-9 * largest);
    }
    let right = DVector::from_iterator(moving.len(), moving.iter().map(|&j| -gradient[j]));
    // Damped, the matrix is positive definite unless nothing depends on anything.
    Cholesky::new(normal).map_or_else(|| DVector::zeros(moving.len()), |root| root.solve(&right))
}

/// Minima without those that are another one again, the best first.
fn distinct(minima: Vec<Minimum>) -> Vec<Minimum> {
    let mut kept: Vec<Minimum> = Vec::new();
    for minimum in minima {
        let near = |other: &Minimum| {
            let pairs = other.coded.iter().zip(&minimum.coded);
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() < 1e-4
        };
        if !kept.iter().any(near) {
            kept.push(minimum);
        }
    }
    kept
}
