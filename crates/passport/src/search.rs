//! The search for the conventions that explain the numbers: by slopes first, then by runs with conventions changed.

use crate::Error;
use crate::advice::LARGEST;
use crate::bench::{Bench, Fitted, STEP};
use crate::convention::{CONVENTIONS, NOTHING};
use inference::diagnosis::{
    CovarianceInput, Diagnosis, Largest, Options, Problem, ProblemFile, RefittedModel, Sign,
    diagnose,
};
use nalgebra::DVector;
use rayon::prelude::*;

/// Draws of the null distribution of the largest score.
const DRAWS: usize = 20_000;
/// Factors from which the fit starts.
const STARTS: [f64; 9] = [NOTHING, 0.1, 0.3, 0.5, 0.7, 1.4, 2.0, 3.0, 6.0];
/// Largest number of conventions that differ together.
const TOGETHER: usize = 3;
/// Combinations of fewer conventions from which larger ones are built.
const KEPT: usize = 3;
/// Most steps of a fit, and most halvings of a step.
const STEPS: usize = 12;
const HALVINGS: usize = 6;
/// Standard errors of a 95 % interval.
const WIDTH: f64 = 1.96;
/// Bisections of an end of an interval: to 2e-4 of the range of the logarithm.
const BISECTIONS: usize = 12;
/// Chance below which even the best explanation leaves more than the bands, as in the diagnosis.
const LEAST_CHANCE: f64 = 0.025;

impl Bench<'_> {
    /// The diagnosis by the slopes: the logarithm of a factor is its amplitude, and 1 the other way of a switch.
    pub(crate) fn diagnose(&self) -> Result<Diagnosis, Error> {
        let n = self.names.len();
        let library = self.concerned();
        let columns: Vec<DVector<f64>> = library
            .iter()
            .map(|&k| {
                if CONVENTIONS[k].is_factor() {
                    self.shift(&[k], &[STEP]) / STEP
                } else {
                    self.shift(&[k], &[0.0])
                }
            })
            .collect();
        let name = |k: &usize| CONVENTIONS[*k].name.to_owned();
        let range = |k: &usize| {
            if CONVENTIONS[*k].is_factor() {
                (Largest::Ends([NOTHING.ln(), LARGEST.ln()]), Sign::Any)
            } else {
                (Largest::Ends([0.0, 1.0]), Sign::Positive)
            }
        };
        let unit = |scale: f64| {
            let row = |i| (0..n).map(|j| if i == j { scale } else { 0.0 }).collect();
            CovarianceInput::Matrix((0..n).map(row).collect())
        };
        let file = ProblemFile {
            id: "passport".into(),
            conditions: vec![inference::diagnosis::Condition::default()],
            observables: self.names.clone(),
            residual_obs_minus_sim: self.residual.iter().map(|r| Some(*r)).collect(),
            cov_measurement: Some(unit(1.0)),
            cov_simulator: Some(unit(0.0)),
            sensitivities_declared: vec![Vec::new(); n],
            library: library.iter().map(name).collect(),
            sensitivities_library: (0..n)
                .map(|row| columns.iter().map(|c| c[row]).collect())
                .collect(),
            largest_amplitudes: library.iter().map(|k| (name(k), range(k).0)).collect(),
            signs: library.iter().map(|k| (name(k), range(k).1)).collect(),
            ..ProblemFile::default()
        };
        let options = Options {
            draws: DRAWS,
            ..Options::new(1)
        };
        Ok(diagnose(&Problem::try_from(file)?, &options)?)
    }

    /// Decides by runs with the conventions changed: of one, or of as few together as explain the numbers.
    pub(crate) fn decide(&self, first: Diagnosis) -> (Diagnosis, Vec<Fitted>) {
        let library = self.concerned();
        let none = self.at(&[], Vec::new());
        let mut kept = vec![none];
        let mut singles = Vec::new();
        for together in 1..=TOGETHER {
            let mut fits = self.larger(&kept, &library);
            fits.sort_by(|a, b| a.sum_of_squares().total_cmp(&b.sum_of_squares()));
            let models: Vec<RefittedModel> = fits.iter().map(refitted).collect();
            let decided = first.clone().decided_by_refits(&models, &[]);
            let chance = decided.refits.first().and_then(|best| best.p);
            if chance.is_some_and(|p| p > LEAST_CHANCE) {
                let standing = decided.refits.iter().zip(fits);
                let fits = standing.filter(|(refit, _)| !refit.refuted);
                let fits = fits.map(|(_, fit)| self.with_intervals(fit)).collect();
                return (decided, fits);
            }
            fits.truncate(KEPT);
            if together == 1 {
                singles.clone_from(&fits);
            }
            kept = fits;
        }
        let models: Vec<RefittedModel> = singles.iter().map(refitted).collect();
        let nearest = singles.into_iter().take(1);
        let nearest = nearest.map(|fit| self.with_intervals(fit)).collect();
        (first.decided_by_refits(&models, &[]), nearest)
    }

    /// A fit with the 95 % intervals of its factors: by the slopes, widened to all that the sum of squares leaves open with the other
    /// factors as they are. Where the numbers no longer follow a factor, as in a contact that sticks, it reaches to the end of the range.
    fn with_intervals(&self, mut fit: Fitted) -> Fitted {
        let free = free(&fit.conventions);
        if free.is_empty() {
            return fit;
        }
        let slopes = self.slopes(&fit.conventions, &fit.logs, &free);
        let inverse = slopes.tr_mul(&slopes).try_inverse();
        let largest = fit.sum_of_squares() + WIDTH * WIDTH;
        for (place, &k) in free.iter().enumerate() {
            let variance = inverse.as_ref().map_or(0.0, |v| v[(place, place)]);
            let width = WIDTH * variance.max(0.0).sqrt();
            let open = |log: f64| {
                let mut logs = fit.logs.clone();
                logs[k] = log;
                self.at(&fit.conventions, logs).sum_of_squares() <= largest
            };
            let [low, high] =
                [NOTHING.ln(), LARGEST.ln()].map(|end| last_open(&open, fit.logs[k], end));
            fit.intervals[k] = [low.min(fit.logs[k] - width), high.max(fit.logs[k] + width)];
        }
        fit
    }

    /// Each combination with one more convention, fitted.
    fn larger(&self, fits: &[Fitted], library: &[usize]) -> Vec<Fitted> {
        let mut sets: Vec<(Vec<usize>, &[f64])> = Vec::new();
        for fit in fits {
            for &k in library.iter().filter(|k| !fit.conventions.contains(k)) {
                let mut set = fit.conventions.clone();
                set.push(k);
                let same = |other: &Vec<usize>| set.iter().all(|k| other.contains(k));
                if !sets.iter().any(|(other, _)| same(other)) {
                    sets.push((set, &fit.logs));
                }
            }
        }
        let fits = sets.par_iter();
        fits.map(|(set, before)| self.fit(set, before)).collect()
    }

    /// Fits the factors of conventions that are read in other ways together, from the factors of all but the last; that of the last
    /// starts from the best of a grid.
    fn fit(&self, conventions: &[usize], before: &[f64]) -> Fitted {
        let free = free(conventions);
        let at = |log: f64| {
            let mut logs = before.to_vec();
            logs.push(log);
            self.at(conventions, logs)
        };
        if !conventions
            .last()
            .is_some_and(|&k| CONVENTIONS[k].is_factor())
        {
            return self.improve(at(0.0), &free);
        }
        let starts: Vec<Fitted> = STARTS.iter().map(|start| at(start.ln())).collect();
        let order = |a: &Fitted, b: &Fitted| a.sum_of_squares().total_cmp(&b.sum_of_squares());
        let best = starts.into_iter().min_by(order);
        best.map_or_else(|| at(0.0), |best| self.improve(best, &free))
    }

    /// Gauss-Newton steps with halving.
    fn improve(&self, start: Fitted, free: &[usize]) -> Fitted {
        let mut fitted = start;
        if free.is_empty() {
            return fitted;
        }
        for _ in 0..STEPS {
            let slopes = self.slopes(&fitted.conventions, &fitted.logs, free);
            let step = slopes.svd(true, true).solve(&fitted.residual, 1e-9);
            let Ok(mut step) = step else { break };
            let before = fitted.sum_of_squares();
            for _ in 0..HALVINGS {
                let mut logs = fitted.logs.clone();
                for (&k, by) in free.iter().zip(step.iter()) {
                    logs[k] = (logs[k] + by.clamp(-0.5, 0.5)).clamp(NOTHING.ln(), LARGEST.ln());
                }
                let next = self.at(&fitted.conventions, logs);
                if next.sum_of_squares() < before {
                    fitted = next;
                    break;
                }
                step *= 0.5;
            }
            // Further steps do not matter: less than a thousandth of what is left, or of the square of a band.
            if before - fitted.sum_of_squares() <= 1e-3 * before.min(1.0) {
                break;
            }
        }
        fitted
    }
}

/// Places of the factors among conventions.
fn free(conventions: &[usize]) -> Vec<usize> {
    (0..conventions.len())
        .filter(|&k| CONVENTIONS[conventions[k]].is_factor())
        .collect()
}

/// The last place between one that is open and an end that is, up to bisection.
fn last_open(open: &dyn Fn(f64) -> bool, from: f64, end: f64) -> f64 {
    if open(end) {
        return end;
    }
    let (mut inside, mut outside) = (from, end);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (inside + outside);
        if open(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

/// A fit as the diagnosis takes it; its runs have no noise.
fn refitted(fit: &Fitted) -> RefittedModel {
    RefittedModel {
        effects: fit
            .conventions
            .iter()
            .map(|&k| CONVENTIONS[k].name.to_owned())
            .collect(),
        residual: fit.residual.iter().copied().collect(),
        noise: 0.0,
    }
}
