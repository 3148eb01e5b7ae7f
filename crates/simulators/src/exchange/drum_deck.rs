//! What the decks of all tools have in common: which drums they can run, and how conventions are converted.

use crate::exchange::Error;
use crate::exchange::vtk::add;
use contact_law::RollingLever;
use contact_law::hertz_mindlin::{self, damping_ratio};
use dem_solver::DashpotMass;
use scene::{Apparatus, ContactSettings, Drum, Frame, Scene, SeedBody};
use std::f64::consts::PI;
use std::sync::Arc;

/// How much finer than here a deck is stepped: velocity Verlet with the hard contacts of the tips
/// needs more steps a contact than three.
pub const FINER: f64 = 4.0;

/// Whether all seeds are plain spheres, which need no rigid bodies.
pub(crate) fn are_spheres(bodies: &[Arc<SeedBody>]) -> bool {
    bodies.iter().all(|b| b.clump.spheres().len() == 1)
}

/// Density of a plain sphere, kg/m³.
pub(crate) fn density_of_sphere(body: &SeedBody) -> f64 {
    let radius = body.clump.spheres()[0].radius;
    body.clump.mass() / (4.0 / 3.0 * PI * radius.powi(3))
}

/// Steps in a time (s), at least as long.
pub(crate) fn steps(time: f64, time_step: f64) -> f64 {
    (time / time_step).ceil()
}

/// Means over all seeds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shares {
    /// Mass that the dashpot sees here over the mass of the body.
    pub(crate) mass: f64,
    /// Lever arm of rolling resistance over the distance from the contact to the centre of the sphere.
    pub(crate) lever: f64,
}

impl Shares {
    pub(crate) fn of(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Self {
        let over_seeds = |share: fn(&SeedBody) -> f64| {
            let kinds = scene.seed.iter().zip(bodies);
            let sum: f64 = kinds
                .map(|(s, body)| scene.count_of(s) as f64 * share(body))
                .sum();
            sum / scene.seed_count() as f64
        };
        Self {
            mass: match scene.model.dashpot_mass {
                DashpotMass::Sphere => over_seeds(|b| b.clump.fraction_mass(0) / b.clump.mass()),
                DashpotMass::Body | DashpotMass::Shared => 1.0,
            },
            lever: match scene.model.rolling_lever {
                RollingLever::Centre => over_seeds(lever_share),
                RollingLever::Sphere => 1.0,
            },
        }
    }
}

/// Restitution that gives, with the mass of the body, the dashpot of a share of that mass.
pub(crate) fn restitution_of_body(restitution: f64, mass_share: f64) -> f64 {
    hertz_mindlin::restitution(damping_ratio(restitution) * mass_share.sqrt())
}

/// The dashpots that other codes have.
pub(crate) const DASHPOTS_THERE: &str = "calibrate with model.dashpot_mass = \"sphere\" or \"body\" and without \
                                         model.whole_seed_damping: there a dashpot knows the mass of a sphere or of a body";

/// The dashpots of a scene that other codes lack: those that share the mass which a push moves; `None` if it has others.
pub(crate) fn whole_seed_damping(scene: &Scene) -> Option<String> {
    let share = scene.model.whole_seed_damping;
    if scene.model.dashpot_mass == DashpotMass::Shared {
        Some("a dashpot that shares the mass of a body".into())
    } else if share != 0.0 {
        Some(format!(
            "whole-seed damping of {share}, whose dashpots share the mass that a push moves"
        ))
    } else {
        None
    }
}

/// Whether a contact attracts by its area.
pub(crate) fn coheres(contact: &ContactSettings) -> bool {
    contact
        .cohesion_energy_density_j_m3
        .is_some_and(|k| k != 0.0)
}

/// Lever arm of a contact about the centre of a seed over the radius of its sphere: the mean over the
/// spheres at the surface.
pub(crate) fn lever_share(body: &SeedBody) -> f64 {
    let outer = body.outer.spheres();
    let levers = outer
        .iter()
        .map(|s| (s.centre.norm() + s.radius) / s.radius);
    levers.sum::<f64>() / outer.len() as f64
}

/// The drum of a scene, which other codes run until its bed is steady.
///
/// # Errors
///
/// [`Error::NotThere`] with the name of another apparatus.
pub fn require_drum<'a>(scene: &'a Scene, tool: &'static str) -> Result<&'a Drum, Error> {
    let Apparatus::Drum(drum) = &scene.apparatus else {
        let kind = scene.apparatus.kind();
        return Err(Error::NotThere {
            what: format!("the apparatus '{kind}' with its walls and phases"),
            tool,
            way_out: "choose a scene with a drum; benches are exported as decks",
        });
    };
    Ok(drum)
}

/// The drum, if the tool can run the scene.
///
/// # Errors
///
/// What neither LAMMPS nor LIGGGHTS has.
pub(crate) fn supported<'a>(scene: &'a Scene, tool: &'static str) -> Result<&'a Drum, Error> {
    let missing = |what: &str, way_out| {
        Err(Error::NotThere {
            what: what.to_owned(),
            tool,
            way_out,
        })
    };
    let drum = require_drum(scene, tool)?;
    if drum.lifters.is_some() || !scene.wall.is_empty() {
        return missing(
            "a wall of triangles",
            "remove lifters and [[wall]] from the scene",
        );
    }
    if drum.has_periodic_ends() {
        return missing(
            "a drum with periodic ends",
            "name the material of the covers",
        );
    }
    if drum.covers_at_rest {
        return missing(
            "covers that stand still",
            "remove apparatus.covers_at_rest from the scene",
        );
    }
    if drum.ramp.is_some() || drum.reverse_every.is_some() || drum.ripple.is_some() {
        return missing(
            "a speed that changes",
            "remove ramp, reverse_every and ripple",
        );
    }
    supported_model(scene, tool)?;
    Ok(drum)
}

/// Refuses a scene with a model that neither LAMMPS nor LIGGGHTS has.
///
/// # Errors
///
/// What is missing, by name.
pub(crate) fn supported_model(scene: &Scene, tool: &'static str) -> Result<(), Error> {
    let missing = |what: &str, way_out| {
        Err(Error::NotThere {
            what: what.to_owned(),
            tool,
            way_out,
        })
    };
    if !scene.surroundings.is_empty() {
        return missing("air, charge or vibration", "remove [surroundings]");
    }
    let pulls = |c: &ContactSettings| c.attraction_n.is_some_and(|force| force != 0.0);
    if scene.contact.values().any(pulls) {
        return missing("a constant attraction", "remove attraction_n");
    }
    if scene.model.bond_number != 0.0 {
        return missing("a constant attraction", "set model.bond_number to 0");
    }
    if scene.model.liquid.is_some() {
        return missing("a bridge of liquid", "remove model.liquid");
    }
    let depends_on_rate =
        |c: &ContactSettings| c.viscoelastic_damping.is_some() || c.friction_rate.is_some();
    if scene.contact.values().any(depends_on_rate) {
        return missing(
            "a law that depends on the speed",
            "remove viscoelastic_damping and friction_rate",
        );
    }
    if scene.model.bonds.is_some() {
        return missing("seeds of bonded spheres", "remove model.bonds");
    }
    if let Some(missed) = whole_seed_damping(scene) {
        return missing(&missed, DASHPOTS_THERE);
    }
    let materials = scene.seed.iter().map(|s| s.material.as_str());
    let mut materials: Vec<_> = materials.collect();
    materials.dedup();
    if materials.len() > 1 {
        return missing("a second material of seeds", "give all seeds one material");
    }
    Ok(())
}

/// Plain spheres and their motion, as the rows of atoms and velocities that both codes read.
pub(crate) fn plain_atoms(bodies: &[Arc<SeedBody>], start: &Frame) -> String {
    let mut rows = String::new();
    for (i, c) in start.position.iter().enumerate() {
        let body = &bodies[start.kind[i]];
        let (diameter, density) = (
            2.0 * body.clump.spheres()[0].radius,
            density_of_sphere(body),
        );
        let row = format_args!(
            "{} 1 {diameter:e} {density} {:e} {:e} {:e}\n",
            i + 1,
            c.x,
            c.y,
            c.z
        );
        add(&mut rows, row);
    }
    rows.push_str("\nVelocities\n\n");
    for (i, (v, w)) in start.velocity.iter().zip(&start.spin).enumerate() {
        let row = format_args!(
            "{} {:e} {:e} {:e} {:e} {:e} {:e}\n",
            i + 1,
            v.x,
            v.y,
            v.z,
            w.x,
            w.y,
            w.z
        );
        add(&mut rows, row);
    }
    rows
}

/// Where the random numbers of a seed begin in a deck. The codes read them as signed 32-bit numbers, so that a seed is spread over those:
/// seeds from 0 on are as far apart as the golden section puts them.
pub(crate) fn first_of(seed: u64) -> u64 {
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    10_007 + (seed.wrapping_mul(GOLDEN) >> 32) % 2_000_000_000
}
