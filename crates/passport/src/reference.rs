//! A small integrator of its own, in which each convention can be read in another way.
//!
//! It knows a few bodies and the plane y = 0, computes every pair in every step, and has the laws of [`contact_law`] written out.
//! With no convention changed it agrees with the solver, which a test checks: so both check each other.

use crate::case::{Case, Component, Start};
use crate::model::{Contact, Model};
use crate::variant::{History, SlidingLimit, Variant};
use contact_law::hertz_mindlin::damping_ratio;
use contact_law::material::EffectiveModuli;
use contact_law::rolling_spring_dashpot::{
    DAMPING_RATIO, RollingContact, RollingSpringDashpot, STIFFNESS_RATIO,
};
use contact_law::{NormalForceEnd, RollingLever, linear_cohesion, rolling_constant_torque};
use dem_solver::DashpotMass;
use nalgebra::{UnitQuaternion, Vector3};
use scene::RollingLaw;

/// Moment of inertia of a sphere over m r².
const SPHERE: f64 = 0.4;

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
struct Place {
    /// Body and sphere.
    i: (usize, usize),
    /// The other body and sphere; `None` for the wall.
    j: Option<(usize, usize)>,
    /// Tangential displacement (m), or force (N) with [`History::Force`].
    spring: Vector3<f64>,
    /// Torque of the rolling spring, N m.
    rolling: Vector3<f64>,
    /// Radius of the contact one step before, m.
    radius: f64,
}

/// Geometry and motion of a contact.
struct Touch {
    normal: Vector3<f64>,
    overlap: f64,
    reduced_radius: f64,
    reduced_mass: f64,
    /// From the centres of the bodies to the point of contact, m.
    arms: [Vector3<f64>; 2],
    /// Velocity of i relative to j at the point of contact, m/s.
    velocity: Vector3<f64>,
    relative_spin: Vector3<f64>,
    /// Index of the contact: grains, wall.
    kind: usize,
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

/// The law of a contact at this moment.
struct Law<'a> {
    variant: &'a Variant,
    contact: &'a Contact,
    kind: usize,
    contact_radius: f64,
    /// E* and G* with their factors, Pa.
    young: f64,
    shear: f64,
    /// `2 sqrt(5/6) b` with its factor.
    damping: f64,
}

impl<'a> Law<'a> {
    fn new(variant: &'a Variant, touch: &Touch, moduli: &EffectiveModuli) -> Self {
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
    fn normal(&self, touch: &Touch) -> f64 {
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
    fn tangential(&self, touch: &Touch, normal: f64, place: &mut Place, step: f64) -> Vector3<f64> {
        let stiffness = 8.0 * self.shear * self.contact_radius;
        let dashpot = self.damping
            * self.variant.tangential_damping
            * (stiffness * touch.reduced_mass).sqrt();
        let in_plane = |v: Vector3<f64>| v - touch.normal * v.dot(&touch.normal);
        let sliding = in_plane(touch.velocity);
        let kept = in_plane(place.spring);
        let limit = self.contact.static_friction * normal.max(0.0);
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
    fn attraction(&self, touch: &Touch) -> f64 {
        attraction(self.contact, touch.reduced_radius, touch.overlap)
    }

    /// Torque of rolling resistance on i, N m; moves the spring of the place.
    fn rolling(
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
            return rolling_constant_torque::torque(
                coefficient,
                normal,
                lever,
                touch.relative_spin,
            );
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

/// Attraction of a contact of a reduced radius and an overlap (m), N.
fn attraction(contact: &Contact, reduced_radius: f64, overlap: f64) -> f64 {
    let area = linear_cohesion::contact_area(reduced_radius, overlap);
    contact.attraction_n + contact.cohesion_energy_density_j_m3 * area
}

/// Overlap (m) at which a contact carries a load (N) beside its attraction, by bisection: the elastic force grows faster than the
/// attraction.
fn overlap_under(contact: &Contact, young: f64, reduced_radius: f64, load: f64) -> f64 {
    let excess = |d: f64| {
        let elastic = 4.0 / 3.0 * young * (reduced_radius * d).sqrt() * d;
        elastic - attraction(contact, reduced_radius, d) - load
    };
    let (mut low, mut high) = (0.0, reduced_radius);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// Overlap of a sphere at rest on the wall under an acceleration (m/s²) normal to it, m.
pub(crate) fn resting_overlap(model: &Model, gravity: f64) -> f64 {
    let young = model.moduli()[1].young;
    overlap_under(
        &model.contacts[1],
        young,
        model.radius_m,
        model.mass() * gravity,
    )
}

/// Overlap of two grains that attract each other, m.
pub(crate) fn neck_overlap(model: &Model) -> f64 {
    let young = model.moduli()[0].young;
    overlap_under(&model.contacts[0], young, 0.5 * model.radius_m, 0.0)
}

/// Speed at which a sphere leaves such a neck at half of its speed if nothing damps it, m/s.
pub(crate) fn neck_speed(model: &Model, overlap: f64) -> f64 {
    let (contact, reduced) = (&model.contacts[0], 0.5 * model.radius_m);
    let area = linear_cohesion::contact_area(reduced, overlap);
    let pull = contact.attraction_n * overlap
        + 0.5 * contact.cohesion_energy_density_j_m3 * area * overlap;
    let elastic =
        8.0 / 15.0 * model.moduli()[0].young * (reduced * overlap).sqrt() * overlap * overlap;
    // m v²/2 is four thirds of the work of parting: a quarter of the energy is left.
    (8.0 / 3.0 * (pull - elastic).max(0.0) / model.mass()).sqrt()
}
