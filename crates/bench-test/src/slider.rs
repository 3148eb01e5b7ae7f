//! The slider: seeds glued to a sled that is pulled over a plate; the pull over the weight is the
//! coefficient of friction.

use crate::drop::plate;
use crate::{Error, settings};
use clump::{Clump, MassProperties, Sphere};
use dem_solver::{DashpotMass, Placement, Template, World};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use random_stream::Stream;
use scene::BenchParts;

/// Seeds along each side of the sled.
const SIDE: usize = 3;

/// Speed of the pull, m/s. The study pulls with 100 mm/min; Coulomb's friction does not depend on it,
/// and six times the speed saves that part of the work.
const SPEED: f64 = 0.01;

/// Time of loading before, and of measuring while sliding, s.
const TIMES: [f64; 2] = [0.15, 0.6];

/// On what the sled slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// A smooth plate of the bench's plate material.
    Plate,
    /// A plate covered with glued seeds.
    Seeds,
}

/// Friction of `repeats` pulls, each with other orientations of the glued seeds: mean pull over weight
/// while sliding.
///
/// The seeds lie flat (their shortest axis upright), turned at random about the vertical. The sled
/// cannot turn: it is held by a tractor, as on the bench. It weighs ten times its seeds.
///
/// # Errors
///
/// A body that cannot be made, a solver that stops.
pub fn slider(
    parts: &BenchParts,
    base: Base,
    repeats: usize,
    seed: u64,
) -> Result<Vec<f64>, Error> {
    let mut stream = Stream::new(seed, "slider test");
    (0..repeats)
        .map(|_| one(parts, base, &mut stream))
        .collect()
}

/// One pull.
fn one(parts: &BenchParts, base: Base, stream: &mut Stream) -> Result<f64, Error> {
    let seed = &parts.body.clump;
    let sled = glued(parts, SIDE, SIDE, stream);
    let mass = 10.0 * seed.mass() * (SIDE * SIDE) as f64;
    let (low, high) = heights(&sled);
    let mut templates = vec![body(&sled, mass, 0)?];
    let mut starts = Vec::new();
    let walls = match base {
        Base::Plate => vec![plate()],
        Base::Seeds => Vec::new(),
    };
    let mut height = -low;
    if base == Base::Seeds {
        let ground = glued(parts, SIDE + 4, SIDE + 2, stream);
        let (_, top) = heights(&ground);
        // Too heavy to move.
        templates.push(body(&ground, 1e12, 0)?);
        height += top;
        starts.push(Placement::at_rest(
            1,
            Vector3::zeros(),
            UnitQuaternion::identity(),
        ));
    }
    let at = Vector3::y() * (height + 1e-5);
    starts.insert(0, Placement::at_rest(0, at, UnitQuaternion::identity()));
    let mut world = World::new(
        settings(parts, Vector3::zeros()),
        templates,
        parts.interactions.clone(),
        walls,
        &starts,
    )?;
    let weight = mass * parts.gravity;
    // A spring that the friction stretches by a tenth of the height of the sled, nearly critically
    // damped.
    let stiffness = 10.0 * weight / (high - low);
    let damping = 2.0 * (stiffness * mass).sqrt();
    let (mut sum, mut n) = (0.0, 0_u32);
    while world.time() < TIMES[0] + TIMES[1] {
        let drive = SPEED * world.time();
        let mut pull = 0.0;
        world.step_with(|bodies| {
            let velocity = bodies.velocity[0];
            pull = stiffness * (drive - bodies.position[0].x) + damping * (SPEED - velocity.x);
            bodies.force[0] += Vector3::new(pull, -weight, 0.0);
            // The tractor holds the sled upright and straight; up and down it is damped a little, as
            // a sled of ten seeds' weight would be by its seeds.
            bodies.force[0].y -= damping * velocity.y;
            bodies.force[0].z = 0.0;
            bodies.torque[0] = Vector3::zeros();
        })?;
        if world.time() > TIMES[0] {
            sum += pull / weight;
            n += 1;
        }
    }
    Ok(sum / f64::from(n.max(1)))
}

/// Spheres of seeds that lie side by side, centred on the origin.
fn glued(parts: &BenchParts, n_x: usize, n_z: usize, stream: &mut Stream) -> Vec<Sphere> {
    let seed = &parts.body.clump;
    let spacing = 2.0 * seed.bounding_radius();
    let mut spheres = Vec::new();
    for i in 0..n_x {
        for k in 0..n_z {
            // The principal axes come in the order of the moments: z is across the flat side.
            let flat =
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
            let angle = stream.between(0.0, std::f64::consts::TAU);
            let about = Quaternion::new((0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0);
            let turn = UnitQuaternion::new_normalize(about) * flat;
            let place = |index: usize, n: usize| (index as f64 - 0.5 * (n as f64 - 1.0)) * spacing;
            let at = Vector3::new(place(i, n_x), 0.0, place(k, n_z));
            spheres.extend(parts.body.outer.spheres().iter().map(|s| Sphere {
                centre: at + turn * s.centre,
                radius: s.radius,
            }));
        }
    }
    spheres
}

/// Lowest and highest point of spheres, m.
fn heights(spheres: &[Sphere]) -> (f64, f64) {
    let low = spheres.iter().map(|s| s.centre.y - s.radius);
    let high = spheres.iter().map(|s| s.centre.y + s.radius);
    (
        low.fold(f64::INFINITY, f64::min),
        high.fold(f64::NEG_INFINITY, f64::max),
    )
}

/// A rigid body of these spheres that keeps the axes in which they are given; mass in kg.
fn body(spheres: &[Sphere], mass: f64, material: usize) -> Result<Template, Error> {
    let size = spheres.iter().map(|s| s.centre.norm()).fold(0.0, f64::max);
    // Three different moments in rising order leave the axes alone; the body does not turn.
    let moments = Vector3::new(1.0, 1.1, 1.2) * (mass * size * size);
    let properties = MassProperties {
        mass,
        centre: Vector3::zeros(),
        inertia: Matrix3::from_diagonal(&moments),
    };
    let clump = Clump::new(spheres, &properties)?;
    Ok(Template::new(&clump, material, DashpotMass::Sphere))
}
