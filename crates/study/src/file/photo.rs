//! How photos are read, as the file says it.

use super::PhotoOptions;
use crate::document::Fields;
use crate::keys;
use crate::problem::Problems;
use quantity::{Angle, Time};

/// How photos are read.
pub(super) fn photo_options(fields: &Fields<'_>, problems: &mut Problems) -> PhotoOptions {
    fields.check_keys(&keys::PHOTO, problems);
    let definition: Option<String> = fields.optional("definition", "\"line\"", problems);
    if definition.is_some_and(|d| d != "line") {
        problems.add(fields.wrong(
            "definition",
            "cannot be compared: the angle of a simulated frame is that of the line through the whole surface; \
             write \"line\"",
        ));
    }
    let roll: Option<Angle> = fields.optional("roll", "an angle such as \"0.4 deg\"", problems);
    let drum = fields.optional("drum", "three numbers [cx, cy, r] in px", problems);
    let corners: Option<String> = fields.optional("corners", "a text", problems);
    let corners = corners.and_then(|text| {
        let found = corners_of(&text);
        if found.is_none() {
            let problem = "must be \"X,Y;X,Y;X,Y;X,Y\" in px: upper left, upper right, lower right, lower left";
            problems.add(fields.wrong("corners", problem));
        }
        found
    });
    let kinds = "\"auto\", \"dark\" or \"light\"";
    let foreground = fields.optional("foreground", kinds, problems);
    let interval: Option<Time> =
        fields.optional("frame_interval", "a time such as \"40 ms\"", problems);
    if interval.is_some_and(|time| time.si() <= 0.0) {
        problems.add(fields.wrong("frame_interval", "must be above 0 s"));
    }
    PhotoOptions {
        frame_interval_s: interval.map(Time::si).filter(|time| *time > 0.0),
        roll_rad: roll.map_or(0.0, Angle::si),
        drum,
        corners,
        foreground: foreground.unwrap_or_default(),
    }
}

/// Four corners `X,Y` with semicolons between them.
fn corners_of(text: &str) -> Option<[[f64; 2]; 4]> {
    let point = |pair: &str| -> Option<[f64; 2]> {
        let (x, y) = pair.split_once(',')?;
        let finite = |t: &str| t.trim().parse().ok().filter(|v: &f64| v.is_finite());
        Some([finite(x)?, finite(y)?])
    };
    let all: Option<Vec<_>> = text.split(';').map(point).collect();
    all?.try_into().ok()
}
