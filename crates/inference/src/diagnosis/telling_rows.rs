//! Whitened rows with the noise of their sensitivities: the information of an experiment.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::Error;
use crate::diagnosis::problem::{Experiment, Problem, SlopeNoise};
use crate::diagnosis::space::Space;

/// Share of the scale of the parameters that keeps ln det finite before they are all seen.
const RIDGE: f64 = 1e-9;

/// Whitened rows that grow as experiments are added.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    /// S~ (rows, parameters).
    declared: DMatrix<f64>,
    /// l~ (rows, effects).
    library: DMatrix<f64>,
    noise: Vec<RowNoise>,
}

/// Noise of the sensitivities of rows that follow each other, whitened.
#[derive(Debug, Clone)]
struct RowNoise {
    /// The first of the rows.
    first: usize,
    /// How the noise of the columns is given.
    kind: NoiseKind,
}

/// How the noise of the columns is given.
#[derive(Debug, Clone)]
enum NoiseKind {
    /// Independent errors of the sensitivities to the declared parameters, each with the share that the parameters have of
    /// it, and a covariance of each effect; empty where exact.
    Columns(Vec<(DVector<f64>, DMatrix<f64>)>, Vec<DMatrix<f64>>),
    /// Means of runs at a point and a step beside it in each column.
    Runs {
        of_mean: DMatrix<f64>,
        /// One over the step of each declared parameter, and behind them of each effect; 0 where it has the noise of the
        /// point.
        inverse_steps: Vec<f64>,
    },
}

/// Two effects to be distinguished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    /// Taken as true.
    pub(crate) effect: usize,
    /// Fitted in its place.
    pub(crate) rival: usize,
    /// Posterior mean of the squared amplitude of the true one.
    pub(crate) mean_square: f64,
}

impl Rows {
    /// The rows that there are already, those of the prior included.
    pub(crate) fn of(problem: &Problem) -> Result<Self, Error> {
        let part = &problem.used;
        let whitener = part.covariance.whitener()?;
        let white = |covariance: &DMatrix<f64>| whitener.whiten_covariance(covariance);
        let of_slopes =
            |noise: &SlopeNoise| (noise.along.clone(), white(&noise.covariance.whole()));
        let kind = NoiseKind::Columns(
            part.declared_noise.iter().map(of_slopes).collect(),
            part.library_noise
                .iter()
                .map(|c| white(&c.whole()))
                .collect(),
        );
        let rows = Self {
            declared: whitener.whiten(&part.declared),
            library: whitener.whiten(&part.library),
            noise: vec![RowNoise { first: 0, kind }],
        };
        Ok(match &problem.prior {
            None => rows,
            Some(prior) => rows.with(&Self {
                declared: prior.root.clone(),
                library: DMatrix::zeros(prior.root.nrows(), problem.candidates.len()),
                noise: Vec::new(),
            }),
        })
    }

    pub(crate) fn of_experiment(experiment: &Experiment) -> Result<Self, Error> {
        let whitener = experiment.covariance.whitener()?;
        let noise = experiment.runs.iter().map(|runs| {
            let of_mean = whitener.whiten_covariance(&runs.of_mean);
            let inverse_steps = runs.inverse_steps.clone();
            let kind = NoiseKind::Runs {
                of_mean,
                inverse_steps,
            };
            RowNoise { first: 0, kind }
        });
        Ok(Self {
            declared: whitener.whiten(&experiment.declared),
            library: whitener.whiten(&experiment.library),
            noise: noise.collect(),
        })
    }

    /// These rows, then others.
    pub(crate) fn with(&self, others: &Self) -> Self {
        let n = self.declared.nrows();
        let mut noise = self.noise.clone();
        noise.extend(others.noise.iter().cloned().map(|mut block| {
            block.first += n;
            block
        }));
        Self {
            declared: stacked(&self.declared, &others.declared),
            library: stacked(&self.library, &others.library),
            noise,
        }
    }

    /// Square of the separation of two effects that is to be expected of the true sensitivities.
    ///
    /// # Formula
    ///
    /// d^2 = a^2 (|r|^2 - tr P N), r = P l_j with P the projector off the parameters and the rival: the noncentrality
    /// left after both are refitted (T-optimality `[AtkinsonFedorov1975]`), less what the noise of the sensitivities adds
    /// to it: r is l_j less a combination of the other columns, and N the covariance of that combination. Never below 0.
    /// [the second part is own]
    pub(crate) fn squared_separation(&self, pair: &Pair) -> f64 {
        pair.mean_square * self.squared_outside(pair.effect, Some(pair.rival))
    }

    /// Square of the expected score of an effect of amplitude 1 after re-tuning, less what the noise of its sensitivity
    /// adds.
    pub(crate) fn squared_detectability(&self, effect: usize) -> f64 {
        self.squared_outside(effect, None)
    }

    /// Squared length of an effect off the parameters and a rival, without the noise of the sensitivities.
    fn squared_outside(&self, effect: usize, rival: Option<usize>) -> f64 {
        let n = self.declared.ncols();
        let mut columns: Vec<DVector<f64>> = self
            .declared
            .column_iter()
            .map(nalgebra::Matrix::into_owned)
            .collect();
        columns.extend(rival.map(|k| self.library.column(k).into_owned()));
        let rows = self.declared.nrows();
        let space = if columns.is_empty() {
            Space::of(&DMatrix::zeros(rows, 0))
        } else {
            Space::of(&DMatrix::from_columns(&columns))
        };
        let whole = self.library.column(effect).into_owned();
        let coefficients = space.coefficients(&whole);
        let mut weights = vec![0.0; n + self.library.ncols()];
        for (k, coefficient) in coefficients.iter().enumerate() {
            let column = if k < n { Some(k) } else { rival.map(|r| n + r) };
            if let Some(column) = column {
                weights[column] = -coefficient;
            }
        }
        weights[n + effect] += 1.0;
        let length = space.outside(&whole).norm_squared();
        let projector = space.outside_columns(&DMatrix::identity(rows, rows));
        (length - self.noise_of(&weights, &projector)).max(0.0)
    }

    /// Trace of the covariance of a combination of columns inside a projector.
    fn noise_of(&self, weights: &[f64], projector: &DMatrix<f64>) -> f64 {
        let n = self.declared.ncols();
        let traced = |first: usize, noise: &DMatrix<f64>| {
            let m = noise.nrows();
            projector.view((first, first), (m, m)).dot(noise)
        };
        let of_block = |block: &RowNoise| match &block.kind {
            NoiseKind::Columns(declared, library) => {
                let of_parameters = DVector::from_column_slice(&weights[..n]);
                let declared = declared
                    .iter()
                    .map(|(along, noise)| (along.dot(&of_parameters), noise));
                let library = library.iter().zip(&weights[n..]).map(|(n, w)| (*w, n));
                let each = declared.chain(library).filter(|(w, _)| *w != 0.0);
                each.map(|(w, noise)| w * w * traced(block.first, noise))
                    .sum::<f64>()
            }
            NoiseKind::Runs {
                of_mean,
                inverse_steps,
            } => {
                let each = || weights.iter().zip(inverse_steps).map(|(w, s)| w * s);
                let (own, of_point) = (each().map(|x| x * x).sum::<f64>(), each().sum::<f64>());
                (own + of_point * of_point) * traced(block.first, of_mean)
            }
        };
        self.noise.iter().map(of_block).sum()
    }

    /// ln det of S~'S~, parameters scaled to the length of their columns, with a small ridge.
    pub(crate) fn ln_information(&self) -> f64 {
        let information = self.declared.tr_mul(&self.declared);
        let n = information.nrows();
        if n == 0 {
            return 0.0;
        }
        let scale = information.diagonal().amax().max(f64::MIN_POSITIVE);
        let ridged = information + DMatrix::identity(n, n) * (RIDGE * scale);
        ridged
            .symmetric_eigenvalues()
            .iter()
            .map(|v| v.max(f64::MIN_POSITIVE).ln())
            .sum()
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

#[cfg(test)]
mod tests {
    use super::{NoiseKind, Pair, RowNoise, Rows};
    use nalgebra::{DMatrix, DVector};
    use probability::random_stream::Stream;

    /// Six rows, one parameter and two effects that differ by a vector of length 3 off the parameter and the rival; means
    /// of runs with a standard deviation of 0.6 at steps of 1, 0.5 and 0.8. Mean over 4000 draws of the squared separation
    /// with noise taken off; without that it is 4 degrees of freedom times the noise too large. Tolerance: four
    /// standard errors of the mean.
    #[test]
    fn the_noise_of_the_runs_is_taken_off_the_separation() {
        let n = 6;
        let unit = |k: usize| DVector::from_fn(n, |i, _| f64::from(u8::from(i == k)));
        let declared = unit(0) * 4.0 + unit(1) * 3.0;
        let rival = unit(1) * 2.0 - unit(2) * 5.0;
        let effect = &rival * 0.7 + &declared * 0.2 + unit(4) * 3.0;
        let (sd, steps) = (0.6, [1.0_f64, 0.5, 0.8]);
        let mut stream = Stream::new(1, "separation");
        let pair = Pair {
            effect: 0,
            rival: 1,
            mean_square: 1.0,
        };
        let mut draw = || {
            let mut noise = || DVector::from_fn(n, |_, _| sd * stream.normal());
            let at_point = noise();
            let mut slope = |true_one: &DVector<f64>, step: f64| {
                let at_step = noise();
                true_one + (at_step - &at_point) / step
            };
            let declared = slope(&declared, steps[0]);
            let effect = slope(&effect, steps[1]);
            let rival = slope(&rival, steps[2]);
            let rows = Rows {
                declared: DMatrix::from_columns(&[declared]),
                library: DMatrix::from_columns(&[effect, rival]),
                noise: vec![RowNoise {
                    first: 0,
                    kind: NoiseKind::Runs {
                        of_mean: DMatrix::identity(n, n) * sd * sd,
                        inverse_steps: steps.iter().map(|s| 1.0 / s).collect(),
                    },
                }],
            };
            rows.squared_separation(&pair)
        };
        let draws: Vec<f64> = (0..4000).map(|_| draw()).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let square = draws.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
        let se = square.sqrt() / draws.len() as f64;
        assert!(se < 0.15, "{se}");
        // Clipping at 0 and the bend of the projector lift the mean by a few hundredths of the noise, 4 x 3.6.
        assert!((mean - 9.0).abs() < 4.0 * se + 0.4, "{mean} +- {se}");
    }
}
