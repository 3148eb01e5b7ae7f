//! The report: one page that opens without a network.

pub(crate) mod explorer;
pub(crate) mod pointing;
mod script;
pub(crate) mod table;
pub(crate) mod viewer;

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use self::script::Script;
use crate::escape::escaped;
use crate::{Error, Explorer, PointingPicture, SphereViewer, Svg, Table};

/// Style sheet.
const STYLE: &str = include_str!("html/style.css");

/// How a statement is coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Something holds.
    Good,
    /// Something must be kept in mind.
    Caution,
    /// Something does not hold.
    Bad,
    /// Neither good nor bad.
    Note,
}

impl Tone {
    /// Class of the style sheet.
    fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Caution => "caution",
            Self::Bad => "bad",
            Self::Note => "note",
        }
    }
}

/// A name and what it is, such as "Repose angle" and "38.9 ± 0.4°".
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// Name.
    pub name: String,
    /// Value with its unit.
    pub value: String,
}

impl Fact {
    /// A name and a value with its unit.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value: value.into(),
        }
    }
}

/// A report in the making. Everything that is added belongs to the section begun last.
///
/// All texts are plain text: markup in them is shown as written.
#[derive(Debug, Clone)]
pub struct Report {
    /// Title, plain text.
    title: String,
    /// Headings of the sections, plain text.
    headings: Vec<String>,
    /// Markup of the page after the table of contents.
    body: String,
    /// Lines of the footer, plain text.
    provenance: Vec<String>,
    /// Number of figures so far.
    figures: usize,
    /// Number of tables so far.
    tables: usize,
    /// Scripts that something in the page needs, each once.
    scripts: Vec<Script>,
    /// Seconds after which a browser loads the page again; `None` for never.
    reload_s: Option<u32>,
}

impl Report {
    /// An empty report.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            headings: Vec::new(),
            body: String::new(),
            provenance: Vec::new(),
            figures: 0,
            tables: 0,
            scripts: Vec::new(),
            reload_s: None,
        }
    }

    /// Begins a section; it appears in the table of contents.
    pub fn section(&mut self, heading: &str) -> &mut Self {
        if !self.headings.is_empty() {
            self.push(format_args!("</section>"));
        }
        self.headings.push(heading.to_owned());
        let number = self.headings.len();
        let heading = escaped(heading);
        self.push(format_args!("<section id=\"section-{number}\">"));
        self.push(format_args!(
            "<h2><span class=\"number\">{number}</span> {heading}</h2>"
        ));
        self
    }

    /// Begins a part of a section.
    pub fn subsection(&mut self, heading: &str) -> &mut Self {
        self.push(format_args!("<h3>{}</h3>", escaped(heading)));
        self
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, text: &str) -> &mut Self {
        self.push(format_args!("<p>{}</p>", escaped(text)));
        self
    }

    /// Adds a text whose lines and columns stand as they are.
    pub fn verbatim(&mut self, text: &str) -> &mut Self {
        self.push(format_args!("<pre>{}</pre>", escaped(text)));
        self
    }

    /// Adds a list of short statements.
    pub fn list(&mut self, items: &[&str]) -> &mut Self {
        self.push(format_args!("<ul>"));
        for item in items {
            self.push(format_args!("<li>{}</li>", escaped(item)));
        }
        self.push(format_args!("</ul>"));
        self
    }

    /// Adds a box with a statement and its reason.
    pub fn verdict(&mut self, tone: Tone, headline: &str, reason: &str) -> &mut Self {
        let class = tone.class();
        let (headline, reason) = (escaped(headline), escaped(reason));
        self.push(format_args!(
            "<div class=\"verdict {class}\"><strong>{headline}</strong><p>{reason}</p></div>"
        ));
        self
    }

    /// Adds names and values side by side.
    pub fn facts(&mut self, facts: &[Fact]) -> &mut Self {
        self.push(format_args!("<dl class=\"facts\">"));
        for fact in facts {
            let (name, value) = (escaped(&fact.name), escaped(&fact.value));
            self.push(format_args!("<div><dt>{name}</dt><dd>{value}</dd></div>"));
        }
        self.push(format_args!("</dl>"));
        self
    }

    /// Adds a table.
    pub fn table(&mut self, table: &Table) -> &mut Self {
        self.tables += 1;
        let markup = table.markup(self.tables);
        self.need(Script::Tables);
        self.push(format_args!("{markup}"));
        self
    }

    /// Adds a chart.
    pub fn figure(&mut self, chart: &Svg, caption: &str) -> &mut Self {
        self.need(Script::Figures);
        self.push_figure(chart.as_str().trim_end(), caption)
    }

    /// Adds charts of which the reader chooses one, each with its name and its caption; without scripts and on paper all
    /// are there.
    pub fn choice(&mut self, what: &str, charts: &[(String, Svg, String)]) -> &mut Self {
        let what = escaped(what);
        self.push(format_args!("<div class=\"choice\" data-what=\"{what}\">"));
        for (name, chart, caption) in charts {
            self.push(format_args!("<div data-name=\"{}\">", escaped(name)));
            self.figure(chart, caption);
            self.push(format_args!("</div>"));
        }
        self.need(Script::Choice);
        self.push(format_args!("</div>"));
        self
    }

    /// Begins a part that is folded up under its summary. It opens where a link leads to its `id`, small letters, digits
    /// and hyphens, once in a page; with scripts over the place from which it was called.
    pub fn begin_fold(&mut self, id: &str, summary: &str) -> &mut Self {
        let (id, summary) = (escaped(id), escaped(summary));
        self.need(Script::Fold);
        self.push(format_args!(
            "<details id=\"{id}\"><summary>{summary}</summary>"
        ));
        self
    }

    /// Ends what [`Report::begin_fold`] began.
    pub fn end_fold(&mut self) -> &mut Self {
        self.push(format_args!("</details>"));
        self
    }

    /// Adds a picture given as the bytes of a PNG or JPEG file; `description` is for readers who cannot
    /// see it.
    ///
    /// # Errors
    /// [`Error::TooFew`] for bytes that do not begin as such a file does.
    pub fn picture(
        &mut self,
        bytes: &[u8],
        description: &str,
        caption: &str,
    ) -> Result<&mut Self, Error> {
        let image = image_element(bytes, description)?;
        Ok(self.push_figure(&image, caption))
    }

    /// Adds several pictures side by side under one caption; a description and the bytes of a PNG or JPEG file
    /// each.
    ///
    /// # Errors
    /// [`Error::TooFew`] without a picture or for bytes that do not begin as such a file does.
    pub fn pictures(
        &mut self,
        pictures: &[(&str, &[u8])],
        caption: &str,
    ) -> Result<&mut Self, Error> {
        crate::check::Field::new("report", "pictures").at_least(1, pictures.len())?;
        let mut markup = String::from("<div class=\"strip\">");
        for (description, png) in pictures {
            markup.push_str(&image_element(png, description)?);
        }
        markup.push_str("</div>");
        Ok(self.push_figure(&markup, caption))
    }

    /// Adds spheres that can be turned with the mouse; without WebGL 2, without scripts and on
    /// paper the picture is shown instead.
    ///
    /// # Errors
    /// [`Error`] as [`SphereViewer::check`] gives it.
    pub fn viewer(&mut self, viewer: &SphereViewer<'_>, caption: &str) -> Result<&mut Self, Error> {
        viewer.check()?;
        let image = image_element(viewer.picture, viewer.description)?;
        let markup = viewer.markup(&image);
        self.need(Script::Viewer);
        Ok(self.push_figure(&markup, caption))
    }

    /// Adds a picture whose places can be pointed at where scripts run.
    ///
    /// # Errors
    /// As [`Report::picture`]; [`Error::OutOfRange`] for a size of 0 pixels.
    pub fn pointing_picture(
        &mut self,
        picture: &PointingPicture<'_>,
        caption: &str,
    ) -> Result<&mut Self, Error> {
        let image = image_element(picture.bytes, picture.description)?;
        if let Some(index) = picture.size.iter().position(|pixels| *pixels == 0) {
            return Err(Error::OutOfRange {
                chart: "picture to point at",
                field: "size",
                index,
                value: 0.0,
                requirement: "above 0",
            });
        }
        let markup = picture.markup(&image);
        self.need(Script::Pointing);
        Ok(self.push_figure(&markup, caption))
    }

    /// Adds predictions of surfaces, with a slider for each of their parameters where scripts run; without them
    /// and on paper it is a table of the predictions at the place where the sliders begin.
    ///
    /// # Errors
    /// [`Error`] as [`Explorer::check`] gives it.
    pub fn explorer(&mut self, explorer: &Explorer, caption: &str) -> Result<&mut Self, Error> {
        explorer.check()?;
        self.tables += 1;
        let markup = explorer.markup(self.tables, caption);
        self.need(Script::Explorer);
        self.need(Script::Tables);
        self.push(format_args!("{markup}"));
        Ok(self)
    }

    /// Has a browser load the page again after some seconds, and says so here if the page has not been written for three
    /// minutes.
    pub fn reload_every(&mut self, seconds: u32) -> &mut Self {
        self.reload_s = Some(seconds);
        self.need(Script::Age);
        self.push(format_args!(
            "<div class=\"verdict bad\" id=\"age\" hidden><strong></strong><p></p></div>"
        ));
        self
    }

    /// Adds a line to the footer: version, seed, checksum of an input.
    pub fn provenance(&mut self, line: &str) -> &mut Self {
        self.provenance.push(line.to_owned());
        self
    }

    /// The whole page.
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let contents = self.contents();
        let end = if self.headings.is_empty() {
            ""
        } else {
            "</section>\n"
        };
        let mut footer = String::new();
        for line in &self.provenance {
            append(&mut footer, format_args!("<p>{}</p>", escaped(line)));
        }
        let policy = script::policy(STYLE, &self.scripts);
        let scripts = script::elements(&self.scripts);
        let reload = self.reload_s.map_or_else(String::new, |seconds| {
            format!("<meta http-equiv=\"refresh\" content=\"{seconds}\">\n")
        });
        let body = &self.body;
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             {reload}<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n\
             <h1>{title}</h1>\n{contents}{body}{end}</main>\n<footer>\n{footer}</footer>\n\
             {scripts}</body>\n</html>\n"
        )
    }

    /// Links to the sections; nothing for fewer than two.
    fn contents(&self) -> String {
        if self.headings.len() < 2 {
            return String::new();
        }
        let mut links = String::new();
        for (number, heading) in (1..).zip(&self.headings) {
            let heading = escaped(heading);
            let link = format_args!("<li><a href=\"#section-{number}\">{heading}</a></li>");
            append(&mut links, link);
        }
        format!("<nav aria-label=\"Contents\"><ol>\n{links}</ol></nav>\n")
    }

    /// Adds a numbered figure.
    fn push_figure(&mut self, content: &str, caption: &str) -> &mut Self {
        self.figures += 1;
        let number = self.figures;
        let caption = escaped(caption);
        self.push(format_args!(
            "<figure>\n{content}\n<figcaption><b>Figure {number}.</b> {caption}</figcaption>\n\
             </figure>"
        ));
        self
    }

    /// Notes that a script is needed.
    fn need(&mut self, script: Script) {
        if !self.scripts.contains(&script) {
            self.scripts.push(script);
        }
    }

    /// Adds markup.
    fn push(&mut self, markup: std::fmt::Arguments<'_>) {
        append(&mut self.body, markup);
    }
}

/// Adds a line of markup; writing to a `String` cannot fail.
fn append(target: &mut String, markup: std::fmt::Arguments<'_>) {
    target.write_fmt(markup).expect("a String takes any text");
    target.push('\n');
}

/// An `img` element that holds the picture itself.
fn image_element(bytes: &[u8], description: &str) -> Result<String, Error> {
    const PNG: &[u8] = &[0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a];
    const JPEG: &[u8] = &[0xff, 0xd8, 0xff];
    let kind = if bytes.starts_with(JPEG) {
        "jpeg"
    } else {
        let pairs = bytes.iter().zip(PNG);
        let matching = pairs.take_while(|(byte, wanted)| byte == wanted).count();
        if matching < PNG.len() {
            let (chart, field) = ("report", "signature bytes of a PNG or JPEG picture");
            return Err(Error::TooFew {
                chart,
                field,
                count: matching,
                least: PNG.len(),
            });
        }
        "png"
    };
    let data = STANDARD.encode(bytes);
    let description = escaped(description);
    Ok(format!(
        "<img alt=\"{description}\" src=\"data:image/{kind};base64,{data}\">"
    ))
}
