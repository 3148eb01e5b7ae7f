//! The surface of a body in a stack of slices, as a tomograph gives them.

use crate::build::build;
use crate::{CheckedMesh, CubeGrid, Error, LengthUnit, Repair, Warning};
use nalgebra::Vector3;

/// Grey values on a grid of boxes of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelStack {
    /// Values along x first, then y, then z.
    pub values: Vec<u16>,
    /// Number of values along x, y and z.
    pub counts: [usize; 3],
    /// Distance of neighbours along x, y and z, m.
    pub spacing: [f64; 3],
}

impl VoxelStack {
    /// The mesh of what is brighter than a threshold, checked and mended as one that was read; `source` names it in messages.
    ///
    /// # Method
    ///
    /// [`CubeGrid::boundary`] of the values; a corner lies where the value between two neighbours, taken as linear, passes the
    /// threshold. Beyond the stack all is dark, so that a body that reaches its border is cut off there, which is reported.
    ///
    /// # Errors
    ///
    /// Sizes that do not fit the values; nothing, or only single points, brighter; as of [`crate::read_mesh_with`].
    pub fn surface(
        &self,
        threshold: f64,
        source: &str,
        repair: &Repair,
    ) -> Result<CheckedMesh, Error> {
        let [nx, ny, nz] = self.counts;
        let is_length = |length: &f64| length.is_finite() && *length > 0.0;
        if nx * ny * nz != self.values.len() || !self.spacing.iter().all(is_length) {
            return Err(Error::VoxelSizes {
                file: source.to_owned(),
                counts: self.counts,
                values: self.values.len(),
            });
        }
        // A dark layer all round.
        let spacing = Vector3::from(self.spacing);
        let grid = CubeGrid {
            low: -spacing,
            cell: spacing,
            counts: self.counts.map(|n| n + 2),
        };
        let at = |node: usize| {
            let [_, rows, layers] = grid.counts;
            let place = [node / (rows * layers), node / layers % rows, node % layers];
            let inner = place
                .iter()
                .zip(&self.counts)
                .all(|(k, n)| (1..=*n).contains(k));
            let [x, y, z] = place.map(|k| k.wrapping_sub(1));
            inner.then(|| self.values[(z * ny + y) * nx + x])
        };
        let value = |node: usize| at(node).map_or(0.0, f64::from);
        let inside: Vec<bool> = (0..grid.nodes())
            .map(|node| at(node).is_some_and(|value| f64::from(value) > threshold))
            .collect();
        let soup = grid.boundary(&inside, |inner, outer| {
            let (bright, dark) = (value(inner), value(outer));
            (bright - threshold) / (bright - dark)
        });
        let mut warnings = Vec::new();
        let cut = self.at_border(threshold);
        if cut > 0 {
            warnings.push(Warning::CutAtBorder(cut));
        }
        let mut read = build(soup, LengthUnit::Metre, source, repair, warnings)?;
        for warning in &mut read.report.warnings {
            // The size follows from the edge length of a voxel, and no unit of numbers in a file from it.
            if let Warning::UnitSuspect { longest, .. } = *warning {
                *warning = Warning::VoxelSuspect { longest };
            }
        }
        Ok(read)
    }

    /// Values brighter than a threshold at the border of the stack.
    fn at_border(&self, threshold: f64) -> usize {
        let [nx, ny, nz] = self.counts;
        let is_border = |k: usize| {
            let (x, y, z) = (k % nx, k / nx % ny, k / (nx * ny));
            x == 0 || y == 0 || z == 0 || x + 1 == nx || y + 1 == ny || z + 1 == nz
        };
        let bright = self.values.iter().enumerate();
        bright
            .filter(|(k, v)| f64::from(**v) > threshold && is_border(*k))
            .count()
    }
}

#[cfg(test)]
mod tests {
    use super::VoxelStack;
    use crate::{Error, Repair, Warning};
    use std::f64::consts::PI;

    /// An ellipsoid with half axes of 8, 6 and 5 mm about the middle of a stack, its edge blurred over two voxels as a tomograph blurs
    /// it: 1000 inside, 0 outside; voxels of 0.5, 0.5 and 0.4 mm, moved by `along` mm to the right.
    fn stack(along: f64) -> VoxelStack {
        let (counts, spacing) = ([40, 32, 34], [0.5e-3, 0.5e-3, 0.4e-3]);
        let mut values = Vec::new();
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let place = [x, y, z];
                    let at = |k: usize| {
                        (place[k] as f64 - 0.5 * (counts[k] - 1) as f64) * spacing[k] * 1e3
                    };
                    let radius = ((at(0) - along) / 8.0)
                        .hypot(at(1) / 6.0)
                        .hypot(at(2) / 5.0);
                    let depth = (1.0 - radius) * 6.0;
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "0 to 1000"
                    )]
                    values.push((1000.0 * (0.5 + depth).clamp(0.0, 1.0)) as u16);
                }
            }
        }
        VoxelStack {
            values,
            counts,
            spacing,
        }
    }

    /// Half of the full grey is the true surface: its volume within 1 %, facets of half a millimetre on radii of 5 to 8 mm cutting
    /// off 0.3 (cell / radius)^2; x is along the rows.
    #[test]
    fn a_body_in_a_stack_has_its_volume_and_lies_as_it_does() {
        let read = stack(0.0)
            .surface(500.0, "stack", &Repair::default())
            .unwrap();
        read.mesh.require_closed().unwrap();
        let exact = 4.0 / 3.0 * PI * 8.0 * 6.0 * 5.0;
        let volume = read.report.volume.unwrap() * 1e9;
        assert!((volume / exact - 1.0).abs() < 0.01, "{volume} for {exact}");
        let size = read.report.bounding_box.size() * 1e3;
        for (found, exact) in size.iter().zip([16.0, 12.0, 10.0]) {
            assert!((found - exact).abs() < 0.1, "{found} for {exact}");
        }
        assert!(
            read.report.warnings.is_empty(),
            "{:?}",
            read.report.warnings
        );
    }

    /// A body that reaches the border of the stack is cut off there, closed and told.
    #[test]
    fn a_body_that_is_cut_at_the_border_is_told() {
        let read = stack(4.0)
            .surface(500.0, "stack", &Repair::default())
            .unwrap();
        read.mesh.require_closed().unwrap();
        assert!(matches!(read.report.warnings[..], [Warning::CutAtBorder(n)] if n > 10));
    }

    #[test]
    fn stacks_that_cannot_be_meant_are_refused() {
        let whole = stack(0.0);
        assert!(whole.surface(1001.0, "stack", &Repair::default()).is_err());
        for changed in [
            VoxelStack {
                counts: [40, 32, 33],
                ..whole.clone()
            },
            VoxelStack {
                spacing: [0.0, 1.0, 1.0],
                ..whole.clone()
            },
            VoxelStack {
                spacing: [f64::NAN, 1.0, 1.0],
                ..whole
            },
        ] {
            let error = changed
                .surface(500.0, "stack", &Repair::default())
                .unwrap_err();
            assert!(matches!(error, Error::VoxelSizes { .. }), "{error}");
        }
    }
}
