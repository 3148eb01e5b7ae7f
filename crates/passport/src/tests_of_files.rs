//! The codes, the files of a passport, and what is read back.

use crate::codes::{CODES, known_of};
use crate::convention::CONVENTIONS;
use crate::expected::Expected;
use crate::folder::{Calibrated, Passport, Validity, covariance, files};
use crate::reading::read_passport;
use crate::results::{read_results, template};
use crate::small_cases::cases;
use crate::tests::beads;
use crate::{Error, Packing, check};

/// The known conventions of each code are conventions of the check, and the table of codes names them.
#[test]
fn codes_differ_in_conventions_of_the_check() {
    let page = include_str!("folder/other-codes.md");
    for code in &CODES {
        for known in code.known {
            let convention = CONVENTIONS.iter().find(|c| c.name == known.convention);
            assert!(convention.is_some_and(|c| !c.is_factor()), "{known:?}");
            let row = page.lines().find(|line| {
                let line = line.to_lowercase();
                line.starts_with(&format!("| {} ", code.name)) && line.contains(known.convention)
            });
            assert!(row.is_some(), "{} {}", code.name, known.convention);
        }
    }
    assert!(matches!(known_of("lamps"), Err(Error::Code { name, .. }) if name == "lamps"));
}

/// Standard errors 2 and 3 with a correlation of -1/2 have a covariance of -3; a value that nothing fixes has none.
#[test]
fn covariance_is_that_of_standard_errors_and_correlation() {
    let value = |se| Calibrated {
        symbol: "A".into(),
        name: "a".into(),
        sets: Vec::new(),
        value: 1.0,
        unit: "1".into(),
        se,
        interval95: None,
    };
    let values = [value(Some(2.0)), value(Some(3.0)), value(None)];
    let correlation = [
        vec![1.0, -0.5, 0.0],
        vec![-0.5, 1.0, 0.0],
        vec![0.0, 0.0, 1.0],
    ];
    assert_eq!(
        covariance(&values, &correlation),
        [
            vec![Some(4.0), Some(-3.0), None],
            vec![Some(-3.0), Some(9.0), None],
            vec![None, None, None],
        ]
    );
}

/// Rows of a small passport.
fn few_rows() -> Vec<Expected> {
    let row = |quantity: &str, unit: &str| Expected {
        case: "rolling".into(),
        quantity: quantity.into(),
        unit: unit.into(),
        value: 1.0,
        band: 0.1,
        closed_form: None,
        varies: false,
    };
    vec![
        row("velocity_x_at_t1", "m/s"),
        row("displacement_x_at_t2", "m"),
    ]
}

/// Each fault of a table of results names its line and the fault; blank lines, comments and the order of rows do not matter.
#[test]
fn faults_of_results_name_their_line() {
    let rows = few_rows();
    let read = |text: &str| read_results(text, "RESULTS.csv", &rows);
    let good = "# mine\ncase,quantity,unit,value\n\nrolling,displacement_x_at_t2,m,2.5e-3\nrolling, velocity_x_at_t1, m/s, 1\n";
    assert_eq!(read(good).unwrap(), [1.0, 2.5e-3]);
    let head = "case,quantity,unit,value\n";
    for (line, word) in [
        ("rolled,velocity_x_at_t1,m/s,1", "'rolled'"),
        ("rolling,velocity_z_at_t1,m/s,1", "'velocity_z_at_t1'"),
        ("rolling,velocity_x_at_t1,mm/s,1", "'mm/s'"),
        ("rolling,velocity_x_at_t1,m/s,NaN", "'NaN'"),
        ("rolling,velocity_x_at_t1,m/s,fast", "'fast'"),
        ("rolling,velocity_x_at_t1,m/s,", "no value"),
        ("rolling,velocity_x_at_t1,m/s", "3 cells"),
        (
            "rolling,displacement_x_at_t2,m,1\nrolling,displacement_x_at_t2,m,1",
            "line 2",
        ),
    ] {
        let last = line.lines().count() + 1;
        match read(&format!("{head}{line}\n")).unwrap_err() {
            Error::Results { line, what, .. } => {
                assert!(line == last && what.contains(word), "{line}: {what}");
            }
            other => panic!("{other}"),
        }
    }
    assert!(matches!(
        read("value\n1\n"),
        Err(Error::Results { line: 1, .. })
    ));
    match read(&format!("{head}rolling,displacement_x_at_t2,m,1\n")).unwrap_err() {
        Error::Missing { rows, .. } => assert_eq!(rows, "rolling velocity_x_at_t1"),
        other => panic!("{other}"),
    }
    // The template has every row and no value.
    assert!(matches!(
        read(&template(&rows)),
        Err(Error::Results { line: 2, .. })
    ));
}

/// A passport is read as it was written; its tables have every body and sphere; numbers of another version are refused.
#[test]
fn a_passport_is_read_as_it_was_written() {
    let model = beads();
    let passport = Passport {
        version: "1".into(),
        model: model.clone(),
        calibrated: Vec::new(),
        correlation: Some(vec![vec![1.0]]),
        covariance: Some(vec![vec![Some(0.25)]]),
        validity: Validity::default(),
        expected: few_rows(),
    };
    let files = files(&passport).unwrap();
    let text = |name: &str| &files.iter().find(|file| file.name == name).unwrap().text;
    assert_eq!(read_passport(text("passport.json")).unwrap(), passport);
    let small: usize = cases(&model).iter().map(|case| case.bodies.len()).sum();
    let packed: usize = Packing::ALL.iter().map(|p| p.starts(&model, 1).len()).sum();
    assert_eq!(packed, 200 + 300);
    assert_eq!(text("bodies.csv").lines().count(), 1 + small + packed);
    // Two cases have one clump of two spheres.
    assert_eq!(text("spheres.csv").lines().count(), 1 + small + packed + 2);
    assert!(matches!(
        check(&model, &few_rows(), &[1.0, 1.0], &[]),
        Err(Error::OtherVersion)
    ));
    assert!(read_passport("{}").is_err());
}

/// The spheres of a packing do not overlap, and are inside its planes.
#[test]
fn packings_start_without_contacts() {
    let model = beads();
    for packing in Packing::ALL {
        let centres = packing.starts(&model, 3);
        for (i, a) in centres.iter().enumerate() {
            let others = centres[..i].iter().map(|b| (a - b).norm());
            assert!(others.fold(f64::INFINITY, f64::min) > 2.0 * model.radius_m);
            for [point, normal] in packing.planes(&model) {
                assert!((a - point).dot(&normal) > model.radius_m, "{a}");
            }
        }
    }
}
