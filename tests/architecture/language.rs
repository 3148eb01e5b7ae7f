//! Pages, documentation and messages avoid phrases that are nearly always unclear.

use crate::tree::{files, root, shown, text_of};

/// Phrases that a reader stumbles over in nearly every use, with the words to use instead.
///
/// A phrase matches whole words in any case, also across a line break.
const BANNED: [(&str, &str); 56] = [
    ("is told", "is reported"),
    ("are told", "are reported"),
    ("was told", "was reported"),
    ("were told", "were reported"),
    ("told apart", "distinguished"),
    ("told as", "reported as"),
    ("told by", "given by"),
    ("tell apart", "distinguish"),
    ("tells apart", "distinguishes"),
    ("tells how", "shows how"),
    ("tells that", "reports that"),
    ("tells the", "gives the"),
    ("tells what", "reports, with a noun"),
    ("tells which", "states which"),
    ("tells whether", "shows whether"),
    ("tells nothing", "gives no information"),
    ("is no", "is not a"),
    ("are no", "are not"),
    ("none where", "`None` if"),
    ("where none", "if none"),
    ("where no", "if no"),
    ("where nothing", "if nothing"),
    ("where there are", "if there are"),
    ("where there is", "if there is"),
    ("where the file leaves", "if the file omits"),
    ("of which nothing", "without"),
    ("as it stands", "unchanged"),
    ("stand there", "are present"),
    ("stands behind", "follows"),
    ("stands beside", "is next to"),
    ("stands for", "represents"),
    ("stands in", "is in"),
    ("stands there", "is present"),
    ("stands twice", "is a duplicate"),
    ("name of its own", "unique name"),
    ("names of their own", "unique names"),
    ("anew", "again"),
    ("goes on", "continues"),
    ("go on", "continue"),
    ("in place of", "instead of"),
    ("as good as", "nearly"),
    ("speaks for", "supports"),
    ("speaks against", "contradicts"),
    ("the way out", "the remedy"),
    ("hangs on", "depends on"),
    ("drawn are", "put the subject first"),
    ("what became of", "result of"),
    ("what came of", "result of"),
    ("what came out of", "result of"),
    ("what can be wrong", "errors of"),
    ("what can go wrong", "errors of"),
    ("what comes of", "result of"),
    ("what is known of", "known data of"),
    ("what is left of", "remainder of"),
    ("what is said of", "message about"),
    ("what is wrong", "fault of"),
];

/// Correct English that contains a banned phrase.
const ALLOWED: [&str; 7] = [
    "there is no",
    "there are no",
    "is no longer",
    "are no longer",
    "is no more",
    "is no less",
    "is no larger",
];

/// A run of text that a reader takes in at once: a paragraph, a documentation comment or a message.
struct Passage {
    /// Line of each byte of the text, from 1.
    lines: Vec<usize>,
    text: String,
}

impl Passage {
    fn new() -> Self {
        Self {
            lines: Vec::new(),
            text: String::new(),
        }
    }

    fn add(&mut self, line: usize, text: &str) {
        let text = format!("{} ", text.to_lowercase());
        self.lines.extend(vec![line; text.len()]);
        self.text += &text;
    }
}

/// Returns the paragraphs of a page without its code blocks.
fn paragraphs(page: &str) -> Vec<Passage> {
    let mut passages = vec![Passage::new()];
    let mut in_code = false;
    for (number, line) in page.lines().enumerate() {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        if is_fence || line.trim().is_empty() {
            passages.push(Passage::new());
        } else if !in_code {
            let last = passages.last_mut().expect("there is always one");
            last.add(number + 1, line.trim());
        }
    }
    passages
}

/// Returns the documentation comments and the string literals of a source file.
///
/// A literal may continue on the next lines. The search for its end starts afresh at an empty line, so that a quote
/// in a raw string does no lasting harm.
fn documentation_and_messages(source: &str) -> Vec<Passage> {
    let mut passages = vec![Passage::new()];
    let mut in_literal = false;
    for (number, line) in source.lines().enumerate() {
        let line = line.trim();
        let doc = line.strip_prefix("///").or(line.strip_prefix("//!"));
        if let Some(doc) = doc.filter(|doc| !doc.trim().is_empty()) {
            let last = passages.last_mut().expect("there is always one");
            last.add(number + 1, doc.trim());
            continue;
        }
        if line.is_empty() || line.starts_with("//") {
            in_literal = false;
            passages.push(Passage::new());
            continue;
        }
        let line = line.replace("\\\"", "'").replace("'\"'", "' '");
        for (part, text) in line.trim_end_matches('\\').split('"').enumerate() {
            if part > 0 {
                in_literal = !in_literal;
            }
            if part > 0 || !in_literal {
                passages.push(Passage::new());
            }
            if in_literal {
                let last = passages.last_mut().expect("there is always one");
                last.add(number + 1, text.trim());
            }
        }
    }
    passages
}

/// Returns where a phrase occurs as whole words.
fn occurrences(text: &str, phrase: &str) -> Vec<usize> {
    let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '-' || c == '_');
    text.match_indices(phrase)
        .map(|(at, _)| at)
        .filter(|&at| {
            !is_word(text[..at].chars().next_back())
                && !is_word(text[at + phrase.len()..].chars().next())
        })
        .collect()
}

/// Returns the banned phrases of a passage, each with its line and the words to use instead.
fn faults(passage: &Passage) -> Vec<(usize, &'static str, &'static str)> {
    let text = &passage.text;
    let allowed: Vec<(usize, usize)> = ALLOWED
        .iter()
        .flat_map(|phrase| {
            let starts = occurrences(text, phrase).into_iter();
            starts.map(|at| (at, at + phrase.len()))
        })
        .collect();
    let mut found = Vec::new();
    for (phrase, instead) in BANNED {
        for at in occurrences(text, phrase) {
            let end = at + phrase.len();
            if !allowed.iter().any(|(from, to)| *from <= at && end <= *to) {
                found.push((passage.lines[at], phrase, instead));
            }
        }
    }
    found
}

#[test]
fn a_banned_phrase_is_found_across_a_line_break_and_in_a_message() {
    let page = "A speed is\ntold in rpm.\n\n```sh\nis told\n```\nThere is no other.";
    let found: Vec<_> = paragraphs(page).iter().flat_map(faults).collect();
    assert_eq!(found, [(1, "is told", "is reported")]);

    let source = "/// One that\n/// is told.\n// is told\nf(\"it stands for\", \"a \\\"b\\\" goes \\\n    on\");";
    let passages = documentation_and_messages(source);
    let found: Vec<_> = passages.iter().flat_map(faults).collect();
    let found: Vec<_> = found
        .iter()
        .map(|(line, phrase, _)| (*line, *phrase))
        .collect();
    assert_eq!(found, [(2, "is told"), (4, "stands for"), (4, "goes on")]);
}

#[test]
fn pages_documentation_and_messages_use_no_banned_phrase() {
    let root = root();
    let docs = root.join("docs");
    let pages = ["README.md", "CONTRIBUTING.md", "ARCHITECTURE.md"].map(|name| root.join(name));
    let mut found = Vec::new();
    for path in files() {
        let passages = match path.extension().and_then(|end| end.to_str()) {
            Some("md") if path.starts_with(&docs) || pages.contains(&path) => {
                paragraphs(&text_of(&path).expect("a page is text"))
            }
            Some("rs") if !path.ends_with("language.rs") => {
                documentation_and_messages(&text_of(&path).expect("code is text"))
            }
            _ => continue,
        };
        for (line, phrase, instead) in passages.iter().flat_map(faults) {
            found.push(format!(
                "{}:{line}: \"{phrase}\"; write {instead}",
                shown(&path)
            ));
        }
    }
    assert!(
        found.is_empty(),
        "{} phrases are hard to read:\n{}",
        found.len(),
        found.join("\n")
    );
}
