//! The verdict in plain language, with what remains open.

use input::quantity::significant;
use std::fmt::Write as _;

use crate::diagnosis::decision::LN_FACTOR_TO_NAME;
use crate::diagnosis::outcome::{Diagnosis, Verdict};
use crate::diagnosis::refits::odds;

/// Puts a diagnosis into sentences.
pub(crate) fn summary(d: &Diagnosis) -> String {
    let mut text = match d.verdict {
        Verdict::None => none(d),
        Verdict::Named => named(d),
        Verdict::Tie => tie(d),
        Verdict::Unknown => unknown(d),
        Verdict::Recheck => format!(
            "The residual is more than noise, and one condition carries it: {}. Measure it \
             again before any effect is looked for.",
            d.recheck_condition.as_deref().unwrap_or("not known")
        ),
        Verdict::NotTestable => format!(
            "Nothing can be said about {}: even at the largest physical amplitude re-tuning the \
             declared parameters hides the effect, or it is smaller than the noise. This is not \
             a sign that it is absent.",
            listed(&d.not_testable, "and")
        ),
        Verdict::Refused => "The observations are not more than the declared parameters: \
             re-tuning absorbs any residual, so that no missing effect can be tested."
            .to_owned(),
    };
    if d.verdict != Verdict::NotTestable && !d.not_testable.is_empty() {
        append(
            &mut text,
            format_args!(
                " Nothing can be said about {}, which could not be seen here.",
                listed(&d.not_testable, "and")
            ),
        );
    }
    if let Some(advice) = d.advice() {
        append(&mut text, format_args!(" Next: {advice}."));
    }
    text
}

fn append(text: &mut String, sentence: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(sentence);
}

/// Nothing stands out.
fn none(d: &Diagnosis) -> String {
    let smallest: Vec<String> = d
        .candidates
        .iter()
        .filter(|(_, c)| c.testable)
        .filter_map(|(name, c)| {
            c.smallest_detectable
                .map(|a| format!("{name} {}", significant(a, 3)))
        })
        .collect();
    let mut text = "No missing effect at this precision: the residual is no more than noise and \
                    re-tuning."
        .to_owned();
    if !smallest.is_empty() {
        append(
            &mut text,
            format_args!(
                " Smaller effects may still be there; amplitudes that would have been seen in 9 of \
             10 cases: {}.",
                smallest.join(", ")
            ),
        );
    }
    text
}

fn named(d: &Diagnosis) -> String {
    // Amplitudes of one fit: an effect that is named beside another has its own share only there.
    let amplitudes: Vec<String> = d
        .effects
        .iter()
        .map(|name| match d.amplitudes.get(name) {
            Some(amplitude) => format!("{name} with amplitude {amplitude}"),
            None => name.clone(),
        })
        .collect();
    let verb = if d.effects.len() == 1 { "is" } else { "are" };
    let others = match d.best_rival().map(|r| (&r.effects, r.ln_odds_of_best)) {
        Some((rival, Some(ln))) => format!(
            "real runs explain the residual better so than with {}, by odds of {}",
            listed(rival, "and"),
            odds(ln)
        ),
        _ => "by the slopes no other effect of the library does nearly as well".to_owned(),
    };
    let predicted = d.before_after.as_ref().and_then(|b| b.unused.as_ref());
    let predicted = predicted.map(|u| [u.whitened_mse.before, u.whitened_mse.after]);
    let (by, last_word) = if d.runs_on_unused.is_some() {
        (" by real runs", "")
    } else {
        (
            "",
            "; a simulator run with it switched on has the last word",
        )
    };
    let check = match d.runs_on_unused.or(predicted) {
        Some([before, after]) => format!(
            "; on the unused conditions the whitened mean square falls{by} from {before:.2} to \
             {after:.2} (noise alone: 1)"
        ),
        None => "; no unused conditions were given to check it".to_owned(),
    };
    format!(
        "{} {verb} missing: {others}, what remains is noise, and an unknown effect is far less likely{check}. The \
         library may lack the true cause{last_word}.",
        listed(&amplitudes, "and")
    )
}

/// One of several effects.
fn tie(d: &Diagnosis) -> String {
    let mut text = format!(
        "One of {} is missing, and these data cannot tell which: each of them explains the \
         residual nearly as well as the others.",
        listed(&d.effects, "or")
    );
    if let Some([before, after]) = d.runs_on_unused {
        append(
            &mut text,
            format_args!(
                " With the best of them that remains, the whitened mean square on the unused conditions \
                 falls by real runs from {before:.2} to {after:.2} (noise alone: 1)."
            ),
        );
    }
    text
}

/// Something outside the library.
fn unknown(d: &Diagnosis) -> String {
    if d.suspects.is_empty() {
        return "Something is missing that is none of the effects of the library: the residual \
                is more than noise, and no candidate stands out."
            .to_owned();
    }
    let suspects = listed(&d.suspects, "or");
    let of = d.suspects.iter().filter_map(|name| d.candidates.get(name));
    let best = of
        .filter_map(|c| c.ln_bf_unknown)
        .fold(f64::NEG_INFINITY, f64::max);
    if 0.0 < best && best < LN_FACTOR_TO_NAME {
        return format!(
            "Something is missing, but it cannot be named: {suspects} would help. The best of them explains the residual {} \
             times as well as an effect that is not in the library, and a name needs {:.0} times.",
            significant(best.exp(), 2),
            LN_FACTOR_TO_NAME.exp()
        );
    }
    if best > 0.0 {
        return format!(
            "Something is missing, but it cannot be named: {suspects} would help, and none of them is shown to explain all \
             of it."
        );
    }
    format!(
        "Something is missing, but it cannot be named: {suspects} would help, and an effect that is not \
         in the library explains the residual as well or better."
    )
}

/// `a, b and c`.
pub(crate) fn listed(names: &[String], last: &str) -> String {
    match names {
        [] => "no effect".to_owned(),
        [one] => one.clone(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}
