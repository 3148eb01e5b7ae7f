//! Walls of triangles in a scene: those of the apparatus and those that the user brings.

use crate::apparatus::NamedMesh;
use crate::check::bad;
use crate::{Error, Frame, Scene, SeedSettings};
use dem_solver::{Motion, Vibration};
use input::quantity::{AngularSpeed, Frequency, Length, Speed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// A wall from a mesh, with prescribed motion. It moves from the start of the drive on; while the
/// seeds settle it stands still.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallSettings {
    /// Name.
    pub name: String,
    /// Mesh (STL, OBJ, PLY), relative to the scene file. It need not be closed, but a mesh without any thickness is
    /// refused: give a flat plate a thickness.
    pub mesh: PathBuf,
    /// Unit of the mesh.
    pub mesh_unit: trimesh::LengthUnit,
    /// Name of the material.
    pub material: String,
    /// Shift of the mesh: x, y, z; not shifted if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[Length; 3]>,
    /// Velocity: x, y, z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<[Speed; 3]>,
    /// Angular velocity: x, y, z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spin: Option<[AngularSpeed; 3]>,
    /// Centre of rotation, in the frame of the scene; the origin if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<[Length; 3]>,
    /// Vibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration: Option<VibrationSettings>,
}

/// A harmonic motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VibrationSettings {
    /// Amplitude: x, y, z.
    pub amplitude: [Length; 3],
    /// Frequency.
    pub frequency: Frequency,
}

/// A motion about the origin of velocity, spin and vibration as a file states them.
pub(crate) fn prescribed(
    velocity: Option<[Speed; 3]>,
    spin: Option<[AngularSpeed; 3]>,
    vibration: Option<&VibrationSettings>,
) -> Motion {
    let vibration = vibration.map(|v| Vibration {
        amplitude: Vector3::from(v.amplitude.map(Length::si)),
        angular_frequency: TAU * v.frequency.si(),
    });
    Motion {
        velocity: velocity.map_or_else(Vector3::zeros, |v| Vector3::from(v.map(Speed::si))),
        spin: spin.map_or_else(Vector3::zeros, |v| Vector3::from(v.map(AngularSpeed::si))),
        vibration,
        ..Motion::default()
    }
}

/// Greatest speed of a wall with these motions within so many metres, m/s.
pub(crate) fn fastest(
    velocity: Option<[Speed; 3]>,
    spin: Option<[AngularSpeed; 3]>,
    vibration: Option<&VibrationSettings>,
    size: f64,
) -> f64 {
    let speed = |v: [Speed; 3]| v.iter().map(|c| c.si().abs()).sum::<f64>();
    let turn = |v: [AngularSpeed; 3]| v.iter().map(|c| c.si().abs()).sum::<f64>();
    let swing = |v: &VibrationSettings| {
        let way: f64 = v.amplitude.iter().map(|c| c.si().abs()).sum();
        TAU * v.frequency.si() * way
    };
    velocity.map_or(0.0, speed) + size * spin.map_or(0.0, turn) + vibration.map_or(0.0, swing)
}

impl WallSettings {
    /// Greatest speed that it can have within so many metres, m/s.
    pub(crate) fn fastest(&self, size: f64) -> f64 {
        fastest(self.velocity, self.spin, self.vibration.as_ref(), size)
    }

    /// Refuses a wall that no seed can reach: all of it is outside the ball about a drum or a device. On an open floor
    /// seeds can roll away, so every place can be reached.
    fn check_place(&self, scene: &Scene, triangles: &[[Vector3<f64>; 3]]) -> Result<(), Error> {
        if !scene.apparatus.is_turned() {
            return Ok(());
        }
        let [low, high] = scene.apparatus.device().room();
        let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low).norm());
        let distance =
            |corners| (geometry::triangle::nearest_on_triangle(&middle, corners) - middle).norm();
        let nearest = triangles.iter().map(distance).fold(f64::INFINITY, f64::min);
        if nearest <= radius || self.velocity.is_some() {
            return Ok(());
        }
        Err(bad(
            &format!("place of wall '{}'", self.name),
            format!("{nearest:.4} m from the middle at the nearest"),
            &format!(
                "at most {radius:.4} m, beyond which no seed is: look at its position and its mesh_unit"
            ),
        ))
    }

    /// Reads the mesh and puts it in its place.
    fn read(&self, scene: &Scene) -> Result<NamedMesh, Error> {
        let path = scene.folder.join(&self.mesh);
        let mesh = trimesh::read_mesh(&path, self.mesh_unit).map_err(|source| Error::WallMesh {
            wall: self.name.clone(),
            source,
        })?;
        let lengths = |v: Option<[Length; 3]>| {
            v.map_or_else(Vector3::zeros, |v| Vector3::from(v.map(Length::si)))
        };
        let shift = lengths(self.position);
        let mesh = &mesh.mesh;
        let triangles = (0..mesh.triangles().len()).map(|t| mesh.corners(t).map(|c| c + shift));
        let triangles: Vec<_> = triangles.collect();
        self.check_place(scene, &triangles)?;
        Ok(NamedMesh {
            name: self.name.clone(),
            triangles,
            material: self.material.clone(),
            motion: Motion {
                about: lengths(self.about),
                ..prescribed(self.velocity, self.spin, self.vibration.as_ref())
            },
        })
    }
}

/// All walls of triangles of a scene.
///
/// # Errors
///
/// A mesh that is refused.
pub(crate) fn mesh_walls(scene: &Scene) -> Result<Vec<NamedMesh>, Error> {
    let mut walls = scene.apparatus.device().mesh_walls();
    for wall in &scene.wall {
        walls.push(wall.read(scene)?);
    }
    Ok(walls)
}

/// A wall of triangles in a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedWall {
    /// Name.
    pub name: String,
    /// Whether it belongs to the apparatus.
    pub is_own: bool,
    /// Corners of its triangles, m.
    pub triangles: Vec<[Vector3<f64>; 3]>,
}

/// The walls of triangles of a scene where they stand in a frame, without those that were taken away: those of the apparatus, then
/// those that the user brings. If the frame does not know them, they stand as at the start.
///
/// # Errors
///
/// A mesh that is refused.
pub fn walls_in_frame(scene: &Scene, frame: &Frame) -> Result<Vec<PlacedWall>, Error> {
    let own = scene.apparatus.device().mesh_walls().len();
    let mut placed = Vec::new();
    for (number, wall) in mesh_walls(scene)?.into_iter().enumerate() {
        let pose = frame.walls.get(number);
        if pose.is_some_and(|pose| pose.removed) {
            continue;
        }
        let place = |corner: Vector3<f64>| pose.map_or(corner, |pose| pose.place(&corner));
        placed.push(PlacedWall {
            name: wall.name,
            is_own: number < own,
            triangles: wall.triangles.iter().map(|t| t.map(place)).collect(),
        });
    }
    Ok(placed)
}

impl Scene {
    /// Names of the materials of all walls.
    pub(crate) fn wall_materials(&self) -> Vec<&str> {
        let mut names = self.apparatus.device().materials();
        names.extend(self.wall.iter().map(|w| w.material.as_str()));
        names
    }

    /// All files of shapes that a run depends on, meshes and tables of spheres, relative to the folder of the scene.
    pub fn shape_files(&self) -> Vec<&std::path::Path> {
        let seeds = self.seed.iter().filter_map(SeedSettings::shape_file);
        seeds
            .chain(self.wall.iter().map(|w| w.mesh.as_path()))
            .collect()
    }
}
