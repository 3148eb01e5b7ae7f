//! What the records of single runs keep for the report: series and frames.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use run_store::Record;
use serde_json::Value;

/// Series and last frame of a run, as its record keeps them; what is missing is empty.
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
    /// The last frame as PNG.
    pub(crate) last_frame: Option<Vec<u8>>,
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
        let frame = details["last_frame_png_base64"].as_str();
        Self {
            times_s: numbers("series", "time_s"),
            centre_of_mass_deg: numbers("series", "centre_of_mass_deg"),
            start_up_s: details["start_up_s"].as_f64(),
            frame_times_s: numbers("frames", "times_s"),
            last_frame: frame.and_then(|text| STANDARD.decode(text).ok()),
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
        assert_eq!(details.last_frame.as_deref(), Some(b"hi".as_slice()));
        let empty = RunDetails::of(&Record::new("0", json!({}), 1).expect("a record"));
        assert!(empty.times_s.is_empty() && empty.last_frame.is_none());
    }
}
