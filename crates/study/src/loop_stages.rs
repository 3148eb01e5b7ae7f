//! The stages of the loop, one after the other.

use crate::hidden::probes;
use crate::result::Cost;
use crate::{
    Error, FillingSummary, ImageAgainstPosition, MeteringResult, Profile, StudyFile, StudyResult,
    SweepPoint,
};
use calibration::{
    CalibrationFactor, DeclaredParameter, Observed, Point, PointResult, Question, ResidualPlan,
    StudyCondition, Validation, fit_surface, run_points, screen_factors, significant_factors,
    study_residual,
};
use campaign::{Campaign, Progress, RunRequest, Simulator};
use response_surface::{Fit, Measured, SolutionRequest, Solutions, solutions};
use run_store::{Lookup, Record, Store};
use scene::Scene;
use scene_simulator::{Binding, RunDetails, SceneSimulator};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// How the loop is run.
#[derive(Debug, Clone)]
pub struct RunSettings {
    /// Name of the profile.
    pub profile: String,
    /// First seed.
    pub seed: u64,
    /// Runs at a time.
    pub threads: usize,
    /// Result folder; the records are in its folder `runs`.
    pub folder: PathBuf,
    /// SHA-256 of each input file, for the record.
    pub inputs: BTreeMap<String, String>,
}

/// What all stages share.
pub(crate) struct Loop<'a> {
    /// The study.
    pub(crate) study: &'a StudyFile,
    /// The size of the loop.
    pub(crate) profile: &'a Profile,
    /// Settings of this run.
    pub(crate) settings: &'a RunSettings,
    /// The simulator.
    pub(crate) simulator: &'a SceneSimulator,
    /// Runs and their store.
    pub(crate) campaign: Campaign<'a>,
    /// All factors.
    factors: Vec<CalibrationFactor>,
    /// Where stages are announced.
    announce: &'a dyn Fn(&str),
}

/// Runs all stages of a study.
///
/// `announce` is told each stage as it begins; `progress` hears of each run.
///
/// # Errors
///
/// A file that cannot be meant, a target that the surface cannot reach, runs that failed.
pub fn run_study(
    study: &StudyFile,
    settings: &RunSettings,
    progress: &dyn Progress,
    stop: &AtomicBool,
    announce: &dyn Fn(&str),
) -> Result<StudyResult, Error> {
    let profile = study.profile(&settings.profile)?;
    let simulator = SceneSimulator::new(scenes(study, profile)?, bindings(study))?;
    let store = Store::open(settings.folder.join("runs"))?;
    let stages = Loop {
        study,
        profile,
        settings,
        simulator: &simulator,
        campaign: Campaign::new(&store, settings.threads, progress).with_stop(stop),
        factors: study.calibration_factors()?,
        announce,
    };
    let later = stages.hidden_measurements()?;
    let campaign = stages.campaign.with_meanwhile(&later);
    Loop { campaign, ..stages }.run(&store)
}

/// The scenes of a study with the changes of a profile.
fn scenes(study: &StudyFile, profile: &Profile) -> Result<BTreeMap<String, Scene>, Error> {
    let folder = study.path.parent().map_or_else(PathBuf::new, PathBuf::from);
    let changes = study.overrides(&profile.scene)?;
    let drum = Scene::read(&folder.join(&study.drum), &changes)?;
    // The metering device has its own sizes: changes of the apparatus are not for it.
    let shared: Vec<_> = changes
        .iter()
        .filter(|c| !c.name.starts_with("apparatus."))
        .cloned()
        .collect();
    let metering = Scene::read(&folder.join(&study.metering), &shared)?
        .with(&study.overrides(&profile.metering_scene)?)?;
    let mut hidden_changes = study.overrides(&study.hidden.scene)?;
    hidden_changes.extend(study.overrides(&profile.hidden_scene)?);
    let hidden = drum.with(&hidden_changes)?;
    Ok(BTreeMap::from([
        ("drum".to_owned(), drum),
        ("metering".to_owned(), metering),
        ("hidden".to_owned(), hidden),
    ]))
}

/// The settings that the parameters of a study stand for.
fn bindings(study: &StudyFile) -> BTreeMap<String, Binding> {
    let paths = study.factor.iter().map(|f| f.parameter.clone());
    paths
        .map(|path| (path.clone(), Binding::of_path(&path)))
        .collect()
}

impl Loop<'_> {
    /// All stages.
    fn run(&self, store: &Store) -> Result<StudyResult, Error> {
        (self.announce)("filling the seeds");
        let fillings = self.fillings()?;
        (self.announce)("screening (Plackett-Burman)");
        let screening = screen_factors(
            &self.campaign,
            self.simulator,
            &self.factors,
            &self.question(1_000, self.profile.screening_replicates, &[])?,
        )?;
        let rule = &self.study.screening;
        let kept_factors =
            significant_factors(&screening.screening, rule.alpha, rule.least_factors);
        (self.announce)("response surface (Box-Behnken)");
        let kept: Vec<_> = self
            .factors
            .iter()
            .filter(|f| kept_factors.iter().any(|s| s == f.factor.symbol()))
            .cloned()
            .collect();
        let question = self.question(10_000, self.profile.surface_replicates, &kept)?;
        let n_centre = self.profile.centre_points;
        let surface = fit_surface(&self.campaign, self.simulator, &kept, n_centre, &question)?;
        let solutions = self.solutions(&surface.fit, &kept)?;
        let (chosen, target_reached) = self.choose(&surface.fit, &solutions, &kept);
        (self.announce)("validation, sweeps and metering device");
        let singles = self.singles(store, &chosen)?;
        (self.announce)("residual at the bench measurements");
        let residual = self.residual()?;
        (self.announce)("campaign with a hidden effect");
        let hidden = self.hidden_campaign(true)?;
        (self.announce)("campaign with nothing hidden");
        let nothing_hidden = self.hidden_campaign(false)?;
        let cells = screening.cells.iter().chain(&surface.cells);
        let drum_keys: Vec<String> = cells.flat_map(|c| c.keys.iter().cloned()).collect();
        Ok(StudyResult {
            name: self.study.name.clone(),
            profile: self.settings.profile.clone(),
            version: env!("CARGO_PKG_VERSION").into(),
            seed: self.settings.seed,
            inputs: self.settings.inputs.clone(),
            image_against_position: image_against_position(store, &drum_keys)?,
            cost: self.cost(store, &drum_keys)?,
            remarks: remarks(&solutions, target_reached),
            fillings,
            screening,
            kept_factors,
            surface,
            solutions,
            chosen,
            target_reached,
            validation: singles.validation,
            published_optimum: singles.published_optimum,
            sweep: singles.sweep,
            metering: singles.metering,
            smoothness: singles.smoothness,
            residual,
            hidden,
            nothing_hidden,
        })
    }

    /// A drum run with every factor at its bench mean, except those of `free`.
    fn question(
        &self,
        seeds: u64,
        replicates: usize,
        free: &[CalibrationFactor],
    ) -> Result<Question<'_>, Error> {
        let mut base = RunRequest::new("drum", self.settings.seed + seeds);
        for factor in &self.factors {
            if !free.iter().any(|f| f.parameter == factor.parameter) {
                let measured = self.study.factor(factor.factor.symbol())?.measured.mean;
                base = base.with_parameter(&factor.parameter, measured);
            }
        }
        Ok(Question {
            base,
            observable: &self.study.target.observable,
            replicates,
        })
    }

    /// A run with all factors at the given values.
    fn at(&self, model: &str, values: &BTreeMap<String, f64>, seeds: u64) -> RunRequest {
        let mut request = RunRequest::new(model, self.settings.seed + seeds);
        for factor in &self.study.factor {
            let value = values
                .get(&factor.symbol)
                .copied()
                .unwrap_or(factor.measured.mean);
            request = request.with_parameter(&factor.parameter, value);
        }
        request
    }

    /// The seeds as bodies.
    fn fillings(&self) -> Result<Vec<FillingSummary>, Error> {
        let request = RunRequest::new("drum", 0);
        let scene = self
            .simulator
            .scene_of(&request)
            .map_err(|e| self.study.wrong("drum", e.to_string()))?;
        scene
            .seed
            .iter()
            .map(|seed| {
                let body = self.simulator.fillings().body(&scene, seed)?;
                Ok(FillingSummary {
                    name: seed.name.clone(),
                    spheres: body.clump.spheres().len(),
                    outer_spheres: body.outer.spheres().len(),
                    mass_kg: seed.mass_kg(),
                    fraction_density_kg_m3: body.fraction_density,
                    mesh_volume_mm3: body.mesh.mesh.moments().volume * 1e9,
                    fit: body.report,
                })
            })
            .collect()
    }

    /// The set of solutions for the measured angle.
    fn solutions(&self, fit: &Fit, kept: &[CalibrationFactor]) -> Result<Solutions, Error> {
        let target = &self.study.target;
        let mut near = Vec::new();
        for factor in kept {
            let m = self.study.factor(factor.factor.symbol())?.measured;
            near.push(Some(Measured {
                value: m.mean,
                sd: Some(m.sd),
                n: Some(m.n),
            }));
        }
        let request = SolutionRequest {
            target: target.value,
            target_sd: Some(target.sd),
            target_n: Some(target.n),
            near,
            error: None,
        };
        Ok(solutions(fit, &request)?)
    }

    /// The solution nearest to the bench means in units of their standard deviations; where the
    /// surface does not reach the target, the point of the box that comes nearest to it.
    fn choose(
        &self,
        fit: &Fit,
        solutions: &Solutions,
        kept: &[CalibrationFactor],
    ) -> (BTreeMap<String, f64>, bool) {
        let nearest = solutions.nearest.get("sd").map(|n| n.solution.clone());
        let reached = nearest.is_some();
        let point = nearest.unwrap_or_else(|| {
            let r = &solutions.reachable;
            let low = (r.min.value - solutions.target).abs();
            let end = if low < (r.max.value - solutions.target).abs() {
                &r.min
            } else {
                &r.max
            };
            fit.natural(&end.coded)
        });
        let symbols = kept.iter().map(|f| f.factor.symbol().to_owned());
        let mut chosen: BTreeMap<String, f64> = symbols.zip(point).collect();
        for factor in &self.study.factor {
            chosen
                .entry(factor.symbol.clone())
                .or_insert(factor.measured.mean);
        }
        (chosen, reached)
    }

    /// Runs at single points: the validation, the published optimum and one parameter varied from there,
    /// the metering device with the chosen parameters, smoother and smoother fillings at the bench
    /// measurements.
    fn singles(&self, store: &Store, chosen: &BTreeMap<String, f64>) -> Result<Singles, Error> {
        let runs = self.profile.point_runs;
        let angle = &self.study.target.observable;
        let point = |label: String, request, observable: &str, runs| Point {
            label,
            request,
            observable: observable.to_owned(),
            runs,
        };
        let optimum = &self.study.published_optimum;
        let mut points = vec![
            point(
                "validation".into(),
                self.at("drum", chosen, 20_000),
                angle,
                self.profile.validation_runs,
            ),
            point(
                "published optimum".into(),
                self.at("drum", optimum, 30_000),
                angle,
                runs,
            ),
            point(
                "metering device".into(),
                self.at("metering", chosen, 40_000),
                "filling_angle_deg",
                runs,
            ),
        ];
        let (symbol, levels) = (&self.study.sweep.symbol, &self.study.sweep.values);
        for value in levels {
            let mut values = optimum.clone();
            values.insert(symbol.clone(), *value);
            // The seeds do not depend on the value: the point at the optimum is run once.
            let request = self.at("drum", &values, 30_000);
            points.push(point(format!("{symbol} = {value}"), request, angle, runs));
        }
        let mut smoothnesses = vec![0.0];
        smoothnesses.extend(&self.study.residual.smoothness);
        for value in &smoothnesses {
            // The residual at the bench measurements finds these runs again.
            let request = self.at("drum", &BTreeMap::new(), 50_000);
            let request = request.with_effect("filling-smoothness", *value);
            points.push(point(format!("smoothness {value}"), request, angle, runs));
        }
        let results = run_points(&self.campaign, self.simulator, &points)?;
        let (single, series) = results.split_at(3);
        let (sweep, smoothness) = series.split_at(levels.len());
        let [validation, optimum, metering] = [0, 1, 2].map(|k| single[k].clone());
        Ok(Singles {
            validation: Validation::new(validation, self.study.target.value),
            published_optimum: optimum,
            sweep: with_regime(store, levels, sweep)?,
            metering: self.metering(metering),
            smoothness: with_regime(store, &smoothnesses, smoothness)?,
        })
    }

    /// Filling angle of the metering device beside the study's.
    fn metering(&self, result: PointResult) -> MeteringResult {
        let measured = self.study.published.filling_angle_measured_deg;
        MeteringResult {
            difference_percent: 100.0 * (result.mean - measured[0]).abs() / measured[0],
            result,
            published_measured_deg: measured,
            published_simulated_deg: self.study.published.filling_angle_simulated_deg,
        }
    }

    /// The residual of the one measured angle, with the bench measurements as priors.
    fn residual(&self) -> Result<calibration::ResidualStudy, Error> {
        let settings = &self.study.residual;
        let mut declared = Vec::new();
        for (symbol, step) in settings.factors.iter().zip(&settings.steps) {
            let factor = self.study.factor(symbol)?;
            declared.push(DeclaredParameter {
                name: factor.parameter.clone(),
                start: factor.measured.mean,
                step: *step,
                bounds: [0.0, 1.0],
                prior: Some([factor.measured.mean, factor.measured.sd]),
            });
        }
        let target = &self.study.target;
        let plan = ResidualPlan {
            id: "bench measurements against the drum".into(),
            base: self.at("drum", &BTreeMap::new(), 50_000),
            conditions: vec![StudyCondition {
                condition: BTreeMap::new(),
                used: true,
            }],
            observables: vec![target.observable.clone()],
            declared,
            effects: probes(&settings.effects)?,
            replicates: self.profile.residual_replicates,
            seed: self.settings.seed,
        };
        let observed = Observed {
            values: vec![vec![Some(target.value)]],
            covariance: vec![vec![vec![target.sd * target.sd / target.n as f64]]],
        };
        Ok(study_residual(
            &self.campaign,
            self.simulator,
            &plan,
            &observed,
        )?)
    }
}

/// Runs at single points.
struct Singles {
    /// At the chosen solution, against the target.
    validation: Validation,
    /// At the study's optimum.
    published_optimum: PointResult,
    /// Along one parameter from there.
    sweep: Vec<SweepPoint>,
    /// The metering device at the chosen solution.
    metering: MeteringResult,
    /// At the bench measurements, along the smoothness of the filling.
    smoothness: Vec<SweepPoint>,
}

/// Points of a sweep with regime and slip of their first runs.
fn with_regime(
    store: &Store,
    values: &[f64],
    results: &[PointResult],
) -> Result<Vec<SweepPoint>, Error> {
    let mut points = Vec::new();
    for (value, result) in values.iter().zip(results) {
        let record = match result.keys.first() {
            Some(key) => record_of(store, key)?,
            None => None,
        };
        let regime = record.as_ref().and_then(Record::regime);
        let slip = record.as_ref().and_then(|r| r.observable("shell_slip"));
        points.push(SweepPoint {
            value: *value,
            regime: regime.unwrap_or("unknown").to_owned(),
            shell_slip: slip.map_or(f64::NAN, |o| o.mean),
            result: result.clone(),
        });
    }
    Ok(points)
}

/// A record by its key.
fn record_of(store: &Store, key: &str) -> Result<Option<Record>, Error> {
    Ok(match store.get(key)? {
        Lookup::Found(record) => Some(record),
        _ => None,
    })
}

/// Image angle against position angle over drum runs.
fn image_against_position(store: &Store, keys: &[String]) -> Result<ImageAgainstPosition, Error> {
    let (mut means, mut sds, mut n_frames) = (Vec::new(), Vec::new(), 0);
    for key in keys {
        let record = record_of(store, key)?;
        let found = record
            .as_ref()
            .and_then(|r| r.observable("image_minus_position_deg"));
        if let Some(difference) = found {
            means.push(difference.mean);
            sds.extend(difference.sd);
            n_frames += difference.n;
        }
    }
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let square: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    Ok(ImageAgainstPosition {
        n_runs: means.len(),
        n_frames,
        mean_deg: mean,
        sd_of_runs_deg: (square / (n - 1.0)).sqrt(),
        sd_of_frames_deg: sds.iter().sum::<f64>() / sds.len() as f64,
    })
}

impl Loop<'_> {
    /// What the runs cost, and what profile `study` would.
    fn cost(&self, store: &Store, drum_keys: &[String]) -> Result<Cost, Error> {
        let version = self.simulator.version();
        let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for key in store.keys()? {
            if let Some(record) = record_of(store, &key)?.filter(|r| r.version() == version) {
                // The drums of the campaign with a hidden effect are all those that no other stage asked for.
                let scene = match record.inputs()["scene"]["apparatus"]["kind"].as_str() {
                    Some("drum") if !drum_keys.contains(&key) => "hidden",
                    other => other.unwrap_or_default(),
                };
                let time = RunDetails::of(&record)?.timing.wall_s;
                times.entry(scene.to_owned()).or_default().push(time);
            }
        }
        let all = times.values().flatten();
        let (mut drum_time, mut drum_steps) = (0.0, 0.0);
        for key in drum_keys {
            if let Some(record) = record_of(store, key)? {
                let timing = RunDetails::of(&record)?.timing;
                drum_time += timing.wall_s;
                drum_steps += timing.steps as f64;
            }
        }
        let study = self.study.profile("study").unwrap_or(self.profile);
        let campaign = &self.study.hidden;
        let conditions = campaign.conditions.len();
        let used = campaign.conditions.iter().filter(|c| c.used).count();
        // Probes once; data; and some nine rounds in both campaigns together: fits, sensitivities anew, the
        // model with the effect, corrections.
        let probes = (1 + campaign.factors.len() + campaign.effects.len()) * used;
        let hidden = 2 * conditions * campaign.measured_runs
            + (probes + 9 * conditions) * study.residual_replicates;
        let runs = 12 * study.screening_replicates
            + (12 + study.centre_points) * study.surface_replicates
            + study.validation_runs
            + (1 + self.study.sweep.values.len()) * study.point_runs
            + 10 * study.point_runs;
        // Time of a run there: as measured here, times the ratio of seeds and drum time.
        let there = SceneSimulator::new(scenes(self.study, study)?, bindings(self.study))?;
        let run_time = |scene: &str| {
            let request = RunRequest::new(scene, 0);
            let ratio = there.expected_cost(&request) / self.simulator.expected_cost(&request);
            ratio * mean(times.get(scene).map_or(&[], Vec::as_slice))
        };
        let study_time = runs as f64 * run_time("drum") + hidden as f64 * run_time("hidden");
        Ok(Cost {
            n_runs: all.clone().count(),
            run_time_s: all.sum(),
            drum_run_s: drum_time / drum_keys.len().max(1) as f64,
            drum_steps_per_s: drum_steps / drum_time.max(1e-9),
            study_profile_runs: runs + hidden,
            study_profile_core_hours: study_time / 3600.0,
        })
    }
}

/// Mean, 0 of nothing.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// What a reader should know.
fn remarks(solutions: &Solutions, reached: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    let (low, high) = (solutions.reachable.min.value, solutions.reachable.max.value);
    if !reached {
        remarks.push(format!(
            "The surface reaches {low:.2} to {high:.2} deg within the bounds of the design; the \
                 measured {:.2} deg lies outside. The validation is run at the point that comes \
                 nearest, and the difference is a finding, not a calibration.",
            solutions.target
        ));
    }
    remarks.push(
        "One angle cannot fix three parameters: the solutions form a surface, and the chosen \
             point is the one nearest to the bench means."
            .into(),
    );
    remarks.push(
        "The metering device's dimensions are assumed: its filling angle is no test of the \
             published value."
            .into(),
    );
    remarks
}
