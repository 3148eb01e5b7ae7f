//! The design that the arguments ask for.

use std::path::Path;

use anyhow::{Context as _, ensure};
use experiment_design::table::design_from_table;
use experiment_design::{
    AxialDistance, Criterion, Design, DesignKind, Factor, Fraction, augmented_design,
    augmented_near, box_behnken, box_behnken_in_blocks, central_composite,
    central_composite_in_blocks, fraction_with_generators, fractional_factorial, full_factorial,
    in_blocks, latin_hypercube, plackett_burman, plackett_burman_with_runs,
};
use response_surface::distribution::t_two_sided_quantile;
use response_surface::{Fit, Model, Transform, ridge_path};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Arguments, Axial, Kind};

/// A design and what there is to say about it.
pub(super) struct Made {
    /// The runs in standard order, not replicated.
    pub(super) design: Design,
    /// Resolution, aliases, blocks and the like.
    pub(super) facts: Value,
}

impl From<Design> for Made {
    fn from(design: Design) -> Self {
        Self {
            design,
            facts: Value::Null,
        }
    }
}

/// Makes the design.
pub(super) fn make(arguments: &Arguments, factors: &[Factor]) -> anyhow::Result<Made> {
    check(arguments)?;
    let seed = arguments.seed.unwrap_or(1);
    let centre = |default: usize| arguments.centre.unwrap_or(default);
    let orthogonal = arguments.blocks == ["orthogonal"];
    Ok(match arguments.kind {
        Kind::Pb => match arguments.runs {
            Some(runs) => plackett_burman_with_runs(factors, runs)?.into(),
            None => plackett_burman(factors)?.into(),
        },
        Kind::Bbd if orthogonal => {
            let default = if factors.len() == 4 { 3 } else { 6 };
            box_behnken_in_blocks(factors, centre(default))?.into()
        }
        Kind::Bbd => box_behnken(factors, centre(5))?.into(),
        Kind::Ccd if orthogonal => {
            let all = centre(6);
            let cube = all - all / 3;
            central_composite_in_blocks(factors, cube, all / 3)?.into()
        }
        Kind::Ccd => {
            let distance = arguments
                .alpha
                .map_or(axial(arguments.axial), AxialDistance::At);
            central_composite(factors, distance, centre(5))?.into()
        }
        Kind::Full => blocked(arguments, full_factorial(factors, centre(0))?, json!({}))?,
        Kind::Fraction => {
            let fraction = if arguments.generators.is_empty() {
                fractional_factorial(factors, arguments.halvings, centre(0))?
            } else {
                fraction_with_generators(factors, &arguments.generators, centre(0))?
            };
            let facts = told(arguments, &fraction);
            blocked(arguments, fraction.design, facts)?
        }
        Kind::Lhs => {
            let runs = arguments
                .runs
                .context("lhs needs --runs N; 10 per factor are a start")?;
            latin_hypercube(factors, runs, seed)?.into()
        }
        Kind::DOptimal => optimal(arguments, factors, Criterion::Determinant, seed)?,
        Kind::IOptimal => optimal(arguments, factors, Criterion::MeanVariance, seed)?,
        Kind::Steepest => path(arguments, factors)?,
    })
}

/// Refuses arguments that the kind does not take.
fn check(arguments: &Arguments) -> anyhow::Result<()> {
    use Kind::{Bbd, Ccd, DOptimal, Fraction, Full, IOptimal, Lhs, Pb, Steepest};
    let kind = arguments.kind;
    ensure!(
        matches!(kind, Bbd | Ccd | Full | Fraction) || arguments.centre.is_none(),
        "--centre is for bbd, ccd, full and fraction"
    );
    ensure!(
        matches!(kind, Pb | Lhs | DOptimal | IOptimal | Steepest) || arguments.runs.is_none(),
        "--runs is for pb, lhs, d-optimal, i-optimal and steepest; use --replicates or --centre"
    );
    ensure!(
        kind == Fraction || arguments.generators.is_empty(),
        "--generators is for fraction"
    );
    ensure!(
        kind == Ccd || arguments.alpha.is_none(),
        "--alpha is for ccd"
    );
    let products = matches!(kind, Full | Fraction) && arguments.blocks != ["orthogonal"];
    let orthogonal = matches!(kind, Bbd | Ccd) && arguments.blocks == ["orthogonal"];
    ensure!(
        arguments.blocks.is_empty() || products || orthogonal,
        "--blocks takes products such as ABC for full and fraction, `orthogonal` for bbd and ccd"
    );
    ensure!(
        !orthogonal || arguments.alpha.is_none(),
        "--blocks orthogonal sets the axial distance itself; leave --alpha out"
    );
    ensure!(
        matches!(kind, DOptimal | IOptimal) || arguments.augment.is_none(),
        "--augment is for d-optimal and i-optimal"
    );
    ensure!(
        arguments.target.is_none() || arguments.augment.is_some(),
        "--target needs --augment, the design of the first stage"
    );
    Ok(())
}

/// Parts a two-level design into blocks where asked for.
fn blocked(arguments: &Arguments, design: Design, mut facts: Value) -> anyhow::Result<Made> {
    if arguments.blocks.is_empty() {
        return Ok(Made { design, facts });
    }
    let (design, confounded) = in_blocks(&design, &arguments.blocks)?;
    let words = confounded.join(", ");
    arguments
        .common
        .log(|| format!("confounded with blocks: {words}"));
    facts["confounded_with_blocks"] = json!(confounded);
    Ok(Made { design, facts })
}

/// Tells what a fraction costs.
fn told(arguments: &Arguments, fraction: &Fraction) -> Value {
    let words = fraction.defining_words.join(", ");
    let resolution = fraction.resolution;
    let common = &arguments.common;
    common.log(|| format!("resolution {resolution}; constant products: {words}"));
    for set in &fraction.aliases {
        common.log(|| format!("cannot be told apart: {}", set.join(" = ")));
    }
    json!({
        "resolution": resolution,
        "defining_words": fraction.defining_words,
        "alias_sets": fraction.aliases,
    })
}

/// An optimal design for the model asked for.
fn optimal(
    arguments: &Arguments,
    factors: &[Factor],
    criterion: Criterion,
    seed: u64,
) -> anyhow::Result<Made> {
    let formula = arguments.model.as_deref().unwrap_or("quadratic");
    let model = Model::parse(formula, factors)?;
    let terms = model.terms().len();
    let row = |coded: &[f64]| model.row(coded);
    let Some(file) = &arguments.augment else {
        let runs = arguments.runs.unwrap_or(terms + 5);
        return Ok(augmented_design(factors, criterion, &[], runs, seed, &row)?.into());
    };
    let place = file.display();
    let table = table_file::read(file)?;
    let given = design_from_table(&table, factors).with_context(|| place.to_string())?;
    let given = given.coded_rows();
    let runs = arguments
        .runs
        .context("--augment needs --runs N, the number of runs to add")?;
    let Some(target) = arguments.target else {
        return Ok(augmented_design(factors, criterion, &given, runs, seed, &row)?.into());
    };
    let (fit, transform) = analysis(arguments, factors)?;
    let target = match transform {
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
        (fit.value(x) - target).abs() < limit * se
    };
    let design = augmented_near(factors, criterion, &given, runs, seed, &row, &near)
        .context("no second stage near the target; is it within reach of the surface?")?;
    Ok(Made {
        design,
        facts: json!({ "near_target": arguments.target, "added_runs": runs, "error": error }),
    })
}

/// The analysis named, over the given factors.
fn analysis(arguments: &Arguments, factors: &[Factor]) -> anyhow::Result<(Fit, Option<Transform>)> {
    let file: &Path = arguments
        .analysis
        .as_deref()
        .context("this needs --analysis ANALYSIS.json, written by seedloop analyse --json")?;
    let place = file.display();
    let text = input_file::read_text(file).with_context(|| format!("cannot read {place}"))?;
    let fit: Fit = serde_json::from_str(&text).with_context(|| {
        format!("{place} is no analysis; write one with seedloop analyse --json")
    })?;
    let is_coded = |f: &Factor| (f.low(), f.high()) == (-1.0, 1.0);
    for (old, new) in fit.factors.iter().zip(factors) {
        ensure!(
            !is_coded(old) || is_coded(new),
            "{place} was made from coded values of '{}', and the table of factors has its natural range \
             {} to {}: analyse again with --factors {}={}:{}",
            old.symbol(),
            new.low(),
            new.high(),
            new.symbol(),
            new.low(),
            new.high()
        );
    }
    let scale: Fitted = serde_json::from_str(&text).with_context(|| place.to_string())?;
    let fit = fit.within(factors).with_context(|| place.to_string())?;
    Ok((fit, scale.transform))
}

/// What an analysis tells about the scale of its response.
#[derive(Deserialize)]
struct Fitted {
    /// The function of the response that was fitted; missing in analyses of older versions.
    #[serde(default)]
    transform: Option<Transform>,
}

/// Points along the path of steepest ascent or descent.
fn path(arguments: &Arguments, factors: &[Factor]) -> anyhow::Result<Made> {
    let (fit, transform) = analysis(arguments, factors)?;
    // Up is where the response rises, be it where its function falls.
    let falls = transform.is_some_and(Transform::falls);
    let step = arguments.step;
    ensure!(
        step > 0.0 && step <= 10.0,
        "--step is {step}; it must lie above 0 and be 10 at most"
    );
    let runs = arguments.runs.unwrap_or(5);
    ensure!(
        (1..=100).contains(&runs),
        "--runs is {runs}; a path has 1 to 100 points"
    );
    let radii: Vec<f64> = (0..=runs).map(|i| step * i as f64).collect();
    let points = ridge_path(&fit, &radii, arguments.descend == falls)?;
    let rows = points.iter().map(|point| point.coded.clone()).collect();
    Ok(Made {
        design: Design::new(DesignKind::SteepestAscent, factors, Vec::new(), rows)?,
        facts: json!({ "path": points }),
    })
}

/// The place of the axial runs.
fn axial(axial: Axial) -> AxialDistance {
    match axial {
        Axial::Face => AxialDistance::Face,
        Axial::Rotatable => AxialDistance::Rotatable,
        Axial::Inscribed => AxialDistance::RotatableInscribed,
        Axial::Spherical => AxialDistance::Spherical,
    }
}
