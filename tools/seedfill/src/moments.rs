//! Shape of the mesh, and moments and axes of mesh and spheres.

use command_line::significant;
use serde::Serialize;
use sphere_fill::Filling;
use trimesh::{BodyShape, LengthUnit, VolumeMoments};

/// Size and shape of the mesh; lengths, area and volume in the unit of the mesh.
#[derive(Debug, Serialize)]
pub(crate) struct Shape {
    volume: f64,
    area: f64,
    equivalent_diameter: f64,
    /// Edges of the smallest box in any direction: longest, intermediate, shortest.
    longest: f64,
    intermediate: f64,
    shortest: f64,
    /// Intermediate over longest.
    elongation: f64,
    /// Shortest over intermediate.
    flatness: f64,
    /// After Wadell.
    sphericity: f64,
}

impl Shape {
    pub(crate) fn new(shape: &BodyShape, unit: LengthUnit) -> Self {
        let metre = unit.in_metres();
        let [longest, intermediate, shortest] = shape.lengths.map(|length| length / metre);
        Self {
            volume: shape.volume / metre.powi(3),
            area: shape.area / metre.powi(2),
            equivalent_diameter: shape.equivalent_diameter / metre,
            longest,
            intermediate,
            shortest,
            elongation: shape.elongation,
            flatness: shape.flatness,
            sphericity: shape.sphericity,
        }
    }

    /// All numbers in the order of the fields.
    pub(crate) fn numbers(&self) -> [f64; 9] {
        [
            self.volume,
            self.area,
            self.equivalent_diameter,
            self.longest,
            self.intermediate,
            self.shortest,
            self.elongation,
            self.flatness,
            self.sphericity,
        ]
    }

    /// Names and values for people.
    pub(crate) fn lines(&self, unit: LengthUnit) -> Vec<(&'static str, String)> {
        let lengths = [self.longest, self.intermediate, self.shortest];
        let [l, i, s] = lengths.map(|length| significant(length, 4));
        vec![
            (
                "surface area",
                format!("{} {unit}2", significant(self.area, 4)),
            ),
            (
                "equivalent diameter",
                format!("{} {unit}", significant(self.equivalent_diameter, 4)),
            ),
            (
                "smallest box",
                format!("{l} x {i} x {s} {unit} (L x I x S)"),
            ),
            (
                "elongation, flatness",
                format!(
                    "{:.3} (I / L), {:.3} (S / I)",
                    self.elongation, self.flatness
                ),
            ),
            ("sphericity", format!("{:.3}", self.sphericity)),
        ]
    }
}

/// Moments and axes of mesh and spheres at the same mass.
#[derive(Debug, Serialize)]
pub(crate) struct Moments {
    mesh: BodyMoments,
    /// Of the union of the spheres at uniform density.
    spheres: BodyMoments,
    /// Of the spheres against the mesh.
    error_percent: [f64; 3],
    /// Angle between the axes of mesh and spheres; none if two moments are so near to each other
    /// that the axis has no direction of its own.
    axis_angle_deg: [Option<f64>; 3],
}

/// Moments of a body in rising order.
#[derive(Debug, Serialize)]
struct BodyMoments {
    /// In the unit of the mesh.
    centroid: [f64; 3],
    /// Principal moments of a unit of mass, in the square of the unit of the mesh.
    principal_per_mass: [f64; 3],
    /// Principal moments, where the mass is known.
    principal_kg_m2: Option<[f64; 3]>,
    /// Unit vectors of the principal axes.
    axes: [[f64; 3]; 3],
}

impl BodyMoments {
    fn new(moments: &VolumeMoments, mass: Option<f64>, metre: f64) -> Self {
        let found = moments.principal_axes();
        let per_mass = found.moments.map(|moment| moment / moments.volume);
        Self {
            centroid: (moments.centroid / metre).into(),
            principal_per_mass: per_mass.map(|moment| moment / metre.powi(2)),
            principal_kg_m2: mass.map(|mass| per_mass.map(|moment| moment * mass)),
            axes: found.axes.map(Into::into),
        }
    }

    fn text(&self, unit: LengthUnit) -> String {
        let (moments, unit) = match self.principal_kg_m2 {
            Some(moments) => (moments, "kg m2".to_owned()),
            None => (self.principal_per_mass, format!("{unit}2 a unit of mass")),
        };
        format!(
            "{} {unit}",
            moments.map(|moment| significant(moment, 4)).join(", ")
        )
    }
}

impl Moments {
    pub(crate) fn new(filling: &Filling, mass: Option<f64>, unit: LengthUnit) -> Self {
        let (mesh, spheres) = (&filling.mesh_moments, &filling.union_moments);
        let angles = spheres.principal_axes().angles_to(&mesh.principal_axes());
        let metre = unit.in_metres();
        Self {
            mesh: BodyMoments::new(mesh, mass, metre),
            spheres: BodyMoments::new(spheres, mass, metre),
            error_percent: filling.report.inertia_error_percent,
            axis_angle_deg: angles.map(|angle| angle.map(f64::to_degrees)),
        }
    }

    /// Names and values for people.
    pub(crate) fn lines(&self, unit: LengthUnit) -> Vec<(&'static str, String)> {
        let [i, j, k] = self.error_percent;
        let angle =
            |angle: Option<f64>| angle.map_or("-".to_owned(), |angle| format!("{angle:.2}"));
        vec![
            ("moments of the mesh", self.mesh.text(unit)),
            ("moments of the spheres", self.spheres.text(unit)),
            ("inertia error", format!("{i:.2}, {j:.2}, {k:.2} %")),
            (
                "angle of the axes",
                format!("{} deg", self.axis_angle_deg.map(angle).join(", ")),
            ),
        ]
    }
}
