//! The points that the data cannot tell from a solution.

use serde::{Deserialize, Serialize};

use super::range::{Interval, pieces};
use crate::fit::ErrorVariance;
use crate::surface::quadratic::Quadratic;
use crate::{Fit, NamedValues};

/// Points x of the box with `|yhat(x) - T| <= t sqrt(s^2 x'Cx + s_T^2)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// Two-sided 5 % limit of Student's t.
    pub t_limit: f64,
    /// Share of the volume of the box that the region fills.
    pub box_fraction: f64,
    /// Standard error of `box_fraction` where lines are sampled; 0 on a grid of lines, whose
    /// error is about 1e-4.
    pub box_fraction_se: f64,
    /// Number of lines, parallel to the first factor, along which the region was measured.
    pub n_lines: usize,
    /// Whether the region reaches the low and the high bound of each factor: it is open there, the
    /// data give no limit.
    #[serde(default)]
    pub open: NamedValues<[bool; 2]>,
}

/// The interval of one factor in the region, the others at the solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GivenOthers {
    /// The interval around the solution, unit of the factor, cut at the range of the factor.
    pub natural: Interval,
    /// Whether it is cut at the low bound: the data give no lower limit.
    pub open_below: bool,
    /// Whether it is cut at the high bound: the data give no upper limit.
    pub open_above: bool,
}

/// What decides whether a point belongs to the region.
#[derive(Debug)]
pub(crate) struct Membership<'a> {
    pub(crate) fit: &'a Fit,
    /// Its surface.
    pub(crate) quadratic: &'a Quadratic,
    /// Target, unit of the response.
    pub(crate) target: f64,
    /// Two-sided limit of Student's t.
    pub(crate) t_limit: f64,
    /// Error variance of a cell mean.
    pub(crate) error: ErrorVariance,
    /// Squared standard error of the target.
    pub(crate) target_variance: f64,
}

impl Membership<'_> {
    /// `(yhat - T)^2 - t^2 (s^2 x'Cx + s_T^2)`: zero or negative inside. A polynomial of degree
    /// four in every coordinate.
    pub(crate) fn miss(&self, x: &[f64]) -> f64 {
        let variance = self.error.variance * self.fit.leverage(x) + self.target_variance;
        (self.quadratic.value(x) - self.target).powi(2) - self.t_limit.powi(2) * variance
    }

    /// Intervals of the factors around a solution, each with the others held there.
    pub(crate) fn given_others(&self, solution: &[f64]) -> NamedValues<GivenOthers> {
        let interval = |(j, factor): (usize, &experiment_design::Factor)| {
            let quartic = self.along(solution, j);
            let here = solution[j];
            // At a solution the polynomial is not positive; the tolerance is its rounding.
            let pieces = pieces(&|x| quartic.value(x));
            let piece = pieces
                .into_iter()
                .find(|p| p.low - 1e-9 <= here && here <= p.high + 1e-9)?;
            let given = GivenOthers {
                natural: Interval {
                    low: factor.natural(piece.low),
                    high: factor.natural(piece.high),
                },
                open_below: piece.low <= -1.0,
                open_above: piece.high >= 1.0,
            };
            Some((factor.symbol().to_owned(), given))
        };
        self.fit
            .factors
            .iter()
            .enumerate()
            .filter_map(interval)
            .collect()
    }

    /// The polynomial of `miss` along coordinate j through a point.
    fn along(&self, point: &[f64], j: usize) -> Quartic {
        let mut x = point.to_vec();
        Quartic::through(|value| {
            x[j] = value;
            self.miss(&x)
        })
    }
}

/// A polynomial of degree four.
#[derive(Debug, Clone, Copy)]
struct Quartic {
    /// Coefficients of 1, x, x^2, x^3, x^4.
    coefficients: [f64; 5],
}

impl Quartic {
    /// The quartic that agrees with a function at -1, -1/2, 0, 1/2 and 1.
    fn through(mut f: impl FnMut(f64) -> f64) -> Self {
        let [a, b, c, d, e] = [-1.0, -0.5, 0.0, 0.5, 1.0].map(&mut f);
        let (even1, even2) = (0.5 * (a + e) - c, 0.5 * (b + d) - c);
        let (odd1, odd2) = (0.5 * (e - a), 0.5 * (d - b));
        // even1 = c2 + c4, even2 = c2/4 + c4/16; odd1 = c1 + c3, odd2 = c1/2 + c3/8.
        let c4 = (4.0 * even1 - 16.0 * even2) / 3.0;
        let c3 = (4.0 * odd1 - 8.0 * odd2) / 3.0;
        Self {
            coefficients: [c, odd1 - c3, even1 - c4, c3, c4],
        }
    }

    fn value(self, x: f64) -> f64 {
        self.coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, c| sum * x + c)
    }

    /// Share of -1..+1 on which the value is zero or negative: signs on a grid, the crossings
    /// between by linear interpolation.
    fn share_not_positive(self) -> f64 {
        const STEPS: usize = 64;
        let mut share = 0.0;
        let mut before = self.value(-1.0);
        for i in 1..=STEPS {
            let value = self.value(-1.0 + 2.0 * i as f64 / STEPS as f64);
            share += match (before <= 0.0, value <= 0.0) {
                (true, true) => 1.0,
                (false, false) => 0.0,
                (true, false) => before / (before - value),
                (false, true) => value / (value - before),
            };
            before = value;
        }
        share / STEPS as f64
    }
}

/// Measures the region along lines parallel to the first factor.
///
/// Up to three factors the lines stand on a grid of midpoints of the other factors; beyond, at
/// 4096 points of the additive recurrence with the generalised golden ratio, whose error is
/// estimated from 16 groups.
pub(crate) fn region(membership: &Membership) -> Region {
    let others = membership.fit.factors.len() - 1;
    let share = |position: Vec<f64>| {
        let mut point = vec![0.0];
        point.extend(position.iter().map(|u| 2.0 * u - 1.0));
        membership.along(&point, 0).share_not_positive()
    };
    let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let shares: Vec<f64> = match others {
        0 => vec![share(Vec::new())],
        1 => (0..400).map(|i| share(vec![middle(i, 400)])).collect(),
        2 => (0..80 * 80)
            .map(|i| share(vec![middle(i % 80, 80), middle(i / 80, 80)]))
            .collect(),
        _ => (0..4096).map(|i| share(recurrence(i, others))).collect(),
    };
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let box_fraction = mean(&shares);
    let box_fraction_se = if others > 2 {
        let groups: Vec<f64> = shares.chunks(256).map(mean).collect();
        let n = groups.len() as f64;
        (groups
            .iter()
            .map(|g| (g - box_fraction).powi(2))
            .sum::<f64>()
            / (n * (n - 1.0)))
            .sqrt()
    } else {
        0.0
    };
    Region {
        t_limit: membership.t_limit,
        box_fraction,
        box_fraction_se,
        n_lines: shares.len(),
        open: open_ends(membership),
    }
}

/// Points of a face of the box at which it is asked whether the region reaches it.
const FACE_POINTS: usize = 2048;

/// Whether the region reaches the bounds of each factor.
fn open_ends(membership: &Membership) -> NamedValues<[bool; 2]> {
    let others = membership.fit.factors.len() - 1;
    let points: Vec<Vec<f64>> = match others {
        0 => vec![Vec::new()],
        _ => (0..FACE_POINTS).map(|i| recurrence(i, others)).collect(),
    };
    let reaches = |j: usize, end: f64| {
        points.iter().any(|point| {
            let mut x: Vec<f64> = point.iter().map(|u| 2.0 * u - 1.0).collect();
            x.insert(j, end);
            membership.miss(&x) <= 0.0
        })
    };
    let factors = membership.fit.factors.iter().enumerate();
    let ends = |(j, f): (usize, &experiment_design::Factor)| {
        (f.symbol().to_owned(), [reaches(j, -1.0), reaches(j, 1.0)])
    };
    factors.map(ends).collect()
}

/// Point i of a sequence that fills the unit cube evenly: multiples of 1/phi, 1/phi^2, ..., phi
/// the root of phi^(d+1) = phi + 1 `[Roberts2018]`.
fn recurrence(i: usize, d: usize) -> Vec<f64> {
    let mut phi = 1.5_f64;
    for _ in 0..50 {
        phi = (1.0 + phi).powf(1.0 / (d as f64 + 1.0));
    }
    let multiple = |power: i32| (0.5 + (i + 1) as f64 / phi.powi(power)).fract();
    (1..).take(d).map(multiple).collect()
}
