//! Lengths, shape and principal axes of bodies whose values are known.

use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::PI;
use trimesh::{LengthUnit, TriMesh, shapes};

/// The mesh turned about an odd axis and moved.
fn turned(mesh: &TriMesh, angles: [f64; 3]) -> TriMesh {
    let [a, b, c] = angles;
    let turn = UnitQuaternion::from_euler_angles(a, b, c);
    let moved = |corner: Vector3<f64>| turn * corner + Vector3::new(3e-3, -2e-3, 5e-3);
    let soup: Vec<_> = (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(moved))
        .collect();
    TriMesh::from_triangles(&soup, LengthUnit::Metre, "turned")
        .expect("a turned body is a body")
        .mesh
}

const TURNS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [0.4, -0.9, 2.2],
    [1.1, 0.6, -0.3],
    [-2.0, 1.3, 0.7],
];

/// A cuboid, a square plate and a cube in any direction: of the last two the inertia leaves some or all
/// axes open, so only the smallest box finds their edges. The tolerance is rounding.
#[test]
fn lengths_are_the_edges_of_a_cuboid_in_any_direction() {
    for size in [[4e-3, 2e-3, 1e-3], [3e-3, 3e-3, 1e-3], [2e-3, 2e-3, 2e-3]] {
        let mesh = shapes::cuboid(size).unwrap();
        for angles in TURNS {
            let shape = turned(&mesh, angles).shape().unwrap();
            for (found, exact) in shape.lengths.iter().zip(size) {
                assert!(
                    (found / exact - 1.0).abs() < 1e-9,
                    "{size:?} {angles:?}: {shape:?}"
                );
            }
            assert!((shape.elongation - size[1] / size[0]).abs() < 1e-9);
            assert!((shape.flatness - size[2] / size[1]).abs() < 1e-9);
        }
    }
}

/// Wadell's sphericity of a cube is (π/6)^(1/3), and its equivalent diameter a (6/π)^(1/3). A ball of
/// 8 n² triangles has 1 up to the error of its facets, which is of the order of 1/n²: 0.2 % at n = 30.
#[test]
fn sphericity_and_equivalent_diameter_have_their_closed_forms() {
    let cube = shapes::cuboid([2e-3; 3]).unwrap().shape().unwrap();
    assert!((cube.sphericity - (PI / 6.0).cbrt()).abs() < 1e-12);
    assert!((cube.equivalent_diameter / (2e-3 * (6.0 / PI).cbrt()) - 1.0).abs() < 1e-12);
    let ball = shapes::ellipsoid([1e-3; 3], 30).unwrap().shape().unwrap();
    assert!((ball.sphericity - 1.0).abs() < 2e-3 && ball.sphericity < 1.0);
    assert!((ball.equivalent_diameter / 2e-3 - 1.0).abs() < 2e-3);
}

/// Of an ellipsoid the smallest box is that of its axes; a mesh inscribed with 8 n² triangles reaches
/// each axis exactly, and the box may be smaller by the sagitta of a facet, below 0.5 % at n = 24.
#[test]
fn lengths_of_an_ellipsoid_are_its_axes() {
    let mesh = shapes::ellipsoid([3e-3, 2e-3, 1e-3], 24).unwrap();
    for angles in TURNS {
        let lengths = turned(&mesh, angles).shape().unwrap().lengths;
        for (found, exact) in lengths.iter().zip([6e-3, 4e-3, 2e-3]) {
            assert!((found / exact - 1.0).abs() < 5e-3, "{lengths:?}");
        }
    }
}

/// The axes of a turned cuboid are the turned axes of the cuboid, the longest edge with the least moment;
/// the angle to the unturned body is that of the turn about a common axis.
#[test]
fn principal_axes_turn_with_the_body() {
    let mesh = shapes::cuboid([4e-3, 2e-3, 1e-3]).unwrap();
    let plain = mesh.moments().principal_axes();
    let about_z = turned(&mesh, [0.0, 0.0, 0.3]).moments().principal_axes();
    for (found, exact) in about_z.angles_to(&plain).iter().zip([0.3, 0.3, 0.0]) {
        assert!((found.unwrap() - exact).abs() < 1e-9, "{found:?}");
    }
    for angles in TURNS {
        let [a, b, c] = angles;
        let turn = UnitQuaternion::from_euler_angles(a, b, c);
        let found = turned(&mesh, angles).moments().principal_axes();
        for (k, axis) in found.axes.iter().enumerate() {
            let exact = turn * Vector3::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
            assert!((axis.dot(&exact).abs() - 1.0).abs() < 1e-9, "{k}");
            assert!((found.moments[k] / plain.moments[k] - 1.0).abs() < 1e-9);
        }
        let [x, y, z] = found.axes;
        assert!((x.cross(&y) - z).norm() < 1e-12, "right-handed");
    }
    // A square plate: the axis across is known, the two in its plane are not.
    let plate = shapes::cuboid([3e-3, 3e-3, 1e-3])
        .unwrap()
        .moments()
        .principal_axes();
    for angles in [plate.angles_to(&plain), plain.angles_to(&plate)] {
        assert!(angles[0].is_none() && angles[1].is_none() && angles[2].is_some());
    }
}
