//! From a photo or a rendered frame to the free surface in it.
//!
//! One path for colour photos, back-lit instrument pictures, time averages and rendered frames:
//! grey or the channel that parts best, drum circle, threshold, majority filter, boundary, and then
//! [`surface_profile::read_surface`], which also measures simulated beds. Nothing is set per
//! picture. What cannot be measured honestly comes back as [`PhotoReading::Refused`] with a reason.
//!
//! Steps, in order: [`read_photo`] (or [`PhotoPixels::from_gray`]) holds the picture; the drum is
//! found by edges and a robust circle in the luminance, or in another channel where that leads nowhere; of a
//! colour picture the [`Channel`] is taken in which the two sides lie farthest apart; the disc is resampled around the axis; the air tone is
//! found on the upper side of the most telling straight cut; pixels are separated by their
//! distance from the air tone with the threshold of `[Otsu1979]`, made to follow uneven light;
//! the mask is smoothed over 0.03 drum radii and its half-of-bulk contour is the free surface. The
//! surface must agree with the picture (a step along it, bed below and air above), or it is
//! refused. The standard errors hold roughness, drum circle, threshold, light and camera tilt.
//! A heap has its own path from the same tones: the highest place of the largest part in each column, then
//! [`surface_profile::measure_heap`].
//!
//! `imageproc` straightens oblique pictures and finds the largest part of a heap's picture. Its edge finder, Hough lines and
//! threshold are not used: the first is not mirror-symmetric, the second counts in degrees, and the third overflows on large
//! pictures (`tests/suite/other_library.rs`).
//!
//! Pixel frame: x to the right, y **down**, the centre of the first pixel is (0, 0).
//!
//! ```
//! use dev_support::drawn_pictures::Scene;
//! use photo_profile::{Settings, measure_image};
//! let scene = Scene { inclination: 0.6, ..Scene::default() };
//! let reading = measure_image(&scene.draw(), &Settings::default())?;
//! let angle = reading.angle().expect("a clear picture");
//! assert!((angle.line - 0.6).abs() < 0.005);
//! # Ok::<(), photo_profile::Error>(())
//! ```
//!
//! Invariants: nothing random; a picture and its mirror give the same angle; no step knows
//! which file it works on.

mod agreement;
mod block_match;
mod channel;
mod circle;
mod decode;
mod drum;
mod edges;
mod error;
mod files;
mod film;
mod font;
mod given_surface;
mod heap;
mod jpeg_end;
mod level_mark;
mod light;
mod mask;
mod measure;
mod otsu;
mod overlay;
mod pixels;
mod rays;
mod reading;
mod rectify;
mod region;
mod rim;
mod settings;
mod sideways;
mod surface_shift;
mod tone;
mod uncertainty;
mod unread_frames;
mod view;

pub use channel::Channel;
pub use decode::{Frames, MOST_PIXELS, decode_photo, read_frames, read_photo};
pub use error::Error;
pub use files::{LeftOut, NoPhoto, PictureFiles, one_of};
pub use given_surface::{LEAST_PLACES, measure_given_surface};
pub use heap::HeapReading;
pub use level_mark::{mark_error, roll_by_level, roll_by_plumb_line};
pub use mask::Mask;
pub use measure::{measure_image, measure_photo};
pub use otsu::otsu_threshold;
pub use overlay::{marked, overlay, overlay_gray};
pub use pixels::PhotoPixels;
pub use reading::{BedEnds, DrumReading, PhotoReading, PixelPoint, Refusal, RefusedReading};
pub use rectify::rectify;
pub use region::PixelRegion;
pub use settings::{DrumPixels, Foreground, MAX_ANGLE_ERROR, Mode, Settings};
pub use sideways::{Posture, sideways};
pub use surface_shift::{NoShift, SurfaceShift, surface_shift};
pub use unread_frames::SelectionBias;
