//! One contact: from geometry and motion to force and torques.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::interaction::Interaction;
use crate::shared_mass::{Shares, Touch};
use contact_law::rolling_spring_dashpot::RollingContact;
use contact_law::{ContactGeometry, rolling_constant_torque};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What a contact remembers from one step to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Memory {
    /// Tangential displacement, m.
    pub(crate) slip: Vector3<f64>,
    /// Torque of the rolling spring on body i, N m.
    pub(crate) rolling: Vector3<f64>,
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
    /// What was remembered in the step before.
    pub(crate) memory: Memory,
    /// Radii of both spheres, m.
    pub(crate) radii: [f64; 2],
    /// Masses that both spheres bring into the dashpots, kg.
    pub(crate) dashpot_masses: [f64; 2],
    /// Volume of the bridge of liquid, 0 if there is none, m³.
    pub(crate) bridge_volume: f64,
}

impl SpherePair {
    /// The contact as it shares the masses of both bodies.
    #[inline(always)]
    pub(crate) fn touch(&self) -> Touch<2> {
        let [a, b] = self.radii;
        let distance = self.between.norm();
        let normal = self.between / distance;
        let overlap = a + b - distance;
        Touch {
            radius: (a * b / (a + b) * overlap.max(0.0)).sqrt(),
            normal,
            arms: [
                self.offset_i + normal * (a - 0.5 * overlap),
                self.offset_j - normal * (b - 0.5 * overlap),
            ],
        }
    }

    /// Lets the dashpots know the masses of both bodies.
    #[inline(always)]
    pub(crate) fn share_masses(&mut self, shares: Option<&Shares<'_, 2>>) {
        if let Some(shares) = shares {
            self.dashpot_masses = shares.masses(&self.touch(), self.dashpot_masses);
        }
    }
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
    /// Volume of the bridge of liquid, 0 if there is none, m³.
    pub(crate) bridge_volume: f64,
}

impl SphereWall {
    /// The contact as it shares the mass of the body.
    #[inline(always)]
    pub(crate) fn touch(&self) -> Touch<1> {
        Touch {
            radius: (self.geometry.reduced_radius * self.geometry.overlap.max(0.0)).sqrt(),
            normal: self.normal,
            arms: [self.arm],
        }
    }

    /// Lets the dashpot know the mass of the body.
    #[inline(always)]
    pub(crate) fn share_mass(&mut self, shares: Option<&Shares<'_, 1>>) {
        if let Some(shares) = shares {
            [self.geometry.reduced_mass] =
                shares.masses(&self.touch(), [self.geometry.reduced_mass]);
        }
    }
}

/// Force and torques of a contact.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ContactWrench {
    /// Force on body i, N; the other side feels the opposite.
    pub(crate) force: Vector3<f64>,
    /// Torque on body i about its centre, N m.
    pub(crate) torque_i: Vector3<f64>,
    /// Torque on body j about its centre, N m.
    pub(crate) torque_j: Vector3<f64>,
    /// What to remember after the step.
    pub(crate) memory: Memory,
}

impl Interaction {
    /// Force and torques between two spheres, for one step of `time_step` (s).
    ///
    /// The displacement of the step before is first projected on the present contact plane; its
    /// length changes by the square of the angle of one step only. No branch depends on the
    /// state, so that a loop over contacts can be vectorised.
    #[inline(always)]
    pub(crate) fn between_spheres(&self, pair: &SpherePair, time_step: f64) -> ContactWrench {
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
            // Only a bridge keeps a contact beyond the touch; nothing is pressed then.
            overlap: overlap.max(0.0),
            reduced_radius: radius_i * radius_j / sum,
            reduced_mass: mass_i * mass_j / (mass_i + mass_j),
        };
        let approach = relative.dot(&normal);
        let sliding = relative - normal * approach;
        let kept = kept_slip(&pair.memory, &normal, overlap);
        let force = self
            .law
            .force(&geometry, approach, sliding, kept, time_step);
        let pull = self.attraction(overlap, geometry.reduced_radius, pair.bridge_volume);
        let mut on_i = force.tangential - normal * (force.normal - pull);
        let bridge = [overlap, pair.bridge_volume];
        if let Some(drag) = self.drag(bridge, &normal, approach, &sliding) {
            on_i += drag;
        }
        let rolling = if self.rolling_friction > 0.0 || self.rolling_spring.is_some() {
            let lever = |arm: &Vector3<f64>, radius: f64| {
                self.rolling_lever.of(arm.norm(), radius - 0.5 * overlap)
            };
            let [lever_i, lever_j] = [lever(&arm_i, radius_i), lever(&arm_j, radius_j)];
            let rolling = Rolling {
                normal_force: force.normal.max(0.0),
                lever: lever_i * lever_j / (lever_i + lever_j),
                spin: pair.spins[0] - pair.spins[1],
                normal,
                overlap: geometry.overlap,
                reduced_radius: geometry.reduced_radius,
                inertia: reduced_inertia(mass_i * lever_i * lever_i, mass_j * lever_j * lever_j),
            };
            self.rolling(&rolling, pair.memory.rolling, time_step)
        } else {
            [Vector3::zeros(); 2]
        };
        ContactWrench {
            force: on_i,
            torque_i: arm_i.cross(&on_i) + rolling[0],
            torque_j: -arm_j.cross(&on_i) - rolling[0],
            memory: Memory {
                slip: force.slip,
                rolling: rolling[1],
            },
        }
    }

    /// Force and torque of a wall on a sphere of `body`; `memory` as in [`SpherePair`].
    #[inline(always)]
    pub(crate) fn at_wall(
        &self,
        contact: &SphereWall,
        body: &Mover,
        memory: Memory,
        time_step: f64,
    ) -> ContactWrench {
        let normal = contact.normal;
        let relative = body.velocity + body.spin.cross(&contact.arm) - contact.wall_velocity;
        let approach = relative.dot(&normal);
        let sliding = relative - normal * approach;
        let overlap = contact.geometry.overlap;
        let kept = kept_slip(&memory, &normal, overlap);
        let geometry = ContactGeometry {
            overlap: overlap.max(0.0),
            ..contact.geometry
        };
        let force = self
            .law
            .force(&geometry, approach, sliding, kept, time_step);
        let pull = self.attraction(overlap, geometry.reduced_radius, contact.bridge_volume);
        let mut on_body = force.tangential - normal * (force.normal - pull);
        let bridge = [overlap, contact.bridge_volume];
        if let Some(drag) = self.drag(bridge, &normal, approach, &sliding) {
            on_body += drag;
        }
        let of_sphere = geometry.reduced_radius - 0.5 * overlap;
        let lever = self.rolling_lever.of(contact.arm.norm(), of_sphere);
        let rolling = Rolling {
            normal_force: force.normal.max(0.0),
            lever,
            spin: body.spin - contact.wall_spin,
            normal,
            overlap: geometry.overlap,
            reduced_radius: geometry.reduced_radius,
            inertia: ROUND * geometry.reduced_mass * lever * lever,
        };
        let [torque, spring] = self.rolling(&rolling, memory.rolling, time_step);
        ContactWrench {
            force: on_body,
            torque_i: contact.arm.cross(&on_body) + torque,
            torque_j: Vector3::zeros(),
            memory: Memory {
                slip: force.slip,
                rolling: spring,
            },
        }
    }

    /// Torque of rolling resistance on body i and that of its spring, N m.
    #[inline(always)]
    fn rolling(
        &self,
        rolling: &Rolling,
        spring: Vector3<f64>,
        time_step: f64,
    ) -> [Vector3<f64>; 2] {
        if let Some(law) = &self.rolling_spring {
            let contact = RollingContact {
                normal_force: rolling.normal_force,
                reduced_radius: rolling.lever,
                tangential_stiffness: self
                    .law
                    .tangential_stiffness(rolling.overlap, rolling.reduced_radius),
                reduced_inertia: rolling.inertia,
                normal: rolling.normal,
                relative_spin: rolling.spin,
            };
            let found = law.torque(&contact, spring, time_step);
            return [found.torque, found.spring];
        }
        let torque = rolling_constant_torque::torque(
            self.rolling_friction,
            rolling.normal_force,
            rolling.lever,
            rolling.spin,
        );
        [torque, Vector3::zeros()]
    }
}

/// The slip of the step before in the plane of contact, m; none if only a bridge holds.
#[inline(always)]
fn kept_slip(memory: &Memory, normal: &Vector3<f64>, overlap: f64) -> Vector3<f64> {
    let touches = if overlap > 0.0 { 1.0 } else { 0.0 };
    (memory.slip - normal * memory.slip.dot(normal)) * touches
}

/// Moment of inertia of a sphere about its contact over m r²: 2/5 + 1.
const ROUND: f64 = 1.4;

/// Moment about the point of contact that resists the rolling of two bodies, kg m²; `m l²` of both.
///
/// The mass is the one that enters the dashpots: for single spheres the moment is exact, for
/// agglomerates whose spheres damp with their own mass it is that of the spheres at their levers.
#[inline(always)]
fn reduced_inertia(i: f64, j: f64) -> f64 {
    ROUND * i * j / (i + j)
}

/// A contact as rolling resistance sees it.
#[derive(Debug, Clone, Copy)]
struct Rolling {
    /// Normal force, 0 or more, N.
    normal_force: f64,
    /// Reduced lever arm, m.
    lever: f64,
    /// Angular velocity of i less that of j, rad/s.
    spin: Vector3<f64>,
    /// Unit normal.
    normal: Vector3<f64>,
    /// Overlap, 0 or more, m.
    overlap: f64,
    /// Reduced radius, m.
    reduced_radius: f64,
    /// Reduced moment of inertia, kg m².
    inertia: f64,
}

#[cfg(test)]
mod tests {
    use super::{Memory, Mover, SpherePair, SphereWall};
    use crate::interaction::{Interaction, InteractionSettings, OptionalLaws};
    use contact_law::{ContactGeometry, Material, NormalForceEnd, PairParameters, RollingLever};
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
                memory: Memory {
                    slip,
                    ..Memory::default()
                },
                radii: [1e-3, 1e-3],
                dashpot_masses: [4e-6, 4e-6],
                bridge_volume: 1e-11,
            };
            interaction().between_spheres(&pair, 1e-6)
        });
        let error = (plain.force - tilted.force).norm() / plain.force.norm();
        assert!(error < 1e-12, "force between spheres changes by {error}");
        assert!(
            (plain.memory.slip - tilted.memory.slip).norm() < 1e-12 * plain.memory.slip.norm(),
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
            bridge_volume: 0.0,
        };
        let [plain, tilted] = [SLIP, SLIP + NORMAL * 5e-7].map(|slip| {
            let memory = Memory {
                slip,
                ..Memory::default()
            };
            interaction().at_wall(&contact, &body, memory, 1e-6)
        });
        let error = (plain.force - tilted.force).norm() / plain.force.norm();
        assert!(error < 1e-12, "force of a wall changes by {error}");
    }

    /// Two spheres far from the centres of their bodies: the torque of rolling resistance is `mu_r F_n L` with L half of
    /// the distance from the contact to the centre of a sphere, or half of that to the centre of a body. Rounding only.
    #[test]
    fn rolling_resistance_takes_its_arm_from_the_sphere_or_from_the_body() {
        let pair = SpherePair {
            between: NORMAL * 1.99e-3,
            offset_i: NORMAL * 3e-3,
            offset_j: -NORMAL * 3e-3,
            velocity: Vector3::zeros(),
            spins: [Vector3::new(-0.8, 0.0, 0.6) * 5.0, Vector3::zeros()],
            memory: Memory::default(),
            radii: [1e-3, 1e-3],
            dashpot_masses: [4e-6, 4e-6],
            bridge_volume: 0.0,
        };
        for (rolling_lever, arm) in [
            (RollingLever::Sphere, 0.995e-3),
            (RollingLever::Centre, 3.995e-3),
        ] {
            let lever = OptionalLaws {
                rolling_lever,
                ..OptionalLaws::default()
            };
            let law = interaction().with(&lever);
            let rolls = law.between_spheres(&pair, 1e-9);
            let mut free = law;
            free.rolling_friction = 0.0;
            let slides = free.between_spheres(&pair, 1e-9);
            let torque = (rolls.torque_i - slides.torque_i).norm();
            let normal_force = law.attraction(1e-5, 0.5e-3, 0.0) - slides.force.dot(&NORMAL);
            let expected = 0.1 * normal_force * 0.5 * arm;
            assert!(
                (torque / expected - 1.0).abs() < 1e-9,
                "{rolling_lever:?}: {torque} N m for {expected}"
            );
        }
    }

    /// While only a bridge holds, nothing rubs: a slip from before is forgotten, and the drift of many steps
    /// does not wait for the next touch. What is left is the way of the last step.
    #[test]
    fn slip_does_not_grow_across_a_bridge() {
        let water = contact_law::CapillaryBridge::new(0.07, 0.0).unwrap();
        let wet = interaction().with(&OptionalLaws {
            bridge: Some(water.between(1e-3)),
            ..OptionalLaws::default()
        });
        let step = 1e-6;
        let mut memory = Memory {
            slip: SLIP,
            ..Memory::default()
        };
        let sideways = Vector3::new(0.01, 0.02, -0.0075);
        for _ in 0..100 {
            let pair = SpherePair {
                between: NORMAL * 2.01e-3,
                offset_i: Vector3::zeros(),
                offset_j: Vector3::zeros(),
                velocity: sideways,
                spins: [Vector3::zeros(); 2],
                memory,
                radii: [1e-3, 1e-3],
                dashpot_masses: [4e-6, 4e-6],
                bridge_volume: 1e-11,
            };
            memory = wet.between_spheres(&pair, step).memory;
        }
        let way = sideways.norm() * step;
        assert!(memory.slip.norm() <= way * (1.0 + 1e-12), "{}", memory.slip);
    }
}
