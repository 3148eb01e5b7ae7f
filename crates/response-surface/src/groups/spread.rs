//! Do the runs scatter alike everywhere? Bartlett's and Levene's tests over repeated settings.

use serde::{Deserialize, Serialize};

use crate::fit::{Bartlett, FTest, bartlett_of, same_settings};
use crate::{Observations, one_way};

/// Tests that all settings have one variance, from single runs that share their settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Number of settings with two runs or more.
    pub groups: usize,
    /// Bartlett's test; none for fewer than two groups or a group without scatter.
    pub bartlett: Option<Bartlett>,
    /// Number of settings with three runs or more, which Levene's test is made over.
    #[serde(default)]
    pub levene_groups: usize,
    /// Levene's test with distances from the medians (Brown and Forsythe); none for fewer than two settings with three
    /// runs or more. Two runs lie equally far from their median, so pairs have no scatter of distances whatever
    /// their variance is: over pairs F would be infinite, and pairs among larger groups would make it too large.
    pub levene: Option<FTest>,
}

/// The tests; none if no two settings are repeated, or if rows are means of runs (the single runs
/// are then not known; Bartlett's test on the given standard deviations is part of the fit).
///
/// # Source
/// `[Bartlett1937]`; `[BrownForsythe1974]`; distances that are equal by their making: `[HinesHines2000]`.
pub fn spread(data: &Observations) -> Option<Spread> {
    let cells = data.cells();
    if cells.iter().any(|cell| cell.n > 1) {
        return None;
    }
    let groups: Vec<Vec<f64>> = same_settings(data)
        .into_iter()
        .filter(|group| group.len() > 1)
        .map(|group| group.into_iter().map(|i| cells[i].mean).collect())
        .collect();
    if groups.len() < 2 {
        return None;
    }
    let variance = |group: &Vec<f64>| {
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        let squares: f64 = group.iter().map(|y| (y - mean).powi(2)).sum();
        (group.len() - 1, squares / (group.len() - 1) as f64)
    };
    let variances: Vec<(usize, f64)> = groups.iter().map(variance).collect();
    let bartlett = bartlett_of(&variances);
    let all = groups.len();
    let larger: Vec<Vec<f64>> = groups.into_iter().filter(|group| group.len() > 2).collect();
    Some(Spread {
        groups: all,
        bartlett,
        levene_groups: larger.len(),
        levene: levene(&larger),
    })
}

/// One-way analysis of variance of the distances from the medians.
fn levene(groups: &[Vec<f64>]) -> Option<FTest> {
    let (mut labels, mut distances) = (Vec::new(), Vec::new());
    for (i, group) in groups.iter().enumerate() {
        let middle = probability::median(group);
        labels.extend(std::iter::repeat_n(i.to_string(), group.len()));
        distances.extend(group.iter().map(|y| (y - middle).abs()));
    }
    let tested = one_way(&labels, &distances).ok()?;
    Some(FTest {
        f: tested.f,
        df1: tested.between_df,
        df2: tested.within_df,
        p: tested.p,
    })
}
