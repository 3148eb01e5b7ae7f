//! Polynomial surfaces of all observables of one model, with what they know of their own error.

use crate::region::Region;
use crate::samples::Sample;
use crate::{CalibrationProblem, CoarseGraining, Error};
use experiment_design::Factor;
use nalgebra::{DMatrix, DVector};
use response_surface::{Cell, Fit, Model, Observations, Polynomials, fit};
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
    /// Fits the highest degree, up to `most`, for which the runs leave a degree of freedom; none where they do not
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
        let coded = |s: &&Sample| -> Vec<f64> {
            let each = parameters.iter();
            let each = each.map(|&j| region.coded(j, s.at[j]));
            each.chain(coarsest.map(|one| (s.factor - 1.0) / one))
                .collect()
        };
        let points: Vec<Vec<f64>> = samples.iter().map(coded).collect();
        let y = DMatrix::from_fn(samples.len(), observables.len(), |i, k| {
            samples[i].values[&observables[k]]
        });
        let degrees = [Degree::Quadratic, Degree::Linear, Degree::Constant];
        let allowed = degrees.into_iter().filter(|d| *d as u8 <= most as u8);
        let allowed = allowed.flat_map(|degree| {
            let crossed = coarsest.is_some() && degree != Degree::Constant;
            [Some((degree, crossed)), crossed.then_some((degree, false))]
        });
        let symbols: Vec<String> = (0..points[0].len()).map(|j| format!("x{j}")).collect();
        let weights = vec![1.0; points.len()];
        for (degree, crossed) in allowed.flatten() {
            let model = model_of(symbols.clone(), (degree, curved, crossed));
            let p = model.terms().len();
            if points.len() <= p {
                continue;
            }
            let fitted = Polynomials::fit(&model, &points, &y, &weights).ok();
            let Some(polynomials) = fitted.filter(|found| found.condition < SINGULAR.recip())
            else {
                continue;
            };
            let cubes = if degree == Degree::Quadratic {
                curved
            } else {
                0
            };
            let z = DMatrix::from_fn(points.len(), cubes, |i, j| points[i][j].powi(3));
            let x = DMatrix::from_row_iterator(
                points.len(),
                p,
                points.iter().flat_map(|x| model.row(x)),
            );
            let residual = &y - x * &polynomials.coefficients;
            let dof = (points.len() - p) as f64;
            let products = residual.tr_mul(&residual);
            let (covariance, shrinkage) = shrunk(&products, dof);
            return Some(Self {
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
                degrees_of_freedom: dof,
                scatter_of: samples.iter().map(|s| s.key.clone()).collect(),
                anchor: None,
            });
        }
        None
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
        let each = self.parameters.iter();
        let each = each.map(|&j| self.region.coded(j, at[j]));
        each.chain(self.coarsest.map(|one| (factor - 1.0) / one))
            .collect()
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

    /// Whether it knows how its observables change with the size of the grains.
    pub(crate) fn has_trend(&self) -> bool {
        self.coarsest.is_some()
    }

    /// How an observable changes with the size of the grains at a point, per real diameter, and the variance of that over that of a
    /// run; none if no run tells.
    pub(crate) fn trend(&self, k: usize, at: &[f64]) -> Option<(f64, f64)> {
        let one = self.coarsest?;
        let row = self.slope_of_terms(&self.coded(at, 1.0), self.parameters.len());
        let slope = row.dot(&self.polynomials.coefficients.column(k)) / one;
        Some((slope, self.polynomials.covariance(&row, &row) / (one * one)))
    }

    /// Whether a trend that is straight misses the runs behind the surface: by how much a term in the square of the size would
    /// change the value for real grains at a point, and the chance that noise alone makes so much of it. None if the runs have
    /// fewer than three sizes.
    ///
    /// # Formula
    ///
    /// With w the square of the coordinate, `u = w - X (X'X)^-1 X'w` and e the residuals, `c = u'e / u'u` is its coefficient; `c² u'u`
    /// is compared with the residual variance that is left by `F(1, n - p - 1)` `[Myers2016, chapter 2]`. The value at x changes by
    /// `-c x'(X'X)^-1 X'w`.
    pub(crate) fn bend(&self, k: usize, used: &[&Sample], at: &[f64]) -> Option<(f64, f64)> {
        let one = self.coarsest?;
        let n = used.len();
        let rows: Vec<_> = used
            .iter()
            .map(|s| self.terms_at(&s.at, s.factor).transpose())
            .collect();
        let x = DMatrix::from_rows(&rows);
        let w = DVector::from_fn(n, |i, _| ((used[i].factor - 1.0) / one).powi(2));
        let name = &self.observables[k];
        let y = DVector::from_fn(n, |i, _| used[i].values[name]);
        let e = y - &x * self.polynomials.coefficients.column(k);
        let followed = &self.polynomials.inverse * x.tr_mul(&w);
        let u = &w - &x * &followed;
        let dof = n as f64 - x.ncols() as f64 - 1.0;
        if u.norm_squared() <= SINGULAR * SINGULAR * w.norm_squared() || dof <= 0.0 {
            return None;
        }
        let c = u.dot(&e) / u.norm_squared();
        let of_bend = c * c * u.norm_squared();
        let left = (e.norm_squared() - of_bend) / dof;
        let row = self.terms_at(at, 1.0);
        // Runs without any scatter leave no doubt.
        let p = probability::f_upper_tail(of_bend / left, 1.0, dof).unwrap_or(0.0);
        Some((-c * row.dot(&followed), p))
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

    /// A run as the trend carries it to grains of the real size.
    pub(crate) fn for_real_size(&self, sample: &Sample) -> Sample {
        let mut carried = sample.clone();
        for (k, name) in self.observables.iter().enumerate() {
            if let (Some((slope, _)), Some(value)) =
                (self.trend(k, &sample.at), carried.values.get_mut(name))
            {
                *value -= slope * (sample.factor - 1.0);
            }
        }
        carried
    }

    /// Whether the scatter of runs is in the covariance already.
    pub(crate) fn knows_scatter_of(&self, group: &[&Sample]) -> bool {
        group.iter().all(|s| self.scatter_of.contains(&s.key))
    }

    /// The analysis of an observable over the runs behind this surface: the same polynomial, raised as fresh runs have shifted it. Inputs
    /// are held as they were stated, and the grains at the real size. None if the analysis is undefined.
    pub(crate) fn analysis(
        &self,
        problem: &CalibrationProblem,
        used: &[&Sample],
        k: usize,
    ) -> Option<Fit> {
        let of_parameter = |&j: &usize| {
            let p = &problem.parameters[j];
            let [low, high] = [self.region.low[j], self.region.high[j]];
            Factor::new(&p.symbol, &p.name, &p.unit, low, high)
        };
        // Its coded values are those of the surface: 0 at the real size, 1 at the coarsest.
        let of_size = |one: f64| Factor::new(CoarseGraining::SYMBOL, "", "1", 1.0 - one, 1.0 + one);
        let factors = self.parameters.iter().map(of_parameter);
        let factors: Vec<Factor> = factors
            .chain(self.coarsest.map(of_size))
            .collect::<Result<_, _>>()
            .ok()?;
        let symbols = factors.iter().map(|f| f.symbol().to_owned()).collect();
        let model = model_of(symbols, (self.degree, self.curved, self.crossed));
        let run =
            |s: &&Sample| Cell::single(self.coded(&s.at, s.factor), s.values[&self.observables[k]]);
        let data = Observations::from_cells(used.iter().map(run).collect()).ok()?;
        let mut found = fit(&factors, &model, &data).ok()?;
        let start = problem.start();
        let stated = self
            .coded(&start, 1.0)
            .into_iter()
            .enumerate()
            .skip(self.curved);
        let stated: Vec<(usize, f64)> = stated.collect();
        if !stated.is_empty() {
            found = found.held(&stated).ok()?;
            found.box_extremes = found.extremes().ok();
        }
        Some(found.raised(self.shift(k)))
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

/// A covariance from sums of products, and the share by which its correlations were shrunk.
///
/// With few degrees of freedom for many observables the plain estimate is singular, and weighted least squares leans on
/// combinations whose variance happens to be small.
///
/// # Formula
///
/// The variances are `products / d`. A correlation r becomes `(1 - l) r` with `l = sum var(r) / sum r²` over all pairs, 1 at most,
/// and `var(r) = 1 / d`, that of independent normal values `[SchaeferStrimmer2005, table 1]`. Since r² is 1 at most, l is never
/// less than 1 / d, and the result is positive definite wherever the variances are positive.
fn shrunk(products: &DMatrix<f64>, degrees_of_freedom: f64) -> (DMatrix<f64>, f64) {
    let n = products.nrows();
    let root = |k: usize| products[(k, k)].max(0.0).sqrt();
    let correlation = |a: usize, b: usize| {
        let scale = root(a) * root(b);
        if scale > 0.0 {
            products[(a, b)] / scale
        } else {
            0.0
        }
    };
    let pairs = (0..n).flat_map(|a| (0..a).map(move |b| (a, b)));
    let (mut variance, mut square) = (0.0, 0.0);
    for (a, b) in pairs.filter(|&(a, b)| root(a) * root(b) > 0.0) {
        variance += 1.0 / degrees_of_freedom;
        square += correlation(a, b).powi(2);
    }
    let share = if square > variance {
        variance / square
    } else {
        1.0
    };
    let covariance = DMatrix::from_fn(n, n, |a, b| {
        let kept = if a == b { 1.0 } else { 1.0 - share };
        kept * products[(a, b)] / degrees_of_freedom
    });
    (covariance, share)
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

/// Runs of one regime, and those of others with the reason why they stay out.
pub(crate) fn of_regime<'a>(
    samples: &'a [Sample],
    regime: &str,
) -> (Vec<&'a Sample>, Vec<(&'a Sample, String)>) {
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for sample in samples {
        if sample.regime == regime {
            inside.push(sample);
        } else {
            let reason = format!(
                "it ended up {}, while the surface describes {regime}",
                sample.regime
            );
            outside.push((sample, reason));
        }
    }
    (inside, outside)
}

/// The regime of most runs; of equally many the one that comes first.
pub(crate) fn usual_regime(samples: &[Sample]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for sample in samples {
        *counts.entry(&sample.regime).or_default() += 1;
    }
    let most = counts.values().copied().max().unwrap_or(0);
    let first = samples.iter().find(|s| counts[s.regime.as_str()] == most);
    first.map_or_else(String::new, |s| s.regime.clone())
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
mod tests {
    use super::{Degree, Surface, shrunk};
    use crate::region::Region;
    use crate::samples::Sample;
    use crate::{CalibrationProblem, Parameter};
    use nalgebra::DMatrix;
    use std::collections::BTreeMap;

    fn region() -> Region {
        Region {
            low: vec![0.0, 10.0],
            high: vec![2.0, 30.0],
        }
    }

    fn sample(a: f64, b: f64, noise: f64) -> Sample {
        Sample {
            place: 0,
            at: vec![a, b],
            factor: 1.0,
            values: BTreeMap::from([("y".to_owned(), 1.0 + a * a - 0.1 * a * b + noise)]),
            regime: String::new(),
            key: format!("{a} {b} {noise}"),
        }
    }

    fn grid() -> Vec<Sample> {
        let levels = [0.0, 1.0, 2.0];
        let cells = levels.into_iter().flat_map(|a| {
            let b = [10.0, 20.0, 30.0];
            b.into_iter().map(move |b| sample(a, b, 0.0))
        });
        cells.collect()
    }

    fn fitted(samples: &[Sample]) -> Surface {
        let all: Vec<_> = samples.iter().collect();
        let names = ["y".to_owned()];
        Surface::fit(
            (0, &[0, 1], &[]),
            &names,
            &region(),
            &all,
            Degree::Quadratic,
        )
        .unwrap()
    }

    /// The polynomial itself comes back, and its derivatives 2 a - 0.1 b and -0.1 a in natural units, to rounding.
    #[test]
    fn a_quadratic_is_reproduced_with_its_slopes_in_natural_units() {
        let surface = fitted(&grid());
        let at = [0.7, 14.0];
        let exact = 1.0 + 0.49 - 0.1 * 0.7 * 14.0;
        assert!((surface.value(0, &at) - exact).abs() < 1e-12);
        let slopes = surface.slopes(0, &at);
        assert!((slopes[0] - (1.4 - 1.4)).abs() < 1e-12, "{slopes:?}");
        assert!((slopes[1] + 0.07).abs() < 1e-12, "{slopes:?}");
    }

    /// Of `1 - exp(-x)` over -1 to 1, runs at three levels give b1 = sinh 1 and b2 = 1 - cosh 1 and take the cube for x, so that c moves
    /// the slope in the middle by -c: sd |b2| tanh(1/2) = 0.251, and the slope is in truth off by sinh 1 - 1 = 0.175. A parabola with
    /// b1 = 4 and b2 = 1 may hide 1/4.
    #[test]
    fn a_steep_bend_may_hide_a_cube() {
        let at = |x: f64, y: f64| Sample {
            place: 0,
            factor: 1.0,
            at: vec![1.0 + x, 20.0],
            values: BTreeMap::from([("y".to_owned(), y)]),
            regime: String::new(),
            key: format!("{x}"),
        };
        let hidden = |shows: fn(f64) -> f64| {
            let samples = [-1.0, 0.0, 1.0, -1.0, 0.0, 1.0].map(|x| at(x, shows(x)));
            let all: Vec<_> = samples.iter().collect();
            let axes = (0, &[0][..], &[][..]);
            let names = ["y".to_owned()];
            let surface = Surface::fit(axes, &names, &region(), &all, Degree::Quadratic).unwrap();
            surface.hidden_slopes(0, &[1.0, 20.0])[0].sqrt()
        };
        let of_exponential = (1.0_f64.cosh() - 1.0) * 0.5_f64.tanh();
        assert!((hidden(|x| 1.0 - (-x).exp()) - of_exponential).abs() < 1e-9);
        assert!((hidden(|x| 4.0 * x + x * x) - 0.25).abs() < 1e-9);
        assert!(hidden(|x| 4.0 * x) < 1e-9);
    }

    /// With n fresh runs at a point the surface goes through their mean, with the variance of that mean.
    #[test]
    fn an_anchored_surface_goes_through_the_fresh_runs() {
        let shift = 3.0 - (1.0 + 0.25 - 0.1 * 0.5 * 20.0);
        let fresh = [0.1, -0.1, 0.2, -0.2].map(|noise| sample(0.5, 20.0, shift + noise));
        let surface = fitted(&grid()).anchored(&fresh.iter().collect::<Vec<_>>());
        assert!((surface.value(0, &[0.5, 20.0]) - 3.0).abs() < 1e-12);
        assert!((surface.leverage(&[0.5, 20.0]) - 0.25).abs() < 1e-12);
        assert!(
            surface.leverage(&[1.5, 20.0]) > 0.25,
            "it knows less elsewhere"
        );
    }

    /// What is shown is the surface that is used: its value everywhere, shifted to the fresh runs, its leverage before them, and the
    /// variance of a run, with an input and coarse grains as well, which are held as stated and at the real size (rounding).
    #[test]
    fn the_analysis_is_that_of_the_surface() {
        let input = Parameter {
            start: 20.0,
            is_input: true,
            ..Parameter::new("B", [10.0, 30.0])
        };
        let problem = CalibrationProblem {
            parameters: vec![Parameter::new("A", [0.0, 2.0]), input],
            ..CalibrationProblem::default()
        };
        let mut samples = grid();
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.factor = if i % 3 == 0 { 2.0 } else { 3.0 };
            let noise = 0.1 * [1.0, -2.0, 0.5, 1.5, -1.0][i % 5];
            sample
                .values
                .insert("y".into(), sample.values["y"] + 0.3 * sample.factor + noise);
        }
        let used: Vec<_> = samples.iter().collect();
        let fresh = sample(0.5, 20.0, 4.0);
        let (names, most) = (["y".to_owned()], Degree::Quadratic);
        for (tuned, inputs) in [(&[0, 1][..], &[][..]), (&[0][..], &[1][..])] {
            let plain = Surface::fit((0, tuned, inputs), &names, &region(), &used, most).unwrap();
            let surface = plain.anchored(&[&fresh]);
            let shown = surface.analysis(&problem, &used, 0).unwrap();
            assert_eq!(shown.factors.len(), tuned.len());
            assert!((shown.mse.unwrap() - surface.covariance[(0, 0)]).abs() < 1e-12);
            for at in [[0.3, 20.0], [1.9, 20.0]] {
                let coded = shown.coded(&at[..tuned.len()]);
                assert!((shown.value(&coded) - surface.value(0, &at)).abs() < 1e-12);
                assert!((shown.leverage(&coded) - plain.leverage(&at)).abs() < 1e-12);
            }
        }
    }

    /// Of three observables over 4 degrees of freedom the products are singular; shrunk they are not. By hand: correlations 1, 0.5 and
    /// 0.5, so that l = (3 / 4) / (1 + 0.25 + 0.25) = 0.5.
    #[test]
    fn a_covariance_of_few_runs_is_positive_definite() {
        let products = [4.0, 4.0, 2.0, 4.0, 4.0, 2.0, 2.0, 2.0, 4.0_f64];
        let products = DMatrix::from_row_slice(3, 3, &products);
        assert!(products.determinant().abs() < 1e-12);
        let (covariance, share) = shrunk(&products, 4.0);
        assert!((share - 0.5).abs() < 1e-15, "{share}");
        let expected = [1.0, 0.5, 0.25, 0.5, 1.0, 0.25, 0.25, 0.25, 1.0];
        let expected = DMatrix::from_row_slice(3, 3, &expected);
        assert!((&covariance - expected).amax() < 1e-15, "{covariance}");
        assert!(nalgebra::Cholesky::new(covariance).is_some());
    }

    /// Three runs do not fix the six terms of a quadratic in two parameters, nor leave a degree of freedom for a plane:
    /// what is left is a mean; one run leaves nothing.
    #[test]
    fn too_few_runs_give_a_lower_degree_and_one_run_gives_nothing() {
        let samples = grid();
        let names = ["y".to_owned()];
        let some: Vec<_> = samples[..3].iter().collect();
        let make = |some: &[&Sample]| {
            Surface::fit(
                (0, &[0, 1], &[]),
                &names,
                &region(),
                some,
                Degree::Quadratic,
            )
        };
        assert_eq!(make(&some).unwrap().degree, Degree::Constant);
        assert!(make(&some[..1]).is_none());
        let more: Vec<_> = samples[..6].iter().collect();
        assert_eq!(make(&more).unwrap().degree, Degree::Linear);
    }

    /// Nine runs of noise +-1 in a pattern that no quadratic can follow: the residual variance is known by hand.
    #[test]
    fn the_scatter_of_repeats_is_pooled() {
        let surface = fitted(&grid());
        let repeats = [sample(1.0, 20.0, 0.5), sample(1.0, 20.0, -0.5)];
        let groups = [repeats.iter().collect::<Vec<_>>()];
        let pooled = surface.with_scatter(&groups);
        // Exact surface with 3 degrees of freedom; two repeats with a sum of squares of 0.5.
        assert!((pooled.degrees_of_freedom - 4.0).abs() < 1e-12);
        assert!((pooled.covariance[(0, 0)] - 0.125).abs() < 1e-12);
        // Runs that are known tell nothing new, neither repeats nor those of the design.
        assert_eq!(pooled.with_scatter(&groups), pooled);
        let of_design: Vec<Sample> = grid();
        assert_eq!(surface.with_scatter(&[of_design.iter().collect()]), surface);
    }
}
