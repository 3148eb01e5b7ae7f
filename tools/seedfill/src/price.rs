//! What a filling costs in a simulation.

use crate::arguments::Arguments;
use anyhow::Context as _;
use contact_law::Material;
use contact_law::hertz_mindlin::rayleigh_time_step;
use serde::Serialize;
use sphere_fill::Filling;
use std::path::Path;

/// Time step and cost that a filling implies; what is not known is none.
#[derive(Debug, Serialize)]
pub(crate) struct Price {
    /// Spheres that something outside can touch.
    outer_spheres: usize,
    shear_modulus_pa: f64,
    poisson_ratio: f64,
    /// Of the seed: mass over volume of the mesh.
    density_kg_m3: Option<f64>,
    /// Of the smallest sphere at the density of the seed.
    rayleigh_time_step_s: Option<f64>,
    /// Bodies of the run that was timed.
    timed_bodies: Option<u64>,
    /// Time step of that run.
    timed_step_s: Option<f64>,
    /// What a second of that drum would take with this filling.
    wall_s_per_drum_s: Option<f64>,
}

impl Price {
    /// Works out time step and cost.
    ///
    /// The cost is bodies x spheres / (sphere steps a second x time step): the measured speed of the
    /// timed run, whose sphere steps count hidden spheres as well, carried over to this filling.
    ///
    /// # Errors
    ///
    /// Elastic constants out of range, a file of a run that cannot be read.
    pub(crate) fn new(arguments: &Arguments, filling: &Filling) -> anyhow::Result<Self> {
        let material = Material::new(arguments.poisson_ratio, arguments.shear_modulus_pa)?;
        let volume = filling.mesh_moments.volume;
        let density = arguments.mass_of(volume).map(|mass| mass / volume);
        let radii = filling.spheres.iter().map(|s| s.radius);
        let smallest = radii.fold(f64::INFINITY, f64::min);
        let timed = arguments.timing.as_deref().map(Timing::read).transpose()?;
        let spheres = filling.spheres.len() as f64;
        Ok(Self {
            outer_spheres: filling.outer_count()?,
            shear_modulus_pa: material.shear_modulus,
            poisson_ratio: material.poisson_ratio,
            density_kg_m3: density,
            rayleigh_time_step_s: density.map(|rho| rayleigh_time_step(smallest, rho, &material)),
            timed_bodies: timed.as_ref().map(|timing| timing.bodies),
            timed_step_s: timed.as_ref().map(|timing| timing.time_step_s),
            wall_s_per_drum_s: timed.map(|timing| {
                timing.bodies as f64 * spheres / (timing.sphere_steps_per_s * timing.time_step_s)
            }),
        })
    }

    /// Names and values for people.
    pub(crate) fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![("spheres at the surface", self.outer_spheres.to_string())];
        if let Some(step) = self.rayleigh_time_step_s {
            let text = format!(
                "{step:.2e} s (shear modulus {:.3e} Pa)",
                self.shear_modulus_pa
            );
            lines.push(("Rayleigh time step", text));
        }
        if let (Some(cost), Some(bodies)) = (self.wall_s_per_drum_s, self.timed_bodies) {
            lines.push((
                "cost of a drum second",
                format!("{cost:.0} s for {bodies} bodies"),
            ));
        }
        lines
    }
}

/// Measured speed of a run.
struct Timing {
    bodies: u64,
    time_step_s: f64,
    sphere_steps_per_s: f64,
}

impl Timing {
    /// Reads the JSON that `seedloop simulate --json FILE` wrote.
    fn read(file: &Path) -> anyhow::Result<Self> {
        let name = file.display();
        let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {name}"))?;
        let run: serde_json::Value =
            serde_json::from_str(&text).with_context(|| format!("{name} is no JSON"))?;
        let number = |key: &str| {
            let found = run["timing"][key].as_f64().filter(|value| *value > 0.0);
            found.with_context(|| {
                format!("{name} has no positive number timing.{key}: expected the JSON of a run")
            })
        };
        Ok(Self {
            bodies: run["timing"]["bodies"]
                .as_u64()
                .with_context(|| format!("{name} has no timing.bodies"))?,
            time_step_s: number("time_step_s")?,
            sphere_steps_per_s: number("sphere_steps_per_s")?,
        })
    }
}
