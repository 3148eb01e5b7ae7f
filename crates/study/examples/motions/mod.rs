//! How many runs ended in which form of motion.

use campaign::run_store::Record;
use simulators::scene_simulator::{NOT_STEADY, RunDetails};
use std::collections::BTreeMap;
use std::error::Error;

/// The forms in which runs ended, the most frequent first: number of runs and mean angle (deg) of each.
pub(crate) fn forms(records: &[Record]) -> Result<String, Box<dyn Error>> {
    let mut found: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for record in records {
        let steady = record.regime() != Some(NOT_STEADY);
        let form = RunDetails::of(record)?.motion.filter(|_| steady);
        let angle = record.observable("angle_deg").map_or(f64::NAN, |o| o.mean);
        let form = form.unwrap_or_else(|| NOT_STEADY.to_owned());
        found.entry(form).or_default().push(angle);
    }
    let mut found: Vec<_> = found.into_iter().collect();
    found.sort_by_key(|(_, angles)| std::cmp::Reverse(angles.len()));
    let told = found.iter().map(|(form, angles)| {
        let n = angles.len();
        let mean = angles.iter().sum::<f64>() / n as f64;
        format!("{form} {n} ({mean:.2} deg)")
    });
    Ok(told.collect::<Vec<_>>().join(", "))
}
