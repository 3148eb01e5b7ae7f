//! A small reader of markup that refuses what is not well formed.

/// One element as it begins.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Element {
    /// Name.
    pub(crate) name: String,
    /// Attributes in order.
    pub(crate) attributes: Vec<(String, String)>,
    /// Text directly inside, still escaped.
    pub(crate) text: String,
}

impl Element {
    /// Value of an attribute.
    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value.as_str())
    }

    /// Number in an attribute.
    pub(crate) fn number(&self, name: &str) -> f64 {
        let value = self
            .attribute(name)
            .unwrap_or_else(|| panic!("{self:?} has no {name}"));
        value
            .parse()
            .unwrap_or_else(|_| panic!("{name} of {self:?} is not a number"))
    }
}

/// Elements of HTML that have no end.
const VOID: [&str; 2] = ["meta", "img"];

/// All elements in order; an error reports what is not well formed.
pub(crate) fn elements(markup: &str) -> Result<Vec<Element>, String> {
    let mut rest = markup.strip_prefix("<!DOCTYPE html>\n").unwrap_or(markup);
    let mut all: Vec<Element> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    while let Some(place) = rest.find('<') {
        let (text, tag) = rest.split_at(place);
        check_text(text)?;
        if let Some(&inner) = open.last() {
            all[inner].text.push_str(text);
        } else if !text.trim().is_empty() {
            return Err(format!("text outside of everything: {text}"));
        }
        let end = tag
            .find('>')
            .ok_or_else(|| format!("no end of {tag:.60}"))?;
        let inside = &tag[1..end];
        rest = &tag[end + 1..];
        if let Some(name) = inside.strip_prefix('/') {
            let inner = open
                .pop()
                .ok_or_else(|| format!("{name} ends without a beginning"))?;
            if all[inner].name != name {
                return Err(format!("{} ends as {name}", all[inner].name));
            }
            continue;
        }
        let (inside, closed) = inside
            .strip_suffix('/')
            .map_or((inside, false), |i| (i, true));
        let element = element(inside)?;
        let name = element.name.clone();
        all.push(element);
        if name == "script" || name == "style" {
            let ending = format!("</{name}>");
            let past = rest
                .find(&ending)
                .ok_or_else(|| format!("no end of {name}"))?;
            rest = &rest[past + ending.len()..];
        } else if !closed && !VOID.contains(&name.as_str()) {
            open.push(all.len() - 1);
        }
    }
    if !rest.trim().is_empty() {
        return Err(format!("text after the end: {rest}"));
    }
    open.last().map_or(Ok(()), |&inner| {
        Err(format!("{} has no end", all[inner].name))
    })?;
    Ok(all)
}

/// Name and attributes.
fn element(inside: &str) -> Result<Element, String> {
    let (name, mut rest) = inside.split_once(' ').unwrap_or((inside, ""));
    let plain = |text: &str| {
        !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-')
    };
    if !plain(name) {
        return Err(format!("not a name: {name}"));
    }
    let mut attributes: Vec<(String, String)> = Vec::new();
    while !rest.trim().is_empty() {
        let (key, after) = rest
            .split_once("=\"")
            .ok_or_else(|| format!("no value in {rest} of {name}"))?;
        let (value, after) = after
            .split_once('"')
            .ok_or_else(|| format!("no end of {key} of {name}"))?;
        let key = key.trim();
        if !plain(key) || attributes.iter().any(|(other, _)| other == key) {
            return Err(format!("bad or repeated attribute {key} of {name}"));
        }
        check_text(value)?;
        attributes.push((key.to_owned(), value.to_owned()));
        rest = after;
    }
    Ok(Element {
        name: name.to_owned(),
        attributes,
        text: String::new(),
    })
}

/// Refuses markup characters that are not escaped.
fn check_text(text: &str) -> Result<(), String> {
    for (place, _) in text.match_indices('&') {
        let known = ["&amp;", "&lt;", "&gt;", "&quot;", "&#39;"];
        if !known.iter().any(|entity| text[place..].starts_with(entity)) {
            return Err(format!("a bare & in {text}"));
        }
    }
    Ok(())
}

#[test]
fn reader_refuses_what_is_not_well_formed() {
    assert_eq!(elements("<a><b/></a>").unwrap().len(), 2);
    for bad in [
        "<a>",
        "<a></b>",
        "</a>",
        "<a b></a>",
        "<a b=\"&\"></a>",
        "<a>&nbsp;</a>",
        "<a>x</a>y",
    ] {
        assert!(elements(bad).is_err(), "{bad}");
    }
}
