//! Factors with named levels beside those with numbers.

use anyhow::{Context as _, ensure};
use experiment_design::table::{Table, csv_field, design_to_csv};
use experiment_design::{Design, Factor, Run};
use response_surface::{Categorical, CategoricalModel};

use super::Arguments;
use crate::levels;

/// A level of each named factor, in their order.
pub(super) type Combination = Vec<String>;

/// The named factors that are asked for.
pub(super) fn named(arguments: &Arguments, factors: &[Factor]) -> anyhow::Result<Vec<Categorical>> {
    let mut all: Vec<Categorical> = Vec::new();
    for text in &arguments.categories {
        let form = || format!("'{text}' is not a factor with levels; write it as wall=steel:glass");
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
            !factors.iter().any(|factor| factor.symbol() == symbol)
                && !all.iter().any(|other| other.symbol() == symbol),
            "the symbol '{symbol}' is used twice; give each factor its own symbol"
        );
        all.push(category);
    }
    Ok(all)
}

/// All combinations of levels, the last factor changing fastest; one empty combination without named factors.
pub(super) fn combinations(named: &[Categorical]) -> Vec<Combination> {
    let names = |chosen: levels::Combination| chosen.into_iter().map(|(_, level)| level).collect();
    levels::combinations(named).into_iter().map(names).collect()
}

/// The design once for each combination, its cells counted on, and the combination of each cell.
pub(super) fn crossed(
    design: &Design,
    combinations: &[Combination],
) -> anyhow::Result<(Design, Vec<Combination>)> {
    let cells = design.runs().iter().map(|run| run.cell).max().unwrap_or(1);
    let again = |i: usize| {
        design.runs().iter().map(move |run| Run {
            cell: run.cell + i * cells,
            ..run.clone()
        })
    };
    let runs = (0..combinations.len()).flat_map(again).collect();
    let design = Design::with_runs(
        design.kind(),
        design.factors(),
        design.dummies().to_vec(),
        runs,
    )?;
    let of_cells = combinations.iter();
    let of_cells = of_cells.flat_map(|each| std::iter::repeat_n(each.clone(), cells));
    Ok((design, of_cells.collect()))
}

/// The design over all columns of a model with named levels, their columns behind the factors.
pub(super) fn expanded(
    design: &Design,
    model: &CategoricalModel,
    named: &[Categorical],
    of_cells: &[Combination],
) -> anyhow::Result<Design> {
    let k = design.factors().len();
    let run = |run: &Run| Run {
        coded: columns(&run.coded[..k], named, &of_cells[run.cell - 1]),
        ..run.clone()
    };
    let runs = design.runs().iter().map(run).collect();
    Ok(Design::with_runs(
        design.kind(),
        &model.factors,
        Vec::new(),
        runs,
    )?)
}

/// Coded values of all columns at a point with levels; a level that its factor lacks adds no columns.
pub(super) fn columns(coded: &[f64], named: &[Categorical], levels: &[String]) -> Vec<f64> {
    let pairs = named.iter().zip(levels);
    let of_levels = pairs.flat_map(|(factor, level)| factor.coded(level).unwrap_or_default());
    coded.iter().copied().chain(of_levels).collect()
}

/// The levels of each row of a table of runs.
pub(super) fn of_table(table: &Table, named: &[Categorical]) -> anyhow::Result<Vec<Combination>> {
    let mut all = vec![Combination::new(); table.rows().len()];
    for factor in named {
        let column = table.column(factor.symbol())?;
        for (row, chosen) in table.rows().iter().zip(&mut all) {
            let level = row.text(column);
            ensure!(
                factor.coded(level).is_some(),
                "{}: '{level}' is not a level of '{}'; they are {}",
                table.place(row, column),
                factor.symbol(),
                factor.levels().join(", ")
            );
            chosen.push(level.to_owned());
        }
    }
    Ok(all)
}

/// The table of the design, a column for each named factor behind the others.
pub(super) fn table(design: &Design, named: &[Categorical], of_cells: &[Combination]) -> String {
    let text = design_to_csv(design);
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let symbols = named.iter().map(Categorical::symbol);
    let mut out = [header]
        .into_iter()
        .chain(symbols)
        .collect::<Vec<_>>()
        .join(",")
        + "\n";
    for (line, run) in lines.zip(design.runs()) {
        let levels = of_cells[run.cell - 1].iter();
        let fields = [line.to_owned()]
            .into_iter()
            .chain(levels.map(|level| csv_field(level)));
        out += &(fields.collect::<Vec<_>>().join(",") + "\n");
    }
    out
}
