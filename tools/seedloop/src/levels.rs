//! Factors of named levels on the command line.

use anyhow::Context as _;
use command_line::significant;
use response_surface::{Categorical, Fit, Transform};
use serde::Serialize;

/// Most combinations of levels that are reported one by one.
const MOST_COMBINATIONS: usize = 100;

/// A level of each named factor.
pub(crate) type Combination = Vec<(Categorical, String)>;

/// The response at a combination of levels.
#[derive(Debug, Serialize)]
pub(crate) struct LevelMean {
    /// Level of each named factor, in their order.
    pub(crate) levels: Vec<String>,
    /// Fitted value, the other factors in the middle of their ranges, unit of the response.
    pub(crate) mean: f64,
    /// 95 % confidence interval with the residuals as error.
    pub(crate) ci95: Option<[f64; 2]>,
    /// Both in the unit of the response, where a function of it was fitted.
    pub(crate) original: Option<Original>,
}

/// A value and an interval taken back to the unit of the response.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Original {
    /// Median of the response.
    pub(crate) median: Option<f64>,
    /// 95 % confidence interval of the median; null at an end that the function does not reach.
    pub(crate) ci95: [Option<f64>; 2],
}

impl Original {
    /// Takes a value and an interval back.
    pub(crate) fn new(transform: Transform, mean: f64, ci95: Option<[f64; 2]>) -> Self {
        Self {
            median: transform.back(mean),
            ci95: ci95.map_or([None; 2], |ends| transform.back_interval(ends)),
        }
    }

    /// The value with its interval in words.
    pub(crate) fn words(self) -> String {
        let text = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| significant(v, 6));
        let [low, high] = self.ci95.map(text);
        format!("median {} (95 % {low} to {high})", text(self.median))
    }
}

/// All combinations of levels; one empty combination without named factors.
pub(crate) fn combinations(categories: &[Categorical]) -> Vec<Combination> {
    let mut combinations = vec![Vec::new()];
    for category in categories {
        let with = |chosen: &Combination| -> Vec<Combination> {
            let each = category.levels().iter();
            let one = |level: &String| {
                let next = (category.clone(), level.clone());
                [&chosen[..], &[next]].concat()
            };
            each.map(one).collect()
        };
        combinations = combinations.iter().flat_map(with).collect();
    }
    combinations
}

/// The response at each combination of levels; none without named factors and for very many combinations.
pub(crate) fn means(
    fit: &Fit,
    categories: &[Categorical],
    transform: Option<Transform>,
) -> Vec<LevelMean> {
    let count: usize = categories.iter().map(|c| c.levels().len()).product();
    if categories.is_empty() || count > MOST_COMBINATIONS {
        return Vec::new();
    }
    let columns: usize = categories.iter().map(|c| c.levels().len() - 1).sum();
    let numeric = fit.factors.len() - columns;
    let mean = |chosen: Combination| {
        let mut coded = vec![0.0; numeric];
        for (category, level) in &chosen {
            coded.extend(category.coded(level).unwrap_or_default());
        }
        let mean = fit.value(&coded);
        let reach = fit.mse.zip(fit.t_crit_975);
        let reach = reach.map(|(mse, t)| t * (mse * fit.leverage(&coded)).sqrt());
        let ci95 = reach.map(|reach| [mean - reach, mean + reach]);
        LevelMean {
            levels: chosen.into_iter().map(|(_, level)| level).collect(),
            mean,
            ci95,
            original: transform.map(|transform| Original::new(transform, mean, ci95)),
        }
    };
    combinations(categories).into_iter().map(mean).collect()
}

/// The fit with named factors held at levels.
///
/// # Errors
/// A level that does not exist.
pub(crate) fn held(fit: &Fit, chosen: &[(Categorical, String)]) -> anyhow::Result<Fit> {
    let mut held = Vec::new();
    for (category, level) in chosen {
        let (symbol, levels) = (category.symbol(), category.levels().join(", "));
        let values = category.coded(level).with_context(|| {
            format!("'{symbol}' has no level '{level}'; its levels are {levels}")
        })?;
        for (column, value) in category.columns()?.iter().zip(values) {
            let place = fit
                .factors
                .iter()
                .position(|f| f.symbol() == column.symbol())
                .with_context(|| format!("the analysis has no column of '{symbol}'"))?;
            held.push((place, value));
        }
    }
    Ok(fit.held(&held)?)
}
