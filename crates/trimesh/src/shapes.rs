//! Meshes of bodies with known volume and inertia.

use crate::{Error, LengthUnit, TriMesh};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Refuses sizes that make no body.
fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    let must = "a positive number";
    Err(Error::BadShape { what, value, must })
}

/// Makes the mesh of loose triangles in metres.
fn mesh_of(soup: &[[Vector3<f64>; 3]], source: &str) -> Result<TriMesh, Error> {
    Ok(TriMesh::from_triangles(soup, LengthUnit::Metre, source)?.mesh)
}

/// Box of the edge lengths given, m, with its middle at the origin; 12 triangles.
///
/// # Errors
///
/// A length that is not positive.
pub fn cuboid(size: [f64; 3]) -> Result<TriMesh, Error> {
    size.iter()
        .try_for_each(|&s| positive("an edge length in m", s))?;
    let corner = |bits: usize| {
        Vector3::from_fn(|k, _| if bits >> k & 1 == 1 { 0.5 } else { -0.5 } * size[k])
    };
    let squares = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let soup: Vec<_> = squares
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|triangle| triangle.map(corner))
        .collect();
    mesh_of(&soup, "cuboid")
}

/// Ellipsoid of the semi-axes given, m, about the origin; 8 n² triangles, inscribed.
///
/// An octahedron whose faces are cut n-fold along each edge and pushed out to the surface.
///
/// # Errors
///
/// A semi-axis that is not positive, or n = 0.
pub fn ellipsoid(semi_axes: [f64; 3], n: usize) -> Result<TriMesh, Error> {
    semi_axes
        .iter()
        .try_for_each(|&s| positive("a semi-axis in m", s))?;
    positive("the number of cuts", n as f64)?;
    let mut soup = Vec::with_capacity(8 * n * n);
    for octant in 0..8_usize {
        let sign = |k: usize| if octant >> k & 1 == 1 { -1.0 } else { 1.0 };
        let point = |i: usize, j: usize| {
            let d = Vector3::new(i as f64, j as f64, (n - i - j) as f64).normalize();
            Vector3::from_fn(|k, _| d[k] * sign(k) * semi_axes[k])
        };
        for i in 0..n {
            for j in 0..n - i {
                soup.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
                if i + j + 2 <= n {
                    soup.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
    }
    // Octants with an odd number of mirrored axes come out inside-in; building turns them.
    mesh_of(&soup, "ellipsoid")
}

/// Torus about the z axis: radius of the ring, radius of the tube, m; 2·n·m triangles.
///
/// # Errors
///
/// Radii that are not positive, a tube that closes the hole, or fewer than 3 cuts.
pub fn torus(ring: f64, tube: f64, n_ring: usize, n_tube: usize) -> Result<TriMesh, Error> {
    positive("the radius of the tube in m", tube)?;
    positive(
        "the radius of the ring less that of the tube in m",
        ring - tube,
    )?;
    positive("the number of cuts less 2", n_ring.min(n_tube) as f64 - 2.0)?;
    let point = |i: usize, j: usize| {
        let (p, t) = (
            TAU * (i % n_ring) as f64 / n_ring as f64,
            TAU * (j % n_tube) as f64 / n_tube as f64,
        );
        let away = ring + tube * t.cos();
        Vector3::new(away * p.cos(), away * p.sin(), tube * t.sin())
    };
    let soup: Vec<_> = (0..n_ring)
        .flat_map(|i| (0..n_tube).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let (a, b) = (point(i, j), point(i + 1, j));
            let (c, d) = (point(i + 1, j + 1), point(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh_of(&soup, "torus")
}
