//! `seedloop analyse --groups`: one-way analysis of variance.

use std::fmt::Write as _;

use anyhow::{Context as _, ensure};
use command_line::{DONE, Header, significant};
use response_surface::{OneWay, PairDifference, one_way_decimals};
use serde::Serialize;

use super::Arguments;
use super::text::{counted, probability};

/// The comparison in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Name of the column of the response.
    response: String,
    /// Name of the column of the groups.
    groups: String,
    #[serde(flatten)]
    analysis: OneWay,
    /// All pairs of groups at once; null without replicates or scatter, and for more than 30 groups.
    pairs: Option<Vec<PairDifference>>,
}

/// Reads, compares, prints.
///
/// # Errors
/// Files that cannot be read or written, columns that are missing, fewer than two groups.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let place = || arguments.data.display().to_string();
    let table = command_line::table_file::read(&arguments.data)?;
    let named = arguments.factors.as_deref().unwrap_or_default();
    ensure!(
        !named.contains(','),
        "--groups takes one column; --factors names several"
    );
    let group = table.column(named).with_context(place)?;
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
    let pairs = analysis.pairs();
    let text = in_words(&analysis, pairs.as_deref());
    common.emit_json(&Report {
        header: Header::new(None, [command_line::table_file::file_of(&arguments.data)])?,
        response: table.header()[response].clone(),
        groups: table.header()[group].clone(),
        analysis,
        pairs,
    })?;
    common.print(text.trim_end())?;
    Ok(DONE)
}

/// Means of the groups, the analysis of variance, and the differences of all pairs.
fn in_words(analysis: &OneWay, pairs: Option<&[PairDifference]>) -> String {
    let means = analysis.means.iter().zip(analysis.counts.values());
    let mut text = String::new();
    for ((name, mean), n) in means {
        let mean = significant(*mean, 7);
        let _ = writeln!(text, "{name:<12} n {n:>6}  mean {mean}");
    }
    let _ = writeln!(
        text,
        "between {:>16.8e} {:>6}  F {}  p {}",
        analysis.between_ss,
        analysis.between_df,
        counted(analysis.f, 7),
        probability(analysis.p)
    );
    let _ = writeln!(
        text,
        "within  {:>16.8e} {:>6}",
        analysis.within_ss, analysis.within_df
    );
    if pairs.is_some() {
        let _ = writeln!(
            text,
            "pairs, Tukey: difference, 95 % interval and p for all pairs at once"
        );
    }
    for pair in pairs.into_iter().flatten() {
        let [low, high] = pair.simultaneous95.map(|end| significant(end, 5));
        let _ = writeln!(
            text,
            "{:<24} {:>11}  {low} to {high}  p {}",
            format!("{} - {}", pair.group, pair.less),
            significant(pair.difference, 5),
            probability(Some(pair.p))
        );
    }
    text
}
