//! What the file of a diagnosis says: measurements, declared parameters, effects, budget.

use crate::Error;
use crate::file::read_toml;
use crate::hidden::probes;
use calibration::{
    DeclaredParameter, EffectProbe, Observed, ResidualPlan, StudyCondition, least_budget,
    runs_needed, within_budget,
};
use campaign::RunRequest;
use scene::{Override, Scene};
use scene_simulator::{Binding, SceneSimulator};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Name under which the scene of a diagnosis is run.
pub(crate) const MODEL: &str = "diagnosis";

/// A diagnosis: what was measured, and what may be missing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiagnosisFile {
    /// Name; also that of the result folder.
    pub name: String,
    /// Scene of the apparatus, relative to this file.
    pub scene: PathBuf,
    /// Changes of the scene for all runs, `name = value`.
    #[serde(default)]
    pub changes: Vec<String>,
    /// Effects to search; the whole library where absent.
    #[serde(default)]
    pub effects: Option<Vec<String>>,
    /// Runs behind each simulated mean: 2 or more, they give the noise of the simulator.
    pub replicates: usize,
    /// Largest number of runs.
    pub budget_runs: usize,
    /// Parameters that may be tuned again.
    pub declared: Vec<DeclaredEntry>,
    /// What was measured, condition by condition.
    pub measured: Vec<MeasuredEntry>,
    /// Where the file is.
    #[serde(skip)]
    pub path: PathBuf,
}

/// A parameter that may be tuned again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeclaredEntry {
    /// Setting of the scene by its dotted path; it must be a plain number.
    pub parameter: String,
    /// Value at which the simulator is linearised.
    pub start: f64,
    /// Step of the finite difference.
    pub step: f64,
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// What a bench measurement says of it: mean and standard deviation; free where absent.
    #[serde(default)]
    pub prior: Option<Prior>,
}

/// A normal prior.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prior {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// What a condition serves for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The fit may use it.
    Fit,
    /// It is kept for the check.
    Check,
}

/// The measurements at one condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredEntry {
    /// Conditions of the run: rpm, seed count.
    pub condition: BTreeMap<String, f64>,
    /// Fit or check, decided before anyone looks at the residual.
    pub role: Role,
    /// Means by observable.
    pub values: BTreeMap<String, Measurement>,
}

/// A measured mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// Mean, in the unit of the observable.
    pub mean: f64,
    /// Standard deviation of the single values.
    pub sd: f64,
    /// Number of independent values.
    pub n: usize,
}

/// A diagnosis that is ready to be run.
#[derive(Debug)]
pub struct PlannedDiagnosis {
    /// The scene as a simulator.
    pub simulator: SceneSimulator,
    /// What is run, within the budget.
    pub plan: ResidualPlan,
    /// What was measured.
    pub observed: Observed,
    /// Largest number of runs of the plan.
    pub runs: usize,
    /// Effects that the scene cannot carry, with the reason.
    pub not_applicable: BTreeMap<String, String>,
    /// Number of conditions that the budget took out of the fit.
    pub taken_out: usize,
}

impl DiagnosisFile {
    /// Reads the file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, text that is no diagnosis, numbers that cannot be meant.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let mut file: Self = read_toml(path)?;
        path.clone_into(&mut file.path);
        file.check()?;
        Ok(file)
    }

    /// The scene file.
    pub fn scene_path(&self) -> PathBuf {
        self.path
            .parent()
            .unwrap_or(Path::new(""))
            .join(&self.scene)
    }

    /// Plans the runs, without doing any.
    ///
    /// # Errors
    ///
    /// A scene, condition, parameter or effect that cannot be meant; a budget that tests nothing.
    pub fn plan(&self, seed: u64) -> Result<PlannedDiagnosis, Error> {
        let changes = overrides(&self.changes).map_err(|text| {
            self.wrong(
                format!("scene change '{text}'"),
                "has no '='; write 'name = value'",
            )
        })?;
        let scene = Scene::read(&self.scene_path(), &changes)?;
        let simulator =
            SceneSimulator::new(BTreeMap::from([(MODEL.to_owned(), scene)]), self.bindings())?;
        let names = self.effects.clone().unwrap_or_else(effect_library::names);
        let base = RunRequest::new(MODEL, seed);
        let (mut effects, mut not_applicable) = (Vec::new(), BTreeMap::new());
        let probes = probes(&names).map_err(|e| self.wrong("effects:", e.to_string()))?;
        for probe in probes {
            match simulator.scene_of(&self.first_request(&base, Some(&probe))) {
                Ok(_) => effects.push(probe),
                Err(reason) => {
                    not_applicable.insert(probe.name, reason.to_string());
                }
            }
        }
        for entry in &self.measured {
            let mut request = self.first_request(&base, None);
            request.condition.clone_from(&entry.condition);
            let checked = simulator.scene_of(&request);
            checked.map_err(|e| {
                self.wrong(format!("condition {:?}", entry.condition), e.to_string())
            })?;
        }
        let plan = ResidualPlan {
            id: self.name.clone(),
            base,
            conditions: self.conditions(),
            observables: self.observables(),
            declared: self
                .declared
                .iter()
                .map(DeclaredEntry::as_declared)
                .collect(),
            effects,
            replicates: self.replicates,
            seed,
        };
        let Some(least) = least_budget(&plan) else {
            return Err(self.wrong(
                format!("[[declared]] x {}", plan.declared.len()),
                "takes up all values of the conditions that the fit uses, so that nothing can be tested: \
                 declare fewer parameters, or measure more conditions or observables",
            ));
        };
        if self.budget_runs < least {
            let problem = format!(
                "is too few to test anything: write {least} or more (a test needs more values than declared \
                 parameters), or name fewer effects"
            );
            return Err(self.wrong(format!("budget_runs = {}", self.budget_runs), problem));
        }
        let within = within_budget(&plan, self.budget_runs)?;
        let used = |p: &ResidualPlan| p.conditions.iter().filter(|c| c.used).count();
        Ok(PlannedDiagnosis {
            simulator,
            runs: runs_needed(&within),
            taken_out: used(&plan) - used(&within),
            observed: self.observed(),
            plan: within,
            not_applicable,
        })
    }

    /// The settings that the declared parameters stand for.
    fn bindings(&self) -> BTreeMap<String, Binding> {
        let paths = self.declared.iter().map(|d| d.parameter.as_str());
        paths
            .map(|path| (path.to_owned(), Binding::of_path(path)))
            .collect()
    }

    /// A run at the first condition and the starting values, with an effect at its probe.
    fn first_request(&self, base: &RunRequest, effect: Option<&EffectProbe>) -> RunRequest {
        let mut request = base.clone();
        if let Some(first) = self.measured.first() {
            request.condition.clone_from(&first.condition);
        }
        for declared in &self.declared {
            request = request.with_parameter(&declared.parameter, declared.start);
        }
        match effect {
            Some(probe) => request.with_effect(&probe.name, probe.probe),
            None => request,
        }
    }

    /// Names of all observables.
    fn observables(&self) -> Vec<String> {
        let names = self.measured.iter().flat_map(|m| m.values.keys().cloned());
        names.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Conditions in the order of the file.
    fn conditions(&self) -> Vec<StudyCondition> {
        let condition = |m: &MeasuredEntry| StudyCondition {
            condition: m.condition.clone(),
            used: m.role == Role::Fit,
        };
        self.measured.iter().map(condition).collect()
    }

    /// Means with the squares of their standard errors; different observables are taken as
    /// independent.
    fn observed(&self) -> Observed {
        let names = self.observables();
        let mut observed = Observed {
            values: Vec::new(),
            covariance: Vec::new(),
        };
        for entry in &self.measured {
            let of = |name: &String| entry.values.get(name);
            observed
                .values
                .push(names.iter().map(|n| of(n).map(|m| m.mean)).collect());
            let square = |m: &Measurement| m.sd * m.sd / m.n as f64;
            let mut block = vec![vec![0.0; names.len()]; names.len()];
            for (k, name) in names.iter().enumerate() {
                block[k][k] = of(name).map_or(0.0, square);
            }
            observed.covariance.push(block);
        }
        observed
    }

    /// An error about an entry.
    fn wrong(&self, what: impl Into<String>, problem: impl Into<String>) -> Error {
        Error::Meaning {
            file: self.path.display().to_string(),
            what: what.into(),
            problem: problem.into(),
        }
    }

    /// Refuses numbers that cannot be meant.
    fn check(&self) -> Result<(), Error> {
        if self.replicates < 2 {
            return Err(self.wrong(
                format!("replicates = {}", self.replicates),
                "must be 2 or more: they give the noise of the simulator",
            ));
        }
        if !self.measured.iter().any(|m| m.role == Role::Fit) {
            return Err(self.wrong(
                "measured",
                "has no condition with role = \"fit\"; the fit needs one",
            ));
        }
        for d in &self.declared {
            let bounded = d.low.is_finite() && d.high.is_finite();
            let inside = bounded && d.low <= d.start && d.start <= d.high;
            let prior = d.prior.is_none_or(|p| p.mean.is_finite() && p.sd > 0.0);
            let moved = (d.low..=d.high).contains(&(d.start + d.step));
            if !(inside && prior && moved && d.step != 0.0) {
                return Err(self.wrong(
                    format!("declared '{}'", d.parameter),
                    "needs start and start + step within finite low and high, a step other than 0, and an \
                     sd above 0 in its prior",
                ));
            }
        }
        for entry in &self.measured {
            let finite = |m: &Measurement| m.mean.is_finite() && m.sd.is_finite();
            for (name, m) in &entry.values {
                if !(finite(m) && m.sd > 0.0 && m.n >= 1) {
                    return Err(self.wrong(
                        format!("'{name}' at {:?}", entry.condition),
                        "needs a finite mean, an sd above 0 and n of 1 or more",
                    ));
                }
            }
            let twice = self
                .measured
                .iter()
                .filter(|other| other.condition == entry.condition);
            if twice.count() > 1 {
                return Err(self.wrong(
                    format!("condition {:?}", entry.condition),
                    "stands there twice; put all its values into one entry",
                ));
            }
        }
        Ok(())
    }
}

impl DeclaredEntry {
    /// As the calibration wants it.
    pub fn as_declared(&self) -> DeclaredParameter {
        DeclaredParameter {
            name: self.parameter.clone(),
            start: self.start,
            step: self.step,
            bounds: [self.low, self.high],
            prior: self.prior.map(|p| [p.mean, p.sd]),
        }
    }
}

/// Changes `name = value` as overrides.
///
/// # Errors
///
/// A text without an equals sign comes back.
pub fn overrides(changes: &[String]) -> Result<Vec<Override>, String> {
    let one = |text: &String| {
        let (name, value) = text.split_once('=').ok_or_else(|| text.clone())?;
        Ok(Override {
            name: name.trim().into(),
            value: value.trim().into(),
        })
    };
    changes.iter().map(one).collect()
}
