//! A smooth surface without a polynomial: the alternative when lack of fit persists.

use experiment_design::Factor;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::Serialize;

use crate::fit::pooled_variance;
use crate::{Error, Model, Observations};

/// Greatest number of cells: the work grows with its cube.
const MOST_CELLS: usize = 400;
/// Scale lengths searched, coded units.
const LENGTHS: [f64; 2] = [0.05, 20.0];

/// A Gaussian process with a linear trend, fitted to cell means.
#[derive(Debug, Clone, Serialize)]
pub struct GaussianProcess {
    /// The distance over which the surface changes along each factor, coded units.
    pub lengths_coded: Vec<f64>,
    /// Standard deviation of the surface about its trend, unit of the response.
    pub process_sd: f64,
    /// Standard deviation of a single run, unit of the response.
    pub run_sd: f64,
    /// Whether `run_sd` is that of the replicates (otherwise it was fitted with the rest).
    pub run_sd_from_replicates: bool,
    /// -2 ln of the restricted likelihood.
    pub minus_2_log_likelihood: f64,
    /// Root of the mean squared error of each cell predicted from the others, unit of the response.
    pub leave_one_out_rmse: f64,
    /// Everything a prediction needs.
    #[serde(skip)]
    state: State,
}

/// A fitted process.
#[derive(Debug, Clone)]
struct State {
    /// Coded settings of the cells.
    settings: Vec<Vec<f64>>,
    /// The trend.
    trend: Model,
    /// Coefficients of the trend.
    coefficients: DVector<f64>,
    /// K^-1 (y - F beta).
    weights: DVector<f64>,
    /// Factor of K.
    factor: Cholesky<f64, Dyn>,
    /// K^-1 F.
    solved_trend: DMatrix<f64>,
    /// (F' K^-1 F)^-1.
    trend_covariance: DMatrix<f64>,
}

/// Fits the process by restricted likelihood. The noise of a cell is the pooled variance of the
/// replicates over their number; without replicates it is fitted as well.
///
/// # Formula
/// `y = F beta + z + e`, `cov z(x, x') = s^2 exp(-sum ((x - x') / l)^2 / 2)`, `var e = s_run^2 / n`.
///
/// # Source
/// `[RasmussenWilliams2006, chapter 5]`; leave-one-out: eq. 5.12 there.
///
/// # Errors
/// [`Error::TooFewObservations`] for fewer than p + 2 cells; [`Error::SettingOutOfRange`] for more
/// than 400; those of the model.
pub fn gaussian_process(factors: &[Factor], data: &Observations) -> Result<GaussianProcess, Error> {
    let data = data.first_columns(factors.len());
    let cells = data.cells();
    let trend = Model::linear(factors)?;
    let (n, p) = (cells.len(), trend.terms().len());
    if n < p + 2 {
        return Err(Error::TooFewObservations {
            observations: n,
            terms: p + 2,
        });
    }
    if n > MOST_CELLS {
        return Err(Error::SettingOutOfRange {
            what: "the number of cells of a Gaussian process",
            value: n as f64,
            range: "400 at most; group replicates into cells, or take a polynomial",
        });
    }
    let pure = repeated_variance(&data);
    let problem = Problem {
        settings: cells.iter().map(|c| c.coded.clone()).collect(),
        counts: cells.iter().map(|c| c.n as f64).collect(),
        response: DVector::from_iterator(n, cells.iter().map(|c| c.mean)),
        basis: DMatrix::from_row_iterator(n, p, cells.iter().flat_map(|c| trend.row(&c.coded))),
        run_variance: pure,
    };
    let spread = problem.response.variance().max(f64::MIN_POSITIVE);
    let best = problem.search(factors.len(), spread);
    let (lengths, process, run) = problem.read(&best);
    let fitted = problem
        .solve(&lengths, process, run)
        .ok_or(Error::SettingOutOfRange {
            what: "the covariance of the cells",
            value: f64::NAN,
            range: "positive definite; the responses may be constant",
        })?;
    Ok(GaussianProcess {
        lengths_coded: lengths,
        process_sd: process.sqrt(),
        run_sd: run.sqrt(),
        run_sd_from_replicates: pure.is_some(),
        minus_2_log_likelihood: fitted.minus_2_log_likelihood,
        leave_one_out_rmse: fitted.leave_one_out_rmse,
        state: State {
            settings: problem.settings,
            trend,
            ..fitted.state
        },
    })
}

/// Variance of a run: replicates within cells, or rows that share their settings.
fn repeated_variance(data: &Observations) -> Option<f64> {
    let weights = vec![1.0; data.cells().len()];
    let between = crate::fit::pure_error_of(data, &weights);
    let single = data.cells().iter().all(|cell| cell.n == 1);
    let variance = pooled_variance(data).or_else(|| between.filter(|_| single).map(|p| p.ms));
    variance.filter(|v| *v > 0.0)
}

/// The data of a fit.
struct Problem {
    /// Coded settings.
    settings: Vec<Vec<f64>>,
    /// Runs per cell.
    counts: Vec<f64>,
    /// Means.
    response: DVector<f64>,
    /// F.
    basis: DMatrix<f64>,
    /// Variance of a run where known.
    run_variance: Option<f64>,
}

/// A solved problem.
struct Solved {
    /// As in [`GaussianProcess`].
    minus_2_log_likelihood: f64,
    /// As in [`GaussianProcess`].
    leave_one_out_rmse: f64,
    /// For predictions.
    state: State,
}

impl Problem {
    /// Lengths, process variance and run variance of logarithmic parameters.
    fn read(&self, parameters: &[f64]) -> (Vec<f64>, f64, f64) {
        let k = self.settings[0].len();
        let lengths = parameters[..k].iter().map(|l| l.exp()).collect();
        let run = self.run_variance.unwrap_or_else(|| parameters[k + 1].exp());
        (lengths, parameters[k].exp(), run)
    }

    /// The best parameters by a compass search from three starts.
    fn search(&self, k: usize, spread: f64) -> Vec<f64> {
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in [0.5_f64, 1.5, 5.0] {
            let mut at = vec![start.ln(); k];
            at.push(spread.ln());
            at.push((0.1 * spread).ln());
            let cost = |at: &[f64]| self.cost(at, spread);
            let reached = compass(&mut at, &cost);
            if best.as_ref().is_none_or(|(least, _)| reached < *least) {
                best = Some((reached, at));
            }
        }
        best.map(|(_, at)| at).unwrap_or_default()
    }

    /// -2 ln likelihood of logarithmic parameters, infinite outside the range searched.
    fn cost(&self, parameters: &[f64], spread: f64) -> f64 {
        let (lengths, process, run) = self.read(parameters);
        let inside = lengths
            .iter()
            .all(|l| (LENGTHS[0]..=LENGTHS[1]).contains(l));
        let sizes = [process, run]
            .iter()
            .all(|v| (1e-8..1e4).contains(&(v / spread)) || self.run_variance == Some(*v));
        if !(inside && sizes) {
            return f64::INFINITY;
        }
        self.solve(&lengths, process, run)
            .map_or(f64::INFINITY, |solved| solved.minus_2_log_likelihood)
    }

    /// Solves for the trend; none if the covariance is not positive definite.
    fn solve(&self, lengths: &[f64], process: f64, run: f64) -> Option<Solved> {
        let n = self.settings.len();
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let noise = if i == j { run / self.counts[i] } else { 0.0 };
            process * correlation(&self.settings[i], &self.settings[j], lengths) + noise
        });
        let factor = Cholesky::new(covariance)?;
        let solved_trend = factor.solve(&self.basis);
        let information = self.basis.tr_mul(&solved_trend);
        let trend_factor = Cholesky::new(information.clone())?;
        let coefficients = trend_factor.solve(&solved_trend.tr_mul(&self.response));
        let rest = &self.response - &self.basis * &coefficients;
        let weights = factor.solve(&rest);
        let trend_covariance = trend_factor.inverse();
        let log_det = |f: &Cholesky<f64, Dyn>| -> f64 {
            2.0 * f.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
        };
        let inverse =
            factor.inverse() - &solved_trend * &trend_covariance * solved_trend.transpose();
        let errors = (0..n).map(|i| (weights[i] / inverse[(i, i)]).powi(2));
        Some(Solved {
            minus_2_log_likelihood: log_det(&factor) + log_det(&trend_factor) + rest.dot(&weights),
            leave_one_out_rmse: (errors.sum::<f64>() / n as f64).sqrt(),
            state: State {
                settings: Vec::new(),
                trend: Model::of_degree(0, &[]),
                coefficients,
                weights,
                factor,
                solved_trend,
                trend_covariance,
            },
        })
    }
}

/// Correlation of the surface at two points.
fn correlation(a: &[f64], b: &[f64], lengths: &[f64]) -> f64 {
    let gaps = a.iter().zip(b).zip(lengths);
    (-0.5 * gaps.map(|((x, y), l)| ((x - y) / l).powi(2)).sum::<f64>()).exp()
}

/// Moves one parameter at a time by a step that halves where nothing improves; returns the cost.
pub(crate) fn compass(at: &mut [f64], cost: &dyn Fn(&[f64]) -> f64) -> f64 {
    let mut reached = cost(at);
    let mut step = 1.0;
    while step > 1e-3 {
        let before = reached;
        for j in 0..at.len() {
            for direction in [step, -step] {
                let kept = at[j];
                at[j] += direction;
                let value = cost(at);
                if value < reached {
                    reached = value;
                } else {
                    at[j] = kept;
                }
            }
        }
        if before - reached < 1e-9 {
            step *= 0.5;
        }
    }
    reached
}

impl GaussianProcess {
    /// The surface at a coded point with its standard error, unit of the response.
    pub fn predict(&self, coded: &[f64]) -> (f64, f64) {
        let state = &self.state;
        let n = state.settings.len();
        let process = self.process_sd * self.process_sd;
        let near = DVector::from_fn(n, |i, _| {
            process * correlation(coded, &state.settings[i], &self.lengths_coded)
        });
        let row = DVector::from_vec(state.trend.row(coded));
        let mean = row.dot(&state.coefficients) + near.dot(&state.weights);
        let left = row - state.solved_trend.tr_mul(&near);
        let variance = process - near.dot(&state.factor.solve(&near))
            + left.dot(&(&state.trend_covariance * &left));
        (mean, variance.max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::gaussian_process;
    use crate::{Cell, Model, Observations, fit};
    use experiment_design::{Factor, latin_hypercube};

    /// A wave that no quadratic follows: the process must predict left-out cells several times
    /// better, and between the cells to a tenth of the wave.
    #[test]
    fn a_wave_is_followed_where_a_quadratic_fails() {
        let factors = ["A", "B"].map(|s| Factor::coded_only(s).unwrap());
        let design = latin_hypercube(&factors, 40, 3).unwrap();
        let truth = |x: &[f64]| (4.0 * x[0]).sin() + x[1];
        let cells = design.coded_rows().into_iter().map(|x| {
            let y = truth(&x);
            Cell {
                sd: Some(0.02),
                n: 4,
                ..Cell::single(x, y)
            }
        });
        let data = Observations::from_cells(cells.collect()).unwrap();
        let process = gaussian_process(&factors, &data).unwrap();
        assert!(process.run_sd_from_replicates && (process.run_sd - 0.02).abs() < 1e-12);
        let polynomial = fit(&factors, &Model::quadratic(&factors).unwrap(), &data).unwrap();
        let rmse = (polynomial.press.unwrap() / 40.0).sqrt();
        assert!(
            process.leave_one_out_rmse < rmse / 3.0,
            "{process:?} against {rmse}"
        );
        for x in [[0.1, 0.2], [-0.5, 0.4], [0.6, -0.7]] {
            let (mean, se) = process.predict(&x);
            assert!(
                (mean - truth(&x)).abs() < 0.1 && se < 0.1,
                "{mean} +- {se} at {x:?}"
            );
        }
    }
}
