//! Cells of tables over runs; for the examples.

use run_store::Record;

/// Mean and standard error of an observable over the runs.
pub(crate) fn mean_and_error(records: &[Record], observable: &str, digits: usize) -> String {
    let means = records.iter().filter_map(|r| r.observable(observable));
    let values: Vec<f64> = means.map(|o| o.mean).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let error = (square / (n - 1.0) / n).sqrt();
    format!("{mean:.digits$} +- {error:.digits$}")
}
