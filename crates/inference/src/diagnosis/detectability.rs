//! Which effects could be seen at all, from which amplitude on, and why not.

use crate::diagnosis::fit::Fit;
use crate::diagnosis::outcome::Unseen;
use crate::diagnosis::problem::Problem;

/// Expected score of the largest amplitude below which a candidate is not testable.
const SMALLEST_DETECTABILITY: f64 = 3.0;

/// Size of an effect without a largest amplitude at which it is judged: that of 80 standard errors of the values, before
/// re-tuning. Our choice: an effect larger than that is not a residual to explain, and one that must be larger to be
/// seen rests on the last digits of the slopes, because re-tuning absorbs more than 99.86 % of it. At twice the
/// value the limit is 99.96 %.
const UNLIMITED_SIZE: f64 = 80.0;

/// Candidates whose largest physical amplitude would be seen; one without a limit is judged at a size that no residual
/// has.
///
/// The noise of a sensitivity lengthens it: what is asked of the largest amplitude is the expected score, without
/// that noise. A candidate whose sensitivity is no more than noise would otherwise look like one of random shape,
/// and take names from others. What re-tuning inside the limits imitates is taken off.
pub(crate) fn testable(problem: &Problem, nominal: &Fit) -> Vec<usize> {
    let seen = |j: &usize| {
        let ends = problem.candidates[*j].range().into_iter();
        let mut ends = ends.filter(|end| *end != 0.0);
        let [length, _] = nominal.whole_and_noise(problem, *j);
        ends.any(|end| {
            let amplitude = if end.is_finite() {
                end
            } else {
                end.signum() * UNLIMITED_SIZE / length
            };
            // An effect that does nothing has no amplitude of that size.
            let score = Some(amplitude).filter(|a| a.is_finite());
            let score = score.and_then(|a| nominal.expected_score(problem, *j, a));
            score.is_some_and(|score| score >= SMALLEST_DETECTABILITY)
        })
    };
    (0..problem.candidates.len()).filter(seen).collect()
}

/// Why an effect that is not testable cannot be seen.
pub(crate) fn why_unseen(problem: &Problem, nominal: &Fit, effect: usize) -> Unseen {
    let [length, noise] = nominal.whole_and_noise(problem, effect);
    let largest = problem.candidates[effect].range().map(f64::abs);
    let largest = largest[0].max(largest[1]);
    // Noise lengthens a slope to the root of the sum of squares.
    let own = (length * length - noise * noise).max(0.0).sqrt();
    if noise > 0.0 && own < noise {
        Unseen::SlopeIsNoise
    } else if largest * own < SMALLEST_DETECTABILITY {
        Unseen::RangeTooSmall
    } else {
        Unseen::RetuningHidesIt
    }
}

/// Smallest amplitude of a candidate whose expected score reaches a value, of the sign that needs less; `None` if no
/// possible amplitude does.
pub(crate) fn smallest_detectable(
    problem: &Problem,
    nominal: &Fit,
    effect: usize,
    score: f64,
) -> Option<f64> {
    let expected = |a: f64| nominal.expected_score(problem, effect, a).unwrap_or(0.0);
    let least = |end: f64| {
        // Where re-tuning has no limit in reach, the score grows in proportion.
        let mut high = if end.is_finite() { end } else { end.signum() };
        for _ in 0..60 {
            if expected(high) >= score {
                break;
            }
            if end.is_finite() {
                // An amplitude beyond the possible ones shows how far the effect is from being detectable.
                let proportional = expected(high);
                return (proportional > 0.0).then(|| high.abs() * score / proportional);
            }
            high *= 2.0;
        }
        if expected(high) < score {
            return None;
        }
        let mut low = 0.0;
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if expected(middle) >= score {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(high.abs())
    };
    let ends = problem.candidates[effect].range().into_iter();
    let each = ends.filter(|end| *end != 0.0).filter_map(least);
    each.min_by(f64::total_cmp)
}
