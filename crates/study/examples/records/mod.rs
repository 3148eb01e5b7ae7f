//! Arguments of the examples that make a table over runs, and its cells.

use campaign::run_store::Record;
use simulators::scene_simulator::NOT_STEADY;
use std::error::Error;

/// FOLDER and the number of runs of each point, 2 or more, from the command line.
pub(crate) fn folder_and_runs(
    example: &str,
    runs_by_default: u64,
) -> Result<(String, u64), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = || format!("usage: {example} FOLDER [RUNS]");
    let folder = arguments.next().ok_or_else(usage)?;
    let wrong = |text: &str| format!("RUNS is '{text}'; {}", usage());
    let runs = match arguments.next() {
        Some(text) => text.parse().map_err(|_| wrong(&text))?,
        None => runs_by_default,
    };
    if runs < 2 {
        return Err(
            format!("RUNS is {runs}; it must be 2 or more: one run has no standard error").into(),
        );
    }
    Ok((folder, runs))
}

/// Mean and standard error of an observable over the runs that were steady; the mean alone of one, "-" of none.
pub(crate) fn mean_and_error(records: &[Record], observable: &str, digits: usize) -> String {
    let steady = records.iter().filter(|r| r.regime() != Some(NOT_STEADY));
    mean_and_error_of_all(steady, observable, digits)
}

/// The same over all runs.
pub(crate) fn mean_and_error_of_all<'a>(
    records: impl IntoIterator<Item = &'a Record>,
    observable: &str,
    digits: usize,
) -> String {
    let means = records.into_iter().filter_map(|r| r.observable(observable));
    let values: Vec<f64> = means.map(|o| o.mean).collect();
    let n = values.len() as f64;
    if values.is_empty() {
        return "-".to_owned();
    }
    let mean = values.iter().sum::<f64>() / n;
    if values.len() == 1 {
        return format!("{mean:.digits$}");
    }
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let error = (square / (n - 1.0) / n).sqrt();
    format!("{mean:.digits$} +- {error:.digits$}")
}
