//! Which experiment would break a tie, free an absorbed effect, or settle the parameters.

use serde::Serialize;

use crate::diagnosis::Error;
use crate::diagnosis::outcome::{Diagnosis, Unseen, Verdict};
use crate::diagnosis::problem::{Experiment, Problem};
use crate::diagnosis::summary::{listed, summary};
use crate::diagnosis::telling_rows::{Pair, Rows};

/// Separation at which two effects are distinguished nearly always: P(wrong) = Phi(-2).
pub(crate) const SEPARATION_TO_REACH: f64 = 4.0;
/// Expected score from which an effect counts as one that can be seen.
const SCORE_TO_SEE: f64 = 3.0;
/// Expected score from which a naming can be expected if nothing in the library looks alike (docs/trials.md).
const SCORE_TO_NAME: f64 = 6.0;
/// Longest plan; more of the same seldom helps.
const LONGEST_PLAN: usize = 6;

/// Purpose of an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// Tell the members of the tie set apart (T-optimality).
    BreakTie,
    /// Tell the suspects of an unknown cause apart (T-optimality).
    TellSuspects,
    /// See the only suspect of an unknown cause better (D_s-optimality).
    SeeSuspect,
    /// See an effect that re-tuning can imitate (D_s-optimality).
    FreeEffect,
    /// Have more observations than parameters (D-optimality).
    SettleParameters,
}

/// The experiment that helps most, and how far it leads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextMeasurement {
    /// Its purpose.
    pub purpose: Purpose,
    /// The effects concerned.
    pub effects: Vec<String>,
    /// The experiments to do, the most helpful first (for its cost, given those before it).
    pub plan: Vec<PlannedExperiment>,
    /// All experiments on offer, each alone with what there is, the most helpful for its cost first.
    pub ranked: Vec<PlannedExperiment>,
    /// Criterion before any of them: smallest separation of two effects, detectability of
    /// the effect, or ln det of the parameters' information.
    pub now: f64,
    /// Value of the criterion that would do; none for the parameters.
    pub needed: Option<f64>,
    /// Whether the plan reaches it.
    pub reached: bool,
    /// Advice, as a sentence.
    pub advice: String,
}

/// An experiment of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedExperiment {
    /// Its name.
    pub experiment: String,
    /// Its cost.
    pub cost: f64,
    /// Criterion once it, and in a plan those before it, are done.
    pub criterion: f64,
}

/// An effect that an experiment should detect.
#[derive(Debug, Clone, PartialEq)]
pub struct QuestionedEffect {
    /// Its name.
    pub name: String,
    /// The amplitude that the data ask for; `None` if it is asked of its largest.
    pub amplitude: Option<f64>,
}

/// What an experiment is asked.
enum Question {
    /// To distinguish effects.
    Separate(Vec<Pair>),
    /// To see effects of these amplitudes.
    See(Vec<(usize, f64)>),
    /// To settle the parameters.
    Settle,
}

/// A question with its purpose and the value that would do.
struct Task {
    purpose: Purpose,
    question: Question,
    /// Numbers of the effects concerned.
    effects: Vec<usize>,
    /// Value of the criterion that would do.
    target: Option<f64>,
}

impl Diagnosis {
    /// Effects that an experiment should detect, the most important first: those that tie, the suspects of an unknown
    /// cause, or those that re-tuning hides; empty if nothing is in question.
    pub fn in_question(&self) -> Vec<QuestionedEffect> {
        let found = |name: &String| {
            let amplitude = self.candidates.get(name)?.amplitude?;
            Some(QuestionedEffect {
                name: name.clone(),
                amplitude: Some(amplitude),
            })
        };
        let unseen = |hidden_only: bool| {
            let each = self.candidates.iter().filter(move |(_, c)| {
                c.unseen.is_some_and(|why| {
                    let hidden = why == Unseen::RetuningHidesIt;
                    hidden || !hidden_only
                })
            });
            let mut all: Vec<_> = each.map(|(name, c)| (c.unseen, name.clone())).collect();
            // A stable sort: what re-tuning hides comes first, for another condition can undo that.
            all.sort_by_key(|(why, _)| *why != Some(Unseen::RetuningHidesIt));
            let asked = all.into_iter().map(|(_, name)| QuestionedEffect {
                name,
                amplitude: None,
            });
            asked.collect()
        };
        match self.verdict {
            Verdict::Tie => {
                let mut names: Vec<&String> = Vec::new();
                for name in self.tie_groups.iter().flatten() {
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                names.into_iter().filter_map(found).collect()
            }
            Verdict::Unknown => {
                let mut names: Vec<&String> = self.suspects.iter().collect();
                let left = |name: &String| self.candidates.get(name).map_or(0.0, |c| c.t_after);
                names.sort_by(|a, b| left(a).total_cmp(&left(b)));
                names.into_iter().filter_map(found).collect()
            }
            Verdict::NotTestable => unseen(false),
            Verdict::None => unseen(true),
            Verdict::Named | Verdict::Recheck | Verdict::Refused => Vec::new(),
        }
    }

    /// Advice on the next measurement: one of those on offer, otherwise one that should be offered.
    pub fn advice(&self) -> Option<String> {
        if let Some(next) = &self.next_measurement {
            return Some(next.advice.clone());
        }
        let differ = |names: &[String]| {
            format!(
                "measure an observable, or in a scene, in which {} differ",
                listed(names, "and")
            )
        };
        match self.verdict {
            Verdict::Tie => Some(differ(&self.effects)),
            Verdict::Unknown if self.suspects.len() > 1 => Some(differ(&self.suspects)),
            Verdict::Unknown => Some(
                "measure another observable or in another scene, where what is missing shows more of itself".to_owned(),
            ),
            _ => None,
        }
    }

    /// The same with what to measure next among the experiments of a problem, those in it now.
    ///
    /// # Errors
    ///
    /// [`Error::NotPositiveDefinite`] when a covariance cannot be factorised.
    pub fn with_next_measurement(mut self, problem: &Problem) -> Result<Self, Error> {
        self.next_measurement = next_measurement(problem, &self)?;
        self.summary = summary(&self);
        Ok(self)
    }
}

/// Plans the next measurement where one helps.
pub(crate) fn next_measurement(
    problem: &Problem,
    diagnosis: &Diagnosis,
) -> Result<Option<NextMeasurement>, Error> {
    let experiments = experiments(problem);
    if experiments.is_empty() {
        return Ok(None);
    }
    let task = task(problem, diagnosis, &experiments);
    task.map(|task| plan(problem, &experiments, &task))
        .transpose()
}

/// The question that a diagnosis leaves, restricted to effects that all experiments can show; `None` if it leaves
/// none.
fn task(problem: &Problem, diagnosis: &Diagnosis, experiments: &[Experiment]) -> Option<Task> {
    if diagnosis.verdict == Verdict::Refused {
        return Some(Task {
            purpose: Purpose::SettleParameters,
            question: Question::Settle,
            effects: Vec::new(),
            target: None,
        });
    }
    let known = |j: &usize| experiments.iter().all(|e| e.tells_of(*j));
    let number = |name: &String| problem.candidates.iter().position(|c| c.name == *name);
    let asked = diagnosis.in_question();
    let effects = asked.iter().filter_map(|q| number(&q.name).filter(known));
    let effects: Vec<usize> = effects.collect();
    let separate = |groups: &[Vec<String>]| {
        let mut pairs = Vec::new();
        for group in groups {
            let members = group.iter().filter_map(|name| number(name).filter(known));
            let members: Vec<usize> = members.collect();
            for &effect in &members {
                let others = members.iter().filter(|&&k| k != effect);
                pairs.extend(others.filter_map(|&rival| pair(problem, diagnosis, effect, rival)));
            }
        }
        Question::Separate(pairs)
    };
    let (purpose, question, target) = match diagnosis.verdict {
        Verdict::Tie => {
            let question = separate(&diagnosis.tie_groups);
            (Purpose::BreakTie, question, SEPARATION_TO_REACH)
        }
        Verdict::Unknown if effects.len() > 1 => {
            let question = separate(std::slice::from_ref(&diagnosis.suspects));
            (Purpose::TellSuspects, question, SEPARATION_TO_REACH)
        }
        Verdict::Unknown => {
            let found = effects.iter().filter_map(|&j| {
                let amplitude = amplitude_and_error(problem, diagnosis, j)?.0;
                Some((j, amplitude.abs()))
            });
            let question = Question::See(found.collect());
            (Purpose::SeeSuspect, question, SCORE_TO_NAME)
        }
        _ => {
            let largest = |j: &usize| {
                let ends = problem.candidates[*j].range().map(f64::abs);
                let largest = ends[0].max(ends[1]);
                // 1 represents an amplitude without a limit.
                let amplitude = if largest.is_finite() { largest } else { 1.0 };
                (*j, amplitude)
            };
            let question = Question::See(effects.iter().map(largest).collect());
            (Purpose::FreeEffect, question, SCORE_TO_SEE)
        }
    };
    (!question.is_empty()).then_some(Task {
        purpose,
        question,
        effects,
        target: Some(target),
    })
}

/// Amplitude of an effect alone, and its standard error.
fn amplitude_and_error(
    problem: &Problem,
    diagnosis: &Diagnosis,
    effect: usize,
) -> Option<(f64, f64)> {
    let candidate = diagnosis.candidates.get(&problem.candidates[effect].name)?;
    Some((candidate.amplitude?, candidate.se?))
}

/// Two effects to be distinguished; `None` if the first has no amplitude.
fn pair(problem: &Problem, diagnosis: &Diagnosis, effect: usize, rival: usize) -> Option<Pair> {
    let (a, se) = amplitude_and_error(problem, diagnosis, effect)?;
    Some(Pair {
        effect,
        rival,
        mean_square: a * a + se * se,
    })
}

/// The experiments on offer: the problem's own, or its unused conditions at cost 1.
fn experiments(problem: &Problem) -> Vec<Experiment> {
    let Some(part) = problem
        .unused
        .as_ref()
        .filter(|_| problem.experiments.is_empty())
    else {
        return problem.experiments.clone();
    };
    (0..part.conditions.len())
        .map(|c| {
            let own = part.keep(|row| row.condition == c);
            Experiment {
                name: part.label(c),
                covariance: own.covariance,
                declared: own.declared,
                library: own.library,
                effects: None,
                runs: None,
                cost: 1.0,
            }
        })
        .filter(|e| e.declared.nrows() > 0)
        .collect()
}

impl Question {
    /// Whether nothing is asked.
    fn is_empty(&self) -> bool {
        match self {
            Self::Separate(pairs) => pairs.is_empty(),
            Self::See(effects) => effects.is_empty(),
            Self::Settle => false,
        }
    }

    /// The criterion, and what it has gained: the larger the better. Squares of separations add up over experiments;
    /// a separation beyond the target is not a gain, and a pair that is still tied takes none from the others.
    fn answered(&self, rows: &Rows, target: Option<f64>) -> (f64, f64) {
        let most = target.map_or(f64::INFINITY, |t| t * t);
        let capped = |squares: &[f64]| squares.iter().map(|d| d.min(most)).sum::<f64>();
        match self {
            Self::Separate(pairs) => {
                let squares: Vec<f64> = pairs.iter().map(|p| rows.squared_separation(p)).collect();
                let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
                (least.sqrt(), capped(&squares))
            }
            Self::See(effects) => {
                let square = |(j, a): &(usize, f64)| a * a * rows.squared_detectability(*j);
                let squares: Vec<f64> = effects.iter().map(square).collect();
                let largest = squares.iter().copied().fold(0.0, f64::max);
                (largest.sqrt(), capped(&squares))
            }
            Self::Settle => {
                let information = rows.ln_information();
                (information, information)
            }
        }
    }
}

/// Ranks the experiments, and adds them one by one, each the most helpful for its cost, until the target is reached or
/// none helps.
fn plan(
    problem: &Problem,
    experiments: &[Experiment],
    task: &Task,
) -> Result<NextMeasurement, Error> {
    let mut rows = Rows::of(problem)?;
    let offered = experiments
        .iter()
        .map(|e| Ok((e, Rows::of_experiment(e)?)))
        .collect::<Result<Vec<_>, Error>>()?;
    let ask = |rows: &Rows| task.question.answered(rows, task.target);
    let ranked_on = |rows: &Rows, before: f64| {
        let mut ranked: Vec<(f64, usize, f64)> = offered
            .iter()
            .enumerate()
            .map(|(i, (experiment, own))| {
                let (criterion, gained) = ask(&rows.with(own));
                ((gained - before) / experiment.cost, i, criterion)
            })
            .collect();
        // A stable sort: equal ones stay in the order of the problem.
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked
    };
    let planned = |i: usize, criterion: f64| PlannedExperiment {
        experiment: experiments[i].name.clone(),
        cost: experiments[i].cost,
        criterion,
    };
    let (now, mut gained) = ask(&rows);
    let ranked = ranked_on(&rows, gained);
    let longest = match task.question {
        Question::Settle => longest_for_parameters(problem),
        _ => LONGEST_PLAN,
    };
    let (mut value, mut plan) = (now, Vec::new());
    while plan.len() < longest && task.target.is_none_or(|t| value < t) {
        let best = ranked_on(&rows, gained).into_iter().next();
        let Some((_, i, criterion)) = best.filter(|(gain, ..)| *gain > 0.0) else {
            break;
        };
        rows = rows.with(&offered[i].1);
        (value, gained) = ask(&rows);
        plan.push(planned(i, criterion));
    }
    let reached = task.target.is_none_or(|t| value >= t);
    Ok(NextMeasurement {
        purpose: task.purpose,
        effects: task
            .effects
            .iter()
            .map(|&j| problem.candidates[j].name.clone())
            .collect(),
        advice: advice(task.purpose, plan.first(), reached),
        plan,
        ranked: ranked.into_iter().map(|(_, i, c)| planned(i, c)).collect(),
        now,
        needed: task.target,
        reached,
    })
}

/// Experiments until there is one row more than parameters.
fn longest_for_parameters(problem: &Problem) -> usize {
    let rows_each = problem.observables.len().max(1);
    problem.declared.len() / rows_each + 1
}

fn advice(purpose: Purpose, first: Option<&PlannedExperiment>, reached: bool) -> String {
    let what = match purpose {
        Purpose::BreakTie => "to distinguish the tied effects",
        Purpose::TellSuspects => "to distinguish the suspects",
        Purpose::SeeSuspect => "to see the suspect better",
        Purpose::FreeEffect => "to see the effect that re-tuning can imitate",
        Purpose::SettleParameters => "to have more observations than parameters",
    };
    let Some(first) = first else {
        return if reached && matches!(purpose, Purpose::SeeSuspect | Purpose::TellSuspects) {
            // A suspect that is seen well and not named leaves something that the library lacks.
            format!(
                "these measurements suffice {what}: another observable or scene may show what is missing beside it"
            )
        } else if reached {
            "nothing needs to be measured".to_owned()
        } else {
            format!(
                "none of the experiments on offer helps {what}: offer another observable or scene in which the effects \
                 differ"
            )
        };
    };
    let rest = if reached {
        ""
    } else {
        "; the experiments on offer do not suffice: measure another observable in which the \
         effects differ, or measure more precisely (more frames and simulator runs)"
    };
    format!("measure at {} {what}{rest}", first.experiment)
}

#[cfg(test)]
mod tests {
    use super::{Purpose, advice};

    /// Something is missing that the suspect does not explain: that nothing needs to be measured would be no answer.
    #[test]
    fn a_suspect_that_is_seen_well_is_not_the_end() {
        let told = advice(Purpose::SeeSuspect, None, true);
        assert!(told.contains("another observable"), "{told}");
        let told = advice(Purpose::FreeEffect, None, true);
        assert_eq!(told, "nothing needs to be measured");
    }
}
