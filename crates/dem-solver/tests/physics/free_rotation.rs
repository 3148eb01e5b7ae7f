//! Rotation of a body that nothing touches.
//!
//! The reference is Euler's equations by a fourth-order scheme with a fine step.

use crate::scene::{asymmetric_clump, run, settings, smooth, world};
use dem_solver::{DashpotMass, Placement, Template, World};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Angular velocity at the start about no special axis, rad/s.
const ASKEW: Vector3<f64> = Vector3::new(20.0, 40.0, 10.0);

/// Nearly about the middle axis, where the body turns over again and again, rad/s.
const UNSTABLE: Vector3<f64> = Vector3::new(0.3, 60.0, 0.2);

/// Time of the tests, s.
const END: f64 = 0.8;

fn spinning(spin: Vector3<f64>, time_step: f64) -> World {
    let template = Template::new(&asymmetric_clump(), 0, DashpotMass::Body);
    let turn = UnitQuaternion::from_euler_angles(0.3, 0.2, -0.7);
    let start = Placement {
        spin: turn * spin,
        ..Placement::at_rest(0, Vector3::zeros(), turn)
    };
    world(
        settings(time_step, Vector3::zeros()),
        &smooth(),
        vec![template],
        Vec::new(),
        &[start],
    )
}

/// Rotational energy from the orientation, J.
fn energy(world: &World) -> f64 {
    let bodies = world.bodies();
    let momentum = bodies.orientation[0].inverse() * bodies.angular_momentum[0];
    0.5 * momentum
        .component_div(&asymmetric_clump().inertia())
        .dot(&momentum)
}

/// Orientation at [`END`] by Euler's equations in the body frame, classical Runge-Kutta.
fn reference(spin: Vector3<f64>) -> UnitQuaternion<f64> {
    let moments = asymmetric_clump().inertia();
    let rates = |(turn, spin): (Quaternion<f64>, Vector3<f64>)| {
        let torque = moments.component_mul(&spin).cross(&spin);
        (
            turn * Quaternion::from_imag(spin) * 0.5,
            torque.component_div(&moments),
        )
    };
    let step = 1e-5;
    let mut state = (
        UnitQuaternion::from_euler_angles(0.3, 0.2, -0.7).into_inner(),
        spin,
    );
    for _ in 0..80_000 {
        let ahead = |rate: (Quaternion<f64>, Vector3<f64>), part: f64| {
            (
                state.0 + rate.0 * (part * step),
                state.1 + rate.1 * (part * step),
            )
        };
        let a = rates(state);
        let b = rates(ahead(a, 0.5));
        let c = rates(ahead(b, 0.5));
        let d = rates(ahead(c, 1.0));
        state.0 += (a.0 + b.0 * 2.0 + c.0 * 2.0 + d.0) * (step / 6.0);
        state.1 += (a.1 + b.1 * 2.0 + c.1 * 2.0 + d.1) * (step / 6.0);
    }
    UnitQuaternion::new_normalize(state.0)
}

/// Nothing writes to the angular momentum of a free body: it is the same to the last bit.
#[test]
fn free_body_keeps_its_angular_momentum_exactly() {
    let mut world = spinning(ASKEW, 1e-4);
    let before = world.bodies().angular_momentum[0];
    run(&mut world, 8000);
    assert_eq!(world.bodies().angular_momentum[0], before);
}

/// The energy error is of second order: half the step leaves a quarter of it; 0.2 of the order
/// covers higher terms. At the step of a drum (1e-4 s) it is below 1e-6 of the energy.
#[test]
fn energy_drift_of_a_free_body_is_of_second_order() {
    let drift = |time_step: f64, n: usize| {
        let mut world = spinning(ASKEW, time_step);
        let before = energy(&world);
        run(&mut world, n);
        (energy(&world) / before - 1.0).abs()
    };
    let errors = [drift(2e-4, 4000), drift(1e-4, 8000), drift(5e-5, 16_000)];
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.2, "order {order} of {errors:?}");
    }
    assert!(errors[1] < 1e-6, "{errors:?}");
}

/// The orientation follows Euler's equations with second order; 0.2 of the order covers the terms
/// of third order at these steps.
#[test]
fn orientation_converges_with_second_order_to_eulers_equations() {
    let expected = reference(ASKEW);
    let error = |time_step: f64, n: usize| {
        let mut world = spinning(ASKEW, time_step);
        run(&mut world, n);
        assert!((world.time() - END).abs() < 1e-9, "{}", world.time());
        world.bodies().orientation[0].angle_to(&expected)
    };
    let errors = [error(2e-4, 4000), error(1e-4, 8000), error(5e-5, 16_000)];
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.2, "order {order} of {errors:?}");
    }
}

/// A body spun about its middle axis turns over when Euler's equations say. The instability
/// magnifies the truncation error of 1e-5 rad to the order of 0.01 rad within these 0.8 s.
#[test]
fn body_spun_about_its_middle_axis_turns_over_in_time() {
    let mut world = spinning(UNSTABLE, 1e-4);
    let (mut turns, mut upright) = (0, true);
    for _ in 0..8000 {
        run(&mut world, 1);
        let bodies = world.bodies();
        let about_middle = (bodies.orientation[0].inverse() * bodies.angular_momentum[0]).y;
        turns += usize::from((about_middle > 0.0) != upright);
        upright = about_middle > 0.0;
    }
    assert!(turns == 2, "turned over {turns} times");
    let error = world.bodies().orientation[0].angle_to(&reference(UNSTABLE));
    assert!(error < 0.05, "orientation off by {error} rad");
}
