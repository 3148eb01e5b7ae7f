//! A design at every combination of named levels.

use anyhow::{Context as _, ensure};
use experiment_design::table::{csv_field, design_to_csv};
use experiment_design::{Design, Run};
use response_surface::Categorical;

use super::Arguments;

/// One level of each named factor, as (symbol, level).
pub(super) type Combination = Vec<(String, String)>;

/// All combinations of levels; one empty combination without named factors.
pub(super) fn combinations(
    arguments: &Arguments,
    design: &Design,
) -> anyhow::Result<Vec<Combination>> {
    let mut all: Vec<Combination> = vec![Vec::new()];
    for text in &arguments.categories {
        let form = || format!("'{text}' is no factor with levels; write it as wall=steel:glass");
        let (symbol, levels) = text.split_once('=').with_context(form)?;
        let levels: Vec<String> = levels.split(':').map(|l| l.trim().to_owned()).collect();
        ensure!(
            levels
                .iter()
                .all(|l| !l.is_empty() && !l.contains([',', '"'])),
            form()
        );
        let category = Categorical::new(symbol.trim(), levels)?;
        let symbol = category.symbol();
        ensure!(
            !design.columns().iter().any(|name| name == symbol)
                && !all[0].iter().any(|(other, _)| other == symbol),
            "the symbol '{symbol}' is used twice; give each factor its own symbol"
        );
        let with = |level: &String| (symbol.to_owned(), level.clone());
        all = all
            .iter()
            .flat_map(|chosen| {
                let each = category.levels().iter();
                each.map(|level| [&chosen[..], &[with(level)]].concat())
                    .collect::<Vec<_>>()
            })
            .collect();
    }
    Ok(all)
}

/// The design once for each combination, its cells counted on.
pub(super) fn crossed(design: &Design, combinations: &[Combination]) -> anyhow::Result<Design> {
    let cells = design.runs().iter().map(|run| run.cell).max().unwrap_or(1);
    let again = |i: usize| {
        design.runs().iter().map(move |run| Run {
            cell: run.cell + i * cells,
            ..run.clone()
        })
    };
    let runs = (0..combinations.len()).flat_map(again).collect();
    Ok(Design::with_runs(
        design.kind(),
        design.factors(),
        design.dummies().to_vec(),
        runs,
    )?)
}

/// The table of the design, a column for each named factor behind the others. Every combination has
/// `cells` cells.
pub(super) fn table(design: &Design, combinations: &[Combination], cells: usize) -> String {
    let text = design_to_csv(design);
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let symbols = combinations[0].iter().map(|(symbol, _)| symbol.as_str());
    let mut out = [header]
        .into_iter()
        .chain(symbols)
        .collect::<Vec<_>>()
        .join(",")
        + "\n";
    for (line, run) in lines.zip(design.runs()) {
        let levels = combinations[(run.cell - 1) / cells].iter();
        let fields = [line.to_owned()]
            .into_iter()
            .chain(levels.map(|(_, level)| csv_field(level)));
        out += &(fields.collect::<Vec<_>>().join(",") + "\n");
    }
    out
}
