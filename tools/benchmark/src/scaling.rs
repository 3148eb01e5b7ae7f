//! One thread against several, on the same steps.

use crate::arguments::Arguments;
use crate::scenes::BenchmarkScene;
use crate::{seed_drum, sphere_drum};
use dem_solver::World;
use probability::median;
use serde::Serialize;
use std::time::Instant;

/// Time of a step by the clock; each unit is in the name.
#[derive(Debug, Serialize)]
pub(crate) struct ScalingRow {
    scene: String,
    bodies: usize,
    threads: usize,
    block_steps: usize,
    /// Median over the blocks on one thread.
    us_per_step_on_one: f64,
    /// Median over the blocks on all threads.
    us_per_step_on_all: f64,
    /// Median over the pairs of blocks of the time on one thread over that on all.
    speed_up: f64,
}

/// Measures all scenes.
pub(crate) fn compare(
    arguments: &Arguments,
    scenes: &[BenchmarkScene],
) -> anyhow::Result<Vec<ScalingRow>> {
    let threads = arguments.common.threads();
    anyhow::ensure!(
        threads > 1,
        "--scaling compares with one thread: say --threads 2 or more"
    );
    let rows = scenes.iter().map(|scene| {
        arguments
            .common
            .log(|| format!("measuring {scene} on 1 and {threads} threads"));
        row(arguments, *scene, threads)
    });
    rows.collect()
}

/// Measures a scene.
fn row(arguments: &Arguments, scene: BenchmarkScene, threads: usize) -> anyhow::Result<ScalingRow> {
    let mut one = match scene {
        BenchmarkScene::Seeds(count) => seed_drum::start(arguments, count)?.world()?,
        BenchmarkScene::Spheres(count) => {
            sphere_drum::flowing(arguments, count)?.world(sphere_drum::TIME_STEP)?
        }
    };
    let mut all = one.clone().on_threads(threads)?;
    let steps = scene.block_steps();
    let mut times = Vec::new();
    for block in 0..=arguments.blocks {
        let pair = [timed(&mut one, steps)?, timed(&mut all, steps)?];
        // The first blocks warm up.
        times.extend((block > 0).then_some(pair));
    }
    // When lists are made again is no part of the result.
    let (a, b) = (one.bodies(), all.bodies());
    anyhow::ensure!(
        (&a.position, &a.velocity, &a.orientation) == (&b.position, &b.velocity, &b.orientation)
            && (&a.spin, &a.load) == (&b.spin, &b.load),
        "{scene}: the bodies are not the same on 1 and {threads} threads"
    );
    let of = |pick: fn(&[f64; 2]) -> f64| median(&times.iter().map(pick).collect::<Vec<_>>());
    Ok(ScalingRow {
        scene: scene.to_string(),
        bodies: one.bodies().len(),
        threads,
        block_steps: steps,
        us_per_step_on_one: of(|pair| pair[0]),
        us_per_step_on_all: of(|pair| pair[1]),
        speed_up: of(|pair| pair[0] / pair[1]),
    })
}

/// Runs a block; the time of a step by the clock, us.
fn timed(world: &mut World, steps: usize) -> anyhow::Result<f64> {
    let start = Instant::now();
    world.steps(steps as u64)?;
    Ok(start.elapsed().as_secs_f64() / steps as f64 * 1e6)
}

/// The rows as a Markdown table.
pub(crate) fn table(rows: &[ScalingRow]) -> String {
    let head = "| scene | bodies | threads | us per step on one | us per step on all | speed-up |\n\
        |---|---|---|---|---|---|";
    let lines = rows.iter().map(|row| {
        format!(
            "| {} | {} | {} | {:.1} | {:.1} | {:.2} |",
            row.scene,
            row.bodies,
            row.threads,
            row.us_per_step_on_one,
            row.us_per_step_on_all,
            row.speed_up
        )
    });
    let lines: Vec<_> = std::iter::once(head.to_owned()).chain(lines).collect();
    lines.join("\n")
}
