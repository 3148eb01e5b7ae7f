//! Flags that a command has no use for are refused: one that is left unread would be taken for one that was followed.

use crate::{assert_code, assert_error, seedloop};
use std::fs;
use tempfile::tempdir;

/// A word for each flag, the mode in which it is unread, and what the refusal says.
#[test]
fn a_flag_that_would_be_left_unread_is_refused() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let factors = "symbol,low,high\nA,10,20\nB,1,3\nC,0,1\n";
    fs::write(here.join("f.csv"), factors).unwrap();
    let data = "A,B,C,wall,y\n10,1,0,a,1\n20,1,0,b,3\n10,3,1,a,2\n20,3,1,b,5\n15,2,0.5,a,3\n15,2,0.5,b,3.1\n";
    fs::write(here.join("d.csv"), data).unwrap();
    let run = |words: &str| seedloop(here, &words.split(' ').collect::<Vec<_>>());
    let analyse = "analyse d.csv --factors A,B --response y --model linear";
    assert_code(&run(&format!("{analyse} --json a.json")), 0);
    let design =
        |kind: &str, flags: &str| format!("design {kind} --factors f.csv --out x.csv {flags}");
    for (words, says) in [
        (design("bbd", "--halvings 1"), "--halvings is for fraction"),
        (
            design("full", "--resolution 3"),
            "--resolution is for fraction",
        ),
        (design("bbd", "--axial rotatable"), "--axial is for ccd"),
        (design("lhs", "--runs 9 --step 1"), "--step is for steepest"),
        (design("pb", "--descend"), "--descend is for steepest"),
        (
            design("ccd", "--foldover"),
            "--foldover is for pb and fraction",
        ),
        (design("ccd", "--analysis a.json"), "--analysis is for"),
        (
            design("steepest", "--analysis a.json --model linear"),
            "--model",
        ),
        (
            design("fraction", "--halvings 1 --generators C=AB"),
            "--generators",
        ),
        (
            design("fraction", "--resolution 3 --generators C=AB"),
            "--generators",
        ),
        (design("ccd", "--axial face --alpha 1.5"), "--alpha"),
        (design("ccd", "--axial face --blocks orthogonal"), "--axial"),
        (format!("{analyse} --alpha 0.2"), "--alpha is for"),
        (
            format!("{analyse} --reduce bic --alpha 0.2"),
            "--alpha is for",
        ),
        (
            "analyse d.csv --categories wall --response y --coded".to_owned(),
            "--factors",
        ),
        (
            "analyse d.csv --factors wall --response y --groups --block B".to_owned(),
            "--block",
        ),
        (
            "analyse d.csv --factors wall --response y --groups --model linear".to_owned(),
            "--model",
        ),
        (
            "analyse d.csv --factors wall --response y --groups --plots p".to_owned(),
            "--plots",
        ),
        ("bench-test tilt d.csv --seed 4".to_owned(), "--scene"),
        ("bench-test tilt d.csv --repeats 4".to_owned(), "--scene"),
        (
            "bench-test drop d.csv --height-mm 100".to_owned(),
            "--scene",
        ),
        (
            "bench-test tilt --scene s.toml --height-mm 100".to_owned(),
            "--height-mm is for drop",
        ),
        (
            "optimise a.json --goal max --near A=12".to_owned(),
            "--near",
        ),
        (
            "optimise a.json --goal max --at A=12,B=2,C=0 --confirm 3".to_owned(),
            "--confirm",
        ),
        (
            "optimise a.json --goal max --target-sd 1 --target-n 3".to_owned(),
            "--target-sd",
        ),
        (
            "optimise a.json --goal max --content 0.9".to_owned(),
            "--content",
        ),
        (
            "optimise a.json --target 3 --content 0.9".to_owned(),
            "--at",
        ),
        (
            "optimise a.json --target 3 --seed 4".to_owned(),
            "--bootstrap",
        ),
        (
            "optimise a.json --target 3 --at A=12+-1,B=2".to_owned(),
            "--factor-sd",
        ),
        (
            "optimise a.json --target 3 --factor-sd A=1+-0.1/3".to_owned(),
            "--factor-sd",
        ),
    ] {
        assert_error(&run(&words), &[says]);
    }
    assert!(!here.join("x.csv").exists(), "a refused run leaves nothing");
}
