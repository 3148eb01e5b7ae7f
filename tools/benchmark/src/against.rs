//! This build of the solver against another one, block by block.

use crate::arguments::Arguments;
use crate::measure::{median, processor_seconds};
use crate::scenes::BenchmarkScene;
use crate::{seed_drum, sphere_drum};
use anyhow::Context as _;
use dem_solver::World;
use serde::Serialize;
use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Steps of a block: so few that the machine is the same for both builds.
const BLOCK_STEPS: usize = 40;

/// Odd factor that spreads the bits of a number.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

/// Two builds on one scene; each unit is in the name.
#[derive(Debug, Serialize)]
pub(crate) struct AgainstRow {
    scene: String,
    /// Pairs of blocks.
    pairs: usize,
    block_steps: usize,
    /// Median over the blocks of this build.
    us_per_step_here: f64,
    /// Median over the blocks of the other build.
    us_per_step_there: f64,
    /// Median over the pairs of the time here over the time there.
    ratio: f64,
    /// Lower and upper quartile of the same.
    ratio_quartiles: [f64; 2],
    /// Whether both worlds are the same at the end, to the last bit.
    same_bits: bool,
}

/// Measures all scenes.
pub(crate) fn compare(
    arguments: &Arguments,
    other: &Path,
    scenes: &[BenchmarkScene],
) -> anyhow::Result<Vec<AgainstRow>> {
    let rows = scenes.iter().map(|scene| {
        arguments
            .common
            .log(|| format!("measuring {scene} against {}", other.display()));
        row(arguments, other, *scene)
    });
    rows.collect()
}

/// Measures a scene: after one block each to warm up, the builds take their blocks in turn, and take
/// turns in who is first. Each runs in a process of its own: beside the one that keeps the books, a child was four
/// percent faster.
fn row(arguments: &Arguments, other: &Path, scene: BenchmarkScene) -> anyhow::Result<AgainstRow> {
    let program = std::env::current_exe().context("cannot find this program")?;
    let mut here = Build::start(arguments, &program, scene)?;
    let mut there = Build::start(arguments, other, scene)?;
    let mut pairs = Vec::new();
    for block in 0..=arguments.blocks {
        let pair = if block % 2 == 0 {
            let first = here.timed()?;
            [first, there.timed()?]
        } else {
            let first = there.timed()?;
            [here.timed()?, first]
        };
        pairs.extend((block > 0).then_some(pair));
    }
    let same_bits = there.end()? == here.end()?;
    let of = |pick: fn(&[f64; 2]) -> f64| median(&pairs.iter().map(pick).collect::<Vec<_>>());
    let mut ratios: Vec<f64> = pairs.iter().map(|pair| pair[0] / pair[1]).collect();
    ratios.sort_by(f64::total_cmp);
    Ok(AgainstRow {
        scene: scene.to_string(),
        pairs: pairs.len(),
        block_steps: BLOCK_STEPS,
        us_per_step_here: of(|pair| pair[0]),
        us_per_step_there: of(|pair| pair[1]),
        ratio: median(&ratios),
        ratio_quartiles: [ratios[ratios.len() / 4], ratios[3 * ratios.len() / 4]],
        same_bits,
    })
}

/// The flowing scene.
fn world(arguments: &Arguments, scene: BenchmarkScene) -> anyhow::Result<World> {
    match scene {
        BenchmarkScene::Seeds(count) => seed_drum::flowing(arguments, count),
        BenchmarkScene::Spheres(count) => {
            sphere_drum::flowing(arguments, count)?.world(sphere_drum::TIME_STEP)
        }
    }
}

/// Runs a block; the time of a step on the processor, us.
fn timed(world: &mut World) -> anyhow::Result<f64> {
    let start = processor_seconds()?;
    for _ in 0..BLOCK_STEPS {
        world.step()?;
    }
    Ok((processor_seconds()? - start) / BLOCK_STEPS as f64 * 1e6)
}

/// A text that two worlds share only if their bodies stand and move alike.
fn fingerprint(world: &World) -> String {
    let bodies = world.bodies();
    let vectors = [&bodies.position, &bodies.velocity, &bodies.spin];
    let vectors = vectors.into_iter().flatten().flat_map(|v| v.iter());
    let turns = bodies.orientation.iter().flat_map(|q| q.coords.iter());
    let mixed = vectors.chain(turns).fold(0_u64, |sum, x| {
        // An odd factor loses nothing; it spreads each bit over those above, the rotation brings them down.
        (sum ^ x.to_bits()).wrapping_mul(SPREAD).rotate_left(29)
    });
    format!("{mixed:016x}")
}

/// Serves --against: a block for each line on standard input, at its end the fingerprint.
pub(crate) fn serve(arguments: &Arguments, scene: BenchmarkScene) -> anyhow::Result<()> {
    let mut world = world(arguments, scene)?;
    let mut out = std::io::stdout();
    for line in std::io::stdin().lines() {
        line.context("cannot read standard input")?;
        writeln!(out, "{}", timed(&mut world)?)?;
        out.flush()?;
    }
    writeln!(out, "{}", fingerprint(&world))?;
    Ok(())
}

/// A build at work.
struct Build {
    process: Child,
    orders: ChildStdin,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Build {
    /// Starts it on a scene.
    fn start(arguments: &Arguments, program: &Path, scene: BenchmarkScene) -> anyhow::Result<Self> {
        let mut command = Command::new(program);
        command
            .arg(scene.to_string())
            .arg("--on-demand")
            .args(["--seed", &arguments.seed.to_string()])
            .arg("--drum")
            .arg(&arguments.drum)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut process = command
            .spawn()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let orders = process.stdin.take().context("no way in")?;
        let answers = process.stdout.take().context("no way out")?;
        Ok(Self {
            process,
            orders,
            answers: BufReader::new(answers).lines(),
        })
    }

    /// Lets it run a block; the time of a step, us.
    fn timed(&mut self) -> anyhow::Result<f64> {
        let order = writeln!(self.orders).and_then(|()| self.orders.flush());
        order.context("a build has ended: it must know --on-demand")?;
        let answer = self.answer()?;
        answer
            .parse()
            .with_context(|| format!("a build says '{answer}' instead of a time"))
    }

    /// What it says next.
    fn answer(&mut self) -> anyhow::Result<String> {
        let line = self.answers.next();
        Ok(line.context("a build has ended: it must know --on-demand")??)
    }

    /// Ends it; its fingerprint.
    fn end(mut self) -> anyhow::Result<String> {
        drop(self.orders);
        let line = self.answers.next();
        self.process.wait()?;
        Ok(line.context("a build gave no end")??)
    }
}

/// The rows as a Markdown table.
pub(crate) fn table(rows: &[AgainstRow]) -> String {
    let head = "| scene | pairs of blocks | us per step here | us per step there | here over there (quartiles) \
        | same bits |\n|---|---|---|---|---|---|";
    let lines = rows.iter().map(|row| {
        format!(
            "| {} | {} | {:.1} | {:.1} | {:.3} ({:.3} to {:.3}) | {} |",
            row.scene,
            row.pairs,
            row.us_per_step_here,
            row.us_per_step_there,
            row.ratio,
            row.ratio_quartiles[0],
            row.ratio_quartiles[1],
            if row.same_bits { "yes" } else { "no" }
        )
    });
    let lines: Vec<_> = std::iter::once(head.to_owned()).chain(lines).collect();
    lines.join("\n")
}
