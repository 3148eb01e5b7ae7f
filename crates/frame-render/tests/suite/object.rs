//! Tests of pictures of one particle through the public interface.

use frame_render::{Error, ObjectView, RenderSphere, render_object};
use image::RgbImage;

/// A white sphere.
fn white(centre: [f64; 3], radius: f64) -> RenderSphere {
    RenderSphere {
        centre,
        radius,
        colour: [255; 3],
    }
}

/// Camera on an axis.
fn from(toward_camera: [f64; 3]) -> ObjectView {
    ObjectView {
        toward_camera,
        pixels: 64,
    }
}

/// A cube from -a to a, 12 triangles, counter-clockwise from outside.
fn cube(a: f64) -> Vec<[[f64; 3]; 3]> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |u: f64, v: f64| {
                let mut point = [0.0; 3];
                point[axis] = side * a;
                point[(axis + 1) % 3] = u * a;
                point[(axis + 2) % 3] = v * side * a;
                point
            };
            triangles.push([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
            triangles.push([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        }
    }
    triangles
}

/// Number of pixels that are not paper.
fn inked(picture: &RgbImage) -> usize {
    let paper = *picture.get_pixel(0, 0);
    picture.pixels().filter(|pixel| **pixel != paper).count()
}

#[test]
fn lone_sphere_fills_its_share_of_the_picture() {
    let picture =
        render_object(&[white([5.0, 6.0, 7.0], 0.3)], &[], &from([1.0, 2.0, 3.0])).unwrap();
    // Radius 0.92 * 32 pixels; partly covered pixels count, so the area is pi (r + 1/2)^2 within
    // half a pixel of the outline.
    let radius = 0.92 * 32.0 + 0.5;
    let expected = std::f64::consts::PI * radius * radius;
    let tolerance = std::f64::consts::TAU * radius * 0.5;
    assert!(
        (inked(&picture) as f64 - expected).abs() < tolerance,
        "{} pixels",
        inked(&picture)
    );
}

#[test]
fn camera_on_x_sees_y_to_the_right_and_z_upward() {
    let scene = [
        RenderSphere {
            centre: [0.0, 1.0, 0.0],
            radius: 0.2,
            colour: [255, 0, 0],
        },
        RenderSphere {
            centre: [0.0, 0.0, 1.0],
            radius: 0.2,
            colour: [0, 255, 0],
        },
        RenderSphere {
            centre: [0.0, 0.0, 0.0],
            radius: 0.2,
            colour: [0, 0, 255],
        },
    ];
    let picture = render_object(&scene, &[], &from([1.0, 0.0, 0.0])).unwrap();
    // The frame spans -0.2 to 1.2 both ways: 42 pixels per unit, middle at 0.5.
    let [red, green, blue] = [(53, 53), (10, 10), (10, 53)].map(|(x, y)| picture.get_pixel(x, y).0);
    assert!(red[0] > 60 && red[1] == 0, "{red:?}");
    assert!(green[1] > 60 && green[0] == 0, "{green:?}");
    assert!(blue[2] > 60 && blue[0] == 0, "{blue:?}");
}

#[test]
fn nearer_sphere_hides_the_farther_one() {
    let scene = [
        RenderSphere {
            centre: [0.0, 0.0, -1.0],
            radius: 1.0,
            colour: [255, 0, 0],
        },
        RenderSphere {
            centre: [0.0, 0.0, 1.0],
            radius: 1.0,
            colour: [0, 255, 0],
        },
    ];
    let above = render_object(&scene, &[], &from([0.0, 0.0, 1.0])).unwrap();
    let below = render_object(&scene, &[], &from([0.0, 0.0, -1.0])).unwrap();
    assert_eq!(above.get_pixel(32, 32).0[0], 0);
    assert_eq!(below.get_pixel(32, 32).0[1], 0);
}

#[test]
fn light_comes_from_the_upper_left() {
    let picture = render_object(&[white([0.0; 3], 1.0)], &[], &from([1.0, 0.0, 0.0])).unwrap();
    assert!(picture.get_pixel(20, 20).0[0] > picture.get_pixel(44, 44).0[0] + 30);
}

#[test]
fn coat_lies_over_spheres_inside_and_under_spheres_outside() {
    let view = from([1.0, 0.0, 0.0]);
    let inside = white([0.0; 3], 0.5);
    let bare = render_object(&[inside, white([0.0, 0.0, -1.0], 0.1)], &[], &view).unwrap();
    let coated = render_object(&[inside], &cube(1.0), &view).unwrap();
    let [bare_middle, coated_middle] = [bare.get_pixel(32, 28).0, coated.get_pixel(32, 32).0];
    assert_eq!(bare_middle[0], bare_middle[2], "white without a coat");
    assert!(
        coated_middle[2] > coated_middle[0] + 20,
        "blue through the coat: {coated_middle:?}"
    );
    let before = white([1.5, 0.0, 0.0], 0.4);
    let covered = render_object(&[inside, before], &cube(1.0), &view).unwrap();
    let middle = covered.get_pixel(32, 32).0;
    assert_eq!(
        middle[0], middle[2],
        "the sphere before the coat is not tinted: {middle:?}"
    );
}

#[test]
fn mesh_alone_is_drawn_with_the_area_of_its_outline() {
    let picture = render_object(&[], &cube(1.0), &from([1.0, 0.0, 0.0])).unwrap();
    // A square of 0.92 * 64 = 58.88 pixels a side; pixels touched in part count.
    assert_eq!(inked(&picture), 60 * 60);
}

#[test]
fn values_that_cannot_be_meant_are_refused() {
    let view = from([1.0, 0.0, 0.0]);
    assert_eq!(render_object(&[], &[], &view), Err(Error::NothingToShow));
    let ball = [white([0.0; 3], 1.0)];
    for direction in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        let error = render_object(&ball, &[], &from(direction)).unwrap_err();
        assert!(
            matches!(
                error,
                Error::InvalidView {
                    field: "toward_camera",
                    ..
                }
            ),
            "{error}"
        );
    }
    let broken = [[[0.0; 3], [0.0, f64::NAN, 0.0], [1.0, 0.0, 0.0]]];
    let error = render_object(&ball, &broken, &view).unwrap_err();
    assert!(
        matches!(
            error,
            Error::InvalidCoordinate {
                what: "triangle",
                ..
            }
        ),
        "{error}"
    );
    let error = render_object(&ball, &[], &ObjectView { pixels: 0, ..view }).unwrap_err();
    assert!(
        matches!(error, Error::InvalidPixels { pixels: 0, .. }),
        "{error}"
    );
    let error = render_object(&[white([0.0; 3], f64::NAN)], &[], &view).unwrap_err();
    assert!(matches!(error, Error::InvalidSphere { .. }), "{error}");
}
