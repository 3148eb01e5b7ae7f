//! The world: bodies, walls, laws, and the step.

use crate::batch::Batch;
use crate::bodies::{Bodies, Placement};
use crate::broad_phase::Grid;
use crate::contact::Interaction;
use crate::integrate::{Step, advance};
use crate::neighbours::{Census, Neighbours};
use crate::pair_force::{Context, add_pair_forces};
use crate::template::Template;
use crate::wall::Wall;
use crate::wall_force::WallNeighbours;
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

/// Why a world cannot be built or cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is not a positive finite number.
    #[error("{name} is {value}; it must be a positive finite number")]
    NotPositive {
        /// Name of the setting, with its unit.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// An index points to nothing.
    #[error("{what} {index} does not exist: there are {count}")]
    NoSuch {
        /// Template or material.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// The table of interactions is not a full square.
    #[error("{got} interactions given, {expected} needed: one for each ordered pair of materials")]
    Interactions {
        /// Number given.
        got: usize,
        /// Number needed.
        expected: usize,
    },
    /// A shape that is no surface of revolution was given a spin.
    #[error("wall '{wall}' spins about z but is no surface of revolution about z")]
    SpinningShape {
        /// Name of the wall.
        wall: String,
    },
    /// A template has more spheres than an index of 16 bits can name.
    #[error("a body type has {count} spheres in the contact search, at most 65535 are possible")]
    TooManySpheres {
        /// Number of spheres.
        count: usize,
    },
    /// A body has left every bound.
    #[error(
        "body {body} is at a position that is not a number after {time} s: the time step \
         {time_step} s is too large for the contacts, or bodies overlapped at the start"
    )]
    Diverged {
        /// Index of the body.
        body: usize,
        /// Time, s.
        time: f64,
        /// Time step, s.
        time_step: f64,
    },
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
    /// Buffer of contacts.
    batch: Batch,
    /// Force on each wall in the last step, N.
    wall_load: Vec<Vector3<f64>>,
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
    /// Settings that are not positive, indices out of range, a spinning wall that is no surface
    /// of revolution.
    pub fn new(
        settings: Settings,
        templates: Vec<Template>,
        interactions: Vec<Interaction>,
        walls: Vec<Wall>,
        placements: &[Placement],
    ) -> Result<Self, Error> {
        let checks = [
            ("time step in s", settings.time_step),
            ("skin in m", settings.skin),
            ("margin in m", settings.margin),
        ];
        for (name, value) in checks {
            if !value.is_finite() || value <= 0.0 {
                return Err(Error::NotPositive { name, value });
            }
        }
        let n_materials = interactions.len().isqrt();
        if n_materials * n_materials != interactions.len() {
            let expected = (n_materials + 1) * (n_materials + 1);
            return Err(Error::Interactions { got: interactions.len(), expected });
        }
        check_parts(&templates, &walls, n_materials)?;
        let mut bodies = Bodies::default();
        for placement in placements {
            let template = templates.get(placement.template).ok_or(Error::NoSuch {
                what: "body type",
                index: placement.template,
                count: templates.len(),
            })?;
            bodies.push(placement, template);
        }
        let radii = bodies.template.iter().map(|&t| templates[t].bounding_radius).collect();
        let wall_load = vec![Vector3::zeros(); walls.len()];
        let mut world = Self {
            templates,
            interactions,
            n_materials,
            bodies,
            walls,
            settings,
            time: 0.0,
            n_steps: 0,
            neighbours: Neighbours::default(),
            wall_neighbours: WallNeighbours::default(),
            grid: Grid::default(),
            radii,
            batch: Batch::default(),
            wall_load,
            reference_spin: 0.0,
            longest: f32::INFINITY,
        };
        world.choose_reference_spin();
        Ok(world)
    }

    /// Sets the spin of the named wall, rad/s; false if there is no such wall.
    pub fn set_wall_spin(&mut self, name: &str, spin: f64) -> bool {
        let mut found = false;
        for wall in self.walls.iter_mut().filter(|w| w.name == name) {
            wall.spin = spin;
            found = true;
        }
        self.choose_reference_spin();
        found
    }

    /// Moves the world by one step.
    ///
    /// # Errors
    ///
    /// A body whose position is no longer a number.
    pub fn step(&mut self) -> Result<(), Error> {
        if f64::from(self.longest) > 0.5 * self.settings.margin {
            self.search_pairs()?;
        }
        self.bodies.force.fill(Vector3::zeros());
        self.bodies.torque.fill(Vector3::zeros());
        self.wall_load.fill(Vector3::zeros());
        #[expect(clippy::cast_possible_truncation, reason = "the lists have a safety distance")]
        let skin = self.settings.skin as f32;
        let context = Context {
            templates: &self.templates,
            interactions: &self.interactions,
            n_materials: self.n_materials,
            skin,
            time_step: self.settings.time_step,
        };
        let (neighbours, batch) = (&mut self.neighbours, &mut self.batch);
        add_pair_forces(neighbours, &mut self.bodies, batch, &context);
        let walls = &mut self.wall_neighbours;
        walls.add_forces(&mut self.bodies, &self.walls, &context, &mut self.wall_load);
        let step = Step {
            time_step: self.settings.time_step,
            gravity: self.settings.gravity,
            reference_spin: self.reference_spin,
        };
        self.longest = advance(&mut self.bodies, &self.templates, &step);
        self.n_steps += 1;
        self.time += self.settings.time_step;
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
        self.wall_neighbours.n_contacts()
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

    /// What the force loops need; for the plain reference.
    pub(crate) fn context(&self) -> Context<'_> {
        Context {
            templates: &self.templates,
            interactions: &self.interactions,
            n_materials: self.n_materials,
            skin: 0.0,
            time_step: self.settings.time_step,
        }
    }

    /// Ways are counted in the frame of the walls if all are surfaces of revolution, otherwise
    /// in the frame at rest, in which the other walls stand still.
    fn choose_reference_spin(&mut self) {
        let revolved = self.walls.iter().all(Wall::is_axisymmetric);
        let spins = self.walls.iter().map(|w| w.spin);
        self.reference_spin = if revolved { spins.fold(0.0, largest) } else { 0.0 };
    }

    /// Finds the pairs of bodies and of bodies and walls.
    fn search_pairs(&mut self) -> Result<(), Error> {
        for (body, p) in self.bodies.position.iter().enumerate() {
            if !p.iter().all(|c| c.is_finite()) {
                let time_step = self.settings.time_step;
                return Err(Error::Diverged { body, time: self.time, time_step });
            }
        }
        let (neighbours, travel) = (&mut self.neighbours, &self.bodies.travel);
        neighbours.begin();
        self.grid.pairs(&self.bodies.position, &self.radii, self.settings.margin, |i, partners| {
            neighbours.add(i, partners, travel);
        });
        let margin = self.settings.margin;
        self.wall_neighbours.rebuild(&self.bodies, &self.templates, &self.walls, margin);
        self.bodies.travel.fill(0.0);
        Ok(())
    }
}

/// The spin of larger size.
fn largest(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// Checks indices, sphere counts and spins.
fn check_parts(templates: &[Template], walls: &[Wall], n_materials: usize) -> Result<(), Error> {
    let materials =
        templates.iter().map(|t| t.material).chain(walls.iter().map(|w| w.material));
    for index in materials {
        if index >= n_materials {
            return Err(Error::NoSuch { what: "material", index, count: n_materials });
        }
    }
    for template in templates {
        let count = template.n_outer_spheres();
        if count > usize::from(u16::MAX) {
            return Err(Error::TooManySpheres { count });
        }
    }
    match walls.iter().find(|w| w.spin != 0.0 && !w.is_axisymmetric()) {
        Some(wall) => Err(Error::SpinningShape { wall: wall.name.clone() }),
        None => Ok(()),
    }
}
