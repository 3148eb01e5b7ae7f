//! Signed distance, inside test and surface samples.

use nalgebra::{Rotation3, Vector2, Vector3};
use proptest::prelude::*;
use trimesh::{LengthUnit, SignedDistance, TriMesh, shapes, winding_number};

/// Exact signed distance to a box of the half sizes given.
fn box_distance(half: [f64; 3], point: &Vector3<f64>) -> f64 {
    let q = Vector3::from_fn(|k, _| point[k].abs() - half[k]);
    q.sup(&Vector3::zeros()).norm() + q.max().min(0.0)
}

/// Faces, edges, corners, their neighbourhoods: a box of 12 triangles has all cases of the
/// sign rule, among them points exactly opposite an edge or a corner.
#[test]
fn distance_to_a_box_is_exact_with_the_right_sign_everywhere() {
    let half = [4.5, 2.5, 2.0];
    let mesh = shapes::cuboid(half.map(|h| 2.0 * h)).unwrap();
    let distance = SignedDistance::new(&mesh).unwrap();
    let steps = [-1.6, -1.0, -0.999, -0.5, 0.0, 0.3, 0.999, 1.0, 1.001, 1.6];
    for x in steps {
        for y in steps {
            for z in steps {
                let point = Vector3::new(x * half[0], y * half[1], z * half[2]);
                let (found, exact) = (distance.distance(&point), box_distance(half, &point));
                assert!(
                    (found - exact).abs() < 1e-14,
                    "{point:?}: {found} for {exact}"
                );
            }
        }
    }
}

#[test]
fn known_points_lie_in_or_out_of_a_torus() {
    let mesh = shapes::torus(3.0, 1.0, 60, 40).unwrap();
    let distance = SignedDistance::new(&mesh).unwrap();
    for (point, inside) in [
        ([0.0, 0.0, 0.0], false),
        ([3.0, 0.0, 0.0], true),
        ([0.0, -3.0, 0.9], true),
        ([2.01, 0.0, 0.0], true),
        ([1.98, 0.0, 0.0], false),
        ([3.0, 0.0, 1.01], false),
        ([-4.02, 0.0, 0.0], false),
    ] {
        assert_eq!(
            distance.contains(&Vector3::from(point)),
            inside,
            "{point:?}"
        );
    }
}

#[test]
fn outward_is_the_direction_in_which_the_distance_grows() {
    let mesh = shapes::ellipsoid([4.6, 2.5, 2.2], 12).unwrap();
    let distance = SignedDistance::new(&mesh).unwrap();
    for point in [[1.0, 2.0, 0.2], [0.4, 0.3, 1.9], [5.0, 1.0, 1.0]].map(Vector3::from) {
        let found = distance.nearest(&point);
        let there = found.point + found.outward * found.distance;
        assert!((there - point).norm() < 1e-14);
        let further = distance.distance(&(point + found.outward * 1e-6));
        // The nearest feature stays the same over 1e-6, so the growth is exact to rounding.
        assert!((further - found.distance - 1e-6).abs() < 1e-12);
    }
}

/// Mean of x², y², z² over a sphere's surface is r²/3; the samples follow a low-discrepancy
/// sequence, so 10 000 of them do far better than the 1 % of random ones.
#[test]
fn surface_samples_average_as_the_area_does() {
    let mesh = shapes::ellipsoid([1.0, 1.0, 1.0], 30).unwrap();
    let samples = mesh.surface_samples(10_000);
    for k in 0..3 {
        let mean = samples.iter().map(|s| s.point[k].powi(2)).sum::<f64>() / 10_000.0;
        assert!((mean - 1.0 / 3.0).abs() < 2e-3, "axis {k}: {mean}");
    }
    let distance = SignedDistance::new(&mesh).unwrap();
    for sample in samples.iter().step_by(97) {
        assert!(distance.distance(&sample.point).abs() < 1e-15);
        assert!(sample.normal.dot(&sample.point) > 0.9, "normal points in");
    }
}

/// Radius and height of the cone, m.
const CONE: [f64; 2] = [2.0, 8.0];

/// Exact signed distance to a cone that stands on the origin along z.
fn cone_distance(point: &Vector3<f64>) -> f64 {
    let [radius, height] = CONE;
    let at = Vector2::new(point.x.hypot(point.y), point.z);
    let to_segment = |a: Vector2<f64>, b: Vector2<f64>| {
        let way = b - a;
        let part = ((at - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        (at - a - way * part).norm()
    };
    let rim = Vector2::new(radius, 0.0);
    let base = to_segment(Vector2::zeros(), rim);
    let side = to_segment(rim, Vector2::new(0.0, height));
    let inside = at.y > 0.0 && at.x < radius * (1.0 - at.y / height);
    base.min(side) * if inside { -1.0 } else { 1.0 }
}

/// A cone of slivers that lies askew: each is cut for the tree, and the nearest point may lie on
/// any piece. The slivers keep within the sagitta of the circle, 2 (1 - cos(pi / 400)) = 6.2e-5 m.
#[test]
fn distance_to_a_cone_of_slivers_is_that_of_the_cone() {
    let [radius, height] = CONE;
    let n = 400;
    let turn = Rotation3::from_euler_angles(0.8, 0.3, 0.6);
    let rim = |k: usize| {
        let angle = std::f64::consts::TAU * (k % n) as f64 / n as f64;
        turn * Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    };
    let tip = turn * Vector3::new(0.0, 0.0, height);
    let soup: Vec<_> = (0..n)
        .flat_map(|k| {
            let (a, b) = (rim(k), rim(k + 1));
            [[a, b, tip], [b, a, Vector3::zeros()]]
        })
        .collect();
    let mesh = TriMesh::from_triangles(&soup, LengthUnit::Metre, "cone")
        .unwrap()
        .mesh;
    let distance = SignedDistance::new(&mesh).unwrap();
    for x in [-2.5, -1.3, 0.0, 0.02, 0.7, 1.9] {
        for y in [-2.0, 0.0, 0.3, 1.1] {
            for z in [-1.0, 0.0, 0.01, 0.5, 3.0, 6.5, 8.5] {
                let point = Vector3::new(x, y, z);
                let (found, exact) = (distance.distance(&(turn * point)), cone_distance(&point));
                assert!(
                    (found - exact).abs() < 6.3e-5,
                    "{point:?}: {found} for {exact}"
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// The tree gives the distance of the plain search over all triangles, and the sign that of
    /// the winding number, also after a turn and a shift.
    #[test]
    fn tree_and_sign_agree_with_the_plain_sums(
        x in -5.0..5.0, y in -3.0..3.0, z in -1.5..1.5,
        roll in -3.0..3.0, pitch in -1.5..1.5,
    ) {
        let mesh = shapes::torus(3.0, 1.0, 14, 9).unwrap();
        let turn = Rotation3::from_euler_angles(roll, pitch, 0.7);
        let shift = Vector3::new(4.0, -7.0, 2.0);
        let soup: Vec<_> = (0..mesh.triangles().len())
            .map(|t| mesh.corners(t).map(|c| turn * c + shift))
            .collect();
        let moved = TriMesh::from_triangles(&soup, LengthUnit::Metre, "moved").unwrap().mesh;
        let point = Vector3::new(x, y, z);
        let found = SignedDistance::new(&mesh).unwrap().distance(&point);
        let again = SignedDistance::new(&moved).unwrap().distance(&(turn * point + shift));
        prop_assert!((found - again).abs() < 1e-12, "moved: {found} and {again}");
        let inside = winding_number(&mesh, &point) > 0.5;
        prop_assert!(found.abs() < 1e-12 || (found < 0.0) == inside);
        // No sample of the surface lies nearer, and the nearest is at most some spacings (0.08) off.
        let nearest = mesh
            .surface_samples(20_000)
            .iter()
            .map(|s| (s.point - point).norm())
            .fold(f64::INFINITY, f64::min);
        prop_assert!(nearest > found.abs() - 1e-12 && nearest < found.abs() + 0.12);
    }
}

/// 1 within, 0 without, to the rounding of 12 arctangents.
#[test]
fn winding_number_counts_the_enclosures() {
    let mesh = shapes::cuboid([2.0, 2.0, 2.0]).unwrap();
    for (point, expected) in [([0.3, 0.2, -0.9], 1.0), ([1.1, 0.0, 0.0], 0.0)] {
        let found = winding_number(&mesh, &Vector3::from(point));
        assert!((found - expected).abs() < 1e-14, "{found}");
    }
}

/// At the tip of a leaning spike the normal of one triangle alone misleads; the angle-weighted
/// normal must give the sign of the winding number all round every corner and edge.
#[test]
fn sign_is_right_round_the_tip_of_a_leaning_spike() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 0.8, 0.1],
        [3.0, 2.0, 4.0],
    ];
    let corners = corners.map(Vector3::from);
    let soup = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]].map(|t| t.map(|i| corners[i]));
    let mesh = TriMesh::from_triangles(&soup, LengthUnit::Metre, "spike")
        .unwrap()
        .mesh;
    let distance = SignedDistance::new(&mesh).unwrap();
    let around = |i: i32, n: i32| f64::from(i % n) - f64::from(n - 1) / 2.0;
    for corner in corners {
        for i in 0..1000 {
            let offset = Vector3::new(around(i, 10), around(i / 10, 10), around(i / 100, 10));
            let point = corner + offset * 0.05;
            let inside = winding_number(&mesh, &point) > 0.5;
            assert_eq!(distance.distance(&point) < 0.0, inside, "at {point:?}");
        }
    }
}
