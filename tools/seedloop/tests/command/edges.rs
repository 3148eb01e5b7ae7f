//! `design`, `analyse` and `optimise` at the edge of what is valid, and with a reader that goes away.

use crate::{assert_code, assert_error, json, seedloop, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::{TempDir, tempdir};

/// A folder with a table in it.
fn table(content: &str) -> TempDir {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("d.csv"), content).unwrap();
    folder
}

/// `analyse d.csv` with more words, separated by spaces.
fn analyse(folder: &TempDir, words: &str) -> Output {
    let words: Vec<&str> = words.split_whitespace().collect();
    let all = [&["analyse", "d.csv"], &words[..]].concat();
    seedloop(folder.path(), &all)
}

/// `optimise a.json` with more words, separated by spaces.
fn optimise(folder: &TempDir, words: &str) -> Output {
    let words: Vec<&str> = words.split_whitespace().collect();
    let all = [&["optimise", "a.json"], &words[..]].concat();
    seedloop(folder.path(), &all)
}

/// A line through the origin in natural units: the slope is sum x y / sum x^2, whatever range codes it (rounding: 1e-12).
/// In coded columns zero is the middle of the range, and the answer says so.
#[test]
fn zero_is_that_of_the_columns() {
    let folder = table("x,y\n1,2.1\n2,4.1\n4,8.3\n6,12.4\n");
    let slope = (2.1 + 8.2 + 33.2 + 74.4) / 57.0;
    for factors in ["x", "x=1:6", "x=0:5"] {
        let words = format!("--factors {factors} --response y --model 0+x --json");
        let report = json(&analyse(&folder, &words));
        let got = report["coef_natural_units"]["x"].as_f64().unwrap();
        assert!(
            (got - slope).abs() < 1e-12,
            "{factors}: {got} is not {slope}"
        );
        assert_eq!(report["coef_natural_units"]["1"], Value::Null);
    }
    let said = analyse(&folder, "--factors x --response y --model 0+x");
    assert!(text(&said.stdout).contains("the response is 0 at x = 0\n"));
    let coded = table("x,x_natural,y\n-1,10,-2\n0,20,0.1\n1,30,2\n");
    let said = analyse(&coded, "--factors x --response y --model 0+x");
    assert!(text(&said.stdout).contains("in the middle of the ranges, at x = 20.0000"));
    let walls = table("x,wall,y\n1,a,2\n2,a,4\n1,b,3\n2,b,5\n");
    let refused = analyse(
        &walls,
        "--factors x --categories wall --response y --model 0+x+wall",
    );
    assert_error(&refused, &["named levels", "intercept"]);
}

#[test]
fn levenes_test_of_pairs_is_not_made_and_that_is_said() {
    let folder = table("A,y\n-1,3.1\n-1,3.4\n0,2.2\n0,2.9\n1,4.0\n1,5.3\n");
    let output = analyse(
        &folder,
        "--factors A --response y --model linear --json a.json",
    );
    assert_code(&output, 0);
    let said = text(&output.stdout);
    assert!(said.contains("Levene's test cannot be made"), "{said}");
    let report: Value = read(folder.path(), "a.json");
    assert_eq!(report["spread"]["levene"], Value::Null);
    assert!(report["spread"]["bartlett"]["p"].is_number());
}

/// The JSON of a file.
fn read(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap()
}

/// Runs the command with a standard output that nobody reads.
fn unread(folder: &TempDir, words: &str) -> i32 {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut command = Command::new(env!("CARGO_BIN_EXE_seedloop"));
    command
        .current_dir(folder.path())
        .args(words.split_whitespace());
    let status = command.stdout(writer).status().unwrap();
    status.code().unwrap()
}

/// `| head -1` takes one line and goes; the files asked for are written all the same, and the exit code stays that of the
/// answer: a target out of reach is 1.
#[test]
fn files_are_written_though_nobody_reads_the_text() {
    let folder = table("A,B,y\n0,0,1\n0,1,2\n1,0,3.1\n1,1,4.3\n0.5,0.5,2.4\n0.5,0.5,2.6\n");
    let written = |name: &str| folder.path().join(name).is_file();
    let words = "analyse d.csv --factors A,B --response y --model 2fi --json a.json --html a.html --plots plots";
    assert_eq!(unread(&folder, words), 0);
    assert!(written("a.json") && written("a.html") && written("plots/pareto.svg"));
    assert_eq!(
        unread(&folder, "optimise a.json --target 2 --json o.json"),
        0
    );
    assert_eq!(
        unread(&folder, "optimise a.json --target 99 --json p.json"),
        1
    );
    assert_eq!(
        unread(&folder, "optimise a.json --goal max --json g.json"),
        0
    );
    assert!(written("o.json") && written("p.json") && written("g.json"));
    fs::write(
        folder.path().join("f.csv"),
        "symbol,low,high\nA,0,1\nB,0,1\n",
    )
    .unwrap();
    let words = "design full --factors f.csv --out full.csv --json d.json";
    assert_eq!(unread(&folder, words), 0);
    assert!(written("full.csv") && written("d.json"));
    let words = "analyse d.csv --groups --factors A --response y --json q.json";
    assert_eq!(unread(&folder, words), 0);
    assert!(written("q.json"));
}

#[test]
fn responses_whose_squares_are_no_numbers_are_refused_with_line_and_column() {
    let folder = table("# note\nx,y\n1,1\n2,2.5e165\n3,4\n");
    let output = analyse(&folder, "--factors x --response y --model linear");
    assert_error(&output, &["d.csv", "line 4", "'y'", "larger unit"]);
    let groups = analyse(&folder, "--groups --factors x --response y");
    assert_error(&groups, &["d.csv", "larger unit"]);
    let tiny = table("x,y\n1e-200,1\n2e-200,2.5\n3e-200,4\n");
    let output = analyse(&tiny, "--factors x --response y --model linear");
    assert_error(&output, &["'x'", "1e-200", "another unit"]);
}

/// One pair of repeats is an error of one degree of freedom (t 12.7): the answer says so and names the better known one.
#[test]
fn an_error_of_few_degrees_of_freedom_is_told() {
    let folder = table("A,y\n-1,1\n-0.5,1.6\n0,2.2\n0,2.0\n0.5,2.4\n1,3.1\n0.8,2.9\n");
    let output = analyse(
        &folder,
        "--factors A --response y --model linear --json a.json",
    );
    assert_code(&output, 0);
    let said = optimise(&folder, "--target 2");
    let said = text(&said.stdout);
    assert!(
        said.contains("sd 0.1414") && said.contains("1 degree of freedom"),
        "{said}"
    );
    assert!(said.contains("Student's t 12.71"), "{said}");
    assert!(
        said.contains("the residuals have 5") && said.contains("--error residual"),
        "{said}"
    );
    let said = optimise(&folder, "--target 2 --error residual");
    let said = text(&said.stdout);
    assert!(
        said.contains("the residuals of the fit, sd")
            && !said.contains("1 degree of freedom")
            && !said.contains("--error residual"),
        "{said}"
    );
    let goal = optimise(&folder, "--goal max");
    assert!(text(&goal.stdout).contains("1 degree of freedom"));
}

/// In the half fraction D = ABC a main effect is aliased with the product of the three others.
#[test]
fn the_aliases_of_a_fraction_are_told_with_its_analysis() {
    let row = |bits: i32| {
        let [a, b, c] = [0, 1, 2].map(|j| if bits >> j & 1 == 1 { 1 } else { -1 });
        format!("{a},{b},{c},{},{}\n", a * b * c, 3 * a + b + (bits % 3))
    };
    let content = format!("A,B,C,D,y\n{}", (0..8).map(row).collect::<String>());
    let folder = table(&content);
    let output = analyse(
        &folder,
        "--factors A,B,C,D --response y --model linear --json a.json",
    );
    assert_code(&output, 0);
    let said = text(&output.stdout);
    assert!(
        said.contains("\n  A + BCD\n") && said.contains("\n  D + ABC\n"),
        "{said}"
    );
    let amount = &read(folder.path(), "a.json")["aliases"]["BCD"];
    assert!(
        (amount["A"].as_f64().unwrap() - 1.0).abs() < 1e-12,
        "{amount}"
    );
}

/// Two walls and two named blocks, balanced: the level means are those of the rows, the difference of the blocks is 1.
#[test]
fn named_blocks_and_named_levels_alone_are_analysed() {
    let folder = table(
        "wall,day,y\nsteel,mon,1.0\nsteel,tue,2.1\nglass,mon,3.0\nglass,tue,3.9\n\
         steel,mon,1.2\nsteel,tue,2.1\nglass,mon,2.8\nglass,tue,3.9\n",
    );
    let output = analyse(
        &folder,
        "--categories wall --block day --response y --model wall --json a.json --plots plots",
    );
    assert_code(&output, 0);
    let report = read(folder.path(), "a.json");
    let coef = |name: &str| report["terms"][name]["coef"].as_f64().unwrap();
    assert!((coef("block mon") + 0.5).abs() < 1e-12);
    let means = report["level_means"].as_array().unwrap();
    assert_eq!(means[0]["levels"], serde_json::json!(["glass"]));
    assert!((means[0]["mean"].as_f64().unwrap() - 3.4).abs() < 1e-12);
    assert!((means[1]["mean"].as_f64().unwrap() - 1.6).abs() < 1e-12);
    let said = text(&output.stdout);
    assert!(said.contains("at glass: 3.40000 (95 % "), "{said}");
    let refused = optimise(&folder, "--target 2 --level wall=steel");
    assert_error(&refused, &["named levels only"]);
    let nothing = analyse(&folder, "--response y");
    assert_code(&nothing, 2);
}

/// Bounds at ten times the data are reported on standard error and in the JSON; those of a design are not.
#[test]
fn bounds_far_beyond_the_data_are_told() {
    let folder = table("x,y\n1,2.1\n2,4.1\n4,8.3\n6,12.4\n");
    let output = analyse(
        &folder,
        "--factors x --response y --model linear --json a.json",
    );
    assert_code(&output, 0);
    let far = optimise(&folder, "--target 20 --bounds x=1:60 --json=-");
    assert_code(&far, 0);
    let warning = json(&far)["warnings"][0].as_str().unwrap().to_owned();
    assert!(
        warning.contains("beyond the data") && warning.contains("--bounds x=1:6"),
        "{warning}"
    );
    assert!(text(&far.stderr).contains(&warning));
    let near = optimise(&folder, "--target 5 --bounds x=1.5:6.2 --json=-");
    assert_eq!(json(&near)["warnings"], serde_json::json!([]));
    let goal = optimise(&folder, "--goal max --bounds x=-60:6 --json=-");
    assert_eq!(json(&goal)["warnings"].as_array().unwrap().len(), 1);
}

/// Digits that matter are printed at every size: fixed decimals would give 0.00000 for 1e-7.
#[test]
fn small_and_large_numbers_are_printed_with_their_digits() {
    let folder = table("x,y\n1e-7,1e-7\n2e-7,2.1e-7\n3e-7,2.9e-7\n4e-7,4.2e-7\n");
    let output = analyse(
        &folder,
        "--factors x --response y --model linear --json a.json",
    );
    let said = text(&output.stdout);
    assert!(
        said.contains("2.55000e-7") && said.contains("1.040000"),
        "{said}"
    );
    let said = optimise(&folder, "--target 2.55e-7");
    let said = text(&said.stdout);
    assert!(said.contains("x = 2.50000e-7"), "{said}");
}

/// R's operators: A*B is both factors and their product.
#[test]
fn a_formula_may_cross_factors() {
    let folder = table("A,B,y\n-1,-1,1\n-1,1,2\n1,-1,3\n1,1,7\n0,0,3\n0,0,3.4\n");
    let formula = |model: &str| {
        let words = [
            "analyse",
            "d.csv",
            "--factors",
            "A,B",
            "--response",
            "y",
            "--json=-",
            "--model",
            model,
        ];
        json(&seedloop(folder.path(), &words))["terms"].clone()
    };
    assert_eq!(formula("A*B"), formula("1 + A + B + A:B"));
    assert_eq!(formula("(A + B)^2 - A:B"), formula("A + B"));
}

/// The page of an analysis begins with its verdict, has the squares as squares, the factors that a picture holds, the
/// data of its sliders, and no script that its policy does not name.
#[test]
fn the_page_of_an_analysis_begins_with_its_verdict() {
    let rows = [
        "-1,-1", "-1,1", "1,-1", "1,1", "-1,0", "1,0", "0,-1", "0,1", "0,0", "0,0",
    ];
    let value = |k: usize| 5.0 + [0.1, 3.0, 1.2, 4.4, 0.9, 2.1, 3.3, 1.8, 2.0, 2.2][k];
    let lines: Vec<String> = (0..10)
        .map(|k| format!("{},{},{}", rows[k], k % 3, value(k)))
        .collect();
    let folder = table(&format!("A,B,C,y\n{}\n", lines.join("\n")));
    let words = "analyse d.csv --coded --factors A,B --response y --model quadratic --html a.html";
    assert_eq!(unread(&folder, words), 0);
    let page = std::fs::read_to_string(folder.path().join("a.html")).unwrap();
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text}"));
    assert!(place("class=\"verdict") < place("<table>"));
    assert!(place("class=\"surfaces\"") < place("<svg"));
    assert!(page.contains("<td>A²</td>") && !page.contains("<td>A2</td>"));
    assert!(page.contains("outlier, 5 % of all runs") && page.contains("95 % interval, "));
    assert!(page.contains("script-src &#39;sha256-") || page.contains("script-src 'sha256-"));
    assert!(!page.contains("unsafe-inline"));
}

/// A maximum at radius 1.24 in a rotatable composite of two factors, whose axial runs lie at 1.41: beyond the ranges, within the
/// runs. The surface is y = 35 + 6 a - 2.5 a^2 + 0.3 b - 1.5 b^2 with a scatter of hundredths: its maximum lies at a = 1.2.
#[test]
fn an_optimum_between_the_ranges_and_the_axial_runs_is_one_of_these_data() {
    let alpha = 2.0_f64.sqrt();
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let axial = [(-alpha, 0.0), (alpha, 0.0), (0.0, -alpha), (0.0, alpha)];
    let runs = corners
        .into_iter()
        .chain(axial)
        .chain([(0.0, 0.0); 5])
        .enumerate();
    let line = |(i, (a, b)): (usize, (f64, f64))| {
        let scatter = [0.02, -0.03, 0.01, 0.03, -0.02][i % 5];
        let y = 35.0 + 6.0 * a - 2.5 * a * a + 0.3 * b - 1.5 * b * b + scatter;
        format!("{},{},{y}\n", 15.0 + 5.0 * a, 2.0 + b)
    };
    let folder = table(&format!("A,B,y\n{}", runs.map(line).collect::<String>()));
    let said = analyse(
        &folder,
        "--factors A=10:20,B=1:3 --response y --json a.json",
    );
    assert_code(&said, 0);
    let told = text(&said.stdout);
    assert!(told.contains("outside the ranges but within"), "{told}");
    let analysis = read(folder.path(), "a.json");
    assert_eq!(analysis["canonical"]["inside_box"], false);
    assert_eq!(analysis["canonical"]["inside_data"], true);
    let at = |point: &str| {
        let report = json(&optimise(
            &folder,
            &format!("--at {point} --target 38 --json=-"),
        ));
        report["at"]["extrapolated"].as_bool().unwrap()
    };
    assert!(!at("A=21.2,B=2.1"), "radius 1.24");
    assert!(at("A=20.5,B=3.1"), "radius 1.56 within the box of the runs");
    // The best setting lies on the bound of the range, which is not a bound of the data.
    let said = optimise(&folder, "--goal max");
    let told = text(&said.stdout);
    assert!(
        told.contains("A is on its bound 20") && told.contains("--bounds A=10:22.07"),
        "{told}"
    );
    let further = optimise(&folder, "--goal max --bounds A=10:22 --json=-");
    let best = &json(&further)["compromises"][0];
    assert!(
        (best["natural"][0].as_f64().unwrap() - 21.0).abs() < 0.1,
        "{best}"
    );
    assert_eq!(best["predictions"][0]["extrapolated"], false);
    let said = optimise(&folder, "--target 45");
    assert_code(&said, 1);
    assert!(text(&said.stdout).contains("A is on its bound 20"));
}

/// The desirability of a plane that rises from 1 to 3 where it is 2.5, and the same by a goal whose bounds stand in the wrong
/// order.
#[test]
fn a_goal_says_what_a_point_is_worth() {
    let folder = table("x,z,y\n-1,-1,1\n1,-1,2\n-1,1,2\n1,1,3\n0,0,2.02\n0,0,1.98\n");
    let words = "--factors x,z --response y --coded --model linear --json a.json";
    assert_code(&analyse(&folder, words), 0);
    let said = optimise(&folder, "--goal max:1:3 --at x=0.5,z=0.5 --json=-");
    assert_code(&said, 0);
    let worth = json(&said)["at"]["desirability"].as_f64().unwrap();
    assert!((worth - 0.75).abs() < 1e-12, "{worth}");
    let said = optimise(&folder, "--goal max:1:3 --at x=0.5,z=0.5 --error residual");
    let told = text(&said.stdout);
    assert!(
        told.contains("desirability 0.7500 at x = 0.500000, z = 0.500000"),
        "{told}"
    );
    assert!(told.contains("error: the residuals of the fit"), "{told}");
    assert_error(
        &optimise(&folder, "--goal max:3:1"),
        &["must ascend", "3:1"],
    );
    assert_error(
        &optimise(&folder, "--goal max:1:3^0"),
        &["the weight of a goal is 0", "above 0"],
    );
}

/// Cells that no experiment has are named with line and column: 9e99 for a level, 10 for 1, and a scatter of 1e-320.
#[test]
fn absurd_cells_are_named_with_their_place() {
    let rows = |level: &str| {
        format!(
            "B,E,y\n-1,-1,28.4\n-1,1,27.8\n1,{level},30.9\n1,1,33.4\n0,0,29.8\n0,0,29.7\n0,0,30.2\n"
        )
    };
    let words = "--factors B,E --response y --model 2fi";
    let refused = analyse(&table(&rows("9e99")), words);
    assert_error(
        &refused,
        &["line 4, column 'E'", "e99", "far outside all other rows"],
    );
    let said = analyse(&table(&rows("10")), words);
    assert_code(&said, 0);
    let warned = text(&said.stderr);
    assert!(
        warned.contains("line 4, column 'E': 10.0000 lies 4.5 widths outside"),
        "{warned}"
    );
    let said = analyse(&table(&rows("-1")), words);
    assert!(!text(&said.stderr).contains("widths outside"));
    let response = analyse(&table(&rows("-1").replace("33.4", "33.4e20")), words);
    assert_error(
        &response,
        &["line 5, column 'y'", "far outside all other rows"],
    );
    let spreads = |sd: &str, n: &str| {
        let table = table(&format!(
            "A,m,s,n\n-1,3,0.2,5\n1,4,{sd},{n}\n0,3.4,0.25,5\n0,3.6,0.2,5\n"
        ));
        analyse(
            &table,
            "--factors A --response m --sd s --n n --model linear",
        )
    };
    for (sd, n, says) in [
        ("1e-320", "5", "column 's'"),
        ("1e300", "5", "column 's'"),
        ("0.2", "1", "single run"),
        ("0.2", "99999999", "at most 1000000"),
    ] {
        assert_error(&spreads(sd, n), &["line 3", says]);
    }
    // Replicates without their scatter are weighed all the same, and their degrees of freedom are missed aloud.
    let said = spreads("", "5");
    assert_code(&said, 0);
    let warned = text(&said.stderr);
    assert!(
        warned.contains("line 3, column 's'")
            && warned.contains("12 degrees of freedom instead of 16"),
        "{warned}"
    );
    assert!(!text(&spreads("", "1").stderr).contains("degrees of freedom"));
}

/// A target whose scatter is none, and a hostile formula, are refused before anything is computed.
#[test]
fn hostile_words_are_refused() {
    let folder = table("x,y\n-1,1\n1,3\n0,2.1\n0,1.9\n");
    assert_code(
        &analyse(
            &folder,
            "--factors x --response y --model linear --json a.json",
        ),
        0,
    );
    for (words, says) in [
        (
            "--target 2 --target-sd 1e-320 --target-n 5",
            "the sd of the target",
        ),
        ("--target 2 --near x=0+-1e300", "the sd of a measured value"),
        (
            "--target 2 --factor-sd x=1e300",
            "the standard deviation of a factor",
        ),
    ] {
        assert_error(&optimise(&folder, words), &[says, "plausible"]);
    }
    let deep = format!("{}x{}", "(".repeat(10_000), ")".repeat(10_000));
    let words = format!("--factors x --response y --model {deep}");
    assert_error(&analyse(&folder, &words), &["more than 64 brackets"]);
}

/// The picture of a design of three factors says where the third is held, and no mark lies outside the plane: four marks side by
/// side at its edge stand within it.
#[test]
fn a_contour_names_the_factor_that_is_held_and_keeps_its_marks_inside() {
    let corners = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| 2 * bit - 1));
    let line = |[a, b, c]: [i32; 3]| {
        format!(
            "{a},{b},{c},{}\n{a},{b},{c},{}.1\n",
            5 + a + b * c,
            5 + a + b * c
        )
    };
    let rows: String = corners.map(line).collect();
    let folder = table(&format!("A,B,C,y\n{rows}0,0,0,5\n0,0,0,5.2\n"));
    let words = "--factors A,B,C --response y --model 2fi --plots p";
    assert_code(&analyse(&folder, words), 0);
    let svg = |name: &str| fs::read_to_string(folder.path().join("p").join(name)).unwrap();
    for name in ["contour-A-B.svg", "surface-A-B.svg", "interaction-A-B.svg"] {
        assert!(svg(name).contains("y at C = 0"), "{name}");
    }
    let contour = svg("contour-A-B.svg");
    // Two runs of one setting are one mark, and say so.
    assert_eq!(contour.matches("<title>Run ").count(), 9, "{contour}");
    assert!(contour.contains("<title>Run 1, 2: A = -1"));
}
