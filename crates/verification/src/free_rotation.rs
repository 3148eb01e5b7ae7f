//! Rotation of an unsymmetrical body that nothing touches.
//!
//! The reference is Euler's equations by the classical fourth-order scheme with a fine step.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{run, settings, soft_surface, world};
use dem_solver::{DashpotMass, Placement, Template, World};
use geometry::clump::{Clump, MassProperties, Sphere};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Spin at the start, about no special axis, rad/s.
const SPIN: Vector3<f64> = Vector3::new(20.0, 40.0, 10.0);

/// Duration, s.
const END: f64 = 0.8;

/// A body of three different moments of inertia.
fn body() -> Result<Clump, CheckError> {
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

/// Turn at the start.
fn start() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, 0.2, -0.7)
}

/// The body after [`END`] with a time step (s).
fn spun(time_step: f64) -> Result<World, CheckError> {
    let turn = start();
    let placement = Placement {
        spin: turn * SPIN,
        ..Placement::at_rest(0, Vector3::zeros(), turn)
    };
    let mut world = world(
        settings(time_step, Vector3::zeros(), 3e-3),
        &soft_surface([1.0, 0.0, 0.0])?,
        vec![Template::new(&body()?, 0, DashpotMass::Body)],
        Vec::new(),
        &[placement],
    )?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few thousand"
    )]
    run(&mut world, (END / time_step).round() as usize)?;
    Ok(world)
}

/// Energy by the orientation, J.
fn energy(moments: &Vector3<f64>, turn: &UnitQuaternion<f64>, momentum: &Vector3<f64>) -> f64 {
    let momentum = turn.inverse() * momentum;
    0.5 * momentum.component_div(moments).dot(&momentum)
}

/// Orientation at [`END`] by Euler's equations.
fn reference(moments: &Vector3<f64>) -> UnitQuaternion<f64> {
    let rates = |turn: Quaternion<f64>, spin: Vector3<f64>| {
        let torque = moments.component_mul(&spin).cross(&spin);
        (
            turn * Quaternion::from_imag(spin) * 0.5,
            torque.component_div(moments),
        )
    };
    let step = 1e-5;
    let (mut turn, mut spin) = (start().into_inner(), SPIN);
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

/// Conservation and order of convergence.
pub(crate) fn free_rotation() -> Result<Vec<Row>, CheckError> {
    let moments = body()?.inertia();
    let turn = start();
    let momentum = turn * moments.component_mul(&SPIN);
    let before = energy(&moments, &turn, &momentum);
    let expected = reference(&moments);
    let (mut drift, mut off, mut kept) = (Vec::new(), Vec::new(), 0.0_f64);
    for time_step in [2e-4, 1e-4, 5e-5] {
        let world = spun(time_step)?;
        let bodies = world.bodies();
        let now = bodies.angular_momentum[0];
        kept = kept.max((now - momentum).norm() / momentum.norm());
        drift.push((energy(&moments, &bodies.orientation[0], &now) / before - 1.0).abs());
        off.push(bodies.orientation[0].angle_to(&expected));
    }
    let basis = |tolerance, reason| Basis {
        check: "free-rotation",
        kind: Kind::Analytical,
        tolerance,
        reason,
        source: "Euler's equations, fourth order, step 1e-5 s",
    };
    let exact = basis(Tolerance::Absolute(1e-14), "rounding of the start only");
    let order = basis(
        Tolerance::Absolute(0.2),
        "terms of third order at these steps",
    );
    let small = basis(
        Tolerance::Absolute(1e-6),
        "second order at the step of a drum",
    );
    let rate = |errors: &[f64], k: usize| (errors[k] / errors[k + 1]).log2();
    Ok(vec![
        exact.row("change of the angular momentum, 0.8 s", "1", 0.0, kept),
        small.row("drift of the energy, 0.8 s at 1e-4 s", "1", 0.0, drift[1]),
        order.row(
            "order of the energy, 2e-4 to 1e-4 s",
            "1",
            2.0,
            rate(&drift, 0),
        ),
        order.row(
            "order of the energy, 1e-4 to 5e-5 s",
            "1",
            2.0,
            rate(&drift, 1),
        ),
        order.row(
            "order of the orientation, 2e-4 to 1e-4 s",
            "1",
            2.0,
            rate(&off, 0),
        ),
        order.row(
            "order of the orientation, 1e-4 to 5e-5 s",
            "1",
            2.0,
            rate(&off, 1),
        ),
    ])
}
