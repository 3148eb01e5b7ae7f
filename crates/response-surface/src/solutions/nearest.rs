//! The solution nearest to given values.

use experiment_design::Factor;
use nalgebra::{DVector, SymmetricEigen};
use serde::{Deserialize, Serialize};

use super::along::quadratic_roots;
use super::range::golden_minimum;
use super::region::{GivenOthers, Membership};
use super::{Measured, SolutionRequest};
use crate::surface::quadratic::{Face, Quadratic, faces, free_places, point_on_face};
use crate::{Fit, NamedValues};

/// Weight of the squared coded distance from the middle of the range for a factor without a
/// measured value, against 1 for a difference of one scale. It only decides among solutions that
/// are equally near otherwise; it moves them by about 1e-7.
const FREE_WEIGHT: f64 = 1e-7;

/// Share by which a point of the set one rounding further in must be nearer than an extreme to be taken for another
/// extreme: more than the root of the rounding, about 1e-7, can bring.
const NEARER: f64 = 1e-5;

/// A solution and its distance from given values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Nearest {
    /// Length that counts as one for each factor, unit of the factor; `None` if no errors are given.
    pub scale: Vec<Option<f64>>,
    /// Natural point, units of the factors.
    pub solution: Vec<f64>,
    /// Coded point.
    pub coded: Vec<f64>,
    /// Root of the sum of squared differences over scales.
    pub distance: f64,
    /// Value of the surface there, unit of the response: the target to rounding.
    pub value: f64,
    /// Symbols of the factors that lie on a bound of their range.
    pub at_bound: Vec<String>,
    /// Interval of each factor in the region, the others held; none without an error variance.
    pub given_others: Option<NamedValues<GivenOthers>>,
}

/// A squared distance in coded coordinates: sum of weight (x - centre)^2.
#[derive(Debug, Clone)]
struct Metric {
    /// Point that distances are measured from, coded.
    centre: Vec<f64>,
    /// Weights, above zero.
    weights: Vec<f64>,
}

impl Metric {
    /// Squared distance of a coded point.
    fn squared(&self, x: &[f64]) -> f64 {
        let terms = self.weights.iter().zip(&self.centre).zip(x);
        terms.map(|((w, c), x)| w * (x - c) * (x - c)).sum()
    }
}

/// The length of a factor that a metric counts as one, unit of the factor.
type Length<'a> = &'a dyn Fn(&Measured, &Factor) -> Option<f64>;

/// A named metric: the values to lie near, and the length of each factor that counts as one.
pub(crate) struct NamedMetric {
    /// `sd`, `standard_error` or `coded`.
    pub(crate) name: &'static str,
    /// Measured values; the middle of the ranges if none are given.
    pub(crate) near: Vec<Option<Measured>>,
    /// Lengths, units of the factors.
    pub(crate) scale: Vec<Option<f64>>,
}

/// The metrics that the request allows.
pub(crate) fn metrics(fit: &Fit, request: &SolutionRequest) -> Vec<NamedMetric> {
    let k = fit.factors.len();
    let mut near = request.near.clone();
    if near.iter().all(Option::is_none) {
        let middle = |f: &Factor| {
            Some(Measured {
                value: f.mid(),
                sd: None,
                n: None,
            })
        };
        near = fit.factors.iter().map(middle).collect();
    }
    let sd: Length = &|m, _| m.sd;
    let se: Length = &|m, _| Some(m.sd? / (m.n? as f64).sqrt());
    let coded: Length = &|_, f| Some(f.half_range());
    let all: [(&'static str, Length); 3] = [("sd", sd), ("standard_error", se), ("coded", coded)];
    let metric = |(name, length): (&'static str, Length)| {
        let scale: Vec<Option<f64>> = (0..k)
            .map(|j| length(near[j].as_ref()?, &fit.factors[j]))
            .collect();
        // A metric needs a length for every value given.
        let known = (0..k).all(|j| near[j].is_none() || scale[j].is_some());
        known.then(|| NamedMetric {
            name,
            near: near.clone(),
            scale,
        })
    };
    all.into_iter().filter_map(metric).collect()
}

/// The nearest solutions under all metrics that the request allows.
pub(crate) fn all_metrics(
    fit: &Fit,
    quadratic: &Quadratic,
    target: f64,
    request: &SolutionRequest,
    membership: Option<&Membership>,
) -> NamedValues<Nearest> {
    let found = metrics(fit, request).into_iter().filter_map(|metric| {
        let nearest = nearest(fit, quadratic, target, &metric.near, &metric.scale)?;
        let given_others = membership.map(|m| m.given_others(&nearest.coded));
        let nearest = Nearest {
            given_others,
            ..nearest
        };
        Some((metric.name.to_owned(), nearest))
    });
    found.collect()
}

/// The nearest solution under one metric.
pub(crate) fn nearest(
    fit: &Fit,
    quadratic: &Quadratic,
    target: f64,
    near: &[Option<Measured>],
    scale: &[Option<f64>],
) -> Option<Nearest> {
    let factors = fit.factors.iter();
    let weight =
        |(f, s): (&Factor, &Option<f64>)| s.map_or(FREE_WEIGHT, |s| (f.half_range() / s).powi(2));
    let centre = |(f, m): (&Factor, &Option<Measured>)| m.map_or(0.0, |m| f.coded(m.value));
    let metric = Metric {
        centre: factors.clone().zip(near).map(centre).collect(),
        weights: factors.clone().zip(scale).map(weight).collect(),
    };
    let shifted = Quadratic {
        constant: quadratic.constant - target,
        ..quadratic.clone()
    };
    let coded = nearest_zero(&shifted, &metric)
        .or_else(|| touching(&shifted, &metric, quadratic.rounding()))?;
    let solution = fit.natural(&coded);
    let squared = |j: usize| Some(((solution[j] - near[j]?.value) / scale[j]?).powi(2));
    let at_bound = factors.zip(&coded).filter(|(_, x)| x.abs() >= 1.0);
    Some(Nearest {
        scale: scale.to_vec(),
        distance: (0..coded.len()).filter_map(squared).sum::<f64>().sqrt(),
        value: quadratic.value(&coded),
        at_bound: at_bound.map(|(f, _)| f.symbol().to_owned()).collect(),
        solution,
        coded,
        given_others: None,
    })
}

/// The point of the box nearest to the centre of the metric at which a quadratic is zero; none if
/// it has no zero in the box.
///
/// The nearest point is a stationary point of the distance on the zero set within some face of
/// the box (3^k faces), so the stationary points of all faces are found and the nearest of them
/// that lies in the box is taken.
fn nearest_zero(quadratic: &Quadratic, metric: &Metric) -> Option<Vec<f64>> {
    let k = metric.centre.len();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for face in faces(k) {
        for free in zeros_on_face(quadratic, metric, &face) {
            if free.iter().any(|x| x.is_nan() || x.abs() > 1.0 + 1e-9) {
                continue;
            }
            let clamped: Vec<f64> = free.iter().map(|x| x.clamp(-1.0, 1.0)).collect();
            let point = point_on_face(&face, &clamped);
            let distance = metric.squared(&point);
            if best.as_ref().is_none_or(|(least, _)| distance < *least) {
                best = Some((distance, point));
            }
        }
    }
    best.map(|(_, point)| point)
}

/// The point nearest to the centre at which a quadratic that nowhere changes its sign in the box is zero to rounding;
/// none if it stays away from zero.
///
/// The zeros are extremes. A single one is found as such; of many, as along the bottom of a valley, the nearest is that of
/// the set one rounding further in, which lies within the root of the rounding of it.
fn touching(quadratic: &Quadratic, metric: &Metric, rounding: f64) -> Option<Vec<f64>> {
    let span = crate::surface::extremes::span(quadratic);
    let ends = [(span.lowest, span.min, 1.0), (span.highest, span.max, -1.0)];
    let (extreme, value, inward) = ends
        .into_iter()
        .find(|(_, value, _)| value.abs() <= rounding)?;
    let inside = Quadratic {
        constant: quadratic.constant - value - inward * rounding,
        ..quadratic.clone()
    };
    let nearby = nearest_zero(&inside, metric);
    let distance = |x: &[f64]| metric.squared(x).sqrt();
    let nearer = |x: &Vec<f64>| distance(x) < (1.0 - NEARER) * distance(&extreme);
    Some(nearby.filter(nearer).unwrap_or(extreme))
}

/// Candidates on one face: the free coordinates of its zeros that are stationary in distance.
fn zeros_on_face(quadratic: &Quadratic, metric: &Metric, face: &Face) -> Vec<Vec<f64>> {
    let free = free_places(face);
    let on_face = quadratic.on_face(face);
    match free[..] {
        [] => {
            // A corner counts only if the target is met there to rounding.
            let size = quadratic.linear.amax() + quadratic.hessian.amax();
            let meets = on_face.constant.abs() <= 1e-12 * size;
            if meets { vec![Vec::new()] } else { Vec::new() }
        }
        [_] => {
            let (a, b) = (0.5 * on_face.hessian[(0, 0)], on_face.linear[0]);
            quadratic_roots(a, b, on_face.constant)
                .into_iter()
                .map(|x| vec![x])
                .collect()
        }
        _ => {
            let centre: Vec<f64> = free.iter().map(|&j| metric.centre[j]).collect();
            let roots: Vec<f64> = free.iter().map(|&j| metric.weights[j].sqrt()).collect();
            stationary_zeros(&on_face, &centre, &roots)
        }
    }
}

/// Stationary points of the distance from `centre` on the zero set of a quadratic.
///
/// # Formula
/// With `z = sqrt(w) (x - centre)` in the eigenvectors of the scaled second derivatives `d_i`, and
/// `c_i` the gradient at the centre: `z_i = -lambda c_i / (1 + lambda d_i)`, and the multiplier
/// solves the secular equation `g0 + sum (c_i z_i + d_i z_i^2 / 2) = 0`. At a local minimum at
/// most one `1 + lambda d_i` is negative.
///
/// # Source
/// `[More1993]`; local minima: `[Martinez1994]`.
fn stationary_zeros(quadratic: &Quadratic, centre: &[f64], roots: &[f64]) -> Vec<Vec<f64>> {
    let m = centre.len();
    let scale = DVector::from_fn(m, |i, _| 1.0 / roots[i]);
    let scaled =
        nalgebra::DMatrix::from_fn(m, m, |i, j| quadratic.hessian[(i, j)] * scale[i] * scale[j]);
    let eigen = SymmetricEigen::new(scaled);
    let gradient = quadratic.gradient(centre).component_mul(&scale);
    // A curvature that bends the surface over the box by less than its rounding puts the poles beyond all digits.
    let reach = (0..m).fold(0.0_f64, |reach, i| {
        reach.max(roots[i] * (1.0 + centre[i].abs()))
    });
    let counts = |d: &f64| d.abs() * reach > 1e-15 * gradient.amax();
    let curvatures = eigen.eigenvalues.iter();
    let curvatures = curvatures.map(|d| if counts(d) { *d } else { 0.0 });
    let secular = Secular {
        offset: quadratic.value(centre),
        slopes: eigen.eigenvectors.tr_mul(&gradient).as_slice().to_vec(),
        curvatures: curvatures.collect(),
    };
    let point = |z: Vec<f64>| -> Vec<f64> {
        let z = &eigen.eigenvectors * DVector::from_vec(z);
        (0..m).map(|i| centre[i] + z[i] * scale[i]).collect()
    };
    secular.stationary_points().into_iter().map(point).collect()
}

/// The secular equation of the nearest zero.
#[derive(Debug)]
struct Secular {
    /// Value at the centre.
    offset: f64,
    /// Gradient at the centre, c.
    slopes: Vec<f64>,
    /// Second derivatives, d.
    curvatures: Vec<f64>,
}

impl Secular {
    /// The coordinates that belong to a multiplier.
    fn coordinates(&self, lambda: f64) -> Vec<f64> {
        let pairs = self.slopes.iter().zip(&self.curvatures);
        pairs
            .map(|(c, d)| {
                if *c == 0.0 {
                    0.0
                } else {
                    -lambda * c / (1.0 + lambda * d)
                }
            })
            .collect()
    }

    /// The quadratic at given coordinates.
    fn quadratic(&self, z: &[f64]) -> f64 {
        let parts = self.slopes.iter().zip(&self.curvatures).zip(z);
        self.offset + parts.map(|((c, d), z)| z * (c + 0.5 * d * z)).sum::<f64>()
    }

    /// The quadratic as a function of the multiplier.
    fn value(&self, lambda: f64) -> f64 {
        self.quadratic(&self.coordinates(lambda))
    }

    /// All coordinates that can be a local minimum of the distance.
    fn stationary_points(&self) -> Vec<Vec<f64>> {
        if self.offset == 0.0 {
            return vec![vec![0.0; self.slopes.len()]];
        }
        let size = self
            .curvatures
            .iter()
            .fold(0.0_f64, |size, d| size.max(d.abs()));
        let curved = self.curvatures.iter().filter(|d| d.abs() > 1e-12 * size);
        let mut poles: Vec<f64> = curved.map(|d| -1.0 / d).collect();
        poles.sort_by(f64::total_cmp);
        let mut ends = vec![f64::NEG_INFINITY];
        ends.extend(&poles);
        ends.push(f64::INFINITY);
        let mut found = Vec::new();
        for pair in ends.windows(2) {
            let between = self.interval_nodes(pair[0], pair[1]);
            let Some(&inner) = between.get(between.len() / 2) else {
                continue;
            };
            let negative = self
                .curvatures
                .iter()
                .filter(|d| 1.0 + inner * **d < 0.0)
                .count();
            if negative <= 1 {
                let multipliers = self.roots(&between);
                found.extend(
                    multipliers
                        .into_iter()
                        .map(|lambda| self.coordinates(lambda)),
                );
            }
        }
        for pole in poles {
            found.extend(self.at_pole(pole));
        }
        found
    }

    /// Scan points between two poles, dense towards both.
    fn interval_nodes(&self, low: f64, high: f64) -> Vec<f64> {
        const NODES: usize = 80;
        if high <= low {
            return Vec::new();
        }
        let slope: f64 = self.slopes.iter().map(|c| c * c).sum();
        let natural = if slope > 0.0 {
            self.offset.abs() / slope
        } else {
            1.0
        };
        let reach = |end: f64| natural.max(end.abs()).max(1e-300);
        let node = |i: usize| {
            // From 1e-14 to 1 - 1e-14 on a logistic scale.
            let s = 64.0 * (i as f64 / NODES as f64 - 0.5);
            let (u, v) = (1.0 / (1.0 + (-s).exp()), 1.0 / (1.0 + s.exp()));
            match (low.is_finite(), high.is_finite()) {
                (true, true) if u < 0.5 => low + (high - low) * u,
                (true, true) => high - (high - low) * v,
                (true, false) => low + reach(low) * u / v,
                (false, true) => high - reach(high) * v / u,
                (false, false) => natural * (u / v - v / u),
            }
        };
        (0..=NODES)
            .map(node)
            .filter(|x| *x > low && *x < high)
            .collect()
    }

    /// Multipliers at which the quadratic is zero, between the first and the last node.
    fn roots(&self, nodes: &[f64]) -> Vec<f64> {
        let values: Vec<f64> = nodes.iter().map(|&lambda| self.value(lambda)).collect();
        let mut roots = Vec::new();
        let mut cross = |a: f64, fa: f64, b: f64, fb: f64| {
            if fa.is_finite() && fb.is_finite() && (fa > 0.0) != (fb > 0.0) {
                roots.push(self.bisect(a, b));
            }
        };
        for i in 1..nodes.len() {
            cross(nodes[i - 1], values[i - 1], nodes[i], values[i]);
            // A turning point between nodes may hide two roots.
            let Some(next) = values.get(i + 1) else {
                continue;
            };
            let side = values[i].signum();
            let same = side == values[i - 1].signum() && side == next.signum();
            if same && side * values[i] <= side * values[i - 1] && side * values[i] <= side * next {
                let (a, c) = (nodes[i - 1], nodes[i + 1]);
                let turn = golden_minimum(&|lambda| side * self.value(lambda), a, c);
                let value = self.value(turn);
                cross(a, values[i - 1], turn, value);
                cross(turn, value, c, *next);
            }
        }
        roots
    }

    /// The sign change between two multipliers, to the last bits.
    fn bisect(&self, mut a: f64, mut b: f64) -> f64 {
        let positive = self.value(a) > 0.0;
        for _ in 0..200 {
            let middle = 0.5 * (a + b);
            if (self.value(middle) > 0.0) == positive {
                a = middle;
            } else {
                b = middle;
            }
        }
        0.5 * (a + b)
    }

    /// Candidates where one `1 + lambda d_i` is zero: possible only if its slope is zero, and then
    /// that coordinate is free to take either sign (the centre lies on an axis of symmetry).
    fn at_pole(&self, pole: f64) -> Vec<Vec<f64>> {
        let size = self
            .slopes
            .iter()
            .fold(0.0_f64, |size, c| size.max(c.abs()));
        let singular = |i: &usize| (1.0 + pole * self.curvatures[*i]).abs() < 1e-9;
        let places: Vec<usize> = (0..self.slopes.len()).filter(singular).collect();
        let flat = |i: &usize| self.slopes[*i].abs() <= 1e-9 * size.max(self.offset.abs());
        let Some(&first) = places.first().filter(|_| places.iter().all(flat)) else {
            return Vec::new();
        };
        let mut z = self.coordinates(pole);
        for &i in &places {
            z[i] = 0.0;
        }
        let roots = quadratic_roots(
            0.5 * self.curvatures[first],
            self.slopes[first],
            self.quadratic(&z),
        );
        let with = |root: f64| {
            let mut z = z.clone();
            z[first] = root;
            z
        };
        roots.into_iter().map(with).collect()
    }
}
