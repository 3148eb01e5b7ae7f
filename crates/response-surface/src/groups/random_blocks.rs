//! Blocks drawn at random (batches): a model with two variances.

mod likelihood;

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::fit::{Matrix, ratio};
use crate::solutions::golden_minimum;
use crate::{Error, Model, NamedValues, Observations, Weighting};
use likelihood::{At, Likelihood};
use probability::{t_two_sided_quantile, t_two_sided_tail};

/// Ratios of the variances that are searched, natural logarithms.
const SEARCHED: [f64; 2] = [-16.0, 16.0];
/// Steps of that search before it is refined.
const STEPS: usize = 128;

/// A fit with random blocks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RandomBlocks {
    /// Number of blocks.
    pub blocks: usize,
    /// Standard deviation of the blocks, unit of the response; 0 where the data show none.
    pub block_sd: f64,
    /// Standard deviation of an observation of mean weight within its block, unit of the response.
    pub residual_sd: f64,
    /// Share of the blocks in the sum of both variances.
    pub block_share: f64,
    /// -2 ln of the restricted likelihood.
    pub minus_2_restricted_log_likelihood: f64,
    /// Coefficients in coded units with their tests.
    pub terms: NamedValues<RandomBlockTerm>,
    /// The blocks' own deviations, drawn towards zero, unit of the response, in the order of the blocks.
    pub deviations: Vec<f64>,
}

/// A coefficient of a fit with random blocks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RandomBlockTerm {
    /// Coefficient, unit of the response.
    pub coef: f64,
    /// Standard error, unit of the response.
    pub se: f64,
    /// Degrees of freedom after Satterthwaite: few for what varies between blocks only.
    pub df: Option<f64>,
    /// coef / se.
    pub t: Option<f64>,
    /// Two-sided tail of t.
    pub p: Option<f64>,
    /// 95 % confidence interval, unit of the response.
    pub ci95: Option<[f64; 2]>,
}

/// Fits a model whose blocks are drawn at random, by restricted maximum likelihood.
///
/// # Formula
/// `y = X beta + b_block + e`, `var b = s_b^2`, `var e_i = s^2 / w_i`. The ratio of the variances minimises
/// `-2 ln L = (n - p)(1 + ln(2 pi s^2)) + ln|V/s^2| + ln|X'(V/s^2)^-1 X|`. Degrees of freedom
/// `2 C_jj^2 / (g' A g)`, g the derivatives of `C_jj` by both variances, A their covariance from the second
/// derivatives of -2 ln L.
///
/// # Source
/// `[PattersonThompson1971]`; degrees of freedom: `[GiesbrechtBurns1985]`.
///
/// # Errors
/// Those of [`crate::fit_weighted`]; [`Error::Length`] for fewer than two blocks;
/// [`Error::TooFewObservations`] without residual degrees of freedom; [`Error::NoErrorVariance`] if
/// nothing is left to scatter.
pub fn random_blocks(
    factors: &[Factor],
    model: &Model,
    data: &Observations,
    weighting: Weighting,
) -> Result<RandomBlocks, Error> {
    let data = data.first_columns(factors.len());
    let mut numbers: Vec<usize> = data.cells().iter().map(|cell| cell.block).collect();
    let blocks: Vec<usize> = numbers.clone();
    numbers.sort_unstable();
    numbers.dedup();
    if numbers.len() < 2 {
        return Err(Error::Length {
            what: "random blocks",
            expected: 2,
            given: numbers.len(),
        });
    }
    let place = |block: &usize| numbers.binary_search(block).unwrap_or(0);
    let matrix = Matrix::without_blocks(model, &data, weighting)?;
    let (n, p) = (matrix.rows.len(), matrix.names.len());
    if n <= p {
        return Err(Error::TooFewObservations {
            observations: n,
            terms: p + 1,
        });
    }
    let likelihood = Likelihood {
        blocks: blocks.iter().map(place).collect(),
        count: numbers.len(),
        matrix: &matrix,
    };
    let theta = best_ratio(&likelihood)?;
    let at = likelihood.at(theta)?;
    let residual = at.profiled_variance(n - p);
    if residual.is_nan() || residual <= 0.0 {
        return Err(Error::NoErrorVariance {
            source_of_error: "residual",
            way_out: "the model passes through every observation",
        });
    }
    let between = theta * residual;
    let df = likelihood.degrees_of_freedom(between, residual)?;
    let term = |(j, name): (usize, &String)| {
        let (coef, se) = (at.coefficients[j], (at.covariance[j] * residual).sqrt());
        let (t, df) = (ratio(coef, se), df[j]);
        let limit = df.and_then(|df| t_two_sided_quantile(0.05, df));
        let term = RandomBlockTerm {
            coef,
            se,
            df,
            t,
            p: t.zip(df).and_then(|(t, df)| t_two_sided_tail(t, df)),
            ci95: limit.map(|limit| [coef - limit * se, coef + limit * se]),
        };
        (name.clone(), term)
    };
    Ok(RandomBlocks {
        blocks: numbers.len(),
        block_sd: between.sqrt(),
        residual_sd: residual.sqrt(),
        block_share: theta / (1.0 + theta),
        minus_2_restricted_log_likelihood: at.deviance(residual, n - p),
        terms: matrix.names.iter().enumerate().map(term).collect(),
        deviations: likelihood.deviations(&at, theta),
    })
}

/// The ratio of the variance of blocks to that of observations that is most likely; 0 where any
/// scatter of blocks makes the data less likely.
fn best_ratio(likelihood: &Likelihood<'_>) -> Result<f64, Error> {
    let free = likelihood.matrix.rows.len() - likelihood.matrix.names.len();
    let profile = |at: &At| at.deviance(at.profiled_variance(free), free);
    // Errors can only be those of the columns, which do not depend on the ratio.
    let none = profile(&likelihood.at(0.0)?);
    let cost = |log: f64| {
        likelihood
            .at(log.exp())
            .map_or(f64::INFINITY, |at| profile(&at))
    };
    let node = |i: usize| SEARCHED[0] + (SEARCHED[1] - SEARCHED[0]) * i as f64 / STEPS as f64;
    let values: Vec<f64> = (0..=STEPS).map(|i| cost(node(i))).collect();
    let least = (0..=STEPS)
        .min_by(|&a, &b| values[a].total_cmp(&values[b]))
        .unwrap_or(0);
    let (from, to) = (node(least.saturating_sub(1)), node((least + 1).min(STEPS)));
    let log = golden_minimum(&cost, from, to);
    // A gain of less than rounding is none.
    let found = cost(log) < none - 1e-9 * none.abs().max(1.0);
    Ok(if found { log.exp() } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::random_blocks;
    use crate::{Cell, Model, Observations, Weighting};
    use experiment_design::Factor;

    /// Balanced blocks without factors have the estimates of the analysis of variance: the variance
    /// within is the mean square within, that of the blocks (between - within) / 4, and the mean has
    /// one degree of freedom less than blocks. The search ends at 1e-8.
    #[test]
    fn balanced_blocks_give_the_estimates_of_the_analysis_of_variance() {
        let blocks = [
            [3.0, 5.0, 4.0, 4.0],
            [8.0, 9.0, 7.0, 8.0],
            [5.0, 5.0, 7.0, 3.0],
        ];
        let x = [-1.0, 1.0, 1.0, -1.0];
        let mut cells = Vec::new();
        for (block, values) in blocks.iter().enumerate() {
            for (i, &y) in values.iter().enumerate() {
                let block = block + 1;
                cells.push(Cell {
                    block,
                    ..Cell::single(vec![x[i]], y)
                });
            }
        }
        let data = Observations::from_cells(cells).unwrap();
        let factors = [Factor::coded_only("A").unwrap()];
        let model = Model::parse("mean", &factors).unwrap();
        let got = random_blocks(&factors, &model, &data, Weighting::Counts).unwrap();
        // Means 4, 8, 5; within 2 + 2 + 8 on 9; between 4 ((4 - 17/3)^2 + ...) on 2.
        let (within, between) = (12.0 / 9.0, 4.0 * (26.0 / 3.0) / 2.0);
        assert!((got.residual_sd.powi(2) - within).abs() < 1e-6, "{got:?}");
        let of_blocks: f64 = (between - within) / 4.0;
        assert!((got.block_sd - of_blocks.sqrt()).abs() < 1e-6, "{got:?}");
        let mean = got.terms.get("1").unwrap();
        assert!((mean.se - (between / 12.0).sqrt()).abs() < 1e-6, "{mean:?}");
        assert!((mean.df.unwrap() - 2.0).abs() < 1e-4, "{mean:?}");
    }

    #[test]
    fn blocks_that_scatter_less_than_their_runs_have_no_variance() {
        let cells = (0..8).map(|i| Cell {
            block: 1 + i / 4,
            ..Cell::single(
                vec![if i % 2 == 0 { -1.0 } else { 1.0 }],
                f64::from(u8::from(i % 4 > 1)),
            )
        });
        let data = Observations::from_cells(cells.collect()).unwrap();
        let factors = [Factor::coded_only("A").unwrap()];
        let model = Model::linear(&factors).unwrap();
        let got = random_blocks(&factors, &model, &data, Weighting::Counts).unwrap();
        assert_eq!(got.block_sd, 0.0);
        assert_eq!(got.terms.get("A").unwrap().df, Some(6.0));
    }
}
