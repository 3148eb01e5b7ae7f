//! Polynomial surfaces of all observables of one model, with what they know of their own error.

mod analysis;
mod shrunk;
mod trend;

use crate::Error;
use crate::region::Region;
use crate::samples::Sample;
use nalgebra::{DMatrix, DVector};
use response_surface::{Model, Polynomials};
use shrunk::shrunk;
use std::collections::{BTreeMap, BTreeSet};

/// Least over greatest singular value of X, its columns scaled to unit length, below which the runs do not fix all terms.
const SINGULAR: f64 = 1e-5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Degree {
    /// A mean.
    Constant,
    /// A plane.
    Linear,
    /// All squares and products.
    Quadratic,
}

/// Fresh runs near the estimate: the surface is shifted to meet their mean, and keeps its slopes.
#[derive(Debug, Clone, PartialEq)]
struct Anchor {
    /// Mean of the terms of the polynomial over the runs.
    terms: DVector<f64>,
    /// What is added, by observable.
    shift: Vec<f64>,
    /// Number of runs.
    n: f64,
}

/// Surfaces of all observables of a model over the same runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Surface {
    pub(crate) model: usize,
    /// Numbers of the parameters that it depends on; behind those that are tuned the inputs, along which it is straight.
    pub(crate) parameters: Vec<usize>,
    /// How many of them are tuned.
    curved: usize,
    /// Largest size of the grains over the real one, less 1, if the runs differ in it: where the trend has the coordinate 1.
    coarsest: Option<f64>,
    /// Whether the trend with the size differs from place to place.
    crossed: bool,
    pub(crate) observables: Vec<String>,
    /// Where its coordinates are -1 to 1.
    region: Region,
    pub(crate) degree: Degree,
    polynomials: Polynomials,
    /// What a cube of each tuned parameter adds to the coefficients of the terms, `(X'X)^-1 X'Z`, (terms, tuned); empty for a plane.
    aliases: DMatrix<f64>,
    /// Sums of products of the residuals of the observables.
    products: DMatrix<f64>,
    /// Covariance of the observables of one run about the surface, its correlations shrunk.
    pub(crate) covariance: DMatrix<f64>,
    /// Share by which the correlations were shrunk.
    pub(crate) shrinkage: f64,
    pub(crate) degrees_of_freedom: f64,
    /// Keys of the runs whose scatter is in it.
    scatter_of: BTreeSet<String>,
    /// Correction by fresh runs.
    anchor: Option<Anchor>,
}

impl Surface {
    /// Fits the highest degree, up to `most`, for which the runs leave a degree of freedom; `None` if they do not
    /// even do that for a mean.
    ///
    /// # Formula
    ///
    /// Ordinary least squares over single runs: `b = (X'X)^-1 X'y`, the covariance of a run about the surface is
    /// `R'R / (n - p)`, R the residuals of all observables, with [shrunk correlations](shrunk). Along inputs it is straight; what
    /// no run varies it does not depend on. The size of the grains is a further coordinate, 0 at the real size and 1 at the coarsest: its
    /// own term, and the product with each tuned parameter where the runs fix these.
    pub(crate) fn fit(
        (number, tuned, inputs): (usize, &[usize], &[usize]),
        observables: &[String],
        region: &Region,
        samples: &[&Sample],
        most: Degree,
    ) -> Option<Self> {
        let first = samples.first()?;
        let varied = |j: &usize| samples.iter().any(|s| s.at[*j] != first.at[*j]);
        let inputs = inputs.iter().copied().filter(varied);
        let parameters: Vec<usize> = tuned.iter().copied().chain(inputs).collect();
        let curved = tuned.len();
        let largest = samples.iter().map(|s| s.factor).fold(1.0, f64::max);
        let is_finer = |s: &&Sample| s.factor < largest;
        let coarsest = samples.iter().any(is_finer).then_some(largest - 1.0);
        let coded = |s: &&Sample| coordinates(&parameters, region, coarsest, &s.at, s.factor);
        let points: Vec<Vec<f64>> = samples.iter().map(coded).collect();
        let y = DMatrix::from_fn(samples.len(), observables.len(), |i, k| {
            samples[i].values[&observables[k]]
        });
        let symbols: Vec<String> = (0..points[0].len()).map(|j| format!("x{j}")).collect();
        let weights = vec![1.0; points.len()];
        let fitted = |(degree, crossed)| {
            let model = model_of(symbols.clone(), (degree, curved, crossed));
            if points.len() <= model.terms().len() {
                return None;
            }
            let found = Polynomials::fit(&model, &points, &y, &weights).ok()?;
            (found.condition < SINGULAR.recip()).then_some((degree, crossed, found))
        };
        let (degree, crossed, polynomials) = degrees(most, coarsest.is_some()).find_map(fitted)?;
        let p = polynomials.model.terms().len();
        let residual = &y - matrix_of(&polynomials.model, &points) * &polynomials.coefficients;
        let cubes = if degree == Degree::Quadratic {
            curved
        } else {
            0
        };
        let z = DMatrix::from_fn(points.len(), cubes, |i, j| points[i][j].powi(3));
        let degrees_of_freedom = (points.len() - p) as f64;
        let products = residual.tr_mul(&residual);
        let (covariance, shrinkage) = shrunk(&products, degrees_of_freedom);
        Some(Self {
            model: number,
            parameters,
            curved,
            coarsest: coarsest.filter(|_| degree != Degree::Constant),
            crossed,
            observables: observables.to_vec(),
            region: region.clone(),
            degree,
            aliases: &polynomials.gain * z,
            polynomials,
            products,
            covariance,
            shrinkage,
            degrees_of_freedom,
            scatter_of: samples.iter().map(|s| s.key.clone()).collect(),
            anchor: None,
        })
    }

    pub(crate) fn tuned(&self) -> &[usize] {
        &self.parameters[..self.curved]
    }

    pub(crate) fn by_observable<T>(&self, value: impl Fn(usize) -> T) -> BTreeMap<String, T> {
        let names = self.observables.iter().cloned().enumerate();
        names.map(|(k, name)| (name, value(k))).collect()
    }

    pub(crate) fn place(&self, observable: &str) -> Option<usize> {
        self.observables.iter().position(|o| o == observable)
    }

    /// Coordinates of the parameters of the model at a point of all parameters, and of the size of the grains if it has a trend.
    fn coded(&self, at: &[f64], factor: f64) -> Vec<f64> {
        coordinates(&self.parameters, &self.region, self.coarsest, at, factor)
    }

    /// Value of an observable at a point (all parameters, natural), for grains of the real size.
    pub(crate) fn value(&self, k: usize, at: &[f64]) -> f64 {
        self.value_of(k, at, 1.0)
    }

    /// The same for grains that are so many times coarser.
    pub(crate) fn value_of(&self, k: usize, at: &[f64], factor: f64) -> f64 {
        let polynomial = self.polynomials.value(k, &self.coded(at, factor));
        polynomial + self.shift(k)
    }

    /// What fresh runs at the estimate have added to the polynomial of an observable.
    pub(crate) fn shift(&self, k: usize) -> f64 {
        self.anchor.as_ref().map_or(0.0, |anchor| anchor.shift[k])
    }

    /// Derivatives of the terms along a coordinate, at a point.
    fn slope_of_terms(&self, coded: &[f64], place: usize) -> DVector<f64> {
        DVector::from_vec(self.polynomials.model.row_slopes(coded, place))
    }

    /// The terms at a point of all parameters, for grains so many times coarser than the real ones.
    fn terms_at(&self, at: &[f64], factor: f64) -> DVector<f64> {
        DVector::from_vec(self.polynomials.model.row(&self.coded(at, factor)))
    }

    /// d observable / d parameter, for the parameters of the model in their order, per unit of each.
    pub(crate) fn slopes(&self, k: usize, at: &[f64]) -> Vec<f64> {
        let coded = self.coded(at, 1.0);
        let column = self.polynomials.coefficients.column(k);
        let each = self.parameters.iter().enumerate();
        each.map(|(place, &j)| {
            self.slope_of_terms(&coded, place).dot(&column) / self.region.half(j)
        })
        .collect()
    }

    /// Covariance of the slopes of an observable over the variance of a run: for the parameters of the model in their order, per
    /// unit of each.
    ///
    /// # Formula
    ///
    /// `R (X'X)^-1 R'`, R the derivatives of the terms.
    pub(crate) fn slope_covariance(&self, at: &[f64]) -> DMatrix<f64> {
        let coded = self.coded(at, 1.0);
        let k = self.parameters.len();
        let rows: Vec<_> = (0..k)
            .map(|place| self.slope_of_terms(&coded, place))
            .collect();
        let half = |place: usize| self.region.half(self.parameters[place]);
        DMatrix::from_fn(k, k, |a, b| {
            self.polynomials.covariance(&rows[a], &rows[b]) / (half(a) * half(b))
        })
    }

    /// Variance of each slope of an observable by the cubes that a quadratic leaves out: for the parameters of the model in their
    /// order, per squared unit of each.
    ///
    /// # Formula
    ///
    /// The coefficient c of `x³` is unknown, with mean 0 and standard deviation `|b2| min(|b2 / b1|, 1)`, b1 and b2 those of `x` and
    /// `x²`: the terms of a series fall by one ratio, as those of `x / (1 + x)`. Of an exponential, c is two thirds of that to first
    /// order, of a logarithm four thirds, of a parabola nothing. What noise adds to b2² is taken off. Design runs take the part of the
    /// cube for terms of the quadratic that these imitate: c changes the slope by `3 x² - r'A`, r the derivatives of the terms and A
    /// the alias matrix `[Myers2016, chapter 9]`.
    pub(crate) fn hidden_slopes(&self, k: usize, at: &[f64]) -> Vec<f64> {
        let coded = self.coded(at, 1.0);
        let coefficient = self.polynomials.coefficients.column(k);
        let terms = self.polynomials.model.terms();
        let place = |j: usize, power: u8| {
            let is_power = |(i, own): (usize, &u8)| *own == if i == j { power } else { 0 };
            terms
                .iter()
                .position(|term| term.powers().iter().enumerate().all(is_power))
        };
        let mut variances = vec![0.0; self.parameters.len()];
        for (j, alias) in self.aliases.column_iter().enumerate() {
            let Some((line, square)) = place(j, 1).zip(place(j, 2)) else {
                continue;
            };
            let (b1, b2) = (coefficient[line], coefficient[square]);
            let noise = self.polynomials.inverse[(square, square)] * self.covariance[(k, k)];
            let seen = (b2 * b2 - noise).max(0.0);
            let ratio = if b2.abs() < b1.abs() { b2 / b1 } else { 1.0 };
            let imitated = self.slope_of_terms(&coded, j).dot(&alias);
            let slope = (3.0 * coded[j].powi(2) - imitated) / self.region.half(self.parameters[j]);
            variances[j] = seen * (ratio * slope).powi(2);
        }
        variances
    }

    /// The slope along parameter `j` over its standard error; 0 where the model does not depend on it.
    pub(crate) fn slope_in_errors(&self, k: usize, j: usize, at: &[f64]) -> f64 {
        let Some(place) = self.parameters.iter().position(|p| *p == j) else {
            return 0.0;
        };
        let slope = self.slopes(k, at)[place];
        let variance = self.slope_covariance(at)[(place, place)] * self.covariance[(k, k)];
        if variance > 0.0 {
            slope / variance.sqrt()
        } else if slope == 0.0 {
            0.0
        } else {
            f64::INFINITY
        }
    }

    /// Variance of the surface at a point over that of one run.
    ///
    /// # Formula
    ///
    /// `x'(X'X)^-1 x`; with n fresh runs `1/n + (x - x0)'(X'X)^-1 (x - x0)`, x0 the mean of their terms.
    pub(crate) fn leverage(&self, at: &[f64]) -> f64 {
        self.leverage_of(at, 1.0)
    }

    /// The same for grains that are so many times coarser than the real ones.
    pub(crate) fn leverage_of(&self, at: &[f64], factor: f64) -> f64 {
        let row = self.terms_at(at, factor);
        match &self.anchor {
            None => self.polynomials.covariance(&row, &row),
            Some(anchor) => {
                let away = row - &anchor.terms;
                self.polynomials.covariance(&away, &away) + 1.0 / anchor.n
            }
        }
    }

    /// The surface shifted so that it meets fresh runs on average; itself without any.
    ///
    /// What a polynomial misses of the response does not bias it there, whether a test sees the miss or not.
    pub(crate) fn anchored(&self, fresh: &[&Sample]) -> Self {
        let mut shifted = self.clone();
        shifted.anchor = None;
        let n = fresh.len() as f64;
        if fresh.is_empty() {
            return shifted;
        }
        let mean_over = |of: &dyn Fn(&Sample) -> f64| fresh.iter().map(|s| of(s)).sum::<f64>() / n;
        let names = self.observables.iter().enumerate();
        let shift = names
            .map(|(k, name)| mean_over(&|s| s.values[name] - shifted.value_of(k, &s.at, s.factor)))
            .collect();
        let rows = fresh.iter().map(|s| self.terms_at(&s.at, s.factor));
        let sum = rows.reduce(|sum, row| sum + row);
        shifted.anchor = sum.map(|sum| Anchor {
            terms: sum / n,
            shift,
            n,
        });
        shifted
    }

    /// Mean of an observable over runs, carried to a point and to grains of the real size, and its variance over that of a run.
    /// Runs that the polynomial was made of are in it already.
    pub(crate) fn carried(&self, k: usize, group: &[&Sample], at: &[f64]) -> (f64, f64) {
        if self.anchor.is_none() && self.knows_scatter_of(group) {
            return (self.value(k, at), self.leverage(at));
        }
        let through = self.anchored(group);
        (through.value(k, at), through.leverage(at))
    }

    /// Whether the scatter of runs is in the covariance already.
    pub(crate) fn knows_scatter_of(&self, group: &[&Sample]) -> bool {
        group.iter().all(|s| self.scatter_of.contains(&s.key))
    }

    /// The same with the scatter of further runs of the model pooled into that of a run; runs that it knows count once.
    pub(crate) fn with_scatter(&self, groups: &[Vec<&Sample>]) -> Self {
        let mut products = self.products.clone();
        let mut dof = self.degrees_of_freedom;
        let mut scatter_of = self.scatter_of.clone();
        let new = |group: &&Vec<&Sample>| group.len() > 1 && !self.knows_scatter_of(group);
        for group in groups.iter().filter(new) {
            scatter_of.extend(group.iter().map(|s| s.key.clone()));
            let n = group.len();
            let y = DMatrix::from_fn(n, self.observables.len(), |i, k| {
                group[i].values[&self.observables[k]]
            });
            let mean = y.row_mean();
            let centred = DMatrix::from_fn(n, y.ncols(), |i, k| y[(i, k)] - mean[k]);
            products += centred.tr_mul(&centred);
            dof += (n - 1) as f64;
        }
        let (covariance, shrinkage) = shrunk(&products, dof);
        Self {
            products,
            covariance,
            shrinkage,
            degrees_of_freedom: dof,
            scatter_of,
            ..self.clone()
        }
    }
}

/// Coordinates of some parameters at a point of all parameters, and of the size of the grains if it has one.
fn coordinates(
    parameters: &[usize],
    region: &Region,
    coarsest: Option<f64>,
    at: &[f64],
    factor: f64,
) -> Vec<f64> {
    let each = parameters.iter().map(|&j| region.coded(j, at[j]));
    each.chain(coarsest.map(|one| (factor - 1.0) / one))
        .collect()
}

/// The models to try, the richest first: degrees up to `most`, each first with a trend that differs from place to place if the
/// runs have several sizes of grains.
fn degrees(most: Degree, has_sizes: bool) -> impl Iterator<Item = (Degree, bool)> {
    let all = [Degree::Quadratic, Degree::Linear, Degree::Constant];
    let allowed = all.into_iter().filter(move |d| *d as u8 <= most as u8);
    allowed.flat_map(move |degree| {
        let crossed = has_sizes && degree != Degree::Constant;
        let plain = crossed.then_some((degree, false));
        [Some((degree, crossed)), plain].into_iter().flatten()
    })
}

/// X of a model, (points, terms).
fn matrix_of(model: &Model, points: &[Vec<f64>]) -> DMatrix<f64> {
    let rows = points.iter().flat_map(|x| model.row(x));
    DMatrix::from_row_iterator(points.len(), model.terms().len(), rows)
}

/// The terms of a surface: 1, each x, the product of the last, the size of the grains, with each of the first `curved` if it is
/// `crossed`, and the squares and products of these.
fn model_of(symbols: Vec<String>, (degree, curved, crossed): (Degree, usize, bool)) -> Model {
    let k = symbols.len();
    let product = |places: &[usize]| {
        let mut powers = vec![0; k];
        for &j in places {
            powers[j] += 1;
        }
        powers
    };
    let mut terms = vec![product(&[])];
    if degree != Degree::Constant {
        terms.extend((0..k).map(|j| product(&[j])));
    }
    if crossed {
        terms.extend((0..curved).map(|j| product(&[j, k - 1])));
    }
    if degree == Degree::Quadratic {
        terms.extend((0..curved).flat_map(|i| (i..curved).map(move |j| product(&[i, j]))));
    }
    Model::of_powers(symbols, terms)
}

/// The error of a surface that cannot be made.
pub(crate) fn too_few(model: &str, n: usize, left_out: &[String]) -> Error {
    Error::TooFewRuns {
        model: model.to_owned(),
        n,
        reasons: left_out.to_vec(),
    }
}

#[cfg(test)]
mod tests;
