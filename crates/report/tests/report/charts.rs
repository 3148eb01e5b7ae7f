//! Charts: well formed, within their paper, and with every number at its pixel.

use report::{
    AxisTitle, Comparison, Contour, Cube, CubeEdge, DesignRun, Error, Level, LineSeries,
    PredictedAgainstMeasured, Role, Scatter, Series, SeriesPoint, Svg,
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
                assert!(["contour", "timeseries"].contains(&name), "{name}: {error}");
            }
        }
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (name, chart) in examples::all(&[1.0, 2.0, value, 3.0]) {
            let error = chart.expect_err(name);
            let place = matches!(error, Error::NonFinite { index: 2, .. });
            assert!(place, "{name}: {error}");
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

/// Eight corners with their responses, all on the paper, whatever the names; each response stands nearest
/// to its own corner.
#[test]
fn a_cube_shows_every_corner_with_its_response() {
    let edge = |low: f64, high: f64| CubeEdge {
        title: AxisTitle::new(examples::HOSTILE, "m"),
        low,
        high,
    };
    let cube = |values: [f64; 8]| Cube {
        edges: [edge(0.0, 1.0), edge(0.3, 0.42), edge(-1e6, 1e6)],
        response: AxisTitle::new(examples::HOSTILE, ""),
        values,
    };
    let chart = cube([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])
        .draw()
        .unwrap();
    check_paper("cube", &chart);
    assert!(!chart.as_str().contains("<b"));
    let elements = read(&chart);
    let corners: Vec<&Element> = elements.iter().filter(|e| e.name == "circle").collect();
    assert_eq!(corners.len(), 8);
    for (i, corner) in corners.iter().enumerate() {
        let label = texts(&elements, &format!("{:.2}", (i + 1) as f64))[0];
        let away = |c: &Element| {
            (c.number("cx") - label.number("x")).hypot(c.number("cy") - label.number("y"))
        };
        assert!(
            corners.iter().all(|other| away(corner) <= away(other)),
            "corner {i}"
        );
    }
    check_paper("flat cube", &cube([38.9; 8]).draw().unwrap());
    let broken = cube([1.0, 2.0, f64::NAN, 4.0, 5.0, 6.0, 7.0, 8.0]).draw();
    assert!(matches!(broken, Err(Error::NonFinite { index: 2, .. })));
}

#[test]
fn points_stand_at_the_ticks_of_their_values() {
    let point = |x: f64, y: f64| SeriesPoint::new(x, y, 0.0);
    let chart = LineSeries {
        x: AxisTitle::new("Friction", ""),
        y: AxisTitle::new("Angle", "°"),
        series: vec![Series {
            name: "s".into(),
            points: vec![point(0.1, 30.0), point(0.3, 35.0), point(0.45, 41.25)],
        }],
        levels: vec![],
    };
    let elements = read(&chart.draw().unwrap());
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
        "larger values stand higher"
    );
}

#[test]
fn units_stand_in_the_axis_titles() {
    let mut chart = examples::lines(&VALUES);
    chart.y = AxisTitle::new("Repose angle", "°");
    chart.x = AxisTitle::new("Friction", "");
    let elements = read(&chart.draw().unwrap());
    assert_eq!(texts(&elements, "Repose angle (°)").len(), 1);
    assert_eq!(texts(&elements, "Friction").len(), 1);
    chart.series[0].points = vec![
        SeriesPoint::new(1e-6, 1.0, 0.0),
        SeriesPoint::new(3e-6, 1.0, 0.0),
    ];
    chart.series.truncate(1);
    chart.x = AxisTitle::new("Overlap", "m");
    let elements = read(&chart.draw().unwrap());
    assert_eq!(texts(&elements, "Overlap (×10⁻⁶ m)").len(), 1);
}

#[test]
fn pareto_bars_fall_in_length_and_show_the_sign_by_colour() {
    let svg = examples::pareto(&[0.5, -4.0, 2.0]).draw().unwrap();
    let elements = read(&svg);
    // After the paper and two patches of the legend.
    let bars: Vec<&Element> = elements
        .iter()
        .filter(|e| e.name == "rect")
        .skip(3)
        .collect();
    let widths: Vec<f64> = bars.iter().map(|bar| bar.number("width")).collect();
    assert_eq!(widths.len(), 3);
    // Lengths in the ratio of the sizes, to the hundredth of a pixel that is written.
    assert!((widths[0] / widths[1] - 2.0).abs() < 1e-3, "{widths:?}");
    assert!((widths[1] / widths[2] - 4.0).abs() < 1e-3, "{widths:?}");
    let colours: Vec<_> = bars.iter().map(|bar| bar.attribute("fill")).collect();
    assert_ne!(colours[0], colours[1], "negative and positive");
    assert_eq!(colours[1], colours[2], "both positive");
    assert!(
        bars[0].number("y") < bars[1].number("y"),
        "the largest is on top"
    );
}

#[test]
fn agreement_lies_on_the_diagonal_of_a_square() {
    let comparison = |value: f64| Comparison {
        name: String::new(),
        measured: value,
        measured_error: 0.0,
        predicted: value,
        predicted_error: 0.0,
        role: Role::Fit,
    };
    let chart = PredictedAgainstMeasured {
        observable: AxisTitle::new("angle", "°"),
        comparisons: vec![comparison(30.0), comparison(38.0), comparison(41.0)],
    };
    let elements = read(&chart.draw().unwrap());
    let circles: Vec<&Element> = elements
        .iter()
        .filter(|e| e.name == "circle")
        .skip(1)
        .collect();
    for pair in circles.windows(2) {
        let right = pair[1].number("cx") - pair[0].number("cx");
        let up = pair[0].number("cy") - pair[1].number("cy");
        assert!(
            right > 0.0 && (right - up).abs() < 0.021,
            "{right} to the right, {up} up"
        );
    }
}

#[test]
fn bold_contour_runs_where_the_surface_has_the_target() {
    let axis: Vec<f64> = (0..11).map(|i| f64::from(i) / 10.0).collect();
    // The surface is 10 x, so the target 4 is the upright line at x = 0.4.
    let values = axis
        .iter()
        .flat_map(|_| axis.iter().map(|x| 10.0 * x))
        .collect();
    let chart = Contour {
        x_values: axis.clone(),
        y_values: axis,
        values,
        x: AxisTitle::new("x", ""),
        target: Some(Level::new("target", 4.0)),
        region: vec![],
        points: vec![],
        runs: vec![],
        ..examples::contour(&[0.0; 4])
    };
    let elements = read(&chart.draw().unwrap());
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
fn lists_that_do_not_match_are_refused() {
    let mut chart = examples::residuals(&VALUES);
    chart.panels[1].noise.pop();
    assert!(matches!(
        chart.draw(),
        Err(Error::Length { field: "noise", .. })
    ));
    let mut chart = examples::contour(&VALUES);
    chart.values.pop();
    assert!(matches!(
        chart.draw(),
        Err(Error::Length {
            field: "values",
            ..
        })
    ));
    let mut chart = examples::contour(&VALUES);
    chart.x_values.reverse();
    assert!(matches!(
        chart.draw(),
        Err(Error::OutOfRange {
            field: "column",
            ..
        })
    ));
    let mut chart = examples::timeseries(&VALUES);
    chart.samples.push(99.0);
    assert!(matches!(
        chart.draw(),
        Err(Error::OutOfRange {
            field: "sampled moment",
            ..
        })
    ));
    let mut chart = examples::lines(&VALUES);
    chart.series[0].points[0].error = -1.0;
    assert!(matches!(
        chart.draw(),
        Err(Error::OutOfRange {
            field: "error of point",
            ..
        })
    ));
}

/// Five runs at the place (0.5, 0.5) differ in a factor that is not shown: four stand side by side 10 px apart, one in
/// the next row, around that place; each opens its part of the page.
#[test]
fn runs_at_one_place_stand_side_by_side_and_open_their_part_of_the_page() {
    let axis = vec![0.0, 0.5, 1.0];
    let run = |number: usize| DesignRun {
        name: format!("run {number}"),
        x: 0.5,
        y: 0.5,
        link: format!("#run-{number}"),
    };
    let chart = Contour {
        x_values: axis.clone(),
        y_values: axis.clone(),
        values: vec![0.0, 1.0, 2.0, 0.0, 1.0, 2.0, 0.0, 1.0, 2.0],
        points: vec![],
        region: vec![],
        runs: (1..=5).map(run).collect(),
        x: AxisTitle::new("x", ""),
        ..examples::contour(&[0.0; 4])
    };
    let elements = read(&chart.draw().unwrap());
    // Both axes have these ticks, the upright one first.
    let tick = |text| {
        texts(&elements, text)
            .iter()
            .map(|t| t.number("x"))
            .fold(0.0, f64::max)
    };
    let middle = 0.5 * (tick("0.4") + tick("0.6"));
    let links: Vec<usize> = (0..elements.len())
        .filter(|i| elements[*i].name == "a")
        .collect();
    assert_eq!(links.len(), 5);
    for (number, &link) in (1..).zip(&links) {
        assert_eq!(
            elements[link].attribute("href").unwrap(),
            format!("#run-{number}")
        );
        assert_eq!(elements[link + 1].text, format!("run {number}"));
        let path = elements[link + 2].attribute("d").unwrap();
        let corner = path.trim_start_matches('M').split(' ').next().unwrap();
        // The corner of a mark of 4 px is 3.6 px left of its middle.
        let across = corner.parse::<f64>().unwrap() + 3.6 - middle;
        let wanted = [-15.0, -5.0, 5.0, 15.0, -15.0][number - 1];
        assert!((across - wanted).abs() < 0.03, "{across} {wanted}");
    }
}

/// Four runs at each corner of the plane, and one on its left edge: the middles of all marks lie in the plane, whose corners are
/// those of the frame, and the single one on its place. Limit: the two decimals that are written.
#[test]
fn marks_at_the_edge_stay_off_the_names_of_the_axes() {
    let axis = vec![0.0, 0.5, 1.0];
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let places = corners.iter().flat_map(|corner| [*corner; 4]);
    let run = |(x, y): (f64, f64)| DesignRun {
        name: String::new(),
        x,
        y,
        link: "#run".to_owned(),
    };
    let chart = Contour {
        x_values: axis.clone(),
        y_values: axis,
        values: vec![0.0, 1.0, 2.0, 0.0, 1.0, 2.0, 0.0, 1.0, 2.0],
        points: vec![],
        region: vec![],
        runs: places.chain([(0.0, 0.5)]).map(run).collect(),
        ..examples::contour(&[0.0; 4])
    };
    let elements = read(&chart.draw().unwrap());
    let corner = |element: usize| -> [f64; 2] {
        let path = elements[element].attribute("d").unwrap();
        let numbers = path.trim_start_matches('M').split([' ', 'L']).take(2);
        let numbers: Vec<f64> = numbers.map(|x| x.parse().unwrap()).collect();
        // The upper left corner of a mark of 4 px.
        [numbers[0] + 3.6, numbers[1] + 3.6]
    };
    let links = (0..elements.len()).filter(|i| elements[*i].name == "a");
    let middles: Vec<[f64; 2]> = links.map(|link| corner(link + 2)).collect();
    assert_eq!(middles.len(), 17);
    // What is drawn within the plane stands in a picture of its own.
    let frame = elements.iter().filter(|e| e.name == "svg").nth(1).unwrap();
    let [left, top, width, height] = ["x", "y", "width", "height"].map(|name| frame.number(name));
    for [x, y] in &middles {
        assert!((left - 0.03..=left + width + 0.03).contains(x), "{x}");
        assert!((top - 0.03..=top + height + 0.03).contains(y), "{y}");
    }
    assert!((middles[16][0] - left).abs() < 0.03, "{:?}", middles[16]);
}

/// Up to 40 runs have their numbers; of more only those beyond the limits, so that the numbers stay legible.
#[test]
fn runs_beyond_the_limits_are_named_at_every_number_of_runs() {
    let residuals = |n: usize| Scatter {
        x: AxisTitle::new("run", ""),
        y: AxisTitle::new("t", ""),
        points: (0..n)
            .map(|i| [i as f64, if i == 7 { 4.5 } else { 0.3 }])
            .collect(),
        names: (0..n).map(|i| format!("r{i}")).collect(),
        marked: vec![],
        line: None,
        levels: vec![Level::new("upper", 3.6), Level::new("lower", -3.6)],
    };
    let named = |n: usize| -> Vec<String> {
        let elements = read(&residuals(n).draw().unwrap());
        let names = elements.iter().filter(|e| e.name == "text");
        let names = names.map(|e| e.text.clone());
        names
            .filter(|text| text.starts_with('r') && text.len() < 4)
            .collect()
    };
    assert_eq!(
        named(10).len(),
        10 + 1,
        "ten runs and the title of the axis"
    );
    assert_eq!(named(200), ["r7", "run"]);
    let elements = read(&residuals(200).draw().unwrap());
    assert_eq!(texts(&elements, "upper").len(), 1);
    let mut short = residuals(10);
    short.names.pop();
    assert!(matches!(
        short.draw(),
        Err(Error::Length { field: "names", .. })
    ));
}

/// The limit of the plot stands at its value with its name, and the axis reaches it.
#[test]
fn limits_of_effects_are_drawn_and_named() {
    let mut chart = examples::half_normal(&[0.2, -0.4, 1.0]);
    chart.size = AxisTitle::new("|effect|", "");
    chart.limits = vec![Level::new("margin", 2.0)];
    let elements = read(&chart.draw().unwrap());
    assert_eq!(texts(&elements, "margin").len(), 1);
    let tick = texts(&elements, "2.0")[0].number("y");
    let lines = elements.iter().filter(|e| e.name == "line");
    let mut dashed = lines.filter(|e| e.attribute("stroke-dasharray").is_some());
    assert!(
        dashed.any(|e| (e.number("y1") - tick).abs() < 0.02 && e.attribute("y1") == e.attribute("y2")),
        "no line at {tick}"
    );
}
