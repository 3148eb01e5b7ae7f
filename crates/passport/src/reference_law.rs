//! The contact law of the reference integrator, in which each convention can be read in another way.

use crate::model::Contact;
use crate::reference::{Place, SPHERE, Touch};
use crate::resting::attraction;
use crate::variant::{History, SlidingLimit, Variant};
use contact_law::hertz_mindlin::damping_ratio;
use contact_law::material::EffectiveModuli;
use contact_law::rolling_spring_dashpot::{
    DAMPING_RATIO, RollingContact, RollingSpringDashpot, STIFFNESS_RATIO,
};
use contact_law::{NormalForceEnd, RollingLever, rolling_constant_torque};
use nalgebra::Vector3;
use scene::RollingLaw;

/// The law of a contact at this moment.
pub(crate) struct Law<'a> {
    variant: &'a Variant,
    contact: &'a Contact,
    kind: usize,
    pub(crate) contact_radius: f64,
    /// E* and G* with their factors, Pa.
    young: f64,
    shear: f64,
    /// `2 sqrt(5/6) b` with its factor.
    damping: f64,
}

impl<'a> Law<'a> {
    pub(crate) fn new(variant: &'a Variant, touch: &Touch, moduli: &EffectiveModuli) -> Self {
        let kind = touch.kind;
        let contact = &variant.model.contacts[kind];
        let stiffness = variant.stiffness[kind];
        let ratio = damping_ratio(contact.restitution);
        Self {
            variant,
            contact,
            kind,
            contact_radius: (touch.reduced_radius * touch.overlap).sqrt(),
            young: moduli.young * stiffness,
            shear: moduli.shear * stiffness * variant.tangential_stiffness,
            damping: 2.0 * (5.0_f64 / 6.0).sqrt() * ratio * variant.damping[kind],
        }
    }

    /// Elastic part of the normal force, N.
    fn elastic(&self, touch: &Touch) -> f64 {
        4.0 / 3.0 * self.young * self.contact_radius * touch.overlap
    }

    /// Normal force without attraction, N.
    pub(crate) fn normal(&self, touch: &Touch) -> f64 {
        let a = self.contact_radius;
        let approach = touch.velocity.dot(&touch.normal);
        let dashpot = self.damping * (2.0 * self.young * a * touch.reduced_mass).sqrt();
        let force = self.elastic(touch) + dashpot * approach;
        match self.variant.model.normal_force_end {
            NormalForceEnd::Clipped => force.max(0.0),
            NormalForceEnd::Attractive => force,
        }
    }

    /// Tangential force on i, N; moves the spring of the place.
    pub(crate) fn tangential(
        &self,
        touch: &Touch,
        normal: f64,
        place: &mut Place,
        step: f64,
    ) -> Vector3<f64> {
        let stiffness = 8.0 * self.shear * self.contact_radius;
        let dashpot = self.damping
            * self.variant.tangential_damping
            * (stiffness * touch.reduced_mass).sqrt();
        let in_plane = |v: Vector3<f64>| v - touch.normal * v.dot(&touch.normal);
        let sliding = in_plane(touch.velocity);
        let kept = in_plane(place.spring);
        let pressing = if self.variant.limit_by_size {
            normal.abs()
        } else {
            normal.max(0.0)
        };
        let limit = self.contact.static_friction * pressing;
        let shrunk = if place.radius > self.contact_radius {
            self.contact_radius / place.radius
        } else {
            1.0
        };
        // The spring as a force; `unit` turns it back into what the place remembers.
        let (spring, unit) = match self.variant.history {
            History::Displacement => ((kept + sliding * step) * stiffness, stiffness),
            History::Force => (kept + sliding * (stiffness * step), 1.0),
            History::Rescaled => ((kept * shrunk + sliding * step) * stiffness, stiffness),
            History::Off => (Vector3::zeros(), 1.0),
        };
        let within = |force: Vector3<f64>| force * (limit / force.norm()).min(1.0);
        let viscous = sliding * dashpot;
        let (spring, force) = match self.variant.limit {
            SlidingLimit::SpringThenSum => {
                let spring = within(spring);
                (spring, within(spring + viscous))
            }
            SlidingLimit::Spring if spring.norm() > limit => (within(spring), within(spring)),
            // Without a spring the limit has nothing but the dashpot to hold.
            SlidingLimit::Spring if self.variant.history == History::Off => {
                (spring, within(viscous))
            }
            SlidingLimit::Spring => (spring, spring + viscous),
            SlidingLimit::Sum => (spring, within(spring + viscous)),
            SlidingLimit::SumMovesSpring => {
                let force = within(spring + viscous);
                // Only a sum beyond the limit moves the spring.
                let moved = force != spring + viscous;
                (if moved { force - viscous } else { spring }, force)
            }
        };
        place.spring = spring / unit;
        if force.iter().all(|x| x.is_finite()) {
            -force
        } else {
            Vector3::zeros()
        }
    }

    /// Attraction, N.
    pub(crate) fn attraction(&self, touch: &Touch) -> f64 {
        attraction(self.contact, touch.reduced_radius, touch.overlap)
    }

    /// Torque of rolling resistance on i, N m; moves the spring of the place.
    pub(crate) fn rolling(
        &self,
        touch: &Touch,
        normal: f64,
        spring: &mut Vector3<f64>,
        step: f64,
    ) -> Vector3<f64> {
        let model = &self.variant.model;
        let normal = if self.variant.rolling_by_spring {
            self.elastic(touch)
        } else {
            normal.max(0.0)
        };
        let coefficient = self.contact.rolling_friction * self.variant.rolling[self.kind];
        let of_sphere = model.radius_m - 0.5 * touch.overlap;
        let lever = |arm: &Vector3<f64>| match model.rolling_lever {
            RollingLever::Centre => arm.norm(),
            RollingLever::Sphere => of_sphere,
        };
        let (a, b) = (lever(&touch.arms[0]), lever(&touch.arms[1]));
        let (lever, inertia) = if self.kind == 0 {
            // Two bodies of one mass: half of the reduced mass at the lever of each.
            let moment = |l: f64| 2.0 * touch.reduced_mass * l * l;
            let (i, j) = (moment(a), moment(b));
            (a * b / (a + b), i * j / (i + j))
        } else {
            (a, touch.reduced_mass * a * a)
        };
        if model.rolling_law == RollingLaw::ConstantTorque {
            let twist = touch.normal * touch.relative_spin.dot(&touch.normal);
            let spin = if self.variant.rolling_without_twist {
                touch.relative_spin - twist
            } else {
                touch.relative_spin
            };
            return rolling_constant_torque::torque(coefficient, normal, lever, spin);
        }
        let Ok(law) = RollingSpringDashpot::new(coefficient, DAMPING_RATIO, STIFFNESS_RATIO) else {
            return Vector3::zeros();
        };
        let contact = RollingContact {
            normal_force: normal,
            reduced_radius: lever,
            tangential_stiffness: 8.0 * self.shear * self.contact_radius,
            reduced_inertia: (1.0 + SPHERE) * inertia,
            normal: touch.normal,
            relative_spin: touch.relative_spin,
        };
        let found = law.torque(&contact, *spring, step);
        *spring = found.spring;
        found.torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::beads;

    /// A spin of 4 rad/s along the plane and 3 about the normal: a torque of `mu_r F_n R` points against the whole spin, or against the
    /// part along the plane alone, and has that size either way.
    #[test]
    fn rolling_without_twist_leaves_the_spin_about_the_normal_free() {
        let model = beads();
        let touch = Touch {
            normal: Vector3::y(),
            overlap: 1e-6,
            reduced_radius: model.radius_m,
            reduced_mass: 1e-5,
            arms: [Vector3::new(0.0, -model.radius_m, 0.0), Vector3::zeros()],
            velocity: Vector3::zeros(),
            relative_spin: Vector3::new(4.0, 3.0, 0.0),
            kind: 1,
        };
        let moduli = model.moduli();
        let own = Variant::nominal(&model);
        let mut without = own.clone();
        without.rolling_without_twist = true;
        let size = 0.08 * 0.5 * (model.radius_m - 0.5e-6);
        for (variant, direction) in [(&own, [0.8, 0.6, 0.0]), (&without, [1.0, 0.0, 0.0])] {
            let law = Law::new(variant, &touch, &moduli[1]);
            let torque = law.rolling(&touch, 0.5, &mut Vector3::zeros(), 1e-6);
            let apart = torque + Vector3::from(direction) * size;
            assert!(apart.norm() < 1e-12 * size, "{torque}");
        }
    }
}
