//! `seedloop design`: writes a design of experiments.

mod categories;
mod limits;
mod make;
mod optimal;

use std::path::PathBuf;

use anyhow::Context as _;
use clap::ValueEnum;
use command_line::{Common, DONE, Header, significant, write_new};
use experiment_design::table::factors_from_table;
use experiment_design::{Coordinate, Design, Region};
use response_surface::{Categorical, CategoricalModel, Evaluation, Over, evaluate};
use serde_json::json;

use make::Made;

/// Points of a region at which predictions are judged.
const POINTS: usize = 4000;

/// Writes a design of experiments as a table of runs
#[derive(clap::Args, Debug)]
#[command(
    after_help = "Example:\n  seedloop design bbd --factors factors.csv --seed 1 --out design.xlsx"
)]
pub(crate) struct Arguments {
    /// Kind of design
    #[arg(value_enum)]
    kind: Kind,

    /// Table of the factors: symbol,name,unit,low,high. Every table is CSV or an Excel workbook; book.xlsx#Factors names
    /// a sheet
    #[arg(long, value_name = "FACTORS.csv")]
    factors: PathBuf,

    /// Centre runs [default: 5 for bbd and ccd, 1 for dsd, otherwise 0]
    #[arg(long, value_name = "N")]
    centre: Option<usize>,

    /// Runs of the same settings
    #[arg(long, value_name = "N", default_value_t = 1)]
    replicates: usize,

    /// Puts the runs in the random order of this seed; without it they stay in standard order
    /// (lhs and the optimal designs then use seed 1)
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Number of runs before replication (pb: a multiple of four from 12 to 48; lhs; d-optimal,
    /// i-optimal: those added with --augment; steepest: 5 if not given)
    #[arg(long, value_name = "N")]
    runs: Option<usize>,

    /// Adds the mirror image of every run (pb, fraction)
    #[arg(long)]
    foldover: bool,

    /// Where the axial runs of ccd lie [default: face]
    #[arg(long, value_enum, conflicts_with = "alpha")]
    axial: Option<Axial>,

    /// Axial distance of ccd in half-ranges, instead of --axial
    #[arg(long, value_name = "HALF-RANGES")]
    alpha: Option<f64>,

    /// Generators of the fraction, D=ABC,E=-AB (D=A:B:C for longer symbols)
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    generators: Vec<String>,

    /// Blocks: the products that part them (full, fraction: ABC,CDE), or `orthogonal` (bbd, ccd)
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    blocks: Vec<String>,

    /// Design whose runs are kept and added to (d-optimal, i-optimal)
    #[arg(long, value_name = "DESIGN.csv")]
    augment: Option<PathBuf>,

    /// Analysis that a path (steepest) or a second stage (--target) starts from
    #[arg(long, value_name = "ANALYSIS.json")]
    analysis: Option<PathBuf>,

    /// Second stage: adds runs only where the surface of --analysis is within two standard errors
    /// of this value (d-optimal, i-optimal with --augment)
    #[arg(
        long,
        value_name = "VALUE",
        allow_negative_numbers = true,
        requires = "analysis"
    )]
    target: Option<f64>,

    /// Follows the path down instead of up (steepest)
    #[arg(long)]
    descend: bool,

    /// Distance of the points of a path in half-ranges (steepest) [default: 0.5]
    #[arg(long, value_name = "HALF-RANGES")]
    step: Option<f64>,

    /// How often the full factorial is halved (fraction) [default: 1]
    #[arg(long, value_name = "P", conflicts_with_all = ["generators", "resolution"])]
    halvings: Option<usize>,

    /// The fraction of fewest runs with this resolution, III, IV, V or 3, 4, 5, ...: main effects clear of each other, of
    /// two-factor interactions, and these of each other (fraction)
    #[arg(long, value_name = "R", conflicts_with = "generators", value_parser = resolution_argument)]
    resolution: Option<usize>,

    /// Model that d-optimal and i-optimal are made for, and every design is judged by: linear, 2fi,
    /// quadratic or a formula [default: linear for pb, fraction and dsd, 2fi for full, or quadratic]
    #[arg(long)]
    model: Option<String>,

    /// A factor with named levels, wall=steel:glass; optimal designs choose the level of each run, the others are repeated at
    /// every combination of levels. May be given several times
    #[arg(long = "category", value_name = "NAME=LEVELS")]
    categories: Vec<String>,

    /// A factor that takes these values alone, B=0.30:0.36:0.42, in its unit (d-optimal, i-optimal, full). May be given
    /// several times
    #[arg(long, value_name = "FACTOR=VALUES")]
    levels: Vec<String>,

    /// A limit that every run must keep, "2*B + E <= 0.5", in the units of the factors (d-optimal, i-optimal). May be given
    /// several times
    #[arg(long = "constraint", value_name = "INEQUALITY")]
    constraints: Vec<String>,

    /// Columns of dsd that no factor takes, for the error of the main effects; two add four runs [default: 2]
    #[arg(long, value_name = "N")]
    fake_factors: Option<usize>,

    /// File of the design; DESIGN.xlsx is written as an Excel workbook
    #[arg(long, value_name = "DESIGN.csv")]
    out: PathBuf,

    #[command(flatten)]
    common: Common,
}

/// Kinds of design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Plackett-Burman, for screening up to 47 factors
    Pb,
    /// Box-Behnken, for a quadratic in 3 to 7 factors
    Bbd,
    /// Central composite, for a quadratic in 2 to 8 factors
    Ccd,
    /// All combinations of two levels, or of those of --levels
    Full,
    /// A regular fraction of them
    Fraction,
    /// Definitive screening, three levels of 3 to 30 factors
    Dsd,
    /// Latin hypercube
    Lhs,
    /// Least determinant of the covariance of the coefficients
    DOptimal,
    /// Least mean variance of the prediction over the ranges
    IOptimal,
    /// Points along the path of steepest ascent of an analysis
    Steepest,
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

/// Reads a resolution in Roman or Arabic numerals.
fn resolution_argument(text: &str) -> Result<usize, String> {
    const ROMAN: [&str; 9] = ["III", "IV", "V", "VI", "VII", "VIII", "IX", "X", "XI"];
    let roman = ROMAN.iter().position(|r| text.eq_ignore_ascii_case(r));
    let number = roman.map(|place| place + 3).or_else(|| text.parse().ok());
    let number = number.filter(|r| (3..=11).contains(r));
    number.ok_or_else(|| "write III, IV, V, ... XI, or 3 to 11".to_owned())
}

/// Makes the design and writes it.
///
/// # Errors
/// Files that cannot be read or written, factors or counts that the design does not exist for.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let (inputs, files) = ([&arguments.factors], [&arguments.out]);
    arguments.common.try_outputs_beside(inputs, files)?;
    let path = &arguments.factors;
    let table = command_line::table_file::read(path)?;
    let factors = factors_from_table(&table).with_context(|| path.display().to_string())?;
    let named = categories::named(arguments, &factors)?;
    let Made {
        mut design,
        of_cells,
        region,
        facts,
    } = make::make(arguments, &factors, &named)?;
    if arguments.foldover {
        design = design.folded_over();
    }
    let of_cells = if let Some(of_cells) = of_cells {
        of_cells
    } else {
        let combinations = categories::combinations(&named);
        let (crossed, of_cells) = categories::crossed(&design, &combinations)?;
        design = crossed;
        of_cells
    };
    design = design.replicated(arguments.replicates)?;
    if let Some(seed) = arguments.seed {
        design = design.randomised(seed);
    }
    let levels = Levels {
        named: &named,
        of_cells: &of_cells,
    };
    let evaluation = judge(arguments, &design, &levels, region)?;
    let common = &arguments.common;
    let table = categories::table(&design, &named, &of_cells);
    let bytes = command_line::table_file::bytes_for(&arguments.out, &table)?;
    write_new(&arguments.out, &bytes, common.overwrite())?;
    let reach = design.reach();
    if reach > 1.0 {
        common.log(|| {
            format!("warning: runs reach {reach:.3} half-ranges from the middle, beyond the bounds")
        });
    }
    let runs = design.runs().len();
    common.emit_json(&report(arguments, &design, &facts, evaluation.as_ref())?)?;
    common.print(format!(
        "{runs} runs written to {}",
        arguments.out.display()
    ))?;
    if let Some(evaluation) = &evaluation {
        describe(common, evaluation)?;
    }
    Ok(DONE)
}

/// The named factors, and their levels in each cell.
struct Levels<'a> {
    /// The factors.
    named: &'a [Categorical],
    /// A level of each, by cell.
    of_cells: &'a [categories::Combination],
}

/// Judges the design by its model, over the region where runs may lie; none for a path and for very many runs.
fn judge(
    arguments: &Arguments,
    design: &Design,
    levels: &Levels<'_>,
    region: Option<Region>,
) -> anyhow::Result<Option<Evaluation>> {
    if arguments.kind == Kind::Steepest || design.runs().len() > 20_000 {
        return Ok(None);
    }
    let formula = arguments.model.as_deref().unwrap_or(match arguments.kind {
        Kind::Pb | Kind::Fraction | Kind::Dsd => "linear",
        Kind::Full => "2fi",
        _ => "quadratic",
    });
    let Levels { named, of_cells } = *levels;
    let model = CategoricalModel::parse(formula, design.factors(), named)?;
    let expanded = categories::expanded(design, &model, named, of_cells)?;
    let seed = arguments.seed.unwrap_or(1);
    let region = match region {
        None if !named.is_empty() => {
            let ranges = vec![Coordinate::Range; design.factors().len()];
            Some(Region::new(
                optimal::with_levels(ranges, named),
                Vec::new(),
            )?)
        }
        region => region,
    };
    let k = design.factors().len();
    let points = region.map(|region| {
        let points = region.sample(POINTS, seed).into_iter();
        let column = |x: Vec<f64>| {
            let chosen = optimal::levels_at(&x[k..], named);
            categories::columns(&x[..k], named, &chosen)
        };
        points.map(column).collect::<Vec<_>>()
    });
    let over = points.as_deref().map_or(Over::Box(seed), Over::Points);
    Ok(Some(evaluate(&expanded, &model.model, over)?))
}

/// Prints what the design can detect.
fn describe(common: &Common, evaluation: &Evaluation) -> anyhow::Result<()> {
    common.print(format!("for the model {}:", evaluation.model))?;
    if !evaluation.aliased.is_empty() {
        let relations = evaluation.aliased.join("; ");
        return common.print(format!("  the runs cannot separate its terms: {relations}"));
    }
    common.print(format!(
        "  residual degrees of freedom {}, of them pure error {}",
        evaluation.df_resid, evaluation.df_pure_error
    ))?;
    let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, f64::max);
    let vif = greatest(&mut evaluation.vif.values().copied());
    let leverage = greatest(&mut evaluation.leverage.iter().copied());
    common.print(format!(
        "  greatest correlation of terms {:.4}, variance inflation {vif:.3}, leverage {leverage:.4}",
        evaluation.greatest_correlation.unwrap_or(0.0)
    ))?;
    if let Some(e) = &evaluation.efficiency {
        common.print(format!(
            "  efficiency % D {:.2}, A {:.2}, G {:.2}; mean variance of the prediction {}",
            e.d_pct,
            e.a_pct,
            e.g_pct,
            significant(e.mean_variance, 5)
        ))?;
    }
    for (term, [one, two, three]) in evaluation.power.iter() {
        common.print(format!(
            "  power for {term:<8} of 1, 2, 3 standard deviations: {one:.3} {two:.3} {three:.3}"
        ))?;
    }
    Ok(())
}

/// The design as JSON.
fn report(
    arguments: &Arguments,
    design: &Design,
    facts: &serde_json::Value,
    evaluation: Option<&Evaluation>,
) -> anyhow::Result<serde_json::Value> {
    let header = Header::new(
        arguments.seed,
        [command_line::table_file::file_of(&arguments.factors)],
    )?;
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
        "evaluation": evaluation,
        "facts": facts,
        "runs": rows.collect::<Vec<_>>(),
    });
    if let (Some(report), serde_json::Value::Object(header)) =
        (report.as_object_mut(), serde_json::to_value(&header)?)
    {
        report.extend(header);
    }
    Ok(report)
}
