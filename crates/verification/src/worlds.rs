//! Small worlds, for the rows and for the tests of the solver: balls, clusters, planes, starts.
//!
//! # Errors
//!
//! All fail only if the solver refuses a number.

#![expect(clippy::missing_errors_doc, reason = "one reason for all, above")]

use crate::CheckError;
use contact_law::{Material, NormalForceEnd, PairParameters};
use dem_solver::{
    DashpotMass, Interaction, InteractionSettings, Placement, Settings, Shape, Template, Wall,
    World,
};
use geometry::clump::{Clump, MassProperties, Sphere, properties_of_spheres};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Acceleration of gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// Density of bodies that have no other, kg/m³.
pub const DENSITY: f64 = 1000.0;

/// Radius of balls that have no other, m.
pub const RADIUS: f64 = 2e-3;

/// A material by Young's modulus (Pa) and Poisson's ratio.
pub fn elastic(young: f64, poisson: f64) -> Result<Material, contact_law::Error> {
    Material::new(poisson, young / (2.0 * (1.0 + poisson)))
}

/// A soft material, so that a contact lasts many steps.
pub fn soft() -> Result<Material, contact_law::Error> {
    Material::new(0.25, 4e6)
}

/// A surface between two materials: restitution, sliding and rolling friction, no attraction, a
/// dashpot that may pull.
pub fn surface(
    materials: [Material; 2],
    [restitution, static_friction, rolling_friction]: [f64; 3],
) -> InteractionSettings {
    InteractionSettings {
        materials,
        parameters: PairParameters {
            restitution,
            static_friction,
            rolling_friction,
        },
        attraction: 0.0,
        end: NormalForceEnd::Attractive,
    }
}

/// The same with soft sides.
pub fn soft_surface(parameters: [f64; 3]) -> Result<InteractionSettings, CheckError> {
    Ok(surface([soft()?; 2], parameters))
}

/// The same without a pulling dashpot.
pub fn clipped(settings: InteractionSettings) -> InteractionSettings {
    InteractionSettings {
        end: NormalForceEnd::Clipped,
        ..settings
    }
}

/// Settings whose lists suit bodies of a size (m).
pub fn settings(time_step: f64, gravity: Vector3<f64>, size: f64) -> Settings {
    Settings {
        time_step,
        gravity,
        skin: 0.15 * size,
        margin: 0.5 * size,
    }
}

/// A ball: radius in m, density in kg/m³.
pub fn ball(radius: f64, density: f64) -> Result<Template, CheckError> {
    let clump = Clump::sphere(radius, density)?;
    Ok(Template::new(&clump, 0, DashpotMass::Body))
}

/// A body of spheres (centre and radius in m) with their mass.
pub fn cluster(spheres: &[([f64; 3], f64)]) -> Result<Clump, CheckError> {
    let spheres: Vec<_> = spheres
        .iter()
        .map(|&(centre, radius)| Sphere {
            centre: Vector3::from(centre),
            radius,
        })
        .collect();
    Ok(Clump::new(
        &spheres,
        &properties_of_spheres(&spheres, DENSITY),
    )?)
}

/// A body of three different moments of inertia: two crossed pairs of spheres.
pub fn asymmetric() -> Result<Clump, CheckError> {
    let sphere = |x, y| Sphere {
        centre: Vector3::new(x, y, 0.0),
        radius: 1e-3,
    };
    let spheres = [
        sphere(3e-3, 0.0),
        sphere(-3e-3, 0.0),
        sphere(0.0, 1.5e-3),
        sphere(0.0, -1.5e-3),
    ];
    let properties = MassProperties {
        mass: 3e-5,
        centre: Vector3::zeros(),
        inertia: Matrix3::from_diagonal(&Vector3::new(1e-10, 2e-10, 2.7e-10)),
    };
    Ok(Clump::new(&spheres, &properties)?)
}

/// A plane through a point (m).
pub fn plane(point: Vector3<f64>, normal: Vector3<f64>) -> Wall {
    let shape = Shape::Plane {
        point,
        normal: normal.normalize(),
    };
    Wall {
        name: "plane".into(),
        shape,
        material: 0,
        spin: 0.0,
    }
}

/// A box of six planes about the origin; half edge in m.
pub fn box_of_planes(half: f64) -> Vec<Wall> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    axes.iter()
        .flat_map(|axis| [plane(-axis * half, *axis), plane(axis * half, -axis)])
        .collect()
}

/// The plane y = 0 with bodies above.
pub fn floor() -> Wall {
    plane(Vector3::zeros(), Vector3::y())
}

/// A body that starts without spin: template, position (m), velocity (m/s).
pub fn thrown(template: usize, position: Vector3<f64>, velocity: Vector3<f64>) -> Placement {
    Placement {
        velocity,
        ..Placement::at_rest(template, position, UnitQuaternion::identity())
    }
}

/// A world with one surface everywhere.
pub fn world(
    settings: Settings,
    surface: &InteractionSettings,
    templates: Vec<Template>,
    walls: Vec<Wall>,
    starts: &[Placement],
) -> Result<World, CheckError> {
    let interactions = vec![Interaction::new(surface)?];
    Ok(World::new(
        settings,
        templates,
        interactions,
        walls,
        starts,
    )?)
}

/// Moves a world by a number of steps.
pub fn run(world: &mut World, n_steps: usize) -> Result<(), CheckError> {
    for _ in 0..n_steps {
        world.step()?;
    }
    Ok(())
}

/// Whether anything touches.
pub fn touches(world: &World) -> bool {
    world.census().sphere_contacts + world.n_wall_contacts() > 0
}

/// Runs until the first contact has come and gone; the time of contact, s.
pub fn collide(world: &mut World, most_steps: usize) -> Result<f64, CheckError> {
    let mut n_touching = 0;
    for _ in 0..most_steps {
        world.step()?;
        if touches(world) {
            n_touching += 1;
        } else if n_touching > 0 {
            return Ok(f64::from(n_touching) * world.settings().time_step);
        }
    }
    Err(CheckError::NoEvent("the end of the contact"))
}

/// Overlap at which a plane of the same soft material carries a ball of [`DENSITY`], m.
pub fn resting_overlap(radius: f64, gravity: f64) -> Result<f64, CheckError> {
    let mass = DENSITY * geometry::clump::volume_of_sphere(radius);
    let young = contact_law::material::effective_moduli(&soft()?, &soft()?).young;
    Ok((0.75 * mass * gravity / (young * radius.sqrt())).powf(2.0 / 3.0))
}
