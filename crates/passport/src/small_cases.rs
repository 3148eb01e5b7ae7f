//! The small cases of a model.

use crate::case::{Case, Component, Quantity, Shape, Start};
use crate::model::Model;
use crate::resting;
use nalgebra::{UnitQuaternion, Vector3};
use scene::RollingLaw;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

/// Steps of the duration of an elastic impact.
const STEPS_PER_IMPACT: f64 = 1000.0;
/// Steps of the duration of an impact at the speed of rolling, in the cases with gravity.
const STEPS_PER_REST: f64 = 25.0;
/// Scales of the cases of a model.
struct Scales<'a> {
    model: &'a Model,
    radius: f64,
    /// Speed of impacts, m/s.
    speed: f64,
    /// Duration of an elastic impact at this speed, s.
    contact: f64,
    gravity: f64,
}

/// The small cases of a model.
pub fn cases(model: &Model) -> Vec<Case> {
    let speed = model.impact_speed();
    let scales = Scales {
        model,
        radius: model.radius_m,
        speed,
        contact: model.contact_time(speed),
        gravity: model.gravity_m_s2,
    };
    let mut cases = vec![
        scales.head_on(),
        scales.spinning_pair(),
        scales.sliding_pair(),
        scales.sticking_pair(),
        scales.wall_impact(),
        scales.rolling(),
        scales.incline(),
    ];
    if model.clumps {
        cases.extend([scales.clump_drop(), scales.clump_roll()]);
    }
    if model.coheres() {
        cases.push(scales.neck());
    }
    cases
}

/// A number without closed form.
fn read(component: Component, at: usize) -> Quantity {
    Quantity {
        component,
        at,
        closed_form: None,
    }
}

use Component::{Displacement, Spin, Velocity};

impl Scales<'_> {
    /// Two spheres in contact on the x axis with a relative velocity (m/s) of the first, and no gravity.
    fn pair(&self, name: &'static str, shows: &'static str, velocity: Vector3<f64>) -> Case {
        let place = Vector3::x() * self.radius;
        Case {
            name,
            shows,
            bodies: vec![
                Start::sphere(-place, velocity * 0.5),
                Start::sphere(place, -velocity * 0.5),
            ],
            wall: false,
            gravity: Vector3::zeros(),
            time_step: self.contact / STEPS_PER_IMPACT,
            times: vec![0.25 * self.contact, 4.0 * self.contact],
            quantities: Vec::new(),
            speed: self.speed,
        }
    }

    fn head_on(&self) -> Case {
        let attractive = self.model.normal_force_end == contact_law::NormalForceEnd::Attractive;
        let rebound = -0.5 * self.model.contacts[0].restitution * self.speed;
        let closed_form = (attractive && !self.model.coheres()).then_some(rebound);
        let end = Quantity {
            closed_form,
            ..read(Velocity(0), 1)
        };
        Case {
            quantities: vec![read(Velocity(0), 0), end],
            ..self.pair(
                "head-on",
                "Two spheres meet head-on: stiffness at t1, restitution and the end of the normal force at t2.",
                Vector3::x() * self.speed,
            )
        }
    }

    fn spinning_pair(&self) -> Case {
        let spin = Vector3::z() * (0.5 * self.speed / self.radius);
        let mut case = self.pair(
            "spinning-pair",
            "The same with opposite spins, so that the surfaces roll on each other: rolling resistance between grains.",
            Vector3::x() * self.speed,
        );
        case.bodies[0].spin = spin;
        case.bodies[1].spin = -spin;
        case.quantities = vec![read(Spin(2), 0), read(Spin(2), 1)];
        case
    }

    /// Tangential over normal speed with which a contact slides to the end: 3.5 mu (1 + e) is enough if the dashpot is below the limit as
    /// well. In codes in which it is not, and to show a larger friction, more is needed; beyond 10 the spheres would slide around each other.
    fn sliding_ratio(&self, contact: usize) -> f64 {
        let contact = &self.model.contacts[contact];
        let enough = 5.0 * contact.static_friction * (1.0 + contact.restitution);
        (2.0 * enough).min(enough.max(10.0)) + 0.5
    }

    fn sliding_pair(&self) -> Case {
        let speed = self.speed;
        let across = Vector3::y() * (self.sliding_ratio(0) * speed);
        Case {
            quantities: vec![read(Velocity(1), 1), read(Spin(2), 1)],
            ..self.pair(
                "sliding-pair",
                "Two spheres meet at a grazing angle and slide throughout: friction between grains.",
                Vector3::x() * speed + across,
            )
        }
    }

    fn sticking_pair(&self) -> Case {
        let across =
            Vector3::y() * (2.0 * self.model.contacts[0].static_friction.max(0.05) * self.speed);
        let mut case = self.pair(
            "sticking-pair",
            "Two spheres meet at a steep angle, stick and slide: tangential spring, its memory, its dashpot and the limit.",
            Vector3::x() * self.speed + across,
        );
        case.times = vec![0.5 * self.contact, 4.0 * self.contact];
        case.quantities = vec![
            read(Velocity(1), 0),
            read(Spin(2), 0),
            read(Velocity(1), 1),
            read(Spin(2), 1),
        ];
        case
    }

    fn wall_impact(&self) -> Case {
        let across = self.sliding_ratio(1) * self.speed;
        let velocity = Vector3::new(across, -self.speed, 0.0);
        Case {
            name: "wall-impact",
            shows: "A sphere hits the wall and slides: stiffness at t1, restitution and friction at the wall at t2.",
            bodies: vec![Start::sphere(Vector3::y() * self.radius, velocity)],
            wall: true,
            gravity: Vector3::zeros(),
            time_step: self.contact / STEPS_PER_IMPACT,
            times: vec![0.25 * self.contact, 4.0 * self.contact],
            quantities: vec![
                read(Velocity(1), 0),
                read(Velocity(0), 1),
                read(Velocity(1), 1),
                read(Spin(2), 1),
            ],
            speed: self.speed,
        }
    }

    /// A body at rest on the wall under gravity tilted by an angle (rad), which then moves with a velocity along x (m/s).
    fn on_wall(
        &self,
        name: &'static str,
        shows: &'static str,
        shape: Shape,
        [tilt, speed]: [f64; 2],
    ) -> Case {
        let gravity = Vector3::new(tilt.sin(), -tilt.cos(), 0.0) * self.gravity;
        let overlap = resting::resting_overlap(self.model, self.gravity * tilt.cos());
        let scale = (self.gravity * self.radius).sqrt();
        // The axis of the clump lies along z.
        let orientation = match shape {
            Shape::Sphere => UnitQuaternion::identity(),
            Shape::Clump => UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -FRAC_PI_2),
        };
        let time_step = self.model.contact_time(0.1 * scale) / STEPS_PER_REST;
        Case {
            name,
            shows,
            bodies: vec![Start {
                shape,
                position: Vector3::y() * (self.radius - overlap),
                orientation,
                velocity: Vector3::x() * speed,
                spin: -Vector3::z() * (speed / self.radius),
            }],
            wall: true,
            gravity,
            time_step,
            times: vec![20.0 * (self.radius / self.gravity).sqrt()],
            quantities: Vec::new(),
            speed: scale,
        }
    }

    /// Deceleration of a rolling sphere, m/s², times a lever arm over the radius.
    fn slowing(&self, lever: f64) -> f64 {
        5.0 / 7.0 * self.model.contacts[1].rolling_friction * lever * self.gravity
    }

    /// Speed with which rolling is started, m/s.
    fn rolling_speed(&self) -> f64 {
        0.3 * (self.gravity * self.radius).sqrt()
    }

    /// Whether the closed forms of rolling hold: a constant torque, which friction carries, without attraction.
    fn rolls_in_closed_form(&self, rolling: f64) -> bool {
        let constant = self.model.rolling_law == RollingLaw::ConstantTorque;
        let friction = self.model.contacts[1].static_friction;
        constant && !self.model.coheres() && 5.0 / 7.0 * rolling < friction
    }

    fn rolling(&self) -> Case {
        let (speed, slowing) = (self.rolling_speed(), self.slowing(1.0));
        let half = 0.5 * speed / slowing;
        let mut case = self.on_wall(
            "rolling",
            "A sphere rolls on the wall, which is level: rolling resistance at the wall. It is at rest before t2.",
            Shape::Sphere,
            [0.0, speed],
        );
        let longest = 40.0 * (self.radius / self.gravity).sqrt();
        let ends =
            self.rolls_in_closed_form(self.model.contacts[1].rolling_friction) && half < longest;
        let first = half.min(longest);
        case.times = vec![first];
        case.quantities = vec![Quantity {
            closed_form: ends.then_some(0.5 * speed),
            ..read(Velocity(0), 0)
        }];
        if ends {
            case.times.push(3.0 * first);
            let distance = speed * speed / (2.0 * slowing);
            case.quantities.push(Quantity {
                closed_form: Some(distance),
                ..read(Displacement(0), 1)
            });
        } else {
            case.shows =
                "A sphere rolls on the wall, which is level: rolling resistance at the wall.";
        }
        case.speed = speed;
        case
    }

    fn incline(&self) -> Case {
        let rolling = self.model.contacts[1].rolling_friction;
        let tilt = (rolling + 0.2).atan();
        let mut case = self.on_wall(
            "incline",
            "A sphere starts from rest on the wall; gravity is tilted instead of the wall.",
            Shape::Sphere,
            [tilt, 0.0],
        );
        let rolls = 2.0 / 7.0 * (rolling + 0.2) + 5.0 / 7.0 * rolling
            < self.model.contacts[1].static_friction;
        let acceleration = 5.0 / 7.0 * self.gravity * (tilt.sin() - rolling * tilt.cos());
        case.times = vec![10.0 * (self.radius / self.gravity).sqrt()];
        let closed_form =
            (rolls && self.rolls_in_closed_form(rolling)).then_some(acceleration * case.times[0]);
        case.quantities = vec![
            Quantity {
                closed_form,
                ..read(Velocity(0), 0)
            },
            read(Spin(2), 0),
        ];
        case
    }

    fn clump_drop(&self) -> Case {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_6);
        // The lower sphere is half a radius below the centre, and in contact with the wall.
        let mut start = Start::sphere(
            Vector3::y() * (1.5 * self.radius),
            -Vector3::y() * self.speed,
        );
        start.shape = Shape::Clump;
        start.orientation = turn;
        start.spin = Vector3::y() * (0.2 * self.speed / self.radius);
        Case {
            name: "clump-drop",
            shows: "Two joined spheres fall on the wall with one of them, and spin: mass in the dashpot, inertia.",
            bodies: vec![start],
            wall: true,
            gravity: Vector3::zeros(),
            time_step: self.contact / STEPS_PER_IMPACT,
            times: vec![0.25 * self.contact, 3.0 * self.contact],
            quantities: vec![read(Velocity(1), 0), read(Velocity(1), 1), read(Spin(2), 1)],
            speed: self.speed,
        }
    }

    fn clump_roll(&self) -> Case {
        let lever = match self.model.rolling_lever {
            contact_law::RollingLever::Sphere => 1.0,
            contact_law::RollingLever::Centre => 2.0_f64.sqrt(),
        };
        let speed = self.rolling_speed();
        let slowing = self.slowing(lever);
        let time = (0.5 * speed / slowing).min(40.0 * (self.radius / self.gravity).sqrt());
        let mut case = self.on_wall(
            "clump-roll",
            "Two joined spheres roll about their common axis: the lever arm of rolling resistance of a clump.",
            Shape::Clump,
            [0.0, speed],
        );
        case.times = vec![time];
        let holds = self.rolls_in_closed_form(lever * self.model.contacts[1].rolling_friction);
        let left = speed - slowing * time;
        case.quantities = vec![Quantity {
            closed_form: holds.then_some(left),
            ..read(Velocity(0), 0)
        }];
        case.speed = speed;
        case
    }

    fn neck(&self) -> Case {
        let overlap = resting::neck_overlap(self.model);
        let pull = resting::neck_speed(self.model, overlap);
        let distance = Vector3::x() * (2.0 * self.radius - overlap);
        let still = Vector3::zeros();
        Case {
            name: "neck",
            shows: "Three spheres that cohere lie in a row; the outer ones are pulled away: strength and range of cohesion.",
            bodies: vec![
                Start::sphere(distance, Vector3::x() * pull),
                Start::sphere(still, still),
                Start::sphere(-distance, -Vector3::x() * pull),
            ],
            wall: false,
            gravity: still,
            time_step: self.contact / STEPS_PER_IMPACT,
            times: vec![0.5 * self.contact, 4.0 * self.contact],
            quantities: vec![read(Velocity(0), 0), read(Velocity(0), 1)],
            speed: pull,
        }
    }
}
