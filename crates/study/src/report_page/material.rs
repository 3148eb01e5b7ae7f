//! What the report shows beyond the result: bodies of the seeds, and records of single runs.

use crate::{Error, Profile, StudyFile, StudyResult};
use run_store::{Lookup, Record, Store};
use scene::{FillingLibrary, Scene, SeedBody};
use std::path::Path;
use std::sync::Arc;

/// A seed with its body.
#[derive(Debug)]
pub(crate) struct FilledSeed {
    /// Name.
    pub(crate) name: String,
    /// Spheres and mesh.
    pub(crate) body: Arc<SeedBody>,
}

/// What is read for the report.
#[derive(Debug)]
pub(crate) struct Material {
    /// The profile that was run.
    pub(crate) profile: Profile,
    /// The seeds of the drum.
    pub(crate) seeds: Vec<FilledSeed>,
    /// Records of the validation runs that are in the store.
    pub(crate) validation: Vec<Record>,
}

/// Frames, series and regime of a run, as its record keeps them.
#[derive(Debug, Clone)]
pub(crate) struct RunDetails {
    /// Times of the series, s.
    pub(crate) times_s: Vec<f64>,
    /// Direction of the centre of mass at these times, deg.
    pub(crate) centre_of_mass_deg: Vec<f64>,
    /// End of the start-up, s.
    pub(crate) start_up_s: Option<f64>,
    /// Times of the frames, s.
    pub(crate) frame_times_s: Vec<f64>,
    /// What the bed does.
    pub(crate) regime: String,
    /// Whether the run became steady.
    pub(crate) steady: bool,
    /// Number of frames that were not measured.
    pub(crate) refused: u64,
    /// The last frame as PNG; none where it was not kept.
    pub(crate) last_frame: Option<Vec<u8>>,
}

impl Material {
    /// Reads records and fills the seeds.
    pub(crate) fn collect(
        folder: &Path,
        study: &StudyFile,
        result: &StudyResult,
    ) -> Result<Self, Error> {
        let profile = study.profile(&result.profile)?.clone();
        let store = Store::open(folder.join("runs"))?;
        let mut validation = Vec::new();
        for key in &result.validation.point.keys {
            if let Lookup::Found(record) = store.get(key)? {
                validation.push(record);
            }
        }
        Ok(Self {
            seeds: filled_seeds(study, &profile)?,
            profile,
            validation,
        })
    }
}

/// The seeds of the drum with the changes of a profile.
fn filled_seeds(study: &StudyFile, profile: &Profile) -> Result<Vec<FilledSeed>, Error> {
    let base = study.path.parent().unwrap_or(Path::new(""));
    let scene = Scene::read(&base.join(&study.drum), &study.overrides(&profile.scene)?)?;
    let library = FillingLibrary::default();
    let seeds = scene.seed.iter().map(|seed| {
        Ok(FilledSeed {
            name: seed.name.clone(),
            body: library.body(&scene, seed)?,
        })
    });
    seeds.collect()
}

impl RunDetails {
    /// Reads the details of a record; what is missing is empty.
    pub(crate) fn of(record: &Record) -> Self {
        use base64::Engine as _;
        let details = record.details();
        let numbers = |part: &str, name: &str| -> Vec<f64> {
            let list = details[part][name].as_array();
            list.map(|l| l.iter().filter_map(serde_json::Value::as_f64).collect())
                .unwrap_or_default()
        };
        let frame = details["last_frame_png_base64"].as_str();
        let engine = base64::engine::general_purpose::STANDARD;
        Self {
            times_s: numbers("series", "time_s"),
            centre_of_mass_deg: numbers("series", "centre_of_mass_deg"),
            start_up_s: details["start_up_s"].as_f64(),
            frame_times_s: numbers("frames", "times_s"),
            regime: record.regime().unwrap_or("unknown").to_owned(),
            steady: details["steady"].as_bool().unwrap_or(false),
            refused: details["frames"]["refused"].as_u64().unwrap_or(0),
            last_frame: frame.and_then(|text| engine.decode(text).ok()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::RunDetails;
    use run_store::Record;
    use serde_json::json;

    #[test]
    fn details_of_a_record_are_read_and_missing_ones_are_empty() {
        let record = Record::new("0", json!({}), 1)
            .expect("a record")
            .with_details(json!({
                "steady": true, "start_up_s": 0.5,
                "series": { "time_s": [0.0, 0.5], "centre_of_mass_deg": [1.0, 2.0] },
                "frames": { "times_s": [0.5], "refused": 2 },
                "last_frame_png_base64": "aGk=",
            }));
        let details = RunDetails::of(&record);
        assert_eq!(details.times_s, [0.0, 0.5]);
        assert_eq!(details.last_frame.as_deref(), Some(b"hi".as_slice()));
        assert_eq!((details.refused, details.steady), (2, true));
        let empty = RunDetails::of(&Record::new("0", json!({}), 1).expect("a record"));
        assert!(empty.times_s.is_empty() && empty.last_frame.is_none());
        assert_eq!(empty.regime, "unknown");
    }
}
