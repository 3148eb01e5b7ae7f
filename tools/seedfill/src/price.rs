//! What a filling costs in a simulation.

use crate::arguments::Arguments;
use crate::trial_bed::near_groups;
use anyhow::Context as _;
use contact_law::Material;
use contact_law::hard_contact::{self, Meeting};
use contact_law::hertz_mindlin::rayleigh_time_step;
use contact_law::material::effective_moduli;
use serde::Serialize;
use sphere_fill::{Filling, InertiaSource};
use std::path::Path;

/// Seeds of the study's drum.
const DRUM_SEEDS: u64 = 1200;

/// Cost of a seed and step with packed spheres, us: docs/benchmarks.md, scene `seeds-1200`
/// (540.2 us a step of 1200 seeds).
const PACKED_US: f64 = 540.2 / 1200.0;

/// Name of that run in the output.
const PACKED_RUN: &str = "docs/benchmarks.md, seeds-1200";

/// Overlap of two spheres (over the smallest radius) from which a filling counts as overlapping.
const OVERLAPPING: f64 = 0.01;

/// Time step and cost that a filling implies; what is not known is none.
#[derive(Debug, Serialize)]
pub(crate) struct Price {
    /// Spheres that something outside can touch.
    outer_spheres: usize,
    shear_modulus_pa: f64,
    poisson_ratio: f64,
    /// Of the stiffest thing that the seed meets.
    wall_shear_modulus_pa: f64,
    wall_poisson_ratio: f64,
    /// Of the seed: mass over volume of the mesh.
    density_kg_m3: Option<f64>,
    /// Longest step that a scene takes by default.
    time_step_s: Option<f64>,
    /// That step over the duration of a hard contact.
    step_share: f64,
    /// Of the smallest sphere at the density of the seed; a yardstick only.
    rayleigh_time_step_s: Option<f64>,
    /// Cost of a step over that with packed spheres.
    relative_cost: f64,
    /// Cost of a step for each seed.
    cpu_us_per_seed_step: f64,
    /// Run in which the cost was measured.
    cost_source: String,
    drum_seeds: u64,
    /// What a second of that drum takes with this filling.
    cpu_s_per_drum_s: Option<f64>,
}

impl Price {
    /// Works out time step and cost.
    ///
    /// The time step is that of a scene that says nothing else: 0.36 of the duration of a hard contact
    /// [with its like or a wall](hard_contact::duration_between). The cost is seeds x cost of a
    /// seed and step / time step, the cost of a step as in [`relative_cost`].
    ///
    /// # Errors
    ///
    /// Elastic constants out of range, a file of a run that cannot be read.
    pub(crate) fn new(arguments: &Arguments, filling: &Filling) -> anyhow::Result<Self> {
        let material = Material::new(arguments.poisson_ratio, arguments.shear_modulus_pa)?;
        let wall = Material::new(
            arguments.wall_poisson_ratio,
            arguments.wall_shear_modulus_pa,
        )?;
        let volume = filling.mesh_moments.volume;
        let mass = arguments.mass_of(volume);
        let density = mass.map(|mass| mass / volume);
        let radii = filling.spheres.iter().map(|s| s.radius);
        let smallest = radii.fold(f64::INFINITY, f64::min);
        let time_step_s = mass
            .map(|mass| time_step(filling, mass, &[material, wall]))
            .transpose()?;
        let timed = arguments.timing.as_deref().map(Timing::read).transpose()?;
        let packed_us = timed.as_ref().map_or(PACKED_US, |run| run.us_per_seed_step);
        let drum_seeds = timed.as_ref().map_or(DRUM_SEEDS, |run| run.bodies);
        let outer_spheres = filling.outer_count()?;
        let relative_cost = relative_cost(filling, smallest, mass, [material, wall])?;
        let cpu_us_per_seed_step = packed_us * relative_cost;
        Ok(Self {
            outer_spheres,
            shear_modulus_pa: material.shear_modulus,
            poisson_ratio: material.poisson_ratio,
            wall_shear_modulus_pa: wall.shear_modulus,
            wall_poisson_ratio: wall.poisson_ratio,
            density_kg_m3: density,
            time_step_s,
            step_share: hard_contact::STEP_SHARE,
            rayleigh_time_step_s: density.map(|rho| rayleigh_time_step(smallest, rho, &material)),
            relative_cost,
            cpu_us_per_seed_step,
            cost_source: match &arguments.timing {
                Some(file) => file.display().to_string(),
                None => PACKED_RUN.to_owned(),
            },
            drum_seeds,
            cpu_s_per_drum_s: time_step_s
                .map(|step| drum_seeds as f64 * cpu_us_per_seed_step * 1e-6 / step),
        })
    }

    /// Names and values for people.
    pub(crate) fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![("spheres at the surface", self.outer_spheres.to_string())];
        if let Some(step) = self.time_step_s {
            let text = format!(
                "{:.4} ms ({} of a hard contact)",
                step * 1e3,
                self.step_share
            );
            lines.push(("time step", text));
        }
        if let Some(step) = self.rayleigh_time_step_s {
            lines.push(("Rayleigh time step", format!("{:.4} ms", step * 1e3)));
        }
        if let Some(cost) = self.cpu_s_per_drum_s {
            let text = format!(
                "{cost:.1} CPU-s for {} seeds ({:.2} times a packing's step; measured: {})",
                self.drum_seeds, self.relative_cost, self.cost_source
            );
            lines.push(("cost of a drum second", text));
        } else {
            let unknown = "not known without --mass or --density".to_owned();
            lines.push(("time step and cost", unknown));
        }
        lines
    }
}

/// Longest step of a seed of a mass (kg) that meets its like and a wall, s.
fn time_step(filling: &Filling, mass: f64, others: &[Material; 2]) -> anyhow::Result<f64> {
    let body = filling.clump(mass, InertiaSource::Mesh)?;
    let outer = body.without_hidden_spheres();
    let [seed, wall] =
        others.map(|other| Meeting::usual(effective_moduli(&others[0], &other).young));
    let with_seed = hard_contact::duration_between(&outer, Some(&outer), &seed);
    let with_wall = hard_contact::duration_between(&outer, None, &wall);
    Ok(hard_contact::STEP_SHARE * with_seed.min(with_wall))
}

/// Cost of a step of a filling over that of a packing: 1 for separate spheres.
///
/// Smooth seeds of overlapping spheres touch at as few places as others, but many of their spheres are nearly in touch, and
/// these are looked at in each step: the cost grows with the groups of eight such pairs that a seed of a [small bed](near_groups) has. The
/// line is fitted to twelve fillings in the study's drum and holds within 15 % (`just filling-cost`).
///
/// # Errors
///
/// What the solver refuses.
fn relative_cost(
    filling: &Filling,
    smallest: f64,
    mass: Option<f64>,
    materials: [Material; 2],
) -> anyhow::Result<f64> {
    const FIRST: f64 = 0.5;
    const EACH: f64 = 0.165;
    if filling.report.max_overlap <= OVERLAPPING * smallest {
        return Ok(1.0);
    }
    // Seeds of water where none is weighed: the lists depend on the shape.
    let mass = mass.unwrap_or(1000.0 * filling.mesh_moments.volume);
    let step = time_step(filling, mass, &materials)?;
    let body = filling.clump(mass, InertiaSource::Mesh)?;
    Ok(FIRST + EACH * near_groups(&body, materials, step)?)
}

/// Measured cost of a run with packed seeds.
struct Timing {
    bodies: u64,
    us_per_seed_step: f64,
}

impl Timing {
    /// Reads the JSON that `seedloop simulate --json FILE` wrote.
    fn read(file: &Path) -> anyhow::Result<Self> {
        let name = file.display();
        let text = input_file::read_text(file).with_context(|| format!("cannot read {name}"))?;
        let run: serde_json::Value =
            serde_json::from_str(&text).with_context(|| format!("{name} is no JSON"))?;
        let number = |key: &str| {
            let found = run["timing"][key].as_f64().filter(|value| *value > 0.0);
            found.with_context(|| {
                format!("{name} has no positive number timing.{key}: expected the JSON of a run")
            })
        };
        let threads = run["timing"]["threads"].as_u64().unwrap_or(1);
        anyhow::ensure!(
            threads == 1,
            "{name}: the run was spread over {threads} threads, whose waiting counts as work; make it again with \
             --threads 1"
        );
        let seeds = number("bodies")?;
        // Where the system told no time on the processor, the time on the clock stands for it.
        let cost_s = number("cpu_s").or_else(|_| number("wall_s"))?;
        Ok(Self {
            bodies: run["timing"]["bodies"]
                .as_u64()
                .with_context(|| format!("{name}: timing.bodies is no whole number"))?,
            us_per_seed_step: cost_s * 1e6 / (number("steps")? * seeds),
        })
    }
}
