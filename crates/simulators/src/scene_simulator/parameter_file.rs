//! Calibrated values as a file that other commands take over.

use crate::scene_simulator::Error;
use crate::scene_simulator::binding::has_setting;
use scene::{FillingLibrary, Override, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Unit of a pure number.
const PURE_NUMBER: &str = "1";

/// Start of the first line, a comment, by which a file without `met` says that its fit is not met.
const NOT_MET: &str = "# NOT MET: ";

/// The parameters of a calibration: `parameters.toml`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterFile {
    /// Whether the parameters meet the measurements and the check of their calibration; `None` if the file does not say it, as one
    /// that was typed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub met: Option<bool>,
    /// The verdict of the calibration, a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<String>,
    /// The parameters, in the order of the study.
    pub parameter: Vec<CalibratedParameter>,
    /// Effects of the library with which they were calibrated, since the scenes alone lack them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effect: Vec<CalibratedEffect>,
    /// Name of the file, for messages.
    #[serde(skip)]
    pub file: String,
}

/// A parameter with its value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibratedParameter {
    /// Symbol.
    pub symbol: String,
    /// Description for the reader.
    pub name: String,
    /// Dotted paths of the settings that get its value.
    pub sets: Vec<String>,
    /// The value, in `unit`.
    pub value: f64,
    /// Unit of value, standard error and interval; a pure number if omitted or `1`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Standard error, in `unit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub se: Option<f64>,
    /// Two-sided 95 % interval, in `unit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval95: Option<[f64; 2]>,
    /// Whether the measurements fix the parameter; where not, the value is one of many.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed_by_data: Option<bool>,
    /// Whether the value stands at a limit of what is physically possible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_limit: Option<bool>,
}

/// An effect that is switched on in scenes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibratedEffect {
    /// Its name in the library.
    pub name: String,
    /// Its amplitude, in the unit of the library.
    pub amplitude: f64,
}

impl CalibratedParameter {
    /// Unit of the settings; none of a pure number.
    fn setting_unit(&self) -> Option<&str> {
        self.unit.as_deref().filter(|unit| *unit != PURE_NUMBER)
    }

    /// Fault of the parameter, and the remedy.
    fn problem(&self) -> Option<String> {
        if !self.value.is_finite() {
            return Some(format!(
                "has the value {}: give a finite number",
                self.value
            ));
        }
        if self.sets.is_empty() {
            return Some("sets nothing: give the dotted paths of its settings in 'sets'".into());
        }
        if let Some(se) = self.se.filter(|se| !(se.is_finite() && *se >= 0.0)) {
            return Some(format!("has se = {se}: give a finite number, 0 or more"));
        }
        match self.interval95 {
            Some([low, high]) if !(low <= self.value && self.value <= high) => Some(format!(
                "has interval95 = [{low}, {high}] and value = {}: the value lies between the two",
                self.value
            )),
            _ => None,
        }
    }
}

impl ParameterFile {
    /// Reads a parameter file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, text that is not a parameter file, an invalid number, two parameters
    /// that set one path.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = input::file::read_text(path).map_err(|source| Error::Read {
            path: path.to_owned(),
            source,
        })?;
        let file = path.display().to_string();
        let mut read: Self = toml::from_str(&text).map_err(|e| Error::Text {
            file: file.clone(),
            message: e.to_string(),
        })?;
        read.file = file;
        if read.met.is_none()
            && let Some(verdict) = text
                .lines()
                .next()
                .and_then(|line| line.strip_prefix(NOT_MET))
        {
            (read.met, read.verdict) = (Some(false), Some(verdict.to_owned()));
        }
        read.check()?;
        Ok(read)
    }

    /// Refuses what is invalid.
    fn check(&self) -> Result<(), Error> {
        let wrong = |parameter: &CalibratedParameter, problem: String| Error::Parameter {
            file: self.file.clone(),
            symbol: parameter.symbol.clone(),
            problem,
        };
        let mut by_path: BTreeMap<&str, &str> = BTreeMap::new();
        for parameter in &self.parameter {
            if let Some(problem) = parameter.problem() {
                return Err(wrong(parameter, problem));
            }
            for path in &parameter.sets {
                if let Some(other) = by_path.insert(path, &parameter.symbol) {
                    let problem = format!(
                        "sets '{path}', which parameter '{other}' sets as well: leave one of them"
                    );
                    return Err(wrong(parameter, problem));
                }
            }
        }
        Ok(())
    }

    /// The text of the file; reading it back gives the same bits.
    ///
    /// # Errors
    ///
    /// Parameters that have no form in TOML.
    pub fn to_toml(&self) -> Result<String, Error> {
        Ok(toml::to_string(self)?)
    }

    /// What whoever uses the values must know, each a sentence that names the file: that the fit was not met, and parameters that it
    /// left open.
    pub fn doubts(&self) -> Vec<String> {
        let file = &self.file;
        let mut doubts = Vec::new();
        if self.met == Some(false) {
            let verdict = self.verdict.as_deref().unwrap_or("its calibration failed");
            doubts.push(format!("{file}: NOT MET: {verdict}"));
        }
        let open = self
            .parameter
            .iter()
            .filter(|p| p.fixed_by_data == Some(false));
        let open: Vec<&str> = open.map(|p| p.symbol.as_str()).collect();
        if !open.is_empty() {
            doubts.push(format!(
                "{file}: the measurements do not fix {}: the value is one of many",
                open.join(", ")
            ));
        }
        doubts
    }

    /// The same, and parameters that set nothing in a scene.
    ///
    /// # Errors
    ///
    /// As [`Self::overrides`].
    pub fn warnings(&self, scene: &Scene) -> Result<Vec<String>, Error> {
        let mut warnings = self.doubts();
        for parameter in &self.parameter {
            let mut sets = false;
            for path in &parameter.sets {
                sets |= self.has(scene, parameter, path)?;
            }
            if !sets {
                warnings.push(format!(
                    "{}: {} ({}) = {} is not carried over: {} has no {}; state the value yourself, or give the materials the \
                     names that they were calibrated with",
                    self.file,
                    parameter.symbol,
                    parameter.name,
                    parameter.value,
                    scene.file,
                    parameter.sets.join(" and no ")
                ));
            }
        }
        Ok(warnings)
    }

    /// Whether a scene has a setting of a parameter.
    fn has(
        &self,
        scene: &Scene,
        parameter: &CalibratedParameter,
        path: &str,
    ) -> Result<bool, Error> {
        let has = has_setting(scene, path, parameter.setting_unit());
        has.map_err(|source| Error::Parameter {
            file: self.file.clone(),
            symbol: parameter.symbol.clone(),
            problem: format!("cannot be set: {source}"),
        })
    }

    /// A scene with the values, and with the effects switched on that it can carry; the others, a sentence each.
    ///
    /// # Errors
    ///
    /// As [`Self::overrides`]; an effect that the library lacks, an amplitude that is impossible.
    pub fn applied(&self, scene: &Scene) -> Result<(Scene, Vec<String>), Error> {
        let changes = self.overrides(scene)?;
        let scene = scene.with(&changes).map_err(Error::Scene)?;
        self.switched_on(scene)
    }

    /// A scene with the effects that it can carry; the others, a sentence each.
    fn switched_on(&self, mut scene: Scene) -> Result<(Scene, Vec<String>), Error> {
        let (fillings, mut told) = (FillingLibrary::default(), Vec::new());
        for CalibratedEffect { name, amplitude } in &self.effect {
            let wrong = |source: crate::effects::Error| Error::Text {
                file: self.file.clone(),
                message: source.to_string(),
            };
            match crate::effects::apply(&mut scene, name, *amplitude, &fillings) {
                Ok(()) => {}
                Err(source @ crate::effects::Error::Setting { .. }) => {
                    told.push(format!(
                        "{}: not carried over to {}: {source}",
                        self.file, scene.file
                    ));
                }
                Err(source) => return Err(wrong(source)),
            }
        }
        Ok((scene, told))
    }

    /// The changes that the parameters make in a scene; paths that it does not have are skipped.
    ///
    /// # Errors
    ///
    /// [`Error::NothingToSet`] when the scene has none of the paths; a setting that takes no number with that unit.
    pub fn overrides(&self, scene: &Scene) -> Result<Vec<Override>, Error> {
        let mut overrides = Vec::new();
        for parameter in &self.parameter {
            let unit = parameter.setting_unit();
            for path in &parameter.sets {
                if self.has(scene, parameter, path)? {
                    overrides.push(Override::number(path, parameter.value, unit));
                }
            }
        }
        if overrides.is_empty() {
            let paths: Vec<&str> = self
                .parameter
                .iter()
                .flat_map(|p| &p.sets)
                .map(String::as_str)
                .collect();
            return Err(Error::NothingToSet {
                file: self.file.clone(),
                scene: scene.file.clone(),
                paths: paths.join(", "),
            });
        }
        Ok(overrides)
    }
}

/// A scene as it is run.
#[derive(Debug)]
pub struct ReadScene {
    /// The scene.
    pub scene: Scene,
    /// All settings that were changed, in the order in which they were.
    pub changes: Vec<Override>,
    /// Warnings about the values of the parameter file.
    pub warnings: Vec<String>,
}

/// Reads a scene with the values of a parameter file, if one is given, and then with further settings.
///
/// # Errors
///
/// A scene or parameter file that cannot be read, settings that the scene does not have.
pub fn read_scene(
    file: &Path,
    set_file: Option<&Path>,
    set: &[Override],
) -> Result<ReadScene, Error> {
    let scene = Scene::read(file, set)?;
    let Some(set_file) = set_file else {
        return Ok(ReadScene {
            scene,
            changes: set.to_vec(),
            warnings: Vec::new(),
        });
    };
    let parameters = ParameterFile::read(set_file)?;
    let changes = [parameters.overrides(&scene)?.as_slice(), set].concat();
    let mut warnings = parameters.warnings(&scene)?;
    let (scene, not_carried) = parameters.switched_on(Scene::read(file, &changes)?)?;
    warnings.extend(not_carried);
    Ok(ReadScene {
        scene,
        changes,
        warnings,
    })
}
