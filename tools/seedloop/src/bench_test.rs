//! `seedloop bench-test`: contact parameters from the bench, measured or simulated.

mod measured;
mod summary;

use crate::simulate::read_scene;
use anyhow::{Context as _, ensure};
use clap::ValueEnum;
use command_line::{Common, DONE, Header, significant};
use input::quantity::Length;
use measured::{Test, coefficients};
use scene::{Apparatus, Drop, FillingLibrary, RunResult, Slider, Tilt};
use serde::Serialize;
use simulators::scene_simulator::ReadScene;
use std::path::{Path, PathBuf};
use summary::{Summary, summarise};

/// Height of a drop if none is given, mm.
const HEIGHT_MM: f64 = 200.0;

/// A bench test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Restitution from the heights of a drop
    Drop,
    /// Static friction from the pull on a sled
    Slider,
    /// Rolling friction from the angle at which a seed starts to roll
    Tilt,
}

/// Reads bench measurements, or does the same test with the solver, and prints the coefficient
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop bench-test tilt angles.csv")]
pub(crate) struct Arguments {
    /// Which test
    #[arg(value_enum)]
    test: Kind,

    /// Measurements with the columns `drop_height_mm,rebound_height_mm` (drop),
    /// `pull_force_n,normal_force_n` (slider) or `angle_deg` (tilt): CSV or an Excel workbook
    #[arg(value_name = "DATA.csv", conflicts_with = "scene")]
    data: Option<PathBuf>,

    /// Does the test with the solver: seeds and contacts of this scene
    #[arg(long, value_name = "SCENE.toml")]
    scene: Option<PathBuf>,

    /// Parameters that a calibration wrote: the values of its parameters.toml
    #[arg(long, value_name = "PARAMETERS.toml", requires = "scene")]
    set_file: Option<PathBuf>,

    /// Material of the plate, as the scene names it; that of the seeds makes a plate of seeds
    #[arg(long, value_name = "MATERIAL", requires = "scene")]
    plate: Option<String>,

    /// Kind of seed, as the scene names it [default: the first]
    #[arg(long, value_name = "NAME", requires = "scene")]
    kind: Option<String>,

    /// Height of the drop; the study does not state its own [default: 200]
    #[arg(
        long,
        value_name = "MM",
        requires = "scene",
        allow_negative_numbers = true
    )]
    height_mm: Option<f64>,

    /// Number of repeats [default: 40 drops, 5 pulls, 20 tilts]
    #[arg(long, value_name = "N", requires = "scene")]
    repeats: Option<usize>,

    /// Seed of orientations [default: 1]
    #[arg(long, value_name = "N", requires = "scene")]
    seed: Option<u64>,

    #[command(flatten)]
    common: Common,
}

/// A coefficient in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// `measured` or `simulated`.
    origin: &'static str,
    /// Name of the coefficient.
    coefficient: &'static str,
    /// What the scene puts into the contact of each sphere; none for measurements.
    put_in: Option<f64>,
    /// Seeds that slid instead of rolling; tilt only.
    slid: usize,
    /// What the user should know of the values of the parameter file.
    warnings: Vec<String>,
    /// Mean, spread, interval.
    #[serde(flatten)]
    summary: Summary,
}

/// Does the test and prints the coefficient.
///
/// # Errors
/// A table or scene that cannot be read, a test that does not come to its end.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    common.try_outputs([])?;
    // The parser asks for no --scene beside a table, which excludes it.
    let simulates = arguments.repeats.is_some()
        || arguments.seed.is_some()
        || arguments.height_mm.is_some()
        || arguments.set_file.is_some()
        || arguments.plate.is_some()
        || arguments.kind.is_some();
    ensure!(
        arguments.scene.is_some() || !simulates,
        "--repeats, --seed, --height-mm, --set-file, --plate and --kind are for a test with the solver; give --scene instead \
         of a table, or leave them out"
    );
    ensure!(
        arguments.test == Kind::Drop || arguments.height_mm.is_none(),
        "--height-mm is for drop"
    );
    let report = match (&arguments.scene, &arguments.data) {
        (Some(file), _) => simulated(arguments, file)?,
        (None, Some(file)) => measured(arguments.test, file)?,
        (None, None) => anyhow::bail!("give DATA.csv, or --scene SCENE.toml for a simulated test"),
    };
    let s = &report.summary;
    common.print(format!(
        "{} {} {} (sd {}, n {}, 95 % interval {} to {}, range {} to {})",
        report.origin,
        report.coefficient,
        significant(s.mean, 4),
        significant(s.sd, 3),
        s.n,
        significant(s.interval[0], 4),
        significant(s.interval[1], 4),
        significant(s.min, 4),
        significant(s.max, 4)
    ))?;
    if let Some(put_in) = report.put_in {
        common.print(format!("put into the contact of each sphere: {put_in}"))?;
    }
    if report.slid > 0 {
        common.log(|| format!("warning: {} seeds slid instead of rolling", report.slid));
    }
    common.emit_json(&report)?;
    Ok(DONE)
}

/// The test as the tables know it.
fn test_of(kind: Kind) -> Test {
    match kind {
        Kind::Drop => Test::Drop,
        Kind::Slider => Test::Slider,
        Kind::Tilt => Test::Tilt,
    }
}

/// Reads a table.
fn measured(kind: Kind, file: &Path) -> anyhow::Result<Report> {
    let table = command_line::table_file::read(file)?;
    let test = test_of(kind);
    let coefficients = coefficients(test, &table).with_context(|| file.display().to_string())?;
    Ok(Report {
        header: Header::new(None, [command_line::table_file::file_of(file)])?,
        origin: "measured",
        coefficient: test.coefficient(),
        put_in: None,
        slid: 0,
        warnings: Vec::new(),
        summary: summarise(&coefficients)?,
    })
}

/// Does the test with the solver.
fn simulated(arguments: &Arguments, file: &Path) -> anyhow::Result<Report> {
    let set_file = arguments.set_file.as_deref();
    let ReadScene {
        scene, warnings, ..
    } = read_scene(file, set_file, &[], &arguments.common)?;
    let first = scene.seed.first().context("the scene has no seed")?;
    let seed_name = arguments.kind.clone().unwrap_or_else(|| first.name.clone());
    let plate = arguments
        .plate
        .as_deref()
        .context("--plate MATERIAL is missing: the plate on which the test is done")?;
    let kind = scene
        .seed
        .iter()
        .find(|s| s.name == seed_name)
        .unwrap_or(first);
    let material = kind.material.clone();
    let repeats = arguments.repeats.unwrap_or(match arguments.test {
        Kind::Drop => 40,
        Kind::Slider => 5,
        Kind::Tilt => 20,
    });
    ensure!(
        repeats >= 2,
        "--repeats {repeats}: at least 2 are needed for an interval"
    );
    let scene = scene
        .in_apparatus(apparatus(arguments, plate, seed_name, repeats)?)?
        .reduced();
    let contact = scene
        .contact_of(&material, plate)
        .context("the contact of seed and plate is missing")?;
    let put_in = match arguments.test {
        Kind::Drop => contact.restitution.get(),
        Kind::Slider => contact.static_friction.get(),
        Kind::Tilt => contact.rolling_friction.get(),
    };
    let seed = arguments.seed.unwrap_or(1);
    let result = scene::run(&scene, &FillingLibrary::default(), seed)?;
    let slid = values(&result, "slid_share").iter().filter(|s| **s > 0.5);
    let slid = slid.count();
    let shown = format!("shown_{}", test_of(arguments.test).coefficient());
    let meshes = scene
        .shape_files()
        .into_iter()
        .map(|m| scene.folder.join(m));
    let inputs = [file.to_path_buf()].into_iter();
    let inputs = inputs.chain(arguments.set_file.clone()).chain(meshes);
    Ok(Report {
        header: Header::new(seed, inputs)?,
        origin: "simulated",
        coefficient: test_of(arguments.test).coefficient(),
        put_in: Some(put_in),
        slid,
        warnings,
        summary: summarise(values(&result, &shown))?,
    })
}

/// The bench test of the arguments as an apparatus.
fn apparatus(
    arguments: &Arguments,
    plate: &str,
    seed: String,
    repeats: usize,
) -> anyhow::Result<Apparatus> {
    let (plate, seed) = (plate.to_owned(), Some(seed));
    Ok(match arguments.test {
        Kind::Drop => Apparatus::Drop(Drop {
            plate,
            seed,
            repeats,
            height: Length::from_si(1e-3 * arguments.height_mm.unwrap_or(HEIGHT_MM))
                .context("--height-mm")?,
            plate_give: 0.0,
        }),
        Kind::Slider => Apparatus::Slider(Slider {
            plate,
            seed,
            repeats,
        }),
        Kind::Tilt => Apparatus::Tilt(Tilt {
            plate,
            seed,
            repeats,
        }),
    })
}

/// Values of an observable; `None` if the run does not give it.
fn values<'a>(result: &'a RunResult, name: &str) -> &'a [f64] {
    let mut observables = result.observables.iter();
    observables
        .find(|f| f.name == name)
        .map_or(&[], |f| f.values.as_slice())
}
