//! The page as a whole, and the policy that lets a browser run its script and nothing else.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use report::escaped;
use serde_json::json;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;

use crate::view::Parts;

/// Style sheet.
const STYLE: &str = include_str!("page/watch.css");
/// Script.
const SCRIPT: &str = include_str!("page/watch.js");

/// The page with its parts in it, so that it shows them without the script too: it is then loaded again every two seconds.
pub(crate) fn html(title: &str, parts: &Parts) -> String {
    let mut body = String::new();
    for (name, markup) in parts {
        let tag = if *name == "name" { "h1" } else { "section" };
        for text in ["<", tag, " id=\"", name, "\">", markup, "</", tag, ">\n"] {
            body.push_str(text);
        }
    }
    let title = escaped(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <noscript><meta http-equiv=\"refresh\" content=\"2\"></noscript>\n\
         <title>{title}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <div id=\"lost\" class=\"verdict bad\" hidden><strong>No answer</strong>\
         <p>seedloop watch has ended, or the machine is out of reach: what follows is the last that it told.</p></div>\n\
         {body}</main>\n<footer>Renewed every two seconds. Nothing in the folder is changed.</footer>\n\
         <script>{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

/// What the script of the page fetches.
pub(crate) fn json(title: &str, parts: &Parts) -> String {
    let parts: BTreeMap<&str, &String> = parts.iter().map(|(name, text)| (*name, text)).collect();
    let data = json!({ "title": title, "parts": parts }).to_string();
    // So that no reader takes it for a page.
    data.replace('<', "\\u003c")
}

/// The policy of all replies: the style and the script of the page by their SHA-256 digests, pictures and data from here, nothing
/// from anywhere else, and no frame around it.
///
/// # Source
/// W3C, Content Security Policy Level 3, sections 2.3.1 and 6.7.3.
pub(crate) fn policy() -> String {
    format!(
        "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; connect-src 'self'; \
         img-src 'self' data:; style-src {}; script-src {}",
        digest(STYLE),
        digest(SCRIPT)
    )
}

/// The digest of a text as a policy names it.
fn digest(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
