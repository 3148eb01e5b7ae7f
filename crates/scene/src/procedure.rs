//! An apparatus as another code must build it, and the observables of a run that another code made.
//!
//! Walls, phases, outlets and loads are those of the [`crate::run`] here: the apparatus describes them once.

use crate::apparatus::NamedMesh;
use crate::factory::Factory;
use crate::motion::{filling_times, rest_energy_of};
use crate::obstacles::mesh_walls;
use crate::phases::{Log, Passage, Plan, Sample, Seen};
use crate::{Error, Frame, ObservableValues, Scene, SeedBody};
use dem_solver::Shape;
use nalgebra::Vector3;
use std::sync::Arc;

/// A wall at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcedureWall {
    /// Name.
    pub name: String,
    /// Name of the material.
    pub material: String,
    /// Its surface.
    pub surface: Surface,
    /// Point about which it turns, m.
    pub about: Vector3<f64>,
    /// Whether the user brought it as a mesh.
    pub is_brought: bool,
}

/// Surface of a wall.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// An endless plane.
    Plane {
        /// A point of the plane, m.
        point: Vector3<f64>,
        /// Unit normal, towards the bed.
        normal: Vector3<f64>,
    },
    /// Corners of triangles, m.
    Triangles(Vec<[Vector3<f64>; 3]>),
}

/// What an apparatus is and does, phase by phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Procedure {
    /// Analytic walls, then walls of triangles.
    pub walls: Vec<ProcedureWall>,
    /// Number of the analytic walls.
    pub analytic: usize,
    /// Its phases; the first fills it.
    pub plan: Plan,
    /// Shortest and longest time of the filling, s.
    pub filling: [f64; 2],
    /// Kinetic energy below which all seeds rest, J; less in proportion once some were taken out.
    pub rest_energy: f64,
    /// Region in which seeds start: lower and upper corner, m.
    pub room: [Vector3<f64>; 2],
    /// Whether the ends along z are periodic sides.
    pub is_periodic: bool,
    /// Cylinder about the y axis in which seeds appear over time: radius, lower and upper end, m; `None` if all are there from the start.
    pub inlet: Option<[f64; 3]>,
}

impl Procedure {
    /// That of a scene; `None` if it has no phases: a drum, a device that turns, a bench test.
    ///
    /// # Errors
    ///
    /// A mesh of a wall that cannot be read.
    pub fn of(scene: &Scene, bodies: &[Arc<SeedBody>]) -> Result<Option<Self>, Error> {
        let device = scene.apparatus.device();
        let Some(mut plan) = device.plan(scene) else {
            return Ok(None);
        };
        let analytic = device.walls().into_iter().map(|wall| ProcedureWall {
            surface: surface_of(&wall.shape),
            name: wall.name,
            material: wall.material,
            about: Vector3::zeros(),
            is_brought: false,
        });
        let mut walls: Vec<_> = analytic.collect();
        let analytic = walls.len();
        let own = device.mesh_walls().len();
        for (k, mesh) in mesh_walls(scene)?.into_iter().enumerate() {
            let is_brought = k >= own;
            // What the user brings moves from the first phase behind the filling on.
            if let (true, Some(phase)) = (is_brought, plan.phases.get_mut(1)) {
                phase.motions.insert(0, (mesh.name.clone(), mesh.motion));
            }
            walls.push(of_mesh(mesh, is_brought));
        }
        let inlet = device.inlet();
        let made = inlet.and_then(|_| Factory::of(scene, 0));
        let spheres = bodies.iter().flat_map(|body| body.clump.spheres());
        let smallest = spheres.map(|s| s.radius).fold(f64::INFINITY, f64::min);
        Ok(Some(Self {
            walls,
            analytic,
            plan,
            filling: filling_times(scene, made.map_or(0.0, |factory| factory.duration())),
            rest_energy: rest_energy_of(scene, smallest),
            room: device.room(),
            is_periodic: device.periodic_sides().is_some(),
            inlet,
        }))
    }
}

fn of_mesh(mesh: NamedMesh, is_brought: bool) -> ProcedureWall {
    ProcedureWall {
        name: mesh.name,
        material: mesh.material,
        surface: Surface::Triangles(mesh.triangles),
        about: mesh.motion.about,
        is_brought,
    }
}

/// An analytic shape; only a drum has a cylinder, and it has no phases.
fn surface_of(shape: &Shape) -> Surface {
    match *shape {
        Shape::Plane { point, normal } => Surface::Plane { point, normal },
        Shape::Rectangle {
            centre,
            half_edges: [a, b],
        } => {
            let [p, q, r, s] = [
                centre - a - b,
                centre + a - b,
                centre + a + b,
                centre - a + b,
            ];
            Surface::Triangles(vec![[p, q, r], [p, r, s]])
        }
        Shape::Cylinder { .. } => Surface::Triangles(Vec::new()),
    }
}

/// What another code left of a run in phases.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignRun {
    /// The seeds at the end.
    pub frame: Frame,
    /// Samples in order of time, with the walls in the order of [`Procedure::walls`]; what the code did not report is NaN.
    pub samples: Vec<Sample>,
    /// Seeds that were taken out.
    pub passages: Vec<Passage>,
}

/// Observables of a run in phases that another code made, by the rules of the runs here; values that need what the code did not report
/// are left out.
///
/// # Errors
///
/// A scene without phases, a picture that cannot be drawn, a bench whose bed is not what its rules need.
pub fn observe_foreign(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    run: ForeignRun,
) -> Result<Vec<ObservableValues>, Error> {
    let Some(procedure) = Procedure::of(scene, bodies)? else {
        return Err(Error::BadValue {
            name: format!("{}: apparatus.kind", scene.file),
            value: scene.apparatus.kind().into(),
            requirement: "an apparatus that goes through phases".into(),
        });
    };
    let log = Log {
        samples: run.samples,
        passages: run.passages,
        ..Log::default()
    };
    let walls = procedure.walls.into_iter().map(|wall| wall.name);
    let seen = Seen::new(
        (scene, &procedure.plan),
        &run.frame,
        bodies,
        &log,
        walls.collect(),
    );
    let mut all = scene.apparatus.device().observe(&seen)?;
    for values in &mut all {
        values.values.retain(|value| value.is_finite());
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::{Procedure, Surface};
    use crate::{End, FillingLibrary, Scene, starting_frame};
    use dev_support::fixture_files::fixture;

    fn procedure(bench: &str) -> Procedure {
        let scene = Scene::read(&fixture(&format!("benches/{bench}.toml")), &[]).unwrap();
        let (_, bodies, _) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        Procedure::of(&scene, &bodies).unwrap().unwrap()
    }

    /// The hopper of 30 mm with an opening of 15 mm: its gate is removed in the last phase, in which seeds leave 15 mm below. Rest is
    /// 1e-4 of the energy of a fall of all 900 beads by ten radii: 900 pi/6 (3 mm)^3 2500 kg/m3 g 15 mm 1e-4 = 4.6806e-7 J.
    #[test]
    fn a_hopper_is_what_its_scene_states() {
        let hopper = procedure("hopper");
        let names: Vec<_> = hopper.walls.iter().map(|w| w.name.as_str()).collect();
        assert_eq!(names, ["gate", "bottom", "side"]);
        let last = hopper.plan.phases.last().unwrap();
        assert_eq!(last.removed, ["gate"]);
        assert!((last.outlets[0].point.y + 0.015).abs() < 1e-15);
        assert_eq!(hopper.inlet, None);
        assert!(
            (hopper.rest_energy / 4.6806e-7 - 1.0).abs() < 1e-4,
            "{} J",
            hopper.rest_energy
        );
    }

    /// Peas are poured within 20 mm, from 30 % of the inlet's height of 40 mm above 45 mm on: 1100 at 700 a second need 1.571 s.
    #[test]
    fn a_poured_heap_has_an_inlet_and_starts_empty() {
        let heap = procedure("poured-heap");
        let [radius, low, high] = heap.inlet.unwrap();
        assert!(
            (radius - 0.01).abs() < 1e-15
                && (low - 0.057).abs() < 1e-12
                && (high - 0.085).abs() < 1e-12
        );
        let [shortest, longest] = heap.filling;
        assert!(shortest > 1100.0 / 700.0 && (longest - 1100.0 / 700.0 - 1.0).abs() < 1e-12);
    }

    /// A press has five planes and a piston, whose last load is the first stress on 40 mm by 40 mm again: 2 kPa are 3.2 N.
    #[test]
    fn a_press_has_loads() {
        let press = procedure("compression");
        let planes = press
            .walls
            .iter()
            .filter(|w| matches!(w.surface, Surface::Plane { .. }));
        assert_eq!((planes.count(), press.walls.len()), (5, 6));
        let last = press.plan.phases.last().unwrap();
        let load = last.motions[0].1.load.unwrap();
        assert!((load.force - 3.2).abs() < 1e-12, "{} N", load.force);
        assert!(matches!(last.end, End::AtRest { .. }));
    }
}
