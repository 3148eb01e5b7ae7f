//! The measurements of a study, resolved against its scenes.

use crate::correlated::correlations_of;
use crate::document::{Document, below};
use crate::file::{MeasuredEntry, MeasuredValue};
use crate::photo_values::{FILL, shown_fill};
use crate::photos::{self, PhotoSeries, Shown};
use crate::problem::Problems;
use crate::scenes::{Models, Scenes, condition_text};
use inference::{Correlation, Measurement, Role};
use input::quantity::significant;
use scene::OBSERVABLES_OF_A_BED;
use scene::{Apparatus, Scene};
use std::path::Path;

/// Least and largest share of the volume of a bed that grains take, chosen wide: spheres that flow in a narrow drum take 0.45, long or
/// sticky grains less; ordered spheres take 0.74, mixed sizes more.
const PACKINGS: [f64; 2] = [0.3, 0.85];

/// Measurements, their models, and the photos behind them.
#[derive(Debug, Default)]
pub(crate) struct Resolved {
    /// In the order of the file.
    pub(crate) measurements: Vec<Measurement>,
    /// Which of them are correlated.
    pub(crate) correlations: Vec<Correlation>,
    /// What they are measured on.
    pub(crate) models: Models,
    /// Photos that were read.
    pub(crate) photos: Vec<PhotoSeries>,
    /// Place in the file of each measurement.
    places: Known,
}

/// Place in the file of each measurement so far.
pub(crate) type Known = Vec<String>;

/// An entry in words.
pub(crate) fn words(entry: &MeasuredEntry) -> String {
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
        let mut observables = scene.observables();
        if scenes.peer.is_some() {
            observables.retain(|name| OBSERVABLES_OF_A_BED.contains(name));
        }
        let mut values: Vec<(String, MeasuredValue)> = Vec::new();
        for (name, value) in &entry.values {
            if observables.contains(&name.as_str()) {
                values.push((name.clone(), *value));
            } else if !observables.is_empty() {
                // Where a code shows nothing of an apparatus, that it does not take it is told below.
                let what = format!("{}: '{name}'", words(entry));
                let problem = format!(
                    "is neither a key of [[measured]] ({}) nor an observable of this scene, which gives {}",
                    crate::keys::MEASURED.join(", "),
                    observables.join(", ")
                );
                problems.add(document.problem(&below(&entry.path, name), what, problem));
            }
        }
        let shown = Shown {
            heap: matches!(scene.apparatus, Apparatus::Heap(_)),
            radius: Some(scene.apparatus.radius()),
            observables: &observables,
        };
        let mut series = read_photos(document, entry, folder, shown, problems);
        let taken = series.iter().flat_map(|s| &s.values);
        values.extend(taken.map(|(name, value)| (name.clone(), *value)));
        let (model, is_new) = self.models.number_of(&entry.scene, &entry.condition, scene);
        let built = &self.models.scenes[model];
        if let Some(series) = &mut series {
            series.remarks.extend(impossible_fill(built, series));
        }
        if is_new && let Err(error) = built.build_check(&scenes.fillings) {
            let what = format!("{}: the scene cannot be built:", words(entry));
            problems.add(document.problem(&entry.path, what, error.to_string()));
        }
        if is_new && let Some(Err(error)) = scenes.peer.map(|peer| peer.check(built)) {
            let what = format!("{}:", words(entry));
            problems.add(document.problem(&entry.path, what, error.to_string()));
        }
        let values = values.into_iter().map(|value| (value, entry.role));
        let fill = shown_fill(series.as_ref(), entry).map(|value| (value, Role::Show));
        for ((observable, MeasuredValue { mean, sd, n }), role) in values.chain(fill) {
            let measurement = Measurement {
                model,
                observable,
                role,
                mean,
                sd,
                n,
            };
            let all = (&mut self.measurements, &mut self.places);
            push(document, entry, measurement, all, problems);
        }
        let of_model = (model, &self.measurements[..]);
        let found = correlations_of(document, entry, series.as_ref(), of_model, problems);
        self.correlations.extend(found);
        self.photos.extend(series);
    }
}

/// That photos of a drum show a bed that no packing of the seeds of the scene makes. A settled bed of the scene is compared with them
/// when it has been run.
fn impossible_fill(scene: &Scene, series: &PhotoSeries) -> Option<String> {
    let mut shown = [&series.values, &series.further].into_iter();
    let shown = shown.find_map(|values| values.get(FILL))?.mean;
    let solid = scene.solid_share()? / shown;
    let [least, most] = PACKINGS;
    let impossible =
        matches!(scene.apparatus, Apparatus::Drum(_)) && !(least..=most).contains(&solid);
    impossible.then(|| {
        format!(
            "{FILL}: the photos show {} of the drum filled; the seeds of the scene would take {} of the volume of such a bed, and no \
             packing takes less than {least} or more than {most}: look at their fill_level, count or total_mass",
            significant(shown, 2),
            significant(solid, 2)
        )
    })
}

/// The photos of a measurement in a folder; none where it has none, or they cannot be read, which is
/// told.
pub(crate) fn read_photos(
    document: &Document,
    entry: &MeasuredEntry,
    folder: &Path,
    shown: Shown<'_>,
    problems: &mut Problems,
) -> Option<PhotoSeries> {
    if entry.photos.is_empty() {
        return None;
    }
    match photos::read(folder, &entry.photos, &entry.photo, shown) {
        Ok(mut series) => {
            for told in &mut series.left_out {
                *told = format!("{}: {told}", words(entry));
            }
            Some(series)
        }
        Err(reasons) => {
            let path = below(&entry.path, "photos");
            for reason in reasons {
                let what = format!("{}: photos:", words(entry));
                problems.add(document.problem(&path, what, reason));
            }
            None
        }
    }
}

/// Adds a measurement to those before it, or tells that it stands there already.
pub(crate) fn push(
    document: &Document,
    entry: &MeasuredEntry,
    new: Measurement,
    (measurements, places): (&mut Vec<Measurement>, &mut Known),
    problems: &mut Problems,
) {
    let place = below(&entry.path, &new.observable);
    let mut all = measurements.iter();
    let known = all.position(|m| m.model == new.model && m.observable == new.observable);
    if let Some(known) = known {
        let (other, line) = (&measurements[known], document.line(&places[known]));
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
    measurements.push(new);
    places.push(place);
}
