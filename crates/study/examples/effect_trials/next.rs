//! What the measurement that a diagnosis recommends tells once it is made.

use crate::goals::share;
use crate::outcome::{Outcome, Told};
use crate::page::answer;
use calibration::{CandidateMeasurement, ResidualStudy};
use std::fmt::Write as _;

/// A campaign with one more measurement.
pub(crate) struct Next {
    /// What was measured.
    pub(crate) measured: String,
    /// The answer without it, and its number of effects.
    pub(crate) before: (Option<Told>, usize),
    /// The campaign with it.
    pub(crate) then: Outcome,
}

/// The diagnosis of a campaign that leaves a question, and the first measurement that it recommends; none where nothing is
/// hidden.
pub(crate) fn open_question(outcome: &Outcome) -> Option<(&ResidualStudy, &CandidateMeasurement)> {
    let study = outcome
        .study()
        .filter(|_| outcome.hidden.effect.is_some())?;
    let next = study.diagnosis.next_measurement.as_ref()?;
    let first = next.plan.first().or(next.ranked.first())?;
    let mut candidates = study.plan.candidates.iter();
    Some((study, candidates.find(|c| c.name == first.experiment)?))
}

/// Writes each campaign that was followed, and what became of the ties and of the others.
pub(crate) fn write(all: &[Next], text: &mut String) {
    if all.is_empty() {
        return;
    }
    text.push_str(
        "\n## The next measurement\n\nWhere a question is left, the first measurement that the answer recommends is made, \
         with other seeds and noise of reading, and all is diagnosed again.\n\n\
         | hidden | size | answer | measured next | answer then |\n|---|--:|---|---|---|\n",
    );
    for next in all {
        let name = next
            .then
            .hidden
            .effect
            .as_ref()
            .map_or("", |(name, _)| name);
        let (told, effects) = next.before;
        let before = match told {
            Some(Told::SmallTie | Told::LargeTie) => format!("tie of {effects}"),
            told => told.map_or("no answer", Told::word).into(),
        };
        let _ = writeln!(
            text,
            "| {name} | {:.1} | {before} | {} | {} |",
            next.then.hidden.reached,
            next.measured,
            answer(&next.then),
        );
    }
    let tied = |next: &&Next| matches!(next.before.0, Some(Told::SmallTie | Told::LargeTie));
    let ties: Vec<&Next> = all.iter().filter(tied).collect();
    let others: Vec<&Next> = all.iter().filter(|next| !tied(next)).collect();
    let part = |of: &[&Next], is: &dyn Fn(&Next) -> bool| {
        share(&of.iter().map(|next| is(next)).collect::<Vec<_>>())
    };
    let told = |next: &Next, told: Told| next.then.told() == Some(told);
    let fewer = |next: &Next| {
        let effects = next.then.study().map_or(0, |s| s.diagnosis.effects.len());
        told(next, Told::SmallTie) && effects < next.before.1
    };
    let _ = write!(
        text,
        "\nOf the ties: resolved rightly {}, narrowed with the truth {}, without the truth {}. Of the other answers: named or \
         tied rightly {}, falsely {}.\n",
        part(&ties, &|next| told(next, Told::Named)),
        part(&ties, &fewer),
        part(&ties, &|next| told(next, Told::False)),
        part(&others, &|next| next
            .then
            .told()
            .is_some_and(Told::is_right)),
        part(&others, &|next| told(next, Told::False)),
    );
}
