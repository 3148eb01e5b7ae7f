//! What a study would cost, before the first run.

use crate::Error;
use crate::file::Budget;
use campaign::run_store::{Lookup, Record, Store};
use campaign::{RunRequest, Simulator};
use inference::{CoarseGraining, PlannedStage, RunList};
use serde::Serialize;
use simulators::scene_simulator::{RunDetails, SECONDS_PER_COST, TimingDetails};

/// Cost of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StagePrice {
    /// Name of the stage.
    pub stage: String,
    /// Number of runs that are certain.
    pub runs: usize,
    /// Runs that their results may ask for beyond these, at most: further boxes, rounds and effects.
    pub at_most_further: usize,
    /// Time of one core of the certain runs, s.
    pub core_s: f64,
    /// Time of one core of the further ones, at most, s.
    pub further_core_s: f64,
}

/// Cost of a run with grains of one size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SizePrice {
    /// Diameter of the grains over the real one.
    pub factor: f64,
    /// Certain runs with them.
    pub runs: usize,
    /// Mean time of one core of such a run, s.
    pub core_s: f64,
    /// That of the same runs with real grains, s.
    pub real_core_s: f64,
}

/// Cost of a study. The times are those of runs: the statistics between them, the report and the decks come on top.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Price {
    /// By stage.
    pub stages: Vec<StagePrice>,
    /// By the size of the grains, the finest first; empty if all have their real size.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sizes: Vec<SizePrice>,
    /// Certain runs of all stages.
    pub runs: usize,
    /// Further runs of all stages, at most.
    pub at_most_further: usize,
    /// Time of one core of the certain runs, s.
    pub core_s: f64,
    /// Time of one core of the further ones, at most, s.
    pub further_core_s: f64,
    /// Whether the times follow from planned runs whose records are in the folder, and not from a guess.
    pub measured: bool,
    /// Most runs by the budget; none without one.
    pub most_runs: Option<usize>,
    /// Why no result can count as met, whatever the runs show; `None` if one can.
    pub cannot_be_met: Option<String>,
}

/// Prices the stages, by the pace of the planned runs that a store has, or by a guess. A budget in core hours is turned
/// into runs by the mean cost of the planned ones, always by the guess: a study that is taken up again keeps its budget.
pub(crate) fn of(
    simulator: &dyn Simulator,
    stages: &[PlannedStage],
    budget: Budget,
    store: Option<&Store>,
) -> Result<Price, Error> {
    let cost = |request: &RunRequest| {
        let cost = simulator.prepare(request).map_or(1.0, |run| run.cost());
        // As the campaign counts it.
        if cost.is_finite() && cost > 0.0 {
            cost
        } else {
            1.0
        }
    };
    let (mut known_cost, mut known_s) = (0.0, 0.0);
    let certain = || stages.iter().flat_map(|s| requests(&s.certain));
    for request in certain() {
        if let Some(store) = store
            && let Some(seconds) = seconds_of(simulator, request, store)?
        {
            known_cost += cost(request);
            known_s += seconds;
        }
    }
    let pace = if known_cost > 0.0 {
        known_s / known_cost
    } else {
        SECONDS_PER_COST
    };
    let seconds = |lists: &[RunList]| requests(lists).fold(0.0, |sum, r| sum + pace * cost(r));
    let price = |stage: &PlannedStage| StagePrice {
        stage: stage.stage.clone(),
        runs: stage.runs(),
        at_most_further: stage.at_most_further(),
        core_s: seconds(&stage.certain),
        further_core_s: seconds(&stage.further),
    };
    let guess_s = certain().fold(0.0, |sum, r| sum + SECONDS_PER_COST * cost(r));
    let stages: Vec<StagePrice> = stages.iter().map(price).collect();
    let runs = stages.iter().map(|s| s.runs).sum();
    let at_most_further = stages.iter().map(|s| s.at_most_further).sum();
    let core_s = stages.iter().fold(0.0, |sum, s| sum + s.core_s);
    let further_core_s = stages.iter().fold(0.0, |sum, s| sum + s.further_core_s);
    Ok(Price {
        sizes: by_size(certain(), |request| pace * cost(request)),
        measured: known_cost > 0.0,
        most_runs: most_runs(budget, runs, guess_s),
        stages,
        runs,
        at_most_further,
        core_s,
        further_core_s,
        cannot_be_met: None,
    })
}

/// What runs with coarse grains cost, size by size.
fn by_size<'r>(
    requests: impl Iterator<Item = &'r RunRequest>,
    seconds: impl Fn(&RunRequest) -> f64,
) -> Vec<SizePrice> {
    let mut sizes: Vec<SizePrice> = Vec::new();
    for request in requests {
        let Some(&factor) = request.parameters.get(CoarseGraining::SYMBOL) else {
            continue;
        };
        let mut real = request.clone();
        real.parameters.remove(CoarseGraining::SYMBOL);
        let place = sizes.iter().position(|size| size.factor == factor);
        let place = place.unwrap_or_else(|| {
            sizes.push(SizePrice {
                factor,
                runs: 0,
                core_s: 0.0,
                real_core_s: 0.0,
            });
            sizes.len() - 1
        });
        let size = &mut sizes[place];
        size.runs += 1;
        // Running means.
        let share = 1.0 / size.runs as f64;
        size.core_s += share * (seconds(request) - size.core_s);
        size.real_core_s += share * (seconds(&real) - size.real_core_s);
    }
    sizes.sort_by(|a, b| a.factor.total_cmp(&b.factor));
    sizes
}

/// The runs of lists, each as often as its list.
fn requests(lists: &[RunList]) -> impl Iterator<Item = &RunRequest> {
    let each = lists.iter();
    each.flat_map(|list| std::iter::repeat_n(&list.requests, list.times).flatten())
}

/// Time of one core that a run took, s; `None` if the store has no record of it, or the run was only measured again by another
/// camera.
fn seconds_of(
    simulator: &dyn Simulator,
    request: &RunRequest,
    store: &Store,
) -> Result<Option<f64>, Error> {
    let Ok(inputs) = simulator.prepare(request).and_then(|run| run.inputs()) else {
        return Ok(None);
    };
    let blank = Record::new(&simulator.version(), inputs, request.seed)?;
    let Lookup::Found(record) = store.get(blank.key())? else {
        return Ok(None);
    };
    let timing = RunDetails::of(&record).ok().map(|details| details.timing);
    Ok(timing.filter(|t| !t.only_seen).map(|t| of_core(&t)))
}

/// Most runs by a budget, at least one.
fn most_runs(budget: Budget, runs: usize, core_s: f64) -> Option<usize> {
    let by_time = budget.core_hours.map(|hours| {
        let each = core_s / runs.max(1) as f64;
        let affordable = (hours * 3600.0 / each.max(f64::MIN_POSITIVE)).clamp(1.0, 1e9);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 1 and a thousand million"
        )]
        let whole = affordable as usize;
        whole
    });
    budget.runs.or(by_time)
}

/// Time of one core, s. If the system gives no time of the processor, it is the wall time: a run of a study is
/// one thread.
pub(crate) fn of_core(timing: &TimingDetails) -> f64 {
    timing.cpu_s.unwrap_or(timing.wall_s)
}

/// Mean time of one core of some runs in a store, s; `None` if none of them is known.
pub(crate) fn mean_core_seconds(store: &Store, keys: &[String]) -> Result<Option<f64>, Error> {
    let (mut sum, mut n) = (0.0, 0);
    for key in keys {
        let Lookup::Found(record) = store.get(key)? else {
            continue;
        };
        let timing = RunDetails::of(&record).ok().map(|details| details.timing);
        if let Some(timing) = timing.filter(|t| !t.only_seen) {
            sum += of_core(&timing);
            n += 1;
        }
    }
    Ok((n > 0).then(|| sum / f64::from(n)))
}

#[cfg(test)]
mod tests {
    use super::{SECONDS_PER_COST, most_runs, of};
    use crate::Budget;
    use crate::spent::{Spending, core_seconds};
    use campaign::run_store::{Record, Store};
    use campaign::{Cores, PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError};
    use inference::{PlannedStage, RunList};
    use serde_json::Value;

    /// A run of model m costs 3.
    struct Three;

    impl Simulator for Three {
        fn version(&self) -> String {
            "three".into()
        }

        fn run(&self, _: &RunRequest) -> Result<RunOutcome, SimulatorError> {
            Ok(RunOutcome::default())
        }

        fn prepare<'s>(
            &'s self,
            request: &RunRequest,
        ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
            Ok(Box::new(OfThree(request.clone())))
        }
    }

    struct OfThree(RunRequest);

    impl PreparedRun for OfThree {
        fn inputs(&self) -> Result<Value, SimulatorError> {
            Ok(self.0.inputs())
        }

        fn cost(&self) -> f64 {
            3.0
        }

        fn run(&self, _: &Cores) -> Result<RunOutcome, SimulatorError> {
            Three.run(&self.0)
        }
    }

    /// The record of a run that took 6 s of one core.
    fn record_of_six_seconds(request: &RunRequest) -> Record {
        let details = serde_json::json!({
            "steady": true, "start_up_s": null, "froude_number": null, "last_frame_png_base64": null,
            "frames": {
                "times_s": [], "angles_deg": [], "angles_by_position_deg": [], "filling_angles_deg": [],
                "refused": 0, "effective_number": null,
            },
            "series": { "time_s": [], "centre_of_mass_deg": [] },
            "timing": {
                "time_step_s": 1e-4, "settling_time_step_s": 1e-4, "steps": 1, "bodies": 1, "spheres": 1,
                "threads": 1, "wall_s": 6.5, "cpu_s": 6.0, "filling_s": null, "us_per_step": null,
                "sphere_steps_per_s": null, "continued": false, "only_seen": false,
                "phases": {
                    "building_s": 0.5, "settling_s": 1.0, "start_up_s": 2.0, "measuring_s": 1.75, "reading_s": 0.75,
                },
            },
        });
        let record = Record::new("three", request.inputs(), request.seed);
        let record = record.expect("a record");
        record.with_details(details)
    }

    /// Ten runs of cost 3; one of them is in the folder and took 6 s, so that a cost of 1 takes 2 s.
    #[test]
    fn the_price_follows_the_runs_that_are_there() {
        let requests: Vec<_> = (1..=10).map(|seed| RunRequest::new("m", seed)).collect();
        let stages = [PlannedStage {
            stage: "surfaces".into(),
            certain: vec![RunList::once(requests.clone())],
            further: vec![RunList {
                times: 5,
                requests: requests[..1].to_vec(),
            }],
        }];
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let budget = Budget {
            runs: None,
            core_hours: Some(18.0 / 3600.0),
        };
        let guess = of(&Three, &stages, budget, Some(&store)).unwrap();
        assert!(!guess.measured);
        assert!((guess.core_s - 30.0 * SECONDS_PER_COST).abs() < 1e-12);
        let record = record_of_six_seconds(&requests[4]);
        store.put(&record).unwrap();
        let price = of(&Three, &stages, budget, Some(&store)).unwrap();
        assert!(price.measured);
        assert_eq!((price.runs, price.core_s), (10, 60.0));
        assert_eq!((price.at_most_further, price.further_core_s), (5, 30.0));
        assert_eq!(
            price.most_runs, guess.most_runs,
            "a budget does not follow the pace"
        );
        assert_eq!(core_seconds(&store).unwrap().0, 6.0);
        // A damaged record is none, and costs no answer.
        let file = folder.path().join(format!("{}.json", record.key()));
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replace("6.0", "7.0")).unwrap();
        assert!(!of(&Three, &stages, budget, Some(&store)).unwrap().measured);
        assert_eq!(core_seconds(&store).unwrap().0, 0.0);
        assert!(file.exists(), "it is left to the run that needs it");
    }

    /// A run that kept one thread busy for 6 s: what a million threads waited rises with the call. The next call has no run.
    #[test]
    fn a_call_spends_what_its_own_runs_took() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let spending = Spending::begin(&store).unwrap();
        let record = record_of_six_seconds(&RunRequest::new("m", 5));
        store.put(&record).unwrap();
        let [busy, many] = [1, 1_000_000].map(|n| spending.end(n).unwrap());
        assert_eq!((busy.core_s, busy.waiting_s), (6.0, Some(0.0)));
        assert_eq!((busy.phases.total_s(), busy.phases.reading_s), (6.0, 0.75));
        let waited = many.waiting_s.unwrap();
        assert!(
            (waited - (1e6 * many.wall_s - 6.0)).abs() < 1e-6,
            "{many:?}"
        );
        let again = Spending::begin(&store).unwrap().end(1).unwrap();
        assert_eq!(again.core_s, 6.0);
        assert_eq!(again.waiting_s, Some(again.wall_s), "no run of this call");
    }

    /// 100 runs of 36 s each: a core hour pays for 100 of them, half an hour for 50.
    #[test]
    fn a_budget_of_core_hours_becomes_runs() {
        let hours = |h: f64| Budget {
            core_hours: Some(h),
            runs: None,
        };
        assert_eq!(most_runs(hours(1.0), 100, 3600.0), Some(100));
        assert_eq!(most_runs(hours(0.5), 100, 3600.0), Some(50));
        assert_eq!(most_runs(Budget::default(), 100, 3600.0), None);
        let runs = Budget {
            runs: Some(7),
            core_hours: None,
        };
        assert_eq!(most_runs(runs, 100, 3600.0), Some(7));
    }
}
