//! The measurements of a study, resolved against its scenes.

use crate::document::{Document, below};
use crate::file::{MeasuredEntry, MeasuredValue};
use crate::photos::{self, PhotoSeries};
use crate::problem::Problems;
use crate::scenes::{Models, Scenes, condition_text};
use calibration::Measurement;
use scene::{Apparatus, Scene};
use std::path::{Path, PathBuf};

/// Measurements, their models, and the photos behind them.
#[derive(Debug, Default)]
pub(crate) struct Resolved {
    /// In the order of the file.
    pub(crate) measurements: Vec<Measurement>,
    /// What they are measured on.
    pub(crate) models: Models,
    /// Photos that were read.
    pub(crate) photos: Vec<PhotoSeries>,
    /// Place in the file of each measurement.
    places: Vec<String>,
}

/// An entry in words.
fn words(entry: &MeasuredEntry) -> String {
    if entry.condition.is_empty() {
        return format!("[[measured]] of '{}'", entry.scene);
    }
    let condition = condition_text(&entry.condition);
    format!("[[measured]] of '{}' at {condition}", entry.scene)
}

impl Resolved {
    /// Resolves all entries.
    pub(crate) fn all(
        scenes: &Scenes<'_>,
        entries: &[MeasuredEntry],
        folder: &Path,
        known_scenes: &[&str],
        problems: &mut Problems,
    ) -> Self {
        let mut resolved = Self::default();
        for entry in entries {
            let document = scenes.document;
            if !known_scenes.contains(&entry.scene.as_str()) {
                let path = below(&entry.path, "scene");
                let problem = format!(
                    "is the name of no [[scene]]; there are {}",
                    known_scenes.join(", ")
                );
                let what = format!("[[measured]]: scene = '{}'", entry.scene);
                problems.add(document.problem(&path, what, problem));
                continue;
            }
            match scenes.under(&entry.scene, &entry.condition) {
                Some(Ok(scene)) => resolved.add(scenes, entry, scene, folder, problems),
                Some(Err(error)) => {
                    let path = below(&entry.path, "condition");
                    let what = format!("{}: the condition cannot be set:", words(entry));
                    problems.add(document.problem(&path, what, error.to_string()));
                }
                // The scene itself was refused.
                None => {}
            }
        }
        resolved
    }

    /// Resolves one entry.
    fn add(
        &mut self,
        scenes: &Scenes<'_>,
        entry: &MeasuredEntry,
        scene: Scene,
        folder: &Path,
        problems: &mut Problems,
    ) {
        let document = scenes.document;
        let observables = scene.observables();
        let mut values: Vec<(String, MeasuredValue)> = Vec::new();
        for (name, value) in &entry.values {
            if observables.contains(&name.as_str()) {
                values.push((name.clone(), *value));
            } else {
                let what = format!("{}: '{name}'", words(entry));
                let problem = format!(
                    "is neither a key of [[measured]] ({}) nor an observable of this scene, which gives {}",
                    crate::keys::MEASURED.join(", "),
                    observables.join(", ")
                );
                problems.add(document.problem(&below(&entry.path, name), what, problem));
            }
        }
        if !entry.photos.is_empty() {
            let paths: Vec<PathBuf> = entry.photos.iter().map(|p| folder.join(p)).collect();
            let heap = matches!(scene.apparatus, Apparatus::Heap(_));
            match photos::read(&paths, &entry.photo, heap, &observables) {
                Ok(series) => {
                    let taken = series.values.iter();
                    values.extend(taken.map(|(name, value)| (name.clone(), *value)));
                    self.photos.push(series);
                }
                Err(reasons) => {
                    let path = below(&entry.path, "photos");
                    for reason in reasons {
                        let what = format!("{}: photos:", words(entry));
                        problems.add(document.problem(&path, what, reason));
                    }
                }
            }
        }
        let (model, is_new) = self.models.number_of(&entry.scene, &entry.condition, scene);
        let built = &self.models.scenes[model];
        if let (true, Err(error)) = (is_new, built.build_check(&scenes.fillings)) {
            let what = format!("{}: the scene cannot be built:", words(entry));
            problems.add(document.problem(&entry.path, what, error.to_string()));
        }
        for (observable, MeasuredValue { mean, sd, n }) in values {
            let measurement = Measurement {
                model,
                observable,
                role: entry.role,
                mean,
                sd,
                n,
            };
            self.push(document, entry, measurement, problems);
        }
    }

    /// Adds a measurement, or tells that it stands there already.
    fn push(
        &mut self,
        document: &Document,
        entry: &MeasuredEntry,
        new: Measurement,
        problems: &mut Problems,
    ) {
        let place = below(&entry.path, &new.observable);
        let mut all = self.measurements.iter();
        let known = all.position(|m| m.model == new.model && m.observable == new.observable);
        if let Some(known) = known {
            let (other, line) = (
                &self.measurements[known],
                document.line(&self.places[known]),
            );
            let line = line.map_or_else(String::new, |line| format!(" in line {line}"));
            let problem = if other.role == new.role {
                format!("stands there{line} already: give each measurement once")
            } else {
                format!(
                    "has another role{line}: what checks a fit cannot be part of it; give it one role only"
                )
            };
            let what = format!("{}: '{}'", words(entry), new.observable);
            problems.add(document.problem(&place, what, problem));
            return;
        }
        self.measurements.push(new);
        self.places.push(place);
    }
}
