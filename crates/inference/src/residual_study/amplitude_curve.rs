//! What runs at several amplitudes of an effect say of its amplitude: the estimate, and the interval by a test at each amplitude.

use crate::diagnosis::{Amplitude, least_squares_step};
use nalgebra::{DMatrix, DVector};

/// Difference of two amplitudes over the larger from which on their slope is used beyond them.
const APART: f64 = 0.2;
/// Steps of the range in which ends of the interval are looked for.
const STEPS: usize = 200;
/// Bends that are tried on each side, times the largest amplitude: a response that saturates in a twentieth of it needs the last.
const BENDS: [f64; 10] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 13.0, 20.0];
/// By how much the squares of a bend that agrees with the runs may exceed those of the best, over the variance of the runs: the quantile of
/// chi-squared on one degree of freedom at 95 %.
const LIKELY_BEND: f64 = 3.84;
/// Halvings of a step to the end of the interval in it.
const HALVINGS: usize = 30;

/// A response to an amplitude that is straight at a bend of 0, saturates at a positive one, and bends upwards at a negative one:
/// `(1 - exp(-b a)) / b`. The length over which it saturates is 1 / b.
fn response(bend: f64, a: f64) -> f64 {
    if bend == 0.0 {
        a
    } else {
        -(-bend * a).exp_m1() / bend
    }
}

/// Runs at one amplitude.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) amplitude: f64,
    /// Whitened residual of these runs, less what the parameters do on the way to the end of the fit.
    pub(super) residual: DVector<f64>,
    pub(super) block: u64,
}

/// Runs at several amplitudes, and what else can move their residual.
#[derive(Debug, Clone)]
pub(super) struct Runs {
    /// By amplitude, in the order in which they were made.
    pub(super) nodes: Vec<Node>,
    /// Whitened slopes of the parameters and of the other effects.
    pub(super) slopes: DMatrix<f64>,
    /// How far these may go from the end of the fit.
    pub(super) ways: [Vec<f64>; 2],
    /// Covariance of a mean of runs, whitened.
    pub(super) covariance: DMatrix<f64>,
    /// Share of the noise that runs of one block do not share.
    pub(super) own_noise: f64,
    /// Quantile of the test.
    pub(super) quantile: f64,
}

/// What runs say of an effect along its amplitude, the parameters re-tuned at each.
///
/// # Formula
///
/// With the whitened residuals `r_i` of the runs at the amplitudes `a_i`, the residual at an amplitude a is
/// `r(a) = sum_i w_i(a) r_i`, the w of the line between its two neighbours, beyond the last of that through the last two: a straight
/// line over the [`response`], whose bend is not known: a bend agrees with the runs if its squares exceed those of the best by no more
/// than a quantile of chi-squared, and an amplitude is accepted if it is with one of these bends. M takes off what parameters
/// inside their bounds do, and `p = M sum_i v_i r_i` is what the effect does between two of the amplitudes. The runs of each mean have the covariance Q. At the true amplitude
///
/// `z(a) = (p' M r(a) - k tr(M Q)) / sqrt(p'p + (s - 1) p' Q p + k^2 tr(M Q M Q))`, `k = v' C w`, `s = w' C w`
///
/// is standard normal in the limit of many values, t on the degrees of freedom of the covariance, C the correlation of the noise of
/// the runs at different amplitudes: the noise of p is in r(a) too, which moves the mean of the product. The interval reaches from
/// the least to the greatest amplitude at which |z| is below its quantile, as that of a ratio `[Fieller1954]`. [own]
pub(super) struct Curve {
    /// Sorted by amplitude.
    runs: Runs,
    /// Weight of each node in the direction.
    direction: Vec<f64>,
    /// How the response may bend, see [`response`]; the first agrees best with the runs.
    bends: Vec<f64>,
}

/// A test at one amplitude and another, as long as the same parameters are held at their bounds.
struct Projected {
    free: Vec<bool>,
    /// What the effect does beside them.
    along: DVector<f64>,
    /// `p' Q p`, `tr(M Q)` and `tr(M Q M Q)`.
    of_runs: [f64; 3],
}

impl Curve {
    /// The curve of runs at several amplitudes, in the order in which they were made; `None` if all are at one. `end` is the amplitude
    /// of the end of the fit, `largest` that of the range.
    pub(super) fn new(mut runs: Runs, end: f64, largest: f64) -> Option<Self> {
        let nodes = &mut runs.nodes;
        // Of several points at one amplitude the first counts: that is the end of the fit.
        nodes.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
        nodes.dedup_by(|later, first| later.amplitude == first.amplitude);
        if nodes.len() < 2 {
            return None;
        }
        let mut curve = Self {
            direction: vec![0.0; nodes.len()],
            bends: vec![0.0],
            runs,
        };
        curve.direct(end);
        curve.bend(largest);
        Some(curve)
    }

    /// Weights of the nodes at an amplitude, with one of the bends.
    fn weights(&self, a: f64, bend: f64) -> Vec<f64> {
        let at = |i: usize| self.runs.nodes[i].amplitude;
        let last = self.runs.nodes.len() - 1;
        let apart =
            |i: usize, j: usize| (at(i) - at(j)).abs() >= APART * at(i).abs().max(at(j).abs());
        let (i, j) = if a <= at(0) {
            (0, (1..=last).find(|&j| apart(0, j)).unwrap_or(last))
        } else if a >= at(last) {
            (last, (0..last).rev().find(|&j| apart(last, j)).unwrap_or(0))
        } else {
            let j = (1..=last).find(|&j| a <= at(j)).unwrap_or(last);
            (j - 1, j)
        };
        let along = |a: f64| response(bend, a);
        let share = (along(a) - along(at(i))) / (along(at(j)) - along(at(i)));
        let mut weights = vec![0.0; self.runs.nodes.len()];
        weights[i] = 1.0 - share;
        weights[j] = share;
        weights
    }

    /// Residual of so much of each node.
    fn mixed(&self, weights: &[f64]) -> DVector<f64> {
        let parts = self.runs.nodes.iter().zip(weights);
        let zero = DVector::zeros(self.runs.slopes.nrows());
        parts.fold(zero, |sum, (node, weight)| sum + &node.residual * *weight)
    }

    /// Covariance of the noise of the runs in two mixtures of nodes, over that of one.
    fn shared(&self, one: &[f64], other: &[f64]) -> f64 {
        let correlation = |i: usize, j: usize| match (
            i == j,
            self.runs.nodes[i].block == self.runs.nodes[j].block,
        ) {
            (true, _) => 1.0,
            (false, true) => 1.0 - self.runs.own_noise,
            (false, false) => 0.0,
        };
        let pairs = (0..one.len()).flat_map(|i| (0..other.len()).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| one[i] * other[j] * correlation(i, j))
            .sum()
    }

    /// The step of the parameters and the other effects that fits best at an amplitude.
    fn retuned(&self, residual: &DVector<f64>) -> DVector<f64> {
        least_squares_step(
            &self.runs.slopes,
            residual,
            &self.runs.ways[0],
            &self.runs.ways[1],
        )
    }

    /// The test with these parameters free.
    fn projected(&self, free: Vec<bool>) -> Projected {
        let columns: Vec<_> = (0..free.len()).filter(|&j| free[j]).collect();
        let slopes = self.runs.slopes.select_columns(&columns);
        let space = if columns.is_empty() {
            slopes
        } else {
            let svd = slopes.svd(true, false);
            let largest = svd.singular_values.max();
            let spans = |&j: &usize| svd.singular_values[j] > 1e-9 * largest;
            let kept: Vec<usize> = (0..svd.singular_values.len()).filter(spans).collect();
            svd.u.map(|u| u.select_columns(&kept)).unwrap_or_default()
        };
        let taken_off = |matrix: DMatrix<f64>| &matrix - &space * (space.transpose() * &matrix);
        let whole = self.mixed(&self.direction);
        let along = &whole - &space * (space.transpose() * &whole);
        let beside = taken_off(self.runs.covariance.clone());
        let product = (along.transpose() * &self.runs.covariance * &along)[(0, 0)];
        let twice = (&beside * &beside).trace();
        Projected {
            of_runs: [product, beside.trace(), twice],
            free,
            along,
        }
    }

    /// Whether runs were made within a distance of an amplitude.
    pub(super) fn is_known(&self, x: f64, near: f64) -> bool {
        let mut nodes = self.runs.nodes.iter();
        nodes.any(|node| (node.amplitude - x).abs() <= near)
    }

    /// The step of the parameters and the other effects that fits best at an amplitude, with the bend that agrees best.
    pub(super) fn step_at(&self, a: f64) -> DVector<f64> {
        self.retuned(&self.mixed(&self.weights(a, self.bends[0])))
    }

    /// The test at an amplitude with the bend that accepts it most easily.
    fn statistic(&self, a: f64, known: &mut Option<Projected>) -> f64 {
        let each = self
            .bends
            .iter()
            .map(|bend| self.with_bend(a, *bend, known));
        each.min_by(|z, other| z.abs().total_cmp(&other.abs()))
            .unwrap_or(0.0)
    }

    fn with_bend(&self, a: f64, bend: f64, known: &mut Option<Projected>) -> f64 {
        let weights = self.weights(a, bend);
        let residual = self.mixed(&weights);
        let step = self.retuned(&residual);
        let free = |j: usize| self.runs.ways[0][j] < step[j] && step[j] < self.runs.ways[1][j];
        let free: Vec<bool> = (0..step.len()).map(free).collect();
        let projected = match known.take() {
            Some(projected) if projected.free == free => projected,
            _ => self.projected(free),
        };
        let Projected {
            along,
            of_runs: [product, trace, twice],
            ..
        } = &projected;
        let (k, s) = (
            self.shared(&self.direction, &weights),
            self.shared(&weights, &weights),
        );
        let left = residual - &self.runs.slopes * step;
        let variance = along.norm_squared() + (s - 1.0) * product + k * k * twice;
        let z = (along.dot(&left) - k * trace) / variance.sqrt();
        *known = Some(projected);
        z
    }

    /// The amplitude nearest to the end of the fit at which the statistic is 0, or where it is least, and the interval inside a
    /// range.
    pub(super) fn amplitude(&self, end: f64, range: [f64; 2]) -> Amplitude {
        let known = &mut None;
        let step = (range[1] - range[0]) / STEPS as f64;
        let mut at: Vec<f64> = (0..=STEPS).map(|i| range[0] + step * i as f64).collect();
        at[STEPS] = range[1];
        at.extend(
            self.runs
                .nodes
                .iter()
                .map(|n| n.amplitude)
                .filter(|a| range[0] < *a && *a < range[1]),
        );
        at.sort_by(f64::total_cmp);
        let best = self.bends.first().copied().unwrap_or(0.0);
        let z: Vec<f64> = at.iter().map(|a| self.with_bend(*a, best, known)).collect();
        let crossing = |i: usize| {
            (z[i] * z[i + 1] <= 0.0 && z[i] != z[i + 1])
                .then(|| at[i] + (at[i + 1] - at[i]) * z[i] / (z[i] - z[i + 1]))
        };
        let crossings = (0..at.len() - 1).filter_map(crossing);
        let nearest = crossings.min_by(|a, b| (a - end).abs().total_cmp(&(b - end).abs()));
        let least = (0..at.len()).min_by(|&i, &j| z[i].abs().total_cmp(&z[j].abs()));
        let value = nearest.or(least.map(|i| at[i])).unwrap_or(end);
        let easiest: Vec<f64> = at.iter().map(|a| self.statistic(*a, known).abs()).collect();
        let accepted = |i: &usize| easiest[*i] <= self.runs.quantile;
        let mut interval95 = [value, value];
        let mut edge = |inside: f64, outside: Option<&f64>| {
            let Some(&outside) = outside else {
                return inside;
            };
            let (mut inside, mut outside) = (inside, outside);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if self.statistic(middle, known).abs() <= self.runs.quantile {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside
        };
        if let Some(first) = (0..at.len()).find(accepted) {
            let before = first.checked_sub(1).map(|i| &at[i]);
            interval95[0] = edge(at[first], before).min(value);
        }
        if let Some(last) = (0..at.len()).rev().find(accepted) {
            interval95[1] = edge(at[last], at.get(last + 1)).max(value);
        }
        Amplitude { value, interval95 }
    }

    /// Takes what the effect does between no amplitude, or the least that was run, and the end of the fit, or the greatest where
    /// that is the same.
    fn direct(&mut self, end: f64) {
        let by_size = |i: &usize, j: &usize| {
            let size = |i: usize| self.runs.nodes[i].amplitude.abs();
            size(*i).total_cmp(&size(*j))
        };
        let least = (0..self.runs.nodes.len()).min_by(by_size).unwrap_or(0);
        let greatest = (0..self.runs.nodes.len()).max_by(by_size).unwrap_or(0);
        let end = self
            .runs
            .nodes
            .iter()
            .position(|n| n.amplitude == end)
            .unwrap_or(greatest);
        let to = if end == least { greatest } else { end };
        self.direction[least] = 1.0;
        self.direction[to] = -1.0;
    }

    /// Takes the bends with which the fractions of the direction that the amplitudes show agree with a straight line over the
    /// [`response`], the best first: none if these are fewer than three.
    fn bend(&mut self, largest: f64) {
        if self.runs.nodes.len() < 3 {
            return;
        }
        let free = vec![true; self.runs.slopes.ncols()];
        let Projected {
            along,
            of_runs: [noise, ..],
            ..
        } = self.projected(free);
        let shown: Vec<f64> = self
            .runs
            .nodes
            .iter()
            .map(|n| -along.dot(&n.residual))
            .collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let missed = |bend: f64| {
            let at = self.runs.nodes.iter().map(|n| response(bend, n.amplitude));
            let at: Vec<f64> = at.collect();
            let (x, y) = (mean(&at), mean(&shown));
            let pairs = || at.iter().zip(&shown).map(|(a, s)| (a - x, s - y));
            let size = |f: &dyn Fn((f64, f64)) -> f64| pairs().map(f).sum::<f64>();
            let product = size(&|(a, s)| a * s);
            size(&|(_, s)| s * s) - product * product / size(&|(a, _)| a * a)
        };
        let bends = BENDS.iter().flat_map(|b| [b / largest, -b / largest]);
        let all = std::iter::once(0.0).chain(bends);
        let mut each: Vec<(f64, f64)> = all.map(|bend| (missed(bend), bend)).collect();
        each.sort_by(|a, b| a.0.total_cmp(&b.0));
        let most = each[0].0 + LIKELY_BEND * noise;
        let agree = each.into_iter().take_while(|(missed, _)| *missed <= most);
        self.bends = agree.map(|(_, bend)| bend).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, Node, Runs};
    use nalgebra::{DMatrix, DVector};

    /// Runs at amplitudes of 0, a half and 1 whose response is the square, measured where it is 0.49. The effect is eight standard errors at
    /// 1, of whose variance the runs have a share.
    fn squares(share: f64) -> Curve {
        let node = |amplitude: f64| Node {
            amplitude,
            residual: DVector::from_element(1, 8.0 * (0.49 - amplitude * amplitude)),
            block: 1,
        };
        let runs = Runs {
            nodes: vec![node(1.0), node(0.0), node(0.5)],
            slopes: DMatrix::zeros(1, 0),
            ways: [Vec::new(), Vec::new()],
            covariance: DMatrix::from_element(1, 1, share),
            own_noise: 1.0,
            quantile: 1.96,
        };
        Curve::new(runs, 1.0, 1.0).expect("three amplitudes")
    }

    /// A straight line through the three misses the square by 8² / 24 = 2.7 in squares, and 3.84 is allowed for a variance of the runs of
    /// 1. Without noise only bends near the square agree.
    #[test]
    fn noisy_runs_leave_the_bend_open() {
        let [exact, noisy] = [1e-6, 0.9].map(squares);
        assert!(exact.bends.iter().all(|bend| *bend < 0.0));
        assert!(noisy.bends.contains(&0.0), "{:?}", noisy.bends);
        assert_eq!(exact.bends[0], noisy.bends[0]);
    }

    /// The straight line gives another amplitude than the square, and both agree with the runs: the interval is wider than by the
    /// best bend alone.
    #[test]
    fn an_open_bend_widens_the_interval() {
        let curve = squares(0.9);
        let open = curve.amplitude(1.0, [0.0, 1.0]).interval95;
        let mut one = squares(0.9);
        one.bends.truncate(1);
        let [low, high] = one.amplitude(1.0, [0.0, 1.0]).interval95;
        assert!(open[0] < low && high < open[1], "{open:?} {low} {high}");
        assert!(open[0] < 0.7 && 0.7 < open[1], "{open:?}");
    }
}
