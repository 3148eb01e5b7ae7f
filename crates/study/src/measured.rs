//! The measurements of a study, resolved against its scenes.

use crate::correlated::correlations_of;
use crate::curves::MeasuredCurve;
use crate::document::below;
use crate::file::{MeasuredEntry, MeasuredValue};
use crate::photo_values::{FILL, shown_fill};
use crate::photos::{self, PhotoSeries, Shown};
use crate::problem::Problems;
use crate::scenes::{Models, Scenes, Setup, model_name};
use inference::{Correlation, Measurement, Role};
use input::quantity::significant;
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
    pub(crate) correlations: Vec<Correlation>,
    /// What is measured.
    pub(crate) models: Models,
    /// Photos that were read.
    pub(crate) photos: Vec<PhotoSeries>,
    /// Curves that were read, each with the number of its model.
    pub(crate) curves: Vec<(usize, MeasuredCurve)>,
    /// Path in the file of each measurement.
    places: Vec<String>,
}

impl Resolved {
    /// Resolves all entries.
    pub(crate) fn all(scenes: &Scenes<'_>, folder: &Path, problems: &mut Problems) -> Self {
        let mut resolved = Self::default();
        for entry in &scenes.file.measured {
            match scenes.setup(&entry.scene, &entry.condition) {
                Ok(setup) => resolved.add(scenes, entry, setup, folder, problems),
                Err(Some((key, problem))) => problems.wrong(&below(&entry.path, key), problem),
                Err(None) => {}
            }
        }
        resolved
    }

    /// Resolves one entry.
    fn add(
        &mut self,
        scenes: &Scenes<'_>,
        entry: &MeasuredEntry,
        setup: Setup,
        folder: &Path,
        problems: &mut Problems,
    ) {
        let observables = scenes.observables(&setup);
        let mut values: Vec<(String, MeasuredValue)> = Vec::new();
        for (name, value) in &entry.values {
            if observables.contains(&name.as_str()) {
                values.push((name.clone(), *value));
            } else if !observables.is_empty() || setup.scene().is_none() {
                // That a code does not take an apparatus, and so shows nothing of it, is reported below.
                let known = observables.join(", ");
                let problem = format!("not an observable of this scene, which gives {known}");
                problems.wrong(&below(&entry.path, name), problem);
            }
        }
        let curve = read_curve(entry, folder, scenes, &setup, problems);
        if let Some(curve) = &curve {
            values.extend(curve.values.iter().cloned());
        }
        let shown = setup.shown(&observables);
        let mut series = read_photos(entry, folder, shown, problems);
        let taken = series.iter().flat_map(|s| &s.values);
        values.extend(taken.map(|(name, value)| (name.clone(), *value)));
        let (model, is_new) = self.models.number_of(&entry.scene, &entry.condition, setup);
        let setup = &self.models.setups[model];
        if let (Some(series), Some(scene)) = (&mut series, setup.scene()) {
            series.remarks.extend(impossible_fill(scene, series));
        }
        if is_new && let Some(reason) = scenes.refusal(setup) {
            problems.wrong(&entry.path, reason);
        }
        let values = values.into_iter().map(|value| (value, entry.role));
        let fill = shown_fill(series.as_ref(), entry).map(|value| (value, Role::Show));
        for ((observable, value), role) in values.chain(fill) {
            let measurement = Measurement {
                model,
                observable,
                role,
                mean: value.mean,
                sd: value.sd,
                n: value.n,
                is_scatter: value.is_scatter,
            };
            self.push(entry, measurement, problems);
        }
        let of_model = (model, &self.measurements[..]);
        let of_curve = curve.iter().flat_map(|curve| &curve.correlations);
        let found = correlations_of(entry, series.as_ref(), of_curve, of_model, problems);
        self.correlations.extend(found);
        self.curves.extend(curve.map(|curve| (model, curve)));
        self.photos.extend(series);
    }

    /// Adds a measurement, unless it is there already.
    fn push(&mut self, entry: &MeasuredEntry, new: Measurement, problems: &mut Problems) {
        let place = below(&entry.path, &new.observable);
        let same = |m: &Measurement| m.model == new.model && m.observable == new.observable;
        if let Some(known) = self.measurements.iter().position(same) {
            let line = problems.document.line(&self.places[known]);
            let line = line.map_or_else(String::new, |line| format!(" in line {line}"));
            let problem = if self.measurements[known].role == new.role {
                format!("the same as{line}: give each measurement once")
            } else {
                format!(
                    "has another role{line}: what checks a fit cannot be part of it; give it one role only"
                )
            };
            return problems.wrong(&place, problem);
        }
        self.measurements.push(new);
        self.places.push(place);
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

/// The curve of a measurement; `None` if it has none, or it cannot be read, which is reported.
fn read_curve(
    entry: &MeasuredEntry,
    folder: &Path,
    scenes: &Scenes<'_>,
    setup: &Setup,
    problems: &mut Problems,
) -> Option<MeasuredCurve> {
    let stated = entry.curve.as_ref()?;
    let at = below(&entry.path, "curve");
    let of_scene = setup.scene().filter(|_| scenes.peer().is_none());
    let Some(kind) = of_scene.and_then(Scene::curve) else {
        let problem = "is not read here: the solver of seedloop gives curves of hopper, draw-down, ledge, compression, direct-shear, \
                       penetration, and of a machine whose last phase has an outlet";
        problems.wrong(&at, problem);
        return None;
    };
    match MeasuredCurve::read(stated, folder, kind) {
        Ok(curve) => Some(curve),
        Err((key, problem)) => {
            problems.wrong(&below(&at, key), problem);
            None
        }
    }
}

/// The photos of a measurement; `None` if it has none, or they cannot be read, which is reported.
fn read_photos(
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
            let model = model_name(&entry.scene, &entry.condition);
            for told in &mut series.left_out {
                *told = format!("{model}: {told}");
            }
            Some(series)
        }
        Err(reasons) => {
            let path = below(&entry.path, "photos");
            for reason in reasons {
                problems.wrong(&path, reason);
            }
            None
        }
    }
}
