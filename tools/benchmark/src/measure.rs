//! Time on the processor, peak memory, medians.

use anyhow::Context as _;
use dem_solver::World;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Cost of a scene with one code; each unit is in the name.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) code: String,
    pub(crate) seeds: usize,
    /// All spheres, those hidden inside a seed included.
    pub(crate) spheres: usize,
    /// Touching pairs of spheres and of spheres and walls at the end; none for other codes.
    pub(crate) contacts: Option<usize>,
    pub(crate) time_step_s: f64,
    pub(crate) block_steps: usize,
    /// Cost of a step in each block, in the order of time.
    pub(crate) us_per_step_blocks: Vec<f64>,
    /// Their median.
    pub(crate) us_per_step: f64,
    pub(crate) sphere_steps_per_s: f64,
    pub(crate) cpu_s_per_simulated_s: f64,
    /// Of the process; none if it has done other things before.
    pub(crate) peak_memory_mib: Option<f64>,
    /// Bytes of lists and bodies that a step reads, each once; none for other codes.
    pub(crate) bytes_of_step: Option<usize>,
    /// Direction of the centre of mass from straight down at the end, deg.
    pub(crate) centre_of_mass_deg: f64,
    /// Kinetic energy of translation at the end, uJ.
    pub(crate) kinetic_energy_uj: f64,
    /// Cost over that of this solver; none without peers.
    pub(crate) cost_over_seedloop: Option<f64>,
    /// What the phases of a step cost; none if they are not asked for.
    pub(crate) phases: Option<Phases>,
}

/// What the phases of a step cost by the clock, us.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[expect(clippy::struct_field_names, reason = "each unit is in the name")]
pub(crate) struct Phases {
    pub(crate) search_us: f64,
    pub(crate) contacts_us: f64,
    pub(crate) triangles_us: f64,
    pub(crate) motion_us: f64,
}

impl Row {
    /// Sets the costs from those of the blocks.
    pub(crate) fn set_blocks(&mut self, blocks: Vec<f64>) {
        self.us_per_step = probability::median(&blocks);
        self.sphere_steps_per_s = self.spheres as f64 / self.us_per_step * 1e6;
        self.cpu_s_per_simulated_s = self.us_per_step * 1e-6 / self.time_step_s;
        self.us_per_step_blocks = blocks;
    }
}

/// Runs one block to warm up and then `n_blocks` that are measured; gives the row.
pub(crate) fn measure_world(
    scene: &str,
    world: &mut World,
    spheres: usize,
    block_steps: usize,
    (n_blocks, with_phases): (u32, bool),
) -> anyhow::Result<Row> {
    let threads = world.n_threads();
    let clock = Instant::now();
    // Threads of the solver are not counted on the processor.
    let seconds = || match threads {
        1 => processor_seconds(),
        _ => Ok(clock.elapsed().as_secs_f64()),
    };
    let mut blocks = Vec::new();
    for block in 0..=n_blocks {
        if block == 1 && with_phases {
            world.count_phases();
        }
        let start = seconds()?;
        world.steps(block_steps as u64)?;
        if block > 0 {
            blocks.push((seconds()? - start) / block_steps as f64 * 1e6);
        }
    }
    let bodies = world.bodies();
    let (mut moment, mut energy) = (nalgebra::Vector3::zeros(), 0.0);
    for i in 0..bodies.len() {
        let mass = world.templates()[bodies.template[i]].mass();
        moment += bodies.position[i] * mass;
        energy += 0.5 * mass * bodies.velocity[i].norm_squared();
    }
    let mut row = Row {
        scene: scene.to_owned(),
        code: "seedloop".into(),
        seeds: bodies.len(),
        spheres,
        contacts: Some(world.census().sphere_contacts + world.n_wall_contacts()),
        time_step_s: world.settings().time_step,
        block_steps,
        us_per_step_blocks: Vec::new(),
        us_per_step: 0.0,
        sphere_steps_per_s: 0.0,
        cpu_s_per_simulated_s: 0.0,
        peak_memory_mib: Some(peak_memory_mib()?),
        bytes_of_step: Some(world.bytes_of_step()),
        centre_of_mass_deg: moment.x.atan2(-moment.y).to_degrees(),
        kinetic_energy_uj: energy * 1e6,
        cost_over_seedloop: None,
        phases: world.phases().map(|sums| {
            let us = |sum: f64| sum * 1e6 / (f64::from(n_blocks) * block_steps as f64);
            Phases {
                search_us: us(sums.search),
                contacts_us: us(sums.contacts),
                triangles_us: us(sums.triangles),
                motion_us: us(sums.motion),
            }
        }),
    };
    row.set_blocks(blocks);
    Ok(row)
}

/// Time that this process has had a processor, s.
pub(crate) fn processor_seconds() -> anyhow::Result<f64> {
    let file = "/proc/self/schedstat";
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("cannot read {file}: the benchmark needs Linux"))?;
    let nanoseconds = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
    Ok(nanoseconds.with_context(|| format!("{file}: no number"))? * 1e-9)
}

/// Largest resident memory of this process so far, MiB.
pub(crate) fn peak_memory_mib() -> anyhow::Result<f64> {
    let file = "/proc/self/status";
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {file}"))?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    Ok(kib.with_context(|| format!("{file}: no VmHWM"))? / 1024.0)
}
