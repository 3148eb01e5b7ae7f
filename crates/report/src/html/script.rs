//! The scripts of a page, and the policy that lets a browser run these and nothing else.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;

/// A script that a part of a page needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Script {
    /// Spheres that can be turned.
    Viewer,
    /// Tables that are sorted and copied.
    Tables,
    /// Sliders over response surfaces.
    Explorer,
    /// One of several charts at a time.
    Choice,
    /// Folded parts that open over the place from which they are called.
    Fold,
    /// Pictures whose places are pointed at.
    Pointing,
    /// Charts that are saved.
    Figures,
    /// The age of a page that should be renewed.
    Age,
}

impl Script {
    fn text(self) -> &'static str {
        match self {
            Self::Viewer => include_str!("viewer.js"),
            Self::Tables => include_str!("tables.js"),
            Self::Explorer => include_str!("explorer.js"),
            Self::Choice => include_str!("choice.js"),
            Self::Fold => include_str!("fold.js"),
            Self::Pointing => include_str!("pointing.js"),
            Self::Figures => include_str!("figures.js"),
            Self::Age => include_str!("age.js"),
        }
    }
}

pub(crate) fn elements(scripts: &[Script]) -> String {
    let element = |script: &Script| format!("<script>{}</script>\n", script.text());
    scripts.iter().map(element).collect()
}

/// The policy of a page: pictures in the page itself, its style and its scripts by their SHA-256 digests, nothing from
/// anywhere else.
///
/// # Source
/// W3C, Content Security Policy Level 3, sections 2.3.1 and 6.7.3.
pub(crate) fn policy(style: &str, scripts: &[Script]) -> String {
    let mut policy = format!(
        "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; style-src {}",
        digest(style)
    );
    if !scripts.is_empty() {
        policy.push_str("; script-src");
    }
    for script in scripts {
        write!(policy, " {}", digest(script.text())).expect("a String takes any text");
    }
    policy
}

/// The digest of a text as a policy names it.
fn digest(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

/// Data for a script as an element that no browser runs and that no text in it can end: `<` is written as `\u003c`.
///
/// Numbers have the shortest digits that give the same number back.
pub(crate) fn data_element(class: &str, data: &impl Serialize) -> String {
    let json = serde_json::to_string(data).expect("names and finite numbers are JSON");
    let json = json.replace('<', "\\u003c");
    format!("<script type=\"application/json\" class=\"{class}\">{json}</script>")
}

#[cfg(test)]
mod tests {
    use super::{Script, data_element, digest, elements, policy};

    /// The digest of the empty text is that of FIPS 180-4, in base 64.
    #[test]
    fn the_policy_names_every_script_of_the_page_and_allows_no_other() {
        assert_eq!(
            digest(""),
            "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='"
        );
        let scripts = [
            Script::Viewer,
            Script::Tables,
            Script::Explorer,
            Script::Choice,
            Script::Fold,
            Script::Pointing,
            Script::Figures,
            Script::Age,
        ];
        let policy = policy("p {}", &scripts);
        let page = elements(&scripts);
        let texts = page
            .split("<script>")
            .skip(1)
            .map(|s| s.split("</script>").next());
        for text in texts {
            assert!(policy.contains(&digest(text.unwrap())), "{policy}");
        }
        assert!(policy.contains(&digest("p {}")));
        assert!(!policy.contains("unsafe"));
        assert!(super::policy("", &[]).contains("default-src 'none'"));
        assert!(!super::policy("", &[]).contains("script-src"));
    }

    /// Neither an end tag nor the beginning of a comment gets out of the data, and what is read back is what went in.
    #[test]
    fn no_text_ends_the_data_or_begins_markup() {
        let names = ["</script><b>", "<!--<script>", "a & b \u{2028} \"c\""];
        let element = data_element("names", &names);
        let inside = element
            .strip_prefix("<script type=\"application/json\" class=\"names\">")
            .and_then(|rest| rest.strip_suffix("</script>"))
            .unwrap();
        assert!(!inside.contains('<'), "{inside}");
        let read: Vec<String> = serde_json::from_str(inside).unwrap();
        assert_eq!(read, names);
    }

    /// Digits that would not give the same number back would move the predictions of the page.
    #[test]
    fn numbers_come_back_bit_for_bit() {
        let numbers = [0.1 + 0.2, 1.0 / 3.0, -1e-300, 6.02e23];
        let element = data_element("n", &numbers);
        let inside = element.split('>').nth(1).unwrap().split('<').next();
        let read: Vec<f64> = serde_json::from_str(inside.unwrap()).unwrap();
        assert_eq!(read, numbers);
    }
}
