//! `seedloop passport`: parameters with their conventions and a self-test for other codes, and what the self-test says.

use ::passport::{Calibrated, Checked, Grain, Model, PASSPORT, Passport, Validity};
use anyhow::{Context as _, bail, ensure};
use command_line::{Common, DONE, Header, NOT_MET, try_folder, write_new};
use inference::diagnosis::Verdict;
use scene::{FillingLibrary, Scene};
use serde::Serialize;
use serde_json::Value;
use simulators::scene_simulator::ParameterFile;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Solid fraction of a bed, for the stress at its bottom.
const SOLID_FRACTION: f64 = 0.6;

/// Writes parameters with their conventions and a self-test for other codes; or checks what another code gave
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop passport out/cotton --scene drum.toml --out passport")]
pub(crate) struct Arguments {
    /// Folder of a calibration, its result.json, or a parameter file
    #[arg(
        value_name = "RESULT|PARAMETERS.toml",
        required_unless_present = "check",
        conflicts_with = "check"
    )]
    from: Option<PathBuf>,

    /// Scene with the conventions, materials and grains to which the parameters belong
    #[arg(long, value_name = "SCENE.toml", required_unless_present = "check")]
    scene: Option<PathBuf>,

    /// Material of the wall of the self-test [default: the first that has a contact with the grains]
    #[arg(long, value_name = "NAME")]
    wall: Option<String>,

    /// Folder for the passport
    #[arg(long, value_name = "DIR", required_unless_present = "check")]
    out: Option<PathBuf>,

    /// Says which convention another code reads in another way, from the results of the self-test; passport.json lies beside them
    #[arg(long, value_name = "RESULTS.csv")]
    check: Option<PathBuf>,

    /// With --check: a convention that belongs to the other code and counts as no difference, such as limit-moves-spring; may be given
    /// several times
    #[arg(long, value_name = "CONVENTION", requires = "check")]
    accept: Vec<String>,

    /// With --check: the code (lammps, liggghts, mercurydpm, yade); the conventions in which its source is known to differ, and that nothing converts,
    /// count as no difference
    #[arg(long, value_name = "NAME", requires = "check")]
    code: Option<String>,

    #[command(flatten)]
    common: Common,
}

/// The written files, for JSON.
#[derive(Debug, Serialize)]
struct Written {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Names of the files in the folder.
    files: Vec<&'static str>,
}

/// The answer of a check in JSON.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// Conventions that count as no difference.
    accepted: &'a [String],
    /// The answer.
    #[serde(flatten)]
    checked: &'a Checked,
}

/// Writes a passport, or checks results.
///
/// # Errors
/// Files that cannot be read or written, a model that the self-test does not cover, results that are wrong.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    arguments.common.try_outputs([])?;
    match (
        &arguments.check,
        &arguments.from,
        &arguments.scene,
        &arguments.out,
    ) {
        (Some(results), ..) => check(results, arguments, &arguments.common),
        (None, Some(from), Some(scene), Some(out)) => write(arguments, from, scene, out),
        _ => bail!("name a result, --scene and --out, or --check"),
    }
}

/// Writes the folder.
fn write(arguments: &Arguments, from: &Path, scene_file: &Path, out: &Path) -> anyhow::Result<u8> {
    let common = &arguments.common;
    try_folder(out)?;
    let source = Source::find(from)?;
    let read = crate::simulate::read_scene(scene_file, Some(&source.parameters), &[], common)?;
    let model = Model::of_scene(
        &read.scene,
        &FillingLibrary::default(),
        arguments.wall.as_deref(),
    )?;
    common.log(|| "computing the expected numbers".to_owned());
    let header = Header::new(1, source.inputs(scene_file))?;
    let calibrated = source.calibrated()?;
    let correlation = source.correlation(calibrated.len())?;
    let passport = Passport {
        version: header.version.clone(),
        covariance: correlation
            .as_ref()
            .map(|rows| ::passport::covariance(&calibrated, rows)),
        calibrated,
        correlation,
        validity: source.validity(&read.scene, &model)?,
        expected: ::passport::expected(&model)?,
        model,
    };
    let files = ::passport::files(&passport)?;
    for file in &files {
        let path = out.join(file.name);
        ensure!(
            common.force || !path.exists(),
            "{} exists: say --force to overwrite it, or give another folder",
            path.display()
        );
    }
    std::fs::create_dir_all(out)
        .with_context(|| format!("cannot make the folder {}", out.display()))?;
    for file in &files {
        write_new(
            &out.join(file.name),
            file.text.as_bytes(),
            common.overwrite(),
        )?;
        common.print(out.join(file.name).display())?;
    }
    common.emit_json(&Written {
        header,
        files: files.iter().map(|file| file.name).collect(),
    })?;
    Ok(DONE)
}

/// Where the values come from.
struct Source {
    /// The parameter file.
    parameters: PathBuf,
    /// The result of the calibration and its file.
    result: Option<(PathBuf, Value)>,
}

impl Source {
    /// The files of a folder, a result or a parameter file.
    fn find(from: &Path) -> anyhow::Result<Self> {
        let folder = match from {
            from if from.is_dir() => from,
            from if input::file::has_ending(from, &["json"]) => {
                from.parent().unwrap_or(Path::new("."))
            }
            from => {
                return Ok(Self {
                    parameters: from.to_owned(),
                    result: None,
                });
            }
        };
        let file = if from.is_dir() {
            folder.join("result.json")
        } else {
            from.to_owned()
        };
        let text = input::file::read_text(&file)
            .with_context(|| format!("cannot read the result {}", file.display()))?;
        let result = serde_json::from_str(&text)
            .with_context(|| format!("{} is not the result of a calibration", file.display()))?;
        Ok(Self {
            parameters: folder.join("parameters.toml"),
            result: Some((file, result)),
        })
    }

    fn inputs(&self, scene: &Path) -> Vec<PathBuf> {
        let result = self.result.iter().map(|(file, _)| file.clone());
        [scene.to_owned(), self.parameters.clone()]
            .into_iter()
            .chain(result)
            .collect()
    }

    fn calibrated(&self) -> anyhow::Result<Vec<Calibrated>> {
        let file = ParameterFile::read(&self.parameters)?;
        let row = |p: simulators::scene_simulator::CalibratedParameter| Calibrated {
            symbol: p.symbol,
            name: p.name,
            sets: p.sets,
            value: p.value,
            unit: p.unit.unwrap_or_else(|| "1".to_owned()),
            se: p.se,
            interval95: p.interval95,
        };
        Ok(file.parameter.into_iter().map(row).collect())
    }

    /// The correlation of so many values, if the result has one.
    fn correlation(&self, n: usize) -> anyhow::Result<Option<Vec<Vec<f64>>>> {
        let found = self
            .result
            .as_ref()
            .and_then(|(file, result)| Some((file, result.get("correlation")?)));
        let Some((file, found)) = found else {
            return Ok(None);
        };
        let rows: Vec<Vec<f64>> = serde_json::from_value(found.clone()).with_context(|| {
            format!(
                "{}: correlation is not a matrix; calibrate again",
                file.display()
            )
        })?;
        ensure!(
            rows.len() == n && rows.iter().all(|row| row.len() == n),
            "{}: correlation has not {n} rows and columns, as many as {} has parameters: both must be of one calibration",
            file.display(),
            self.parameters.display(),
        );
        Ok(Some(rows))
    }

    fn validity(&self, scene: &Scene, model: &Model) -> anyhow::Result<Validity> {
        let file = ParameterFile::read(&self.parameters)?;
        let apparatus = &scene.apparatus;
        let kind = serde_json::to_value(apparatus)?;
        let kind = kind
            .get("kind")
            .and_then(Value::as_str)
            .unwrap_or("apparatus");
        // A bench test holds no bed: one layer of grains.
        let depth = (2.0 * apparatus.radius()).max(2.0 * model.radius_m);
        let turning = apparatus.speed().abs() * apparatus.radius();
        let falling = (2.0 * model.gravity_m_s2 * depth).sqrt();
        Ok(Validity {
            met: file.met,
            verdict: file.verdict,
            measurements: self.measurements(),
            apparatus: kind.to_owned(),
            grains: grains(scene, &model.grain)?,
            regimes: self.regimes(),
            speed_m_s: if turning > 0.0 { turning } else { falling },
            stress_pa: SOLID_FRACTION * model.density_kg_m3 * model.gravity_m_s2 * depth,
        })
    }

    /// Regimes of the runs at the estimate.
    fn regimes(&self) -> Vec<String> {
        let rows = self
            .result
            .iter()
            .filter_map(|(_, result)| result.get("fit")?.as_array());
        let names = rows
            .flatten()
            .filter_map(|row| row.get("regimes")?.as_object())
            .flat_map(|regimes| regimes.keys().cloned());
        names.collect::<BTreeSet<String>>().into_iter().collect()
    }

    /// The measurements of fit and check, a line each.
    fn measurements(&self) -> Vec<String> {
        let Some((_, result)) = &self.result else {
            return Vec::new();
        };
        let text = |row: &Value, key: &str| {
            row.get(key)
                .and_then(Value::as_str)
                .unwrap_or("?")
                .to_owned()
        };
        let line = |row: &Value| {
            let list = |key: &str| {
                let map = row.get(key).and_then(Value::as_object);
                let entries = map
                    .into_iter()
                    .flatten()
                    .map(|(name, value)| format!("{name} {value}"));
                entries.collect::<Vec<_>>().join(", ")
            };
            let (condition, regimes) = (list("condition"), list("regimes"));
            let holds = row.get("holds").and_then(Value::as_bool) == Some(true);
            format!(
                "{} of {}{}: {}, {}{}",
                text(row, "observable"),
                text(row, "scene"),
                if condition.is_empty() {
                    String::new()
                } else {
                    format!(" at {condition}")
                },
                text(row, "role"),
                if holds { "met" } else { "not met" },
                if regimes.is_empty() {
                    String::new()
                } else {
                    format!("; runs by regime: {regimes}")
                },
            )
        };
        let rows = ["fit", "check"]
            .into_iter()
            .filter_map(|key| result.get(key)?.as_array());
        rows.flatten().map(line).collect()
    }
}

/// The grains of a material.
fn grains(scene: &Scene, material: &str) -> anyhow::Result<Vec<Grain>> {
    let library = FillingLibrary::default();
    let of_material = scene.seed.iter().filter(|seed| seed.material == material);
    let grain = |seed: &scene::SeedSettings| {
        let body = library.body(scene, seed)?;
        Ok(Grain {
            name: seed.name.clone(),
            diameter_m: 2.0 * body.volume_radius(),
            spheres: body.clump.spheres().len(),
        })
    };
    of_material.map(grain).collect()
}

/// Checks the results of another code.
fn check(results: &Path, arguments: &Arguments, common: &Common) -> anyhow::Result<u8> {
    let code = arguments.code.as_deref();
    let code = code.map(::passport::known_of).transpose()?;
    let known = code.map_or(&[][..], |code| code.known);
    let known_names = known.iter().map(|known| known.convention.to_owned());
    let accepted: Vec<String> = known_names
        .chain(arguments.accept.iter().cloned())
        .collect();
    let folder = results.parent().unwrap_or(Path::new("."));
    let file = folder.join(PASSPORT);
    let text = input::file::read_text(&file)
        .with_context(|| format!("cannot read {}: put the results beside it", file.display()))?;
    let passport = ::passport::read_passport(&text).with_context(|| file.display().to_string())?;
    let text = input::file::read_text(results)
        .with_context(|| format!("cannot read {}", results.display()))?;
    let got = ::passport::read_results(&text, &results.display().to_string(), &passport.expected)?;
    let checked = ::passport::check(&passport.model, &passport.expected, &got, &accepted)?;
    for row in &checked.rows {
        common.print(format!(
            "{:<14} {:<22} expected {:>13.6e} +- {:.1e}  got {:>13.6e} {:<5}  {:>8.1} bands",
            row.expected.case,
            row.expected.quantity,
            row.expected.value,
            row.expected.band,
            row.got,
            row.expected.unit,
            row.z
        ))?;
    }
    if let Some(code) = code {
        common.print(format!("{} is known to differ in:", code.law))?;
    }
    for known in known {
        common.print(format!("- {} ({})", known.convention, known.source))?;
    }
    common.print(verdict(&checked))?;
    for difference in &checked.differences {
        common.print(format!(
            "- {}: {}",
            difference.convention, difference.advice
        ))?;
    }
    if !checked.not_shown.is_empty() {
        common.print(format!(
            "These numbers cannot show: {}.",
            checked.not_shown.join(", ")
        ))?;
    }
    common.emit_json(&Report {
        header: Header::new(1, [results.to_owned(), file])?,
        accepted: &accepted,
        checked: &checked,
    })?;
    Ok(if checked.agrees { DONE } else { NOT_MET })
}

/// The verdict in a sentence.
fn verdict(checked: &Checked) -> &'static str {
    match checked.verdict {
        Verdict::None if checked.agrees => "The other code reads the parameters as they are meant.",
        Verdict::None => {
            "The small cases agree, and bed or heap does not: something else differs, such as the walls, the start or the contacts of many grains."
        }
        Verdict::Named if checked.differences.len() > 1 => "These conventions differ together:",
        Verdict::Named => "This convention differs:",
        Verdict::Tie => "One of these conventions differs, and the numbers do not decide which:",
        _ => "Something else differs; the nearest of the known conventions does not explain it:",
    }
}
