//! Fills a closed mesh with spheres.

mod arguments;
mod connections;
mod cost;
mod moments;
mod outputs;
mod page;
mod preview;
mod shapes;
mod slices;
mod sphere_doubt;
mod sphere_file;
mod summary;
mod target;
mod union_file;

use anyhow::Context as _;
use arguments::{Arguments, MethodName, length_in_metres};
use command_line::{DONE, Header, NOT_MET, significant};
use geometry::clump::files::read_spheres;
use geometry::clump::{DENSITIES, Sphere};
use sphere_fill::{Connectivity, Error, FillSettings, fill, measure};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use summary::{Measured, Refusal, Summary};
use target::target_of;
use trimesh::{Changes, CheckedMesh, LengthUnit, MeshReport};
use union_file::UnionFile;

fn main() -> ExitCode {
    let arguments: Arguments = command_line::parse();
    command_line::finish(run(&arguments))
}

/// Fills one mesh, or gives the shapes of several.
fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    match (&arguments.shapes, arguments.mesh.as_slice()) {
        (Some(file), _) => shapes::run(arguments, file),
        (None, [mesh]) => fill_one(arguments, mesh),
        (None, meshes) => anyhow::bail!(
            "{} meshes are given: fill them one by one, or ask for a table of all with --shapes FILE.csv",
            meshes.len()
        ),
    }
}

/// Reads, fills, writes.
fn fill_one(arguments: &Arguments, mesh: &Path) -> anyhow::Result<u8> {
    let common = &arguments.common;
    let task = task_of(arguments)?;
    let bond_gap = connections::bond_gap(arguments, task.smallest_radius())?;
    union_file::cell_of(arguments)?;
    arguments.repair()?;
    outputs::try_all(arguments)?;
    let start = Instant::now();
    let read = read_body(arguments, mesh)?;
    check_density(arguments, read.report.volume).with_context(|| mesh.display().to_string())?;
    let bodies = inputs(arguments, mesh)?;
    let inputs = bodies.iter().chain(&arguments.spheres);
    let header = Header::new(arguments.seed, inputs)?;
    common.log(|| {
        let what = match &task {
            Task::Fill(settings) => {
                format!("sphere radius {} mm", significant(settings.radius * 1e3, 6))
            }
            Task::Measure(spheres) => format!("{} spheres given", spheres.len()),
        };
        format!("mesh read in {}; {what}", arguments.unit)
    });
    for warning in &read.report.warnings {
        common.log(|| format!("warning: {}: {warning}", mesh.display()));
    }
    let doubt = match &task {
        Task::Fill(_) => None,
        Task::Measure(spheres) => {
            sphere_doubt::doubt(spheres, &read.report.bounding_box, arguments)
        }
    };
    let filled = match task {
        Task::Fill(settings) => fill(&read.mesh, &settings),
        Task::Measure(spheres) => measure(&read.mesh, spheres),
    };
    let filling = match filled {
        Ok(filling) => filling,
        Err(error) if is_refusal(&error) => {
            return refused(header, explained(&error, arguments), read.report, arguments);
        }
        Err(error) => anyhow::bail!(explained(&error, arguments)),
    };
    let elapsed_s = start.elapsed().as_secs_f64();
    let connectivity = Connectivity::new(&filling.spheres, bond_gap);
    let measured = Measured {
        mesh: &read.report,
        shape: &read.mesh.shape()?,
        filling: &filling,
        connectivity: &connectivity,
        doubt,
    };
    let mut failures = outputs::Failures::default();
    let surface = failures.of(arguments.union.as_ref(), || {
        UnionFile::new(arguments, &filling)
    });
    let summary = Summary::new(header, arguments, &measured, elapsed_s).with(surface.flatten());
    for warning in summary.warnings() {
        common.log(|| format!("warning: {warning}"));
    }
    outputs::write(arguments, &read.mesh, &measured, summary, failures)?;
    Ok(DONE)
}

/// Reports why a body is not filled.
fn refused(
    header: Header,
    reason: String,
    mesh: MeshReport,
    arguments: &Arguments,
) -> anyhow::Result<u8> {
    // A refusal states its reason even when the log is quiet.
    writeln!(std::io::stderr(), "refused: {reason}")?;
    arguments.common.emit_json(&Refusal {
        header,
        verdict: "refused",
        reason,
        mesh_warnings: mesh.warnings,
    })?;
    Ok(NOT_MET)
}

/// The reason why a body is not filled, with what the flags add to it.
fn explained(error: &Error, arguments: &Arguments) -> String {
    let unit = arguments.unit;
    let by_length = matches!(
        error,
        Error::RadiusTooLarge { .. } | Error::TooManySpheres { .. }
    );
    if !by_length {
        return error.to_string();
    }
    if slices::is_stack(arguments) {
        return format!("{error} (--voxel); a bare --radius is in {unit}");
    }
    format!(
        "{error} (--unit, now {unit}); a bare --radius is in that unit, another may be written behind it (--radius 0.45mm)"
    )
}

/// The files that a body is read from.
fn inputs(arguments: &Arguments, body: &Path) -> anyhow::Result<Vec<PathBuf>> {
    if slices::is_stack(arguments) {
        slices::files(body)
    } else {
        Ok(vec![body.to_owned()])
    }
}

/// Reads the mesh; of several bodies the largest, if that is asked for.
fn read_body(arguments: &Arguments, file: &Path) -> anyhow::Result<CheckedMesh> {
    let repair = arguments.repair()?;
    let mut read = if slices::is_stack(arguments) {
        let (read, threshold) = slices::read(arguments, file, &repair)?;
        arguments
            .common
            .log(|| format!("bright is what lies above the grey level {threshold:.1}"));
        read
    } else {
        anyhow::ensure!(
            !file.is_dir(),
            "{} is a folder; a stack of slices needs the edge length of a voxel, --voxel LENGTH",
            file.display()
        );
        trimesh::read_mesh_with(file, arguments.unit, &repair)?
    };
    if arguments.largest_body && read.mesh.topology().shells > 1 {
        let body = read.mesh.largest_body()?;
        read.mesh = body.mesh;
        // What was repaired on reading stays told; the figures are those of the body.
        read.report = MeshReport {
            warnings: read.report.warnings,
            degenerate_dropped: read.report.degenerate_dropped,
            duplicates_dropped: read.report.duplicates_dropped,
            triangles_turned: read.report.triangles_turned,
            holes_closed: read.report.holes_closed,
            // The lids no longer end the list of triangles.
            changes: Changes {
                lid_triangles: 0,
                ..read.report.changes
            },
            unit: read.report.unit,
            ..body.report
        };
    }
    Ok(read)
}

/// What is to be done.
enum Task {
    Fill(FillSettings),
    Measure(Vec<Sphere>),
}

impl Task {
    /// Radius of the smallest sphere given, or of the smallest allowed, m.
    fn smallest_radius(&self) -> f64 {
        match self {
            Self::Fill(settings) => settings.radius,
            Self::Measure(spheres) => spheres
                .iter()
                .map(|s| s.radius)
                .fold(f64::INFINITY, f64::min),
        }
    }
}

/// Reads a table of spheres in a unit.
///
/// # Errors
///
/// A file that cannot be read, a line that is not a sphere.
fn read_table(file: &Path, unit: LengthUnit) -> anyhow::Result<Vec<Sphere>> {
    let name = file.display().to_string();
    let text = input::file::read_text(file).with_context(|| format!("cannot read {name}"))?;
    Ok(read_spheres(&text, &name, unit.in_metres())?)
}

/// What the arguments ask for.
fn task_of(arguments: &Arguments) -> anyhow::Result<Task> {
    for (flag, value) in [("mass", arguments.mass), ("density", arguments.density)] {
        let given = value.unwrap_or(1.0);
        anyhow::ensure!(
            given.is_finite() && given > 0.0,
            "--{flag} {given}: it must be a positive number"
        );
    }
    match (&arguments.spheres, &arguments.radius) {
        (Some(file), _) => Ok(Task::Measure(read_table(
            file,
            arguments.spheres_unit.unwrap_or(arguments.unit),
        )?)),
        (None, Some(radius)) => Ok(Task::Fill(settings_of(arguments, radius)?)),
        (None, None) => anyhow::bail!("--radius is needed"),
    }
}

/// Refuses a mass or a density that no seed of a volume (m³) has.
fn check_density(arguments: &Arguments, volume: Option<f64>) -> anyhow::Result<()> {
    let Some((volume, mass)) = volume.and_then(|v| Some((v, arguments.mass_of(v)?))) else {
        return Ok(());
    };
    let density = mass / volume;
    anyhow::ensure!(
        DENSITIES.contains(&density),
        "the density is {} kg/m3 (mass {} mg over volume {} mm3): it must be {} to {} kg/m3; --mass is in kg, --density in \
         kg/m3, and --unit says what one unit of the mesh is",
        significant(density, 4),
        significant(1e6 * mass, 4),
        significant(1e9 * volume, 4),
        DENSITIES.start(),
        DENSITIES.end()
    );
    Ok(())
}

fn settings_of(arguments: &Arguments, radius: &str) -> anyhow::Result<FillSettings> {
    let unit = arguments.unit;
    let roughness = arguments.roughness.as_deref();
    let roughness = roughness.map(|text| length_in_metres("roughness", text, unit));
    let takes_roughness = matches!(
        arguments.method,
        MethodName::Smooth | MethodName::Surface | MethodName::Ferellec
    );
    anyhow::ensure!(
        roughness.is_none() || takes_roughness,
        "--roughness is for --method smooth, surface and ferellec only"
    );
    let target = arguments.target.as_deref();
    let target = target.map(|text| target_of(text, unit));
    let settings = FillSettings {
        method: arguments.method.into(),
        count: arguments.count,
        max_spheres: arguments.max_spheres,
        target: target.transpose()?,
        roughness: roughness.transpose()?,
        seed: arguments.seed,
        effort: arguments.effort,
        ..FillSettings::new(length_in_metres("radius", radius, unit)?)
    };
    settings.check()?;
    Ok(settings)
}

/// Whether an error is an answer (exit 1) and not a fault of the input (exit 2).
fn is_refusal(error: &Error) -> bool {
    matches!(
        error,
        Error::RadiusTooLarge { .. }
            | Error::CountNotReached { .. }
            | Error::RoughnessNotReached { .. }
            | Error::TargetNotReached { .. }
    )
}
