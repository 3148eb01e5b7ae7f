//! How long a hard contact lasts, and the time step that resolves it.
//!
//! The one rule for all who choose or foretell a time step: the runs of a scene and the price of a
//! filling.

mod bodies;
mod dashpots;

pub use bodies::duration_between;
pub use dashpots::{BodyDashpots, stable_share};

/// Least speed of a hard contact: a fall across half of a drum of 0.1 m, m/s.
///
/// Twice the speed shortens the step by 13 %.
pub const SPEED: f64 = 1.0;

/// Longest time step while seeds fall into place, as a share of the duration of a hard contact, where
/// a scene does not say otherwise (docs/time-step.md).
pub const STEP_SHARE: f64 = 0.36;

/// Duration of the collision of a sphere times speed over deepest overlap, `[Hertz1881]`.
const DURATION: f64 = 2.9432;

/// Conditions of an impact besides the shapes and masses of the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Effective modulus E*, Pa.
    pub young: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Dashpots that know the mass of the whole body; none if each sphere damps with its own.
    pub dashpots: Option<BodyDashpots>,
}

impl Impact {
    /// At [`SPEED`], with an effective modulus E* (Pa), of bodies whose spheres damp with their own masses.
    pub fn usual(young: f64) -> Self {
        Self {
            young,
            speed: SPEED,
            dashpots: None,
        }
    }
}

/// Duration of an elastic collision with a fixed plane, s.
///
/// `mass` is that felt at the contact, kg; `radius` that of the sphere, m.
///
/// # Formula
///
/// `t_c = 2.9432 (15 m / (16 sqrt(R) E*))^(2/5) v^(-1/5)`
///
/// # Source
///
/// Duration of an elastic collision `[Hertz1881]`.
pub fn duration(mass: f64, radius: f64, meeting: &Impact) -> f64 {
    let base = 15.0 * mass / (16.0 * radius.sqrt() * meeting.young);
    DURATION * base.powf(0.4) * meeting.speed.powf(-0.2)
}

/// Deepest overlap of that collision, m; arguments as in [`duration`].
///
/// # Formula
///
/// `d_0 = (15 m v² / (16 sqrt(R) E*))^(2/5)`: the energy of the spring, 8/15 E* sqrt(R) d^(5/2), is that of
/// the motion. `[Hertz1881]`
pub fn overlap(mass: f64, radius: f64, meeting: &Impact) -> f64 {
    let Impact { young, speed, .. } = meeting;
    (15.0 * mass * speed * speed / (16.0 * radius.sqrt() * young)).powf(0.4)
}

#[cfg(test)]
mod tests {
    use super::{Impact, duration};

    /// A mass on a Hertz spring, F = 4/3 E sqrt(R) d^(3/2), integrated through its collision by the
    /// velocity Verlet method: with 1e5 steps its error is about 1e-8, and that of the end, found to
    /// one step, 1e-5. The constant of the formula has five digits (3e-5).
    #[test]
    fn a_mass_on_a_hertz_spring_leaves_after_the_duration() {
        for speed in [1.0, 4.0] {
            leaves_after_the_duration(speed);
        }
    }

    /// The same at a speed, m/s.
    fn leaves_after_the_duration(speed: f64) {
        let (mass, radius, young) = (5e-5, 0.45e-3, 4e6);
        let meeting = Impact {
            speed,
            ..Impact::usual(young)
        };
        let expected = duration(mass, radius, &meeting);
        let pull =
            |depth: f64| -4.0 / 3.0 * young * radius.sqrt() * depth.max(0.0).powf(1.5) / mass;
        let step = expected / 1e5;
        let (mut depth, mut speed, mut steps) = (0.0, speed, 0_u32);
        while depth >= 0.0 {
            speed += 0.5 * step * pull(depth);
            depth += step * speed;
            speed += 0.5 * step * pull(depth);
            steps += 1;
        }
        let ratio = f64::from(steps) * step / expected;
        assert!((ratio - 1.0).abs() < 5e-5, "{ratio}");
    }
}
