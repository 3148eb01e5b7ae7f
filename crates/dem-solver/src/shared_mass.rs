//! Dashpots that know the whole body: the mass that the contacts with one partner move, shared among them.
//!
//! # Formula
//!
//! A push along the unit vector n at an arm r from the centre of a body of mass m and moments of inertia I moves the mass
//! `M(n, r x n)`, and the contacts of two bodies, with radii a, normals and arms, together the mass `M_0`:
//!
//! ```text
//! 1/M(f, t) = |f|²/m + t I⁻¹ t
//! a_k       = sqrt(R*_k d_k)     w_k = a_k / sum(a)
//! M_0       = M(sum(w_k n_k), sum(w_k r_k x n_k))
//! M_k       = min(w_k M_0, M(n_k, r_k x n_k))
//! m_k       = ((1 - s) sqrt(m_sphere) + s sqrt(M_k))²
//! ```
//!
//! s is the share of the damping of the whole body, 0 to 1, and `m_k` takes the place of the mass of the sphere: the dashpot goes
//! with the root of the mass, so that s mixes the dashpots of sphere and body. The mass of two bodies is `1/(1/m_i + 1/m_j)`.
//!
//! One contact has the mass `M(n, r x n)` that its normal impulse moves, so that the coefficient of restitution holds for the normal
//! velocity at the point of contact, however the body is turned. Several contacts that push one way are one as stiff as all of
//! them: stiffness goes with a, the dashpot with `sqrt(a m)`, and `sum(sqrt(a_k w_k)) = sqrt(sum(a))`. Two bodies that meet
//! face to face rebound alike, however many spheres the face is made of. Contacts at right angles share nothing, since
//! `M_0` rises as their pushes cancel; none gets more than it moves alone. A contact that begins takes its share from 0 on,
//! without a jump.
//!
//! # Source
//!
//! `M` is the mass of the impulse of a rigid body at one point `[Stronge2000, chapter 4]`. `[Berry2023]` lists the errors of two usual
//! choices: a dashpot that knows only the mass of its sphere damps too little, and several that know the mass of the whole body damp
//! too much. Weights and least are ours.

#![expect(
    clippy::inline_always,
    reason = "called in the force loop, which is vectorised only when inlined"
)]

use crate::template::Template;
use nalgebra::{Matrix3, Vector3};

/// Least share: a contact that holds by liquid alone has no radius, and needs a mass above 0.
const LEAST: f64 = 1e-9;

/// A body with its orientation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turned<'a> {
    /// Its type.
    pub(crate) template: &'a Template,
    /// From its principal frame to the world.
    pub(crate) rotation: &'a Matrix3<f64>,
}

impl Turned<'_> {
    /// One over the mass that a force and its torque about the centre move, `1/M(f, t)`, 1/kg for a force of 1.
    #[inline(always)]
    fn inverse_mass(&self, force: &Vector3<f64>, torque: &Vector3<f64>) -> f64 {
        let own = self.rotation.tr_mul(torque);
        force.norm_squared() * self.template.inverse_mass
            + own.component_mul(&own).dot(&self.template.inverse_inertia)
    }
}

/// A contact of N bodies: two that meet, or one at a wall.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch<const N: usize> {
    /// Radius of the contact, m; 0 if nothing is pressed.
    pub(crate) radius: f64,
    /// Unit normal, in either direction.
    pub(crate) normal: Vector3<f64>,
    /// From the centre of each body to the point of contact, m.
    pub(crate) arms: [Vector3<f64>; N],
}

/// How bodies share their masses among the contacts of the same two.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shares<'a, const N: usize> {
    bodies: [Turned<'a>; N],
    /// Sum of the radii of all contacts, m.
    total: f64,
    /// `1/M_0` of each body, 1/kg.
    together: [f64; N],
}

impl<'a, const N: usize> Shares<'a, N> {
    /// Of the contacts of the same bodies; none if no dashpot knows more than its sphere.
    #[inline(always)]
    pub(crate) fn new(
        bodies: [Turned<'a>; N],
        touches: impl Iterator<Item = Touch<N>>,
    ) -> Option<Self> {
        if bodies.iter().all(|b| b.template.whole_damping == 0.0) {
            return None;
        }
        let (mut total, mut force, mut torques) = (0.0, Vector3::zeros(), [Vector3::zeros(); N]);
        for touch in touches {
            let push = touch.normal * touch.radius;
            total += touch.radius;
            force += push;
            for (torque, arm) in torques.iter_mut().zip(&touch.arms) {
                *torque += arm.cross(&push);
            }
        }
        let square = total * total;
        let together =
            std::array::from_fn(|k| bodies[k].inverse_mass(&force, &torques[k]) / square);
        Some(Self {
            bodies,
            total,
            together,
        })
    }

    /// Masses in the dashpot of a contact (kg) instead of those of its spheres (kg).
    #[inline(always)]
    pub(crate) fn masses(&self, touch: &Touch<N>, of_spheres: [f64; N]) -> [f64; N] {
        let share = (touch.radius / self.total).max(LEAST);
        std::array::from_fn(|k| {
            let body = &self.bodies[k];
            let torque = touch.arms[k].cross(&touch.normal);
            let alone = 1.0 / body.inverse_mass(&touch.normal, &torque);
            // Where only bridges hold, nothing is shared: the total is 0, and no number is less than `alone`.
            let mass = alone.min(share / self.together[k]);
            let whole = body.template.whole_damping;
            let root = (1.0 - whole) * of_spheres[k].sqrt() + whole * mass.sqrt();
            root * root
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Shares, Touch, Turned};
    use crate::template::{DashpotMass, Template};
    use geometry::clump::{Clump, MassProperties, Sphere};
    use nalgebra::{Matrix3, Rotation3, Vector3};

    const MASS: f64 = 2e-5;
    const MOMENTS: [f64; 3] = [1e-11, 2e-11, 3e-11];
    /// Mass of a touching sphere, kg.
    const OF_SPHERE: f64 = 1e-6;

    /// A body of two spheres with a share of the damping of the whole.
    fn body(share: f64) -> Template {
        let spheres = [-1e-3, 1e-3].map(|x| Sphere {
            centre: Vector3::new(x, 0.0, 0.0),
            radius: 1e-3,
        });
        let properties = MassProperties {
            mass: MASS,
            centre: Vector3::zeros(),
            inertia: Matrix3::from_diagonal(&Vector3::from(MOMENTS)),
        };
        let clump = Clump::new(&spheres, &properties).unwrap();
        Template::new(&clump, 0, DashpotMass::Sphere).with_whole_damping(share)
    }

    /// A contact by its radius, normal and arm.
    fn touch(radius: f64, normal: [f64; 3], arm: [f64; 3]) -> Touch<1> {
        Touch {
            radius,
            normal: Vector3::from(normal).normalize(),
            arms: [Vector3::from(arm)],
        }
    }

    /// The masses of some contacts of a body that is not turned, kg.
    fn masses(share: f64, touches: &[Touch<1>]) -> Vec<f64> {
        let (template, rotation) = (body(share), Matrix3::identity());
        let turned = Turned {
            template: &template,
            rotation: &rotation,
        };
        let shares = Shares::new([turned], touches.iter().copied()).unwrap();
        let own = touches.iter().map(|t| shares.masses(t, [OF_SPHERE])[0]);
        own.collect()
    }

    fn close(got: f64, expected: f64) {
        assert!((got / expected - 1.0).abs() < 1e-12, "{got} for {expected}");
    }

    /// A push along y at 2 mm on x turns the body about z: `1/M = 1/m + x²/I_z`; with the body turned by a quarter about y its axis x
    /// lies along -z of the world, and it is turned about x. Rounding only.
    #[test]
    fn one_contact_has_the_mass_that_its_push_moves() {
        let expected = 1.0 / (1.0 / MASS + 4e-6 / MOMENTS[2]);
        close(
            masses(1.0, &[touch(1e-5, [0.0, 1.0, 0.0], [2e-3, 0.0, 0.0])])[0],
            expected,
        );
        let template = body(1.0);
        let quarter = Rotation3::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
        let turned = Turned {
            template: &template,
            rotation: quarter.matrix(),
        };
        let at = touch(1e-5, [0.0, 1.0, 0.0], [0.0, 0.0, -2e-3]);
        let shares = Shares::new([turned], std::iter::once(at)).unwrap();
        close(shares.masses(&at, [OF_SPHERE])[0], expected);
    }

    /// Two contacts on both sides of the centre that push one way are one with the whole mass: the dashpot goes with
    /// `sqrt(a m)`. Rounding only.
    #[test]
    fn contacts_that_push_one_way_are_one() {
        let touches = [(1e-5, 1.5e-3), (3e-5, -0.5e-3)]
            .map(|(radius, x)| touch(radius, [0.0, 1.0, 0.0], [x, 0.0, 0.0]));
        let found = masses(1.0, &touches);
        let together: f64 = touches
            .iter()
            .zip(&found)
            .map(|(t, m)| (t.radius * m).sqrt())
            .sum();
        close(together, (4e-5 * MASS).sqrt());
        close(found[1], 3.0 * found[0]);
    }

    /// Pushes through the centre at right angles share nothing, and neither do opposite ones, whose sum is none: each has the
    /// whole mass. Rounding only.
    #[test]
    fn contacts_that_push_other_ways_do_not_share() {
        for second in [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]] {
            let touches = [
                touch(1e-5, [1.0, 0.0, 0.0], [0.0; 3]),
                touch(1e-5, second, [0.0; 3]),
            ];
            for mass in masses(1.0, &touches) {
                close(mass, MASS);
            }
        }
    }

    /// The dashpots of sphere and body mix: at a quarter their roots do. Nothing is shared where the share is 0, and a contact
    /// that only a bridge of liquid holds, without a radius, still has a mass.
    #[test]
    fn the_share_mixes_dashpots() {
        let at = touch(1e-5, [1.0, 0.0, 0.0], [0.0; 3]);
        let root = 0.75 * OF_SPHERE.sqrt() + 0.25 * MASS.sqrt();
        close(masses(0.25, &[at])[0], root * root);
        let template = body(0.0);
        let rotation = Matrix3::identity();
        let turned = Turned {
            template: &template,
            rotation: &rotation,
        };
        assert!(Shares::new([turned], std::iter::once(at)).is_none());
        let bridge = touch(0.0, [1.0, 0.0, 0.0], [0.0; 3]);
        close(masses(1.0, &[bridge])[0], MASS);
        assert!(masses(1.0, &[at, bridge])[1] > 0.0);
    }
}
