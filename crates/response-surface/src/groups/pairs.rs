//! All pairs of groups compared at once.

use serde::{Deserialize, Serialize};

use crate::OneWay;
use probability::{studentized_range_quantile, studentized_range_upper_tail};

/// Most groups whose pairs are compared: each pair is a double integral.
const MOST_GROUPS: usize = 30;

/// The difference of the means of two groups, with an interval and a p that hold for all pairs at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairDifference {
    /// The group whose mean is taken first.
    pub group: String,
    /// The group whose mean is taken off.
    pub less: String,
    /// Difference of the means, unit of the response.
    pub difference: f64,
    /// Interval that holds, with those of all pairs, in 95 % of experiments, unit of the response.
    pub simultaneous95: [f64; 2],
    /// Chance of a difference that large among all pairs if all means are equal.
    pub p: f64,
}

impl OneWay {
    /// Compares all pairs of groups, in their order; none without replicates, without scatter, or for more than 30
    /// groups.
    ///
    /// # Formula
    /// `q = |d| / sqrt(s^2 / 2 (1/n_i + 1/n_j))`, p the upper tail of the studentized range of all groups at q; interval
    /// `d +- q(0.05) sqrt(s^2 / 2 (1/n_i + 1/n_j))`. For unequal numbers the chance is a bound: the intervals are a
    /// little too wide.
    ///
    /// # Source
    /// Tukey's honest significant difference with `[Kramer1956]` for unequal numbers.
    pub fn pairs(&self) -> Option<Vec<PairDifference>> {
        let k = self.means.len();
        let sd = self
            .residual_sd
            .filter(|sd| *sd > 0.0 && k <= MOST_GROUPS)?;
        let df = self.within_df as f64;
        let limit = studentized_range_quantile(0.05, k, df)?;
        let groups: Vec<(&str, f64, f64)> = self
            .means
            .iter()
            .zip(self.counts.values())
            .map(|((name, mean), n)| (name, *mean, *n as f64))
            .collect();
        let mut pairs = Vec::with_capacity(k * (k - 1) / 2);
        for (i, (less, low, m)) in groups.iter().enumerate() {
            for (group, high, n) in &groups[i + 1..] {
                let difference = high - low;
                let scale = sd * (0.5 * (1.0 / m + 1.0 / n)).sqrt();
                pairs.push(PairDifference {
                    group: (*group).to_owned(),
                    less: (*less).to_owned(),
                    difference,
                    simultaneous95: [difference - limit * scale, difference + limit * scale],
                    p: studentized_range_upper_tail(difference.abs() / scale, k, df)?,
                });
            }
        }
        Some(pairs)
    }
}
