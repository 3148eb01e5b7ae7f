//! Sobol indices: which share of the variance of a fitted surface each factor makes.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::{Categorical, Error, ErrorSource, Fit, NamedValues, Term};

/// How the variance of the surface over the ranges of the factors is shared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sobol {
    /// Variance of the surface with all factors spread evenly over their ranges and levels, squared unit of the response.
    pub variance: f64,
    /// The shares of each factor.
    pub factors: NamedValues<FactorShare>,
    /// Share of each pair of factors beyond its two first-order shares.
    pub pairs: NamedValues<Share>,
}

/// The shares of one factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FactorShare {
    /// First order: the variance that remains on average where the factor alone varies.
    pub first: Share,
    /// Total: with all its products with other factors.
    pub total: Share,
}

/// A share of the variance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// The share, 0 to 1.
    pub share: f64,
    /// The share that the errors of the coefficients alone would make on average, by the residuals; `None` if there are none
    /// left.
    pub by_noise: Option<f64>,
}

/// How a factor is spread: the columns that stand for it, and their values.
enum Spread {
    /// A column that is uniform on -1 to +1.
    Range(usize),
    /// Columns from a place on, with the values that they take together, all as often.
    Levels(usize, Vec<Vec<f64>>),
}

impl Spread {
    /// Mean of the part of a product of two terms that belongs to this factor.
    fn mean(&self, a: &Term, b: Option<&Term>) -> f64 {
        let power = |j: usize| a.powers()[j] + b.map_or(0, |b| b.powers()[j]);
        match self {
            Self::Range(j) => match power(*j) {
                even if even % 2 == 0 => 1.0 / f64::from(even + 1),
                _ => 0.0,
            },
            Self::Levels(first, values) => {
                let product = |level: &Vec<f64>| -> f64 {
                    let columns = level.iter().zip(*first..);
                    columns.map(|(x, j)| x.powi(i32::from(power(j)))).product()
                };
                values.iter().map(product).sum::<f64>() / values.len() as f64
            }
        }
    }
}

impl Fit {
    /// The Sobol indices of the fitted surface, its factors independent and spread evenly over their ranges; `named` are
    /// the factors of named levels whose columns follow the others. None for a surface that does not vary.
    ///
    /// # Formula
    /// `V_u = Var(E[f | x_u])` for a set u of factors, exact from the moments of the ranges: a quadratic form `b'Q_u b` of
    /// the coefficients. First order `V_i / V`, total `1 - V_(all but i) / V`, pair `(V_ij - V_i - V_j) / V`. Errors of the
    /// coefficients with covariance S add `tr(Q_u S)` to the mean of `V_u`.
    ///
    /// # Source
    /// `[Sobol2001]`; total: `[Homma1996]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the named factors have more columns than the fit.
    pub fn sobol(&self, named: &[Categorical]) -> Result<Option<Sobol>, Error> {
        let of_levels: usize = named.iter().map(|factor| factor.levels().len() - 1).sum();
        let columns = self.factors.len();
        let Some(numbers) = columns.checked_sub(of_levels) else {
            return Err(Error::Length {
                what: "columns of the named factors",
                expected: columns,
                given: of_levels,
            });
        };
        let mut spreads: Vec<(String, Spread)> = (0..numbers)
            .map(|j| (self.factors[j].symbol().to_owned(), Spread::Range(j)))
            .collect();
        let mut place = numbers;
        for factor in named {
            let levels = factor.levels().iter();
            let values = levels.map(|level| factor.coded(level).unwrap_or_default());
            let spread = Spread::Levels(place, values.collect());
            spreads.push((factor.symbol().to_owned(), spread));
            place += factor.levels().len() - 1;
        }
        Ok(self.shares(&spreads))
    }

    /// The indices over given spreads.
    fn shares(&self, spreads: &[(String, Spread)]) -> Option<Sobol> {
        let terms = self.formula.terms();
        let coefficients = self.terms.values().map(|row| row.coef);
        let coefficients = DVector::from_iterator(terms.len(), coefficients);
        let inverse = self.inverse_of_terms();
        let covariance = self
            .error_variance(ErrorSource::Residual)
            .map(|e| DMatrix::from_fn(terms.len(), terms.len(), |i, j| e.variance * inverse[i][j]));
        let form = |set: &dyn Fn(usize) -> bool| variance_form(terms, spreads, set);
        let part = |q: &DMatrix<f64>| {
            let noise = covariance.as_ref().map(|s| (q * s).trace());
            (coefficients.dot(&(q * &coefficients)), noise)
        };
        let all = form(&|_| true);
        let (variance, _) = part(&all);
        let scale = coefficients.amax().powi(2);
        // Below, the variance is rounding of the constant term.
        if variance.is_nan() || variance <= 1e-24 * scale {
            return None;
        }
        let share = |q: &DMatrix<f64>| {
            let (value, noise) = part(q);
            Share {
                share: value / variance,
                by_noise: noise.map(|noise| noise / variance),
            }
        };
        let firsts: Vec<DMatrix<f64>> = (0..spreads.len()).map(|g| form(&|i| i == g)).collect();
        let of_factor = |g: usize| {
            let rest = form(&|i| i != g);
            let shares = FactorShare {
                first: share(&firsts[g]),
                total: share(&(&all - rest)),
            };
            (spreads[g].0.clone(), shares)
        };
        let mut pairs = Vec::new();
        for h in 0..spreads.len() {
            for g in 0..h {
                let both = form(&|i| i == g || i == h);
                let name = format!("{}:{}", spreads[g].0, spreads[h].0);
                pairs.push((name, share(&(both - &firsts[g] - &firsts[h]))));
            }
        }
        Some(Sobol {
            variance,
            factors: (0..spreads.len()).map(of_factor).collect(),
            pairs: pairs.into_iter().collect(),
        })
    }
}

/// The matrix Q with which coefficients b have the variance b'Q b that the factors in `set` make over their spreads.
fn variance_form(
    terms: &[Term],
    spreads: &[(String, Spread)],
    set: &dyn Fn(usize) -> bool,
) -> DMatrix<f64> {
    DMatrix::from_fn(terms.len(), terms.len(), |i, j| {
        let (a, b) = (&terms[i], &terms[j]);
        let (mut together, mut apart) = (1.0, 1.0);
        for (g, (_, spread)) in spreads.iter().enumerate() {
            let means = spread.mean(a, None) * spread.mean(b, None);
            together *= if set(g) {
                spread.mean(a, Some(b))
            } else {
                means
            };
            apart *= means;
        }
        together - apart
    })
}

#[cfg(test)]
mod tests {
    use crate::{Cell, Model, Observations, fit};
    use experiment_design::{AxialDistance, Factor, central_composite};
    use probability::random_stream::Stream;

    fn factors(symbols: &str) -> Vec<Factor> {
        let each = symbols.chars();
        each.map(|c| Factor::coded_only(&c.to_string()).unwrap())
            .collect()
    }

    /// y = 3 + 2 A + 3 A B + 1.5 C^2 by hand: Var(A) = 4/3, Var(AB) = 9/9, Var(C^2) = 2.25 (1/5 - 1/9) = 0.2; B has no
    /// share of its own, and all of the product. Rounding: 1e-12.
    #[test]
    fn shares_are_those_of_the_polynomial() {
        let f = factors("ABC");
        let design = central_composite(&f, AxialDistance::Face, 2).unwrap();
        let y = |x: &[f64]| 3.0 + 2.0 * x[0] + 3.0 * x[0] * x[1] + 1.5 * x[2] * x[2];
        let cells = design.coded_rows().into_iter();
        let cells = cells.map(|x| Cell::single(x.clone(), y(&x))).collect();
        let data = Observations::from_cells(cells).unwrap();
        let fit = fit(&f, &Model::quadratic(&f).unwrap(), &data).unwrap();
        let got = fit.sobol(&[]).unwrap().unwrap();
        let [a, ab, c] = [4.0 / 3.0, 1.0, 0.2];
        let v = a + ab + c;
        assert!((got.variance - v).abs() < 1e-12, "{got:?}");
        for (symbol, first, total) in [("A", a, a + ab), ("B", 0.0, ab), ("C", c, c)] {
            let share = got.factors.get(symbol).unwrap();
            assert!(
                (share.first.share - first / v).abs() < 1e-12,
                "{symbol} {share:?}"
            );
            assert!(
                (share.total.share - total / v).abs() < 1e-12,
                "{symbol} {share:?}"
            );
        }
        for (pair, part) in [("A:B", ab), ("A:C", 0.0), ("B:C", 0.0)] {
            let share = got.pairs.get(pair).unwrap().share;
            assert!((share - part / v).abs() < 1e-12, "{pair} {share}");
        }
        let flat = Observations::from_cells(
            design
                .coded_rows()
                .into_iter()
                .map(|x| Cell::single(x, 0.3))
                .collect(),
        );
        let flat = crate::fit(&f, &Model::linear(&f).unwrap(), &flat.unwrap()).unwrap();
        assert_eq!(flat.sobol(&[]).unwrap(), None);
    }

    /// Where B does nothing, what it seems to make is noise: over 400 drawn experiments the mean of its total share times
    /// the variance agrees with the mean of what noise is said to make, within four standard errors of the draws (the
    /// variances are drawn as well, with 7 degrees of freedom).
    #[test]
    fn what_noise_makes_is_told() {
        let f = factors("AB");
        let design = central_composite(&f, AxialDistance::Face, 5).unwrap();
        let mut stream = Stream::new(7, "shares by noise");
        let mut differences = Vec::new();
        for _ in 0..400 {
            let mut y = |x: &[f64]| 2.0 * x[0] + 0.5 * stream.normal();
            let cells = design.coded_rows().into_iter();
            let cells = cells.map(|x| Cell::single(x.clone(), y(&x))).collect();
            let data = Observations::from_cells(cells).unwrap();
            let fit = fit(&f, &Model::quadratic(&f).unwrap(), &data).unwrap();
            let got = fit.sobol(&[]).unwrap().unwrap();
            let total = got.factors.get("B").unwrap().total;
            differences.push((total.share - total.by_noise.unwrap()) * got.variance);
        }
        let n = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / n;
        let sd = (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        assert!(
            mean.abs() < 4.0 * sd / n.sqrt(),
            "{mean} +- {}",
            sd / n.sqrt()
        );
        assert!(sd > 0.0);
    }
}
