//! Writing, hashing and emitting to files.

use std::fs;

use clap::Parser;
use command_line::{Common, Header, Overwrite, file_sha256, write_new};

/// Does the work of a tool.
#[derive(Debug, Parser)]
struct Tool {
    #[command(flatten)]
    common: Common,
}

fn common(words: &[&str]) -> Result<Common, clap::Error> {
    Tool::try_parse_from([&["tool"], words].concat()).map(|tool| tool.common)
}

fn names(folder: &tempfile::TempDir) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().display().to_string())
        .collect();
    names.sort();
    names
}

#[test]
fn a_file_is_written_whole_and_nothing_stays_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("result.csv");
    write_new(&path, b"one", Overwrite::Refuse).expect("new");
    assert_eq!(fs::read(&path).expect("written"), b"one");
    assert_eq!(names(&folder), ["result.csv"]);
}

#[test]
fn an_existing_file_stays_unless_overwriting_is_allowed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("result.csv");
    write_new(&path, b"one", Overwrite::Refuse).expect("new");
    let text = write_new(&path, b"two", Overwrite::Refuse)
        .expect_err("it exists")
        .to_string();
    assert!(text.contains("result.csv exists: add --force"), "{text}");
    assert_eq!(fs::read(&path).expect("kept"), b"one");
    write_new(&path, b"two", Overwrite::Allow).expect("allowed");
    assert_eq!(fs::read(&path).expect("replaced"), b"two");
    assert_eq!(names(&folder), ["result.csv"]);
}

#[test]
fn a_missing_folder_and_a_folder_in_the_way_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = write_new(&folder.path().join("no/x.csv"), b"", Overwrite::Refuse)
        .expect_err("no folder")
        .to_string();
    assert!(text.contains("does not exist; create it first"), "{text}");
    let text = write_new(folder.path(), b"", Overwrite::Allow)
        .expect_err("a folder")
        .to_string();
    assert!(text.contains("it is a folder"), "{text}");
}

/// The digest is the test vector of FIPS 180-4 for the message "abc".
#[test]
fn sha256_of_a_file_is_that_of_its_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("abc");
    fs::write(&path, "abc").expect("written");
    let digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(file_sha256(&path).expect("read"), digest);
    let header = Header::new(7, [&path]).expect("read");
    assert_eq!(header.seed, Some(7));
    assert_eq!(header.inputs[&path.display().to_string()], digest);
    let text = file_sha256(&folder.path().join("none"))
        .expect_err("missing")
        .to_string();
    assert!(text.contains("cannot read"), "{text}");
}

#[test]
fn json_goes_to_its_file_with_null_for_what_is_not_finite() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.json");
    let name = path.display().to_string();
    let flags = common(&["--json", &name]).expect("good usage");
    assert!(!flags.json_on_stdout());
    flags.emit_json(&[0.1, f64::NAN]).expect("written");
    assert_eq!(
        fs::read_to_string(&path).expect("text"),
        "[\n  0.1,\n  null\n]\n"
    );
    assert!(flags.emit_json(&1).is_err(), "it exists now");
    let forced = common(&["--json", &name, "--force"]).expect("good usage");
    forced.emit_json(&1).expect("allowed");
    assert_eq!(fs::read_to_string(&path).expect("text"), "1\n");
}

#[test]
fn a_photo_is_not_replaced_by_json_even_with_force() {
    let folder = tempfile::tempdir().expect("a folder");
    let photo = folder.path().join("photo.jpg");
    fs::write(&photo, "pixels").expect("written");
    let flags = common(&["--force", "--json", &photo.display().to_string()]).expect("usage");
    let text = flags.emit_json(&1).expect_err("not JSON").to_string();
    assert!(text.contains("does not end in .json"), "{text}");
    assert_eq!(fs::read(&photo).expect("kept"), b"pixels");
}

#[test]
fn flags_are_read_with_their_defaults_and_limits() {
    let none = common(&[]).expect("no flags");
    assert!(none.json.is_none() && !none.quiet && !none.force);
    assert_eq!(none.overwrite(), Overwrite::Refuse);
    assert!(none.threads() >= 1);
    assert!(common(&["--json"]).expect("no file").json_on_stdout());
    assert!(
        common(&["--json", "--quiet"])
            .expect("no file")
            .json_on_stdout()
    );
    assert_eq!(common(&["--threads", "3"]).expect("three").threads(), 3);
    for bad in ["0", "-1", "1025", "two", ""] {
        assert!(common(&["--threads", bad]).is_err(), "{bad}");
    }
}

/// The doc comment of a flattened struct must not become the description of the tool.
#[test]
fn help_of_a_tool_lists_the_flags_under_its_own_description() {
    let help = common(&["--help"]).expect_err("help").to_string();
    assert!(help.starts_with("Does the work of a tool"), "{help}");
    for flag in ["--json [<FILE>]", "--quiet", "--threads <N>", "--force"] {
        assert!(help.contains(flag), "{flag} is missing in {help}");
    }
}
