//! Measures what a step of the solver and a call of the instruments costs, and other solvers on the same scenes.

mod against;
mod arguments;
mod contacts;
mod deck;
mod instruments;
mod measure;
mod peers;
mod scaling;
mod scenes;
mod seed_drum;
mod sphere_drum;
mod table;

use anyhow::Context as _;
use arguments::Arguments;
use command_line::{DONE, Header};
use measure::Row;
use scenes::BenchmarkScene;
use serde::{Deserialize, Serialize};
use std::process::{Command, ExitCode, Stdio};

/// Everything that `--json` tells.
#[derive(Debug, Serialize, Deserialize)]
struct Summary<R> {
    #[serde(flatten)]
    header: Header,
    /// One row for each scene, or for each scene and code.
    rows: Vec<R>,
}

fn main() -> ExitCode {
    let arguments: Arguments = command_line::parse();
    command_line::finish(run(&arguments))
}

/// Measures what was asked for, prints the table.
fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let header = Header::new(arguments.seed, [&arguments.drum])?;
    let subjects = arguments.subjects();
    if let Some(other) = &arguments.against {
        let rows = against::compare(arguments, other, &subjects)?;
        arguments.common.print(against::table(&rows))?;
        arguments.common.emit_json(&Summary { header, rows })?;
        return Ok(DONE);
    }
    if let (true, [subject]) = (arguments.on_demand, subjects.as_slice()) {
        against::serve(arguments, *subject)?;
        return Ok(DONE);
    }
    let instruments = arguments.instruments()?;
    if !instruments.is_empty() {
        let rows = instruments
            .into_iter()
            .map(|instrument| instruments::measure(arguments, instrument));
        let rows = rows.collect::<anyhow::Result<Vec<_>>>()?;
        arguments.common.print(instruments::table(&rows))?;
        arguments.common.emit_json(&Summary { header, rows })?;
        return Ok(DONE);
    }
    let scenes = arguments.scenes();
    if arguments.scaling {
        let rows = scaling::compare(arguments, &scenes)?;
        arguments.common.print(scaling::table(&rows))?;
        arguments.common.emit_json(&Summary { header, rows })?;
        return Ok(DONE);
    }
    let rows = match scenes.as_slice() {
        _ if arguments.peers => peers::compare(arguments, &scenes)?,
        [scene] => vec![measured(arguments, *scene)?],
        // A process of its own for each scene: its peak memory is that of this scene alone.
        _ => scenes
            .iter()
            .map(|scene| in_own_process(arguments, *scene))
            .collect::<anyhow::Result<_>>()?,
    };
    arguments.common.print(if arguments.peers {
        table::of_peers(&rows, arguments.ranks > 1)
    } else {
        table::of_scenes(&rows) + &table::of_phases(&rows)
    })?;
    arguments.common.emit_json(&Summary { header, rows })?;
    Ok(DONE)
}

/// Measures a scene in this process.
fn measured(arguments: &Arguments, scene: BenchmarkScene) -> anyhow::Result<Row> {
    arguments.common.log(|| format!("measuring {scene}"));
    match scene {
        BenchmarkScene::Seeds(count) => seed_drum::measure(arguments, count),
        BenchmarkScene::Spheres(count) => sphere_drum::measure(arguments, count),
    }
}

/// Measures a scene in a process of its own.
fn in_own_process(arguments: &Arguments, scene: BenchmarkScene) -> anyhow::Result<Row> {
    let program = std::env::current_exe().context("cannot find this program")?;
    let mut command = Command::new(program);
    command
        .arg(scene.to_string())
        .args(["--seed", &arguments.seed.to_string()])
        .args(["--blocks", &arguments.blocks.to_string()])
        .arg("--drum")
        .arg(&arguments.drum)
        .arg("--json=-")
        .stderr(Stdio::inherit());
    if arguments.phases {
        command.arg("--phases");
    }
    if arguments.unsorted {
        command.arg("--unsorted");
    }
    if arguments.common.quiet {
        command.arg("--quiet");
    }
    let output = command.output().context("cannot start this program")?;
    anyhow::ensure!(
        output.status.success(),
        "the measurement of {scene} ended with {}",
        output.status
    );
    let summary: Summary<Row> = serde_json::from_slice(&output.stdout)
        .with_context(|| format!("the measurement of {scene} gave no result"))?;
    let mut rows = summary.rows;
    rows.pop()
        .with_context(|| format!("the measurement of {scene} gave no row"))
}
