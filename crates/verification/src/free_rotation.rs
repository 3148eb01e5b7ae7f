//! Rotation of an unsymmetrical body that nothing touches.
//!
//! The reference is Euler's equations by the classical fourth-order scheme with a fine step.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{asymmetric, run, settings, soft_surface, world};
use dem_solver::{DashpotMass, Placement, Template, World};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Spin at the start, about no special axis, rad/s.
const ASKEW: Vector3<f64> = Vector3::new(20.0, 40.0, 10.0);

/// Nearly about the middle axis, where the body turns over again and again, rad/s.
const UNSTABLE: Vector3<f64> = Vector3::new(0.3, 60.0, 0.2);

/// Turn at the start.
fn start() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, 0.2, -0.7)
}

/// The body with a spin (rad/s) and a time step (s).
fn spinning(spin: Vector3<f64>, time_step: f64) -> Result<World, CheckError> {
    let turn = start();
    let placement = Placement {
        spin: turn * spin,
        ..Placement::at_rest(0, Vector3::zeros(), turn)
    };
    world(
        settings(time_step, Vector3::zeros(), 3e-3),
        &soft_surface([1.0, 0.0, 0.0])?,
        vec![Template::new(&asymmetric()?, 0, DashpotMass::Body)],
        Vec::new(),
        &[placement],
    )
}

/// Angular momentum in the frame of the body by its orientation, kg m²/s.
fn own_momentum(world: &World) -> Vector3<f64> {
    let bodies = world.bodies();
    bodies.orientation[0].inverse() * bodies.angular_momentum[0]
}

/// Energy by the orientation, J.
fn energy(world: &World, moments: &Vector3<f64>) -> f64 {
    let momentum = own_momentum(world);
    0.5 * momentum.component_div(moments).dot(&momentum)
}

/// Orientation after 0.8 s by Euler's equations, from a spin (rad/s).
fn reference(moments: &Vector3<f64>, mut spin: Vector3<f64>) -> UnitQuaternion<f64> {
    let rates = |turn: Quaternion<f64>, spin: Vector3<f64>| {
        let torque = moments.component_mul(&spin).cross(&spin);
        (
            turn * Quaternion::from_imag(spin) * 0.5,
            torque.component_div(moments),
        )
    };
    let step = 1e-5;
    let mut turn = start().into_inner();
    for _ in 0..80_000 {
        let a = rates(turn, spin);
        let b = rates(turn + a.0 * (0.5 * step), spin + a.1 * (0.5 * step));
        let c = rates(turn + b.0 * (0.5 * step), spin + b.1 * (0.5 * step));
        let d = rates(turn + c.0 * step, spin + c.1 * step);
        turn += (a.0 + b.0 * 2.0 + c.0 * 2.0 + d.0) * (step / 6.0);
        spin += (a.1 + b.1 * 2.0 + c.1 * 2.0 + d.1) * (step / 6.0);
    }
    UnitQuaternion::new_normalize(turn)
}

/// A basis of these rows.
fn basis(tolerance: f64, reason: &'static str) -> Basis {
    Basis {
        check: "free-rotation",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(tolerance),
        reason,
        source: "Euler's equations, fourth order, step 1e-5 s",
    }
}

/// Conservation, order of convergence, and turning over.
pub(crate) fn free_rotation() -> Result<Vec<Row>, CheckError> {
    let moments = asymmetric()?.inertia();
    let expected = reference(&moments, ASKEW);
    let (mut drift, mut off, mut kept) = (Vec::new(), Vec::new(), 0.0_f64);
    for (time_step, n) in [(2e-4, 4000), (1e-4, 8000), (5e-5, 16_000)] {
        let mut world = spinning(ASKEW, time_step)?;
        let (momentum, before) = (world.bodies().angular_momentum[0], energy(&world, &moments));
        run(&mut world, n)?;
        let bodies = world.bodies();
        kept = kept.max((bodies.angular_momentum[0] - momentum).norm());
        drift.push((energy(&world, &moments) / before - 1.0).abs());
        off.push(bodies.orientation[0].angle_to(&expected));
    }
    let exact = basis(0.0, "nothing writes to it");
    let small = basis(1e-6, "second order at the step of a drum");
    let mut rows = vec![
        exact.row(
            "change of the angular momentum, 0.8 s",
            "kg m2/s",
            0.0,
            kept,
        ),
        small.row("drift of the energy, 0.8 s at 1e-4 s", "1", 0.0, drift[1]),
    ];
    let order = basis(0.2, "terms of third order at these steps");
    for (what, errors) in [("energy", drift), ("orientation", off)] {
        for (k, steps) in ["2e-4 to 1e-4 s", "1e-4 to 5e-5 s"].iter().enumerate() {
            let rate = (errors[k] / errors[k + 1]).log2();
            rows.push(order.row(format!("order of the {what}, {steps}"), "1", 2.0, rate));
        }
    }
    rows.extend(turning_over(&moments)?);
    Ok(rows)
}

/// A body that spins about its middle axis turns over when Euler's equations say.
fn turning_over(moments: &Vector3<f64>) -> Result<[Row; 2], CheckError> {
    let mut world = spinning(UNSTABLE, 1e-4)?;
    let (mut turns, mut upright) = (0_u32, true);
    for _ in 0..8000 {
        world.step()?;
        let about_middle = own_momentum(&world).y;
        turns += u32::from((about_middle > 0.0) != upright);
        upright = about_middle > 0.0;
    }
    let error = world.bodies().orientation[0].angle_to(&reference(moments, UNSTABLE));
    let count = basis(0.0, "a count");
    let unstable = basis(
        0.05,
        "the instability turns a truncation error of 1e-5 rad into some 0.01 rad",
    );
    let name = |what| format!("spun about the middle axis: {what}");
    Ok([
        count.row(name("turns over"), "1", 2.0, f64::from(turns)),
        unstable.row(name("angle off the orientation"), "rad", 0.0, error),
    ])
}
