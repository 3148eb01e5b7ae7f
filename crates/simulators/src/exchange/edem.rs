//! The settings of a scene as EDEM takes them, as a table to be typed in.
//!
//! EDEM publishes the formulae of its models, and no form of its decks that another program could write: what is handed over
//! is a table of every value by the place where EDEM asks for it, and the spheres of each particle.
//!
//! # What is converted
//!
//! | here | EDEM 2025, Hertz-Mindlin (no slip) |
//! |---|---|
//! | moduli, density of each material | the same |
//! | static friction | the same: the tangential force is limited by it times the normal force |
//! | restitution of a dashpot with the mass of the sphere | its dashpot takes the mass of the particle: the ratio of damping is scaled by sqrt(`m_sphere` / `m_body`) and turned back into a restitution |
//! | rolling friction of type A with the arm of the body | the same: its standard rolling friction takes the distance of the contact from the centre of mass |
//! | the same with the arm of the sphere | scaled by radius over distance, the mean over the surface |
//! | rolling friction of type C | not converted: refused |
//! | normal force that never pulls | EDEM's formula has no such end: the table says so beside each restitution |
//!
//! # Source
//!
//! `[AltairEDEM2025]`: the pages of the Hertz-Mindlin (no slip) and the standard rolling friction model.

use crate::exchange::Error;
use crate::exchange::drum_deck::{
    DASHPOTS_THERE, FINER, Shares, lever_share, restitution_of_body, whole_seed_damping,
};
use crate::exchange::vtk::{File, add};
use contact_law::{NormalForceEnd, RollingLever};
use scene::{Apparatus, RollingLaw, Scene, SeedBody};
use std::sync::Arc;

/// The tool, for messages.
const TOOL: &str = "EDEM";

/// What a reader must know of a normal force that never pulls: the formula of EDEM has no such end.
const CLIPPED: &str = "as it is; but the force here never pulls and that of EDEM's formula does: seeds rebound less there";
/// The same where the mass is another.
const CONVERTED_AND_CLIPPED: &str = "converted to the mass of the particle; but the force here never pulls and that of \
                                     EDEM's formula does: seeds rebound less there";

/// The tables: `edem.csv`, and for each kind of seeds `KIND.csv` with its spheres. `time_step` is the one that the solver here
/// takes, s.
///
/// # Errors
///
/// Laws that EDEM's standard models do not have.
pub fn tables(scene: &Scene, bodies: &[Arc<SeedBody>], time_step: f64) -> Result<Vec<File>, Error> {
    check(scene)?;
    let mut table = Table::new();
    table.add_materials(scene);
    table.add_particles(scene, bodies);
    table.add_interactions(scene, bodies);
    table.add_drum(&scene.apparatus);
    let gravity = -scene.model.gravity_m_s2;
    let at = ["Physics", "environment", "Gravity Y", "m/s2"];
    table.add(at, gravity, "as it is");
    let at = ["Simulator", "settings", "Fixed time step", "s"];
    table.add(at, time_step / FINER, "a quarter of that here");
    let mut files = vec![File {
        name: "edem.csv".into(),
        text: table.text,
    }];
    let kinds = scene.seed.iter().zip(bodies);
    files.extend(kinds.map(|(seed, body)| File {
        name: format!("{}.csv", seed.name.replace(['/', '\\'], "_")),
        text: spheres(body),
    }));
    Ok(files)
}

/// The spheres at the surface of a seed, about its centre of mass in principal axes.
fn spheres(body: &SeedBody) -> String {
    let mut text = String::from("x_m,y_m,z_m,radius_m\n");
    for s in body.outer.spheres() {
        let c = s.centre;
        let row = format_args!("{:e},{:e},{:e},{:e}\n", c.x, c.y, c.z, s.radius);
        add(&mut text, row);
    }
    text
}

/// The table of settings.
struct Table {
    /// Its text so far.
    text: String,
}

impl Table {
    /// The names of the columns.
    fn new() -> Self {
        Self {
            text: "where,of,setting,unit,value,how\n".into(),
        }
    }

    /// A row: where EDEM asks for it, of what, the setting and its unit.
    fn add(&mut self, at: [&str; 4], value: f64, how: &str) {
        let row = format_args!("{},{value:e},{how}\n", at.join(","));
        add(&mut self.text, row);
    }

    /// Moduli of the materials.
    fn add_materials(&mut self, scene: &Scene) {
        for (name, material) in &scene.material {
            let poisson = material.poisson_ratio.get();
            let shear = material.shear_modulus_pa();
            self.add(
                ["Bulk material", name, "Poisson's ratio", "1"],
                poisson,
                "as it is",
            );
            self.add(
                ["Bulk material", name, "Shear modulus", "Pa"],
                shear,
                "as it is",
            );
        }
    }

    /// The drum that holds the seeds: about Z, between two covers.
    fn add_drum(&mut self, apparatus: &Apparatus) {
        if matches!(apparatus, Apparatus::Drum(_)) {
            let of = |setting, unit| ["Geometry", "drum", setting, unit];
            let radius = apparatus.radius();
            self.add(of("Inner radius", "m"), radius, "as it is");
            let length = apparatus.width();
            self.add(of("Length along Z", "m"), length, "as it is");
            let speed = apparatus.speed();
            self.add(of("Angular velocity about Z", "rad/s"), speed, "as it is");
        }
    }

    /// Number, mass and inertia of the seeds.
    fn add_particles(&mut self, scene: &Scene, bodies: &[Arc<SeedBody>]) {
        for (seed, body) in scene.seed.iter().zip(bodies) {
            let (name, inertia) = (&seed.name, body.clump.inertia());
            let mass = body.clump.mass();
            let number = scene.count_of(seed) as f64;
            self.add(["Particle", name, "Number", "1"], number, "as it is");
            self.add(["Particle", name, "Mass", "kg"], mass, "override");
            for (axis, moment) in ["X", "Y", "Z"].iter().zip(inertia.iter()) {
                let setting = format!("Moment of inertia {axis}");
                self.add(["Particle", name, &setting, "kg m2"], *moment, "override");
            }
        }
    }

    /// Coefficients of the contacts.
    fn add_interactions(&mut self, scene: &Scene, bodies: &[Arc<SeedBody>]) {
        let shares = Shares::of(scene, bodies);
        let rebound = match (shares.mass == 1.0, scene.model.normal_force_end) {
            (true, NormalForceEnd::Attractive) => "as it is",
            (true, NormalForceEnd::Clipped) => CLIPPED,
            (false, NormalForceEnd::Attractive) => "converted to the mass of the particle",
            (false, NormalForceEnd::Clipped) => CONVERTED_AND_CLIPPED,
        };
        let (arm, turn) = match scene.model.rolling_lever {
            RollingLever::Centre => (1.0, "as it is"),
            RollingLever::Sphere => (
                1.0 / mean_lever(scene, bodies),
                "converted to the distance from the centre of mass",
            ),
        };
        for (pair, contact) in &scene.contact {
            let restitution = restitution_of_body(contact.restitution.get(), shares.mass);
            let of = |setting| ["Interaction", pair, setting, "1"];
            self.add(of("Coefficient of restitution"), restitution, rebound);
            let sliding = contact.static_friction.get();
            self.add(of("Coefficient of static friction"), sliding, "as it is");
            let rolling = contact.rolling_friction.get() * arm;
            self.add(of("Coefficient of rolling friction"), rolling, turn);
        }
    }
}

/// Refuses laws that EDEM's standard models do not have.
fn check(scene: &Scene) -> Result<(), Error> {
    let missing = |what: &str, way_out| {
        Err(Error::NotThere {
            what: what.to_owned(),
            tool: TOOL,
            way_out,
        })
    };
    if scene.model.rolling_law == RollingLaw::SpringDashpot {
        return missing(
            "rolling resistance of type C",
            "calibrate with model.rolling_law = \"constant-torque\"",
        );
    }
    let pulls = scene
        .contact
        .values()
        .flat_map(|c| [c.attraction_n, c.cohesion_energy_density_j_m3])
        .any(|stated| stated.is_some_and(|value| value != 0.0));
    if pulls || scene.model.bond_number != 0.0 || scene.model.liquid.is_some() {
        return missing("attraction or liquid", "remove it from the scene");
    }
    if let Some(missed) = whole_seed_damping(scene) {
        return missing(&missed, DASHPOTS_THERE);
    }
    if scene.model.bonds.is_some() {
        return missing("seeds of bonded spheres", "remove model.bonds");
    }
    Ok(())
}

/// Distance of a contact from the centre of a seed over the radius of its sphere: the mean over all seeds.
fn mean_lever(scene: &Scene, bodies: &[Arc<SeedBody>]) -> f64 {
    let kinds = scene.seed.iter().zip(bodies);
    let sum: f64 = kinds
        .map(|(seed, body)| scene.count_of(seed) as f64 * lever_share(body))
        .sum();
    sum / scene.seed_count() as f64
}

#[cfg(test)]
mod tests {
    use super::tables;
    use dev_support::fixture_files::fixture;
    use input::quantity::FrictionCoefficient;
    use scene::{FillingLibrary, RollingLaw, Scene, starting_frame};

    /// A value of a table.
    fn value(text: &str, of: &str, setting: &str) -> f64 {
        let row = text.lines().find(|l| l.contains(of) && l.contains(setting));
        row.and_then(|l| l.split(',').nth(4)?.parse().ok()).unwrap()
    }

    /// Friction goes out as it is. The dashpot of a sphere of one 146th of the seed is that of a weaker one on the whole seed. An
    /// arm of the sphere becomes that of the body: the mean seed is 4.5 to 9.3 mm across, so that a surface sphere of
    /// 0.45 mm has its contact at 5.0 to 10.3 radii from the centre.
    #[test]
    fn coefficients_are_those_of_the_arm_and_mass_that_edem_takes() {
        let file = fixture("cotton/drum.toml");
        let mut scene = Scene::read(&file, &[]).unwrap();
        for contact in scene.contact.values_mut() {
            contact.rolling_friction = FrictionCoefficient::new(0.1).unwrap();
        }
        let (_, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        let files = tables(&scene, &bodies, step).unwrap();
        let pair = "seed-tough_resin";
        let of = |setting: &str| value(&files[0].text, pair, setting);
        let contact = &scene.contact[pair];
        assert_eq!(of("static friction"), contact.static_friction.get());
        let ratio = |e: f64| -e.ln() / e.ln().hypot(std::f64::consts::PI);
        let weaker = ratio(of("restitution")) / ratio(contact.restitution.get());
        let share = bodies[0].clump.fraction_mass(0) / bodies[0].clump.mass();
        assert!(
            (weaker / share.sqrt() - 1.0).abs() < 0.1,
            "{weaker} for {}",
            share.sqrt()
        );
        let rolling = of("rolling friction");
        assert!((0.1 / 10.3..0.1 / 5.0).contains(&rolling), "{rolling}");
        assert_eq!(files.len(), 3, "the spheres of both kinds");
        let mass = value(&files[0].text, &scene.seed[0].name, "Mass");
        assert!((mass / 94.5e-6 - 1.0).abs() < 1e-12);
        let number = value(&files[0].text, &scene.seed[0].name, "Number");
        assert_eq!(number, scene.count_of(&scene.seed[0]) as f64);
        let turn = value(&files[0].text, "drum", "Angular velocity");
        let [radius, length] =
            ["Inner radius", "Length"].map(|setting| value(&files[0].text, "drum", setting));
        // The drum of the study: 140 mm across, 46 mm wide.
        assert_eq!(
            [radius, length, turn],
            [0.07, 0.046, scene.apparatus.speed()]
        );

        scene.model.rolling_law = RollingLaw::SpringDashpot;
        let error = tables(&scene, &bodies, step).unwrap_err().to_string();
        assert!(
            error.contains("type C") && error.contains("EDEM"),
            "{error}"
        );
    }
}
