//! The crates serve any material: published values of one material are in fixtures, not in code.

use crate::tree::{files, root, shown, text_of};
use std::path::Path;

/// Results of the published cotton study, deg, and the name of its seeds.
const PUBLISHED: [&str; 5] = ["38.87", "38.63", "43.18", "91.82", "kangmian"];

/// Materials of its scene, which tests inside crates may load from the fixtures.
const MATERIALS: [&str; 2] = ["tough_resin", "clear_resin"];

/// A source without its tests.
fn without_tests<'a>(path: &Path, text: &'a str) -> &'a str {
    if path.ends_with("tests.rs") || path.components().any(|part| part.as_os_str() == "tests") {
        return "";
    }
    text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("")
}

/// Words of the study that a source contains.
fn held(path: &Path, text: &str) -> Vec<&'static str> {
    let published = PUBLISHED.iter().filter(|word| text.contains(**word));
    let own = without_tests(path, text);
    let materials = MATERIALS.iter().filter(|word| own.contains(**word));
    published.chain(materials).copied().collect()
}

/// Whether a file is the source of a crate or tool.
fn is_source(path: &Path) -> bool {
    let inside = path.strip_prefix(root()).unwrap_or(path);
    let parts: Vec<_> = inside.iter().filter_map(|part| part.to_str()).collect();
    matches!(parts.as_slice(), ["crates" | "tools", _, "src", ..])
}

#[test]
fn words_of_the_study_are_found_in_code_and_materials_outside_tests() {
    let path = Path::new("crates/a/src/b.rs");
    assert_eq!(held(path, "let target = 38.87;"), ["38.87"]);
    assert_eq!(held(path, "\"clear_resin\""), ["clear_resin"]);
    let tested = "fn a() {}\n#[cfg(test)]\nmod tests {\n\"clear_resin\" 43.18 }";
    assert_eq!(held(path, tested), ["43.18"]);
    assert!(held(Path::new("crates/a/src/tests.rs"), "\"clear_resin\"").is_empty());
    assert!(is_source(&root().join("tools/a/src/b/c.toml")));
    assert!(!is_source(&root().join("tools/a/tests/b.rs")));
}

#[test]
fn no_source_holds_what_was_published_of_one_material() {
    let mut found = Vec::new();
    for path in files().into_iter().filter(|path| is_source(path)) {
        let Some(text) = text_of(&path) else { continue };
        let words = held(&path, &text);
        if !words.is_empty() {
            found.push(format!("{}: {}", shown(&path), words.join(", ")));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
