//! Volume, centroid and inertia against closed forms.

use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::PI;
use trimesh::{LengthUnit, TriMesh, VolumeMoments, shapes};

/// Largest difference of two tensors relative to the size of the second.
fn tensor_error(found: &Matrix3<f64>, exact: &Matrix3<f64>) -> f64 {
    (found - exact).norm() / exact.norm()
}

/// Flat faces are met exactly, so only rounding is left: 1e-14 is some tens of units of it.
#[test]
fn box_has_exact_volume_area_and_inertia() {
    let [a, b, c] = [9.19e-3, 5.08e-3, 4.45e-3];
    let mesh = shapes::cuboid([a, b, c]).unwrap();
    let found = mesh.moments();
    let volume = a * b * c;
    let side = |p: f64, q: f64| volume / 12.0 * (p * p + q * q);
    let exact = Matrix3::from_diagonal(&Vector3::new(side(b, c), side(c, a), side(a, b)));
    assert!((found.volume / volume - 1.0).abs() < 1e-14);
    assert!((mesh.area() / (2.0 * (a * b + b * c + c * a)) - 1.0).abs() < 1e-14);
    assert!(found.centroid.norm() < 1e-15 * a);
    assert!(tensor_error(&found.inertia, &exact) < 1e-14);
}

/// Relative errors of an ellipsoid of n cuts.
fn ellipsoid_errors(n: usize) -> [f64; 2] {
    let [a, b, c] = [4.6e-3_f64, 2.5e-3, 2.2e-3];
    let found = shapes::ellipsoid([a, b, c], n)
        .expect("positive sizes")
        .moments();
    let volume = 4.0 / 3.0 * PI * a * b * c;
    let side = |p: f64, q: f64| volume / 5.0 * (p * p + q * q);
    let exact = Matrix3::from_diagonal(&Vector3::new(side(b, c), side(c, a), side(a, b)));
    [
        (found.volume / volume - 1.0).abs(),
        tensor_error(&found.inertia, &exact),
    ]
}

/// An inscribed facet lies below the surface by the square of its size, so halving the facets
/// quarters the error. The next order adds a share of about 1/n², here below 2 %.
#[test]
fn ellipsoid_converges_with_the_square_of_the_facet_size() {
    let (coarse, fine) = (ellipsoid_errors(12), ellipsoid_errors(24));
    for k in 0..2 {
        let ratio = coarse[k] / fine[k];
        assert!((ratio - 4.0).abs() < 0.08, "quantity {k}: ratio {ratio}");
    }
    assert!(fine[0] < 3e-3, "volume error {}", fine[0]);
}

/// Torus: V = 2π²Rr², I about the axis = V (R² + 3/4 r²), across = V (R²/2 + 5/8 r²).
#[test]
fn torus_converges_with_the_square_of_the_facet_size() {
    let (ring, tube) = (3.0e-3_f64, 1.0e-3);
    let volume = 2.0 * PI * PI * ring * tube * tube;
    let across = volume * (ring * ring / 2.0 + 0.625 * tube * tube);
    let along = volume * (ring * ring + 0.75 * tube * tube);
    let exact = Matrix3::from_diagonal(&Vector3::new(across, across, along));
    let errors = |n: usize| {
        let found = shapes::torus(ring, tube, 2 * n, n).unwrap().moments();
        [
            (found.volume / volume - 1.0).abs(),
            tensor_error(&found.inertia, &exact),
        ]
    };
    let (coarse, fine) = (errors(24), errors(48));
    for k in 0..2 {
        let ratio = coarse[k] / fine[k];
        assert!((ratio - 4.0).abs() < 0.08, "quantity {k}: ratio {ratio}");
    }
    assert!(fine[1] < 0.02, "inertia error {}", fine[1]);
}

/// A body moved far and turned keeps its volume; its tensor turns along. The coordinates lose
/// the digits of the shift (1 m for a body of 9 mm: two digits), hence 1e-12.
#[test]
fn moments_follow_a_moved_and_turned_body() {
    let mesh = shapes::ellipsoid([4.6e-3, 2.5e-3, 2.2e-3], 10).unwrap();
    let turn = Rotation3::from_euler_angles(0.4, -1.2, 2.5);
    let shift = Vector3::new(1.0, -0.5, 0.3);
    let soup: Vec<_> = (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(|corner| turn * corner + shift))
        .collect();
    let moved = TriMesh::from_triangles(&soup, LengthUnit::Metre, "moved").unwrap();
    let (before, after): (VolumeMoments, _) = (mesh.moments(), moved.mesh.moments());
    let turned = turn * before.inertia * turn.inverse();
    assert!((after.volume / before.volume - 1.0).abs() < 1e-12);
    assert!((after.centroid - (turn * before.centroid + shift)).norm() < 1e-15);
    assert!(tensor_error(&after.inertia, &turned) < 1e-12);
}

/// Small bodies keep their principal moments: no absolute threshold acts below 1e-20.
#[test]
fn principal_moments_scale_with_the_fifth_power_of_length() {
    let unit = |scale: f64| {
        let mesh = shapes::ellipsoid([3.0 * scale, 2.0 * scale, scale], 6).unwrap();
        mesh.moments().principal_moments()
    };
    let (large, small) = (unit(1.0), unit(1e-4));
    for k in 0..3 {
        assert!(
            (small[k] / large[k] * 1e20 - 1.0).abs() < 1e-12,
            "moment {k}"
        );
    }
}

/// A tetrahedron has its centroid at the mean of its corners, and the tensor of its corners:
/// C = V/20 Σ d dᵀ with d from the centroid; only rounding is left.
#[test]
fn tetrahedron_has_the_centroid_and_tensor_of_its_corners() {
    let corners = [
        [1.0, 2.0, 3.0],
        [4.0, 2.5, 2.0],
        [1.5, 5.0, 3.5],
        [2.0, 2.0, 7.0],
    ];
    let corners = corners.map(Vector3::from);
    let soup = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]].map(|t| t.map(|i| corners[i]));
    let mesh = TriMesh::from_triangles(&soup, LengthUnit::Metre, "tetrahedron").unwrap();
    let found = mesh.mesh.moments();
    let mean = corners.iter().sum::<Vector3<f64>>() / 4.0;
    let [a, b, c, d] = corners;
    let volume = (b - a).dot(&(c - a).cross(&(d - a))).abs() / 6.0;
    let spread: Matrix3<f64> = corners
        .iter()
        .map(|p| (p - mean) * (p - mean).transpose())
        .sum();
    let second = spread * (volume / 20.0);
    let exact = Matrix3::identity() * second.trace() - second;
    assert!((found.volume / volume - 1.0).abs() < 1e-14);
    assert!((found.centroid - mean).norm() < 1e-14);
    assert!(tensor_error(&found.inertia, &exact) < 1e-13);
}
