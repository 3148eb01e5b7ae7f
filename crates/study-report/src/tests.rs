//! The report as a whole: every part with its numbers at their place.

mod beds;
mod browser;
mod curves;
mod explorer;
mod files;
mod runs;

use crate::page::study_page;
use crate::test_input::{Example, example};
use crate::test_residual::twins;
use inference::{Comparison, DiagnosisStage, InputEstimate, Role, WithEffects};
use std::collections::BTreeMap;

fn page(example: &Example) -> String {
    study_page(&example.input()).unwrap()
}

/// The headings of sections and their parts, in order, without the numbers of the sections.
fn headings(page: &str) -> Vec<String> {
    let opened = page.split("<h2>").skip(1);
    let text = |part: &str| part.split("</h2>").next().unwrap().to_owned();
    let plain = |text: String| text.split("</span> ").last().unwrap().to_owned();
    opened.map(text).map(plain).collect()
}

/// The first row of a table that begins with an entry: its entries.
pub(crate) fn row(page: &str, first: &str) -> Vec<String> {
    rows(page, first).into_iter().next().unwrap_or_default()
}

/// All rows of all tables that begin with an entry: their entries.
fn rows(page: &str, first: &str) -> Vec<Vec<String>> {
    let rows = page.split("<tr>").skip(1).map(|row| {
        let row = row.split("</tr>").next().unwrap();
        let entries = row.split("<td").skip(1).map(|entry| {
            let text = entry.split_once('>').unwrap().1;
            text.trim_end().trim_end_matches("</td>").to_owned()
        });
        entries.collect::<Vec<_>>()
    });
    rows.filter(|row| row.first().is_some_and(|entry| entry == first))
        .collect()
}

#[test]
fn the_first_table_holds_every_measurement_before_and_after() {
    let page = page(&example());
    // sd / sqrt(10) of what was measured; 0.12 deg of what was simulated.
    let fit = row(&page, "2");
    let expected = [
        "fit",
        "33.10 ± 0.25°",
        "30.40 ± 0.12°",
        "+9.6",
        "33.25 ± 0.12°",
        "−0.5",
        "yes (2.26)",
    ];
    assert_eq!(fit[1], "drum, speed 15 rpm: angle");
    assert_eq!(fit[2..], expected);
    let check = row(&page, "3");
    let expected = [
        "check",
        "35.20 ± 0.28°",
        "31.90 ± 0.12°",
        "+10.6",
        "36.30 ± 0.12°",
        "−3.6",
        "no (2.26)",
    ];
    assert_eq!(check[2..], expected);
    let show = row(&page, "4");
    assert_eq!(show[2..4], ["show", "21.40 ± 0.19°"]);
    assert_eq!(show[8], "not judged");
    let sled = row(&page, "1");
    assert_eq!(sled[3], "0.5600 ± 0.0095");
    // The fit comes first, and nothing but the verdict comes before the table.
    let place = |text: &str| page.find(text).unwrap();
    assert!(place("Not met (exit code 1)") < place("<table>"));
    assert!(place("sled: shown static friction") < place("drum, speed 30 rpm: angle"));
    // sqrt((20.9² + 9.6²) / 2) and sqrt((0.3² + 0.5²) / 2).
    assert!(page.contains("16.26 before, 0.41 fitted"));
}

/// What is missing and named has its columns in the first tables: a check that the fit misses by 3.6 standard errors, met with the effect,
/// and the parameter with it; whether a measurement holds is said of the last column.
#[test]
fn the_first_tables_show_what_is_added() {
    let mut full = example();
    let met = |row: &Comparison| Comparison {
        z: 0.5,
        holds: true,
        ..row.clone()
    };
    let found = &mut full.calibration;
    let rows = found.fit.iter().chain(&found.check).map(met).collect();
    let mut friction = found.parameters[0].clone();
    (friction.value, friction.se) = (0.45, Some(0.02));
    found.with_effects = Some(WithEffects {
        effects: [("whole-seed-damping".to_owned(), 1.0)].into(),
        parameters: vec![friction],
        rows,
        holds: true,
    });
    let page = page(&full);
    assert!(page.contains("with whole-seed-damping"));
    let check = row(&page, "3");
    assert_eq!(check[check.len() - 4..][..2], ["−3.6", "36.30 ± 0.12°"]);
    assert_eq!(check[check.len() - 2..], ["+0.5", "yes (2.26)"]);
    assert!(page.contains("0.450 ± 0.020"));
}

#[test]
fn every_part_appears_once_and_in_its_order() {
    let mut full = example();
    full.calibration.diagnosis = DiagnosisStage::Done(Box::new(twins()));
    let page = page(&full);
    let expected = [
        "Result",
        "Try other parameters",
        "What the measurements fix",
        "Joint estimate",
        "Runs at the estimate",
        "Residual and diagnosis",
        "Response surfaces",
        "Screening",
        "How it was found",
        "Seeds as bodies of spheres",
        "Runs of the designs",
        "Cost",
        "Inputs and settings",
    ];
    assert_eq!(headings(&page), expected);
    assert!(page.contains("Verdict of the diagnosis"));
    assert!(page.contains("The set of solutions") && page.contains("Beside values of others"));
}

/// The shares of the runs' time are of 100 s; 98 s of one core and 54 s of this call are reported beside them.
#[test]
fn where_the_time_went_is_told() {
    let page = page(&example());
    for told in [
        "All runs took 98 s of one core, and this call 54 s.",
        "building 2 %, settling 13 %, start-up 35 %, measuring 41 %, reading pictures 9 %.",
        "For 10 s a thread of this call computed no run",
    ] {
        assert!(page.contains(told), "{told}");
    }
}

#[test]
fn parameters_correlations_and_open_combinations_are_told() {
    let page = page(&example());
    let f = row(&page, "F name of F");
    let expected = [
        "0.330 ± 0.021",
        "0.288 to 0.372",
        "0.1",
        "0 to 1.5",
        "fixed by the measurements",
    ];
    assert_eq!(f[1..], expected);
    let e = row(&page, "E name of E");
    assert_eq!(e[5], "fixed by the measurements and its prior");
    assert_eq!(row(&page, "E"), ["E", "−0.62", "1.00"]);
    assert!(page.contains("These measurements fix only the sum of F and E"));
    assert!(page.contains("0.610 with 1 degree of freedom, p = 0.4348"));
    assert!(page.contains("Of the last box 4.20 %"));
    let set = rows(&page, "F name of F");
    assert_eq!(set[1][1..], ["0.280", "0.380", "0.330", "0.290"]);
    // (0.34 - 0.33) / 0.021.
    let joint = &set[2];
    assert_eq!(
        joint[1..],
        ["0.330 ± 0.021", "0.340 ± 0.010", "0.320 to 0.360", "+0.5"]
    );
    assert!(page.contains("p = 0.1108"));
    let other = row(&page, "funnel angle");
    assert_eq!(
        other[1..],
        [
            "21.60 ± 0.12°",
            "22.90 ± 0.70°",
            "−1.30°",
            "a handbook, p. 3"
        ]
    );
}

#[test]
fn the_search_the_runs_and_their_cost_are_told() {
    let page = page(&example());
    let second = rows(&page, "2");
    assert!(second.iter().any(|row| row[1] == "moved"
        && row[2] == "F 0.200 to 0.700, E 0.100 to 0.600"
        && row[3] == "F = 0.330, E = 0.400"
        && row[4..] == ["0.610", "21"]));
    let round = rows(&page, "1");
    let confirmed = [
        "drum-15: angle",
        "33.40 ± 0.20°",
        "33.20 ± 0.12°",
        "3",
        "+0.9",
    ];
    assert!(round.iter().any(|row| row[1..] == confirmed));
    assert!(page.contains("the runs agree with the surfaces"));
    assert!(page.contains("it slides, and the others roll"));
    let joint = &rows(&page, "drum, speed 30 rpm: angle")[0];
    assert_eq!(joint[1..], ["35.20°", "35.55 ± 0.20°", "+1.0"]);
    let runs = &rows(&page, "drum, speed 30 rpm: angle")[1];
    assert_eq!(runs[4], "0.310°");
    // 35.2 - 36.3; sqrt(0.285² + 0.12²).
    assert_eq!(runs[5], "−1.10 ± 0.31°");
    assert_eq!(runs[7], "4: 3 rolling, 1 slumping");
    assert_eq!(row(&page, "all stages")[1..], ["25", "38.2"]);
    assert!(page.contains("no effect was asked for"));
    assert!(page.contains("drum.toml: SHA-256 ab12"));
    assert!(page.contains("loop.replicates: 1"));
    assert_eq!(row(&page, "confirmation_runs")[1], "3");
    assert_eq!(row(&page, "most_runs")[1], "no limit");
}

#[test]
fn surfaces_screenings_and_seeds_are_drawn_and_tabled() {
    let example = example();
    let page = page(&example);
    for caption in [
        "Table 1 as a picture",
        "Root of the sum of squares of z over the last box",
        "Points of the set of solutions: E against F",
        "Pareto chart of the effects on the angle",
        "Half-normal plot of all columns for the angle",
        "Fitted angle over the two parameters that move it most",
        "The shown static friction over the parameter",
        "Last frame of a check run: drum, speed 30 rpm",
        "drum, speed 30 rpm: direction of the centre of mass over time",
        "Seed pea: ",
    ] {
        assert!(page.contains(caption), "{caption}");
    }
    // Two models have one drum, and with it one seed.
    assert_eq!(page.matches("the spheres alone; turn them").count(), 1);
    // Twice the coefficient 3 of the plane behind the screening.
    assert!(
        rows(&page, "F name of F")
            .iter()
            .any(|row| row[1] == "+6.000" && row[5] == "yes")
    );
    // The coefficient 4, and what the wobble adds: -0.25 / 6 over the six runs on the faces.
    let effect = rows(&page, "F");
    assert!(
        effect.iter().any(|row| row.len() == 7 && row[1] == "3.96"),
        "{effect:?}"
    );
    assert!(page.contains("The pull force has no analysis of variance: 10 runs are too few"));
    let pea = row(&page, "pea");
    assert_eq!(pea[1..4], ["drum-15, drum-30", "1 (1)", "5.4"]);
}

#[test]
fn what_is_not_there_leaves_no_heading() {
    let bare = Example::bare();
    let page = page(&bare);
    let expected = [
        "Result",
        "What the measurements fix",
        "Runs at the estimate",
        "Residual and diagnosis",
        "Inputs and settings",
    ];
    assert_eq!(headings(&page), expected);
    for absent in [
        "Beside values",
        "leave open",
        "keep in mind",
        "left out, and what",
        "Input files",
        "of z, check",
    ] {
        assert!(!page.contains(absent), "{absent}");
    }
    assert_eq!(row(&page, "2")[4..6], ["–", "–"]);
}

/// An input with its stated value and error, what it becomes, how far it moved and by how much it moves each parameter, which is 0 for
/// one that it does not touch.
#[test]
fn inputs_are_on_the_first_screen_with_what_they_move() {
    let mut example = example();
    let first = example.calibration.parameters[0].clone();
    example.calibration.inputs = vec![InputEstimate {
        symbol: "fill".into(),
        name: "of the drum".into(),
        unit: "1".into(),
        sets: Vec::new(),
        stated: 0.35,
        sd: 0.01,
        value: 0.372,
        se: 0.004,
        moved: 2.2,
        moves: BTreeMap::from([(first.symbol, -0.5)]),
    }];
    let page = page(&example);
    let row = row(&page, "fill of the drum");
    assert_eq!(row[1..4], ["0.350 ± 0.010", "0.3720 ± 0.0040", "+2.2"]);
    assert!(row[4].trim_start_matches('−').starts_with("0.5"), "{row:?}");
    assert!(row[5].starts_with('0'), "{row:?}");
}

#[test]
fn markup_in_any_text_is_shown_as_written() {
    let hostile = "<script>alert('x & y')</script>";
    let mut example = example();
    example.name = hostile.into();
    example.defaults = vec![hostile.into()];
    example.inputs = BTreeMap::from([(hostile.into(), hostile.into())]);
    example.compare[0].source = hostile.into();
    example.problem.models[2].scene = hostile.into();
    let c = &mut example.calibration;
    c.check[0].scene = hostile.into();
    c.before[0].scene = hostile.into();
    c.verdict = hostile.into();
    c.remarks = vec![hostile.into()];
    c.parameters[0].name = hostile.into();
    c.surfaces[0].left_out[0].reason = hostile.into();
    c.boxes[0].why = hostile.into();
    c.cost[0].stage = hostile.into();
    let page = page(&example);
    assert!(!page.contains("<script>alert"));
    assert!(page.matches("&lt;script&gt;alert").count() >= 12);
}

#[test]
fn a_measurement_that_no_run_gives_stays_in_the_table_with_dashes() {
    let mut example = example();
    example.calibration.check.clear();
    let page = page(&example);
    let check = row(&page, "3");
    assert_eq!(check[6..], ["–", "–", "–"]);
    assert_eq!(check[5], "+10.6");
    assert_eq!(example.problem.measurements_of(Role::Check).len(), 1);
}
