//! A surface over two factors seen at a slant, and responses at the corners of three factors as a cube.

use command_line::significant;
use report::{Anchor, Axis, AxisTitle, Format, Grid, Mark, Plot, PlotPoint, Shape, colour};

/// Size of a picture, px.
const SIZE: [f64; 2] = [640.0, 470.0];
/// Turn of a surface about the upright axis, degrees.
const TURN: f64 = 35.0;
/// Height of the eye above the horizon, degrees.
const EYE: f64 = 30.0;

/// A plot without axes whose coordinates are px to the right and upwards.
fn paper() -> Plot {
    let mut plot = Plot::new(Axis::Hidden([0.0, SIZE[0]]), Axis::Hidden([0.0, SIZE[1]]));
    plot.format = Format::Height(SIZE[1]);
    plot
}

/// A title in the upper left corner.
fn title(title: &AxisTitle) -> Mark {
    Mark::text(
        title.to_string(),
        [12.0, SIZE[1] - 18.0],
        [0.0, 0.0],
        Anchor::Start,
    )
}

/// The range of some values and the share of a value in it, 0 to 1; 1/2 without a range.
fn shares(values: &[f64]) -> impl Fn(f64) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let span = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
    move |value| {
        if span > 0.0 {
            (value - low) / span
        } else {
            0.5
        }
    }
}

/// The values of a grid as a surface over its plane, the farthest patches first.
pub(super) fn surface(grid: &Grid) -> Plot {
    let [x, y, z] = [&grid.x_values, &grid.y_values, &grid.values].map(|values| shares(values));
    let (turn_sin, turn_cos) = TURN.to_radians().sin_cos();
    let (eye_sin, eye_cos) = EYE.to_radians().sin_cos();
    // To the right and away from the eye, after the turn.
    let turned = move |a: f64, b: f64| {
        let (a, b) = (a - 0.5, b - 0.5);
        (a * turn_cos + b * turn_sin, b * turn_cos - a * turn_sin)
    };
    let place = |a: f64, b: f64, c: f64| {
        let (right, away) = turned(a, b);
        let up = 0.62 * (c - 0.5) * eye_cos + away * eye_sin;
        [
            0.5 * SIZE[0] + 350.0 * right,
            0.5 * SIZE[1] + 8.0 + 350.0 * up,
        ]
    };
    let columns = grid.x_values.len();
    let corner = |i: usize, j: usize| {
        let value = z(grid.values[i * columns + j]);
        (
            value,
            place(x(grid.x_values[j]), y(grid.y_values[i]), value),
        )
    };
    let depth = |&(i, j): &(usize, usize)| turned(x(grid.x_values[j]), y(grid.y_values[i])).1;
    let mut patches: Vec<(usize, usize)> = (0..grid.y_values.len() - 1)
        .flat_map(|i| (0..columns - 1).map(move |j| (i, j)))
        .collect();
    patches.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
    let marks = patches.into_iter().flat_map(|(i, j)| {
        let corners = [
            corner(i, j),
            corner(i, j + 1),
            corner(i + 1, j + 1),
            corner(i + 1, j),
        ];
        let mean = 0.25 * corners.iter().map(|(value, _)| value).sum::<f64>();
        let mut outline: Vec<[f64; 2]> = corners.iter().map(|(_, place)| *place).collect();
        let area = Mark::area("", &colour::sequential(mean), 1.0, vec![outline.clone()]);
        outline.push(outline[0]);
        [area, edge(outline, 0.35)]
    });
    let floor = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
    let floor = floor.map(|[a, b]| place(a, b, 0.0)).into();
    let upright = vec![place(0.0, 0.0, 0.0), place(0.0, 0.0, 1.0)];
    paper()
        .with(edge(floor, 1.0))
        .with(edge(upright, 1.0))
        .with_all(marks)
        .with_all(surface_texts(grid, place))
        .with(title(&grid.response))
}

/// A thin line.
fn edge(points: Vec<[f64; 2]>, width: f64) -> Mark {
    Mark::lines(colour::INK, width, vec![points])
}

/// Titles and ends of the axes of a surface.
fn surface_texts(grid: &Grid, place: impl Fn(f64, f64, f64) -> [f64; 2]) -> Vec<Mark> {
    let ends = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [low, high].map(|end| significant(end, 3))
    };
    let [x, y, z] = [&grid.x_values, &grid.y_values, &grid.values].map(|values| ends(values));
    let at = |text: &str, place, shift, anchor| Mark::text(text, place, shift, anchor);
    vec![
        at(
            &grid.x.to_string(),
            place(0.5, 0.0, 0.0),
            [-16.0, 34.0],
            Anchor::End,
        ),
        at(
            &grid.y.to_string(),
            place(1.0, 0.5, 0.0),
            [16.0, 34.0],
            Anchor::Start,
        ),
        at(&x[0], place(0.0, 0.0, 0.0), [4.0, 18.0], Anchor::Middle),
        at(&x[1], place(1.0, 0.0, 0.0), [-10.0, 18.0], Anchor::End),
        at(&y[0], place(1.0, 0.0, 0.0), [10.0, 18.0], Anchor::Start),
        at(&y[1], place(1.0, 1.0, 0.0), [6.0, 14.0], Anchor::Start),
        at(&z[0], place(0.0, 0.0, 0.0), [-6.0, 0.0], Anchor::End),
        at(&z[1], place(0.0, 0.0, 1.0), [-6.0, 0.0], Anchor::End),
    ]
}

/// Place of a corner of the cube on the paper; bit j of its number is the end of edge j.
fn corner_of_cube(corner: usize) -> [f64; 2] {
    let bit = |axis: usize| f64::from(u8::from(corner >> axis & 1 == 1));
    [
        140.0 + 230.0 * bit(0) + 130.0 * bit(2),
        80.0 + 230.0 * bit(1) + 85.0 * bit(2),
    ]
}

/// The marker of a corner, coloured by a share of the range of all, and its value as text.
fn marks_of_corner(corner: usize, value: f64, share: f64) -> [Mark; 2] {
    let [x, y] = corner_of_cube(corner);
    let (is_right, is_front) = (corner & 1 == 1, corner & 4 == 0);
    let (anchor, aside) = if is_right {
        (Anchor::Start, 9.0)
    } else {
        (Anchor::End, -9.0)
    };
    let marker = Mark::Points {
        name: String::new(),
        shape: Shape::Circle,
        fill: colour::sequential(share),
        rim: colour::INK.to_owned(),
        points: vec![PlotPoint::new(x, y)],
    };
    let text = Mark::Text {
        place: [x, y],
        shift: [aside, if is_front { 12.0 } else { -12.0 }],
        text: significant(value, 4),
        anchor,
        bold: true,
        turn: 0.0,
    };
    [marker, text]
}

/// Responses at the corners of a cube whose edges are three factors, each with its ends in words: to the right, upwards and away from
/// the reader. The first factor changes fastest, its low end first.
pub(super) fn cube(edges: &[String; 3], response: &AxisTitle, values: [f64; 8]) -> Plot {
    let place = corner_of_cube;
    let line = |corner: usize, axis: usize| {
        let other = corner | 1 << axis;
        let ends = vec![place(corner), place(other)];
        // The three edges at the hidden corner are dashed.
        if corner == 4 || other == 4 {
            Mark::dashed("", ends)
        } else {
            edge(ends, 1.4)
        }
    };
    let lines = (0..8_usize).flat_map(|corner| {
        (0..3)
            .filter(move |axis| corner >> axis & 1 == 0)
            .map(move |axis| line(corner, axis))
    });
    let share = shares(&values);
    let each = values.iter().enumerate();
    let corners = each.flat_map(|(corner, &value)| marks_of_corner(corner, value, share(value)));
    let middle = |a: usize, b: usize| {
        let ([ax, ay], [bx, by]) = (place(a), place(b));
        [0.5 * (ax + bx), 0.5 * (ay + by)]
    };
    let [x, y, z] = edges;
    let upright = Mark::Text {
        place: middle(0, 2),
        shift: [-72.0, 0.0],
        text: y.clone(),
        anchor: Anchor::Middle,
        bold: false,
        turn: -90.0,
    };
    paper()
        .with_all(lines)
        .with_all(corners)
        .with(Mark::text(x, middle(0, 1), [0.0, 34.0], Anchor::Middle))
        .with(upright)
        .with(Mark::text(z, middle(1, 5), [16.0, 14.0], Anchor::Start))
        .with(title(response))
}
