//! The world: bodies, walls, laws, and the step.

mod order;
mod state;
mod sweep;
mod wet;

use crate::advance::advance;
use crate::batch::Loads;
use crate::bodies::{Bodies, Placement};
use crate::broad_phase::BodyGrid;
use crate::census::Census;
use crate::check;
use crate::context::{Context, Cutoffs};
use crate::error::Error;
use crate::integrate::Surroundings;
use crate::interaction::Interaction;
use crate::liquid::{Liquid, most_given};
use crate::mesh_force::MeshWalls;
use crate::mesh_wall::{MeshPose, MeshWall, Motion, Moving};
use crate::part::{Part, find_loads, give_loads};
use crate::periodic::Period;
use crate::phases::{Clock, StepPhases};
use crate::settings::Settings;
use crate::spheres::sphere::Sphere;
use crate::template::Template;
use crate::wall::Wall;
use crate::window::Window;
use crate::workspace::Workspace;
use fearless_simd::Level;
use nalgebra::Vector3;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::mem::take;
use std::sync::Arc;

/// Pieces of work for each thread: enough that no thread waits long for another.
const PIECES_PER_THREAD: usize = 4;
/// Most bodies of a part where sweeps cannot be: a workspace holds the lists of one part of before.
const MOST_BODIES_OF_PART: usize = 1 << 14;

/// Bodies, walls and laws, and the time.
#[derive(Debug, Clone)]
pub struct World {
    /// Body types.
    templates: Vec<Template>,
    /// Interactions by material, row by row.
    interactions: Vec<Interaction>,
    n_materials: usize,
    /// State of the bodies.
    bodies: Bodies,
    /// Copy of the bodies for the forces between them where all are spheres; empty in another world.
    spheres: Vec<Sphere>,
    walls: Vec<Wall>,
    settings: Settings,
    /// Periodic sides.
    period: Period,
    /// Distances of the sphere lists.
    cutoffs: Cutoffs,
    /// Time since the start, s.
    time: f64,
    /// Steps since the start.
    n_steps: u64,
    /// Lists of ranges of bodies.
    parts: Vec<Part>,
    /// For each part the last one whose contacts act on its bodies, in a world of spheres.
    last_partners: Vec<usize>,
    /// What the threads work with, one for each piece of work; a piece is as many parts in a row.
    workspaces: Vec<Workspace>,
    /// Threads of one step; none if it runs on the caller's.
    pool: Option<Arc<ThreadPool>>,
    /// Grid of the broad phase.
    grid: BodyGrid,
    /// Bounding radii by body, m.
    radii: Vec<f64>,
    /// Instruction set of the processor.
    level: Level,
    /// Force on each wall in the last step, N.
    wall_load: Vec<Vector3<f64>>,
    /// Torque about the z axis on each wall in the last step, N m.
    wall_torque: Vec<f64>,
    /// Walls of triangles.
    mesh_walls: MeshWalls,
    /// Liquid of the bodies in their bridges.
    liquid: Liquid,
    /// Spin of the frame in which travels are measured, rad/s.
    reference_spin: f64,
    /// Longest displacement of a centre of mass since the last broad phase, m; infinite before the first.
    longest: f32,
    /// Time of the phases of the steps, where it is counted.
    phases: Option<StepPhases>,
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
    /// describe its shape, a spinning wall that is not a surface of revolution, a body whose centre
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
        let wettest = templates.iter().map(Template::liquid).fold(0.0, f64::max);
        let most_volume = 2.0 * most_given(wettest);
        let reach = interactions
            .iter()
            .map(|law| law.reach(most_volume))
            .fold(0.0, f64::max);
        let radii = templates.iter().map(|t| t.bounding_radius);
        let cutoffs = Cutoffs::new(radii.fold(0.0, f64::max), reach, &settings);
        let wall_load = vec![Vector3::zeros(); walls.len()];
        let wall_torque = vec![0.0; walls.len()];
        let mut world = Self {
            templates,
            interactions,
            n_materials,
            bodies: Bodies::default(),
            spheres: Vec::new(),
            walls,
            // A pair whose bridge may still hold must not be dropped.
            settings: Settings {
                margin: settings.margin + reach,
                ..settings
            },
            period: Period::default(),
            cutoffs,
            time: 0.0,
            n_steps: 0,
            parts: Vec::new(),
            last_partners: Vec::new(),
            workspaces: vec![Workspace::default()],
            pool: None,
            grid: BodyGrid::default(),
            radii: Vec::new(),
            level: Level::new(),
            wall_load,
            wall_torque,
            mesh_walls: MeshWalls::default(),
            liquid: Liquid::default(),
            reference_spin: 0.0,
            longest: f32::INFINITY,
            phases: None,
        };
        world.choose_reference_spin();
        world.push(placements)?;
        world.deal_liquid();
        Ok(world)
    }

    /// Adds bodies between two steps, numbered after the others, which keep their contacts.
    ///
    /// # Errors
    ///
    /// A placement that is not finite, of an unknown type or behind a wall; nothing is added then.
    pub fn insert(&mut self, placements: &[Placement]) -> Result<(), Error> {
        if placements.is_empty() {
            return Ok(());
        }
        let pairs: Vec<_> = self.kept_pairs().collect();
        let walls: Vec<_> = self.kept_walls().collect();
        self.push(placements)?;
        self.search_pairs()?;
        self.longest = 0.0;
        self.recall(&pairs, &walls)?;
        self.deal_liquid();
        Ok(())
    }

    /// Adds bodies, without lists.
    fn push(&mut self, placements: &[Placement]) -> Result<(), Error> {
        for (k, placement) in placements.iter().enumerate() {
            check::placement(self.bodies.len() + k, placement, &self.walls)?;
            if placement.template >= self.templates.len() {
                return Err(Error::NoSuch {
                    what: "body type",
                    index: placement.template,
                    count: self.templates.len(),
                });
            }
        }
        for placement in placements {
            let template = &self.templates[placement.template];
            self.bodies.push(placement, template);
            self.radii.push(template.bounding_radius);
        }
        self.cut_parts();
        Ok(())
    }

    /// Cuts the bodies into parts without lists, as many for each piece of work. The next step makes the lists.
    fn cut_parts(&mut self) {
        self.longest = f32::INFINITY;
        let (n_bodies, pieces) = (self.bodies.len(), self.workspaces.len());
        let most = if self.is_local() {
            sweep::BODIES_OF_PART
        } else {
            MOST_BODIES_OF_PART
        };
        let parts_of_piece = n_bodies.div_ceil(pieces * most).max(1);
        self.parts = Part::cut(n_bodies, pieces * parts_of_piece);
    }

    /// The world with periodic sides at z = `low` and `high`, m: bodies pass through one and come in at the other. The z coordinate
    /// of a body continues beyond them; [`World::between_sides`] gives the image between them.
    ///
    /// Walls are at their places between the sides: one that comes near a side must go beyond it by [`World::reach_of_bodies`], so
    /// that a body that passes stays at it. For a new world, before its first step.
    ///
    /// # Errors
    ///
    /// Sides nearer than twice the largest body, with twice the reach of a bridge of liquid, or for bodies of several spheres twice the
    /// margin of the lists, beside: two bodies would meet in two images at once.
    pub fn with_periodic_sides(mut self, low: f64, high: f64) -> Result<Self, Error> {
        let radii = self.templates.iter().map(|t| t.bounding_radius);
        let largest = radii.fold(0.0, f64::max);
        // A bridge of liquid holds two bodies beyond their touch; the margin contains its reach.
        let apart = if self.is_of_spheres() {
            f64::from(self.cutoffs.reach)
        } else {
            self.settings.margin
        };
        self.period = Period::between(low, high, 4.0 * largest + 2.0 * apart)?;
        Ok(self)
    }

    /// How far walls must go beyond periodic sides: the largest bounding radius and the margin of the lists, m.
    pub fn reach_of_bodies(&self) -> f64 {
        let radii = self.templates.iter().map(|t| t.bounding_radius);
        radii.fold(self.settings.margin, |reach, radius| {
            reach.max(radius + self.settings.margin)
        })
    }

    /// The image of a point (m) between the periodic sides; the point itself if there are none.
    pub fn between_sides(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.period.inside(point)
    }

    /// Periodic sides.
    pub(crate) fn period(&self) -> Period {
        self.period
    }

    /// The world with its steps on `threads` threads, see [`World::set_threads`].
    ///
    /// # Errors
    ///
    /// As [`World::set_threads`].
    pub fn on_threads(mut self, threads: usize) -> Result<Self, Error> {
        self.set_threads(threads)?;
        Ok(self)
    }

    /// Spreads the steps from now on over `threads` threads; 1 keeps them on the caller's.
    ///
    /// The results have the same bits. It pays from some thousands of bodies on; run many
    /// smaller worlds side by side instead. A world that has moved is cut into other parts, which costs as much as a search for pairs.
    ///
    /// # Errors
    ///
    /// No thread, threads that cannot be started.
    pub fn set_threads(&mut self, threads: usize) -> Result<(), Error> {
        let refused = |reason: String| Error::Threads { threads, reason };
        if threads == 0 {
            return Err(refused("at least one is needed".into()));
        }
        let state = (self.n_steps > 0).then(|| self.snapshot());
        let pieces = if threads == 1 {
            self.pool = None;
            1
        } else {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            self.pool = Some(Arc::new(pool.map_err(|e| refused(e.to_string()))?));
            PIECES_PER_THREAD * threads
        };
        self.workspaces = vec![Workspace::default(); pieces];
        self.cut_parts();
        match state {
            Some(state) => self.take_up(state),
            None => Ok(()),
        }
    }

    /// The world on the basic instructions of the processor instead of its widest: slower, with the same bits. For tests.
    #[must_use]
    pub fn on_basic_instructions(mut self) -> Self {
        self.level = Level::baseline();
        self
    }

    /// Number of threads that the steps are spread over.
    pub fn n_threads(&self) -> usize {
        self.pool
            .as_ref()
            .map_or(1, |pool| pool.current_num_threads())
    }

    /// Sets the gravity that acts from the next step on, m/s².
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`]; the gravity stays as it was.
    pub fn set_gravity(&mut self, gravity: Vector3<f64>) -> Result<(), Error> {
        if gravity.iter().any(|x| !x.is_finite()) {
            let what = "gravity in m/s2".into();
            return Err(Error::NotFinite { what });
        }
        self.settings.gravity = gravity;
        Ok(())
    }

    /// Sets the time step from the next step on, s.
    ///
    /// # Errors
    ///
    /// [`Error::NotPositive`]; the time step stays as it was.
    pub fn set_time_step(&mut self, time_step: f64) -> Result<(), Error> {
        if !(time_step > 0.0 && time_step.is_finite()) {
            return Err(Error::NotPositive {
                name: "time step in s",
                value: time_step,
            });
        }
        self.settings.time_step = time_step;
        Ok(())
    }

    /// Sets the spin of all walls called `name`, rad/s.
    ///
    /// # Errors
    ///
    /// [`Error::NoWall`], [`Error::NotFinite`], and [`Error::SpinningShape`] for a wall that is not a surface of revolution about z;
    /// the spins stay as they were.
    pub fn set_wall_spin(&mut self, name: &str, spin: f64) -> Result<(), Error> {
        if !spin.is_finite() {
            let what = format!("spin of wall '{name}' in rad/s");
            return Err(Error::NotFinite { what });
        }
        let mut named = self.walls.iter().filter(|w| w.name == name).peekable();
        if named.peek().is_none() {
            return Err(Error::NoWall { name: name.into() });
        }
        if spin != 0.0 && !named.all(Wall::is_axisymmetric) {
            return Err(Error::SpinningShape { wall: name.into() });
        }
        for wall in self.walls.iter_mut().filter(|w| w.name == name) {
            wall.spin = spin;
        }
        self.choose_reference_spin();
        Ok(())
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
        self.mesh_walls.add(wall, self.time)?;
        self.longest = f32::INFINITY;
        self.choose_reference_spin();
        Ok(())
    }

    /// Changes velocity, spin and vibration of all walls of triangles called `name`. Their centre of
    /// rotation stays, and a new vibration begins at the present place of the wall.
    ///
    /// # Errors
    ///
    /// [`Error::NoWall`], [`Error::NotFinite`]; the motions stay as they were.
    pub fn set_mesh_motion(&mut self, name: &str, motion: &Motion) -> Result<(), Error> {
        self.mesh_walls.set_motion(name, motion, self.time)
    }

    /// Takes all walls of triangles called `name` away. They keep their place in [`Self::mesh_walls`] and feel nothing.
    ///
    /// # Errors
    ///
    /// [`Error::NoWall`].
    pub fn remove_mesh_wall(&mut self, name: &str) -> Result<(), Error> {
        self.mesh_walls.remove(name)?;
        self.deal_liquid();
        Ok(())
    }

    /// Moves the world by one step.
    ///
    /// # Errors
    ///
    /// A body that has run away or whose state is not finite.
    pub fn step(&mut self) -> Result<(), Error> {
        self.step_with(|_| {})
    }

    /// Moves the world by one step in which further forces act, such as those of bonds.
    ///
    /// `further` adds to `force` (N) and `torque` (N m about the centre of mass) of the bodies.
    ///
    /// # Errors
    ///
    /// A body that has run away or whose state is not finite.
    pub fn step_with(&mut self, further: impl FnOnce(&mut Bodies) + Send) -> Result<(), Error> {
        // One change of threads for the whole step: each costs as much as some hundred contacts.
        match self.pool.clone() {
            Some(pool) => pool.install(|| self.step_here(further)),
            None => self.step_here(further),
        }
    }

    /// [`Self::step_with`] on a thread of the pool, if there is one.
    fn step_here(&mut self, further: impl FnOnce(&mut Bodies)) -> Result<(), Error> {
        let mut clock = Clock::start(self.phases.is_some());
        // Two bodies, or a body and a wall, can close the gap of a margin only if one of them has moved by half of it.
        let half = 0.5 * self.settings.margin;
        if f64::from(self.longest) > half || self.mesh_walls.longest() > half {
            self.search_pairs()?;
        }
        let search = clock.lap();
        self.find_loads();
        let contacts = clock.lap();
        self.add_loads_of_triangles();
        self.deal_liquid();
        let triangles = clock.lap();
        further(&mut self.bodies);
        let others = clock.lap();
        self.move_bodies();
        if let Some(phases) = &mut self.phases {
            phases.add([search, contacts, triangles, others, clock.lap()]);
        }
        Ok(())
    }

    /// Finds the forces of contacts of bodies and of bodies and walls that are not triangles.
    fn find_loads(&mut self) {
        self.wall_load.fill(Vector3::zeros());
        self.wall_torque.fill(0.0);
        let mut on_bodies = take(&mut self.bodies.load);
        let (mut parts, mut workspaces) = (take(&mut self.parts), take(&mut self.workspaces));
        let (level, bodies, walls, context) =
            (self.level, &self.bodies, &self.walls, self.context());
        if self.pool.is_some() {
            let (all, workspaces) = (Loads::of(&mut on_bodies), &mut workspaces);
            find_loads(level, &mut parts, bodies, walls, &context, workspaces, all);
            give_loads(&parts, 0..parts.len(), Loads::of(&mut on_bodies));
        } else {
            let (workspace, mut loads) = (&mut workspaces[0], Loads::of(&mut on_bodies));
            for part in &mut parts {
                part.clear(&mut loads);
                part.find_loads(level, bodies, walls, &context, workspace, &mut loads);
            }
            for part in &parts {
                part.give_wall_forces(&mut loads);
            }
        }
        for part in &parts {
            let on_walls = (
                self.wall_load.as_mut_slice(),
                self.wall_torque.as_mut_slice(),
            );
            part.add_to_walls(Window::whole(&self.bodies.position), on_walls);
        }
        (self.parts, self.workspaces) = (parts, workspaces);
        self.bodies.load = on_bodies;
    }

    /// Adds the forces of contacts with walls of triangles.
    fn add_loads_of_triangles(&mut self) {
        let mut walls = take(&mut self.mesh_walls);
        let mut bodies = take(&mut self.bodies);
        walls.add_forces(&mut bodies, &self.context());
        (self.mesh_walls, self.bodies) = (walls, bodies);
    }

    /// Moves the bodies, and the time.
    fn move_bodies(&mut self) {
        let around = self.surroundings();
        self.longest = advance(
            self.level,
            self.pool.is_some(),
            self.bodies.slices(&mut self.spheres),
            &self.templates,
            &around,
        );
        self.n_steps += 1;
        self.time += self.settings.time_step;
        self.mesh_walls.advance(self.settings.time_step, self.time);
    }

    /// Time step, gravity and spin of the reference frame: what moves the bodies apart from their loads.
    fn surroundings(&self) -> Surroundings {
        Surroundings {
            time_step: self.settings.time_step,
            gravity: self.settings.gravity,
            reference_spin: self.reference_spin,
        }
    }

    /// Measures the time of each phase of the steps from now on.
    pub fn count_phases(&mut self) {
        self.phases = Some(StepPhases::default());
    }

    /// Time of each phase since [`Self::count_phases`], or `None` without it.
    pub fn phases(&self) -> Option<StepPhases> {
        self.phases
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

    /// Force on each wall in the last step, N; not on walls of triangles.
    pub fn wall_load(&self) -> &[Vector3<f64>] {
        &self.wall_load
    }

    /// Torque about the z axis on each wall in the last step, N m.
    pub fn wall_torque(&self) -> &[f64] {
        &self.wall_torque
    }

    /// Walls of triangles as they were given, with their present motion.
    pub fn mesh_walls(&self) -> impl Iterator<Item = &MeshWall> {
        self.moving_walls().iter().map(|m| &m.wall)
    }

    /// Walls of triangles, where they are now.
    pub(crate) fn moving_walls(&self) -> &[Moving] {
        &self.mesh_walls.moving
    }

    /// Force (N) on each wall of triangles in the last step, and its torque (N m) about the
    /// centre of rotation.
    pub fn mesh_loads(&self) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + '_ {
        self.mesh_walls.moving.iter().map(|m| (m.force, m.torque))
    }

    /// Displacement (m) of the centre of rotation of each wall of triangles since its start.
    pub fn mesh_displacements(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.mesh_walls.moving.iter().map(Moving::displacement)
    }

    /// Where each wall of triangles stands.
    pub fn mesh_poses(&self) -> impl Iterator<Item = MeshPose> + '_ {
        self.mesh_walls.moving.iter().map(Moving::pose)
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
        let mut total = Census::default();
        for part in &self.parts {
            total += part.census();
        }
        total
    }

    /// Bytes that a step reads, each once: the lists of pairs and the state of the bodies. Lists at walls and the shapes of the
    /// bodies, which stay in the cache, are left out.
    pub fn bytes_of_step(&self) -> usize {
        self.census().bytes + self.bodies.len() * Bodies::BYTES_OF_EACH
    }

    /// Number of touching spheres at all walls.
    pub fn n_wall_contacts(&self) -> usize {
        let analytic: usize = self.parts.iter().map(Part::n_wall_contacts).sum();
        analytic + self.mesh_walls.n_contacts()
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

    /// What the force loops need beside bodies and lists.
    pub(crate) fn context(&self) -> Context<'_> {
        Context {
            templates: &self.templates,
            interactions: &self.interactions,
            n_materials: self.n_materials,
            cutoffs: self.cutoffs,
            period: self.period,
            time_step: self.settings.time_step,
            liquid: self.liquid.shares(),
            spheres: Window::whole(&self.spheres),
        }
    }

    /// Travels are measured in the frame of the walls if all are surfaces of revolution, otherwise
    /// in the frame at rest, where the other walls are. A change of frame needs no new
    /// lists: gaps between bodies, and between bodies and walls of revolution, are the same in
    /// both frames, and the travels before and after the change add up to a bound in either.
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

    /// Refuses a body that is at no place, or has come there on no way.
    fn check_finite(&self) -> Result<(), Error> {
        let lost = |body: &usize| {
            let position = &self.bodies.position[*body];
            !position.iter().all(|c| c.is_finite()) || !self.bodies.travel[*body].is_finite()
        };
        let found = (0..self.bodies.len()).find(lost);
        found.map_or(Ok(()), |body| {
            Err(Error::Diverged {
                body,
                time: self.time,
                time_step: self.settings.time_step,
            })
        })
    }

    /// Finds the pairs of bodies and of bodies and walls.
    fn search_pairs(&mut self) -> Result<(), Error> {
        self.check_finite()?;
        let (bodies, radii, margin) = (&self.bodies, &self.radii, self.settings.margin);
        self.grid.sort(&bodies.position, radii, margin, self.period);
        if self.is_of_spheres() {
            self.bodies
                .copy_to_spheres(&self.templates, &mut self.spheres);
        }
        let (mut parts, mut workspaces) = (take(&mut self.parts), take(&mut self.workspaces));
        let (level, grid, context) = (self.level, &self.grid, self.context());
        let around = (&context, self.walls.as_slice(), margin);
        let search = |(piece, workspace): (&mut [Part], &mut Workspace)| {
            for part in piece {
                part.search(level, grid, bodies, radii, around, workspace);
            }
        };
        let piece = parts.len() / workspaces.len();
        match &self.pool {
            None => search((&mut parts, &mut workspaces[0])),
            Some(pool) => pool.install(|| {
                let pieces = parts.par_chunks_mut(piece).zip(workspaces.par_iter_mut());
                pieces.for_each(search);
            }),
        }
        (self.parts, self.workspaces) = (parts, workspaces);
        if self.is_of_spheres() {
            self.last_partners = sweep::last_partners(&self.parts);
        }
        // A bridge may pass from a triangle to one that is not listed: that must stay beyond its reach.
        let at_triangles = margin + f64::from(self.cutoffs.reach);
        self.mesh_walls
            .rebuild(&self.bodies, &self.templates, at_triangles, self.period);
        self.bodies.travel.fill(0.0);
        self.bodies.shift.fill(0.0);
        Ok(())
    }
}

/// The spin of larger size.
fn largest(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}
