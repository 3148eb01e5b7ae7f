//! A small integrator of its own, in which each convention can be read in another way.
//!
//! It knows a few bodies and the plane y = 0, computes every pair in every step, and has the laws of [`contact_law`] written out.
//! With no convention changed it agrees with the solver, which a test checks: so both check each other.

use crate::case::{Case, Component, Start};
use crate::model::Model;
use crate::reference_law::Law;
use crate::variant::Variant;
use contact_law::material::EffectiveModuli;
use dem_solver::DashpotMass;
use nalgebra::{UnitQuaternion, Vector3};

/// Moment of inertia of a sphere over m r².
pub(crate) const SPHERE: f64 = 0.4;

/// A body in motion.
#[derive(Debug, Clone)]
struct Body {
    mass: f64,
    /// Principal moments, kg m².
    inertia: Vector3<f64>,
    /// Centres of the spheres in the frame of the body, m.
    centres: Vec<Vector3<f64>>,
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    orientation: UnitQuaternion<f64>,
    /// Angular momentum, kg m²/s.
    momentum: Vector3<f64>,
    force: Vector3<f64>,
    torque: Vector3<f64>,
}

impl Body {
    fn new(start: &Start, model: &Model) -> Self {
        let centres = start.shape.centres(model.radius_m);
        let (mass, radius) = (model.mass(), model.radius_m);
        let about_axis = |axis: usize| -> f64 {
            let of_sphere = |c: &Vector3<f64>| c.norm_squared() - c[axis] * c[axis];
            centres
                .iter()
                .map(|c| mass * (SPHERE * radius * radius + of_sphere(c)))
                .sum()
        };
        let inertia = Vector3::from_fn(|axis, _| about_axis(axis));
        let turn = start.orientation;
        Self {
            mass: mass * centres.len() as f64,
            inertia,
            centres,
            position: start.position,
            velocity: start.velocity,
            orientation: turn,
            momentum: turn * inertia.component_mul(&(turn.inverse() * start.spin)),
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
        }
    }

    /// Angular velocity, rad/s.
    fn spin(&self) -> Vector3<f64> {
        self.spin_at(&self.orientation)
    }

    fn spin_at(&self, turn: &UnitQuaternion<f64>) -> Vector3<f64> {
        turn * (turn.inverse() * self.momentum).component_div(&self.inertia)
    }

    /// One step: the same scheme as the solver, second order.
    fn advance(&mut self, gravity: &Vector3<f64>, step: f64) {
        self.velocity += (self.force / self.mass + gravity) * step;
        self.position += self.velocity * step;
        self.momentum += self.torque * step;
        let half = UnitQuaternion::from_scaled_axis(self.spin() * (0.5 * step)) * self.orientation;
        let turn = UnitQuaternion::from_scaled_axis(self.spin_at(&half) * step);
        self.orientation = turn * self.orientation;
        (self.force, self.torque) = (Vector3::zeros(), Vector3::zeros());
    }
}

/// A contact that may form, and what it remembers.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    /// Body and sphere.
    i: (usize, usize),
    /// The other body and sphere; `None` for the wall.
    j: Option<(usize, usize)>,
    /// Tangential displacement (m), or force (N) with [`History::Force`].
    pub(crate) spring: Vector3<f64>,
    /// Torque of the rolling spring, N m.
    pub(crate) rolling: Vector3<f64>,
    /// Radius of the contact one step before, m.
    pub(crate) radius: f64,
}

/// Geometry and motion of a contact.
pub(crate) struct Touch {
    pub(crate) normal: Vector3<f64>,
    pub(crate) overlap: f64,
    pub(crate) reduced_radius: f64,
    pub(crate) reduced_mass: f64,
    /// From the centres of the bodies to the point of contact, m.
    pub(crate) arms: [Vector3<f64>; 2],
    /// Velocity of i relative to j at the point of contact, m/s.
    pub(crate) velocity: Vector3<f64>,
    pub(crate) relative_spin: Vector3<f64>,
    /// Index of the contact: grains, wall.
    pub(crate) kind: usize,
}

/// Numbers of a case by a reading of the parameters, in the order of its quantities.
pub(crate) fn run(case: &Case, variant: &Variant) -> Vec<f64> {
    let mut bodies: Vec<Body> = case
        .bodies
        .iter()
        .map(|start| Body::new(start, &variant.model))
        .collect();
    let mut places = places(&bodies, case.wall);
    let moduli = variant.model.moduli();
    let mut n_done = 0_u64;
    let mut values = vec![f64::NAN; case.quantities.len()];
    for (at, time) in case.times.iter().enumerate() {
        let n_steps = steps(*time, case.time_step);
        while n_done < n_steps {
            for place in &mut places {
                act(&mut bodies, place, variant, &moduli, case.time_step);
            }
            for body in &mut bodies {
                body.advance(&case.gravity, case.time_step);
            }
            n_done += 1;
        }
        for (quantity, value) in case.quantities.iter().zip(&mut values) {
            if quantity.at == at {
                *value = component(quantity.component, &bodies[0], &case.bodies[0]);
            }
        }
    }
    values
}

/// Steps to a time.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "times are positive and far below 2^63 steps"
)]
pub(crate) fn steps(time: f64, time_step: f64) -> u64 {
    (time / time_step).round() as u64
}

fn component(component: Component, body: &Body, start: &Start) -> f64 {
    match component {
        Component::Velocity(axis) => body.velocity[axis],
        Component::Spin(axis) => body.spin()[axis],
        Component::Displacement(axis) => body.position[axis] - start.position[axis],
    }
}

/// All contacts that may form.
fn places(bodies: &[Body], wall: bool) -> Vec<Place> {
    let spheres = |b: usize| (0..bodies[b].centres.len()).map(move |s| (b, s));
    let place = |i, j| Place {
        i,
        j,
        spring: Vector3::zeros(),
        rolling: Vector3::zeros(),
        radius: 0.0,
    };
    let mut places = Vec::new();
    for a in 0..bodies.len() {
        for i in spheres(a) {
            for b in a + 1..bodies.len() {
                places.extend(spheres(b).map(|j| place(i, Some(j))));
            }
            if wall {
                places.push(place(i, None));
            }
        }
    }
    places
}

/// The contact of a place, if the surfaces overlap.
fn touch(bodies: &[Body], place: &Place, model: &Model) -> Option<Touch> {
    let radius = model.radius_m;
    let centre = |(b, s): (usize, usize)| bodies[b].orientation * bodies[b].centres[s];
    let mass = |b: usize| match model.dashpot_mass {
        DashpotMass::Sphere => model.mass(),
        DashpotMass::Body | DashpotMass::Shared => bodies[b].mass,
    };
    let (i, from) = (&bodies[place.i.0], centre(place.i));
    let velocity = |body: &Body, arm: &Vector3<f64>| body.velocity + body.spin().cross(arm);
    let Some(at) = place.j else {
        let overlap = radius - (i.position + from).y;
        let normal = -Vector3::y();
        let arm = from + normal * (radius - 0.5 * overlap);
        return (overlap > 0.0).then(|| Touch {
            normal,
            overlap,
            reduced_radius: radius,
            reduced_mass: mass(place.i.0),
            velocity: velocity(i, &arm),
            relative_spin: i.spin(),
            arms: [arm, Vector3::zeros()],
            kind: 1,
        });
    };
    let (j, to) = (&bodies[at.0], centre(at));
    let between = j.position + to - i.position - from;
    let overlap = 2.0 * radius - between.norm();
    let normal = between.normalize();
    let reach = radius - 0.5 * overlap;
    let arms = [from + normal * reach, to - normal * reach];
    let (a, b) = (mass(place.i.0), mass(at.0));
    (overlap > 0.0).then(|| Touch {
        normal,
        overlap,
        reduced_radius: 0.5 * radius,
        reduced_mass: a * b / (a + b),
        velocity: velocity(i, &arms[0]) - velocity(j, &arms[1]),
        relative_spin: i.spin() - j.spin(),
        arms,
        kind: 0,
    })
}

/// Force and torques of a place on its bodies.
fn act(
    bodies: &mut [Body],
    place: &mut Place,
    variant: &Variant,
    moduli: &[EffectiveModuli; 2],
    step: f64,
) {
    let Some(touch) = touch(bodies, place, &variant.model) else {
        (place.spring, place.rolling, place.radius) = Default::default();
        return;
    };
    let law = Law::new(variant, &touch, &moduli[touch.kind]);
    let normal = law.normal(&touch);
    let tangential = law.tangential(&touch, normal, place, step);
    let pull = law.attraction(&touch);
    let force = tangential - touch.normal * (normal - pull);
    let rolling = law.rolling(&touch, normal, &mut place.rolling, step);
    place.radius = law.contact_radius;
    let mut load = |b: usize, force: Vector3<f64>, torque: Vector3<f64>| {
        bodies[b].force += force;
        bodies[b].torque += torque;
    };
    load(place.i.0, force, touch.arms[0].cross(&force) + rolling);
    if let Some((b, _)) = place.j {
        load(b, -force, -touch.arms[1].cross(&force) - rolling);
    }
}
