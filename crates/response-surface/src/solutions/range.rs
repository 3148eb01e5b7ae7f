//! The range of every factor on the set of solutions.

use serde::{Deserialize, Serialize};

use crate::surface::extremes::span;
use crate::surface::quadratic::{Face, Quadratic};
use crate::{Fit, NamedValues};

/// Steps of the scan over the range of a factor. A gap or an island of solutions narrower than a
/// step is still found where the distance from the target has its own minimum there.
const STEPS: usize = 64;

/// The part of the range of a factor on which there are solutions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorRange {
    /// Least and greatest value on the set, unit of the factor.
    pub natural: Interval,
    /// The same, coded.
    pub coded: Interval,
    /// The separate pieces, unit of the factor; one if the set has no gap.
    pub pieces: Vec<Interval>,
}

/// A closed interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "[f64; 2]", from = "[f64; 2]")]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl From<Interval> for [f64; 2] {
    fn from(interval: Interval) -> Self {
        [interval.low, interval.high]
    }
}

impl From<[f64; 2]> for Interval {
    fn from([low, high]: [f64; 2]) -> Self {
        Self { low, high }
    }
}

/// Ranges of all factors on the set where the surface has the value `target`.
///
/// A value of a factor belongs to the range if the target lies between the extremes of the
/// surface over the other factors, which are found exactly.
pub(crate) fn factor_ranges(
    fit: &Fit,
    quadratic: &Quadratic,
    target: f64,
) -> NamedValues<FactorRange> {
    let range = |(j, factor): (usize, &experiment_design::Factor)| {
        let miss = |x: f64| miss_on_slice(quadratic, target, j, x);
        let coded = pieces(&miss);
        let natural = |i: &Interval| Interval {
            low: factor.natural(i.low),
            high: factor.natural(i.high),
        };
        let whole = Interval {
            low: coded.first()?.low,
            high: coded.last()?.high,
        };
        let range = FactorRange {
            natural: natural(&whole),
            coded: whole,
            pieces: coded.iter().map(natural).collect(),
        };
        Some((factor.symbol().to_owned(), range))
    };
    fit.factors.iter().enumerate().filter_map(range).collect()
}

/// How far the target lies outside what the surface reaches where coordinate j is x; zero or
/// negative if there is a solution.
fn miss_on_slice(quadratic: &Quadratic, target: f64, j: usize, x: f64) -> f64 {
    let face: Face = (0..quadratic.linear.len())
        .map(|i| (i == j).then_some(x))
        .collect();
    let reached = span(&quadratic.on_face(&face));
    let miss = (reached.min - target).max(target - reached.max);
    // A surface that only touches the target does so to rounding.
    if miss.abs() <= quadratic.rounding() {
        0.0
    } else {
        miss
    }
}

/// Maximal intervals of -1..+1 on which a continuous function is zero or negative.
pub(crate) fn pieces(miss: &dyn Fn(f64) -> f64) -> Vec<Interval> {
    let nodes = nodes(miss);
    let mut pieces: Vec<Interval> = Vec::new();
    let mut open = false;
    for (i, &(x, m)) in nodes.iter().enumerate() {
        let inside = m <= 0.0;
        let edge = || match i.checked_sub(1).map(|before| nodes[before].0) {
            Some(before) => boundary(miss, before, x),
            None => x,
        };
        match (inside, open) {
            (true, false) => pieces.push(Interval {
                low: edge(),
                high: x,
            }),
            (true, true) => {
                if let Some(last) = pieces.last_mut() {
                    last.high = x;
                }
            }
            (false, true) => {
                if let Some(last) = pieces.last_mut() {
                    last.high = edge();
                }
            }
            (false, false) => {}
        }
        open = inside;
    }
    pieces
}

/// The scan points with the values there: a grid, and the turning points between that change the
/// sign.
fn nodes(miss: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let step = |i: usize| -1.0 + 2.0 * i as f64 / STEPS as f64;
    let grid: Vec<(f64, f64)> = (0..=STEPS).map(|i| (step(i), miss(step(i)))).collect();
    let mut nodes = grid.clone();
    for three in grid.windows(3) {
        let [(a, fa), (_, fb), (c, fc)] = three else {
            continue;
        };
        let side = if *fb > 0.0 { 1.0 } else { -1.0 };
        let turns = side * fb <= side * fa && side * fb <= side * fc;
        if turns && side * fa > 0.0 && side * fc > 0.0 {
            let x = golden_minimum(&|x| side * miss(x), *a, *c);
            let m = miss(x);
            if side * m <= 0.0 {
                nodes.push((x, m));
            }
        }
    }
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    nodes
}

/// The place between a and b where the sign changes, to 1e-15, on the side that is not positive.
fn boundary(miss: &dyn Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let a_inside = miss(a) <= 0.0;
    let (mut inside, mut outside) = if a_inside { (a, b) } else { (b, a) };
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if miss(middle) <= 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

/// Minimum of a unimodal function between a and b by golden sections `[Kiefer1953]`.
pub(crate) fn golden_minimum(f: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    for _ in 0..60 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - ratio * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + ratio * (b - a);
            fd = f(d);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::pieces;

    /// An island of width 0.002, far below the step of 1/32, is found at the minimum.
    #[test]
    fn narrow_islands_and_gaps_are_found() {
        let island = pieces(&|x| (x - 0.3017).abs() - 0.001);
        assert_eq!(island.len(), 1);
        assert!((island[0].low - 0.3007).abs() < 1e-12, "{island:?}");
        let gap = pieces(&|x| 0.001 - (x - 0.3017).abs());
        assert_eq!(gap.len(), 2);
        assert!((gap[0].high - 0.3007).abs() < 1e-12, "{gap:?}");
        assert_eq!(pieces(&|_| 1.0), []);
    }
}
