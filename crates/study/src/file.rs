//! What a study file says.

use crate::Error;
use crate::diagnosis_file::overrides;
use calibration::CalibrationFactor;
use experiment_design::Factor;
use scene::Override;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Name; also that of the result folder.
    pub name: String,
    /// Scene of the drum, relative to the study file.
    pub drum: PathBuf,
    /// Scene of the metering device.
    pub metering: PathBuf,
    /// What was measured in the drum.
    pub target: Target,
    /// What was published, for comparison.
    pub published: Published,
    /// Contact parameters to calibrate.
    pub factor: Vec<FactorEntry>,
    /// How screening decides.
    pub screening: ScreeningSettings,
    /// The optimum that was published, by symbol.
    pub published_optimum: BTreeMap<String, f64>,
    /// Angle against one parameter.
    pub sweep: Sweep,
    /// The residual at the bench measurements.
    pub residual: ResidualSettings,
    /// The campaign with a hidden effect.
    pub hidden: HiddenSettings,
    /// Sizes of the loop by name.
    pub profile: BTreeMap<String, Profile>,
    /// Where the file is.
    #[serde(skip)]
    pub path: PathBuf,
}

/// A measured mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredMean {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of single measurements.
    pub sd: f64,
    /// Number of measurements.
    pub n: usize,
}

/// The measurement that the calibration must meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Name of the observable.
    pub observable: String,
    /// Mean, in the unit of the observable.
    pub value: f64,
    /// Standard deviation over frames.
    pub sd: f64,
    /// Number of frames.
    pub n: usize,
}

/// Published results: mean and standard deviation, deg.
#[expect(clippy::struct_field_names, reason = "keys of a file carry their unit")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Simulated angle at the published optimum.
    pub validation_angle_deg: [f64; 2],
    /// Measured filling angle.
    pub filling_angle_measured_deg: [f64; 2],
    /// Simulated filling angle.
    pub filling_angle_simulated_deg: [f64; 2],
    /// Simulated angle with the bench measurements.
    pub sliding_angle_at_measured_deg: f64,
}

/// One factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FactorEntry {
    /// Symbol.
    pub symbol: String,
    /// What it is.
    pub name: String,
    /// Setting of the scene.
    pub parameter: String,
    /// Low level.
    pub low: f64,
    /// High level.
    pub high: f64,
    /// Bench measurement.
    pub measured: MeasuredMean,
}

/// How screening decides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScreeningSettings {
    /// Level of significance.
    pub alpha: f64,
    /// Number of factors to keep at least.
    pub least_factors: usize,
}

/// Angle against one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Symbol of the factor.
    pub symbol: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// The residual at the bench measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResidualSettings {
    /// Symbols of the declared parameters.
    pub factors: Vec<String>,
    /// Steps of the finite differences.
    pub steps: Vec<f64>,
    /// Effects to search.
    pub effects: Vec<String>,
    /// Amplitudes of filling-smoothness at which the angle is shown.
    pub smoothness: Vec<f64>,
}

/// A condition of the hidden campaign.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HiddenCondition {
    /// Speed, rpm.
    pub rpm: f64,
    /// Number of seeds over the full number.
    pub fill: f64,
    /// Whether the fit may use it.
    pub used: bool,
}

/// The campaign with a hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HiddenSettings {
    /// The effect that made the data.
    pub effect: String,
    /// Its amplitude.
    pub amplitude: f64,
    /// Observables.
    pub observables: Vec<String>,
    /// Noise of reading each observable, in its unit.
    pub reading_sd: Vec<f64>,
    /// Runs behind each measured value: 2 or more.
    pub measured_runs: usize,
    /// Effects to search.
    pub effects: Vec<String>,
    /// Symbols of the declared parameters.
    pub factors: Vec<String>,
    /// Values that made the data.
    pub true_values: Vec<f64>,
    /// Values from which the fit starts.
    pub starts: Vec<f64>,
    /// Steps of the finite differences.
    pub steps: Vec<f64>,
    /// Bounds.
    pub bounds: Vec<[f64; 2]>,
    /// Whether the bench measurement of each factor is its prior.
    pub bench_prior: Vec<bool>,
    /// Changes of the drum scene.
    pub scene: Vec<String>,
    /// Number of seeds at fill 1.
    pub full_seed_count: usize,
    /// Conditions.
    pub conditions: Vec<HiddenCondition>,
}

/// A size of the loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Runs in each cell of the screening design.
    pub screening_replicates: usize,
    /// Runs in each cell of the surface design.
    pub surface_replicates: usize,
    /// Centre points of the surface design.
    pub centre_points: usize,
    /// Runs of the validation.
    pub validation_runs: usize,
    /// Runs at each point of the sweep, of the metering device and of the smoothness series.
    pub point_runs: usize,
    /// Runs for each nominal mean of the residual studies.
    pub residual_replicates: usize,
    /// Changes of both scenes, `name = value`; those of the apparatus are for the drum alone.
    pub scene: Vec<String>,
    /// Further changes of the metering scene.
    #[serde(default)]
    pub metering_scene: Vec<String>,
    /// Further changes of the drum of the hidden campaign, after those of the campaign itself.
    #[serde(default)]
    pub hidden_scene: Vec<String>,
    /// Number of seeds at fill 1 in the hidden campaign; that of the campaign where absent.
    #[serde(default)]
    pub hidden_full_seed_count: Option<usize>,
}

/// Reads a file of settings; the message of an error names file and line.
pub(crate) fn read_toml<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, Error> {
    let text = std::fs::read_to_string(path).map_err(|source| Error::File {
        what: "read",
        path: path.to_owned(),
        source,
    })?;
    toml::from_str(&text).map_err(|e| Error::Text {
        file: path.display().to_string(),
        message: e.to_string(),
    })
}

impl StudyFile {
    /// Reads a study file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, text that is no study, numbers that cannot be meant.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let mut study: Self = read_toml(path)?;
        path.clone_into(&mut study.path);
        study.check()?;
        Ok(study)
    }

    /// An error about an entry.
    pub(crate) fn wrong(&self, what: impl Into<String>, problem: impl Into<String>) -> Error {
        let file = self.path.display().to_string();
        Error::Meaning {
            file,
            what: what.into(),
            problem: problem.into(),
        }
    }

    /// The profile of a name.
    ///
    /// # Errors
    ///
    /// A name that the file does not have.
    pub fn profile(&self, name: &str) -> Result<&Profile, Error> {
        self.profile.get(name).ok_or_else(|| {
            let known: Vec<_> = self.profile.keys().map(String::as_str).collect();
            self.wrong(
                format!("profile '{name}'"),
                format!("is not defined; there are {}", known.join(", ")),
            )
        })
    }

    /// The factor of a symbol.
    ///
    /// # Errors
    ///
    /// A symbol that the file does not have.
    pub fn factor(&self, symbol: &str) -> Result<&FactorEntry, Error> {
        self.factor
            .iter()
            .find(|f| f.symbol == symbol)
            .ok_or_else(|| {
                let known: Vec<_> = self.factor.iter().map(|f| f.symbol.as_str()).collect();
                self.wrong(
                    format!("factor '{symbol}'"),
                    format!("is not defined; there are {}", known.join(", ")),
                )
            })
    }

    /// All factors as the calibration wants them.
    ///
    /// # Errors
    ///
    /// Levels that cannot be meant.
    pub fn calibration_factors(&self) -> Result<Vec<CalibrationFactor>, Error> {
        self.factor
            .iter()
            .map(|f| {
                Ok(CalibrationFactor {
                    factor: Factor::new(&f.symbol, &f.name, "1", f.low, f.high)?,
                    parameter: f.parameter.clone(),
                })
            })
            .collect()
    }

    /// Changes `name = value` as overrides.
    ///
    /// # Errors
    ///
    /// A change without an equals sign.
    pub fn overrides(&self, changes: &[String]) -> Result<Vec<Override>, Error> {
        overrides(changes).map_err(|text| {
            self.wrong(
                format!("scene change '{text}'"),
                "has no '='; write 'name = value'",
            )
        })
    }

    /// Refuses numbers that cannot be meant.
    fn check(&self) -> Result<(), Error> {
        let t = &self.target;
        if !(t.value.is_finite() && t.sd.is_finite() && t.sd >= 0.0 && t.n >= 1) {
            return Err(self.wrong(
                "target",
                "needs a finite value, an sd of 0 or more and n of 1 or more",
            ));
        }
        self.check_factors()?;
        self.check_hidden()?;
        for (name, profile) in &self.profile {
            self.check_profile(name, profile)?;
        }
        self.check_steps("residual", &self.residual.factors, &self.residual.steps)?;
        for symbol in self
            .residual
            .factors
            .iter()
            .chain(&self.hidden.factors)
            .chain(std::iter::once(&self.sweep.symbol))
            .chain(self.published_optimum.keys())
        {
            self.factor(symbol)?;
        }
        for (part, names) in [
            ("residual", self.residual.effects.as_slice()),
            ("hidden", &self.hidden.effects),
            ("hidden", std::slice::from_ref(&self.hidden.effect)),
        ] {
            for name in names {
                effect_library::find(name)
                    .map_err(|e| self.wrong(format!("[{part}]:"), e.to_string()))?;
            }
        }
        Ok(())
    }

    /// Refuses factors that cannot be meant.
    fn check_factors(&self) -> Result<(), Error> {
        for (k, f) in self.factor.iter().enumerate() {
            let other = |o: &&FactorEntry| o.parameter == f.parameter || o.symbol == f.symbol;
            if let Some(other) = self.factor[..k].iter().find(other) {
                let what = format!("factor '{}'", f.symbol);
                let problem = format!(
                    "has the symbol or the parameter '{}' of factor '{}': give each factor its own",
                    f.parameter, other.symbol
                );
                return Err(self.wrong(what, problem));
            }
            let m = &f.measured;
            if !(m.mean.is_finite() && m.sd > 0.0 && m.n >= 1) {
                let what = format!("measured of factor '{}'", f.symbol);
                return Err(self.wrong(
                    what,
                    "needs a finite mean, an sd above 0 and n of 1 or more",
                ));
            }
            if f.low < 0.0 || f.high <= f.low {
                let what = format!("levels {} to {} of factor '{}'", f.low, f.high, f.symbol);
                return Err(
                    self.wrong(what, "must rise, and a contact parameter is never negative")
                );
            }
        }
        Ok(())
    }

    /// Refuses steps of finite differences that cannot be meant.
    fn check_steps(&self, what: &str, factors: &[String], steps: &[f64]) -> Result<(), Error> {
        if steps.len() != factors.len() {
            return Err(self.wrong(what, "needs as many steps as factors"));
        }
        if steps.iter().any(|s| !s.is_finite() || *s == 0.0) {
            return Err(self.wrong(what, "needs finite steps other than 0"));
        }
        Ok(())
    }

    /// Refuses a profile whose runs give no mean, or no scatter where a scatter is needed.
    fn check_profile(&self, name: &str, profile: &Profile) -> Result<(), Error> {
        let counts = [
            ("screening_replicates", profile.screening_replicates, 1),
            ("surface_replicates", profile.surface_replicates, 1),
            ("centre_points", profile.centre_points, 1),
            ("validation_runs", profile.validation_runs, 1),
            ("point_runs", profile.point_runs, 1),
            ("residual_replicates", profile.residual_replicates, 2),
        ];
        match counts.iter().find(|(_, given, least)| given < least) {
            Some((key, given, least)) => Err(self.wrong(
                format!("{key} = {given} of profile '{name}'"),
                format!("must be {least} or more"),
            )),
            None => Ok(()),
        }
    }

    /// Refuses a hidden campaign that cannot be meant.
    fn check_hidden(&self) -> Result<(), Error> {
        let h = &self.hidden;
        let same = [
            h.true_values.len(),
            h.starts.len(),
            h.steps.len(),
            h.bounds.len(),
            h.bench_prior.len(),
        ];
        if same.iter().any(|n| *n != h.factors.len()) {
            return Err(self.wrong(
                "hidden",
                "needs as many true_values, starts, steps, bounds and bench_prior as factors",
            ));
        }
        let readings = h.reading_sd.iter().all(|sd| sd.is_finite() && *sd >= 0.0);
        if h.reading_sd.len() != h.observables.len() || !readings || h.measured_runs < 2 {
            return Err(self.wrong(
                "hidden",
                "needs one reading_sd of 0 or more for each observable and two measured_runs or more",
            ));
        }
        self.check_steps("hidden", &h.factors, &h.steps)?;
        let places = h.bounds.iter().zip(&h.starts).zip(&h.steps);
        for (symbol, ((&[low, high], &start), &step)) in h.factors.iter().zip(places) {
            let within = |x: f64| low <= x && x <= high;
            if !(low.is_finite() && high.is_finite() && within(start) && within(start + step)) {
                return Err(self.wrong(
                    format!("hidden, factor '{symbol}'"),
                    format!(
                        "starts at {start} with a step of {step}: both the start and the start plus \
                         the step must lie within its bounds {low} to {high}"
                    ),
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::StudyFile;

    /// The study of the fixtures with a piece of its text replaced.
    fn changed(from: &str, to: &str) -> Result<StudyFile, String> {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../fixtures/cotton/study.toml"
        );
        let text = std::fs::read_to_string(path).expect("the fixture");
        assert!(text.contains(from), "{from}");
        let study: StudyFile = toml::from_str(&text.replacen(from, to, 1)).expect("a study");
        study.check().map(|()| study).map_err(|e| e.to_string())
    }

    /// What would be found out after hours of runs, or never, is refused when the file is read.
    #[test]
    fn what_cannot_be_meant_is_refused_at_once() {
        assert!(
            changed("name", "name").is_ok(),
            "the fixture itself is fine"
        );
        for (from, to, place) in [
            (
                "\"contact.seed-tough_resin.static_friction\"",
                "\"contact.seed-tough_resin.restitution\"",
                "factor 'B'",
            ),
            (
                "bench_prior = [true, true]",
                "bench_prior = [true]",
                "bench_prior",
            ),
            (
                "residual_replicates = 5",
                "residual_replicates = 1",
                "profile 'study'",
            ),
            (
                "validation_runs = 2",
                "validation_runs = 0",
                "validation_runs = 0",
            ),
            ("steps = [0.10, -0.30]", "steps = [0.0, -0.30]", "residual"),
            (
                "starts = [0.56, 0.32]",
                "starts = [0.9, 0.32]",
                "factor 'F'",
            ),
            ("reading_sd = [0.1,", "reading_sd = [-0.1,", "reading_sd"),
            (
                "effects = [\"rolling",
                "effects = [\"roling",
                "[residual]: no effect 'roling-resistance'",
            ),
            (
                "effect = \"rolling",
                "effect = \"roling",
                "[hidden]: no effect 'roling-resistance'",
            ),
        ] {
            let refused = changed(from, to).expect_err(to);
            assert!(refused.contains(place), "{to}: {refused}");
        }
    }
}
