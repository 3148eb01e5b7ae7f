//! The runs behind the surfaces: every mark of a picture opens its own, with the results of that run.

use super::{page, rows};
use crate::design_points::design_points;
use crate::numbers::digits;
use crate::page::with_room;
use crate::test_study::study;
use std::collections::BTreeSet;

/// Parts of a text between two others.
fn between<'a>(text: &'a str, begin: &str, end: &str) -> Vec<&'a str> {
    let parts = text.split(begin).skip(1);
    parts.map(|part| part.split(end).next().unwrap()).collect()
}

/// The folded part of a point.
fn fold<'a>(page: &'a str, id: &str) -> &'a str {
    between(page, &format!("<details id=\"{id}\">"), "</details>")[0]
}

#[test]
fn every_mark_of_a_design_opens_the_runs_of_its_point() {
    let study = study();
    let page = page(&study);
    let ids: BTreeSet<&str> = between(&page, "<details id=\"", "\"").into_iter().collect();
    let links = between(&page, "<a href=\"#run-", "\"");
    // Two surfaces of the drum over three parameters, 13 points each; the sled has a curve without marks.
    let drum = study
        .calibration
        .surfaces
        .iter()
        .position(|s| s.model == "drum-15");
    let drum = drum.unwrap();
    let points = design_points(&study.calibration.surfaces[drum]);
    assert_eq!(links.len(), 2 * points.len());
    for link in links {
        assert!(ids.contains(format!("run-{link}").as_str()), "{link}");
    }
    let all: usize = study
        .calibration
        .surfaces
        .iter()
        .map(|s| design_points(s).len())
        .sum();
    assert_eq!(ids.len(), all, "each point once");
    let names = between(&page, "<a href=\"#run-", "</title>");
    for (point, name) in points.iter().zip(names) {
        let name = name.split("<title>").nth(1).unwrap();
        assert_eq!(name, point.name(&study.calibration.surfaces[drum].symbols));
    }
}

#[test]
fn a_point_tells_settings_observables_and_what_its_records_keep() {
    let study = study();
    let page = page(&study);
    for (number, surfaces) in study.calibration.surfaces.iter().enumerate() {
        for point in design_points(surfaces) {
            let part = fold(&page, &point.id(number));
            for (symbol, value) in surfaces.symbols.iter().zip(point.settings) {
                let row = part
                    .split("<tr>")
                    .find(|row| row.starts_with(&format!("<td>{symbol} ")));
                assert!(row.unwrap().contains(&digits(*value)), "{symbol} of {part}");
            }
            let mut frames = 0;
            for &run in &point.runs {
                let record = &study.records[&surfaces.keys[run]];
                let row = &rows(part, &(run + 1).to_string())[0];
                let values: Vec<String> =
                    surfaces.values.values().map(|v| digits(v[run])).collect();
                assert_eq!(row[1..=values.len()], values);
                assert_eq!(row[values.len() + 1], record.seed().to_string());
                assert_eq!(row.last().unwrap(), record.key());
                let details = record.details();
                frames += usize::from(details["last_frame_png_base64"].is_string());
            }
            assert_eq!(part.matches("<img").count(), frames, "{}", point.id(number));
            let series = if surfaces.model == "sled" {
                0
            } else {
                point.runs.len()
            };
            assert_eq!(part.matches("<svg xmlns").count(), series);
        }
    }
    assert!(
        page.contains("alt=\"Last frame of run"),
        "some run kept a frame"
    );
}

/// All three pairs of three parameters can be chosen, the most correlated first, with the estimate in each; the equation
/// and the analysis of variance have squares.
#[test]
fn every_pair_of_parameters_and_every_square_is_shown() {
    let study = study();
    let page = page(&study);
    let choice = between(&page, "<div class=\"choice\"", "</div>\n</div>")[0];
    let names = between(choice, "data-name=\"", "\"");
    let sorted: BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(sorted, BTreeSet::from(["F and E", "F and G", "E and G"]));
    let correlation = &study.calibration.correlation;
    let size = |name: &str| {
        let place = |s: &str| {
            ["F", "E", "G"]
                .iter()
                .position(|known| *known == s)
                .unwrap()
        };
        let (a, b) = name.split_once(" and ").unwrap();
        correlation[place(a)][place(b)].abs()
    };
    assert!(size(names[0]) >= size(names[1]) && size(names[1]) >= size(names[2]));
    assert_eq!(choice.matches(">estimate</text>").count(), 3);
    assert!(choice.contains("(mm)"), "the unit of G");
    assert!(!rows(&page, "F²").is_empty() && !rows(&page, "FE").is_empty());
    assert!(rows(&page, "F2").is_empty());
    let held = digits(study.calibration.parameters[2].value);
    assert!(page.contains(&format!("with G = {held} mm held there")));
}

/// A page without room for a frame says in which record it is; one with all frames says nothing of the kind.
#[test]
fn a_frame_without_room_on_the_page_is_in_its_record() {
    let study = study();
    let told = "is kept in its record alone";
    assert!(!page(&study).contains(told));
    let without = with_room(&study.input(), 0).unwrap();
    let with_frame =
        |record: &campaign::run_store::Record| !record.details()["last_frame_png_base64"].is_null();
    let surfaces = study.calibration.surfaces.iter();
    let frames = surfaces
        .flat_map(|s| &s.keys)
        .filter(|key| study.records.get(*key).is_some_and(with_frame));
    let frames = frames.count();
    assert!(frames > 0);
    assert_eq!(without.matches(told).count(), frames);
}
