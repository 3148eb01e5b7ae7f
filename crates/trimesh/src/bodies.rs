//! The connected surfaces of a mesh, and the mesh of the largest body alone.

use crate::build::CheckedMesh;
use crate::orientation::{Edges, shells_of};
use crate::winding::solid_angle_sum;
use crate::{BoundingBox, Error, LengthUnit, TriMesh, VolumeMoments};
use input::quantity::significant;
use nalgebra::Vector3;

/// A connected surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// Its triangles in the mesh.
    pub triangles: Vec<usize>,
    /// Enclosed volume, m³: negative for the wall of a cavity; without meaning if it is open.
    pub volume: f64,
    /// Box along the axes, m.
    pub bounding_box: BoundingBox,
}

impl TriMesh {
    /// All connected surfaces, the one of the largest volume first.
    pub fn shells(&self) -> Vec<Shell> {
        let of_triangle = shells_of(&Edges::new(self.triangles()));
        let count = of_triangle.iter().max().map_or(0, |most| most + 1);
        let mut members = vec![Vec::new(); count];
        for (triangle, &shell) in of_triangle.iter().enumerate() {
            members[shell].push(triangle);
        }
        let mut shells: Vec<Shell> = members.into_iter().map(|m| self.shell(m)).collect();
        shells.sort_by(|a, b| b.volume.total_cmp(&a.volume));
        shells
    }

    fn shell(&self, triangles: Vec<usize>) -> Shell {
        let vertices = || triangles.iter().flat_map(|&t| self.triangles()[t]);
        let bounding_box = BoundingBox::of(vertices().map(|i| &self.vertices()[i]));
        let corners = triangles.iter().map(|&t| self.corners(t));
        let volume = VolumeMoments::of_triangles(&bounding_box.centre(), corners).volume;
        Shell {
            triangles,
            volume,
            bounding_box,
        }
    }

    /// The mesh of the largest body with its cavities; all other surfaces are left out.
    ///
    /// # Errors
    ///
    /// What is left is not a body.
    pub fn largest_body(&self) -> Result<CheckedMesh, Error> {
        let shells = self.shells();
        let Some((largest, others)) = shells.split_first() else {
            return Self::from_triangles(&[], LengthUnit::Metre, self.source());
        };
        let corners = |shell: &Shell| -> Vec<[Vector3<f64>; 3]> {
            shell.triangles.iter().map(|&t| self.corners(t)).collect()
        };
        let outside = corners(largest);
        let is_cavity = |shell: &&Shell| {
            let point = self.corners(shell.triangles[0])[0];
            let angle = solid_angle_sum(&point, outside.iter().copied());
            shell.volume < 0.0 && angle > std::f64::consts::TAU
        };
        let cavities: Vec<_> = others.iter().filter(is_cavity).flat_map(corners).collect();
        let kept = [outside.as_slice(), &cavities].concat();
        Self::from_triangles(&kept, LengthUnit::Metre, self.source())
    }

    /// Volumes of the largest shells for a message, mm³.
    pub(crate) fn volumes_told(&self) -> String {
        const TOLD: usize = 5;
        let shells = self.shells();
        let told = shells.iter().take(TOLD);
        let told: Vec<String> = told.map(|s| significant(s.volume * 1e9, 4)).collect();
        let more = if shells.len() > TOLD { ", ..." } else { "" };
        told.join(", ") + more
    }
}
