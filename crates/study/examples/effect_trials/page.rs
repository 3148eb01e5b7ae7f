//! The page: the goals, and what cannot be told; and every campaign by effect and size.

use crate::goals;
use crate::outcome::{Outcome, Told, Work};
use inference::ResidualStudy;
use inference::diagnosis::{CandidateResult, Unseen};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// What the page shows.
const HEAD: &str = "# Every effect hidden, by the solver

Data as measured, by the solver: drums at several speeds and fills, two heaps, a sled and a tilted plate
([study](../../fixtures/cotton/trials.toml)). One effect is on wherever a scene can carry it; frictions are drawn from
their bench values. The diagnosis knows the study alone and searches the whole library by its own simulations, with
other seeds. One drum and one heap are kept aside. All rows share the runs for the first sensitivities, and their noise.

`size`: the hidden amplitude over the smallest one that these measurements show with a chance of 90 % (linear model
about the start); effects that cannot reach half of it within what is physically possible are left out. `ideal`: what a
rule could tell that knew the truth's direction, by the linear problem of each campaign. Slopes are exact and effects
proportional there, so that this bound is generous. `rows.md` in the folder of the runs has every campaign.
";

/// What the table of all campaigns shows.
const TABLE_HEAD: &str = "`answer`: the truth named, in a tie (number of effects), another name (`false`), `unknown`, or `none`, for \
each truth in turn. `kept`: whitened mean square on what is kept aside, by real runs, before and after the best explanation; 1 is noise.

| hidden | size | amplitude: hidden, found | answer | kept: before -> after |
|---|--:|---|---|---|
";

/// Bound below which the likelihood errs in more than one case of six.
const HARD_TO_TELL: f64 = 2.0;

/// All that the page shows.
pub(crate) struct Page {
    /// Campaigns.
    pub(crate) outcomes: Vec<Outcome>,
    /// Campaigns for which there was no time.
    pub(crate) not_begun: usize,
    /// Effects whose probes could not be run; the file of each diagnosis tells why.
    left_out: Vec<String>,
    /// Effects that no scene can carry, with the reason.
    not_applicable: BTreeMap<String, String>,
    /// Number of effects of the library.
    library: usize,
    /// Effects that cannot be seen, with the reason.
    unseen: BTreeMap<String, String>,
    /// Effects that cannot reach half of a size, with the most that they reach.
    weak: BTreeMap<String, f64>,
}

impl Page {
    /// An empty page.
    pub(crate) fn new(not_applicable: &BTreeMap<String, String>, first: &ResidualStudy) -> Self {
        Self {
            outcomes: Vec::new(),
            not_begun: 0,
            library: first.plan.effects.len() + first.left_out.len() + not_applicable.len(),
            left_out: first.left_out.keys().cloned().collect(),
            not_applicable: not_applicable.clone(),
            unseen: BTreeMap::new(),
            weak: BTreeMap::new(),
        }
    }

    /// Notes an effect that cannot be seen at its largest amplitude.
    pub(crate) fn note_unseen(&mut self, name: &str, candidate: &CandidateResult) {
        let why = match candidate.unseen {
            Some(Unseen::RetuningHidesIt) => "re-tuning hides it",
            Some(Unseen::RangeTooSmall) => "its largest amplitude does less than the noise",
            Some(Unseen::SlopeIsNoise) => "its slope is noise",
            None => "not testable",
        };
        self.unseen.insert(name.to_owned(), why.to_owned());
    }

    /// Notes an effect that leaves every scene as it is.
    pub(crate) fn note_unchanged(&mut self, name: &str, amplitude: f64) {
        let why = format!("{amplitude:.3} changes no scene");
        self.unseen.insert(name.to_owned(), why);
    }

    /// Notes an effect that cannot reach half of a size.
    pub(crate) fn note_weak(&mut self, name: &str, reached: f64) {
        let most = self.weak.entry(name.to_owned()).or_default();
        *most = most.max(reached);
    }

    /// The page in Markdown.
    pub(crate) fn text(&self, work: &Work) -> String {
        let mut text = format!("{HEAD}\n");
        self.write_coverage(&mut text);
        self.write_nothing(&mut text);
        goals::write(&self.outcomes, &mut text);
        self.write_limits(&mut text);
        self.write_work(&mut text, work);
        text
    }

    /// All campaigns, one row for each effect and size.
    pub(crate) fn table(&self) -> String {
        let mut text = TABLE_HEAD.to_owned();
        let mut rows: BTreeMap<(&str, u64), Vec<&Outcome>> = BTreeMap::new();
        for outcome in &self.outcomes {
            if let Some((name, _)) = &outcome.hidden.effect {
                let size = crate::tenths(outcome.hidden.size);
                rows.entry((name, size)).or_default().push(outcome);
            }
        }
        for ((name, _), row) in rows {
            let sizes = unique(row.iter().map(|o| format!("{:.1}", o.hidden.reached)));
            let hidden = |o: &Outcome| o.hidden.effect.as_ref().map_or(0.0, |(_, a)| *a);
            let amplitudes = row.iter().map(|o| match o.amplitude_found() {
                Some(found) => format!("{:.3}, {found:.3}", hidden(o)),
                None => format!("{:.3}, -", hidden(o)),
            });
            let kept = row.iter().map(|o| match o.kept() {
                Some((before, Some(after))) => format!("{before:.1} -> {after:.1}"),
                Some((before, None)) => format!("{before:.1}"),
                None => String::new(),
            });
            let _ = writeln!(
                text,
                "| {name} | {sizes} | {} | {} | {} |",
                join(amplitudes),
                join(row.iter().map(|o| answer(o))),
                join(kept),
            );
        }
        text
    }

    /// How many effects the rates are made of.
    fn write_coverage(&self, text: &mut String) {
        let names = |size: f64, answered: bool| {
            let of_size = goals::of_size(&self.outcomes, size).into_iter();
            let of_size = of_size.filter(|o| !answered || o.told().is_some());
            let names = of_size.filter_map(|o| Some(&o.hidden.effect.as_ref()?.0));
            names.collect::<BTreeSet<_>>().len()
        };
        let _ = writeln!(text, "Of the {} effects of the library:", self.library);
        for size in crate::SIZES {
            let (hidden, answered) = (names(size, false), names(size, true));
            let _ = writeln!(
                text,
                "- {hidden} could be hidden at size {size:.0}, and {answered} of these gave an answer."
            );
        }
        text.push_str("\nThe rates below are of these alone.\n");
    }

    /// Campaigns with nothing hidden, in words.
    fn write_nothing(&self, text: &mut String) {
        let nothing = self.outcomes.iter().filter(|o| o.hidden.effect.is_none());
        let answers: Vec<String> = nothing.map(answer).collect();
        let quiet = answers.iter().filter(|a| *a == "none").count();
        let others: Vec<&String> = answers.iter().filter(|a| *a != "none").collect();
        let _ = write!(
            text,
            "\nNothing hidden, {} campaigns: none in {quiet}",
            answers.len()
        );
        for other in others {
            let _ = write!(text, ", {other}");
        }
        text.push_str(".\n");
        if self.not_begun > 0 {
            let _ = writeln!(
                text,
                "\nNot begun, for lack of time: {} campaigns.",
                self.not_begun
            );
        }
    }

    /// What cannot be told, and why.
    fn write_limits(&self, text: &mut String) {
        let reasons = |map: &BTreeMap<String, String>| {
            // What follows the first clause is detail.
            let mut names: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
            for (name, why) in map {
                let first = why.split(';').next().unwrap_or_default();
                names.entry(first).or_default().push(name);
            }
            let each = names
                .into_iter()
                .map(|(why, names)| format!("{} ({why})", names.join(", ")));
            list(&each.collect::<Vec<_>>())
        };
        let hard = self.outcomes.iter().filter_map(|o| {
            let (name, _) = o.hidden.effect.as_ref()?;
            let ideal = o.ideal.as_ref()?;
            let left = ideal.separation.filter(|left| *left < HARD_TO_TELL)?;
            let rival = ideal.nearest.as_ref()?;
            let strong = (o.hidden.size - crate::SIZES[crate::SIZES.len() - 1]).abs() < 0.01;
            strong.then(|| (format!("{name} as {rival}"), left))
        });
        let hard: BTreeMap<String, String> = hard
            .map(|(pair, left)| (pair, format!("{left:.1}")))
            .collect();
        let failed = self.outcomes.iter().filter_map(|o| {
            let (name, amplitude) = o.hidden.effect.as_ref()?;
            Some((format!("{name} {amplitude:.3}"), o.failure()?.to_owned()))
        });
        let failed: BTreeMap<String, String> = failed.collect();
        let weak = self.weak.iter().filter(|(name, _)| {
            let hides = |o: &Outcome| o.hidden.effect.as_ref().is_some_and(|(n, _)| n == *name);
            let largest = |o: &Outcome| o.hidden.size >= crate::SIZES[crate::SIZES.len() - 1];
            !self.outcomes.iter().any(|o| hides(o) && largest(o))
        });
        let weak = weak.map(|(name, most)| format!("{name} ({most:.1})"));
        let _ = write!(
            text,
            "\n## What cannot be told\n\n\
             At the largest size these leave less than \
             {HARD_TO_TELL:.0} standard deviations of each other: {}.\n\n\
             Not seen even at their largest amplitude: {}.\n\n\
             Largest possible amplitude below half of the largest size (its size): {}.\n\n\
             Carried by no scene: {}.\n\n\
             Left out of the library, as their probes fail: {}.\n\n\
             Hidden amplitudes that could not be run or diagnosed: {}.\n",
            reasons(&hard),
            reasons(&self.unseen),
            list(&weak.collect::<Vec<_>>()),
            reasons(&self.not_applicable),
            list(&self.left_out),
            reasons(&failed),
        );
    }

    /// Runs and time.
    fn write_work(&self, text: &mut String, work: &Work) {
        let with = |hidden: bool| {
            let of = self.outcomes.iter();
            let of = of.filter(|o| o.hidden.effect.is_some() == hidden && o.failure().is_none());
            let runs: Vec<f64> = of.map(|o| o.runs as f64).collect();
            runs.iter().sum::<f64>() / runs.len().max(1) as f64
        };
        let minutes = |runs: f64| runs * work.core_s_of_run() / 60.0;
        let _ = write!(
            text,
            "\n## Cost\n\nA diagnosis asks for {:.0} runs where something is hidden and {:.0} where nothing is, those of \
             the laboratory and of the common sensitivities included: {:.1} and {:.1} minutes of the clock at {:.2} s a run. All \
             campaigns together took {} different runs and {:.0} such minutes.",
            with(true),
            with(false),
            minutes(with(true)),
            minutes(with(false)),
            work.core_s_of_run(),
            work.runs,
            work.core_s / 60.0,
        );
    }
}

/// The answer of a campaign in words.
pub(crate) fn answer(outcome: &Outcome) -> String {
    let Some(told) = outcome.told() else {
        return "no answer".into();
    };
    let effects = outcome.study().map(|s| s.diagnosis.effects.as_slice());
    let effects = effects.unwrap_or_default();
    match told {
        Told::LargeTie => format!("tie of {}", effects.len()),
        Told::False => format!("false: {}", effects.join(", ")),
        Told::SmallTie => format!("tie: {}", effects.join(", ")),
        _ => told.word().into(),
    }
}

/// A chance in percent.
pub(crate) fn percent(p: f64) -> String {
    format!("{:.0} %", 100.0 * p)
}

/// Replicates in one cell.
fn join(each: impl Iterator<Item = String>) -> String {
    each.collect::<Vec<_>>().join(" / ")
}

/// The same, once where all are alike.
fn unique(each: impl Iterator<Item = String>) -> String {
    let mut all: Vec<String> = each.collect();
    all.dedup();
    all.join(" / ")
}

/// Words with commas, or "none".
fn list(words: &[String]) -> String {
    if words.is_empty() {
        "none".into()
    } else {
        words.join(", ")
    }
}
