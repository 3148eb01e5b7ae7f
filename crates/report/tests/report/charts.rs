//! Charts: well formed, within their paper, and with every number at its pixel.

use report::{
    Axis, AxisTitle, Error, Format, Grid, Mark, Plot, PlotPoint, Shape, Svg, colour, design_runs,
    half_normal, pareto, scatter, series,
};

use crate::examples;
use crate::markup::{Element, elements};

/// Values without any pattern.
const VALUES: [f64; 8] = [0.3, -2.4, 1.9, 3.1, -0.2, 0.0, 2.2, 1.1];

/// Elements of a picture.
fn read(svg: &Svg) -> Vec<Element> {
    elements(svg.as_str()).unwrap_or_else(|reason| panic!("{reason} in {svg}"))
}

/// The text elements that hold a text.
fn texts<'a>(elements: &'a [Element], text: &str) -> Vec<&'a Element> {
    elements
        .iter()
        .filter(|element| element.name == "text" && element.text == text)
        .collect()
}

/// Refuses pictures with a broken number or anything that begins outside of the paper.
fn check_paper(name: &str, svg: &Svg) {
    for word in ["NaN", "inf", "Inf"] {
        assert!(!svg.as_str().contains(word), "{name} contains {word}");
    }
    let elements = read(svg);
    let (width, height) = (elements[0].number("width"), elements[0].number("height"));
    let within = |x: f64, y: f64, what: &Element| {
        assert!(
            (0.0..=width).contains(&x) && (0.0..=height).contains(&y),
            "{name}: {what:?}"
        );
    };
    for element in &elements {
        match element.name.as_str() {
            "circle" => within(element.number("cx"), element.number("cy"), element),
            "text" => within(element.number("x"), element.number("y"), element),
            "rect" => {
                let (x, y) = (element.number("x"), element.number("y"));
                within(x, y, element);
                within(
                    x + element.number("width"),
                    y + element.number("height"),
                    element,
                );
            }
            _ => {}
        }
    }
}

#[test]
fn every_chart_is_well_formed_whatever_its_texts_are() {
    for (name, chart) in examples::all(&VALUES) {
        let chart = chart.unwrap();
        check_paper(name, &chart);
        assert!(!chart.as_str().contains("<b"), "{name} lets markup through");
        assert!(
            !chart.as_str().contains(" id="),
            "{name}: ids would clash in a page"
        );
    }
}

#[test]
fn odd_values_still_give_whole_pictures() {
    let many: Vec<f64> = (0..60)
        .map(|index| (f64::from(index) * 0.7).sin())
        .collect();
    for values in [
        vec![0.0; 4],
        vec![38.9; 4],
        vec![1e-12, 2e-12, -1e-12, 3e-12],
        vec![1e12, 2e12, -4e12, 3e12],
        vec![1e12, 1e12 + 1.0, 1e12, 1e12],
        vec![-5.0, -3.0, -4.0, -9.0],
        many,
    ] {
        for (name, chart) in examples::all(&values) {
            check_paper(
                name,
                &chart.unwrap_or_else(|error| panic!("{error} for {values:?}")),
            );
        }
    }
}

#[test]
fn one_value_is_enough_where_one_can_be_shown() {
    for (name, chart) in examples::all(&[2.0]) {
        match chart {
            Ok(chart) => check_paper(name, &chart),
            Err(error) => {
                assert_eq!(name, "contours", "{error}");
            }
        }
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (name, chart) in examples::all(&[1.0, 2.0, value, 3.0]) {
            let error = chart.expect_err(name);
            assert!(matches!(error, Error::NonFinite { .. }), "{name}: {error}");
        }
    }
}

#[test]
fn charts_without_values_are_refused() {
    for (name, chart) in examples::all(&[]) {
        let error = chart.expect_err(name);
        assert!(matches!(error, Error::TooFew { .. }), "{name}: {error}");
    }
}

#[test]
fn same_input_gives_the_same_bytes() {
    assert_eq!(examples::all(&VALUES), examples::all(&VALUES));
}

/// Axes of plain numbers.
fn axes() -> Plot {
    Plot::new(Axis::numbers("Friction", ""), Axis::numbers("Angle", "°"))
}

#[test]
fn points_are_at_the_ticks_of_their_values() {
    let points = [[0.1, 30.0], [0.3, 35.0], [0.45, 41.25]].map(|[x, y]| PlotPoint::new(x, y));
    let plot = axes().with_all(series(0, "s", points.into()));
    let elements = read(&plot.draw().unwrap());
    let circles: Vec<&Element> = elements.iter().filter(|e| e.name == "circle").collect();
    // The first circle is that of the legend.
    let [_, low, middle, high] = circles[..] else {
        panic!("{circles:?}")
    };
    let x_of = |text: &str| texts(&elements, text)[0].number("x");
    let y_of = |text: &str| texts(&elements, text)[0].number("y");
    // Coordinates are written to a hundredth of a pixel.
    assert!((low.number("cx") - x_of("0.1")).abs() < 0.011);
    assert!((middle.number("cx") - x_of("0.3")).abs() < 0.011);
    assert!((low.number("cy") - y_of("30")).abs() < 0.011);
    // Between the ticks the map is straight: 41.25 lies 1.125 times as far above 30 as 40 does.
    let wanted = y_of("30") + 1.125 * (y_of("40") - y_of("30"));
    assert!((high.number("cy") - wanted).abs() < 0.03);
    assert!(
        high.number("cy") < low.number("cy"),
        "larger values are higher"
    );
}

#[test]
fn titles_name_units_and_powers_of_ten() {
    let plot = axes().with_all(series(0, "s", examples::points(&VALUES)));
    let elements = read(&plot.draw().unwrap());
    assert_eq!(texts(&elements, "Angle (°)").len(), 1);
    assert_eq!(texts(&elements, "Friction").len(), 1);
    let points = vec![PlotPoint::new(1e-6, 1.0), PlotPoint::new(3e-6, 1.0)];
    let plot = Plot::new(Axis::numbers("Overlap", "m"), Axis::numbers("", ""))
        .with_all(series(0, "s", points));
    let elements = read(&plot.draw().unwrap());
    assert_eq!(texts(&elements, "Overlap (×10⁻⁶ m)").len(), 1);
}

/// Widths of the boxes of a path element of an area, px, from the left to the right corner of each.
fn widths(area: &Element) -> Vec<f64> {
    let outlines = area.attribute("d").unwrap().split('Z');
    let places = |outline: &str| -> Vec<f64> {
        let places = outline.split(['M', 'L']).filter(|place| !place.is_empty());
        places
            .map(|place| place.split(' ').next().unwrap().parse().unwrap())
            .collect()
    };
    let outlines = outlines.filter(|outline| !outline.is_empty()).map(places);
    outlines.map(|x| x[1] - x[0]).collect()
}

#[test]
fn pareto_bars_fall_in_length_and_show_the_sign_by_colour() {
    let plot = pareto(
        &AxisTitle::new("|t|", ""),
        &examples::effects(&[0.5, -4.0, 2.0]),
        &[],
    );
    let elements = read(&plot.draw().unwrap());
    let bars: Vec<&Element> = elements.iter().filter(|e| e.name == "path").collect();
    let [up, down] = bars[..] else {
        panic!("{bars:?}")
    };
    assert_eq!(up.attribute("fill"), Some(colour::BLUE));
    assert_eq!(down.attribute("fill"), Some(colour::VERMILION));
    let (up, down) = (widths(up), widths(down));
    // Lengths in the ratio of the sizes 2, 0.5 and 4, to the hundredth of a pixel that is written.
    assert!((up[0] / up[1] - 4.0).abs() < 1e-2, "{up:?}");
    assert!((down[0] / up[0] - 2.0).abs() < 1e-3, "{up:?} {down:?}");
    let y = |text: &str| texts(&elements, text)[0].number("y");
    assert!(
        y("4.00") < y("2.00") && y("2.00") < y("0.50"),
        "the largest is on top"
    );
}

#[test]
fn equal_values_are_on_the_diagonal_of_a_square() {
    let points: Vec<PlotPoint> = [30.0, 38.0, 41.0].map(|v| PlotPoint::new(v, v)).into();
    let mut plot = axes().with(Mark::points("", Shape::Circle, colour::BLUE, points));
    plot.format = Format::Square(400.0);
    let elements = read(&plot.draw().unwrap());
    let circles: Vec<&Element> = elements.iter().filter(|e| e.name == "circle").collect();
    assert_eq!(circles.len(), 3);
    for pair in circles.windows(2) {
        let right = pair[1].number("cx") - pair[0].number("cx");
        let up = pair[0].number("cy") - pair[1].number("cy");
        assert!(
            right > 0.0 && (right - up).abs() < 0.021,
            "{right} to the right, {up} up"
        );
    }
}

/// The grid of 11 x 11 nodes on the unit square with the value 10 x.
fn slope() -> Grid {
    let axis: Vec<f64> = (0..11).map(|i| f64::from(i) / 10.0).collect();
    let values = axis
        .iter()
        .flat_map(|_| axis.iter().map(|x| 10.0 * x))
        .collect();
    Grid {
        x_values: axis.clone(),
        y_values: axis,
        values,
        x: AxisTitle::new("x", ""),
        ..examples::grid(&[0.0; 4])
    }
}

/// The surface is 10 x, so that the line of the value 4 is upright at x = 0.4.
#[test]
fn the_bold_line_is_where_the_surface_has_its_value() {
    let grid = slope();
    let bold = grid.bold_line("target", 4.0).unwrap();
    let elements = read(&grid.contours(bold.into()).unwrap().draw().unwrap());
    let bold: Vec<&Element> = elements
        .iter()
        .filter(|e| e.name == "path" && e.attribute("stroke-width") == Some("3"))
        .collect();
    assert_eq!(bold.len(), 1);
    let wanted = texts(&elements, "0.4")
        .first()
        .map_or(f64::NAN, |tick| tick.number("x"));
    let path = bold[0].attribute("d").unwrap();
    for point in path.split(['M', 'L']).filter(|part| !part.is_empty()) {
        let x: f64 = point.split(' ').next().unwrap().parse().unwrap();
        assert!((x - wanted).abs() < 0.011, "{x} instead of {wanted}");
    }
}

#[test]
fn what_does_not_match_is_refused() {
    let grid = examples::grid(&VALUES);
    let short = grid.region("r", &grid.values[1..]);
    assert!(matches!(
        short,
        Err(Error::Length {
            field: "values",
            ..
        })
    ));
    let mut falling = grid.clone();
    falling.x_values.reverse();
    let falling = falling.contours(Vec::new());
    assert!(matches!(
        falling,
        Err(Error::OutOfRange {
            field: "column",
            ..
        })
    ));
    let point = PlotPoint::new(0.0, 0.0).with_error(-1.0);
    let negative = axes().with_all(series(0, "s", vec![point])).draw();
    assert!(matches!(
        negative,
        Err(Error::OutOfRange { field: "error", .. })
    ));
}

/// Contours over the unit square with runs at these places.
fn with_runs(places: impl IntoIterator<Item = (f64, f64)>) -> Vec<Element> {
    let run = |(number, (x, y)): (usize, (f64, f64))| PlotPoint {
        tip: format!("run {number}"),
        link: format!("#run-{number}"),
        ..PlotPoint::new(x, y)
    };
    let runs = (1..).zip(places).map(run).collect();
    let also = design_runs(runs).into_iter().collect();
    read(&slope().contours(also).unwrap().draw().unwrap())
}

/// The middles of the marks of all links, px: the first corner of a mark of 4 px is 3.6 px left of and above its middle.
fn middles(elements: &[Element]) -> Vec<[f64; 2]> {
    let links = (0..elements.len()).filter(|i| elements[*i].name == "a");
    let middle = |link: usize| {
        let path = elements[link + 2].attribute("d").unwrap();
        let mut numbers = path.trim_start_matches('M').split([' ', 'L']);
        let mut next = || numbers.next().unwrap().parse::<f64>().unwrap() + 3.6;
        [next(), next()]
    };
    links.map(middle).collect()
}

/// Five runs at the place (0.5, 0.5) differ in a factor that is not shown: four are side by side 10 px apart, one in
/// the next row, around that place; each opens its part of the page.
#[test]
fn runs_at_one_place_are_side_by_side_and_open_their_part_of_the_page() {
    let elements = with_runs([(0.5, 0.5); 5]);
    // Both axes have these ticks, the horizontal one further right.
    let tick = |text| {
        let ticks = texts(&elements, text);
        ticks.iter().map(|t| t.number("x")).fold(0.0, f64::max)
    };
    let middle = 0.5 * (tick("0.4") + tick("0.6"));
    let links = elements.iter().enumerate().filter(|(_, e)| e.name == "a");
    for ((number, (i, link)), [x, _]) in (1..).zip(links).zip(middles(&elements)) {
        assert_eq!(link.attribute("href").unwrap(), format!("#run-{number}"));
        assert_eq!(elements[i + 1].text, format!("run {number}"));
        let wanted = [-15.0, -5.0, 5.0, 15.0, -15.0][number - 1];
        assert!((x - middle - wanted).abs() < 0.03, "{x} {wanted}");
    }
    assert_eq!(middles(&elements).len(), 5);
}

/// Four runs at each corner of the plane, and one on its left edge: the middles of all marks lie in the plane, whose corners are
/// those of the frame, and the single one on its place. Limit: the two decimals that are written.
#[test]
fn marks_at_the_edge_stay_off_the_names_of_the_axes() {
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let elements = with_runs(
        corners
            .into_iter()
            .flat_map(|corner| [corner; 4])
            .chain([(0.0, 0.5)]),
    );
    let middles = middles(&elements);
    assert_eq!(middles.len(), 17);
    // What is cut off at the plane is in a picture of its own.
    let frame = elements.iter().filter(|e| e.name == "svg").nth(1).unwrap();
    let [left, top, width, height] = ["x", "y", "width", "height"].map(|name| frame.number(name));
    for [x, y] in &middles {
        assert!((left - 0.03..=left + width + 0.03).contains(x), "{x}");
        assert!((top - 0.03..=top + height + 0.03).contains(y), "{y}");
    }
    assert!((middles[16][0] - left).abs() < 0.03, "{:?}", middles[16]);
}

/// A limit is drawn at its value with its name, and the axis reaches it; effects above it are named, smaller ones not.
#[test]
fn limits_of_effects_are_drawn_and_named() {
    let effects = [("A", 0.2), ("B", -2.4), ("C", 1.0)].map(|(name, e)| (name.to_owned(), e));
    let plot = half_normal(
        &AxisTitle::new("|effect|", ""),
        &effects,
        None,
        &[("margin", 2.0)],
    );
    let elements = read(&plot.draw().unwrap());
    assert_eq!(texts(&elements, "margin").len(), 1);
    assert_eq!(texts(&elements, "B").len(), 1);
    assert!(texts(&elements, "A").is_empty() && texts(&elements, "C").is_empty());
    let tick = texts(&elements, "2.0")[0].number("y");
    let lines = elements.iter().filter(|e| e.name == "line");
    let mut dashed = lines.filter(|e| e.attribute("stroke-dasharray").is_some());
    assert!(
        dashed.any(|e| (e.number("y1") - tick).abs() < 0.02 && e.attribute("y1") == e.attribute("y2")),
        "no line at {tick}"
    );
}

/// A hundred and fifty points are markers, more are small dots in one element.
#[test]
fn many_points_are_small() {
    let circles = |count: usize| {
        let points = examples::points(&vec![1.0; count]);
        let plot = scatter(
            AxisTitle::default(),
            AxisTitle::default(),
            points,
            Vec::new(),
        );
        let elements = read(&plot.draw().unwrap());
        elements.iter().filter(|e| e.name == "circle").count()
    };
    assert_eq!((circles(150), circles(151)), (150, 0));
}
