//! One contact: from geometry and motion to force and torques.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use contact_law::{
    ContactGeometry, HertzMindlin, Material, NormalForceEnd, PairParameters, constant_attraction,
    material, rolling_constant_torque,
};
use nalgebra::Vector3;

/// Everything that decides the contact between two kinds of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interaction {
    /// Elastic, damping and sliding part.
    law: HertzMindlin,
    /// Coefficient of rolling friction.
    rolling_friction: f64,
    /// Attraction while touching, N.
    attraction: f64,
}

/// What a user states about two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InteractionSettings {
    /// Materials of the two sides.
    pub materials: [Material; 2],
    /// Restitution and friction.
    pub parameters: PairParameters,
    /// Attraction of one touching pair of spheres, N.
    pub attraction: f64,
    /// What happens when the dashpot would pull.
    pub end: NormalForceEnd,
}

impl Interaction {
    /// Prepares an interaction.
    ///
    /// # Errors
    ///
    /// Contact parameters outside their range, a negative attraction.
    pub fn new(settings: &InteractionSettings) -> Result<Self, contact_law::Error> {
        let moduli = material::effective_moduli(&settings.materials[0], &settings.materials[1]);
        Ok(Self {
            law: HertzMindlin::new(moduli, &settings.parameters, settings.end)?,
            rolling_friction: settings.parameters.rolling_friction,
            attraction: constant_attraction::check(settings.attraction)?,
        })
    }
}

impl Interaction {
    /// Elastic, damping and sliding part.
    pub(crate) fn law(&self) -> &HertzMindlin {
        &self.law
    }

    /// Attraction while touching, N.
    pub(crate) fn attraction(&self) -> f64 {
        self.attraction
    }
}

/// Position and motion of a body that takes part in a contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mover {
    /// Centre of mass, m.
    pub(crate) position: Vector3<f64>,
    /// Velocity, m/s.
    pub(crate) velocity: Vector3<f64>,
    /// Angular velocity, rad/s.
    pub(crate) spin: Vector3<f64>,
}

/// Two touching spheres of two bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpherePair {
    /// From the centre of sphere i to the centre of sphere j, m.
    pub(crate) between: Vector3<f64>,
    /// From the centre of body i to the centre of sphere i, m.
    pub(crate) offset_i: Vector3<f64>,
    /// From the centre of body j to the centre of sphere j, m.
    pub(crate) offset_j: Vector3<f64>,
    /// Velocity of body i minus that of body j, m/s.
    pub(crate) velocity: Vector3<f64>,
    /// Angular velocities of both bodies, rad/s.
    pub(crate) spins: [Vector3<f64>; 2],
    /// Tangential displacement of the step before, m.
    pub(crate) slip: Vector3<f64>,
    /// Radii of both spheres, m.
    pub(crate) radii: [f64; 2],
    /// Masses that both spheres bring into the dashpots, kg.
    pub(crate) dashpot_masses: [f64; 2],
}

/// A sphere that touches a wall.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphereWall {
    /// Unit vector from the sphere towards the wall.
    pub(crate) normal: Vector3<f64>,
    /// From the centre of the body to the contact point, m.
    pub(crate) arm: Vector3<f64>,
    /// Velocity of the wall's surface at the contact point, m/s.
    pub(crate) wall_velocity: Vector3<f64>,
    /// Angular velocity of the wall, rad/s.
    pub(crate) wall_spin: Vector3<f64>,
    /// Overlap, radius and dashpot mass.
    pub(crate) geometry: ContactGeometry,
}

/// Force and torques of a contact.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Effect {
    /// Force on body i, N; the other side feels the opposite.
    pub(crate) force: Vector3<f64>,
    /// Torque on body i about its centre, N m.
    pub(crate) torque_i: Vector3<f64>,
    /// Torque on body j about its centre, N m.
    pub(crate) torque_j: Vector3<f64>,
    /// Tangential displacement after the step, m.
    pub(crate) slip: Vector3<f64>,
}

impl Interaction {
    /// Force and torques between two spheres, for one step of `time_step` (s).
    ///
    /// The displacement of the step before is first projected on the present contact plane; its
    /// length changes by the square of the angle of one step only. No branch depends on the
    /// state, so that a loop over contacts can be vectorised.
    #[inline(always)]
    pub(crate) fn between_spheres(&self, pair: &SpherePair, time_step: f64) -> Effect {
        let distance = pair.between.norm();
        let normal = pair.between * (1.0 / distance);
        let [radius_i, radius_j] = pair.radii;
        let sum = radius_i + radius_j;
        let [mass_i, mass_j] = pair.dashpot_masses;
        let overlap = sum - distance;
        let arm_i = pair.offset_i + normal * (radius_i - 0.5 * overlap);
        let arm_j = pair.offset_j - normal * (radius_j - 0.5 * overlap);
        let relative = pair.velocity + pair.spins[0].cross(&arm_i) - pair.spins[1].cross(&arm_j);
        let geometry = ContactGeometry {
            overlap,
            reduced_radius: radius_i * radius_j / sum,
            reduced_mass: mass_i * mass_j / (mass_i + mass_j),
        };
        let approach = relative.dot(&normal);
        let sliding = relative - normal * approach;
        let kept = pair.slip - normal * pair.slip.dot(&normal);
        let force = self
            .law
            .force(&geometry, approach, sliding, kept, time_step);
        let on_i = force.tangential - normal * (force.normal - self.attraction);
        let rolling = if self.rolling_friction > 0.0 {
            let inverse_arm = 1.0 / arm_i.norm() + 1.0 / arm_j.norm();
            self.rolling(
                force.normal,
                1.0 / inverse_arm,
                pair.spins[0] - pair.spins[1],
            )
        } else {
            Vector3::zeros()
        };
        Effect {
            force: on_i,
            torque_i: arm_i.cross(&on_i) + rolling,
            torque_j: -arm_j.cross(&on_i) - rolling,
            slip: force.slip,
        }
    }

    /// Force and torque of a wall on a sphere of `body`; `slip` as in [`SpherePair`].
    #[inline(always)]
    pub(crate) fn at_wall(
        &self,
        contact: &SphereWall,
        body: &Mover,
        slip: Vector3<f64>,
        time_step: f64,
    ) -> Effect {
        let normal = contact.normal;
        let relative = body.velocity + body.spin.cross(&contact.arm) - contact.wall_velocity;
        let approach = relative.dot(&normal);
        let sliding = relative - normal * approach;
        let kept = slip - normal * slip.dot(&normal);
        let force = self
            .law
            .force(&contact.geometry, approach, sliding, kept, time_step);
        let on_body = force.tangential - normal * (force.normal - self.attraction);
        let lever = contact.arm.norm();
        let rolling = self.rolling(force.normal, lever, body.spin - contact.wall_spin);
        Effect {
            force: on_body,
            torque_i: contact.arm.cross(&on_body) + rolling,
            torque_j: Vector3::zeros(),
            slip: force.slip,
        }
    }

    /// Torque of rolling resistance, N m.
    #[inline(always)]
    fn rolling(&self, normal_force: f64, lever: f64, spin: Vector3<f64>) -> Vector3<f64> {
        let load = normal_force.max(0.0);
        rolling_constant_torque::torque(self.rolling_friction, load, lever, spin)
    }
}

#[cfg(test)]
mod tests {
    use super::{Interaction, InteractionSettings, Mover, SpherePair, SphereWall};
    use contact_law::{ContactGeometry, Material, NormalForceEnd, PairParameters};
    use nalgebra::Vector3;

    /// A normal in no special direction.
    const NORMAL: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);

    /// A slip in the plane of contact, m.
    const SLIP: Vector3<f64> = Vector3::new(0.8e-7, 2e-7, -0.6e-7);

    fn interaction() -> Interaction {
        let parameters = PairParameters {
            restitution: 0.5,
            static_friction: 0.5,
            rolling_friction: 0.1,
        };
        let materials = [Material::new(0.25, 4e6).unwrap(); 2];
        let end = NormalForceEnd::Clipped;
        let settings = InteractionSettings {
            materials,
            parameters,
            attraction: 1e-5,
            end,
        };
        Interaction::new(&settings).unwrap()
    }

    /// What a slip keeps of an older contact plane does not push along the present normal: the
    /// part of the slip along the normal changes nothing. Rounding of 1e-16 of the force only.
    #[test]
    fn slip_counts_only_in_the_plane_of_contact() {
        let [plain, tilted] = [SLIP, SLIP + NORMAL * 5e-7].map(|slip| {
            let pair = SpherePair {
                between: NORMAL * 1.99e-3,
                offset_i: Vector3::new(1e-3, 2e-3, 0.0),
                offset_j: Vector3::new(0.0, -1e-3, 1e-3),
                velocity: Vector3::new(0.01, 0.02, -0.01),
                spins: [Vector3::new(1.0, 2.0, 3.0), Vector3::new(-2.0, 0.0, 1.0)],
                slip,
                radii: [1e-3, 1e-3],
                dashpot_masses: [4e-6, 4e-6],
            };
            interaction().between_spheres(&pair, 1e-6)
        });
        let error = (plain.force - tilted.force).norm() / plain.force.norm();
        assert!(error < 1e-12, "force between spheres changes by {error}");
        assert!(
            (plain.slip - tilted.slip).norm() < 1e-12 * plain.slip.norm(),
            "slip changes"
        );

        let body = Mover {
            position: Vector3::zeros(),
            velocity: Vector3::new(0.01, 0.02, -0.01),
            spin: Vector3::new(1.0, 2.0, 3.0),
        };
        let contact = SphereWall {
            normal: NORMAL,
            arm: NORMAL * 1e-3,
            wall_velocity: Vector3::zeros(),
            wall_spin: Vector3::zeros(),
            geometry: ContactGeometry {
                overlap: 1e-5,
                reduced_radius: 1e-3,
                reduced_mass: 4e-6,
            },
        };
        let [plain, tilted] = [SLIP, SLIP + NORMAL * 5e-7]
            .map(|slip| interaction().at_wall(&contact, &body, slip, 1e-6));
        let error = (plain.force - tilted.force).norm() / plain.force.norm();
        assert!(error < 1e-12, "force of a wall changes by {error}");
    }
}
