//! Tables as people have them: workbooks beside CSV, numbers of every size.

use crate::{assert_code, assert_error, fixture, seedloop, text, words_in};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::{TempDir, tempdir};

/// Ranges of three factors.
const FACTORS: &str = "symbol,name,unit,low,high\nB,static friction,1,0.30,0.42\nE,restitution,1,0.01,0.18\n\
                       F,rolling friction,1,0.0,0.1\n";

/// Text as a workbook in a folder.
fn workbook(folder: &Path, name: &str, csv: &str) {
    let file = folder.join(name);
    fs::write(
        &file,
        command_line::table_file::bytes_for(&file, csv).unwrap(),
    )
    .unwrap();
}

/// The design of three factors with a response behind each run: `response` of its coded values, and a scatter of some
/// hundredths that depends on the number of the run alone.
fn measured(folder: &Path, response: impl Fn(f64, f64, f64) -> f64, scale: f64) -> String {
    fs::write(folder.join("factors.csv"), FACTORS).unwrap();
    assert_code(
        &words_in(
            folder,
            "design bbd --factors factors.csv --seed 3 --out design.csv --force",
        ),
        0,
    );
    let design = fs::read_to_string(folder.join("design.csv")).unwrap();
    let mut lines = design.lines();
    let mut table = format!("{},theta_deg\n", lines.next().unwrap());
    for (i, line) in lines.enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        let coded: Vec<f64> = fields[4..7]
            .iter()
            .map(|field| field.parse().unwrap())
            .collect();
        let scatter = 0.01 * f64::from(i32::try_from((7 * i) % 5).unwrap() - 2);
        let value = scale * (response(coded[0], coded[1], coded[2]) + scatter);
        table.extend([line, ",", &value.to_string(), "\n"]);
    }
    table
}

/// A folder with the design and its response as CSV and as workbook.
fn folder() -> TempDir {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let data = measured(
        here,
        |b, e, f| 36.0 + 3.0 * b - e + 0.5 * f + 0.7 * b * b + 0.2 * b * f,
        1.0,
    );
    fs::write(here.join("data.csv"), &data).unwrap();
    workbook(here, "data.xlsx", &data);
    workbook(here, "factors.xlsx", FACTORS);
    folder
}

/// Factors, design and data go through workbooks without the loss of a bit: the analysis prints the same and its JSON is the
/// same but for the files that it names. The sheet of a workbook may be named.
#[test]
fn a_workbook_gives_the_analysis_of_its_csv_to_the_last_digit() {
    let folder = folder();
    let here = folder.path();
    let words = "design bbd --factors factors.xlsx --seed 3 --out design.xlsx --json design.json";
    assert_code(&words_in(here, words), 0);
    let [csv, xlsx] = ["design.csv", "design.xlsx"]
        .map(|name| command_line::table_file::read(&here.join(name)).unwrap());
    assert_eq!(csv.header(), xlsx.header());
    for (row, expected) in xlsx.rows().iter().zip(csv.rows()) {
        for column in 0..csv.header().len() {
            assert_eq!(xlsx.number(row, column), csv.number(expected, column));
        }
    }
    let analyses = ["csv", "xlsx", "xlsx#Sheet1"].map(|end| {
        let words = format!(
            "analyse data.{end} --factors factors.{end} --response theta --json a.json --force"
        );
        let output = words_in(here, &words);
        assert_code(&output, 0);
        let mut json: Value =
            serde_json::from_slice(&fs::read(here.join("a.json")).unwrap()).unwrap();
        let inputs = json.as_object_mut().unwrap().remove("inputs").unwrap();
        let names: Vec<String> = inputs.as_object().unwrap().keys().cloned().collect();
        (text(&output.stdout).to_owned(), json, names)
    });
    assert_eq!(analyses[0].0, analyses[1].0);
    assert_eq!(analyses[0].1, analyses[1].1);
    assert_eq!(analyses[1], analyses[2]);
    assert_eq!(analyses[1].2, ["data.xlsx", "factors.xlsx"]);
}

/// A word among the numbers of a workbook is reported with file, sheet, cell and the remedy; a broken workbook with the file.
#[test]
fn a_wrong_cell_of_a_workbook_is_told_with_its_place() {
    let folder = folder();
    let here = folder.path();
    let data = fs::read_to_string(here.join("data.csv")).unwrap();
    let mut lines: Vec<String> = data.lines().map(str::to_owned).collect();
    let value = lines[5].rsplit_once(',').unwrap().0.to_owned();
    lines[5] = value + ",about 36";
    workbook(here, "wrong.xlsx", &lines.join("\n"));
    let words = "analyse wrong.xlsx --factors B,E,F --response theta";
    // run,cell,replicate,block, three coded and three natural columns: the response is the 11th, K.
    let says = [
        "wrong.xlsx",
        "sheet 'Sheet1'",
        "cell K6",
        "'about 36'",
        "correct it",
    ];
    assert_error(&words_in(here, words), &says);
    let whole = fs::read(here.join("data.xlsx")).unwrap();
    fs::write(here.join("cut.xlsx"), &whole[..whole.len() / 2]).unwrap();
    let words = "design bbd --factors cut.xlsx --out other.xlsx";
    assert_error(
        &words_in(here, words),
        &["cut.xlsx", "damaged", "save it again"],
    );
    assert!(
        !here.join("other.xlsx").exists(),
        "a refused run leaves nothing"
    );
}

/// The angles of a tilt in a workbook, with points, and with decimal commas behind semicolons, are the same angles.
#[test]
fn measurements_of_the_bench_may_be_a_workbook_or_have_decimal_commas() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let csv = "seed,angle_deg\n1,10.5\n2,11.25\n3,9.75\n";
    fs::write(here.join("a.csv"), csv).unwrap();
    fs::write(here.join("b.csv"), csv.replace(',', ";").replace('.', ",")).unwrap();
    workbook(here, "c.xlsx", csv);
    let told = ["a.csv", "b.csv", "c.xlsx"].map(|file| {
        let output = words_in(here, &format!("bench-test tilt {file}"));
        assert_code(&output, 0);
        text(&output.stdout).to_owned()
    });
    // tan of 10.5 deg is 0.1853.
    assert!(told[0].contains("rolling_friction 0.185"), "{}", told[0]);
    assert_eq!(told[0], told[1]);
    assert_eq!(told[0], told[2]);
    workbook(here, "wrong.xlsx", "angle_deg\n10\n95\n");
    let says = [
        "wrong.xlsx",
        "sheet 'Sheet1'",
        "cell A3",
        "'95'",
        "below 90",
    ];
    assert_error(&words_in(here, "bench-test tilt wrong.xlsx"), &says);
}

/// A formula of R with its response, and a column name that no formula can hold, are reported with what to write instead.
#[test]
fn formulas_and_names_of_other_programs_are_told_with_the_way_out() {
    let folder = folder();
    let analyse = |model: &str, factors: &str| {
        let words = [
            "analyse",
            "data.csv",
            "--response",
            "theta",
            "--model",
            model,
            "--factors",
            factors,
        ];
        seedloop(folder.path(), &words)
    };
    assert_error(
        &analyse("theta ~ B*E", "B,E,F"),
        &["--response", "--model 'B*E'"],
    );
    assert_error(
        &analyse("linear", "B,static friction"),
        &["'static friction'", "static_friction"],
    );
}

/// Data in another unit, 1e-7 or 1e9 of the first, print the same digits: fixed decimals would print 0.0000 or lose them in
/// the width. The scales are not powers of two, so that the last of six digits may turn by rounding.
#[test]
fn coefficients_keep_their_digits_in_every_unit() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let coefficients = [1.0, 1e-7, 1e9].map(|scale| {
        let data = measured(
            here,
            |b, e, f| 36.0 + 3.0 * b - e + 0.5 * f + 0.7 * b * b,
            scale,
        );
        fs::write(here.join("data.csv"), data).unwrap();
        let output = words_in(
            here,
            "analyse data.csv --factors factors.csv --response theta",
        );
        assert_code(&output, 0);
        let table = text(&output.stdout).lines().skip(2).take(10);
        let coefficients: Vec<f64> = table
            .map(|line| {
                line.split_whitespace()
                    .nth(1)
                    .unwrap()
                    .parse::<f64>()
                    .unwrap()
                    / scale
            })
            .collect();
        coefficients
    });
    assert_eq!(coefficients[0].len(), 10);
    for other in &coefficients[1..] {
        for (value, expected) in other.iter().zip(&coefficients[0]) {
            // Six digits are printed: half a unit of the last one on either side.
            let bound = 1.1e-5 * expected.abs();
            assert!(
                (value - expected).abs() <= bound,
                "{value} is not {expected}"
            );
        }
    }
}

/// A response that is a plane without scatter: the other terms are rounding of sums of order 36, some 1e-15, and are shown as
/// 0 in coded and natural units, while those of the plane keep their digits.
#[test]
fn coefficients_that_are_rounding_are_shown_as_zero() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let data = measured(here, |b, e, _| 36.0 + 3.0 * b - e, 1.0);
    let exact = data.lines().enumerate().map(|(i, line)| {
        let (design, _) = line.rsplit_once(',').unwrap();
        if i == 0 {
            return line.to_owned();
        }
        let fields: Vec<f64> = design
            .split(',')
            .map(|field| field.parse().unwrap())
            .collect();
        format!("{design},{}", 36.1 + 3.3 * fields[4] - 1.7 * fields[5])
    });
    let exact = exact.collect::<Vec<_>>().join("\n");
    fs::write(here.join("data.csv"), exact).unwrap();
    let output = words_in(
        here,
        "analyse data.csv --factors factors.csv --response theta",
    );
    assert_code(&output, 0);
    let told = text(&output.stdout);
    for term in ["F", "BE", "BF", "EF", "B2", "E2", "F2"] {
        let lines: Vec<&str> = told
            .lines()
            .filter(|line| line.split_whitespace().next() == Some(term))
            .collect();
        assert_eq!(lines.len(), 2, "{term} in {told}");
        for line in lines {
            assert_eq!(line.split_whitespace().nth(1), Some("0"), "{line}");
        }
    }
    assert!(
        told.contains("3.30000") && told.contains("-1.70000"),
        "{told}"
    );
}

/// Text of an [`analyse`] that succeeds.
fn analysed(folder: &Path, file: &str, response: &str, factors: &str) -> String {
    let output = analyse(folder, file, response, factors);
    assert_code(&output, 0);
    text(&output.stdout).to_owned()
}

/// Runs `analyse` for a response with these factors.
fn analyse(folder: &Path, file: &str, response: &str, factors: &str) -> Output {
    let words = [
        "analyse",
        file,
        "--response",
        response,
        "--factors",
        factors,
    ];
    seedloop(folder, &words)
}

/// A design that goes through pandas, `read_csv` and `to_excel` with all defaults, has the numbers of the rows before it, in no
/// column of a name: the analysis is that of the design itself.
#[test]
fn a_design_that_went_through_pandas_is_analysed_alike() {
    let folder = folder();
    let here = folder.path();
    let csv = fs::read_to_string(here.join("data.csv")).unwrap();
    let header = csv.lines().next().unwrap();
    let rows = csv.lines().skip(1).enumerate();
    let rows: Vec<String> = rows.map(|(i, line)| format!("{i},{line}\n")).collect();
    let expected = analysed(here, "data.csv", "theta", "factors.csv");
    for (file, name) in [("again.csv", ""), ("twice.csv", "Unnamed: 0")] {
        let table = format!("{name},{header}\n{}", rows.concat());
        fs::write(here.join(file), table).unwrap();
        let found = analysed(here, file, "theta", "factors.csv");
        assert_eq!(found, expected, "{file}");
    }
    let [csv, xlsx] = ["tables/pandas.csv", "tables/pandas.xlsx"].map(|name| {
        let file = fixture(name);
        let file = file.to_str().unwrap();
        let factors = "Temp (ºC),Time (min),Solvent (%)";
        analysed(here, file, "Extraction Yield (%)", factors)
    });
    assert_eq!(csv, xlsx);
    assert!(csv.contains("Temp:Time"), "{csv}");
}

/// The factor `Temp (deg C)` may be asked for as `Temp`, and another name with a blank is refused.
#[test]
fn names_with_a_unit_in_brackets_are_found_by_the_name_alone() {
    let folder = folder();
    let here = folder.path();
    let csv = fs::read_to_string(here.join("data.csv")).unwrap();
    let named = csv
        .replace("theta_deg", "theta [deg]")
        .replace("B_natural", "Temp (deg C)")
        .replace("E_natural", "x2")
        .replace("F_natural", "x3");
    fs::write(here.join("named.csv"), named).unwrap();
    let found = analysed(here, "named.csv", "theta", "Temp,x2,x3");
    let full = analysed(here, "named.csv", "theta", "Temp (deg C),x2,x3");
    assert_eq!(full, found);
    let refused = analyse(here, "named.csv", "theta", "Temp of bath (deg C),E");
    assert_error(&refused, &["'Temp of bath'", "such as Temp_of_bath"]);
}
