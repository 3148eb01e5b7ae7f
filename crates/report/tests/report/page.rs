//! The page: well formed, whole without a network, and with every text escaped.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use report::{
    Column, Error, Fact, Report, SphereViewer, Table, Tone, ViewerBody, ViewerKind, ViewerSphere,
};

use crate::examples::{self, HOSTILE};
use crate::markup::elements;

/// Bytes that begin as a PNG file does.
const PNG: &[u8] = &[0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a, 1, 2, 3];

/// A page with everything in it, and markup in every text.
fn full_page() -> String {
    let mut report = Report::new(HOSTILE);
    let mut table = Table::new(HOSTILE, vec![Column::text(HOSTILE), Column::number("b")]).unwrap();
    table
        .row([HOSTILE, "1"])
        .unwrap()
        .row(["x", HOSTILE])
        .unwrap();
    let kinds = [ball([0.0; 3], 1.0)];
    let viewer = SphereViewer {
        kinds: &kinds,
        bodies: &[ViewerBody::at_origin(0)],
        picture: PNG,
        description: HOSTILE,
    };
    report
        .section(HOSTILE)
        .subsection(HOSTILE)
        .paragraph(HOSTILE)
        .list(&[HOSTILE, HOSTILE])
        .facts(&[Fact::new(HOSTILE, HOSTILE)])
        .table(&table)
        .provenance(HOSTILE);
    for verdict in [Tone::Good, Tone::Caution, Tone::Bad, Tone::Note] {
        report.verdict(verdict, HOSTILE, HOSTILE);
    }
    report.section("Pictures");
    report.picture(PNG, HOSTILE, HOSTILE).unwrap();
    report
        .pictures(&[(HOSTILE, PNG), ("b", PNG)], HOSTILE)
        .unwrap();
    report.viewer(&viewer, HOSTILE).unwrap();
    for (_, chart) in examples::all(&[1.0, 2.0, -3.0, 4.0]) {
        report.figure(&chart.unwrap(), HOSTILE);
    }
    report.html()
}

/// A kind of body of one sphere.
fn ball(centre: [f64; 3], radius: f64) -> ViewerKind {
    ViewerKind {
        spheres: vec![ViewerSphere { centre, radius }],
        colour: [10, 20, 30],
    }
}

#[test]
fn page_is_well_formed_and_lets_no_markup_through() {
    let page = full_page();
    let elements = elements(&page).unwrap();
    assert!(
        elements
            .iter()
            .all(|element| element.name != "b" || element.attributes.is_empty())
    );
    assert!(!page.contains(HOSTILE));
    let mut ids: Vec<&str> = elements.iter().filter_map(|e| e.attribute("id")).collect();
    let count = ids.len();
    ids.dedup();
    assert_eq!(ids, ["section-1", "section-2"]);
    assert_eq!(count, 2, "ids are unique");
    for link in elements.iter().filter_map(|e| e.attribute("href")) {
        assert!(
            ids.contains(&link.trim_start_matches('#')),
            "{link} leads nowhere"
        );
    }
}

#[test]
fn page_needs_nothing_from_outside() {
    let page = full_page();
    let without_namespace = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for word in [
        "http:",
        "https:",
        "src=\"/",
        "url(",
        "@import",
        "fetch(",
        "XMLHttpRequest",
    ] {
        assert!(!without_namespace.contains(word), "{word} is in the page");
    }
    for element in elements(&page).unwrap() {
        assert!(element.name != "link", "a style sheet from elsewhere");
        assert!(element.name != "script" || element.attribute("src").is_none());
        assert!(element.name != "img" || element.attribute("src").unwrap().starts_with("data:"));
    }
    assert!(
        page.contains("default-src 'none'"),
        "the browser is asked to refuse anything else"
    );
}

#[test]
fn figures_and_tables_are_numbered_in_order() {
    let page = full_page();
    for number in 1..=10 {
        assert_eq!(
            page.matches(&format!("<b>Figure {number}.</b>")).count(),
            1,
            "{number}"
        );
    }
    assert!(page.contains("<b>Table 1.</b>"));
}

#[test]
fn pictures_come_back_byte_for_byte() {
    let page = full_page();
    let elements = elements(&page).unwrap();
    let image = elements
        .iter()
        .find(|element| element.name == "img")
        .unwrap();
    let data = image
        .attribute("src")
        .unwrap()
        .strip_prefix("data:image/png;base64,")
        .unwrap();
    assert_eq!(STANDARD.decode(data).unwrap(), PNG);
    let jpeg = [0xff, 0xd8, 0xff, 0xe0, 7];
    let mut report = Report::new("t");
    report.picture(&jpeg, "d", "c").unwrap();
    let source = format!("src=\"data:image/jpeg;base64,{}\"", STANDARD.encode(jpeg));
    assert!(report.html().contains(&source), "a JPEG under its name");
    assert!(report.picture(b"GIF89a", "d", "c").is_err(), "no GIF");
}

#[test]
fn script_is_there_only_where_a_viewer_needs_it() {
    assert!(full_page().contains("<script>"));
    let mut report = Report::new("t");
    report.section("s").paragraph("p");
    let page = report.html();
    assert!(!page.contains("<script>"));
    assert!(
        !page.contains("<nav"),
        "one section needs no table of contents"
    );
    assert!(elements(&page).is_ok());
    assert!(elements(&Report::new("empty").html()).is_ok());
}

#[test]
fn viewer_holds_the_picture_for_browsers_that_cannot_run_it() {
    let elements = elements(&full_page()).unwrap();
    let viewer = elements
        .iter()
        .position(|e| e.attribute("class") == Some("spheres"))
        .unwrap();
    assert_eq!(elements[viewer + 1].name, "img");
    let numbers = |name: &str| -> Vec<f32> {
        let bytes = STANDARD.decode(elements[viewer].attribute(name).unwrap());
        let bytes = bytes.unwrap();
        let chunks = bytes.chunks(4).map(|b| b.try_into().unwrap());
        chunks.map(f32::from_le_bytes).collect()
    };
    // A unit ball about the origin, of the first kind, neither moved nor turned.
    assert_eq!(numbers("data-kinds"), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(
        numbers("data-bodies"),
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    );
    assert_eq!(elements[viewer].attribute("data-colours"), Some("10,20,30"));
}

#[test]
fn broken_parts_are_refused() {
    let mut report = Report::new("t");
    assert!(matches!(
        report.picture(b"JFIF", "", ""),
        Err(Error::TooFew { count: 0, .. })
    ));
    assert!(matches!(Table::new("t", vec![]), Err(Error::TooFew { .. })));
    let mut table = Table::new("t", vec![Column::text("a"), Column::text("b")]).unwrap();
    assert!(matches!(
        table.row(["1"]),
        Err(Error::Length {
            count: 1,
            expected: 2,
            ..
        })
    ));
    for (radius, centre) in [
        (0.0, 0.0),
        (-1.0, 0.0),
        (f64::NAN, 0.0),
        (1.0, f64::INFINITY),
    ] {
        let kinds = [ball([centre; 3], radius)];
        let viewer = SphereViewer {
            kinds: &kinds,
            bodies: &[ViewerBody::at_origin(0)],
            picture: PNG,
            description: "",
        };
        assert!(report.viewer(&viewer, "").is_err(), "{radius} at {centre}");
    }
    assert!(
        !report.html().contains("<figure"),
        "nothing broken got into the page"
    );
}
