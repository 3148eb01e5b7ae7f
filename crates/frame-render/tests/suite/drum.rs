//! Tests of drum pictures through the public interface.

use frame_render::{
    BACKGROUND_COLOUR, DrumView, Error, OUTSIDE_COLOUR, PixelPoint, RenderSphere, draw_segments,
    render_drum, seed_colour,
};
use image::{Rgb, RgbImage, imageops};

/// Picture with 10 pixels per mm: 200 pixels for a radius of 9.259... mm with the 8 % margin.
fn view() -> DrumView {
    DrumView::new(0.01 / 1.08, 0.02, 200)
}

/// A sphere of one colour.
fn sphere(centre: [f64; 3], radius: f64, colour: [u8; 3]) -> RenderSphere {
    RenderSphere {
        centre,
        radius,
        colour,
    }
}

/// Luma as image analysis computes it (ITU-R BT.709 weights).
fn luma(pixel: Rgb<u8>) -> f64 {
    let [red, green, blue] = pixel.0.map(f64::from);
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// Which pixels differ from the picture of the empty drum.
fn changed(picture: &RgbImage, view: &DrumView) -> Vec<(u32, u32)> {
    let empty = render_drum(&[], view).expect("the views of these tests are valid");
    picture
        .enumerate_pixels()
        .filter(|(column, row, pixel)| *pixel != empty.get_pixel(*column, *row))
        .map(|(column, row, _)| (column, row))
        .collect()
}

/// Spheres without any symmetry.
fn heap(count: u32) -> Vec<RenderSphere> {
    (0..count)
        .map(|index| {
            let t = f64::from(index);
            let centre = [
                0.007 * (1.3 * t).sin(),
                0.006 * (0.7 * t + 1.0).cos() - 0.001,
                0.009 * (2.1 * t).sin(),
            ];
            sphere(
                centre,
                0.0005 + 0.0003 * (3.0 * t).cos(),
                seed_colour(index as usize),
            )
        })
        .collect()
}

#[test]
fn sphere_covers_exactly_the_pixels_within_its_radius() {
    let view = view();
    let projection = view.projection().unwrap();
    let drawn = render_drum(&[sphere([0.0021, 0.0033, 0.0], 0.00107, [90; 3])], &view).unwrap();
    let centre = projection.pixel_from_metre([0.0021, 0.0033]);
    let radius = 0.00107 * projection.pixels_per_metre();
    let expected: Vec<(u32, u32)> = (0..200u32)
        .flat_map(|row| (0..200u32).map(move |column| (column, row)))
        .filter(|&(column, row)| {
            let right = f64::from(column) - centre.column;
            let down = f64::from(row) - centre.row;
            right * right + down * down <= radius * radius
        })
        .collect();
    let mut found = changed(&drawn, &view);
    found.sort_by_key(|&(column, row)| (row, column));
    assert_eq!(found, expected);
    // 10.7 pixels of radius: the area is pi r^2 = 359.7 within the rounding of the outline
    // (circle problem of Gauss; well below one part in twenty at this size).
    assert!(
        (expected.len() as f64 - 359.7).abs() < 18.0,
        "{} pixels",
        expected.len()
    );
    assert_eq!(centre.column, 99.5 + 21.0);
    assert!((centre.row - (99.5 - 33.0)).abs() < 1e-10, "{}", centre.row);
}

#[test]
fn nearer_sphere_hides_the_farther_one_in_either_order() {
    let view = view();
    let front = sphere([0.0, 0.0, 0.004], 0.001, [200, 0, 0]);
    let back = sphere([0.0005, 0.0, -0.004], 0.0014, [0, 0, 200]);
    let one = render_drum(&[front, back], &view).unwrap();
    let other = render_drum(&[back, front], &view).unwrap();
    assert_eq!(one, other);
    assert_eq!(one.get_pixel(99, 99).0[2], 0, "the front sphere is seen");
    // 13 pixels right of the axis: beyond the front sphere (10) but within the back one (5 + 14).
    assert_eq!(
        one.get_pixel(112, 99).0[0],
        0,
        "the back sphere is seen beside it"
    );
}

#[test]
fn spheres_that_cross_meet_in_their_common_plane() {
    let view = view();
    let left = sphere([-0.0005, 0.0, 0.0], 0.002, [200, 0, 0]);
    let right = sphere([0.0005, 0.0, 0.0], 0.002, [0, 0, 200]);
    let picture = render_drum(&[left, right], &view).unwrap();
    for row in 85..115 {
        assert_eq!(
            picture.get_pixel(99, row).0[2],
            0,
            "left of the plane, row {row}"
        );
        assert_eq!(
            picture.get_pixel(100, row).0[0],
            0,
            "right of the plane, row {row}"
        );
    }
}

#[test]
fn positive_roll_turns_the_picture_counter_clockwise() {
    let mut view = view();
    let right = sphere([0.006, 0.0, 0.0], 0.001, [90; 3]);
    view.roll = std::f64::consts::FRAC_PI_2;
    let picture = render_drum(&[right], &view).unwrap();
    // 6 mm right of the axis goes to 6 mm above it: row 99.5 - 60.
    let pixels = changed(&picture, &view);
    let mean_row = pixels.iter().map(|&(_, row)| f64::from(row)).sum::<f64>() / pixels.len() as f64;
    let mean_column = pixels
        .iter()
        .map(|&(column, _)| f64::from(column))
        .sum::<f64>()
        / pixels.len() as f64;
    // Symmetric outline about a place on the pixel grid's lines of symmetry: rounding only.
    assert!((mean_row - 39.5).abs() < 1e-9, "row {mean_row}");
    assert!((mean_column - 99.5).abs() < 1e-9, "column {mean_column}");
}

#[test]
fn small_roll_moves_a_point_by_angle_times_distance() {
    let mut view = view();
    view.roll = 0.01;
    let turned = view.projection().unwrap().pixel_from_metre([0.006, 0.0]);
    // Up by s r sin a = 60 * 0.01 (truncation a^3/6: 1e-5 pixels).
    assert!((turned.row - (99.5 - 0.6)).abs() < 2e-5, "{}", turned.row);
}

#[test]
fn mirrored_scene_gives_exactly_the_mirrored_picture() {
    for pixels in [200, 201] {
        let mut view = DrumView::new(0.0093, 0.02, pixels);
        view.roll = 0.13;
        let scene = heap(500);
        let mirrored_scene: Vec<RenderSphere> = scene
            .iter()
            .map(|s| RenderSphere {
                centre: [-s.centre[0], s.centre[1], s.centre[2]],
                ..*s
            })
            .collect();
        let picture = render_drum(&scene, &view).unwrap();
        view.roll = -0.13;
        let mirrored = render_drum(&mirrored_scene, &view).unwrap();
        assert_eq!(
            imageops::flip_horizontal(&picture),
            mirrored,
            "{pixels} pixels"
        );
        assert_ne!(picture, mirrored, "the scene must not be symmetric itself");
    }
}

#[test]
fn pixel_and_metre_maps_are_each_others_inverse() {
    let mut view = DrumView::new(0.15, 0.1, 560);
    view.roll = 0.7;
    view.centre = [0.02, -0.3, 0.01];
    let projection = view.projection().unwrap();
    for point in [[0.02, -0.3], [0.1, -0.25], [-0.08, -0.41]] {
        let back = projection.metre_from_pixel(projection.pixel_from_metre(point));
        // Rounding: values of 1e2 pixels and 1e-1 m, a handful of operations.
        assert!((back[0] - point[0]).abs() < 1e-14, "{back:?} for {point:?}");
        assert!((back[1] - point[1]).abs() < 1e-14, "{back:?} for {point:?}");
    }
    assert_eq!(
        projection.axis(),
        PixelPoint {
            column: 279.5,
            row: 279.5
        }
    );
    assert_eq!(projection.metre_from_pixel(projection.axis()), [0.02, -0.3]);
}

#[test]
fn bed_and_background_are_told_apart_by_gray_level() {
    let view = DrumView::new(0.0093, 0.02, 300);
    let scene = heap(2000);
    let picture = render_drum(&scene, &view).unwrap();
    let projection = view.projection().unwrap();
    let inner = view.inner_radius * projection.pixels_per_metre();
    let seeds = changed(&picture, &view);
    for &(column, row) in &seeds {
        let value = luma(*picture.get_pixel(column, row));
        assert!((40.0..=120.0).contains(&value), "seed luma {value}");
    }
    for (column, row, pixel) in render_drum(&[], &view).unwrap().enumerate_pixels() {
        let distance = (f64::from(column) - 149.5).hypot(f64::from(row) - 149.5);
        if distance < inner - 1.0 {
            assert_eq!(pixel.0, BACKGROUND_COLOUR);
        } else if distance > inner * 1.02 + 1.0 {
            assert_eq!(pixel.0, OUTSIDE_COLOUR);
        }
    }
    assert!((luma(Rgb(BACKGROUND_COLOUR)) - 215.0).abs() < 1.0);
    assert!((luma(Rgb(OUTSIDE_COLOUR)) - 20.0).abs() < 1.0);
}

#[test]
fn drum_edge_lies_where_the_projection_says() {
    let view = DrumView::new(0.15, 0.1, 560);
    let empty = render_drum(&[], &view).unwrap();
    let inner = 0.15 * view.projection().unwrap().pixels_per_metre();
    // Area of the light disc from its gray levels; the edge is smoothed linearly over one pixel,
    // so the sum is pi R^2 up to the lattice error of a smoothed circle (below 1e-3 here).
    let [light, rim] = [BACKGROUND_COLOUR[1], frame_render::RIM_COLOUR[1]].map(f64::from);
    let area: f64 = empty
        .enumerate_pixels()
        .filter(|(column, row, _)| {
            (f64::from(*column) - 279.5).hypot(f64::from(*row) - 279.5) < inner + 2.0
        })
        .map(|(_, _, pixel)| (f64::from(pixel.0[1]) - rim) / (light - rim))
        .sum();
    let expected = std::f64::consts::PI * inner * inner;
    assert!(
        (area / expected - 1.0).abs() < 1e-3,
        "{area} against {expected}"
    );
}

#[test]
fn spheres_outside_of_the_picture_are_cut_off() {
    let view = view();
    let scene = [
        sphere([0.5, 0.0, 0.0], 0.001, [1; 3]),
        sphere([0.0, -0.5, 0.0], 0.001, [1; 3]),
        sphere([-0.0101, 0.0, 0.0], 0.001, [255; 3]),
    ];
    let picture = render_drum(&scene, &view).unwrap();
    assert!(
        changed(&picture, &view)
            .iter()
            .all(|&(column, _)| column < 10)
    );
    assert!(!changed(&picture, &view).is_empty());
}

#[test]
fn spheres_without_place_or_size_are_refused() {
    let good = sphere([0.0; 3], 0.001, [90; 3]);
    let not_a_number = sphere([0.0, f64::NAN, 0.0], 0.001, [90; 3]);
    let error = render_drum(&[good, not_a_number], &view()).unwrap_err();
    assert!(
        matches!(
            error,
            Error::InvalidSphere {
                index: 1,
                field: "centre y",
                ..
            }
        ),
        "{error}"
    );
    for radius in [0.0, -0.001, f64::INFINITY, f64::NAN] {
        let error = render_drum(&[sphere([0.0; 3], radius, [90; 3])], &view()).unwrap_err();
        assert!(
            matches!(
                error,
                Error::InvalidSphere {
                    field: "radius",
                    ..
                }
            ),
            "{error}"
        );
    }
}

#[test]
fn views_that_cannot_be_meant_are_refused() {
    let error = DrumView {
        pixels: 4,
        ..view()
    }
    .projection()
    .unwrap_err();
    assert!(
        matches!(error, Error::InvalidPixels { pixels: 4, .. }),
        "{error}"
    );
    for (setting, changed) in [
        (
            "inner_radius",
            DrumView {
                inner_radius: -1.0,
                ..view()
            },
        ),
        (
            "width",
            DrumView {
                width: 0.0,
                ..view()
            },
        ),
        (
            "roll",
            DrumView {
                roll: f64::NAN,
                ..view()
            },
        ),
        (
            "margin",
            DrumView {
                margin: -0.1,
                ..view()
            },
        ),
        ("rim", DrumView { rim: 7.0, ..view() }),
        (
            "centre z",
            DrumView {
                centre: [0.0, 0.0, f64::INFINITY],
                ..view()
            },
        ),
    ] {
        let error = changed.projection().unwrap_err();
        assert!(
            matches!(error, Error::InvalidView { field, .. } if field == setting),
            "{error}"
        );
    }
}

#[test]
fn segment_is_drawn_along_its_projection() {
    let view = view();
    let mut picture = render_drum(&[], &view).unwrap();
    let empty = picture.clone();
    draw_segments(
        &mut picture,
        &view,
        &[[[-0.005, 0.002], [0.005, 0.002]]],
        [255, 0, 0],
    )
    .unwrap();
    // Row 99.5 - 20 = 79.5: rows 79 and 80 lie half a pixel beside the middle of the line, within
    // its half width of 0.9, rows 78 and 81 at 1.5, beyond its reach of 1.4.
    // Share 1.4 - 0.5 = 0.9 of the line's colour, the rest from the background (218, 215, 208).
    assert_eq!(picture.get_pixel(100, 79).0, [251, 22, 21]);
    assert_eq!(picture.get_pixel(100, 79), picture.get_pixel(100, 80));
    assert_eq!(picture.get_pixel(100, 78), empty.get_pixel(100, 78));
    assert_eq!(picture.get_pixel(100, 81), empty.get_pixel(100, 81));
    // It ends at 99.5 +- 50 pixels.
    assert_eq!(picture.get_pixel(47, 79), empty.get_pixel(47, 79));
    assert_ne!(picture.get_pixel(50, 79), empty.get_pixel(50, 79));
    assert_ne!(picture.get_pixel(149, 79), empty.get_pixel(149, 79));
    assert_eq!(picture.get_pixel(152, 79), empty.get_pixel(152, 79));
}

#[test]
fn broken_segment_leaves_the_picture_alone() {
    let view = view();
    let mut picture = render_drum(&[], &view).unwrap();
    let empty = picture.clone();
    let segments = [[[0.0, 0.0], [0.001, 0.0]], [[0.0, f64::NAN], [0.001, 0.0]]];
    let error = draw_segments(&mut picture, &view, &segments, [255, 0, 0]).unwrap_err();
    assert!(
        matches!(error, Error::InvalidCoordinate { index: 1, .. }),
        "{error}"
    );
    assert_eq!(picture, empty);
}
