//! `seedloop run DESIGN.csv --scene SCENE.toml`: a design table as a campaign.

use crate::calibrate::{progress_lines, refuse_used_folder};
use crate::enter::{enter, require_memory, work_of};
use crate::run_flags::{Retries, Wait, finished};
use crate::simulate::{all_written, log_warnings};
use crate::stop::Stop;
use anyhow::Context as _;
use campaign::run_store::{Observation, Record, Store};
use campaign::{Campaign, time_in_words};
use command_line::table_file;
use command_line::{Common, DONE, Header, NOT_MET, Overwrite, try_folder, write_new};
use report::Tone;
use serde::Serialize;
use simulators::scene_simulator::no_surface_of;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use study::{DesignChoices, DesignPlan, DesignRun, DesignTable};
use study_report::{RunningCampaign, RunningPage};

/// Runs every row of a design table and writes the results beside it, ready for `seedloop analyse`
#[derive(clap::Args, Debug)]
#[command(
    after_help = "Example:\n  seedloop run design.xlsx --scene drum.toml --bind B=contact.seed-steel.static_friction --plan"
)]
pub(crate) struct Arguments {
    /// Table of the runs, as `seedloop design` writes it. A column named by a setting sets it
    /// (rpm, contact.seed-seed.static_friction, `apparatus.speed [rpm]`); `replicates` and
    /// `seed` say how often a row is run and with which first seed. An Excel workbook gives results.xlsx beside
    /// results.csv
    #[arg(value_name = "DESIGN.csv")]
    design: PathBuf,

    /// Scene that is run
    #[arg(long, value_name = "SCENE.toml")]
    scene: PathBuf,

    /// Settings of a column, B=contact.seed-seed.static_friction or `W=apparatus.speed [rpm]`; several
    /// after commas. The column `B_natural` is used if there is one. May be given several times
    #[arg(long, value_name = "COLUMN=PATHS")]
    bind: Vec<String>,

    /// Table of the factors, symbol,name,unit,low,high: needed where a column holds coded values alone, or for units
    #[arg(long, value_name = "FACTORS.csv")]
    factors: Option<PathBuf>,

    /// Columns that set nothing, such as the dummies of a screening design
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    keep: Vec<String>,

    /// Changes a setting of the scene in all runs, as for `simulate`
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,

    /// Sets the calibrated values of a parameter file in all runs, as for `simulate`; --set and columns come after it
    #[arg(long, value_name = "PARAMETERS.toml")]
    set_file: Option<PathBuf>,

    /// Runs of each row, where the table has no column `replicates` [default: 1]
    #[arg(long, value_name = "N")]
    replicates: Option<usize>,

    /// Seed of the first run; the others take those that follow, row by row. A column `seed` comes before it
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Folder of the results [default: out/ and the name of the table]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Checks everything, says how many runs there are and what they cost, and runs nothing
    #[arg(long)]
    plan: bool,

    /// Continues in a folder that exists: finished runs are reused, the table of results is renewed
    #[arg(long)]
    resume: bool,

    #[command(flatten)]
    retries: Retries,

    #[command(flatten)]
    wait: Wait,

    #[command(flatten)]
    common: Common,
}

/// All runs as they stand in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// The table of results.
    results: String,
    /// Number of runs.
    n_runs: usize,
    /// Number of runs without a result.
    n_failed: usize,
    /// Number of runs whose surface no frame shows: they have no angle.
    n_refused: usize,
    /// What the user should know of the values of the parameter file.
    warnings: Vec<String>,
    /// The runs, in the order of the design.
    runs: Vec<RunReport>,
}

/// A run in JSON.
#[derive(Debug, Serialize)]
struct RunReport {
    /// Line of its row in the design.
    line: usize,
    /// Which run of its row it is, from 1.
    repeat: usize,
    seed: u64,
    /// Name of its scene.
    model: String,
    /// Values of its parameters, each in the unit of its column.
    parameters: BTreeMap<String, f64>,
    /// Its regime; `None` for a run without result, or if there are no such classes.
    regime: Option<String>,
    /// Its results by name.
    observables: BTreeMap<String, Observation>,
    /// Key of its record; `None` if there is none.
    record: Option<String>,
    /// Why it has no result, or no angle; `None` if it has.
    problem: Option<String>,
}

/// Runs the table and writes its results.
///
/// # Errors
/// Files that cannot be read or written, an invalid table.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    common.try_outputs([])?;
    try_folder(&folder(arguments))?;
    let table = DesignTable::read(&choices(arguments))?;
    log_warnings(&table.warnings, common);
    let simulator = table.simulator()?.with_retries(arguments.retries.number);
    let folder = folder(arguments);
    let header = Header::new(arguments.seed, table.input_files())?;
    let runs = folder.join("runs");
    // Planning makes no folder.
    let known = runs.is_dir().then(|| Store::open(&runs)).transpose()?;
    table.check_builds(&simulator, known.as_ref())?;
    let plan = table.plan(&simulator, known.as_ref())?;
    let told = plan_text(&plan, common.threads());
    if arguments.plan {
        common.print(told)?;
        common.emit_json(&with_header(&header, &table.warnings, &plan)?)?;
        return Ok(DONE);
    }
    refuse_used_folder(&folder, arguments.resume, common)?;
    require_memory(table.scenes(), common.threads())?;
    let work = work_of(
        "run",
        &header.inputs,
        &(&arguments.set, &arguments.bind, arguments.seed),
    );
    let _owner = enter(&folder, &work, common)?;
    common.log(|| told);
    let store = Store::open(&runs)?;
    let (lines, stop) = (progress_lines(common), Stop::of_runs(&folder)?);
    let name = arguments.design.file_stem().unwrap_or_default();
    let campaign = RunningCampaign {
        title: format!("Runs of {}", name.to_string_lossy()),
        ..RunningCampaign::default()
    };
    let page = RunningPage::begin(&folder, campaign, &lines);
    let simulator = simulator.with_stop(stop.flag());
    let campaign = Campaign::new(&store, common.threads(), &page)
        .with_stop(stop.flag())
        .with_wait(arguments.wait.limit());
    let outcomes = match finished(&stop, table.run(&campaign, &simulator))? {
        Ok(outcomes) => outcomes,
        Err(code) => return Ok(code),
    };
    let file = folder.join("results.csv");
    let where_to = format!("The results are in {}.", file.display());
    let code = write_outcomes(arguments, &table, header, &outcomes, &file);
    page.finish(Tone::Note, "Finished", &where_to);
    code
}

/// Writes the results and reports them; gives the exit code.
fn write_outcomes(
    arguments: &Arguments,
    table: &DesignTable,
    header: Header,
    outcomes: &[Result<Record, String>],
    file: &Path,
) -> anyhow::Result<u8> {
    let common = &arguments.common;
    let [table_written, workbook_written] =
        write_results(file, &table.results_csv(outcomes), &arguments.design);
    let [failed, refused] = tell_failures(table.runs(), outcomes)?;
    let file = file.display().to_string();
    let each = table.runs().iter().zip(outcomes);
    // The runs are done: what cannot be written takes nothing else with it.
    all_written([
        table_written,
        workbook_written,
        common.print(format!(
            "{} runs, {failed} without a result, {refused} without a surface: {file}",
            outcomes.len()
        )),
        common.emit_json(&Report {
            header,
            results: file,
            n_runs: outcomes.len(),
            n_failed: failed,
            n_refused: refused,
            warnings: table.warnings.clone(),
            runs: each.map(|(run, outcome)| report(run, outcome)).collect(),
        }),
    ])?;
    Ok(if failed + refused == 0 { DONE } else { NOT_MET })
}

/// Writes the table of results, as a workbook too if the design is one. The folder was asked for: its files may be renewed.
fn write_results(file: &Path, text: &str, design: &Path) -> [anyhow::Result<()>; 2] {
    let workbook = || {
        if !table_file::is_workbook_name(&table_file::file_of(design)) {
            return Ok(());
        }
        let file = file.with_extension("xlsx");
        let bytes = table_file::bytes_for(&file, text)?;
        write_new(&file, &bytes, Overwrite::Allow)
    };
    [
        write_new(file, text.as_bytes(), Overwrite::Allow),
        workbook(),
    ]
}

/// What the runs follow from.
fn choices(arguments: &Arguments) -> DesignChoices {
    DesignChoices {
        design: arguments.design.clone(),
        scene: arguments.scene.clone(),
        factors: arguments.factors.clone(),
        bind: arguments.bind.clone(),
        set_file: arguments.set_file.clone(),
        set: arguments.set.clone(),
        keep: arguments.keep.clone(),
        replicates: arguments.replicates,
        seed: arguments.seed,
    }
}

/// The folder of the results.
fn folder(arguments: &Arguments) -> PathBuf {
    let own = || {
        let file = table_file::file_of(&arguments.design);
        PathBuf::from("out").join(file.file_stem().unwrap_or_default())
    };
    arguments.out.clone().unwrap_or_else(own)
}

/// What would be run, in words.
fn plan_text(plan: &DesignPlan, threads: usize) -> String {
    let wall = time_in_words(plan.core_s / threads.max(1) as f64);
    let guess = if plan.measured {
        ""
    } else {
        " (a guess until the first runs are done)"
    };
    format!(
        "{} runs of {} rows, {} of them done; the others take {} of one core, about {wall} on {threads}{guess}",
        plan.runs,
        plan.rows,
        plan.kept,
        time_in_words(plan.core_s)
    )
}

/// A plan with version, seed and inputs, and what the user should know of the values of the parameter file.
fn with_header(
    header: &Header,
    warnings: &[String],
    plan: &DesignPlan,
) -> anyhow::Result<serde_json::Value> {
    let (mut value, plan) = (serde_json::to_value(header)?, serde_json::to_value(plan)?);
    if let (Some(value), serde_json::Value::Object(plan)) = (value.as_object_mut(), plan) {
        value.extend(plan);
        value.insert("warnings".to_owned(), warnings.into());
    }
    Ok(value)
}

/// Tells every run without a result or without a surface, also when the log is quiet, and counts both.
fn tell_failures(
    runs: &[DesignRun],
    outcomes: &[Result<Record, String>],
) -> anyhow::Result<[usize; 2]> {
    let mut counts = [0, 0];
    for (run, outcome) in runs.iter().zip(outcomes) {
        let (kind, what, why) = match outcome {
            Err(why) => (0, "no result", why.clone()),
            Ok(record) => match no_surface_of(record) {
                Some(why) => (1, "no angle", why),
                None => continue,
            },
        };
        counts[kind] += 1;
        let (line, seed) = (run.line, run.request.seed);
        writeln!(std::io::stderr(), "{what}: line {line}, seed {seed}: {why}")
            .context("cannot write to standard error")?;
    }
    Ok(counts)
}

/// A run in JSON.
fn report(run: &DesignRun, outcome: &Result<Record, String>) -> RunReport {
    let record = outcome.as_ref().ok();
    let observables = record.map(|record| record.observables().clone());
    RunReport {
        line: run.line,
        repeat: run.repeat,
        seed: run.request.seed,
        model: run.request.model.clone(),
        parameters: run.request.parameters.clone(),
        regime: record.and_then(Record::regime).map(str::to_owned),
        observables: observables.unwrap_or_default(),
        record: record.map(|record| record.key().to_owned()),
        problem: outcome
            .as_ref()
            .map_or_else(|why| Some(why.clone()), no_surface_of),
    }
}
