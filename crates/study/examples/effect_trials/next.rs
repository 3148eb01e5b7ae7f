//! What the measurement that a diagnosis recommends tells once it is made.

use crate::goals::share;
use crate::outcome::{Outcome, Told, Work};
use inference::{CandidateMeasurement, ResidualStudy};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What the page shows.
const HEAD: &str = "# The next measurement, by the solver

A laboratory has one drum, filmed at one speed, and a sled; a second speed is kept aside
([study](../../fixtures/cotton/next-trials.toml)). One effect of the library is hidden, as on the page of the
[campaigns](campaigns.md), at 2 and 4 times the smallest visible amplitude. Where the answer is a tie or `unknown`, the
first measurement that it recommends of four (another filling, another speed, a heap, a tilted plate) is made with other
seeds and noise of reading, and all is diagnosed again. `A plan would do`: the answer said that this measurement, alone or
with others on offer, makes the separation of the effects in question as large as a name needs. `Too little`: it said that
nothing on offer does.
";

/// What an answer expects of the measurement that it recommends: what it should tell apart or show is then as clear as a
/// name needs, alone or with those that follow it in the plan, or not even with all that is on offer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Expected {
    /// It would do alone.
    Alone,
    /// The plan would do.
    WithOthers,
    /// Nothing on offer would do.
    TooLittle,
}

/// A campaign with one more measurement.
pub(crate) struct Next {
    /// What was measured.
    pub(crate) measured: String,
    /// What the answer expected of it.
    pub(crate) expected: Expected,
    /// The answer without it, and its number of effects.
    pub(crate) before: (Option<Told>, usize),
    /// The campaign with it.
    pub(crate) then: Outcome,
}

impl Next {
    /// Whether the first answer was a tie, and whether the truth was in it.
    fn was_tie(&self, with_truth: bool) -> bool {
        match self.before {
            (Some(Told::SmallTie | Told::LargeTie), _) => with_truth,
            (Some(Told::False), effects) => !with_truth && effects > 1,
            _ => false,
        }
    }

    /// Whether the answer expected that what is on offer would do, this measurement first.
    fn has_plan(&self) -> bool {
        self.expected != Expected::TooLittle
    }

    /// Whether the first answer gave no name.
    fn was_unknown(&self) -> bool {
        self.before.0 == Some(Told::Unknown)
    }

    /// Whether the second answer is a tie with the truth.
    fn is_tie(&self) -> bool {
        matches!(self.then.told(), Some(Told::SmallTie | Told::LargeTie))
    }

    /// Number of effects of the second answer.
    fn effects(&self) -> usize {
        self.then.study().map_or(0, |s| s.diagnosis.effects.len())
    }
}

/// Whether a campaign with something hidden leaves a question.
fn is_open(outcome: &Outcome) -> bool {
    let hidden = outcome.hidden.effect.is_some();
    let study = outcome.study().filter(|_| hidden);
    study.is_some_and(|s| s.diagnosis.effects.len() > 1 || outcome.told() == Some(Told::Unknown))
}

/// What a diagnosis recommends.
pub(crate) struct Recommended<'a> {
    /// The diagnosis.
    pub(crate) study: &'a ResidualStudy,
    /// The measurement.
    pub(crate) candidate: &'a CandidateMeasurement,
    /// What is expected of it.
    pub(crate) expected: Expected,
}

/// The first measurement that the diagnosis of a campaign with an open question recommends; none where it says that nothing
/// on offer helps.
pub(crate) fn recommended(outcome: &Outcome) -> Option<Recommended<'_>> {
    let study = outcome.study().filter(|_| is_open(outcome))?;
    let next = study.diagnosis.next_measurement.as_ref()?;
    let first = next.plan.first()?;
    let mut candidates = study.plan.candidates.iter();
    Some(Recommended {
        study,
        candidate: candidates.find(|c| c.name == first.experiment)?,
        expected: match next.needed {
            Some(needed) if first.criterion >= needed => Expected::Alone,
            _ if next.reached => Expected::WithOthers,
            _ => Expected::TooLittle,
        },
    })
}

/// The page in Markdown.
pub(crate) fn text(all: &[Next], outcomes: &[Outcome], work: &Work) -> String {
    let mut text = HEAD.to_owned();
    let measured = counted(all.iter().map(|next| format!("`{}`", next.measured)));
    let _ = writeln!(text, "\nMeasured next: {measured}.");
    write_rates(all, &mut text);
    let hidden = outcomes.iter().filter(|o| o.hidden.effect.is_some());
    let answered = hidden.clone().filter(|o| o.told().is_some()).count();
    let open = outcomes.iter().filter(|o| is_open(o)).count();
    let _ = write!(
        text,
        "\nOf {} campaigns {answered} gave an answer; {open} of these left a question; for {} of them a measurement was \
         recommended, which in {} would do alone. All took {} different runs and {:.0} minutes of one core.",
        hidden.count(),
        all.len(),
        all.iter()
            .filter(|next| next.expected == Expected::Alone)
            .count(),
        work.runs,
        work.core_s / 60.0,
    );
    text
}

/// The shares of ties and other questions that were resolved.
fn write_rates(all: &[Next], text: &mut String) {
    type Is = fn(&Next) -> bool;
    let is: [(&str, Is); 5] = [
        ("truth alone", |next| next.then.told() == Some(Told::Named)),
        ("smaller tie with the truth", |next| {
            next.is_tie() && next.effects() < next.before.1
        }),
        ("other tie with the truth", |next| {
            next.is_tie() && next.effects() >= next.before.1
        }),
        ("unknown, none or no answer", |next| {
            let told = next.then.told();
            matches!(told, None | Some(Told::Unknown | Told::Nothing))
        }),
        ("without the truth", |next| {
            next.then.told() == Some(Told::False)
        }),
    ];
    let before: [(&str, Is); 5] = [
        ("tie, a plan would do", |n| n.was_tie(true) && n.has_plan()),
        ("tie, too little", |n| n.was_tie(true) && !n.has_plan()),
        ("unknown, a plan would do", |n| {
            n.was_unknown() && n.has_plan()
        }),
        ("unknown, too little", |n| n.was_unknown() && !n.has_plan()),
        ("tie without the truth", |n| n.was_tie(false)),
    ];
    text.push_str("\n| then, of each first answer |");
    for (name, was) in before {
        let _ = write!(
            text,
            " {name} ({}) |",
            all.iter().filter(|n| was(n)).count()
        );
    }
    text.push_str("\n|---|--:|--:|--:|--:|--:|\n");
    for (name, is) in is {
        let _ = write!(text, "| {name} |");
        for (_, was) in before {
            let count = all.iter().filter(|n| was(n) && is(n)).count();
            let _ = write!(text, " {count} |");
        }
        text.push('\n');
    }
    let ties: Vec<&Next> = all.iter().filter(|n| n.was_tie(true)).collect();
    let of_ties = |is: Is| share(&ties.iter().map(|n| is(n)).collect::<Vec<_>>());
    let _ = writeln!(
        text,
        "\nOf the ties with the truth: {} end with the truth alone, {} without it.",
        of_ties(|n| n.then.told() == Some(Told::Named)),
        of_ties(|n| n.then.told() == Some(Told::False)),
    );
}

/// Each of these once, with how often it is there.
fn counted(each: impl Iterator<Item = String>) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for word in each {
        *counts.entry(word).or_default() += 1;
    }
    let each = counts.iter().map(|(word, n)| format!("{word} ({n})"));
    each.collect::<Vec<_>>().join(", ")
}
