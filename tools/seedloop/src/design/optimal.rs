//! Designs that are optimal for the model asked for, within the region asked for.

use anyhow::Context as _;
use experiment_design::table::design_from_table;
use experiment_design::{
    Constraint, Coordinate, Criterion, Design, DesignKind, Factor, Region, augmented_near,
    optimal_rows,
};
use probability::t_two_sided_quantile;
use response_surface::{Categorical, CategoricalModel};
use serde_json::{Value, json};

use super::categories::{self, Combination};
use super::make::{Made, analysis};
use super::{Arguments, limits};

/// An optimal design for the model asked for.
pub(super) fn make(
    arguments: &Arguments,
    factors: &[Factor],
    named: &[Categorical],
    criterion: Criterion,
) -> anyhow::Result<Made> {
    let formula = arguments.model.as_deref().unwrap_or("quadratic");
    let model = CategoricalModel::parse(formula, factors, named)?;
    let seed = arguments.seed.unwrap_or(1);
    let k = factors.len();
    let row = |x: &[f64]| {
        let levels = levels_at(&x[k..], named);
        model
            .model
            .row(&categories::columns(&x[..k], named, &levels))
    };
    let region = region(arguments, factors, named)?;
    let given = given(arguments, factors, named)?;
    let runs = match arguments.runs {
        None if arguments.augment.is_none() => model.model.terms().len() + 5,
        runs => runs.context("--augment needs --runs N, the number of runs to add")?,
    };
    if let Some(target) = arguments.target {
        let given = &given;
        return near_target(arguments, factors, &region, target, |near| {
            augmented_near(factors, criterion, given, runs, seed, &row, near)
        });
    }
    let added = optimal_rows(&region, criterion, &given, runs, seed, &row)?;
    let kind = if given.is_empty() {
        criterion.kind()
    } else {
        DesignKind::Augmented
    };
    let of_cells = given.iter().chain(&added);
    let of_cells: Vec<Combination> = of_cells.map(|x| levels_at(&x[k..], named)).collect();
    let numbers =
        |rows: &[Vec<f64>]| -> Vec<Vec<f64>> { rows.iter().map(|x| x[..k].to_vec()).collect() };
    let design = Design::in_stages(kind, factors, &numbers(&given), numbers(&added))?;
    let restricted = !(arguments.constraints.is_empty() && arguments.levels.is_empty());
    let facts = if restricted {
        json!({ "constraints": arguments.constraints, "levels": arguments.levels })
    } else {
        Value::Null
    };
    Ok(Made {
        design,
        of_cells: Some(of_cells),
        region: (restricted || !named.is_empty()).then_some(region),
        facts,
    })
}

/// Where the runs may lie: the factors, then the named ones, whose values are the numbers of their levels.
fn region(
    arguments: &Arguments,
    factors: &[Factor],
    named: &[Categorical],
) -> anyhow::Result<Region> {
    let coordinates = with_levels(limits::coordinates(arguments, factors)?, named);
    let read = |text: &String| -> anyhow::Result<Constraint> {
        let mut constraint = limits::constraint(text, factors)?;
        constraint.weights.resize(coordinates.len(), 0.0);
        Ok(constraint)
    };
    let constraints = arguments.constraints.iter().map(read);
    let constraints = constraints.collect::<anyhow::Result<_>>()?;
    let texts = || arguments.constraints.join(", ");
    Region::new(coordinates, constraints).with_context(texts)
}

/// Coordinates of the factors, and behind them those of the named ones: the numbers of their levels.
pub(super) fn with_levels(mut factors: Vec<Coordinate>, named: &[Categorical]) -> Vec<Coordinate> {
    let numbers = |factor: &Categorical| (0..factor.levels().len()).map(|i| i as f64).collect();
    factors.extend(
        named
            .iter()
            .map(|factor| Coordinate::Levels(numbers(factor))),
    );
    factors
}

/// The levels that a point of the region has behind the factors.
pub(super) fn levels_at(numbers: &[f64], named: &[Categorical]) -> Combination {
    let pairs = named.iter().zip(numbers);
    let level = |(factor, number): (&Categorical, &f64)| {
        let levels = factor.levels().iter().enumerate();
        let mut found = levels.filter(|(i, _)| *i as f64 == *number);
        found.next().map(|(_, level)| level.clone())
    };
    pairs.filter_map(level).collect()
}

/// The runs that are kept, in the coordinates of the region.
fn given(
    arguments: &Arguments,
    factors: &[Factor],
    named: &[Categorical],
) -> anyhow::Result<Vec<Vec<f64>>> {
    let Some(file) = &arguments.augment else {
        return Ok(Vec::new());
    };
    let place = || file.display().to_string();
    let table = command_line::table_file::read(file)?;
    let design = design_from_table(&table, factors).with_context(place)?;
    let levels = categories::of_table(&table, named).with_context(place)?;
    let number = |(factor, level): (&Categorical, &String)| {
        let found = factor.levels().iter().position(|l| l == level);
        found.map_or(0.0, |i| i as f64)
    };
    let rows = design.coded_rows().into_iter().zip(&levels);
    Ok(rows
        .map(|(row, levels)| {
            row.into_iter()
                .chain(named.iter().zip(levels).map(number))
                .collect()
        })
        .collect())
}

/// A second stage near the contour of an analysis at the target; `add` adds the runs at places that are allowed.
fn near_target(
    arguments: &Arguments,
    factors: &[Factor],
    region: &Region,
    target: f64,
    add: impl Fn(&dyn Fn(&[f64]) -> bool) -> Result<Design, experiment_design::Error>,
) -> anyhow::Result<Made> {
    let (fit, transform) = analysis(arguments, factors)?;
    let on_scale = match transform {
        None => target,
        Some(transform) => transform.forward(target).with_context(|| {
            let domain = transform.domain();
            format!(
                "--target is {target}; the analysis is of {transform}, so that it must be {domain}"
            )
        })?,
    };
    let error = fit
        .best_error_variance()
        .context("the analysis has no error variance; replicate runs of the first stage")?;
    let limit = t_two_sided_quantile(0.05, error.df as f64).unwrap_or(2.0);
    let near = |x: &[f64]| {
        let se = (error.variance * fit.leverage(x)).sqrt();
        region.holds(x) && (fit.value(x) - on_scale).abs() < limit * se
    };
    let design = add(&near)?;
    Ok(Made {
        facts: json!({ "near_target": target, "added_runs": arguments.runs, "error": error }),
        ..design.into()
    })
}
