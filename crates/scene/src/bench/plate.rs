//! What a seed meets on the bench: a smooth plate, or seeds glued side by side.

use super::BenchParts;
use crate::Error;
use crate::extent::extent;
use dem_solver::{DashpotMass, Placement, Shape, Template, Wall, World};
use geometry::clump::{Clump, MassProperties, Sphere};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Mass of a rigid plate of seeds, kg: too heavy to move.
const PLATE_MASS: f64 = 1e12;

/// Rate at which a plate that gave way comes back on its tape, damped critically, 1/s: slowly against a contact, which lasts less than a
/// millisecond, and fast against the 40 ms of a bounce by 2 mm.
const TAPE_RATE: f64 = 100.0;

/// Gap below a plate that gives way, m: of ten times the mass of a seed, hit with 2 m/s, it sinks by `0.2 / (100 e) = 0.7 mm`.
const ROOM: f64 = 5e-3;

/// The plate of a test, its upper side about y = 0.
#[derive(Debug)]
pub(super) enum Plate {
    /// The plane y = 0.
    Smooth,
    /// Spheres of seeds that are glued down on a plane at their lowest point.
    Seeds(Vec<Sphere>),
}

impl Plate {
    /// The plate of the parts: smooth, or `n_x` by `n_z` seeds.
    pub(super) fn of(parts: &BenchParts, n_x: usize, n_z: usize, stream: &mut Stream) -> Self {
        if parts.on_seeds {
            Self::Seeds(glued(parts, n_x, n_z, stream))
        } else {
            Self::Smooth
        }
    }

    /// Where over the plate a seed is put, m from its middle: there on a smooth plate, on seeds at a random
    /// place within half a seed of it.
    pub(super) fn place(&self, parts: &BenchParts, stream: &mut Stream) -> Vector3<f64> {
        let half = 0.5 * parts.radius;
        match self {
            Self::Smooth => Vector3::zeros(),
            Self::Seeds(_) => {
                let [x, z] = [0, 1].map(|_| stream.between(-half, half));
                Vector3::new(x, 0.0, z)
            }
        }
    }

    /// Highest point, m.
    pub(super) fn top(&self) -> f64 {
        match self {
            Self::Smooth => 0.0,
            Self::Seeds(spheres) => highest(spheres),
        }
    }

    /// How far spheres must be raised so that they just touch the plate from above, m.
    pub(super) fn lift(&self, spheres: &[Sphere]) -> f64 {
        match self {
            Self::Smooth => -lowest(spheres),
            Self::Seeds(plate) => {
                let on_base = lowest(plate) - lowest(spheres);
                touching_shift(spheres, plate, 1).map_or(on_base, |shift| shift.max(on_base))
            }
        }
    }

    /// The world of a test: the body (material 0) is body 0, a plate of seeds the last. No gravity acts; a
    /// test adds the weight.
    pub(super) fn world(
        &self,
        parts: &BenchParts,
        body: Template,
        start: Placement,
    ) -> Result<World, Error> {
        let (mut templates, mut starts) = (vec![body], vec![start]);
        let base = match self {
            Self::Smooth => 0.0,
            Self::Seeds(spheres) => {
                let plate = [plate_mass(parts), PLATE_MASS];
                templates.push(rigid(parts, spheres, plate, DashpotMass::Body)?);
                let still = UnitQuaternion::identity();
                starts.push(Placement::at_rest(1, Vector3::zeros(), still));
                lowest(spheres) - if parts.plate_give > 0.0 { ROOM } else { 0.0 }
            }
        };
        let plane = Wall {
            name: "plate".into(),
            shape: Shape::Plane {
                point: Vector3::y() * base,
                normal: Vector3::y(),
            },
            material: 1,
            spin: 0.0,
        };
        Ok(World::new(
            parts.solver_settings(),
            templates,
            parts.interactions.clone(),
            vec![plane],
            &starts,
        )?)
    }
}

/// The turn that lays a seed flat: the principal axes come in the order of the moments, so z is across the
/// flat side; it is turned upright.
pub(super) fn flat() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2)
}

/// Spheres of `n_x` by `n_z` seeds that lie flat side by side, centred on the origin.
///
/// Each is turned at random about the vertical. Each row along x begins at random within a seed, and in it each seed begins
/// where the one before ends; along z each is pushed against the rows before until it touches. With rows that begin
/// side by side round seeds would make a lattice, into whose pits all seeds of a sled fall at once.
pub(super) fn glued(
    parts: &BenchParts,
    n_x: usize,
    n_z: usize,
    stream: &mut Stream,
) -> Vec<Sphere> {
    let mut laid: Vec<Vec<Sphere>> = Vec::new();
    for _ in 0..n_z {
        let before = laid.len();
        let mut end = 0.0;
        for _ in 0..n_x {
            let angle = stream.between(0.0, std::f64::consts::TAU);
            let about = Quaternion::new((0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0);
            let seed = parts.turned(&(UnitQuaternion::new_normalize(about) * flat()));
            let [from, to] = extent(&seed, 0);
            laid.push(moved(seed, Vector3::x() * (end - from)));
            end += to - from;
        }
        let start = stream.between(-0.5, 0.5) * end / n_x as f64;
        for k in before..laid.len() {
            let seed = moved(
                std::mem::take(&mut laid[k]),
                Vector3::x() * (start - 0.5 * end),
            );
            let others = laid[..before].iter().flatten().copied();
            let others: Vec<Sphere> = others.collect();
            let shift = touching_shift(&seed, &others, 2).unwrap_or(0.0);
            laid[k] = moved(seed, Vector3::z() * shift);
        }
    }
    let spheres = laid.concat();
    let [front, back] = extent(&spheres, 2);
    moved(spheres, Vector3::z() * (-0.5 * (front + back)))
}

/// Mass of a plate of seeds, kg.
fn plate_mass(parts: &BenchParts) -> f64 {
    if parts.plate_give > 0.0 {
        parts.body.clump.mass() / parts.plate_give
    } else {
        PLATE_MASS
    }
}

/// Force of the tape on a plate of seeds that moved from its place (m) and moves (m/s), N; none on a rigid one.
pub(super) fn of_tape(
    parts: &BenchParts,
    moved: &Vector3<f64>,
    velocity: &Vector3<f64>,
) -> Vector3<f64> {
    if parts.plate_give == 0.0 {
        return Vector3::zeros();
    }
    (moved * TAPE_RATE + velocity * 2.0) * (-TAPE_RATE * plate_mass(parts))
}

/// A rigid body of these spheres (material 0) that keeps the axes in which they are given; its mass, and the one of its moments of
/// inertia, kg.
pub(super) fn rigid(
    parts: &BenchParts,
    spheres: &[Sphere],
    [mass, turned]: [f64; 2],
    dashpots: DashpotMass,
) -> Result<Template, Error> {
    let size = spheres.iter().map(|s| s.centre.norm()).fold(0.0, f64::max);
    // Three different moments in rising order leave the axes alone; the body does not turn.
    let moments = Vector3::new(1.0, 1.1, 1.2) * (turned * size.max(spheres[0].radius).powi(2));
    let properties = MassProperties {
        mass,
        centre: Vector3::zeros(),
        inertia: Matrix3::from_diagonal(&moments),
    };
    let clump = Clump::new(spheres, &properties).map_err(|source| Error::Body {
        seed: parts.name.clone(),
        source,
    })?;
    Ok(Template::new(&clump, 0, dashpots))
}

/// Spheres shifted, m.
pub(super) fn moved(mut spheres: Vec<Sphere>, shift: Vector3<f64>) -> Vec<Sphere> {
    for sphere in &mut spheres {
        sphere.centre += shift;
    }
    spheres
}

/// Lowest point of spheres, m.
pub(super) fn lowest(spheres: &[Sphere]) -> f64 {
    extent(spheres, 1)[0]
}

/// Highest point of spheres, m.
pub(super) fn highest(spheres: &[Sphere]) -> f64 {
    extent(spheres, 1)[1]
}

/// Shift along an axis, m, at which spheres that come from its positive end first touch others; `None` if they pass by.
fn touching_shift(moving: &[Sphere], others: &[Sphere], axis: usize) -> Option<f64> {
    let mut shift: Option<f64> = None;
    for b in others {
        for a in moving {
            let mut between = b.centre - a.centre;
            let along = between[axis];
            between[axis] = 0.0;
            let beside = between.norm_squared();
            let reach = (a.radius + b.radius).powi(2);
            if beside < reach {
                let touch = along + (reach - beside).sqrt();
                shift = Some(shift.map_or(touch, |s| s.max(touch)));
            }
        }
    }
    shift
}

#[cfg(test)]
mod tests {
    use super::{Sphere, touching_shift};
    use nalgebra::Vector3;

    /// A ball over the gap between two others of its size, a diameter and a half apart: the centres then form
    /// an isosceles triangle of sides 2, 2 and 3, whose height is sqrt(4 - 9/4). One that passes by touches
    /// nothing. Rounding only.
    #[test]
    fn a_ball_comes_to_lie_where_the_triangle_of_centres_says() {
        let ball = |x: f64, y: f64| Sphere {
            centre: Vector3::new(x, y, 0.0),
            radius: 1.0,
        };
        let others = [ball(-1.5, 0.0), ball(1.5, 0.0)];
        let shift = touching_shift(&[ball(0.0, 7.0)], &others, 1).unwrap();
        assert!((7.0 + shift - 1.75_f64.sqrt()).abs() < 1e-12, "{shift}");
        assert_eq!(touching_shift(&[ball(4.0, 7.0)], &others, 1), None);
    }
}
