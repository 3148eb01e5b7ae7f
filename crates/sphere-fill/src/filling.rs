//! A body turned into spheres.

use crate::count_search::{fewest_spheres, require_met};
use crate::surface_gap::gaps_at;
use crate::union_moments::union_moments;
use crate::{
    Body, DistanceTransform, Error, Favier, Ferellec, FillSettings, FitReport, Lattice, Method,
    Pack, Smooth, Surface,
};
use geometry::clump::{Clump, MassProperties, Sphere, volume_of_sphere};
use nalgebra::Vector3;
use trimesh::{TriMesh, VolumeMoments};

/// A way of placing spheres in a body.
pub trait Place {
    /// Places the spheres; the answer depends on body and settings only.
    ///
    /// # Errors
    ///
    /// A count or roughness that is not reached.
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error>;
}

/// Whose mass distribution a body of spheres gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InertiaSource {
    /// That of the seed: centre of mass and inertia of the mesh at uniform density.
    #[default]
    Mesh,
    /// That of the spheres: of their union at uniform density.
    Spheres,
}

/// A body turned into spheres.
#[derive(Debug, Clone, PartialEq)]
pub struct Filling {
    /// Spheres in the frame of the mesh, m.
    pub spheres: Vec<Sphere>,
    /// How well they stand for the body.
    pub report: FitReport,
    /// Settings that made them.
    pub settings: FillSettings,
    /// Volume integrals of the mesh.
    pub mesh_moments: VolumeMoments,
    /// Volume integrals of the union of spheres.
    pub union_moments: VolumeMoments,
}

/// Fills the body that a closed mesh bounds.
///
/// The same mesh and settings give the same spheres to the last bit.
///
/// # Errors
///
/// Invalid settings, a mesh that is not closed, a radius of which none or far too
/// many fit, a count, roughness or target that is not reached.
pub fn fill(mesh: &TriMesh, settings: &FillSettings) -> Result<Filling, Error> {
    settings.check()?;
    let body = Body::new(mesh)?;
    body.check_radius(settings.radius)?;
    if !settings.method.follows_count() {
        body.check_number(settings.radius)?;
    }
    let sought = settings.target.is_some()
        || settings.roughness.is_some() && settings.method == Method::Surface;
    if sought && settings.count.is_none() && settings.method.follows_count() {
        return fewest_spheres(&body, settings);
    }
    let filling = fill_body(&body, settings)?;
    require_met(&body, &filling)?;
    Ok(filling)
}

/// Fills a body by the method of the settings, without a look at the target.
pub(crate) fn fill_body(body: &Body<'_>, settings: &FillSettings) -> Result<Filling, Error> {
    let method: &dyn Place = match settings.method {
        Method::Pack => &Pack,
        Method::Lattice => &Lattice,
        Method::Smooth => &Smooth,
        Method::Surface => &Surface,
        Method::Favier => &Favier,
        Method::Ferellec => &Ferellec,
        Method::DistanceTransform => &DistanceTransform,
    };
    let mut spheres = method.place(body, settings)?;
    let most = settings.max_spheres.unwrap_or(usize::MAX);
    if settings.count.is_none() && spheres.len() > most {
        let limited = FillSettings {
            count: Some(most),
            ..*settings
        };
        spheres = method.place(body, &limited)?;
    }
    if spheres.is_empty() {
        return Err(Error::RadiusTooLarge {
            mesh: body.mesh.source().to_owned(),
            radius_mm: settings.radius * 1e3,
            largest_mm: body.inscribed_radius * 1e3,
        });
    }
    Ok(filling_of(body, spheres, settings))
}

/// Measures spheres that came from elsewhere, in the frame of the mesh.
///
/// The radius of the settings of the result is that of the smallest sphere.
///
/// # Errors
///
/// No sphere, a sphere whose centre or radius is invalid, a mesh that is not closed.
pub fn measure(mesh: &TriMesh, spheres: Vec<Sphere>) -> Result<Filling, Error> {
    let radii = spheres.iter().map(|s| s.radius);
    let settings = FillSettings::new(radii.fold(f64::INFINITY, f64::min));
    let body = Body::new(mesh)?;
    let properties = MassProperties {
        mass: 1.0,
        centre: body.moments.centroid,
        inertia: body.moments.inertia * (1.0 / body.moments.volume),
    };
    // Building a rigid body checks every sphere.
    Clump::new(&spheres, &properties)?;
    Ok(filling_of(&body, spheres, &settings))
}

/// Spheres with their report.
fn filling_of(body: &Body<'_>, spheres: Vec<Sphere>, settings: &FillSettings) -> Filling {
    let union_moments = union_moments(&spheres);
    Filling {
        report: FitReport::new(body, &spheres, &union_moments),
        spheres,
        settings: *settings,
        mesh_moments: body.moments,
        union_moments,
    }
}

impl Filling {
    /// Density of the sphere material that gives the body its mass, kg/m³; mass in kg.
    ///
    /// # Formula
    ///
    /// ρ = m / (N V), the study's eq. (9), with the sum of the sphere volumes for N V.
    pub fn fraction_density(&self, mass: f64) -> f64 {
        let volumes = self.spheres.iter().map(|s| volume_of_sphere(s.radius));
        mass / volumes.sum::<f64>()
    }

    /// Points that share the area of the mesh evenly, with the gap from each to the spheres, m:
    /// positive where these fall short, negative where they stand out.
    pub fn gaps(&self, mesh: &TriMesh, n: usize) -> Vec<(Vector3<f64>, f64)> {
        let samples = mesh.surface_samples(n);
        let gaps = gaps_at(samples.iter().map(|sample| &sample.point), &self.spheres);
        samples
            .iter()
            .map(|sample| sample.point)
            .zip(gaps)
            .collect()
    }

    /// Rigid body of the mass given, kg.
    ///
    /// # Errors
    ///
    /// A mass that is not positive.
    pub fn clump(&self, mass: f64, source: InertiaSource) -> Result<Clump, Error> {
        let moments = match source {
            InertiaSource::Mesh => &self.mesh_moments,
            InertiaSource::Spheres => &self.union_moments,
        };
        let properties = MassProperties {
            mass,
            centre: moments.centroid,
            inertia: moments.inertia * (mass / moments.volume),
        };
        Ok(Clump::new(&self.spheres, &properties)?)
    }
}
