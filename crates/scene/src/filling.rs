//! From the mesh of a seed to a body, once for each distinct filling.

use crate::Error;
use crate::settings::{Scene, SeedSettings};
use clump::Clump;
use sphere_fill::{FillSettings, FitReport, InertiaSource};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use trimesh::{CheckedMesh, LengthUnit, TriMesh, read_stl};

/// A seed as a body, with the report of how well the spheres stand for it.
#[derive(Debug, Clone)]
pub struct SeedBody {
    /// The body, in its principal frame.
    pub clump: Clump,
    /// Only the spheres that can be seen or touched.
    pub outer: Clump,
    /// Spheres in the frame of the mesh, m.
    pub spheres: Vec<clump::Sphere>,
    /// The mesh.
    pub mesh: CheckedMesh,
    /// Fit of the spheres, before a scale of the seed.
    pub report: FitReport,
    /// Density of the spheres by the study's eq. (9), kg/m³.
    pub fraction_density: f64,
}

impl SeedBody {
    /// Radius of the sphere with the volume of the mesh, m.
    pub fn volume_radius(&self) -> f64 {
        (3.0 * self.mesh.mesh.moments().volume / (4.0 * std::f64::consts::PI)).cbrt()
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
        let path = scene.folder.join(&seed.mesh);
        let key = format!(
            "{} {:?} {:?} {} {:?}",
            path.display(),
            seed.mesh_unit,
            seed.filling,
            seed.mass.si(),
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
}

/// Reads the mesh and fills it.
fn make(scene: &Scene, seed: &SeedSettings) -> Result<SeedBody, Error> {
    let refused = |source| Error::Mesh {
        seed: seed.name.clone(),
        source,
    };
    let unfilled = |source| Error::Filling {
        seed: seed.name.clone(),
        source,
    };
    let mesh = read_stl(&scene.folder.join(&seed.mesh), seed.mesh_unit).map_err(refused)?;
    let settings = FillSettings {
        method: seed.filling.method,
        count: seed.filling.sphere_count,
        roughness: seed.filling.roughness.map(quantity::Length::si),
        seed: seed.filling.seed,
        ..FillSettings::new(seed.filling.sphere_radius.si())
    };
    let filling = sphere_fill::fill(&mesh.mesh, &settings).map_err(unfilled)?;
    let mass = seed.mass.si();
    let clump = filling.clump(mass, InertiaSource::Mesh).map_err(unfilled)?;
    let body = SeedBody {
        outer: clump.without_hidden_spheres(),
        clump,
        fraction_density: filling.fraction_density(mass),
        spheres: filling.spheres,
        report: filling.report,
        mesh,
    };
    match seed.scale {
        None => Ok(body),
        Some(scale) => scaled(&body, scale, &seed.name),
    }
}

/// The body with all lengths multiplied by a factor. It is made from the filling of the mesh as it is,
/// since a search for another filling could end in another packing.
fn scaled(body: &SeedBody, factor: f64, seed: &str) -> Result<SeedBody, Error> {
    let mesh = &body.mesh.mesh;
    let triangles: Vec<_> = (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(|c| c * factor))
        .collect();
    let mesh = TriMesh::from_triangles(&triangles, LengthUnit::Metre, mesh.source()).map_err(
        |source| Error::Mesh {
            seed: seed.to_owned(),
            source,
        },
    )?;
    let refused = |source: clump::Error| Error::Filling {
        seed: seed.to_owned(),
        source: source.into(),
    };
    let grown = |s: &clump::Sphere| clump::Sphere {
        centre: s.centre * factor,
        radius: s.radius * factor,
    };
    Ok(SeedBody {
        clump: body.clump.scaled(factor).map_err(refused)?,
        outer: body.outer.scaled(factor).map_err(refused)?,
        spheres: body.spheres.iter().map(grown).collect(),
        fraction_density: body.fraction_density / factor.powi(3),
        mesh,
        report: body.report,
    })
}
