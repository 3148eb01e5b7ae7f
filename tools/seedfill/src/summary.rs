//! The result as JSON and as text.

use crate::arguments::{Arguments, MethodName};
use crate::connections::Connections;
use crate::cost::Cost;
use crate::moments::{Moments, Shape};
use crate::union_file::UnionFile;
use command_line::{Header, significant};
use geometry::clump::Sphere;
use serde::Serialize;
use sphere_fill::{Connectivity, Filling, FitReport};
use trimesh::{BodyShape, LengthUnit, MeshReport, Warning};

/// Everything that `--json` tells. Lengths without a unit in their key are in `unit`.
#[derive(Debug, Serialize)]
pub(crate) struct Summary {
    #[serde(flatten)]
    header: Header,
    /// `ok`.
    verdict: &'static str,
    /// Unit of the mesh, of all lengths whose key names none, and of `sphere_list`.
    unit: LengthUnit,
    method: String,
    spheres: usize,
    /// Radius asked for.
    radius: f64,
    radius_mm: f64,
    mesh: MeshSummary,
    shape: Shape,
    fit: FitSummary,
    moments: Moments,
    connections: Connections,
    /// What `--union` writes.
    union_surface: Option<UnionFile>,
    /// What the user should know of the spheres; of the mesh: `mesh.warnings`.
    warnings: Vec<String>,
    mass_kg: Option<f64>,
    fraction_density_kg_m3: Option<f64>,
    cost: Cost,
    elapsed_s: f64,
    /// x, y, z, radius of each sphere.
    sphere_list: Vec<[f64; 4]>,
}

#[derive(Debug, Serialize)]
struct MeshSummary {
    triangles: usize,
    vertices: usize,
    watertight: bool,
    volume: Option<f64>,
    volume_mm3: Option<f64>,
    area: f64,
    bounding_box: Bounds,
    degenerate_dropped: usize,
    duplicates_dropped: usize,
    triangles_turned: usize,
    holes_closed: usize,
    /// Width of the widest hole that was closed; 0 if none was.
    widest_hole_closed: f64,
    lid_share_of_area: f64,
    vertices_joined: usize,
    pieces_cut: usize,
    triangles_cut: usize,
    cut_share_of_area: f64,
    warnings: Vec<Warning>,
}

#[derive(Debug, Serialize)]
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
    size: [f64; 3],
}

#[derive(Debug, Serialize)]
struct FitSummary {
    packing_fraction: f64,
    union_fraction: f64,
    max_protrusion: f64,
    max_overlap: f64,
    surface_rms: f64,
    surface_hausdorff: f64,
    roughness_rms: f64,
    mean_gap: f64,
    centroid_offset: f64,
    inertia_error_percent: [f64; 3],
}

/// What a summary is made of.
pub(crate) struct Measured<'a> {
    pub(crate) mesh: &'a MeshReport,
    pub(crate) shape: &'a BodyShape,
    pub(crate) filling: &'a Filling,
    pub(crate) connectivity: &'a Connectivity,
    /// Why given spheres may not be those of the mesh.
    pub(crate) doubt: Option<String>,
}

/// A refusal as JSON.
#[derive(Debug, Serialize)]
pub(crate) struct Refusal {
    #[serde(flatten)]
    pub(crate) header: Header,
    /// `refused`.
    pub(crate) verdict: &'static str,
    pub(crate) reason: String,
    pub(crate) mesh_warnings: Vec<Warning>,
}

/// Share of the volume below which a filling with equal spheres is reported to be sparse, chosen by us: half of that of a dense
/// random packing, 0.64.
const SPARSE: f64 = 0.32;

/// Says that equal spheres reach little of the volume, with the ways out.
fn sparse(arguments: &Arguments, report: &FitReport) -> Option<String> {
    let equal = matches!(arguments.method, MethodName::Pack | MethodName::Lattice);
    let placed_all = arguments.spheres.is_none() && arguments.count.is_none();
    let limited = arguments.max_spheres.is_some();
    let share = report.union_fraction;
    (equal && placed_all && !limited && share < SPARSE).then(|| {
        format!(
            "the spheres reach {:.0} % of the volume: the body is thin, or small, for this radius; take a smaller --radius, \
             or spheres that follow the surface (--method surface or smooth)",
            100.0 * share
        )
    })
}

impl MeshSummary {
    /// The figures of a mesh in a unit of so many metres.
    fn new(mesh: &MeshReport, metre: f64) -> Self {
        Self {
            triangles: mesh.triangles,
            vertices: mesh.vertices,
            watertight: mesh.watertight,
            volume: mesh.volume.map(|v| v / metre.powi(3)),
            volume_mm3: mesh.volume.map(|v| v * 1e9),
            area: mesh.area / metre.powi(2),
            bounding_box: Bounds {
                low: array(&mesh.bounding_box.low, metre),
                high: array(&mesh.bounding_box.high, metre),
                size: array(&mesh.bounding_box.size(), metre),
            },
            degenerate_dropped: mesh.degenerate_dropped,
            duplicates_dropped: mesh.duplicates_dropped,
            triangles_turned: mesh.triangles_turned,
            holes_closed: mesh.holes_closed,
            widest_hole_closed: mesh.changes.lids.first().map_or(0.0, |lid| lid.width) / metre,
            lid_share_of_area: mesh.changes.lid_share,
            vertices_joined: mesh.changes.joined,
            pieces_cut: mesh.changes.pieces_cut,
            triangles_cut: mesh.changes.triangles_cut,
            cut_share_of_area: mesh.changes.cut_share,
            warnings: mesh.warnings.clone(),
        }
    }
}

impl Summary {
    /// Converts all figures to the unit of the mesh.
    pub(crate) fn new(
        header: Header,
        arguments: &Arguments,
        measured: &Measured<'_>,
        elapsed_s: f64,
    ) -> Self {
        let (mesh, filling) = (measured.mesh, measured.filling);
        let unit = arguments.unit;
        let metre = unit.in_metres();
        let connections = Connections::new(measured.connectivity, filling.spheres.len(), unit);
        let volume = filling.mesh_moments.volume;
        let mass_kg = arguments.mass_of(volume);
        Self {
            header,
            verdict: "ok",
            unit,
            method: match arguments.spheres {
                Some(_) => "given".to_owned(),
                None => name_of(arguments.method),
            },
            spheres: filling.spheres.len(),
            radius: filling.settings.radius / metre,
            radius_mm: filling.settings.radius / metre * (metre * 1e3),
            mesh: MeshSummary::new(mesh, metre),
            shape: Shape::new(measured.shape, unit),
            fit: fit_in(&filling.report, metre),
            moments: Moments::new(filling, mass_kg, unit),
            warnings: [
                measured.doubt.clone(),
                sparse(arguments, &filling.report),
                connections.warning(arguments, filling.settings.radius),
            ]
            .into_iter()
            .flatten()
            .collect(),
            connections,
            union_surface: None,
            mass_kg,
            fraction_density_kg_m3: mass_kg.map(|mass| filling.fraction_density(mass)),
            cost: Cost::new(&filling.spheres),
            elapsed_s,
            sphere_list: filling.spheres.iter().map(|s| in_unit(s, metre)).collect(),
        }
    }

    /// With the known data of the surface of the spheres.
    pub(crate) fn with(self, union_surface: Option<UnionFile>) -> Self {
        Self {
            union_surface,
            ..self
        }
    }

    /// Adds something that the user should know.
    pub(crate) fn warn(&mut self, warning: String) {
        self.warnings.push(warning);
    }

    /// The surface of the spheres, where it is asked for.
    pub(crate) fn union_file(&self) -> Option<&UnionFile> {
        self.union_surface.as_ref()
    }

    /// Short text for people.
    pub(crate) fn text(&self) -> String {
        let lines = [
            self.shape_lines(),
            self.fit_lines(),
            self.moment_lines(),
            self.connection_lines(),
            self.cost_lines(),
        ]
        .concat();
        let rows = lines
            .iter()
            .map(|(name, value)| format!("\n{name:<23} {value}"));
        self.headline() + &rows.collect::<String>()
    }

    /// How many spheres in what.
    fn headline(&self) -> String {
        let unit = self.unit;
        let [a, b, c] = self.mesh.bounding_box.size;
        format!(
            "{} spheres ({}, radius {} {unit}) in {} x {} x {} {unit}, volume {} {unit}3",
            self.spheres,
            self.method,
            significant(self.radius, 6),
            significant(a, 4),
            significant(b, 4),
            significant(c, 4),
            significant(self.mesh.volume.unwrap_or(f64::NAN), 4),
        )
    }

    /// Names and values of the fit.
    pub(crate) fn fit_lines(&self) -> Vec<(&'static str, String)> {
        let (fit, unit) = (&self.fit, self.unit);
        let length = |value: f64| format!("{} {unit}", significant(value, 3));
        vec![
            (
                "sphere volumes / mesh",
                format!("{:.4}", fit.packing_fraction),
            ),
            ("union / mesh", format!("{:.4}", fit.union_fraction)),
            ("largest overlap", length(fit.max_overlap)),
            ("largest protrusion", length(fit.max_protrusion)),
            ("surface error, rms", length(fit.surface_rms)),
            ("surface error, largest", length(fit.surface_hausdorff)),
            ("roughness, rms", length(fit.roughness_rms)),
            ("centroid offset", length(fit.centroid_offset)),
        ]
    }

    /// Names and values of mass and cost.
    pub(crate) fn cost_lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = Vec::new();
        if let (Some(mass), Some(density)) = (self.mass_kg, self.fraction_density_kg_m3) {
            lines.push(("mass", format!("{mass:.4e} kg")));
            lines.push(("fraction density", format!("{density:.1} kg/m3")));
        }
        lines.extend(self.cost.lines());
        lines
    }

    /// Names and values of the shape of the mesh.
    pub(crate) fn shape_lines(&self) -> Vec<(&'static str, String)> {
        self.shape.lines(self.unit)
    }

    /// Names and values of moments and axes.
    pub(crate) fn moment_lines(&self) -> Vec<(&'static str, String)> {
        self.moments.lines(self.unit)
    }

    /// Names and values of pieces and contacts.
    pub(crate) fn connection_lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = self.connections.lines();
        lines.extend(self.union_surface.as_ref().map(UnionFile::line));
        lines
    }

    /// What the user should know of the mesh.
    pub(crate) fn mesh_warnings(&self) -> &[Warning] {
        &self.mesh.warnings
    }

    /// What the user should know of the spheres.
    pub(crate) fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Where the result comes from.
    pub(crate) fn provenance(&self) -> Vec<String> {
        let head = format!("seedfill {}, {}", self.header.version, self.headline());
        let inputs = self.header.inputs.iter();
        let inputs = inputs.map(|(file, sum)| format!("{file}: SHA-256 {sum}"));
        std::iter::once(head).chain(inputs).collect()
    }
}

/// Centre and radius in a unit.
fn in_unit(sphere: &Sphere, metre: f64) -> [f64; 4] {
    let c = sphere.centre;
    [c.x, c.y, c.z, sphere.radius].map(|length| length / metre)
}

/// Name of a method as its flag takes it.
fn name_of(method: MethodName) -> String {
    let value = clap::ValueEnum::to_possible_value(&method);
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Fit figures with lengths in a unit.
fn fit_in(fit: &FitReport, metre: f64) -> FitSummary {
    FitSummary {
        packing_fraction: fit.packing_fraction,
        union_fraction: fit.union_fraction,
        max_protrusion: fit.max_protrusion / metre,
        max_overlap: fit.max_overlap / metre,
        surface_rms: fit.surface_rms / metre,
        surface_hausdorff: fit.surface_hausdorff / metre,
        roughness_rms: fit.roughness_rms / metre,
        mean_gap: fit.mean_gap / metre,
        centroid_offset: fit.centroid_offset / metre,
        inertia_error_percent: fit.inertia_error_percent,
    }
}

/// Components of a vector (m) in a unit.
fn array(vector: &impl std::ops::Index<usize, Output = f64>, metre: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| vector[k] / metre)
}
