//! The multi-sphere body: spheres, mass, principal inertia.
//!
//! A [`Clump`] is a rigid body whose surface is a union of spheres. It lives in its own frame:
//! origin at the centre of mass, axes along the principal axes of inertia. The caller decides where the mass is:
//! in the spheres or in the seed that they represent. [`files`] writes it for other programs.

pub mod files;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Densities that a body may have, kg/m³: from half of the lightest foamed beads (10) to the densest metal (osmium,
/// 22 590). For any material from 25 to 5000 kg/m³, a mass wrong by a factor of 1000 or a size wrong by a factor of 10
/// lies outside.
pub const DENSITIES: std::ops::RangeInclusive<f64> = 5.0..=25_000.0;

/// One sphere of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sphere {
    /// Centre, m.
    pub centre: Vector3<f64>,
    /// Radius, m.
    pub radius: f64,
}

/// Mass, centre of mass and inertia tensor of a body in some frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: Vector3<f64>,
    /// Inertia tensor about the centre of mass, kg m².
    pub inertia: Matrix3<f64>,
}

/// Errors of a body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A body needs at least one sphere.
    #[error("a body needs at least one sphere, got none")]
    NoSpheres,
    /// A sphere has a radius that is not a positive number, or a centre that is not finite.
    #[error(
        "sphere {index} has radius {radius} m; centre and radius must be finite, radius above 0"
    )]
    BadSphere {
        /// Index of the sphere.
        index: usize,
        /// Its radius, m.
        radius: f64,
    },
    /// Mass or a principal moment of inertia is not a positive number.
    #[error("{what} is {value}; it must be a positive number")]
    NotPositive {
        /// Which quantity.
        what: &'static str,
        /// Its value, SI.
        value: f64,
    },
}

/// A rigid body made of spheres, in its principal frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Clump {
    /// Spheres, centre of mass at the origin, principal axes along x, y, z.
    spheres: Vec<Sphere>,
    /// Mass, kg.
    mass: f64,
    /// Principal moments of inertia, kg m².
    inertia: Vector3<f64>,
}

impl Clump {
    /// Builds a body from spheres and mass properties given in the same frame.
    ///
    /// The spheres are moved to the centre of mass and turned to the principal axes, taken in
    /// order of rising moment (for an elongated seed x is then the long axis).
    ///
    /// # Errors
    ///
    /// No sphere, a bad sphere, or a mass or moment that is not positive.
    pub fn new(spheres: &[Sphere], properties: &MassProperties) -> Result<Self, Error> {
        if spheres.is_empty() {
            return Err(Error::NoSpheres);
        }
        for (index, sphere) in spheres.iter().enumerate() {
            let finite = sphere.centre.iter().all(|c| c.is_finite());
            if !finite || !sphere.radius.is_finite() || sphere.radius <= 0.0 {
                return Err(Error::BadSphere {
                    index,
                    radius: sphere.radius,
                });
            }
        }
        positive("mass in kg", properties.mass)?;
        let (inertia, axes) = principal_axes(&properties.inertia);
        for moment in inertia.iter() {
            positive("principal moment of inertia in kg m²", *moment)?;
        }
        let into_body = axes.inverse();
        let spheres = spheres
            .iter()
            .map(|s| Sphere {
                centre: into_body * (s.centre - properties.centre),
                ..*s
            })
            .collect();
        Ok(Self {
            spheres,
            mass: properties.mass,
            inertia,
        })
    }

    /// A single sphere of uniform density; radius in m, density in kg/m³.
    ///
    /// # Errors
    ///
    /// A radius or density that is not positive.
    pub fn sphere(radius: f64, density: f64) -> Result<Self, Error> {
        let mass = density * volume_of_sphere(radius);
        let inertia = Matrix3::identity() * (0.4 * mass * radius * radius);
        let spheres = [Sphere {
            centre: Vector3::zeros(),
            radius,
        }];
        Self::new(
            &spheres,
            &MassProperties {
                mass,
                centre: Vector3::zeros(),
                inertia,
            },
        )
    }

    /// The body with all lengths multiplied by a factor; the mass stays.
    ///
    /// # Errors
    ///
    /// A factor that is not positive.
    pub fn scaled(&self, factor: f64) -> Result<Self, Error> {
        positive("factor of the lengths", factor)?;
        let grown = |s: &Sphere| Sphere {
            centre: s.centre * factor,
            radius: s.radius * factor,
        };
        Ok(Self {
            spheres: self.spheres.iter().map(grown).collect(),
            mass: self.mass,
            inertia: self.inertia * (factor * factor),
        })
    }

    /// Spheres in the principal frame.
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// Mass, kg.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Principal moments of inertia, kg m².
    pub fn inertia(&self) -> Vector3<f64> {
        self.inertia
    }

    /// Radius of the smallest sphere about the centre of mass that holds the whole body, m.
    pub fn bounding_radius(&self) -> f64 {
        self.spheres
            .iter()
            .map(|s| s.centre.norm() + s.radius)
            .fold(0.0, f64::max)
    }

    /// Effective mass of the body for an impulse at its tip, kg.
    ///
    /// # Formula
    ///
    /// `1/m_e = 1/m + l²/I`, with l the bounding radius and I the largest moment of inertia: the
    /// normal impulse at the lever arm l rotates the body as well as moving it.
    pub fn mass_felt_at_tip(&self) -> f64 {
        let arm = self.bounding_radius();
        1.0 / (1.0 / self.mass + arm * arm / self.inertia.max())
    }

    /// Mass of one sphere if the mass is divided in proportion to sphere volume, kg.
    pub fn fraction_mass(&self, index: usize) -> f64 {
        let total: f64 = self.spheres.iter().map(|s| s.radius.powi(3)).sum();
        self.mass * self.spheres[index].radius.powi(3) / total
    }

    /// Radius of the smallest sphere, m.
    pub fn smallest_radius(&self) -> f64 {
        let radii = self.spheres.iter().map(|s| s.radius);
        radii.fold(f64::INFINITY, f64::min)
    }

    /// Keeps only the spheres that something outside can touch: those that a probe of half the smallest radius of this
    /// body reaches. Mass and inertia stay.
    ///
    /// Objects smaller than the probe, such as spheres of another body or the edge of a wall, could pass through a hole
    /// to an omitted sphere.
    #[must_use]
    pub fn without_hidden_spheres(&self) -> Self {
        self.reached_by(0.5 * self.smallest_radius())
    }

    /// Keeps the spheres that a probe of the radius `clearance` (m) touches.
    ///
    /// It touches a sphere when at least one of 200 points on the surface, pushed out by `clearance`, lies inside no
    /// other sphere grown by `clearance`.
    fn reached_by(&self, clearance: f64) -> Self {
        let directions = fibonacci_directions(200);
        let reachable = |i: usize| {
            let own = self.spheres[i];
            directions.iter().any(|d| {
                let probe = own.centre + d * (own.radius + clearance);
                self.spheres.iter().enumerate().all(|(j, other)| {
                    j == i
                        || (probe - other.centre).norm_squared()
                            >= (other.radius + clearance).powi(2) * (1.0 - 1e-12)
                })
            })
        };
        let spheres = (0..self.spheres.len())
            .filter(|&i| reachable(i))
            .map(|i| self.spheres[i])
            .collect();
        Self {
            spheres,
            ..self.clone()
        }
    }
}

/// Volume of a sphere, 4/3 pi r³, m³.
pub fn volume_of_sphere(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

/// Mass properties of separate spheres of one density (kg/m³), overlaps counted twice.
///
/// Each sphere adds its own 2/5 m r² and its share by the parallel-axis theorem.
pub fn properties_of_spheres(spheres: &[Sphere], density: f64) -> MassProperties {
    let mass_of = |s: &Sphere| density * volume_of_sphere(s.radius);
    let mass: f64 = spheres.iter().map(mass_of).sum();
    let centre = spheres
        .iter()
        .map(|s| s.centre * mass_of(s))
        .sum::<Vector3<f64>>()
        / mass;
    let inertia = spheres.iter().map(|s| {
        let (m, d) = (mass_of(s), s.centre - centre);
        Matrix3::identity() * (0.4 * m * s.radius * s.radius + m * d.norm_squared())
            - d * d.transpose() * m
    });
    MassProperties {
        mass,
        centre,
        inertia: inertia.sum(),
    }
}

/// Principal moments in rising order, and the rotation from the principal frame.
fn principal_axes(inertia: &Matrix3<f64>) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let eigen = inertia.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let column = |i: usize| eigen.eigenvectors.column(order[i]).into_owned();
    let (x, y) = (column(0), column(1));
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let moments = Vector3::from_fn(|i, _| eigen.eigenvalues[order[i]]);
    (moments, UnitQuaternion::from_rotation_matrix(&axes))
}

/// Nearly even directions on the unit sphere (Fibonacci lattice).
fn fibonacci_directions(n: u32) -> Vec<Vector3<f64>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..n)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
            let (radius, angle) = ((1.0 - z * z).sqrt(), golden * f64::from(i));
            Vector3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
        .collect()
}

/// Refuses a value that is not a positive finite number.
fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::NotPositive { what, value })
    }
}

#[cfg(test)]
mod tests {
    use super::{Clump, Error, MassProperties, Sphere, properties_of_spheres};
    use nalgebra::{Matrix3, Rotation3, Vector3};

    fn dumbbell() -> Vec<Sphere> {
        [-2.0, 2.0]
            .map(|x| Sphere {
                centre: Vector3::new(x, 0.0, 0.0),
                radius: 1.0,
            })
            .to_vec()
    }

    /// Two unit spheres of mass m at distance 4: I = 2·(2/5)m along, + 2·m·2² across.
    #[test]
    fn inertia_of_a_dumbbell_is_the_textbook_value() {
        let properties = properties_of_spheres(&dumbbell(), 1.0);
        let m = properties.mass / 2.0;
        let body = Clump::new(&dumbbell(), &properties).unwrap();
        let expected = Vector3::new(0.8 * m, 8.8 * m, 8.8 * m);
        assert!(
            (body.inertia() - expected).norm() < 1e-12 * m,
            "{:?}",
            body.inertia()
        );
    }

    /// The principal frame does not depend on the frame in which the body was given.
    #[test]
    fn moving_and_turning_the_input_changes_nothing() {
        let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let shift = Vector3::new(5.0, -3.0, 0.5);
        let moved: Vec<Sphere> = dumbbell()
            .iter()
            .map(|s| Sphere {
                centre: turn * s.centre + shift,
                ..*s
            })
            .collect();
        let a = Clump::new(&dumbbell(), &properties_of_spheres(&dumbbell(), 2.0)).unwrap();
        let b = Clump::new(&moved, &properties_of_spheres(&moved, 2.0)).unwrap();
        assert!(
            (a.inertia() - b.inertia()).norm() < 1e-12 * a.inertia().norm(),
            "inertia differs"
        );
        assert!(
            (a.bounding_radius() - b.bounding_radius()).abs() < 1e-12,
            "radius differs"
        );
        let long_axis = b.spheres()[0].centre.x.abs();
        assert!(
            (long_axis - 2.0).abs() < 1e-12,
            "long axis is not x: {long_axis}"
        );
    }

    /// A small sphere in the middle of a 3 x 3 x 3 block of touching spheres is out of reach.
    #[test]
    fn the_middle_of_a_block_is_hidden() {
        let mut spheres = Vec::new();
        for i in 0..27_i32 {
            let at = |k: i32| f64::from(k % 3 - 1) * 2.0;
            spheres.push(Sphere {
                centre: Vector3::new(at(i), at(i / 3), at(i / 9)),
                radius: 1.0,
            });
        }
        let body = Clump::new(&spheres, &properties_of_spheres(&spheres, 1.0)).unwrap();
        assert_eq!(body.reached_by(1.0).spheres().len(), 26);
    }

    /// A blow at the tip of a rod of length 2 l (I = m l²/3 without its thickness) moves m/4.
    #[test]
    fn a_quarter_of_a_thin_rod_is_felt_at_its_tip() {
        let (mass, half) = (2.0, 5.0);
        let properties = MassProperties {
            mass,
            centre: Vector3::zeros(),
            inertia: Matrix3::from_diagonal(&Vector3::new(1e-9, 1.0, 1.0))
                * (mass * half * half / 3.0),
        };
        let tips = [-half, half].map(|x| Sphere {
            centre: Vector3::new(x, 0.0, 0.0),
            radius: 1e-12,
        });
        let rod = Clump::new(&tips, &properties).unwrap();
        assert!((rod.mass_felt_at_tip() / (0.25 * mass) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_massless_body_is_refused() {
        let properties = MassProperties {
            mass: 0.0,
            centre: Vector3::zeros(),
            inertia: Matrix3::identity(),
        };
        let error = Clump::new(&dumbbell(), &properties).unwrap_err();
        assert_eq!(
            error,
            Error::NotPositive {
                what: "mass in kg",
                value: 0.0
            }
        );
    }
}
