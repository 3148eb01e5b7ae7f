//! From the shape of a seed to a body, once for each distinct filling.

use crate::{Error, Scene, SeedSettings};
use geometry::clump::{Clump, MassProperties, volume_of_sphere};
use sphere_fill::{FillSettings, FitReport, InertiaSource, union_moments};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use trimesh::{CheckedMesh, LengthUnit, TriMesh, read_mesh};

/// Cuts along each edge of the octahedron that becomes the mesh of an ellipsoid: 2048 triangles, which lie within
/// 0.5 % of its radius.
const CUTS: usize = 16;

/// A seed as a body, with the report of how well the spheres stand for it.
#[derive(Debug, Clone)]
pub struct SeedBody {
    /// The body, in its principal frame.
    pub clump: Clump,
    /// Only the spheres that can be seen or touched.
    pub outer: Clump,
    /// Spheres in the frame of the mesh, m.
    pub spheres: Vec<geometry::clump::Sphere>,
    /// Volume of the seed, m³: of the shape, or of the union of the spheres where these are the shape.
    pub volume: f64,
    /// The shape that the spheres approximate; `None` if the spheres are the shape.
    pub shape: Option<FilledShape>,
    /// Density of the spheres by the study's eq. (9), kg/m³.
    pub fraction_density: f64,
}

/// A shape that spheres stand for.
#[derive(Debug, Clone)]
pub struct FilledShape {
    /// Its mesh.
    pub mesh: CheckedMesh,
    /// Fit of the spheres, before a scale of the seed.
    pub report: FitReport,
}

impl SeedBody {
    /// Radius of the sphere with the volume of the seed, m.
    pub fn volume_radius(&self) -> f64 {
        (3.0 * self.volume / (4.0 * std::f64::consts::PI)).cbrt()
    }
}

/// Bodies made so far; shared between threads.
#[derive(Debug, Default)]
pub struct FillingLibrary {
    /// Body by mesh and filling.
    bodies: Mutex<BTreeMap<String, Arc<SeedBody>>>,
}

impl FillingLibrary {
    /// The body of a kind of seed; made on first use.
    ///
    /// # Errors
    ///
    /// A mesh that is refused or cannot be filled.
    pub fn body(&self, scene: &Scene, seed: &SeedSettings) -> Result<Arc<SeedBody>, Error> {
        let shape = match seed.shape_file() {
            Some(file) => scene.folder.join(file).display().to_string(),
            None => format!("{:?} {:?}", seed.sphere, seed.ellipsoid),
        };
        let key = format!(
            "{shape} {:?} {:?} {:?} {} {:?}",
            seed.mesh_unit,
            seed.spheres_unit,
            seed.filling,
            seed.mass_kg(),
            seed.scale
        );
        // The lock is held while a body is made: others wait for it and do not make it again.
        let mut bodies = self.bodies.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(body) = bodies.get(&key) {
            return Ok(Arc::clone(body));
        }
        let body = Arc::new(make(scene, seed)?);
        bodies.insert(key, Arc::clone(&body));
        Ok(body)
    }

    /// Whether no body was made yet.
    pub fn is_empty(&self) -> bool {
        let bodies = self.bodies.lock().unwrap_or_else(PoisonError::into_inner);
        bodies.is_empty()
    }
}

/// Makes the body of a shape.
fn make(scene: &Scene, seed: &SeedSettings) -> Result<SeedBody, Error> {
    let body = match (&seed.mesh, seed.sphere, seed.ellipsoid) {
        _ if seed.spheres.is_some() => listed(seed, seed.listed_spheres(&scene.folder)?)?,
        (Some(mesh), _, _) => {
            let unit = seed.mesh_unit.unwrap_or(LengthUnit::Metre);
            let mesh = read_mesh(&scene.folder.join(mesh), unit);
            filled(seed, mesh.map_err(|source| refused(seed, source))?)?
        }
        (None, Some(diameter), _) => ball(seed, 0.5 * diameter.si())?,
        (None, None, Some(axes)) => filled(seed, ellipsoid(seed, axes.map(|a| 0.5 * a.si()))?)?,
        (None, None, None) => {
            return Err(Error::SeedKeys {
                file: scene.file.clone(),
                seed: seed.name.clone(),
                problem: "no shape is stated; state mesh, sphere, ellipsoid or spheres".into(),
            });
        }
    };
    match seed.scale {
        None => Ok(body),
        Some(scale) => scaled(&body, scale, &seed.name),
    }
}

/// The refusal of a mesh.
fn refused(seed: &SeedSettings, source: trimesh::Error) -> Error {
    Error::Mesh {
        seed: seed.name.clone(),
        source,
    }
}

/// The refusal of a filling.
fn unfilled(seed: &SeedSettings, source: sphere_fill::Error) -> Error {
    Error::Filling {
        seed: seed.name.clone(),
        source,
    }
}

/// Fills a mesh as the seed says.
fn filled(seed: &SeedSettings, mesh: CheckedMesh) -> Result<SeedBody, Error> {
    let stated = seed.filling().map_err(|source| Error::SeedQuantity {
        seed: seed.name.clone(),
        source,
    })?;
    let Some(stated) = stated else {
        return Err(unfilled(seed, geometry::clump::Error::NoSpheres.into()));
    };
    let settings = FillSettings {
        method: stated.method,
        count: stated.sphere_count,
        roughness: stated.roughness.map(input::quantity::Length::si),
        seed: stated.seed,
        ..FillSettings::new(stated.sphere_radius.si())
    };
    let unfilled = |source| unfilled(seed, source);
    let filling = sphere_fill::fill(&mesh.mesh, &settings).map_err(unfilled)?;
    let mass = seed.mass_kg();
    let clump = filling.clump(mass, InertiaSource::Mesh).map_err(unfilled)?;
    Ok(SeedBody {
        outer: clump.without_hidden_spheres(),
        clump,
        fraction_density: filling.fraction_density(mass),
        spheres: filling.spheres,
        volume: filling.mesh_moments.volume,
        shape: Some(FilledShape {
            mesh,
            report: filling.report,
        }),
    })
}

/// A body of one sphere of a radius, m.
fn ball(seed: &SeedSettings, radius: f64) -> Result<SeedBody, Error> {
    let mesh = ellipsoid(seed, [radius; 3])?;
    let sphere = geometry::clump::Sphere {
        centre: nalgebra::Vector3::zeros(),
        radius,
    };
    let unfilled = |source| unfilled(seed, source);
    let filling = sphere_fill::measure(&mesh.mesh, vec![sphere]).map_err(unfilled)?;
    let density = seed.mass_kg() / volume_of_sphere(radius);
    let clump = Clump::sphere(radius, density).map_err(|e| unfilled(e.into()))?;
    Ok(SeedBody {
        outer: clump.clone(),
        clump,
        fraction_density: density,
        spheres: filling.spheres,
        volume: filling.mesh_moments.volume,
        shape: Some(FilledShape {
            mesh,
            report: filling.report,
        }),
    })
}

/// A body of the spheres of a list as they are: its mass is spread evenly over their union.
fn listed(seed: &SeedSettings, spheres: Vec<geometry::clump::Sphere>) -> Result<SeedBody, Error> {
    let (union, mass) = (union_moments(&spheres), seed.mass_kg());
    let properties = MassProperties {
        mass,
        centre: union.centroid,
        inertia: union.inertia * (mass / union.volume),
    };
    let clump = Clump::new(&spheres, &properties).map_err(|source| Error::Body {
        seed: seed.name.clone(),
        source,
    })?;
    let volumes = spheres.iter().map(|s| volume_of_sphere(s.radius));
    Ok(SeedBody {
        outer: clump.without_hidden_spheres(),
        clump,
        fraction_density: mass / volumes.sum::<f64>(),
        spheres,
        volume: union.volume,
        shape: None,
    })
}

/// Mesh of an ellipsoid of these semi-axes, m, with its volume.
fn ellipsoid(seed: &SeedSettings, semi_axes: [f64; 3]) -> Result<CheckedMesh, Error> {
    let refused = |source| refused(seed, source);
    let inscribed = trimesh::shapes::ellipsoid(semi_axes, CUTS).map_err(refused)?;
    let volume = 8.0 * volume_of_sphere(0.5) * semi_axes.iter().product::<f64>();
    let factor = (volume / inscribed.moments().volume).cbrt();
    grown(&inscribed, factor).map_err(refused)
}

/// A mesh with all lengths multiplied by a factor.
fn grown(mesh: &TriMesh, factor: f64) -> Result<CheckedMesh, trimesh::Error> {
    let triangles: Vec<_> = (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(|c| c * factor))
        .collect();
    TriMesh::from_triangles(&triangles, LengthUnit::Metre, mesh.source())
}

/// The body with all lengths multiplied by a factor. It is made from the filling of the mesh as it is,
/// since a search for another filling could end in another packing.
fn scaled(body: &SeedBody, factor: f64, seed: &str) -> Result<SeedBody, Error> {
    let shape = body.shape.as_ref().map(|shape| {
        Ok(FilledShape {
            mesh: grown(&shape.mesh.mesh, factor)?,
            report: shape.report,
        })
    });
    let shape = shape.transpose().map_err(|source| Error::Mesh {
        seed: seed.to_owned(),
        source,
    })?;
    let refused = |source: geometry::clump::Error| Error::Filling {
        seed: seed.to_owned(),
        source: source.into(),
    };
    let larger = |s: &geometry::clump::Sphere| geometry::clump::Sphere {
        centre: s.centre * factor,
        radius: s.radius * factor,
    };
    Ok(SeedBody {
        clump: body.clump.scaled(factor).map_err(refused)?,
        outer: body.outer.scaled(factor).map_err(refused)?,
        spheres: body.spheres.iter().map(larger).collect(),
        fraction_density: body.fraction_density / factor.powi(3),
        volume: body.volume * factor.powi(3),
        shape,
    })
}
