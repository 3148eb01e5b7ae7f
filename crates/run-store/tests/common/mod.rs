//! A record like those of real runs, in its small parts.

use run_store::{Observation, Record};
use serde_json::json;

/// A record with numbers whose last bits matter.
pub(crate) fn record(seed: u64) -> Record {
    let angle = Observation {
        mean: 38.870000000000005,
        sd: Some(0.1 + 0.2),
        n: 10,
        unit: "deg".into(),
    };
    Record::new(
        "0.1.0",
        json!({"rpm": 14.999999999999998, "model": "drum"}),
        seed,
    )
    .expect("the record is sound")
    .with_observable("angle", angle)
    .expect("the record is sound")
    .with_details(json!({"wall_s": 1.25, "series": [0.1, 2.2250738585072014e-308]}))
}
