//! The solution at which the scatter of the factors does least to the response.

use experiment_design::Factor;
use probability::random_stream::Stream;
use serde::{Deserialize, Serialize};

use super::along::quadratic_roots;
use crate::surface::propagation::{coded_variances, transmitted_variance};
use crate::surface::quadratic::Quadratic;
use crate::{Error, Fit};

/// Lines on which solutions are looked for.
const LINES: usize = 4000;
/// Best of them that are improved.
const IMPROVED: usize = 10;

/// The solution of least transmitted scatter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robust {
    /// Natural point, units of the factors.
    pub solution: Vec<f64>,
    /// Coded point.
    pub coded: Vec<f64>,
    /// Standard deviation that the factors hand on there, unit of the response.
    pub transmitted_sd: f64,
    /// Symbols of the factors that lie on a bound.
    pub at_bound: Vec<String>,
}

/// Finds the point of the solution set where the transmitted standard deviation (see
/// [`Fit::propagation`]) is least; none if the surface does not meet the target in the box.
///
/// Solutions are taken on lines parallel to each factor through random points, and the best of them
/// are moved along the set by ever smaller steps.
///
/// # Errors
/// [`Error::DegreeTooHigh`]; [`Error::Length`] and [`Error::SettingOutOfRange`] for standard deviations
/// that are invalid.
pub fn most_robust(fit: &Fit, target: f64, factor_sd: &[f64]) -> Result<Option<Robust>, Error> {
    let mut shifted = fit.quadratic()?;
    let variances = coded_variances(&fit.factors, factor_sd)?;
    shifted.constant -= target;
    let k = fit.factors.len();
    let cost = |x: &[f64]| transmitted_variance(&shifted, x, &variances);
    let mut stream = Stream::new(1, "robust solution");
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    for i in 0..LINES {
        let x: Vec<f64> = (0..k).map(|_| stream.between(-1.0, 1.0)).collect();
        let on_line = onto_set(&shifted, &x, i % k);
        found.extend(on_line.into_iter().map(|x| (cost(&x), x)));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(IMPROVED);
    for (reached, x) in &mut found {
        improve(&shifted, &cost, reached, x);
    }
    let best = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let bound = |(f, x): (&Factor, &f64)| (x.abs() >= 1.0).then(|| f.symbol().to_owned());
    Ok(best.map(|(variance, coded)| Robust {
        solution: fit.natural(&coded),
        transmitted_sd: variance.sqrt(),
        at_bound: fit.factors.iter().zip(&coded).filter_map(bound).collect(),
        coded,
    }))
}

/// Points of the set on the line through x along factor j, within the box.
fn onto_set(shifted: &Quadratic, x: &[f64], j: usize) -> Vec<Vec<f64>> {
    let mut base = x.to_vec();
    base[j] = 0.0;
    let slope = shifted.gradient(&base)[j];
    let roots = quadratic_roots(0.5 * shifted.hessian[(j, j)], slope, shifted.value(&base));
    let inside = roots.into_iter().filter(|root| root.abs() <= 1.0);
    let with = |root: f64| {
        let mut point = base.clone();
        point[j] = root;
        point
    };
    inside.map(with).collect()
}

/// Moves every factor but one by a step, and that one back onto the set, while that lowers the cost.
fn improve(shifted: &Quadratic, cost: &dyn Fn(&[f64]) -> f64, reached: &mut f64, x: &mut Vec<f64>) {
    let k = x.len();
    let mut step = 0.1;
    while step > 1e-9 {
        let before = *reached;
        for i in 0..k {
            for j in (0..k).filter(|&j| j != i) {
                for direction in [step, -step] {
                    let mut moved = x.clone();
                    moved[i] = (moved[i] + direction).clamp(-1.0, 1.0);
                    for point in onto_set(shifted, &moved, j) {
                        let value = cost(&point);
                        if value < *reached {
                            (*reached, *x) = (value, point);
                        }
                    }
                }
            }
        }
        if *reached >= before {
            step *= 0.5;
        }
    }
}
