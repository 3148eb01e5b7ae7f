//! The answer of a diagnosis as people ask for it: what is missing, how sure that is, and what follows.

use crate::numbers::{digits, fixed, listed, p_in_words, with_error};
use crate::residual::models;
use inference::diagnosis::{Limit, Unseen, Verdict};
use inference::{AddedEffect, ResidualStudy};

/// Distance from an end of its range, in widths of it, at which an effect lies there.
const AT_AN_END: f64 = 1e-6;

/// An answer in a sentence, and the remarks after it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// What is missing.
    pub headline: String,
    /// Questions with their answers; those without an answer are left out.
    pub lines: Vec<(&'static str, String)>,
}

/// The answer of a residual study.
pub fn answer(study: &ResidualStudy) -> Answer {
    let parameters_question = if models(study).is_empty() {
        "The fitted parameters"
    } else {
        "What it changes in the parameters"
    };
    let lines = [
        ("How sure", how_sure(study)),
        ("What it changes in the error", errors(study)),
        (parameters_question, parameters(study)),
        ("Suspects", suspects(study)),
        ("What else it could be", others(study)),
        ("Parameters at a limit", at_limits(study)),
        ("Effects at an end of their range", at_ends(study)),
        ("What could not be seen", unseen(study)),
        ("Measure next", next(study)),
    ];
    Answer {
        headline: headline(study),
        lines: lines
            .into_iter()
            .filter_map(|(question, answer)| Some((question, answer?)))
            .collect(),
    }
}

/// What is missing.
fn headline(study: &ResidualStudy) -> String {
    let d = &study.diagnosis;
    let amplitude = |name: &String| match d.amplitudes.get(name) {
        Some(amplitude) => format!("{name} with amplitude {amplitude}"),
        None => name.clone(),
    };
    let with_amplitudes = || {
        d.effects
            .iter()
            .map(amplitude)
            .collect::<Vec<_>>()
            .join(" and ")
    };
    match d.verdict {
        Verdict::None => "Nothing is missing that these measurements could show.".into(),
        Verdict::Named => format!("Missing: {}.", with_amplitudes()),
        Verdict::Tie => format!(
            "One of these is missing, and these measurements cannot tell which: {}.",
            listed(&d.effects)
        ),
        Verdict::Unknown if d.suspects.is_empty() => {
            "Something is missing that is none of the effects of the library.".into()
        }
        Verdict::Unknown => "Something is missing, and cannot be named.".into(),
        Verdict::Recheck => format!(
            "One condition carries the whole residual; measure it again: {}.",
            d.recheck_condition.as_deref().unwrap_or("not known")
        ),
        Verdict::NotTestable => {
            "No effect of the library could be seen by these measurements.".into()
        }
        Verdict::Refused => {
            "The measurements are not more than the parameters: nothing can be tested.".into()
        }
    }
}

/// The chance of the residual by noise, and the odds of what is named over the best rival that real runs have fitted again.
fn how_sure(study: &ResidualStudy) -> Option<String> {
    let d = &study.diagnosis;
    let noise = d.structured_residual.p?;
    let mut parts = vec![format!(
        "so large a residual by noise alone: {}",
        p_in_words(Some(noise))
    )];
    if let (Verdict::Named | Verdict::Tie, Some(best)) = (d.verdict, d.refits.first()) {
        let named = best.effects.join(" and ");
        parts.push(format!(
            "what {named} leaves by noise: {}",
            p_in_words(best.p)
        ));
        let over = |rival: &inference::diagnosis::Refit| {
            let odds = inference::diagnosis::odds(rival.ln_odds_of_best?);
            Some(format!(
                "{named} over {}, by real runs of both: odds of {odds}",
                rival.effects.join(" and ")
            ))
        };
        parts.extend(d.refits.iter().skip(1).filter_map(over));
    }
    Some(parts.join("; "))
}

/// Errors of real runs, without and with what was added: on the conditions kept aside, or else on those of the fit.
fn errors(study: &ResidualStudy) -> Option<String> {
    let models = models(study);
    if models.is_empty() {
        return None;
    }
    let kept = study.errors_before.kept.is_some();
    let of = |errors: &inference::ErrorPair| {
        let errors = errors
            .kept
            .as_ref()
            .filter(|_| kept)
            .unwrap_or(&errors.used);
        fixed(errors.whitened_mse, 2)
    };
    let after = |(_, model): &(String, &AddedEffect)| {
        format!("{} with {}", of(&model.errors), effects(model))
    };
    let after: Vec<String> = models.iter().map(after).collect();
    let place = if kept {
        "conditions kept aside"
    } else {
        "the conditions of the fit (none was kept aside)"
    };
    Some(format!(
        "mean square over noise at {place}, by real runs: {} without, {} (1 is noise alone)",
        of(&study.errors_before),
        after.join(", ")
    ))
}

fn effects(model: &AddedEffect) -> String {
    let names: Vec<&str> = model.effects.keys().map(String::as_str).collect();
    names.join(" and ")
}

/// Parameters without and with what was added, with their standard errors.
fn parameters(study: &ResidualStudy) -> Option<String> {
    let d = &study.diagnosis;
    let models = models(study);
    let one = |name: &String| {
        let result = d.declared.get(name);
        let before = with_error(
            *study.fitted.get(name)?,
            result.and_then(|r| r.se_without),
            "",
        );
        let after = models.iter().filter_map(|(_, model)| {
            let se = model.fitted_se.get(name).copied();
            Some(with_error(*model.fitted.get(name)?, se, ""))
        });
        let after: Vec<String> = after.collect();
        Some(if after.is_empty() {
            format!("{name} {before}")
        } else {
            format!("{name} {before} → {}", after.join(" or "))
        })
    };
    let all: Vec<String> = study
        .plan
        .parameters
        .iter()
        .filter_map(|p| one(&p.symbol))
        .collect();
    (!all.is_empty()).then(|| all.join(", "))
}

/// Effects that would help, if none is named.
fn suspects(study: &ResidualStudy) -> Option<String> {
    let d = &study.diagnosis;
    let is_unknown = d.verdict == Verdict::Unknown && !d.suspects.is_empty();
    is_unknown.then(|| {
        format!(
            "{}: by the slopes they would help; none of them is established",
            listed(&d.suspects)
        )
    })
}

/// Rivals of what is named.
fn others(study: &ResidualStudy) -> Option<String> {
    let d = &study.diagnosis;
    if d.verdict != Verdict::Named {
        return None;
    }
    let refitted = |name: &String| d.refits.iter().any(|refit| refit.effects.contains(name));
    let next = d
        .candidates
        .iter()
        .filter(|(name, c)| !refitted(name) && c.testable)
        .min_by(|a, b| a.1.t_after.total_cmp(&b.1.t_after));
    let next = next.map(|(name, c)| {
        format!(
            "of the effects that were not run again {name} comes next, and would leave a sum of squares of {} by its \
             slopes; ",
            fixed(c.t_after, 1)
        )
    });
    Some(format!(
        "{}an effect that the library lacks",
        next.unwrap_or_default()
    ))
}

/// Parameters that the data would move beyond their limits.
fn at_limits(study: &ResidualStudy) -> Option<String> {
    let held = study
        .diagnosis
        .declared
        .iter()
        .filter_map(|(name, result)| {
            let side = match result.held? {
                Limit::Lower => "lower",
                Limit::Upper => "upper",
            };
            Some(format!("{name} at its {side} one"))
        });
    let held: Vec<String> = held.collect();
    (!held.is_empty()).then(|| {
        format!(
            "{}: without an effect the data would go further",
            held.join(", ")
        )
    })
}

/// Effects whose amplitude in a model that was run is as large as their range holds.
fn at_ends(study: &ResidualStudy) -> Option<String> {
    let at_end = |(name, amplitude): (&String, &f64)| {
        let probe = study.plan.effects.iter().find(|e| e.name == *name)?;
        let [low, high] = probe.range;
        let mut ends = probe.range.into_iter().filter(|end| *end != 0.0);
        let end = ends.find(|end| (amplitude - end).abs() <= AT_AN_END * (high - low))?;
        Some(format!("{name} at {}", digits(end)))
    };
    let of_models = study.models().flat_map(|model| &model.effects);
    let mut all: Vec<String> = of_models.filter_map(at_end).collect();
    all.dedup();
    (!all.is_empty()).then(|| {
        format!(
            "{}: the data would have more. Where it can be larger, widen the range of its [[effect]] before anything else is \
             measured; where not, it is not all that is missing",
            all.join(", ")
        )
    })
}

/// Effects that could not be seen, by the reason.
fn unseen(study: &ResidualStudy) -> Option<String> {
    let of = |reason: Unseen| -> Vec<String> {
        let candidates = study.diagnosis.candidates.iter();
        let same = candidates.filter(|(_, c)| c.unseen == Some(reason));
        same.map(|(name, _)| name.clone()).collect()
    };
    let reasons = [
        (Unseen::RetuningHidesIt, "hidden by re-tuning"),
        (
            Unseen::RangeTooSmall,
            "less than the noise at their largest",
        ),
        (
            Unseen::SlopeIsNoise,
            "not known well enough, more runs would show it",
        ),
    ];
    let parts = reasons.into_iter().filter_map(|(reason, words)| {
        let names = of(reason);
        (!names.is_empty()).then(|| format!("{}: {words}", listed(&names)))
    });
    let parts: Vec<String> = parts.collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// What to measure next.
fn next(study: &ResidualStudy) -> Option<String> {
    study.diagnosis.advice()
}

#[cfg(test)]
mod tests {
    use super::answer;
    use crate::test_residual::twins;
    use inference::diagnosis::{DeclaredResult, Limit, Verdict};
    use std::collections::BTreeMap;

    /// The first screen of a named effect: what, how sure, errors, parameters, and no empty line.
    #[test]
    fn a_named_effect_comes_with_what_it_changes() {
        let mut study = twins();
        study.diagnosis.verdict = Verdict::Named;
        let told = answer(&study);
        let questions: Vec<&str> = told.lines.iter().map(|(question, _)| *question).collect();
        assert!(questions.contains(&"How sure"), "{told:?}");
        assert!(
            questions.contains(&"What it changes in the error"),
            "{told:?}"
        );
        assert!(told.lines.iter().all(|(_, text)| !text.is_empty()));
        for name in &study.diagnosis.effects {
            assert!(told.headline.contains(name.as_str()), "{told:?}");
        }
    }

    /// An effect at the end of its range is reported with that end; one inside its range is not, wherever
    /// its slope would end.
    #[test]
    fn an_effect_at_an_end_of_its_range_is_told() {
        let mut study = twins();
        let line = |study: &_| {
            let lines = answer(study).lines.into_iter();
            let mut found = lines.filter(|(q, _)| *q == "Effects at an end of their range");
            found.next().map(|(_, text)| text)
        };
        let model = study.models().next().unwrap();
        let (name, amplitude) = model.effects.first_key_value().unwrap();
        let (name, amplitude) = (name.clone(), *amplitude);
        let largest = study.plan.effects[0].range[1];
        let by_slope = study.diagnosis.candidates.get_mut(&name).unwrap();
        by_slope.amplitude = Some(largest);
        assert_eq!(line(&study), None);
        let probe = study.plan.effects.iter_mut().find(|e| e.name == name);
        probe.unwrap().range = [-amplitude, amplitude];
        let told = line(&study).unwrap();
        assert!(told.starts_with(&format!("{name} at ")), "{told}");
        assert!(told.contains("widen"), "{told}");
    }

    /// The odds that are shown are those of real runs: twins, fitted again both, are reported with odds near 1, of which the slopes and an
    /// unknown effect know nothing. If nothing is named, suspects are shown apart from the headline, with a measurement.
    #[test]
    fn odds_are_those_of_real_runs_and_suspects_are_called_that() {
        let mut study = twins();
        let sure = |study: &_| {
            let lines = answer(study).lines.into_iter();
            lines
                .filter(|(q, _)| *q == "How sure")
                .map(|(_, text)| text)
                .next()
                .unwrap()
        };
        let told = sure(&study);
        assert!(
            told.contains("bow, by real runs of both: odds of")
                || told.contains("bend, by real runs of both: odds of"),
            "{told}"
        );
        let ln = study.diagnosis.refits[1].ln_odds_of_best.unwrap();
        assert!(ln < 3.0, "{ln}");
        study.diagnosis.verdict = Verdict::Unknown;
        study.diagnosis.suspects = std::mem::take(&mut study.diagnosis.effects);
        let told = answer(&study);
        for name in &study.diagnosis.suspects {
            assert!(!told.headline.contains(name.as_str()), "{told:?}");
        }
        let asked = |question| told.lines.iter().any(|(q, _)| *q == question);
        assert!(asked("Suspects") && asked("Measure next"), "{told:?}");
        assert!(!sure(&study).contains("odds"), "{told:?}");
    }

    /// A parameter at a limit is on the first screen.
    #[test]
    fn a_parameter_at_a_limit_is_told() {
        let mut study = twins();
        let result = DeclaredResult {
            se: None,
            se_without: None,
            held: Some(Limit::Upper),
            correlation: BTreeMap::new(),
        };
        study.diagnosis.declared.insert("mu".into(), result);
        let told = answer(&study);
        let line = told
            .lines
            .iter()
            .find(|(q, _)| *q == "Parameters at a limit");
        assert!(line.unwrap().1.contains("mu at its upper one"));
    }
}
