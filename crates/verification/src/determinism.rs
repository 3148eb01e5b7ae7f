//! The same input gives the same bits.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{GRAVITY, box_of_planes, cluster, run, settings, soft_surface, world};
use dem_solver::{DashpotMass, Placement, Template, World};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Some fifty bodies in a box.
fn shaken() -> Result<World, CheckError> {
    let row = [-1.6e-3, 0.0, 1.6e-3].map(|x: f64| ([x, x * x * 200.0, 0.0], 1e-3));
    let template = Template::new(&cluster(&row)?, 0, DashpotMass::Sphere);
    let mut stream = Stream::new(5, "bits");
    let mut starts = Vec::new();
    for k in 0..27_u32 {
        let cell = Vector3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
        let [w, x, y, z] = stream.rotation();
        starts.push(Placement {
            template: 0,
            position: (cell - Vector3::repeat(1.0)) * 7e-3,
            orientation: UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
            velocity: Vector3::from_fn(|_, _| stream.between(-0.5, 0.5)),
            spin: Vector3::from_fn(|_, _| stream.between(-50.0, 50.0)),
        });
    }
    world(
        settings(2e-5, Vector3::y() * -GRAVITY, 2e-3),
        &soft_surface([0.4, 0.4, 0.05])?,
        vec![template],
        box_of_planes(0.0125),
        &starts,
    )
}

/// Number of coordinates, turns and spins whose bits differ.
fn n_different(a: &World, b: &World) -> f64 {
    let numbers = |world: &World| {
        let bodies = world.bodies();
        let vectors = bodies
            .position
            .iter()
            .chain(&bodies.spin)
            .chain(&bodies.velocity);
        let mut all: Vec<u64> = vectors
            .flat_map(|v| [v.x, v.y, v.z])
            .map(f64::to_bits)
            .collect();
        let turns = bodies.orientation.iter();
        all.extend(turns.flat_map(|q| [q.w, q.i, q.j, q.k]).map(f64::to_bits));
        all
    };
    let (a, b) = (numbers(a), numbers(b));
    a.iter().zip(&b).filter(|(a, b)| a != b).count() as f64
}

/// Runs twice, and continues from a stop.
pub(crate) fn same_bits() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "determinism",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(0.0),
        reason: "bits",
        source: "the same input",
    };
    let (mut one, mut two) = (shaken()?, shaken()?);
    run(&mut one, 3001)?;
    run(&mut two, 3001)?;
    Ok(vec![basis.row(
        "numbers that differ between two runs, 3001 steps",
        "1",
        0.0,
        n_different(&one, &two),
    )])
}
