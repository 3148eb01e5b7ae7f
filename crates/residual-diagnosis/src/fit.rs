//! The linear model with some effects switched on: amplitudes, re-tuning, what remains.

use nalgebra::{DMatrix, DVector};

use crate::Error;
use crate::covariance::{Covariance, Whitener};
use crate::problem::{Candidate, Problem};
use crate::problem_file::Sign;
use crate::smooth_basis::smooth_basis;
use crate::space::Space;
use crate::tails::upper_tail;

/// An effect whose part that re-tuning cannot absorb is shorter than this share of the whole
/// counts as absorbed wholly: what is left of it is rounding.
const ABSORBED: f64 = 1e-7;
/// Rounds in which amplitudes and the covariance that depends on them are made consistent; each
/// round shrinks the change by about the share of the added variance.
const NOISE_ROUNDS: usize = 4;

/// The problem in whitened rows, the rows of the prior last.
#[derive(Debug, Clone)]
struct Whitened {
    /// r~ (rows).
    residual: DVector<f64>,
    /// S~ (rows, parameters).
    declared: DMatrix<f64>,
    /// l~ (rows, effects).
    library: DMatrix<f64>,
    /// L^-1 G (rows, smooth columns).
    smooth: DMatrix<f64>,
    /// Turns rows of the problem into these.
    whitener: Whitener,
}

/// Least squares with the declared parameters and some effects free.
///
/// # Formula
///
/// With A = [S~, l~_J] and Q_J the projection off its columns: T_J = r~'Q_J r~, on
/// rows - rank A degrees of freedom; (shift, a_J) = A^+ r~. Where sensitivities are noisy, V_J =
/// V + sum_k shift_k^2 Cov(S_k) + sum_j a_j^2 Cov(l_j), made consistent in a few rounds.
/// [statistics of this project, section 4.1]
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// The effects that are on (numbers in the library).
    pub(crate) effects: Vec<usize>,
    /// Their amplitudes; 0 where the sign constraint holds one back, the largest possible one where the
    /// data ask for more.
    pub(crate) amplitudes: Vec<f64>,
    /// Standard errors of the amplitudes.
    pub(crate) standard_errors: Vec<f64>,
    /// Re-tuning of the declared parameters, in their units.
    pub(crate) shift: DVector<f64>,
    /// Structured residual T_J.
    pub(crate) t: f64,
    /// Its degrees of freedom.
    pub(crate) df: usize,
    /// T_J + ln det V_J: minus twice the log likelihood, without constants.
    pub(crate) deviance: f64,
    /// What [S~, l~_J] absorbs.
    space: Space,
    /// Q_J r~.
    remaining: DVector<f64>,
    /// The rows that it was made of.
    whitened: Whitened,
}

/// How an effect that is off would help.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    /// u'r~ / |u|: standard normal when the effect is absent.
    pub(crate) z: f64,
    /// |u|, 1 / (unit of the amplitude): 1/|u| is the standard error of the amplitude.
    pub(crate) length: f64,
    /// u / |u|.
    pub(crate) direction: DVector<f64>,
}

/// The structured residual inside the smooth basis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmoothTest {
    /// Its sum of squares.
    pub(crate) t: f64,
    /// Its degrees of freedom.
    pub(crate) df: usize,
    /// Its upper tail; none without degrees of freedom.
    pub(crate) p: Option<f64>,
}

impl Fit {
    /// Fits a problem with these effects on.
    pub(crate) fn new(problem: &Problem, effects: &[usize]) -> Result<Self, Error> {
        let noisy = problem.used.has_noisy_sensitivities();
        let mut fit = Self::constrained(problem, effects, &DVector::zeros(0), &[])?;
        if noisy {
            for _ in 0..NOISE_ROUNDS {
                let (shift, amplitudes) = (fit.shift.clone(), fit.amplitudes.clone());
                fit = Self::constrained(problem, effects, &shift, &amplitudes)?;
            }
        }
        Ok(fit)
    }

    /// Fits with the covariance of the given shift and amplitudes; effects that come out with the
    /// wrong sign are held at 0, those beyond what is physically possible at their largest
    /// amplitude, the worst first.
    fn constrained(
        problem: &Problem,
        effects: &[usize],
        shift: &DVector<f64>,
        amplitudes: &[f64],
    ) -> Result<Self, Error> {
        let whitened = Whitened::new(problem, effects, shift, amplitudes)?;
        let mut active = effects.to_vec();
        let mut at_limit: Vec<(usize, f64)> = Vec::new();
        loop {
            let fit = Self::unconstrained(&whitened.less(&at_limit), &active);
            let worst = active
                .iter()
                .zip(fit.amplitudes.iter().zip(&fit.standard_errors))
                .map(|(&j, (a, se))| (j, a / se, problem.candidates[j].sign))
                .filter(|(_, z, sign)| !sign.allows(*z))
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            if let Some((j, _, _)) = worst {
                active.retain(|&k| k != j);
                continue;
            }
            let beyond = active
                .iter()
                .zip(fit.amplitudes.iter().zip(&fit.standard_errors))
                .filter_map(|(&j, (a, se))| {
                    let largest = problem.candidates[j].largest_towards(*a)?;
                    let over = (a.abs() - largest) / se;
                    (over > 0.0).then_some((j, largest * a.signum(), over))
                })
                .max_by(|a, b| a.2.total_cmp(&b.2));
            match beyond {
                Some((j, limit, _)) => {
                    active.retain(|&k| k != j);
                    at_limit.push((j, limit));
                }
                None => return Ok(fit.with_held(effects, &at_limit)),
            }
        }
    }

    /// Plain least squares.
    fn unconstrained(whitened: &Whitened, effects: &[usize]) -> Self {
        let n_declared = whitened.declared.ncols();
        let mut columns: Vec<DVector<f64>> = whitened
            .declared
            .column_iter()
            .map(nalgebra::Matrix::into_owned)
            .collect();
        columns.extend(
            effects
                .iter()
                .map(|&j| whitened.library.column(j).into_owned()),
        );
        let matrix = if columns.is_empty() {
            DMatrix::zeros(whitened.residual.len(), 0)
        } else {
            DMatrix::from_columns(&columns)
        };
        let space = Space::of(&matrix);
        let remaining = space.outside(&whitened.residual);
        let coefficients = space.coefficients(&whitened.residual);
        let covariance = space.coefficient_covariance();
        let own = n_declared..coefficients.len();
        let t = remaining.norm_squared();
        Self {
            effects: effects.to_vec(),
            amplitudes: own.clone().map(|i| coefficients[i]).collect(),
            standard_errors: own.map(|i| covariance[(i, i)].sqrt()).collect(),
            shift: coefficients.rows(0, n_declared).into_owned(),
            t,
            df: whitened.residual.len() - space.rank(),
            deviance: t + whitened.whitener.ln_determinant,
            space,
            remaining,
            whitened: whitened.clone(),
        }
    }

    /// Puts back the effects that are held, at their limits or at 0: each takes its degree of freedom, as
    /// if free.
    fn with_held(mut self, effects: &[usize], at_limit: &[(usize, f64)]) -> Self {
        let find = |values: &[f64], j: &usize| {
            let at = self.effects.iter().position(|k| k == j);
            at.and_then(|i| values.get(i).copied())
        };
        let amplitudes = effects
            .iter()
            .map(|j| {
                let limit = at_limit
                    .iter()
                    .find(|(k, _)| k == j)
                    .map(|(_, limit)| *limit);
                find(&self.amplitudes, j).or(limit).unwrap_or(0.0)
            })
            .collect();
        let standard_errors = effects
            .iter()
            .map(|j| {
                let held = || self.score(*j).map_or(f64::INFINITY, |s| 1.0 / s.length);
                find(&self.standard_errors, j).unwrap_or_else(held)
            })
            .collect();
        self.df = self.df.saturating_sub(effects.len() - self.effects.len());
        self.amplitudes = amplitudes;
        self.standard_errors = standard_errors;
        self.effects = effects.to_vec();
        self
    }

    /// Standard errors of the declared parameters, in their units.
    pub(crate) fn parameter_errors(&self) -> Vec<f64> {
        let covariance = self.space.coefficient_covariance();
        (0..self.shift.len())
            .map(|k| covariance[(k, k)].sqrt())
            .collect()
    }

    /// Upper tail of the structured residual; none without degrees of freedom.
    pub(crate) fn p(&self, problem: &Problem) -> Option<f64> {
        upper_tail(self.t, self.df, problem.covariance_dof)
    }

    /// How an effect that is off would help; none when it is absorbed wholly or does nothing.
    pub(crate) fn score(&self, effect: usize) -> Option<Score> {
        let whole = self.whitened.library.column(effect).into_owned();
        let outside = self.space.outside(&whole);
        let length = outside.norm();
        if length <= ABSORBED * whole.norm() {
            return None;
        }
        let direction = outside / length;
        Some(Score {
            z: direction.dot(&self.remaining),
            length,
            direction,
        })
    }

    /// Expected score of an effect of amplitude 1 that is off, known by a sensitivity that is itself noisy; none
    /// where the sensitivity does not stand out of its noise.
    ///
    /// # Formula
    ///
    /// The sensitivity u is the true one, w, plus noise of covariance N: E|u|² = |w|² + tr N, and the score of the data
    /// w along u is `w'u / |u|`, in the mean about `(|u|² - tr N) / |u|`. Both are taken in whitened rows, off what the
    /// declared parameters absorb. [own]
    pub(crate) fn expected_score(&self, problem: &Problem, effect: usize) -> Option<f64> {
        let length = self.score(effect)?.length;
        let noise = problem.used.library_noise.get(effect);
        let noise = noise.map_or(0.0, |noise| self.whitened.noise_outside(noise, &self.space));
        let signal = length * length - noise;
        (signal > 0.0).then(|| signal / length)
    }

    /// Share of an effect that the parameters (and the effects that are on) can imitate; none when
    /// the effect does nothing at all.
    pub(crate) fn absorbed_fraction(&self, effect: usize) -> Option<f64> {
        let whole = self.whitened.library.column(effect).into_owned();
        let total = whole.norm_squared();
        (total > 0.0).then(|| 1.0 - self.space.outside(&whole).norm_squared() / total)
    }

    /// The smooth basis outside what is absorbed already; a column that is absorbed wholly is 0.
    pub(crate) fn smooth_outside(&self) -> DMatrix<f64> {
        let mut outside = self.space.outside_columns(&self.whitened.smooth);
        let whole = self.whitened.smooth.column_iter().map(|c| c.norm());
        for (mut column, length) in outside.column_iter_mut().zip(whole) {
            if column.norm() <= ABSORBED * length {
                column.fill(0.0);
            }
        }
        outside
    }

    /// What the declared parameters and the effects that are on leave of the residual (whitened
    /// rows, then prior rows).
    pub(crate) fn remaining(&self) -> &DVector<f64> {
        &self.remaining
    }

    /// Tests the part of the residual inside the smooth basis.
    pub(crate) fn smooth_test(&self, problem: &Problem) -> SmoothTest {
        let space = Space::of(&self.smooth_outside());
        let t = space.coordinates(&self.remaining).norm_squared();
        SmoothTest {
            t,
            df: space.rank(),
            p: upper_tail(t, space.rank(), problem.covariance_dof),
        }
    }

    /// Share of each condition in the structured residual; what is missing to 1 is the prior's.
    pub(crate) fn shares(&self, problem: &Problem) -> Vec<f64> {
        let mut shares = vec![0.0; problem.used.conditions.len()];
        for (row, value) in problem.used.rows.iter().zip(self.remaining.iter()) {
            if let Some(share) = shares.get_mut(row.condition) {
                *share += value * value / self.t.max(f64::MIN_POSITIVE);
            }
        }
        shares
    }

    /// The amplitude of an effect, 0 when it is off.
    pub(crate) fn amplitude(&self, effect: usize) -> f64 {
        let at = self.effects.iter().position(|&j| j == effect);
        at.and_then(|i| self.amplitudes.get(i).copied())
            .unwrap_or(0.0)
    }
}

impl Whitened {
    /// Whitens the used part of a problem and appends the rows of the prior.
    fn new(
        problem: &Problem,
        effects: &[usize],
        shift: &DVector<f64>,
        amplitudes: &[f64],
    ) -> Result<Self, Error> {
        let part = &problem.used;
        let mut covariance = part.covariance.clone();
        for (noise, dtheta) in part.declared_noise.iter().zip(shift.iter()) {
            covariance = covariance.plus_scaled(dtheta * dtheta, noise);
        }
        for (&j, a) in effects.iter().zip(amplitudes) {
            if let Some(noise) = part.library_noise.get(j) {
                covariance = covariance.plus_scaled(a * a, noise);
            }
        }
        let whitener = covariance.whitener()?;
        let column = DMatrix::from_column_slice(part.residual.len(), 1, part.residual.as_slice());
        let mut residual = whitener.whiten(&column).column(0).into_owned();
        let mut declared = whitener.whiten(&part.declared);
        let mut library = whitener.whiten(&part.library);
        let mut smooth = whitener.whiten(&smooth_basis(part));
        if let Some(prior) = &problem.prior {
            let (n, extra) = (residual.len(), prior.offset.len());
            residual = residual.resize_vertically(n + extra, 0.0);
            residual.rows_mut(n, extra).copy_from(&prior.offset);
            declared = declared.resize_vertically(n + extra, 0.0);
            declared.rows_mut(n, extra).copy_from(&prior.root);
            library = library.resize_vertically(n + extra, 0.0);
            smooth = smooth.resize_vertically(n + extra, 0.0);
        }
        Ok(Self {
            residual,
            declared,
            library,
            smooth,
            whitener,
        })
    }

    /// Trace of the covariance of a noisy column, whitened and outside a space of such rows.
    fn noise_outside(&self, noise: &Covariance, space: &Space) -> f64 {
        let half = self.whitener.whiten(&noise.whole());
        let n = self.residual.len();
        // The rows of the prior have no noise.
        let whole = self.whitener.whiten(&half.transpose()).resize(n, n, 0.0);
        space.outside_columns(&whole).trace()
    }
}

impl Whitened {
    /// The rows without what effects of given amplitudes explain.
    fn less(&self, effects: &[(usize, f64)]) -> Self {
        let mut rest = self.clone();
        for &(j, amplitude) in effects {
            rest.residual -= self.library.column(j) * amplitude;
        }
        rest
    }
}

impl Score {
    /// The score that an effect reaches with an amplitude up to the largest possible one of its sign.
    ///
    /// # Formula
    ///
    /// `z' = sign(z) sqrt(z² - max(0, |z| - a_max |u|)²)`: what it takes off the structured residual is z'².
    pub(crate) fn within(&self, candidate: &Candidate) -> f64 {
        let largest = candidate.largest_towards(self.z);
        let over = largest.map_or(0.0, |a| (self.z.abs() - a * self.length).max(0.0));
        self.z.signum() * (self.z * self.z - over * over).max(0.0).sqrt()
    }
}

impl Sign {
    /// Whether an amplitude of this sign is physically possible.
    pub(crate) fn allows(self, amplitude: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Positive => amplitude >= 0.0,
            Self::Negative => amplitude <= 0.0,
        }
    }

    /// The test statistic of a score: its size, 0 where the sign is impossible.
    pub(crate) fn statistic(self, z: f64) -> f64 {
        if self.allows(z) { z.abs() } else { 0.0 }
    }
}
