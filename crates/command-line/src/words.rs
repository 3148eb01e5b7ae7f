//! The words of the command line before they are parsed.

use std::ffi::{OsStr, OsString};
use std::path::Path;

/// Returns the words of the command line, to be parsed.
///
/// `--json` may take a file name, so `angle-from-image --json photo.jpg` would lose its photo to
/// it. A word after `--json` that names an existing file or folder and does not end in `.json`
/// is an input: `--json` then means standard output.
pub(crate) fn arguments() -> impl Iterator<Item = OsString> {
    let words: Vec<OsString> = std::env::args_os().collect();
    separate_json(words, |word| Path::new(word).exists()).into_iter()
}

/// Gives `--json` its own value if the next word is an input.
fn separate_json(words: Vec<OsString>, exists: impl Fn(&OsStr) -> bool) -> Vec<OsString> {
    let is_input = |word: &OsStr| {
        let is_json = Path::new(word)
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("json"));
        !is_json && exists(word)
    };
    let next_is_input: Vec<bool> = words
        .iter()
        .skip(1)
        .map(|word| is_input(word))
        .chain([false])
        .collect();
    words
        .into_iter()
        .zip(next_is_input)
        .map(|(word, next_is_input)| {
            if word == "--json" && next_is_input {
                OsString::from("--json=-")
            } else {
                word
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::separate_json;
    use std::ffi::OsString;

    fn separated(line: &str) -> String {
        let words = line.split(' ').map(OsString::from).collect();
        let words = separate_json(words, |word| {
            ["photo.jpg", "frames", "old.json"]
                .iter()
                .any(|file| word == *file)
        });
        let words: Vec<&str> = words.iter().filter_map(|word| word.to_str()).collect();
        words.join(" ")
    }

    #[test]
    fn an_existing_input_after_json_stays_an_input() {
        assert_eq!(
            separated("tool --json photo.jpg"),
            "tool --json=- photo.jpg"
        );
        assert_eq!(separated("tool --json frames"), "tool --json=- frames");
    }

    #[test]
    fn a_json_file_or_a_new_file_after_json_is_its_value() {
        for line in [
            "tool --json old.json photo.jpg",
            "tool --json new photo.jpg",
            "tool photo.jpg --json",
            "tool --json --quiet photo.jpg",
        ] {
            assert_eq!(separated(line), line);
        }
    }
}
