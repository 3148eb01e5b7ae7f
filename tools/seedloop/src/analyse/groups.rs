//! `seedloop analyse --groups`: one-way analysis of variance.

use anyhow::{Context as _, ensure};
use command_line::{DONE, Header};
use experiment_design::table::Table;
use response_surface::{OneWay, one_way_decimals};
use serde::Serialize;

use super::Arguments;
use super::text::{fixed, probability};

/// The comparison as it stands in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Name of the column of the response.
    response: String,
    /// Name of the column of the groups.
    groups: String,
    /// The analysis.
    #[serde(flatten)]
    analysis: OneWay,
}

/// Reads, compares, prints.
///
/// # Errors
/// Files that cannot be read or written, columns that are missing, fewer than two groups.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let place = || arguments.data.display().to_string();
    let text = input_file::read_text(&arguments.data)
        .with_context(|| format!("cannot read {}", place()))?;
    let table = Table::parse(&text).with_context(place)?;
    ensure!(
        !arguments.factors.contains(','),
        "--groups takes one column; --factors names several"
    );
    let group = table.column(&arguments.factors).with_context(place)?;
    let response = table.column(&arguments.response).with_context(place)?;
    let labels: Vec<String> = table
        .rows()
        .iter()
        .map(|row| row.text(group).to_owned())
        .collect();
    let mut values = Vec::with_capacity(labels.len());
    for row in table.rows() {
        // The number is checked here, where its line is known; its text keeps all digits.
        table.number(row, response).with_context(place)?;
        values.push(row.text(response));
    }
    let analysis = one_way_decimals(&labels, &values).with_context(place)?;
    let common = &arguments.common;
    let means = analysis.means.iter().zip(analysis.counts.values());
    for ((name, mean), n) in means {
        common.print(format!("{name:<12} n {n:>6}  mean {mean:.6}"))?;
    }
    common.print(format!(
        "between {:>16.8e} {:>6}  F {}  p {}",
        analysis.between_ss,
        analysis.between_df,
        fixed(analysis.f, 6),
        probability(analysis.p)
    ))?;
    common.print(format!(
        "within  {:>16.8e} {:>6}",
        analysis.within_ss, analysis.within_df
    ))?;
    common.emit_json(&Report {
        header: Header::new(None, [&arguments.data])?,
        response: table.header()[response].clone(),
        groups: table.header()[group].clone(),
        analysis,
    })?;
    Ok(DONE)
}
