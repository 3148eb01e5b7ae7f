//! Flags that a command has no use for are refused: one that is left unread would be taken for one that was followed.

use crate::{assert_code, assert_error, seedloop};
use std::fs;
use tempfile::tempdir;

/// Flags of `design`, behind its kind, and what the refusal says.
const OF_DESIGNS: [(&str, &str); 12] = [
    ("bbd --halvings 1", "--halvings is for fraction"),
    ("full --resolution 3", "--resolution is for fraction"),
    ("bbd --axial rotatable", "--axial is for ccd"),
    ("lhs --runs 9 --step 1", "--step is for steepest"),
    ("pb --descend", "--descend is for steepest"),
    ("ccd --foldover", "--foldover is for pb and fraction"),
    ("ccd --analysis a.json", "--analysis is for"),
    ("steepest --analysis a.json --model linear", "--model"),
    ("fraction --halvings 1 --generators C=AB", "--generators"),
    ("fraction --resolution 3 --generators C=AB", "--generators"),
    ("ccd --axial face --alpha 1.5", "--alpha"),
    ("ccd --axial face --blocks orthogonal", "--axial"),
];

/// Flags of `analyse`, behind the table and the response.
const OF_ANALYSES: [(&str, &str); 6] = [
    ("--factors A,B --model linear --alpha 0.2", "--alpha is for"),
    (
        "--factors A,B --model linear --reduce bic --alpha 0.2",
        "--alpha is for",
    ),
    ("--categories wall --coded", "--factors"),
    ("--factors wall --groups --block B", "--block"),
    ("--factors wall --groups --model linear", "--model"),
    ("--factors wall --groups --plots p", "--plots"),
];

/// Flags of `optimise`, behind the analysis.
const OF_OPTIMA: [(&str, &str); 8] = [
    ("--goal max --near A=12", "--near"),
    ("--goal max --at A=12,B=2 --confirm 3", "--confirm"),
    ("--goal max --target-sd 1 --target-n 3", "--target-sd"),
    ("--goal max --content 0.9", "--content"),
    ("--target 3 --content 0.9", "--at"),
    ("--target 3 --seed 4", "--bootstrap"),
    ("--target 3 --at A=12+-1,B=2", "--factor-sd"),
    ("--target 3 --factor-sd A=1+-0.1/3", "--factor-sd"),
];

/// Words of `bench-test`.
const OF_THE_BENCH: [(&str, &str); 4] = [
    ("tilt d.csv --seed 4", "--scene"),
    ("tilt d.csv --repeats 4", "--scene"),
    ("drop d.csv --height-mm 100", "--scene"),
    (
        "tilt --scene s.toml --height-mm 100",
        "--height-mm is for drop",
    ),
];

#[test]
fn a_flag_that_would_be_left_unread_is_refused() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let factors = "symbol,low,high\nA,10,20\nB,1,3\nC,0,1\n";
    fs::write(here.join("f.csv"), factors).unwrap();
    let data = "A,B,wall,y\n10,1,a,1\n20,1,b,3\n10,3,a,2\n20,3,b,5\n15,2,a,3\n15,2,b,3.1\n";
    fs::write(here.join("d.csv"), data).unwrap();
    let run = |words: &str| seedloop(here, &words.split(' ').collect::<Vec<_>>());
    let analyse = "analyse d.csv --response y";
    let sound = format!("{analyse} --factors A,B --model linear --json a.json");
    assert_code(&run(&sound), 0);
    let all = [
        ("design --factors f.csv --out x.csv", &OF_DESIGNS[..]),
        (analyse, &OF_ANALYSES),
        ("optimise a.json", &OF_OPTIMA),
        ("bench-test", &OF_THE_BENCH),
    ];
    for (command, flags) in all {
        for (words, says) in flags {
            assert_error(&run(&format!("{command} {words}")), &[says]);
        }
    }
    assert!(!here.join("x.csv").exists(), "a refused run leaves nothing");
}
