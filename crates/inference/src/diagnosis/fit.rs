//! The linear model with some effects switched on: amplitudes, re-tuning, what remains.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::Error;
use crate::diagnosis::box_least_squares::least_squares_in_box;
use crate::diagnosis::covariance::{Covariance, Whitener};
use crate::diagnosis::problem::{Candidate, Problem};
use crate::diagnosis::problem_file::Sign;
use crate::diagnosis::smooth_basis::smooth_basis;
use crate::diagnosis::space::Space;
use crate::diagnosis::tails::upper_tail;

/// An effect whose part that re-tuning cannot absorb is shorter than this share of the whole
/// counts as absorbed wholly: its remainder is rounding.
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

/// Least squares with the declared parameters and some effects free inside their limits.
///
/// # Formula
///
/// With A = [S~, l~_J]: T_J is the least |r~ - A (shift, a_J)|² over shifts and amplitudes inside their limits. With A_f
/// the columns of those that end inside, T_J has rows - rank A_f degrees of freedom, less the effects that are held.
/// Where sensitivities are noisy, V_J = V + sum_m (w_m . shift)^2 N_m + sum_j a_j^2 Cov(l_j), made consistent in a few
/// rounds; N_m is the covariance of the m-th independent error of S and w_m the share that each parameter has of it. [statistics of this project, section 4.1]
///
/// A parameter that is held at its limit does not cost a degree of freedom. The upper tail is then a p-value wherever
/// in the box the truth lies: given which limits hold, what remains lies in the cone of normals of that face, and its
/// density there over that of a normal vector falls along every ray from the origin, so that T is at most as large as
/// chi² in distribution, and is chi² where the truth lies on those limits `[Bartholomew1961]`.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// The effects that are on (numbers in the library).
    pub(crate) effects: Vec<usize>,
    /// Their amplitudes; 0 where the sign constraint holds one back, the largest possible one where the
    /// data ask for more.
    pub(crate) amplitudes: Vec<f64>,
    pub(crate) standard_errors: Vec<f64>,
    /// Re-tuning of the declared parameters, in their units.
    pub(crate) shift: DVector<f64>,
    /// Structured residual T_J.
    pub(crate) t: f64,
    /// Its degrees of freedom.
    pub(crate) df: usize,
    /// T_J + ln det V_J: minus twice the log likelihood, without constants.
    pub(crate) deviance: f64,
    /// Declared parameters that are held at a limit.
    pub(crate) held: Vec<Held>,
    /// What the columns of the parameters and effects that are not held absorb.
    space: Space,
    /// What remains of r~.
    remaining: DVector<f64>,
    /// Limits of the shift of each declared parameter, and behind them of the amplitudes.
    limits: Vec<[f64; 2]>,
    /// The rows that it was made of.
    whitened: Whitened,
}

/// A declared parameter that the data would move beyond its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Held {
    pub(crate) parameter: usize,
    /// 1 at its upper limit, -1 at its lower one.
    pub(crate) side: f64,
}

/// The residual without any re-tuning, in standard deviations of measurement and simulator, the rows of the prior last.
pub(crate) fn as_simulated(problem: &Problem) -> Result<DVector<f64>, Error> {
    Ok(Whitened::new(problem, &[], &DVector::zeros(0), &[])?.residual)
}

/// How an effect that is off would help.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    /// u'r~ / |u|: standard normal when the effect is absent and no parameter is held.
    pub(crate) z: f64,
    /// What the effect takes off the structured residual with a possible amplitude, the declared parameters anywhere
    /// inside their limits: the square root, with the sign of the amplitude; `z` where its sign is impossible.
    pub(crate) gain: f64,
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

    /// Fits with the covariance of the given shift and amplitudes.
    fn constrained(
        problem: &Problem,
        effects: &[usize],
        shift: &DVector<f64>,
        amplitudes: &[f64],
    ) -> Result<Self, Error> {
        let whitened = Whitened::new(problem, effects, shift, amplitudes)?;
        let ends = effects.iter().map(|&j| problem.candidates[j].range());
        let limits = problem.limits.iter().copied().chain(ends).collect();
        Ok(Self::inside(whitened, effects, limits))
    }

    /// Least squares inside limits.
    fn inside(whitened: Whitened, effects: &[usize], limits: Vec<[f64; 2]>) -> Self {
        let n_declared = whitened.declared.ncols();
        let matrix = whitened.columns(effects);
        let [low, high] = [0, 1].map(|end| limits.iter().map(|l| l[end]).collect::<Vec<_>>());
        let solution = least_squares_in_box(&matrix, &whitened.residual, &low, &high);
        let covariance = solution.space.coefficient_covariance();
        let mut of_free = (0..covariance.nrows()).map(|i| covariance[(i, i)].sqrt());
        let errors: Vec<Option<f64>> = solution
            .free
            .iter()
            .map(|free| if *free { of_free.next() } else { None })
            .collect();
        let own = n_declared..limits.len();
        let held_effects = own.clone().filter(|&i| !solution.free[i]).count();
        let t = solution.remaining.norm_squared();
        let mut fit = Self {
            effects: effects.to_vec(),
            amplitudes: own.clone().map(|i| solution.coefficients[i]).collect(),
            standard_errors: Vec::new(),
            shift: solution.coefficients.rows(0, n_declared).into_owned(),
            t,
            // An effect that is held takes its degree of freedom, as if free.
            df: (whitened.residual.len() - solution.space.rank()).saturating_sub(held_effects),
            deviance: t + whitened.whitener.ln_determinant,
            held: Vec::new(),
            space: solution.space,
            remaining: solution.remaining,
            limits,
            whitened,
        };
        let outward = |k: usize| fit.whitened.declared.column(k).dot(&fit.remaining);
        fit.held = (0..n_declared)
            .filter(|&k| !solution.free[k])
            .map(|parameter| Held {
                parameter,
                side: if outward(parameter) < 0.0 { -1.0 } else { 1.0 },
            })
            .collect();
        fit.standard_errors = own
            .zip(effects)
            .map(|(i, &j)| {
                let held = || {
                    fit.outside(j)
                        .map_or(f64::INFINITY, |(_, length)| 1.0 / length)
                };
                errors[i].unwrap_or_else(held)
            })
            .collect();
        fit
    }

    /// The fit in which an effect that was taken is judged beside an unknown one: the effects of this fit, and those
    /// parameters free that are free once the effect is on. This fit where these are the same.
    ///
    /// An effect that is missing drives parameters to their limits; once it is on, they come back. So would they beside
    /// an unknown effect, which must not look worse for being held to them.
    pub(crate) fn freed_as(&self, problem: &Problem, with_effect: &Self) -> Result<Self, Error> {
        if self.held == with_effect.held {
            return Ok(self.clone());
        }
        let mut whitened =
            Whitened::new(problem, &self.effects, &with_effect.shift, &self.amplitudes)?;
        let mut limits = vec![[f64::NEG_INFINITY, f64::INFINITY]; problem.limits.len()];
        for held in &with_effect.held {
            let at = with_effect.shift[held.parameter];
            whitened.residual -= whitened.declared.column(held.parameter) * at;
            limits[held.parameter] = [0.0, 0.0];
        }
        let ends = self.effects.iter().map(|&j| problem.candidates[j].range());
        limits.extend(ends);
        Ok(Self::inside(whitened, &self.effects, limits))
    }

    /// Covariance of the declared parameters, products of their units; 0 for those that are held.
    pub(crate) fn parameter_covariance(&self) -> DMatrix<f64> {
        let of_free = self.space.coefficient_covariance();
        let n = self.shift.len();
        let held = |k: usize| self.held.iter().any(|held| held.parameter == k);
        let free: Vec<usize> = (0..n).filter(|&k| !held(k)).collect();
        let mut covariance = DMatrix::zeros(n, n);
        for (a, &i) in free.iter().enumerate() {
            for (b, &j) in free.iter().enumerate() {
                covariance[(i, j)] = of_free[(a, b)];
            }
        }
        covariance
    }

    /// Directions along which held parameters would move on: unit vectors outside what is absorbed, out of the
    /// box. Parameters that move nothing have none.
    pub(crate) fn outward(&self) -> Vec<DVector<f64>> {
        let direction = |held: &Held| {
            let whole = self.whitened.declared.column(held.parameter).into_owned();
            let outside = self.space.outside(&whole);
            let length = outside.norm();
            (length > ABSORBED * whole.norm()).then(|| outside * (held.side / length))
        };
        self.held.iter().filter_map(direction).collect()
    }

    /// Upper tail of the structured residual; none without degrees of freedom.
    pub(crate) fn p(&self, problem: &Problem) -> Option<f64> {
        upper_tail(self.t, self.df, problem.covariance_dof)
    }

    /// Part of an effect outside what is absorbed, and its length; none when it is absorbed wholly or does nothing.
    fn outside(&self, effect: usize) -> Option<(DVector<f64>, f64)> {
        let whole = self.whitened.library.column(effect).into_owned();
        let outside = self.space.outside(&whole);
        let length = outside.norm();
        (length > ABSORBED * whole.norm()).then_some((outside, length))
    }

    /// How an effect that is off would help; none when it is absorbed wholly or does nothing.
    pub(crate) fn score(&self, effect: usize, candidate: &Candidate) -> Option<Score> {
        let (outside, length) = self.outside(effect)?;
        let direction = outside / length;
        let z = direction.dot(&self.remaining);
        let size = |t: f64| (self.t - t).max(0.0).sqrt();
        let (amplitude, t) = self.with_one_more(effect, candidate.range());
        let gain = if amplitude == 0.0 {
            z
        } else {
            size(t) * amplitude.signum()
        };
        Some(Score {
            z,
            gain,
            length,
            direction,
        })
    }

    /// Amplitude of one more effect inside a range, and the structured residual with it.
    fn with_one_more(&self, effect: usize, range: [f64; 2]) -> (f64, f64) {
        let mut effects = self.effects.clone();
        effects.push(effect);
        let limits = self.limits.iter().chain([&range]);
        let [low, high] = [0, 1].map(|end| limits.clone().map(|l| l[end]).collect::<Vec<_>>());
        let matrix = self.whitened.columns(&effects);
        let solution = least_squares_in_box(&matrix, &self.whitened.residual, &low, &high);
        let amplitude = solution.coefficients[solution.coefficients.len() - 1];
        (amplitude, solution.remaining.norm_squared())
    }

    /// Expected score of an effect of this amplitude, off what re-tuning inside the limits can imitate, known by a
    /// sensitivity that is itself noisy; `None` if it does not stand out of its noise.
    ///
    /// # Formula
    ///
    /// The least |a u - S shift| over shifts inside the limits, u the sensitivity; of its square a² tr N is taken off: u
    /// is the true one, w, plus noise of covariance N, and E|u|² = |w|² + tr N. Without limits in reach that is the mean
    /// of the score of the data along u, about `a (|u|² - tr N) / |u|`, and taken so. Whitened rows (own derivation).
    pub(crate) fn expected_score(
        &self,
        problem: &Problem,
        effect: usize,
        amplitude: f64,
    ) -> Option<f64> {
        let noise = problem.used.library_noise.get(effect);
        let noise = noise.map_or(0.0, |noise| self.whitened.noise_outside(noise, &self.space));
        let whole = self.whitened.library.column(effect) * amplitude;
        let [low, high] = [0, 1].map(|end| {
            let each = problem.limits.iter().zip(self.shift.iter());
            // Rounding must not put the fitted point outside.
            let inside = |x: f64| if end == 0 { x.min(0.0) } else { x.max(0.0) };
            each.map(|(l, at)| inside(l[end] - at)).collect::<Vec<_>>()
        });
        let left = least_squares_in_box(&self.whitened.declared, &whole, &low, &high);
        let length = left.remaining.norm();
        let signal = length * length - amplitude * amplitude * noise;
        (signal > 0.0 && length > ABSORBED * whole.norm()).then(|| signal / length)
    }

    /// Length of an effect before re-tuning, and that of its noise, 1 / (unit of the amplitude); whitened rows.
    pub(crate) fn whole_and_noise(&self, problem: &Problem, effect: usize) -> [f64; 2] {
        let nothing = Space::of(&DMatrix::zeros(self.whitened.residual.len(), 0));
        let noise = problem.used.library_noise.get(effect);
        let noise = noise.map_or(0.0, |noise| self.whitened.noise_outside(noise, &nothing));
        [self.whitened.library.column(effect).norm(), noise.sqrt()]
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
        self.outside_of_white(&self.whitened.smooth)
    }

    /// Columns over the rows of the problem, in its units, outside what is absorbed already; one that is absorbed wholly is 0.
    pub(crate) fn outside_of(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let white = self.whitened.whitener.whiten(columns);
        // The rows of the prior have no part in them.
        self.outside_of_white(&white.resize_vertically(self.remaining.len(), 0.0))
    }

    fn outside_of_white(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut outside = self.space.outside_columns(columns);
        let whole = columns.column_iter().map(|c| c.norm());
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
        if !shift.is_empty() {
            for noise in &part.declared_noise {
                let size = noise.along.dot(shift);
                covariance = covariance.plus_scaled(size * size, &noise.covariance);
            }
        }
        for (&j, a) in effects.iter().zip(amplitudes) {
            if let Some(noise) = part.library_noise.get(j) {
                covariance = covariance.plus_scaled(a * a, noise);
            }
        }
        let whitener = covariance.whitener()?;
        let mut residual = whitener.whiten_vector(&part.residual);
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
        let n = self.residual.len();
        // The rows of the prior have no noise.
        let whole = self
            .whitener
            .whiten_covariance(&noise.whole())
            .resize(n, n, 0.0);
        space.outside_columns(&whole).trace()
    }
}

impl Whitened {
    /// The columns of the declared parameters and of some effects.
    fn columns(&self, effects: &[usize]) -> DMatrix<f64> {
        let (rows, n) = self.declared.shape();
        DMatrix::from_fn(rows, n + effects.len(), |i, k| match k.checked_sub(n) {
            None => self.declared[(i, k)],
            Some(e) => self.library[(i, effects[e])],
        })
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
