//! Campaigns with known truth by the solver itself: each effect of the library is hidden in measured-like
//! data, and the diagnosis, which runs its own simulations, is asked what is missing.
//!
//! `cargo run --release -p study --example effect_trials -- PLAN.toml FOLDER SIZE`
//!
//! SIZE is a multiple of the smallest amplitude that the plan's conditions show with a chance of 90 %, never
//! above the largest that is physically possible; an effect that cannot reach half of SIZE is left to a smaller
//! one. Finished runs are kept in FOLDER and found again. Prints a page in Markdown; each diagnosis is written
//! whole to FOLDER, and the linear problem of the whole library, as it is when nothing is hidden, to
//! FOLDER/problem.json, for `just trials`.

#![expect(clippy::print_stdout, reason = "the page is the purpose")]

use calibration::{
    DeclaredParameter, EffectProbe, Laboratory, Prior, ResidualPlan, ResidualStudy, StudyCondition,
    study_residual,
};
use campaign::{Campaign, LineProgress, RunRequest};
use random_stream::Stream;
use run_store::Store;
use scene::{Override, Scene};
use scene_simulator::{Binding, SceneSimulator};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};

/// First seed of the fits; each of them begins with the same runs.
const SEED: u64 = 1;
/// Seeds of the data, far from those of the fits.
const DATA_SEEDS: u64 = 10_000_000;
/// Campaigns with nothing hidden.
const NOTHING: u64 = 2;

/// What the page shows.
const HEAD: &str = "# Every effect hidden once, by the solver

Measured-like data are made by the solver with one effect of the library switched on, the friction drawn from its
bench values, runs of other seeds, and noise of reading. The diagnosis knows the bench values and searches the whole
library by simulations of its own: [the plan](../../fixtures/cotton/trials.toml). All diagnoses begin with the same
runs for the sensitivities, so that the noise of these is common to all rows.

`size`: the hidden amplitude over the smallest one that these conditions show with a chance of 90 %, by the linear
model about the start; never more than is physically possible, and none that cannot reach half of the size asked
for. `T before, after`: the whitened residual that
re-tuning cannot absorb, without an effect and with the first one named. Last column: root mean square error of the
angle at the condition kept for the check, before and after, by real runs; where effects tie, up to three of them
are added in turn, and both last numbers are given for each. An amplitude without a name was
withdrawn because that condition spoke against it.
";

/// The file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plan {
    /// Scene, relative to the file.
    scene: PathBuf,
    /// Changes of it, `name = value`.
    changes: Vec<String>,
    /// What is measured.
    observables: Vec<String>,
    /// Standard deviation of reading it, in its unit.
    reading_sd: Vec<f64>,
    /// Runs behind a measured mean.
    measured_runs: usize,
    /// Runs behind a simulated mean.
    replicates: usize,
    /// Declared parameters.
    declared: Vec<DeclaredEntry>,
    /// Conditions.
    conditions: Vec<StudyCondition>,
}

/// A declared parameter.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DeclaredEntry {
    /// Path of the setting.
    parameter: String,
    /// Value at which the simulator is linearised.
    start: f64,
    /// Step of the finite difference.
    step: f64,
    /// Lower bound.
    low: f64,
    /// Upper bound.
    high: f64,
    /// What the bench says; none where it is free.
    prior: Option<Prior>,
}

impl DeclaredEntry {
    /// As the calibration wants it.
    fn as_declared(&self) -> DeclaredParameter {
        DeclaredParameter {
            name: self.parameter.clone(),
            start: self.start,
            step: self.step,
            bounds: [self.low, self.high],
            prior: self.prior.map(|p| [p.mean, p.sd]),
        }
    }
}

/// What a campaign hides.
struct Hidden {
    /// Effect and amplitude; none for nothing.
    effect: Option<(String, f64)>,
    /// Number of the campaign, for its seeds.
    number: u64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: effect_trials PLAN.toml FOLDER SIZE";
    let path = PathBuf::from(arguments.next().ok_or(usage)?);
    let folder = PathBuf::from(arguments.next().ok_or(usage)?);
    let size: f64 = arguments.next().ok_or(usage)?.parse()?;
    if !(size > 0.0 && size.is_finite()) || arguments.next().is_some() {
        return Err(usage.into());
    }
    let plan: Plan = toml::from_str(&std::fs::read_to_string(&path)?)?;
    let simulator = plan.simulator(path.parent().unwrap_or(Path::new("")))?;
    let store = Store::open(folder.join("runs"))?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = LineProgress::new(std::io::stderr());
    let trials = Trials {
        folder,
        residual: plan.residual(&simulator)?,
        campaign: Campaign::new(&store, threads, &progress),
        plan,
        simulator,
    };
    trials.print_all(size)
}

impl Plan {
    /// The scene as a simulator.
    fn simulator(&self, folder: &Path) -> Result<SceneSimulator, Box<dyn Error>> {
        let one = |text: &String| {
            let (name, value) = text.split_once('=').ok_or(format!("'{text}' has no '='"))?;
            let (name, value) = (name.trim().into(), value.trim().into());
            Ok(Override { name, value })
        };
        let changes: Result<Vec<_>, String> = self.changes.iter().map(one).collect();
        let changes = changes?;
        let scene = Scene::read(&folder.join(&self.scene), &changes)?;
        let paths = self.declared.iter().map(|d| d.parameter.clone());
        let bindings = paths.map(|path| (path.clone(), Binding::of_path(&path)));
        Ok(SceneSimulator::new(
            BTreeMap::from([("trials".to_owned(), scene)]),
            bindings.collect(),
        )?)
    }

    /// What every fit is given: all effects that the scene can carry.
    fn residual(&self, simulator: &SceneSimulator) -> Result<ResidualPlan, Box<dyn Error>> {
        let base = RunRequest::new("trials", SEED);
        let probe = |name: &String| {
            let description = effect_library::find(name)?.description();
            Ok(EffectProbe {
                name: name.clone(),
                probe: description.probe,
                range: description.range,
                absent: BTreeMap::new(),
            })
        };
        let names = effect_library::names();
        let effects: Result<Vec<_>, effect_library::Error> = names.iter().map(probe).collect();
        let mut effects = effects?;
        effects.retain(|e| {
            let request = base.clone().with_effect(&e.name, e.probe);
            simulator.scene_of(&request).is_ok()
        });
        Ok(ResidualPlan {
            id: "effect trials".into(),
            base,
            conditions: self.conditions.clone(),
            observables: self.observables.clone(),
            declared: self
                .declared
                .iter()
                .map(DeclaredEntry::as_declared)
                .collect(),
            effects,
            replicates: self.replicates,
            seed: SEED,
        })
    }
}

/// What all campaigns share.
struct Trials<'a> {
    /// The file.
    plan: Plan,
    /// The scene.
    simulator: SceneSimulator,
    /// Runs.
    campaign: Campaign<'a>,
    /// The fit's plan.
    residual: ResidualPlan,
    /// Where the diagnoses are written.
    folder: PathBuf,
}

impl Trials<'_> {
    /// All campaigns, one line each.
    fn print_all(&self, size: f64) -> Result<(), Box<dyn Error>> {
        println!("{HEAD}");
        println!(
            "| hidden | amplitude | size | verdict | named or tied | amplitude found | T before, after | \
             angle on kept condition, deg |"
        );
        println!("|---|--:|--:|---|---|--:|--:|--:|");
        let mut first = None;
        for number in 0..NOTHING {
            let hidden = Hidden {
                effect: None,
                number,
            };
            let study = self.study(&hidden)?;
            print_row(&hidden, None, &study);
            first.get_or_insert(study);
        }
        let Some(first) = first else { return Ok(()) };
        let problem = serde_json::to_string_pretty(&first.problem)?;
        std::fs::write(self.folder.join("problem.json"), problem)?;
        let mut rest = Vec::new();
        let mut too_weak = Vec::new();
        for (k, effect) in first.plan.effects.iter().enumerate() {
            let candidate = first.diagnosis.candidates.get(&effect.name);
            let Some(candidate) = candidate.filter(|c| c.testable) else {
                rest.push(effect.name.clone());
                continue;
            };
            let Some(smallest) = candidate.smallest_detectable else {
                continue;
            };
            // Either sign in turn where both are possible.
            let sign = if k % 2 == 1 { -1.0 } else { 1.0 };
            let of_sign =
                |sign: f64| (sign * size * smallest).clamp(effect.range[0], effect.range[1]);
            let amplitude = match of_sign(sign) {
                amplitude if self.is_possible(&effect.name, amplitude) => amplitude,
                _ => of_sign(-sign),
            };
            let reached = amplitude.abs() / smallest;
            if reached < size / 2.0 {
                too_weak.push(format!("{} ({reached:.1})", effect.name));
                continue;
            }
            let hidden = Hidden {
                effect: Some((effect.name.clone(), amplitude)),
                number: 100 * (k as u64 + 1) + tenths(size),
            };
            match self.study(&hidden) {
                Ok(study) => print_row(&hidden, Some(reached), &study),
                Err(error) => println!(
                    "| {} | {amplitude:.3} | {reached:.1} | cannot be run: {} | | | | |",
                    effect.name,
                    cause(&*error)
                ),
            }
        }
        println!(
            "\nNot seen at these conditions even at their largest amplitude: {}.",
            list(&rest)
        );
        println!(
            "Largest possible amplitude below half of this size: {}.",
            list(&too_weak)
        );
        let left_out = first
            .left_out
            .iter()
            .map(|(name, why)| format!("{name} ({why})"));
        println!(
            "Left out of the library, for they could not be run: {}.",
            list(&left_out.collect::<Vec<_>>())
        );
        Ok(())
    }

    /// Whether the scene can carry an effect of this amplitude; without one it is another campaign.
    fn is_possible(&self, effect: &str, amplitude: f64) -> bool {
        let request = self.residual.base.clone().with_effect(effect, amplitude);
        amplitude != 0.0 && self.simulator.scene_of(&request).is_ok()
    }

    /// One campaign: draws a truth, makes the data, asks what is missing.
    fn study(&self, hidden: &Hidden) -> Result<ResidualStudy, Box<dyn Error>> {
        let mut stream = Stream::new(SEED, &format!("truth {}", hidden.number));
        let truth = self.plan.declared.iter().map(|d| {
            let drawn = d.prior.map_or(d.start, |p| p.mean + p.sd * stream.normal());
            (d.parameter.clone(), drawn.clamp(d.low, d.high))
        });
        let laboratory = Laboratory {
            parameters: truth.collect(),
            effects: hidden.effect.iter().cloned().collect(),
            runs: self.plan.measured_runs,
            reading_sd: &self.plan.reading_sd,
            first_seed: DATA_SEEDS + 100 * hidden.number,
            reading: Stream::new(SEED, &format!("reading {}", hidden.number)),
        };
        let observed = laboratory.measure(&self.campaign, &self.simulator, &self.residual)?;
        let study = study_residual(&self.campaign, &self.simulator, &self.residual, &observed)?;
        let name = format!("campaign-{}.json", hidden.number);
        let text = serde_json::to_string_pretty(&study)?;
        std::fs::write(self.folder.join(name), text)?;
        Ok(study)
    }
}

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

/// One line of the table.
fn print_row(hidden: &Hidden, size: Option<f64>, study: &ResidualStudy) {
    let (name, amplitude) = match &hidden.effect {
        Some((name, amplitude)) => (name.as_str(), format!("{amplitude:.3}")),
        None => ("nothing", String::new()),
    };
    let size = size.map_or_else(String::new, |s| format!("{s:.1}"));
    let diagnosis = &study.diagnosis;
    let models: Vec<_> = study.models().collect();
    let amplitudes = |model: &&calibration::AddedEffect| -> Vec<String> {
        let one = |(name, value): (&String, &f64)| match study.rivals.len() {
            0 => format!("{value:.3}"),
            _ => format!("{name} {value:.3}"),
        };
        model.effects.iter().map(one).collect()
    };
    let found: Vec<_> = models.iter().flat_map(amplitudes).collect();
    let rest = diagnosis
        .effects
        .first()
        .and_then(|name| diagnosis.candidates.get(name))
        .map_or_else(String::new, |c| format!(", {:.0}", c.t_after));
    let kept = |errors: &calibration::ErrorPair| {
        let kept = errors
            .kept
            .as_ref()
            .and_then(|e| e.rmse.get("angle_deg").copied());
        kept.map_or_else(String::new, |e| format!("{e:.2}"))
    };
    let after: Vec<_> = models.iter().map(|model| kept(&model.errors)).collect();
    let arrow = if after.is_empty() { "" } else { " -> " };
    println!(
        "| {name} | {amplitude} | {size} | {} | {} | {} | {:.0}{rest} | {}{arrow}{} |",
        diagnosis.verdict,
        diagnosis.effects.join(", "),
        found.join(", "),
        diagnosis.structured_residual.t0.unwrap_or(f64::NAN),
        kept(&study.errors_before),
        after.join(", "),
    );
}

/// The innermost reason of an error: the run that failed has a long name.
fn cause(error: &dyn Error) -> String {
    let mut innermost = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    innermost.to_string()
}

/// Names with commas, or "none".
fn list(names: &[String]) -> String {
    if names.is_empty() {
        "none".into()
    } else {
        names.join(", ")
    }
}
