//! Agglomerates of spheres that elastic bonds hold together.
//!
//! In the study each sphere of a seed is a body of its own, and bonds hold a seed together. Here the
//! spheres are bodies of a [`World`], and [`Bonds::step`] adds the forces of
//! [`contact_law::bond`] to each of its steps. A rigid agglomerate is the limit of stiff bonds, at a
//! small part of the cost: the bonded one needs a time step that resolves a single sphere on its
//! bonds ([`Bonds::longest_time_step`]). Take it where seeds may bend or break, and the rigid one
//! everywhere else.
//!
//! Bonded spheres that touch feel their contact as well, as in the study's model.

mod agglomerate;

pub use agglomerate::{Agglomerate, agglomerate};

use crate::load::Load;
use crate::{Bodies, World};
use contact_law::bond::{Bond, Deformation, ReducedInertia};
use nalgebra::{UnitQuaternion, Vector3};

/// Errors of bonds.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A bond names a body that does not exist, or twice the same.
    #[error("bond {bond} joins bodies {i} and {j}; they must be two of the {count} bodies")]
    NoSuchPair {
        /// Index of the bond.
        bond: usize,
        /// One body.
        i: usize,
        /// The other.
        j: usize,
        /// Number of bodies.
        count: usize,
    },
    /// A bond that does not exist.
    #[error("there is no bond {bond} of {count}")]
    NoSuchBond {
        /// Its number.
        bond: usize,
        /// Number of bonds.
        count: usize,
    },
    /// A length that decides which spheres are bonded makes no sense.
    #[error("the largest gap of bonded spheres is {gap} m; it must be 0 m or more")]
    Gap {
        /// The value.
        gap: f64,
    },
    /// An agglomerate that its bonds do not hold together.
    #[error(
        "{loose} of {count} spheres are not bonded to the first one: raise the largest gap of \
         bonded spheres above {gap} m"
    )]
    Loose {
        /// Spheres apart from the first.
        loose: usize,
        /// Number of spheres.
        count: usize,
        /// Largest gap, m.
        gap: f64,
    },
}

/// One bond between two bodies.
#[derive(Debug, Clone)]
struct Link {
    /// The two bodies.
    bodies: [usize; 2],
    /// Where the bond is fixed on each, in its frame, m.
    anchors: [Vector3<f64>; 2],
    /// Orientation of j in the frame of i when the bond was made.
    reference: UnitQuaternion<f64>,
    /// Inertia for the dashpots.
    inertia: ReducedInertia,
    /// Whether it has broken.
    broken: bool,
}

/// All bonds of a world; one law for all.
#[derive(Debug, Clone)]
pub struct Bonds {
    law: Bond,
    /// Bonds in the order in which they were given.
    links: Vec<Link>,
}

impl Bonds {
    /// Bonds pairs of bodies of a world as they are now, each in the middle between the two centres.
    ///
    /// # Errors
    ///
    /// A bond between two bodies that do not exist, or one twice.
    pub fn new(world: &World, pairs: &[[usize; 2]], law: Bond) -> Result<Self, Error> {
        let (bodies, templates) = (world.bodies(), world.templates());
        let mut links = Vec::with_capacity(pairs.len());
        for (bond, &[i, j]) in pairs.iter().enumerate() {
            let count = bodies.len();
            if i == j || i.max(j) >= count {
                return Err(Error::NoSuchPair { bond, i, j, count });
            }
            let middle = 0.5 * (bodies.position[i] + bodies.position[j]);
            let anchor = |k: usize| bodies.orientation[k].inverse() * (middle - bodies.position[k]);
            let mass = |k: usize| templates[bodies.template[k]].mass();
            let moment = |k: usize| {
                let template = &templates[bodies.template[k]];
                0.4 * template.mass() * template.bounding_radius().powi(2)
            };
            let reduced = |f: &dyn Fn(usize) -> f64| f(i) * f(j) / (f(i) + f(j));
            links.push(Link {
                bodies: [i, j],
                anchors: [anchor(i), anchor(j)],
                reference: bodies.orientation[i].inverse() * bodies.orientation[j],
                inertia: ReducedInertia {
                    mass: reduced(&mass),
                    moment: reduced(&moment),
                },
                broken: false,
            });
        }
        Ok(Self { law, links })
    }

    /// Moves the world by one step under the forces of the bonds.
    ///
    /// # Errors
    ///
    /// A body that has run away.
    pub fn step(&mut self, world: &mut World) -> Result<(), crate::Error> {
        world.step_with(|bodies| self.add_forces(bodies))
    }

    /// Adds the forces of all bonds to the bodies; bonds above their strength break.
    pub fn add_forces(&mut self, bodies: &mut Bodies) {
        for link in self.links.iter_mut().filter(|l| !l.broken) {
            let [i, j] = link.bodies;
            let turned = |k: usize, side: usize| bodies.orientation[k] * link.anchors[side];
            let (arm_i, arm_j) = (turned(i, 0), turned(j, 1));
            let between = bodies.position[j] - bodies.position[i];
            let displacement = arm_i - between - arm_j;
            let rotation = bodies.orientation[i] * link.reference * bodies.orientation[j].inverse();
            // Both sides feel the force at one point, so that angular momentum is kept.
            let arm_i = arm_i - displacement * 0.5;
            let arm_j = arm_j + displacement * 0.5;
            let velocity = bodies.velocity[i] + bodies.spin[i].cross(&arm_i)
                - bodies.velocity[j]
                - bodies.spin[j].cross(&arm_j);
            let deformation = Deformation {
                axis: between.normalize(),
                displacement,
                rotation: rotation.scaled_axis(),
                velocity,
                spin: bodies.spin[i] - bodies.spin[j],
            };
            let load = self.law.load(&deformation, &link.inertia);
            if load.breaks {
                link.broken = true;
                continue;
            }
            let [on_i, on_j] = [arm_i, arm_j].map(|arm| load.moment + arm.cross(&load.force));
            bodies.load[i] += Load::new(&load.force, &on_i);
            bodies.load[j] += Load::new(&-load.force, &-on_j);
        }
    }

    /// Bonds that have broken, by their number in the order in which they were given.
    pub fn broken(&self) -> Vec<usize> {
        let all = self.links.iter().enumerate();
        all.filter(|(_, link)| link.broken)
            .map(|(k, _)| k)
            .collect()
    }

    /// Breaks bonds by their number, and mends all others: with the bodies where they were, what continues from a kept state.
    ///
    /// # Errors
    ///
    /// A number that no bond has.
    pub fn set_broken(&mut self, broken: &[usize]) -> Result<(), Error> {
        let count = self.links.len();
        if let Some(&bond) = broken.iter().find(|bond| **bond >= count) {
            return Err(Error::NoSuchBond { bond, count });
        }
        for link in &mut self.links {
            link.broken = false;
        }
        for &bond in broken {
            self.links[bond].broken = true;
        }
        Ok(())
    }

    /// Number of bonds that hold.
    pub fn n_whole(&self) -> usize {
        self.links.iter().filter(|l| !l.broken).count()
    }

    /// Number of bonds that have broken.
    pub fn n_broken(&self) -> usize {
        self.links.len() - self.n_whole()
    }

    /// Longest time step that resolves a sphere on its bonds: a tenth of the shortest period
    /// `2 pi sqrt(m / k)`, s; infinite without bonds.
    ///
    /// A sphere has up to `most` bonds, all of which add to its stiffness. The explicit scheme is
    /// stable up to `2 sqrt(m / k)`, that is three tenths of the period; the rest is for accuracy.
    pub fn longest_time_step(&self, most: usize) -> f64 {
        let [stretch, shear, twist, bend] = self.law.stiffnesses();
        let many = most.max(1) as f64;
        let shortest = self.links.iter().map(|l| {
            let arm = l.anchors[0].norm();
            let turning = twist.max(bend) + shear * arm * arm;
            let by_way = l.inertia.mass / (stretch.max(shear) * many);
            by_way.min(l.inertia.moment / (turning * many)).sqrt()
        });
        0.1 * std::f64::consts::TAU * shortest.fold(f64::INFINITY, f64::min)
    }
}
