//! How photos are read, as the file says it.

use super::PhotoOptions;
use crate::document::Fields;
use crate::keys;
use crate::photo_values::NOT_IN_EVERY_RUN;
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
    let elevation_rad = angle_within(fields, "elevation", [0.0, 30.0], problems);
    let max_angle_error_rad = max_angle_error(fields, problems);
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
    let frame_interval_s = interval(fields, "frame_interval", problems);
    let pair_interval_s = interval(fields, "pair_interval", problems);
    let names = "a list of observables";
    let also: Option<Vec<String>> = fields.optional("also", names, problems);
    let also = also.unwrap_or_default();
    for name in also
        .iter()
        .filter(|name| !NOT_IN_EVERY_RUN.contains(&name.as_str()))
    {
        let problem = format!(
            "'{name}' is none of the observables that are left to choice: {}; all others are taken over where photos show \
             them",
            NOT_IN_EVERY_RUN.join(", ")
        );
        problems.add(fields.wrong("also", problem));
    }
    PhotoOptions {
        frame_interval_s,
        pair_interval_s,
        also,
        roll_rad: roll.map_or(0.0, Angle::si),
        elevation_rad: elevation_rad.unwrap_or(0.0),
        max_angle_error_rad,
        drum,
        corners,
        foreground: foreground.unwrap_or_default(),
    }
}

/// Largest standard error with which the angle may be known from one picture, rad.
pub(super) fn max_angle_error(fields: &Fields<'_>, problems: &mut Problems) -> Option<f64> {
    angle_within(fields, "max_angle_error", [0.1, 30.0], problems)
}

/// An angle between two limits (degrees), rad.
fn angle_within(
    fields: &Fields<'_>,
    key: &str,
    [low, high]: [f64; 2],
    problems: &mut Problems,
) -> Option<f64> {
    let angle: Option<Angle> = fields.optional(key, "an angle such as \"3 deg\"", problems);
    let angle = angle.map(Angle::si);
    let possible = |angle: &f64| (low..=high).contains(&angle.to_degrees());
    if angle.is_some_and(|angle| !possible(&angle)) {
        problems.add(fields.wrong(key, format!("must be {low} to {high} degrees")));
    }
    angle.filter(possible)
}

/// A time between pictures, s.
fn interval(fields: &Fields<'_>, key: &str, problems: &mut Problems) -> Option<f64> {
    let time: Option<Time> = fields.optional(key, "a time such as \"40 ms\"", problems);
    if time.is_some_and(|time| time.si() <= 0.0) {
        problems.add(fields.wrong(key, "must be above 0 s"));
    }
    time.map(Time::si).filter(|time| *time > 0.0)
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
