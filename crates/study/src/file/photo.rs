//! How photos are read, as the file says it.

use crate::document::below;
use crate::photo_values::{IF_NAMED, OF_PHOTOS};
use crate::problem::Problems;
use input::quantity::{self, Angle, Time};
use photo_profile::{Error, Foreground, PixelPoint, mark_error, roll_by_level, roll_by_plumb_line};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// How photos are read.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PhotoOptions {
    /// Slope that is the angle.
    definition: Option<Definition>,
    /// Angle of the true horizontal in the pictures, counter-clockwise positive.
    roll: Option<Angle>,
    /// Two places on a plumb line, or of one height, px, which give the same angle.
    #[serde(deserialize_with = "places")]
    plumb_line: Option<[[f64; 2]; 2]>,
    #[serde(deserialize_with = "places")]
    level: Option<[[f64; 2]; 2]>,
    /// How far the camera is above the foot of a heap; `None`: as the lower edge of each heap shows it.
    pub(crate) elevation: Option<Angle>,
    /// Largest standard error with which the angle may be known from one picture; `None`: 3 degrees.
    pub(crate) max_angle_error: Option<Angle>,
    /// Left, top, width and height of the part of each picture that alone is looked at, px.
    pub(crate) region: Option<[u32; 4]>,
    /// A picture that is black where something else than bed and air shows.
    pub(crate) mask: Option<PathBuf>,
    /// Every n-th picture is taken: of several files one file, of one film or animation one picture in it.
    pub(crate) every: Option<NonZeroUsize>,
    /// Centre and radius of the drum, px; `None`: found.
    pub(crate) drum: Option<[f64; 3]>,
    /// Corners of a square in the plane of the drum's end, px.
    #[serde(deserialize_with = "places")]
    pub(crate) corners: Option<[[f64; 2]; 4]>,
    /// Tone of the bed against the air.
    pub(crate) foreground: Foreground,
    /// Time between two pictures that follow each other, taken or not; `None`: not known, or not always the same.
    pub(crate) frame_interval: Option<Time>,
    /// Time between the two pictures of a pair, of which the first is measured and the second shows how far the surface went.
    pub(crate) pair_interval: Option<Time>,
    /// Observables to be taken over besides the usual ones.
    pub(crate) also: Vec<String>,
    /// Observables that are not to be taken over.
    pub(crate) leave_out: Vec<String>,
}

/// The one definition that a simulated frame can be compared by: the line through the whole surface.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Definition {
    Line,
}

impl PhotoOptions {
    /// Angle of the true horizontal in the pictures and its standard error, rad: stated, or by a mark in them; 0 if neither is given.
    ///
    /// # Errors
    ///
    /// The key of a mark that shows no horizontal.
    pub(crate) fn roll_rad(&self) -> Result<(f64, f64), (&'static str, Error)> {
        let points = |ends: [[f64; 2]; 2]| ends.map(|[x, y]| PixelPoint { x, y });
        if let Some(ends) = self.plumb_line.map(points) {
            let roll = roll_by_plumb_line(ends).map_err(|error| ("plumb_line", error))?;
            return Ok((roll, mark_error(ends)));
        }
        if let Some(ends) = self.level.map(points) {
            let roll = roll_by_level(ends).map_err(|error| ("level", error))?;
            return Ok((roll, mark_error(ends)));
        }
        Ok((self.roll.map_or(0.0, Angle::si), 0.0))
    }

    /// Refuses what contradicts itself.
    pub(super) fn check(&self, path: &str, problems: &mut Problems) {
        let at = |key: &str| below(path, key);
        if let Err((key, error)) = self.roll_rad() {
            problems.wrong(&at(key), format!("shows no horizontal: {error}"));
        }
        let rolls = [
            ("roll", self.roll.is_some()),
            ("plumb_line", self.plumb_line.is_some()),
            ("level", self.level.is_some()),
        ];
        for (key, _) in rolls.into_iter().filter(|(_, stated)| *stated).skip(1) {
            let problem =
                "states the turn of the camera again: give one of roll, plumb_line and level";
            problems.wrong(&at(key), problem);
        }
        require_angle(self.elevation, [0.0, 30.0], &at("elevation"), problems);
        require_angle(
            self.max_angle_error,
            [0.1, 30.0],
            &at("max_angle_error"),
            problems,
        );
        let both = self.corners.is_some() && self.mask.is_some();
        let problem = "a mask is laid over the picture as it was taken: leave out corners or mask";
        problems.require(!both, &at("mask"), problem);
        for (key, time) in [
            ("frame_interval", self.frame_interval),
            ("pair_interval", self.pair_interval),
        ] {
            problems.require(
                time.is_none_or(|time| time.si() > 0.0),
                &at(key),
                "must be above 0 s",
            );
        }
        let both = self.every.is_some() && self.pair_interval.is_some();
        let problem = "would separate the pictures of a pair: leave out every or pair_interval";
        problems.require(!both, &at("every"), problem);
        let unknown = |name: &str, known: &[&str]| {
            let known = known.join(", ");
            format!("'{name}' is not one of {known}")
        };
        for name in self
            .also
            .iter()
            .filter(|name| !IF_NAMED.contains(&name.as_str()))
        {
            problems.wrong(&at("also"), unknown(name, &IF_NAMED));
        }
        for name in &self.leave_out {
            if !OF_PHOTOS.contains(&name.as_str()) {
                problems.wrong(&at("leave_out"), unknown(name, &OF_PHOTOS));
            } else if self.also.contains(name) {
                let problem = format!("'{name}' is in also, too: remove it from one of the two");
                problems.wrong(&at("leave_out"), problem);
            }
        }
    }
}

/// Refuses an angle beyond two limits, degrees.
pub(super) fn require_angle(
    angle: Option<Angle>,
    [low, high]: [f64; 2],
    path: &str,
    problems: &mut Problems,
) {
    let holds = angle.is_none_or(|angle| (low..=high).contains(&angle.si().to_degrees()));
    problems.require(holds, path, &format!("must be {low} to {high} degrees"));
}

/// So many places `X,Y` with semicolons between them, px.
fn places<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<Option<[[f64; 2]; N]>, D::Error> {
    let text = String::deserialize(from)?;
    let found = quantity::places(&text).and_then(|all| all.try_into().ok());
    let form = vec!["X,Y"; N].join(";");
    let wrong = || D::Error::custom(format!("must be {N} places \"{form}\" in px"));
    found.map(Some).ok_or_else(wrong)
}
