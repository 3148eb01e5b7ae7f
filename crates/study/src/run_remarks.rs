//! What a reader should know of the runs behind a result, from their records.

use crate::scenes::model_name;
use campaign::run_store::Record;
use inference::{Calibration, Comparison};
use simulators::scene_simulator::{RunDetails, unread_frames};
use std::collections::{BTreeMap, BTreeSet};

/// Remarks on the runs at the estimate, by model.
pub(crate) fn of_runs(
    calibration: &Calibration,
    records: &BTreeMap<String, Record>,
) -> Vec<String> {
    let rows = calibration.fit.iter().chain(&calibration.check);
    let mut keys: BTreeMap<String, BTreeSet<&String>> = BTreeMap::new();
    for row in rows.chain(&calibration.show) {
        let Comparison {
            scene, condition, ..
        } = row;
        let of_model = keys.entry(model_name(scene, condition)).or_default();
        of_model.extend(&row.keys);
    }
    let each = keys.into_iter().flat_map(|(model, keys)| {
        let records = keys.into_iter().filter_map(|key| records.get(key));
        let details: Vec<RunDetails> = records.filter_map(|r| RunDetails::of(r).ok()).collect();
        of_model(&model, &details)
    });
    each.collect()
}

/// Frames of the runs of a model without a surface, with what they may change, and files that were left out.
fn of_model(model: &str, details: &[RunDetails]) -> Vec<String> {
    let unread = unread_frames(details.iter().map(|d| &d.frames));
    let unread = unread.map(|told| format!("{model}, runs at the estimate: {told}"));
    let told: BTreeSet<&String> = details.iter().flat_map(|d| &d.remarks).collect();
    let told = told.into_iter().map(|told| format!("{model}: {told}"));
    unread.into_iter().chain(told).collect()
}

#[cfg(test)]
mod tests {
    use super::of_model;
    use simulators::scene_simulator::RunDetails;

    /// A run with nine angles and so many frames without a surface, and remarks on its files.
    fn run(refused: usize, remarks: &[&str]) -> RunDetails {
        serde_json::from_value(serde_json::json!({
            "steady": true, "start_up_s": null, "motion": null, "froude_number": null, "last_frame_png_base64": null,
            "remarks": remarks,
            "frames": {
                "times_s": [], "angles_deg": [31, 30, 32, 29, 31, 33, 30, 32, 31], "angles_by_position_deg": [],
                "filling_angles_deg": [], "refused": refused, "effective_number": null,
            },
            "series": { "time_s": [], "centre_of_mass_deg": [] },
            "timing": {
                "time_step_s": 1e-4, "settling_time_step_s": 1e-4, "steps": 1, "bodies": 1, "spheres": 1,
                "threads": 1, "wall_s": 6.5, "cpu_s": 6.0, "filling_s": null, "us_per_step": null,
                "sphere_steps_per_s": null, "continued": false, "only_seen": false,
            },
        }))
        .unwrap()
    }

    #[test]
    fn what_runs_say_of_frames_and_files_reaches_the_result_once() {
        assert!(of_model("drum", &[run(0, &[])]).is_empty());
        let left = "1 of 9 files hold no positions";
        let told = of_model("drum", &[run(1, &[left]), run(0, &[left])]);
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].starts_with("drum, runs at the estimate: 1 of 19 frames"));
        assert_eq!(told[1], format!("drum: {left}"));
    }
}
