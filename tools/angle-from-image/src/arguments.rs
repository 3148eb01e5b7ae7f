//! What the command takes.

use photo_profile::{
    DrumPixels, Foreground, LEAST_PLACES, Mode, PixelPoint, PixelRegion, Settings, mark_error,
    roll_by_level, roll_by_plumb_line,
};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use surface_profile::Definition;

/// Reads the angle of repose from photos and frames of a rotating drum, or of a heap.
///
/// The angle is the inclination of the free surface from the horizontal of the picture, always
/// positive, with the side that stands higher. Exit code 0: all measured; 1: at least one picture
/// was refused or one of several files could not be read, with the reason; 2: an error, or nothing
/// could be read.
#[derive(Debug, clap::Parser)]
#[command(
    version,
    after_help = "Example:\n  angle-from-image frames/ --csv angles.xlsx --html angles.html"
)]
pub(crate) struct Arguments {
    /// Photos (PNG, JPEG, BMP, GIF, TIFF, WebP, animated PNG and GIF), folders of them, or films (MP4, MOV, AVI and others, by
    /// the program ffmpeg)
    #[arg(required = true, value_name = "PHOTO")]
    pub(crate) photos: Vec<PathBuf>,

    /// Draw what was found over the photo; for several pictures the name gets a number
    #[arg(long, value_name = "OUT.png")]
    pub(crate) overlay: Option<PathBuf>,

    /// Write a table, one row a picture, refused ones with their reason: CSV, or an Excel workbook for a name that ends in
    /// .xlsx
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,

    /// Write a page that opens without a network: a summary, and every picture with what was found in it
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,

    /// Which slope is the angle: least-squares line through the whole free surface, tangent of
    /// the central fifth of the drum diameter, or rim to rim
    #[arg(long, value_enum, default_value_t = DefinitionName::Line)]
    pub(crate) definition: DefinitionName,

    /// The drum circle, px, y down from the centre of the upper left pixel [default: found]
    #[arg(long, value_name = "CX,CY,R", value_parser = drum, allow_hyphen_values = true)]
    pub(crate) drum: Option<DrumPixels>,

    /// Five or more places on the surface of the bed in one picture of a drum, px, where the program does not see it: the
    /// angle is that of the line through them
    #[arg(long, value_name = "X,Y;X,Y;...", value_parser = surface, conflicts_with_all = ["region", "mask", "every", "fps"])]
    pub(crate) surface: Option<Surface>,

    /// The part of the picture that alone is looked at, px: left, top, width, height
    #[arg(long, value_name = "X,Y,W,H", value_parser = region)]
    pub(crate) region: Option<PixelRegion>,

    /// A picture of the same size, black where something else than bed and air shows (a clamp, a label), white elsewhere: no
    /// point of a surface counts there
    #[arg(long, value_name = "FILE", conflicts_with = "corners")]
    pub(crate) mask: Option<PathBuf>,

    /// Angle of the true horizontal in the picture, degrees, counter-clockwise positive
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_hyphen_values = true
    )]
    pub(crate) camera_roll_deg: f64,

    /// Two places on a plumb line in the picture, px, that tell the horizontal
    #[arg(long, value_name = "X,Y;X,Y", value_parser = places, conflicts_with_all = ["camera_roll_deg", "level"])]
    pub(crate) plumb_line: Option<[PixelPoint; 2]>,

    /// Two places of the same height in the picture, px, that tell the horizontal
    #[arg(long, value_name = "X,Y;X,Y", value_parser = places, conflicts_with = "camera_roll_deg")]
    pub(crate) level: Option<[PixelPoint; 2]>,

    /// How far above the foot of a heap the camera stands, degrees: from there a heap looks flatter than it is [default: as the
    /// lower edge of the heap shows it]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub(crate) camera_elevation_deg: Option<f64>,

    /// Corners of a square in the plane of the drum's end, to take the perspective out: upper
    /// left, upper right, lower right, lower left, px; results are then in the straightened
    /// picture
    #[arg(long, value_name = "X,Y;X,Y;X,Y;X,Y", value_parser = corners, allow_hyphen_values = true)]
    pub(crate) corners: Option<Corners>,

    /// What the picture shows: a drum along its axis, or a heap from the side (its angle is the
    /// mean of both flanks)
    #[arg(long, value_enum, default_value_t = ModeName::Drum)]
    pub(crate) mode: ModeName,

    /// Whether the bed is darker or lighter than the air
    #[arg(long, value_enum, default_value_t = ForegroundName::Auto)]
    pub(crate) foreground: ForegroundName,

    /// Largest standard error with which the angle of a bed or a heap may be known from one picture, degrees: coarse grains
    /// need more, and many pictures
    #[arg(long, value_name = "DEG", default_value_t = 3.0)]
    pub(crate) max_error_deg: f64,

    /// Put the points of the surface (px) into the JSON
    #[arg(long)]
    pub(crate) points: bool,

    /// Pictures a second, where they follow each other at one rate: each then has a time, and the angle also shows how
    /// long it is correlated with itself, or its avalanches [default: none; of one film, as it states]
    #[arg(long, value_name = "RATE", value_parser = rate)]
    pub(crate) fps: Option<f64>,

    /// Take each N-th picture only: of several files each N-th file, of one film or animation each N-th picture in it
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) every: NonZeroUsize,

    /// Flags of every command.
    #[command(flatten)]
    pub(crate) common: command_line::Common,
}

/// Places on a surface, px.
#[derive(Debug, Clone)]
pub(crate) struct Surface(pub(crate) Vec<PixelPoint>);

/// Four corners, px.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corners(pub(crate) [PixelPoint; 4]);

/// Names of the definitions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum DefinitionName {
    /// Rim to rim
    Chord,
    /// Central fifth of the drum diameter
    Mid,
    /// Least-squares line through the whole free surface
    Line,
}

/// Names of the modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ModeName {
    /// A drum seen along its axis
    Drum,
    /// A heap on a level base
    Heap,
}

/// Names of the foregrounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ForegroundName {
    /// Found from the picture
    Auto,
    /// The bed is darker than the air
    Dark,
    /// The bed is lighter than the air
    Light,
}

impl Arguments {
    /// The settings of the measurement; marks that tell no horizontal are an error.
    pub(crate) fn settings(&self) -> Result<Settings, photo_profile::Error> {
        let camera_roll = match (self.plumb_line, self.level) {
            (Some(places), _) => roll_by_plumb_line(places)?,
            (None, Some(places)) => roll_by_level(places)?,
            (None, None) => self.camera_roll_deg.to_radians(),
        };
        let mark = self.plumb_line.or(self.level);
        let settings = Settings {
            region: self.region,
            drum: self.drum,
            camera_roll,
            camera_roll_error: mark.map_or(0.0, mark_error),
            definition: match self.definition {
                DefinitionName::Chord => Definition::Chord,
                DefinitionName::Mid => Definition::Mid,
                DefinitionName::Line => Definition::Line,
            },
            mode: match self.mode {
                ModeName::Drum => Mode::Drum,
                ModeName::Heap => Mode::Heap,
            },
            foreground: match self.foreground {
                ForegroundName::Auto => Foreground::Auto,
                ForegroundName::Dark => Foreground::Dark,
                ForegroundName::Light => Foreground::Light,
            },
            max_angle_error: self.max_error_deg.to_radians(),
            camera_elevation: self.camera_elevation_deg.map(f64::to_radians),
        };
        settings.check()?;
        Ok(settings)
    }
}

/// Reads numbers with commas between them.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    input::quantity::numbers(text)
        .ok_or_else(|| format!("\"{text}\" must be {N} finite numbers with commas, in px"))
}

/// Reads a number of pictures a second.
fn rate(text: &str) -> Result<f64, String> {
    let rate = text
        .trim()
        .parse()
        .ok()
        .filter(|r: &f64| r.is_finite() && *r > 0.0);
    rate.ok_or_else(|| format!("\"{text}\" must be a number of pictures a second above 0"))
}

/// Reads CX,CY,R.
fn drum(text: &str) -> Result<DrumPixels, String> {
    numbers(text).map(|[cx, cy, r]| DrumPixels { cx, cy, r })
}

/// Reads X,Y,W,H.
fn region(text: &str) -> Result<PixelRegion, String> {
    let parts: Result<Vec<u32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let wrong = || format!("\"{text}\" must be left, top, width and height with commas, whole px");
    let [left, top, width, height] = parts
        .ok()
        .and_then(|parts| parts.try_into().ok())
        .ok_or_else(wrong)?;
    Ok(PixelRegion {
        left,
        top,
        width,
        height,
    })
}

/// Reads places X,Y with semicolons between them.
fn points<const N: usize>(text: &str, what: &str) -> Result<[PixelPoint; N], String> {
    all_points(text)?
        .try_into()
        .map_err(|_| format!("\"{text}\" must be {what} X,Y with semicolons, in px"))
}

/// Reads any number of X,Y with semicolons.
fn all_points(text: &str) -> Result<Vec<PixelPoint>, String> {
    let places = input::quantity::places(text);
    let places = places.ok_or_else(|| {
        format!("\"{text}\" must be places X,Y of finite numbers with semicolons, in px")
    })?;
    Ok(places
        .into_iter()
        .map(|[x, y]| PixelPoint { x, y })
        .collect())
}

/// Reads the places on a surface.
fn surface(text: &str) -> Result<Surface, String> {
    let places = all_points(text)?;
    if places.len() < LEAST_PLACES {
        return Err(format!(
            "\"{text}\" must be {LEAST_PLACES} or more places X,Y with semicolons, in px"
        ));
    }
    Ok(Surface(places))
}

/// Reads X,Y;X,Y;X,Y;X,Y.
fn corners(text: &str) -> Result<Corners, String> {
    points(text, "four corners").map(Corners)
}

/// Reads X,Y;X,Y.
fn places(text: &str) -> Result<[PixelPoint; 2], String> {
    points(text, "two places")
}
