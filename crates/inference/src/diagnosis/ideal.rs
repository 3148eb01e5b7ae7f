//! How often a rule could tell a hidden effect that knew more than any rule can: a bound for rates of campaigns.

use nalgebra::DVector;
use probability::random_stream::Stream;
use serde::Serialize;

use crate::diagnosis::Error;
use crate::diagnosis::detectability::testable;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::gates::GATE;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::trials::noise;
use probability::{ln_normal_cdf, normal_upper_quantile};

/// Most effects of a tie that still says something.
const SMALL_TIE: usize = 3;

/// What an ideal rule could tell of a hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ideal {
    /// Expected score of the effect behind re-tuning, the noise of its sensitivity taken off; 0 where re-tuning hides it.
    pub detectability: f64,
    /// Chance that a one-sided normal test along the true direction, at the level of a gate, sees it.
    pub seen: f64,
    /// The effect of the library that imitates it best; none without another one that could be seen.
    pub nearest: Option<String>,
    /// What that effect leaves of it, standard deviations; none likewise.
    pub separation: Option<f64>,
    /// Chance that the likelihood ratio of the two prefers the truth; 1 without a rival.
    pub preferred: f64,
    /// Share of drawn campaigns in which the effect is seen and is among the three likeliest of the library.
    pub among_three: f64,
}

/// What an ideal rule could tell of an effect of this amplitude, in a design as linear as that of the problem.
///
/// The residual of the problem is not used. The drawn campaigns hold the effect, the noise of the covariance and that of
/// the bench means; their sensitivities are taken as exact. What is noise in those of two effects thus counts as a
/// difference between them, so that the last two chances are generous.
///
/// # Formula
///
/// With d the detectability and z the quantile of the gate, the chance to be seen is Phi(d - z). With s² the least of
/// |a l - S shift - b l_k|² over shifts and amplitudes b of a rival, whitened rows, the log likelihood ratio of the
/// two is normal of mean s²/2 and variance s², and prefers the truth with the chance Phi(s/2).
///
/// # Errors
///
/// As [`crate::diagnosis::diagnose`]; [`Error::Missing`] for an effect that the library does not have.
pub fn ideal(
    problem: &Problem,
    effect: &str,
    amplitude: f64,
    draws: usize,
    seed: u64,
) -> Result<Ideal, Error> {
    let at = problem.candidates.iter().position(|c| c.name == effect);
    let j = at.ok_or_else(|| Error::Missing {
        what: format!("library effect '{effect}'"),
        way_out: "name an effect of the library".into(),
    })?;
    let nominal = Fit::new(problem, &[])?;
    let family = testable(problem, &nominal);
    let score = nominal.expected_score(problem, j, amplitude);
    let detectability = score.unwrap_or(0.0).max(0.0);
    let mut exact = problem.clone();
    exact.used.declared_noise.clear();
    exact.used.library_noise.clear();
    let signal = problem.used.library.column(j) * amplitude;
    exact.used.residual.clone_from(&signal);
    if let Some(prior) = &mut exact.prior {
        prior.offset.fill(0.0);
    }
    let mut nearest: Option<(usize, f64)> = None;
    for &k in family.iter().filter(|&&k| k != j) {
        let left = Fit::new(&exact, &[k])?.t.max(0.0).sqrt();
        if nearest.is_none_or(|(_, least)| left < least) {
            nearest = Some((k, left));
        }
    }
    let gate = normal_upper_quantile(GATE);
    let mut stream = Stream::new(seed, "ideal rule");
    let mut told = 0;
    for _ in 0..draws {
        exact.used.residual = &signal + noise(&exact.used.covariance, &mut stream);
        if let Some(prior) = &mut exact.prior {
            prior.offset = DVector::from_fn(prior.offset.len(), |_, _| stream.normal());
        }
        let nothing = Fit::new(&exact, &[])?;
        let score = nothing.score(j, &exact.candidates[j]);
        if score.is_none_or(|s| s.gain * amplitude.signum() < gate) {
            continue;
        }
        let own = Fit::new(&exact, &[j])?.t;
        let mut ahead = 0;
        for &k in family.iter().filter(|&&k| k != j) {
            ahead += usize::from(Fit::new(&exact, &[k])?.t < own);
        }
        told += usize::from(ahead < SMALL_TIE);
    }
    Ok(Ideal {
        detectability,
        seen: ln_normal_cdf(detectability - gate).exp(),
        nearest: nearest.map(|(k, _)| problem.candidates[k].name.clone()),
        separation: nearest.map(|(_, left)| left),
        preferred: nearest.map_or(1.0, |(_, left)| ln_normal_cdf(0.5 * left).exp()),
        among_three: told as f64 / draws.max(1) as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::ideal;
    use crate::diagnosis::{Problem, ProblemFile};

    /// Two values of noise 1 and no parameter: `first` moves the first alone; `both` moves both by 0.6 and 0.8.
    fn plane() -> Problem {
        let text = r#"{
            "id": "plane", "observables": ["angle_deg"],
            "conditions": [{"rpm": 5}, {"rpm": 10}],
            "residual_obs_minus_sim": [7.0, -3.0],
            "cov_measurement": [[1.0]], "cov_simulator": [[0.0]],
            "sensitivities_declared": [[], []],
            "library": ["first", "both"], "sensitivities_library": [[1.0, 0.6], [0.0, 0.8]]
        }"#;
        let file: ProblemFile = serde_json::from_str(text).unwrap();
        Problem::try_from(file).unwrap()
    }

    /// An amplitude of 5 has the score 5, seen but for Phi(1.96 - 5) = 0.0012; `both` takes its projection 0.6 off and
    /// leaves 0.8 x 5 = 4: Phi(2) = 0.97725. Of two effects each is among three, so that the drawn share is that of being
    /// seen: 0.9988 within four standard errors of 400 draws, 0.007.
    #[test]
    fn an_effect_in_a_plane_is_told_as_often_as_the_normal_says() {
        let told = ideal(&plane(), "first", 5.0, 400, 1).unwrap();
        assert!((told.detectability - 5.0).abs() < 1e-12, "{told:?}");
        assert!((told.seen - 0.998_82).abs() < 1e-5, "{told:?}");
        assert_eq!(told.nearest.as_deref(), Some("both"));
        assert!((told.separation.unwrap() - 4.0).abs() < 1e-12, "{told:?}");
        assert!((told.preferred - 0.977_25).abs() < 1e-5, "{told:?}");
        assert!((told.among_three - 0.998_8).abs() < 0.007, "{told:?}");
        let error = ideal(&plane(), "third", 5.0, 1, 1).unwrap_err();
        assert!(error.to_string().contains("third"), "{error}");
    }

    /// Half of the campaigns see an effect as strong as the quantile of the gate: 0.5 within four standard errors of 400
    /// draws, 0.1; and either sign alike.
    #[test]
    fn an_effect_at_the_gate_is_seen_half_the_time() {
        for amplitude in [1.96, -1.96] {
            let told = ideal(&plane(), "first", amplitude, 400, 1).unwrap();
            assert!((told.seen - 0.5).abs() < 1e-4, "{told:?}");
            assert!((told.among_three - 0.5).abs() < 0.1, "{told:?}");
        }
    }
}
