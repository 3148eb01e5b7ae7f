//! Analysis of variance of groups: do their means differ?

use serde::{Deserialize, Serialize};

use crate::fit::ratio;
use crate::fit::wide::Wide;
use crate::{Error, NamedValues};
use probability::f_upper_tail;

/// One-way analysis of variance. Sums of squares are in squared units of the response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OneWay {
    /// Mean of each group, unit of the response.
    pub means: NamedValues<f64>,
    /// Number of runs of each group.
    pub counts: NamedValues<usize>,
    /// Sum of squares of the group means about the mean of all runs.
    pub between_ss: f64,
    /// Number of groups less one.
    pub between_df: usize,
    /// Sum of squares of the runs about their group means.
    pub within_ss: f64,
    /// Number of runs less the number of groups.
    pub within_df: usize,
    /// Mean square between over mean square within; `None` if undefined.
    pub f: Option<f64>,
    /// Upper tail of F.
    pub p: Option<f64>,
    /// Share of the total sum of squares that lies between the groups.
    pub r2: Option<f64>,
    /// Root of the mean square within, unit of the response; none without replicates.
    pub residual_sd: Option<f64>,
}

/// Compares the means of named groups; groups of the same name are one group.
///
/// # Formula
/// `between = sum n_g (mean_g - mean)^2`, `within = sum (y - mean_g)^2`, F of their mean squares, all
/// summed in long arithmetic: a common offset of the data costs only the digits that storing them as
/// usual numbers took (12 of 16 for an offset of 1e12). [`one_way_decimals`] keeps those too.
///
/// # Errors
/// [`Error::Length`] for lists of different length, no runs, or fewer than two groups;
/// [`Error::BadObservation`] for a response that is not finite or whose square is not a number.
pub fn one_way(groups: &[String], responses: &[f64]) -> Result<OneWay, Error> {
    let wide = |(i, &y): (usize, &f64)| {
        if y.is_finite() {
            return Ok(Wide::from(y));
        }
        Err(not_finite(i, y))
    };
    let wide: Result<Vec<Wide>, Error> = responses.iter().enumerate().map(wide).collect();
    of_wide(groups, &wide?)
}

/// As [`one_way`], of responses as they are written: decimal texts are read to 31 digits, so that no
/// digit of the table is lost to storage.
///
/// # Errors
/// As [`one_way`]; [`Error::BadObservation`] for a text that is not a finite number.
pub fn one_way_decimals(groups: &[String], responses: &[&str]) -> Result<OneWay, Error> {
    let wide = |(i, text): (usize, &&str)| {
        Wide::from_decimal(text).ok_or_else(|| not_finite(i, text.parse().unwrap_or(f64::NAN)))
    };
    let wide: Result<Vec<Wide>, Error> = responses.iter().enumerate().map(wide).collect();
    of_wide(groups, &wide?)
}

/// The error of response `i` (from 0).
fn not_finite(i: usize, value: f64) -> Error {
    Error::BadObservation {
        row: i + 1,
        what: "the response",
        value,
        way_out: "it must be a finite number; leave failed runs out",
    }
}

/// Compares the means of named groups.
fn of_wide(groups: &[String], responses: &[Wide]) -> Result<OneWay, Error> {
    if groups.len() != responses.len() {
        return Err(Error::Length {
            what: "responses, one per group label",
            expected: groups.len(),
            given: responses.len(),
        });
    }
    let mut named: Vec<(&String, Vec<Wide>)> = Vec::new();
    let mut places = std::collections::BTreeMap::new();
    for (group, &y) in groups.iter().zip(responses) {
        let place = *places.entry(group).or_insert_with(|| {
            named.push((group, Vec::new()));
            named.len() - 1
        });
        named[place].1.push(y);
    }
    if named.len() < 2 {
        return Err(Error::Length {
            what: "groups",
            expected: 2,
            given: named.len(),
        });
    }
    let beyond = |y: &Wide| y.rounded().abs() > crate::Observations::LARGEST;
    if let Some(i) = responses.iter().position(beyond) {
        return Err(Error::BadObservation {
            row: i + 1,
            what: "the response",
            value: responses[i].rounded(),
            way_out: "squares of numbers beyond 1e140 overflow; give it in a larger unit",
        });
    }
    let lists: Vec<&[Wide]> = named.iter().map(|(_, list)| &list[..]).collect();
    let sums = sums(&lists);
    let (between_df, within_df) = (named.len() - 1, responses.len() - named.len());
    let ms_within = (within_df > 0).then(|| sums.within / within_df as f64);
    let f = ms_within.and_then(|ms| ratio(sums.between / between_df as f64, ms));
    let name = |i: usize| named[i].0.clone();
    Ok(OneWay {
        means: (0..named.len()).map(|i| (name(i), sums.means[i])).collect(),
        counts: (0..named.len())
            .map(|i| (name(i), named[i].1.len()))
            .collect(),
        between_ss: sums.between,
        between_df,
        within_ss: sums.within,
        within_df,
        p: f.and_then(|f| f_upper_tail(f, between_df as f64, within_df as f64)),
        f,
        r2: ratio(sums.between, sums.between + sums.within),
        residual_sd: ms_within.map(f64::sqrt),
    })
}

/// The sums behind the analysis.
struct Sums {
    /// Group means, unit of the response.
    means: Vec<f64>,
    /// Sum of squares between groups.
    between: f64,
    /// Sum of squares within groups.
    within: f64,
}

/// Sums of squares of lists of responses. They are taken about the first response, which keeps the
/// partial sums small.
fn sums(lists: &[&[Wide]]) -> Sums {
    let origin = lists[0][0];
    let mean = |values: &mut dyn Iterator<Item = Wide>| {
        let (mut n, mut sum) = (0.0, Wide::ZERO);
        for value in values {
            n += 1.0;
            sum += value;
        }
        sum.divided_by(n)
    };
    let about = |y: &Wide| *y - origin;
    let means: Vec<Wide> = lists
        .iter()
        .map(|list| mean(&mut list.iter().map(about)))
        .collect();
    let all = mean(&mut lists.iter().flat_map(|list| list.iter().map(about)));
    let (mut between, mut within) = (Wide::ZERO, Wide::ZERO);
    for (list, &mean) in lists.iter().zip(&means) {
        let gap = mean - all;
        between += gap * gap * Wide::from(list.len() as f64);
        for y in *list {
            let rest = about(y) - mean;
            within += rest * rest;
        }
    }
    let whole = |mean: Wide| (origin + mean).rounded();
    Sums {
        means: means.into_iter().map(whole).collect(),
        between: between.rounded(),
        within: within.rounded(),
    }
}
