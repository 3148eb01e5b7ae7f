//! How photos are read, as the file says it.

use super::PhotoOptions;
use crate::document::Fields;
use crate::keys;
use crate::photo_values::{IF_NAMED, OF_PHOTOS};
use crate::problem::Problems;
use input::quantity::{Angle, Time};
use photo_profile::{PixelPoint, PixelRegion, mark_error, roll_by_level, roll_by_plumb_line};
use std::num::NonZeroUsize;
use std::path::PathBuf;

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
    let (roll_rad, roll_error_rad) = roll(fields, problems);
    let elevation_rad = angle_within(fields, "elevation", [0.0, 30.0], problems);
    let max_angle_error_rad = max_angle_error(fields, problems);
    let drum = fields.optional("drum", "three numbers [cx, cy, r] in px", problems);
    let form = "\"X,Y;X,Y;X,Y;X,Y\" in px: upper left, upper right, lower right, lower left";
    let corners = places(fields, "corners", form, problems);
    let form = "four whole numbers [x, y, width, height] in px";
    let region: Option<[u32; 4]> = fields.optional("region", form, problems);
    let mask: Option<PathBuf> = fields.optional("mask", "the name of a picture", problems);
    if corners.is_some() && mask.is_some() {
        let problem = "lies over the picture as it was taken: leave out corners, or hide nothing";
        problems.add(fields.wrong("mask", problem));
    }
    let every: Option<NonZeroUsize> = fields.optional("every", "a whole number from 1", problems);
    let kinds = "\"auto\", \"dark\" or \"light\"";
    let foreground = fields.optional("foreground", kinds, problems);
    let frame_interval_s = interval(fields, "frame_interval", problems);
    let pair_interval_s = interval(fields, "pair_interval", problems);
    if every.is_some() && pair_interval_s.is_some() {
        let problem = "parts the pictures of a pair: leave out one of every and pair_interval";
        problems.add(fields.wrong("every", problem));
    }
    let names = "a list of observables";
    let also: Option<Vec<String>> = fields.optional("also", names, problems);
    let also = also.unwrap_or_default();
    for name in also
        .iter()
        .filter(|name| !IF_NAMED.contains(&name.as_str()))
    {
        let problem = format!(
            "'{name}' is none of the observables that are left to choice: {}; all others are taken over where photos show \
             them",
            IF_NAMED.join(", ")
        );
        problems.add(fields.wrong("also", problem));
    }
    let leave_out: Option<Vec<String>> = fields.optional("leave_out", names, problems);
    let leave_out = leave_out.unwrap_or_default();
    for name in &leave_out {
        if !OF_PHOTOS.contains(&name.as_str()) {
            let problem = format!(
                "'{name}' is none of the observables that photos give: {}",
                OF_PHOTOS.join(", ")
            );
            problems.add(fields.wrong("leave_out", problem));
        } else if also.contains(name) {
            let problem = format!("'{name}' is named in also, too: remove it from one of both");
            problems.add(fields.wrong("leave_out", problem));
        }
    }
    PhotoOptions {
        frame_interval_s,
        pair_interval_s,
        also,
        leave_out,
        roll_rad,
        roll_error_rad,
        elevation_rad,
        max_angle_error_rad,
        region: region.map(|[left, top, width, height]| PixelRegion {
            left,
            top,
            width,
            height,
        }),
        mask,
        every,
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

/// Tells the turn of the camera by two places.
type RollBy = fn([PixelPoint; 2]) -> Result<f64, photo_profile::Error>;

/// Angle of the true horizontal in the pictures and its standard error, rad: stated, or by a mark in them; 0 if neither is given.
fn roll(fields: &Fields<'_>, problems: &mut Problems) -> (f64, f64) {
    let stated: Option<Angle> = fields.optional("roll", "an angle such as \"0.4 deg\"", problems);
    let mut rolls = vec![stated.map(|angle| (angle.si(), 0.0))];
    let marks: [(&str, RollBy); 2] = [("plumb_line", roll_by_plumb_line), ("level", roll_by_level)];
    for (key, roll_by) in marks {
        let ends = places(fields, key, "\"X,Y;X,Y\" in px: two places", problems);
        let ends = ends.map(|ends: [[f64; 2]; 2]| ends.map(|[x, y]| PixelPoint { x, y }));
        rolls.push(ends.and_then(|ends| match roll_by(ends) {
            Ok(roll) => Some((roll, mark_error(ends))),
            Err(error) => {
                problems.add(fields.wrong(key, format!("tells no horizontal: {error}")));
                None
            }
        }));
        if rolls.iter().flatten().count() > 1 {
            let problem =
                "says the turn of the camera a second time: give one of roll, plumb_line and level";
            problems.add(fields.wrong(key, problem));
            rolls.pop();
        }
    }
    rolls.into_iter().flatten().next().unwrap_or_default()
}

/// So many places `X,Y` with semicolons between them.
fn places<const N: usize>(
    fields: &Fields<'_>,
    key: &str,
    form: &str,
    problems: &mut Problems,
) -> Option<[[f64; 2]; N]> {
    let text: String = fields.optional(key, "a text", problems)?;
    let found = input::quantity::places(&text).and_then(|all| all.try_into().ok());
    if found.is_none() {
        problems.add(fields.wrong(key, format!("must be {form}")));
    }
    found
}
