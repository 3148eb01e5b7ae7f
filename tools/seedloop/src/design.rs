//! `seedloop design`: writes a design of experiments.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, ensure};
use clap::ValueEnum;
use command_line::{Common, DONE, Header, write_new};
use experiment_design::table::{design_to_csv, factors_from_csv};
use experiment_design::{
    AxialDistance, Criterion, Design, Factor, box_behnken, central_composite, fractional_factorial,
    full_factorial, latin_hypercube, optimal_design, plackett_burman, plackett_burman_with_runs,
};
use response_surface::Model;
use serde_json::json;

/// Writes a design of experiments as a table of runs
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Kind of design
    #[arg(value_enum)]
    kind: Kind,

    /// Table of the factors: symbol,name,unit,low,high
    #[arg(long, value_name = "FACTORS.csv")]
    factors: PathBuf,

    /// Centre runs [default: 5 for bbd and ccd, otherwise 0]
    #[arg(long, value_name = "N")]
    centre: Option<usize>,

    /// Runs of the same settings
    #[arg(long, value_name = "N", default_value_t = 1)]
    replicates: usize,

    /// Puts the runs in the random order of this seed; without it they stay in standard order
    /// (lhs and the optimal designs then use seed 1)
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Number of runs before replication (pb: 12, 20 or 24; lhs; d-optimal, i-optimal)
    #[arg(long, value_name = "N")]
    runs: Option<usize>,

    /// Adds the mirror image of every run (pb, fraction)
    #[arg(long)]
    foldover: bool,

    /// Where the axial runs of ccd lie
    #[arg(long, value_enum, default_value_t = Axial::Face)]
    axial: Axial,

    /// How often the full factorial is halved (fraction)
    #[arg(long, value_name = "P", default_value_t = 1)]
    halvings: usize,

    /// Model that d-optimal and i-optimal are made for: linear, 2fi, quadratic or a formula
    #[arg(long, default_value = "quadratic")]
    model: String,

    /// File of the design
    #[arg(long, value_name = "DESIGN.csv")]
    out: PathBuf,

    #[command(flatten)]
    common: Common,
}

/// Kinds of design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Plackett-Burman, for screening up to 23 factors
    Pb,
    /// Box-Behnken, for a quadratic in 3 to 7 factors
    Bbd,
    /// Central composite, for a quadratic in 2 to 8 factors
    Ccd,
    /// All combinations of two levels
    Full,
    /// A regular fraction of them
    Fraction,
    /// Latin hypercube
    Lhs,
    /// Least determinant of the covariance of the coefficients
    DOptimal,
    /// Least mean variance of the prediction over the ranges
    IOptimal,
}

/// Where axial runs lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Axial {
    /// On the bounds of the factors
    Face,
    /// Beyond the bounds, equal precision in all directions
    Rotatable,
    /// As rotatable, shrunk onto the bounds
    Inscribed,
    /// Beyond the bounds, on one sphere with the corners
    Spherical,
}

/// Makes the design and writes it.
///
/// # Errors
/// Files that cannot be read or written, factors or counts that the design does not exist for.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let path = &arguments.factors;
    let text =
        fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let factors = factors_from_csv(&text).with_context(|| path.display().to_string())?;
    let mut design = make(arguments, &factors)?;
    if arguments.foldover {
        ensure!(
            matches!(arguments.kind, Kind::Pb | Kind::Fraction),
            "--foldover is for pb and fraction"
        );
        design = design.folded_over();
    }
    design = design.replicated(arguments.replicates)?;
    if let Some(seed) = arguments.seed {
        design = design.randomised(seed);
    }
    let common = &arguments.common;
    write_new(
        &arguments.out,
        design_to_csv(&design).as_bytes(),
        common.overwrite(),
    )?;
    let reach = design.reach();
    if reach > 1.0 {
        common.log(|| {
            format!("warning: runs reach {reach:.3} half-ranges from the middle, beyond the bounds")
        });
    }
    let runs = design.runs().len();
    common.print(format!(
        "{runs} runs written to {}",
        arguments.out.display()
    ))?;
    common.emit_json(&report(arguments, &design)?)?;
    Ok(DONE)
}

/// The design in standard order, not replicated.
fn make(arguments: &Arguments, factors: &[Factor]) -> anyhow::Result<Design> {
    let seed = arguments.seed.unwrap_or(1);
    let centre = |default: usize| arguments.centre.unwrap_or(default);
    let takes_centre = matches!(
        arguments.kind,
        Kind::Bbd | Kind::Ccd | Kind::Full | Kind::Fraction
    );
    ensure!(
        takes_centre || arguments.centre.is_none(),
        "--centre is for bbd, ccd, full and fraction"
    );
    let takes_runs = matches!(
        arguments.kind,
        Kind::Pb | Kind::Lhs | Kind::DOptimal | Kind::IOptimal
    );
    ensure!(
        takes_runs || arguments.runs.is_none(),
        "--runs is for pb, lhs, d-optimal and i-optimal; use --replicates or --centre"
    );
    Ok(match arguments.kind {
        Kind::Pb => match arguments.runs {
            Some(runs) => plackett_burman_with_runs(factors, runs)?,
            None => plackett_burman(factors)?,
        },
        Kind::Bbd => box_behnken(factors, centre(5))?,
        Kind::Ccd => central_composite(factors, axial(arguments.axial), centre(5))?,
        Kind::Full => full_factorial(factors, centre(0))?,
        Kind::Fraction => {
            let fraction = fractional_factorial(factors, arguments.halvings, centre(0))?;
            let words = fraction.defining_words.join(", ");
            let resolution = fraction.resolution;
            arguments
                .common
                .log(|| format!("resolution {resolution}; constant products: {words}"));
            fraction.design
        }
        Kind::Lhs => {
            let runs = arguments
                .runs
                .context("lhs needs --runs N; 10 per factor are a start")?;
            latin_hypercube(factors, runs, seed)?
        }
        Kind::DOptimal => optimal(arguments, factors, Criterion::Determinant, seed)?,
        Kind::IOptimal => optimal(arguments, factors, Criterion::MeanVariance, seed)?,
    })
}

/// An optimal design for the model asked for.
fn optimal(
    arguments: &Arguments,
    factors: &[Factor],
    criterion: Criterion,
    seed: u64,
) -> anyhow::Result<Design> {
    let model = Model::parse(&arguments.model, factors)?;
    let terms = model.terms().len();
    let runs = arguments.runs.unwrap_or(terms + 5);
    Ok(optimal_design(factors, criterion, runs, seed, &|coded| {
        model.row(coded)
    })?)
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

/// The design as JSON.
fn report(arguments: &Arguments, design: &Design) -> anyhow::Result<serde_json::Value> {
    let header = Header::new(arguments.seed, [&arguments.factors])?;
    let rows = design.runs().iter().enumerate().map(|(i, run)| {
        json!({
            "run": i + 1,
            "cell": run.cell,
            "replicate": run.replicate,
            "block": run.block,
            "coded": run.coded,
            "natural": design.natural(i),
        })
    });
    let mut report = json!({
        "kind": design.kind(),
        "factors": design.factors(),
        "dummies": design.dummies(),
        "columns": design.columns(),
        "reach_coded": design.reach(),
        "out": arguments.out.display().to_string(),
        "runs": rows.collect::<Vec<_>>(),
    });
    if let (Some(report), serde_json::Value::Object(header)) =
        (report.as_object_mut(), serde_json::to_value(&header)?)
    {
        report.extend(header);
    }
    Ok(report)
}
