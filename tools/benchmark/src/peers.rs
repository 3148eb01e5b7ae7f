//! LIGGGHTS and LAMMPS on the same drum, in turn with this solver.

use crate::arguments::Arguments;
use crate::deck::{self, Code, Plan};
use crate::measure::{Row, measure_world};
use crate::scenes::BenchmarkScene;
use crate::seed_drum::{self, SeedDrum};
use crate::sphere_drum::{self, SphereDrum};
use anyhow::Context as _;
use dem_solver::World;
use simulators::exchange::vtk::File;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Steps of a block of the peers in a drum of seeds: ten to fifty seconds.
const SEED_BLOCK_STEPS: usize = 500;

/// A code to compare with and its program.
#[derive(Debug, Clone)]
struct Peer {
    code: Code,
    program: PathBuf,
}

/// The drum that all codes run, from one start.
enum Drum {
    /// Plain spheres; all codes take one step.
    Spheres(SphereDrum),
    /// Seeds; each code takes its own step.
    Seeds(Box<SeedDrum>),
}

impl Drum {
    fn flowing(arguments: &Arguments, scene: BenchmarkScene) -> anyhow::Result<Self> {
        Ok(match scene {
            BenchmarkScene::Spheres(count) => {
                Self::Spheres(sphere_drum::flowing(arguments, count)?)
            }
            BenchmarkScene::Seeds(count) => {
                Self::Seeds(Box::new(seed_drum::start(arguments, count)?))
            }
        })
    }

    /// The solver's world.
    fn world(&self) -> anyhow::Result<World> {
        match self {
            Self::Spheres(drum) => drum.world(sphere_drum::TIME_STEP),
            Self::Seeds(drum) => drum.world(),
        }
    }

    /// Number of spheres, those inside seeds included.
    fn spheres(&self) -> usize {
        match self {
            Self::Spheres(drum) => drum.placements.len(),
            Self::Seeds(drum) => drum.spheres,
        }
    }

    /// What the peers run.
    fn plan(&self, arguments: &Arguments, scene: BenchmarkScene) -> Plan {
        let (block_steps, time_step) = match self {
            Self::Spheres(_) => (scene.block_steps(), sphere_drum::TIME_STEP),
            Self::Seeds(_) => (SEED_BLOCK_STEPS, arguments.peer_step_us * 1e-6),
        };
        Plan {
            block_steps,
            blocks: arguments.blocks,
            time_step,
            skin: arguments.peer_skin_mm * 1e-3,
            ranks: arguments.ranks,
        }
    }

    /// The input of a peer.
    fn files(&self, code: Code, plan: &Plan) -> anyhow::Result<Vec<File>> {
        Ok(match self {
            Self::Spheres(drum) => deck::of_spheres(drum, code, plan),
            Self::Seeds(drum) => deck::of_seeds(drum, code, plan)?,
        })
    }
}

/// Measures this solver and the peers on each scene; rows of one scene follow each other, this
/// solver first.
pub(crate) fn compare(
    arguments: &Arguments,
    scenes: &[BenchmarkScene],
) -> anyhow::Result<Vec<Row>> {
    let peers = [
        Peer {
            code: Code::Liggghts,
            program: program(&arguments.liggghts)?,
        },
        Peer {
            code: Code::Lammps,
            program: program(&arguments.lammps)?,
        },
    ];
    let mut rows = Vec::new();
    for scene in scenes {
        rows.extend(compare_scene(arguments, *scene, &peers)?);
    }
    Ok(rows)
}

/// Rounds of all codes on one scene.
fn compare_scene(
    arguments: &Arguments,
    scene: BenchmarkScene,
    peers: &[Peer],
) -> anyhow::Result<Vec<Row>> {
    let drum = Drum::flowing(arguments, scene)?;
    let plan = drum.plan(arguments, scene);
    let mut rows: Vec<Row> = Vec::new();
    for round in 1..=arguments.rounds {
        arguments
            .common
            .log(|| format!("{scene}: round {round} of {}", arguments.rounds));
        let mut world = drum.world()?.on_threads(plan.ranks.into())?;
        let name = scene.to_string();
        let own_steps = steps_of_block(&plan, world.settings().time_step);
        let spheres = drum.spheres();
        let mut own = measure_world(&name, &mut world, spheres, own_steps, (plan.blocks, false))?;
        if own_steps < scene.block_steps() {
            // So few steps tell the state at the end, not the cost: all lists are as old as the world.
            let steps = scene.block_steps();
            let timed = measure_world(&name, &mut world, spheres, steps, (plan.blocks, false))?;
            own.set_blocks(timed.us_per_step_blocks);
            own.block_steps = steps;
        }
        // This process has also prepared the scene and written it for the peers.
        own.peak_memory_mib = None;
        let mut of_round = vec![own];
        for peer in peers {
            let folder = arguments.work.join(&name).join(peer.code.name());
            of_round.push(run_peer(peer, &drum, &plan, &folder, &of_round[0])?);
        }
        if rows.is_empty() {
            rows = of_round;
        } else {
            for (row, new) in rows.iter_mut().zip(of_round) {
                row.us_per_step_blocks.extend(new.us_per_step_blocks);
            }
        }
    }
    for row in &mut rows {
        let blocks = std::mem::take(&mut row.us_per_step_blocks);
        row.set_blocks(blocks);
    }
    let own = rows.first().map_or(f64::NAN, |r| r.cpu_s_per_simulated_s);
    for row in &mut rows {
        row.cost_over_seedloop = Some(row.cpu_s_per_simulated_s / own);
    }
    Ok(rows)
}

/// Steps of this solver, each of `time_step` (s), in the time of a block of the peers.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "some hundred steps, and both time steps are positive"
)]
fn steps_of_block(plan: &Plan, time_step: f64) -> usize {
    (plan.block_steps as f64 * plan.time_step / time_step).round() as usize
}

/// Runs a peer once in a folder of its own.
fn run_peer(
    peer: &Peer,
    drum: &Drum,
    plan: &Plan,
    folder: &Path,
    own: &Row,
) -> anyhow::Result<Row> {
    let name = peer.code.name();
    let write = |name: &str, text: &str| {
        let file = folder.join(name);
        fs::write(&file, text).with_context(|| format!("cannot write {}", file.display()))
    };
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for file in drum.files(peer.code, plan)? {
        write(&file.name, &file.text)?;
    }
    write("sample.sh", &deck::sample(plan))?;
    write("samples.txt", "")?;
    let status = command(&peer.program, plan.ranks)
        .args(["-in", deck::SCRIPT, "-log", "log.txt"])
        .current_dir(folder)
        .env("OMP_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .status()
        .with_context(|| {
            let program = peer.program.display();
            let starter = if plan.ranks > 1 { " by mpirun" } else { "" };
            format!("cannot start {program}{starter}: install {name} or name its program")
        })?;
    let log = folder.join("log.txt");
    anyhow::ensure!(
        status.success(),
        "{name} ended with {status}: see {}",
        log.display()
    );
    let samples = read_samples(&folder.join("samples.txt"), plan)?;
    let blocks = samples.windows(2).map(|pair| {
        let nanoseconds = pair[1].0 - pair[0].0;
        nanoseconds / plan.block_steps as f64 * 1e-3
    });
    let [x, y, energy] = read_result(&log)?;
    let mut row = Row {
        code: name.into(),
        contacts: None,
        bytes_of_step: None,
        peak_memory_mib: samples.last().map(|s| s.1 / 1024.0),
        centre_of_mass_deg: x.atan2(-y).to_degrees(),
        kinetic_energy_uj: energy * 1e6,
        time_step_s: plan.time_step,
        block_steps: plan.block_steps,
        ..own.clone()
    };
    row.set_blocks(blocks.collect());
    Ok(row)
}

/// Starts a program in so many processes, by the `mpirun` in its folder: that of another library would start it as often alone.
fn command(program: &Path, ranks: u8) -> Command {
    if ranks == 1 {
        return Command::new(program);
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut folders = std::env::split_paths(&path);
    let folder = match program.parent() {
        Some(parent) if parent != Path::new("") => Some(parent.to_owned()),
        _ => folders.find(|folder| folder.join(program).exists()),
    };
    let starter = folder.unwrap_or_default().join("mpirun");
    let mut command = Command::new(starter);
    // Open MPI refuses the administrator otherwise, as in a container.
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1");
    command.env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command.args(["-np", &ranks.to_string()]).arg(program);
    command
}

/// Time on the processor, or by the clock of several processes (ns), and peak memory (KiB) behind each block.
fn read_samples(file: &Path, plan: &Plan) -> anyhow::Result<Vec<(f64, f64)>> {
    let text = fs::read_to_string(file)?;
    let sample = |line: &str| {
        let (time, memory) = line.split_once(' ')?;
        Some((time.parse().ok()?, memory.trim().parse().ok()?))
    };
    let samples: Option<Vec<_>> = text.lines().map(sample).collect();
    let expected = plan.blocks as usize + 1;
    samples.filter(|s| s.len() == expected).with_context(|| {
        format!(
            "{}: expected {expected} lines of two numbers",
            file.display()
        )
    })
}

/// Centre of mass (m) and kinetic energy (J) at the end.
fn read_result(log: &Path) -> anyhow::Result<[f64; 3]> {
    let text = fs::read_to_string(log)?;
    let line = text.lines().rev().find_map(|l| l.strip_prefix("result "));
    let numbers = line.map(|l| l.split_whitespace().map(str::parse).collect());
    let numbers: Option<Result<Vec<f64>, _>> = numbers;
    numbers
        .and_then(Result::ok)
        .and_then(|n| n.try_into().ok())
        .with_context(|| format!("{}: no line \"result X Y ENERGY\"", log.display()))
}

/// A program in a folder by its full path, for it is started elsewhere; a bare name as it is.
fn program(file: &Path) -> anyhow::Result<PathBuf> {
    if file.components().count() == 1 {
        return Ok(file.to_owned());
    }
    // The link itself is kept: LAMMPS in its own folder finds its libraries by it.
    let full = std::path::absolute(file)?;
    anyhow::ensure!(
        full.exists(),
        "{} does not exist: `trials/programs.sh bench-peers` installs it",
        file.display()
    );
    Ok(full)
}

#[cfg(test)]
mod tests {
    use super::{Plan, command, read_result, read_samples};
    use std::path::Path;

    /// A file of this test alone.
    fn file(name: &str, text: &str) -> std::path::PathBuf {
        let name = format!("seedloop-benchmark-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    #[test]
    fn samples_are_read_and_a_run_that_broke_off_is_an_error() {
        let plan = Plan {
            block_steps: 10,
            blocks: 1,
            time_step: 1e-5,
            skin: 1e-3,
            ranks: 1,
        };
        let whole = file("whole", "5000 100\n9000 120\n");
        let read = read_samples(&whole, &plan).unwrap();
        assert_eq!(read, [(5000.0, 100.0), (9000.0, 120.0)]);
        for text in ["5000 100\n", "5000 100\n9000\n", ""] {
            let broken = file("broken", text);
            assert!(read_samples(&broken, &plan).is_err(), "{text}");
            std::fs::remove_file(broken).unwrap();
        }
        std::fs::remove_file(whole).unwrap();
    }

    /// Several processes are started by the `mpirun` beside the program, one by the program itself.
    #[test]
    fn ranks_are_started_by_the_library_of_the_program() {
        let two = command(Path::new("/codes/bin/lmp"), 2);
        assert_eq!(two.get_program(), "/codes/bin/mpirun");
        assert!(two.get_args().eq(["-np", "2", "/codes/bin/lmp"]));
        let one = command(Path::new("/codes/bin/lmp"), 1);
        assert_eq!(
            (one.get_program(), one.get_args().len()),
            ("/codes/bin/lmp".as_ref(), 0)
        );
    }

    /// The deck's own line comes first in the log, with the names of the variables.
    #[test]
    fn result_is_the_printed_line_and_not_the_command() {
        let log = file("log", "print \"result $x $y $e\"\nresult 1e-2 -0.04 3e-6\n");
        assert_eq!(read_result(&log).unwrap(), [1e-2, -0.04, 3e-6]);
        let without = file("without", "print \"result $x $y $e\"\n");
        assert!(read_result(&without).is_err());
        std::fs::remove_file(log).unwrap();
        std::fs::remove_file(without).unwrap();
    }
}
