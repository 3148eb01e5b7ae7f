//! Campaigns with known truth by the solver itself: each effect of the library is hidden in measured-like data of
//! several apparatus, and the diagnosis, which runs its own simulations, is asked what is missing.
//!
//! `cargo run --release -p study --example effect_trials -- campaigns|next STUDY.toml FOLDER REPLICATES NOTHING MINUTES`
//!
//! Every effect is hidden at each of the sizes, REPLICATES times with other truths and seeds; in NOTHING campaigns nothing
//! is. With `next`, where an answer leaves a question, the first measurement that it recommends is made, and all is
//! diagnosed again. After MINUTES no further campaign begins.
//! A size is a multiple of the smallest amplitude that the measurements show with a chance of 90 %, never above the
//! largest that is physically possible; an effect that cannot reach half of a size is left to the smaller one.
//! Finished runs are kept in FOLDER and found again. Prints a page in Markdown; FOLDER/rows.md has a row for each effect and
//! size. Each diagnosis is written whole to FOLDER, and the linear problem of the whole library, as it is when nothing is
//! hidden, to FOLDER/problem.json, for `just trials`.

#![expect(clippy::print_stdout, reason = "the page is the purpose")]
#![expect(
    clippy::print_stderr,
    reason = "an hour of silence would be taken for a standstill"
)]

mod goals;
mod laboratory;
mod next;
mod outcome;
mod page;

use campaign::run_store::Store;
use campaign::{Campaign, Progress, ProgressState};
use inference::diagnosis::CandidateResult;
use inference::{
    DiagnosisStage, EffectProbe, LoopSettings, ResidualStudy, diagnose_at, study_residual,
};
use laboratory::{Hidden, Laboratory};
use next::{Next, Recommended};
use outcome::{Outcome, Work};
use page::Page;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use study::{Study, StudySimulator};

/// Seed of the diagnoses: each of them begins with the same runs. The truths have streams of their own.
const SEED: u64 = 1;
/// Multiples of the smallest amplitude that can be seen; the last is that of the goals.
const SIZES: [f64; 2] = [2.0, 4.0];

/// How the program is called.
const USAGE: &str =
    "usage: effect_trials campaigns|next STUDY.toml FOLDER REPLICATES NOTHING MINUTES";

/// Counts the runs of a campaign, those found again too.
#[derive(Default)]
struct Counter(AtomicUsize);

impl Progress for Counter {
    fn update(&self, state: &ProgressState) {
        if state.done == state.total {
            self.0.fetch_add(state.total, Ordering::Relaxed);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [mode, path, folder, replicates, nothing, minutes] = arguments.as_slice() else {
        return Err(USAGE.into());
    };
    let follows = match mode.as_str() {
        "campaigns" => false,
        "next" => true,
        _ => return Err(USAGE.into()),
    };
    let (replicates, nothing): (u64, u64) = (replicates.parse()?, nothing.parse()?);
    let minutes: f64 = minutes.parse()?;
    let folder = PathBuf::from(folder);
    let study = Study::read(Path::new(path), None)?;
    let simulator = study.simulator(&folder)?;
    let store = Store::open(folder.join("runs"))?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let counter = Counter::default();
    let campaign = Campaign::new(&store, threads, &counter);
    let trials = Trials {
        laboratory: Laboratory::new(&study, &simulator, &campaign)?,
        study: &study,
        simulator: &simulator,
        campaign: &campaign,
        counter: &counter,
        folder: &folder,
        follows,
    };
    let (page, next) = trials.all(replicates, nothing, minutes)?;
    let work = Work::of(&store)?;
    let text = if follows {
        next::text(&next, &page.outcomes, &work)
    } else {
        std::fs::write(folder.join("rows.md"), page.table())?;
        page.text(&work)
    };
    println!("{text}");
    Ok(())
}

/// What all campaigns share.
struct Trials<'a> {
    /// The file, read.
    study: &'a Study,
    /// Its scenes.
    simulator: &'a StudySimulator,
    /// Runs.
    campaign: &'a Campaign<'a>,
    /// Their number so far.
    counter: &'a Counter,
    /// Where the data come from.
    laboratory: Laboratory<'a>,
    /// Where the diagnoses are written.
    folder: &'a Path,
    /// Whether the measurement that an open question recommends is made.
    follows: bool,
}

impl Trials<'_> {
    /// All campaigns, the largest size first, and what follows those with an open question; campaigns that a lack of time
    /// leaves out are counted.
    fn all(
        &self,
        replicates: u64,
        nothing: u64,
        minutes: f64,
    ) -> Result<(Page, Vec<Next>), AnyError> {
        let begin = Instant::now();
        let first = self.outcome(Hidden::nothing(0))?;
        let study = first.study().cloned();
        let study = study.ok_or_else(|| {
            format!(
                "with nothing hidden: {}",
                first.failure().unwrap_or("no answer")
            )
        })?;
        let problem = serde_json::to_string_pretty(&study.problem)?;
        std::fs::write(self.folder.join("problem.json"), problem)?;
        let mut page = Page::new(&self.study.not_applicable, &study);
        page.outcomes.push(first);
        let sizes =
            (0..replicates).flat_map(|r| SIZES.into_iter().rev().map(move |size| (r, size)));
        let blocks = replicates * SIZES.len() as u64;
        let mut hidden = Vec::new();
        for (block, (replicate, size)) in (0..blocks).zip(sizes) {
            hidden.extend(self.block(&study, replicate, size, &mut page)?);
            // Those with nothing hidden are spread between the others.
            let upto = |block: u64| 1 + nothing.saturating_sub(1) * block / blocks;
            hidden.extend((upto(block)..upto(block + 1)).map(Hidden::nothing));
        }
        let mut next = Vec::new();
        for hidden in hidden {
            if begin.elapsed().as_secs_f64() > 60.0 * minutes {
                page.not_begun += 1;
                continue;
            }
            let outcome = self.outcome(hidden)?;
            if self.follows
                && let Some(recommended) = next::recommended(&outcome)
            {
                next.push(self.next(&outcome, &recommended)?);
            }
            page.outcomes.push(outcome);
        }
        Ok((page, next))
    }

    /// What a campaign with an open question tells once the first measurement that it recommends is made.
    fn next(&self, outcome: &Outcome, recommended: &Recommended<'_>) -> Result<Next, AnyError> {
        let (study, candidate) = (recommended.study, recommended.candidate);
        let again = || -> Result<ResidualStudy, AnyError> {
            let values = self.laboratory.measure_next(&outcome.hidden, candidate)?;
            let plan = study.with_measured(candidate, &values);
            Ok(study_residual(self.campaign, self.simulator, &plan)?)
        };
        let result = again().map_err(|e| cause(&*e));
        let then = Outcome::new(outcome.hidden.clone(), result, 0)?;
        eprintln!(
            "{} -> {} -> {}",
            outcome.line(),
            candidate.name,
            then.line()
        );
        Ok(Next {
            measured: candidate.name.clone(),
            expected: recommended.expected,
            before: (outcome.told(), study.diagnosis.effects.len()),
            then,
        })
    }

    /// What is hidden at one size and of one replicate: every effect that can be seen.
    fn block(
        &self,
        first: &ResidualStudy,
        replicate: u64,
        size: f64,
        page: &mut Page,
    ) -> Result<Vec<Hidden>, AnyError> {
        let mut all = Vec::new();
        for (k, effect) in first.plan.effects.iter().enumerate() {
            let Some(candidate) = first.diagnosis.candidates.get(&effect.name) else {
                continue;
            };
            if !candidate.testable {
                page.note_unseen(&effect.name, candidate);
                continue;
            }
            // Either sign in turn where both are possible.
            let positive = (k as u64 + replicate).is_multiple_of(2);
            let Some((amplitude, reached)) = self.amplitude(effect, candidate, size, positive)
            else {
                continue;
            };
            if reached < size / 2.0 {
                page.note_weak(&effect.name, reached);
            } else if self.laboratory.is_unchanged(&effect.name, amplitude)? {
                page.note_unchanged(&effect.name, amplitude);
            } else {
                all.push(Hidden {
                    effect: Some((effect.name.clone(), amplitude)),
                    size,
                    reached,
                    number: 10_000 * (replicate + 1) + 100 * k as u64 + tenths(size),
                });
            }
        }
        Ok(all)
    }

    /// Amplitude of a size and what multiple of the smallest one it is, of the sign asked for where that can be run, else
    /// of the other; none where neither can, or the smallest is not known.
    fn amplitude(
        &self,
        effect: &EffectProbe,
        candidate: &CandidateResult,
        size: f64,
        positive: bool,
    ) -> Option<(f64, f64)> {
        let smallest = candidate.smallest_detectable?;
        let signs = if positive { [1.0, -1.0] } else { [-1.0, 1.0] };
        let of_sign = |sign: f64| (sign * size * smallest).clamp(effect.range[0], effect.range[1]);
        let amplitude = signs.map(of_sign).into_iter();
        let mut possible = amplitude.filter(|a| self.laboratory.can_be_run(&effect.name, *a));
        let amplitude = possible.next()?;
        Some((amplitude, amplitude.abs() / smallest))
    }

    /// One campaign: makes the data, asks what is missing.
    fn outcome(&self, hidden: Hidden) -> Result<Outcome, AnyError> {
        let before = self.counter.0.load(Ordering::Relaxed);
        let number = hidden.number;
        let result = self.diagnosed(&hidden);
        let after = self.counter.0.load(Ordering::Relaxed);
        let outcome = Outcome::new(hidden, result.map_err(|e| cause(&*e)), after - before)?;
        let name = format!("campaign-{number}.json");
        if let Some(study) = outcome.study() {
            let text = serde_json::to_string_pretty(study)?;
            std::fs::write(self.folder.join(name), text)?;
        }
        eprintln!("{}", outcome.line());
        Ok(outcome)
    }

    /// The diagnosis of data in which something is hidden.
    fn diagnosed(&self, hidden: &Hidden) -> Result<ResidualStudy, AnyError> {
        let problem = self.laboratory.measure(hidden)?;
        let settings = LoopSettings {
            seed: SEED,
            ..self.study.settings.clone()
        };
        let start: Vec<f64> = problem.parameters.iter().map(|p| p.start).collect();
        match diagnose_at(self.campaign, self.simulator, &problem, &settings, &start)? {
            DiagnosisStage::Done(study) => Ok(*study),
            DiagnosisStage::LeftOut { reason } => Err(reason.into()),
        }
    }
}

/// Any error.
type AnyError = Box<dyn Error>;

/// A size in tenths, as part of the number of a campaign.
fn tenths(size: f64) -> u64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a negative size gives 0, a huge one saturates"
    )]
    let tenths = (10.0 * size).round() as u64;
    tenths
}

/// The innermost reason of an error: the run that failed has a long name.
fn cause(error: &dyn Error) -> String {
    let mut innermost = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    innermost.to_string()
}
