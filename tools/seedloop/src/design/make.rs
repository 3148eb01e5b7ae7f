//! The design that the arguments ask for.

use std::path::Path;

use anyhow::{Context as _, ensure};
use experiment_design::{
    AxialDistance, Coordinate, Criterion, Design, DesignKind, Factor, Fraction, Region,
    box_behnken, box_behnken_in_blocks, central_composite, central_composite_in_blocks,
    definitive_screening, fraction_of_resolution, fraction_with_generators, fractional_factorial,
    full_factorial, in_blocks, latin_hypercube, mixed_factorial, plackett_burman,
    plackett_burman_with_runs,
};
use response_surface::{Categorical, Fit, Transform, ridge_path};
use serde::Deserialize;
use serde_json::{Value, json};

use super::categories::Combination;
use super::{Arguments, Axial, Kind, limits, optimal};

/// A design and what there is to say about it.
pub(super) struct Made {
    /// The runs in standard order, not replicated.
    pub(super) design: Design,
    /// The levels of the named factors in each cell, where the design chose them.
    pub(super) of_cells: Option<Vec<Combination>>,
    /// Where runs may lie, the named factors behind the others, where that is less than the box.
    pub(super) region: Option<Region>,
    /// Resolution, aliases, blocks and the like.
    pub(super) facts: Value,
}

impl From<Design> for Made {
    fn from(design: Design) -> Self {
        Self {
            design,
            of_cells: None,
            region: None,
            facts: Value::Null,
        }
    }
}

/// Makes the design.
#[allow(clippy::too_many_lines, reason = "each kind has its call here")]
pub(super) fn make(
    arguments: &Arguments,
    factors: &[Factor],
    named: &[Categorical],
) -> anyhow::Result<Made> {
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
            let distance = arguments.alpha.map_or(
                axial(arguments.axial.unwrap_or(Axial::Face)),
                AxialDistance::At,
            );
            central_composite(factors, distance, centre(5))?.into()
        }
        Kind::Full if arguments.levels.is_empty() => {
            blocked(arguments, full_factorial(factors, centre(0))?, json!({}))?
        }
        Kind::Full => {
            let ends = |coordinate| match coordinate {
                Coordinate::Range => vec![-1.0, 1.0],
                Coordinate::Levels(levels) => levels,
            };
            let levels = limits::coordinates(arguments, factors)?;
            let levels: Vec<Vec<f64>> = levels.into_iter().map(ends).collect();
            mixed_factorial(factors, &levels, centre(0))?.into()
        }
        Kind::Fraction => {
            let fraction = if let Some(resolution) = arguments.resolution {
                fraction_of_resolution(factors, resolution, centre(0))?
            } else if arguments.generators.is_empty() {
                fractional_factorial(factors, arguments.halvings.unwrap_or(1), centre(0))?
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
        Kind::Dsd => {
            let fake = arguments.fake_factors.unwrap_or(2);
            definitive_screening(factors, fake, centre(1))?.into()
        }
        Kind::DOptimal => optimal::make(arguments, factors, named, Criterion::Determinant)?,
        Kind::IOptimal => optimal::make(arguments, factors, named, Criterion::MeanVariance)?,
        Kind::Steepest => path(arguments, factors)?,
    })
}

/// Refuses arguments that the kind does not take: one that is left unread would be taken for one that was followed.
fn check(arguments: &Arguments) -> anyhow::Result<()> {
    use Kind::{Ccd, DOptimal, Fraction, IOptimal, Pb, Steepest};
    let kind = arguments.kind;
    let is_optimal = matches!(kind, DOptimal | IOptimal);
    let only = |is_given: bool, flag: &str, kinds: &[Kind], names: &str| {
        ensure!(
            !is_given || kinds.contains(&kind),
            "{flag} is for {names}; leave it out"
        );
        Ok(())
    };
    only(
        arguments.halvings.is_some(),
        "--halvings",
        &[Fraction],
        "fraction",
    )?;
    only(
        arguments.resolution.is_some(),
        "--resolution",
        &[Fraction],
        "fraction",
    )?;
    only(arguments.axial.is_some(), "--axial", &[Ccd], "ccd")?;
    only(arguments.step.is_some(), "--step", &[Steepest], "steepest")?;
    only(arguments.descend, "--descend", &[Steepest], "steepest")?;
    only(
        arguments.foldover,
        "--foldover",
        &[Pb, Fraction],
        "pb and fraction",
    )?;
    ensure!(
        kind == Steepest || arguments.analysis.is_none() || arguments.target.is_some(),
        "--analysis is for steepest, and for a second stage beside --target"
    );
    ensure!(
        kind != Steepest || arguments.model.is_none(),
        "a path has no model to be judged by; leave --model out"
    );
    ensure!(
        arguments.target.is_none() || is_optimal,
        "--target is for d-optimal and i-optimal"
    );
    check_runs(arguments)
}

/// Refuses arguments about runs and their limits that the kind does not take.
fn check_runs(arguments: &Arguments) -> anyhow::Result<()> {
    use Kind::{Bbd, Ccd, DOptimal, Dsd, Fraction, Full, IOptimal, Lhs, Pb, Steepest};
    let kind = arguments.kind;
    let is_optimal = matches!(kind, DOptimal | IOptimal);
    ensure!(
        matches!(kind, Bbd | Ccd | Full | Fraction | Dsd) || arguments.centre.is_none(),
        "--centre is for bbd, ccd, full, fraction and dsd"
    );
    ensure!(
        kind == Dsd || arguments.fake_factors.is_none(),
        "--fake-factors is for dsd"
    );
    ensure!(
        is_optimal || kind == Full || arguments.levels.is_empty(),
        "--levels is for d-optimal, i-optimal and full"
    );
    ensure!(
        arguments.levels.is_empty() || arguments.blocks.is_empty(),
        "--blocks parts factorials of two levels; leave --levels out"
    );
    ensure!(
        is_optimal || arguments.constraints.is_empty(),
        "--constraint is for d-optimal and i-optimal"
    );
    ensure!(
        arguments.target.is_none()
            || (arguments.levels.is_empty() && arguments.categories.is_empty()),
        "--target takes runs from a grid of the ranges; leave --levels and --category out"
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
        !orthogonal || (arguments.alpha.is_none() && arguments.axial.is_none()),
        "--blocks orthogonal sets the axial distance itself; leave --alpha and --axial out"
    );
    ensure!(
        is_optimal || arguments.augment.is_none(),
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
        return Ok(Made {
            facts,
            ..design.into()
        });
    }
    let (design, confounded) = in_blocks(&design, &arguments.blocks)?;
    let words = confounded.join(", ");
    arguments
        .common
        .log(|| format!("confounded with blocks: {words}"));
    facts["confounded_with_blocks"] = json!(confounded);
    Ok(Made {
        facts,
        ..design.into()
    })
}

/// Reports which effects a fraction confounds.
fn told(arguments: &Arguments, fraction: &Fraction) -> Value {
    let words = fraction.defining_words.join(", ");
    let resolution = fraction.resolution;
    let common = &arguments.common;
    common.log(|| format!("resolution {resolution}; constant products: {words}"));
    for set in &fraction.aliases {
        common.log(|| format!("cannot be distinguished: {}", set.join(" = ")));
    }
    json!({
        "resolution": resolution,
        "defining_words": fraction.defining_words,
        "alias_sets": fraction.aliases,
    })
}

/// The analysis named, over the given factors.
pub(super) fn analysis(
    arguments: &Arguments,
    factors: &[Factor],
) -> anyhow::Result<(Fit, Option<Transform>)> {
    let file: &Path = arguments
        .analysis
        .as_deref()
        .context("this needs --analysis ANALYSIS.json, written by seedloop analyse --json")?;
    let place = file.display();
    let text = input::file::read_text(file).with_context(|| format!("cannot read {place}"))?;
    let fit: Fit = serde_json::from_str(&text).with_context(|| {
        format!("{place} is not an analysis; write one with seedloop analyse --json")
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

/// The scale of the response of an analysis.
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
    let step = arguments.step.unwrap_or(0.5);
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
        facts: json!({ "path": points }),
        ..Design::new(DesignKind::SteepestAscent, factors, Vec::new(), rows)?.into()
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
