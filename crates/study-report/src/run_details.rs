//! What the records of single runs keep for the report: series, frames and seeds.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use campaign::run_store::Record;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use report::{ViewerBody, ViewerSphere};
use serde_json::Value;

/// The seeds of a frame, lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seeds {
    /// The spheres of each kind, in its own frame.
    pub(crate) kinds: Vec<Vec<ViewerSphere>>,
    /// Each seed.
    pub(crate) bodies: Vec<ViewerBody>,
}

/// Series and seeds of a run, as its record keeps them; what is missing is empty.
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
    /// The seeds in the last frame.
    pub(crate) seeds: Option<Seeds>,
}

impl RunDetails {
    /// Reads the details of a record.
    pub(crate) fn of(record: &Record) -> Self {
        let details = record.details();
        let numbers = |part: &str, name: &str| -> Vec<f64> {
            let list = details[part][name].as_array();
            list.map(|l| l.iter().filter_map(Value::as_f64).collect())
                .unwrap_or_default()
        };
        Self {
            times_s: numbers("series", "time_s"),
            centre_of_mass_deg: numbers("series", "centre_of_mass_deg"),
            start_up_s: details["start_up_s"].as_f64(),
            frame_times_s: numbers("frames", "times_s"),
            seeds: Seeds::of(&details["last_bodies"]),
        }
    }

    /// The last frame of a record as PNG.
    pub(crate) fn last_frame_of(record: &Record) -> Option<Vec<u8>> {
        let text = record.details()["last_frame_png_base64"].as_str()?;
        STANDARD.decode(text).ok()
    }
}

/// A column of the curve that a record holds; empty if it has none.
pub(crate) fn curve_column(record: &Record, name: &str) -> Vec<f64> {
    let column = record.details()["curve"]["columns"][name].as_array();
    let numbers = column.into_iter().flatten().filter_map(Value::as_f64);
    numbers.collect()
}

impl Seeds {
    /// Reads the seeds of a record; `None` if it holds none, or not all of them.
    fn of(details: &Value) -> Option<Self> {
        let kinds = details["kinds_base64"].as_array()?.iter();
        let kinds: Option<Vec<_>> = kinds.map(|text| spheres(&floats(text)?)).collect();
        let kinds = kinds?;
        let numbers = floats(&details["seeds_base64"])?;
        let bodies: Option<Vec<_>> = numbers
            .chunks(8)
            .map(|one| body(one, kinds.len()))
            .collect();
        let bodies = bodies.filter(|bodies| !bodies.is_empty())?;
        Some(Self { kinds, bodies })
    }
}

/// The spheres of a kind.
fn spheres(numbers: &[f64]) -> Option<Vec<ViewerSphere>> {
    let sphere = |one: &[f64]| match *one {
        [x, y, z, radius] => Some(ViewerSphere {
            centre: [x, y, z],
            radius,
        }),
        _ => None,
    };
    numbers.chunks(4).map(sphere).collect()
}

/// A seed of one of so many kinds.
fn body(numbers: &[f64], kinds: usize) -> Option<ViewerBody> {
    let [kind, x, y, z, w, i, j, k] = *numbers else {
        return None;
    };
    Some(ViewerBody {
        kind: (0..kinds).find(|&known| known as f64 == kind)?,
        position: Vector3::new(x, y, z),
        orientation: UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)),
    })
}

/// 32-bit little-endian floats in base 64.
fn floats(text: &Value) -> Option<Vec<f64>> {
    let bytes = STANDARD.decode(text.as_str()?).ok()?;
    let (numbers, []) = bytes.as_chunks::<4>() else {
        return None;
    };
    Some(
        numbers
            .iter()
            .map(|b| f64::from(f32::from_le_bytes(*b)))
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::RunDetails;
    use campaign::run_store::Record;
    use serde_json::json;

    #[test]
    fn details_of_a_record_are_read_and_missing_ones_are_empty() {
        let record = Record::new("0", json!({}), 1)
            .expect("a record")
            .with_details(json!({
                "start_up_s": 0.5,
                "series": { "time_s": [0.0, 0.5], "centre_of_mass_deg": [1.0, 2.0] },
                "frames": { "times_s": [0.5] },
                "last_frame_png_base64": "aGk=",
            }));
        let details = RunDetails::of(&record);
        assert_eq!(details.times_s, [0.0, 0.5]);
        assert_eq!(details.centre_of_mass_deg, [1.0, 2.0]);
        assert_eq!(
            (details.start_up_s, details.frame_times_s),
            (Some(0.5), vec![0.5])
        );
        assert_eq!(
            RunDetails::last_frame_of(&record).as_deref(),
            Some(b"hi".as_slice())
        );
        let empty = Record::new("0", json!({}), 1).expect("a record");
        assert!(RunDetails::of(&empty).times_s.is_empty());
        assert_eq!(RunDetails::last_frame_of(&empty), None);
    }
}
