//! What came out of one campaign, and what an ideal rule could have told.

use crate::AnyError;
use crate::laboratory::Hidden;
use campaign::run_store::{Lookup, Store};
use inference::diagnosis::{Ideal, Problem, Verdict, ideal};
use inference::{AddedEffect, ErrorPair, ResidualStudy};
use simulators::scene_simulator::RunDetails;

/// Draws behind the share of an ideal rule: right within 2.5 %.
const DRAWS: usize = 400;
/// Most effects of a tie that still says something.
const SMALL_TIE: usize = 3;

/// What the answer says of the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Told {
    /// Nothing is missing.
    Nothing,
    /// Something is missing, and no name is given.
    Unknown,
    /// The truth alone.
    Named,
    /// The truth in a tie of at most three.
    SmallTie,
    /// The truth in a larger tie.
    LargeTie,
    /// Names, the truth not among them.
    False,
}

impl Told {
    /// In a word.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Nothing => "none",
            Self::Unknown => "unknown",
            Self::Named => "named",
            Self::SmallTie => "tie of 2 or 3",
            Self::LargeTie => "larger tie",
            Self::False => "false",
        }
    }

    /// Whether it is the truth, alone or with at most two others.
    pub(crate) fn is_right(self) -> bool {
        matches!(self, Self::Named | Self::SmallTie)
    }
}

/// One campaign.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// What was hidden.
    pub(crate) hidden: Hidden,
    /// Its diagnosis, or why it could not be made.
    result: Result<Box<ResidualStudy>, String>,
    /// What an ideal rule could tell; none where nothing was hidden.
    pub(crate) ideal: Option<Ideal>,
    /// Runs that it asked for, those found again too.
    pub(crate) runs: usize,
}

impl Outcome {
    /// Asks what an ideal rule could have told.
    pub(crate) fn new(
        hidden: Hidden,
        result: Result<ResidualStudy, String>,
        runs: usize,
    ) -> Result<Self, AnyError> {
        let ideal = match (&hidden.effect, &result) {
            (Some((name, amplitude)), Ok(study)) => {
                let problem = Problem::try_from(study.problem.clone())?;
                let known = problem.library().contains(&name.as_str());
                known
                    .then(|| ideal(&problem, name, *amplitude, DRAWS, hidden.number))
                    .transpose()?
            }
            _ => None,
        };
        Ok(Self {
            hidden,
            result: result.map(Box::new),
            ideal,
            runs,
        })
    }

    /// The diagnosis; none where it could not be made.
    pub(crate) fn study(&self) -> Option<&ResidualStudy> {
        self.result.as_deref().ok()
    }

    /// Why it could not be made.
    pub(crate) fn failure(&self) -> Option<&str> {
        self.result.as_ref().err().map(String::as_str)
    }

    /// What the answer says of the truth; none where there is no answer.
    pub(crate) fn told(&self) -> Option<Told> {
        let diagnosis = &self.study()?.diagnosis;
        let truth = self.hidden.effect.as_ref().map(|(name, _)| name);
        Some(match diagnosis.verdict {
            Verdict::None | Verdict::NotTestable | Verdict::Refused => Told::Nothing,
            Verdict::Unknown | Verdict::Recheck => Told::Unknown,
            Verdict::Named | Verdict::Tie => {
                let holds = truth.is_some_and(|name| diagnosis.effects.contains(name));
                match diagnosis.effects.len() {
                    _ if !holds => Told::False,
                    1 => Told::Named,
                    2..=SMALL_TIE => Told::SmallTie,
                    _ => Told::LargeTie,
                }
            }
        })
    }

    /// The amplitude found for the hidden effect, where a model with it was run.
    pub(crate) fn amplitude_found(&self) -> Option<f64> {
        let (truth, _) = self.hidden.effect.as_ref()?;
        let mut models = self.study()?.models();
        models.find_map(|model| model.effects.get(truth).copied())
    }

    /// Whitened mean square on the conditions kept aside, without an effect, and with the best explanation where the
    /// answer has one.
    pub(crate) fn kept(&self) -> Option<(f64, Option<f64>)> {
        let study = self.study()?;
        let of = |errors: &ErrorPair| errors.kept.as_ref().map(|kept| kept.whitened_mse);
        let named = matches!(study.diagnosis.verdict, Verdict::Named | Verdict::Tie);
        let best: Option<&AddedEffect> = study.models().next().filter(|_| named);
        Some((of(&study.errors_before)?, best.and_then(|m| of(&m.errors))))
    }

    /// The campaign in one line, for who waits.
    pub(crate) fn line(&self) -> String {
        let hidden = match &self.hidden.effect {
            Some((name, amplitude)) => format!("{name} {amplitude:.3}"),
            None => "nothing".into(),
        };
        let told = match self.told() {
            Some(told) => told.word(),
            None => self.failure().unwrap_or("no answer"),
        };
        let effects = self.study().map(|s| s.diagnosis.effects.join(", "));
        format!("{hidden}: {told} [{}]", effects.unwrap_or_default())
    }
}

/// What all runs took.
#[derive(Debug)]
pub(crate) struct Work {
    /// Different runs in the folder.
    pub(crate) runs: usize,
    /// Time of one core that they took, s.
    pub(crate) core_s: f64,
}

impl Work {
    /// Sums up the records of a folder.
    pub(crate) fn of(store: &Store) -> Result<Self, AnyError> {
        let (mut runs, mut core_s) = (0, 0.0);
        for key in store.keys()? {
            if let Lookup::Found(record) = store.get(&key)? {
                let timing = RunDetails::of(&record)?.timing;
                runs += 1;
                core_s += timing.cpu_s.unwrap_or(timing.wall_s);
            }
        }
        Ok(Self { runs, core_s })
    }

    /// Mean time of one core that a run takes, s.
    pub(crate) fn core_s_of_run(&self) -> f64 {
        self.core_s / self.runs.max(1) as f64
    }
}
