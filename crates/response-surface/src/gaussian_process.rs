//! A smooth surface without a polynomial: the alternative when lack of fit persists.

use experiment_design::Factor;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::Serialize;

use crate::fit::pooled_variance;
use crate::goals::simplex::minimum;
use crate::{Error, Model, Observations};
use probability::normal_quantile;

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
    /// Degrees of freedom of the replicates within cells, whose scatter counts in the likelihood.
    pub replicate_df: usize,
    /// -2 ln of the restricted likelihood of the cells and the scatter within them, but for a constant.
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

/// Fits the process by restricted likelihood, the variance of a run with the rest. Replicates that are given as the standard
/// deviation of a cell count as if their runs stood in rows of their own.
///
/// # Formula
/// `y = F beta + z + e`, `cov z(x, x') = s^2 exp(-sum ((x - x') / l)^2 / 2)`, `var e = s_run^2 / n`. Within cells the sum of
/// squares S of nu degrees of freedom adds `nu ln s_run^2 + S / s_run^2` to -2 ln of the likelihood.
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
    let replicate_df = replicate_df(&data);
    let within = pooled_variance(&data).unwrap_or(0.0);
    let problem = Problem {
        settings: cells.iter().map(|c| c.coded.clone()).collect(),
        counts: cells.iter().map(|c| c.n as f64).collect(),
        response: DVector::from_iterator(n, cells.iter().map(|c| c.mean)),
        basis: DMatrix::from_row_iterator(n, p, cells.iter().flat_map(|c| trend.row(&c.coded))),
        replicate_df: replicate_df as f64,
        within_squares: within * replicate_df as f64,
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
        replicate_df,
        minus_2_log_likelihood: fitted.minus_2_log_likelihood,
        leave_one_out_rmse: fitted.leave_one_out_rmse,
        state: State {
            settings: problem.settings,
            trend,
            ..fitted.state
        },
    })
}

/// Degrees of freedom of the replicates within cells.
fn replicate_df(data: &Observations) -> usize {
    let of_cell = |cell: &crate::Cell| cell.sd.map_or(0, |_| cell.n.saturating_sub(1));
    data.cells().iter().map(of_cell).sum()
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
    /// Degrees of freedom of the replicates within cells.
    replicate_df: f64,
    /// Their sum of squares.
    within_squares: f64,
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
        (lengths, parameters[k].exp(), parameters[k + 1].exp())
    }

    /// The best parameters from three starts.
    fn search(&self, k: usize, spread: f64) -> Vec<f64> {
        let from = |length: f64| {
            let mut start = vec![length.ln(); k];
            start.extend([spread.ln(), (0.1 * spread).ln()]);
            minimum(&start, 1.0, &|at| self.cost(at, spread))
        };
        let starts = [0.5, 1.5, 5.0].map(from).into_iter();
        let best = starts.min_by(|a, b| a.0.total_cmp(&b.0));
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
            .all(|v| (1e-8..1e4).contains(&(v / spread)));
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
            minus_2_log_likelihood: log_det(&factor)
                + log_det(&trend_factor)
                + rest.dot(&weights)
                + self.replicate_df * run.ln()
                + self.within_squares / run,
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

/// Prediction of a process at one point, its parameters taken as known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ProcessPrediction {
    /// The surface, unit of the response.
    pub mean: f64,
    /// Its standard error, unit of the response.
    pub se_mean: f64,
    /// 95 % interval of the surface.
    pub ci95: [f64; 2],
    /// 95 % interval of a single run.
    pub pi95: [f64; 2],
}

impl GaussianProcess {
    /// The surface at a coded point with intervals of the surface and of a single run.
    ///
    /// # Formula
    /// `mean +- 1.96 se` and `mean +- 1.96 sqrt(se^2 + s_run^2)`, 1.96 the quantile of the normal distribution.
    pub fn prediction(&self, coded: &[f64]) -> ProcessPrediction {
        let (mean, se_mean) = self.predict(coded);
        let quantile = normal_quantile(0.975).unwrap_or(f64::INFINITY);
        let around = |sd: f64| [mean - quantile * sd, mean + quantile * sd];
        ProcessPrediction {
            mean,
            se_mean,
            ci95: around(se_mean),
            pi95: around(se_mean.hypot(self.run_sd)),
        }
    }

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
        // 120 degrees of freedom tell a standard deviation to 6.5 %; the means have no scatter of their own here, which draws
        // it down.
        assert_eq!(process.replicate_df, 120);
        assert!((process.run_sd / 0.02 - 1.0).abs() < 0.2, "{process:?}");
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

    /// A line with noise of sd 0.5 fitted without replicates: single new runs fall into their 95 % intervals in 95 % of
    /// 40 experiments of 25 runs. With 2000 new runs the share scatters by some 1.5 % (experiments share their errors);
    /// intervals of the surface alone would hold less than half of them.
    #[test]
    fn intervals_of_a_run_hold_new_runs() {
        let factors = [Factor::coded_only("A").unwrap()];
        let mut stream = probability::random_stream::Stream::new(5, "new runs");
        let (mut inside, mut of_surface) = (0, 0);
        for experiment in 0..40 {
            let design = latin_hypercube(&factors, 25, experiment).unwrap();
            let cells = design.coded_rows().into_iter();
            let cells = cells.map(|x| {
                let y = (2.0 * x[0]).sin() + 0.5 * stream.normal();
                Cell::single(x, y)
            });
            let data = Observations::from_cells(cells.collect()).unwrap();
            let process = gaussian_process(&factors, &data).unwrap();
            for _ in 0..50 {
                let x = stream.between(-1.0, 1.0);
                let y = (2.0 * x).sin() + 0.5 * stream.normal();
                let told = process.prediction(&[x]);
                let holds = |[low, high]: [f64; 2]| usize::from((low..=high).contains(&y));
                inside += holds(told.pi95);
                of_surface += holds(told.ci95);
            }
        }
        let share = |n: usize| n as f64 / 2000.0;
        assert!((share(inside) - 0.95).abs() < 0.04, "{}", share(inside));
        assert!(share(of_surface) < 0.6, "{}", share(of_surface));
    }

    /// Runs in rows of their own, or as means with their standard deviations: the same likelihood but for a constant, so
    /// that parameters and predictions agree to the tolerance of the search (1e-4 of the scatter of a run).
    #[test]
    fn replicates_count_alike_in_rows_and_in_cells() {
        let factors = [Factor::coded_only("A").unwrap()];
        let mut stream = probability::random_stream::Stream::new(9, "replicates");
        let (mut rows, mut means) = (Vec::new(), Vec::new());
        for i in 0..12 {
            let x = f64::from(i) / 5.5 - 1.0;
            let runs = [0; 3].map(|_| (3.0 * x).sin() + 0.2 * stream.normal());
            rows.extend(runs.map(|y| Cell::single(vec![x], y)));
            let mean = runs.iter().sum::<f64>() / 3.0;
            let squares: f64 = runs.iter().map(|y| (y - mean).powi(2)).sum();
            means.push(Cell {
                sd: Some((squares / 2.0).sqrt()),
                n: 3,
                ..Cell::single(vec![x], mean)
            });
        }
        let of = |cells: Vec<Cell>| {
            gaussian_process(&factors, &Observations::from_cells(cells).unwrap()).unwrap()
        };
        let (rows, means) = (of(rows), of(means));
        assert_eq!((rows.replicate_df, means.replicate_df), (0, 24));
        assert!(
            (rows.run_sd - means.run_sd).abs() < 2e-5,
            "{rows:?} {means:?}"
        );
        for x in [-0.8, 0.1, 1.1] {
            let (a, b) = (rows.prediction(&[x]), means.prediction(&[x]));
            for (a, b) in [
                (a.mean, b.mean),
                (a.se_mean, b.se_mean),
                (a.pi95[0], b.pi95[0]),
            ] {
                assert!((a - b).abs() < 2e-5, "{a} against {b} at {x}");
            }
        }
    }
}
