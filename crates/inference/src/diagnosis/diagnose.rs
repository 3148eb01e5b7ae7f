//! The whole diagnosis: decision, check on unused conditions, report.

use std::collections::BTreeMap;

use crate::diagnosis::Error;
use crate::diagnosis::bayes_factor::{ln_factor_of_effect, ln_factor_of_unknown};
use crate::diagnosis::before_after::{BeforeAfter, before_after};
use crate::diagnosis::decision::{Decision, decide};
use crate::diagnosis::detectability::{smallest_detectable, testable, why_unseen};
use crate::diagnosis::fit::Fit;
use crate::diagnosis::gates::{GATE, Gates};
use crate::diagnosis::next_measurement::next_measurement;
use crate::diagnosis::outcome::{
    Amplitude, CandidateResult, ConditionShare, DeclaredResult, Diagnosis, Evidence, Limit,
    ObservableSupport, StructuredResidual, Verdict,
};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::refits::KNOWN;
use crate::diagnosis::summary::summary;
use probability::{normal_upper_quantile, t_two_sided_quantile};

/// Chance with which the smallest detectable amplitude is seen.
const POWER: f64 = 0.9;

/// How a diagnosis is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Seed of the simulated null distributions and of the bootstrap.
    pub seed: u64,
    /// Draws of the null distribution of the largest score; the standard error of a p-value of
    /// 0.025 is 0.16 / sqrt(draws).
    pub draws: usize,
    /// Largest number of effects taken together.
    pub max_effects: usize,
}

impl Options {
    /// The usual settings: 200 000 draws, up to two effects together.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            draws: 200_000,
            max_effects: 2,
        }
    }
}

/// Diagnoses a residual.
///
/// # Errors
///
/// [`Error::NotPositiveDefinite`] when a covariance cannot be factorised, those added for noisy
/// sensitivities included.
pub fn diagnose(problem: &Problem, options: &Options) -> Result<Diagnosis, Error> {
    let Checked {
        decision,
        before_after,
        withdrawn,
    } = decide_and_check(problem, options)?;
    let refused = decision.verdict == Verdict::Refused;
    let name = |j: &usize| problem.candidates[*j].name.clone();
    let names = |list: &[usize]| list.iter().map(name).collect::<Vec<_>>();
    let candidates = if refused {
        BTreeMap::new()
    } else {
        candidate_results(problem, &decision)?
    };
    let mut diagnosis = Diagnosis {
        id: problem.id.clone(),
        verdict: decision.verdict,
        effects: names(&decision.effects),
        summary: String::new(),
        suspects: names(&decision.suspects),
        tie_groups: decision.tie_groups.iter().map(|g| names(g)).collect(),
        proposal: decision.proposal.iter().map(|g| names(g)).collect(),
        tie_set_c: decision.tie_limit,
        structured_residual: structured_residual(problem, &decision),
        not_testable: candidates
            .iter()
            .filter(|(_, c)| !c.testable)
            .map(|(name, _)| name.clone())
            .collect(),
        candidates,
        z_critical: critical(&decision.gates),
        amplitudes: amplitudes(problem, &decision),
        retuning: retuning(problem, &decision),
        declared: declared_results(problem, &decision),
        largest_condition_share: largest_share(problem, &decision.nominal).filter(|_| !refused),
        recheck_condition: decision.recheck.map(|c| problem.used.label(c)),
        observable_support: if refused {
            Vec::new()
        } else {
            observable_support(problem, &decision)?
        },
        evidence: if refused {
            BTreeMap::new()
        } else {
            evidence(problem, &decision)
        },
        before_after,
        refits: Vec::new(),
        runs_on_unused: None,
        next_measurement: None,
        warnings: all_warnings(problem, &decision, withdrawn, options)?,
        seed: options.seed,
        draws: options.draws,
    };
    diagnosis.next_measurement = next_measurement(problem, &diagnosis)?;
    diagnosis.summary = summary(&diagnosis);
    Ok(diagnosis)
}

/// A decision that has met the unused conditions.
pub(crate) struct Checked {
    pub(crate) decision: Decision,
    /// The errors before and after; `None` if nothing could be tried.
    pub(crate) before_after: Option<BeforeAfter>,
    /// Why a naming was taken back, where it was.
    pub(crate) withdrawn: Option<String>,
}

/// Decides, and takes back a naming that the unused conditions refute.
pub(crate) fn decide_and_check(problem: &Problem, options: &Options) -> Result<Checked, Error> {
    let mut decision = decide(problem, options)?;
    let before_after = match decision.verdict {
        Verdict::Refused => None,
        _ => compare(problem, &decision, options)?,
    };
    let withdrawn = withdraw(&mut decision, before_after.as_ref());
    Ok(Checked {
        decision,
        before_after,
        withdrawn,
    })
}

/// Errors before and after the chosen effects, or the best candidate if none was chosen.
fn compare(
    problem: &Problem,
    decision: &Decision,
    options: &Options,
) -> Result<Option<BeforeAfter>, Error> {
    let Some(best) = decision.gates.best else {
        return Ok(None);
    };
    let chosen = if decision.effects.is_empty() {
        &decision.singles[best]
    } else {
        &decision.chosen
    };
    let tied = |j: &usize| {
        chosen.effects.contains(j) || decision.effects.contains(j) || decision.suspects.contains(j)
    };
    let rival = decision
        .testable
        .iter()
        .filter(|j| !tied(j))
        .map(|&j| &decision.singles[j])
        .min_by(|a, b| a.deviance.total_cmp(&b.deviance));
    before_after(problem, &decision.nominal, chosen, rival, options.seed).map(Some)
}

/// Takes back a naming that the unused conditions refute, and says why.
fn withdraw(decision: &mut Decision, errors: Option<&BeforeAfter>) -> Option<String> {
    let naming = matches!(decision.verdict, Verdict::Named | Verdict::Tie);
    let unused = errors.filter(|_| naming)?.unused.as_ref()?;
    if !unused.contrast.refutes() {
        return None;
    }
    decision.verdict = Verdict::Unknown;
    decision.suspects = std::mem::take(&mut decision.effects);
    decision.tie_groups.clear();
    let mse = unused.whitened_mse;
    Some(format!(
        "the naming is withdrawn: the unused conditions speak against it (score {:.1}, which a right one exceeds in 19 \
         of 20 cases at -1.6); the whitened mean square goes from {:.3} to {:.3} there",
        unused.contrast.score, mse.before, mse.after
    ))
}

/// What the reader of a diagnosis should know beside its verdict.
fn all_warnings(
    problem: &Problem,
    decision: &Decision,
    withdrawn: Option<String>,
    options: &Options,
) -> Result<Vec<String>, Error> {
    let mut warnings = problem.warnings.clone();
    warnings.extend(odd_amplitudes(problem, decision));
    warnings.extend(unseen_parameters(problem));
    warnings.extend(withdrawn);
    warnings.extend(held_parameters(problem, decision));
    warnings.extend(promises(decision));
    warnings.extend(lone_support(problem, decision, options)?);
    Ok(warnings)
}

/// Warns of amplitudes that the data want larger than is physically possible; not where runs at fitted parameters follow,
/// which end at amplitudes of their own.
fn odd_amplitudes(problem: &Problem, decision: &Decision) -> Vec<String> {
    if problem.at_fit {
        return Vec::new();
    }
    let fit = &decision.chosen;
    let amplitudes = fit.effects.iter().zip(&fit.amplitudes);
    amplitudes
        .filter_map(|(&j, a)| {
            let candidate = &problem.candidates[j];
            let mut ends = candidate.range().into_iter();
            let largest = ends.find(|end| *end != 0.0 && a == end)?.abs();
            Some(format!(
                "{} is held at its physically largest amplitude {largest}: the data ask for more",
                candidate.name
            ))
        })
        .collect()
}

/// Warns of declared parameters that move no observable: they cannot be calibrated from this.
fn unseen_parameters(problem: &Problem) -> Vec<String> {
    problem
        .declared
        .iter()
        .zip(problem.used.declared.column_iter())
        .filter(|(_, column)| column.amax() == 0.0)
        .map(|(name, _)| {
            format!(
                "the declared parameter {name} moves no observable: it cannot be calibrated here"
            )
        })
        .collect()
}

/// States which parameters the data would move beyond their limits.
fn held_parameters(problem: &Problem, decision: &Decision) -> Vec<String> {
    let held = decision.nominal.held.iter();
    held.filter(|held| problem.used.declared.column(held.parameter).amax() > 0.0)
        .map(|held| {
            let side = if held.side > 0.0 { "upper" } else { "lower" };
            format!(
                "{} is held at its {side} limit: without an effect the data would move it further",
                problem.declared[held.parameter]
            )
        })
        .collect()
}

/// Reports that runs and slopes do not agree.
fn promises(decision: &Decision) -> Option<String> {
    let at = decision
        .at_fit
        .filter(|_| decision.runs_contradict_slopes())?;
    Some(format!(
        "runs at the fitted parameters miss by more than noise (sum of squares {:.1}, p {:.1e}); by the slopes a further \
         step would leave {:.1}, which no run has shown: the runs are right",
        at.t, at.p?, decision.nominal.t
    ))
}

/// Warns when a naming falls once the condition with the largest share is left out.
fn lone_support(
    problem: &Problem,
    decision: &Decision,
    options: &Options,
) -> Result<Option<String>, Error> {
    if !matches!(decision.verdict, Verdict::Named | Verdict::Tie) {
        return Ok(None);
    }
    let Some(largest) = largest_share(problem, &decision.nominal) else {
        return Ok(None);
    };
    let rest = problem.without_condition(largest.condition_index);
    if rest.used.rows.is_empty() {
        return Ok(None);
    }
    let fit = Fit::new(&rest, &[])?;
    let gates = Gates::new(&rest, &fit, &testable(&rest, &fit), options);
    Ok((!gates.directed()).then(|| {
        format!(
            "the verdict rests on one condition ({}): without it no effect stands out; measure it again",
            largest.condition
        )
    }))
}

/// Score of the chosen effect, or of the best candidate, by each observable alone.
fn observable_support(
    problem: &Problem,
    decision: &Decision,
) -> Result<Vec<ObservableSupport>, Error> {
    let Some(&effect) = decision.effects.first().or(decision.gates.best.as_ref()) else {
        return Ok(Vec::new());
    };
    let mut support = Vec::new();
    for (k, observable) in problem.observables.iter().enumerate() {
        let alone = problem.with_observable(k);
        if alone.used.rows.is_empty() {
            continue;
        }
        support.push(ObservableSupport {
            observable: observable.clone(),
            effect: problem.candidates[effect].name.clone(),
            z: Fit::new(&alone, &[])?
                .score(effect, &problem.candidates[effect])
                .map(|s| s.z),
        });
    }
    Ok(support)
}

/// What each effect takes off the structured residual, by observable.
fn evidence(problem: &Problem, decision: &Decision) -> BTreeMap<String, Vec<Evidence>> {
    let (rows, n) = (&problem.used.rows, problem.observables.len());
    let of = |with: &Fit| {
        // The rows of the priors come last, and have a place of their own.
        let mut drops = vec![0.0; n + 1];
        let left = decision.nominal.remaining().iter().zip(with.remaining());
        for (i, (without, with)) in left.enumerate() {
            let place = rows.get(i).map_or(n, |row| row.observable);
            drops[place] += without * without - with * with;
        }
        let some = |o: usize| o < n || problem.prior.is_some();
        let named = |(o, drop): (usize, f64)| Evidence {
            observable: problem.observables.get(o).cloned(),
            drop,
        };
        drops
            .into_iter()
            .enumerate()
            .filter(|(o, _)| some(*o))
            .map(named)
            .collect()
    };
    let each = problem.candidates.iter().zip(&decision.singles);
    each.map(|(candidate, with)| (candidate.name.clone(), of(with)))
        .collect()
}

/// What each effect of the library would do.
fn candidate_results(
    problem: &Problem,
    decision: &Decision,
) -> Result<BTreeMap<String, CandidateResult>, Error> {
    let gates = &decision.gates;
    let z_detect = critical(gates).map(|z| z + normal_upper_quantile(1.0 - POWER));
    let result = |j: usize| -> Result<CandidateResult, Error> {
        let single = &decision.singles[j];
        let score = gates.scores[j].as_ref();
        let candidate = &problem.candidates[j];
        let testable = decision.testable.contains(&j);
        let reference = decision.nominal.freed_as(problem, single)?;
        let unknown = if reference.held == decision.nominal.held {
            decision.ln_factor_of_unknown
        } else {
            ln_factor_of_unknown(&reference)
        };
        let freed = reference.score(j, candidate);
        Ok(CandidateResult {
            z: score.map(|s| s.z),
            amplitude: score.map(|_| single.amplitude(j)),
            se: score.and_then(|_| single.standard_errors.first().copied()),
            absorbed_fraction: decision.nominal.absorbed_fraction(j),
            t_after: single.t,
            p_adequacy: single.p(problem),
            p_adequacy_smooth: single.smooth_test(problem).p,
            p_max_test: testable.then(|| gates.max_test.p(gates.statistic(problem, j))),
            ln_bf_unknown: freed
                .filter(|_| score.is_some())
                .map(|s| ln_factor_of_effect(s.gain, candidate.sign) - unknown),
            smallest_detectable: z_detect
                .and_then(|z| smallest_detectable(problem, &decision.nominal, j, z)),
            testable,
            unseen: (!testable).then(|| why_unseen(problem, &decision.nominal, j)),
        })
    };
    (0..problem.candidates.len())
        .map(|j| Ok((problem.candidates[j].name.clone(), result(j)?)))
        .collect()
}

/// The statistic that opens the directed gate.
fn critical(gates: &Gates) -> Option<f64> {
    (!gates.family.is_empty())
        .then(|| gates.max_test.critical(GATE))
        .filter(|z| z.is_finite())
}

/// The structured residual, undefined where the test was refused.
fn structured_residual(problem: &Problem, decision: &Decision) -> StructuredResidual {
    let tested = decision.verdict != Verdict::Refused;
    StructuredResidual {
        t0: tested.then_some(decision.nominal.t),
        df: decision.nominal.df,
        p: decision.gates.p.filter(|_| tested),
        t0_smooth: tested.then_some(decision.gates.smooth.t),
        df_smooth: decision.gates.smooth.df,
        p_smooth: decision.gates.smooth.p.filter(|_| tested),
        covariance_dof: problem.covariance_dof,
        t_at_fit: decision.at_fit.filter(|_| tested).map(|at| at.t),
        p_at_fit: decision.at_fit.filter(|_| tested).and_then(|at| at.p),
    }
}

/// Amplitudes of the effects that were taken, together, by their slopes.
fn amplitudes(problem: &Problem, decision: &Decision) -> BTreeMap<String, Amplitude> {
    let fit = &decision.chosen;
    let values = fit.amplitudes.iter().zip(&fit.standard_errors);
    let effects = fit.effects.iter().zip(values);
    let dof = problem.covariance_dof.unwrap_or(KNOWN);
    let quantile = t_two_sided_quantile(0.05, dof).unwrap_or(f64::INFINITY);
    let amplitude = |(&j, (&value, se)): (&usize, (&f64, &f64))| {
        let candidate = &problem.candidates[j];
        let [low, high] = candidate.range();
        let end = |times: f64| (value + times * se).max(low).min(high);
        let interval95 = [end(-quantile), end(quantile)];
        (candidate.name.clone(), Amplitude { value, interval95 })
    };
    effects.map(amplitude).collect()
}

/// Known data of the declared parameters.
fn declared_results(problem: &Problem, decision: &Decision) -> BTreeMap<String, DeclaredResult> {
    let covariance = decision.chosen.parameter_covariance();
    let error = |k: usize| covariance[(k, k)].sqrt();
    let held = |fit: &Fit, k: usize| fit.held.iter().find(|h| h.parameter == k).copied();
    let without = decision.nominal.parameter_covariance();
    let of = |k: usize| DeclaredResult {
        se_without: held(&decision.nominal, k)
            .is_none()
            .then(|| without[(k, k)].sqrt()),
        se: held(&decision.chosen, k).is_none().then(|| error(k)),
        held: held(&decision.nominal, k).map(|h| {
            if h.side > 0.0 {
                Limit::Upper
            } else {
                Limit::Lower
            }
        }),
        correlation: (0..problem.declared.len())
            .filter(|&i| i != k)
            .map(|i| {
                let both = (error(i) * error(k)).max(f64::MIN_POSITIVE);
                (problem.declared[i].clone(), covariance[(i, k)] / both)
            })
            .collect(),
    };
    (0..problem.declared.len())
        .map(|k| (problem.declared[k].clone(), of(k)))
        .collect()
}

/// Re-tuning of the declared parameters with the chosen effects on.
fn retuning(problem: &Problem, decision: &Decision) -> BTreeMap<String, f64> {
    problem
        .declared
        .iter()
        .cloned()
        .zip(decision.chosen.shift.iter().copied())
        .collect()
}

/// The condition with the largest share of the structured residual.
fn largest_share(problem: &Problem, nominal: &Fit) -> Option<ConditionShare> {
    let shares = nominal.shares(problem);
    let (index, share) = shares
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))?;
    Some(ConditionShare {
        condition_index: index,
        condition: problem.used.label(index),
        share: *share,
    })
}
