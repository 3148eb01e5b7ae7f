//! Columns that cannot be meant: without variation, or with one value far from all others.

use super::extremes;
use anyhow::ensure;
use command_line::significant;
use experiment_design::table::Table;

/// How far a value may lie beyond those of all other rows, in widths of their range, before it is reported: as far as they
/// reach themselves. The outermost axial runs of a composite come in pairs.
const LONE: f64 = 1.0;
/// How far it may lie before it is refused, in widths of their range and sizes of their values: no factor and no response
/// of an experiment jumps a million times its own size in one row.
const ABSURD: f64 = 1e6;

/// Refuses a factor or a response that never varies, and a response that is a factor.
pub(super) fn check_columns(
    table: &Table,
    factors: &[usize],
    response: usize,
) -> anyhow::Result<()> {
    let name = |column: usize| &table.header()[column];
    ensure!(
        !factors.contains(&response),
        "column '{}' is named as a factor and as the response; it can only be one of them",
        name(response)
    );
    let columns = factors.iter().map(|&column| (column, "factor"));
    for (column, what) in columns.chain([(response, "response")]) {
        let (low, high) = extremes(table, column)?;
        let name = name(column);
        ensure!(
            low < high || table.rows().len() == 1,
            "the {what} '{name}' never varies: it is {low} in all rows; leave it out"
        );
    }
    Ok(())
}

/// Refuses a factor or a response that one row alone has at an absurd value, and reports factors that one row alone takes far
/// beyond all others, each with its place: a slip of a typist costs terms, and the terms do not say where it stands.
pub(super) fn lone_values(
    table: &Table,
    factors: &[usize],
    response: usize,
) -> anyhow::Result<Vec<String>> {
    let mut warnings = Vec::new();
    for &column in factors.iter().chain([&response]) {
        let mut sorted = Vec::with_capacity(table.rows().len());
        for row in table.rows() {
            sorted.push((table.number(row, column)?, row));
        }
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        // With fewer rows no two others could tell what is far.
        let [(low, lowest), (second, _), .., (last, _), (high, highest)] = &sorted[..] else {
            continue;
        };
        for (value, row, [from, to]) in
            [(low, lowest, [second, high]), (high, highest, [low, last])]
        {
            let beyond = (from - value).max(value - to);
            let (spread, size) = (to - from, from.abs().max(to.abs()));
            let place = table.place(row, column);
            let [value, from, to] = [value, from, to].map(|v| significant(*v, 6));
            ensure!(
                beyond <= ABSURD * spread.max(size) || spread.max(size) == 0.0,
                "{place}: {value} lies far outside all other rows, {from} to {to}; correct it, or leave the row out"
            );
            if column != response && spread > 0.0 && beyond > LONE * spread {
                warnings.push(format!(
                    "{place}: {value} lies {} widths outside the range of all other rows, {from} to {to}; the fit depends on \
                     this row, so check it",
                    significant(beyond / spread, 2)
                ));
            }
        }
    }
    Ok(warnings)
}
