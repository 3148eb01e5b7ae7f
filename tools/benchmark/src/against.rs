//! This build against another one, block by block.

use crate::arguments::Arguments;
use crate::instruments::{self, Call, Subject};
use crate::measure::processor_seconds;
use crate::scenes::BenchmarkScene;
use crate::{seed_drum, sphere_drum};
use anyhow::Context as _;
use dem_solver::World;
use probability::median;
use serde::Serialize;
use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Steps of a block: so few that the machine is the same for both builds.
const BLOCK_STEPS: usize = 40;

/// Odd factor that spreads the bits of a number.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

/// Two builds on one scene or call; each unit is in the name.
#[derive(Debug, Serialize)]
pub(crate) struct AgainstRow {
    scene: String,
    /// Pairs of blocks.
    pairs: usize,
    /// Steps of a block, or calls.
    block_steps: usize,
    /// A step or a call, median over the blocks of this build.
    us_per_step_here: f64,
    /// The same of the other build.
    us_per_step_there: f64,
    /// Median over the pairs of the time here over the time there.
    ratio: f64,
    /// Lower and upper quartile of the same.
    ratio_quartiles: [f64; 2],
    /// Whether both give the same at the end, to the last bit.
    same_bits: bool,
}

/// Measures all.
pub(crate) fn compare(
    arguments: &Arguments,
    other: &Path,
    subjects: &[Subject],
) -> anyhow::Result<Vec<AgainstRow>> {
    let rows = subjects.iter().map(|subject| {
        arguments
            .common
            .log(|| format!("measuring {subject} against {}", other.display()));
        row(arguments, other, *subject)
    });
    rows.collect()
}

/// Measures one: after one block each to warm up, the builds take their blocks in turn, and take
/// turns in who is first. Each runs in a process of its own: beside the one that keeps the books, a child was four
/// percent faster.
fn row(arguments: &Arguments, other: &Path, subject: Subject) -> anyhow::Result<AgainstRow> {
    let program = std::env::current_exe().context("cannot find this program")?;
    let mut here = Build::start(arguments, &program, subject)?;
    let mut there = Build::start(arguments, other, subject)?;
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
        scene: subject.to_string(),
        pairs: pairs.len(),
        block_steps: match subject {
            Subject::Instrument(instrument) => instrument.block_calls(),
            Subject::Scene(_) => BLOCK_STEPS,
        },
        us_per_step_here: of(|pair| pair[0]),
        us_per_step_there: of(|pair| pair[1]),
        ratio: median(&ratios),
        ratio_quartiles: [ratios[ratios.len() / 4], ratios[3 * ratios.len() / 4]],
        same_bits,
    })
}

/// What a block repeats.
enum Work {
    /// A step of the flowing scene.
    Step(Box<World>),
    /// A call, how often a block makes it, and what the last one gave.
    Call(Call, usize, String),
}

impl Work {
    fn prepare(arguments: &Arguments, subject: Subject) -> anyhow::Result<Self> {
        Ok(match subject {
            Subject::Scene(BenchmarkScene::Seeds(count)) => {
                Self::Step(Box::new(seed_drum::flowing(arguments, count)?))
            }
            Subject::Scene(BenchmarkScene::Spheres(count)) => {
                let drum = sphere_drum::flowing(arguments, count)?;
                Self::Step(Box::new(drum.world(sphere_drum::TIME_STEP)?))
            }
            Subject::Instrument(instrument) => Self::Call(
                instruments::prepare(arguments, instrument)?,
                instrument.block_calls(),
                String::new(),
            ),
        })
    }

    /// Runs a block; the time of a step or a call on the processor, us.
    fn timed(&mut self) -> anyhow::Result<f64> {
        let start = processor_seconds()?;
        let times = match self {
            Self::Step(world) => {
                world.steps(BLOCK_STEPS as u64)?;
                BLOCK_STEPS as f64
            }
            Self::Call(call, calls, result) => {
                for _ in 0..*calls {
                    *result = call()?;
                }
                *calls as f64
            }
        };
        Ok((processor_seconds()? - start) / times * 1e6)
    }

    /// A text that two builds share only if their results are the same.
    fn fingerprint(&self) -> String {
        let mixed = match self {
            Self::Step(world) => fingerprint(world),
            Self::Call(_, _, result) => result.bytes().map(u64::from).fold(0, mixed),
        };
        format!("{mixed:016x}")
    }
}

/// A number that two worlds share only if their bodies stand and move alike.
fn fingerprint(world: &World) -> u64 {
    let bodies = world.bodies();
    let vectors = [&bodies.position, &bodies.velocity, &bodies.spin];
    let vectors = vectors.into_iter().flatten().flat_map(|v| v.iter());
    let turns = bodies.orientation.iter().flat_map(|q| q.coords.iter());
    vectors.chain(turns).map(|x| x.to_bits()).fold(0, mixed)
}

/// A further number taken up. An odd factor loses nothing; it spreads each bit over those above, the rotation brings them
/// down.
fn mixed(sum: u64, bits: u64) -> u64 {
    (sum ^ bits).wrapping_mul(SPREAD).rotate_left(29)
}

/// Serves --against: a block for each line on standard input, at its end the fingerprint.
pub(crate) fn serve(arguments: &Arguments, subject: Subject) -> anyhow::Result<()> {
    let mut work = Work::prepare(arguments, subject)?;
    let mut out = std::io::stdout();
    for line in std::io::stdin().lines() {
        line.context("cannot read standard input")?;
        writeln!(out, "{}", work.timed()?)?;
        out.flush()?;
    }
    writeln!(out, "{}", work.fingerprint())?;
    Ok(())
}

/// A build at work.
struct Build {
    process: Child,
    orders: ChildStdin,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Build {
    fn start(arguments: &Arguments, program: &Path, subject: Subject) -> anyhow::Result<Self> {
        let mut command = Command::new(program);
        command
            .arg(subject.to_string())
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
    let head = "| step or call of | pairs of blocks | us here | us there | here over there (quartiles) \
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
