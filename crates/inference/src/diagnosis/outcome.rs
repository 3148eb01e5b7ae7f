//! The outcome of a diagnosis, as it is written and read.

use input::quantity::significant;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

use crate::diagnosis::summary::summary;
use crate::diagnosis::tails::upper_tail;
use crate::diagnosis::{BeforeAfter, Contrast, NextMeasurement, Refit, RefittedModel};

/// Verdict on a residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No missing effect at this precision.
    None,
    /// The effects are named, each alone in its tie set, and what remains is noise.
    Named,
    /// One of several effects is missing, and the data cannot tell which.
    Tie,
    /// Something is missing, and it cannot be said to be an effect of the library.
    Unknown,
    /// One condition carries the whole residual: measure it again.
    Recheck,
    /// No candidate could be seen even at its largest amplitude.
    NotTestable,
    /// There are not more observations than parameters.
    Refused,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Named => "named",
            Self::Tie => "tie",
            Self::Unknown => "unknown",
            Self::Recheck => "recheck",
            Self::NotTestable => "not-testable",
            Self::Refused => "refused",
        })
    }
}

/// A diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Name of the problem.
    pub id: String,
    /// The verdict.
    pub verdict: Verdict,
    /// The effects that are named, or the tie set; empty otherwise.
    pub effects: Vec<String>,
    /// The same in plain language, with what remains open.
    pub summary: String,
    /// Effects that would help but are not named, because an unknown effect is not excluded, the
    /// unused conditions speak against them, or one condition carries them.
    pub suspects: Vec<String>,
    /// For each effect that was taken, it and behind it the candidates that would do nearly as well, the best first.
    pub tie_groups: Vec<Vec<String>>,
    /// What would be named or tied, one effect and its rivals, if it did better than an unknown effect at the conditions of the fit;
    /// conditions kept from it may tell, see [`crate::diagnosis::ln_over_unknown`]. Empty otherwise.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub proposal: Vec<Vec<String>>,
    /// Largest distance in deviance inside a tie set.
    pub tie_set_c: f64,
    /// Whether there is structure at all.
    pub structured_residual: StructuredResidual,
    /// Result of each effect of the library, by name; empty if the test was refused.
    pub candidates: BTreeMap<String, CandidateResult>,
    /// Names of the candidates that could not be seen even at their largest amplitude.
    pub not_testable: Vec<String>,
    /// Statistic that the largest score must reach; none without candidates.
    pub z_critical: Option<f64>,
    /// Amplitudes of the effects that were taken, together.
    pub amplitudes: BTreeMap<String, Amplitude>,
    /// Re-tuning of the declared parameters with the effects on, in their units.
    pub retuning: BTreeMap<String, f64>,
    /// The declared parameters with the effects on: how well they are known.
    pub declared: BTreeMap<String, DeclaredResult>,
    /// The condition with the largest share of the structured residual.
    pub largest_condition_share: Option<ConditionShare>,
    /// The condition to measure again.
    pub recheck_condition: Option<String>,
    /// Support of each observable alone for the leading effect; empty if the test was
    /// refused or there is no library.
    pub observable_support: Vec<ObservableSupport>,
    /// Reduction of the structured residual by each effect, by observable; the reductions add up to the whole.
    /// Correlated values are split in the order of the observables.
    pub evidence: BTreeMap<String, Vec<Evidence>>,
    /// Errors before and after; none when the test was refused or there is no library.
    pub before_after: Option<BeforeAfter>,
    /// The models that real runs have fitted again, the best first; empty until [`Diagnosis::decided_by_refits`].
    pub refits: Vec<Refit>,
    /// Whitened mean square on unused conditions by runs of the simulator itself, without and with
    /// the named effects; none until [`Diagnosis::checked_by_runs`].
    pub runs_on_unused: Option<[f64; 2]>,
    /// The next measurement, if one helps.
    pub next_measurement: Option<NextMeasurement>,
    /// Oddities, and limits of the verdict.
    pub warnings: Vec<String>,
    /// Seed of the simulated distributions.
    pub seed: u64,
    /// Number of draws of them.
    pub draws: usize,
}

/// The amplitude of an effect, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Amplitude {
    /// Its estimate.
    pub value: f64,
    /// Its 95 % interval, inside the range that is physically possible.
    pub interval95: [f64; 2],
}

/// Such as "0.620 (0.410 to 0.970)". An interval without width is none: the data ask for more than is possible, or for another response,
/// and no amplitude passes the test.
impl fmt::Display for Amplitude {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [value, low, high] = [self.value, self.interval95[0], self.interval95[1]];
        let is_none = low >= high;
        let [value, low, high] = [value, low, high].map(|x| significant(x, 3));
        if is_none {
            return write!(f, "{value} (no amplitude passes at 95 %)");
        }
        write!(f, "{value} ({low} to {high})")
    }
}

/// Whether the residual holds more than noise and re-tuning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructuredResidual {
    /// Sum of squares that re-tuning cannot absorb; none when the test was refused.
    pub t0: Option<f64>,
    /// Its degrees of freedom.
    pub df: usize,
    /// Its upper tail.
    pub p: Option<f64>,
    /// The part of it inside a smooth basis over the conditions.
    pub t0_smooth: Option<f64>,
    /// Its degrees of freedom.
    pub df_smooth: usize,
    /// Its upper tail.
    pub p_smooth: Option<f64>,
    /// Degrees of freedom of the covariances, when they are estimated: the reference is then F.
    pub covariance_dof: Option<f64>,
    /// Sum of squares of runs at fitted parameters, without a further step by the slopes; `None` if the residual is not
    /// of such runs.
    pub t_at_fit: Option<f64>,
    /// Its upper tail on as many degrees of freedom as there are values and priors.
    pub p_at_fit: Option<f64>,
}

/// Known data of a declared parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeclaredResult {
    /// Standard error, in its unit; `None` if it is held at a limit.
    pub se: Option<f64>,
    /// The same without any effect.
    pub se_without: Option<f64>,
    /// Where the data would move it beyond a limit, without an effect.
    pub held: Option<Limit>,
    /// Correlation with the other parameters, by name; 0 where one of the two is held.
    pub correlation: BTreeMap<String, f64>,
}

/// A limit of a declared parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Limit {
    /// Its lower one.
    Lower,
    /// Its upper one.
    Upper,
}

/// Why an effect could not be seen even at its largest amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unseen {
    /// Re-tuning the declared parameters inside their limits hides it.
    RetuningHidesIt,
    /// Its largest amplitude does less than the noise.
    RangeTooSmall,
    /// The runs that give its slope are too few: the slope is noise.
    SlopeIsNoise,
}

/// Result of one effect of the library.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CandidateResult {
    /// Score: standard normal when the effect is absent; none when re-tuning absorbs it wholly.
    pub z: Option<f64>,
    /// Amplitude, 0 where its sign is impossible.
    pub amplitude: Option<f64>,
    /// Standard error of the amplitude.
    pub se: Option<f64>,
    /// Share of the effect that re-tuning can imitate; none when it does nothing.
    pub absorbed_fraction: Option<f64>,
    /// Structured residual with this effect on.
    pub t_after: f64,
    /// Its upper tail: whether what remains is noise.
    pub p_adequacy: Option<f64>,
    /// Upper tail of the part of it inside the smooth basis.
    pub p_adequacy_smooth: Option<f64>,
    /// Chance that the largest score of all testable candidates is at least this large by noise.
    pub p_max_test: Option<f64>,
    /// ln of the Bayes factor of this effect over an unknown smooth effect.
    pub ln_bf_unknown: Option<f64>,
    /// Smallest amplitude that is seen with a chance of 90 %; `None` if the sensitivity does not stand out
    /// of its own noise.
    pub smallest_detectable: Option<f64>,
    /// Whether its largest physical amplitude could be seen.
    pub testable: bool,
    /// Why not, where it could not.
    pub unseen: Option<Unseen>,
}

/// Support of one observable for the leading effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservableSupport {
    /// The observable.
    pub observable: String,
    /// The effect.
    pub effect: String,
    /// Its score by the rows of this observable alone; `None` if re-tuning absorbs it there.
    pub z: Option<f64>,
}

/// Reduction of the structured residual by an effect, in the values of one observable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evidence {
    /// The observable; none for the priors of the parameters.
    pub observable: Option<String>,
    /// The drop; below 0 where the effect makes the values fit worse.
    pub drop: f64,
}

/// A condition and its share.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionShare {
    /// Number of the condition, from 0.
    pub condition_index: usize,
    /// The condition in words.
    pub condition: String,
    /// Its share of the structured residual, 0 to 1.
    #[serde(rename = "share_of_T0")]
    pub share: f64,
}

/// Least chance with which noise alone leaves so much on unused conditions as a named effect may leave.
const LEAST_P_ON_UNUSED: f64 = 0.01;

/// Separation from which on two models are distinguished in 19 of 20 cases either way: twice the quantile of 5 %.
const TOLD_APART: f64 = 3.29;

/// A model in question, by real runs at conditions that nothing has used.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedModel {
    /// Its effects, and the residual of its runs.
    pub model: RefittedModel,
    /// Whitened mean square of the remaining residual.
    pub whitened_mse: f64,
    /// How it differs there from the model without effects.
    pub contrast: Contrast,
}

impl Diagnosis {
    /// The diagnosis in plain language, with what remains open.
    pub fn summary(&self) -> &str {
        &self.summary
    }

    /// Holds an answer against runs of the simulator itself, with the effects switched on, at conditions
    /// that neither choice nor fit has used: whitened mean square `before` of so many values, and each model in
    /// question, the best explanation first.
    ///
    /// A model does not stand that the values refute (a right one by chance in 5 of 100 cases) or that leaves more than
    /// noise there (1 of 100): its effects leave the answer, but for those of models that stand. The answer is taken back, and its
    /// effects become suspects if none remains, or if one remains that the values do not distinguish from those refuted. The errors before and
    /// after stay.
    #[must_use]
    pub fn checked_by_runs(mut self, before: f64, after: &[CheckedModel], values: usize) -> Self {
        let dof = self.structured_residual.covariance_dof;
        let fault = |model: &CheckedModel| {
            let Contrast { separation, score } = model.contrast;
            if model.contrast.refutes() {
                return Some(format!(
                    "and the values lie {:.1} standard deviations on the side of the model without it, which lies \
                     {separation:.1} away",
                    -score
                ));
            }
            let p = upper_tail(model.whitened_mse * values as f64, values, dof);
            let too_small = p.filter(|p| *p < LEAST_P_ON_UNUSED);
            too_small.map(|p| format!("and what is left is more than noise, p {p:.1e}"))
        };
        let (mut standing, mut fallen) = (Vec::new(), Vec::new());
        for model in after {
            let (name, mse) = (model.model.effects.join(" and "), model.whitened_mse);
            match fault(model) {
                None => {
                    standing.push(&model.model);
                    if model.contrast.separation < TOLD_APART {
                        self.warnings.push(format!(
                            "the unused conditions can hardly tell the model with {name} from the one without: the \
                             two differ by {:.1} standard deviations there",
                            model.contrast.separation
                        ));
                    }
                }
                Some(reason) => {
                    fallen.push(&model.model);
                    self.warnings.push(format!(
                        "{name} does not stand: by real runs the whitened mean square on the unused \
                         conditions goes from {before:.3} to {mse:.3}, {reason}"
                    ));
                }
            }
        }
        let first = |m: &&CheckedModel| standing.first().is_none_or(|s| m.model == **s);
        let shown = after.iter().find(first);
        self.runs_on_unused = shown.map(|model| [before, model.whitened_mse]);
        let level = self.level();
        let holds = |models: &[&RefittedModel], name: &String| {
            models.iter().any(|model| model.effects.contains(name))
        };
        if let Some(best) = standing.first() {
            let is_told = |model: &&RefittedModel| model.against(best, level, dof).0;
            let all_told = fallen.iter().all(is_told);
            self.keep(|name| holds(&standing, name) || !holds(&fallen, name));
            if self.verdict == Verdict::Named && !all_told {
                self.take_back(
                    "the answer is withdrawn: the unused conditions do not distinguish what remains of it from what they refute".to_owned(),
                );
            }
        } else if shown.is_some() {
            self.take_back("the answer is withdrawn for this".to_owned());
        }
        self.summary = summary(&self);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::{CheckedModel, Verdict};
    use crate::diagnosis::{Contrast, Options, Problem, ProblemFile, RefittedModel, diagnose};

    /// A line over four speeds with noise 1, one free level, and a library of one slope, planted with
    /// twenty standard errors.
    fn named() -> super::Diagnosis {
        let text = r#"{
            "id": "slope", "observables": ["angle_deg"],
            "conditions": [{"rpm": 5}, {"rpm": 10}, {"rpm": 15}, {"rpm": 20}],
            "residual_obs_minus_sim": [-15.3, -4.6, 5.2, 14.8],
            "cov_measurement": [[1.0]], "cov_simulator": [[0.0]],
            "sensitivities_declared": [[1], [1], [1], [1]],
            "library": ["slope"], "sensitivities_library": [[-1.5], [-0.5], [0.5], [1.5]]
        }"#;
        let file: ProblemFile = serde_json::from_str(text).unwrap();
        diagnose(&Problem::try_from(file).unwrap(), &Options::new(1)).unwrap()
    }

    /// Models by the mean square that they leave, and by the score of their difference from the model without them.
    fn models(after: &[[f64; 2]]) -> Vec<CheckedModel> {
        let model = |(name, [whitened_mse, score]): (&str, &[f64; 2])| CheckedModel {
            model: RefittedModel {
                effects: vec![name.into()],
                // All of it in one value, so that models that differ lie apart.
                residual: vec![whitened_mse.sqrt() * 2.0, 0.0, 0.0, 0.0],
                noise: 0.0,
            },
            whitened_mse: *whitened_mse,
            contrast: Contrast {
                separation: 5.0,
                score: *score,
            },
        };
        ["slope", "curve"]
            .into_iter()
            .zip(after)
            .map(model)
            .collect()
    }

    #[test]
    fn a_naming_that_real_runs_do_not_bear_out_is_withdrawn() {
        assert_eq!(named().verdict, Verdict::Named, "{}", named().summary());
        let stays = named().checked_by_runs(9.0, &models(&[[1.1, -2.4]]), 4);
        assert_eq!(stays.verdict, Verdict::Named);
        assert!(
            stays.summary().contains("from 9.00 to 1.10"),
            "{}",
            stays.summary()
        );
        // Four values of mean square 3.4 sum to 13.6, above 13.3: the upper 1 % point of chi-square on four.
        // At a distance of 5 the other model is nearer from -2.5 on.
        for after in [[1.1, -2.6], [3.4, 0.0], [f64::NAN, f64::NAN]] {
            let fallen = named().checked_by_runs(9.0, &models(&[after]), 4);
            assert_eq!(fallen.verdict, Verdict::Unknown);
            assert!(fallen.effects.is_empty());
            assert_eq!(fallen.suspects, ["slope"]);
        }
    }

    /// Of two effects in question the second stands, and the first leaves the answer; or none stands.
    #[test]
    fn what_real_runs_refute_leaves_the_answer() {
        let mut tied = named();
        tied.tie_groups = vec![vec!["slope".into(), "curve".into()]];
        tied.effects = tied.tie_groups[0].clone();
        let stays = tied
            .clone()
            .checked_by_runs(9.0, &models(&[[9.1, -4.0], [1.1, 0.0]]), 4);
        assert_eq!(stays.verdict, Verdict::Named);
        assert_eq!(stays.effects, ["curve"]);
        assert_eq!(stays.runs_on_unused, Some([9.0, 1.1]));
        let said = stays.warnings.join(" ");
        assert!(said.contains("slope does not stand"), "{said}");
        // 2 (sqrt(2) - sqrt(1.1)) = 0.7 standard deviations do not tell them apart.
        let alike = tied
            .clone()
            .checked_by_runs(9.0, &models(&[[2.0, -4.0], [1.1, 0.0]]), 4);
        assert_eq!(alike.verdict, Verdict::Unknown);
        assert_eq!(alike.suspects, ["curve"]);
        let both = tied
            .clone()
            .checked_by_runs(9.0, &models(&[[1.2, 0.0], [1.1, 0.0]]), 4);
        assert_eq!(
            (both.verdict, both.effects),
            (Verdict::Tie, tied.effects.clone())
        );
        let fallen = tied.checked_by_runs(9.0, &models(&[[3.4, 0.0], [9.1, -4.0]]), 4);
        assert_eq!(fallen.verdict, Verdict::Unknown);
        assert_eq!(fallen.suspects, ["slope", "curve"]);
        assert_eq!(fallen.runs_on_unused, Some([9.0, 3.4]));
        let said = fallen.warnings.join(" ");
        assert!(said.contains("curve does not stand"), "{said}");
    }

    /// A model as real runs leave it: four values, the first of which it misses by so much.
    fn refitted(name: &str, miss: f64) -> RefittedModel {
        RefittedModel {
            effects: vec![name.into()],
            residual: vec![miss, 0.5, -0.5, 0.5],
            noise: 0.4,
        }
    }

    /// The slopes name "slope". Real runs fit "curve" better by 4 standard deviations, and "slope" leaves the answer; by 2, and
    /// both are in it, the better one first. What was not run is not refuted. Where the best leaves more than noise, nothing
    /// is named: 4² + 0.75 = 16.75 lies above 11.1, the upper 2.5 % point of chi-square on four.
    #[test]
    fn real_runs_decide_between_the_effects() {
        let decided = |models: &[RefittedModel], open: &[Vec<String>]| {
            named().decided_by_refits(models, open)
        };
        let curve = decided(&[refitted("slope", 4.0), refitted("curve", 0.0)], &[]);
        assert_eq!(curve.verdict, Verdict::Named, "{}", curve.summary());
        assert_eq!(curve.effects, ["curve"]);
        assert!(curve.refits[1].refuted && curve.refits[1].ln_odds_of_best > Some(5.0));
        let tied = decided(&[refitted("slope", 2.0), refitted("curve", 0.0)], &[]);
        assert_eq!(tied.verdict, Verdict::Tie, "{}", tied.summary());
        assert_eq!(tied.effects, ["curve", "slope"]);
        let open = decided(&[refitted("slope", 0.0)], &[vec!["curve".into()]]);
        assert_eq!(open.verdict, Verdict::Tie, "{}", open.summary());
        let poor = decided(&[refitted("slope", 4.0)], &[]);
        assert_eq!(poor.verdict, Verdict::Unknown, "{}", poor.summary());
        assert_eq!(poor.suspects, ["slope"]);
        let unrun = decided(&[], &[vec!["slope".into()]]);
        assert_eq!(unrun.verdict, Verdict::Unknown, "{}", unrun.summary());
    }

    /// With one observable the support is the score itself.
    #[test]
    fn a_lone_observable_carries_the_whole_score() {
        let d = named();
        let [only] = d.observable_support.as_slice() else {
            panic!("{:?}", d.observable_support);
        };
        assert_eq!(
            (only.observable.as_str(), only.effect.as_str()),
            ("angle_deg", "slope")
        );
        assert!((only.z.unwrap() - d.candidates["slope"].z.unwrap()).abs() < 1e-9);
    }
}
