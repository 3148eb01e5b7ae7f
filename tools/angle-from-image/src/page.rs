//! The results as one page that opens without a network: a summary, then every picture with what was found in it.

use crate::interface::Interface;
use crate::results::{ImageResult, Output};
use crate::summary::Spread;
use anyhow::Context as _;
use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use photo_profile::Mode;
use report::{
    Axis, Column, Fact, Mark, Plot, PlotPoint, Pointed, PointingPicture, PointingTool, Report,
    Table, Tone, series,
};
use surface_profile::Definition;

/// Up to so many pictures are shown large.
const FEW: usize = 60;
/// Longer side of a picture in a page of few and of many pictures, px.
const SIDES: [u32; 2] = [800, 400];
/// Quality of the pictures, 1 to 100: a line of two pixels stays sharp.
const QUALITY: u8 = 85;
/// Standard errors in half of the 95 % interval.
const HALF_INTERVAL: f64 = 1.96;

/// What can be given by pointing at it, and how it is stated; last, what holds for a picture that is not straightened.
const TOOLS: [PointingTool<'static>; 6] = [
    PointingTool {
        what: "the drum: three or more places on its rim",
        flag: "--drum",
        told: Pointed::Circle,
    },
    PointingTool {
        what: "the surface of the bed: five or more places on it",
        flag: "--surface",
        told: Pointed::Path,
    },
    PointingTool {
        what: "the part to look at: two opposite corners",
        flag: "--region",
        told: Pointed::Rectangle,
    },
    PointingTool {
        what: "a plumb line: two places on it",
        flag: "--plumb-line",
        told: Pointed::Places,
    },
    PointingTool {
        what: "a level: two places of one height",
        flag: "--level",
        told: Pointed::Places,
    },
    PointingTool {
        what: "a square in the plane of the drum's end: its corners",
        flag: "--corners",
        told: Pointed::Square,
    },
];

/// Longer side of the pictures in a page of at least so many, px.
pub(crate) fn side(n_pictures: usize) -> u32 {
    SIDES[usize::from(n_pictures > FEW)]
}

/// A picture as it goes into the page.
pub(crate) fn jpeg(picture: &RgbImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, QUALITY)
        .encode_image(picture)
        .context("cannot draw a picture of the page")?;
    Ok(bytes)
}

/// The page; `shown` holds for each picture its overlay as JPEG, none for one that could not be read.
pub(crate) fn page(
    output: &Output,
    shown: &[Option<Vec<u8>>],
    mode: Mode,
) -> anyhow::Result<String> {
    let all: Vec<Shown<'_>> = output
        .images
        .iter()
        .zip(shown)
        .enumerate()
        .map(|(place, (image, jpeg))| Shown {
            number: place + 1,
            image,
            jpeg: jpeg.as_deref(),
        })
        .collect();
    let mut page = Report::new(match all.len() {
        1 => "Angle of repose from a picture".to_owned(),
        n => format!("Angle of repose from {n} pictures"),
    });
    summary(&mut page, output, &all, mode)?;
    let (measured, others): (Vec<&Shown<'_>>, Vec<_>) =
        all.iter().partition(|s| s.image.angle_deg.is_some());
    if !others.is_empty() {
        page.section("Pictures without an angle");
        for shown in others {
            shown.without_angle(&mut page)?;
        }
    }
    if !measured.is_empty() {
        page.section("Measured pictures");
        page.paragraph(&format!("{}.", legend(mode)));
        for shown in measured {
            shown.measured(&mut page)?;
        }
    }
    page.provenance(&format!("angle-from-image {}.", output.header.version));
    for (file, hash) in &output.header.inputs {
        page.provenance(&format!("{file}: SHA-256 {hash}"));
    }
    Ok(page.html())
}

/// What the colours of a measured picture are.
fn legend(mode: Mode) -> &'static str {
    match mode {
        Mode::Drum => {
            "Blue: the drum. Green: points of the surface that count; magenta: set aside. Orange: the line whose slope is \
             the angle"
        }
        Mode::Heap => {
            "Green: points of the flanks that count; magenta: points that do not. Orange: the lines of the flanks"
        }
    }
}

/// One picture with its number.
struct Shown<'a> {
    /// Place in the order of all, from 1; also in the names of overlays.
    number: usize,
    image: &'a ImageResult,
    /// What was found in it, as JPEG.
    jpeg: Option<&'a [u8]>,
}

impl Shown<'_> {
    /// The file, with the frame of an animation.
    fn name(&self) -> String {
        self.image.name()
    }

    /// A refused or unread picture: first how to continue, then why.
    fn without_angle(&self, page: &mut Report) -> anyhow::Result<()> {
        let image = self.image;
        page.subsection(&format!("{}. {}", self.number, self.name()));
        if let Some(words) = &image.advice {
            page.verdict(Tone::Note, "How to continue", &sentence(words));
        }
        if let Some(flag) = &image.advice_flag {
            page.verbatim(flag);
        }
        let reason = image.reason.as_deref().unwrap_or("no reason");
        let verdict = if image.sha256.is_some() {
            "Refused"
        } else {
            "Not read"
        };
        page.paragraph(&format!("{verdict}: {reason}."));
        if let Some(jpeg) = self.jpeg {
            let caption = "Blue: the drum, dashed where it is a guess. Magenta: the boundary that was found, and its line.";
            let description = format!("Refused picture {}", self.number);
            let picture = self.picture(jpeg, &description);
            page.pointing_picture(&picture, &format!("{}. {caption}", self.name()))?;
        }
        Ok(())
    }

    /// A measured picture.
    fn measured(&self, page: &mut Report) -> anyhow::Result<()> {
        if let Some(jpeg) = self.jpeg {
            let caption = format!("{}. {}.", self.number, self.image.text());
            let description = format!("Measured picture {}", self.number);
            page.pointing_picture(&self.picture(jpeg, &description), &caption)?;
        }
        Ok(())
    }

    /// The picture to be pointed at. What straightens a picture is reported by the one that was taken.
    fn picture<'a>(&self, bytes: &'a [u8], description: &'a str) -> PointingPicture<'a> {
        let tools = if self.image.rectified {
            &TOOLS[..TOOLS.len() - 1]
        } else {
            &TOOLS
        };
        PointingPicture {
            bytes,
            description,
            size: self.image.picture_size_px,
            tools,
        }
    }
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().map(char::to_uppercase);
    first
        .into_iter()
        .flatten()
        .chain(letters)
        .collect::<String>()
        + "."
}

/// The first section: verdict, means, course over the pictures and the list of all.
fn summary(
    page: &mut Report,
    output: &Output,
    all: &[Shown<'_>],
    mode: Mode,
) -> anyhow::Result<()> {
    let summary = &output.summary;
    page.section("Summary");
    let told = [
        (summary.n, "measured"),
        (summary.refused, "refused"),
        (summary.unread, "not read"),
    ];
    let told = told.iter().filter(|(n, _)| *n > 0);
    let told: Vec<String> = told.map(|(n, what)| format!("{n} {what}")).collect();
    let (verdict, reason) = match (summary.n, summary.refused + summary.unread) {
        (_, 0) => (
            Tone::Good,
            "Look at the pictures before you believe a number.",
        ),
        (0, _) => (Tone::Bad, "Each picture below says first how to continue."),
        _ => (
            Tone::Caution,
            "Each picture without an angle says first how to continue.",
        ),
    };
    page.verdict(verdict, &sentence(&told.join(", ")), reason);
    let facts = facts(output, mode);
    if !facts.is_empty() {
        page.facts(&facts);
    }
    if let Some(bias) = &summary.largest_bias {
        page.paragraph(&format!("{}.", bias.text().trim()));
    }
    if let Some(rough) = &summary.too_rough {
        page.paragraph(&format!("{}.", rough.text().trim()));
    }
    if all.len() > 1 {
        several(page, output, all)?;
    }
    for image in &output.images {
        if let Some(warning) = &image.warning {
            page.verdict(Tone::Note, &image.name(), &sentence(warning));
        }
    }
    if let Some(words) = &output.left_out {
        page.paragraph(&sentence(words));
    }
    Ok(())
}

/// Course, mean surface and tables of several pictures.
fn several(page: &mut Report, output: &Output, all: &[Shown<'_>]) -> anyhow::Result<()> {
    let summary = &output.summary;
    if let Some(chart) = course(all, summary.mean_deg) {
        let caption =
            "The angle of each picture that has one, with its 95 % interval, and the mean.";
        page.figure(&chart.draw()?, caption);
    }
    if let Some(interface) = &summary.interface {
        let caption = "The mean surface of all measured pictures along the drum, with the standard deviation of its height \
                       between them as bars.";
        page.figure(&mean_surface(interface).draw()?, caption);
    }
    page.table(&list(all)?);
    if let Some(table) = observables(output)? {
        page.table(&table);
    }
    Ok(())
}

/// The angle with its error, or the mean of several, and which slope it is.
fn facts(output: &Output, mode: Mode) -> Vec<Fact> {
    let slope = match (mode, output.images.first()) {
        (Mode::Heap, _) => "both flanks, their mean",
        (Mode::Drum, image) => definition(image.map(|i| i.definition).unwrap_or_default()),
    };
    let slope = Fact::new("The angle is that of", slope);
    let summary = &output.summary;
    if let [image] = output.images.as_slice() {
        let Some((angle, error)) = image.angle_deg.zip(image.angle_se_deg) else {
            return Vec::new();
        };
        let mut facts = vec![Fact::new("Angle", with_error(angle, Some(error)))];
        if let Some([low, high]) = image.angle_interval_deg {
            let interval = format!("{low:.2} to {high:.2}\u{b0}");
            facts.push(Fact::new("95 % interval", interval));
        }
        facts.push(slope);
        return facts;
    }
    let Some(mean) = summary.mean_deg else {
        return Vec::new();
    };
    let mut facts = vec![Fact::new("Mean angle", with_error(mean, summary.se_deg))];
    if let Some(sd) = summary.sd_deg {
        let name = "Standard deviation between pictures";
        facts.push(Fact::new(name, format!("{sd:.2}\u{b0}")));
    }
    if let Some(n) = summary.n_effective {
        facts.push(Fact::new("Independent pictures", format!("{n:.1}")));
    }
    facts.push(slope);
    facts
}

/// A definition in words.
fn definition(definition: Definition) -> &'static str {
    match definition {
        Definition::Line => "the line through the whole surface",
        Definition::Mid => "the central fifth of the drum",
        Definition::Chord => "the chord from rim to rim",
    }
}

/// An angle with its standard error, degrees.
fn with_error(angle: f64, error: Option<f64>) -> String {
    match error {
        Some(error) => format!("{angle:.2} \u{b1} {error:.2}\u{b0}"),
        None => format!("{angle:.2}\u{b0}, error unknown"),
    }
}

/// The angle over the pictures, or over time where it is known; none of fewer than two.
fn course(all: &[Shown<'_>], mean: Option<f64>) -> Option<Plot> {
    let points = all.iter().filter_map(|shown| {
        let image = shown.image;
        let x = image.time_s.unwrap_or(shown.number as f64);
        let error = HALF_INTERVAL * image.angle_se_deg?;
        Some(PlotPoint::new(x, image.angle_deg?).with_error(error))
    });
    let points: Vec<PlotPoint> = points.collect();
    let finite = |p: &PlotPoint| p.x.is_finite() && p.y.is_finite() && p.y_error.is_finite();
    if points.len() < 2 || !points.iter().all(finite) {
        return None;
    }
    let timed = all.iter().any(|shown| shown.image.time_s.is_some());
    let x = if timed {
        Axis::numbers("Time", "s")
    } else {
        Axis::numbers("Picture", "")
    };
    let plot = Plot::new(x, Axis::numbers("Angle", "\u{b0}")).with_all(series(0, "angle", points));
    Some(plot.with_all(mean.map(|mean| Mark::level("mean", mean))))
}

/// The mean surface along the drum.
fn mean_surface(interface: &Interface) -> Plot {
    let places = interface.x_radii.iter();
    let heights = interface.mean_radii.iter().zip(&interface.sd_radii);
    let points = places
        .zip(heights)
        .map(|(x, (mean, sd))| PlotPoint::new(*x, *mean).with_error(*sd));
    let x = Axis::numbers("Place along the drum", "radii");
    Plot::new(x, Axis::numbers("Height over the axis", "radii")).with_all(series(
        0,
        "surface",
        points.collect(),
    ))
}

/// All pictures as a table.
fn list(all: &[Shown<'_>]) -> anyhow::Result<Table> {
    let timed = all.iter().any(|shown| shown.image.time_s.is_some());
    let mut columns = vec![Column::number("No."), Column::text("Picture")];
    if timed {
        columns.push(Column::number("Time, s"));
    }
    columns.extend([
        Column::number("Angle, \u{b0}"),
        Column::number("Standard error, \u{b0}"),
        Column::text("Verdict"),
    ]);
    let mut table = Table::new("All pictures in their order.", columns)?;
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.2}"));
    for shown in all {
        let image = shown.image;
        let mut row = vec![shown.number.to_string(), shown.name()];
        if timed {
            row.push(image.time_s.map_or_else(String::new, |t| format!("{t:.3}")));
        }
        row.extend([
            number(image.angle_deg),
            number(image.angle_se_deg),
            image.verdict.to_owned(),
        ]);
        table.row(row)?;
    }
    Ok(table)
}

/// What the pictures tell together beside the angle; none of a heap.
fn observables(output: &Output) -> anyhow::Result<Option<Table>> {
    let found = &output.summary.observables;
    if found.is_empty() {
        return Ok(None);
    }
    let mut table = Table::new(
        "All that the pictures tell, by the names that studies use; the unit is the end of the name.",
        vec![
            Column::text("Name"),
            Column::number("Mean"),
            Column::number("Standard error"),
            Column::number("Standard deviation"),
        ],
    )?;
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.4}"));
    for (name, Spread { mean, sd, se, .. }) in found {
        table.row([
            (*name).to_owned(),
            number(Some(*mean)),
            number(*se),
            number(*sd),
        ])?;
    }
    Ok(Some(table))
}
