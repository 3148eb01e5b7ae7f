//! The cases in the solver of this workspace.

use crate::Error;
use crate::case::{Case, Component, Shape};
use crate::model::Model;
use crate::reference::steps;
use contact_law::rolling_spring_dashpot::{DAMPING_RATIO, STIFFNESS_RATIO};
use contact_law::{LinearCohesion, RollingSpringDashpot};
use dem_solver::{
    Interaction, InteractionSettings, OptionalLaws, Placement, Settings, Template, Wall, World,
};
use geometry::clump::{Clump, Sphere, properties_of_spheres};
use nalgebra::{UnitQuaternion, Vector3};
use scene::RollingLaw;

/// The interactions of grains and wall, row by row.
pub(crate) fn interactions(model: &Model) -> Result<Vec<Interaction>, contact_law::Error> {
    let between = |a: usize, b: usize| {
        let contact = &model.contacts[a.max(b)];
        let settings = InteractionSettings {
            materials: [model.materials[a], model.materials[b]],
            parameters: contact.parameters(),
            attraction: contact.attraction_n,
            end: model.normal_force_end,
        };
        let rolling_spring = match model.rolling_law {
            RollingLaw::ConstantTorque => None,
            RollingLaw::SpringDashpot => Some(RollingSpringDashpot::new(
                contact.rolling_friction,
                DAMPING_RATIO,
                STIFFNESS_RATIO,
            )?),
        };
        let density = contact.cohesion_energy_density_j_m3;
        let further = OptionalLaws {
            rolling_spring,
            rolling_lever: model.rolling_lever,
            linear_cohesion: (density > 0.0)
                .then(|| LinearCohesion::new(density))
                .transpose()?,
            ..OptionalLaws::default()
        };
        Ok(Interaction::new(&settings)?.with(&further))
    };
    [(0, 0), (0, 1), (1, 0), (1, 1)]
        .map(|(a, b)| between(a, b))
        .into_iter()
        .collect()
}

/// The bodies of the model: a sphere and a clump, and the rotations from their frames in [`Shape`] to their principal frames.
pub(crate) fn templates(model: &Model) -> Result<[(Template, UnitQuaternion<f64>); 2], Error> {
    let of = |shape: Shape| {
        let spheres: Vec<_> = shape
            .centres(model.radius_m)
            .into_iter()
            .map(|centre| Sphere {
                centre,
                radius: model.radius_m,
            })
            .collect();
        let clump = Clump::new(
            &spheres,
            &properties_of_spheres(&spheres, model.density_kg_m3),
        )?;
        let last = spheres.len() - 1;
        let turn =
            UnitQuaternion::rotation_between(&clump.spheres()[last].centre, &spheres[last].centre);
        let template = Template::new(&clump, 0, model.dashpot_mass);
        Ok::<_, Error>((template, turn.unwrap_or_default()))
    };
    Ok([of(Shape::Sphere)?, of(Shape::Clump)?])
}

/// Numbers of a case, in the order of its quantities, with a step of a fraction of the case's.
pub(crate) fn run(case: &Case, model: &Model, step_fraction: f64) -> Result<Vec<f64>, Error> {
    let [(sphere, upright), (clump, turn)] = templates(model)?;
    let starts: Vec<Placement> = case
        .bodies
        .iter()
        .map(|start| {
            let (template, frame) = match start.shape {
                Shape::Sphere => (0, upright),
                Shape::Clump => (1, turn),
            };
            Placement {
                template,
                position: start.position,
                orientation: start.orientation * frame,
                velocity: start.velocity,
                spin: start.spin,
            }
        })
        .collect();
    let walls = case.wall.then(|| plane(Vector3::zeros(), Vector3::y()));
    let time_step = case.time_step * step_fraction;
    let settings = Settings::for_templates(time_step, case.gravity, std::slice::from_ref(&sphere));
    let mut world = World::new(
        settings,
        vec![sphere, clump],
        interactions(model)?,
        walls.into_iter().collect(),
        &starts,
    )?;
    let (mut n_done, mut values) = (0, vec![f64::NAN; case.quantities.len()]);
    for (at, time) in case.times.iter().enumerate() {
        let n_steps = steps(*time, time_step);
        while n_done < n_steps {
            world.step()?;
            n_done += 1;
        }
        let bodies = world.bodies();
        for (quantity, value) in case.quantities.iter().zip(&mut values) {
            if quantity.at == at {
                *value = match quantity.component {
                    Component::Velocity(axis) => bodies.velocity[0][axis],
                    Component::Spin(axis) => bodies.spin[0][axis],
                    Component::Displacement(axis) => {
                        bodies.position[0][axis] - case.bodies[0].position[axis]
                    }
                };
            }
        }
    }
    Ok(values)
}

/// A plane of the wall's material through a point (m), with bodies on the side of its normal.
pub(crate) fn plane(point: Vector3<f64>, normal: Vector3<f64>) -> Wall {
    Wall {
        name: "wall".into(),
        shape: dem_solver::Shape::Plane { point, normal },
        material: 1,
        spin: 0.0,
    }
}
