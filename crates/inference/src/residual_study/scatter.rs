//! How runs scatter about the means of their conditions.

use crate::diagnosis::CovarianceMatrix;
use probability::{chi_squared_upper_tail, digamma, inverse_trigamma, trigamma};

/// Chance below which a difference between the variances of the conditions counts as one: conditions that do not differ
/// should share their variance, which is then known best.
const DIFFERENCE: f64 = 0.01;

/// Least degrees of freedom that the other conditions lend to one: however much variances differ, a condition whose few
/// runs happen to agree has noise.
const LEAST_BORROWED: f64 = 2.0;

/// Scatter of the runs of each condition.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scatter {
    /// One for each condition; those without runs are empty.
    conditions: Vec<Products>,
}

/// Products of deviations at a condition.
#[derive(Debug, Clone, Default, PartialEq)]
struct Products {
    /// Their sums, (observables, observables).
    sums: Vec<Vec<f64>>,
    /// Degrees of freedom of each, (observables, observables): 0 for two that were never read together.
    dof: Vec<Vec<usize>>,
}

/// How far the variances of an observable differ between conditions, beyond what few runs explain.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moderation {
    /// Variance to which those of the conditions are drawn.
    variance: f64,
    /// Degrees of freedom that it is worth; infinite where the conditions do not differ.
    dof: f64,
}

impl Scatter {
    /// Scatter of one group of rows per condition about their means; NaN marks what was not read.
    pub(super) fn of<'a>(groups: impl Iterator<Item = &'a [Vec<f64>]>, means: &[Vec<f64>]) -> Self {
        let conditions = groups.zip(means).map(|(g, m)| Products::of(g, m));
        Self {
            conditions: conditions.collect(),
        }
    }

    /// The same for a longer list of conditions, of which `has` says which are these, in their order.
    pub(super) fn spread_over(self, has: impl Iterator<Item = bool>) -> Self {
        let mut own = self.conditions.into_iter();
        let mut next = |has: bool| if has { own.next() } else { None };
        Self {
            conditions: has.map(|has| next(has).unwrap_or_default()).collect(),
        }
    }

    /// The same without the conditions for which `counts` is false.
    pub(super) fn only(mut self, counts: &[bool]) -> Self {
        for (products, counts) in self.conditions.iter_mut().zip(counts) {
            if !counts {
                *products = Products::default();
            }
        }
        self
    }

    /// Takes in the scatter of other runs of the same conditions.
    pub(super) fn add(&mut self, other: &Self) {
        for (own, more) in self.conditions.iter_mut().zip(&other.conditions) {
            own.add(more);
        }
    }

    /// Sum of squares of an observable over all conditions.
    pub(super) fn sum_of_squares(&self, observable: usize) -> f64 {
        let all = self.conditions.iter();
        all.filter(|p| !p.sums.is_empty())
            .map(|p| p.sums[observable][observable])
            .sum()
    }

    /// Covariance of one run, the same at all conditions; observables of different scenes have none.
    pub(super) fn pooled(&self) -> Vec<Vec<f64>> {
        let all = self.all();
        let lines = all.sums.iter().zip(&all.dof);
        lines
            .map(|(sums, dof)| {
                let each = sums.iter().zip(dof);
                each.map(|(x, dof)| x / (*dof).max(1) as f64).collect()
            })
            .collect()
    }

    /// Covariance of one run at each condition, and the degrees of freedom of the variances of each observable, harmonic means over
    /// the conditions; without end for one that `tested` does not read, or whose runs show no scatter.
    ///
    /// # Formula
    ///
    /// The variance of an observable at a condition is `(d0 s0² + d s²) / (d0 + d)`, `s²` that of its own runs with `d`
    /// degrees of freedom; `d0` and `s0²` come from how the `ln s²` of the conditions scatter beyond what their `d` explain
    /// `[Smyth2004]`, weighted by these as in `[DerSimonian1986]`. Where they do not, by a test at 1 % `[Bartlett1937]`, `d0` is infinite and `s0²` the pooled variance. Correlations are
    /// pooled.
    pub(super) fn by_condition(&self, tested: &Self) -> (Vec<CovarianceMatrix>, Vec<f64>) {
        let (pooled, all) = (self.pooled(), self.all());
        let n = pooled.len();
        let moderations: Vec<Moderation> = (0..n)
            .map(|k| self.moderation(k, pooled[k][k], all.dof[k][k]))
            .collect();
        let of = |condition: &Products| -> CovarianceMatrix {
            let scale: Vec<f64> = (0..n)
                .map(|k| moderations[k].of(condition.variance(k)) / pooled[k][k])
                // An observable that never scatters has no variance to scale.
                .map(|ratio| if ratio.is_finite() { ratio.sqrt() } else { 1.0 })
                .collect();
            let line = |a: usize| (0..n).map(|b| pooled[a][b] * scale[a] * scale[b]).collect();
            (0..n).map(line).collect()
        };
        let dof = |k: usize| {
            let own = self.conditions.iter().map(|p| p.variance(k).1);
            let known: Vec<f64> = own.filter(|d| *d > 0.0).collect();
            if known.is_empty() {
                // Its runs tell nothing of any scatter: it limits that of no other.
                return f64::INFINITY;
            }
            let inverses: f64 = known.iter().map(|d| (moderations[k].dof + d).recip()).sum();
            (known.len() as f64 / inverses).min(all.dof[k][k] as f64)
        };
        let read = tested.all();
        let of_tested = |k: usize| {
            if read.variance(k).1 > 0.0 {
                dof(k)
            } else {
                f64::INFINITY
            }
        };
        let each = self.conditions.iter().map(of).collect();
        (each, (0..n).map(of_tested).collect())
    }

    /// How the variances of an observable differ; `pooled` with `dof` if nothing can be said.
    fn moderation(&self, observable: usize, pooled: f64, dof: usize) -> Moderation {
        let same = Moderation {
            variance: pooled,
            dof: f64::INFINITY,
        };
        let known = self.conditions.iter().map(|p| p.variance(observable));
        let known: Vec<(f64, f64)> = known.filter(|(s, d)| *s > 0.0 && *d > 0.0).collect();
        if known.len() < 3 || dof == 0 || chance_of_equal(&known) > DIFFERENCE {
            return same;
        }
        // ln s² less what few degrees of freedom do to its mean, and the inverse of what they do to its variance.
        let logarithm = |(s, d): &(f64, f64)| s.ln() - digamma(d / 2.0) + (d / 2.0).ln();
        let weight = |(_, d): &(f64, f64)| trigamma(d / 2.0).recip();
        let weights: f64 = known.iter().map(weight).sum();
        let mean = known
            .iter()
            .map(|one| weight(one) * logarithm(one))
            .sum::<f64>()
            / weights;
        let square = |one: &(f64, f64)| weight(one) * (logarithm(one) - mean).powi(2);
        let spread = known.iter().map(square).sum::<f64>() - (known.len() - 1) as f64;
        let squares: f64 = known.iter().map(|one| weight(one).powi(2)).sum();
        let excess = spread / (weights - squares / weights);
        if excess <= 0.0 {
            return same;
        }
        let half = inverse_trigamma(excess).max(0.5 * LEAST_BORROWED);
        Moderation {
            variance: (mean + digamma(half) - half.ln()).exp(),
            dof: 2.0 * half,
        }
    }

    /// Sums over all conditions.
    fn all(&self) -> Products {
        let mut all = Products::default();
        for one in &self.conditions {
            all.add(one);
        }
        all
    }
}

impl Moderation {
    /// A variance with its degrees of freedom, drawn to that of all.
    fn of(self, (variance, dof): (f64, f64)) -> f64 {
        if self.dof.is_finite() {
            (self.dof * self.variance + dof * variance) / (self.dof + dof)
        } else {
            self.variance
        }
    }
}

impl Products {
    fn of(rows: &[Vec<f64>], mean: &[f64]) -> Self {
        let width = mean.len();
        let mut products = Self {
            sums: vec![vec![0.0; width]; width],
            dof: vec![vec![0; width]; width],
        };
        let read = |k: usize| rows.iter().all(|row| !row[k].is_nan());
        for a in (0..width).filter(|&a| read(a)) {
            for b in (0..width).filter(|&b| read(b)) {
                for row in rows {
                    products.sums[a][b] += (row[a] - mean[a]) * (row[b] - mean[b]);
                }
                products.dof[a][b] += rows.len().saturating_sub(1);
            }
        }
        products
    }

    fn add(&mut self, other: &Self) {
        if self.sums.is_empty() {
            self.clone_from(other);
            return;
        }
        for (line, more) in self.sums.iter_mut().zip(&other.sums) {
            for (sum, product) in line.iter_mut().zip(more) {
                *sum += product;
            }
        }
        for (line, more) in self.dof.iter_mut().zip(&other.dof) {
            for (sum, dof) in line.iter_mut().zip(more) {
                *sum += dof;
            }
        }
    }

    /// Variance of an observable and its degrees of freedom.
    fn variance(&self, k: usize) -> (f64, f64) {
        match self.dof.get(k).map(|line| line[k]) {
            None | Some(0) => (0.0, 0.0),
            Some(dof) => (self.sums[k][k] / dof as f64, dof as f64),
        }
    }
}

/// Chance that variances of normal values with these degrees of freedom differ so much where they are equal
/// `[Bartlett1937]`.
fn chance_of_equal(known: &[(f64, f64)]) -> f64 {
    let n = known.len() as f64;
    let total: f64 = known.iter().map(|(_, d)| d).sum();
    let pooled = known.iter().map(|(s, d)| s * d).sum::<f64>() / total;
    let logarithms: f64 = known.iter().map(|(s, d)| d * s.ln()).sum();
    let inverses: f64 = known.iter().map(|(_, d)| d.recip()).sum();
    let correction = 1.0 + (inverses - total.recip()) / (3.0 * (n - 1.0));
    let statistic = (total * pooled.ln() - logarithms) / correction;
    chi_squared_upper_tail(statistic.max(0.0), n - 1.0).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::{CovarianceMatrix, Scatter};
    use probability::random_stream::Stream;

    /// Runs of one observable, normal with these standard deviations.
    fn scatter(sds: &[f64], runs: usize, seed: u64) -> Scatter {
        let mut stream = Stream::new(seed, "scatter");
        let mut group =
            |sd: f64| -> Vec<Vec<f64>> { (0..runs).map(|_| vec![sd * stream.normal()]).collect() };
        let groups: Vec<_> = sds.iter().map(|sd| group(*sd)).collect();
        let mean = |g: &Vec<Vec<f64>>| vec![g.iter().map(|r| r[0]).sum::<f64>() / g.len() as f64];
        let means: Vec<_> = groups.iter().map(mean).collect();
        Scatter::of(groups.iter().map(Vec::as_slice), &means)
    }

    /// The covariance of [`scatter`] and its degrees of freedom.
    fn varied(sds: &[f64], runs: usize, seed: u64) -> (Vec<CovarianceMatrix>, f64) {
        let all = scatter(sds, runs, seed);
        let (covariance, dof) = all.by_condition(&all);
        (covariance, dof[0])
    }

    /// An observable that only conditions kept for the check read, with two runs each, leaves the 8 degrees of freedom of the
    /// fit's own observable alone.
    #[test]
    fn what_only_the_check_reads_limits_no_test_of_the_fit() {
        let rows = |values: &[[f64; 2]]| values.iter().map(|v| v.to_vec()).collect::<Vec<_>>();
        let used = rows(&[[1.0, f64::NAN], [2.0, f64::NAN], [4.0, f64::NAN]]);
        let kept = rows(&[[f64::NAN, 1.0], [f64::NAN, 2.0]]);
        let groups = |group: &Vec<Vec<f64>>, of: [bool; 6]| {
            of.map(|has| if has { group.clone() } else { Vec::new() })
        };
        let on = |of: [bool; 6], group: &Vec<Vec<f64>>, mean: Vec<f64>| {
            let groups = groups(group, of);
            let means = vec![mean; 6];
            Scatter::of(groups.iter().map(Vec::as_slice), &means).only(&of)
        };
        let tested = on(
            [true, true, true, true, false, false],
            &used,
            vec![7.0 / 3.0, 0.0],
        );
        let mut all = tested.clone();
        all.add(&on(
            [false, false, false, false, true, true],
            &kept,
            vec![0.0, 1.5],
        ));
        assert_eq!(all.by_condition(&tested).1, [8.0, f64::INFINITY]);
    }

    /// Twelve conditions, half of them with a threefold standard deviation, eight runs each: the mean of ln(estimate /
    /// truth) over 200 draws is near that of an unbiased variance of 7 degrees of freedom, -1/7, and its scatter below
    /// that of the conditions alone (sqrt(trigamma(7/2)) = 0.57) and of the pooled value (ln 9 / 2 = 1.10). Tolerance:
    /// what is borrowed of the others takes a part of the -1/7 away.
    #[test]
    fn conditions_that_differ_keep_their_own_variance() {
        let sds: Vec<f64> = (0..12).map(|c| if c < 6 { 1.0 } else { 3.0 }).collect();
        let (mut sum, mut square, mut n) = (0.0, 0.0, 0.0);
        for seed in 0..200 {
            let (covariance, _) = varied(&sds, 8, seed);
            for (c, sd) in covariance.iter().zip(&sds) {
                let error = (c[0][0] / (sd * sd)).ln();
                (sum, square, n) = (sum + error, square + error * error, n + 1.0);
            }
        }
        assert!((-0.143..0.0).contains(&(sum / n)), "{}", sum / n);
        assert!((square / n).sqrt() < 0.57, "{}", (square / n).sqrt());
    }

    /// One condition does not scatter at all beside others that differ a millionfold: it borrows some noise of them.
    #[test]
    fn a_condition_without_scatter_has_noise() {
        let sds = [0.0, 1.0, 1000.0, 1.0, 1000.0];
        let (covariance, _) = varied(&sds, 3, 1);
        assert!(covariance[0][0][0] > 0.01, "{covariance:?}");
    }

    /// Where all conditions have one variance, all share it with all its degrees of freedom in 99 % of the draws: of 200,
    /// 194 or more with a chance of 99.9 %.
    #[test]
    fn conditions_that_do_not_differ_share_one_variance() {
        let draws = 200;
        let all_pooled = (0..draws).filter(|&seed| {
            let (covariance, dof) = varied(&[1.0; 12], 4, seed);
            dof == 36.0 && covariance.iter().all(|c| *c == covariance[0])
        });
        assert!(all_pooled.count() >= 194);
    }
}
