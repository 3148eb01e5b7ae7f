//! Seeds as agglomerates of single spheres that bonds hold together, as in the study.
//!
//! In the world each sphere is a body. Frames, series and readings see seeds: the pose of a seed is the mean
//! position of its spheres and the mean of their orientations, which is exact where the bonds are stiff.

use crate::build::Built;
use crate::{Error, Frame, Scene, SeedBody};
use contact_law::bond::{Bond, BondSettings, BondStrength};
use dem_solver::bonds::{Bonds, agglomerate};
use dem_solver::{Placement, World};
use input::quantity::{Length, Pressure};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Overlap of two spheres of a seed that counts as touching, as a share of the radius: bonds hold the
/// spheres where they are, and an overlap would push them apart from the start.
const TOUCHING: f64 = 1e-3;

/// How the spheres of a seed hold together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BondedSettings {
    /// Stiffness of a bond along its axis per area, N/m³.
    pub normal_stiffness_n_m3: f64,
    /// Stiffness across its axis per area, N/m³.
    pub shear_stiffness_n_m3: f64,
    /// Radius of a bond.
    pub radius: Length,
    /// Largest gap of two spheres that are bonded.
    pub largest_gap: Length,
    /// Damping ratio of each part of a bond.
    pub damping_ratio: f64,
    /// Tensile and shear strength; bonds never break if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<[Pressure; 2]>,
}

impl BondedSettings {
    /// The law of the bonds.
    ///
    /// # Errors
    ///
    /// Values outside their range.
    pub(crate) fn law(&self) -> Result<Bond, contact_law::Error> {
        Bond::new(&BondSettings {
            normal_stiffness: self.normal_stiffness_n_m3,
            shear_stiffness: self.shear_stiffness_n_m3,
            radius: self.radius.si(),
            damping_ratio: self.damping_ratio,
            strength: self.strength.map(|[tension, shear]| BondStrength {
                tension: tension.si(),
                shear: shear.si(),
            }),
        })
    }
}

/// The bonded seeds of a world.
#[derive(Debug, Clone)]
pub(crate) struct BondedSeeds {
    bonds: Bonds,
    /// Kind and first sphere of each seed.
    seeds: Vec<(usize, usize)>,
}

/// Spheres of all seeds and the pairs to be bonded.
#[derive(Debug, Clone, Default)]
pub(crate) struct Parts {
    /// Where the spheres start.
    pub(crate) placements: Vec<Placement>,
    /// Pairs to be bonded.
    pairs: Vec<[usize; 2]>,
    /// Kind and first sphere of each seed.
    seeds: Vec<(usize, usize)>,
}

impl Parts {
    /// Takes seeds in their places apart.
    ///
    /// # Errors
    ///
    /// Seeds whose spheres overlap, or that the bonds do not hold together.
    pub(crate) fn of(
        scene: &Scene,
        settings: &BondedSettings,
        bodies: &[Arc<SeedBody>],
        places: &[Placement],
    ) -> Result<Self, Error> {
        for (kind, body) in scene.seed.iter().zip(bodies) {
            let spheres = body.clump.spheres();
            let deep = spheres.iter().enumerate().any(|(k, a)| {
                spheres[..k].iter().any(|b| {
                    let overlap = a.radius + b.radius - (a.centre - b.centre).norm();
                    overlap > TOUCHING * a.radius.min(b.radius)
                })
            });
            if deep {
                return Err(Error::BadValue {
                    name: "model.bonds".into(),
                    value: format!("seed '{}' whose spheres overlap", kind.name),
                    requirement: "seeds of separate spheres: filling method pack or lattice".into(),
                });
            }
        }
        let mut first = vec![0];
        for body in bodies {
            first.push(first.last().copied().unwrap_or(0) + body.clump.spheres().len());
        }
        let mut all = Self::default();
        for place in places {
            let (kind, at) = (place.template, all.placements.len());
            let clump = &bodies[kind].clump;
            let gap = settings.largest_gap.si();
            let parts =
                agglomerate(clump, place, first[kind], at, gap).map_err(|source| Error::Bonds {
                    seed: scene.seed[kind].name.clone(),
                    source,
                })?;
            all.seeds.push((kind, at));
            all.placements.extend(parts.placements);
            all.pairs.extend(parts.pairs);
        }
        Ok(all)
    }

    /// Largest number of bonds of one sphere.
    fn most_bonds(&self) -> usize {
        let mut bonds = vec![0_usize; self.placements.len()];
        for k in self.pairs.iter().flatten() {
            bonds[*k] += 1;
        }
        bonds.into_iter().max().unwrap_or(0)
    }

    /// Bonds the spheres of a world of a scene file, and the longest time step that resolves them, s.
    ///
    /// # Errors
    ///
    /// Invalid bonds.
    pub(crate) fn bond(
        self,
        (settings, file): (&BondedSettings, &str),
        world: &World,
    ) -> Result<(BondedSeeds, f64), Error> {
        let law = settings.law().map_err(|source| Error::Contact {
            file: file.into(),
            pair: "model.bonds".into(),
            source,
        })?;
        let most = self.most_bonds();
        let bonds = Bonds::new(world, &self.pairs, law).map_err(|source| Error::Bonds {
            seed: "model.bonds".into(),
            source,
        })?;
        let step = bonds.longest_time_step(most);
        let seeds = self.seeds;
        Ok((BondedSeeds { bonds, seeds }, step))
    }
}

impl BondedSeeds {
    /// Moves a world by one step.
    ///
    /// # Errors
    ///
    /// A body that has run away.
    pub(crate) fn step(&mut self, world: &mut World) -> Result<(), dem_solver::Error> {
        self.bonds.step(world)
    }

    /// Kind of each seed.
    pub(crate) fn kinds(&self) -> Vec<usize> {
        self.seeds.iter().map(|seed| seed.0).collect()
    }

    /// Bonds that have broken, by their number.
    pub(crate) fn broken(&self) -> Vec<usize> {
        self.bonds.broken()
    }

    /// Breaks bonds by their number, and no others.
    ///
    /// # Errors
    ///
    /// A number that no bond has, in words.
    pub(crate) fn set_broken(&mut self, broken: &[usize]) -> Result<(), String> {
        self.bonds.set_broken(broken).map_err(|e| e.to_string())
    }

    /// Number of bonds that have broken.
    pub(crate) fn n_broken(&self) -> usize {
        self.bonds.n_broken()
    }

    /// The seeds as bodies.
    pub(crate) fn frame(&self, built: &Built, time: f64) -> Frame {
        let world = built.world.bodies();
        let mut frame = Frame {
            time,
            kind: Vec::new(),
            position: Vec::new(),
            orientation: Vec::new(),
            velocity: Vec::new(),
            spin: Vec::new(),
            walls: Vec::new(),
        };
        for &(kind, first) in &self.seeds {
            let spheres = built.bodies[kind].clump.spheres();
            let range = first..first + spheres.len();
            let n = spheres.len() as f64;
            let mean = |vectors: &[Vector3<f64>]| vectors.iter().sum::<Vector3<f64>>() / n;
            let turns = &world.orientation[range.clone()];
            let turn = turns.iter().fold(Quaternion::default(), |sum, q| {
                let same = if q.coords.dot(&turns[0].coords) < 0.0 {
                    -1.0
                } else {
                    1.0
                };
                sum + q.into_inner() * same
            });
            let turn = UnitQuaternion::new_normalize(turn);
            // The middle of the spheres is not the centre of mass of the seed.
            let middle = spheres.iter().map(|s| s.centre).sum::<Vector3<f64>>() / n;
            let arm = turn * -middle;
            let spin = mean(&world.spin[range.clone()]);
            frame.kind.push(kind);
            frame.position.push(
                built
                    .world
                    .between_sides(&(mean(&world.position[range.clone()]) + arm)),
            );
            frame.orientation.push(turn);
            frame
                .velocity
                .push(mean(&world.velocity[range]) + spin.cross(&arm));
            frame.spin.push(spin);
        }
        frame
    }
}
