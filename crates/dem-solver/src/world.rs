//! The world: bodies, walls, laws, and the step.

use crate::batch::Batch;
use crate::bodies::{Bodies, Placement};
use crate::broad_phase::Grid;
use crate::check;
use crate::contact::Interaction;
use crate::error::Error;
use crate::integrate::{Surroundings, advance};
use crate::mesh_force::MeshWalls;
use crate::mesh_wall::{MeshWall, Motion};
use crate::neighbours::{Census, Neighbours};
use crate::pair_force::{Context, Slack, add_pair_forces};
use crate::template::Template;
use crate::wall::Wall;
use crate::wall_force::WallNeighbours;
use fearless_simd::Level;
use nalgebra::Vector3;

/// What a world needs beside bodies and walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Time step, s.
    pub time_step: f64,
    /// Gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Skin of the sphere lists, m. It decides the speed only: a third to a half of the sphere
    /// radius is a flat optimum.
    pub skin: f64,
    /// Margin of the bounding spheres, m. It decides the speed only.
    pub margin: f64,
}

/// Bodies, walls and laws, and the time.
#[derive(Debug, Clone)]
pub struct World {
    /// Body types.
    templates: Vec<Template>,
    /// Interactions by material, row by row.
    interactions: Vec<Interaction>,
    /// Number of materials.
    n_materials: usize,
    /// State of the bodies.
    bodies: Bodies,
    /// Walls.
    walls: Vec<Wall>,
    /// Settings.
    settings: Settings,
    /// Distances of the sphere lists.
    slack: Slack,
    /// Time since the start, s.
    time: f64,
    /// Steps since the start.
    n_steps: u64,
    /// Pairs of bodies.
    neighbours: Neighbours,
    /// Bodies near walls.
    wall_neighbours: WallNeighbours,
    /// Grid of the broad phase.
    grid: Grid,
    /// Bounding radii by body, m.
    radii: Vec<f64>,
    /// Instruction set of the processor.
    level: Level,
    /// Buffer of contacts.
    batch: Batch,
    /// Force on each wall in the last step, N.
    wall_load: Vec<Vector3<f64>>,
    /// Torque about the z axis on each wall in the last step, N m.
    wall_torque: Vec<f64>,
    /// Walls of triangles.
    mesh_walls: MeshWalls,
    /// Spin of the frame in which ways are counted, rad/s.
    reference_spin: f64,
    /// Longest way of a body since the last broad phase, m; infinite when there is none yet.
    longest: f32,
}

impl World {
    /// Builds a world.
    ///
    /// `interactions` holds, row by row, the interaction of each material with each.
    ///
    /// # Errors
    ///
    /// Settings that are not positive, numbers that are not finite, indices out of range, a table
    /// of interactions that depends on the order of two bodies, a wall whose numbers do not
    /// describe its shape, a spinning wall that is no surface of revolution, a body whose centre
    /// is behind a wall.
    pub fn new(
        settings: Settings,
        templates: Vec<Template>,
        interactions: Vec<Interaction>,
        walls: Vec<Wall>,
        placements: &[Placement],
    ) -> Result<Self, Error> {
        check::settings(&settings)?;
        let n_materials = check::interactions(&interactions, &templates, &walls)?;
        check::templates(&templates)?;
        walls.iter().try_for_each(check::wall)?;
        let mut bodies = Bodies::default();
        for (body, placement) in placements.iter().enumerate() {
            check::placement(body, placement, &walls)?;
            let template = templates.get(placement.template).ok_or(Error::NoSuch {
                what: "body type",
                index: placement.template,
                count: templates.len(),
            })?;
            bodies.push(placement, template);
        }
        let radii: Vec<_> = bodies
            .template
            .iter()
            .map(|&t| templates[t].bounding_radius)
            .collect();
        let slack = Slack::new(radii.iter().copied().fold(0.0, f64::max), &settings);
        let wall_load = vec![Vector3::zeros(); walls.len()];
        let wall_torque = vec![0.0; walls.len()];
        let mut world = Self {
            templates,
            interactions,
            n_materials,
            bodies,
            walls,
            settings,
            slack,
            time: 0.0,
            n_steps: 0,
            neighbours: Neighbours::default(),
            wall_neighbours: WallNeighbours::default(),
            grid: Grid::default(),
            radii,
            level: Level::new(),
            batch: Batch::default(),
            wall_load,
            wall_torque,
            mesh_walls: MeshWalls::default(),
            reference_spin: 0.0,
            longest: f32::INFINITY,
        };
        world.choose_reference_spin();
        Ok(world)
    }

    /// Sets the spin of all walls of a name, rad/s.
    ///
    /// Changes nothing and returns false if there is no such wall, if one of them is no surface
    /// of revolution about z, or if the spin is not finite.
    pub fn set_wall_spin(&mut self, name: &str, spin: f64) -> bool {
        let mut named = self.walls.iter().filter(|w| w.name == name).peekable();
        if named.peek().is_none() || !named.all(Wall::is_axisymmetric) || !spin.is_finite() {
            return false;
        }
        for wall in self.walls.iter_mut().filter(|w| w.name == name) {
            wall.spin = spin;
        }
        self.choose_reference_spin();
        true
    }

    /// Adds a wall of triangles at its start.
    ///
    /// # Errors
    ///
    /// No triangles, corners or motion that are not finite, a triangle without area, a material
    /// out of range.
    pub fn add_mesh_wall(&mut self, wall: MeshWall) -> Result<(), Error> {
        if wall.material >= self.n_materials {
            return Err(Error::NoSuch {
                what: "material",
                index: wall.material,
                count: self.n_materials,
            });
        }
        self.mesh_walls.add(wall)?;
        self.longest = f32::INFINITY;
        self.choose_reference_spin();
        Ok(())
    }

    /// Changes velocity, spin and vibration of all walls of triangles of a name; their centre of
    /// rotation stays what it is. False if there is no such wall or a number is not finite.
    pub fn set_mesh_motion(&mut self, name: &str, motion: &Motion) -> bool {
        self.mesh_walls.set_motion(name, motion)
    }

    /// Moves the world by one step.
    ///
    /// # Errors
    ///
    /// A body that has run away or whose state is no longer a number.
    pub fn step(&mut self) -> Result<(), Error> {
        self.step_with(|_| {})
    }

    /// Moves the world by one step in which further forces act, such as those of bonds.
    ///
    /// `further` adds to `force` (N) and `torque` (N m about the centre of mass) of the bodies.
    ///
    /// # Errors
    ///
    /// A body that has run away or whose state is no longer a number.
    pub fn step_with(&mut self, further: impl FnOnce(&mut Bodies)) -> Result<(), Error> {
        let half = 0.5 * self.settings.margin;
        if f64::from(self.longest) > half || self.mesh_walls.longest() > half {
            self.search_pairs()?;
        }
        self.bodies.force.fill(Vector3::zeros());
        self.bodies.torque.fill(Vector3::zeros());
        self.wall_load.fill(Vector3::zeros());
        self.wall_torque.fill(0.0);
        let context = Context {
            templates: &self.templates,
            interactions: &self.interactions,
            n_materials: self.n_materials,
            slack: self.slack,
            time_step: self.settings.time_step,
        };
        let (neighbours, batch) = (&mut self.neighbours, &mut self.batch);
        add_pair_forces(self.level, neighbours, &mut self.bodies, batch, &context);
        let walls = &mut self.wall_neighbours;
        let loads = (
            self.wall_load.as_mut_slice(),
            self.wall_torque.as_mut_slice(),
        );
        walls.add_forces(&mut self.bodies, &self.walls, &context, loads);
        self.mesh_walls.add_forces(&mut self.bodies, &context);
        further(&mut self.bodies);
        let around = Surroundings {
            time_step: self.settings.time_step,
            gravity: self.settings.gravity,
            reference_spin: self.reference_spin,
        };
        self.longest = advance(self.level, &mut self.bodies, &self.templates, &around);
        self.n_steps += 1;
        self.time += self.settings.time_step;
        self.mesh_walls.advance(self.settings.time_step, self.time);
        Ok(())
    }

    /// Bodies.
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// Body types.
    pub fn templates(&self) -> &[Template] {
        &self.templates
    }

    /// Walls.
    pub fn walls(&self) -> &[Wall] {
        &self.walls
    }

    /// Force on each wall in the last step, N.
    pub fn wall_load(&self) -> &[Vector3<f64>] {
        &self.wall_load
    }

    /// Torque about the z axis on each wall in the last step, N m.
    pub fn wall_torque(&self) -> &[f64] {
        &self.wall_torque
    }

    /// Walls of triangles, as they were given, with their motion of now.
    pub fn mesh_walls(&self) -> impl Iterator<Item = &MeshWall> {
        self.mesh_walls.moving.iter().map(|m| &m.wall)
    }

    /// Force (N) on each wall of triangles in the last step, and its torque (N m) about the
    /// centre of rotation.
    pub fn mesh_loads(&self) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + '_ {
        self.mesh_walls.moving.iter().map(|m| (m.force, m.torque))
    }

    /// Triangles of a wall of triangles where they are now, m.
    pub fn mesh_triangles(&self, wall: usize) -> Vec<[Vector3<f64>; 3]> {
        self.mesh_walls.moving.get(wall).map_or_else(Vec::new, |m| {
            (0..m.wall.triangles.len())
                .map(|t| m.corners_now(t))
                .collect()
        })
    }

    /// Time since the start, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps since the start.
    pub fn n_steps(&self) -> u64 {
        self.n_steps
    }

    /// Settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Sizes of the contact lists.
    pub fn census(&self) -> Census {
        self.neighbours.census()
    }

    /// Number of touching spheres at all walls.
    pub fn n_wall_contacts(&self) -> usize {
        self.wall_neighbours.n_contacts() + self.mesh_walls.n_contacts()
    }

    /// Kinetic energy of translation and rotation, J.
    pub fn kinetic_energy(&self) -> f64 {
        let b = &self.bodies;
        (0..b.len())
            .map(|i| {
                let translation = self.templates[b.template[i]].mass * b.velocity[i].norm_squared();
                0.5 * (translation + b.angular_momentum[i].dot(&b.spin[i]))
            })
            .sum()
    }

    /// Touching spheres of two bodies: (body, body, key of the spheres), as of the last step.
    pub(crate) fn touching_spheres(&self) -> impl Iterator<Item = (usize, usize, u32)> + '_ {
        let n = &self.neighbours;
        let pairs = (0..n.start.len().saturating_sub(1))
            .flat_map(move |i| (n.start[i] as usize..n.start[i + 1] as usize).map(move |k| (i, k)));
        pairs.flat_map(move |(i, k)| {
            let lists = &n.lists[k];
            let touches = lists.touch as usize..(lists.touch + lists.n_touches) as usize;
            let j = n.heads[k].j as usize;
            n.touches[touches].iter().map(move |t| (i, j, t.key))
        })
    }

    /// What the force loops need; for the plain reference.
    pub(crate) fn context(&self) -> Context<'_> {
        Context {
            templates: &self.templates,
            interactions: &self.interactions,
            n_materials: self.n_materials,
            slack: self.slack,
            time_step: self.settings.time_step,
        }
    }

    /// Ways are counted in the frame of the walls if all are surfaces of revolution, otherwise
    /// in the frame at rest, in which the other walls stand still. A change of frame needs no new
    /// lists: gaps between bodies, and between bodies and walls of revolution, are the same in
    /// both frames, and the ways before and after the change add up to a bound in either.
    fn choose_reference_spin(&mut self) {
        let revolved =
            self.walls.iter().all(Wall::is_axisymmetric) && self.mesh_walls.moving.is_empty();
        let spins = self.walls.iter().map(|w| w.spin);
        self.reference_spin = if revolved {
            spins.fold(0.0, largest)
        } else {
            0.0
        };
    }

    /// Finds the pairs of bodies and of bodies and walls.
    fn search_pairs(&mut self) -> Result<(), Error> {
        let lost = |body: &usize| {
            let position = &self.bodies.position[*body];
            !position.iter().all(|c| c.is_finite()) || !self.bodies.travel[*body].is_finite()
        };
        if let Some(body) = (0..self.bodies.len()).find(lost) {
            let time_step = self.settings.time_step;
            return Err(Error::Diverged {
                body,
                time: self.time,
                time_step,
            });
        }
        let (neighbours, travel) = (&mut self.neighbours, &self.bodies.travel);
        neighbours.begin();
        self.grid.pairs(
            self.level,
            &self.bodies.position,
            &self.radii,
            self.settings.margin,
            |i, partners| {
                neighbours.add(i, partners, travel);
            },
        );
        let margin = self.settings.margin;
        self.wall_neighbours
            .rebuild(&self.bodies, &self.templates, &self.walls, margin);
        self.mesh_walls
            .rebuild(&self.bodies, &self.templates, margin);
        self.bodies.travel.fill(0.0);
        Ok(())
    }
}

/// The spin of larger size.
fn largest(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}
